// SPDX-License-Identifier: Apache-2.0
// Bounds of a map over boxes of its target: where there is a source point, its Taylor coefficients, and their rounding.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "anamorph/number/jets.h"
#include "anamorph/plan/boxes.h"
#include "anamorph/plan/formula_plan.h"
#include "anamorph/plan/taylor.h"

namespace anamorph::plan_detail {

// The roundings that a Taylor polynomial goes through once its coefficients are known, in units of rounding
// of their sum: moved and scaled to a part of its box, 25 operations for each variable, of which the shift's
// own rounding counts four times more, on magnitudes that a part's outermost pixel may double; rearranged in
// Chebyshev polynomials, 6 operations on twice the sum; less a base, as four corners' mean and as linear part
// and residual of a table, 8.
inline constexpr double kRearranged = (2 * (2 * 25 + 2 * 4) + 2 * 6 + 8 + 24) * 0x1p-53;
// Blocks of a box share a bound of rounding up to this part of the tolerance; above, each has its own.
inline constexpr double kSharedRounding = 1.0 / 64;
// Smaller boxes have too few blocks for looking at their halves.
inline constexpr int kBoxOfRoundings = 4 * kBlockWidth * kBlockHeight;

/// Stands for the edges of maps that have none.
struct NoEdges {
    Cover cover(const Box&) const { return Cover::inside; }
};
template <class Map>
struct EdgesOf {
    using type = std::optional<NoEdges>;
};
template <CutMap Map>
struct EdgesOf<Map> {
    using type = decltype(std::declval<const Map&>().edges_over(Box(), 0));
};

/// The bounds of a map on one piece of the target.
template <FormulaMap Map>
class BoxBounds {
  public:
    using Local = typename Map::Local;
    // The Taylor polynomial of a block has degree 4; its remainder is bounded over large boxes.
    using Taylor = Point<Jet<double, 4>>;
    using Enclosed = Point<Jet<Interval, 5>>;
    using Edges = typename EdgesOf<Map>::type;

    /// A box on one branch of the map. All of it is read with one Local, about its own middle or that of a box around it.
    struct Place {
        Box box;
        Local local;
        double rounding = -1;  ///< rounding of any block in the box; negative until it is asked for
    };

    BoxBounds(const Map& map, const PlanOptions& options, int piece)
        : m_map(map),
          m_options(options),
          m_piece(piece),
          m_margin(options.scheme == Scheme::residual ? 0 : 0.5) {}

    Place place_about(const Box& box) const {
        return {box, m_map.local_around(0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1), m_piece)};
    }
    /// A part of a place that is inside: about its own middle, or as the place is where the part is not inside about that.
    Place part_of(const Place& place, const Box& part) const {
        if (part == place.box) return place;
        const Place own = place_about(part);
        if constexpr (DirectMap<Map>) return own;
        const Cover found = m_map.cover(across(part), down(part), m_piece, own.local, m_options.across_seam);
        return found == Cover::inside ? own : Place{part, place.local};
    }

    /// Does every point of the box have a source point on one smooth branch of the map?
    Cover cover(const Box& box, const Local& local) const {
        const Cover found = m_map.cover(across(box), down(box), m_piece, local, m_options.across_seam);
        // Where a formula goes on, its bounds hold for those points that count.
        if (found == Cover::partial || found == Cover::cut) {
            if (m_options.cull && culled(box, local) == Cover::outside) return Cover::outside;
            return found == Cover::cut ? Cover::cut : Cover::mixed;
        }
        return found == Cover::inside && m_options.cull ? culled(box, local) : found;
    }

    /// The edges that cut a box, where it is known which do.
    Edges edges_over(const Box& box) const {
        if constexpr (CutMap<Map>)
            return m_map.edges_over(box, m_piece);
        else
            return {};
    }

