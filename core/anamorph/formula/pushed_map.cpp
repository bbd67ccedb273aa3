// SPDX-License-Identifier: Apache-2.0
#include "anamorph/formula/pushed_map.h"

#include <algorithm>
#include <cmath>

#include "anamorph/geometry/count_pixels.h"

namespace anamorph {
namespace {

using pushed_detail::about, pushed_detail::common, pushed_detail::half_of, pushed_detail::holds,
    pushed_detail::middle_of;
using BoundJet = PushedFormula::BoundJet;

// By how much more than it needs a box is taken, so that it is led into itself.
constexpr double kRoom = 1.01, kMoreRoom = 1.3;
// The largest |g' - I| over what holds all source points, and over what is led into itself.
constexpr double kMostAtAll = 0.9, kMostBend = 0.45;
// A box that is so much larger than all sheets around bends too much.
constexpr double kTimesSheet = 4;

/// The larger sum of a row of |g' - I|, where parameters are counted in units (w, h).
double size_of(const Linear<Interval>& bend, double w, double h) {
    return std::max(magnitude(bend.a11) + magnitude(bend.a12) * (h / w),
                    magnitude(bend.a21) * (w / h) + magnitude(bend.a22));
}
Linear<Interval> bend_of(const Point<BoundJet>& g) {
    return {g.x.c[1] - Interval(1), g.x.c[2], g.y.c[1], g.y.c[2] - Interval(1)};
}

}  // namespace

PushedMap::PushedMap(PlaneFormula formula, const Size& picture, const Size& target, const Size& source,
                     std::size_t most_parts, PushedSheets::NamePlace place, const Size& overscan)
    : m_target(target),
      m_sheets({std::move(formula), picture, target}, widened({0, 0, target.width, target.height}, overscan),
               source, most_parts, place) {}

PushedMap::Local PushedMap::local_around(double x, double y, int) const {
    const Preimages all = preimages(x, y);
    if (all.count != 1 || all.on_fold) return {};
    return {{x, y}, {all.best.at, formula().derivative(all.best.at).inverse()}, true};
}

// --- a box of the target ---

/// K(Z) as pushed_map.h has it.
Point<Interval> PushedMap::krawczyk(const Interval& x, const Interval& y, const PlaneFrame& frame,
                                    const Linear<Interval>& bend, const Point<Interval>& z) const {
    const Point<double> z0{middle_of(z.x), middle_of(z.y)}, at = frame.source(z0);
    const Point<DefinedInterval> g = formula().target_point(DefinedInterval(at.x), DefinedInterval(at.y));
    const double off = frame.rounding({std::fabs(z0.x), std::fabs(z0.y)});
    const Interval zx = about(z0.x, off), zy = about(z0.y, off), dx = z.x - zx, dy = z.y - zy;
    return {zx + (x - Interval(g.x)) - (bend.a11 * dx + bend.a12 * dy),
            zy + (y - Interval(g.y)) - (bend.a21 * dx + bend.a22 * dy)};
}

/// g' - I over a box; `most`: what it is hoped to be, in units of the box.
Linear<Interval> PushedMap::bend_over(const Point<Interval>& z, const PlaneFrame& frame, double most) const {
    const auto serves = [&](const PushedFormula::Series& series) {
        return size_of(bend_of(series.over), half_of(z.x), half_of(z.y)) <= most;
    };
    return bend_of(formula().series(z, frame, serves).over);
}

/// First a box that holds all source points, where no two of them have one target point; then one in it that has them all.
std::optional<PushedMap::Roots> PushedMap::roots(const Interval& x, const Interval& y,
                                                 const Local& local) const {
    const PlaneFrame& frame = local.frame;
    const std::optional<PushedSheets::Reached> reached = m_sheets.reached(x, y, frame);
    if (!reached || reached->is_empty()) return std::nullopt;
    const auto roomy = [](const Interval& a, double times) {
        return about(middle_of(a), times * half_of(a) + 1e-9);
    };
    const auto is_little = [](const Linear<Interval>& bend, const Point<Interval>& z, double most) {
        return size_of(bend, half_of(z.x), half_of(z.y)) <= most;
    };
    // Without bending the roots would be these.
    const Point<Interval> straight{x - Interval(local.target.x), y - Interval(local.target.y)};
    const Point<Interval> all{hull(roomy(reached->z.x, kRoom), roomy(straight.x, kMoreRoom)),
                              hull(roomy(reached->z.y, kRoom), roomy(straight.y, kMoreRoom))};
    const Point<Interval> source = frame.source(all);
    if (!(half_of(source.x) <= kTimesSheet * reached->largest_sheet.x + 1 &&
          half_of(source.y) <= kTimesSheet * reached->largest_sheet.y + 1) ||
        formula().is_defined(source.x, source.y) != Certainty::yes)
        return std::nullopt;
    const Linear<Interval> bend = bend_over(all, frame, kMostAtAll);
    if (!is_little(bend, all, kMostAtAll)) return std::nullopt;
    if (is_little(bend, all, kMostBend)) {
        const Point<Interval> next = krawczyk(x, y, frame, bend, all);
        if (holds(all, next)) return Roots{x, y, all, bend};
    }
    Point<Interval> z{roomy(straight.x, kMoreRoom), roomy(straight.y, kMoreRoom)};
    constexpr int kTries = 3;
    for (int n = 0; n < kTries; ++n) {
        const Linear<Interval> less = bend_over(z, frame, kMostBend);
        if (!is_little(less, z, kMostBend)) return std::nullopt;
        const Point<Interval> next = krawczyk(x, y, frame, less, z);
        if (!holds(all, next)) return std::nullopt;
        if (holds(z, next)) return Roots{x, y, z, less};
        z = {roomy(hull(z.x, next.x), kRoom), roomy(hull(z.y, next.y), kRoom)};
        if (!holds(all, z)) return std::nullopt;
    }
    return std::nullopt;
}

bool PushedMap::find_roots(const Interval& x, const Interval& y, const Local& local,
                           Point<Interval>& z) const {
    if (!local.is_known) return false;
    if (!(local.roots && holds(local.roots->x, x) && holds(local.roots->y, y))) {
        const std::optional<Roots> found = roots(x, y, local);
        if (!found) return false;
        local.roots = found;
    }
    // Each step leaves kMostBend of what is too much, at most.
    constexpr int kSteps = 6;
    z = local.roots->z;
    for (int n = 0; n < kSteps; ++n) {
        const Point<Interval> next = krawczyk(x, y, local.frame, local.roots->bend, z);
        const double width = half_of(z.x), height = half_of(z.y);
        z = {common(z.x, next.x), common(z.y, next.y)};
        if (half_of(z.x) > 0.9 * width && half_of(z.y) > 0.9 * height) break;
    }
    return z.x.lo <= z.x.hi && z.y.lo <= z.y.hi;
}

Cover PushedMap::cover(const Interval& x, const Interval& y, int, const Local& local, bool) const {
    Point<Interval> z;
    if (find_roots(x, y, local, z)) {
        const Point<Interval> at = local.frame.source(z);
        const bool is_inside =
            holds({{0, double(source_size().width)}, {0, double(source_size().height)}}, at);
        return is_inside ? Cover::inside : Cover::mixed;
    }
    const std::optional<PushedSheets::Reached> reached = m_sheets.reached(x, y, {});
    return reached && reached->is_empty() ? Cover::outside : Cover::mixed;
}

// --- numbers ---

Point<double> PushedMap::operator()(double x, double y, const Local&) const {
    Point<double> p{NAN, NAN};
    int piece = 0;
    exact(x, y, 0, p, piece);
    return p;
}
Point<Interval> PushedMap::operator()(const Interval& x, const Interval& y, const Local& local) const {
    Point<Interval> z;
    return find_roots(x, y, local, z) ? local.frame.source(z)
                                      : Point<Interval>{Interval::all(), Interval::all()};
}

template <class J>
Point<J> PushedMap::read_taylor(const Point<J>& v, const Local& local) const {
    using L = inverse_detail::Lanes<J>;
    Point<double> at[L::kCount];
    for (int lane = 0; lane < L::kCount; ++lane)
        at[lane] = (*this)(L::get(v.x, 0, lane), L::get(v.y, 0, lane), local);
    const J x = inverse_detail::variable<J>([&](int lane) { return at[lane].x; }, true),
            y = inverse_detail::variable<J>([&](int lane) { return at[lane].y; }, false);
    return inverse_series(formula().target_point(x, y), v, [&](int lane) { return at[lane]; });
}
template <int N>
Point<Jet<double, N>> PushedMap::operator()(const Jet<double, N>& x, const Jet<double, N>& y,
                                            const Local& local) const {
    return read_taylor(Point<Jet<double, N>>{x, y}, local);
}
template Point<Jet<double, 1>> PushedMap::operator()(const Jet<double, 1>&, const Jet<double, 1>&,
                                                     const Local&) const;
Point<simd::TaylorJets> PushedMap::operator()(const simd::TaylorJets& x, const simd::TaylorJets& y,
                                              const Local& local) const {
    return read_taylor(Point<simd::TaylorJets>{x, y}, local);
}

namespace {

/// The source points of jets of parameters.
template <class J>
Point<J> on_frame(const PlaneFrame& frame, const Point<J>& z) {
    const Matrix2& m = frame.to_source;
    return {z.x * m.a11 + z.y * m.a12 + frame.origin.x, z.x * m.a21 + z.y * m.a22 + frame.origin.y};
}

}  // namespace

template <int N>
Point<Jet<Interval, N>> PushedMap::operator()(const Jet<Interval, N>& x, const Jet<Interval, N>& y,
                                              const Local& local) const {
    using J = Jet<Interval, N>;
    Point<Interval> z{Interval::all(), Interval::all()};
    find_roots(x.c[0], y.c[0], local, z);
    const Point<BoundJet> g = formula().series(z, local.frame).over;
    Point<J> low;
    std::copy_n(g.x.c, J::kSize, low.x.c);
    std::copy_n(g.y.c, J::kSize, low.y.c);
    return on_frame(local.frame, inverse_series(low, Point<J>{x, y}, [&](int) { return z; }));
}
template Point<Jet<Interval, 1>> PushedMap::operator()(const Jet<Interval, 1>&, const Jet<Interval, 1>&,
                                                       const Local&) const;
template Point<Jet<Interval, 2>> PushedMap::operator()(const Jet<Interval, 2>&, const Jet<Interval, 2>&,
                                                       const Local&) const;
Point<simd::BoundJets> PushedMap::operator()(const simd::BoundJets& x, const simd::BoundJets& y,
                                             const Local& local) const {
    Point<Interval> z[simd::kJets];
    for (int lane = 0; lane < simd::kJets; ++lane)
        if (!find_roots(x.c[0][lane], y.c[0][lane], local, z[lane]))
            z[lane] = {Interval::all(), Interval::all()};
    const PlaneFrame frames[] = {local.frame, local.frame};
    PushedFormula::Series g[simd::kJets];
    for (int lane = 0; lane < simd::kJets; lane += 2) formula().expand(z + lane, frames, g + lane);
    Point<simd::BoundJets> over;
    for (int lane = 0; lane < simd::kJets; ++lane) {
        over.x.set(lane, g[lane].over.x);
        over.y.set(lane, g[lane].over.y);
    }
    return on_frame(local.frame,
                    inverse_series(over, Point<simd::BoundJets>{x, y}, [&](int lane) { return z[lane]; }));
}

namespace {

/// By degrees, the sums of magnitudes of a series' coefficients, the larger of both coordinates.
struct TermSizes {
    double of[5] = {};

