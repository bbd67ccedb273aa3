// SPDX-License-Identifier: Apache-2.0
// A map given by a function of the target point, in blocks of a kind that a test chooses.
#pragma once

#include <functional>

#include "anamorph/plan/block_writer.h"

namespace anamorph::test {

class FunctionMap final : public BlockMap {
  public:
    using Function = std::function<Point<double>(double, double)>;

    /// Makes blocks of a kind. A polynomial block is the function's where that is a quadratic; exact ones
    /// stand where none is possible.
    FunctionMap(int width, int height, Block::Kind kind, Function function)
        : BlockMap(width, height, {Box{0, 0, width, height}}),
          m_kind(kind),
          m_function(std::move(function)) {}

    bool exact(double x, double y, int, Point<double>& at, int& source_piece) const noexcept override {
        at = m_function(x, y);
        source_piece = 0;
        return true;
    }
    Jacobian jacobian(double x, double y, int) const noexcept override {
        constexpr double h = 1.0 / 64;
        const Point<double> i = (m_function(x + h, y) - m_function(x - h, y)) * (0.5 / h),
                            j = (m_function(x, y + h) - m_function(x, y - h)) * (0.5 / h);
        return {i.x, i.y, j.x, j.y};
    }
    void computed_row(const Block& block, int row, int begin, int end, float* x,
                      float* y) const noexcept override {
        for (int i = begin; i < end; ++i) {
            const Point<double> p = m_function(block.box.x0 + i + 0.5, block.box.y0 + row + 0.5);
            x[i - begin] = static_cast<float>(p.x - block.base_x);
            y[i - begin] = static_cast<float>(p.y - block.base_y);
        }
    }

  protected:
    void plan(const Box& box, int, Blocks& blocks) const override {
        BlockWriter writer(1e9, blocks);
        BlockWriter::for_blocks(box, [&](const Box& b) {
            const bool done = m_kind == Block::Kind::polynomial ? polynomial(b, writer)
                              : m_kind == Block::Kind::computed ? writer.computed(b, at(b, 0, 0), 0)
                                                                : false;
            if (!done) writer.exact(b, 0);
        });
    }

  private:
    Point<double> at(const Box& b, int s, int t) const {
        return m_function(0.5 * (b.x0 + b.x1) + s * half(b.width()),
                          0.5 * (b.y0 + b.y1) + t * half(b.height()));
    }
    bool polynomial(const Box& b, BlockWriter& writer) const {
        const Point<double> c[6] = {
            at(b, 0, 0),
            (at(b, 1, 0) - at(b, -1, 0)) * 0.5,
            (at(b, 0, 1) - at(b, 0, -1)) * 0.5,
            (at(b, 1, 0) + at(b, -1, 0)) * 0.5 - at(b, 0, 0),
            (at(b, 1, 1) + at(b, -1, -1) - at(b, 1, -1) - at(b, -1, 1)) * 0.25,
            (at(b, 0, 1) + at(b, 0, -1)) * 0.5 - at(b, 0, 0),
        };
        double x[6], y[6];
        for (int k = 0; k < 6; ++k) {
            x[k] = c[k].x;
            y[k] = c[k].y;
        }
        return writer.polynomial(b, x, y, 0);
    }

    Block::Kind m_kind;
    Function m_function;
};

}  // namespace anamorph::test
