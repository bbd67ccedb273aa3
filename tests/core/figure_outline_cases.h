// SPDX-License-Identifier: Apache-2.0
// Seeded scenes of ellipsoids, and what is true of them: visibility by intersecting view rays with ellipsoids
// in long double, which shares nothing with the outlines' arcs.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <random>
#include <vector>

#include "anamorph/figure/outline/outline.h"

namespace anamorph::test {

struct OutlineScene {
    std::vector<figure::Ellipsoid> bodies;
    figure::View view;
};

enum class Family { small, large, needle, tangent };
inline constexpr Family kFamilies[] = {Family::small, Family::large, Family::needle, Family::tangent};
inline const char* name_of(Family f) {
    const char* names[] = {"small", "large", "needle", "tangent"};
    return names[static_cast<int>(f)];
}

class SceneMaker {
  public:
    explicit SceneMaker(std::uint64_t seed) : m_random(seed) {}

    double between(double low, double high) {
        return low + (high - low) * (static_cast<double>(m_random() >> 11) * 0x1p-53);
    }
    int whole(int low, int high) {
        return low + static_cast<int>(m_random() % static_cast<std::uint64_t>(high - low + 1));
    }
    glm::dvec3 point(double reach) {
        return {between(-reach, reach), between(-reach, reach), between(-reach, reach)};
    }
    glm::dvec3 direction() {
        glm::dvec3 d;
        do d = point(1);
        while (glm::dot(d, d) > 1 || glm::dot(d, d) < 1e-4);
        return glm::normalize(d);
    }
    glm::dmat3 rotation() {
        const glm::dvec3 a = direction(), b = glm::normalize(glm::cross(a, direction()));
        return {a, b, glm::cross(a, b)};
    }
    figure::Ellipsoid body(double reach, double least, double most) {
        return {point(reach), {between(least, most), between(least, most), between(least, most)}, rotation()};
    }

    figure::View view(bool perspective) {
        figure::View v;
        v.rotation = rotation();
        if (whole(0, 3) == 0) v.rotation[0] = -v.rotation[0];
        v.center = point(20);
        v.middle = {500, 500};
        v.scale = between(0.5, 2);
        if (perspective) {
            v.eye_distance = between(600, 3000);
            v.near = 1;
        }
        return v;
    }

    OutlineScene scene(Family family, bool perspective) {
        OutlineScene s;
        s.view = view(perspective);
        switch (family) {
            case Family::small:
                for (int i = whole(6, 16); i > 0; --i) s.bodies.push_back(body(100, 4, 40));
                break;
            case Family::large:
                for (int i = whole(2, 8); i > 0; --i) s.bodies.push_back(body(100, 40, 160));
                break;
            case Family::needle:
                for (int i = whole(3, 8); i > 0; --i) {
                    figure::Ellipsoid e = body(60, 20, 100);
                    const int k = whole(0, 2);
                    const double thin = std::pow(10, -between(1, 6));
                    if (whole(0, 1))
                        e.axes[k] *= thin;  // a flake
                    else
                        e.axes[(k + 1) % 3] *= thin, e.axes[(k + 2) % 3] *= thin;
                    s.bodies.push_back(e);
                }
                break;
            case Family::tangent:
                s.bodies.push_back(body(60, 20, 100));
                for (int i = whole(2, 5); i > 0; --i)
                    s.bodies.push_back(touching(
                        s.bodies[static_cast<std::size_t>(whole(0, static_cast<int>(s.bodies.size()) - 1))],
                        s.view));
        }
        return s;
    }