    explicit TermSizes(const Point<BoundJet>& f) {
        for (int degree = 1; degree <= 4; ++degree) {
            double x = 0, y = 0;
            for (int k = BoundJet::part(degree); k < BoundJet::part(degree + 1); ++k) {
                x += magnitude(f.x.c[k]);
                y += magnitude(f.y.c[k]);
            }
            of[degree] = std::max(x, y);
        }
    }
    /// The size of N at r; slope() is that of its slope.
    double beyond_linear(double r) const { return ((of[4] * r + of[3]) * r + of[2]) * r * r; }
    double slope(double r) const { return ((4 * of[4] * r + 3 * of[3]) * r + 2 * of[2]) * r; }
};

}  // namespace

/// Reads jets with their rounding as pushed_map.h has it, in norms of the larger coordinate, for all members
/// of a box at once.
///
/// The ball. v - N(z) + (I - J) z leads a ball of radius r into itself where |v| + e r + n(r) <= r, with e that of I - J and n(r) the sum
/// of N's terms at r; c = e + n'(r).
///
/// The rest, in target pixels. Jets are computed by source pixels, up to R of them, where S is n(R) by these: Horner's rule rounds a
/// term of degree k in k products of jets, of 16 units each (Rounded::kSum), and k sums: 128 units in all. The difference from v: one
/// more of |v| + S. J^-1, by Cramer's rule, takes 3 units of the determinant's terms, 2 of its quotients and products, and 3 as it is
/// applied, each of |J| |J^-1|: 16 in all. Coefficients are those of f, which Rounded reads with radius R; the source point is off by
/// `known`.
Point<Rounded<double>> PushedMap::operator()(const Rounded<double>& x, const Rounded<double>& y,
                                             const Local& local) const {
    using R = Rounded<double>;
    const R none(Interval::all(), HUGE_VAL, HUGE_VAL);
    Point<Interval> z;
    const std::optional<double> known = m_sheets.error(x.range, y.range);
    if (!known || x.error != 0 || y.error != 0 || !find_roots(x.range, y.range, local, z))
        return {none, none};
    const Matrix2& to_source = local.frame.to_source;
    const Point<Interval> at = local.frame.source(z);
    if (!x.is_jet() && !y.is_jet()) return {R(at.x, 0, *known), R(at.y, 0, *known)};

    const Point<Interval> boxes[] = {z, at};
    const PlaneFrame frames[] = {local.frame, {}};
    PushedFormula::Series found[2];
    formula().expand(boxes, frames, found);
    const TermSizes in_frame(found[0].over), in_pixels(found[1].over);
    const double bend = size_of(bend_of(found[0].over), 1, 1), v = std::max(x.radius, y.radius);
    const auto is_ball = [&](double r) { return 1.01 * (v + bend * r + in_frame.beyond_linear(r)) <= r; };
    double r = 1.1 * v;
    constexpr int kTries = 8;
    for (int n = 0; n < kTries && !is_ball(r); ++n) r *= 1.2;
    const double c = bend + in_frame.slope(r);
    if (!is_ball(r) || !(c <= 0.75)) return {none, none};

    // A power of two: jets that are scaled by it are rounded as they would be without.
    const double pixels = std::exp2(std::ceil(std::log2(to_source.norm() * r)));
    const Point<R> f = formula().target_point(R(at.x, pixels, *known), R(at.y, pixels, *known));
    const double sum = in_pixels.beyond_linear(pixels),
                 condition = in_pixels.of[1] * to_source.norm() / (1 - bend);
    const double rest =
        std::max(f.x.error, f.y.error) + R::kUnit * (128 * sum + (1 + 16 * condition) * (v + sum));
    const double off = rest / (1 - c) * (1 + 0x1p-30);
    // What is computed lies in the ball, too.
    if (!(off <= 0.005 * r)) return {none, none};
    const Point<double> radius = to_source.span(r, r), error = to_source.span(off, off);
    return {R(at.x, radius.x, *known + error.x), R(at.y, radius.y, *known + error.y)};
}

std::int64_t PushedMap::undefined_pixels(const Box& box) const {
    // Of fewer pixels, their own points cost no more than bounds.
    constexpr int kFew = 8;
    const auto is_undefined = [&](const Box& b) {
        const Interval x(b.x0 + 0.5, b.x1 - 0.5), y(b.y0 + 0.5, b.y1 - 0.5);
        const Cover found = cover(x, y, 0, local_around(middle_of(x), middle_of(y), 0), true);
        return found == Cover::inside    ? Certainty::no
               : found == Cover::outside ? Certainty::yes
                                         : Certainty::open;
    };
    const auto is_small = [](const Box& b) { return b.width() <= kFew && b.height() <= kFew; };
    return count_pixels(box, is_undefined, is_small, [&](const Box& b) {
        std::int64_t count = 0;
        for (int row = b.y0; row < b.y1; ++row)
            for (int column = b.x0; column < b.x1; ++column)
                count += preimages(column + 0.5, row + 0.5).count == 0;
        return count;
    });
}

}  // namespace anamorph
