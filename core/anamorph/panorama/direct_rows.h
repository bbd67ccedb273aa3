// SPDX-License-Identifier: Apache-2.0
// Blocks of a panorama's pull map pixel by pixel, in float or in double: the formulas of chart/projection/ and of lenses
// read with vectors near the middle of the block (number/near.h).
#pragma once

#include "anamorph/panorama/panorama.h"
#include "anamorph/plan/block.h"

namespace anamorph::simd {

/// A block whose source points are to be read in Real, float or double, with the charts and the place that it
/// is read by.
template <class Real>
struct DirectBlock {
    const Chart& target;
    const Chart& source;
    const Panorama::Local& local;
    /// The bases that Panorama::direct() wrote down about the middle of the block, in the order of
    /// direct_order().
    std::span<const Real> bases;
    int width, height;
    /// The number that is added to the rests: the source point of the middle of the block, or its offset from
    /// the block's base.
    Point<Real> middle;
};

/// Finds the source points of a part of the block, counted from its corner, as offsets from its base; row by
/// row from the start of `to` on. What is computed and in what order is what Panorama::direct() bounds. The
/// same bits on all instruction sets.
void direct_rows(const DirectBlock<float>& block, const Box& part, const PointRows& to);

/// Finds the source points of row `row` of the block, by the same computations. There is room for 16 more.
void direct_row(const DirectBlock<double>& block, int row, double* x, double* y);

/// The order in which direct_rows() and direct_row() read the bases of a block, as NearReading has that in
/// which they were written; 0 if it cannot be told. Drawing keeps no order: rows of any bases are computed
/// once more with it, and it is theirs if all have the same bits.
template <class Real>
std::uint64_t direct_order(const Chart& target, const Chart& source, const Panorama::Local& local);

}  // namespace anamorph::simd