    /// Makes a body that touches another: from outside or inside, on the surface or in the view, or along a
    /// curve.
    figure::Ellipsoid touching(const figure::Ellipsoid& e, const figure::View& view) {
        const glm::dvec3 u = direction(), at = e.center + e.rotation * (e.axes * u),
                         normal = glm::normalize(e.rotation * (u / e.axes));
        switch (whole(0, 5)) {
            case 0: {  // outside, at a point
                figure::Ellipsoid t = body(0, 20, 80);
                t.center = at + support(t, -normal) * -1.0;
                return t;
            }
            case 1: {  // inside, at a point: shrunk about it
                figure::Ellipsoid t = e;
                const double k = between(0.2, 0.9);
                t.axes *= k;
                t.center = at + (e.center - at) * k;
                return t;
            }
            case 2: {  // outside in the view: the limbs' images touch in parallel projection
                const glm::dvec3 d = glm::transpose(view.rotation) *
                                     glm::dvec3(glm::normalize(glm::dvec2(u) + glm::dvec2(1e-3, 0)), 0);
                figure::Ellipsoid t = body(0, 20, 80);
                t.center = e.center + support(e, d) + support(t, d) +
                           glm::transpose(view.rotation) * glm::dvec3(0, 0, between(-90, 90));
                return t;
            }
            case 3: {  // about the same centre, along an axis or two
                figure::Ellipsoid t = e;
                t.axes[whole(0, 2)] *= between(0.3, 2);
                if (whole(0, 1)) t.axes[whole(0, 2)] *= between(0.3, 2);
                return t;
            }
            case 4: {  // equal, other axes first
                figure::Ellipsoid t = e;
                t.axes = {e.axes.y, e.axes.z, e.axes.x};
                t.rotation = {e.rotation[1], e.rotation[2], e.rotation[0]};
                return t;
            }
            default: {  // moved along the view
                figure::Ellipsoid t = e;
                t.center += glm::transpose(view.rotation) * glm::dvec3(0, 0, between(-90, 90));
                return t;
            }
        }
    }

    /// The vector from the centre to the surface point with normal `d`.
    static glm::dvec3 support(const figure::Ellipsoid& e, const glm::dvec3& d) {
        const glm::dvec3 along = e.axes * (glm::transpose(e.rotation) * d);
        return e.rotation * (e.axes * along / glm::length(along));
    }

  private:
    std::mt19937_64 m_random;
};

// --- the truth

using Real = long double;
using Vec = glm::vec<3, Real>;
using Mat = glm::mat<3, 3, Real>;

inline Vec eye_of(const figure::View& view) {
    const Mat to_scene = glm::inverse(Mat(view.rotation));
    return Vec(view.center) - to_scene * Vec(0, 0, view.eye_distance);
}
/// The direction from the observer through p.
inline Vec ray_through(const figure::View& view, const Vec& p) {
    if (view.perspective()) return p - eye_of(view);
    return glm::inverse(Mat(view.rotation)) * Vec(0, 0, 1);
}

/// A vector on the unit sphere of a body: R^-1 v / axes; axes may be zero only where v has no part along
/// them.
inline Vec to_unit(const figure::Ellipsoid& e, const Vec& v) {
    const Vec own = glm::inverse(Mat(e.rotation)) * v;
    return own / Vec(std::fabs(e.axes.x), std::fabs(e.axes.y), std::fabs(e.axes.z));
}

/// Does the view ray meet the body's surface between the eye and p?
inline bool hides(const figure::Ellipsoid& e, const figure::View& view, const Vec& p) {
    const Vec ray = ray_through(view, p);
    int flat = -1, flats = 0;
    for (int k = 0; k < 3; ++k)
        if (e.axes[k] == 0) flat = k, ++flats;
    if (flats > 1) return false;
    // p + s ray, in perspective from s = -1 on.
    const Real first = view.perspective() ? -1 : -HUGE_VALL;
    if (flats == 1) {
        const Mat own = glm::inverse(Mat(e.rotation));
        const Vec from = own * (p - Vec(e.center)), step = own * ray;
        if (step[flat] == 0) return false;
        const Real s = -from[flat] / step[flat];
        Real square = 0;
        for (int k = 0; k < 3; ++k)
            if (k != flat) square += std::pow((from[k] + s * step[k]) / Real(e.axes[k]), Real(2));
        return s > first && s < 0 && square < 1;
    }
    const Vec u = to_unit(e, p - Vec(e.center)), v = to_unit(e, ray);
    const Real a = glm::dot(v, v), b = glm::dot(u, v), c = (glm::length(u) - 1) * (glm::length(u) + 1);
    const Vec across = glm::cross(u, v);
    const Real discriminant = a - glm::dot(across, across);
    if (!(discriminant > 0)) return false;
    const Real q = -(b + std::copysign(std::sqrt(discriminant), b));
    const Real roots[] = {q / a, c / q};
    return std::any_of(roots, roots + 2, [&](Real s) { return s > first && s < 0; });
}

inline bool is_hidden(const OutlineScene& scene, std::size_t body, const Vec& p) {
    for (std::size_t j = 0; j < scene.bodies.size(); ++j)
        if (j != body && hides(scene.bodies[j], scene.view, p)) return true;
    return false;
}

inline double size_of(const figure::Ellipsoid& e) {
    return std::max({std::fabs(e.axes.x), std::fabs(e.axes.y), std::fabs(e.axes.z)});
}

/// The distance of p from the limb of a solid body, relative to the body's size: to the point of the limb
/// that is nearest in the unit sphere.
inline double limb_distance(const figure::Ellipsoid& e, const figure::View& view, const Vec& p) {
    const Vec toward = view.perspective() ? eye_of(view) - Vec(e.center) : -ray_through(view, p);
    const Vec pole = to_unit(e, toward);
    const Real height = view.perspective() ? 1 / glm::length(pole) : 0;
    const Vec n = glm::normalize(pole);
    Vec u = to_unit(e, p - Vec(e.center));
    u -= n * glm::dot(u, n);
    u = glm::normalize(u) * std::sqrt((1 - height) * (1 + height)) + n * height;
    const Vec nearest = Vec(e.center) + Mat(e.rotation) * (Vec(e.axes) * u);
    return static_cast<double>(glm::length(nearest - p)) / size_of(e);
}

struct OutlineFindings {
    std::int64_t samples = 0, hidden = 0, wrong = 0;
    std::int64_t near = 0;     ///< differing samples within 1e-6 of a crossing along the limb
    std::int64_t grazing = 0;  ///< differing samples whose truth a move by 1e-9 of the body's size changes
    double worst_limb = 0;
    std::int64_t gaps = 0;  ///< outlines whose arcs do not make up the circle

