// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "anamorph/surface/shape/shape.h"

namespace anamorph::surface::shapes {

/// A sheet that curls round a cylinder of `radius` that rolls over it, towards the viewer: up to the line where
/// they touch the sheet stays, half a turn of it lies on the cylinder, the rest lies flat above the sheet.
/// `direction`: the direction in which the part that moves lies. `turn`: the way that the line has come, from
/// the far corner (0) to where all of the sheet is turned (1).
class PageTurn {
  public:
    explicit PageTurn(const SurfaceShape& shape)
        : m_shape(shape), m_radius(shape.radius > 0 ? shape.radius : 0.1) {
        const double angle = shape.direction * (kPi / 180);
        m_across = std::cos(angle);
        m_up = std::sin(angle);
        // The corners are that far from the middle along the direction.
        const double reach = (std::fabs(m_across) * shape.aspect + std::fabs(m_up)) / 2;
        m_line = reach - shape.turn * (2 * reach);
    }

    template <class T>
    SurfacePoint<T> point(const T& u, const T& v) const {
        const T x = plane_x(m_shape, u), y = plane_y(v);
        const T past = x * m_across + y * m_up - m_line;
        T s, c;
        sin_cos(T(past * (1 / m_radius)), s, c);
        // Along the direction, less `past`, and up: on the cylinder, on the sheet above, on the sheet that stays.
        const double half_turn = kPi * m_radius;
        const auto above = is_negative(T(half_turn - past)), stays = is_negative(past);
        const T back = half_turn - past * 2.0;
        const T along = select(stays, T(0.0), select(above, back, T(s * m_radius - past)));
        const T height = select(stays, T(0.0), select(above, T(2 * m_radius), T((1.0 - c) * m_radius)));
        return {x + along * m_across, y + along * m_up, height};
    }

  private:
    SurfaceShape m_shape;
    double m_radius, m_across, m_up, m_line;
};

}  // namespace anamorph::surface::shapes
