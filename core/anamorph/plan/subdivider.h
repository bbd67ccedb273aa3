// SPDX-License-Identifier: Apache-2.0
// Cuts the regions of a formula's plan, top-down, until a polynomial, direct pixels or the exact formula
// serves each part.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "anamorph/parameter/left_out.h"
#include "anamorph/plan/block_emitter.h"
#include "anamorph/plan/box_bounds.h"
#include "anamorph/plan/cost_model.h"
#include "anamorph/plan/direct_strategy.h"
#include "anamorph/plan/polynomial_strategy.h"
#include "anamorph/plan/residual_strategy.h"

namespace anamorph::plan_detail {

// The least side of blocks that edges cut: their exact pixels cost more than what finds where the edges run.
inline constexpr int kCutFloor = 4;
// The factor by which a block in the middle of a box has to miss the tolerance for others of the box not to
// be looked at.
inline constexpr double kHopeless = 4;

inline bool is_all_exact(const PlanOptions& options) {
    return options.scheme == Scheme::exact || options.tol == 0;
}
/// The largest error that bounds may have.
inline double goal_of(const PlanOptions& options) {
    if (!is_all_exact(options)) return options.tol;
    return options.tol > 0 ? std::min(options.tol, kExactError) : kExactError;
}

/// Plans a region of one piece of the target; blocks are appended to `blocks`, and to `records` what they are made of.
template <FormulaMap Map>
class Subdivider {
    using Local = typename Map::Local;
    using Place = typename BoxBounds<Map>::Place;
    using Polynomials = PolynomialStrategy<Map>;
    using Known = typename Polynomials::Known;
    using Bound = typename Polynomials::Bound;
    using Parts = typename Polynomials::Parts;
    using Expansion = typename Polynomials::Expansion;

  public:
    Subdivider(const Map& map, const PlanOptions& options, const ReadOrders& orders, const Box& region,
               int piece, Blocks& blocks, Records<Local>& records)
        : m_scheme(is_all_exact(options) ? Scheme::exact : options.scheme),
          m_tol(options.tol),
          m_goal(goal_of(options)),
          m_culls(options.cull),
          m_costs(options.costs.value_or(costs_of<Map>()), is_only_fastest(m_scheme), region),
          m_bounds(map, options, piece),
          m_emitter(map, options.tol, piece, m_costs, blocks, records),
          m_polynomials(m_bounds, options.tol, m_costs),
          m_direct(map, m_bounds, orders, m_goal, m_scheme == Scheme::exact, m_costs),
          m_residuals(map, m_bounds, piece) {}
    Subdivider(const Subdivider&) = delete;
    Subdivider& operator=(const Subdivider&) = delete;

    void plan(const Box& region) {
        if (m_scheme == Scheme::exact && !m_direct.is_possible())
            for_blocks(region, [&](const Box& b) { m_emitter.exact(b); });
        else
            settle(region);
    }

  private:
    static bool is_only_fastest(Scheme scheme) {
        return scheme == Scheme::automatic || scheme == Scheme::exact;
    }

    /// Finds the branch of the map on which a box lies, and settles it there.
    void settle(const Box& box) {
        if (!m_costs.worth_a_bound(box)) return leave(box);
        Place place = m_bounds.place_about(box);
        switch (m_bounds.cover(box, place.local)) {
            case Cover::outside:
                return m_emitter.outside(box);
            case Cover::partial:
            case Cover::mixed:
                return split(box, [&](const Box& b) { settle(b); });
            case Cover::cut:
                return settle_cut(box, place);
            case Cover::inside:
                return settle_inside(box, place);
        }
    }

    /// Settles a box that edges cut as if all of it had source points; its blocks are then cut where the edges are.
    void settle_cut(const Box& box, Place& place) {
        auto edges = m_bounds.edges_over(box);
        if (!edges) return split(box, [&](const Box& b) { settle(b); });
        std::swap(m_edges, edges);
        settle_inside(box, place);
        std::swap(m_edges, edges);
    }
    /// The cover of a part of a box that is being settled, by the edges that cut this, if any do.
    Cover cover_by_edges(const Box& box) const { return m_edges ? m_edges->cover(box) : Cover::inside; }
    Cover cover_of_block(const Box& box) const {
        const Cover cover = cover_by_edges(box);
        return cover == Cover::mixed ? m_bounds.cover(box, m_bounds.place_about(box).local) : cover;
    }

