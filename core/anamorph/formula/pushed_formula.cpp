// SPDX-License-Identifier: Apache-2.0
#include "anamorph/formula/pushed_formula.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace anamorph {
namespace {

using pushed_detail::common, pushed_detail::half_of, pushed_detail::middle_of;
using BoundJet = PushedFormula::BoundJet;
constexpr int kSeriesDegree = simd::BoundJets::kDegree;

/// How many ways there are to choose k of n: kWays[n][k].
constexpr std::array<std::array<double, kSeriesDegree + 1>, kSeriesDegree + 1> kWays = [] {
    std::array<std::array<double, kSeriesDegree + 1>, kSeriesDegree + 1> ways{};
    for (std::size_t n = 0; n <= kSeriesDegree; ++n) {
        ways[n][0] = 1;
        for (std::size_t k = 1; k <= n; ++k) ways[n][k] = ways[n - 1][k - 1] + ways[n - 1][k];
    }
    return ways;
}();

constexpr double ways(int n, int k) {
    return kWays[static_cast<std::size_t>(n)][static_cast<std::size_t>(k)];
}

/// Every coefficient has a series itself: c_ij at (x + s, y + t) is the sum of ways(i + p, i) ways(j + q, j) c_(i+p)(j+q) s^p t^q,
/// where the last ones, of the highest degree, are those somewhere in the box. So what is known of these narrows all others.
BoundJet narrowed(const BoundJet& about, const BoundJet& over, double hx, double hy) {
    // Fewer than 2^8 roundings of all that is summed up.
    constexpr double kRounding = 0x1p-45;
    BoundJet narrow = over;
    double down[kSeriesDegree + 1] = {1};
    for (int q = 1; q <= kSeriesDegree; ++q) down[q] = down[q - 1] * hy;
    for (int i = 0; i < kSeriesDegree; ++i)
        for (int j = 0; i + j < kSeriesDegree; ++j) {
            Interval& c = narrow.c[BoundJet::part(i + j) + j];
            // Of even powers from 0 up.
            double lo = 0, hi = 0, size = 0, across = 1;
            for (int p = 0; i + j + p <= kSeriesDegree; ++p, across *= hx)
                for (int q = p == 0; i + j + p + q <= kSeriesDegree; ++q) {
                    const Interval& from = (i + j + p + q == kSeriesDegree ? over : about).at(i + p, j + q);
                    const double weight = across * down[q] * ways(i + p, i) * ways(j + q, j);
                    const double most = weight * magnitude(from);
                    const bool is_odd = (p | q) & 1;
                    size += most;
                    lo -= is_odd ? most : weight * std::max(-from.lo, 0.0);
                    hi += is_odd ? most : weight * std::max(from.hi, 0.0);
                }
            const Interval& first = about.at(i, j);
            size += magnitude(first);
            lo += first.lo - kRounding * size;
            hi += first.hi + kRounding * size;
            if (std::isfinite(size)) c = common(c, {lo, hi});
        }
    return narrow;
}

}  // namespace

Point<Interval> PlaneFrame::source(const Point<Interval>& z) const {
    const Matrix2& m = to_source;
    return {z.x * m.a11 + z.y * m.a12 + Interval(origin.x), z.x * m.a21 + z.y * m.a22 + Interval(origin.y)};
}
double PlaneFrame::rounding(const Point<double>& z) const {
    const double place = largest(origin) + largest(to_source.span(z.x, z.y));
    return 0x1p-50 * place * to_source.inverse().norm();
}

PushedFormula::PushedFormula(PlaneFormula formula, const Size& picture, const Size& target)
    : m_formula(std::move(formula)), m_scale(picture, target) {}

Matrix2 PushedFormula::derivative(const Point<double>& source) const {
    using J = Jet1<double>;
    const Point<J> f = target_point(J::variable(source.x, 1, 0), J::variable(source.y, 0, 1));
    return {f.x.c[1], f.x.c[2], f.y.c[1], f.y.c[2]};
}

