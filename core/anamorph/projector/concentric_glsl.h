// SPDX-License-Identifier: Apache-2.0
// Concentric mosaics as shaders find them, by the formulas of panorama/concentric.h.
#pragma once

#include <string>

#include "anamorph/chart/chart.h"

namespace anamorph {

/// Two functions of GLSL, which need panorama_glsl_prelude() before them, of a ray `r` in the frame of the circles' panoramas and a viewpoint
/// `p`, right and ahead in radii of the outer circle:
///     float NAMEOffset(vec3 r, vec2 p)             which circle a line of sight touches, by its radius
///     vec2 NAMETexel(vec3 r, vec2 p, float slit)   the texel of that of radius `slit` times the depth
/// A ray must not be vertical. `depth`: that of the scene (ConcentricStack).
std::string concentric_glsl(const Chart& panorama, double depth, const std::string& name);

}  // namespace anamorph
