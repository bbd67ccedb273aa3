// SPDX-License-Identifier: Apache-2.0
// The distortion of a lens: a map between a picture as a lens without distortion would give it (the ideal one, a point
// of the plane of its projection) and as it was taken (the observed one). One of the two directions is a formula, the
// other the root of it, found by Newton's iteration and certified.
//
// Models, with u a point about the lens's centre, r = |u|, and v what becomes of it:
//
//   ptlens   ideal to observed, v = u (a r^3 + b r^2 + c r + 1 - a - b - c); PanoTools and Hugin. Unit: half of the
//            picture's smaller side. With an axis, or cylinders. What is observed is (x + g y / height, y + t x / width) of
//            the picture's v about its middle, PanoTools' shear.
//   brown    ideal to observed, v = u (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
//            + (2 p1 x y + p2 (r^2 + 2 x^2), p1 (r^2 + 2 y^2) + 2 p2 x y) + (s1 r^2 + s2 r^4, s3 r^2 + s4 r^4);
//            Brown 1966 with a thin prism (Weng, Cohen and Herniou 1992), OpenCV. Unit: the focal length. For rectilinear
//            pictures.
//   3de4     observed to ideal, v = u (1 + k1 r^2 + k2 r^4); 3DEqualizer4's radial model of degree 4 without
//            decentering. Unit: half of the picture's diagonal. For projections with an axis.
//   kb4      ideal to observed, r = t the angle from the axis, v = u (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8); Kannala
//            and Brandt 2006, OpenCV's fisheye. Unit: the focal length. For equidistant fisheyes.
//   division observed to ideal, v = u / (1 + k1 r^2 + k2 r^4); Fitzgibbon 2001 with k1 alone. Unit: half of the picture's
//            diagonal. For projections with an axis.
//   poly     ideal to observed, v = u (1 + k0 + k1 r + k2 r^2 + k3 r^3 + k4 r^4), which magnifies by 1 + k0 at the centre: what
//            the models of Lensfun are. Unit: half of the picture's smaller side. For projections with an axis.
//   ocam     observed to ideal, where r pixels are seen at the angle atan2(r, g), g = |a0 + a2 r^2 + a3 r^3 + a4 r^4| with the
//            sign that it has where a0 is positive: v = u 2 / (g + sqrt(g^2 + r^2)); Scaramuzza, Martinelli and Siegwart 2006,
//            OCamCalib. For stereographic pictures; whatever their field of view, a0 is the focal length. What is observed is
//            not u = (x, y) but (x + affine_e y, affine_d x + affine_c y), OCamCalib's affine part, whose x is our y.
//
// The lens's centre stands d pixels right of the picture's middle and e below it; the axis of sight meets the plane
// there. The focal length is that of the field of view without distortion.
//
// A lens ends where its radius no longer rises (it folds), and what lies beyond has no counterpart. It also ends at
// 4 times the distance of the picture's farthest corner, and where that is 16 times as far in the ideal picture.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/chart/projection/facts.h"
#include "anamorph/geometry/point.h"
#include "anamorph/number/jet.h"
#include "anamorph/number/near_bound.h"
#include "anamorph/number/rounded.h"

namespace anamorph {

/// A model of lens distortion and its parameters.
struct LensModel {
    /// The models described at the head of this file.
    enum class Kind { none, ptlens, brown, three_de4, kb4, division, poly, ocam };
    Kind kind = Kind::none;
    /// The values of the model, in the order of names(): no magnitude is above kMostValue.
    std::vector<double> values;
    static constexpr double kMostValue = 1e6;

    /// Parses "none", or MODEL:name=value,name=value as in "ptlens:a=0.01,b=-0.03"; a parameter that is not named is
    /// 0, and affine_c is 1. Throws Error naming `parameter`.
    static LensModel parse(std::string_view text, const std::string& parameter = "lens");
    /// The text that parse() reads as this model.
    std::string text() const;
    /// The names of a model's parameters.
    static const std::vector<std::string>& names(Kind kind);
    /// How much larger the observed picture is than the ideal one, at the centre; of ocam that is Lens::magnification().
    double magnification() const;
};

class LensTable;

/// The coefficients and limits with which the formulas of a lens (chart/lens_formula.h) are evaluated.
struct LensTerms {
    /// Does the formula map ideal points to observed ones, not the other way round?
    bool to_observed = true;
    /// The model's own unit in units of the plane, its reciprocal, and the centre.
    Constant unit, per_unit, shift_x, shift_y;
    /// Is the model's unit another than the plane's?
    bool has_unit = false;
    /// Is the lens's centre another point than the picture's middle?
    bool shifted = false;

