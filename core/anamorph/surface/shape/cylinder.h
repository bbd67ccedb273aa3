// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "anamorph/surface/shape/shape.h"

namespace anamorph::surface::shapes {

/// An upright cylinder about the y axis, of `radius`, of which the picture covers `angle`.
class Cylinder {
  public:
    explicit Cylinder(const SurfaceShape& shape)
        : m_turn(shape.angle * (kPi / 180)),
          m_radius(shape.radius > 0 ? shape.radius : shape.aspect / m_turn) {}

    template <class T>
    SurfacePoint<T> point(const T& u, const T& v) const {
        T s, c;
        sin_cos(T((u - 0.5) * m_turn), s, c);
        return {s * m_radius, plane_y(v), c * m_radius};
    }
    template <class T>
    SurfacePoint<T> normal(const T& u, const T&) const {
        T s, c;
        sin_cos(T((u - 0.5) * m_turn), s, c);
        return {s, T(0.0), c};
    }

  private:
    double m_turn, m_radius;
};

}  // namespace anamorph::surface::shapes
