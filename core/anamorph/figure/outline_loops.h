// SPDX-License-Identifier: Apache-2.0
// Loops of a quadric's intersection with the unit sphere.
#pragma once

#include <functional>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace anamorph {

/// The curve |u| = 1, |matrix u + offset| = 1.
struct SphereCurve {
    glm::dmat3 matrix{1.0};
    glm::dvec3 offset{0.0};
    double noise = 0;  ///< |matrix u + offset|^2 - 1 is zero below this

    double at(const glm::dvec3& u) const {
        const glm::dvec3 v = matrix * u + offset;
        return glm::dot(v, v) - 1;
    }
};

/// The curve as closed polylines, their points on it. `holds(u, radius, deviation)` says whether a chord may
/// be that far off (in the sphere's units), all within `radius` of u. Loops may be left out, or joined where
/// they come near each other, within a distance that holds.
std::vector<std::vector<glm::dvec3>> loops_of(
    const SphereCurve& curve,
    const std::function<bool(const glm::dvec3& u, double radius, double deviation)>& holds);

}  // namespace anamorph
