// SPDX-License-Identifier: Apache-2.0
// Numbers of some 100 bits, each the unevaluated sum of two doubles (Dekker 1971, "A floating-point technique for extending the available
// precision").
//
// What a picture depends on and what double holds too badly is computed in them: constants of projections, turns and lenses, which are
// then rounded to double, the points of exact pixels that double's rounding moves by more than the tolerance, and the truth that errors
// are measured against. long double would do, but has 64, 113 or 53 bits, and functions of its own, on different processors; these are
// the same on all of them, but for angles beyond DoubleDouble::kLargestAngle and for the last bits of arcs.
#pragma once

#include <cmath>
#include <compare>
#include <concepts>
#include <limits>

#include "anamorph/number/arithmetic.h"
#include "anamorph/number/number.h"

namespace anamorph {

/// The sum of two doubles, of which the second is at most half a unit in the last place of the first. What overflows or is no number has
/// no second part.
///
/// Sums, products, quotients and roots are off by less than 2^-102 of themselves (Joldes, Muller and Popescu 2017, "Tight and rigorous
/// error bounds for basic building blocks of double-word arithmetic"), functions by less than 2^-94, as tests/core measures them; where a
/// second part or what it is made of underflows or overflows by no more than a double is. Bounds count 2^-64 (unit_roundoff()).
class DoubleDouble {
  public:
    /// Up to this magnitude sines and cosines are as exact as other functions; beyond, where doubles are a radian apart, those of the first
    /// part take their place.
    static constexpr double kLargestAngle = 0x1p52;

    constexpr DoubleDouble() = default;
    template <class T>
    requires(std::integral<T> || std::same_as<T, float> ||
             std::same_as<T, double>) constexpr DoubleDouble(T value)
        : m_upper(static_cast<double>(value)) {}  // NOLINT: a double is one
    /// As far as it holds it.
    template <std::same_as<long double> T>
    constexpr explicit DoubleDouble(T value)
        : m_upper(static_cast<double>(value)), m_lower(static_cast<double>(value - m_upper)) {}
    /// The sum of two doubles of which the second does not change the first.
    constexpr DoubleDouble(double upper, double lower) : m_upper(upper), m_lower(lower) {}

    /// Half a turn, off by less than 2^-107.
    static constexpr DoubleDouble pi() { return {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53}; }

    /// The nearest double, and what is left of the number.
    constexpr double upper() const { return m_upper; }
    constexpr double lower() const { return m_lower; }
    constexpr explicit operator double() const { return m_upper; }
    /// As far as long double holds it.
    constexpr explicit operator long double() const { return static_cast<long double>(m_upper) + m_lower; }

    friend constexpr DoubleDouble operator-(const DoubleDouble& a) { return {-a.m_upper, -a.m_lower}; }
    friend DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b);
    friend DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + -b; }
    friend DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b);
    friend DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b);
    DoubleDouble& operator+=(const DoubleDouble& b) { return *this = *this + b; }
    DoubleDouble& operator-=(const DoubleDouble& b) { return *this = *this - b; }
    DoubleDouble& operator*=(const DoubleDouble& b) { return *this = *this * b; }

    friend constexpr bool operator==(const DoubleDouble&, const DoubleDouble&) = default;
    friend constexpr std::partial_ordering operator<=>(const DoubleDouble& a, const DoubleDouble& b) {
        return a.m_upper == b.m_upper ? a.m_lower <=> b.m_lower : a.m_upper <=> b.m_upper;
    }

  private:
    double m_upper = 0, m_lower = 0;
};

/// The square root.
DoubleDouble sqrt(const DoubleDouble& a);
/// The root of the sum of both squares; no square overflows or underflows.
DoubleDouble hypot(const DoubleDouble& a, const DoubleDouble& b);
/// Puts the sine and the cosine of an angle in radians into `s` and `c`.
void sin_cos(const DoubleDouble& a, DoubleDouble& s, DoubleDouble& c);
/// The tangent of an angle in radians.
DoubleDouble tan(const DoubleDouble& a);
/// The angle from minus to plus a quarter of a turn of which `a` is the sine; no number where |a| > 1.
DoubleDouble asin(const DoubleDouble& a);
/// The angle from 0 to half a turn of which `a` is the cosine; no number where |a| > 1.
DoubleDouble acos(const DoubleDouble& a);
/// The angle of (x, y), from minus to plus half a turn, as std::atan2 has it for zeros and infinities.
DoubleDouble atan2(const DoubleDouble& y, const DoubleDouble& x);
/// e to the power of a.
DoubleDouble exp(const DoubleDouble& a);
/// The power of a number that is not negative.
DoubleDouble pow(const DoubleDouble& a, double exponent);
/// The natural logarithm; minus infinity of 0, no number below.
DoubleDouble log(const DoubleDouble& a);
/// The inverse hyperbolic sine.
DoubleDouble asinh(const DoubleDouble& a);
/// Puts tanh(a) into `s` and returns 1 / cosh(a), at least kLeastScale, as number.h has it.
DoubleDouble scaled_sinh(const DoubleDouble& a, DoubleDouble& s);

/// The largest whole number that is not above a number.
DoubleDouble floor(const DoubleDouble& a);
inline DoubleDouble fabs(const DoubleDouble& a) {
    return std::signbit(a.upper()) ? -a : a;
}
inline bool isnan(const DoubleDouble& a) {
    return std::isnan(a.upper());
}
inline bool isfinite(const DoubleDouble& a) {
    return std::isfinite(a.upper());
}
inline DoubleDouble square(const DoubleDouble& a) {
    return a * a;
}
inline DoubleDouble min(const DoubleDouble& a, const DoubleDouble& b) {
    return b < a ? b : a;
}
inline DoubleDouble max(const DoubleDouble& a, const DoubleDouble& b) {
    return a < b ? b : a;
}
inline bool is_zero(const DoubleDouble& a) {
    return a.upper() == 0;
}
inline bool is_negative(const DoubleDouble& a) {
    return a.upper() < 0;
}
inline DoubleDouble without_hair(const DoubleDouble& a) {
    return a < 0 && a > -0x1p-38 ? DoubleDouble() : a;
}
inline double enlarger(const DoubleDouble& a, const DoubleDouble& b) {
    return enlarger(a.upper(), b.upper());
}

/// A number that formulas are computed in, at a point.
template <class T>
concept RealNumber = std::floating_point<T> || std::same_as<T, DoubleDouble>;

/// Bounds decide how a picture is drawn, and pictures are as they were when long double of 64 bits had this place.
template <>
constexpr double unit_roundoff<DoubleDouble>() {
    return 0x1p-64;
}

}  // namespace anamorph
