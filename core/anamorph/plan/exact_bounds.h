// SPDX-License-Identifier: Apache-2.0
// The roundings of exact pixels.
#pragma once

#include <algorithm>
#include <cmath>

#include "anamorph/plan/boxes.h"
#include "anamorph/plan/formula_plan.h"

namespace anamorph::plan_detail {

// The precision to which rounding needs to be known where every pixel is exact (source pixels).
inline constexpr double kExactGoal = 1e-4;
// The most exact pixels of a box that is read in DoubleDouble where that keeps the tolerance; larger ones are
// halved first.
inline constexpr int kPrecisePixels = 64;
// The largest gain of precision by DoubleDouble: 11 bits less those by which constants are known worse.
inline constexpr double kPreciseGain = 512;
// The factor up to which bounds above the tolerance are alike.
inline constexpr double kAlike = 4;

/// Gives exact blocks the bound of their rounding, and cuts out of them the pixels that need DoubleDouble.
template <FormulaMap Map>
class ExactBounds {
  public:
    ExactBounds(const Map& map, double tol, Blocks& blocks)
        : m_map(map), m_goal(tol > 0 ? tol : kExactGoal), m_blocks(blocks) {}

    /// Appends the parts of an exact block.
    void place(Block block) {
        const Interval x{block.box.x0 + 0.5, block.box.x1 - 0.5}, y{block.box.y0 + 0.5, block.box.y1 - 0.5};
        block.bound = bound_of<double>(block, x, y);
        const int pixels = pixels_of(block.box);
        const bool may_help =
            pixels == 1 || (pixels <= kPrecisePixels && block.bound <= kPreciseGain * m_goal);
        if (!(block.bound <= m_goal) && may_help) {
            block.precise = true;
            block.bound = bound_of<DoubleDouble>(block, x, y);
        }
        if (block.bound <= m_goal || pixels == 1)
            m_blocks.push_back(block);
        else
            halve(block);
    }

  private:
    /// Places the halves of a block. Halves that came out alike are one block again.
    void halve(const Block& block) {
        const std::size_t first = m_blocks.size();
        const bool vertical_cut = block.box.width() >= block.box.height();
        for (const bool second : {false, true}) {
            Block part = block;
            part.precise = false;
            part.box = sub_box(block.box, vertical_cut, second);
            place(part);
        }
        if (m_blocks.size() != first + 2 || m_blocks[first].precise != m_blocks[first + 1].precise) return;
        const double smaller = std::min(m_blocks[first].bound, m_blocks[first + 1].bound);
        const double bound = std::max(m_blocks[first].bound, m_blocks[first + 1].bound);
        if (!(bound <= m_goal || bound <= kAlike * smaller)) return;
        m_blocks.resize(first + 1);
        m_blocks[first].box = block.box;
        m_blocks[first].bound = bound;
    }
    /// The bound of a block's rounding; infinite where none is known.
    template <class Real>
    double bound_of(const Block& block, const Interval& x, const Interval& y) const {
        const double bound = m_map.template exact_error<Real>(x, y, block.piece);
        return std::isnan(bound) ? HUGE_VAL : bound;
    }

    const Map& m_map;
    double m_goal;
    Blocks& m_blocks;
};

}  // namespace anamorph::plan_detail