    /// Is what is observed sheared about the centre? Then by this matrix, row by row, whose inverse is `unshear`.
    bool sheared = false;
    Constant shear[4], unshear[4];

    /// Is S a polynomial in r, not in r^2?
    bool in_radius = false;
    /// Is there a part that is not radial (tangential_at())? Then `m`, the tangential one, and of a thin prism `a` and `b`.
    bool tangential = false, prism = false;
    double mx = 0, my = 0, ax = 0, ay = 0, bx = 0, by = 0;
    Constant over[5], under[5];
    int over_count = 1, under_count = 1;
    /// Is what is below the line g the component ahead of a direction that is r across, and S over / (g + sqrt(g^2 + r^2))?
    bool of_direction = false;

    /// The largest distances of the ideal and of the observed points from the centre, in the model's unit; of the observed ones
    /// before they are sheared.
    double ideal_end = 0, observed_end = 0;
    /// The largest t (radial_of()) before the lens's end, and a lower bound of radial_at() there.
    double end = 0, value_end = 0;
    /// The first approximation of the root of radial_at(t) = value is value * slope.
    double slope = 1;

    /// The computed root of radial_at(t) = value has a residual of at most kResidual roundings of value * `condition`, and
    /// radial_at() itself an error of at most kOff of them (derived in lens.cpp). For a value next to 0, roundings of
    /// kSmall * value_end count in its place.
    static constexpr double kResidual = 80, kOff = 32, kSmall = 0x1p-24;
    double condition = 1;
    /// settled() takes kFastSteps of Newton's iteration, then up to kSteps that are certain to converge; it ends with a step
    /// of at most kStill roundings of `ideal_end`.
    static constexpr double kStill = 512;
    static constexpr int kSteps = 72, kFastSteps = 3;

    /// The table with which intervals are evaluated (chart/lens_table.h).
    std::shared_ptr<const LensTable> table;
};

namespace lens_formula {
inline bool somewhere(bool condition) {
    return condition;
}
#include "anamorph/chart/lens_formula.h"
}  // namespace lens_formula

/// The coefficients of a Taylor series in the increment of the squared distance from the centre.
using LensCoefficients = lens_formula::Series<Interval, 5>;
/// Encloses the coefficients of S about any member of `squared`.
LensCoefficients stretch_coefficients(const LensTerms& lens, const Interval& squared);
/// Encloses the coefficients of shrink() about any member of `squared`.
LensCoefficients shrink_coefficients(const LensTerms& lens, const Interval& squared);

/// The coefficients of a Taylor series in the increment of a value, and the error of computing them in double.
struct ComputedSeries {
    /// The degree up to which double computes them.
    static constexpr int kDegree = 4;
    /// Intervals that enclose the coefficients up to kDegree, and the next one.
    LensCoefficients exact;
    /// Bounds of the errors of the computed coefficients.
    double error[kDegree + 1] = {};

