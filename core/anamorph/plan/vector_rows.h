// SPDX-License-Identifier: Apache-2.0
// Exact blocks of maps that compute rows by vectors.
#pragma once

#include "anamorph/plan/block.h"

namespace anamorph {

/// Finds rows [begin, end) of a block by map.exact_row(x, y, count, to_x, to_y, piece), which gives the
/// points (x + i, y).
template <class Map>
void exact_rows_by_vectors(const Map& map, const Block& block, int begin, int end, const DoubleRows& to) {
    for (int row = begin; row < end; ++row) {
        const std::ptrdiff_t at = (row - begin) * to.stride;
        map.exact_row(block.box.x0 + 0.5, block.box.y0 + row + 0.5, block.box.width(), to.x + at, to.y + at,
                      to.piece + at);
    }
}

}  // namespace anamorph
