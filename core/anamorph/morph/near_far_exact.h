// SPDX-License-Identifier: Apache-2.0
// The rounding of pixels of a morph that are evaluated in double.
#pragma once

#include <vector>

#include "anamorph/morph/feature_lines.h"

namespace anamorph {

/// The error of a line as FeatureMap, in double, sees it at points of a box, in the target's pixels.
struct LineOff {
    double distance;      ///< a + dist
    double displacement;  ///< the displacement of the line
};
/// Bounds the error of line i at points of a box. `rho`: at least the points' distance from the line's p.
/// `farthest`: at least |x| + |y| of each.
LineOff line_off(const FeatureMap& map, std::size_t i, double rho, double farthest);

/// The most by which FeatureMap, in double, is off from the lines' exact formula at the pixels of a box, for
/// any of `shapes`, in pixels of their pictures. With a = 0 the map jumps where lines cross: where the
/// distance of several from a pixel's centre is nothing but rounding the bound is as large as what they say
/// differs, unless all of these are found at distance 0 and certainly pass through it
/// (FeatureMap::passes_through). Refined by parts of the box until it is below `tol`, unless a pixel shows that it
/// cannot be.
double exact_bound(const FeatureMap& map, const std::vector<int>& shapes, const Box& box, double tol);

/// The same for the formula as a shader computes it in floats, of lines whose numbers are floats (morph/feature_glsl.h). Proven for
/// shaders that round as GLSL 4.1 and later demand, 4.7.1 of its specification. Refined by at most so many parts of the box.
double shader_bound(const FeatureMap& map, const std::vector<int>& shapes, const Box& box,
                    std::size_t most_boxes);

}  // namespace anamorph
