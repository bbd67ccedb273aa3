// SPDX-License-Identifier: Apache-2.0
// A formula that leads from the source to the target, and its series over boxes of the source.
#pragma once

#include "anamorph/formula/formula_text.h"
#include "anamorph/formula/pixel_scale.h"
#include "anamorph/geometry/matrix2.h"
#include "anamorph/geometry/point.h"
#include "anamorph/number/jets.h"

namespace anamorph {

/// A frame of the plane: source points are origin + to_source z of parameters z, and target points are read
/// as from_target f.
struct PlaneFrame {
    Point<double> origin{0, 0};
    Matrix2 to_source{1, 0, 0, 1};
    Matrix2 from_target{1, 0, 0, 1};

    Point<double> source(const Point<double>& z) const { return origin + to_source(z); }
    Point<Interval> source(const Point<Interval>& z) const;
    /// The largest rounding of the parameters of a point that are no larger than these.
    double rounding(const Point<double>& z) const;
};

/// A formula that pushes. Pixels, x right, y down, pixel centres at + 0.5.
class PushedFormula {
  public:
    /// `formula`: target pixels of a picture of size `picture`, at source pixels. `target`: the pixels that the picture has.
    PushedFormula(PlaneFormula formula, const Size& picture, const Size& target);

    /// The target point of a source point.
    template <class T>
    Point<T> target_point(const T& x, const T& y) const {
        const auto [to_x, to_y] = read_program<2>(m_formula.point, x, y);
        return m_scale(to_x, to_y);
    }
    /// The derivative of the map at a source point.
    Matrix2 derivative(const Point<double>& source) const;
    /// Has the formula values all over a box of the source?
    Certainty is_defined(const Interval& x, const Interval& y) const;

    /// Coefficients by powers of a frame's parameters: those of the series about the middle of a box of them, and what encloses
    /// those about all of its points.
    using BoundJet = Jet<Interval, simd::BoundJets::kDegree>;
    struct Series {
        Point<BoundJet> about, over;
    };
    /// Finds the series of two boxes, each in a frame.
    void expand(const Point<Interval>* boxes, const PlaneFrame* frames, Series* found) const;
    Series series(const Point<Interval>& box, const PlaneFrame& frame) const;
    /// Finds the series of a box for a purpose that `serves` tests: the enclosure is narrowed by evaluating quarters where it
    /// would serve if the formula were its series about the middle.
    template <class Serves>
    Series series(const Point<Interval>& box, const PlaneFrame& frame, const Serves& serves) const {
        Series found = series(box, frame);
        narrow(box, frame, serves, found);
        return found;
    }
    template <class Serves>
    void narrow(const Point<Interval>& box, const PlaneFrame& frame, const Serves& serves,
                Series& found) const {
        if (!serves(found) && serves(hoped(found, box))) found.over = over_quarters(box, frame);
    }

  private:
    /// The series with the enclosure that it would have if the formula were its series about the middle.
    static Series hoped(const Series& series, const Point<Interval>& box);
    Point<BoundJet> over_quarters(const Point<Interval>& box, const PlaneFrame& frame) const;

    PlaneFormula m_formula;
    PixelScale m_scale;
};

namespace pushed_detail {

inline double half_of(const Interval& a) {
    return 0.5 * (a.hi - a.lo);
}
inline double middle_of(const Interval& a) {
    return 0.5 * (a.lo + a.hi);
}
/// The interval of the members that both intervals have.
inline Interval common(const Interval& a, const Interval& b) {
    return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
}
inline bool holds(const Interval& a, const Interval& b) {
    return a.lo <= b.lo && b.hi <= a.hi;
}
inline bool holds(const Point<Interval>& a, const Point<Interval>& b) {
    return holds(a.x, b.x) && holds(a.y, b.y);
}
inline Interval about(double middle, double half) {
    return Interval(middle) + Interval(-half, half);
}

}  // namespace pushed_detail

}  // namespace anamorph
