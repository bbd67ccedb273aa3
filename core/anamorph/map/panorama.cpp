// SPDX-License-Identifier: Apache-2.0
#include "anamorph/map/panorama.h"

#include <glm/trigonometric.hpp>

#include "anamorph/error.h"

namespace anamorph {

glm::dmat3 rotation(const Orientation& orientation) {
    const double y = glm::radians(orientation.yaw), p = glm::radians(orientation.pitch),
                 r = glm::radians(orientation.roll);
    // glm's matrices are written column by column.
    const glm::dmat3 roll(std::cos(r), std::sin(r), 0, -std::sin(r), std::cos(r), 0, 0, 0, 1);
    const glm::dmat3 pitch(1, 0, 0, 0, std::cos(p), std::sin(p), 0, -std::sin(p), std::cos(p));
    const glm::dmat3 yaw(std::cos(y), 0, -std::sin(y), 0, 1, 0, std::sin(y), 0, std::cos(y));
    return yaw * pitch * roll;
}

Panorama::Panorama(const Chart& source, const Chart& target, const Orientation& orientation)
    : m_source(source), m_target(target) {
    const std::pair<const char*, double> angles[] = {
        {"yaw", orientation.yaw}, {"pitch", orientation.pitch}, {"roll", orientation.roll}};
    for (const auto& [name, value] : angles)
        if (!std::isfinite(value))
            throw Error(name, std::to_string(value), "must be a finite angle in degrees");
    m_rotation = rotation(orientation);
}

Panorama::Local Panorama::local_around(double x, double y, int piece) const {
    Local local;
    // The target's own angles count from this point only where that narrows intervals; its piece is given.
    local.target = m_target.branch_around(x, y, piece);
    if (local.target.piece != piece) local.target = m_target.branch(piece);
    local.source = m_source.branch_around(transform(m_rotation, m_target.ray(x, y, piece)));
    local.rotation = glm::transpose(local.source.axes) * m_rotation * local.target.axes;
    return local;
}

}  // namespace anamorph
