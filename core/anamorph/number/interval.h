// SPDX-License-Identifier: Apache-2.0
// Interval arithmetic over double: every operation encloses the exact result of its operands' members.
//
// Rounding: the hardware rounds the four operations and sqrt to nearest, half a ULP off at most. A ULP of v
// is at most kUlp |v|, so that an end moved by kUlp of its own magnitude, itself rounded, lies at least one
// ULP further out: beyond the exact value. Other functions are libm's, taken to be within kLibmError of the
// value (glibc states 2 ULP for the worst of them; tests/core holds it against long double) and widened by
// twice that, which covers the rounding of the widening. Monotone functions of libm are read at both ends;
// what libm may lack in monotony is less than its error.
//
// Underflow: a product, a quotient or a function below kSmallest is off by kSmallest at most, also where the
// processor takes what is smaller for zero, and is widened by as much. Sums do not underflow, and an exact
// zero stays one.
//
// An operation without a bounded result (division by an interval that holds zero, the root or the logarithm
// of a negative number) gives [-inf, inf] or NaN ends; every test on a bound is written !(bound <= tol).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "anamorph/number/number.h"

namespace anamorph {

/// A closed interval of real numbers, from lo to hi.
struct Interval {
    double lo = 0;
    double hi = 0;

    constexpr Interval() = default;
    constexpr Interval(double value) : lo(value), hi(value) {}  // NOLINT: a number is an interval
    constexpr Interval(double low, double high) : lo(low), hi(high) {}

