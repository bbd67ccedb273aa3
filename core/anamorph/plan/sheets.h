// SPDX-License-Identifier: Apache-2.0
// The inverse of a map that pushes: the source points of a target point, certified.
//
// Every cell of the source is cut into parts until each is certainly one to one, a sheet: in parameters z in [-1, 1]^2 of the
// part, with f the map and Y the inverse of about its derivative at the middle, Y (f(z) - f(0)) = z + N(z), where N has a Lipschitz
// constant of at most kContraction in the larger coordinate. Then
//   - a point p has at most one preimage in the part: the fixed point of z -> w - N(z), w = Y (p - f(0)), to
//     which this iteration (the chord form of Newton's, with Krawczyk's bound) converges;
//   - it has none where |w| > 1 + max |N|.
// Where no such part can be had (the derivative is singular: a fold), cutting ends at parts that are smaller than a given size in
// target pixels. Pixels on such parts are computed one by one, and the parts cut on for each of them as far as it takes to tell
// its source points apart: down to kUndecided source pixels, to what rounding hides, or so many parts as a map allows. What then
// is left (a pixel within rounding of a fold's edge, or what is squeezed to a line) counts as a source point and as a fold, with a
// bound that spans all that it may be.
//
// The map in double errs by e, so that the iteration ends within |Y| e / (1 - kContraction) of the exact source point, in z; parts
// overlap by more than that, and points found on the edges of two parts are compared.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "anamorph/geometry/bounds_tree.h"
#include "anamorph/geometry/matrix2.h"
#include "anamorph/geometry/point.h"
#include "anamorph/number/hypot.h"

namespace anamorph {

/// The interval [middle - half, middle + half] of a parameter.
struct Part {
    double middle, half;
};

/// A part of a cell that is one to one, or a fold.
struct Sheet {
    static constexpr double kContraction = 1.0 / 4;
    /// The least and the most that parameters run beyond a part: its hair.
    static constexpr double kHair = 1e-9, kMostHair = 1.0 / 16;

    int cell;  ///< number of the cell
    bool fold;
    double s, t, hs, ht;    ///< the middle and half the size of the part, parameters of the cell, from 0 to 1
    Point<double> at;       ///< f(0), target pixels
    Matrix2 to_parameters;  ///< Y, parameters per target pixel
    double reach;           ///< a bound of N, with room for the hair
    double hair;            ///< how far z runs beyond 1, so that no point on an edge is lost
    double noise;           ///< what rounding makes of z
    double error;           ///< error of a source point found here, source pixels
    double edge;            ///< source points on two parts' edges that are no farther apart may be the same

    /// A part that is left as a fold.
    static Sheet of_fold(int cell, const Part& s, const Part& t, const Point<double>& at) {
        return {cell, true, s.middle, t.middle, s.half, t.half, at, {0, 0, 0, 0}, 0, 0, 0, 0, 0};
    }
    /// Does it come near a target point? For a sheet that is no fold.
    bool reaches(double x, double y) const { return largest(to_parameters(x - at.x, y - at.y)) <= 1 + reach; }
    /// The source pixels per target pixel, about, in a cell of that size.
    Matrix2 to_source(double width, double height) const {
        const Matrix2& y = to_parameters;
        const double w = hs * width, h = ht * height;
        return {w * y.a11, w * y.a12, h * y.a21, h * y.a22};
    }
    /// Finds the parameters of (x, y) on a sheet that is no fold, where f(z) is the target point of
    /// parameters z. False where there are none.
    template <class Map>
    bool find(double x, double y, const Map& f, Point<double>& z) const;
    /// The box of parameters of all points up to (hx, hy) from (x, y); none if there are no such.
    template <class Map>
    std::optional<std::pair<Part, Part>> narrowed(double x, double y, double hx, double hy, const Map& f,
                                                  int steps = 3) const;
};

/// The facts that a look at a part finds.
struct SeenPart {
    Bounds bounds;  ///< target pixels; the bounds of nothing meet nothing
    double size;    ///< half the part's size in target pixels
    std::optional<Sheet> sheet;
    bool cut_s;             ///< which way to cut the part if there is no sheet
    bool is_torn = false;   ///< is the part small, and does the map jump there?
    bool is_point = false;  ///< is all that it leads to within rounding, so that cuts tell no more?
};

/// Calls body(half of s, t) or body(s, half of t) for both halves.
template <class Body>
void each_half(const Part& s, const Part& t, bool cut_s, const Body& body) {
    for (const double side : {-0.5, 0.5}) {
        const Part half_s{s.middle + side * s.half, 0.5 * s.half},
            half_t{t.middle + side * t.half, 0.5 * t.half};
        cut_s ? body(half_s, t) : body(s, half_t);
    }
}

/// Cuts cells into sheets; parts that do not meet the target are left out. A cell gives
///   SeenPart see(const Part& s, const Part& t, const Bounds& target) const
///   Sheet fold(const Part& s, const Part& t) const
/// where less is asked of a part that does not meet the target.
class SheetCutter {
  public:
    static constexpr std::size_t kFirst = std::size_t{1} << 15;
    struct Limits {
        double fold_size;   ///< the size in target pixels at which a part is cut no further
        int cuts;           ///< the number of cuts after which a part is cut no further
        std::size_t parts;  ///< the most parts that are looked at
        int torn = 0;       ///< the most torn parts that are looked at
        /// The most parts that all of the cell may be foreseen to take, by what kFirst or more parts have
        /// done of it.
        double foreseen = HUGE_VAL;
    };
    SheetCutter(const Bounds& target, const Limits& limits) : m_target(target), m_limits(limits) {}

