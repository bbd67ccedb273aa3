// SPDX-License-Identifier: Apache-2.0
// Taps of each pixel of a block for itself, where its footprint is small: by the rule of image/footprint.h, from how far its
// source point is from those of its neighbours.
#pragma once

#include <cstddef>
#include <cstdint>

#include "anamorph/image/block_sampler.h"

namespace anamorph::simd {

/// The longest side of a footprint, in source pixels, that gets taps here. Up to 1 there is one tap to a side. Up to 2 there are
/// two, no more than a texel apart (box_energy(2) is 5/12, tap_energy(2, 1) as well), on level 0, for the least stretch is no
/// longer than a side (FootprintChooser).
inline constexpr float kLongestOwnSide = 2;

/// What taps a pixel takes: the later ones include the earlier ones.
enum class OwnKind : std::int32_t {
    one,    ///< one: the map magnifies
    nine,   ///< within half a texel of the point, each way
    four,   ///< farther away
    others  ///< the footprint is larger, or none
};

/// Rows of taps, `stride` entries apart, with room for 16 more behind each.
struct OwnTapRows {
    float *x_i, *y_i, *x_j, *y_j;
    std::int32_t* kind;
    std::ptrdiff_t stride;

    OwnTaps at(std::ptrdiff_t k) const { return {x_i + k, y_i + k, x_j + k, y_j + k}; }
};

/// The farthest that own taps reach from their point along an axis, in texels: half a texel for each side, which may be parallel.
inline constexpr double kOwnReach = 1;

/// Finds the taps of all pixels of a block at least two pixels wide and high from its points; rows of them have room for 16 more.
/// A side is the shorter one of the steps to the two neighbours in the block, which does not cross a seam.
void own_taps(const float* x, const float* y, std::ptrdiff_t row_stride, int width, int height,
              const OwnTapRows& to);

}  // namespace anamorph::simd
