// SPDX-License-Identifier: Apache-2.0
// The number a formula is read with to learn what rounding does to it.
//
// Rounded<Real> stands for all evaluations of a formula in Real (float, double or DoubleDouble) over a box: `range`
// encloses the exact values there, `error` bounds |computed - exact|. Each operation passes on its operands'
// errors by its own derivative, largest over the box, and adds its own rounding.
//
// With a radius it stands for jets too. Jet<Real, N> at a point of the box has the exact coefficients a_ij
// and computed ones; a_00 lies in `range`, the sum of the other |a_ij| is at most `radius`, and the sum of
// all |computed - exact| at most `error`. With |a| the sum of all |a_ij|, |a b| <= |a| |b|, so that jets can be
// bounded like numbers: a power series of a_00 + n has no larger norm than the series of magnitudes at
// |n| <= radius. What a recurrence of number/jet.h computes solves its equation up to a residual, which is
// kSum times what was summed up; the error is the residual times the inverse of what it is divided by.
//
// Angles are meant modulo a turn: where atan2 jumps by one, no error is counted.
//
// A bound that cannot be had is infinite or NaN: test !(error <= tol). What is exactly zero stays free of
// errors: zero times anything, and sums with it.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include "anamorph/number/arithmetic.h"
#include "anamorph/number/double_double.h"
#include "anamorph/number/hypot.h"
#include "anamorph/number/interval.h"

namespace anamorph {

template <class Real>
struct Rounded;

template <class Real>
double lower_end(const Rounded<Real>& a);

namespace rounded_detail {

template <class Real>
Rounded<Real> sum(const Rounded<Real>& a, const Rounded<Real>& b);
template <class Real>
Rounded<Real> product(const Rounded<Real>& a, const Rounded<Real>& b);
template <class Real>
Rounded<Real> quotient(const Rounded<Real>& f, const Rounded<Real>& g);

}  // namespace rounded_detail

template <class Real>
struct Rounded {
    static constexpr double kUnit = unit_roundoff<Real>();
    /// The largest error of libm's functions, relative to the value, as in number/interval.h.
    static constexpr double kLibm = 8 * kUnit;
    /// The largest error of an underflow. (That of the second part of a DoubleDouble is less.)
    static constexpr double kLeast =
        std::is_same_v<Real, float> ? double{std::numeric_limits<float>::min()} : interval_detail::kSmallest;
    /// The rounding of a coefficient relative to the sum of magnitudes of its products.
    ///
    /// Jets have degree 4 at most. The longest sum in a coefficient, that of s^2 t^2, has 9 products; on its
    /// way each meets a product's rounding, at most 4 sums in its part, a weight's and 5 sums of parts. Then
    /// follow a difference and two products at most.
    static constexpr double kSum = 16 * kUnit;
    static constexpr double kDegree = 4;

    Interval range;
    double radius = 0;
    double error = 0;

    Rounded() = default;
    Rounded(double value) : range(value) {}  // NOLINT: a number is one without error
    Rounded(const Interval& values, double spread, double bound)
        : range(values), radius(spread), error(bound) {}

    /// A constant that was rounded: `value` is off by at most `bound`.
    static Rounded near(double value, double bound) {
        return bound == 0 ? Rounded(value)
                          : Rounded(Interval(value - 2 * bound, value + 2 * bound), 0, bound);
    }

    /// The largest norm of the exact jets; computed_size() is that of the computed ones.
    double size() const { return magnitude(range) + radius; }
    double computed_size() const { return size() + error; }
    bool is_jet() const { return radius != 0; }
    bool is_zero() const { return range.lo == 0 && range.hi == 0 && radius == 0 && error == 0; }

