// SPDX-License-Identifier: Apache-2.0
// How FormulaPlan cuts a map into blocks. Included only by source files that instantiate it.
#pragma once

#include <algorithm>
#include <bit>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "anamorph/number/jets.h"
#include "anamorph/plan/block_writer.h"
#include "anamorph/plan/cubic_terms.h"
#include "anamorph/plan/direct_blocks.h"
#include "anamorph/plan/formula_plan.h"
#include "anamorph/plan/residual.h"
#include "anamorph/plan/taylor.h"

namespace anamorph {
namespace planner_detail {

inline constexpr int kBlockWidth = BlockWriter::kWidth, kBlockHeight = BlockWriter::kHeight;
// Below this a polynomial costs more than its pixels.
inline constexpr int kFloor = 8, kResidualFloor = 4;

// What a Taylor polynomial goes through once its coefficients are known, in units of rounding of their sum:
// moved and scaled to a part of its box, 25 operations for each variable, of which the shift's own rounding
// counts four times more, on magnitudes that a part's outermost pixel may double; rearranged in Chebyshev
// polynomials, 6 operations on twice the sum; less a base, as four corners' mean and as linear part and
// residual of a table, 8.
inline constexpr double kRearranged = (2 * (2 * 25 + 2 * 4) + 2 * 6 + 8 + 24) * 0x1p-53;
// Blocks of a box share a bound of rounding up to this part of the tolerance; above, each has its own.
inline constexpr double kSharedRounding = 1.0 / 64;
// Smaller boxes have too few blocks for looking at their halves.
inline constexpr int kBoxOfRoundings = 4 * BlockWriter::kWidth * BlockWriter::kHeight;

// Where any pixel is exact, what rounding costs it need not be known better than this (source pixels).
inline constexpr double kExactGoal = 1e-4;
// Boxes of up to so many exact pixels are read in long double where that keeps the tolerance, larger ones are
// halved first.
inline constexpr int kPrecisePixels = 64;
// Long double is at most so many times more precise: 11 bits less those by which constants are known worse.
inline constexpr double kPreciseGain = 512;

// Blocks are not counted in more parts than this.
inline constexpr int kMostParts = 256;
// The part of the tolerance that a remainder over a box may take up for a polynomial on it; and for one that
// serves parts of it.
inline constexpr double kTailShare = 0.125, kPartShare = 0.25;

// Where a block in the middle of a box misses it by so much, others of it are not looked at.
inline constexpr double kHopeless = 4;

inline int pixels_of(const Box& box) {
    return box.width() * box.height();
}

inline double length(double x, double y) {
    return std::sqrt(x * x + y * y);
}

/// What a region's bicubic blocks are made of.
struct Cubics : RegionData {
    std::vector<CubicTerms> terms;
    /// Of precise ones all coefficients up to degree 4, as in Jet, less the base.
    struct Precise {
        double x[15], y[15];
    };
    std::vector<Precise> precise;
};

inline BlockPolynomial cubic_of(const Block& block) {
    const auto& cubics = static_cast<const Cubics&>(*block.data);
    return with_cubic_terms(block, cubics.terms[static_cast<std::size_t>(block.record)]);
}

/// A row of a polynomial in double: by Horner's rule for t, then for s, as image/block_sampler_lanes.cpp does in float.
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

/// And its direct blocks.
template <class Local>
struct Records : Cubics {
    DirectRecords<Local> direct;
};

template <class Local, class Real>
NearBlock<Local, Real> near_block(const Block& block) {
    return static_cast<const Records<Local>&>(*block.data).direct.template at<Real>(block.record);
}

/// Plans one piece of the target; blocks are appended to `blocks`, and to `records` what they are made of.
template <FormulaMap Map>
class FormulaPlanner {
    using Local = typename Map::Local;

  public:
    FormulaPlanner(const Map& map, const PlanOptions& options, const ReadOrders& orders, const Box& region,
                   int piece, Blocks& blocks, Records<Local>& records)
        : m_map(map),
          m_options(options),
          m_costs(options.costs.value_or(costs_of<Map>())),
          m_orders(orders),
          m_piece(piece),
          m_blocks(blocks),
          m_records(records),
          m_exact(options.scheme == Scheme::exact || options.tol == 0),
          m_goal(m_exact ? std::min(options.tol > 0 ? options.tol : kExactError, kExactError) : options.tol),
          m_balance(m_costs.credit * pixels_of(region)),
          m_over_direct(m_balance),
          m_margin(options.scheme == Scheme::residual ? 0 : 0.5) {}

    bool is_exact() const { return m_exact; }
    double goal() const { return m_goal; }
    bool may_be_direct() const {
        if constexpr (DirectMap<Map>)
            return m_read_as_written && m_map.may_be_direct();
        else
            return false;
    }
    void exact(const Box& box) {
        for_blocks(box, [&](const Box& b) { emit(b, Block::Kind::exact); });
    }

    /// Top-down: finds the branch of the map on which a large box lies, and settles it there.
    void settle(const Box& box) {
        if (!worth_a_bound(box)) return leave(box);
        const Local local = m_map.local_around(0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1), m_piece);
        switch (cover(box, local)) {
            case Cover::outside:
                return emit(box, Block::Kind::outside);
            case Cover::partial:
            case Cover::mixed:
                return split(box, [&](const Box& b) { settle(b); });
            case Cover::inside:
                return settle_inside(box, local);
        }
    }

  private:
    /// Is only the fastest way asked for?
    bool is_free() const { return m_options.scheme == Scheme::automatic || m_exact; }
    /// May a bound over the box pay? Where only the fastest way is asked for.
    bool worth_a_bound(const Box& box) const {
        return worth_a_polynomial() && (!is_free() || pixels_of(box) * saving() >= m_costs.bound_pixels);
    }
    bool worth_a_polynomial() const { return !is_free() || (m_direct ? m_over_direct : m_balance) >= 0; }
    /// What a polynomial's pixel saves, in exact pixels.
    double saving() const { return m_direct ? m_direct->saving : 1; }
    /// Bounds and polynomials are paid for by what they save over what there is without.
    void pay(double exact_pixels) {
        if (m_direct)
            m_over_direct -= exact_pixels / m_direct->saving;
        else
            m_balance -= exact_pixels;
    }

