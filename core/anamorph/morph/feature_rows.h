// SPDX-License-Identifier: Apache-2.0
// Rows of a morph's map in double, every line at every pixel: the formula of morph/feature_formula.h read with vectors.
#pragma once

#include <span>

#include "anamorph/morph/feature_lines.h"

namespace anamorph::simd {

/// The error of a power c^-b, c >= 1, in units of 2^-53, for exponents that have no closed form: it is
/// exp(-b log(c)) with functions and a product that err by less than 4 (number/lanes.h), `log` being at least
/// b log(c).
constexpr double power_rounding(double log) {
    return 4 * log + 4;
}
/// The largest b log(c) of a power that is not 0: beyond, it is less than any double.
inline constexpr double kMostPowerLog = 746;

/// The arrays for the points of one shape's picture; room for 16 more is written to.
struct FeatureRow {
    int shape;
    double *x, *y;
};

/// Finds the points of shapes' pictures that the map has for the `count` points (x + i, y). What is computed,
/// and in what order, is what FeatureMap does in double, but for power_rounding where b is none of 0, 1/2, 1
/// and 2. The same bits on all instruction sets, and whichever shapes are computed together.
void feature_rows(const FeatureMap& map, std::span<const FeatureRow> rows, double x, double y, int count);
/// Finds the points of one shape's picture, as feature_rows() does.
inline void feature_row(const FeatureMap& map, int shape, double x, double y, int count, double* to_x,
                        double* to_y) {
    const FeatureRow row{shape, to_x, to_y};
    feature_rows(map, {&row, 1}, x, y, count);
}

}  // namespace anamorph::simd
