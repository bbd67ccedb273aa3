// SPDX-License-Identifier: Apache-2.0
// The test whether two ellipsoids meet, exactly: the contact function of Perram and Wertheim (1985).
#pragma once

#include <algorithm>
#include <glm/vec3.hpp>

#include "anamorph/figure/body/ellipsoid.h"

namespace anamorph::figure {

struct EllipsoidContact {
    /// Scaled about their centres by this factor, both touch from outside: below 1 they
    /// share inner points, at 1 they touch, above they are apart. It is the square root of
    ///     F = max over 0 < l < 1 of l (1 - l) r^T ((1 - l) A + l B)^-1 r
    /// with r from the first centre to the second, and A, B = R diag(a^2) R^T of each.
    double ratio = 0;
    /// The normal of the plane that then touches both, of length 1, from the first towards the second.
    glm::dvec3 normal{0, 1, 0};
    /// The width of the slab square to `normal` that keeps them apart: at most their distance; negative
    /// where they overlap.
    double gap = 0;
};

/// Finds the contact of two ellipsoids. The relative error of `ratio` is below 1e-12 for axes that differ by
/// up to 1e8. An axis shorter than 1e-18 of the longest of both counts as that.
EllipsoidContact contact_of(const Ellipsoid& first, const Ellipsoid& second) noexcept;

/// The distance that an ellipsoid reaches from its centre in a direction of length 1: |diag(a) R^T n|.
double reach_of(const Ellipsoid& ellipsoid, const glm::dvec3& direction) noexcept;

/// The longest of three half axes.
inline double longest(const glm::dvec3& axes) {
    return std::max({axes.x, axes.y, axes.z});
}

}  // namespace anamorph::figure
