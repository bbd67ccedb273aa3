// SPDX-License-Identifier: Apache-2.0
// The map from a ray to a panorama (projector.h; Kim 2003, eq. 4.1 for cylinders) as a function of GLSL: what
// Projector::receive() finds, once a fragment. The formulas of chart/projection/ write it themselves (number/glsl_number.h), with
// their derivatives: these lead to the level of detail on each face by itself, so that no seam shows.
#pragma once

#include <string>
#include <string_view>

#include "anamorph/chart/chart.h"

namespace anamorph {

/// The GLSL functions that those of panorama_glsl() call; they belong once in a shader, before them.
std::string_view panorama_glsl_prelude();

/// The text of a definition for a shader of GLSL 1.50 or later, of
///
///   bool NAME(vec3 ray, vec3 right, vec3 up, out vec2 texel, out vec2 alongRight, out vec2 alongUp)
///
/// `ray`: in the frame of rays (chart/chart.h), of any length; `right` and `up`: its differences to the next fragments. The
/// function sets `texel`, in pixels of the panorama, x right and y down, and its differences to the next fragments. It
/// returns false where the ray is not in the panorama, or has no direction. Lenses that need a root get 10 steps of
/// Newton's iteration.
std::string panorama_glsl(const Chart& panorama, const std::string& name);

}  // namespace anamorph