    // The Taylor polynomial of a block has degree 4; its remainder is bounded over large boxes.
    using Tail = Remainder<5>;
    using Taylor = Point<Jet<double, 4>>;
    using Enclosed = Point<Jet<Interval, 5>>;

    /// What is computed of several boxes at once.
    struct Known {
        Box box;
        Enclosed enclosed;
        Taylor middle;                 ///< of the block in the middle
        std::optional<Taylor> itself;  ///< of the box, where it may be one polynomial's
    };

    /// A box that lies on one branch.
    void settle_inside(const Box& box, const Local& local, const Known* known = nullptr) {
        if (m_options.scheme == Scheme::residual && !m_exact) return settle_residual(box, local);
        if (m_options.scheme == Scheme::blocks && !m_exact) return settle_blocks(box, local, known);
        const bool first = !m_direct && !m_never_direct && pixels_of(box) >= kLeastInFloat;
        const bool by_blocks = m_options.scheme == Scheme::automatic && !m_exact;
        const double error = first ? find_direct(box) : 0;
        if (first) m_never_direct = by_blocks && error > kHopeless * m_goal && error < HUGE_VAL;
        // Where one bound cannot be had, the other is too wide.
        if (m_direct || (by_blocks && error < HUGE_VAL))
            by_blocks && (!first || may_beat_direct(box, local)) ? settle_blocks(box, local, known)
                                                                 : leave(box);
        else if (pixels_of(box) <= kLeastInFloat)
            leave(box);
        else
            split(box, [&](const Box& b) { settle(b); });
        if (!first) return;
        m_direct.reset();
        m_never_direct = false;
    }

    /// What is expected of direct blocks: that they hold the tolerance over most of a box.
    struct Direct {
        bool precise;   ///< in double
        double saving;  ///< of a polynomial's pixel over one of theirs
    };
    /// Judges by the block in the middle of a box. Returns its error where none is expected to hold the tolerance, else 0.
    double find_direct(const Box& box) {
        if constexpr (DirectMap<Map>) {
            if (!may_be_direct()) return 0;
            Box middle = is_block(box) ? box : middle_of(box);
            const auto error_in = [&](auto real, const Box& of) {
                using Real = decltype(real);
                m_balance -= m_costs.direct_trial;
                const NearReading found = read_near<Real>(m_map, of, local_about(of), m_orders, m_bases);
                m_read_as_written = m_read_as_written && is_read_as_written<Real>(found, m_orders);
                return found.error;
            };
            const auto expect = [&](bool precise, double saving) {
                m_direct = {precise, saving};
                return 0.0;
            };
            const auto part_of = [](const Box& of) { return sub_box(of, of.width() > of.height(), false); };
            double error = m_exact ? error_in(0.0, middle) : error_in(0.0f, middle);
            if (!m_read_as_written) return 0;
            // Where blocks are too large for any bound, smaller ones may have one.
            while (!(error < HUGE_VAL) && pixels_of(middle) >= 2 * kLeastInFloat) {
                middle = part_of(middle);
                error = m_exact ? error_in(0.0, middle) : error_in(0.0f, middle);
            }
            if (m_exact) return error <= m_goal ? expect(true, m_costs.precise_pixel) : error;
            if (error <= m_goal) return expect(false, m_costs.direct_pixel);
            // Where float holds it in smaller blocks only, a polynomial saves more.
            const auto in_parts = [&] {
                Box part = middle;
                while (pixels_of(part) >= 2 * kLeastInFloat) part = part_of(part);
                return error_in(0.0f, part) <= m_goal;
            };
            if (serves_in_float(middle, error, m_goal) && in_parts())
                return expect(false, m_costs.precise_pixel);
            if (error < HUGE_VAL) error = error_in(0.0, middle);
            return error <= m_goal ? expect(true, m_costs.precise_pixel) : error;
        }
        return 0;
    }
    /// Could polynomials in float pay where direct blocks are expected? Judges by the block in the middle of a box: by the
    /// number of parts into which its error, an expected remainder and the rounding of floats cut it.
    bool may_beat_direct(const Box& box, const Local& local) const {
        if (!m_direct) return true;
        using J = Jet1<double>;
        const Box middle = middle_of(box);
        // Bounds may cost as much again.
        const auto pays = [&](double blocks) {
            return !(2 * m_costs.polynomial * blocks >= pixels_of(middle) * m_direct->saving);
        };
        const Point<J> p = m_map(J::variable(0.5 * (middle.x0 + middle.x1), half(middle.width()), 0),
                                 J::variable(0.5 * (middle.y0 + middle.y1), 0, half(middle.height())), local);
        const double x[10] = {0, p.x.c[1], p.x.c[2]}, y[10] = {0, p.y.c[1], p.y.c[2]};
        const double rounding = BlockWriter::cubic_rounding(x, y);
        if (!pays(parts(0, 0, rounding))) return false;
        const Taylor taylor = taylor_of(middle, local);
        return pays(parts(Fit(taylor).error, expected_tail(taylor), rounding));
    }
    /// What the terms of degree 5 would be if they were as much smaller than those of degree 4 as those than degree 3's.
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
    /// What no polynomial serves.
    void leave(const Box& box) {
        for_blocks(box, [&](const Box& b) {
            if (has_edges() && cover(b, local_about(b)) == Cover::outside)
                emit(b, Block::Kind::outside);
            else
                m_direct ? leave_direct(b) : emit(b, Block::Kind::exact);
        });
    }
    /// For DirectBlocks.
    void leave_direct(const Box& box) {
        emit(box, Block::Kind::computed);
        m_blocks.back().precise = m_direct->precise;
        m_blocks.back().data = &m_records;
        m_balance += pixels_of(box) * (1 - m_direct->saving);
    }

    Local local_about(const Box& box) const {
        return m_map.local_around(0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1), m_piece);
    }

    /// The map's Taylor coefficients over a box, in pixels of the target.
    template <int N>
    Point<Jet<Interval, N>> enclose(const Box& box, const Local& local) const {
        using J = Jet<Interval, N>;
        return m_map(J::variable(across(box), 1, 0), J::variable(down(box), 0, 1), local);
    }
    /// Its pixel centres, or all of it where blocks are made of values at its corners.
    Interval across(const Box& box) const { return {box.x0 + m_margin, box.x1 - m_margin}; }
    Interval down(const Box& box) const { return {box.y0 + m_margin, box.y1 - m_margin}; }