    /// Does the source image have edges beyond which nothing is drawn?
    bool has_edges() const {
        const SourceEdges edges = m_map.source_edges();
        return m_options.cull && (edges.across || edges.down);
    }
    /// Can no part of a box be culled, with its source points here?
    bool is_kept(const Interval& x, const Interval& y) const {
        const Size size = m_map.source_size();
        const SourceEdges edges = m_map.source_edges();
        const auto within = [](const Interval& a, int length) { return a.lo >= 0 && a.hi <= length; };
        return !m_options.cull ||
               ((!edges.across || within(x, size.width)) && (!edges.down || within(y, size.height)));
    }
    /// Does all that pixels of a box would read lie beyond an edge, by the map's Taylor coefficients over it?
    template <int N>
    bool lies_beyond(const Point<Jet<Interval, N>>& p) const {
        return lie_beyond(p.x.c[0], p.y.c[0], footprint_reach(p));
    }
    /// Does all that is read at source points in these ranges lie beyond an edge, with texels up to `reach` from them?
    bool lie_beyond(const Interval& x, const Interval& y, double reach) const {
        const Size size = m_map.source_size();
        const SourceEdges edges = m_map.source_edges();
        const auto beyond = [&](const Interval& a, int length) {
            return a.hi < -reach || a.lo > length + reach;
        };
        return (edges.across && beyond(x, size.width)) || (edges.down && beyond(y, size.height));
    }

    /// The largest distance of a pixel's texels from its source point, in source pixels (image/footprint.h).
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
    double footprint_reach(const Point<Jet<Interval, N>>& p) const {
        const Size source = m_map.source_size();
        const double length =
            magnitude(p.x.c[1]) + magnitude(p.x.c[2]) + magnitude(p.y.c[1]) + magnitude(p.y.c[2]);
        const double texel = 16 * std::max(1.0, length);
        const double narrow = std::min(source.width, source.height);
        return length + (texel < narrow ? texel : std::max(source.width, source.height)) + 4;
    }

    /// The map's Taylor coefficients over a box, in pixels of the target.
    template <int N>
    Point<Jet<Interval, N>> enclose(const Box& box, const Local& local) const {
        using J = Jet<Interval, N>;
        return m_map(J::variable(across(box), 1, 0), J::variable(down(box), 0, 1), local);
    }
    /// The map's Taylor coefficients over each of up to kJets boxes.
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
    /// The polynomials' terms up to degree 1, for one box.
    Point<Jet1<double>> linear_of(const Box& box, const Local& local) const {
        using J = Jet1<double>;
        return m_map(J::variable(0.5 * (box.x0 + box.x1), half(box.width()), 0),
                     J::variable(0.5 * (box.y0 + box.y1), 0, half(box.height())), local);
    }

    /// The texels that a pixel in the middle of a box has.
    double texels_of_pixel(const Box& box) const {
        const Point<Jet1<double>> p = linear_of(box, place_about(box).local);
        const double area = half(box.width()) * half(box.height());
        return area > 0 ? std::fabs(p.x.c[1] * p.y.c[2] - p.x.c[2] * p.y.c[1]) / area : 0;
    }

    /// The rounding of the blocks in a box, of up to a given size; or of values, for a size of 0.
    double rounding_over(const Box& box, double half_width, double half_height, const Local& local) const {
        const auto t = taylor_rounding(m_map, across(box), down(box), half_width, half_height, local);
        return length(t.error.x + kRearranged * t.size.x, t.error.y + kRearranged * t.size.y);
    }
    /// A bound of rounding for all blocks in a part of a place, if possible for all of the place. Infinite where each block
    /// needs its own.
    double shared_rounding(const Box& part, Place& place) const {
        if (place.rounding < 0) place.rounding = shared_rounding(place.box, place.local);
        if (place.rounding < HUGE_VAL || part == place.box) return place.rounding;
        return shared_rounding(part, place.local);
    }

  private:
    /// The range of a box's pixel centres along x, or all of it where blocks are made of values at its corners.
    Interval across(const Box& box) const { return {box.x0 + m_margin, box.x1 - m_margin}; }
    Interval down(const Box& box) const { return {box.y0 + m_margin, box.y1 - m_margin}; }

    /// The cover of a box, which is outside also when every pixel's footprint lies beyond the source image's edges.
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

    /// A bound of rounding for all blocks in a box, found in halves where all of it is too much at once.
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

    static constexpr double kOnes[simd::kJets] = {1, 1, 1, 1}, kNone[simd::kJets] = {};

    const Map& m_map;
    const PlanOptions& m_options;
    int m_piece;
    double m_margin;  ///< distance from the edges of a box to the nodes that blocks are made of
};

}  // namespace anamorph::plan_detail
