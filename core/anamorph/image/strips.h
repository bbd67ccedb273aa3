// SPDX-License-Identifier: Apache-2.0
// The work of drawing a box of a picture, shared out to threads.
#pragma once

#include <algorithm>
#include <vector>

#include "anamorph/parallel_for.h"
#include "anamorph/plan/block.h"

namespace anamorph {

/// The blocks of one region that begin in some of its rows: the work of one thread.
class Strip {
  public:
    /// Makes a strip. `rows`: a part of a region that is as wide as the region.
    Strip(const SharedBlocks& blocks, const Box& rows, const Box& box)
        : m_blocks(blocks), m_rows(rows), m_box(box) {}

    /// The part of the box that lies in the strip's rows.
    Box box() const { return intersection(m_rows, m_box); }

    /// Calls body(block, part) for every block that meets the box, in `part`.
    template <class Body>
    void for_each_block(const Body& body) const {
        for (const Block& block : m_blocks) {
            Box part = intersection(block.box, m_box);
            if (block.kind == Block::Kind::outside) {
                // It has no texels and may be cut at will; others are no taller than a strip.
                part = intersection(part, m_rows);
            } else if (block.box.y0 < m_rows.y0 || block.box.y0 >= m_rows.y1)
                continue;
            if (!part.empty()) body(block, part);
        }
    }

  private:
    const SharedBlocks& m_blocks;
    Box m_rows, m_box;
};

/// Calls body(strip) for strips that together hold every block that meets `box`. A small region is one strip.
/// Of larger ones plans come first in the same loop, so that threads neither wait for each other's plan nor
/// meet in between.
template <class Body>
void for_each_strip(const BlockMap& map, const Box& box, const ParallelFor& parallel_for, const Body& body) {
    struct Work {
        std::int64_t region;
        Box rows;
    };
    constexpr int kSmall = 128, kHeight = 64;
    // As many regions at a time as their plans are kept for.
    constexpr std::size_t kBatch = 1024;
    const std::vector<std::int64_t> regions = map.regions_in(box);
    for (std::size_t first = 0; first < regions.size(); first += kBatch) {
        std::vector<std::int64_t> plans;
        std::vector<Work> strips;
        for (std::size_t i = first; i < std::min(first + kBatch, regions.size()); ++i) {
            const Box region = map.region_box(regions[i]), part = intersection(region, box);
            const bool small = std::max(region.width(), region.height()) <= kSmall;
            if (!small) plans.push_back(regions[i]);
            const int height = small ? kSmall : kHeight;
            for (int y = region.y0; y < part.y1; y += height)
                if (y + height + Block::kMaxSide > part.y0)
                    strips.push_back(
                        {regions[i], {region.x0, y, region.x1, std::min(y + height, region.y1)}});
        }
        parallel_for(static_cast<std::int64_t>(plans.size() + strips.size()), [&](std::int64_t item) {
            const auto i = static_cast<std::size_t>(item);
            if (i < plans.size()) {
                map.blocks(plans[i]);
                return;
            }
            const Work& work = strips[i - plans.size()];
            const SharedBlocks blocks = map.blocks(work.region);
            body(Strip(blocks, work.rows, box));
        });
    }
}

/// Calls body(square) for the squares that together are a box: work without blocks.
template <class Body>
void for_each_square(const Box& box, const ParallelFor& parallel_for, const Body& body) {
    if (box.empty()) return;
    constexpr int kSide = 128;
    const std::int64_t columns = (box.width() + kSide - 1) / kSide, rows = (box.height() + kSide - 1) / kSide;
    parallel_for(columns * rows, [&](std::int64_t i) {
        const int x = box.x0 + static_cast<int>(i % columns) * kSide,
                  y = box.y0 + static_cast<int>(i / columns) * kSide;
        body(intersection({x, y, x + kSide, y + kSide}, box));
    });
}

}  // namespace anamorph
