// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/inverse_view.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

/// "lon=30 and lat=-12.5 degrees"
std::string direction_name(const Point<double>& globe) {
    constexpr Size all = InverseView::kGlobe;
    return "lon=" + brief(360 * (globe.x / all.width - 0.5)) +
           " and lat=" + brief(180 * (0.5 - globe.y / all.height)) + " degrees";
}

}  // namespace

InverseView::InverseView(const Chart& source, PlaneFormula points, const Size& picture, const Size& target,
                         const Orientation& orientation, const Orientation& held, const Size& overscan)
    : m_globe(std::move(points), picture, target, kGlobe, PushedMap::kMostParts, direction_name, overscan),
      m_view(source, Chart(Projection::equirectangular, kGlobe.width, kGlobe.height), orientation, held) {}

InverseView::Local InverseView::local_around(double x, double y, int piece) const {
    Point<double> at{0.5 * kGlobe.width, 0.5 * kGlobe.height};
    int globe_piece = 0;
    m_globe.exact(x, y, piece, at, globe_piece);
    return {m_globe.local_around(x, y, piece), m_view.local_around(at.x, at.y, 0)};
}

Cover InverseView::cover(const Interval& x, const Interval& y, int piece, const Local& local,
                         bool across_seam) const {
    const Cover there = m_globe.cover(x, y, piece, local.globe, false);
    if (there != Cover::inside) return there;
    const Point<Interval> at = m_globe(x, y, local.globe);
    return m_view.cover(at.x, at.y, 0, local.view, across_seam);
}

template <class Real>
double InverseView::error_from(const Point<Interval>& at, double error) const {
    using R = Rounded<Real>;
    return m_view.exact_error(m_view.source_ray(R(at.x, 0, error), R(at.y, 0, error), 0));
}

template <class Real>
double InverseView::exact_error(const Interval& x, const Interval& y, int piece) const {
    const auto all = m_globe.source_points(x, y);
    if (all && !all->is_apart())
        return all->is_empty() ? 0 : error_from<Real>(all->z, m_globe.exact_error<Real>(x, y, piece));
    // Near a fold, and where there are several points of which one is taken, pixel by pixel.
    double error = 0;
    for (double row = y.lo; row <= y.hi; ++row)
        for (double column = x.lo; column <= x.hi; ++column) {
            const Preimages found = m_globe.preimages(column, row);
            if (found.count == 0) continue;
            const Point<double>& at = found.best.at;
            const Interval off(-found.error, found.error);
            error =
                std::max(error, error_from<Real>({Interval(at.x) + off, Interval(at.y) + off}, found.error));
        }
    return error;
}
template double InverseView::exact_error<double>(const Interval&, const Interval&, int) const;
template double InverseView::exact_error<DoubleDouble>(const Interval&, const Interval&, int) const;

}  // namespace anamorph
