// SPDX-License-Identifier: Apache-2.0
// What a number offers, so that formulas (of chart/, mesh/, morph/, deform/ and surface/) can be read with it.
//
// A formula is a template over its scalar T and is written once. With a, b of type T and k a double it uses
//
//   T(k)  a + b  a - b  a * b  a / b  -a  a + k  k + a  a - k  k - a  a * k  k * a
//   square(a)  sqrt(a)  sin_cos(a, s, c)  atan2(b, a)  exp(a)  log(a)  asinh(a)  min(a, b)  max(a, b)
//   is_zero(a)  is_negative(a)      conditions; both(condition, condition)
//   select(condition, a, b)         a where it holds, else b; both have been computed
//   without_hair(a)                 a; 0 where it is negative by less than 2^-38
//   scaled_sinh(a, s)               sinh(a) into s, and returns 1, both over cosh(a): no a overflows them
//   enlarger(a, b)                  1, or where the squares of both would underflow, a large factor
//
// and names no scalar type. A condition is a bool, or what the number needs in its place: a mask of a vector's
// lanes, a Certainty of an interval. A branch that would save time is no use to a vector, so there is none.
//
// Numbers: float, double and long double (here), DoubleDouble (double_double.h), Interval (interval.h), Jet (jet.h), Lanes (lanes.h),
// four jets at once (number/jets.h). Rounded (rounded.h), which bounds rounding over a box, offers what projections ask for; Tracked (tracked.h)
// follows a single evaluation. FormatNumber (number_format.h) is rounded as hardware does. GlslNumber (glsl_number.h) writes a
// shader. A new one gives the list above in its own namespace and works at once in every formula.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>

#include "anamorph/number/arithmetic.h"

namespace anamorph {

using std::asinh;
using std::atan2;
using std::exp;
using std::fabs;
using std::floor;
using std::isfinite;
using std::log;
using std::sqrt;

template <std::floating_point T>
T square(T a) {
    return a * a;
}
template <std::floating_point T>
void sin_cos(T a, T& s, T& c) {
    s = std::sin(a);
    c = std::cos(a);
}
template <std::floating_point T>
T min(T a, T b) {
    return b < a ? b : a;
}
template <std::floating_point T>
T max(T a, T b) {
    return a < b ? b : a;
}
template <std::floating_point T>
bool is_zero(T a) {
    return a == 0;
}
template <std::floating_point T>
bool is_negative(T a) {
    return a < 0;
}
template <std::floating_point T>
T without_hair(T a) {
    return a < 0 && a > static_cast<T>(-0x1p-38) ? 0 : a;
}
/// The least value that scaled_sinh() returns: its products do not underflow, so that a vector scaled by it keeps its
/// direction.
inline constexpr double kLeastScale = 0x1p-960;
template <std::floating_point T>
T scaled_sinh(T a, T& s) {
    constexpr bool kLong = std::numeric_limits<T>::min_exponent < -16000;
    s = std::tanh(a);
    return std::max(1 / std::cosh(a), kLong ? static_cast<T>(0x1p-16000L) : static_cast<T>(kLeastScale));
}
/// A factor of a and b so that their squares do not underflow.
template <std::floating_point T>
double enlarger(T a, T b) {
    return std::fabs(a) < 0x1p-400 && std::fabs(b) < 0x1p-400 ? 0x1p500 : 1;
}
template <class T>
T select(bool condition, const T& a, const T& b) {
    return condition ? a : b;
}
inline bool both(bool a, bool b) {
    return a && b;
}

/// A number that offers the list at the head of this file.
template <class T>
concept FormulaNumber = requires(const T& a, const T& b, T& to, double k) {
    T(k);
    { T(a + b) } -> std::same_as<T>;
    { T(a - b) } -> std::same_as<T>;
    { T(a * b) } -> std::same_as<T>;
    { T(a / b) } -> std::same_as<T>;
    { T(-a) } -> std::same_as<T>;
    { T(a + k) } -> std::same_as<T>;
    { T(k + a) } -> std::same_as<T>;
    { T(a - k) } -> std::same_as<T>;
    { T(k - a) } -> std::same_as<T>;
    { T(a * k) } -> std::same_as<T>;
    { T(k * a) } -> std::same_as<T>;
    { T(square(a)) } -> std::same_as<T>;
    { T(sqrt(a)) } -> std::same_as<T>;
    sin_cos(a, to, to);
    { T(atan2(b, a)) } -> std::same_as<T>;
    { T(exp(a)) } -> std::same_as<T>;
    { T(log(a)) } -> std::same_as<T>;
    { T(asinh(a)) } -> std::same_as<T>;
    { T(min(a, b)) } -> std::same_as<T>;
    { T(max(a, b)) } -> std::same_as<T>;
    { T(select(is_zero(a), a, b)) } -> std::same_as<T>;
    { T(select(is_negative(a), a, b)) } -> std::same_as<T>;
    { T(select(both(is_zero(a), is_negative(b)), a, b)) } -> std::same_as<T>;
    { T(without_hair(a)) } -> std::same_as<T>;
    { T(a * scaled_sinh(a, to)) } -> std::same_as<T>;
    { T(a * enlarger(a, b)) } -> std::same_as<T>;
};

}  // namespace anamorph
