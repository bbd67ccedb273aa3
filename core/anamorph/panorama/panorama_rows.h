// SPDX-License-Identifier: Apache-2.0
// Rows of a panorama's pull map, exactly: the formulas of chart/projection/ and of lenses read with vectors of doubles.
#pragma once

#include <array>
#include <cstdint>

#include "anamorph/chart/chart.h"

namespace anamorph::simd {

/// The number of pixels of a row that are computed together.
inline constexpr int kExactRow = 64;

/// Source points of a row of target points. Room for kExactRow entries each.
struct ExactRow {
    alignas(64) double x[kExactRow], y[kExactRow];  ///< source pixels
    alignas(64) double piece[kExactRow];            ///< piece of the source
    alignas(64) double seen[kExactRow];             ///< 1, or 0 where there is no source point
};

/// Rays of a row of target points, x right, y down and z forward, with room for kExactRow, and numbers that are not negative where
/// there is one.
struct RayRow {
    alignas(64) double x[kExactRow], y[kExactRow], z[kExactRow], inside[kExactRow];
};

/// A rotation of rays by columns.
using Turn = std::array<std::array<Constant, 3>, 3>;

/// Finds the source points of the `count` <= kExactRow points (x + i, y) of a piece of the target. What is
/// computed and in what order is what Panorama::exact<double> does, with functions that err less than
/// Rounded<double> allows for: its bound holds. The same bits on all instruction sets.
void exact_row(const Chart& target, const Chart& source, const Turn& turn, int piece, double x, double y,
               int count, ExactRow& row);
/// Finds the source points of rays that are given, as Panorama::exact<double> finds their points when it has
/// turned them.
void exact_points(const Chart& source, const Turn& turn, RayRow& rays, int count, ExactRow& row);

}  // namespace anamorph::simd
