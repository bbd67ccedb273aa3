// SPDX-License-Identifier: Apache-2.0
// Blocks of a panorama's pull map pixel by pixel in float: the formulas of map/projection/ and of lenses read with
// vectors near the middle of the block (number/near.h).
#pragma once

#include "anamorph/approx/block.h"
#include "anamorph/map/panorama.h"

namespace anamorph::simd {

/// A block to be read, and where.
struct DirectBlock {
    const Chart& target;
    const Chart& source;
    const Panorama::Local& local;
    /// As Panorama::direct() wrote them down about the middle of the block.
    const Bases& bases;
    int width, height;
    /// What is added to the rests: the source point of the middle of the block less the block's base.
    Point<float> middle;
};

/// The pixels of a part of the block, counted from its corner, as offsets from its base; row by row from the start of
/// `to` on. What is computed and in what order is what Panorama::direct_error() bounds. The same bits on all instruction
/// sets.
void direct_rows(const DirectBlock& block, const Box& part, const PointRows& to);

}  // namespace anamorph::simd
