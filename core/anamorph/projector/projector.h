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

/// Where a projector stands, and how it is turned.
struct ProjectorPose {
    glm::dvec3 position{0.0};        ///< the centre of the panorama, in the scene
    glm::dvec3 direction{0, 0, -1};  ///< of the panorama's middle; any length
    glm::dvec3 up{0, 1, 0};          ///< not along the direction; need not be at right angles to it
};

/// Right, down and forward of a pose, in the scene, as columns: within a few roundings at right angles, of length 1. Throws
/// Error: a position that is not finite, a direction or an up that is none, or the one along the other.
glm::dmat3 frame_of(const ProjectorPose& pose);

/// What a point of the scene receives.
enum class Received {
    texel,         ///< a point of the panorama
    nothing,       ///< its direction is not in the panorama
    no_direction,  ///< it is the centre, not finite, or on the axis of a panorama that has no poles
};

/// A panorama and its projector.
class Projector {
  public:
    /// A panorama thrown from a pose. Throws what frame_of() throws.
    explicit Projector(const Chart& panorama, const ProjectorPose& pose = {});

    const Chart& panorama() const { return m_panorama; }
    const ProjectorPose& pose() const { return m_pose; }
    /// frame_of() the pose.
    const glm::dmat3& frame() const { return m_frame; }

    /// The ray from the centre to a point of the scene, in the frame of rays (chart/chart.h), in units of the scene.
    glm::dvec3 ray(const glm::dvec3& point) const { return (point - m_pose.position) * m_frame; }

    /// No ray of the panorama has a smaller part forward, relative to its length: a proven bound, -1 where none is known.
    double least_forward() const { return m_least_forward; }

    /// What a point receives. `texel`, in pixels of the panorama, x right and y down, is set where it is one.
    Received receive(const glm::dvec3& point, Point<double>& texel) const;

  private:
    Chart m_panorama;
    ProjectorPose m_pose;
    glm::dmat3 m_frame;
    double m_least_forward = -1;
};

/// A ray times a power of 2, of a length from 1 to 4, as projections read it without overflow; without a direction, 0.
glm::dvec3 scaled_ray(const glm::dvec3& ray);

}  // namespace anamorph
