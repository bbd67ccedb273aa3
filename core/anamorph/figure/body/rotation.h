// SPDX-License-Identifier: Apache-2.0
// The angles by which NUDES names a turn: (a1, a2, a3) in degrees turns by a3 about the axis
// u = (cos a1 cos a2, sin a1 cos a2, sin a2), as R = c I + (1 - c) u u^T - s [u]x; the minus makes it the
// transpose of the textbook's matrix. Matrices act on columns.
#pragma once

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <numbers>

#include "anamorph/number/hypot.h"

namespace anamorph::figure {

inline constexpr double kRadiansPerDegree = std::numbers::pi / 180, kTurn = 2 * std::numbers::pi;

/// An angle in radians, less whole turns: from 0 up to a whole turn.
inline double in_turn(double angle) {
    angle -= kTurn * std::floor(angle / kTurn);
    return angle < kTurn ? angle : 0;
}

/// The turn by `angle` degrees about a unit axis; textbook sign: about x it takes y towards z.
inline glm::dquat turn_about(const glm::dvec3& axis, double angle) {
    const double half = 0.5 * kRadiansPerDegree * angle;
    return glm::dquat(std::cos(half), std::sin(half) * axis);
}

inline glm::dquat turn_of_angles(const glm::dvec3& angles) {
    const double a1 = kRadiansPerDegree * angles.x, a2 = kRadiansPerDegree * angles.y;
    return turn_about({std::cos(a1) * std::cos(a2), std::sin(a1) * std::cos(a2), std::sin(a2)}, -angles.z);
}

/// The angles of a turn: a1 and a2 from 0 up to 360, a3 from 0 to 180; 0 0 0 for none.
inline glm::dvec3 angles_of_turn(const glm::dquat& q) {
    const glm::dvec3 v = (q.w < 0 ? 1.0 : -1.0) * glm::dvec3(q.x, q.y, q.z);
    const double sine = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    const double a3 = 2 * std::atan2(sine, std::abs(q.w)) / kRadiansPerDegree;
    // What is rounding error does not turn: no axis, or one along z, whose first angle is 0.
    if (!(sine > 1e-15)) return glm::dvec3(0.0);
    const double level = hypot(v.x, v.y);
    double a1 = level > 1e-14 * sine ? std::atan2(v.y, v.x) / kRadiansPerDegree : 0.0;
    double a2 = std::atan2(v.z, level) / kRadiansPerDegree;
    if (a1 < 0) a1 += 360;
    if (a2 < 0) a2 += 360;
    return {a1, a2, a3};
}

inline glm::dvec3 angles_of_rotation(const glm::dmat3& rotation) {
    return angles_of_turn(glm::quat_cast(rotation));
}

/// The turn Rx Ry Rz by angles in degrees, as `observe` turns.
inline glm::dquat turn_xyz(const glm::dvec3& angles) {
    return turn_about({1, 0, 0}, angles.x) * turn_about({0, 1, 0}, angles.y) *
           turn_about({0, 0, 1}, angles.z);
}

/// The angles x, z in (-180, 180] and y in [-90, 90] with Rx Ry Rz = rotation.
inline glm::dvec3 xyz_of_rotation(const glm::dmat3& r) {
    // Rx Ry Rz has (row, column): (0,0) = cy cz, (0,1) = -cy sz, (0,2) = sy, (1,2) = -sx cy, (2,2) = cx cy.
    const double cy = hypot(r[0][0], r[1][0]);
    const double y = std::atan2(r[2][0], cy);
    if (cy < 1e-9) return {std::atan2(r[1][2], r[1][1]) / kRadiansPerDegree, y / kRadiansPerDegree, 0.0};
    return glm::dvec3(std::atan2(-r[2][1], r[2][2]), y, std::atan2(-r[1][0], r[0][0])) / kRadiansPerDegree;
}

}  // namespace anamorph::figure
