// SPDX-License-Identifier: Apache-2.0
// An ellipsoid in space: the points c + R diag(a) x with |x| <= 1.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace anamorph::figure {

/// An ellipsoid: the points center + rotation diag(axes) x with |x| <= 1.
struct Ellipsoid {
    glm::dvec3 center{0.0};    ///< c, in the units of the scene
    glm::dvec3 axes{1.0};      ///< a: half the lengths along its own axes, in the same units; not negative
    glm::dmat3 rotation{1.0};  ///< R: column k is the direction of its axis k

    bool operator==(const Ellipsoid&) const = default;
};

}  // namespace anamorph::figure
