// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/concentric.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anamorph/error.h"
#include "anamorph/number/hypot.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

/// Directions in which vertical distortion is looked for.
constexpr int kDirections = 3600;

double inverse_of(double depth) {
    return depth < ConcentricStack::kFar ? 1 / depth : 0;
}

/// How far the viewpoint is on its way from the slit to what is seen at a distance 1 / `per_depth` from the centre.
double part_of_way(double offset, double ahead, double per_depth) {
    return ahead * per_depth / std::sqrt(1 - square(offset * per_depth));
}

glm::dvec2 horizontal(const Ray<double>& ray) {
    const double length = hypot(ray.x, ray.z);
    return length > 0 ? glm::dvec2(ray.x / length, ray.z / length) : glm::dvec2(0.0);
}

const ConcentricStack& checked(const ConcentricStack& stack, const Panorama& view, int circle) {
    stack.check();
    if (circle < 0 || circle >= stack.circles)
        throw Error("circle", std::to_string(circle + 1),
                    "must be one of the " + std::to_string(stack.circles));
    check_slit_panorama(view.source());
    return stack;
}

}  // namespace

void ConcentricStack::check() const {
    if (circles < 1 || circles > kMostCircles)
        throw Error("circles", std::to_string(circles),
                    "must be an integer from 1 to " + std::to_string(kMostCircles));
    if (!(depth > 1)) throw Error("depth", shortest(depth), "must be a number above 1");
    // By a hair farther it may be from rounding.
    if (!(hypot(viewpoint.x, viewpoint.y) <= 1 + 1e-12))
        throw Error("viewpoint", shortest(viewpoint.x) + "," + shortest(viewpoint.y),
                    "must be at most 1 from the centre");
}

void check_slit_panorama(const Chart& panorama) {
    if (panorama.counted() != Counted::azimuth || !panorama.closed())
        throw Error("from", std::string(name_of(panorama.projection())),
                    "must be a projection whose rows are a full turn");
}

double ConcentricStack::offset(const Ray<double>& ray) const {
    const glm::dvec2 u = horizontal(ray);
    return u.y * viewpoint.x - u.x * viewpoint.y;
}

double ConcentricStack::weight(int circle, double offset) const {
    if (circles == 1) return 1;
    const double place = std::clamp((offset + 1) / 2, 0.0, 1.0) * (circles - 1);
    return std::max(0.0, 1 - std::fabs(place - circle));
}

double ConcentricStack::vertical_distortion(const Ray<double>& ray, double nearest) const {
    const glm::dvec2 u = horizontal(ray);
    const double r = offset(ray), t = viewpoint.x * u.x + viewpoint.y * u.y;
    // Drawn heights over true ones: the thing's way from the viewpoint over that of the depth that is taken, in parts of the
    // ways from the slit.
    const double taken = 1 - part_of_way(r, t, inverse_of(depth)), far = 1 / taken;
    const double near = (1 - part_of_way(r, t, inverse_of(nearest))) / taken;
    // Things in between are in between.
    return std::max(std::fabs(near - 1), std::fabs(far - 1));
}

double ConcentricStack::vertical_distortion(double nearest) const {
    double most = 0;
    for (int i = 0; i < kDirections; ++i) {
        // From along the viewpoint on, where it is largest but for things close by.
        const double angle = std::atan2(viewpoint.x, viewpoint.y) + 2 * std::numbers::pi * i / kDirections;
        most = std::max(most, vertical_distortion({std::sin(angle), 0, std::cos(angle)}, nearest));
    }
    return most;
}

ConcentricMap::ConcentricMap(const Panorama& view, const ConcentricStack& stack, int circle, bool whole)
    : m_view(view),
      m_stack(checked(stack, view, circle)),
      m_circle(circle),
      m_whole(whole),
      m_per_depth(inverse_of(stack.depth)) {
    const DoubleDouble slit = static_cast<DoubleDouble>(stack.radius(circle)) * m_per_depth;
    m_slit = Constant(slit);
    m_least_height = (1 - hypot(stack.viewpoint.x, stack.viewpoint.y) * m_per_depth) / 2;
    const DoubleDouble root = sqrt((1 - slit) * (1 + slit));
    m_slit_root = Constant(root);
    m_per_root = Constant(1 / root);
}

