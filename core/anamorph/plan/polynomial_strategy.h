// SPDX-License-Identifier: Apache-2.0
// Decides where a map's Taylor polynomials serve as blocks, and how large these may be.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "anamorph/plan/block_emitter.h"
#include "anamorph/plan/box_bounds.h"
#include "anamorph/plan/cost_model.h"

namespace anamorph::plan_detail {

// Blocks are not counted in more parts than this.
inline constexpr int kMostParts = 256;
// The part of the tolerance that a remainder over a box may take up for a polynomial on it; and for one that
// serves parts of it.
inline constexpr double kTailShare = 0.125, kPartShare = 0.25;

/// Polynomials in float or in double with what is known of a map over boxes.
template <FormulaMap Map>
class PolynomialStrategy {
  public:
    using Local = typename Map::Local;
    using Taylor = typename BoxBounds<Map>::Taylor;
    using Enclosed = typename BoxBounds<Map>::Enclosed;
    using Tail = Remainder<5>;

    PolynomialStrategy(const BoxBounds<Map>& bounds, double tol, CostModel& costs)
        : m_bounds(bounds), m_tol(tol), m_account(costs) {}

    /// The enclosures and polynomials that are computed for several boxes at once.
    struct Known {
        Box box;
        Enclosed enclosed;
        Taylor middle;                 ///< polynomial of the block in the middle
        std::optional<Taylor> itself;  ///< polynomial of the box, where it may be one block
    };
    /// Computes them for up to kJets boxes.
    void know(std::span<const Box> boxes, const Local& local, Known* known) {
        m_account.pay_for_bounds(boxes.size());
        Box middles[simd::kJets];
        const auto enclosed = m_bounds.enclose_all(boxes, local);
        bool single = true, blocks = true;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            known[i].box = boxes[i];
            known[i].enclosed = {enclosed.x.at(static_cast<int>(i)), enclosed.y.at(static_cast<int>(i))};
            middles[i] = middle_of(boxes[i]);
            single = single && boxes[i].width() <= 2 * kBlockWidth && boxes[i].height() <= 2 * kBlockHeight;
            blocks = blocks && is_block(boxes[i]);
        }
        Taylor taylors[simd::kJets];
        if (!blocks) {
            m_bounds.taylors_of({middles, boxes.size()}, local, taylors);
            for (std::size_t i = 0; i < boxes.size(); ++i) known[i].middle = taylors[i];
        }
        if (!single || boxes.size() == 1) return;
        m_bounds.taylors_of(boxes, local, taylors);
        for (std::size_t i = 0; i < boxes.size(); ++i) known[i].itself = taylors[i];
    }

    /// The bounds that the map's Taylor coefficients over a box give for the blocks in it.
    struct Bound {
        Tail x, y;
        double reach;  ///< reach of their footprints where some may lie beyond the image's edges; else -1
        double rounding = HUGE_VAL;  ///< rounding of any block; infinite where each has its own
    };
    Bound bound_of(const Known& known) const {
        const Enclosed& p = known.enclosed;
        const bool kept = m_bounds.is_kept(p.x.c[0], p.y.c[0]);
        return {Tail(p.x), Tail(p.y), kept ? -1 : m_bounds.footprint_reach(p)};
    }
    static Bound larger(const Bound& a, const Bound& b) {
        return {Tail::larger(a.x, b.x), Tail::larger(a.y, b.y), std::max(a.reach, b.reach)};
    }
    static double tail_over(const Box& box, const Bound& bound) {
        return tail_over(half(box.width()), half(box.height()), bound);
    }

    /// Is the remainder small enough for blocks in a box, so that it is not halved?
    bool serves(const Known& known, const Bound& bound) const {
        return is_block(known.box) ? tail_over(known.box, bound) < HUGE_VAL
                                   : serves(known.box, known.middle, bound);
    }
    /// Does a bound serve a box, in no smaller parts than its own would?
    bool serves_as_well(const Known& known, const Bound& bound) const {
        const Parts shared = parts_of(known.box, bound), own = parts_of(known.box, bound_of(known));
        return shared.width * shared.height == own.width * own.height && shared.are == own.are &&
               serves(known.box, known.middle, bound);
    }

