// SPDX-License-Identifier: Apache-2.0
// Numbers near a known one (number/near.h) as they are read before a block is drawn: their bases, written down, and what
// float or double makes of the rests, bounded over all of the block's pixels.
#pragma once

#include <algorithm>
#include <numbers>
#include <vector>

#include "anamorph/number/reading_order.h"
#include "anamorph/number/rounded.h"
#include "anamorph/number/sinc_series.h"

namespace anamorph {

struct Heading;  // chart/projection/facts.h

#if defined(ANAMORPH_SANITIZED) || defined(ANAMORPH_NEAR_CALLS)
#define ANAMORPH_INLINE inline
#else
// Inlines an operation: as calls, operations would take twice as long.
#define ANAMORPH_INLINE __attribute__((always_inline)) inline
#endif
#include "anamorph/number/hypot.h"
#include "anamorph/number/near.h"

// --- rests ---

/// Bounds the rests of all pixels of a block: the exact ones lie within `radius` of `middle`, and those that are computed in
/// Real, float or double, lie within `error` of them. Errors are propagated as by Rounded. A bound that cannot be found is
/// infinite or NaN: test !(error <= tol).
template <class Real>
struct RestBound {
    using R = Rounded<Real>;
    static constexpr double kUnit = R::kUnit;

    double middle = 0, radius = 0, error = 0;

    RestBound() = default;
    explicit RestBound(double exact) : middle(exact) {}
    RestBound(double about, double spread, double bound) : middle(about), radius(spread), error(bound) {}

    static RestBound unbounded() { return {0, HUGE_VAL, HUGE_VAL}; }
    /// The bound of values with an error of `bound` before they are rounded by `unit` of their size. The middle is rounded,
    /// too, and so are the sums and products of which the others are made, fewer than 32 times, all of one sign.
    static ANAMORPH_INLINE RestBound result(double middle, double radius, double bound, double unit) {
        RestBound r{middle, radius + 0x1p-53 * std::fabs(middle), 0};
        r.radius = r.radius * rounded_detail::kUp + interval_detail::kSmallest;
        r.error = (bound + unit * (r.size() + bound)) * rounded_detail::kUp + R::kLeast;
        if (std::is_same_v<Real, float> &&
            !(r.computed_size() < double{std::numeric_limits<float>::max()} / 4))
            r.error = HUGE_VAL;
        return r;
    }
    /// The bound of a function of libm whose slope is at most 1, with this value at a.middle, which mostly is 0 there.
    static RestBound of_function(const RestBound& a, double (*function)(double), double unit) {
        const double middle = a.middle == 0 ? 0 : function(a.middle);
        return result(middle, a.radius + interval_detail::kLibmMargin * std::fabs(middle), a.error, unit);
    }

    /// The largest magnitude of the exact rests; computed_size() is that of the computed ones.
    double size() const { return std::fabs(middle) + radius; }
    double computed_size() const { return size() + error; }