    static constexpr Interval all() {
        return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    }
    constexpr bool contains(double value) const { return lo <= value && value <= hi; }
};

inline bool operator==(const Interval& a, const Interval& b) {
    return a.lo == b.lo && a.hi == b.hi;
}
/// Is a < b for all members of both? Neither a < b nor b <= a need hold.
inline bool operator<(const Interval& a, const Interval& b) {
    return a.hi < b.lo;
}
inline bool operator<=(const Interval& a, const Interval& b) {
    return a.hi <= b.lo;
}
inline bool operator>(const Interval& a, const Interval& b) {
    return b < a;
}
inline bool operator>=(const Interval& a, const Interval& b) {
    return b <= a;
}

namespace interval_detail {

/// The largest spacing of doubles, relative to their magnitude; the smallest is half of it.
inline constexpr double kUlp = std::numeric_limits<double>::epsilon();
/// The largest error of libm's functions, relative to the value.
inline constexpr double kLibmError = 4 * kUlp;
inline constexpr double kLibmMargin = 2 * kLibmError;
/// The smallest normal number.
inline constexpr double kSmallest = std::numeric_limits<double>::min();
inline constexpr double kLargest = std::numeric_limits<double>::max();

/// Widens [lo, hi] by `relative` of each end's magnitude. An end of exactly 0 stays.
inline Interval widen(double lo, double hi, double relative = kUlp) {
    return {lo - std::fabs(lo) * relative, hi + std::fabs(hi) * relative};
}

/// May an end of the interval have lost digits to underflow?
inline bool underflows(const Interval& a) {
    return std::fabs(a.lo) < 4 * kSmallest || std::fabs(a.hi) < 4 * kSmallest;
}

/// Encloses the values of a function of libm that is 0 only where its argument is, given those that libm returns.
inline Interval libm(double lo, double hi) {
    Interval r = widen(lo, hi, kLibmMargin);
    if (underflows(r)) {
        if (r.lo != 0) r.lo -= kSmallest;
        if (r.hi != 0) r.hi += kSmallest;
    }
    return r;
}

}  // namespace interval_detail

inline Interval operator-(const Interval& a) {
    return {-a.hi, -a.lo};
}
inline Interval operator+(const Interval& a, const Interval& b) {
    return interval_detail::widen(a.lo + b.lo, a.hi + b.hi);
}
inline Interval operator-(const Interval& a, const Interval& b) {
    return interval_detail::widen(a.lo - b.hi, a.hi - b.lo);
}
namespace interval_detail {

/// The product a b where one of the four products of ends is 0 or nearly so; each of them has its own margin.
inline Interval small_product(const Interval& a, const Interval& b) {
    Interval r{kLargest, -kLargest};
    for (const double x : {a.lo, a.hi})
        for (const double y : {b.lo, b.hi}) {
            const bool lost = x != 0 && y != 0 && std::fabs(x * y) < 4 * kSmallest;
            const Interval p = widen(x * y, x * y);
            r.lo = std::min(r.lo, lost ? p.lo - kSmallest : p.lo);
            r.hi = std::max(r.hi, lost ? p.hi + kSmallest : p.hi);
        }
    return r;
}

}  // namespace interval_detail

inline Interval operator*(const Interval& a, const Interval& b) {
    const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
    // 0 * inf is NaN and must not be lost by min and max.
    if (std::isnan(p + q + r + s)) return Interval::all();
    const Interval product = interval_detail::widen(std::min(std::min(p, q), std::min(r, s)),
                                                    std::max(std::max(p, q), std::max(r, s)));
    if (!interval_detail::underflows(product)) return product;
    const bool zero = (a.lo == 0 && a.hi == 0) || (b.lo == 0 && b.hi == 0);
    return zero ? Interval(0) : interval_detail::small_product(a, b);
}
inline Interval operator*(const Interval& a, double k) {
    const double p = a.lo * k, q = a.hi * k;
    if (std::isnan(p + q)) return Interval::all();
    const Interval product = k < 0 ? interval_detail::widen(q, p) : interval_detail::widen(p, q);
    if (!interval_detail::underflows(product)) return product;
    const bool zero = k == 0 || (a.lo == 0 && a.hi == 0);
    return zero ? Interval(0) : interval_detail::small_product(a, k);
}
inline Interval operator*(double k, const Interval& a) {
    return a * k;
}
inline Interval operator/(const Interval& a, const Interval& b) {
    if (!(b.lo > 0 || b.hi < 0)) return Interval::all();
    Interval inverse = interval_detail::widen(1 / b.hi, 1 / b.lo);
    if (interval_detail::underflows(inverse)) {
        inverse.lo -= interval_detail::kSmallest;
        inverse.hi += interval_detail::kSmallest;
    }
    return a * inverse;
}
inline Interval& operator+=(Interval& a, const Interval& b) {
    return a = a + b;
}
inline Interval& operator-=(Interval& a, const Interval& b) {
    return a = a - b;
}
inline Interval& operator*=(Interval& a, const Interval& b) {
    return a = a * b;
}

/// The largest magnitude of a member; NaN when an end is NaN.
inline double magnitude(const Interval& a) {
    const double m = std::max(std::fabs(a.lo), std::fabs(a.hi));
    return std::isnan(a.lo) || std::isnan(a.hi) ? std::numeric_limits<double>::quiet_NaN() : m;
}

/// The square, which unlike a * a is never negative.
inline Interval square(const Interval& a) {
    const double p = a.lo * a.lo, q = a.hi * a.hi;
    if (std::isnan(p + q)) return Interval::all();
    const bool zero = a.contains(0);
    Interval r = interval_detail::widen(zero ? 0 : std::min(p, q), std::max(p, q));
    if (interval_detail::underflows(r)) {
        r.lo -= interval_detail::kSmallest;
        if (a.lo != 0 || a.hi != 0) r.hi += interval_detail::kSmallest;
    }
    r.lo = std::max(r.lo, 0.0);
    return r;
}
inline Interval sqrt(const Interval& a) {
    Interval r = interval_detail::widen(std::sqrt(a.lo), std::sqrt(a.hi));
    if (r.lo < 0) r.lo = 0;
    return r;
}

namespace interval_detail {

/// Encloses a function with extrema of value 1 at `top` + 2 k pi and -1 half a turn later.
inline Interval wave(double f_lo, double f_hi, const Interval& a, double top) {
    constexpr double kTurn = 6.283185307179586;
    if (!(a.hi - a.lo < kTurn)) return {-1, 1};
    Interval r = widen(std::min(f_lo, f_hi), std::max(f_lo, f_hi), kLibmMargin);
    // Is some point `at` + 2 k pi inside, with a margin for the rounding of this test?
    const auto holds = [&](double at) {
        const double margin = 1e-14 * (1 + magnitude(a));
        return std::floor((a.hi + margin - at) / kTurn) >= std::ceil((a.lo - margin - at) / kTurn);
    };
    if (holds(top)) r.hi = 1;
    if (holds(top + kTurn / 2)) r.lo = -1;
    return {std::max(r.lo, -1.0), std::min(r.hi, 1.0)};
}

}  // namespace interval_detail

inline Interval sin(const Interval& a) {
    return interval_detail::wave(std::sin(a.lo), std::sin(a.hi), a, 1.5707963267948966);
}
inline Interval cos(const Interval& a) {
    return interval_detail::wave(std::cos(a.lo), std::cos(a.hi), a, 0);
}
inline Interval sinh(const Interval& a) {
    return interval_detail::libm(std::sinh(a.lo), std::sinh(a.hi));
}
inline Interval cosh(const Interval& a) {
    const double p = std::cosh(a.lo), q = std::cosh(a.hi);
    if (std::isnan(p + q)) return Interval::all();
    // A value that overflows is known to be larger than kLargest, no more.
    const double least = a.contains(0) ? 1 : std::min({p, q, interval_detail::kLargest});
    return interval_detail::widen(least, std::max(p, q), interval_detail::kLibmMargin);
}
inline Interval tanh(const Interval& a) {
    const Interval r = interval_detail::libm(std::tanh(a.lo), std::tanh(a.hi));
    return {r.lo < -1 ? -1 : r.lo, r.hi > 1 ? 1 : r.hi};
}
inline Interval asinh(const Interval& a) {
    return interval_detail::libm(std::asinh(a.lo), std::asinh(a.hi));
}
inline Interval exp(const Interval& a) {
    // Unlike the others it is never 0, and finite where it overflows.
    Interval r = interval_detail::libm(std::min(std::exp(a.lo), interval_detail::kLargest), std::exp(a.hi));
    r.hi += r.hi == 0 ? interval_detail::kSmallest : 0;
    r.lo = r.lo < 0 ? 0 : r.lo;
    return r;
}
/// The logarithm; its end is -inf at 0.
inline Interval log(const Interval& a) {
    return interval_detail::libm(std::log(a.lo), std::log(a.hi));
}
/// Encloses the powers of bases that are not negative: the extreme ones stand at corners.
inline Interval pow(const Interval& a, const Interval& b) {
    if (!(a.lo >= 0)) return Interval::all();
    const double p = std::pow(a.lo, b.lo), q = std::pow(a.lo, b.hi);
    const double r = std::pow(a.hi, b.lo), s = std::pow(a.hi, b.hi);
    if (std::isnan(p + q + r + s) || std::isnan(b.lo + b.hi)) return Interval::all();
    Interval power =
        interval_detail::libm(std::min({p, q, r, s, interval_detail::kLargest}), std::max({p, q, r, s}));
    power.hi += power.hi == 0 && a.hi > 0 ? interval_detail::kSmallest : 0;
    // Whatever the exponent, 0^0 = 1 stands beside 0^b.
    if (a.lo == 0 && b.contains(0)) power = {std::min(power.lo, 0.0), std::max(power.hi, 1.0)};
    power.lo = std::max(power.lo, 0.0);
    return power;
}
/// The angle of (x, y); the whole circle when the box meets the negative x axis or the origin.
inline Interval atan2(const Interval& y, const Interval& x) {
    constexpr double kPi = 3.141592653589793;
    if (!(x.lo > 0 || y.lo > 0 || y.hi < 0))
        return interval_detail::widen(-kPi, kPi, interval_detail::kLibmMargin);
    // The extreme angles of a box that the angle's cut does not cross are at corners.
    const double p = std::atan2(y.lo, x.lo), q = std::atan2(y.lo, x.hi);
    const double r = std::atan2(y.hi, x.lo), s = std::atan2(y.hi, x.hi);
    if (std::isnan(p + q + r + s)) return Interval::all();
    Interval angle = interval_detail::libm(std::min(std::min(p, q), std::min(r, s)),
                                           std::max(std::max(p, q), std::max(r, s)));
    // An angle that underflows to 0.
    if (angle.lo == 0 && y.lo != 0) angle.lo -= interval_detail::kSmallest;
    if (angle.hi == 0 && y.hi != 0) angle.hi += interval_detail::kSmallest;
    return angle;
}

inline Interval min(const Interval& a, const Interval& b) {
    return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
}
inline Interval max(const Interval& a, const Interval& b) {
    return {std::max(a.lo, b.lo), std::max(a.hi, b.hi)};
}

/// Whether a condition holds for the members of an interval: for none, for all, or it is not known.
enum class Certainty { no, yes, open };

inline Certainty is_negative(const Interval& a) {
    return a.hi < 0 ? Certainty::yes : a.lo >= 0 ? Certainty::no : Certainty::open;
}
/// Is this certainly the number zero?
inline bool is_zero(const Interval& a) {
    return a.lo == 0 && a.hi == 0;
}
/// The numbers as they are where they are not negative, else 0.
inline Interval without_hair(const Interval& a) {
    return {a.lo < 0 ? 0 : a.lo, a.hi < 0 ? 0 : a.hi};
}
inline void sin_cos(const Interval& a, Interval& s, Interval& c) {
    s = sin(a);
    c = cos(a);
}
inline Interval scaled_sinh(const Interval& a, Interval& s) {
    s = tanh(a);
    const Interval r = Interval(1) / cosh(a);
    return {std::max(r.lo, kLeastScale), std::max(r.hi, kLeastScale)};
}
inline double enlarger(const Interval& a, const Interval& b) {
    return enlarger(magnitude(a), magnitude(b));
}
inline Certainty both(Certainty a, Certainty b) {
    if (a == Certainty::no || b == Certainty::no) return Certainty::no;
    return a == Certainty::yes && b == Certainty::yes ? Certainty::yes : Certainty::open;
}
inline Certainty both(bool a, Certainty b) {
    return a ? b : Certainty::no;
}
/// The smallest interval that holds both intervals.
inline Interval hull(const Interval& a, const Interval& b) {
    if (std::isnan(a.lo + a.hi + b.lo + b.hi)) return Interval::all();
    return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}
/// Selects a where the condition holds and b where it does not; where it is not known, encloses both.
template <class T>
T select(Certainty condition, const T& a, const T& b) {
    return condition == Certainty::yes ? a : condition == Certainty::no ? b : hull(a, b);
}

}  // namespace anamorph
