// SPDX-License-Identifier: Apache-2.0
// The way from space to the pixels of a screen (Oka 1987, section 2: p).
#pragma once

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include "anamorph/geometry/point.h"
#include "anamorph/geometry/size.h"

namespace anamorph::surface {

/// The parameters of a camera.
struct CameraPose {
    glm::dvec3 position{0, 0, 2}, target{0.0}, up{0, 1, 0};
    bool perspective = true;
    double fov = 40;    ///< perspective: degrees, horizontal
    double extent = 1;  ///< parallel: width of the view in units of space
};

/// A camera in front of an object that is moved, p -> matrix p + offset, before it is seen. In the camera's frame x is
/// to the right, y down and z ahead, in units of space.
class Camera {
  public:
    /// `overscan`: the pixels of the screen on either side, across and down, that the pose's field of view does not count. Throws
    /// Error where the position is the target or `up` is parallel to the line between them.
    Camera(const CameraPose& pose, const glm::dmat3& matrix, const glm::dvec3& offset, const Size& screen,
           const Size& overscan = {});

    const Size& screen() const { return m_screen; }
    bool perspective() const { return m_perspective; }
    /// Pixels per unit of space, in perspective those at a distance of 1.
    double focal() const { return m_focal; }
    /// The distance of the near plane: points less far ahead are not seen.
    double near() const { return m_near; }

    /// The matrix from the object to the camera's frame.
    const glm::dmat3& matrix() const { return m_matrix; }
    const glm::dvec3& offset() const { return m_offset; }
    glm::dvec3 in_frame(const glm::dvec3& object) const { return m_matrix * object + m_offset; }
    /// A vector of the object, turned into the camera's frame.
    glm::dvec3 turned(const glm::dvec3& vector) const { return m_matrix * vector; }

    /// A direction of the camera's frame, in space.
    glm::dvec3 in_space(const glm::dvec3& direction) const { return glm::transpose(m_turn) * direction; }
    /// The way from the eye to a point of the camera's frame, of length 1.
    glm::dvec3 ray_to(const glm::dvec3& p) const {
        return m_perspective ? glm::normalize(p) : glm::dvec3(0, 0, 1);
    }

    /// The weight of a point when what is linear in space is interpolated on the screen: 1 over its depth, or 1.
    double weight(const glm::dvec3& p) const { return m_perspective ? 1 / p.z : 1; }
    /// The point on the screen of a point of the camera's frame, in pixels from the middle of the screen.
    Point<double> seen(const glm::dvec3& p) const {
        const double scale = m_focal * weight(p);
        return {p.x * scale, p.y * scale};
    }

  private:
    Size m_screen;
    bool m_perspective;
    double m_focal, m_near;
    glm::dmat3 m_turn, m_matrix;
    glm::dvec3 m_offset;
};

}  // namespace anamorph::surface
