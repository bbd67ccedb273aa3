// SPDX-License-Identifier: Apache-2.0
// Cubics on rows of pixels.
#pragma once

namespace anamorph::simd {

/// d0 + x (d1 + (x - h) (d2 + (x - 2 h) d3)) - base: Newton's form of a cubic through values at 0, h, 2 h and 3 h.
struct CubicRow {
    double d0, d1, d2, d3, h, base;
};
/// Its values at x = 0, 1, ..., `count` of them, computed in double and rounded to float: the same bits on all
/// instruction sets. Nothing else is written to.
void write_cubic(const CubicRow& cubic, int count, float* to);

}  // namespace anamorph::simd
