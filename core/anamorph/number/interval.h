// SPDX-License-Identifier: Apache-2.0
// Interval arithmetic over double: every operation encloses the exact result of its operands' members.
//
// Rounding: the four operations and sqrt are rounded to nearest by the hardware and then widened by one ULP
// or more on each side; sin, cos, sinh, cosh, atan2, asin and log are taken from libm and widened by
// kLibmMargin, a relative margin of 8 ULP (glibc states at most 2 for these; tests/core checks the margin
// against long double). An operation without a bounded result (division by an interval that holds zero, the
// root of a negative number) gives [-inf, inf] or NaN ends; every test on a bound is written !(bound <= tol).
// Underflow is not enclosed: an exact zero stays one, and a result below 1e-300 may be lost.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace anamorph {

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

namespace interval_detail {

inline constexpr double kUlp = 0x1p-52;
inline constexpr double kLibmMargin = 8 * 0x1p-52;

/// [lo, hi] widened by `relative` of each end's magnitude. An end of exactly 0 stays.
inline Interval widen(double lo, double hi, double relative = kUlp) {
    return {lo - std::fabs(lo) * relative, hi + std::fabs(hi) * relative};
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
inline Interval operator*(const Interval& a, const Interval& b) {
    const double p = a.lo * b.lo, q = a.lo * b.hi, r = a.hi * b.lo, s = a.hi * b.hi;
    // 0 * inf is NaN and must not be lost by min and max.
    if (std::isnan(p + q + r + s)) return Interval::all();
    return interval_detail::widen(std::min(std::min(p, q), std::min(r, s)),
                                  std::max(std::max(p, q), std::max(r, s)));
}
inline Interval operator/(const Interval& a, const Interval& b) {
    if (!(b.lo > 0 || b.hi < 0)) return Interval::all();
    return a * interval_detail::widen(1 / b.hi, 1 / b.lo);
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
    return interval_detail::widen(std::sinh(a.lo), std::sinh(a.hi), interval_detail::kLibmMargin);
}
inline Interval cosh(const Interval& a) {
    const double p = std::cosh(a.lo), q = std::cosh(a.hi);
    if (std::isnan(p + q)) return Interval::all();
    return interval_detail::widen(a.contains(0) ? 1 : std::min(p, q), std::max(p, q),
                                  interval_detail::kLibmMargin);
}
inline Interval asinh(const Interval& a) {
    return interval_detail::widen(std::asinh(a.lo), std::asinh(a.hi), interval_detail::kLibmMargin);
}
/// The angle of (x, y); the whole circle when the box meets the negative x axis or the origin.
inline Interval atan2(const Interval& y, const Interval& x) {
    using interval_detail::kLibmMargin;
    constexpr double kPi = 3.141592653589793;
    if (!(x.lo > 0 || y.lo > 0 || y.hi < 0)) return interval_detail::widen(-kPi, kPi, kLibmMargin);
    // The extreme angles of a box that the angle's cut does not cross are at corners.
    const double p = std::atan2(y.lo, x.lo), q = std::atan2(y.lo, x.hi);
    const double r = std::atan2(y.hi, x.lo), s = std::atan2(y.hi, x.hi);
    if (std::isnan(p + q + r + s)) return Interval::all();
    return interval_detail::widen(std::min(std::min(p, q), std::min(r, s)),
                                  std::max(std::max(p, q), std::max(r, s)), kLibmMargin);
}

}  // namespace anamorph
