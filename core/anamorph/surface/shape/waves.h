// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "anamorph/surface/shape/shape.h"

namespace anamorph::surface::shapes {

/// Plane waves on the sheet, of `amplitude` and `wavelength`, that go along `direction`.
class Waves {
  public:
    explicit Waves(const SurfaceShape& shape)
        : m_shape(shape),
          m_across(std::cos(shape.direction * (kPi / 180)) * (2 * kPi / shape.wavelength)),
          m_up(std::sin(shape.direction * (kPi / 180)) * (2 * kPi / shape.wavelength)) {}

    template <class T>
    SurfacePoint<T> point(const T& u, const T& v) const {
        const T x = plane_x(m_shape, u), y = plane_y(v);
        T s, c;
        sin_cos(T(x * m_across + y * m_up - m_shape.phase * (2 * kPi)), s, c);
        return {x, y, s * m_shape.amplitude};
    }
    template <class T>
    SurfacePoint<T> normal(const T& u, const T& v) const {
        T s, c;
        sin_cos(T(plane_x(m_shape, u) * m_across + plane_y(v) * m_up - m_shape.phase * (2 * kPi)), s, c);
        const T slope = c * m_shape.amplitude;
        return normal_of_slopes(T(slope * m_across), T(slope * m_up));
    }

  private:
    SurfaceShape m_shape;
    double m_across, m_up;
};

}  // namespace anamorph::surface::shapes
