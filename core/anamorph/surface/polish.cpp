// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/polish.h"

#include <algorithm>
#include <cmath>

#include "anamorph/number/hypot.h"
#include "anamorph/surface/seen_range.h"

namespace anamorph::surface {
namespace {

constexpr int kMostSteps = 12;
// Beyond that, steps change nothing.
constexpr double kLeastStep = 1e-15;

}  // namespace

/// A point, how far from a place it is seen, and the inverse of the derivatives.
struct PointPolish::Step {
    glm::dvec3 p;
    double off_x, off_y;
    double u_x, u_y, v_x, v_y;  ///< of u and v by the place on the screen
};

PointPolish::Step PointPolish::step(double x, double y, double u, double v) const noexcept {
    const SurfaceFrame frame = m_surface.frame(u, v);
    Step s;
    s.p = m_camera.in_frame(frame.position);
    const Point<double> seen = m_camera.seen(s.p);
    s.off_x = seen.x - x;
    s.off_y = seen.y - y;
    // Of X / Z: (X' - (X / Z) Z') / Z.
    const double scale = m_camera.focal() * m_camera.weight(s.p);
    const double slope_x = m_camera.perspective() ? s.p.x / s.p.z : 0,
                 slope_y = m_camera.perspective() ? s.p.y / s.p.z : 0;
    const glm::dvec3 by_u = m_camera.turned(frame.by_u), by_v = m_camera.turned(frame.by_v);
    const double x_u = (by_u.x - slope_x * by_u.z) * scale, y_u = (by_u.y - slope_y * by_u.z) * scale,
                 x_v = (by_v.x - slope_x * by_v.z) * scale, y_v = (by_v.y - slope_y * by_v.z) * scale;
    const double inverse = 1 / (x_u * y_v - x_v * y_u);
    s.u_x = y_v * inverse;
    s.u_y = -x_v * inverse;
    s.v_x = -y_u * inverse;
    s.v_y = x_u * inverse;
    return s;
}

PointPolish::Slopes PointPolish::slopes(const Interval& u, const Interval& v) const noexcept {
    const auto seen = seen_range(m_camera, m_surface.range(u, v));
    return {u, v, seen[0].c[1], seen[0].c[2], seen[1].c[1], seen[1].c[2]};
}

/// Has a box one root at most? 1 - Y g' contracts in some weighted maximum norm where the matrix of its magnitudes has a spectral
/// radius below 1.
bool PointPolish::contracts(const Step& s, const Slopes& g) noexcept {
    const double uu = magnitude(Interval(1) - (s.u_x * g.x_u + s.u_y * g.y_u)),
                 uv = magnitude(s.u_x * g.x_v + s.u_y * g.y_v), vu = magnitude(s.v_x * g.x_u + s.v_y * g.y_u),
                 vv = magnitude(Interval(1) - (s.v_x * g.x_v + s.v_y * g.y_v));
    return uu < 1 && vv < 1 && (1 - uu) * (1 - vv) * (1 - 0x1p-40) > uv * vu;
}

bool PointPolish::is_single(const Step& s, double u0, double v0, double u1, double v1,
                            const Slopes* around) const noexcept {
    const Interval u(std::min(u0, u1), std::max(u0, u1)), v(std::min(v0, v1), std::max(v0, v1));
    const auto holds = [](const Interval& a, const Interval& b) { return a.lo <= b.lo && b.hi <= a.hi; };
    if (around && holds(around->u, u) && holds(around->v, v) && contracts(s, *around)) return true;
    return contracts(s, slopes(u, v));
}

PointPolish::Polished PointPolish::polish(double x, double y, double u, double v,
                                          const Slopes* around) const noexcept {
    Polished to{u, v, 0, HUGE_VAL};
    Step s = step(x, y, u, v);
    for (int n = 0; n < kMostSteps; ++n) {
        const double du = s.u_x * s.off_x + s.u_y * s.off_y, dv = s.v_x * s.off_x + s.v_y * s.off_y;
        // Not beyond the picture.
        const double next_u = std::clamp(to.u - du, 0.0, 1.0), next_v = std::clamp(to.v - dv, 0.0, 1.0);
        if (!std::isfinite(du + dv)) return to;
        const Step next = step(x, y, next_u, next_v);
        const bool nearer = hypot(next.off_x, next.off_y) < hypot(s.off_x, s.off_y);
        if (!nearer) break;
        to.u = next_u;
        to.v = next_v;
        s = next;
        if (std::max(std::fabs(du), std::fabs(dv)) <= kLeastStep) break;
    }
    const double depth = m_camera.perspective() ? s.p.z : 1;
    if (!(depth > 0) || !(s.p.z >= m_camera.near()) || !is_single(s, u, v, to.u, to.v, around)) return to;
    to.nearness = m_camera.perspective() ? 1 / s.p.z : -s.p.z;
    // What the camera loses, and the surface: as of patches (facets.cpp), at a point.
    const auto largest = [](const glm::dvec3& a) {
        return std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)});
    };
    double turned = 0;
    for (int i = 0; i < 3; ++i)
        turned = std::max(turned, std::fabs(m_camera.matrix()[0][i]) + std::fabs(m_camera.matrix()[1][i]) +
                                      std::fabs(m_camera.matrix()[2][i]));
    const double lost = 2 * m_surface.rounding(to.u, to.v) * turned +
                        0x1p-50 * (largest(s.p) + 2 * largest(m_camera.offset()));
    const double slope = m_camera.perspective() ? hypot(s.p.x, s.p.y) / s.p.z : 0;
    if (!(lost < depth / 2)) return to;
    const double bound = hypot(s.off_x, s.off_y) + 4 * m_camera.focal() * lost * (1 + slope) / depth +
                         0x1p-50 * (std::fabs(x) + std::fabs(y));
    to.bound = std::isnan(bound) ? HUGE_VAL : bound;
    return to;
}

}  // namespace anamorph::surface
