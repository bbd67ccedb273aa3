// SPDX-License-Identifier: Apache-2.0
// A panorama thrown like a slide from its centre onto a scene (Kim 2003, chapter 4): where on the panorama is what a point
// of the scene receives. It is eq. 4.1 for cylindrical panoramas, and the same for every other projection and lens of chart/.
//
// The scene is in any unit, right-handed. The panorama's middle is thrown towards `direction`, with `up` upwards.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "anamorph/chart/chart.h"

namespace anamorph {

/// The position of a projector, and its orientation.
struct ProjectorPose {
    glm::dvec3 position{0.0};        ///< the centre of the panorama, in the scene
    glm::dvec3 direction{0, 0, -1};  ///< direction of the panorama's middle; any length
    glm::dvec3 up{0, 1, 0};          ///< not along the direction; need not be at right angles to it
};

/// The right, down and forward axes of a pose, in the scene, as columns: orthonormal to within a few roundings. Throws Error
/// where the position is not finite, where direction or up is 0 or not finite, and where they are parallel.
glm::dmat3 frame_of(const ProjectorPose& pose);

/// The kinds of what a point of the scene receives from a projector.
enum class Received {
    texel,         ///< a point of the panorama
    nothing,       ///< the direction of the point is not in the panorama
    no_direction,  ///< the point is the centre, not finite, or on the axis of a panorama that has no poles
};

/// A panorama and the pose of its projector.
class Projector {
  public:
    /// A panorama thrown from a pose. Throws what frame_of() throws.
    explicit Projector(const Chart& panorama, const ProjectorPose& pose = {});

    const Chart& panorama() const { return m_panorama; }
    const ProjectorPose& pose() const { return m_pose; }
    /// The axes of the pose, frame_of().
    const glm::dmat3& frame() const { return m_frame; }

    /// The ray from the centre to a point of the scene, in the frame of rays (chart/chart.h), in units of the scene.
    glm::dvec3 ray(const glm::dvec3& point) const { return (point - m_pose.position) * m_frame; }

    /// A proven lower bound of the forward component z of the panorama's rays of length 1; -1 where none is known.
    double least_forward() const { return m_least_forward; }

    /// Finds what a point of the scene receives. `texel`, in pixels of the panorama, x right and y down, is set where the
    /// result is Received::texel.
    Received receive(const glm::dvec3& point, Point<double>& texel) const;

  private:
    Chart m_panorama;
    ProjectorPose m_pose;
    glm::dmat3 m_frame;
    double m_least_forward = -1;
};

/// A ray scaled by a power of 2 to a length from 1 to 4, so that projections do not overflow; 0 where it has no direction.
glm::dvec3 scaled_ray(const glm::dvec3& ray);

}  // namespace anamorph
