// SPDX-License-Identifier: Apache-2.0
// The blocks of a morph's maps with their points, for tests and benchmarks.
#pragma once

#include "anamorph/image/block_reader.h"
#include "anamorph/morph/feature_blocks.h"

namespace anamorph {

/// Calls visit(shape, block, points) for the blocks of a region, place by place and layer by layer; those of
/// exact blocks have no points.
template <class Visit>
void each_feature_block(const FeatureBlocks& map, std::int64_t region, const Visit& visit) {
    const auto layers = static_cast<std::size_t>(map.layers());
    const BlockPlanes planes(layers);
    const SharedBlocks blocks = map.blocks(region);
    for (std::size_t i = 0; i < blocks.size(); i += layers) {
        const bool computed = blocks[i].kind == Block::Kind::computed;
        if (computed) map.computed({&blocks[i], layers}, planes.rows());
        for (std::size_t k = 0; k < layers; ++k)
            visit(map.shapes()[k], blocks[i + k], computed ? planes.points(k) : BlockPoints{});
    }
}

/// Calls visit(shape, block, points) for the blocks of all regions.
template <class Visit>
void each_feature_block(const FeatureBlocks& map, const Visit& visit) {
    for (std::int64_t region = 0; region < map.regions(); ++region) each_feature_block(map, region, visit);
}

}  // namespace anamorph
