// SPDX-License-Identifier: Apache-2.0
// Bounds the reach of vectors along axes, where no more is known of them than a range.
#pragma once

namespace anamorph::surface::simd {

/// All vectors within `radius` of `middle`, coordinate by coordinate.
struct FloatRange {
    float middle[3], radius[3];
};

/// Three axes a of space, coordinate by coordinate: coordinates[i][k] is the i-th of axis k. The last column is 0.
struct Axes {
    double coordinates[3][4];
};

/// Bounds |a . v| for the vectors v of each range and each axis: |a . middle| + |a| . radius.
void reach_along(const Axes& axes, const FloatRange* ranges, int count, double (*reach)[4]);

}  // namespace anamorph::surface::simd
