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
/// the tolerance is what comes out: a block's bound is, axis by axis, by Taylor's formula (2.9),
///     H d / 2 r_uu + K d / 2 r_vv + |[0, H^2] g_uu + 2 [-H K, H K] g_uv + [0, K^2] g_vv| / 2
/// where H and K are half of the parallelogram's sides, the derivatives of g, the map to the screen, are intervals over the
/// differences' reach and the parallelogram, and the first two terms are what the differences are off the derivatives: with
/// g_uu = m + r, |r| <= r_uu, a11 - g_u is an integral of s (r(u + s) - r(u - s)) / (2 d) over 0 to d. Infinite where that is
/// not known. Blocks with a point that is not in front of the camera are left out. Throws Error where there are more than four million blocks.
Facets oka_facets(const DrapedSurface& surface, const Camera& camera, const Size& picture,
                  const OkaBlocks& blocks);

}  // namespace anamorph