    friend ANAMORPH_INLINE RestBound operator-(const RestBound& a) { return {-a.middle, a.radius, a.error}; }
    friend ANAMORPH_INLINE RestBound operator+(const RestBound& a, const RestBound& b) {
        return result(a.middle + b.middle, a.radius + b.radius, a.error + b.error, kUnit);
    }
    friend ANAMORPH_INLINE RestBound operator-(const RestBound& a, const RestBound& b) { return a + -b; }
    friend ANAMORPH_INLINE RestBound operator*(const RestBound& a, const RestBound& b) {
        const double in_a = a.size(), in_b = b.size();
        return result(a.middle * b.middle, std::fabs(a.middle) * b.radius + a.radius * in_b,
                      a.error * in_b + b.error * in_a + a.error * b.error +
                          kUnit * a.computed_size() * b.computed_size(),
                      0);
    }
    /// The quotient: F / G - q = (F - q G) / G, and f - q g is a rounding of f; errors are those of Rounded.
    friend ANAMORPH_INLINE RestBound operator/(const RestBound& f, const RestBound& g) {
        const double inverse = 1 / (std::fabs(g.middle) - g.radius);
        const double feedback = inverse * (g.error + 2 * kUnit * g.computed_size());
        if (!(inverse > 0 && feedback < 0.5)) return unbounded();
        const double quotient = f.middle / g.middle, q = std::fabs(quotient);
        const double spread = inverse * (f.radius + q * g.radius + 0x1p-52 * std::fabs(f.middle));
        const double bound =
            (inverse * (f.error + 2 * kUnit * f.computed_size()) + feedback * (q + spread)) / (1 - feedback);
        return result(quotient, spread, bound, 0);
    }
    /// The root: sqrt F - sqrt f = (F - f) / (sqrt F + sqrt f).
    friend ANAMORPH_INLINE RestBound sqrt(const RestBound& f) {
        const double low = f.middle - f.radius;
        if (!(low > f.error)) return unbounded();
        const double least = std::sqrt(low), root = std::sqrt(f.middle);
        return result(root, f.radius / (least + root), f.error / least, kUnit);
    }
    /// The root of the sum of squares, whose slopes are at most 1. Squares of less than kTiny may underflow, none of less
    /// than its inverse overflows.
    friend ANAMORPH_INLINE RestBound length(const RestBound& a, const RestBound& b) {
        constexpr double kTiny = std::is_same_v<Real, float> ? 0x1p-60 : 0x1p-500;
        // In double squares underflow as well: their root is off by less than that.
        constexpr double kLost = 0x1p-500;
        const auto root = [](double x, double y) { return std::sqrt(x * x + y * y); };
        const double least = root(std::max(std::fabs(a.middle) - a.radius, 0.0),
                                  std::max(std::fabs(b.middle) - b.radius, 0.0));
        const double most = root(a.size(), b.size()), about = root(a.middle, b.middle);
        if (!(most + a.error + b.error < 1 / kTiny)) return unbounded();
        const double spread =
            std::max(most - about, about - least) + 4 * interval_detail::kLibmMargin * most + kLost;
        return result(about, spread, root(a.error, b.error) * rounded_detail::kUp + kTiny, 3 * kUnit);
    }
    friend ANAMORPH_INLINE RestBound asinh(const RestBound& a) {
        return of_function(a, std::asinh, R::kLibm);
    }
    /// Writes tanh a into s and returns 1 / cosh a, whose slope is at most |a|.
    friend ANAMORPH_INLINE RestBound scaled_sinh(const RestBound& a, RestBound& s) {
        if (!(a.computed_size() <= 1)) return s = unbounded();
        s = of_function(a, std::tanh, R::kLibm);
        const double secant = a.middle == 0 ? 1 : 1 / std::cosh(a.middle);
        return result(secant, a.size() * a.radius + interval_detail::kLibmMargin, a.error + R::kLibm,
                      2 * kUnit);
    }
    friend Certainty is_negative(const RestBound& a) {
        const double off = a.radius + a.error;
        return is_negative(Interval(a.middle - off, a.middle + off));
    }
    /// Is the rest zero in all of the block, as that of a constant is?
    friend bool is_zero(const RestBound& a) { return a.computed_size() == 0; }
    /// Encloses a choice between two rests, which are the same where rounding decides between them.
    friend ANAMORPH_INLINE RestBound hull(const RestBound& a, const RestBound& b) {
        const double between = 0.5 * (a.middle + b.middle), apart = 0.5 * std::fabs(a.middle - b.middle);
        return result(between, apart + rounded_detail::larger(a.radius, b.radius),
                      rounded_detail::larger(a.error, b.error), 0);
    }
};

namespace rounded_detail {

/// The errors of the functions of rests in lanes.h, in units of Real of the value.
inline constexpr double kRestUnits = 4, kAngleUnits = 6, kTurnUnits = 5;
inline constexpr double kEighth = 0.785398163397448, kTangentOfSixteenth = 0.414213562373095,
                        kTangentOfThreeSixteenths = 2.414213562373095;

}  // namespace rounded_detail

/// Bounds sin a and 1 - cos a for |a| <= pi / 4; unbounded beyond.
template <class Real>
void sine_versine(const RestBound<Real>& a, RestBound<Real>& s, RestBound<Real>& v) {
    const double most = a.computed_size();
    if (!(most <= rounded_detail::kEighth)) {
        s = v = RestBound<Real>::unbounded();
        return;
    }
    // The slope of 1 - cos is at most |a|; it is 2 sin^2(a / 2), and at most half of a^2.
    const double unit = rounded_detail::kRestUnits * RestBound<Real>::kUnit, size = a.size();
    s = RestBound<Real>::of_function(a, std::sin, unit);
    const double half_sine = a.middle == 0 ? 0 : std::sin(0.5 * a.middle), middle = 2 * half_sine * half_sine;
    const double radius = a.middle == 0 ? 0.5 * size * size : size * a.radius;
    v = RestBound<Real>::result(middle, radius + 4 * interval_detail::kLibmMargin * middle, a.error * most,
                                unit);
}
/// Bounds the angle of (x, y) as small_angle() in lanes.h computes it; unbounded beyond |y| <= tan(3 pi / 8) x, also where x
/// may be negative, exact or computed.
template <class Real>
RestBound<Real> small_angle(const RestBound<Real>& y, const RestBound<Real>& x) {
    const RestBound<Real> a = y / x;
    const bool ahead = x.middle - x.radius > x.error;
    const double most = a.computed_size();
    if (!(ahead && most <= rounded_detail::kTangentOfThreeSixteenths)) return RestBound<Real>::unbounded();
    const double units =
        most < rounded_detail::kTangentOfSixteenth ? rounded_detail::kRestUnits : rounded_detail::kAngleUnits;
    return RestBound<Real>::of_function(a, std::atan, units * RestBound<Real>::kUnit);
}

/// Bounds the angle of (x, y) as atan2() in lanes.h computes it; unbounded where points, exact or computed, may lie on the
/// negative x axis.
template <class Real>
RestBound<Real> any_angle(const RestBound<Real>& y, const RestBound<Real>& x) {
    const double left = x.middle - x.radius, top = y.middle - y.radius, bottom = y.middle + y.radius;
    if (!(left > x.error || top > y.error || -bottom > y.error)) return RestBound<Real>::unbounded();
    // Points that are off by less than their distance from the centre are seen from there within the quotient.
    const double off = hypot(x.error, y.error);
    const double nearest = hypot(std::max(left, 0.0), std::max({top, -bottom, 0.0}));
    const double apart = nearest * (1 - 0x1p-50) - off;
    if (!(apart > 0)) return RestBound<Real>::unbounded();
    const double middle = y.middle == 0 && x.middle > 0 ? 0 : std::atan2(y.middle, x.middle);
    double radius = 0;
    for (const double corner_x : {left, x.middle + x.radius})
        for (const double corner_y : {top, bottom})
            radius = std::max(radius, std::fabs(std::atan2(corner_y, corner_x) - middle));
    return RestBound<Real>::result(middle, radius + 2 * interval_detail::kLibmMargin * std::numbers::pi,
                                   off / apart, rounded_detail::kTurnUnits * RestBound<Real>::kUnit);
}

// --- bases ---

/// The bases that evaluations of a formula have written, in order.
using Bases = std::vector<double>;

/// The list to which bases are appended, and a checksum of their order.
struct BaseWriter {
    Bases& bases;
    ReadingOrder order;
};

/// A base in double that is recorded: the result of every operation is appended to the list that WrittenBase::to points to;
/// decisions as 1 or 0.
struct WrittenBase {
    using Number = ReadingOrder::Number;

