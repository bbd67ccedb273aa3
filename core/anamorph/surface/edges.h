// SPDX-License-Identifier: Apache-2.0
// The pixels that a silhouette, a border of the surface or a seam goes through, and what samples of them
// show.
#pragma once

#include <cstdint>
#include <vector>

#include "anamorph/surface/drape_map.h"

namespace anamorph::surface {

/// A part of a pixel that shows one patch.
struct EdgePart {
    std::uint32_t facet;  ///< one of the patch's facets
    double x, y, u, v;    ///< the mean of its samples, on the screen and in 0 to 1 on the picture
    double share;         ///< share of the pixel
};

/// A pixel with an edge; what its parts lack to 1 shows nothing.
struct EdgePixel {
    int x, y;
    std::vector<EdgePart> parts;

    /// The share of the pixel that shows anything.
    float covered() const {
        float sum = 0;
        for (const EdgePart& part : parts) sum += static_cast<float>(part.share);
        return sum;
    }
};

/// The number of samples of an edge pixel either way.
inline constexpr int kEdgeSamples = 8;

/// Finds the edge pixels of `part` of a region.
std::vector<EdgePixel> edges_in(const DrapeMap& map, const SeenRegion& region, const Box& part);

}  // namespace anamorph::surface
