// SPDX-License-Identifier: Apache-2.0
// Ellipses by their centre and two conjugate half-axes, in the plane or in space.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace anamorph::figure {

/// An ellipse: the points center + cosine cos(t) + sine sin(t). Vector: glm::dvec2 or glm::dvec3.
template <class Vector>
struct Ellipse {
    Vector center{0.0}, cosine{0.0}, sine{0.0};

    /// The point at the parameter t, in radians.
    Vector operator()(double t) const { return center + cosine * std::cos(t) + sine * std::sin(t); }
    /// The derivative of the point by t.
    Vector tangent(double t) const { return sine * std::cos(t) - cosine * std::sin(t); }
};

/// The principal axes of an ellipse in the plane: the point at parameter s on them is the one at t = s + shift.
struct PrincipalAxes {
    double major = 0, minor = 0;  ///< half-lengths
    double angle = 0;             ///< angle of the major axis against x, radians, in (-pi/2, pi/2]
    double shift = 0;             ///< the major axis ends at t = shift
    bool mirrored = false;        ///< t runs from x to -y
};

/// Finds the principal axes of an ellipse. 2 shift is the argument of (|cosine|^2 - |sine|^2, 2 cosine.sine): there the
/// distance from the centre is largest.
inline PrincipalAxes principal_axes(const Ellipse<glm::dvec2>& e) {
    PrincipalAxes axes;
    axes.shift = 0.5 * std::atan2(2 * glm::dot(e.cosine, e.sine),
                                  glm::dot(e.cosine, e.cosine) - glm::dot(e.sine, e.sine));
    glm::dvec2 major = e.cosine * std::cos(axes.shift) + e.sine * std::sin(axes.shift);
    if (major.x < 0 || (major.x == 0 && major.y < 0)) {
        major = -major;
        axes.shift += std::acos(-1.0);
    }
    axes.major = glm::length(major);
    const double area = e.cosine.x * e.sine.y - e.cosine.y * e.sine.x;
    axes.minor = axes.major > 0 ? std::fabs(area) / axes.major : 0;
    axes.angle = std::atan2(major.y, major.x);
    axes.mirrored = area < 0;
    return axes;
}

}  // namespace anamorph::figure