    /// Settles a box that lies on one branch.
    void settle_inside(const Box& box, Place& place, const Known* known = nullptr) {
        if (cover_by_edges(box) == Cover::outside) return m_emitter.outside(box);
        if (!kIsSmall && m_scheme == Scheme::residual) return settle_residual(box, place);
        if (m_scheme == Scheme::blocks) return settle_blocks(box, place, known);
        if (m_costs.fallback().kind != Fallback::unknown || pixels_of(box) < kLeastInFloat)
            return settle_fastest(box, place, known);
        const auto trial = m_direct.try_middle(box);
        const bool by_blocks = m_scheme == Scheme::automatic;
        if (trial.fallback.is_direct())
            m_costs.set_fallback(trial.fallback);
        else if (by_blocks && trial.error > kHopeless * m_goal && trial.error < HUGE_VAL)
            m_costs.set_fallback({Fallback::exact});
        if (trial.fallback.is_direct() && by_blocks && !m_polynomials.may_beat_direct(box, place.local))
            leave(box);
        // Where one bound cannot be had, the other is too wide.
        else if (by_blocks && !(trial.error < HUGE_VAL))
            cut_for_fallback(box);
        else
            settle_fastest(box, place, known);
        m_costs.set_fallback({});
    }
    /// Settles a box by polynomials where they may be faster, else by the fallback.
    void settle_fastest(const Box& box, Place& place, const Known* known) {
        if (m_scheme == Scheme::automatic)
            settle_blocks(box, place, known);
        else if (m_costs.fallback().is_direct())
            leave(box);
        else
            cut_for_fallback(box);
    }
    /// Settles a box in parts of which some may be direct, down to the least of such.
    void cut_for_fallback(const Box& box) {
        if (pixels_of(box) <= kLeastInFloat) return leave(box);
        split(box, [&](const Box& b) { settle(b); });
    }

    /// Leaves a box to the fallback, since no polynomial serves it.
    void leave(const Box& box) {
        for_blocks(box, [&](const Box& b) {
            if (m_bounds.has_edges() && m_bounds.cover(b, m_bounds.place_about(b).local) == Cover::outside)
                m_emitter.outside(b);
            else
                m_emitter.without_polynomial(b);
        });
    }

    void settle_blocks(const Box& box, Place& place, const Known* known) {
        if (known) return settle_blocks(*known, place);
        if (!m_costs.worth_a_bound(box)) return leave(box);
        if (has_quarters(box)) return settle_by_quarters(box, place);
        Known one;
        m_polynomials.know({&box, 1}, place.local, &one);
        settle_blocks(one, place);
    }
    void settle_blocks(const Known& known, Place& place) {
        const Bound bound = m_polynomials.bound_of(known);
        if (m_polynomials.serves(known, bound))
            place_all_parts(known.box, place, bound, known);
        else
            settle_quarters(known.box, place, bound.reach < 0);
    }

