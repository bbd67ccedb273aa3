// SPDX-License-Identifier: Apache-2.0
// The map that features make (feature_lines.h; Kim 2003, eq. 5.9 to 5.11) as a function of GLSL: every fragment sums over all lines.
// The templates of feature_formula.h write it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "anamorph/morph/feature_lines.h"

namespace anamorph {

/// The most lines that are drawn so: what cards have room for in uniforms.
inline constexpr int kMostFragmentLines = 192;
/// The vectors of four that a line has there.
inline constexpr int kVectorsOfLine = 5;

/// The numbers of all lines of a map, kVectorsOfLine vectors for each, with the displacements for two shapes. Throws Error where there
/// are more than kMostFragmentLines.
std::vector<std::array<float, 4>> line_uniforms(const FeatureMap& map, const std::array<int, 2>& shapes);

/// The exponents b that have a text of their own; all others have one in common. Returns b, or -1 for these.
double own_exponent(double b);

/// The text of a definition for a shader of GLSL 1.50 or later, of
///
///   vec4 NAME(vec2 at, vec2 weight, vec4 scale)
///
/// It reads a uniform `vec4 NAMELines[kVectorsOfLine * lines]`, those of line_uniforms(). `at`: a point of the target, in pixels;
/// `weight`: a and b of eq. 5.11; `scale`: FeatureMap::scale() of both shapes. It returns the source points in both shapes' pictures.
/// `exponent`: what own_exponent() says of b.
std::string feature_glsl(const std::string& name, std::size_t lines, double exponent);

/// The largest distance of what that function returns from the lines' exact formula, in pixels of the shapes' pictures, at any pixel of
/// the target (near_far_exact.h). Refined by at most so many parts of it, which take some 20 microseconds each where there are 64 lines.
double feature_glsl_bound(const FeatureMap& map, const std::array<int, 2>& shapes,
                          std::size_t most_boxes = 1024);

}  // namespace anamorph
