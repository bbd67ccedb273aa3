// SPDX-License-Identifier: Apache-2.0
// Projection planes of a view of an upright panorama (Kim 2003, 4.2 to 4.5). The screen's rectangle is projected onto a plane at
// distance 1 from the panorama's middle, across a level direction of projection: with pitch it is a trapezoid there. On the
// plane, linear texture coordinates (eq. 4.3) have residuals (4.4) that do not depend on where the camera looks.
//
// Eye coordinates (X, Y) of a screen point are its ray's right and down parts for one part forward. Coordinates of a plane are
// (x', y'), right and down, so that b of eq. 4.5 has no minus.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <vector>

#include "anamorph/panorama/panorama.h"

namespace anamorph::machine {

/// A projection plane, the part of the screen that is drawn by it, and the linear part of what is seen there.
struct ProjectionPlane {
    /// Right, down and the direction of projection, as columns in the frame of the source's rays.
    glm::dmat3 axes{1};
    /// Its product with an eye ray (X, Y, 1) is (x' q, y' q, q): M_rot of eq. 4.5. q is above 0 on the part.
    glm::dmat3 from_eye{1};
    /// The corners of the part, a convex one, in eye coordinates and in order around it.
    std::vector<glm::dvec2> corners;
    double x_max = 0, y_max = 0;  ///< |x'| and |y'| go up to these on the part, or as was asked for
    /// The linear part in texture coordinates: centre + (x' right, y' down). `right` is a and `down` is b of eq. 4.3.
    glm::dvec2 centre{0};
    double right = 0, down = 0;
};

/// How planes are laid through a view.
struct PlaneOptions {
    int count = 1;  ///< as many directions of projection; the view is cut between them by azimuth, evenly
    double x_max = 0,
           y_max =
               0;  ///< ranges of x' and y' that coefficients and bump maps are made for; 0: those of the view
};

/// Throws Error naming `machine` where a source's columns are no azimuths, as it must have for planes (projection_planes(), check_on_scene()).
void check_bump_source(const Chart& source);

/// Lays planes through a view. The direction of a single one is the level part of where the camera looks (4.5).
///
/// Throws Error naming `machine` where the scheme has no meaning: of targets other than rectilinear ones without a lens
/// and sources whose columns are no azimuths; where a part of the view is 90 degrees or more from its direction, beyond the
/// plane; where a range that was asked for is less than the view's; and where residuals are larger than the texture, beyond all
/// that a bump map holds.
std::vector<ProjectionPlane> projection_planes(const Panorama& view, const PlaneOptions& options = {});

/// The residual (eq. 4.4) at a point of a plane, in texture coordinates.
glm::dvec2 plane_residual(const Chart& source, const ProjectionPlane& plane, double x, double y);

/// The eye coordinates of the corners of a rectilinear picture: left upper and right lower.
struct EyeCorners {
    glm::dvec2 first, last;
};
EyeCorners eye_corners(const Chart& target);

}  // namespace anamorph::machine