    /// Does no part about whose middle blocks are placed (Parts) cross the edges of its quarters? The sides of parts divide
    /// two blocks, and those of quarters are multiples of that.
    static bool has_quarters(const Box& box) {
        return box.width() > 2 * kBlockWidth && box.height() > 2 * kBlockHeight;
    }
    /// Settles a large box by bounds of its quarters, which costs no more at once and is many times narrower.
    /// It stays whole where they are no better off each by itself.
    void settle_by_quarters(const Box& box, Place& place) {
        in_parts(box, Quarters(box), [&](std::span<const Box> quarters) {
            Known known[simd::kJets];
            m_polynomials.know(quarters, place.local, known);
            Bound all = m_polynomials.bound_of(known[0]);
            for (std::size_t i = 1; i < quarters.size(); ++i)
                all = Polynomials::larger(all, m_polynomials.bound_of(known[i]));
            const auto stays = [&](const Known& part) { return m_polynomials.serves_as_well(part, all); };
            if (std::all_of(known, known + quarters.size(), stays))
                return place_all_parts(box, place, all, known[0]);
            for (std::size_t i = 0; i < quarters.size(); ++i) settle_known(known[i], place);
        });
    }
    /// Settles a box with what is known of it, unless all of it can be culled.
    void settle_known(const Known& known, Place& place) {
        if (m_culls && m_bounds.lies_beyond(known.enclosed)) return m_emitter.outside(known.box);
        settle_inside(known.box, place, &known);
    }
    /// Settles the quarters of a box, or its halves where quarters could not pay for their bounds. `kept`:
    /// none can be culled. `within`: a place that holds the box.
    void settle_quarters(const Box& box, const Place& within, bool kept) {
        const Box quarter{box.x0, box.y0, box.x0 + box.width() / 2, box.y0 + box.height() / 2};
        const auto at_once = [&](std::span<const Box> parts) {
            Place place = m_bounds.part_of(within, box);
            Known known[simd::kJets];
            m_polynomials.know(parts, place.local, known);
            for (std::size_t i = 0; i < parts.size(); ++i) settle_known(known[i], place);
        };
        const auto one_by_one = [&](const Box& b) {
            if (!kept) return settle(b);
            Place place = m_bounds.part_of(within, b);
            settle_inside(b, place);
        };
        if (m_costs.worth_a_bound(quarter))
            in_parts(box, Quarters(box), at_once);
        else if (m_costs.worth_a_bound(sub_box(box, is_cut_vertically(box), false)))
            in_halves(box, is_cut_vertically(box), kFloor, at_once);
        else
            split(box, one_by_one);
    }

    /// Places blocks all over a box that a bound serves.
    void place_all_parts(const Box& box, Place& place, Bound bound, const Known& known) {
        bound.rounding = m_bounds.shared_rounding(box, place);
        for_boxes(box, 4 * kBlockWidth, 4 * kBlockHeight,
                  [&](const Box& b) { place_parts(b, place, bound, known); });
    }
    /// Places blocks about the middles of a box's parts.
    void place_parts(const Box& box, const Place& place, const Bound& bound, const Known& known) {
        const Local& local = place.local;
        const Parts parts = m_polynomials.parts_of(box, bound);
        if (parts.are == Parts::left) return leave(box);
        const auto for_parts = [&](const Box& within, const auto& body) {
            for_boxes(within, parts.width, parts.height, body);
        };
        const auto renew = [&](const Box& b) {
            m_costs.worth_a_bound(b) ? settle_quarters(b, place, true) : leave(b);
        };
        typename Polynomials::InTurn taylors(m_bounds, local, known);
        const auto place_all = [&](const Box& within, const Bound& with) {
            if (!m_costs.worth_a_polynomial()) return leave(within);
            if (parts.are == Parts::renewed) return for_parts(within, renew);
            for_parts(within, [&](const Box& b) {
                place_block(b, m_polynomials.expand(b, local, with, taylors.of(b)), local, with);
            });
        };
        const auto add_all = [&](const Box& within) {
            if (parts.are == Parts::placed) for_parts(within, [&](const Box& b) { taylors.add(b); });
        };
        if (parts.width > kBlockWidth || parts.height > kBlockHeight) {
            add_all(box);
            return place_all(box, bound);
        }
        for_blocks(box, add_all);
        for_blocks(box, [&](const Box& b) {
            unless_left(b, [&] { place_all(b, m_polynomials.with_rounding(bound, b, parts, local)); });
        });
    }
    /// Places a part of an expansion's box as one polynomial block if that holds the tolerance, else in
    /// halves.
    void place_block(const Box& box, const Expansion& expansion, const Local& local, const Bound& bound) {
        if (!is_block(box))
            return for_blocks(box, [&](const Box& b) { place_block(b, expansion, local, bound); });
        if (const Cover cover = cover_of_block(box); cover == Cover::outside)
            return m_emitter.outside(box);
        else if (cover != Cover::inside)
            return halve(box, is_cut_vertically(box), kCutFloor,
                         [&](const Box& b) { place_block(b, expansion, local, bound); });
        const Fit fit = Polynomials::fit_on(expansion, box);
        if (m_polynomials.lies_beyond(fit.taylor, expansion.error, bound)) return m_emitter.outside(box);
        if (m_emitter.fit(box, local, fit, expansion.error)) return;
        if (m_polynomials.is_cheaper_in_double(box, fit) &&
            m_emitter.in_double(box, local, fit.taylor, expansion.error))
            return;
        // About its own middle the remainder is smaller.
        if (box != expansion.box && fit.error + expansion.error > m_tol &&
            fit.error + Polynomials::tail_over(box, bound) <= m_tol) {
            const auto taylor = m_bounds.taylor_of(box, local);
            return place_block(box, m_polynomials.expand(box, local, bound, taylor), local, bound);
        }
        // Halve the side along which more was dropped, or rounded.
        const bool rounded = fit.error + expansion.error <= m_tol;
        const auto size = [&](int i, int j) {
            return std::fabs(fit.taylor.x.at(i, j)) + std::fabs(fit.taylor.y.at(i, j));
        };
        const bool vertical_cut =
            rounded ? size(1, 0) >= size(0, 1) : size(4, 0) + size(3, 1) >= size(0, 4) + size(1, 3);
        halve(box, vertical_cut, kFloor, [&](const Box& b) { place_block(b, expansion, local, bound); });
    }

