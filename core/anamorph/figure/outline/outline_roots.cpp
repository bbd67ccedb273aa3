// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/outline_roots.h"

#include <algorithm>
#include <array>

#include "anamorph/figure/body/rotation.h"

namespace anamorph::figure {
namespace {

constexpr int kIntervals = 8, kMostLevels = 40;

/// cos and sin of an angle of at most pi / 16, to rounding: their series to t^10 and t^11.
UnitVector small_angle(double t) {
    const double q = t * t;
    const double c =
        1 + q * (-1. / 2 + q * (1. / 24 + q * (-1. / 720 + q * (1. / 40320 + q * (-1. / 3628800)))));
    const double s =
        t *
        (1 + q * (-1. / 6 + q * (1. / 120 + q * (-1. / 5040 + q * (1. / 362880 + q * (-1. / 39916800))))));
    return {c, s};
}

struct Tables {
    /// Ends (even) and middles (odd) of the first intervals.
    std::array<UnitVector, 2 * kIntervals + 1> first;
    /// The turn from the middle of an interval of a level to that of its second half.
    std::array<UnitVector, kMostLevels> half;

    Tables() {
        for (std::size_t i = 0; i < first.size(); ++i) {
            const double t = kTurn * static_cast<double>(i % (2 * kIntervals)) / (2 * kIntervals);
            first[i] = {std::cos(t), std::sin(t)};
        }
        for (std::size_t i = 0; i < half.size(); ++i)
            half[i] = small_angle(std::ldexp(kTurn / (4 * kIntervals), -static_cast<int>(i)));
    }
};
const Tables kTables;

/// kZ, kW: are z and the waves of w there?
template <bool kZ, bool kW>
class Search {
  public:
    Search(const WaveSquares& f, Roots& roots) : m_f(f), m_roots(roots) {
        expand(f.x, 1);
        expand(f.y, 1);
        if (kZ) expand(f.z, 1);
        expand(f.w, -1);
    }

    void run() {
        const double first = std::sqrt(m_c1 * m_c1 + m_s1 * m_s1),
                     second = std::sqrt(m_c2 * m_c2 + m_s2 * m_s2);
        if (std::fabs(m_mean) > first + second + m_magnitude) return;
        // Bounds |f'''|.
        m_third = first + 8 * second;
        constexpr double radius = kTurn / (2 * kIntervals);
        for (int i = 0; i < kIntervals; ++i)
            interval(0, (2 * i + 1) * radius, radius, kTables.first[2 * i + 1], kTables.first[2 * i],
                     kTables.first[2 * i + 2]);
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

    struct Value {
        double f, slope;
    };
    Value value(const UnitVector& d) const {
        Value v{kW ? 0 : -m_f.w.k * m_f.w.k, 0};
        const auto add = [&](const Wave& q, double sign) {
            const double at = q.at(d);
            v.f += sign * at * at;
            v.slope += sign * 2 * at * q.slope(d);
        };
        add(m_f.x, 1);
        add(m_f.y, 1);
        if (kZ) add(m_f.z, 1);
        if (kW) add(m_f.w, -1);
        return v;
    }
    double second_derivative(const UnitVector& d) const {
        const double cosine2 = d.cosine * d.cosine - d.sine * d.sine, sine2 = 2 * d.cosine * d.sine;
        return -(m_c1 * d.cosine + m_s1 * d.sine) - 4 * (m_c2 * cosine2 + m_s2 * sine2);
    }

    /// Finds the sign changes within `radius` of `middle`.
    void interval(int level, double middle, double radius, const UnitVector& at_middle,
                  const UnitVector& at_begin, const UnitVector& at_end) {
        const auto [f, slope] = value(at_middle);
        // Taylor's theorem about the middle bounds f and f'.
        const double bend = std::fabs(second_derivative(at_middle)) + m_third * radius + m_magnitude;
        const double swing = std::fabs(slope) * radius + 0.5 * bend * radius * radius;
        if (!(std::fabs(f) <= swing) || std::fabs(f) + swing < m_f.noise) return;
        if (std::fabs(slope) > bend * radius || level == kMostLevels) {
            const double begin = value(at_begin).f, end = value(at_end).f;
            if ((begin < 0) != (end < 0)) m_roots.add(polish(middle, radius, begin < 0, {f, slope}, bend));
            return;
        }
        const double half = 0.5 * radius;
        const UnitVector step = kTables.half[static_cast<std::size_t>(level)];
        interval(level + 1, middle - half, half, at_middle.turned({step.cosine, -step.sine}), at_begin,
                 at_middle);
        interval(level + 1, middle + half, half, at_middle.turned(step), at_middle, at_end);
    }

    /// Newton's method, kept inside a bracket in which f changes its sign once.
    double polish(double t, double radius, bool rising, Value v, double bend) const {
        double low = t - radius, high = t + radius;
        for (int step = 0; step < 60; ++step) {
            ((v.f < 0) == rising ? low : high) = t;
            double next = t - v.f / v.slope;
            const bool inside = next >= low && next <= high;
            if (!inside) next = 0.5 * (low + high);
            const double moved = next - t;
            t = next;
            // What a step leaves is its square times f'' / 2 f'.
            const bool small = moved * moved * bend <= 0x1p-52 * std::fabs(v.slope);
            if ((inside && small) || high - low < 0x1p-50) break;
            v = value(direction(t));
            if (std::fabs(v.f) <= m_f.noise * 0x1p-6) break;
        }
        return t;
    }

    const WaveSquares& m_f;
    Roots& m_roots;
    double m_mean = 0, m_c1 = 0, m_s1 = 0, m_c2 = 0, m_s2 = 0, m_magnitude = 0, m_third = 0;
};

}  // namespace

UnitVector direction(double t) {
    // NOLINTNEXTLINE(bugprone-incorrect-roundings): t is not negative.
    const int steps = static_cast<int>(t * (2 * kIntervals / kTurn) + 0.5);
    const UnitVector& nearest = kTables.first[static_cast<std::size_t>(steps % (2 * kIntervals))];
    return nearest.turned(small_angle(t - steps * (kTurn / (2 * kIntervals))));
}

void add_roots(const WaveSquares& f, Roots& roots) {
    const bool has_z = f.z.k != 0 || f.z.c != 0 || f.z.s != 0, has_w = f.w.c != 0 || f.w.s != 0;
    if (has_z && has_w)
        Search<true, true>(f, roots).run();
    else if (has_z)
        Search<true, false>(f, roots).run();
    else if (has_w)
        Search<false, true>(f, roots).run();
    else
        Search<false, false>(f, roots).run();
}

void add_roots(const Wave& f, Roots& roots) {
    const double amplitude = f.amplitude();
    if (!(std::fabs(f.k) < amplitude)) return;
    // amplitude cos(t - peak) = -k.
    const double peak = std::atan2(f.s, f.c), away = std::acos(-f.k / amplitude);
    for (const double t : {peak - away, peak + away})
        roots.add(t < 0 ? t + kTurn : t >= kTurn ? t - kTurn : t);
}

}  // namespace anamorph::figure
