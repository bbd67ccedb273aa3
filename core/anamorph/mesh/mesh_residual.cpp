// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/mesh_residual.h"

#include <algorithm>
#include <cmath>

#include "anamorph/number/hypot.h"

namespace anamorph {
namespace {

/// Row and column of G that belong to the products: those that are not 0 in both eq. 5.5 and 5.7, then the
/// corner (1, 1), which is triangle 0's alone, and the corner (0, 0), triangle 1's.
constexpr std::size_t kElements[ResidualPatch::kProducts][2] = {{0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 0},
                                                                {2, 1}, {2, 2}, {2, 3}, {3, 0}, {3, 1},
                                                                {3, 2}, {3, 3}, {1, 1}, {0, 0}};

/// The largest |f_ss| + |f_tt| of product f: the basis functions of values reach 1 and curve by 6, those of
/// derivatives reach 4/27 and curve by 4.
double curvature_of(const std::size_t (&element)[2]) {
    const auto reach = [](std::size_t i) { return i < 2 ? 1.0 : 4.0 / 27; };
    const auto curve = [](std::size_t i) { return i < 2 ? 6.0 : 4.0; };
    return curve(element[0]) * reach(element[1]) + reach(element[0]) * curve(element[1]);
}

/// u: what rounding to float changes, in proportion, at most.
constexpr double kUnit = 0x1p-24;
// How many u of an element its term is off by, at most, in the sum that ResidualTables::row makes. A
// product has one sign and at most size 1 in the cell. Read from the table it is off by 1 u; a step of
// linear interpolation adds u / 2 (its parameter, below 1, is rounded) and 3 u (a difference, a product and
// a sum, of size 1 at most) and keeps what there was: 8 u after both. The element is rounded, and its
// product with that, 2 u; its sum with 13 more, 13 u. 23 u in all; the rest is room for terms of second
// order and for double.
//
// What is rounded at the end, once, is the offset of the point from the block's base. The block's form bounds
// it but for the approximation's own error; `offset` is taken twice for that: it is at least a pixel, and the
// tables' error (ResidualTables::bound) is below a thousandth of the elements' sum, which has room above.
constexpr double kTermRoundings = 32;

}  // namespace

ResidualPatch::ResidualPatch(const Patch& patch) {
    const auto& g = patch.g;
    // The planes of eq. 5.4 and 5.6.
    triangles[0].right = g[1][0] - g[0][0];
    triangles[0].down = g[0][1] - g[0][0];
    triangles[0].origin = g[0][0];
    triangles[1].right = g[1][1] - g[0][1];
    triangles[1].down = g[1][1] - g[1][0];
    triangles[1].origin = g[0][1] - triangles[1].down;
    for (Triangle& plane : triangles) {
        double sum_x = 0, sum_y = 0, curvature_x = 0, curvature_y = 0;
        for (std::size_t k = 0; k < kProducts; ++k) {
            const auto [i, j] = kElements[k];
            // The plane's own Hermite data: values at the corners, slopes, no twist.
            Point<double> linear{0, 0};
            if (i < 2 && j < 2)
                linear = {plane.origin.x + plane.right.x * double(i) + plane.down.x * double(j),
                          plane.origin.y + plane.right.y * double(i) + plane.down.y * double(j)};
            else if (i < 2)
                linear = plane.down;
            else if (j < 2)
                linear = plane.right;
            Point<double> element = g[i][j] - linear;
            // A plane goes through its own corners: that one product is not there.
            const bool own_corner = k == (&plane == &triangles[0] ? 13 : 12);
            if (own_corner) element = {0, 0};
            plane.x[k] = static_cast<float>(element.x);
            plane.y[k] = static_cast<float>(element.y);
            sum_x += std::fabs(element.x);
            sum_y += std::fabs(element.y);
            curvature_x += std::fabs(element.x) * curvature_of(kElements[k]);
            curvature_y += std::fabs(element.y) * curvature_of(kElements[k]);
        }
        plane.sum = hypot(sum_x, sum_y);
        plane.curvature = hypot(curvature_x, curvature_y);
    }
}

double ResidualPatch::float_rounding(const Bicubic& block) const {
    const double offset = hypot(sum_of_magnitudes(block.x) - std::fabs(block.x[0][0]) + 1,
                                sum_of_magnitudes(block.y) - std::fabs(block.y[0][0]) + 1);
    return kUnit * (kTermRoundings * std::max(triangles[0].sum, triangles[1].sum) + 2 * offset);
}

std::array<double, ResidualPatch::kProducts> residual_products(double s, double t) {
    const auto a = hermite_basis(s), b = hermite_basis(t);
    std::array<double, ResidualPatch::kProducts> products;
    for (std::size_t k = 0; k < products.size(); ++k) products[k] = a[kElements[k][0]] * b[kElements[k][1]];
    return products;
}

std::shared_ptr<const ResidualTables> ResidualTables::shared() {
    static const std::shared_ptr<const ResidualTables> tables(new ResidualTables);
    return tables;
}

ResidualTables::ResidualTables() : m_products(std::size_t{kCells + 1} * (kCells + 1) * 16) {
    float* to = m_products.data();
    for (int t = 0; t <= kCells; ++t)
        for (int s = 0; s <= kCells; ++s, to += 16) {
            const auto products = residual_products(double(s) / kCells, double(t) / kCells);
            for (std::size_t k = 0; k < ResidualPatch::kProducts; ++k)
                to[k] = static_cast<float>(products[k]);
        }
}

double ResidualTables::bound(const ResidualPatch& patch) const {
    return std::max(patch.triangles[0].curvature, patch.triangles[1].curvature) / (8.0 * kCells * kCells);
}

void ResidualTables::row(const ResidualPatch& patch, const Origin& origin, double first, double step,
                         double t, int begin, int end, float* x, float* y) const {
    const auto cell = [](double at, float& part) {
        const double scaled = std::clamp(at, 0.0, 1.0) * kCells;
        const int i = std::min(static_cast<int>(scaled), kCells - 1);
        part = static_cast<float>(scaled - i);
        return i;
    };
    float part_t, part_s;
    const int row = cell(t, part_t);
    for (int i = begin; i < end; ++i) {
        const double s = first + step * i;
        const int column = cell(s, part_s);
        const ResidualPatch::Triangle& plane = patch.triangles[s + t <= 1 ? 0 : 1];
        const float *above = node(column, row), *below = node(column, row + 1);
        float sum_x = 0, sum_y = 0;
        for (int k = 0; k < 16; ++k) {
            const float left = above[k] + part_t * (below[k] - above[k]);
            const float right = above[k + 16] + part_t * (below[k + 16] - above[k + 16]);
            const float product = left + part_s * (right - left);
            sum_x += plane.x[k] * product;
            sum_y += plane.y[k] * product;
        }
        x[i - begin] = static_cast<float>(origin.x + origin.step * i + plane.origin.x + plane.right.x * s +
                                          plane.down.x * t + static_cast<double>(sum_x));
        y[i - begin] = static_cast<float>(origin.y + plane.origin.y + plane.right.y * s + plane.down.y * t +
                                          static_cast<double>(sum_y));
    }
}

}  // namespace anamorph
