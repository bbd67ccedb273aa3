// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "anamorph/surface/shape/shape.h"

namespace anamorph::surface::shapes {

/// A torus about the y axis: u goes round the axis at `radius` over `angle`, v once round the tube, of radius
/// `tube`, from its inside over its top.
class Torus {
  public:
    explicit Torus(const SurfaceShape& shape)
        : m_turn(shape.angle * (kPi / 180)),
          m_radius(shape.radius > 0 ? shape.radius : 0.5),
          m_tube(shape.tube) {}

    template <class T>
    SurfacePoint<T> point(const T& u, const T& v) const {
        T s, c, up, out;
        sin_cos(T((u - 0.5) * m_turn), s, c);
        sin_cos(T((0.5 - v) * (2 * kPi)), up, out);
        const T from_axis = out * m_tube + m_radius;
        return {from_axis * s, up * m_tube, from_axis * c};
    }
    /// The direction away from the middle of the tube.
    template <class T>
    SurfacePoint<T> normal(const T& u, const T& v) const {
        T s, c, up, out;
        sin_cos(T((u - 0.5) * m_turn), s, c);
        sin_cos(T((0.5 - v) * (2 * kPi)), up, out);
        return {out * s, up, out * c};
    }

  private:
    double m_turn, m_radius, m_tube;
};

}  // namespace anamorph::surface::shapes
