// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "anamorph/surface/shape/shape.h"

namespace anamorph::surface::shapes {

/// The picture as it is, flat.
class Plane {
  public:
    explicit Plane(const SurfaceShape& shape) : m_shape(shape) {}

    template <class T>
    SurfacePoint<T> point(const T& u, const T& v) const {
        return {plane_x(m_shape, u), plane_y(v), T(0.0)};
    }
    template <class T>
    SurfacePoint<T> normal(const T&, const T&) const {
        return {T(0.0), T(0.0), T(1.0)};
    }

  private:
    SurfaceShape m_shape;
};

}  // namespace anamorph::surface::shapes
