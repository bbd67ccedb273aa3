// SPDX-License-Identifier: Apache-2.0
// sin t / t and cos t as power series in t^2, in which both are smooth at t = 0.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "anamorph/number/arithmetic.h"

namespace anamorph {

/// The inverse factorial 1 / n!, to within n units.
constexpr double inverse_factorial(int n) {
    double product = 1;
    for (int k = 2; k <= n; ++k) product /= k;
    return product;
}

/// The degree of the series of sinc_cos() with which a block is read: the truncation error is small up to t^2 = 1.
template <class Real>
inline constexpr int sinc_degree = std::is_same_v<Real, float> ? 4 : 7;

/// The largest error of coefficient k of sinc_cos_series(): so many units of 1 / (2 k + 1)! in s, of 1 / (2 k)! in c.
inline constexpr double kSincUnits = 256;

/// Finds the first N coefficients of the series of sin t / t (s) and cos t (c) in powers of t^2 about t^2 = a, for a from 0
/// to 10; NaN beyond.
///
/// Coefficient k of the first is the sum of (-1)^(k + m) (m + k)! / (m! k! (2 (m + k) + 1)!) a^m, by Horner's rule. With r
/// the root of a, the magnitudes add up to at most sinh(r) / r, below 3.8, times 1 / (2 k + 1)!; each of the 16 terms meets at
/// most 33 roundings, and its factor is off by 30 units: 240 units in all.
template <std::size_t N>
void sinc_cos_series(double a, double (&s)[N], double (&c)[N]) {
    constexpr std::size_t kTerms = 16;
    static constexpr auto kTable = [] {
        std::array<std::array<double, N>, kTerms> table{};
        for (std::size_t k = 0; k < N; ++k)
            for (std::size_t m = 0; m < kTerms; ++m) {
                double term = inverse_factorial(2 * static_cast<int>(m + k) + 1);
                for (std::size_t i = 1; i <= k; ++i)
                    term *= static_cast<double>(m + i) / static_cast<double>(i);
                table[m][k] = (m + k) % 2 ? -term : term;
            }
        return table;
    }();
    if (!(a >= 0 && a <= 10)) a = NAN;
    for (std::size_t k = 0; k < N; ++k) s[k] = kTable[kTerms - 1][k];
    for (std::size_t m = kTerms - 1; m > 0; --m)
        for (std::size_t k = 0; k < N; ++k) s[k] = s[k] * a + kTable[m - 1][k];
    const double r = std::sqrt(a);
    s[0] = r == 0 ? 1 : std::sin(r) / r;
    c[0] = std::cos(r);
    for (std::size_t k = 1; k < N; ++k) c[k] = s[k - 1] / (-2.0 * static_cast<double>(k));
}

}  // namespace anamorph
