// SPDX-License-Identifier: Apache-2.0
// A body as an observer sees it: its limb, and what of space it hides.
#pragma once

#include <glm/mat3x3.hpp>
#include <span>
#include <string>
#include <vector>

#include "anamorph/figure/outline/outline.h"
#include "anamorph/figure/outline/outline_roots.h"
#include "anamorph/parallel_for.h"

namespace anamorph::figure {

/// A body in the coordinates of View::to_view, with d = p - (a point of the body).
struct SeenBody {
    OutlineKind kind = OutlineKind::whole;
    Ellipse<glm::dvec3> limb;    ///< in the scene
    Ellipse<glm::dvec3> viewed;  ///< the limb as View::to_view gives it; not of a body around the eye
    glm::dvec3 center{0.0};

    /// The body is |unit (p - center)| <= 1, where no axis is zero.
    bool solid = false;
    glm::dmat3 unit{0.0};  ///< unit, transposed: column k is row k

    /// d = p - viewed.center is d.x_row along viewed.cosine, d.y_row along viewed.sine and the rest along the
    /// view ray through viewed.center, of which `beyond` says how far, positive away from the observer. In
    /// perspective that ray's unit is viewed.center itself. Where the limb has no area, `covers` is false.
    bool covers = false;
    glm::dvec3 x_row{0.0}, y_row{0.0}, beyond{0.0};

    glm::dvec2 low{0.0}, high{0.0};       ///< box of the limb on the screen of unit distance
    double nearest = 0;                   ///< depth of the body's nearest point
    double limb_farthest = 0, reach = 0;  ///< greatest depth and greatest absolute coordinate of the limb
    double unit_size = 0, cone_size = 0, beyond_size = 0;  ///< sizes of `unit`, the three rows and `beyond`

    bool seen() const { return kind == OutlineKind::whole || kind == OutlineKind::cut; }
};

/// Throws Error naming the body unless all its values are as `outlines` allows.
void check(const Ellipsoid& body, std::size_t position, const std::vector<std::string>& names);

/// Throws Error unless the point is finite and no larger than 1e25.
void check_point(const std::string& name, const glm::dvec3& point);

SeenBody see(const Ellipsoid& body, const View& view);

/// The bodies as `view` sees them, all checked.
std::vector<SeenBody> see_all(std::span<const Ellipsoid> bodies, const View& view,
                              const std::vector<std::string>& names, const ParallelFor& parallel_for);

}  // namespace anamorph::figure
