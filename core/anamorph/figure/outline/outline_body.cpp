// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/outline_body.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anamorph/parameter/parameter.h"

namespace anamorph::figure {
namespace {

using Real = long double;
using Vector = glm::vec<3, Real>;
using Matrix = glm::mat<3, 3, Real>;

// The squares of squares that the search for roots takes stay finite.
constexpr double kLargest = 1e25;
// Half-axes below are zero: nothing of a scene within kLargest shows them.
constexpr double kLeastAxis = 1e-30;
// A limb that is so much narrower on the screen than long has no area.
constexpr Real kFlat = 1e-13L;

bool within(const glm::dvec3& v) {
    return std::fabs(v.x) <= kLargest && std::fabs(v.y) <= kLargest && std::fabs(v.z) <= kLargest;
}

std::string text_of(const glm::dvec3& v) {
    return shortest(v.x) + "," + shortest(v.y) + "," + shortest(v.z);
}

bool orthonormal(const glm::dmat3& m) {
    constexpr double slack = 1e-6;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j <= i; ++j)
            if (!(std::fabs(glm::dot(m[i], m[j]) - (i == j)) <= slack)) return false;
    return true;
}

std::string columns_of(const glm::dmat3& m) {
    return text_of(m[0]) + "," + text_of(m[1]) + "," + text_of(m[2]);
}

/// The rows of m^-1, as columns.
Matrix inverse_rows(const Matrix& m) {
    const Vector r0 = glm::cross(m[1], m[2]), r1 = glm::cross(m[2], m[0]), r2 = glm::cross(m[0], m[1]);
    const Real det = glm::dot(m[0], r0);
    return {r0 / det, r1 / det, r2 / det};
}

/// The limb in the coordinates u of the unit sphere: the circle center + radius (f cos t + g sin t).
struct UnitLimb {
    Vector center{Real{0}}, f{Real{0}}, g{Real{0}};
    Real radius = 0;
    bool around_eye = false;
};

/// `toward` is the eye in the body's own axes (perspective), or the direction to it. With e = toward / axes,
/// view rays touch the unit sphere where u.e = 1, or 0. Where axes are zero, the limit of small equal ones.
UnitLimb unit_limb(const Vector& axes, const Vector& toward, bool perspective) {
    Vector e{Real{0}};
    bool infinite = false;
    for (int k = 0; k < 3; ++k) infinite = infinite || (axes[k] == 0 && toward[k] != 0);
    for (int k = 0; k < 3; ++k)
        e[k] = infinite ? (axes[k] == 0 ? toward[k] : 0) : axes[k] == 0 ? 0 : toward[k] / axes[k];
    const Real length = glm::length(e);
    UnitLimb limb;
    limb.around_eye = perspective && !infinite && length <= 1;
    if (limb.around_eye) return limb;
    const Vector n = e / length;
    const Real height = perspective && !infinite ? 1 / length : 0;
    limb.center = n * height;
    limb.radius = std::sqrt((1 - height) * (1 + height));
    int least = 0;
    for (int k = 1; k < 3; ++k)
        if (std::fabs(n[k]) < std::fabs(n[least])) least = k;
    Vector axis{Real{0}};
    axis[least] = 1;
    limb.f = glm::normalize(axis - n * n[least]);
    limb.g = glm::cross(n, limb.f);
    return limb;
}

/// Turns two conjugate half-axes until their projections across `ray`, a unit vector, are orthogonal: then
/// neither loses digits to the other where the ellipse is narrow.
void make_principal(Vector& f, Vector& g, Vector& f_scene, Vector& g_scene, const Vector& ray) {
    const Vector p = f - ray * glm::dot(f, ray), q = g - ray * glm::dot(g, ray);
    const Real c2 = glm::dot(p - q, p + q), s2 = 2 * glm::dot(p, q), size = std::hypot(c2, s2);
    if (!(size > 0)) return;
    // Half the angle of (c2, s2).
    Real c, s;
    if (c2 >= 0) {
        c = std::sqrt(0.5L * (1 + c2 / size));
        s = 0.5L * s2 / size / c;
    } else {
        s = std::sqrt(0.5L * (1 - c2 / size));
        c = 0.5L * s2 / size / s;
    }
    const auto turn = [&](Vector& a, Vector& b) {
        const Vector first = a * c + b * s;
        b = b * c - a * s;
        a = first;
    };
    turn(f, g);
    turn(f_scene, g_scene);
}

void set_cone(SeenBody& body, const Vector& c, const Vector& f, const Vector& g, bool perspective) {
    const Vector ray = perspective ? c : Vector(0, 0, 1);
    const Vector unit_ray = glm::normalize(ray);
    const Real wide = glm::length(glm::cross(f, unit_ray)), narrow = glm::length(glm::cross(g, unit_ray));
    const Vector normal = glm::cross(f, g);
    const Real volume = glm::dot(normal, ray);
    if (!(std::min(wide, narrow) > kFlat * std::max(wide, narrow)) || volume == 0) return;
    body.covers = true;
    body.x_row = glm::cross(g, ray) / volume;
    body.y_row = glm::cross(ray, f) / volume;
    body.beyond = normal / volume;
    body.beyond_size = glm::length(body.beyond);
    body.cone_size = glm::length(body.x_row) + glm::length(body.y_row) + body.beyond_size;
}

double amplitude(double a, double b) {
    return std::sqrt(a * a + b * b);
}

/// Box of the limb's image at distance 1 from the eye; everything, if part of the limb is behind the eye.
void set_box(SeenBody& body, bool perspective) {
    const Ellipse<glm::dvec3>& e = body.viewed;
    const double depth_reach = amplitude(e.cosine.z, e.sine.z);
    body.limb_farthest = e.center.z + depth_reach;
    for (int k = 0; k < 2; ++k) {
        const double half = amplitude(e.cosine[k], e.sine[k]);
        body.low[k] = e.center[k] - half;
        body.high[k] = e.center[k] + half;
        if (!perspective) continue;
        if (e.center.z - depth_reach <= 0) {
            body.low[k] = -HUGE_VAL;
            body.high[k] = HUGE_VAL;
            continue;
        }
        // The slopes m at which x - m z, which is (c - m w) + ..., touches zero: a quadratic.
        const double w = e.center.z, wc = e.cosine.z, ws = e.sine.z;
        const double a = w * w - wc * wc - ws * ws;
        const double b = e.center[k] * w - e.cosine[k] * wc - e.sine[k] * ws;
        const double c = e.center[k] * e.center[k] - half * half;
        // Not less than it is for all rounding.
        const double root = std::sqrt(std::max(0.0, b * b - a * c) + 0x1p-46 * (b * b + std::fabs(a * c)));
        body.low[k] = (b - root) / a;
        body.high[k] = (b + root) / a;
    }
}

}  // namespace

