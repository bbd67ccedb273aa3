// SPDX-License-Identifier: Apache-2.0
// The pixels of a block as they are read near its middle, and what becomes of their source points' errors when it is drawn.
#pragma once

#include <cmath>
#include <type_traits>

#include "anamorph/geometry/point.h"
#include "anamorph/number/near_bound.h"

namespace anamorph {

/// The pixels of a block about (x, y), their centres up to half_width and half_height away, as the first bases that are written.
template <class Real>
Point<NearBound<Real>> pixels_near(double x, double y, double half_width, double half_height) {
    using R = RestBound<Real>;
    const NearBound<Real> px(WrittenBase::input(x), R(0, half_width, 0)),
        py(WrittenBase::input(y), R(0, half_height, 0));
    return {px, py};
}

/// Bounds the error of a coordinate. `period`: source pixels after which it comes back to the same place, or 0.
template <class Real>
double drawn_error(const NearBound<Real>& found, double period) {
    using R = RestBound<Real>;
    if constexpr (std::is_same_v<Real, double>) {
        // Source pixels: the middle, which may be moved by whole turns, and what is added to it.
        const double farthest = std::fabs(found.base.value) + found.rest.size() + period;
        return found.rest.error + 2 * R::kUnit * farthest;
    } else {
        // The middle counts from the block's base, which is less than a pixel away, a hair aside. The sum is rounded,
        // and once more when the sampler moves it by half a pixel (image/block_sampler.h).
        const R offset = R::result(0.5, 1.5, 0, R::kUnit) + found.rest;
        return offset.error + R::kUnit * (offset.computed_size() + 1);
    }
}

}  // namespace anamorph