    /// Does every point of the box have a source point on one smooth branch of the map?
    Cover cover(const Box& box, const Local& local) const {
        const Cover found = m_map.cover(across(box), down(box), m_piece, local, m_options.across_seam);
        // Where a formula goes on, its bounds hold for those points that count.
        if (found == Cover::partial)
            return m_options.cull && culled(box, local) == Cover::outside ? Cover::outside : Cover::mixed;
        return found == Cover::inside && m_options.cull ? culled(box, local) : found;
    }

    /// Does the source image have edges beyond which nothing is drawn?
    bool has_edges() const {
        const SourceEdges edges = m_map.source_edges();
        return m_options.cull && (edges.across || edges.down);
    }
    /// Outside when every pixel's footprint lies beyond the source image's edges.
    Cover culled(const Box& box, const Local& local) const {
        const Size size = m_map.source_size();
        const SourceEdges edges = m_map.source_edges();
        // Of whole pixels: some are drawn in parts (image/block_reader.h).
        const Interval x(box.x0, box.x1), y(box.y0, box.y1);
        const Point<Interval> at = m_map(x, y, local);
        const auto meets = [](const Interval& a, int length) { return a.hi >= 0 && a.lo <= length; };
        if ((!edges.across || meets(at.x, size.width)) && (!edges.down || meets(at.y, size.height)))
            return Cover::inside;
        using J = Jet<Interval, 1>;
        return lies_beyond(m_map(J::variable(x, 1, 0), J::variable(y, 0, 1), local)) ? Cover::outside
                                                                                     : Cover::inside;
    }
    /// Of what the map's Taylor coefficients over a box say.
    template <int N>
    bool lies_beyond(const Point<Jet<Interval, N>>& p) const {
        return lie_beyond(p.x.c[0], p.y.c[0], footprint_reach(p, m_map.source_size()));
    }
    /// Of source points in these ranges, with texels that lie up to `reach` from them.
    bool lie_beyond(const Interval& x, const Interval& y, double reach) const {
        const Size size = m_map.source_size();
        const SourceEdges edges = m_map.source_edges();
        const auto beyond = [&](const Interval& a, int length) {
            return a.hi < -reach || a.lo > length + reach;
        };
        return (edges.across && beyond(x, size.width)) || (edges.down && beyond(y, size.height));
    }

    /// Can no part of a box be culled, with its source points here?
    bool is_kept(const Interval& x, const Interval& y) const {
        const Size size = m_map.source_size();
        const SourceEdges edges = m_map.source_edges();
        const auto within = [](const Interval& a, int length) { return a.lo >= 0 && a.hi <= length; };
        return !m_options.cull ||
               ((!edges.across || within(x, size.width)) && (!edges.down || within(y, size.height)));
    }

    /// How far from its source point a pixel's texels lie at most, in source pixels (image/footprint.h).
    ///
    /// Taps: a side of the footprint that is n texels of its level long has at most n + 1 taps, since the
    /// energy of w texels is at least 2 / (3 w), and two texels between them at most: they reach n texels
    /// either way, the side's own length. `length`: of all sides, in both coordinates.
    ///
    /// Texels: bilinear taps read one texel around them. A level is chosen only where on the one before, at
    /// most 4 times finer each way, the narrow side w had too many taps, or all had: there texels were
    /// smaller than half of max(w, 1) (their mean over both ways), or than 1 / 3.5 of a side in one way.
    /// While neither way of the level has come down to one texel, texels are at most 4 times longer one way
    /// than the other: all are shorter than 4 * 4 * length. A level that is one texel high or wide has texels
    /// as large as the image at most.
    ///
    /// Other filters and rounding: 4 pixels.
    template <int N>
    static double footprint_reach(const Point<Jet<Interval, N>>& p, const Size& source) {
        const double length =
            magnitude(p.x.c[1]) + magnitude(p.x.c[2]) + magnitude(p.y.c[1]) + magnitude(p.y.c[2]);
        const double texel = 16 * std::max(1.0, length);
        const double narrow = std::min(source.width, source.height);
        return length + (texel < narrow ? texel : std::max(source.width, source.height)) + 4;
    }

    /// What a bound over a box gives the blocks in it.
    struct Bound {
        Tail x, y;
        double rounding;  ///< infinite where each has its own
        double reach;     ///< of their footprints where some may lie beyond the image's edges; else -1
    };
    /// Does all that blocks of a Taylor polynomial would read lie beyond an edge? It is off by `error`, in a box that `bound` is
    /// of.
    bool lies_beyond(const Taylor& taylor, double error, const Bound& bound) const {
        if (bound.reach < 0) return false;
        const auto range = [error](const Jet<double, 4>& f) {
            double spread = error;
            for (int i = 1; i < 15; ++i) spread += std::fabs(f.c[i]);
            return Interval{f.c[0] - spread, f.c[0] + spread};
        };
        return lie_beyond(range(taylor.x), range(taylor.y), bound.reach);
    }

    /// What rounding costs the blocks in a box, of up to a given size; or values, for a size of 0.
    double rounding_over(const Box& box, double half_width, double half_height, const Local& local) const {
        const auto t = taylor_rounding(m_map, across(box), down(box), half_width, half_height, local);
        return length(t.error.x + kRearranged * t.size.x, t.error.y + kRearranged * t.size.y);
    }
    /// One for all blocks of a box where it is small; found in parts where all of it is too much at once.
    double shared_rounding(const Box& box, const Local& local) const {
        const double rounding = rounding_over(box, half(std::min(2 * kBlockWidth, box.width())),
                                              half(std::min(2 * kBlockHeight, box.height())), local);
        if (rounding <= kSharedRounding * m_options.tol) return rounding;
        if (pixels_of(box) < kBoxOfRoundings) return HUGE_VAL;
        const bool vertical_cut = box.width() >= box.height();
        const double first = shared_rounding(sub_box(box, vertical_cut, false), local);
        return first < HUGE_VAL ? std::max(first, shared_rounding(sub_box(box, vertical_cut, true), local))
                                : HUGE_VAL;
    }
    void settle_blocks(const Box& box, const Local& local, const Known* known = nullptr) {
        if (!known) {
            if (!worth_a_bound(box)) return leave(box);
            if (has_quarters(box)) return settle_by_quarters(box, local);
            Known one;
            know({&box, 1}, local, &one);
            return settle_blocks(box, local, &one);
        }
        const Bound bound = bound_of(*known);
        if (is_block(box) ? tail_over(box, bound) < HUGE_VAL : serves(box, known->middle, bound))
            place_all_parts(box, local, bound, known);
        else
            settle_quarters(box, bound.reach < 0);
    }
    static bool is_block(const Box& box) {
        return box.width() <= kBlockWidth && box.height() <= kBlockHeight;
    }

