// SPDX-License-Identifier: Apache-2.0
// Bodies as spheres along their limbs, for renderers that know only spheres (Badler's bubbles).
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "anamorph/figure/body/ellipsoid.h"
#include "anamorph/figure/body/figure_rows.h"

namespace anamorph::figure {

/// A sphere, in units of the scene.
struct Sphere {
    glm::dvec3 center{0.0};
    double radius = 0;
};

/// How closely spheres have to fill a body.
struct SphereOptions {
    /// Maximum distance of the body's surface from the spheres, in units of the scene.
    double tol = kSphereTolRow.standard;
    int most_spheres = 10000;  ///< for one body; where tol needs more, `deviation` says what was reached
};

/// The spheres that stand for a body.
struct SphereFill {
    std::vector<Sphere> spheres;  ///< the largest about their centres in the body; all touch its surface
    double deviation = 0;         ///< the largest distance of the surface from the nearest sphere
};

/// Fills a body with spheres. Those of a body with half-axes a >= b >= c have their centres on its medial surface, an
/// ellipse with half-axes (a^2 - c^2) / a and (b^2 - c^2) / b: a line where b = c, a point where all are equal. Throws
/// Error when a value is not finite or larger than 1e25, tol is not positive or most_spheres is less than 1.
SphereFill fill_with_spheres(const Ellipsoid& body, const SphereOptions& options = {});

}  // namespace anamorph::figure
