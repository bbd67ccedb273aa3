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

/// mean + c1 cos t + s1 sin t + c2 cos 2t + s2 sin 2t
struct Harmonics {
    double mean, c1, s1, c2, s2;
};

/// f as a product: on the unit circle f is a conic, to which any multiple of the circle's own may be added, and one of these sums is two
/// straight lines. Where f is zero one of them crosses the circle.
///
/// What is found is certified by what it leaves of f, whichever way it was found. Let f = L M + R with waves L and M, |R| <= rest; let l
/// and m be the amplitudes of L and M. About a zero of L at which L has the slope g, and |M| = n, take a zone of the radius
/// d = 8 rest / (n g), and let l d <= g / 4 and m d <= n / 4. As rest counts rounding, that puts the zero off by less than d / 4. So in the
/// zone |M| >= 5 n / 8 and |L'| >= 5 g / 8, and at its ends |L M| >= 3/4 d 5/8 g 5/8 n > rest, with the signs that L M has: f has a zero in
/// it. Zones do not meet: zeros of M are n / m >= 4 d away, and those of L at least 2 g / l >= 8 d. So, f having four zeros at most,
/// - four zones hold one each, and there are no others;
/// - where M does not cross the circle, and n is its least value, there is no zero but in the two zones of L, outside of which
///   |L| > 3/4 d 5/8 g. They hold one each, as f' has no zero there: |L' M| >= 5/8 g n is more than
///   |L M'| + |R'| <= 5/4 d 5/4 g m + 2 rest <= 25/64 g n + 4/64 g n. R has two harmonics, and d <= 1 / 4.
/// Where neither crosses the circle, f has no zero if the product of the least values is more than rest.
class LinePair {
  public:
    /// A zero of f: the only one within `radius` of `at`.
    struct Zero {
        UnitVector at;
        double radius;
        bool rising;
    };

    /// `second`: the amplitude of 2t. `noise`: how far f may be off.
    LinePair(const Harmonics& f, double second, double noise) {
        split(f, second);
        const double rest = rest_of(f) + noise;
        const Line& a = m_lines[0];
        const Line& b = m_lines[1];
        if (!a.crosses() && !b.crosses())
            m_certified = a.least() * b.least() > rest;
        else
            m_certified = (!a.crosses() || add_zeros(a, b, rest)) && (!b.crosses() || add_zeros(b, a, rest));
    }

    bool certified() const { return m_certified; }
    int count() const { return m_count; }
    const Zero& zero(int i) const { return m_zeros[static_cast<std::size_t>(i)]; }

  private:
    struct Line {
        Wave wave;
        double square = 0, amplitude = 0;

        void set(double k, double c, double s) {
            wave = {k, c, s};
            square = c * c + s * s;
            amplitude = std::sqrt(square);
        }
        bool crosses() const { return std::fabs(wave.k) < amplitude; }
        /// The least absolute value on the circle, of a line that does not cross it.
        double least() const { return std::fabs(wave.k) - amplitude; }
        double size() const { return std::fabs(wave.k) + std::fabs(wave.c) + std::fabs(wave.s); }
    };

    /// Finds the lines. In the axes in which f = mean + a cos t + b sin t + r cos 2t, adding r x times the circle's own conic makes them
    ///     p cos t + q sin t + k and p cos t - q sin t + l,  p^2 = r (1 + x), q^2 = r (1 - x),
    ///     p (k + l) = a, q (l - k) = b, k l = mean - r x,
    /// if x is a zero of (x - mean / r)(x^2 - 1) + A (x - 1) + B (x + 1), with 4 r^2 A = a^2 and 4 r^2 B = b^2: from -1 to 1 one lies.
    void split(const Harmonics& f, double r) {
        if (!(r > 0x1p-40 * (std::fabs(f.c1) + std::fabs(f.s1)))) {
            m_lines[0].set(f.mean, f.c1, f.s1);
            m_lines[1].set(1, 0, 0);
            return;
        }
        // Half of the angle of (c2, s2).
        const double scale = 1 / r;
        double turn_c = std::sqrt(0.5 * (1 + std::fabs(f.c2) * scale)), turn_s = 0.5 * f.s2 * scale / turn_c;
        if (f.c2 < 0) {
            const double major = std::copysign(turn_c, f.s2);
            turn_c = std::fabs(turn_s);
            turn_s = major;
        }
        const double a = f.c1 * turn_c + f.s1 * turn_s, b = f.s1 * turn_c - f.c1 * turn_s;
        const double half_a = 0.5 * a * scale, half_b = 0.5 * b * scale;
        const double x = zero_of_cubic(f.mean * scale, half_a * half_a, half_b * half_b);
        const double p = std::sqrt(r * std::max(1 + x, 0.0)), q = std::sqrt(r * std::max(1 - x, 0.0));
        const double product = f.mean - r * x;
        double sum, difference;
        if (p < q) {
            difference = b / q;
            sum = p * p > 0x1p-6 * r
                      ? a / p
                      : std::copysign(std::sqrt(std::max(difference * difference + 4 * product, 0.0)), a);
        } else {
            sum = a / p;
            difference = q * q > 0x1p-6 * r
                             ? b / q
                             : std::copysign(std::sqrt(std::max(sum * sum - 4 * product, 0.0)), b);
        }
        const double pc = p * turn_c, ps = p * turn_s, qc = q * turn_c, qs = q * turn_s;
        m_lines[0].set(0.5 * (sum - difference), pc - qs, ps + qc);
        m_lines[1].set(0.5 * (sum + difference), pc + qs, ps - qc);
    }

