// SPDX-License-Identifier: Apache-2.0
// The pull map of a picture of a picture: the outer one leads from the target to a picture that need not be drawn, the inner
// one from there to the source. Pixels, x right, y down, pixel centres at + 0.5.
//
// It is one formula, that of the inner map at what the outer one gives, so that derivatives (the chain rule), bounds over boxes
// and rounding come from reading it with other numbers, as those of any other map. Where the picture in the middle has edges
// or holes the chain has no source point; the edges are where computed points cross them. How much of a pixel lies within
// edges is told beside (add_edges()), so that they are not drawn pixel by pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <memory>
#include <optional>
#include <type_traits>
#include <vector>

#include "anamorph/chain/middle_edges.h"
#include "anamorph/chain/piece_finder.h"
#include "anamorph/plan/map_link.h"

namespace anamorph {

/// The picture in the middle, as the outer map sees it.
struct MiddlePicture {
    /// The pixel of the inner map at which the outer map's coordinates begin: the corner of the display window.
    Point<double> origin{0, 0};
    Size overscan = {};      ///< the inner map's (PlanOptions::overscan)
    bool has_poles = false;  ///< are its first and last row the poles, so that there is nothing beyond them?
};

class ChainMap {
  public:
    /// Exact pixels cost most: they go from map to map one by one, where single maps have them in vectors.
    static constexpr PlanCosts kCosts{.bound = 20,
                                      .further_bound = 4,
                                      .credit = 0.25,
                                      .bound_pixels = 16,
                                      .polynomial = 3,
                                      .rounding = 6,
                                      .double_pixel = 0.02};

    /// The source of `outer` is what `inner` draws. One that closes on itself is as wide as that.
    ChainMap(std::shared_ptr<const MapLink> outer, std::shared_ptr<const MapLink> inner,
             const MiddlePicture& middle);

    // The members that make this a FormulaMap (plan/formula_map.h).

    /// Where both maps are read, and how far the picture in the middle is turned there. There is no inner place where the
    /// outer point lies beyond that picture and the inner map does not go on.
    struct Local {
        LinkPlace outer, inner;
        int piece = -1;  ///< of the picture in the middle, that holds the outer point or goes on to it
        Point<double> shift{0, 0};
    };
    Size target_size() const { return m_outer->target_size(); }
    Size source_size() const { return m_inner->source_size(); }
    std::vector<Box> target_pieces() const { return m_outer->target_pieces(); }
    SourceEdges source_edges() const { return m_inner->source_edges(); }
    int source_piece(const Local& local) const {
        return local.inner ? m_inner->source_piece(local.inner) : 0;
    }
    int period() const { return m_inner->source_period(); }
    int target_period() const { return m_outer->target_period(); }
    bool reads_computed_points() const { return m_outer->reads_computed_points(); }
    Local local_around(double x, double y, int piece) const;
    /// Of edges for whole pixels about the centres in a box: those that an edge crosses are drawn in part.
    Cover cover(const Interval& x, const Interval& y, int piece, const Local& local, bool across_seam) const;

    template <class T>
    Point<T> operator()(const T& x, const T& y, const Local& local) const {
        if (!local.inner) return {T(NAN), T(NAN)};
        return m_inner->read(in_middle(m_outer->read(Point<T>{x, y}, local.outer), local.shift), local.inner);
    }
    template <RealNumber Real>
    bool exact(const Real& x, const Real& y, int piece, Point<Real>& p, int& source_piece) const {
        Point<Real> at;
        if (!m_outer->exact(x, y, piece, at, source_piece)) return false;
        at = taken_back(at);
        const int middle = piece_at(static_cast<double>(at.x), static_cast<double>(at.y));
        return middle >= 0 && m_inner->exact(at.x, at.y, middle, p, source_piece);
    }
    /// MapLink::jacobian(), by the chain rule.
    Jacobian jacobian(double x, double y, int piece) const;
    /// `off`: how far the points of the box may be off themselves (MapLink::exact_error).
    template <class Real>
    double exact_error(const Interval& x, const Interval& y, int piece, double off = 0) const {
        return exact_error(x, y, piece, off, std::is_same_v<Real, DoubleDouble>);
    }
    /// The way of a box of target points into the picture in the middle.
    struct Way {
        LinkPlace place;         ///< the outer map's
        bool is_smooth = false;  ///< does all of the box lie on one branch of that?
        /// A box that holds their points there, shifted into the picture; none where that is not known.
        std::optional<Point<Interval>> points = {};
    };
    Way way_of(const Interval& x, const Interval& y, int piece) const;
    /// All edges over a box of pixels (CutMap), of pictures in the middle without gaps.
    std::optional<EdgesOverBox> edges_over(const Box& box, int piece) const {
        return edges_over(box, piece, way_of(Interval(box.x0, box.x1), Interval(box.y0, box.y1), piece));
    }
    std::optional<EdgesOverBox> edges_over(const Box& box, int piece, const Way& way) const;
    /// Of a point nothing needs to be known.
    Way way_of_values(const Point<Jet1<double>>&, int) const { return {}; }
    Way way_of_values(const Point<Jet1<Interval>>& p, int piece) const {
        return way_of(p.x.c[0], p.y.c[0], piece);
    }

