// SPDX-License-Identifier: Apache-2.0
// A pull map that is one formula: what plan/formula_plan.h cuts into blocks with a proven bound.
//
// A new map of one picture to another is its formula, templated over the number, in a class derived from PlaneMap.
// A lens that shrinks a picture towards the point (cx, cy) of the target, the more the farther from it:
//
//   class Pincushion : public PlaneMap<Pincushion> {
//     public:
//       Pincushion(Size target, Size source, double cx, double cy, double k) : PlaneMap(target, source), ... {}
//       template <class T>
//       Point<T> source_point(const T& x, const T& y) const {
//           const T u = x - m_cx, v = y - m_cy, scale = (square(u) + square(v)) * m_k + 1.0;
//           return {u * scale + m_cx, v * scale + m_cy};
//       }
//   };
//
// Derivatives, bounds over boxes and the rounding of all that come from reading it with other numbers.
#pragma once

#include <cmath>
#include <concepts>
#include <type_traits>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/geometry/point.h"
#include "anamorph/geometry/size.h"
#include "anamorph/number/hypot.h"
#include "anamorph/number/jet.h"
#include "anamorph/number/near_bound.h"

namespace anamorph {

/// Whether the points of a box have source points on one smooth branch of a map: all of them do, none has a
/// source point, those that have one do and the map is smooth over all of the box, the same where edges tell which ones do (CutMap),
/// or it is not known.
enum class Cover { inside, outside, partial, cut, mixed };

/// The directions in which nothing of a source image lies beyond its edges.
struct SourceEdges {
    bool across = true, down = true;
};

/// Bounds the rounding of points that a formula gave in Real, once they are kept in double.
template <class Real>
double kept_error(const Point<Rounded<Real>>& p) {
    const double unit = std::is_same_v<Real, double> ? 0 : 0x1p-53;
    return hypot(p.x.error + unit * p.x.computed_size(), p.y.error + unit * p.y.computed_size()) *
           rounded_detail::kUp;
}

/// The map from a target image, of one or more pieces, to a source image. Pixels, x right, y down, pixel
/// centres at + 0.5. `Local` is where the formula is read: what it needs to know about a neighbourhood of a
/// point, so that it is smooth there.
template <class Map>
concept FormulaMap = requires(const Map& map, const typename Map::Local& local, double a, DoubleDouble b,
                              const Interval& x, Point<double>& p, Point<DoubleDouble>& q, int piece) {
    { map.target_size() } -> std::same_as<Size>;
    { map.source_size() } -> std::same_as<Size>;
    { map.target_pieces() } -> std::same_as<std::vector<Box>>;
    { map.local_around(a, a, piece) } -> std::same_as<typename Map::Local>;
    /// The source point of a target point; the map takes jets, intervals and Rounded as well.
    { map(a, a, local) } -> std::same_as<Point<double>>;
    /// Whether pixel centres or whole pixels in the box x, y of a piece have source points; `local` is about its middle. Of a
    /// DirectMap a part of a box inside is inside, about its own middle; of others it may be mixed there. May one branch
    /// run over the seam of a source that closes on itself?
    { map.cover(x, x, piece, local, /*across_seam=*/true) } -> std::same_as<Cover>;
    /// The piece of the source that a branch leads to.
    { map.source_piece(local) } -> std::same_as<int>;
    { map.source_edges() } -> std::same_as<SourceEdges>;
    /// The period of x in source pixels, after which the source repeats, or 0.
    { map.period() } -> std::same_as<int>;
    /// Finds the source point of one target point, as the reference for errors; false where there is none.
    { map.exact(a, a, piece, p, piece) } -> std::same_as<bool>;
    { map.exact(b, b, piece, q, piece) } -> std::same_as<bool>;
    /// Bounds the rounding of exact<Real> over a box, its result kept in double. 0 where no point has a
    /// source point; infinite where it is not certain that there is one. A fourth parameter, where there is one, is how far the
    /// coordinates that exact() is given are off in each way; the box holds those and where they belong.
    { map.template exact_error<double>(x, x, piece) } -> std::same_as<double>;
    { map.template exact_error<DoubleDouble>(x, x, piece) } -> std::same_as<double>;
};

/// The map near the middle of a block: the source point there, and a bound of the error of the source points of its
/// pixels.
struct NearReading {
    Point<double> middle;
    double error;         ///< the bound, valid where bases are read in the order in which they were written
    std::uint64_t order;  ///< the sum of that order (number/reading_order.h)
};

/// A map whose plan reads it pixel by pixel near the middles of blocks as well (FormulaPlan's computed blocks), because
/// lanes are compiled for it: panorama/direct_rows.h.
template <class Map>
concept DirectMap = FormulaMap<Map> &&
    requires(const Map& map, const typename Map::Local& local, double a, Bases& bases) {
    /// Does the map have such a bound somewhere? False where it depends on a formula without one.
    { map.may_be_direct() } -> std::same_as<bool>;
    /// The map near (a, a), for pixels up to (a, a) away, read in float or in double. Its bases are appended to `bases`.
    { map.template direct<float>(a, a, a, a, local, bases) } -> std::same_as<NearReading>;
    { map.template direct<double>(a, a, a, a, local, bases) } -> std::same_as<NearReading>;
};

/// A map whose formula goes on beyond edges of pictures that it leads through, where target points have no source point: boxes that such
/// edges cut are Cover::cut.
template <class Map>
concept CutMap = FormulaMap<Map> && requires(const Map& map, const Box& box, int piece) {
    /// The edges over a box that is cut, as something that tells the cover() of its parts, of whole pixels: Cover::cut where an edge
    /// certainly runs, Cover::mixed where it is not known. None where they are not known.
    { map.edges_over(box, piece)->cover(box) } -> std::same_as<Cover>;
};

/// The base class of maps from one flat picture to another. `Formula`, derived from this, gives
///
///   Point<T> source_point(const T& x, const T& y) const     smooth wherever inside() > 0
///   T inside(const T& x, const T& y) const                  > 0 where there is a source point; optional
///
/// for any T of number/number.h. Constants of the formula are taken to be exactly the doubles that they are.
template <class Formula>
class PlaneMap {
  public:
    struct Local {};

