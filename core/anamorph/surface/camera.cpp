// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/camera.h"

#include <cmath>
#include <limits>
#include <string>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/surface/shape/shape.h"

namespace anamorph::surface {
namespace {

std::string written(const glm::dvec3& p) {
    return shortest(p.x) + "," + shortest(p.y) + "," + shortest(p.z);
}

// In the camera's distance from its target: nearer things are not seen.
constexpr double kNear = 1e-3;

}  // namespace

Camera::Camera(const CameraPose& pose, const glm::dmat3& matrix, const glm::dvec3& offset, const Size& screen,
               const Size& overscan)
    : m_screen(screen), m_perspective(pose.perspective) {
    const glm::dvec3 ahead = pose.target - pose.position;
    const double distance = glm::length(ahead);
    if (!(distance > 0 && std::isfinite(distance)))
        throw Error("camera", written(pose.position), "must be away from the target, by a finite distance");
    const glm::dvec3 z = ahead / distance;
    const glm::dvec3 right = glm::cross(z, pose.up);
    const double sine = glm::length(right);
    if (pose.up == glm::dvec3(0.0))
        throw Error("up", written(pose.up), "must be a direction, other than 0,0,0");
    if (!(sine > 1e-9 * glm::length(pose.up)))
        throw Error("up", written(pose.up), "must not be parallel to the direction of view");
    const glm::dvec3 x = right / sine, y = glm::cross(z, x);
    // glm's matrices are given by columns: this one has x, y and z as its rows.
    m_turn = glm::dmat3(x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z);
    m_matrix = m_turn * matrix;
    m_offset = m_turn * (offset - pose.position);
    const int width = screen.width - 2 * overscan.width;
    m_focal = m_perspective ? width / (2 * std::tan(pose.fov * (kPi / 360))) : width / pose.extent;
    m_near = m_perspective ? kNear * distance : -std::numeric_limits<double>::infinity();
}

}  // namespace anamorph::surface