    /// Cuts a cell. False where there are too many parts, or too many that are torn.
    template <class Cell>
    bool cut(const Cell& cell) {
        return cut(cell, {0.5, 0.5}, {0.5, 0.5}, 0);
    }
    std::vector<Sheet> sheets;
    std::vector<Bounds> bounds;
    int torn = 0;
    Point<double> stopped_at{};  ///< parameters of the cell where there were too many

  private:
    template <class Cell>
    bool cut(const Cell& cell, const Part& s, const Part& t, int depth) {
        const SeenPart seen = cell.see(s, t, m_target);
        const double share = 4 * s.half * t.half;
        if (!seen.bounds.meets(m_target)) {
            m_done += share;
            return true;
        }
        torn += seen.is_torn;
        const bool is_hopeless =
            m_parts > kFirst && static_cast<double>(m_parts) > m_limits.foreseen * m_done;
        if (++m_parts > m_limits.parts || torn > m_limits.torn || is_hopeless) {
            stopped_at = {s.middle, t.middle};
            return false;
        }
        if (seen.sheet || seen.size <= 0.5 * m_limits.fold_size || depth == m_limits.cuts) {
            sheets.push_back(seen.sheet ? *seen.sheet : cell.fold(s, t));
            bounds.push_back(seen.bounds);
            m_done += share;
            return true;
        }
        bool all = true;
        each_half(s, t, seen.cut_s,
                  [&](const Part& a, const Part& b) { all = all && cut(cell, a, b, depth + 1); });
        return all;
    }

    Bounds m_target;
    Limits m_limits;
    std::size_t m_parts = 0;
    double m_done = 0;  ///< the part of the cell's area that is done
};

/// One source point of a target point.
struct Preimage {
    Point<double> at;
    int cell;      ///< number of the cell
    bool turned;   ///< is the map turned over there?
    double error;  ///< error of the point
    double edge;   ///< above 0 on the edge of its part: the distance at which others may be the same point
    /// About the inverse of the derivative, source pixels per target pixel; 0 where it is not known.
    Matrix2 inverse{0, 0, 0, 0};
};
struct Preimages {
    Preimage best;
    int count = 0;
    bool on_fold = false;  ///< could some not be told apart?
    double error = 0;      ///< bound of the distance from the best to the exact one
};

/// Collects the source points of one target point. An inverse gives
///   int most_visits() const                          parts that are looked at, at most
///   Cell cell(int number) const                      as SheetCutter wants it, with
///     Point<double> source(double s, double t) const  the source point of parameters
///     double width() const, height() const            source pixels
///   bool find(const Sheet& sheet, double x, double y, Preimage& found) const   of one that is no fold
///   bool before(const Preimage& a, const Preimage& b) const                    which of two is preferred
template <class Inverse>
class PreimageSearch {
  public:
    static constexpr double kUndecided = 0x1p-20;

    PreimageSearch(const Inverse& inverse, double x, double y) : m_inverse(inverse), m_x(x), m_y(y) {}

    void look(const Sheet& sheet) {
        if (sheet.fold) return look(m_inverse.cell(sheet.cell), {sheet.s, sheet.hs}, {sheet.t, sheet.ht});
        find(sheet);
    }

    Preimages result() {
        for (int k = 0; k < m_edges; ++k) compare(m_on_edge[k]);
        // What cannot be told apart may be any of them.
        m_all.error =
            m_all.on_fold ? hypot(m_places.x1 - m_places.x0, m_places.y1 - m_places.y0) : m_all.best.error;
        return m_all;
    }

  private:
    void find(const Sheet& sheet) {
        Preimage found{};
        if (sheet.reaches(m_x, m_y) && m_inverse.find(sheet, m_x, m_y, found)) take(found);
    }

