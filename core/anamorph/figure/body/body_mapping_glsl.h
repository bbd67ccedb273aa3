// SPDX-License-Identifier: Apache-2.0
// The place of a point of a body on its texture, as a function of GLSL: the formulas of body_mapping.h write
// it themselves (number/glsl_number.h), with their derivatives, so that no seam shows.
#pragma once

#include <string>

#include "anamorph/figure/body/body_mapping.h"

namespace anamorph::figure {

/// Definitions for a shader of GLSL 1.50 or later, of what the function calls and of
///
///   void NAME(vec3 p, vec3 a, vec3 b, out vec2 uv, out vec2 alongA, out vec2 alongB)
///
/// `p`: the point of the unit sphere in the body's own axes; `a` and `b`: how it changes from a fragment to the next ones. Set
/// are texture_point() of it, v down, and how that changes.
std::string body_mapping_glsl(BodyMapping mapping, const std::string& name);

}  // namespace anamorph::figure
