// SPDX-License-Identifier: Apache-2.0
// Concentric mosaics as shaders find them, by the formulas of panorama/concentric.h.
#pragma once

#include <string>

#include "anamorph/panorama/concentric.h"

namespace anamorph {

/// Four functions of GLSL, which need panorama_glsl_prelude() before them, of a ray `r` in the frame of the circles' panoramas and a viewpoint
/// `p`, right and ahead in radii of the outer circle:
///     float NAMEOffset(vec3 r, vec2 p)                    which circle a line of sight touches, by its radius
///     float NAMEFirst(float offset, out float weight)     the number of the lower of the two circles beside an offset, and the weight
///                                                         of the upper one
///     float NAMERadius(float circle)                      the radius of a circle
///     vec2 NAMETexel(vec3 r, vec2 p, float slit)          the texel of the circle of radius `slit` times the depth
/// A ray must not be vertical. Of the stack its viewpoint is not read. What the slit of radius q shows of a point of which is known where
/// it is, at the distance d from the vertical axis, is NAMETexel(point, vec2(0), q / d), at any depth.
std::string concentric_glsl(const Chart& panorama, const ConcentricStack& stack, const std::string& name);

}  // namespace anamorph
