// SPDX-License-Identifier: Apache-2.0
// The root of a sum of squares with the same bits on every processor. That of a C library has others where it was compiled for
// processors that multiply and add at once, as on arm64.
#pragma once

#include <algorithm>
#include <cmath>

#include "anamorph/number/arithmetic.h"

namespace anamorph {

/// The root of a^2 + b^2 of numbers 0 <= b <= a whose squares neither overflow nor underflow: the root of the rounded sum, less the
/// first order of what rounding left in it (Borges 2020, "An Improved Algorithm for hypot(a,b)", ACM TOMS 46, algorithm 2: within one
/// unit in the last place).
inline double hypot_of_ordered(double a, double b) {
    const double root = std::sqrt(a * a + b * b);
    // root^2 - a^2 - b^2, from the nearer one of both on.
    double rest, far;
    if (root <= 2 * b) {
        const double beyond = root - b;
        rest = a * (2 * beyond - a);
        far = (beyond - 2 * (a - b)) * beyond;
    } else {
        const double beyond = root - a;
        rest = 2 * beyond * (a - 2 * b);
        far = (4 * beyond - b) * b + beyond * beyond;
    }
    return root - (rest + far) / (2 * root);
}

/// The root of x^2 + y^2, within one unit in the last place; no square overflows or underflows. Infinite where one of both is, as
/// std::hypot has it, else no number where one of both is none.
inline double hypot(double x, double y) {
    x = std::fabs(x), y = std::fabs(y);
    if (std::isinf(x) || std::isinf(y)) return HUGE_VAL;
    if (std::isnan(x) || std::isnan(y)) return x + y;
    const double more = std::max(x, y), less = std::min(x, y);
    // Where the other square is less than half a unit in the last place of the larger one.
    if (less <= more * 0x1p-54) return more + less;
    if (more > 0x1p511) return hypot_of_ordered(more * 0x1p-600, less * 0x1p-600) * 0x1p600;
    if (less < 0x1p-459) return hypot_of_ordered(more * 0x1p600, less * 0x1p600) * 0x1p-600;
    return hypot_of_ordered(more, less);
}

/// The root of x^2 + y^2 + z^2; no square overflows.
inline double hypot(double x, double y, double z) {
    x = std::fabs(x), y = std::fabs(y), z = std::fabs(z);
    if (std::isinf(x) || std::isinf(y) || std::isinf(z)) return HUGE_VAL;
    const double most = std::max({x, y, z});
    if (!(most > 0)) return x + y + z;
    x /= most, y /= most, z /= most;
    return most * std::sqrt(x * x + y * y + z * z);
}

}  // namespace anamorph
