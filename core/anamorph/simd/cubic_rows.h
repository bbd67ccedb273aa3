// SPDX-License-Identifier: Apache-2.0
// Cubics on rows of pixels.
#pragma once

namespace anamorph::simd {

/// c[0] + s (c[1] + s (c[2] + s c[3])).
struct CubicRow {
    double c[4];
};
/// The values of two at s = (from + i) step, i = 0, 1, ..., `count` of them, computed in double and rounded to float:
/// the same bits on all instruction sets. Nothing else changes, but there is room for 16 more.
void write_cubics(const CubicRow& x, const CubicRow& y, double from, double step, int count, float* to_x,
                  float* to_y);

}  // namespace anamorph::simd
