// SPDX-License-Identifier: Apache-2.0
// The map of a control mesh that pulls (mesh.h; Kim 2003, eq. 5.3) as a function of GLSL: every fragment evaluates the Hermite patch
// of its cell. hermite_sum() writes it, and bounds what the floats of a shader make of it.
//
// Each cell is drawn as the rectangle of the pixels whose centres it holds, so that a fragment needs not look for its cell: its
// corners are whole numbers, which no rasterizer moves over a centre.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/mesh/mesh.h"

namespace anamorph {

/// The numbers of a cell that its fragments have in common.
struct CellFragments {
    /// The pixels whose centres the cell holds.
    Box pixels;
    /// The elements of Patch::g row by row, x and y of each: eight vectors of four.
    std::array<float, 32> patch;
    /// s and t in the centre of the first pixel, and by how much they grow from pixel to pixel.
    std::array<float, 4> parameters;
};

/// The most cells that are drawn so.
inline constexpr int kMostFragmentCells = 1 << 14;

/// The cells of a mesh that hold centres of pixels. Throws Error where there are more than kMostFragmentCells.
std::vector<CellFragments> cell_fragments(const Mesh& mesh);

/// The text of a definition for a shader of GLSL 1.50 or later, of
///
///   vec2 NAME(vec4 g[8], vec4 parameters, vec2 first, vec2 scale, vec2 pixel)
///
/// `g` and `parameters`: those of CellFragments; `first`: the upper left one of its pixels; `scale`: Mesh::scale(). It returns the
/// point of the source, in pixels from its upper left corner, y down, of the centre of `pixel`, counted in whole numbers.
std::string mesh_glsl(const std::string& name);

/// The largest distance of what that function returns from the exact map of the given numbers, at any pixel, in pixels of "to".
/// Proven for shaders whose sums and products are rounded correctly, as GLSL 4.1 and later demand; a sum and a product may be
/// rounded once together. Infinite where floats overflow.
double mesh_glsl_bound(const Mesh& mesh);

}  // namespace anamorph
