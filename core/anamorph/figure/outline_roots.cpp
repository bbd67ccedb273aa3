// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline_roots.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace anamorph {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr int kIntervals = 8;
constexpr double kLeastRadius = 1e-13;

struct Direction {
    double cosine, sine;

    explicit Direction(double t = 0) : cosine(std::cos(t)), sine(std::sin(t)) {}
};

/// Ends (even) and middles (odd) of the first intervals.
std::array<Direction, 2 * kIntervals + 1> first_directions() {
    std::array<Direction, 2 * kIntervals + 1> table;
    for (std::size_t i = 0; i < table.size(); ++i)
        table[i] = Direction(kTurn * static_cast<double>(i % (2 * kIntervals)) / (2 * kIntervals));
    return table;
}
const std::array<Direction, 2 * kIntervals + 1> kFirst = first_directions();

class Search {
  public:
    Search(const WaveSquares& f, Roots& roots) : m_f(f), m_roots(roots) {
        expand(f.x, 1);
        expand(f.y, 1);
        expand(f.z, 1);
        expand(f.w, -1);
    }

    void run() {
        const double first = std::hypot(m_c1, m_s1), second = std::hypot(m_c2, m_s2);
        if (std::fabs(m_mean) > first + second + m_magnitude) return;
        // Bounds |f'''|.
        m_third = first + 8 * second;
        constexpr double radius = kTurn / (2 * kIntervals);
        for (int i = 0; i < kIntervals; ++i)
            interval((2 * i + 1) * radius, radius, kFirst[2 * i + 1], kFirst[2 * i], kFirst[2 * i + 2]);
    }

  private:
    /// Adds a square to f = mean + c1 cos t + s1 sin t + c2 cos 2t + s2 sin 2t.
    void expand(const Wave& q, double sign) {
        m_mean += sign * (q.k * q.k + 0.5 * (q.c * q.c + q.s * q.s));
        m_c1 += sign * 2 * q.k * q.c;
        m_s1 += sign * 2 * q.k * q.s;
        m_c2 += sign * 0.5 * (q.c * q.c - q.s * q.s);
        m_s2 += sign * q.c * q.s;
        // Rounding of the expansion.
        m_magnitude += 0x1p-48 * (q.k * q.k + q.c * q.c + q.s * q.s);
    }

    double value(const Direction& d) const { return m_f.at(d.cosine, d.sine); }
    double slope(const Direction& d) const {
        const auto half = [&](const Wave& q) { return q.at(d.cosine, d.sine) * q.slope(d.cosine, d.sine); };
        return 2 * (half(m_f.x) + half(m_f.y) + half(m_f.z) - half(m_f.w));
    }
    double second_derivative(const Direction& d) const {
        const double cosine2 = d.cosine * d.cosine - d.sine * d.sine, sine2 = 2 * d.cosine * d.sine;
        return -(m_c1 * d.cosine + m_s1 * d.sine) - 4 * (m_c2 * cosine2 + m_s2 * sine2);
    }

    /// Finds the sign changes within `radius` of `middle`.
    void interval(double middle, double radius, const Direction& at_middle, const Direction& at_begin,
                  const Direction& at_end) {
        const double f = value(at_middle), f1 = slope(at_middle);
        // Taylor's theorem about the middle bounds f and f'.
        const double bend = std::fabs(second_derivative(at_middle)) + m_third * radius + m_magnitude;
        const double swing = std::fabs(f1) * radius + 0.5 * bend * radius * radius;
        if (std::fabs(f) > swing || std::fabs(f) + swing < m_f.noise) return;
        if (std::fabs(f1) > bend * radius || radius < kLeastRadius) {
            const double begin = value(at_begin), end = value(at_end);
            if ((begin < 0) != (end < 0)) m_roots.add(polish(middle, radius, begin < 0, f, f1));
            return;
        }
        const double half = 0.5 * radius;
        interval(middle - half, half, Direction(middle - half), at_begin, at_middle);
        interval(middle + half, half, Direction(middle + half), at_middle, at_end);
    }

    /// Newton's method, kept inside a bracket in which f changes its sign once.
    double polish(double t, double radius, bool rising, double f, double f1) const {
        double low = t - radius, high = t + radius;
        for (int step = 0; step < 100; ++step) {
            ((f < 0) == rising ? low : high) = t;
            double next = t - f / f1;
            if (!(next > low && next < high)) next = 0.5 * (low + high);
            const double moved = std::fabs(next - t);
            t = next;
            if (moved <= 0x1p-52 * (1 + t)) break;
            const Direction d(t);
            f = value(d);
            f1 = slope(d);
        }
        return t;
    }

    const WaveSquares& m_f;
    Roots& m_roots;
    double m_mean = 0, m_c1 = 0, m_s1 = 0, m_c2 = 0, m_s2 = 0, m_magnitude = 0, m_third = 0;
};

}  // namespace

void add_roots(const WaveSquares& f, Roots& roots) {
    Search(f, roots).run();
}

void add_roots(const Wave& f, Roots& roots) {
    const double amplitude = f.amplitude();
    if (!(std::fabs(f.k) < amplitude)) return;
    // amplitude cos(t - peak) = -k.
    const double peak = std::atan2(f.s, f.c), away = std::acos(-f.k / amplitude);
    for (const double t : {peak - away, peak + away})
        roots.add(t < 0 ? t + kTurn : t >= kTurn ? t - kTurn : t);
}

}  // namespace anamorph