void check(const View& view) {
    const auto demand = [](bool holds, const char* name, const std::string& value, const char* rule) {
        if (!holds) throw Error(name, value, std::string("must be ") + rule);
    };
    demand(orthonormal(view.rotation), "rotation", columns_of(view.rotation), "an orthonormal matrix");
    demand(within(view.center), "center", text_of(view.center), "numbers up to 1e25");
    demand(within({view.middle, 0}), "middle", text_of({view.middle, 0}), "numbers up to 1e25");
    demand(view.scale > 0 && view.scale <= kLargest, "scale", shortest(view.scale), "a positive number");
    demand(view.eye_distance > 0 && (view.eye_distance <= kLargest || !view.perspective()), "eye_distance",
           shortest(view.eye_distance), "a positive number, or infinity");
    demand(view.near > 0 && view.near <= kLargest, "near", shortest(view.near), "a positive number");
}

void check(const Ellipsoid& body, std::size_t position, const std::vector<std::string>& names) {
    const auto fail = [&](const char* what, const std::string& value, const char* rule) {
        const std::string name = position < names.size() ? names[position] : std::to_string(position);
        throw Error("body " + printable(name) + " " + what, value, std::string("must be ") + rule);
    };
    if (!within(body.center)) fail("center", text_of(body.center), "finite numbers up to 1e25");
    if (!within(body.axes)) fail("axes", text_of(body.axes), "finite numbers up to 1e25");
    if (!orthonormal(body.rotation)) fail("rotation", columns_of(body.rotation), "an orthonormal matrix");
}