Certainty PushedFormula::is_defined(const Interval& x, const Interval& y) const {
    if (m_formula.is_everywhere) return Certainty::yes;
    const DefinedInterval domain =
        read_program<2>(m_formula.domain, DefinedInterval(x), DefinedInterval(y))[0];
    return domain.lo > 0 ? Certainty::yes : domain.hi <= 0 ? Certainty::no : Certainty::open;
}

void PushedFormula::expand(const Point<Interval>* boxes, const PlaneFrame* frames, Series* found) const {
    using J = simd::BoundJets;
    Interval x[simd::kJets], y[simd::kJets];
    double xs[simd::kJets], xt[simd::kJets], ys[simd::kJets], yt[simd::kJets];
    for (int i = 0; i < simd::kJets; ++i) {
        const Point<Interval>& box = boxes[i / 2];
        const PlaneFrame& frame = frames[i / 2];
        const Point<double> middle = frame.source(Point<double>{middle_of(box.x), middle_of(box.y)});
        const Point<Interval> at = i % 2 == 0 ? frame.source(box) : Point<Interval>{middle.x, middle.y};
        x[i] = at.x;
        y[i] = at.y;
        xs[i] = frame.to_source.a11;
        xt[i] = frame.to_source.a12;
        ys[i] = frame.to_source.a21;
        yt[i] = frame.to_source.a22;
    }
    const Point<J> f = target_point(J::variable(x, xs, xt), J::variable(y, ys, yt));
    for (int i = 0; i < 2; ++i) {
        const Point<Interval>& box = boxes[i];
        const double off = frames[i].rounding({magnitude(box.x), magnitude(box.y)});
        const double hx = half_of(box.x) * (1 + 0x1p-50) + off, hy = half_of(box.y) * (1 + 0x1p-50) + off;
        const auto read = [&](int lane) {
            const Matrix2& m = frames[i].from_target;
            const BoundJet x_of = f.x.at(lane), y_of = f.y.at(lane);
            if (m.a11 == 1 && m.a12 == 0 && m.a21 == 0 && m.a22 == 1) return Point<BoundJet>{x_of, y_of};
            return Point<BoundJet>{x_of * m.a11 + y_of * m.a12, x_of * m.a21 + y_of * m.a22};
        };
        const Point<BoundJet> over = read(2 * i);
        found[i].about = read(2 * i + 1);
        found[i].over = {narrowed(found[i].about.x, over.x, hx, hy),
                         narrowed(found[i].about.y, over.y, hx, hy)};
    }
}
PushedFormula::Series PushedFormula::series(const Point<Interval>& box, const PlaneFrame& frame) const {
    const Point<Interval> boxes[] = {box, box};
    const PlaneFrame frames[] = {frame, frame};
    Series found[2];
    expand(boxes, frames, found);
    return found[0];
}

PushedFormula::Series PushedFormula::hoped(const Series& series, const Point<Interval>& box) {
    const auto all_over = [&](const BoundJet& about) {
        return narrowed(about, about, half_of(box.x), half_of(box.y));
    };
    return {series.about, {all_over(series.about.x), all_over(series.about.y)}};
}

Point<BoundJet> PushedFormula::over_quarters(const Point<Interval>& box, const PlaneFrame& frame) const {
    const auto first = [](const Interval& a) { return Interval(a.lo, middle_of(a)); };
    const auto second = [](const Interval& a) { return Interval(middle_of(a), a.hi); };
    const Point<Interval> boxes[] = {{first(box.x), first(box.y)},
                                     {second(box.x), first(box.y)},
                                     {first(box.x), second(box.y)},
                                     {second(box.x), second(box.y)}};
    const PlaneFrame frames[] = {frame, frame};
    Series found[4];
    expand(boxes, frames, found);
    expand(boxes + 2, frames, found + 2);
    Point<BoundJet> all = found[0].over;
    for (int i = 1; i < 4; ++i) all = {hull(all.x, found[i].over.x), hull(all.y, found[i].over.y)};
    return all;
}

}  // namespace anamorph
