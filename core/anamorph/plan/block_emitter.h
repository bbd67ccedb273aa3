// SPDX-License-Identifier: Apache-2.0
// Blocks of a formula's plan as they are written, with the records that they are drawn from.
#pragma once

#include <algorithm>
#include <vector>

#include "anamorph/plan/block_writer.h"
#include "anamorph/plan/cost_model.h"
#include "anamorph/plan/cubic_terms.h"
#include "anamorph/plan/direct_blocks.h"
#include "anamorph/plan/formula_plan.h"
#include "anamorph/plan/taylor.h"

namespace anamorph::plan_detail {

/// The coefficients of a region's bicubic blocks.
struct Cubics : RegionData {
    std::vector<CubicTerms> terms;
    /// All coefficients of a block in double, up to degree 4 as in Jet, less the base.
    struct Precise {
        double x[15], y[15];
    };
    std::vector<Precise> precise;
};

inline BlockPolynomial cubic_of(const Block& block) {
    const auto& cubics = static_cast<const Cubics&>(*block.data);
    return with_cubic_terms(block, cubics.terms[static_cast<std::size_t>(block.record)]);
}

/// Evaluates a row of a polynomial in double: by Horner's rule for t, then for s, as
/// image/block_sampler_lanes.cpp does in float.
inline void precise_row(const Block& block, int row, double* to_x, double* to_y) {
    const auto& cubics = static_cast<const Cubics&>(*block.data);
    const Cubics::Precise& c = cubics.precise[static_cast<std::size_t>(block.record)];
    const auto step = [](int count) { return count > 1 ? 1.0 / (count - 1) : 0.0; };
    const int width = block.box.width(), height = block.box.height();
    const double t = (2 * row - (height - 1)) * step(height), per_pixel = step(width);
    double x[5], y[5];
    const auto on_row = [t](const double* of, double* to) {
        to[0] = (((of[14] * t + of[9]) * t + of[5]) * t + of[2]) * t + of[0];
        to[1] = ((of[13] * t + of[8]) * t + of[4]) * t + of[1];
        to[2] = (of[12] * t + of[7]) * t + of[3];
        to[3] = of[11] * t + of[6];
        to[4] = of[10];
    };
    on_row(c.x, x);
    on_row(c.y, y);
    for (int i = 0; i < width; ++i) {
        const double s = (2 * i - (width - 1)) * per_pixel;
        to_x[i] = block.base_x + ((((x[4] * s + x[3]) * s + x[2]) * s + x[1]) * s + x[0]);
        to_y[i] = block.base_y + ((((y[4] * s + y[3]) * s + y[2]) * s + y[1]) * s + y[0]);
    }
}

/// The records of all blocks of a region.
template <class Local>
struct Records : Cubics {
    DirectRecords<Local> direct;
};

template <class Local, class Real>
NearBlock<Local, Real> near_block(const Block& block) {
    return static_cast<const Records<Local>&>(*block.data).direct.template at<Real>(block.record);
}

/// A Taylor polynomial of a block, and the cubic nearest to it.
struct Fit {
    Point<Jet<double, 4>> taylor;
    EconomizedCubic x, y;
    double error;  ///< the largest distance of the cubic from the Taylor polynomial

    explicit Fit(const Point<Jet<double, 4>>& f)
        : taylor(f), x(f.x), y(f.y), error(length(x.error, y.error)) {}
};

/// Appends the blocks of one piece of the target, and enters in the account what they save.
template <FormulaMap Map>
class BlockEmitter {
  public:
    using Local = typename Map::Local;

    BlockEmitter(const Map& map, double tol, int piece, CostModel& costs, Blocks& blocks,
                 Records<Local>& records)
        : m_map(map), m_tol(tol), m_piece(piece), m_costs(costs), m_blocks(blocks), m_records(records) {}

