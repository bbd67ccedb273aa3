// SPDX-License-Identifier: Apache-2.0
// Points of a picture, rays, and the derivative of a map between pictures.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <type_traits>

#include "anamorph/number/rounded.h"

namespace anamorph {

/// A point in pixels, x right, y down, with the centre of the first pixel at (0.5, 0.5), or in the units
/// of a plane.
template <class T>
struct Point {
    T x, y;
};
/// The sum of two points as vectors.
inline Point<double> operator+(const Point<double>& a, const Point<double>& b) {
    return {a.x + b.x, a.y + b.y};
}
/// The vector from b to a.
inline Point<double> operator-(const Point<double>& a, const Point<double>& b) {
    return {a.x - b.x, a.y - b.y};
}
/// The vector a scaled by k.
inline Point<double> operator*(const Point<double>& a, double k) {
    return {a.x * k, a.y * k};
}

/// The larger of the magnitudes of a point's coordinates.
inline double largest(const Point<double>& p) {
    return std::max(std::fabs(p.x), std::fabs(p.y));
}

/// The derivative of a map from the target to the source: how far the source point moves, in source pixels (level 0),
/// for a step of one target pixel to the right, (x_i, y_i), and down, (x_j, y_j).
struct Jacobian {
    double x_i = 1, y_i = 0, x_j = 0, y_j = 1;
};

/// A direction of any length: x right, y down, z forward.
template <class T>
struct Ray {
    T x, y, z;
};

/// The product matrix * ray, where entry(column, row) gives the entries of the matrix.
template <class T, class Entry>
requires(std::is_invocable_v<Entry, int, int>) Ray<T> transform(const Entry& entry, const Ray<T>& ray) {
    const auto row = [&](int i) -> T {
        return ray.x * entry(0, i) + ray.y * entry(1, i) + ray.z * entry(2, i);
    };
    return {row(0), row(1), row(2)};
}
/// A ray turned by a matrix whose entries are off by at most `error`.
template <class T>
Ray<T> transform(const glm::dmat3& matrix, const Ray<T>& ray, double error = 0) {
    return transform([&](int column, int row) { return measured<T>(matrix[column][row], error); }, ray);
}

}  // namespace anamorph