    /// The series of which nothing is known.
    static ComputedSeries unbounded() {
        ComputedSeries series;
        std::fill(std::begin(series.exact.c), std::end(series.exact.c), Interval::all());
        std::fill(std::begin(series.error), std::end(series.error), HUGE_VAL);
        return series;
    }
};
/// The series of shrink() about any value of an interval, as double computes it.
ComputedSeries computed_shrink(const LensTerms& lens, const Interval& value);

/// The first approximation, in double, of the root of radial_at(t) = value, by the lens's table.
double near_root(const LensTerms& lens, double value);

/// stretch_of() for jets of intervals, by its Taylor coefficients.
template <int N>
Jet<Interval, N> stretch_of(const LensTerms& lens, const Point<Jet<Interval, N>>& u);
/// shrink() for jets of intervals, by its coefficients.
template <int N>
Jet<Interval, N> shrink_of(const LensTerms& lens, const Point<Jet<Interval, N>>& v);

/// shrink() for intervals. lens_formula.h has it for the numbers for which an iteration is enough.
Interval shrink(const LensTerms& lens, const Interval& value);
/// shrink() with its rounding.
template <class Real>
Rounded<Real> shrink(const LensTerms& lens, const Rounded<Real>& value);
/// shrink() of jets.
template <class T, int N>
Jet<T, N> shrink(const LensTerms& lens, const Jet<T, N>& value);

/// shrink() near a known value by its Taylor polynomial there: the coefficients are bases, in falling order.
template <class Real>
NearBound<Real> shrink(const LensTerms& lens, const NearBound<Real>& value);

/// settled() near a known point. For lenses with a tangential part no bound is known: the result is unbounded, and no
/// base is written.
template <class Real>
Point<NearBound<Real>> settled(const LensTerms&, const Point<NearBound<Real>>& v) {
    const auto unbounded = RestBound<Real>::unbounded();
    return {{v.x.base, unbounded}, {v.y.base, unbounded}};
}
/// The root that settled() finds, of all points of a box.
Point<Interval> settled(const LensTerms& lens, const Point<Interval>& v);
template <class Real>
Point<Rounded<Real>> settled(const LensTerms& lens, const Point<Rounded<Real>>& v);
template <class T, int N>
Point<Jet<T, N>> settled(const LensTerms& lens, const Point<Jet<T, N>>& v);
template <int N>
Point<Jet<Interval, N>> settled(const LensTerms& lens, const Point<Jet<Interval, N>>& v);

/// A lens and its distortion in the plane of one picture.
class Lens {
  public:
    /// The part of the plane that a picture covers: half its width and height, and the units of the plane per pixel.
    struct Plane {
        DoubleDouble half_width, half_height, per_x, per_y;
    };
    /// A lens on a chart's plane. Throws Error naming `parameter` where a projection of that kind has no such lens, and where the
    /// lens ends within the largest circle that the picture holds. `projection`: its name.
    Lens(const LensModel& model, Lensed lensed, const std::string& projection, const Plane& plane,
         const std::string& parameter);

    const LensModel& model() const { return m_model; }
    const LensTerms& terms() const { return m_terms; }
    /// How much larger the observed picture is than the ideal one, at the centre.
    double magnification() const;

    /// The ideal point of an observed one; valid where inside() is not negative.
    template <class T>
    Point<T> ideal(const Point<T>& observed) const;
    /// The observed point of an ideal one; valid where sees() is not negative.
    template <class T>
    Point<T> observed(const Point<T>& ideal) const;
    /// A number that is not negative where an observed point has an ideal one.
    template <class T>
    T inside(const Point<T>& observed) const {
        return lens_formula::has_ideal(m_terms, observed);
    }
    /// A number that is not negative where an ideal point has an observed one.
    template <class T>
    T sees(const Point<T>& ideal) const {
        return lens_formula::has_observed(m_terms, ideal);
    }

    /// The largest distance of an observed point from the lens's centre, in units of the plane.
    double reach() const { return m_terms.observed_end * m_terms.unit.value() * m_most_shear; }

  private:
    void set_terms();
    DoubleDouble farthest_corner(const Plane& plane, DoubleDouble d, DoubleDouble e) const;
    struct Affine {
        DoubleDouble c = 1, d = 0, e = 0;
        bool is_exact = true;
    };
    Affine affine_of(const Plane& plane) const;
    void set_centre(const Plane& plane);
    /// Throws Error naming `parameter` where the affine part squeezes a picture too much.
    void set_shear(const Plane& plane, const std::string& parameter);
    /// Returns whether the lens ends because it folds. `corner`: the farthest observed point of the picture.
    bool set_ends(double corner);
    /// The condition number of radial_at() over an interval: the magnitude to which its rounding is relative, over its value.
    double condition_over(const Interval& t) const;

