// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/language/timing.h"

#include <algorithm>
#include <cmath>

namespace anamorph::figure {
namespace {

/// 1 + ... + m, and 1 + 4 + ... + m^2.
double sum_to(double m) {
    return m * (m + 1) / 2;
}
double squares_to(double m) {
    return m * (m + 1) * (2 * m + 1) / 6;
}

}  // namespace

Shares shares_of(Distribution distribution, double a, double n) {
    const double b = n - a + 1;  // frames left, this one included
    switch (distribution) {
        case Distribution::linear:
            return {1 / n, 1 / b};
        case Distribution::accelerate:
            return {a / sum_to(n), a / (sum_to(n) - sum_to(a - 1))};
        case Distribution::decelerate:
            return {b / sum_to(n), b / sum_to(b)};
        case Distribution::quadratic: {
            const double odd = std::fmod(n, 2), whole = (n * (n + 2) + odd) / 4;
            return {std::min(a, b) / whole, a < b ? a / (whole - sum_to(a - 1)) : b / sum_to(b)};
        }
        case Distribution::cubic: {
            const double odd = std::fmod(n, 2), half = (n - odd) / 2, m = std::min(a, b);
            const double whole = 2 * squares_to(half) + odd * (half + 1) * (half + 1);
            return {m * m / whole, a < b ? a * a / (whole - squares_to(a - 1)) : b * b / squares_to(b)};
        }
        default:
            return {};
    }
}

}  // namespace anamorph::figure
