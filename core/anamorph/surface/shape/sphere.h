// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "anamorph/surface/shape/shape.h"

namespace anamorph::surface::shapes {

/// A sphere of `radius` about the origin: the picture covers `angle` of longitude, and all latitudes.
class Sphere {
  public:
    explicit Sphere(const SurfaceShape& shape)
        : m_turn(shape.angle * (kPi / 180)), m_radius(shape.radius > 0 ? shape.radius : 0.5) {}

    template <class T>
    SurfacePoint<T> point(const T& u, const T& v) const {
        return at_radius(u, v, m_radius);
    }
    template <class T>
    SurfacePoint<T> normal(const T& u, const T& v) const {
        return at_radius(u, v, 1);
    }

  private:
    template <class T>
    SurfacePoint<T> at_radius(const T& u, const T& v, double radius) const {
        T s, c, up, out;
        sin_cos(T((u - 0.5) * m_turn), s, c);
        sin_cos(T((0.5 - v) * kPi), up, out);
        out = out * radius;
        return {out * s, up * radius, out * c};
    }

    double m_turn, m_radius;
};

}  // namespace anamorph::surface::shapes