    PlaneMap(const Size& target, const Size& source) : m_target(target), m_source(source) {}

    Size target_size() const { return m_target; }
    Size source_size() const { return m_source; }
    std::vector<Box> target_pieces() const { return {{0, 0, m_target.width, m_target.height}}; }
    SourceEdges source_edges() const { return {}; }
    int source_piece(const Local&) const { return 0; }
    int period() const { return 0; }
    Local local_around(double, double, int) const { return {}; }

    template <class T>
    T inside(const T&, const T&) const {
        return T(1);
    }

    /// A number that is positive where there is a source point, and changes sign where those end (MapLink::add_ends).
    template <class T>
    T end(const T& x, const T& y, int) const {
        return formula().inside(x, y);
    }

    template <class T>
    Point<T> operator()(const T& x, const T& y, const Local&) const {
        return formula().source_point(x, y);
    }
    Cover cover(const Interval& x, const Interval& y, int, const Local&, bool) const {
        const Interval in = formula().inside(x, y);
        return in.lo > 0 ? Cover::inside : in.hi <= 0 ? Cover::outside : Cover::mixed;
    }
    template <RealNumber Real>
    bool exact(const Real& x, const Real& y, int, Point<Real>& p, int& source_piece) const {
        source_piece = 0;
        if (!(formula().inside(x, y) > 0)) return false;
        p = formula().source_point(x, y);
        return isfinite(p.x) && isfinite(p.y);
    }
    template <class Real>
    double exact_error(const Interval& x, const Interval& y, int, double off = 0) const {
        using R = Rounded<Real>;
        const R px(x, 0, off), py(y, 0, off), in = formula().inside(px, py);
        if (in.range.hi + in.error <= 0) return 0;
        return lower_end(in) > 0 ? kept_error(formula().source_point(px, py)) : HUGE_VAL;
    }

  private:
    const Formula& formula() const { return static_cast<const Formula&>(*this); }

    Size m_target, m_source;
};

}  // namespace anamorph
