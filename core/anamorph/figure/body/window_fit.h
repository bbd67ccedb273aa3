// SPDX-License-Identifier: Apache-2.0
// The way between the right-handed space of other programs and that of figures (frame.h): z becomes -z.
#pragma once

#include <algorithm>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include "anamorph/figure/body/ellipsoid.h"

namespace anamorph::figure {

/// An ellipsoid seen in a mirror along z. Its rotation is a turn, whatever it was.
inline Ellipsoid mirrored(const Ellipsoid& e) {
    Ellipsoid m{{e.center.x, e.center.y, -e.center.z}, e.axes, {}};
    for (int k = 0; k < 3; ++k) m.rotation[k] = {e.rotation[k].x, e.rotation[k].y, -e.rotation[k].z};
    // An axis the other way is the same axis.
    if (glm::determinant(m.rotation) < 0) m.rotation[2] = -m.rotation[2];
    return m;
}

/// Moves and scales a right-handed scene into the window of 1000 units, of which it fills nine tenths.
class WindowFit {
  public:
    WindowFit() = default;
    /// `least` and `most`: the corners of a box around the scene.
    WindowFit(const glm::dvec3& least, const glm::dvec3& most)
        : m_scale(900 / std::max({most.x - least.x, most.y - least.y, 1e-9})),
          m_middle(0.5 * (least + most)) {}

    glm::dvec3 point(const glm::dvec3& p) const {
        const glm::dvec3 q = m_scale * (p - m_middle);
        return {500 + q.x, 500 + q.y, 500 - q.z};
    }
    Ellipsoid ellipsoid(const Ellipsoid& e) const {
        Ellipsoid fitted = mirrored(e);
        fitted.center = point(e.center);
        fitted.axes *= m_scale;
        return fitted;
    }

  private:
    double m_scale = 1;
    glm::dvec3 m_middle{0.0};
};

}  // namespace anamorph::figure
