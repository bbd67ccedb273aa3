// SPDX-License-Identifier: Apache-2.0
// Rows of a morph's map in double, every line at every pixel: the formula of morph/feature_formula.h read with vectors.
#pragma once

#include <span>

#include "anamorph/morph/feature_lines.h"

namespace anamorph::simd {

/// In units of 2^-53, by how much a power c^-b, c >= 1, of exponents that have no closed form is off here: it is
/// exp(-b log(c)) with functions and a product that err by less than 4 (number/lanes.h), `log` being at least
/// b log(c).
constexpr double power_rounding(double log) {
    return 4 * log + 4;
}
/// Nor is the power of a greater b log(c) more than 0: it is less than any double.
inline constexpr double kMostPowerLog = 746;

/// Where the points of one shape's picture go; room for 16 more is written to.
struct FeatureRow {
    int shape;
    double *x, *y;
};

/// The points of shapes' pictures that the map finds for the `count` points (x + i, y). What is computed, and in
/// what order, is what FeatureMap does in double, but for power_rounding where b is none of 0, 1/2, 1 and 2. The same
/// bits on all instruction sets, and whichever shapes are computed together.
void feature_rows(const FeatureMap& map, std::span<const FeatureRow> rows, double x, double y, int count);
/// The points of one.
inline void feature_row(const FeatureMap& map, int shape, double x, double y, int count, double* to_x,
                        double* to_y) {
    const FeatureRow row{shape, to_x, to_y};
    feature_rows(map, {&row, 1}, x, y, count);
}

}  // namespace anamorph::simd