    /// The zero of h = (x - m)(x^2 - 1) + A (x - 1) + B (x + 1) from -1, where h = -2 A, to 1, where h = 2 B. It is concave up to m / 3 and
    /// convex from there: Newton's method from the end of the part that holds the zero comes nearer with each step.
    static double zero_of_cubic(double m, double a, double b) {
        constexpr int kMostSteps = 40;
        const auto h = [&](double x) { return (x - m) * (x * x - 1) + a * (x - 1) + b * (x + 1); };
        double x = m >= 3 || (m > -3 && h(m / 3) >= 0) ? -1 : 1;
        for (int i = 0; i < kMostSteps; ++i) {
            const double step = h(x) / ((3 * x - 2 * m) * x - 1 + a + b);
            x -= step;
            if (!(std::fabs(step) > 0x1p-26)) break;
        }
        return std::clamp(x, -1.0, 1.0);
    }

    /// How far the product of the lines is from f, at most, and how far rounding may have put that off.
    double rest_of(const Harmonics& f) const {
        const Wave &a = m_lines[0].wave, &b = m_lines[1].wave;
        const double cc = a.c * b.c, ss = a.s * b.s;
        return std::fabs(f.mean - (a.k * b.k + 0.5 * (cc + ss))) + std::fabs(f.c1 - (a.k * b.c + a.c * b.k)) +
               std::fabs(f.s1 - (a.k * b.s + a.s * b.k)) + std::fabs(f.c2 - 0.5 * (cc - ss)) +
               std::fabs(f.s2 - 0.5 * (a.c * b.s + a.s * b.c)) +
               0x1p-47 * m_lines[0].size() * m_lines[1].size();
    }

    /// Adds both zeros of a line; false where they are not certain.
    bool add_zeros(const Line& line, const Line& other, double rest) {
        const Wave& w = line.wave;
        const double slope = std::sqrt(line.square - w.k * w.k), scale = 1 / line.square;
        for (const double side : {slope, -slope}) {
            // The foot on the line and half of its chord.
            const UnitVector at{(-w.k * w.c - side * w.s) * scale, (-w.k * w.s + side * w.c) * scale};
            const double there = other.wave.at(at),
                         least = other.crosses() ? std::fabs(there) : other.least();
            const double radius = 8 * rest / (least * slope);
            if (!(line.amplitude * radius <= 0.25 * slope && other.amplitude * radius <= 0.25 * least))
                return false;
            m_zeros[static_cast<std::size_t>(m_count++)] = {at, radius, (side < 0) == (there > 0)};
        }
        return true;
    }

    std::array<Line, 2> m_lines;
    std::array<Zero, 4> m_zeros;
    int m_count = 0;
    bool m_certified = false;
};

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
        const LinePair lines({m_mean, m_c1, m_s1, m_c2, m_s2}, second, m_magnitude + m_f.noise);
        if (lines.certified()) return add_certified(lines);
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

    void add_certified(const LinePair& lines) {
        for (int i = 0; i < lines.count(); ++i) {
            const LinePair::Zero& zero = lines.zero(i);
            const double t = in_turn(std::atan2(zero.at.sine, zero.at.cosine));
            const UnitVector d = direction(t);
            const double bend = std::fabs(second_derivative(d)) + m_third * zero.radius + m_magnitude;
            m_roots.add(in_turn(polish(t, zero.radius, zero.rising, value(d), bend)));
        }
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
