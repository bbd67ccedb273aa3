// SPDX-License-Identifier: Apache-2.0
// A flat map whose formula is text and leads from the source to the target: its inverse, which is read with any number.
//
// The source is cut into sheets on which the formula is one to one (plan/sheets.h); they give the source points of single points. About
// a box of the target, where it has one root only, the inverse is a function, of which numbers need no more than the formula itself:
//
// - Interval: in parameters z of a frame, m + Y z with Y about the inverse of f's derivative, g(z) = f(m + Y z) has a derivative near I,
//   and Krawczyk's operator is K(Z) = z_0 + T - g(z_0) - (g'(Z) - I) (Z - z_0) for all points of a box T at once. Where it leads a box
//   Z into itself, g has a root there for each of them, and that in K(Z). Where |g' - I| < 1 all over a convex set there is no other.
//
// - Jets: with g(z_0 + z) = g(z_0) + J z + N(z), N of degree 2 and more, the inverse's series is z = J^-1 (v - N(z)), solved degree
//   by degree. J^-1 of intervals is that of Y J, which is near I.
//
// - Rounded: jets as doubles compute them solve J z + N(z) = v with the computed J and N, up to rounding. In norms (number/rounded.h),
//   with what that leaves and what rounding makes of f called `rest`, they are off by rest / (1 - c) at most, where c is a Lipschitz
//   constant of z - g(z) over a ball that holds both.
#pragma once

#include <optional>

#include "anamorph/formula/inverse_series.h"
#include "anamorph/formula/pushed_sheets.h"
#include "anamorph/plan/costs.h"
#include "anamorph/plan/formula_map.h"

namespace anamorph {

/// The inverse of a formula that pushes. Pixels, x right, y down, pixel centres at + 0.5.
class PushedMap {
  public:
    /// Source points cost most: a chord is the formula once, and takes some twelve of them.
    static constexpr PlanCosts kCosts{.bound = 60,
                                      .further_bound = 4,
                                      .credit = 0.25,
                                      .bound_pixels = 96,
                                      .polynomial = 3,
                                      .rounding = 8,
                                      .double_pixel = 0.02};
    static constexpr std::size_t kMostParts = std::size_t{1} << 19;

    /// A box of the target, and a box of a frame's parameters where the formula has one root for each of its
    /// points.
    struct Roots {
        Interval x, y;
        Point<Interval> z;
        Linear<Interval> bend;  ///< g' - I over the box
    };
    /// What is known about a root: the inverse of the formula's derivative there, and what was found last of
    /// a box that holds it.
    struct Local {
        Point<double> target{};
        PlaneFrame frame{};
        bool is_known = false;
        mutable std::optional<Roots> roots = {};
    };

    /// `formula`: target pixels of a picture of size `picture`, at source pixels. `target`: the pixels that the picture has,
    /// and `overscan` those beyond its edges. Throws Error as PushedSheets does.
    PushedMap(PlaneFormula formula, const Size& picture, const Size& target, const Size& source,
              std::size_t most_parts = kMostParts, PushedSheets::NamePlace place = PushedSheets::pixel_name,
              const Size& overscan = {});

    Size target_size() const { return m_target; }
    Size source_size() const { return m_sheets.source_size(); }
    std::vector<Box> target_pieces() const { return {{0, 0, m_target.width, m_target.height}}; }
    /// The edges of the source, where it ends.
    SourceEdges source_edges() const { return {}; }
    int source_piece(const Local&) const { return 0; }
    int period() const { return 0; }
    /// Roots are known about pixels (plan/map_link.h).
    static bool reads_computed_points() { return false; }
    Local local_around(double x, double y, int piece) const;

    Point<double> operator()(double x, double y, const Local& local) const;
    Point<Interval> operator()(const Interval& x, const Interval& y, const Local& local) const;
    template <int N>
    Point<Jet<double, N>> operator()(const Jet<double, N>& x, const Jet<double, N>& y,
                                     const Local& local) const;
    template <int N>
    Point<Jet<Interval, N>> operator()(const Jet<Interval, N>& x, const Jet<Interval, N>& y,
                                       const Local& local) const;
    Point<simd::TaylorJets> operator()(const simd::TaylorJets& x, const simd::TaylorJets& y,
                                       const Local& local) const;
    Point<simd::BoundJets> operator()(const simd::BoundJets& x, const simd::BoundJets& y,
                                      const Local& local) const;
    Point<Rounded<double>> operator()(const Rounded<double>& x, const Rounded<double>& y,
                                      const Local& local) const;

    Cover cover(const Interval& x, const Interval& y, int piece, const Local& local, bool across_seam) const;
    template <RealNumber Real>
    bool exact(const Real& x, const Real& y, int, Point<Real>& p, int& source_piece) const {
        source_piece = 0;
        return m_sheets.exact(x, y, p);
    }
    template <class Real>
    double exact_error(const Interval& x, const Interval& y, int) const {
        return m_sheets.exact_error<Real>(x, y);
    }

    const PushedFormula& formula() const { return m_sheets.formula(); }
    Preimages preimages(double x, double y) const { return m_sheets.preimages(x, y); }
    /// A box of the source that holds all source points of a box of the target; nothing near a fold.
    std::optional<PushedSheets::Reached> source_points(const Interval& x, const Interval& y) const {
        return m_sheets.reached(x, y, {});
    }
    /// The number of pixels of a box that have no source point.
    std::int64_t undefined_pixels(const Box& box) const;

  private:
    /// Finds the parameters of all source points of a box. False where they are not known to be the roots of
    /// one function.
    bool find_roots(const Interval& x, const Interval& y, const Local& local, Point<Interval>& z) const;
    std::optional<Roots> roots(const Interval& x, const Interval& y, const Local& local) const;
    Linear<Interval> bend_over(const Point<Interval>& z, const PlaneFrame& frame, double most) const;
    Point<Interval> krawczyk(const Interval& x, const Interval& y, const PlaneFrame& frame,
                             const Linear<Interval>& bend, const Point<Interval>& z) const;
    template <class J>
    Point<J> read_taylor(const Point<J>& v, const Local& local) const;

    Size m_target;
    PushedSheets m_sheets;
};

}  // namespace anamorph