ConcentricMap::Local ConcentricMap::local_around(double x, double y, int piece) const {
    const glm::dvec2& p = m_stack.viewpoint;
    Local local{m_view.local_around(x, y, piece, slit_or_pole(m_view.source_ray(x, y, piece))), {}};
    const glm::dvec3 moved = glm::transpose(local.view.source.axes) * glm::dvec3(p.x, 0, p.y);
    local.viewpoint = {moved.x, moved.z};
    return local;
}

double ConcentricMap::offset_error(const Interval& x, const Interval& y, int piece) const {
    using R = Rounded<double>;
    const Ray<R> ray = m_view.source_ray(R(x, 0, 0), R(y, 0, 0), piece);
    const auto least = [](const Interval& a) { return std::max({a.lo, -a.hi, 0.0}); };
    const double moved = hypot(ray.x.error, ray.z.error);
    const double nearest = hypot(least(ray.x.range), least(ray.z.range)) * (1 - 0x1p-50);
    if (!(nearest > moved)) return HUGE_VAL;
    // Directions of vectors a and b are at most |a - b| / sqrt(|a| |b|) apart, and offsets as much, as the viewpoint is at most
    // 1 from the centre, a hair aside. In units of 2^-53: hypot is off by 8 of a direction, its quotients by 1, the products and
    // the difference of an offset by 2; weight()'s sum and product by 4 when they are counted as an offset; and the radius of
    // the circle, the way to the next one, their sum and the difference from that by 10. That is 25.
    return (moved / (nearest - moved) + 40 * 0x1p-53) * (1 + 0x1p-30);
}

Cover ConcentricMap::cover(const Interval& x, const Interval& y, int piece, const Local& local,
                           bool across_seam) const {
    const Cover target = m_view.target_cover(x, y, piece);
    if (target != Cover::inside) return target;
    const Ray<Interval> ray = m_view.local_ray(x, y, local.view);
    if (m_view.source().sees(flattest(ray)).hi < 0) return Cover::outside;
    const auto px = measured<Interval>(local.viewpoint.x, kLocalError);
    const auto pz = measured<Interval>(local.viewpoint.y, kLocalError);
    const Interval offset = sight(ray, px, pz).offset;
    const double reach = 2.0 / std::max(1, m_stack.circles - 1), radius = m_stack.radius(m_circle);
    const double beyond = std::max(offset.lo - (radius + reach), (radius - reach) - offset.hi);
    if (!m_whole && beyond > 0 && beyond > offset_error(x, y, piece)) return Cover::outside;
    return m_view.cover(slit_ray(ray, px, pz), local.view, across_seam);
}

template <class Real>
double ConcentricMap::exact_error(const Interval& x, const Interval& y, int piece) const {
    using R = Rounded<Real>;
    if (!(m_view.target().inside(x, y, piece).hi >= 0)) return 0;
    const Ray<R> ray = m_view.source_ray(R(x, 0, 0), R(y, 0, 0), piece);
    const R seen = m_view.source().sees(flattest(ray));
    if (seen.range.hi + seen.error <= 0) return 0;
    const auto is_zero = [](const R& r) { return r.range.lo == 0 && r.range.hi == 0 && r.error == 0; };
    if (is_zero(ray.x) && is_zero(ray.z)) return m_view.exact_error(ray);
    return m_view.exact_error(slit_ray(ray, m_stack.viewpoint.x, m_stack.viewpoint.y));
}
template double ConcentricMap::exact_error<double>(const Interval&, const Interval&, int) const;
template double ConcentricMap::exact_error<DoubleDouble>(const Interval&, const Interval&, int) const;

}  // namespace anamorph
