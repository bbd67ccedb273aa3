// SPDX-License-Identifier: Apache-2.0
// The source of a formula that pushes, cut into sheets on which it is one to one (plan/sheets.h): they give the source points of single
// target points.
#pragma once

#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/formula/pushed_formula.h"
#include "anamorph/geometry/box.h"
#include "anamorph/plan/sheets.h"

namespace anamorph {

/// The sheets of a PushedFormula, in its pixels.
class PushedSheets {
  public:
    /// A function that says what errors call a source point.
    using NamePlace = std::string (*)(const Point<double>& source);
    /// `target`: the target pixels whose source points are wanted. Throws Error where the formula folds, jumps or ends at so
    /// many places that the source would be cut into more than `most_parts`. No more are looked at for one point.
    PushedSheets(PushedFormula formula, const Box& target, const Size& source, std::size_t most_parts,
                 NamePlace name_place = pixel_name);
    /// Names a source point by its pixel: "source pixel 12,40".
    static std::string pixel_name(const Point<double>& source);

    const PushedFormula& formula() const { return m_formula; }
    const Size& source_size() const { return m_source; }

    /// Finds all source points of a target point, and the best of them: those where the map is not turned
    /// over first, of these the lowest, of these the rightmost.
    Preimages preimages(double x, double y) const;
    /// Finds the best source point of a target point. False where there is none.
    template <RealNumber Real>
    bool exact(const Real& x, const Real& y, Point<Real>& p) const;

    /// Bounds the error of source points in double over a box; none where a fold is near.
    std::optional<double> error(const Interval& x, const Interval& y) const;
    /// Bounds the error of exact() in Real, kept in double, over a box; near folds by looking at all pixels
    /// of the box.
    template <class Real>
    double exact_error(const Interval& x, const Interval& y) const;

    /// The box of a frame's parameters that holds all source points of a box of the target; and how large sheets around are, in source
    /// pixels.
    struct Reached {
        Point<Interval> z{{HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, -HUGE_VAL}};
        Point<double> largest_sheet{0, 0};
        Point<double> halves{0, 0};  ///< half the sizes of the boxes of all sheets together

        bool is_empty() const { return !(z.x.lo <= z.x.hi); }
        /// Do boxes of sheets lie apart, as those of several source points of one target point? A hint: one box holds them all.
        bool is_apart() const {
            return z.x.hi - z.x.lo > 2.1 * halves.x + 1 || z.y.hi - z.y.lo > 2.1 * halves.y + 1;
        }
    };
    /// The parameters of all source points of a box of the target; nothing where a fold is near.
    std::optional<Reached> reached(const Interval& x, const Interval& y, const PlaneFrame& frame) const;

  private:
    friend class PreimageSearch<PushedSheets>;
    class Cell;

    int most_visits() const { return m_most_visits; }
    Cell cell(int number) const;
    bool find(const Sheet& sheet, double x, double y, Preimage& found) const;
    bool before(const Preimage& a, const Preimage& b) const;
    Point<double> on_sheet(const Sheet& sheet, const Point<double>& z) const;
    Point<double> about_sheet(const Sheet& sheet, const Point<double>& z) const;
    double precise_error(const Interval& x, const Interval& y) const;

    PushedFormula m_formula;
    Size m_source;
    int m_most_visits;
    std::vector<Sheet> m_sheets;
    BoundsTree m_tree;
    bool m_mirrors = false;  ///< is more of the target covered by what is turned over than by what is not?
};

}  // namespace anamorph
