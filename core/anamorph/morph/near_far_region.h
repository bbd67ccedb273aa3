// SPDX-License-Identifier: Apache-2.0
// The data that near/far keeps of a region for drawing it: its cells, their polynomials and their near lines.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "anamorph/morph/near_far_kernels.h"
#include "anamorph/plan/block.h"

namespace anamorph::near_far {

using simd::CellFrame;
using simd::FieldLine;
using simd::kComponents;
using simd::kMaxDegree;

inline constexpr auto kHalfRegion = static_cast<double>(simd::kRegionHalf);
inline constexpr int kRegion = static_cast<int>(2 * kHalfRegion);

using Vector = std::array<double, kComponents>;

/// The length of the longer half of a vector: the displacements of the shapes.
inline double length_of(const Vector& v) {
    return std::sqrt(std::max(v[0] * v[0] + v[1] * v[1], v[2] * v[2] + v[3] * v[3]));
}

struct Cell {
    Box box;
    bool exact;
    double bound;  ///< not of exact cells
    CellFrame frame;
    std::int32_t base[kComponents];
    std::size_t coefficients, near;  ///< where coefficients and near lines begin in the region's lists
    int near_count;
    bool fine;  ///< tells how near lines are placed
};

struct Region final : RegionData {
    std::vector<Cell> cells;
    std::vector<float> coefficients;
    std::vector<FieldLine> lines;  ///< the near lines, cell by cell, as seen from the cell's centre
    Vector origin;                 ///< source point of the region's centre under the reference displacement
};

}  // namespace anamorph::near_far
