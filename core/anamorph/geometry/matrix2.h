// SPDX-License-Identifier: Apache-2.0
// Linear maps of the plane.
#pragma once

#include <algorithm>
#include <cmath>

#include "anamorph/geometry/point.h"

namespace anamorph {

/// A linear map of the plane: it leads (x, y) to (a11 x + a12 y, a21 x + a22 y).
struct Matrix2 {
    double a11, a12, a21, a22;

    double determinant() const { return a11 * a22 - a12 * a21; }
    Point<double> operator()(double x, double y) const { return {a11 * x + a12 * y, a21 * x + a22 * y}; }
    Point<double> operator()(const Point<double>& p) const { return (*this)(p.x, p.y); }
    /// The largest sum of a row's magnitudes.
    double norm() const { return std::max(std::fabs(a11) + std::fabs(a12), std::fabs(a21) + std::fabs(a22)); }
    /// The half sizes that a box of half sizes (x, y) spans when it is mapped.
    Point<double> span(double x, double y) const {
        return {std::fabs(a11) * x + std::fabs(a12) * y, std::fabs(a21) * x + std::fabs(a22) * y};
    }
    Matrix2 inverse() const {
        const double k = 1 / determinant();
        return {a22 * k, -a12 * k, -a21 * k, a11 * k};
    }
};

}  // namespace anamorph
