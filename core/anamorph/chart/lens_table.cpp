// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chart/lens_table.h"

#include <algorithm>
#include <cmath>

namespace anamorph {
namespace {

using lens_formula::Series;
using Coefficients = LensTable::Coefficients;
constexpr int kDegree = Coefficients::kDegree;

// Rings are as wide as a part of the distance of the picture's corner. Beyond it, they are wider in proportion; so they
// are towards the centre where the function is one of the distance, whose derivatives by its square grow there.
constexpr int kRingsToCorner = 64;
constexpr double kWiderBeyond = 1.02, kWiderInRadius = 1.04;
constexpr double kNearestInRadius = 0x1p-10;
// What is narrower than this part of a ring is enclosed for itself.
constexpr double kNarrow = 1.0 / 16;
// A ring is enclosed in parts where that helps, halved so often.
constexpr int kMostHalvings = 3;

/// The root of q by powers of what is added to it: (1/2 over k) q^(1/2 - k).
Series<Interval, kDegree> root_series(const Interval& q) {
    constexpr double kBinomial[] = {1, 1.0 / 2, -1.0 / 8, 1.0 / 16, -5.0 / 128, 7.0 / 256};
    Series<Interval, kDegree> r(sqrt(q));
    const Interval inverse = Interval(1) / q;
    Interval power = r.c[0];
    for (int k = 1; k <= kDegree; ++k) {
        power = power * inverse;
        r.c[k] = power * kBinomial[k];
    }
    return r;
}

/// Members of both: two enclosures of the same.
Interval common(const Interval& a, const Interval& b) {
    return {std::max(a.lo, b.lo), std::min(a.hi, b.hi)};
}

Coefficients hull(const Coefficients& a, const Coefficients& b) {
    Coefficients r;
    for (int k = 0; k <= kDegree; ++k)
        r.c[k] = {std::min(a.c[k].lo, b.c[k].lo), std::max(a.c[k].hi, b.c[k].hi)};
    return r;
}

/// Is the last coefficient known so badly that it would make up most of a fifth derivative along the radius? That of
/// sum c_k n^k with n = 2 r s + s^2 is c_5 (2 r)^5 + 4 c_4 (2 r)^3 + 3 c_3 (2 r), over 5!.
bool is_loose(const Coefficients& all, const Coefficients& there, const Interval& squared) {
    const double r = 2 * std::sqrt(squared.hi), r2 = r * r;
    const double size =
        (magnitude(there.c[5]) * r2 + 4 * magnitude(there.c[4])) * r2 + 3 * magnitude(there.c[3]);
    return (all.c[5].hi - all.c[5].lo) * r2 * r2 > size;
}

/// By the mean value theorem a coefficient, as a function of the place, is the middle's and its derivative times the
/// distance; the derivative of coefficient k is k + 1 times the next one.
Coefficients narrowed(Coefficients all, const Coefficients& there, const Interval& distance) {
    for (int k = kDegree - 1; k >= 0; --k) {
        const Interval moved = there.c[k] + all.c[k + 1] * distance * (k + 1.0);
        if (magnitude(moved) < HUGE_VAL) all.c[k] = common(all.c[k], moved);
    }
    return all;
}

bool is_bounded(const Coefficients& c) {
    return std::all_of(std::begin(c.c), std::end(c.c),
                       [](const Interval& k) { return magnitude(k) < HUGE_VAL; });
}

}  // namespace

LensTable::LensTable(const LensTerms& lens, double corner) : m_lens(lens) {
    const auto distance_of = [&](double t) { return lens.in_radius ? t : std::sqrt(t); };
    const double end = distance_of(lens.end), value_end = distance_of(lens.value_end);
    // What the corner's ideal point is, as far as the lens goes.
    const double t = std::min(lens.in_radius ? corner : corner * corner, lens.end);
    const double ideal = lens.to_observed ? corner : distance_of(lens_formula::radial_at(lens, t));
    m_shrink.shrink = true;
    cut(m_shrink, std::min(ideal, value_end), value_end);
    if (lens.in_radius) cut(m_stretch, std::min(corner, end), end);
}

void LensTable::cut(Rings& rings, double corner, double reach) const {
    std::vector<double> distances{0};
    if (m_lens.in_radius)
        for (double d = kNearestInRadius * corner; d < corner; d *= kWiderInRadius) distances.push_back(d);
    else
        for (int i = 1; i < kRingsToCorner; ++i) distances.push_back(corner * i / kRingsToCorner);
    for (double d = corner; d < reach; d *= kWiderBeyond) distances.push_back(d);
    distances.push_back(reach);
    for (const double d : distances) rings.ends.push_back(d * d);
    rings.rings = std::make_unique<Ring[]>(distances.size() - 1);
}

std::size_t LensTable::Rings::index_of(double squared) const {
    const auto above = std::upper_bound(ends.begin() + 1, ends.end() - 1, squared);
    return static_cast<std::size_t>(above - ends.begin()) - 1;
}

const LensTable::Ring& LensTable::ring(const Rings& rings, std::size_t i) const {
    Ring& found = rings.rings[i];
    std::call_once(found.made,
                   [&] { make(found, Interval(rings.ends[i], rings.ends[i + 1]), rings.shrink); });
    return found;
}

Coefficients LensTable::enclosed(const Interval& squared, bool shrink, int halvings) const {
    const double middle = 0.5 * (squared.lo + squared.hi);
    const Coefficients there = direct(Interval(middle), shrink);
    const Coefficients all = narrowed(direct(squared, shrink), there, squared - middle);
    if (halvings == 0 || !is_loose(all, there, squared)) return all;
    return hull(enclosed({squared.lo, middle}, shrink, halvings - 1),
                enclosed({middle, squared.hi}, shrink, halvings - 1));
}

void LensTable::make(Ring& ring, const Interval& squared, bool shrink) const {
    ring.coefficients = enclosed(squared, shrink, kMostHalvings);
    if (!shrink) return;
    const double middle = 0.5 * (squared.lo + squared.hi);
    ring.middle = m_lens.in_radius ? std::sqrt(middle) : middle;
    const double root = lens_formula::radial_root(m_lens, ring.middle);
    const auto powers =
        lens_detail::reversed(lens_formula::radial_at(m_lens, Series<double, 3>::variable(root)));
    ring.root[0] = root;
    std::copy_n(powers.c + 1, 3, ring.root + 1);
}

Coefficients LensTable::direct(const Interval& squared, bool shrink) const {
    using S = Series<Interval, kDegree>;
    const auto at = [&](const Interval& t) {
        return shrink ? lens_detail::shrink_series<kDegree>(m_lens, lens_detail::radial_root(m_lens, t))
                      : lens_formula::stretch_at(m_lens, S::variable(t));
    };
    if (!m_lens.in_radius) return at(squared);
    S distance = root_series(squared);
    const S by_distance = at(distance.c[0]);
    distance.c[0] = Interval(0);
    return lens_detail::compose(by_distance, distance);
}

Coefficients LensTable::over(const Rings& rings, const Interval& squared) const {
    if (!(squared.lo <= squared.hi)) return direct(Interval::all(), rings.shrink);
    const std::size_t first = rings.index_of(squared.lo), last = rings.index_of(squared.hi);
    if (squared.hi - squared.lo < kNarrow * (rings.ends[first + 1] - rings.ends[first])) {
        const Coefficients there = direct(squared, rings.shrink);
        if (is_bounded(there)) return there;
    }
    Coefficients all = ring(rings, first).coefficients;
    for (std::size_t i = first + 1; i <= last; ++i) all = hull(all, ring(rings, i).coefficients);
    // At a ring's end they may be unbounded, but not where the box lies.
    return is_bounded(all) ? all : direct(squared, rings.shrink);
}

Coefficients LensTable::shrink_at(const Interval& value) const {
    return lens_detail::shrink_series<kDegree>(m_lens, lens_detail::radial_root(m_lens, value));
}

const ComputedSeries& LensTable::computed_in(std::size_t i) const {
    Ring& found = m_shrink.rings[i];
    std::call_once(found.computed_made, [&] {
        const Interval squared(m_shrink.ends[i], m_shrink.ends[i + 1]);
        const Interval value = m_lens.in_radius ? sqrt(squared) : squared;
        const double middle = 0.5 * (value.lo + value.hi);
        ComputedSeries& computed = found.computed;
        computed.exact = narrowed(shrink_at(value), shrink_at(Interval(middle)), value - middle);
        const auto rounded = lens_detail::shrink_series<ComputedSeries::kDegree>(
            m_lens, lens_detail::radial_root(m_lens, Rounded<double>(value, 0, 0)));
        for (int k = 0; k <= ComputedSeries::kDegree; ++k) computed.error[k] = rounded.c[k].error;
    });
    return found.computed;
}

ComputedSeries LensTable::computed_shrink(const Interval& value) const {
    if (!(value.lo >= 0 && value.hi <= m_lens.value_end)) return ComputedSeries::unbounded();
    const auto index_of = [&](double v) { return m_shrink.index_of(m_lens.in_radius ? v * v : v); };
    // A square may be rounded into the next ring.
    const std::size_t first = index_of(value.lo * (1 - 0x1p-50)), last = index_of(value.hi * (1 + 0x1p-50));
    ComputedSeries all = computed_in(first);
    for (std::size_t i = first + 1; i <= last; ++i) {
        const ComputedSeries& more = computed_in(i);
        all.exact = hull(all.exact, more.exact);
        for (int k = 0; k <= ComputedSeries::kDegree; ++k)
            all.error[k] = rounded_detail::larger(all.error[k], more.error[k]);
    }
    return all;
}

double LensTable::near_root(double value) const {
    const Ring& there = ring(m_shrink, m_shrink.index_of(m_lens.in_radius ? value * value : value));
    const double d = value - there.middle, *c = there.root;
    const double t = ((c[3] * d + c[2]) * d + c[1]) * d + c[0];
    return t >= 0 && t <= m_lens.end ? t : value * m_lens.slope;
}

}  // namespace anamorph
