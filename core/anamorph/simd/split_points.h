// SPDX-License-Identifier: Apache-2.0
// Source points in double as samplers read them: a whole texel, and how far into it.
#pragma once

#include <cstdint>

namespace anamorph::simd {

/// Of `count` points of one coordinate, times `scale`: the texel each falls into, less `base`, and the rest as a float
/// below 1, which loses at most half of 2^-24 texels; all of it where float would round it to the next texel. What is
/// split lies within 2^30 texels of 0. Arrays have room for 16 more. The same bits on all instruction sets.
void split_points(const double* points, int count, double scale, std::int32_t base, std::int32_t* texels,
                  float* rests);

/// Extends a range by `count` values; where one is not a number, to NaN.
void extend_range(const double* values, int count, double& low, double& high);

}  // namespace anamorph::simd