    /// Could polynomials in float pay where direct blocks are expected? Judges by the block in the middle of a box: by the
    /// number of parts into which its error, an expected remainder and the rounding of floats cut it.
    bool may_beat_direct(const Box& box, const Local& local) const {
        const Box middle = middle_of(box);
        // Bounds may cost as much again.
        const auto pays = [&](double blocks) {
            return !(2 * costs().polynomial * blocks >= pixels_of(middle) * m_account.fallback().saving);
        };
        const Point<Jet1<double>> p = m_bounds.linear_of(middle, local);
        const double x[10] = {0, p.x.c[1], p.x.c[2]}, y[10] = {0, p.y.c[1], p.y.c[2]};
        const double rounding = BlockWriter::cubic_rounding(x, y);
        if (!pays(parts(0, 0, rounding))) return false;
        const Taylor taylor = m_bounds.taylor_of(middle, local);
        return pays(parts(Fit(taylor).error, expected_tail(taylor), rounding));
    }
    /// Are cubics in float so many, for their error or their rounding, that one polynomial in double costs less?
    /// Not where pixels may be direct.
    bool is_cheaper_in_double(const Box& box, const Fit& fit) const {
        if (m_account.fallback().is_direct()) return false;
        const double finer = BlockWriter::cubic_rounding(fit.x.c, fit.y.c) / m_tol;
        return costs().polynomial * std::max(parts(fit.error, 0), finer * finer) >=
               costs().double_pixel * pixels_of(box);
    }

    /// The parts of a box about whose middles a remainder is small enough for blocks, or where that comes to nothing.
    struct Parts {
        int width, height;
        enum { placed, renewed, left } are;
    };
    Parts parts_of(const Box& box, const Bound& bound) const {
        Parts p{std::min(box.width(), 2 * kBlockWidth), std::min(box.height(), 2 * kBlockHeight),
                Parts::placed};
        for (;;) {
            const double hx = half(p.width), hy = half(p.height), tail = tail_over(hx, hy, bound);
            const bool of_one = p.width <= kBlockWidth && p.height <= kBlockHeight;
            if (tail <= (of_one ? kTailShare : kPartShare) * m_tol) return p;
            p.are = p.width <= kFloor && p.height <= kFloor ? Parts::left : Parts::renewed;
            const bool dear = parts(0, tail) * costs().polynomial > 2 * m_account.bound();
            if (p.are == Parts::left || (dear && p.width * p.height <= kBlockWidth * kBlockHeight)) return p;
            bool vertical_cut = tail_over(0.5 * hx, hy, bound) <= tail_over(hx, 0.5 * hy, bound);
            if (vertical_cut ? p.width <= kFloor : p.height <= kFloor) vertical_cut = !vertical_cut;
            int& side = vertical_cut ? p.width : p.height;
            side = static_cast<int>(std::bit_ceil(static_cast<unsigned>(side))) / 2;
            p.are = Parts::placed;
        }
    }

    /// Adds a bound of rounding for the parts of one block, which may share one where blocks of any size do not.
    Bound with_rounding(Bound bound, const Box& block, const Parts& parts, const Local& local) {
        const bool is_shared = bound.rounding < HUGE_VAL || parts.are != Parts::placed;
        if (is_shared || pixels_of(block) < 2 * parts.width * parts.height) return bound;
        m_account.pay_for_rounding();
        const double rounding = m_bounds.rounding_over(block, half(parts.width), half(parts.height), local);
        if (rounding <= kSharedRounding * m_tol) bound.rounding = rounding;
        return bound;
    }

    /// A Taylor polynomial, and its largest distance from the map anywhere in its box, remainder and
    /// rounding.
    struct Expansion {
        Box box;
        Taylor taylor;
        double error;
    };
    Expansion expand(const Box& box, const Local& local, const Bound& bound, const Taylor& taylor) {
        const bool alone = !(bound.rounding < HUGE_VAL);
        m_account.pay_for_polynomial(alone);
        const double rounding =
            alone ? m_bounds.rounding_over(box, half(box.width()), half(box.height()), local)
                  : bound.rounding;
        return {box, taylor, tail_over(box, bound) + rounding};
    }
    /// An expansion on a part of its box.
    static Fit fit_on(const Expansion& e, const Box& b) {
        if (b == e.box) return Fit(e.taylor);
        const double per_x = 1 / half(e.box.width()), per_y = 1 / half(e.box.height());
        const auto part = [&](const Jet<double, 4>& f) {
            return on_part(f, 0.5 * (b.x0 + b.x1 - e.box.x0 - e.box.x1) * per_x, half(b.width()) * per_x,
                           0.5 * (b.y0 + b.y1 - e.box.y0 - e.box.y1) * per_y, half(b.height()) * per_y);
        };
        return Fit({part(e.taylor.x), part(e.taylor.y)});
    }
    /// Does all that blocks of a Taylor polynomial would read lie beyond an edge? It is off by `error`, in a box that `bound` is
    /// of.
    bool lies_beyond(const Taylor& taylor, double error, const Bound& bound) const {
        if (bound.reach < 0) return false;
        const auto range = [error](const Jet<double, 4>& f) {
            double spread = error;
            for (int i = 1; i < 15; ++i) spread += std::fabs(f.c[i]);
            return Interval{f.c[0] - spread, f.c[0] + spread};
        };
        return m_bounds.lie_beyond(range(taylor.x), range(taylor.y), bound.reach);
    }

