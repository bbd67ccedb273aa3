// SPDX-License-Identifier: Apache-2.0
#include "anamorph/approx/near_far.h"

#include <cmath>
#include <cstdio>

#include "anamorph/error.h"

namespace anamorph {

struct NearFar::State {
    const FeatureMap& map;
    NearFarOptions options;
};

NearFar::NearFar(const FeatureMap& map, const NearFarOptions& options) {
    if (!(options.tol >= 0 && options.tol < HUGE_VAL)) {
        char text[32];
        std::snprintf(text, sizeof text, "%g", options.tol);
        throw Error("tol", text, "allowed is 0 (exact) or a finite number of source pixels above it");
    }
    m_state = std::make_unique<State>(State{map, options});
}
NearFar::~NearFar() = default;

void NearFar::each_block(const Box& region, const Box& part, const Visit& visit) const {
    Block block;
    for (int y = region.y0; y < region.y1; y += Block::kMaxSide)
        for (int x = region.x0; x < region.x1; x += Block::kMaxSide) {
            block.box = intersection({x, y, x + Block::kMaxSide, y + Block::kMaxSide}, region);
            if (intersection(block.box, part).empty()) continue;
            for (const int k : m_state->options.shapes) visit(k, block, {});
        }
}

CellField::Tally NearFar::tally(const Box& region) const {
    return {0, std::int64_t{region.width()} * region.height()};
}

}  // namespace anamorph