    void outside(const Box& box) { append(box, Block::Kind::outside); }
    void exact(const Box& box) { append(box, Block::Kind::exact); }
    /// Appends a block for pixels that no polynomial serves: direct or exact, as the fallback is.
    void without_polynomial(const Box& box) {
        const Fallback& fallback = m_costs.fallback();
        if (!fallback.is_direct()) return exact(box);
        append(box, Block::Kind::computed);
        m_blocks.back().precise = fallback.kind == Fallback::direct_in_double;
        m_blocks.back().data = &m_records;
        m_costs.save_direct(box);
    }

    /// Appends a block if a polynomial of degree 2 or, where that does not, 3 keeps the tolerance, `error`
    /// away from the map besides. True if so.
    bool fit(const Box& box, const Local& local, const Fit& fit, double error) {
        if (!(fit.error + error <= m_tol)) return false;
        const Economized x(fit.x), y(fit.y);
        return quadratic(box, local, x.c, y.c, length(x.error, y.error) + error) ||
               cubic(box, local, fit.x.c, fit.y.c, fit.error + error);
    }
    /// Appends a block if a quadratic, off by `error` in double and evaluated in float, keeps the tolerance.
    /// True if so.
    bool quadratic(const Box& box, const Local& local, const double* cx, const double* cy, double error) {
        if (!BlockWriter(m_tol, m_blocks).polynomial(box, cx, cy, error)) return false;
        finish(box, local);
        return true;
    }
    /// Appends a block if the Taylor polynomial as it is, in double, keeps the tolerance. True if so.
    bool in_double(const Box& box, const Local& local, const Point<Jet<double, 4>>& taylor, double error) {
        const double *x = taylor.x.c, *y = taylor.y.c;
        // The base may come to stand a turn farther away.
        error += 0x1p-53 * m_map.period();
        if (!BlockWriter(m_tol, m_blocks).precise(box, x, y, error)) return false;
        const Block& block = m_blocks.back();
        Cubics::Precise& c = m_records.precise.emplace_back();
        std::copy_n(x, 15, c.x);
        std::copy_n(y, 15, c.y);
        c.x[0] -= block.base_x;
        c.y[0] -= block.base_y;
        finish(box, local);
        m_costs.pay_for_double(box);
        refer_to(m_records.precise.size() - 1);
        return true;
    }

    /// Calls body(), which appends blocks. True when none of them is a polynomial's: then they are taken
    /// back.
    template <class Body>
    bool takes_back(const Body& body) {
        const std::size_t first = m_blocks.size();
        body();
        const auto kind = m_costs.fallback().is_direct() ? Block::Kind::computed : Block::Kind::exact;
        const auto is_without = [&](const Block& b) { return b.kind == kind; };
        if (!std::all_of(m_blocks.begin() + static_cast<std::ptrdiff_t>(first), m_blocks.end(), is_without))
            return false;
        m_blocks.resize(first);
        return true;
    }

  private:
    bool cubic(const Box& box, const Local& local, const double* cx, const double* cy, double error) {
        if (!BlockWriter(m_tol, m_blocks).cubic(box, cx, cy, error)) return false;
        m_records.terms.emplace_back(cx, cy);
        finish(box, local);
        refer_to(m_records.terms.size() - 1);
        return true;
    }
    void append(const Box& box, Block::Kind kind) {
        Block block;
        block.box = box;
        block.kind = kind;
        block.piece = m_piece;
        m_blocks.push_back(block);
    }
    /// Fills in what the writer does not know of a polynomial's block.
    void finish(const Box& box, const Local& local) {
        m_costs.save_polynomial(box);
        Block& block = m_blocks.back();
        block.piece = m_piece;
        block.source_piece = m_map.source_piece(local);
        turn_into_image(block, m_map.period());
    }
    void refer_to(std::size_t record) {
        m_blocks.back().data = &m_records;
        m_blocks.back().record = static_cast<int>(record);
    }

    const Map& m_map;
    double m_tol;
    int m_piece;
    CostModel& m_costs;
    Blocks& m_blocks;
    Records<Local>& m_records;
};

}  // namespace anamorph::plan_detail
