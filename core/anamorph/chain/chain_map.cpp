// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chain/chain_map.h"

#include <algorithm>
#include <cmath>

namespace anamorph {
namespace {

double middle_of(const Interval& a) {
    return 0.5 * (a.lo + a.hi);
}

bool is_point(const Interval& a) {
    return a.lo == a.hi;
}

/// An interval with `by` more at both ends.
Interval widened(const Interval& a, double by) {
    return a + Interval(-by, by);
}

double middle_of(double a) {
    return a;
}

/// The pieces of a picture with its overscan.
std::vector<Box> pieces_of(const MapLink& map, const Size& overscan) {
    std::vector<Box> pieces = map.target_pieces();
    if (pieces.size() == 1) pieces[0] = widened(pieces[0], overscan);
    return pieces;
}

/// The part of an interval that lies in another.
Interval part_of(const Interval& a, double lo, double hi) {
    return {std::max(a.lo, lo), std::min(a.hi, hi)};
}

}  // namespace

ChainMap::ChainMap(std::shared_ptr<const MapLink> outer, std::shared_ptr<const MapLink> inner,
                   const MiddlePicture& middle)
    : m_outer(std::move(outer)),
      m_inner(std::move(inner)),
      m_middle(middle),
      m_pieces(pieces_of(*m_inner, middle.overscan)) {}

Point<double> ChainMap::shift_about(double x) const {
    const int period = m_outer->source_period();
    if (period == 0) return m_middle.origin;
    return {-std::floor(x / period) * period, 0};
}

bool ChainMap::misses(const Point<Interval>& box) const {
    const bool closes = m_outer->source_period() > 0;
    const auto is_beyond = [&](const Box& piece) {
        return (!closes && (box.x.hi < piece.x0 || box.x.lo > piece.x1)) || box.y.hi < piece.y0 ||
               box.y.lo > piece.y1;
    };
    if (!m_pieces.have_gaps()) return is_beyond(m_pieces.frame());
    return std::all_of(m_pieces.all().begin(), m_pieces.all().end(), is_beyond);
}

bool ChainMap::meets_edge(const Point<Interval>& box) const {
    const Box& frame = m_pieces.frame();
    const auto is_within = [](const Interval& a, int from, int to) {
        return a.lo >= from - EdgesOverBox::kNegligible && a.hi <= to + EdgesOverBox::kNegligible;
    };
    return !(m_outer->source_period() > 0 || is_within(box.x, frame.x0, frame.x1)) ||
           !(m_middle.has_poles || is_within(box.y, frame.y0, frame.y1));
}

bool ChainMap::crosses_edge(const Interval& x, const Interval& y, const Point<Interval>& points, int piece,
                            const Local& local) const {
    if (!meets_edge(points)) return false;
    // Where it is by little the bound may be too wide. What rises across or down the box is least on one of its sides, where the map is
    // read about the middle of that side.
    constexpr double kLittle = 0.25;
    if (meets_edge({widened(points.x, -kLittle), widened(points.y, -kLittle)})) return true;
    using J = Jet<Interval, 1>;
    const Point<J> slopes = m_outer->read(Point<J>{J::variable(x, 1, 0), J::variable(y, 0, 1)}, local.outer);
    const auto on_side = [&](const Interval& side_x, const Interval& side_y) -> Point<Interval> {
        const double at_x = middle_of(side_x), at_y = middle_of(side_y);
        const LinkPlace place = m_outer->place_around(at_x, at_y, piece);
        if (m_outer->cover(side_x, side_y, piece, place, /*across_seam=*/true) != Cover::inside)
            return {Interval::all(), Interval::all()};
        return in_middle(m_outer->read(Point<Interval>{side_x, side_y}, place), local.shift);
    };
    // The range of a coordinate, by its values on the sides that bound it.
    const auto range = [&](Interval Point<Interval>::*coordinate, const J& slope) -> Interval {
        if (slope.c[1].lo > 0 || slope.c[1].hi < 0) {
            const Interval a = on_side(Interval(x.lo), y).*coordinate,
                           b = on_side(Interval(x.hi), y).*coordinate;
            return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
        }
        if (slope.c[2].lo > 0 || slope.c[2].hi < 0) {
            const Interval a = on_side(x, Interval(y.lo)).*coordinate,
                           b = on_side(x, Interval(y.hi)).*coordinate;
            return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
        }
        return points.*coordinate;
    };
    return meets_edge({range(&Point<Interval>::x, slopes.x), range(&Point<Interval>::y, slopes.y)});
}

ChainMap::Local ChainMap::local_around(double x, double y, int piece) const {
    Local local{m_outer->place_around(x, y, piece), {}, -1, {0, 0}};
    Point<double> at;
    int outer_piece = 0;
    if (!m_outer->exact(x, y, piece, at, outer_piece)) return local;
    // By the branch, which may be another turn than the exact point.
    at = m_outer->read(Point<double>{x, y}, local.outer);
    local.shift = shift_about(at.x);
    at = in_middle(at, local.shift);
    local.piece = piece_at(at.x, at.y);
    if (local.piece < 0) {
        Point<double> p;
        int source_piece = 0;
        if (!goes_on({Interval(at.x), Interval(at.y)}) || !m_inner->exact(at.x, at.y, 0, p, source_piece))
            return local;
        local.piece = 0;
    }
    local.inner = m_inner->place_around(at.x, at.y, local.piece);
    return local;
}

Cover ChainMap::cover(const Interval& x, const Interval& y, int piece, const Local& local,
                      bool across_seam) const {
    const Cover outer = m_outer->cover(x, y, piece, local.outer, /*across_seam=*/true);
    if (outer != Cover::inside) return outer == Cover::outside ? Cover::outside : Cover::mixed;
    const Point<Interval> whole =
        in_middle(m_outer->read(Point<Interval>{widened(x, 0.5), widened(y, 0.5)}, local.outer), local.shift);
    if (misses(whole)) return Cover::outside;
    if (!local.inner) return Cover::mixed;
    const Point<Interval> at = in_middle(m_outer->read(Point<Interval>{x, y}, local.outer), local.shift);
    const bool is_cut = crosses_edge(widened(x, 0.5), widened(y, 0.5), whole, piece, local) ||
                        m_pieces.holding(at.x, at.y) != local.piece;
    if (is_cut && !goes_on(whole)) return Cover::mixed;
    // Where the inner map ends, whole pixels are crossed too.
    const Point<Interval>& points = is_cut || m_inner->may_end() ? whole : at;
    const Cover inner = m_inner->cover(points.x, points.y, local.piece, local.inner, across_seam);
    if (inner == Cover::partial) return Cover::mixed;
    return inner == Cover::inside && is_cut ? Cover::cut : inner;
}

bool ChainMap::goes_on(const Point<Interval>& box) const {
    const Box& frame = m_pieces.frame();
    const bool closes = m_outer->source_period() > 0;
    return m_pieces.all().size() == 1 && (!closes || (box.x.lo >= frame.x0 && box.x.hi <= frame.x1)) &&
           (!m_middle.has_poles || (box.y.lo >= frame.y0 && box.y.hi <= frame.y1));
}

std::optional<EdgesOverBox> ChainMap::edges_over(const Box& box, int piece, const Way& way) const {
    using D = Jet1<double>;
    using I = Jet1<Interval>;
    const Interval x(box.x0, box.x1), y(box.y0, box.y1);
    std::vector<D> middle;
    std::vector<I> over;
    const bool are_known =
        way.is_smooth &&
        add_edges(Point<D>{D::variable(middle_of(x), 1, 0), D::variable(middle_of(y), 0, 1)}, piece, way,
                  middle) &&
        add_edges(Point<I>{I::variable(x, 1, 0), I::variable(y, 0, 1)}, piece, way, over) &&
        middle.size() == over.size();
    if (!are_known) return {};
    return EdgesOverBox(box, std::move(middle), std::move(over));
}

Jacobian ChainMap::jacobian(double x, double y, int piece) const {
    Point<double> at;
    int outer_piece = 0;
    if (!m_outer->exact(x, y, piece, at, outer_piece)) return {NAN, NAN, NAN, NAN};
    at = taken_back(at);
    const int middle = piece_at(at.x, at.y);
    if (middle < 0) return {NAN, NAN, NAN, NAN};
    const Jacobian a = m_outer->jacobian(x, y, piece), b = m_inner->jacobian(at.x, at.y, middle);
    return {b.x_i * a.x_i + b.x_j * a.y_i, b.y_i * a.x_i + b.y_j * a.y_i, b.x_i * a.x_j + b.x_j * a.y_j,
            b.y_i * a.x_j + b.y_j * a.y_j};
}

double ChainMap::exact_error(const Interval& x, const Interval& y, int piece, double off,
                             bool in_long_double) const {
    const double error = m_outer->exact_error(x, y, piece, off, in_long_double);
    if (!(error < HUGE_VAL)) return HUGE_VAL;
    // A box that holds the outer points, the true ones and the computed ones.
    Point<Interval> points;
    if (is_point(x) && is_point(y)) {
        Point<double> at;
        int outer_piece = 0;
        // Whether there is one is certain, as the error is not infinite.
        if (!m_outer->exact(x.lo, y.lo, piece, at, outer_piece)) return 0;
        points = {Interval(at.x), Interval(at.y)};
    } else if (const auto all = m_outer->points_of(x, y)) {
        points = *all;
    } else {
        const LinkPlace place = m_outer->place_around(middle_of(x), middle_of(y), piece);
        const Cover cover = m_outer->cover(x, y, piece, place, /*across_seam=*/true);
        if (cover == Cover::outside) return 0;
        if (cover != Cover::inside) return HUGE_VAL;
        points = m_outer->read(Point<Interval>{x, y}, place);
    }
    const int period = m_outer->source_period();
    const Point<double> shift = shift_about(middle_of(points.x));
    // Shifted, a point is rounded once more.
    const bool is_shifted = shift.x != 0 || shift.y != 0;
    const double off_there = is_shifted
                                 ? error + 0x1p-53 * (magnitude(points.x) + magnitude(points.y) +
                                                      std::fabs(shift.x) + std::fabs(shift.y) + 2 * error)
                                 : error;
    points = in_middle(Point<Interval>{widened(points.x, off_there), widened(points.y, off_there)}, shift);
    if (period == 0) return error_from(points, off_there, in_long_double);
    if (m_middle.has_poles) points.y = part_of(points.y, 0, m_inner->target_size().height);
    if (points.x.lo >= 0 && points.x.hi <= period) return error_from(points, off_there, in_long_double);
    // Across the seam the computed point may lie at one end and the true one at the other: no matter where the inner map
    // goes on there.
    if (m_inner->target_period() != period || !(points.x.hi - points.x.lo < period)) return HUGE_VAL;
    const double turn = points.x.lo < 0 ? period : -period;
    const auto error_of_part = [&](double by) {
        return error_from({part_of(points.x + Interval(by), 0, period), points.y}, off_there, in_long_double);
    };
    return std::max(error_of_part(0), error_of_part(turn));
}

double ChainMap::error_from(const Point<Interval>& box, double off, bool in_long_double) const {
    if (misses(box)) return 0;
    if (const int piece = m_pieces.holding(box.x, box.y); piece >= 0)
        return m_inner->exact_error(box.x, box.y, piece, off, in_long_double);
    if (m_pieces.all().size() > 1) return HUGE_VAL;
    // Points beyond the edges do not count, but for those that being off may bring there.
    const Box& all = m_pieces.frame();
    return m_inner->exact_error(part_of(box.x, all.x0 - off, all.x1 + off),
                                part_of(box.y, all.y0 - off, all.y1 + off), 0, off, in_long_double);
}

int ChainMap::piece_near(double x, double y) const {
    const Box& frame = m_pieces.frame();
    return piece_at(std::clamp<double>(x, frame.x0, frame.x1), std::clamp<double>(y, frame.y0, frame.y1));
}

ChainMap::Way ChainMap::way_of(const Interval& x, const Interval& y, int piece) const {
    Way way{m_outer->place_around(middle_of(x), middle_of(y), piece)};
    way.is_smooth = m_outer->cover(x, y, piece, way.place, /*across_seam=*/true) == Cover::inside;
    if (way.is_smooth)
        way.points = m_outer->read(Point<Interval>{x, y}, way.place);
    else
        way.points = m_outer->points_of(x, y);
    if (way.points) way.points = in_middle(*way.points, shift_about(middle_of(way.points->x)));
    return way;
}

template <class T>
std::optional<Point<Jet1<T>>> ChainMap::middle_of_jets(const Point<Jet1<T>>& p, int piece,
                                                       const Way& way) const {
    Point<Jet1<T>> at;
    if (way.is_smooth) {
        at = m_outer->read(p, way.place);
    } else {
        // At one point the exact one will do.
        if constexpr (!std::is_same_v<T, double>) return {};
        const double x = middle_of(p.x.c[0]), y = middle_of(p.y.c[0]);
        Point<double> exact;
        int outer_piece = 0;
        if (!m_outer->exact(x, y, piece, exact, outer_piece)) return {};
        const Jacobian j = m_outer->jacobian(x, y, piece);
        at = {p.x * j.x_i + p.y * j.x_j, p.x * j.y_i + p.y * j.y_j};
        at.x.c[0] = T(exact.x), at.y.c[0] = T(exact.y);
    }
    return in_middle(at, shift_about(middle_of(at.x.c[0])));
}

bool ChainMap::is_clear_beyond(const Way& way) const {
    if (!way.points || (meets_edge(*way.points) && !m_pieces.have_gaps())) return false;
    const int nearest = piece_near(middle_of(way.points->x), middle_of(way.points->y));
    return nearest >= 0 && m_inner->is_clear(way.points->x, way.points->y, nearest);
}

bool ChainMap::ends_beyond(const Way& way) const {
    if (!way.points) return m_inner->may_end();
    const int nearest = piece_near(middle_of(way.points->x), middle_of(way.points->y));
    return nearest < 0 || m_inner->may_end_in(way.points->x, way.points->y, nearest);
}

bool ChainMap::add_ends_beyond(const Point<Jet1<double>>& p, int piece, const Way& way,
                               std::vector<Jet1<double>>& edges) const {
    const std::optional<Point<Jet1<double>>> at = middle_of_jets(p, piece, way);
    if (!at) return false;
    const int nearest = piece_near(at->x.c[0], at->y.c[0]);
    return nearest >= 0 && m_inner->add_ends(*at, nearest, edges);
}

template <class T>
bool ChainMap::add_edges(const Point<Jet1<T>>& p, int piece, const Way& way,
                         std::vector<Jet1<T>>& edges) const {
    const std::optional<Point<Jet1<T>>> at = middle_of_jets(p, piece, way);
    if (!at || !m_outer->add_edges(p, piece, edges)) return false;
    if (m_pieces.have_gaps()) return true;
    const Box& frame = m_pieces.frame();
    if (m_outer->source_period() == 0) {
        edges.push_back(at->x - double(frame.x0));
        edges.push_back(double(frame.x1) - at->x);
    }
    if (!m_middle.has_poles) {
        edges.push_back(at->y - double(frame.y0));
        edges.push_back(double(frame.y1) - at->y);
    }
    // The inner map's own edges, of its nearest piece.
    const int nearest = piece_near(middle_of(at->x.c[0]), middle_of(at->y.c[0]));
    return nearest >= 0 && m_inner->add_edges(*at, nearest, edges);
}
template bool ChainMap::add_edges(const Point<Jet1<double>>&, int, const Way&,
                                  std::vector<Jet1<double>>&) const;
template bool ChainMap::add_edges(const Point<Jet1<Interval>>&, int, const Way&,
                                  std::vector<Jet1<Interval>>&) const;

}  // namespace anamorph
