// SPDX-License-Identifier: Apache-2.0
// Taps of each pixel of a block for itself, where its footprint is not large: by the rule of image/footprint.h, from how far its
// source point is from those of its neighbours.
#pragma once

#include <cstddef>
#include <cstdint>

#include "anamorph/image/block_sampler.h"

namespace anamorph::simd {

/// What serves pixels: of several, the greatest one serves all.
enum class OwnKind : std::int32_t {
    one,     ///< one tap: the map magnifies
    nine,    ///< two taps along each side, within half a texel of the point each way
    some,    ///< some taps along each side
    others,  ///< too many taps, or taps on a coarser level, or no footprint
};

/// What says of a pixel which taps it has.
inline constexpr std::int32_t kNoOwnTaps = 0x7fffffff;
inline OwnKind own_kind(std::int32_t taps) {
    return taps == kNoOwnTaps ? OwnKind::others : static_cast<OwnKind>(taps < 2 ? taps : 2);
}

/// Taps along a side of length l in source pixels: the fewest that can leave as little of white noise as the mean over it does, as
/// far apart as they have to be for that (footprint.h). n taps leave 2/3 / n at least, so that they serve ratios r, 2/3 over the mean's
/// (1 - 1 / (3 l)) / l, that is, 2 l^2 / (3 l - 1), from n - 1 to n. Half of their distance is given at kNodes + 1 places of
/// sqrt(n - r), between which it is linear: they leave 2/3 / r to within 1.5e-4 of itself.
struct SpacingTable {
    static constexpr int kMost = 16, kNodes = 32;
    /// The longest side; kMost taps serve 23.66.
    static constexpr float kLongest = 23.6f;

    float half_spacing[kMost + 1][kNodes + 1];

    /// The one that there is.
    static const SpacingTable& get();

  private:
    SpacingTable();
};

/// The most taps of a pixel.
inline constexpr int kMostOwnTaps = kMaxTaps;

/// Rows of taps (OwnTaps), `stride` entries apart, with room for 16 more behind each.
struct OwnTapRows {
    float *x_i, *y_i, *x_j, *y_j;
    std::int32_t* taps;
    std::ptrdiff_t stride;

    OwnTaps at(std::ptrdiff_t k) const { return {x_i + k, y_i + k, x_j + k, y_j + k, taps + k}; }
};

/// How far taps reach from their points along the axes of the source, at most, and what serves all pixels.
struct OwnReach {
    float x = 0, y = 0;
    OwnKind kind = OwnKind::one;
};

/// The longest that the narrow side of a footprint may be for taps on the source itself, where two across it suffice: beyond it
/// FootprintChooser goes on to a coarser level. (3 + sqrt(5)) / 2, where box_energy is 1/3.
inline constexpr float kWidestOnFinest = 2.618034f;

/// Finds the taps on the source itself of all pixels of a block at least two pixels wide and high from its points; rows of them have
/// room for 16 more. A side is the shorter one of the steps to the two neighbours in the block, which does not cross a seam. Footprints
/// whose least stretch is more than `widest` have none here.
OwnReach own_taps(const float* x, const float* y, std::ptrdiff_t row_stride, int width, int height,
                  float widest, const OwnTapRows& to);

}  // namespace anamorph::simd