    static inline thread_local BaseWriter* to = nullptr;

    double value = 0;
    Number number = 0;  ///< number of the operation whose result it is; 0 for a constant

    WrittenBase() = default;
    WrittenBase(double k) : value(k) {}  // NOLINT: a number is a constant
    WrittenBase(double result, Number of) : value(result), number(of) {}

    /// The result of a condition.
    struct Decision {
        bool holds;
        Number number;

        friend Decision both(const Decision& a, const Decision& b) {
            return {a.holds && b.holds, next(BaseOperation::both, a.number, b.number)};
        }
    };

    static ANAMORPH_INLINE Number next(BaseOperation operation, Number a, Number b = 0, Number c = 0) {
        return to->order.next(operation, a, b, c);
    }
    static ANAMORPH_INLINE WrittenBase written(double value, BaseOperation operation, Number a,
                                               Number b = 0) {
        to->bases.push_back(value);
        return {value, next(operation, a, b)};
    }
    static Decision written_decision(bool holds, BaseOperation operation, Number a) {
        to->bases.push_back(holds ? 1.0 : 0.0);
        return {holds, next(operation, a)};
    }
    static WrittenBase input(double value) { return written(value, BaseOperation::input, 0); }

    friend WrittenBase operator-(const WrittenBase& a) {
        return written(-a.value, BaseOperation::negation, a.number);
    }
    friend WrittenBase operator+(const WrittenBase& a, const WrittenBase& b) {
        return written(a.value + b.value, BaseOperation::sum, a.number, b.number);
    }
    friend WrittenBase operator-(const WrittenBase& a, const WrittenBase& b) {
        return written(a.value - b.value, BaseOperation::difference, a.number, b.number);
    }
    friend WrittenBase operator*(const WrittenBase& a, const WrittenBase& b) {
        return written(a.value * b.value, BaseOperation::product, a.number, b.number);
    }
    friend WrittenBase operator/(const WrittenBase& a, const WrittenBase& b) {
        return written(a.value / b.value, BaseOperation::quotient, a.number, b.number);
    }
    friend WrittenBase sqrt(const WrittenBase& a) {
        return written(std::sqrt(a.value), BaseOperation::root, a.number);
    }
    friend void sin_cos(const WrittenBase& a, WrittenBase& s, WrittenBase& c) {
        const Number of = a.number;
        const double angle = a.value;
        s = written(std::sin(angle), BaseOperation::sine_and_cosine, of);
        c = written(std::cos(angle), BaseOperation::sine_and_cosine, of);
    }
    friend WrittenBase atan2(const WrittenBase& y, const WrittenBase& x) {
        return written(std::atan2(y.value, x.value), BaseOperation::angle, y.number, x.number);
    }
    friend WrittenBase asinh(const WrittenBase& a) {
        return written(std::asinh(a.value), BaseOperation::area_sine, a.number);
    }
    friend WrittenBase scaled_sinh(const WrittenBase& a, WrittenBase& s) {
        const Number of = a.number;
        double t = 0;
        const double c = scaled_sinh(a.value, t);
        s = written(t, BaseOperation::scaled_sine, of);
        return written(c, BaseOperation::scaled_sine, of);
    }
    /// Finds the first coefficients of the series of sin t / t and cos t in powers of t^2, about t^2 = a; NaN for a > 10.
    template <std::size_t N>
    friend void sinc_cos_series(const WrittenBase& a, WrittenBase (&s)[N], WrittenBase (&c)[N]) {
        double sinc[N], cosine[N];
        sinc_cos_series(a.value, sinc, cosine);
        for (std::size_t k = 0; k < N; ++k) {
            s[k] = written(sinc[k], BaseOperation::sinc_and_cosine, a.number);
            c[k] = written(cosine[k], BaseOperation::sinc_and_cosine, a.number);
        }
    }
    friend Decision is_negative(const WrittenBase& a) {
        return written_decision(a.value < 0, BaseOperation::is_negative, a.number);
    }
    friend Decision is_zero(const WrittenBase& a) {
        return written_decision(a.value == 0, BaseOperation::is_zero, a.number);
    }
};

template <class Real>
struct NearRest<WrittenBase, RestBound<Real>> {
    using R = RestBound<Real>;
    static constexpr int kSincDegree = sinc_degree<Real>;

