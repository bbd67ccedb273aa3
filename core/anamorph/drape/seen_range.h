// SPDX-License-Identifier: Apache-2.0
// Where a camera sees a part of a surface.
#pragma once

#include <array>

#include "anamorph/drape/camera.h"
#include "anamorph/map/surface.h"

namespace anamorph {

/// Taylor coefficients of the place on the screen, in pixels from its middle, of what has those of `range`. Infinite where
/// a part may not be in front of the camera.
inline std::array<Jet<Interval, 2>, 2> seen_range(const Camera& camera, const SurfaceRange& range) {
    using J = Jet<Interval, 2>;
    J in_frame[3];
    for (int i = 0; i < 3; ++i)
        in_frame[i] = range[0] * camera.matrix()[0][i] + range[1] * camera.matrix()[1][i] +
                      range[2] * camera.matrix()[2][i] + camera.offset()[i];
    const auto seen = [&](const J& coordinate) {
        return J((camera.perspective() ? coordinate / in_frame[2] : coordinate) * camera.focal());
    };
    return {seen(in_frame[0]), seen(in_frame[1])};
}

}  // namespace anamorph
