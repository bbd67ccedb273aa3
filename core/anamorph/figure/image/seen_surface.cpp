// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/image/seen_surface.h"

#include <limits>

#include "anamorph/figure/outline/outline_body.h"
#include "anamorph/number/hypot.h"

namespace anamorph::figure {
namespace {

using Vector = glm::vec<3, long double>;

constexpr double kThinnestSeen = 1e-9;
constexpr int kFarOut = 1 << 30;

/// Axes f, g, n of the unit sphere's coordinates, n given.
glm::dmat3 frame_with_third(const Vector& n) {
    int least = 0;
    for (int k = 1; k < 3; ++k)
        if (std::fabs(n[k]) < std::fabs(n[least])) least = k;
    Vector axis{0.0L};
    axis[least] = 1;
    const Vector f = glm::normalize(axis - n * n[least]);
    return {glm::dvec3(f), glm::dvec3(glm::cross(n, f)), glm::dvec3(n)};
}

/// rows p, the body's own coordinates of p.
Vector in_unit(const glm::dmat3& rows, const Vector& p) {
    return {glm::dot(Vector(rows[0]), p), glm::dot(Vector(rows[1]), p), glm::dot(Vector(rows[2]), p)};
}

double part(const glm::dvec3& axis, const Vector& p) {
    return static_cast<double>(glm::dot(Vector(axis), p));
}

int pixel_of(double at) {
    return static_cast<int>(std::clamp(at, -double{kFarOut}, double{kFarOut}));
}

}  // namespace

SeenSurface::SeenSurface(Ellipsoid body, const View& view, double height)
    : m_perspective(view.perspective()) {
    body.axes = glm::abs(body.axes);
    const double longest = std::max({body.axes.x, body.axes.y, body.axes.z});
    body.axes = glm::max(body.axes, kThinnestSeen * longest);
    const SeenBody seen = see(body, view);
    // A body that is a point covers no pixel.
    if (!seen.solid) return;
    if (m_perspective) {
        // Of one whose limb is behind the near plane, the inside may be seen beyond that.
        const double farthest = 2 * seen.center.z - seen.nearest;
        if (farthest < view.near) return;
        m_near_limit = 1 / view.near;
        m_meets_near = !(seen.nearest >= view.near);
        m_nearest = m_meets_near ? m_near_limit : 1 / seen.nearest;
        set_perspective(seen.unit, seen.center, view, height);
    } else {
        m_nearest = -seen.nearest;
        set_parallel(seen.unit, seen.center, view, height);
    }
    const double root = std::sqrt(std::max(m_square, 0.0));
    const glm::dvec2 down(m_e1.x + m_e1.y, m_e2.x + m_e2.y), up(m_e1.x - m_e1.y, m_e2.x - m_e2.y);
    m_reach = 0.5 * root * std::max(glm::length(down), glm::length(up)) + m_w.over_half_pixel();
    if (seen.kind == OutlineKind::whole)
        set_box(seen.low, seen.high, view, height);
    else
        m_box = {-kFarOut, -kFarOut, kFarOut, kFarOut};
}

void SeenSurface::set_parallel(const glm::dmat3& rows, const glm::dvec3& center, const View& view,
                               double height) {
    m_at = view.middle + view.scale * glm::dvec2(center);
    m_at.y = height - m_at.y;
    const long double pixel = 1 / static_cast<long double>(view.scale);
    const Vector right = in_unit(rows, {pixel, 0, 0}), down = in_unit(rows, {0, -pixel, 0}),
                 away = in_unit(rows, {0, 0, 1});
    const long double steepness = glm::length(away);
    const glm::dmat3 frame = frame_with_third(away / steepness);
    m_e1 = {0, part(frame[0], right), part(frame[0], down)};
    m_e2 = {0, part(frame[1], right), part(frame[1], down)};
    m_w = {1, 0, 0};
    const auto unit = static_cast<double>(steepness);
    m_lean = {-center.z, part(frame[2], right) / unit, part(frame[2], down) / unit};
    m_bulge = 1 / unit;
    m_unit = frame;
    m_gradient = rows * frame;
}

void SeenSurface::set_perspective(const glm::dmat3& rows, const glm::dvec3& center, const View& view,
                                  double height) {
    const long double zoom = static_cast<long double>(view.scale) * view.eye_distance;
    // Relative to where the centre is seen, if it is: there e1 = e2 = 0.
    const bool ahead = center.z > 0 && glm::length(glm::dvec2(center)) < 1e3 * center.z;
    const Vector ray = ahead ? Vector(center) / static_cast<long double>(center.z) : Vector(0, 0, 1);
    m_at = view.middle + glm::dvec2(zoom * ray.x, zoom * ray.y);
    m_at.y = height - m_at.y;
    const Vector eye = in_unit(rows, Vector(center));
    const long double distance = glm::length(eye);
    const glm::dmat3 frame = frame_with_third(distance > 0 ? eye / distance : Vector(0, 0, 1));
    const Vector at = in_unit(rows, ray), right = in_unit(rows, {1 / zoom, 0, 0}),
                 down = in_unit(rows, {0, -1 / zoom, 0});
    const auto affine = [&](int k) {
        return AffineOfPixel{ahead && k < 2 ? 0 : part(frame[k], at), part(frame[k], right),
                             part(frame[k], down)};
    };
    m_e1 = affine(0), m_e2 = affine(1), m_w = affine(2);
    m_eye = static_cast<double>(distance);
    m_square = static_cast<double>((distance - 1) * (distance + 1));
    m_bulge = 1 / m_square;
    const double lean = m_eye / m_square;
    m_lean = {lean * m_w.c, lean * m_w.x, lean * m_w.y};
    m_unit = frame;
    m_gradient = rows * frame;
}

void SeenSurface::set_box(const glm::dvec2& low, const glm::dvec2& high, const View& view, double height) {
    const double zoom = m_perspective ? view.scale * view.eye_distance : view.scale;
    const glm::dvec2 from = view.middle + zoom * low, to = view.middle + zoom * high;
    m_box = {pixel_of(std::floor(from.x) - 1), pixel_of(std::floor(height - to.y) - 1),
             pixel_of(std::ceil(to.x) + 1), pixel_of(std::ceil(height - from.y) + 1)};
}

double SeenSurface::nearest_in_pixel(double x, double y) const {
    if (m_meets_near) return m_near_limit;
    const double dx = x - m_at.x, dy = y - m_at.y;
    // Over the pixel w is at most `w`, and sqrt(m) |(e1, e2)| at least `e`.
    const double w = m_w(dx, dy) + m_reach;
    const double e = std::max(0.0, std::sqrt(m_square) * hypot(m_e1(dx, dy), m_e2(dx, dy)) - m_reach);
    if (!(w >= e)) return -HUGE_VAL;
    return m_lean(dx, dy) + m_lean.over_half_pixel() + m_bulge * std::sqrt((w - e) * (w + e));
}

SeenSurface::Columns SeenSurface::columns(double y, int x0, int x1) const {
    x0 = std::max(x0, m_box.x0);
    x1 = std::min(x1, m_box.x1);
    if (m_meets_near) return {x0, x1};
    // Pixels that show the body have sqrt(m) |(e1, e2)| <= w + reach in their middle: a quadratic in x.
    const double dy = y - m_at.y, e1 = m_e1(0, dy), e2 = m_e2(0, dy), w = m_w(0, dy) + m_reach;
    const double a = m_square * (m_e1.x * m_e1.x + m_e2.x * m_e2.x) - m_w.x * m_w.x;
    const double b = m_square * (m_e1.x * e1 + m_e2.x * e2) - m_w.x * w;
    const double c = m_square * (e1 * e1 + e2 * e2) - w * w;
    if (!(a > 0)) return {x0, x1};
    const double square = b * b - a * c, slack = 1e-12 * (b * b + std::fabs(a * c));
    if (square < -slack) return {x0, x0};
    // A pixel more at either end than rounding can take.
    const double half = std::sqrt(std::max(square, 0.0) + slack) / a, middle = m_at.x - b / a;
    const double from = std::floor(middle - half) - 1, to = std::ceil(middle + half) + 1;
    if (!(from <= to)) return {x0, x1};
    return {std::max(x0, pixel_of(from)), std::min(x1, pixel_of(to))};
}

double SeenSurface::middle_of_row(double y) const {
    // There D, a quadratic in x, is greatest.
    const double dy = y - m_at.y;
    const double a = m_square * (m_e1.x * m_e1.x + m_e2.x * m_e2.x) - m_w.x * m_w.x;
    const double b = m_square * (m_e1.x * m_e1(0, dy) + m_e2.x * m_e2(0, dy)) - m_w.x * m_w(0, dy);
    const double middle = m_at.x - b / a;
    return std::isfinite(middle) ? std::clamp(middle, -double{kFarOut}, double{kFarOut}) : m_at.x;
}

/// What is beyond the near plane: the near side, or else the far side.
SurfaceHit SeenSurface::cut_hit(double x, double y) const {
    const double dx = x - m_at.x, dy = y - m_at.y, w = m_w(dx, dy), d = discriminant(dx, dy, w);
    const bool outside = m_square > 0;
    if (!(d >= 0) || (outside && !(w > 0))) return {};
    const double front = outside ? m_lean(dx, dy) + m_bulge * std::sqrt(d) : HUGE_VAL;
    if (front <= m_near_limit) return {front, false};
    const double back = far_side(dx, dy);
    if (back > 0 && back <= m_near_limit) return {back, true};
    return {};
}

/// 1 / depth of the far side, of a ray that meets the body. Of two equal forms the one that adds.
double SeenSurface::far_side(double dx, double dy) const {
    const double w = m_w(dx, dy), e1 = m_e1(dx, dy), e2 = m_e2(dx, dy);
    const double root = std::sqrt(std::max(0.0, discriminant(dx, dy, w)));
    if (w < 0) return (root - m_eye * w) / -m_square;
    return (e1 * e1 + e2 * e2 + w * w) / (m_eye * w + root);
}

}  // namespace anamorph::figure