    void add(const OutlineFindings& f) {
        samples += f.samples;
        hidden += f.hidden;
        wrong += f.wrong;
        near += f.near;
        grazing += f.grazing;
        gaps += f.gaps;
        worst_limb = std::max(worst_limb, f.worst_limb);
    }
};

inline bool in_arcs(const std::vector<figure::Arc>& arcs, double t) {
    constexpr double turn = 2 * std::numbers::pi;
    return std::any_of(arcs.begin(), arcs.end(), [&](const figure::Arc& a) {
        return (t >= a.begin && t <= a.end) || (t + turn >= a.begin && t + turn <= a.end);
    });
}

/// May the truth about the sample be either?
inline bool is_excused(const OutlineScene& scene, std::size_t i, const figure::Outline& outline, double t,
                       bool truth, OutlineFindings& found) {
    for (const double step : {-1e-6, 1e-6, -5e-7, 5e-7})
        if (is_hidden(scene, i, Vec(outline.limb(t + step))) != truth) return ++found.near, true;
    const Real move = 1e-9L * size_of(scene.bodies[i]);
    for (int k = 0; k < 27; ++k) {
        const Vec by(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
        if (is_hidden(scene, i, Vec(outline.limb(t)) + by * move) != truth) return ++found.grazing, true;
    }
    return false;
}

/// Compares the arcs of outlines with the truth, at even angles and on both sides of the arcs' ends.
inline OutlineFindings examine(const OutlineScene& scene, const figure::Outlines& outlines, int samples) {
    constexpr double turn = 2 * std::numbers::pi;
    OutlineFindings found;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const figure::Outline& outline = outlines.bodies[i];
        double covered = 0;
        for (const auto* arcs : {&outline.visible, &outline.hidden})
            for (const figure::Arc& a : *arcs) covered += a.length();
        if (outline.kind == figure::OutlineKind::whole && std::fabs(covered - turn) > 1e-12) ++found.gaps;
        std::vector<double> angles;
        for (int k = 0; k < samples; ++k) angles.push_back(turn * (k + 0.37) / samples);
        for (const auto* arcs : {&outline.visible, &outline.hidden})
            for (const figure::Arc& a : *arcs)
                for (const double step : {-1e-5, -1.5e-6, 1.5e-6, 1e-5}) {
                    angles.push_back(std::fmod(a.begin + step + turn, turn));
                    angles.push_back(std::fmod(a.end + step + turn, turn));
                }
        for (const double t : angles) {
            const bool visible = in_arcs(outline.visible, t), hidden = in_arcs(outline.hidden, t);
            if (!visible && !hidden) continue;
            const Vec p(outline.limb(t));
            ++found.samples;
            found.hidden += hidden;
            if (scene.bodies[i].axes.x * scene.bodies[i].axes.y * scene.bodies[i].axes.z != 0)
                found.worst_limb = std::max(found.worst_limb, limb_distance(scene.bodies[i], scene.view, p));
            const bool truth = is_hidden(scene, i, p);
            if (truth != hidden && !is_excused(scene, i, outline, t, truth, found)) ++found.wrong;
        }
    }
    return found;
}

}  // namespace anamorph::test
