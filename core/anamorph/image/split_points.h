// SPDX-License-Identifier: Apache-2.0
// Source points in double as samplers read them: a whole texel, and how far into it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "anamorph/geometry/box.h"

namespace anamorph::simd {

/// Splits `count` points of one coordinate, times `scale`, into the texel that each falls into, less `base`,
/// and the rest as a float below 1, which loses at most half of 2^-24 texels; all of it where float would
/// round it to the next texel. What is split lies within 2^30 texels of 0. Arrays have room for 16 more. The
/// same bits on all instruction sets.
void split_points(const double* points, int count, double scale, std::int32_t base, std::int32_t* texels,
                  float* rests);

/// Rows of values, `stride` entries apart; or of what is to be added to each to come to the one `ahead` entries farther on.
template <class Real>
struct ValueRows {
    const Real* values;
    std::ptrdiff_t stride;
    int width, height;
    std::ptrdiff_t ahead = 0;
};
/// The least and the greatest of at least one value; NaN where one is not a finite number.
struct Ends {
    double low = 0, high = 0;
};
Ends ends_of(const ValueRows<float>& rows);
Ends ends_of(const ValueRows<double>& rows);

/// The texels that may be read: those in `box`. Each pixel reads those up to `reach` <= 2 away from its own,
/// both ways. Rows of `width` texels follow on themselves after `turn`, if that is not 0.
struct Readable {
    Box box;
    int reach, width, turn;
};

/// Counts `count` texels within 2^30 of 0 from the corner of the box. Those whose neighbours all lie beyond the same end of a
/// row that follows on itself go around. Those whose neighbours are not all in the box are `outside`, and come to stand at a
/// texel that may be read. False when there are none for certain. Arrays have room for 16 more.
bool place_in(const Readable& readable, int count, std::int32_t* x, std::int32_t* y, std::int32_t* outside);

}  // namespace anamorph::simd
