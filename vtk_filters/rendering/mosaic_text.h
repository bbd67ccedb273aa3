// SPDX-License-Identifier: Apache-2.0
// The shaders' text that throws concentric mosaics (Shum and He 1999; Kim 2003, 7.2).
#pragma once

#include <string>

#include "anamorph/panorama/concentric.h"

namespace anamorph_vtk {

/// The GLSL function anamorphPaint# of a stack of panoramas in the texture anamorphPanorama#, whose circles are `radius` wide in the scene; it needs
/// panorama_glsl_prelude() and anamorphFade# before it, and the uniform vec4 anamorphViewer#: the viewpoint in radii, and 1; or where a
/// parallel view comes from, and 0. `mipmaps`: has the texture levels?
/// `rgba`: the expression of what a
/// texel `colour` is in red, green, blue and alpha.
std::string mosaic_function(const anamorph::Chart& panorama, const anamorph::ConcentricStack& stack,
                            double radius, bool mipmaps, const std::string& rgba);

}  // namespace anamorph_vtk
