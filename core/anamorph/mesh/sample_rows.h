// SPDX-License-Identifier: Apache-2.0
// Source points that an ST-map says pixel for pixel: pairs of floats, u and v, made places of the source.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace anamorph::simd {

/// The least and the greatest u and v; NaN where one is not a number.
struct SampleRange {
    float low[2] = {HUGE_VALF, HUGE_VALF}, high[2] = {-HUGE_VALF, -HUGE_VALF};

    /// The largest magnitude of all; NaN where one is not a number.
    double most() const {
        double all = 0;
        for (const float v : {low[0], high[0], low[1], high[1]}) {
            const double size = std::fabs(double{v});
            all = std::isnan(size) || size > all ? size : all;
            if (std::isnan(all)) break;
        }
        return all;
    }
};

/// Extends a range by `count` pairs.
void extend_range(const float* uv, std::ptrdiff_t count, SampleRange& range);

/// The numbers of one coordinate of the i-th of a row of samples v: first + step i + scale v.
struct SampleAxis {
    double scale, first, step;
};
/// Writes `count` samples as places, computed in double and rounded to float: the same bits on all
/// instruction sets. Room for 16 more is written to.
void sample_places(const float* uv, int count, const SampleAxis& x, const SampleAxis& y, float* to_x,
                   float* to_y);

}  // namespace anamorph::simd