    /// Settles a box by cells of a table, as wide as the second derivatives allow.
    void settle_residual(const Box& box, const Place& place) {
        const auto curvature = m_residuals.curvature(box, place.local);
        if (curvature.is_hopeless(m_tol)) return leave(box);
        const auto settle_part = [&](const Box& b) { settle(b); };
        if (curvature.error(std::min(box.width(), kBlockWidth), std::min(box.height(), kBlockHeight)) <=
            m_tol)
            for_blocks(box,
                       [&](const Box& b) { place_cell(b, place, curvature.error(b.width(), b.height())); });
        else if (!is_block(box))
            split(box, settle_part);
        else
            halve(box, curvature.is_cut_vertically(box), kFloor, settle_part);
    }
    void place_cell(const Box& box, const Place& place, double interpolation_error) {
        const auto cell = m_residuals.cell(box, place.local, interpolation_error);
        if (m_emitter.quadratic(box, place.local, cell.x, cell.y, cell.error)) return;
        halve(box, box.width() > box.height(), kFloor, [&](const Box& b) { settle(b); });
    }

    /// Calls body(part) for the halves of a box, cut across its longer side.
    template <class Body>
    void split(const Box& box, const Body& body) {
        halve(box, is_cut_vertically(box), kFloor, body);
    }
    template <class Body>
    void halve(const Box& box, bool vertical_cut, int floor, const Body& body) {
        in_halves(box, vertical_cut, floor, [&](std::span<const Box> halves) {
            for (const Box& half : halves) body(half);
        });
    }
    /// Calls body(parts) with both halves at once.
    template <class Body>
    void in_halves(const Box& box, bool vertical_cut, int floor, const Body& body) {
        const auto halves = halves_of(box, vertical_cut, floor);
        in_parts(box, halves ? std::span<const Box>(*halves) : std::span<const Box>(), body);
    }
    /// Calls body(parts); where there are none, or no polynomial came out of them, leaves one block without.
    template <class Body>
    void in_parts(const Box& box, std::span<const Box> parts, const Body& body) {
        if (parts.empty()) return leave(box);
        unless_left(box, [&] { body(parts); });
    }
    /// Calls body(); a block that gets no polynomial from it is left as a whole.
    template <class Body>
    void unless_left(const Box& box, const Body& body) {
        if (!is_block(box))
            body();
        else if (m_emitter.takes_back(body))
            leave(box);
    }

    Scheme m_scheme;
    double m_tol, m_goal;
    bool m_culls;
    CostModel m_costs;
    BoxBounds<Map> m_bounds;
    BlockEmitter<Map> m_emitter;
    PolynomialStrategy<Map> m_polynomials;
    DirectStrategy<Map> m_direct;
    ResidualStrategy<Map> m_residuals;
    typename BoxBounds<Map>::Edges m_edges;  ///< those that cut the box that is being settled
};

}  // namespace anamorph::plan_detail
