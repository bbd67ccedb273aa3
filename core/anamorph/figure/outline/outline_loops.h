// SPDX-License-Identifier: Apache-2.0
// Loops of a quadric's intersection with the unit sphere.
#pragma once

#include <functional>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace anamorph::figure {

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

/// The distance, in the sphere's units, that chords within `radius` of u may have from the curve.
using AllowedDeviation = std::function<double(const glm::dvec3& u, double radius)>;

/// The curve as closed polylines, their points on it, one for each of its loops. Loops may be left out, or
/// joined where they come near each other, only where they are smaller or nearer than a small part of what is
/// allowed.
std::vector<std::vector<glm::dvec3>> loops_of(const SphereCurve& curve, const AllowedDeviation& allowed);

/// The curve's point beside the part `s` of the chord from p to q, two neighbours of a loop.
glm::dvec3 point_between(const SphereCurve& curve, const glm::dvec3& p, const glm::dvec3& q, double s);

}  // namespace anamorph::figure
