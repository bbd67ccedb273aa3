// SPDX-License-Identifier: Apache-2.0
// Cubics on rows of pixels.
#pragma once

#include <span>

namespace anamorph::simd {

/// The cubic c[0] + s (c[1] + s (c[2] + s c[3])).
struct CubicRow {
    double c[4];
};
/// Two cubics on places [begin, end) of a row.
struct CubicRun {
    CubicRow x, y;
    int begin, end;
};
/// Writes runs that follow each other from left to right: to_x[i] and to_y[i] are the values at s = (from + i) step,
/// computed in double and rounded to float: the same bits on all instruction sets. Up to 8 places behind each run may hold
/// anything.
void write_cubics(std::span<const CubicRun> runs, double from, double step, float* to_x, float* to_y);

}  // namespace anamorph::simd
