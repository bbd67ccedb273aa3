// SPDX-License-Identifier: Apache-2.0
// The numbers that surfaces are made of. All lie in a frame with x to the right, y up and z towards the
// viewer. Parameters (u, v) run over the picture, u to the right and v down, from 0 to 1; undeformed it is
// `aspect` wide and 1 high, about the origin, in the plane z = 0.
#pragma once

#include "anamorph/number/jet.h"
#include "anamorph/number/number.h"

namespace anamorph::surface {

inline constexpr double kPi = 3.14159265358979323846;

/// The numbers of a surface; each surface reads those that its file names.
struct SurfaceShape {
    double aspect = 1;   ///< width over height of the picture
    double radius = 0;   ///< 0: such that the picture keeps its width
    double angle = 180;  ///< degrees
    double tube = 0.2;   ///< radius of a torus's tube
    double amplitude = 0.1;
    double wavelength = 0.5;
    double phase = 0;      ///< turns
    double direction = 0;  ///< degrees from the x axis, counterclockwise
    double turn = 0.5;     ///< 0 to 1

    bool operator==(const SurfaceShape&) const = default;
};

/// A point of a surface.
template <class T>
struct SurfacePoint {
    T x, y, z;
};

/// The x coordinate of (u, v) in the plane z = 0; plane_y() is the y coordinate.
template <class T>
T plane_x(const SurfaceShape& shape, const T& u) {
    return (u - 0.5) * shape.aspect;
}
template <class T>
T plane_y(const T& v) {
    return 0.5 - v;
}

/// The unit normal, towards the viewer, of a height over the plane that rises by these slopes along x and y.
template <class T>
SurfacePoint<T> normal_of_slopes(const T& along_x, const T& along_y) {
    const T size = sqrt(T(square(along_x) + square(along_y) + 1.0));
    return {-along_x / size, -along_y / size, T(1.0) / size};
}

}  // namespace anamorph::surface
