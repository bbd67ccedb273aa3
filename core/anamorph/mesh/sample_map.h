// SPDX-License-Identifier: Apache-2.0
// An ST-map that is as large as its picture as a formula, for chains of maps. Alone it is drawn by StMapPlan, pixel for pixel;
// another map reads it between the pixels too, and turns smooth parts of it into polynomials.
//
// The map is the lattice's (st_lattice.h). Where a window of samples lies near a cubic it is read as that cubic, which is off by
// `error` at most anywhere in the window; elsewhere pixels are exact.
//
// The bound of a window. Interpolation I along an axis with lines 1 apart is by weights whose magnitudes sum to 1 + s (1 - s)
// <= 5/4, s being the place in a cell: those of the inner two samples are not negative, those of the outer ones, -s (1 - s)^2 / 2 and
// -s^2 (1 - s) / 2, not positive, and all sum to 1. It reproduces polynomials of degree 2, and x^3 but for s (1 - s) (1 - 2 s)
// (the slopes at 0 and 1 come out as 1 and 4 in place of 0 and 3), which is at most sqrt(3) / 18 < 0.0963. So with p a
// polynomial of total degree 3 and r what samples are off it, |I[p + r] - p| <= (5/4)^2 max |r| + 0.0963 (|p_30| + |p_03|).
//
// That error is no polynomial's, yet Rounded (number/rounded.h) passes it on. Of a box it knows the range of values at all pixels'
// centres, and each of its operations says by how much its value there may be moved where its operands are moved by up to their errors;
// what it adds for the other coefficients of jets makes that larger. So the map is no farther off at any centre than it says.
#pragma once

#include <concepts>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "anamorph/mesh/st_lattice.h"
#include "anamorph/number/rounded.h"
#include "anamorph/plan/costs.h"
#include "anamorph/plan/formula_map.h"

namespace anamorph {

class SampleMap {
  public:
    static constexpr PlanCosts kCosts{.bound = 20, .further_bound = 4, .polynomial = 4, .rounding = 6};

    /// `tol`: the tolerance that blocks are to hold, source pixels. Windows are as large as serves most of the map.
    SampleMap(std::shared_ptr<const StLattice> lattice, double tol);

    // The members that make this a FormulaMap (plan/formula_map.h).

    /// A cubic near the map, with coefficients as in Jet, in units of a window about its middle, and where it serves.
    struct Local {
        Interval x, y;  ///< where it is off by `error` at most; empty where that is nowhere
        Point<double> middle{0, 0};
        double unit = 1;  ///< windows per pixel, half of one
        double cx[10] = {}, cy[10] = {};
        double error = 0;

        bool serves() const { return x.lo <= x.hi; }
    };
    Size target_size() const { return m_lattice->target(); }
    Size source_size() const { return m_lattice->source(); }
    std::vector<Box> target_pieces() const {
        return {{0, 0, m_lattice->target().width, m_lattice->target().height}};
    }
    SourceEdges source_edges() const { return {}; }
    int source_piece(const Local&) const { return 0; }
    int period() const { return 0; }
    /// The cubic of the window whose middle is nearest; where that does not serve, the map's linear part.
    Local local_around(double x, double y, int piece) const;
    Cover cover(const Interval& x, const Interval& y, int piece, const Local& local, bool across_seam) const;

    template <class T>
    Point<T> operator()(const T& x, const T& y, const Local& local) const {
        return cubic(x, y, local);
    }
    Point<Interval> operator()(const Interval& x, const Interval& y, const Local& local) const;
    Point<Rounded<double>> operator()(const Rounded<double>& x, const Rounded<double>& y,
                                      const Local& local) const;

    template <std::floating_point Real>
    bool exact(const Real& x, const Real& y, int, Point<Real>& p, int& source_piece) const {
        source_piece = 0;
        const Point<double> at = m_lattice->at(static_cast<double>(x), static_cast<double>(y));
        p = {Real(at.x), Real(at.y)};
        return is_near(at);
    }
    /// The points are doubles whatever Real is.
    template <class Real>
    double exact_error(const Interval& x, const Interval& y, int, double off = 0) const {
        return exact_error(x, y, off);
    }

    /// MapLink::points_of().
    std::optional<Point<Interval>> points_of(const Interval& x, const Interval& y) const;

    /// Does a cubic serve in at least half of some windows all over the map?
    bool is_smooth() const { return m_is_smooth; }

  private:
    /// Samples of a window either way, and from one to the next: no box of `step` pixels lies in none.
    struct Layout {
        int window, step;
    };
    static constexpr Layout kLayouts[] = {{68, 32}, {36, 16}};  ///< windows are multiples of four

    template <class T>
    static Point<T> cubic(const T& x, const T& y, const Local& local) {
        const T s = (x - local.middle.x) * local.unit, t = (y - local.middle.y) * local.unit, s2 = square(s),
                t2 = square(t);
        const auto sum = [&](const double* c) {
            return s * c[1] + t * c[2] + s2 * c[3] + s * t * c[4] + t2 * c[5] + s2 * (s * c[6] + t * c[7]) +
                   t2 * (s * c[8] + t * c[9]) + c[0];
        };
        return {sum(local.cx), sum(local.cy)};
    }
    static bool is_near(const Point<double>& p);
    double exact_error(const Interval& x, const Interval& y, double off) const;

    /// A window of the lattice, made when it is first asked for.
    struct Window {
        std::once_flag once;
        Local local;
    };
    /// All windows: their numbers across and down.
    struct Windows {
        Layout layout;
        int columns, rows;
        std::vector<Window> all;
    };
    std::shared_ptr<Windows> windows_of(const Layout& layout) const;
    bool most_serve() const;
    Local fitted(int first_column, int first_row) const;
    /// The window of a number across and down.
    const Local& window(int column, int row) const;
    /// The ranges of the displacements from the identity of all samples that count anywhere in a box; none where one is a hole.
    std::optional<Point<Interval>> displacements(const Interval& x, const Interval& y) const;

    std::shared_ptr<const StLattice> m_lattice;
    double m_tol;
    std::shared_ptr<Windows> m_windows;  ///< null where the ST-map is smaller than one
    bool m_is_smooth = false;
};

}  // namespace anamorph