    /// Does no part about whose middle blocks are placed (parts_of) cross the edges of its quarters? The sides of parts divide
    /// two blocks, and those of quarters are multiples of that.
    static bool has_quarters(const Box& box) {
        return box.width() > 2 * kBlockWidth && box.height() > 2 * kBlockHeight;
    }
    /// A large box is bounded in its quarters, which costs no more at once and is many times narrower. It stays whole where
    /// they are no better off each by itself.
    void settle_by_quarters(const Box& box, const Local& local) {
        in_quarters(box, [&](std::span<const Box> quarters) {
            Known known[simd::kJets];
            know(quarters, local, known);
            Bound all = bound_of(known[0]);
            for (std::size_t i = 1; i < quarters.size(); ++i) all = larger(all, bound_of(known[i]));
            const auto stays = [&](const Known& part) { return serves_as_well(part, all); };
            if (std::all_of(known, known + quarters.size(), stays))
                return place_all_parts(box, local, all, &known[0]);
            together(box, local, [&] {
                for (std::size_t i = 0; i < quarters.size(); ++i) settle_known(known[i], local);
            });
        });
    }
    Bound bound_of(const Known& known) const {
        const Enclosed& p = known.enclosed;
        const bool kept = is_kept(p.x.c[0], p.y.c[0]);
        return {Tail(p.x), Tail(p.y), HUGE_VAL, kept ? -1 : footprint_reach(p, m_map.source_size())};
    }
    static Bound larger(const Bound& a, const Bound& b) {
        return {Tail::larger(a.x, b.x), Tail::larger(a.y, b.y), HUGE_VAL, std::max(a.reach, b.reach)};
    }
    /// Does a bound serve a box, in no smaller parts than its own would?
    bool serves_as_well(const Known& known, const Bound& bound) const {
        const Parts shared = parts_of(known.box, bound), own = parts_of(known.box, bound_of(known));
        return shared.width * shared.height == own.width * own.height && shared.are == own.are &&
               serves(known.box, known.middle, bound);
    }
    /// Blocks all over a box that a bound serves.
    void place_all_parts(const Box& box, const Local& local, Bound bound, const Known* known) {
        bound.rounding =
            m_together && m_together->local == &local ? m_together->rounding_of(*this) : HUGE_VAL;
        if (!(bound.rounding < HUGE_VAL)) bound.rounding = shared_rounding(box, local);
        for_boxes(box, 4 * kBlockWidth, 4 * kBlockHeight,
                  [&](const Box& b) { place_parts(b, local, bound, known); });
    }
    /// A box whose parts are settled with the same local: what rounding costs them is found once, when first asked for.
    struct Together {
        Box box;
        const Local* local;
        double rounding = -1;

        double rounding_of(const FormulaPlanner& planner) {
            if (rounding < 0) rounding = planner.shared_rounding(box, *local);
            return rounding;
        }
    };
    template <class Body>
    void together(const Box& box, const Local& local, const Body& body) {
        Together here{box, &local};
        Together* const outer = std::exchange(m_together, &here);
        body();
        m_together = outer;
    }

