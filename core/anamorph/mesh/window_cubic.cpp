// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/window_cubic.h"

#include <algorithm>
#include <cmath>

namespace anamorph {
namespace {

/// The values of the ten monomials of a cubic, in the order of Jet.
std::array<double, 10> monomials(double s, double t) {
    return {1, s, t, s * s, s * t, t * t, s * s * s, s * s * t, s * t * t, t * t * t};
}

}  // namespace

double WindowCubic::size() const {
    double size_x = 0, size_y = 0;
    for (int k = 0; k < 10; ++k) {
        size_x += std::fabs(cx[k]);
        size_y += std::fabs(cy[k]);
    }
    return std::max(size_x, size_y);
}

CubicFit::CubicFit(std::vector<Point<double>> places) : m_places(std::move(places)) {
    for (const Point<double>& p : m_places) m_monomials.push_back(monomials(p.x, p.y));
    std::array<std::array<double, 20>, 10> rows{};
    for (std::size_t a = 0; a < 10; ++a) {
        rows[a][10 + a] = 1;
        for (std::size_t b = 0; b < 10; ++b)
            for (const auto& m : m_monomials) rows[a][b] += m[a] * m[b];
    }
    // Gauss and Jordan; the matrix is positive definite.
    for (std::size_t k = 0; k < 10; ++k) {
        const double pivot = rows[k][k];
        for (double& v : rows[k]) v /= pivot;
        for (std::size_t a = 0; a < 10; ++a) {
            const double factor = rows[a][k];
            for (std::size_t b = 0; a != k && b < 20; ++b) rows[a][b] -= factor * rows[k][b];
        }
    }
    for (std::size_t a = 0; a < 10; ++a)
        for (std::size_t b = 0; b < 10; ++b) m_inverse[a][b] = rows[a][10 + b];
}

}  // namespace anamorph
