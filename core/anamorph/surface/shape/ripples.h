// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "anamorph/surface/shape/shape.h"

namespace anamorph::surface::shapes {

/// Circular waves about the middle of the sheet, of `amplitude` and `wavelength`. Distances r are rounded off at the
/// middle, as sqrt(r^2 + (wavelength / 8)^2), so that the surface is smooth there.
class Ripples {
  public:
    explicit Ripples(const SurfaceShape& shape) : m_shape(shape), m_waves(2 * kPi / shape.wavelength) {}

    template <class T>
    SurfacePoint<T> point(const T& u, const T& v) const {
        const T x = plane_x(m_shape, u), y = plane_y(v);
        const double round = m_shape.wavelength / 8;
        const T distance = sqrt(T(square(x) + square(y) + round * round));
        T s, c;
        sin_cos(T(distance * m_waves - m_shape.phase * (2 * kPi)), s, c);
        return {x, y, s * m_shape.amplitude};
    }
    template <class T>
    SurfacePoint<T> normal(const T& u, const T& v) const {
        const T x = plane_x(m_shape, u), y = plane_y(v);
        const double round = m_shape.wavelength / 8;
        const T distance = sqrt(T(square(x) + square(y) + round * round));
        T s, c;
        sin_cos(T(distance * m_waves - m_shape.phase * (2 * kPi)), s, c);
        const T slope = c * (m_shape.amplitude * m_waves) / distance;
        return normal_of_slopes(T(slope * x), T(slope * y));
    }

  private:
    SurfaceShape m_shape;
    double m_waves;
};

}  // namespace anamorph::surface::shapes