    /// A box with what is known of it, unless all of it can be culled.
    void settle_known(const Known& known, const Local& local) {
        if (m_options.cull && lies_beyond(known.enclosed)) return emit(known.box, Block::Kind::outside);
        settle_inside(known.box, local, &known);
    }
    /// What is in the quarters of a box; in its halves where quarters could not pay for their bounds. `kept`: none can be
    /// culled.
    void settle_quarters(const Box& box, bool kept) {
        const Box quarter{box.x0, box.y0, box.x0 + box.width() / 2, box.y0 + box.height() / 2};
        const auto at_once = [&](std::span<const Box> parts) {
            const Local local = local_about(box);
            together(box, local, [&] { settle_at_once(parts, local); });
        };
        if (worth_a_bound(quarter))
            in_quarters(box, at_once);
        else if (worth_a_bound(sub_box(box, is_cut_vertically(box), false)))
            in_halves(box, is_cut_vertically(box), kFloor, at_once);
        else
            split(box, [&](const Box& b) { kept ? settle_inside(b, local_about(b)) : settle(b); });
    }
    void settle_at_once(std::span<const Box> boxes, const Local& local) {
        Known known[simd::kJets];
        know(boxes, local, known);
        for (std::size_t i = 0; i < boxes.size(); ++i) settle_known(known[i], local);
    }
    /// Of up to kJets boxes.
    void know(std::span<const Box> boxes, const Local& local, Known* known) {
        pay(m_costs.bound + m_costs.further_bound * (static_cast<double>(boxes.size()) - 1));
        Box middles[simd::kJets];
        const auto enclosed = enclose_all(boxes, local);
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
            taylors_of({middles, boxes.size()}, local, taylors);
            for (std::size_t i = 0; i < boxes.size(); ++i) known[i].middle = taylors[i];
        }
        if (!single || boxes.size() == 1) return;
        taylors_of(boxes, local, taylors);
        for (std::size_t i = 0; i < boxes.size(); ++i) known[i].itself = taylors[i];
    }
    Point<simd::BoundJets> enclose_all(std::span<const Box> boxes, const Local& local) const {
        Interval x[simd::kJets], y[simd::kJets];
        for (std::size_t i = 0; i < simd::kJets; ++i) {
            const Box& box = boxes[std::min(i, boxes.size() - 1)];
            x[i] = across(box);
            y[i] = down(box);
        }
        return m_map(simd::BoundJets::variable(x, kOnes, kNone), simd::BoundJets::variable(y, kNone, kOnes),
                     local);
    }

    static double tail_over(double hx, double hy, const Bound& bound) {
        return length(bound.x.over(hx, hy), bound.y.over(hx, hy));
    }
    static double tail_over(const Box& box, const Bound& bound) {
        return tail_over(half(box.width()), half(box.height()), bound);
    }

    struct Fit {
        Point<Jet<double, 4>> taylor;
        EconomizedCubic x, y;
        double error;

        explicit Fit(const Point<Jet<double, 4>>& f)
            : taylor(f), x(f.x), y(f.y), error(length(x.error, y.error)) {}
    };
    /// The map's Taylor polynomials about the middles of up to kJets boxes, with offsets of -1 to 1 over their pixel
    /// centres.
    void taylors_of(std::span<const Box> boxes, const Local& local, Taylor* taylors) const {
        double x[simd::kJets], y[simd::kJets], half_width[simd::kJets], half_height[simd::kJets];
        for (std::size_t i = 0; i < simd::kJets; ++i) {
            const Box& box = boxes[std::min(i, boxes.size() - 1)];
            x[i] = 0.5 * (box.x0 + box.x1);
            y[i] = 0.5 * (box.y0 + box.y1);
            half_width[i] = half(box.width());
            half_height[i] = half(box.height());
        }
        using J = simd::TaylorJets;
        const Point<J> f =
            m_map(J::variable(x, half_width, kNone), J::variable(y, kNone, half_height), local);
        for (std::size_t i = 0; i < boxes.size(); ++i)
            taylors[i] = {f.x.at(static_cast<int>(i)), f.y.at(static_cast<int>(i))};
    }
    Taylor taylor_of(const Box& box, const Local& local) const {
        Taylor taylor;
        taylors_of({&box, 1}, local, &taylor);
        return taylor;
    }

    /// Is a remainder small enough for the blocks of a box? Tried on the one in its middle. Halving the box
    /// costs two bounds, and may save the blocks that are cut smaller only for what the intervals are wide.
    bool serves(const Box& box, const Taylor& in_middle, const Bound& bound) const {
        const Box middle = middle_of(box);
        const double tail = tail_over(middle, bound);
        if (!(tail < HUGE_VAL)) return false;
        const double hx = half(middle.width()), hy = half(middle.height());
        const double least = length(bound.x.about(hx, hy), bound.y.about(hx, hy));
        // As many as are counted are too many, whatever the middles say.
        if (parts(0, tail) >= kMostParts) return false;
        const Fit fit(in_middle);
        const double error = cheaper_in_double(middle, fit) ? 0 : fit.error;
        const double blocks = pixels_of(box) / double{kBlockWidth * kBlockHeight};
        return blocks * (parts(error, tail) - parts(error, least)) * m_costs.polynomial <= 2 * m_costs.bound;
    }
    static Box middle_of(const Box& box) {
        const int x0 = (box.x0 + box.x1) / 2, y0 = (box.y0 + box.y1) / 2;
        return {x0, y0, std::min(x0 + kBlockWidth, box.x1), std::min(y0 + kBlockHeight, box.y1)};
    }

    /// Are cubics in float so many, for their error or their rounding, that one polynomial in double costs less?
    /// Not where pixels may be direct.
    bool cheaper_in_double(const Box& box, const Fit& fit) const {
        if (m_direct) return false;
        const double finer = BlockWriter::cubic_rounding(fit.x.c, fit.y.c) / m_options.tol;
        return m_costs.polynomial * std::max(parts(fit.error, 0), finer * finer) >=
               m_costs.double_pixel * pixels_of(box);
    }

    /// Into how many parts a block is cut until a cubic holds the tolerance: its error falls with the fourth
    /// power of the side, the remainder with the fifth, and what rounding takes of the tolerance with the side itself.
    double parts(double fit, double tail, double rounding = 0) const {
        double count = 1, side = 1;
        while (count < kMostParts && !(std::max(fit + tail * side, tail * side / kTailShare) <=
                                       (m_options.tol - rounding * side) * (count * count))) {
            count *= 2;
            side *= 0.70710678;
        }
        return count;
    }

    /// A Taylor polynomial, and how far it is from the map anywhere in its box, remainder and rounding.
    struct Expansion {
        Box box;
        Point<Jet<double, 4>> taylor;
        double error;
    };
    Expansion expand(const Box& box, const Local& local, const Bound& bound, const Taylor& taylor) {
        const bool shares = bound.rounding < HUGE_VAL;
        pay(shares ? m_costs.polynomial : m_costs.polynomial + m_costs.rounding);
        const double rounding =
            shares ? bound.rounding : rounding_over(box, half(box.width()), half(box.height()), local);
        return {box, taylor, tail_over(box, bound) + rounding};
    }
    /// On a part of its box.
    static Fit fit_on(const Expansion& e, const Box& b) {
        if (b == e.box) return Fit(e.taylor);
        const double per_x = 1 / half(e.box.width()), per_y = 1 / half(e.box.height());
        const auto part = [&](const Jet<double, 4>& f) {
            return on_part(f, 0.5 * (b.x0 + b.x1 - e.box.x0 - e.box.x1) * per_x, half(b.width()) * per_x,
                           0.5 * (b.y0 + b.y1 - e.box.y0 - e.box.y1) * per_y, half(b.height()) * per_y);
        };
        return Fit({part(e.taylor.x), part(e.taylor.y)});
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
            if (tail <= (of_one ? kTailShare : kPartShare) * m_options.tol) return p;
            p.are = p.width <= kFloor && p.height <= kFloor ? Parts::left : Parts::renewed;
            const bool dear = parts(0, tail) * m_costs.polynomial > 2 * m_costs.bound;
            if (p.are == Parts::left || (dear && p.width * p.height <= kBlockWidth * kBlockHeight)) return p;
            bool vertical_cut = tail_over(0.5 * hx, hy, bound) <= tail_over(hx, 0.5 * hy, bound);
            if (vertical_cut ? p.width <= kFloor : p.height <= kFloor) vertical_cut = !vertical_cut;
            int& side = vertical_cut ? p.width : p.height;
            side = static_cast<int>(std::bit_ceil(static_cast<unsigned>(side))) / 2;
            p.are = Parts::placed;
        }
    }
    /// The Taylor polynomials of boxes that are asked for in the order in which they were added: several at once.
    class InTurn {
      public:
        InTurn(const FormulaPlanner& planner, const Local& local, const Known& known)
            : m_planner(planner), m_local(local), m_known(known) {}

        void add(const Box& box) { m_boxes.push_back(box); }
        /// Some may be left out.
        const Taylor& of(const Box& box) {
            if (m_boxes.size() == 1 && m_known.itself && box == m_known.box) return *m_known.itself;
            while (m_boxes[m_at] != box) ++m_at;
            if (m_at >= m_end) {
                const std::size_t count = std::min<std::size_t>(simd::kJets, m_boxes.size() - m_at);
                m_planner.taylors_of({&m_boxes[m_at], count}, m_local, m_taylors);
                m_first = m_at;
                m_end = m_at + count;
            }
            return m_taylors[m_at - m_first];
        }

      private:
        const FormulaPlanner& m_planner;
        const Local& m_local;
        const Known& m_known;
        std::vector<Box> m_boxes;
        std::size_t m_at = 0, m_first = 0, m_end = 0;
        Taylor m_taylors[simd::kJets];
    };
    /// Places blocks about the middles of such parts.
    void place_parts(const Box& box, const Local& local, const Bound& bound, const Known* known) {
        const Parts parts = parts_of(box, bound);
        if (parts.are == Parts::left) return leave(box);
        const bool small = parts.width <= kBlockWidth && parts.height <= kBlockHeight;
        const auto for_parts = [&](const Box& within, const auto& body) {
            for_boxes(within, parts.width, parts.height, body);
        };
        const auto renew_all = [&](const Box& within) {
            for_parts(within, [&](const Box& b) { worth_a_bound(b) ? settle_quarters(b, true) : leave(b); });
        };
        InTurn taylors(*this, local, *known);
        const auto place_all = [&](const Box& within) {
            if (!worth_a_polynomial()) return leave(within);
            if (parts.are == Parts::renewed) return renew_all(within);
            for_parts(within,
                      [&](const Box& b) { place(b, expand(b, local, bound, taylors.of(b)), local, bound); });
        };
        const auto add_all = [&](const Box& within) {
            if (parts.are == Parts::placed) for_parts(within, [&](const Box& b) { taylors.add(b); });
        };
        if (!small) {
            add_all(box);
            return place_all(box);
        }
        for_blocks(box, add_all);
        for_blocks(box, [&](const Box& b) { unless_left(b, [&] { place_all(b); }); });
    }

    /// Emits a part of an expansion's box as one polynomial block if that holds the tolerance, else halves it.
    void place(const Box& box, const Expansion& expansion, const Local& local, const Bound& bound) {
        if (box.width() > kBlockWidth || box.height() > kBlockHeight)
            return for_blocks(box, [&](const Box& b) { place(b, expansion, local, bound); });
        const Fit fit = fit_on(expansion, box);
        if (lies_beyond(fit.taylor, expansion.error, bound)) return emit(box, Block::Kind::outside);
        if (emit_fit(box, local, fit, expansion.error) || emit_precise(box, local, fit, expansion.error))
            return;
        // About its own middle the remainder is smaller.
        if (box != expansion.box && fit.error + expansion.error > m_options.tol &&
            fit.error + tail_over(box, bound) <= m_options.tol)
            return place(box, expand(box, local, bound, taylor_of(box, local)), local, bound);
        // Halve the side along which more was dropped, or rounded.
        const bool rounded = fit.error + expansion.error <= m_options.tol;
        const auto size = [&](int i, int j) {
            return std::fabs(fit.taylor.x.at(i, j)) + std::fabs(fit.taylor.y.at(i, j));
        };
        const bool vertical_cut =
            rounded ? size(1, 0) >= size(0, 1) : size(4, 0) + size(3, 1) >= size(0, 4) + size(1, 3);
        halve(box, vertical_cut, kFloor, [&](const Box& b) { place(b, expansion, local, bound); });
    }

    /// Kim's table: bilinear cells between nodes on a regular grid, as wide as the second derivatives allow.
    void settle_residual(const Box& box, const Local& local) {
        const auto p = enclose<2>(box, local);
        // |f - its bilinear interpolant| <= h^2 / 2 max |f_ss| per direction, h half the cell.
        const auto error = [&](int w, int h) {
            const auto of = [&](const Jet<Interval, 2>& f) {
                return 0.25 * (magnitude(f.at(2, 0)) * w * w + magnitude(f.at(0, 2)) * h * h);
            };
            return length(of(p.x), of(p.y));
        };
        const bool is_block = box.width() <= kBlockWidth && box.height() <= kBlockHeight;
        const bool holds =
            error(std::min(box.width(), kBlockWidth), std::min(box.height(), kBlockHeight)) <= m_options.tol;
        if (holds)
            for_blocks(box, [&](const Box& b) { place_cell(b, local, error(b.width(), b.height())); });
        else if (!is_block)
            split(box, [&](const Box& b) { settle(b); });
        else {
            const double wide = magnitude(p.x.at(2, 0)) + magnitude(p.y.at(2, 0));
            const double high = magnitude(p.x.at(0, 2)) + magnitude(p.y.at(0, 2));
            const bool vertical_cut = wide * box.width() * box.width() >= high * box.height() * box.height();
            halve(box, vertical_cut, kResidualFloor, [&](const Box& b) { settle(b); });
        }
    }

    /// One cell of the table: residuals at its four corners in float, plus the linear part.
    void place_cell(const Box& box, const Local& local, double interpolation_error) {
        if (!m_linear) m_linear = linear_part(m_map, m_piece);
        double x[4], y[4], stored = 0;
        for (int i = 0; i < 4; ++i) {
            const double px = i & 1 ? box.x1 : box.x0, py = i & 2 ? box.y1 : box.y0;
            const Point<double> l = (*m_linear)(px, py), n = residual_at(m_map, *m_linear, local, px, py);
            const double nx = static_cast<float>(n.x), ny = static_cast<float>(n.y);
            stored = std::max(stored, std::fabs(nx) + std::fabs(ny));
            x[i] = l.x + nx;
            y[i] = l.y + ny;
        }
        // From values at the cell's corners (beyond the outermost pixel centres) to coefficients in s and t.
        const double ks = half(box.width()) / (0.5 * box.width()),
                     kt = half(box.height()) / (0.5 * box.height());
        const auto bilinear = [&](const double* v, double* c) {
            c[0] = 0.25 * (v[0] + v[1] + v[2] + v[3]);
            c[1] = 0.25 * (v[1] + v[3] - v[0] - v[2]) * ks;
            c[2] = 0.25 * (v[2] + v[3] - v[0] - v[1]) * kt;
            c[4] = 0.25 * (v[0] + v[3] - v[1] - v[2]) * ks * kt;
            c[3] = c[5] = 0;
        };
        double cx[6], cy[6];
        bilinear(x, cx);
        bilinear(y, cy);
        const double rounding = rounding_over(box, 0, 0, local);
        if (emit_polynomial(box, m_map.source_piece(local), cx, cy,
                            interpolation_error + stored * 0x1p-24 + rounding))
            return;
        halve(box, box.width() > box.height(), kResidualFloor, [&](const Box& b) { settle(b); });
    }

    /// True when a polynomial of degree 2 or, where that does not, 3 keeps the tolerance, `error` away from the
    /// map besides: then the block is appended.
    bool emit_fit(const Box& box, const Local& local, const Fit& fit, double error) {
        if (!(fit.error + error <= m_options.tol)) return false;
        const int source_piece = m_map.source_piece(local);
        const Economized x(fit.x), y(fit.y);
        return emit_polynomial(box, source_piece, x.c, y.c, length(x.error, y.error) + error) ||
               emit_cubic(box, source_piece, fit.x.c, fit.y.c, fit.error + error);
    }
    /// True when the polynomial, off by `error` in double and evaluated in float, keeps the tolerance: then
    /// the block is appended.
    bool emit_polynomial(const Box& box, int source_piece, const double* cx, const double* cy, double error) {
        if (!BlockWriter(m_options.tol, m_blocks).polynomial(box, cx, cy, error)) return false;
        finish(box, source_piece);
        return true;
    }
    bool emit_cubic(const Box& box, int source_piece, const double* cx, const double* cy, double error) {
        if (!BlockWriter(m_options.tol, m_blocks).cubic(box, cx, cy, error)) return false;
        m_records.terms.emplace_back(cx, cy);
        finish(box, source_piece);
        m_blocks.back().data = &m_records;
        m_blocks.back().record = static_cast<int>(m_records.terms.size()) - 1;
        return true;
    }
    /// The Taylor polynomial as it is, in double, where cubics in float would be so many that this is cheaper.
    bool emit_precise(const Box& box, const Local& local, const Fit& fit, double error) {
        const double *x = fit.taylor.x.c, *y = fit.taylor.y.c;
        // The base may come to stand a turn farther away.
        error += 0x1p-53 * m_map.period();
        if (!cheaper_in_double(box, fit) || !BlockWriter(m_options.tol, m_blocks).precise(box, x, y, error))
            return false;
        const Block& block = m_blocks.back();
        Cubics::Precise& c = m_records.precise.emplace_back();
        std::copy_n(x, 15, c.x);
        std::copy_n(y, 15, c.y);
        c.x[0] -= block.base_x;
        c.y[0] -= block.base_y;
        finish(box, m_map.source_piece(local));
        pay(m_costs.double_pixel * pixels_of(box));
        m_blocks.back().data = &m_records;
        m_blocks.back().record = static_cast<int>(m_records.precise.size()) - 1;
        return true;
    }
    /// What the writer does not know of a block.
    void finish(const Box& box, int source_piece) {
        if (m_direct) m_over_direct += pixels_of(box);
        m_balance += pixels_of(box) * (m_direct ? 1 - m_direct->saving : 1);
        set_source(m_blocks.back(), source_piece);
    }
    void set_source(Block& block, int source_piece) const {
        block.piece = m_piece;
        block.source_piece = source_piece;
        turn_into_image(block, m_map.period());
    }

    void emit(const Box& box, Block::Kind kind) {
        Block block;
        block.box = box;
        block.kind = kind;
        block.piece = m_piece;
        m_blocks.push_back(block);
    }

    /// body(part) for the parts of a box on a grid of width x height from its corner.
    template <class Body>
    static void for_boxes(const Box& box, int width, int height, const Body& body) {
        for (int y = box.y0; y < box.y1; y += height)
            for (int x = box.x0; x < box.x1; x += width)
                body(Box{x, y, std::min(x + width, box.x1), std::min(y + height, box.y1)});
    }
    template <class Body>
    static void for_blocks(const Box& box, const Body& body) {
        for_boxes(box, kBlockWidth, kBlockHeight, body);
    }

    /// Is a box that is cut across its longer side (counted in blocks) cut from top to bottom?
    static bool is_cut_vertically(const Box& box) {
        const int wide = box.width() * kBlockHeight, high = box.height() * kBlockWidth;
        return wide > high || (wide == high && box.width() > kFloor);
    }
    /// `body` on the halves of a box, cut across its longer side.
    template <class Body>
    void split(const Box& box, const Body& body) {
        halve(box, is_cut_vertically(box), kFloor, body);
    }

    /// `body` on the halves of the box; where neither side can be cut above the floor, or no polynomial came out of it,
    /// one block without.
    template <class Body>
    void halve(const Box& box, bool vertical_cut, int floor, const Body& body) {
        in_halves(box, vertical_cut, floor, [&](std::span<const Box> halves) {
            for (const Box& half : halves) body(half);
        });
    }
    /// The same, with `body` on both at once.
    template <class Body>
    void in_halves(const Box& box, bool vertical_cut, int floor, const Body& body) {
        if (vertical_cut ? box.width() <= floor : box.height() <= floor) vertical_cut = !vertical_cut;
        if (vertical_cut ? box.width() <= floor : box.height() <= floor) return leave(box);
        const Box halves[] = {sub_box(box, vertical_cut, false), sub_box(box, vertical_cut, true)};
        unless_left(box, [&] { body(std::span<const Box>(halves)); });
    }
    /// The same for quarters.
    template <class Body>
    void in_quarters(const Box& box, const Body& body) {
        const bool across = box.width() > kFloor, down = box.height() > kFloor;
        if (!across && !down) return leave(box);
        Box parts[4];
        std::size_t count = 0;
        for (const bool lower : {false, true})
            for (const bool right : {false, true}) {
                if ((lower && !down) || (right && !across)) continue;
                const Box row = down ? sub_box(box, false, lower) : box;
                parts[count++] = across ? sub_box(row, true, right) : row;
            }
        unless_left(box, [&] { body(std::span<const Box>(parts, count)); });
    }
    /// One block without a polynomial, if nothing else comes of `body`.
    template <class Body>
    void unless_left(const Box& box, const Body& body) {
        const std::size_t first = m_blocks.size();
        body();
        const auto kind = m_direct ? Block::Kind::computed : Block::Kind::exact;
        const auto is_left = [&](const Block& b) { return b.kind == kind; };
        if (is_block(box) &&
            std::all_of(m_blocks.begin() + static_cast<std::ptrdiff_t>(first), m_blocks.end(), is_left)) {
            m_blocks.resize(first);
            leave(box);
        }
    }

    static constexpr double kOnes[simd::kJets] = {1, 1, 1, 1}, kNone[simd::kJets] = {};

    const Map& m_map;
    const PlanOptions& m_options;
    PlanCosts m_costs;
    ReadOrders m_orders;
    bool m_read_as_written = true;  ///< would direct blocks read the bases that are written for them?
    int m_piece;
    Blocks& m_blocks;
    Records<Local>& m_records;
    bool m_exact;          ///< is every pixel evaluated by the formula in double?
    double m_goal;         ///< bounds are not to exceed it
    double m_balance;      ///< exact pixels saved less those that bounds and polynomials would have paid for
    double m_over_direct;  ///< the same in direct pixels, over those where they serve
    double m_margin;  ///< of what is enclosed of a box: from its edges to the nodes that blocks are made of
    std::optional<LinearPart> m_linear;
    Together* m_together = nullptr;
    bool m_never_direct = false;  ///< is nothing expected of direct blocks in the box that is being settled?
    std::optional<Direct> m_direct;  ///< what is expected to serve most of the box that is being settled
    Bases m_bases;
};