    /// Cuts a fold on, as far as it takes.
    template <class Cell>
    void look(const Cell& cell, const Part& s, const Part& t) {
        const Bounds target{m_x, m_y, m_x, m_y};
        const SeenPart seen = cell.see(s, t, target);
        if (!seen.bounds.meets(target)) return;
        ++m_visits;
        if (seen.sheet) return find(*seen.sheet);
        const double size = std::max(s.half * cell.width(), t.half * cell.height());
        if (size <= kUndecided || seen.is_point || m_visits >= m_inverse.most_visits())
            return give_up(cell, s, t);
        each_half(s, t, seen.cut_s, [&](const Part& a, const Part& b) { look(cell, a, b); });
    }

    /// Takes a part that may hold a source point or none.
    template <class Cell>
    void give_up(const Cell& cell, const Part& s, const Part& t) {
        m_all.on_fold = true;
        const double size = 2 * hypot(s.half * cell.width(), t.half * cell.height());
        take({cell.source(s.middle, t.middle), cell.fold(s, t).cell, false, size, 2 * size});
    }

    void take(const Preimage& found) {
        const double e = found.error;
        const Bounds place{found.at.x - e, found.at.y - e, found.at.x + e, found.at.y + e};
        m_all.count == 0 && m_edges == 0 ? m_places = place : (m_places.add(place), m_places);
        if (found.edge == 0) return compare(found);
        for (int k = 0; k < m_edges; ++k) {
            Preimage& other = m_on_edge[k];
            if (largest(other.at - found.at) > other.edge + found.edge) continue;
            // The same, from two parts that share an edge.
            if (m_inverse.before(found, other)) other = found;
            return;
        }
        // No room to compare: counted, and maybe again.
        if (m_edges == kMostEdges) m_all.on_fold = true;
        m_edges < kMostEdges ? void(m_on_edge[m_edges++] = found) : compare(found);
    }
    void compare(const Preimage& found) {
        if (m_all.count++ == 0 || m_inverse.before(found, m_all.best)) m_all.best = found;
    }

    static constexpr int kMostEdges = 64;

    const Inverse& m_inverse;
    double m_x, m_y;
    Preimages m_all{};
    Bounds m_places{};
    Preimage m_on_edge[kMostEdges];
    int m_edges = 0, m_visits = 0;
};

template <class Map>
bool Sheet::find(double x, double y, const Map& f, Point<double>& z) const {
    // Beyond the part by more than what is accepted, so that no end is taken for a solution.
    const double end = 1 + 2 * hair;
    const auto clamped = [&](const Point<double>& p) {
        return Point<double>{std::clamp(p.x, -end, end), std::clamp(p.y, -end, end)};
    };
    z = clamped(to_parameters(x - at.x, y - at.y));
    double moved = HUGE_VAL;
    // Each step gains two bits, or at least one beyond the part's edges.
    for (int n = 0; n < 64 && !(moved <= noise); ++n) {
        const Point<double> p = f(z), step = to_parameters(p.x - x, p.y - y);
        // A solution is no farther from where the step leads than its length times rho / (1 - rho), and rounding
        // is less than the hair.
        if (largest(z - step) > end + kContraction / (1 - kContraction) * largest(step) + hair) return false;
        const Point<double> next = clamped(z - step);
        moved = largest(next - z);
        z = next;
    }
    return moved <= noise && largest(z) <= 1 + hair;
}

/// Narrows the box by Krawczyk's operator for all of the points at once: z = w - N(z), and in a box about c
/// N(z) = N(c) +- contraction * its half size.
template <class Map>
std::optional<std::pair<Part, Part>> Sheet::narrowed(double x, double y, double hx, double hy, const Map& f,
                                                     int steps) const {
    const Point<double> w = to_parameters(x - at.x, y - at.y), span = to_parameters.span(hx, hy);
    const auto cut = [&](double middle, double half_size) {
        const double low = std::max(middle - half_size, -1 - hair),
                     high = std::min(middle + half_size, 1 + hair);
        return Part{0.5 * (low + high), 0.5 * (high - low)};
    };
    std::pair<Part, Part> near{cut(w.x, span.x + reach), cut(w.y, span.y + reach)};
    const auto is_empty = [&] { return near.first.half < 0 || near.second.half < 0; };
    if (is_empty()) return std::nullopt;
    for (int n = 0; n < steps; ++n) {
        const double half_size = std::max(near.first.half, near.second.half);
        if (half_size < 1.5 * std::max(span.x, span.y)) break;
        const Point<double> c{near.first.middle, near.second.middle}, p = f(c);
        const Point<double> off = to_parameters(p.x - x, p.y - y);
        const double slack = kContraction * half_size + hair;
        near = {cut(c.x - off.x, span.x + slack), cut(c.y - off.y, span.y + slack)};
        if (is_empty()) return std::nullopt;
    }
    return near;
}

}  // namespace anamorph
