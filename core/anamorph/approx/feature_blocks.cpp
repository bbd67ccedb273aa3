// SPDX-License-Identifier: Apache-2.0
#include "anamorph/approx/feature_blocks.h"

#include <algorithm>
#include <utility>

#include "anamorph/approx/near_far_exact.h"
#include "anamorph/simd/feature_rows.h"

namespace anamorph {

FeatureBlocks::FeatureBlocks(const FeatureMap& map, std::vector<int> shapes)
    : BlockMap(map.target().width, map.target().height, {Box{0, 0, map.target().width, map.target().height}},
               {.layers = static_cast<int>(shapes.size()), .region_side = kRegion}),
      m_map(map),
      m_shapes(std::move(shapes)) {}

bool FeatureBlocks::exact(double x, double y, int piece, Point<double>& source_point,
                          int& source_piece) const noexcept {
    source_point = m_map(x, y, shape(piece));
    source_piece = 0;
    return true;
}

bool FeatureBlocks::seen(double, double, int) const noexcept {
    return true;
}

bool FeatureBlocks::truth(double x, double y, int piece, Point<long double>& source_point,
                          int& source_piece) const noexcept {
    source_point = m_map(static_cast<long double>(x), static_cast<long double>(y), shape(piece));
    source_piece = 0;
    return true;
}

void FeatureBlocks::exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept {
    const Box& box = block.box;
    for (int row = begin; row < end; ++row) {
        const std::ptrdiff_t at = (row - begin) * to.stride;
        simd::feature_row(m_map, shape(block.piece), box.x0 + 0.5, box.y0 + row + 0.5, box.width(), to.x + at,
                          to.y + at);
        std::fill_n(to.piece + at, box.width(), 0);
    }
}

Jacobian FeatureBlocks::jacobian(double x, double y, int piece) const noexcept {
    using J = Jet1<double>;
    const Point<J> p = m_map(J::variable(x, 1, 0), J::variable(y, 0, 1), shape(piece));
    return {p.x.c[1], p.y.c[1], p.x.c[2], p.y.c[2]};
}

void FeatureBlocks::add_exact(const Box& box, Blocks& blocks) const {
    Block block;
    block.box = box;
    block.bound = exact_bound(m_map, m_shapes, box);
    for (block.piece = 0; block.piece < layers(); ++block.piece) blocks.push_back(block);
}

}  // namespace anamorph