/// Gives exact blocks the bound of their rounding, and cuts out of them the pixels that need long double.
template <FormulaMap Map>
class ExactBounds {
  public:
    ExactBounds(const Map& map, double tol, Blocks& blocks)
        : m_map(map), m_goal(tol > 0 ? tol : kExactGoal), m_blocks(blocks) {}

    /// Appends the blocks of an exact block.
    void place(Block block) {
        const Interval x{block.box.x0 + 0.5, block.box.x1 - 0.5}, y{block.box.y0 + 0.5, block.box.y1 - 0.5};
        block.bound = bound_of<double>(block, x, y);
        const int pixels = pixels_of(block.box);
        const bool may_help =
            pixels == 1 || (pixels <= kPrecisePixels && block.bound <= kPreciseGain * m_goal);
        if (!(block.bound <= m_goal) && may_help) {
            block.precise = true;
            block.bound = bound_of<long double>(block, x, y);
        }
        if (block.bound <= m_goal || pixels == 1)
            m_blocks.push_back(block);
        else
            halve(block);
    }

  private:
    /// Halves that came out alike are one block again.
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
        const double bound = larger(m_blocks[first].bound, m_blocks[first + 1].bound);
        m_blocks.resize(first + 1);
        m_blocks[first].box = block.box;
        m_blocks[first].bound = bound;
    }
    static double larger(double a, double b) { return a >= b ? a : b; }
    /// Infinite where none is known.
    template <class Real>
    double bound_of(const Block& block, const Interval& x, const Interval& y) const {
        const double bound = m_map.template exact_error<Real>(x, y, block.piece);
        return std::isnan(bound) ? HUGE_VAL : bound;
    }

    const Map& m_map;
    double m_goal;
    Blocks& m_blocks;
};

}  // namespace planner_detail

