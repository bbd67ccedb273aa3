// SPDX-License-Identifier: Apache-2.0
// The source points that a block gives its pixels.
#pragma once

#include <vector>

#include "anamorph/image/block_reader.h"
#include "anamorph/image/block_sampler.h"

namespace anamorph::test {

/// Does a block give its pixels points: by a polynomial, or direct?
inline bool has_points(const Block& block) {
    return block.kind != Block::Kind::exact && block.kind != Block::Kind::outside;
}

/// The points of row j of a block; a block may have none.
class BlockRow {
  public:
    BlockRow(const BlockMap& map, const Block& block, int j) : m_block(block) {
        if (!has_points(block)) return;
        if (in_double(block))
            m_points.read(map, block, j - block.box.y0, j - block.box.y0 + 1);
        else
            block_row(map, block, block.box, j, m_x, m_y);
    }
    /// The point of pixel i of the picture.
    Point<double> at(int i) const {
        const int k = i - m_block.box.x0;
        if (in_double(m_block)) return m_points.at(k, 0);
        return {m_block.base_x + double{m_x[k]}, m_block.base_y + double{m_y[k]}};
    }

  private:
    const Block& m_block;
    float m_x[simd::kRowRoom], m_y[simd::kRowRoom];
    PointsInDouble m_points;
};

}  // namespace anamorph::test