    static ANAMORPH_INLINE R of(const WrittenBase& base) {
        const bool kept = static_cast<double>(static_cast<Real>(base.value)) == base.value;
        return kept ? R(base.value) : R::result(base.value, 0, 0, R::kUnit);
    }
    /// Adds the rounding of a base to the errors of a rest. Bases are not known better than to the least scale, which is above
    /// what underflows.
    static ANAMORPH_INLINE R off(const R& rest, const WrittenBase& base, double units) {
        const double by = units * (0x1p-53 * std::fabs(base.value) + kLeastScale);
        return {rest.middle, (rest.radius + by) * rounded_detail::kUp,
                (rest.error + by) * rounded_detail::kUp};
    }
    static R left_out(const R& rest, const R& d, double factor) {
        const double by = factor * d.size();
        return {rest.middle, (rest.radius + by) * rounded_detail::kUp,
                (rest.error + by) * rounded_detail::kUp};
    }
    static R within(const R& rest, const R& other) {
        return other.radius < rest.radius ? R{other.middle, other.radius, rest.error} : rest;
    }
    /// Bounds the angle of (x, y), and writes down which way it is found: most angles are small.
    static R angle(const R& y, const R& x) {
        const R small = small_angle(y, x);
        const auto is_small =
            WrittenBase::written_decision(small.error < HUGE_VAL, BaseOperation::is_small_angle, 0);
        return is_small.holds ? small : any_angle(y, x);
    }
    static Near<WrittenBase, R> near(double value, double error) {
        return {WrittenBase(value), R(0, error, error)};
    }
    static WrittenBase choose(const WrittenBase::Decision& condition, const WrittenBase& a,
                              const WrittenBase& b) {
        return {condition.holds ? a.value : b.value,
                WrittenBase::next(BaseOperation::choice, condition.number, a.number, b.number)};
    }
    static R choose(const WrittenBase::Decision& condition, const R& a, const R& b) {
        return condition.holds ? a : b;
    }
};

/// The number that writes down the bases of a formula, and bounds its rounding in Real near them.
template <class Real>
using NearBound = Near<WrittenBase, RestBound<Real>>;
// Without it, measured() would leave the errors of constants out.
static_assert(
    requires { NearBound<float>::near(1.0, 0.5); } && requires { NearBound<double>::near(1.0, 0.5); });

#undef ANAMORPH_INLINE

}  // namespace anamorph
