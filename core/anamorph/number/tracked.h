// SPDX-License-Identifier: Apache-2.0
// A number as a program computes it, with a proven bound of its distance to the exact result: running error
// analysis (Wilkinson; Higham, "Accuracy and Stability of Numerical Algorithms", section 3.3).
//
// The value is what T's own operations give, bit for bit, so that a formula read with Tracked<double> bounds
// the same formula read with double. Each operation adds u |result|, with u half of T's epsilon, to what its
// operands bring along.
#pragma once

#include <cmath>
#include <limits>

#include "anamorph/number/number.h"

namespace anamorph {

template <class T>
struct Tracked {
    static constexpr double kUnit = unit_roundoff<T>();

    T value = 0;
    double error = 0;

    constexpr Tracked() = default;
    constexpr Tracked(T exact) : value(exact) {}  // NOLINT: a number is exact
    constexpr Tracked(T computed, double bound) : value(computed), error(bound) {}

    double size() const { return static_cast<double>(fabs(value)); }
    /// The number in double, with its rounding.
    Tracked<double> in_double() const {
        const auto v = static_cast<double>(value);
        return {v, (error + 0x1p-53 * std::fabs(v)) * (1 + 0x1p-48)};
    }

    /// A result whose operands bring `carried` along; the factor covers the rounding of bounds themselves.
    static Tracked result(T value, double carried) {
        const double v = static_cast<double>(fabs(value));
        return {value, (carried + kUnit * v) * (1 + 0x1p-48) + std::numeric_limits<double>::min()};
    }
    friend Tracked operator-(const Tracked& a) { return {-a.value, a.error}; }
    friend Tracked operator+(const Tracked& a, const Tracked& b) {
        return result(a.value + b.value, a.error + b.error);
    }
    friend Tracked operator-(const Tracked& a, const Tracked& b) {
        return result(a.value - b.value, a.error + b.error);
    }
    friend Tracked operator*(const Tracked& a, const Tracked& b) {
        return result(a.value * b.value, a.size() * b.error + a.error * (b.size() + b.error));
    }
    Tracked& operator+=(const Tracked& b) { return *this = *this + b; }
    /// The quotient; its bound is infinite where the divisor may be 0.
    friend Tracked operator/(const Tracked& a, const Tracked& b) {
        const T q = a.value / b.value;
        const double least = b.size() - b.error;
        if (!(least > 0)) return {q, std::numeric_limits<double>::infinity()};
        return result(q, (a.error + static_cast<double>(fabs(q)) * b.error) / least);
    }
};

template <class T>
Tracked<T> square(const Tracked<T>& a) {
    return a * a;
}

}  // namespace anamorph
