// SPDX-License-Identifier: Apache-2.0
#include "anamorph/map/panorama.h"

#include <glm/trigonometric.hpp>

#include "anamorph/error.h"

namespace anamorph {

glm::dmat3 rotation(const Orientation& orientation)
{
    const double y = glm::radians(orientation.yaw), p = glm::radians(orientation.pitch),
                 r = glm::radians(orientation.roll);
    // glm's matrices are written column by column.
    const glm::dmat3 roll(std::cos(r), std::sin(r), 0, -std::sin(r), std::cos(r), 0, 0, 0, 1);
    const glm::dmat3 pitch(1, 0, 0, 0, std::cos(p), std::sin(p), 0, -std::sin(p), std::cos(p));
    const glm::dmat3 yaw(std::cos(y), 0, -std::sin(y), 0, 1, 0, std::sin(y), 0, std::cos(y));
    return yaw * pitch * roll;
}

Panorama::Panorama(const Chart& source, const Chart& target, const Orientation& orientation)
    : m_source(source), m_target(target)
{
    const std::pair<const char*, double> angles[] = {
        {"yaw", orientation.yaw}, {"pitch", orientation.pitch}, {"roll", orientation.roll}};
    for (const auto& [name, value] : angles)
        if (!std::isfinite(value)) throw Error(name, std::to_string(value), "allowed are finite angles in degrees");
    m_rotation = rotation(orientation);
}

}  // namespace anamorph