    LensModel m_model;
    LensTerms m_terms;
    /// At least the largest factors by which the shear and its inverse make distances longer.
    double m_most_shear = 1, m_most_unshear = 1;
};

// ---------------------------------------------------------------------------------------------------------

template <class T>
Point<T> Lens::ideal(const Point<T>& observed) const {
    return lens_formula::ideal_point(m_terms, observed);
}
template <class T>
Point<T> Lens::observed(const Point<T>& ideal) const {
    return lens_formula::observed_point(m_terms, ideal);
}

namespace lens_detail {

using lens_formula::reversed;
using lens_formula::shrink_series;

/// Encloses the root t of radial_at(t) = value for every member of `value`.
Interval radial_root(const LensTerms& lens, const Interval& value);
template <class T>
T radial_root(const LensTerms& lens, const T& value) {
    return lens_formula::radial_root(lens, value);
}
/// shrink() in double with a bound of its rounding, by the lens's table; nothing where the table does not have it.
std::optional<Rounded<double>> shrink_by_table(const LensTerms& lens, const Rounded<double>& value);
/// The least slope of radial_at() over an interval.
double least_slope(const LensTerms& lens, const Interval& t);

/// The root of radial_at(t) = value with its rounding, for all members of `value`.
template <class Real>
Rounded<Real> radial_root(const LensTerms& lens, const Rounded<Real>& value) {
    const Interval range = radial_root(lens, value.range);
    // radial_at(computed t) is off from the exact value by this at most; and t as much over the least slope from
    // the one to the other, which lie `far` apart at most if that slope, over all of `far`, says so.
    const double size = std::min(magnitude(value.range) + value.error, lens.value_end);
    const double off = value.error + (LensTerms::kResidual + LensTerms::kOff + 1) * Rounded<Real>::kUnit *
                                         lens.condition * (size + LensTerms::kSmall * lens.value_end);
    const double far = 2 * off / least_slope(lens, range);
    const Interval around{std::max(range.lo - far, 0.0), std::min(range.hi + far, lens.end)};
    const bool known = far >= 0 && far < lens.end && off <= far * least_slope(lens, around);
    return known ? Rounded<Real>(around, 0, far) : Rounded<Real>(Interval(0, lens.end), 0, lens.end);
}

/// The sum of series_k n^k by Horner's rule; n has no constant part.
template <class J, class T, int N>
J compose(const lens_formula::Series<T, N>& series, const J& n) {
    J sum(series.c[N]);
    for (int k = N - 1; k >= 0; --k) sum = sum * n + J(series.c[k]);
    return sum;
}

/// The largest row sum of the matrix `slope`, of whose entries `of` gives the magnitudes.
template <class T, class Of>
double largest_row(const lens_formula::Slope<T>& slope, const Of& of) {
    return std::max(of(slope.xx) + of(slope.xy), of(slope.yy) + of(slope.yx));
}

/// settled() of numbers without jets.
template <class Real>
Point<Rounded<Real>> settled_values(const LensTerms& lens, const Point<Rounded<Real>>& v) {
    using R = Rounded<Real>;
    const Point<Interval> range = settled(lens, Point<Interval>{v.x.range, v.y.range});
    // A step from the computed u, which is taken as it is, leads to within `step` of it; one without rounding halves its
    // distance to the exact one. All of that within twice as much around.
    double off = 0x1p-40 * lens.ideal_end;
    for (int i = 0; i < 3; ++i) {
        const auto around = [&](const Interval& r) { return Interval(r.lo - 2 * off, r.hi + 2 * off); };
        const Point<R> u{R(around(range.x), 0, 0), R(around(range.y), 0, 0)};
        const Point<R> next = lens_formula::nearer(lens, v, u);
        const double step = 1.5 * LensTerms::kStill * R::kUnit * lens.ideal_end + 0x1p-70 * lens.ideal_end +
                            next.x.error + next.y.error;
        if (2 * step <= off) return {R(around(range.x), 0, 2 * step), R(around(range.y), 0, 2 * step)};
        off = 4 * step;
    }
    return {R(range.x, 0, HUGE_VAL), R(range.y, 0, HUGE_VAL)};
}

}  // namespace lens_detail

namespace lens_detail {

/// A Lipschitz constant of radially_undistorted() over all v, in the norm that is the larger of x and y. Its derivative is
/// s + 2 s' v v^T with s = shrink(|v|^2), both by their Taylor series.
template <class R>
double most_undistorted(const LensTerms& lens, const Point<R>& v) {
    const R squared = square(v.x) + square(v.y);
    const ComputedSeries series = computed_shrink(
        lens, {std::max(squared.range.lo - squared.error, 0.0), squared.range.hi + squared.error});
    const double off = squared.radius + squared.error;
    double s = 0, by = 0;
    for (int k = ComputedSeries::kDegree; k >= 0; --k) {
        s = s * off + magnitude(series.exact.c[k]);
        by = by * off + (k + 1) * magnitude(series.exact.c[k + 1]);
    }
    const double x = v.x.computed_size(), y = v.y.computed_size();
    return (s + 2 * by * std::max(x, y) * (x + y)) * (1 + 0x1p-40);
}
/// A Lipschitz constant of tangential_at() over all u, in the same norm as most_undistorted().
template <class R>
double most_tangential(const LensTerms& lens, const Point<R>& u) {
    const double x = u.x.computed_size(), y = u.y.computed_size();
    const double mx = std::fabs(lens.mx), my = std::fabs(lens.my);
    const double most = 2 * (mx * x + my * y) + 4 * std::max(mx * x, my * y) + 2 * (my * x + mx * y);
    // A thin prism's slope is 2 (a + 2 b r^2) u^T.
    const double squared = x * x + y * y;
    const double prism = 2 * (x + y) *
                         std::max(std::fabs(lens.ax) + 2 * std::fabs(lens.bx) * squared,
                                  std::fabs(lens.ay) + 2 * std::fabs(lens.by) * squared);
    return (most + prism) * (1 + 0x1p-40);
}

/// settled() of jets v, where u is the result for their constant parts and nearer() maps `jet` into itself for all of
/// `around`, the points up to `off` from v.
template <class Real>
Point<Rounded<Real>> settled_within(const LensTerms& lens, const Point<Rounded<Real>>& v,
                                    const Point<Rounded<Real>>& u, const Point<Rounded<Real>>& around,
                                    const Point<Rounded<Real>>& jet, double off) {
    using R = Rounded<Real>;
    const Point<R> more = lens_formula::tangential_at(lens, jet);
    const double back = most_undistorted(lens, Point<R>{around.x - more.x, around.y - more.y}),
                 contraction = back * most_tangential(lens, jet), r = jet.x.radius;
    const double c = back / (1 - contraction);
    // Every degree of F is rounded once more, but for the constant part, which is off as u is. Slopes are rounded, those of
    // the computed u are read, and the solution is rounded by less than 16 units of all of it. So are the first parts of
    // slopes, by which degrees may be solved in pairs (chart/lens_jets.h), and by 8 units of all of it what they make of a degree.
    const Point<R> f = lens_formula::distorted(lens, jet);
    const lens_formula::Slope<R> at(lens, u);
    const lens_formula::Slope<R> along(lens, jet);
    const auto size_of = [](const R& k) { return k.computed_size(); };
    const auto error_of = [](const R& k) { return k.error; };
    const double size = largest_row(at, size_of);
    const double paired = largest_row(along, error_of) + 8 * R::kUnit * largest_row(along, size_of);
    const double rest = R::kDegree * std::max(f.x.error, f.y.error) + std::max(v.x.error, v.y.error) +
                        size * std::max(u.x.error, u.y.error) +
                        (largest_row(at, error_of) + 16 * R::kUnit * size * c * size + paired) * r;
    const double error = contraction < 0.5 && rest <= off ? c * rest * (1 + 0x1p-40) : HUGE_VAL;
    return {R(u.x.range, r, error), R(u.y.range, r, error)};
}

}  // namespace lens_detail

/// settled() with a bound of its rounding.
///
/// In norms (number/rounded.h), the larger of x and y. The exact u is what nearer() maps to itself, and so is what is
/// computed for a v that is F of it, `rest` away: both lie in a ball of jets about the constant parts that nearer() maps
/// into itself. With R and T what most_undistorted() and most_tangential() say there, they are apart by
/// R (|rest| + T apart) at most, or R / (1 - R T) |rest|.
template <class Real>
Point<Rounded<Real>> settled(const LensTerms& lens, const Point<Rounded<Real>>& v) {
    using R = Rounded<Real>;
    const Point<R> u =
        lens_detail::settled_values(lens, Point<R>{R(v.x.range, 0, v.x.error), R(v.y.range, 0, v.y.error)});
    if (std::max(v.x.radius, v.y.radius) == 0) return u;
    // Rounding is far less than this.
    const double off = 0x1p-30 * lens.ideal_end;
    const auto wide = [&](const R& a, double radius) {
        return R(Interval(a.range.lo - off, a.range.hi + off), radius + off, 0);
    };
    const Point<R> around{wide(v.x, v.x.radius), wide(v.y, v.y.radius)};
    Point<R> jet{wide(u.x, 0), wide(u.y, 0)};
    for (int i = 0; i < 6; ++i) {
        const Point<R> next = lens_formula::nearer(lens, around, jet);
        const double r = std::max(next.x.radius, next.y.radius);
        if (r <= jet.x.radius) return lens_detail::settled_within(lens, v, u, around, jet, off);
        jet.x.radius = jet.y.radius = 1.05 * r;
    }
    return {R(u.x.range, HUGE_VAL, HUGE_VAL), R(u.y.range, HUGE_VAL, HUGE_VAL)};
}

namespace lens_detail {

/// The parts of a jet up to degree K.
template <int K, class T, int N>
Jet<T, K> lowest(const Jet<T, N>& jet) {
    Jet<T, K> part;
    std::copy_n(jet.c, Jet<T, K>::kSize, part.c);
    return part;
}

/// Solves F(u) = v degree by degree, from K on: what F(u) lacks of v is the slope times what u lacks.
template <int K, class T, int N>
void settle_from(const LensTerms& lens, const Point<Jet<T, N>>& v, const lens_formula::Slope<T>& slope,
                 Point<Jet<T, N>>& u) {
    using J = Jet<T, N>;
    const Point<Jet<T, K>> f =
        lens_formula::distorted(lens, Point<Jet<T, K>>{lowest<K>(u.x), lowest<K>(u.y)});
    for (int i = J::part(K); i < J::part(K + 1); ++i) {
        const Point<T> gain = slope.solved(v.x.c[i] - f.x.c[i], v.y.c[i] - f.y.c[i]);
        u.x.c[i] = gain.x;
        u.y.c[i] = gain.y;
    }
    if constexpr (K < N) settle_from<K + 1>(lens, v, slope, u);
}
template <class T, int N>
Point<Jet<T, N>> settled_by_degree(const LensTerms& lens, const Point<Jet<T, N>>& v,
                                   const Point<T>& constant) {
    const lens_formula::Slope<T> slope(lens, constant);
    Point<Jet<T, N>> u{Jet<T, N>(constant.x), Jet<T, N>(constant.y)};
    settle_from<1>(lens, v, slope, u);
    return u;
}

/// Is every coefficient of b one of a, above the constant part?
template <int N>
bool holds(const Jet<Interval, N>& a, const Jet<Interval, N>& b) {
    for (int i = 1; i < a.kSize; ++i)
        if (!(a.c[i].lo <= b.c[i].lo && b.c[i].hi <= a.c[i].hi)) return false;
    return true;
}
/// The jet b with each coefficient widened by the largest difference of a and b in its degree.
template <int N>
Jet<Interval, N> with_room(const Jet<Interval, N>& a, const Jet<Interval, N>& b) {
    using J = Jet<Interval, N>;
    J wide = b;
    for (int k = 1; k <= N; ++k) {
        double apart = 0;
        for (int i = J::part(k); i < J::part(k + 1); ++i)
            apart = std::max({apart, std::fabs(a.c[i].lo - b.c[i].lo), std::fabs(a.c[i].hi - b.c[i].hi)});
        for (int i = J::part(k); i < J::part(k + 1); ++i) wide.c[i] = {b.c[i].lo - apart, b.c[i].hi + apart};
    }
    return wide;
}

}  // namespace lens_detail

/// settled() of jets: first their constant parts, then degree by degree.
template <class T, int N>
Point<Jet<T, N>> settled(const LensTerms& lens, const Point<Jet<T, N>>& v) {
    using lens_formula::settled;
    return lens_detail::settled_by_degree(lens, v, settled(lens, Point<T>{v.x.c[0], v.y.c[0]}));
}

/// settled() of jets of intervals.
///
/// u is what nearer() maps to itself. With the constant parts known, the parts above of one member's jet are a point of
/// a space of finite dimension, and nearer() is continuous there. A box of that space that it maps into itself for every
/// member holds a fixed point (Brouwer), and there is only one: F(u) = v, solved degree by degree with an invertible
/// slope.
template <int N>
Point<Jet<Interval, N>> settled(const LensTerms& lens, const Point<Jet<Interval, N>>& v) {
    using J = Jet<Interval, N>;
    using lens_detail::with_room;
    const Point<Interval> constant = settled(lens, Point<Interval>{v.x.c[0], v.y.c[0]});
    const auto about_constant = [&](Point<J> u) {
        u.x.c[0] = constant.x;
        u.y.c[0] = constant.y;
        return u;
    };
    const auto nearer = [&](const Point<J>& u) { return about_constant(lens_formula::nearer(lens, v, u)); };
    Point<J> from = about_constant(lens_formula::radially_undistorted(lens, v)), to = nearer(from);
    for (int i = 0; i < 2; ++i) {
        const Point<J> box{with_room(from.x, to.x), with_room(from.y, to.y)}, inner = nearer(box);
        if (lens_detail::holds(box.x, inner.x) && lens_detail::holds(box.y, inner.y)) return inner;
        from = to;
        to = inner;
    }
    return lens_detail::settled_by_degree(lens, v, constant);
}

template <class Real>
Rounded<Real> shrink(const LensTerms& lens, const Rounded<Real>& value) {
    using R = Rounded<Real>;
    if constexpr (std::is_same_v<Real, double>)
        if (const auto found = lens_detail::shrink_by_table(lens, value)) return *found;
    const R root = lens_detail::radial_root(lens, R(value.range, 0, value.error));
    if (!value.is_jet()) return R(1) / lens_formula::stretch_at(lens, root);
    constexpr int kDegree = static_cast<int>(R::kDegree);
    return lens_detail::compose(lens_detail::shrink_series<kDegree>(lens, root),
                                R(Interval(0), value.radius, value.error));
}

namespace lens_detail {

/// A function of the square of a point's distance from the centre, by its Taylor coefficients.
template <int N>
Jet<Interval, N> compose_squared(const LensCoefficients& function, const Jet<Interval, N>& squared) {
    static_assert(N <= LensCoefficients::kDegree);
    return compose(function.c, squared);
}

}  // namespace lens_detail

template <int N>
Jet<Interval, N> stretch_of(const LensTerms& lens, const Point<Jet<Interval, N>>& u) {
    if (!lens.in_radius) return lens_formula::stretch_at(lens, lens_formula::radial_of(lens, u));
    const Jet<Interval, N> squared = square(u.x) + square(u.y);
    return lens_detail::compose_squared(stretch_coefficients(lens, squared.c[0]), squared);
}
template <int N>
Jet<Interval, N> shrink_of(const LensTerms& lens, const Point<Jet<Interval, N>>& v) {
    const Jet<Interval, N> squared = square(v.x) + square(v.y);
    return lens_detail::compose_squared(shrink_coefficients(lens, squared.c[0]), squared);
}

/// shrink() near a known value: the Taylor polynomial about a base b. With c what encloses its next coefficient wherever
/// the value may be, it is off by |c| |rest|^5 at most. Bases and the loop over a block's pixels have the coefficients as
/// they are computed here.
template <class Real>
NearBound<Real> shrink(const LensTerms& lens, const NearBound<Real>& value) {
    constexpr int kDegree = ComputedSeries::kDegree;
    const RestBound<Real>& rest = value.rest;
    const double far = rest.computed_size(), base = value.base.value;
    const auto series = lens_detail::shrink_series<kDegree>(lens, lens_formula::radial_root(lens, base));
    WrittenBase bases[kDegree + 1];
    for (int k = kDegree; k >= 0; --k)
        bases[k] = WrittenBase::written(series.c[k], BaseOperation::power_series, value.base.number);
    NearBound<Real> found = NearBound<Real>::series(bases, rest);
    const ComputedSeries at = computed_shrink(lens, Interval(base));
    const Interval all = Interval(base) + Interval(-far, far);
    const Interval beyond = computed_shrink(lens, {std::max(all.lo, 0.0), all.hi}).exact.c[kDegree + 1];
    // What the bases are off is at most so much of all of the sum.
    double off = magnitude(beyond);
    for (int k = kDegree; k >= 0; --k) off = off * far + at.error[k];
    off *= 1 + 0x1p-40;
    found.rest = {found.rest.middle, found.rest.radius + off, found.rest.error + off};
    return found;
}

template <class T, int N>
Jet<T, N> shrink(const LensTerms& lens, const Jet<T, N>& value) {
    return compose(lens_detail::shrink_series<N>(lens, lens_detail::radial_root(lens, value.c[0])).c, value);
}

}  // namespace anamorph
