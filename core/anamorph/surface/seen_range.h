// SPDX-License-Identifier: Apache-2.0
// The place on the screen where a camera sees a part of a surface.
#pragma once

#include <array>
#include <cmath>
#include <iterator>

#include "anamorph/surface/camera.h"
#include "anamorph/surface/surface.h"

namespace anamorph::surface {

/// The Taylor coefficients of the place on the screen, in pixels from its middle, of a part of a surface that
/// has those of `range`. Infinite where a part may not be in front of the camera.
///
/// With X and Z those of the camera's frame and s near X / Z, a place is s + (X - s Z) / Z, where X - s Z is a sum of what
/// `range` says of each coordinate of space once: X and Z by themselves would each be as wide as that makes them.
inline std::array<Jet<Interval, 2>, 2> seen_range(const Camera& camera, const SurfaceRange& range) {
    using J = Jet<Interval, 2>;
    const auto& m = camera.matrix();
    const auto sum = [&](const auto& weight, const Interval& constant) {
        J total(constant);
        for (int axis = 0; axis < 3; ++axis) {
            const Interval times = weight(axis);
            const J& along = range[static_cast<std::size_t>(axis)];
            for (std::size_t n = 0; n < std::size(total.c); ++n) total.c[n] += along.c[n] * times;
        }
        return total;
    };
    const auto in_frame = [&](int i) {
        return sum([&](int axis) { return Interval(m[axis][i]); }, Interval(camera.offset()[i]));
    };
    if (!camera.perspective()) return {J(in_frame(0) * camera.focal()), J(in_frame(1) * camera.focal())};
    glm::dvec3 middle;
    for (int axis = 0; axis < 3; ++axis) {
        const Interval& at = range[static_cast<std::size_t>(axis)].c[0];
        middle[axis] = at.lo / 2 + at.hi / 2;
    }
    middle = camera.in_frame(middle);
    const J ahead = in_frame(2);
    const auto seen = [&](int i) {
        const double near = middle[i] / middle.z;
        const Interval slope(std::isfinite(near) ? near : 0);
        const J beside = sum([&](int axis) { return Interval(m[axis][i]) - slope * Interval(m[axis][2]); },
                             Interval(camera.offset()[i]) - slope * Interval(camera.offset()[2]));
        return J((beside / ahead + J(slope)) * camera.focal());
    };
    return {seen(0), seen(1)};
}

}  // namespace anamorph::surface
