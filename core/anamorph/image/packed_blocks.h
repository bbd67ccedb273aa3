// SPDX-License-Identifier: Apache-2.0
// Blocks of three or four channels whose pixels have the type of their texels, bilinear with one tap: several pixels
// at once, in the type's own arithmetic, whole cache lines past the cache. draw_block chooses them; block_sampler.h
// states their errors.
//
// uint8 is filtered in whole numbers: a pixel is the sum of its four texels, weighted in units of 2^-14, rounded to
// the nearest level, halves up. With fractions fx and fy of the point past the middle of the upper left texel,
//
//   X = fx 2^14 + e1,  Y = fy 2^14 + e2,  B = X Y 2^-14 + e3,  each rounded to a whole number, |e| <= 1/2,
//
// and the weights are 2^14 - X - Y + B, X - B, Y - B and B: they add up to 2^14, and none is negative, for the
// products of 1 - X 2^-14 or X 2^-14 with 1 - Y 2^-14 or Y 2^-14 are not, and B is off by at most 1/2. Before it is
// rounded the sum is the bilinear value at the point (X, Y) 2^-14, and e3 2^-14 times the mixed difference of the
// texels. Where no two of the four texels differ by more than D levels, moving the point costs at most
// (|e1| + |e2|) 2^-14 D, and the mixed difference is at most 2 D: together 2^-13 D, at most 255 / 8192 < 1/32 levels.
//
// Taps that read nine texels (nine_texels-inl.h) give the eight around the middle one weights in float, each rounded to a
// multiple of 2^-14, and the middle one what is left, but not less than 0. So the sum is off by the rounding of each weight, at
// most 2^-15 (and 2^-22 for what floats lost), times what its texel differs by from the middle one, at most 255: 8 * 255 * 2^-15
// < 1/15 levels. Where that made the eight more than 1, by 4 units at most, a pixel is at most 255.1, which is 255.
//
// uint16 and half are filtered in float, by the formulas of block_sampler.cpp and with the same bits.
#pragma once

#include "anamorph/image/block_sampler.h"

namespace anamorph::simd {

/// The arguments of draw_block.
struct Drawing {
    const Texels& texels;
    const Polynomials& block;
    int begin, end, row_begin, row_end;
    float scale;
    PixelType type;
    std::byte* to;
    std::ptrdiff_t row_stride;
};

/// Draws a block if it is of the kind above and the processor has vectors for it.
bool draw_packed_block(const Drawing& drawing);

}  // namespace anamorph::simd