template <class Map>
FormulaPlan<Map>::FormulaPlan(const Map& map, const PlanOptions& options, const ReadOrders& orders)
    : BlockMap(map.target_size().width, map.target_size().height, map.target_pieces()),
      m_map(map),
      m_options(options),
      m_orders(orders) {
    check_tol(options.tol);
}

template <class Map>
void FormulaPlan<Map>::plan(const Box& box, int piece, Blocks& blocks) const {
    using namespace planner_detail;
    Blocks planned;
    planned.reserve(2 * kRegion * kRegion / (kBlockWidth * kBlockHeight));
    const auto records = std::make_shared<Records<typename Map::Local>>();
    FormulaPlanner<Map> planner(m_map, m_options, m_orders, box, piece, planned, *records);
    if (planner.is_exact() && !planner.may_be_direct())
        planner.exact(box);
    else
        planner.settle(box);
    if constexpr (DirectMap<Map>)
        planned = DirectBlocks<Map>(m_map, planner.goal(), m_orders, records->direct).placed(planned);
    blocks.reserve(planned.size());
    ExactBounds<Map> exact(m_map, m_options.tol, blocks);
    for (const Block& block : planned)
        if (block.kind == Block::Kind::exact)
            exact.place(block);
        else
            blocks.push_back(block);
    if (!records->terms.empty() || !records->precise.empty() || !records->direct.readings.empty())
        blocks.data = records;
}

