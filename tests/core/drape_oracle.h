// SPDX-License-Identifier: Apache-2.0
// Surfaces and a camera, written out in long double for tests: shares no formula with the core.
#pragma once

#include <array>
#include <cmath>
#include <string>

#include "anamorph/surface/camera.h"
#include "anamorph/surface/surface.h"

namespace anamorph::test {

using Real = long double;
using Vector = std::array<Real, 3>;

inline const Real kHalfTurn = std::acos(Real(-1));

/// A point of a surface by its name.
inline Vector oracle_surface(const std::string& name, const surface::SurfaceShape& s, Real u, Real v) {
    const Real x = s.aspect * u - s.aspect / Real(2), y = Real(1) / 2 - v, degrees = kHalfTurn / 180;
    const Real east = s.angle * degrees * u - s.angle * degrees / 2;
    if (name == "plane") return {x, y, 0};
    if (name == "toy_saddle") return {x, y, (x - y) * (x + y) / 2};
    if (name == "cylinder") {
        const Real radius = s.radius > 0 ? Real(s.radius) : s.aspect / (s.angle * degrees);
        return {radius * std::sin(east), y, radius * std::cos(east)};
    }
    const Real radius = s.radius > 0 ? Real(s.radius) : Real(1) / 2;
    if (name == "sphere") {
        const Real down = v * kHalfTurn;  // from the north pole
        return {radius * std::sin(down) * std::sin(east), radius * std::cos(down),
                radius * std::sin(down) * std::cos(east)};
    }
    if (name == "torus") {
        const Real round = v * 2 * kHalfTurn, out = radius - s.tube * std::cos(round);
        return {out * std::sin(east), s.tube * std::sin(round), out * std::cos(east)};
    }
    const Real across = std::cos(s.direction * degrees), up = std::sin(s.direction * degrees);
    const Real along = across * x + up * y;
    if (name == "page_turn") {
        const Real r = s.radius > 0 ? Real(s.radius) : Real(0.1);
        const Real corner = (std::fabs(across) * s.aspect + std::fabs(up)) / 2,
                   line = corner * (1 - 2 * Real(s.turn));
        const Real rolled = along - line;
        if (rolled <= 0) return {x, y, 0};
        Real to = line - (rolled - kHalfTurn * r), height = 2 * r;
        if (rolled < kHalfTurn * r) {
            to = line + r * std::sin(rolled / r);
            height = r - r * std::cos(rolled / r);
        }
        return {x + (to - along) * across, y + (to - along) * up, height};
    }
    const Real waves = 2 * kHalfTurn / s.wavelength, phase = 2 * kHalfTurn * s.phase;
    if (name == "waves") return {x, y, s.amplitude * std::sin(waves * along - phase)};
    const Real round = std::hypot(std::hypot(x, y), Real(s.wavelength) / 8);
    return {x, y, s.amplitude * std::sin(waves * round - phase)};
}

/// The place where a camera sees a point, in pixels from the corner of the screen, and the depth ahead.
struct OracleSight {
    Real x, y, ahead;
};
inline OracleSight oracle_sight(const surface::CameraPose& pose, const Size& screen, const Vector& p) {
    const auto sub = [](const glm::dvec3& a, const glm::dvec3& b) {
        return Vector{Real(a.x) - b.x, Real(a.y) - b.y, Real(a.z) - b.z};
    };
    const auto dot = [](const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    const auto cross = [](const Vector& a, const Vector& b) {
        return Vector{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const auto unit = [&](const Vector& a) {
        const Real size = std::sqrt(dot(a, a));
        return Vector{a[0] / size, a[1] / size, a[2] / size};
    };
    const Vector view = unit(sub(pose.target, pose.position)),
                 right = unit(cross(view, {pose.up.x, pose.up.y, pose.up.z})), up = cross(right, view),
                 from = {p[0] - pose.position.x, p[1] - pose.position.y, p[2] - pose.position.z};
    const Real ahead = dot(from, view), half = screen.width / Real(2);
    const Real scale = pose.perspective ? half / std::tan(pose.fov * kHalfTurn / 360) / ahead
                                        : screen.width / Real(pose.extent);
    return {half + dot(from, right) * scale, screen.height / Real(2) - dot(from, up) * scale, ahead};
}

}  // namespace anamorph::test