    /// MapLink::add_edges() of double and of Interval, of points on a way. A picture in the middle with gaps between its pieces adds
    /// none.
    template <class T>
    bool add_edges(const Point<Jet1<T>>& p, int piece, const Way& way, std::vector<Jet1<T>>& edges) const;
    template <class T>
    bool add_edges(const Point<Jet1<T>>& p, int piece, std::vector<Jet1<T>>& edges) const {
        return add_edges(p, piece, way_of_values(p, piece), edges);
    }

    // Where maps end (MapLink). `beyond`: those that draw the pictures in the middle.
    bool may_end() const { return true; }
    bool may_end_in(const Interval& x, const Interval& y, int piece) const {
        return m_outer->may_end_in(x, y, piece) || ends_beyond(way_of(x, y, piece));
    }
    bool ends_beyond(const Way& way) const;
    bool is_clear(const Interval& x, const Interval& y, int piece) const {
        return !m_outer->may_end_in(x, y, piece) && is_clear_beyond(way_of(x, y, piece));
    }
    bool is_clear_beyond(const Way& way) const;
    bool add_ends(const Point<Jet1<double>>& p, int piece, std::vector<Jet1<double>>& edges) const {
        return m_outer->add_ends(p, piece, edges) && add_ends_beyond(p, piece, {}, edges);
    }
    bool add_ends_beyond(const Point<Jet1<double>>& p, int piece, const Way& way,
                         std::vector<Jet1<double>>& edges) const;

  private:
    /// A point of the picture in the middle, from the outer map's.
    template <class T>
    static Point<T> in_middle(const Point<T>& p, const Point<double>& shift) {
        if (shift.x == 0 && shift.y == 0) return p;
        return {p.x + T(shift.x), p.y + T(shift.y)};
    }
    /// A point that the outer map computed in the picture in the middle: where that closes on itself, within it, whatever the
    /// turn, and at poles whatever the rounding.
    template <class Real>
    Point<Real> taken_back(const Point<Real>& p) const {
        const int period = m_outer->source_period();
        if (period == 0) return {p.x + m_middle.origin.x, p.y + m_middle.origin.y};
        const Real y = m_middle.has_poles ? std::clamp<Real>(p.y, 0, m_inner->target_size().height) : p.y;
        return {p.x - floor(p.x / period) * period, y};
    }
    /// The point of the picture in the middle, shifted into it, and how it moves with a target point on a way; none where it is not known.
    template <class T>
    std::optional<Point<Jet1<T>>> middle_of_jets(const Point<Jet1<T>>& p, int piece, const Way& way) const;
    /// The piece of the picture in the middle that is nearest to a point.
    int piece_near(double x, double y) const;
    /// The shift into the picture in the middle of the outer map's points near x.
    Point<double> shift_about(double x) const;
    /// Does the picture in the middle go on beyond its edges as one formula, but for where it closes on itself and at poles?
    bool goes_on(const Point<Interval>& box) const;
    /// The piece of the picture in the middle that holds a point; -1 where there is none.
    int piece_at(double x, double y) const { return m_pieces.holding(Interval(x), Interval(y)); }
    /// Is all of a box outside of the picture in the middle, which may close across?
    bool misses(const Point<Interval>& box) const;
    /// Does a box reach beyond an edge of the picture in the middle by more than is negligible?
    bool meets_edge(const Point<Interval>& box) const;
    /// Do target points of a box, whose points in the middle lie in `points`?
    bool crosses_edge(const Interval& x, const Interval& y, const Point<Interval>& points, int piece,
                      const Local& local) const;

    double exact_error(const Interval& x, const Interval& y, int piece, double off,
                       bool in_long_double) const;
    /// Bounds the error of source points from a box in the middle, whose points are off by `off` at most.
    double error_from(const Point<Interval>& box, double off, bool in_long_double) const;

    std::shared_ptr<const MapLink> m_outer, m_inner;
    MiddlePicture m_middle;
    PieceFinder m_pieces;  ///< of the picture in the middle
};

}  // namespace anamorph