template <class Map>
BlockPolynomial FormulaPlan<Map>::bicubic(const Block& block) const noexcept {
    return planner_detail::cubic_of(block);
}

template <class Map>
void FormulaPlan<Map>::exact_rows(const Block& block, int begin, int end,
                                  const DoubleRows& to) const noexcept {
    if (block.kind != Block::Kind::bicubic) return BlockMap::exact_rows(block, begin, end, to);
    for (int row = begin; row < end; ++row) {
        const std::ptrdiff_t at = (row - begin) * to.stride;
        planner_detail::precise_row(block, row, to.x + at, to.y + at);
        std::fill_n(to.piece + at, block.box.width(), block.source_piece);
    }
}

template <class Map>
bool FormulaPlan<Map>::exact(double x, double y, int piece, Point<double>& source_point,
                             int& source_piece) const noexcept {
    return m_map.exact(x, y, piece, source_point, source_piece);
}

template <class Map>
bool FormulaPlan<Map>::truth(double x, double y, int piece, Point<long double>& source_point,
                             int& source_piece) const noexcept {
    return m_map.exact(static_cast<long double>(x), static_cast<long double>(y), piece, source_point,
                       source_piece);
}

template <class Map>
Jacobian FormulaPlan<Map>::jacobian(double x, double y, int piece) const noexcept {
    using J = Jet1<double>;
    const Point<J> p = m_map(J::variable(x, 1, 0), J::variable(y, 0, 1), m_map.local_around(x, y, piece));
    return {p.x.c[1], p.y.c[1], p.x.c[2], p.y.c[2]};
}

template <class Map>
NearBlock<typename Map::Local, float> FormulaPlan<Map>::near_in_float(const Block& block) {
    return planner_detail::near_block<typename Map::Local, float>(block);
}
template <class Map>
NearBlock<typename Map::Local, double> FormulaPlan<Map>::near_in_double(const Block& block) {
    return planner_detail::near_block<typename Map::Local, double>(block);
}

}  // namespace anamorph