    /// The Taylor polynomials of boxes that are asked for in the order in which they were added: several at once.
    class InTurn {
      public:
        InTurn(const BoxBounds<Map>& bounds, const Local& local, const Known& known)
            : m_bounds(bounds), m_local(local), m_known(known) {}

        void add(const Box& box) { m_boxes.push_back(box); }
        /// The Taylor polynomial of a box; boxes that were added may be left out.
        const Taylor& of(const Box& box) {
            if (m_boxes.size() == 1 && m_known.itself && box == m_known.box) return *m_known.itself;
            while (m_boxes[m_at] != box) ++m_at;
            if (m_at >= m_end) {
                const std::size_t count = std::min<std::size_t>(simd::kJets, m_boxes.size() - m_at);
                m_bounds.taylors_of({&m_boxes[m_at], count}, m_local, m_taylors);
                m_first = m_at;
                m_end = m_at + count;
            }
            return m_taylors[m_at - m_first];
        }

      private:
        const BoxBounds<Map>& m_bounds;
        const Local& m_local;
        const Known& m_known;
        std::vector<Box> m_boxes;
        std::size_t m_at = 0, m_first = 0, m_end = 0;
        Taylor m_taylors[simd::kJets];
    };

  private:
    const PlanCosts& costs() const { return m_account.costs(); }

    static double tail_over(double hx, double hy, const Bound& bound) {
        return length(bound.x.over(hx, hy), bound.y.over(hx, hy));
    }

    /// Does a bound serve a box, as tried on the block in its middle? Halving the box costs two bounds, and
    /// may save the blocks that are cut smaller only for what the intervals are wide.
    bool serves(const Box& box, const Taylor& in_middle, const Bound& bound) const {
        const Box middle = middle_of(box);
        const double tail = tail_over(middle, bound);
        if (!(tail < HUGE_VAL)) return false;
        const double hx = half(middle.width()), hy = half(middle.height());
        const double least = length(bound.x.about(hx, hy), bound.y.about(hx, hy));
        // As many as are counted are too many, whatever the middles say.
        if (parts(0, tail) >= kMostParts) return false;
        const Fit fit(in_middle);
        const double error = is_cheaper_in_double(middle, fit) ? 0 : fit.error;
        const double blocks = pixels_of(box) / double{kBlockWidth * kBlockHeight};
        return blocks * (parts(error, tail) - parts(error, least)) * costs().polynomial <=
               2 * m_account.bound();
    }

    /// The number of parts into which a block is cut until a cubic holds the tolerance: its error falls with
    /// the fourth power of the side, the remainder with the fifth, and what rounding takes of the tolerance
    /// with the side itself.
    double parts(double fit, double tail, double rounding = 0) const {
        double count = 1, side = 1;
        while (count < kMostParts && !(std::max(fit + tail * side, tail * side / kTailShare) <=
                                       (m_tol - rounding * side) * (count * count))) {
            count *= 2;
            side *= 0.70710678;
        }
        return count;
    }

    /// An estimate of the terms of degree 5, as if they were to those of degree 4 as these are to those of degree 3.
    static double expected_tail(const Taylor& taylor) {
        const auto size = [&](int from, int to) {
            double x = 0, y = 0;
            for (int i = from; i < to; ++i) {
                x += std::fabs(taylor.x.c[i]);
                y += std::fabs(taylor.y.c[i]);
            }
            return length(x, y);
        };
        const double third = size(6, 10), fourth = size(10, 15);
        return third > 0 ? fourth * fourth / third : 0;
    }

    const BoxBounds<Map>& m_bounds;
    double m_tol;
    CostModel& m_account;
};

}  // namespace anamorph::plan_detail
