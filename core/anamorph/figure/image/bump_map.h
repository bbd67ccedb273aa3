// SPDX-License-Identifier: Apache-2.0
// Wrinkles: a picture of heights around a body, which turn its normals (Blinn 1978).
//
// With the unit normal n, the height F along it and its gradient g in space, the surface P + F n has, but for F times how n turns, the
// normal n - (g - (g.n) n): Blinn's N + (F_u (N x P_v) - F_v (N x P_u)) / |N|, by no directions of u and v, which have none at poles.
// Heights are means over what a pixel shows, and slopes differences of these, a texel to either side or half of what the pixel
// shows: what is finer than a pixel leaves no slope, and does not make the surface duller either.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "anamorph/figure/body/body_mapping.h"
#include "anamorph/figure/image/seen_surface.h"
#include "anamorph/image/border.h"
#include "anamorph/image/footprint.h"
#include "anamorph/image/point_sampler.h"

namespace anamorph::figure {

/// Reads the heights around bodies. Each thread needs its own. Keeps a reference to the source.
class BumpMap {
  public:
    BumpMap(const Source& source, BodyMapping mapping);

    /// The gradient of the brightness, the mean of up to three channels, by the point of the unit sphere in the body's own axes, at
    /// what is seen at (x, y). 0 where the source cannot be read, and where a slope is no number.
    glm::dvec3 gradient(const SeenSurface& surface, double x, double y, bool far_side);

  private:
    bool height(const Jacobian& jacobian, double u, double v, double& height);

    const Source& m_source;
    BodyMapping m_mapping;
    Border m_border;
    FootprintChooser m_chooser;
    PointSampler m_sampler;
    std::vector<float> m_pixel;
};

/// The unit normal `n` of a surface that is raised by heights with the gradient `g` in space.
inline glm::dvec3 bumped(const glm::dvec3& n, const glm::dvec3& g) {
    const glm::dvec3 turned = n - (g - glm::dot(g, n) * n);
    const double length = glm::length(turned);
    return length < HUGE_VAL ? turned / length : n;
}

}  // namespace anamorph::figure
