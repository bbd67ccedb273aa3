// SPDX-License-Identifier: Apache-2.0
#include "anamorph/morph/feature_blocks.h"

#include <algorithm>
#include <new>
#include <utility>

#include "anamorph/morph/feature_rows.h"
#include "anamorph/morph/near_far_exact.h"

namespace anamorph {

FeatureBlocks::FeatureBlocks(const FeatureMap& map, std::vector<int> shapes, const Size& overscan)
    : BlockMap(map.target().width, map.target().height,
               {widened({0, 0, map.target().width, map.target().height}, overscan)},
               {.layers = static_cast<int>(shapes.size()), .region_side = kRegion, .kept_regions = 2048}),
      m_map(map),
      m_shapes(std::move(shapes)) {
    m_waiting.reserve(kMostWaiting);
}

bool FeatureBlocks::exact(double x, double y, int piece, Point<double>& source_point,
                          int& source_piece) const noexcept {
    source_point = m_map(x, y, shape(piece));
    source_piece = 0;
    return true;
}

bool FeatureBlocks::seen(double, double, int) const noexcept {
    return true;
}

bool FeatureBlocks::truth(double x, double y, int piece, Point<DoubleDouble>& source_point,
                          int& source_piece) const noexcept {
    source_point = m_map(static_cast<DoubleDouble>(x), static_cast<DoubleDouble>(y), shape(piece));
    source_piece = 0;
    return true;
}

void FeatureBlocks::exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept {
    const Box& box = block.box;
    const int width = box.width(), height = end - begin;
    for (int row = 0; row < height; ++row) std::fill_n(to.piece + row * to.stride, width, 0);
    if (const auto waiting = take_waiting(block, begin, end)) {
        for (int row = 0; row < height; ++row) {
            std::copy_n(waiting->x.data() + row * waiting->stride, width, to.x + row * to.stride);
            std::copy_n(waiting->y.data() + row * waiting->stride, width, to.y + row * to.stride);
        }
        return;
    }
    // The next layer is asked for next, and most of its work is the same.
    std::unique_ptr<Waiting> next = room_for_next(block, begin, end);
    for (int row = 0; row < height; ++row) {
        simd::FeatureRow rows[2] = {{shape(block.piece), to.x + row * to.stride, to.y + row * to.stride}, {}};
        if (next)
            rows[1] = {shape(block.piece + 1), next->x.data() + row * next->stride,
                       next->y.data() + row * next->stride};
        simd::feature_rows(m_map, {rows, next ? 2u : 1u}, box.x0 + 0.5, box.y0 + begin + row + 0.5, width);
    }
    if (next) keep(std::move(next));
}

/// None where there is no next layer, or no memory.
std::unique_ptr<FeatureBlocks::Waiting> FeatureBlocks::room_for_next(const Block& block, int begin,
                                                                     int end) const noexcept try {
    if (block.piece + 1 == layers()) return nullptr;
    return std::make_unique<Waiting>(block.box, begin, end, block.piece + 1);
} catch (const std::bad_alloc&) {
    return nullptr;
}

std::unique_ptr<FeatureBlocks::Waiting> FeatureBlocks::take_waiting(const Block& block, int begin,
                                                                    int end) const noexcept {
    const std::lock_guard lock(m_mutex);
    for (auto at = m_waiting.begin(); at != m_waiting.end(); ++at) {
        const Waiting& w = **at;
        if (w.layer != block.piece || w.box != block.box || w.begin != begin || w.end != end) continue;
        std::unique_ptr<Waiting> found = std::move(*at);
        m_waiting.erase(at);
        return found;
    }
    return nullptr;
}

void FeatureBlocks::keep(std::unique_ptr<Waiting> rows) const noexcept {
    const std::lock_guard lock(m_mutex);
    if (m_waiting.size() == kMostWaiting) m_waiting.erase(m_waiting.begin());
    m_waiting.push_back(std::move(rows));
}

Jacobian FeatureBlocks::jacobian(double x, double y, int piece) const noexcept {
    using J = Jet1<double>;
    const Point<J> p = m_map(J::variable(x, 1, 0), J::variable(y, 0, 1), shape(piece));
    return {p.x.c[1], p.y.c[1], p.x.c[2], p.y.c[2]};
}

void FeatureBlocks::add_exact(const Box& box, double tol, Blocks& blocks) const {
    Block block;
    block.box = box;
    block.bound = exact_bound(m_map, m_shapes, box, tol);
    for (block.piece = 0; block.piece < layers(); ++block.piece) blocks.push_back(block);
}

}  // namespace anamorph
