// SPDX-License-Identifier: Apache-2.0
// The locally linear approximation of Oka et al. 1987: the picture in square blocks, each drawn as a parallelogram.
#pragma once

#include "anamorph/drape/facets.h"

namespace anamorph {

/// How a picture is cut into blocks.
struct OkaBlocks {
    double side = 8;       ///< d, pixels of the picture
    double overlap = 0.5;  ///< width of the common area of two neighbours, pixels of the picture
    /// Depth within a block: false, that of its centre, so that nearer blocks are drawn over farther ones (section 3); true,
    /// linear (section 5).
    bool linear_depth = false;
};

/// A block of the picture and its linear map: x, y (pixels from the middle of the screen) and depth of its centre, and what
/// they gain by u and by v.
struct OkaBlock {
    double u, v;            ///< its centre
    double u0, u1, v0, v1;  ///< its rectangle and its share of the common area, within the picture
    glm::dvec3 centre, by_u, by_v;
};

/// Blocks across and down a picture. Throws Error where there are more than four million.
Size oka_block_count(const Size& picture, const OkaBlocks& blocks);
/// Block (i, j). False where one of its points is not in front of the camera.
bool oka_block(const DrapedSurface& surface, const Camera& camera, const Size& picture,
               const OkaBlocks& blocks, int i, int j, OkaBlock& block);

/// Two facets for each parallelogram: the block's linear map (2.8), whose matrix comes from central differences
/// (2.4 to 2.7) over the block's side, on the block and half of the common area around it. Neighbours need not meet, and
/// the tolerance is what comes out: a block's bound (Facets::bound_of) is, axis by axis, by Taylor's formula (2.9) about
/// its centre, of g, the map to the screen, and the linear map a that is drawn, whatever it is made of,
///     |g - a0 + (g_u - a1) s + (g_v - a2) t + g_uu s^2 / 2 + g_uv s t + g_vv t^2 / 2|
/// with g, g_u and g_v at the centre, and for (s, t) in each quarter of the block a mean of the second derivatives over
/// that quarter, which the way from the centre does not leave, and over the half of it that is next to the centre. Infinite
/// where that is not known. Blocks with a point that is not in front of the camera are left out. The surface outlives the
/// facets. Throws Error where there are more than four million blocks.
Facets oka_facets(const DrapedSurface& surface, const Camera& camera, const Size& picture,
                  const OkaBlocks& blocks);

}  // namespace anamorph