void check_point(const std::string& name, const glm::dvec3& point) {
    if (!within(point)) throw Error(name, text_of(point), "must be finite numbers up to 1e25");
}

SeenBody see(const Ellipsoid& shape, const View& view) {
    const bool perspective = view.perspective();
    const Matrix turn(view.rotation), own = turn * Matrix(shape.rotation), own_rows = inverse_rows(own);
    const Vector center = turn * (Vector(shape.center) - Vector(view.center)) +
                          Vector(0, 0, perspective ? view.eye_distance : 0);
    Vector axes{Real{0}};
    for (int k = 0; k < 3; ++k)
        if (const double a = std::fabs(shape.axes[k]); a >= kLeastAxis) axes[k] = a;

    SeenBody body;
    body.center = center;
    body.solid = axes.x > 0 && axes.y > 0 && axes.z > 0;
    for (int k = 0; body.solid && k < 3; ++k) {
        body.unit[k] = own_rows[k] / axes[k];
        body.unit_size += glm::length(body.unit[k]);
    }
    Real depth = 0;
    for (int k = 0; k < 3; ++k) depth = std::hypot(depth, own[k].z * axes[k]);
    body.nearest = static_cast<double>(center.z - depth);

    const Vector eye = perspective ? -center : Vector(0, 0, -1);
    const UnitLimb unit =
        unit_limb(axes, {glm::dot(own_rows[0], eye), glm::dot(own_rows[1], eye), glm::dot(own_rows[2], eye)},
                  perspective);
    if (unit.around_eye) {
        body.kind = OutlineKind::around_eye;
        body.low = glm::dvec2(-HUGE_VAL);
        body.high = glm::dvec2(HUGE_VAL);
        return body;
    }
    const Vector f_unit = axes * unit.f * unit.radius, g_unit = axes * unit.g * unit.radius;
    const Vector c = center + own * (axes * unit.center);
    Vector f = own * f_unit, g = own * g_unit;
    const Matrix in_scene(shape.rotation);
    Vector f_scene = in_scene * f_unit, g_scene = in_scene * g_unit;
    make_principal(f, g, f_scene, g_scene, perspective ? glm::normalize(c) : Vector(0, 0, 1));
    body.limb = {Vector(shape.center) + in_scene * (axes * unit.center), f_scene, g_scene};
    body.viewed = {c, f, g};
    set_cone(body, c, f, g, perspective);
    set_box(body, perspective);
    body.reach =
        glm::length(body.viewed.center) + glm::length(body.viewed.cosine) + glm::length(body.viewed.sine);
    if (perspective) {
        const double half = amplitude(body.viewed.cosine.z, body.viewed.sine.z),
                     middle = body.viewed.center.z;
        if (middle + half < view.near)
            body.kind = OutlineKind::behind;
        else if (middle - half < view.near)
            body.kind = OutlineKind::cut;
    }
    return body;
}

std::vector<SeenBody> see_all(std::span<const Ellipsoid> bodies, const View& view,
                              const std::vector<std::string>& names, const ParallelFor& parallel_for) {
    check(view);
    for (std::size_t i = 0; i < bodies.size(); ++i) check(bodies[i], i, names);
    std::vector<SeenBody> seen(bodies.size());
    constexpr std::size_t batch = 64;
    parallel_for(static_cast<std::int64_t>((bodies.size() + batch - 1) / batch), [&](std::int64_t k) {
        const std::size_t first = static_cast<std::size_t>(k) * batch;
        for (std::size_t i = first; i < std::min(first + batch, bodies.size()); ++i)
            seen[i] = see(bodies[i], view);
    });
    return seen;
}

}  // namespace anamorph::figure
