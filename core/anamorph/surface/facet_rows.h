// SPDX-License-Identifier: Apache-2.0
// Draws triangles to planes of points: which pixel's centre lies in which of them, nearest first.
#pragma once

#include <cstddef>

namespace anamorph::surface::simd {

/// A triangle as its edges' functions e_0, e_1 and e_2, integers up to 2^53 at all pixels and linear in them. A pixel
/// whose e_i are all at least `least_i` is in it. There its nearness is sum e_i nearness_i, and its point
/// (sum e_i u_i, sum e_i v_i) / sum e_i weight_i.
struct FacetSetup {
    double e[3];               ///< e_i at the first pixel of the box it is drawn in
    double right[3], down[3];  ///< steps from pixel to pixel
    double least[3];           ///< 1, or 0 where pixels on the edge belong to it
    double nearness[3], weight[3], u[3], v[3];
    double id;
};

/// The planes of a box of pixels; rows have room for 16 more, which are not changed.
struct FacetPlanes {
    double *nearness, *u, *v, *id;
    std::ptrdiff_t stride;
};

/// Draws width x height pixels from the planes' first on, where the triangle is nearer than what is there. The same bits
/// on all instruction sets.
void draw_facet(const FacetSetup& facet, int width, int height, const FacetPlanes& to);

}  // namespace anamorph::surface::simd
