// SPDX-License-Identifier: Apache-2.0
// Stick figures: bodies as their longest axes, and from joint to joint.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "anamorph/figure/body/frame.h"

namespace anamorph::figure {

/// A straight line that stands for a body, or for part of one.
struct Stick {
    glm::dvec3 from{0.0}, to{0.0};  ///< in the scene
    int body = 0;                   ///< position of the body that the stick stands for
};

/// The longest axis of each body from end to end (the first of equal ones), in their order.
std::vector<Stick> axis_sticks(std::span<const Ellipsoid> bodies);
/// The longest axis of each body of a frame, in their order.
std::vector<Stick> axis_sticks(const FigureFrame& frame);

/// Sticks from joint to joint: for each body with joints, from its centre to each of them; a body with two joints has one stick
/// between them instead. Bodies without joints have none.
std::vector<Stick> joint_sticks(const FigureFrame& frame);

}  // namespace anamorph::figure
