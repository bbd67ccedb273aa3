// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/formula_view.h"

#include <algorithm>
#include <cmath>

#include "anamorph/geometry/count_pixels.h"
#include "anamorph/number/program_rows.h"
#include "anamorph/panorama/panorama_rows.h"

namespace anamorph {
namespace {

bool may_be_zero(const Interval& a) {
    return !(a.lo > 0 || a.hi < 0);
}
template <class Real>
bool may_be_zero(const Rounded<Real>& a) {
    return may_be_zero(Interval(a.range.lo - a.error, a.range.hi + a.error));
}
template <class T>
bool may_be_none(const Ray<T>& r) {
    return may_be_zero(r.x) && may_be_zero(r.y) && may_be_zero(r.z);
}

bool is_zero_all_over(const Interval& a) {
    return a.lo == 0 && a.hi == 0;
}
template <class Real>
bool is_zero_all_over(const Rounded<Real>& a) {
    return is_zero_all_over(a.range) && a.error == 0 && a.radius == 0;
}
template <class T>
bool is_none(const Ray<T>& r) {
    return is_zero_all_over(r.x) && is_zero_all_over(r.y) && is_zero_all_over(r.z);
}

}  // namespace

FormulaView::FormulaView(const Chart& source, SpaceFormula rays, const Size& picture, const Size& target,
                         const Orientation& orientation, const Orientation& held)
    : m_view(source, Chart(Projection::rectilinear, target.width, target.height), orientation, held),
      m_rays(std::move(rays)),
      m_scale(target, picture) {}

FormulaView::Local FormulaView::local_around(double x, double y, int piece) const {
    return m_view.local_around(x, y, piece, turned(ray(x, y)));
}

Cover FormulaView::cover(const Interval& x, const Interval& y, int, const Local& local,
                         bool across_seam) const {
    const Interval there = domain(x, y);
    if (there.hi <= 0) return Cover::outside;
    const Ray<Interval> r = ray(x, y);
    if (is_none(r)) return Cover::outside;
    if (!(there.lo > 0) || may_be_none(r)) return Cover::mixed;
    return m_view.cover(transform(local.rotation, r, m_view.local_error()), local, across_seam);
}

Certainty FormulaView::has_rays(const Interval& x, const Interval& y) const {
    const DefinedInterval px(x), py(y);
    const Interval there = domain(px, py);
    const Ray<DefinedInterval> r = ray(px, py);
    const Ray<Interval> all{r.x, r.y, r.z};
    if (there.hi <= 0 || is_none(all)) return Certainty::no;
    const bool is_finite = std::isfinite(magnitude(all.x) + magnitude(all.y) + magnitude(all.z));
    return there.lo > 0 && is_finite && !may_be_none(all) ? Certainty::yes : Certainty::open;
}

std::int64_t FormulaView::undefined_pixels(const Box& box) const {
    // Of fewer pixels, their own rays cost no more than intervals.
    constexpr int kFew = 8;
    const auto is_undefined = [&](const Box& b) {
        const Certainty found = has_rays(Interval(b.x0 + 0.5, b.x1 - 0.5), Interval(b.y0 + 0.5, b.y1 - 0.5));
        return found == Certainty::yes ? Certainty::no : found == Certainty::no ? Certainty::yes : found;
    };
    const auto is_small = [](const Box& b) { return b.width() <= kFew && b.height() <= kFew; };
    return count_pixels(box, is_undefined, is_small, [&](const Box& b) {
        std::int64_t count = 0;
        for (int row = b.y0; row < b.y1; ++row)
            for (int column = b.x0; column < b.x1; ++column) {
                const double x = column + 0.5, y = row + 0.5;
                const Ray<double> r = ray(x, y);
                const bool is_finite = std::isfinite(r.x) && std::isfinite(r.y) && std::isfinite(r.z);
                count += !(domain(x, y) > 0 && is_finite && has_length(r));
            }
        return count;
    });
}

template <class Real>
double FormulaView::exact_error(const Interval& x, const Interval& y, int, double off) const {
    using R = Rounded<Real>;
    const R px(x, 0, off), py(y, 0, off), there = domain(px, py);
    if (there.range.hi + there.error <= 0) return 0;
    if (!(lower_end(there) > 0)) return HUGE_VAL;
    const Ray<R> r = ray(px, py);
    if (is_none(r)) return 0;
    return may_be_none(r) ? HUGE_VAL : m_view.exact_error(turned(r));
}
template double FormulaView::exact_error<double>(const Interval&, const Interval&, int, double) const;
template double FormulaView::exact_error<DoubleDouble>(const Interval&, const Interval&, int, double) const;

void FormulaView::exact_row(double x, double y, int count, double* to_x, double* to_y,
                            std::int32_t* piece) const {
    using simd::ProgramRow;
    constexpr int kPart = std::min(simd::kProgramRow, simd::kExactRow);
    ProgramRow at, found, there;
    for (int begin = 0; begin < count; begin += kPart) {
        const int part = std::min(count - begin, kPart);
        at.set_points(x + begin, y, part, m_scale);
        simd::read_program_row(m_rays.point, at, part, found);
        if (!m_rays.is_everywhere) simd::read_program_row(m_rays.domain, at, part, there);
        simd::RayRow rays;
        for (int i = 0; i < kPart; ++i) {
            // What stands behind the last point may be no number.
            const int k = std::min(i, part - 1);
            rays.x[i] = found.x[k];
            rays.y[i] = found.y[k];
            rays.z[i] = found.z[k];
            const bool is_there = m_rays.is_everywhere || there.x[k] > 0;
            rays.inside[i] = is_there && has_length(Ray<double>{found.x[k], found.y[k], found.z[k]}) ? 1 : -1;
        }
        simd::ExactRow points;
        simd::exact_points(source(), m_view.turn(), rays, part, points);
        for (int i = 0; i < part; ++i) {
            const bool is_seen = points.seen[i] != 0;
            to_x[begin + i] = is_seen ? points.x[i] : 0;
            to_y[begin + i] = is_seen ? points.y[i] : 0;
            piece[begin + i] = is_seen ? static_cast<std::int32_t>(points.piece[i]) : -1;
        }
    }
}

}  // namespace anamorph
