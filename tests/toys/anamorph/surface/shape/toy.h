// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "anamorph/surface/shape/shape.h"

namespace anamorph::surface::shapes {

/// A toy: z = (x^2 - y^2) / 2 over the plane.
class ToySaddle {
  public:
    explicit ToySaddle(const SurfaceShape& shape) : m_shape(shape) {}

    template <class T>
    SurfacePoint<T> point(const T& u, const T& v) const {
        const T x = plane_x(m_shape, u), y = plane_y(v);
        return {x, y, (square(x) - square(y)) * 0.5};
    }
    template <class T>
    SurfacePoint<T> normal(const T& u, const T& v) const {
        return normal_of_slopes(plane_x(m_shape, u), T(-plane_y(v)));
    }

  private:
    SurfaceShape m_shape;
};

}  // namespace anamorph::surface::shapes