    friend Rounded operator-(const Rounded& a) { return {-a.range, a.radius, a.error}; }
    friend Rounded operator+(const Rounded& a, const Rounded& b) { return rounded_detail::sum(a, b); }
    friend Rounded operator-(const Rounded& a, const Rounded& b) { return rounded_detail::sum(a, -b); }
    friend Rounded operator*(const Rounded& a, const Rounded& b) { return rounded_detail::product(a, b); }
    friend Rounded operator/(const Rounded& a, const Rounded& b) { return rounded_detail::quotient(a, b); }
};

namespace rounded_detail {

/// The sums and products that make up a bound are themselves rounded, fewer than 32 times, all of one sign.
inline constexpr double kUp = 1 + 64 * 0x1p-53;

/// The Rounded of the given exact values, computed with an error of `error` before it was rounded by `unit` of its size.
template <class Real>
Rounded<Real> result(const Interval& range, double radius, double error, double unit) {
    using R = Rounded<Real>;
    R r(range, radius * kUp, 0);
    const double rounding = unit * (r.size() + error);
    // Only what is 0 is free of errors: those of what is next to it may underflow themselves.
    const bool is_zero = r.size() == 0 && error == 0;
    r.error = is_zero ? 0 : (error + rounding) * kUp + R::kLeast;
    // Beyond double's range intervals are infinite by themselves.
    if (std::is_same_v<Real, float> && !(r.computed_size() < double{std::numeric_limits<float>::max()} / 4))
        r.error = HUGE_VAL;
    return r;
}

/// The least magnitude of a member of an interval.
inline double least_magnitude(const Interval& a) {
    return a.lo > 0 ? a.lo : a.hi < 0 ? -a.hi : 0;
}

/// The error that recurrences add to functions that solve E u = v E a, E v = -+ u E a, where E multiplies the part of
/// degree k by k. u and v are sums of exp(+-c a), c = 1 or i, each of norm at most exp(r) relative to its
/// constant part; the residual of the equations is kSum kDegree r exp(r) for each, and it is divided by u + c v
/// and multiplied by it again.
template <class Real>
double oscillation_error(double r) {
    using R = Rounded<Real>;
    const double grown = std::exp(r);
    return 2 * R::kSum * R::kDegree * r * grown * grown * grown;
}

template <class Real>
Rounded<Real> sum(const Rounded<Real>& a, const Rounded<Real>& b) {
    if (a.is_zero()) return b;
    if (b.is_zero()) return a;
    return result<Real>(a.range + b.range, a.radius + b.radius, a.error + b.error, Rounded<Real>::kUnit);
}
template <class Real>
Rounded<Real> product(const Rounded<Real>& a, const Rounded<Real>& b) {
    using R = Rounded<Real>;
    if (a.is_zero() || b.is_zero()) return R(0);
    const double in_a = magnitude(a.range), in_b = magnitude(b.range);
    // What is summed up are the products of magnitudes.
    const double unit = a.is_jet() && b.is_jet() ? R::kSum : R::kUnit;
    return result<Real>(a.range * b.range, a.radius * in_b + in_a * b.radius + a.radius * b.radius,
                        a.error * b.size() + b.error * a.size() + a.error * b.error +
                            unit * a.computed_size() * b.computed_size(),
                        0);
}
/// The quotient q of f = q g + residual.
template <class Real>
Rounded<Real> quotient(const Rounded<Real>& f, const Rounded<Real>& g) {
    using R = Rounded<Real>;
    // The norm of 1 / g.
    const double inverse = 1 / (least_magnitude(g.range) - g.radius);
    const double unit = f.is_jet() || g.is_jet() ? R::kSum : 2 * R::kUnit;
    const double feedback = inverse * (g.error + unit * g.computed_size());
    if (!(inverse > 0 && feedback < 0.5)) return R(Interval::all(), 0, HUGE_VAL);
    if (f.is_zero()) return f;
    const Interval range = f.range / g.range;
    const double radius = (f.radius + magnitude(range) * g.radius) * inverse;
    const double q = magnitude(range) + radius;
    const double error = (inverse * (f.error + unit * f.computed_size()) + feedback * q) / (1 - feedback);
    return result<Real>(range, radius, error, 0);
}

}  // namespace rounded_detail

template <class Real>
Rounded<Real> square(const Rounded<Real>& a) {
    Rounded<Real> r = a * a;
    r.range = square(a.range);
    return r;
}
/// The root r of r r = f + residual.
template <class Real>
Rounded<Real> sqrt(const Rounded<Real>& f) {
    using R = Rounded<Real>;
    if (f.is_zero()) return f;
    const Interval range = sqrt(f.range);
    if (!f.is_jet()) {
        // |sqrt a - sqrt b| <= |a - b| / sqrt a and <= sqrt |a - b|. Where nothing is negative a root of what
        // rounding made so is not asked for.
        const double by_slope = f.error / range.lo, by_root = std::sqrt(f.error);
        return rounded_detail::result<Real>(range, 0, by_slope < by_root ? by_slope : by_root, R::kUnit);
    }
    // sqrt(f_0 + n) is nearest to 0 where n = -radius: the constant part less the norm of the rest.
    const double least = std::sqrt(f.range.lo - f.radius) * (1 - 4 * interval_detail::kUlp);
    const double radius = range.lo - least + 4 * interval_detail::kUlp * range.hi;
    // |r|^2 <= 4 |f|, and two roots differ by the difference of their squares over their sum, which is at
    // least 1.5 `least` while that difference is below least^2 / 2.
    const double squares = f.error + 5 * R::kSum * f.computed_size();
    if (!(squares <= 0.5 * least * least)) return R(Interval::all(), 0, HUGE_VAL);
    return rounded_detail::result<Real>(range, radius, squares / (1.5 * least), 0);
}
template <class Real>
void sin_cos(const Rounded<Real>& a, Rounded<Real>& s, Rounded<Real>& c) {
    using R = Rounded<Real>;
    const double grown = std::exp(a.radius);
    double moved = a.error * grown * std::exp(a.error);
    if constexpr (std::is_same_v<Real, DoubleDouble>) {
        // Of larger angles the second part is not asked: then no more is known than that two sines differ by 2 at most.
        if (!(a.computed_size() <= Real::kLargestAngle)) moved += 2 * grown;
    }
    const double rest = grown - 1, recurrence = rounded_detail::oscillation_error<Real>(a.radius);
    const auto wave = [&](const Interval& values) {
        return rounded_detail::result<Real>(
            values, rest, moved + recurrence + R::kLibm * (a.is_jet() ? grown : magnitude(values)), 0);
    };
    s = a.is_zero() ? a : wave(sin(a.range));
    c = wave(cos(a.range));
}
/// Returns 1, and puts sinh(a) into `s`, both over cosh of a's constant part, as Jet has them.
template <class Real>
Rounded<Real> scaled_sinh(const Rounded<Real>& a, Rounded<Real>& s) {
    using R = Rounded<Real>;
    const double grown = std::exp(a.radius), moved = a.error * grown * std::exp(a.error);
    const Interval t = tanh(a.range), sech = Interval(1) / cosh(a.range);
    // Below this a number is computed that is as large instead.
    const double least = sech.lo < 2 * kLeastScale ? 2 * kLeastScale : 0;
    s = rounded_detail::result<Real>(t, grown - 1,
                                     moved + rounded_detail::oscillation_error<Real>(a.radius) +
                                         R::kLibm * (a.is_jet() ? grown : magnitude(t)),
                                     0);
    if (a.is_zero()) s = a;
    // |sech'| <= sech
    return rounded_detail::result<Real>(sech, 0, magnitude(sech) * (moved + R::kLibm) + least, 2 * R::kUnit);
}
/// The exponential g, by E g = g E a. |e^b - e^a| <= |e^a| (e^|b - a| - 1), and |e^n| <= e^|n|. The residual of the equation is
/// kSum kDegree r e^r; over e^a and times it again that is less than what two such equations add up to.
template <class Real>
Rounded<Real> exp(const Rounded<Real>& a) {
    using R = Rounded<Real>;
    const Interval range = exp(a.range);
    const double most = magnitude(range), grown = std::exp(a.radius);
    const double relative =
        grown * (std::expm1(a.error) + R::kLibm) + rounded_detail::oscillation_error<Real>(a.radius);
    return rounded_detail::result<Real>(range, most * (grown - 1), most * relative, 0);
}
/// The logarithm g, by E g = E a / a. For the constant parts, |log b - log a| <= |b - a| over the lesser of both.
template <class Real>
Rounded<Real> log(const Rounded<Real>& a) {
    using R = Rounded<Real>;
    const Interval range = log(a.range);
    const double least = lower_end(a);
    if (!(least > 0)) return R(range, a.is_jet() ? HUGE_VAL : 0, HUGE_VAL);
    double error = a.error / least + R::kLibm * magnitude(range);
    if (a.is_jet()) {
        const double steps = R::kDegree * (a.radius + a.error);
        error +=
            rounded_detail::quotient(R(Interval(0), steps, R::kDegree * a.error + R::kSum * steps), a).error;
    }
    return rounded_detail::result<Real>(range, a.radius / least, error, 0);
}
/// The inverse hyperbolic sine g, by sqrt(1 + a^2) E g = E a.
template <class Real>
Rounded<Real> asinh(const Rounded<Real>& a) {
    using R = Rounded<Real>;
    if (a.is_zero()) return a;
    // The largest norm of the derivative 1 / sqrt((1 + a_0^2) + (2 a_0 n + n^2)), errors and all.
    const double r = a.radius + a.error, most = magnitude(a.range);
    const double low = rounded_detail::least_magnitude(a.range);
    const double nearest = low > r ? low : most < r ? most : r;
    const double square_of_root = 1 + (nearest - r) * (nearest - r) - 2 * r * r;
    const Interval range = asinh(a.range);
    if (!(square_of_root > 0)) return R(range, HUGE_VAL, HUGE_VAL);
    const double slope = 1 / std::sqrt(square_of_root);
    double error = slope * a.error + R::kLibm * magnitude(range);
    if (a.is_jet()) {
        // E a is off by kDegree a.error, the root by its own error; the residual is that of the division.
        const R root = sqrt(square(a) + R(1));
        const double steps = R::kDegree * (a.radius + a.error);
        error += slope * (R::kDegree * a.error +
                          (R::kSum * (1 + slope * root.computed_size()) + slope * root.error) * steps);
    }
    return rounded_detail::result<Real>(range, slope * a.radius, error, 0);
}
/// The angle g of z = x + i y: g = Im log z, and z conj(z) E g = x E y - y E x.
template <class Real>
Rounded<Real> atan2(const Rounded<Real>& y, const Rounded<Real>& x) {
    using R = Rounded<Real>;
    constexpr double kHalfTurn = 3.1415926535897936;
    const Interval range = atan2(y.range, x.range);
    // Along the positive x axis, exactly.
    if (y.is_zero() && x.range.lo - x.error >= 0) return R(0);
    const double rest = x.radius + y.radius, moved = x.error + y.error;
    const double low = rounded_detail::least_magnitude(x.range),
                 high = rounded_detail::least_magnitude(y.range);
    // |log(z + d) - log z| <= |d| / (|z| - |d|)
    const double distance = hypot(low, high) * (1 - 4 * interval_detail::kUlp) - rest;
    const double turned = moved / (distance - moved);
    if (!(distance > moved)) {
        // No two angles are more than half a turn apart.
        return R(range, rest > 0 ? HUGE_VAL : 0, rest > 0 ? HUGE_VAL : kHalfTurn);
    }
    double error = turned + R::kLibm * magnitude(range);
    if (rest > 0) {
        // |1 / z| <= 1 / distance; |E g| <= kDegree rest / distance. The right side is summed up of 2 kDegree
        // |z| rest; |z|^2, from two squares, and its product with E g of as much times |z| / distance.
        const double ratio = (x.computed_size() + y.computed_size()) / (distance - moved);
        error += R::kDegree * (rest + moved) / (distance - moved) * 5 * R::kSum * ratio * ratio +
                 R::kDegree * turned * ratio;
    }
    // No more than half a turn, without derivatives.
    if (rest == 0 && error > kHalfTurn) error = kHalfTurn;
    return rounded_detail::result<Real>(range, rest / distance, error, 0);
}

template <class Real>
bool is_zero(const Rounded<Real>& a) {
    return a.is_zero();
}
/// The lower end of all exact and all computed values.
template <class Real>
double lower_end(const Rounded<Real>& a) {
    return a.range.lo - a.radius - a.error;
}
/// Are all exact and all computed values negative?
template <class Real>
Certainty is_negative(const Rounded<Real>& a) {
    const double off = a.radius + a.error;
    return is_negative(Interval(a.range.lo - off, a.range.hi + off));
}
template <class Real>
Rounded<Real> without_hair(const Rounded<Real>& a) {
    return {without_hair(a.range), a.radius, a.error};
}
template <class Real>
double enlarger(const Rounded<Real>& a, const Rounded<Real>& b) {
    return enlarger(a.computed_size(), b.computed_size());
}

namespace rounded_detail {
inline double larger(double a, double b) {
    return a >= b || std::isnan(a) ? a : b;
}
}  // namespace rounded_detail

/// Holds one of two numbers, which are the same where rounding decides between them.
template <class Real>
Rounded<Real> hull(const Rounded<Real>& a, const Rounded<Real>& b) {
    return {hull(a.range, b.range), rounded_detail::larger(a.radius, b.radius),
            rounded_detail::larger(a.error, b.error)};
}
/// The lesser of two numbers; its error is at most the larger of both errors.
template <class Real>
Rounded<Real> min(const Rounded<Real>& a, const Rounded<Real>& b) {
    Rounded<Real> r = hull(a, b);
    r.range = min(a.range, b.range);
    return r;
}
template <class Real>
Rounded<Real> max(const Rounded<Real>& a, const Rounded<Real>& b) {
    Rounded<Real> r = hull(a, b);
    r.range = max(a.range, b.range);
    return r;
}

/// The number, in formulas read with T, of a double that is at most `error` from the exact value.
template <class T>
auto measured(double value, double error) {
    if constexpr (requires { T::near(value, error); })
        return T::near(value, error);
    else
        return value;
}

/// A constant of a formula: a number known better than double holds it, for every number that formulas are
/// read with.
class Constant {
  public:
    Constant() = default;
    /// `value` has an error of at most `error`; the value 0 is taken to be exact.
    Constant(DoubleDouble value, double error)
        : m_precise(value),
          m_value(static_cast<double>(value)),
          m_precise_error(value == 0 ? 0 : error),
          m_error(value == 0 ? 0 : (error + 0x1p-53 * std::fabs(m_value)) * rounded_detail::kUp) {}
    /// A constant from a few operations and one function of libm in DoubleDouble: off by 32 units at most.
    explicit Constant(DoubleDouble value)
        : Constant(value, std::fabs(static_cast<double>(value)) * 32 * Rounded<DoubleDouble>::kUnit) {}

    double value() const { return m_value; }
    DoubleDouble precise() const { return m_precise; }

    /// The number that stands for the constant in a formula that is read with T.
    template <class T>
    auto as() const {
        if constexpr (std::is_same_v<T, DoubleDouble> || std::is_same_v<T, long double>)
            return static_cast<T>(m_precise);
        else if constexpr (std::is_same_v<T, Rounded<DoubleDouble>>) {
            // The double encloses; the DoubleDouble computes.
            T constant = T::near(m_value, m_error);
            constant.error = m_precise_error;
            return constant;
        } else
            return measured<T>(m_value, m_error);
    }

  private:
    DoubleDouble m_precise = 0;
    double m_value = 0, m_precise_error = 0, m_error = 0;
};

}  // namespace anamorph
