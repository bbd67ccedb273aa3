// SPDX-License-Identifier: Apache-2.0
// Light on a surface in space: Gouraud's and Phong's shading (Oka 1987, section 5).
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "anamorph/surface/camera.h"
#include "anamorph/surface/surface.h"

namespace anamorph::surface {

/// How light is added up.
enum class DrapeShading {
    none,
    gouraud,  ///< intensities at the corners of facets, interpolated
    phong     ///< normals at the corners of facets, interpolated
};

/// Lights at infinity, and the numbers by which a surface, lit alike on both sides, reflects them: color
/// (ambient + diffuse sum |n . l|) + specular sum (n . h)^shininess, where a light is on the viewer's side.
struct DrapeLighting {
    DrapeShading shading = DrapeShading::none;
    std::vector<glm::dvec3> lights = {{0, 0, 1}};  ///< directions towards them, of length 1
    double ambient = 0.2, diffuse = 0.8, specular = 0, shininess = 20;
};

/// What light depends on at a point, in space: the unit normal on the viewer's side, 0 where there is none, and the unit direction
/// from the viewer to the point.
struct LitPoint {
    glm::dvec3 normal, ray;
};
LitPoint lit_point(const DrapedSurface& surface, const Camera& camera, double u, double v);

/// What light makes of a colour: share times it, and the highlight.
struct Light {
    float share = 0, highlight = 0;
};
Light light_at(const DrapeLighting& lighting, const LitPoint& point) noexcept;

/// Lights a pixel. `alpha`: its channel of alpha, which stays, or -1. `multiplied`: colours are multiplied by it; what is not there
/// does not shine.
void add_light(const Light& light, float* pixel, int channels, int alpha, bool multiplied) noexcept;

}  // namespace anamorph::surface
