// SPDX-License-Identifier: Apache-2.0
// Blocks as plans write them: checked against the tolerance, halved where they miss it.
#pragma once

#include <algorithm>
#include <cmath>

#include "anamorph/approx/block.h"

namespace anamorph {

/// Source points farther away than this are none.
inline constexpr double kFarthest = 1 << 30;

// Rounding of a point's coordinates to float and of their evaluation: the coefficients, s and t are each
// rounded once, and at most five operations are rounded on the way from the smallest term to the sum, so that
// each term errs by less than 8 half-ULP of its size. So for a cubic in s alone.
inline constexpr double kFloatRounding = 8 * 0x1p-24;

/// Half the distance between the first and the last of a row of pixel centres.
inline double half(int pixels) {
    return pixels > 1 ? 0.5 * (pixels - 1) : 0.5;
}

class BlockWriter {
  public:
    // A block is at most as large as keeps its source and target rows in the first-level cache.
    static constexpr int kWidth = 64, kHeight = 32;
    // A polynomial costs as much to plan as so many exact pixels.
    static constexpr int kFloorPixels = 12;

    BlockWriter(double tol, Blocks& blocks) : m_tol(tol), m_blocks(blocks) {}

    static bool below_floor(const Box& box) { return box.width() * box.height() < kFloorPixels; }

    void exact(const Box& box) { add(box, Block::Kind::exact); }
    void outside(const Box& box) { add(box, Block::Kind::outside); }

    /// A quadratic block, coefficients as in Block less the base. True when it keeps the tolerance in float,
    /// `error` apart: then it is written.
    bool polynomial(const Box& box, const double* x, const double* y, double error) {
        if (!(std::fabs(x[0]) < kFarthest && std::fabs(y[0]) < kFarthest)) return false;
        Block block;
        block.box = box;
        block.kind = Block::Kind::polynomial;
        block.base_x = static_cast<std::int32_t>(std::floor(x[0]));
        block.base_y = static_cast<std::int32_t>(std::floor(y[0]));
        const double ex = store(x, block.base_x, block.x), ey = store(y, block.base_y, block.y);
        block.bound = error + std::sqrt(ex * ex + ey * ey);
        if (!(block.bound <= m_tol)) return false;
        m_blocks.push_back(block);
        return true;
    }

    /// A computed block whose base is `middle` rounded down. True when it keeps the tolerance.
    bool computed(const Box& box, const Point<double>& middle, double error) {
        if (!(error <= m_tol && std::fabs(middle.x) < kFarthest && std::fabs(middle.y) < kFarthest))
            return false;
        Block block;
        block.box = box;
        block.kind = Block::Kind::computed;
        block.base_x = static_cast<std::int32_t>(std::floor(middle.x));
        block.base_y = static_cast<std::int32_t>(std::floor(middle.y));
        block.bound = error;
        m_blocks.push_back(block);
        return true;
    }

    /// `body` on the halves of a box of at least two pixels; where all that comes of it is exact, one block.
    template <class Body>
    void halve(const Box& box, bool vertical_cut, const Body& body) {
        const std::size_t first = m_blocks.size();
        if (vertical_cut ? box.width() < 2 : box.height() < 2) vertical_cut = !vertical_cut;
        Box a = box, b = box;
        if (vertical_cut)
            a.x1 = b.x0 = (box.x0 + box.x1) / 2;
        else
            a.y1 = b.y0 = (box.y0 + box.y1) / 2;
        body(a);
        body(b);
        const auto is_exact = [](const Block& block) { return block.kind == Block::Kind::exact; };
        if (!std::all_of(m_blocks.begin() + static_cast<std::ptrdiff_t>(first), m_blocks.end(), is_exact))
            return;
        m_blocks.resize(first);
        exact(box);
    }

    /// body(block) for boxes of at most kWidth x kHeight pixels.
    template <class Body>
    static void for_blocks(const Box& box, const Body& body) {
        for (int y = box.y0; y < box.y1; y += kHeight)
            for (int x = box.x0; x < box.x1; x += kWidth)
                body(Box{x, y, std::min(x + kWidth, box.x1), std::min(y + kHeight, box.y1)});
    }

  private:
    void add(const Box& box, Block::Kind kind) {
        Block block;
        block.box = box;
        block.kind = kind;
        m_blocks.push_back(block);
    }

    /// Coefficients in float, and what rounding may cost.
    static double store(const double* c, std::int32_t base, float* to) {
        to[0] = static_cast<float>(c[0] - base);
        double sum = std::fabs(c[0] - base);
        for (int i = 1; i < 6; ++i) {
            to[i] = static_cast<float>(c[i]);
            sum += std::fabs(c[i]);
        }
        return sum * kFloatRounding;
    }

    double m_tol;
    Blocks& m_blocks;
};

}  // namespace anamorph
