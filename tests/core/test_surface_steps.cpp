// SPDX-License-Identifier: Apache-2.0
// Grids over ellipsoids, and the bound of their triangles.
#include "anamorph/figure/body/surface_steps.h"

#include <gtest/gtest.h>

#include <random>

namespace anamorph::test_surface_steps {
using namespace figure;
namespace {

using Real = long double;
using Point = glm::vec<3, Real>;

/// A point of the surface, from its definition.
Point surface(const glm::dvec3& a, Real t, Real p) {
    return {a.x * std::cos(t) * std::sin(p), a.y * std::sin(t), -a.z * std::cos(t) * std::cos(p)};
}

TEST(SurfaceSteps, NoPointOfATriangleIsOffByMore) {
    // A point l1 v1 + l2 v2 + l3 v3 of a triangle of any cell is within the bound of the surface's point at the same means of the
    // parameters, which is the claim that is proven; a cell has both triangles, and one at a pole.
    std::mt19937 random(20);
    std::uniform_real_distribution<double> exponent(-2, 3), share(0, 1);
    const Real pi = std::acos(Real{-1});
    double closest = 0;
    for (int k = 0; k < 40; ++k) {
        glm::dvec3 axes(std::pow(10, exponent(random)), std::pow(10, exponent(random)),
                        std::pow(10, exponent(random)));
        if (k % 10 == 0) axes[k / 10 % 3] = 0;
        const double tolerance = std::max({axes.x, axes.y, axes.z}) * std::pow(10, -1 - 2 * share(random));
        const auto steps = surface_steps(axes, tolerance);
        ASSERT_TRUE(steps);
        ASSERT_LE(steps->bound, tolerance * (1 + 1e-12));
        ASSERT_TRUE(steps->rows >= 4 && steps->columns >= 6);
        const Real h = pi / steps->rows, w = 2 * pi / steps->columns;
        for (int row = 0; row < steps->rows; ++row) {
            const Real t0 = -pi / 2 + row * h, p0 = share(random) * 6;
            const Real t[4] = {t0, t0, t0 + h, t0 + h}, p[4] = {p0, p0 + w, p0 + w, p0};
            for (const auto& [i, j, l] : {std::array{0, 1, 2}, {0, 2, 3}, {1, 2, 3}}) {
                for (int s = 0; s < 20; ++s) {
                    const Real x = share(random), y = share(random) * (1 - x), z = 1 - x - y;
                    const Point flat = x * surface(axes, t[i], p[i]) + y * surface(axes, t[j], p[j]) +
                                       z * surface(axes, t[l], p[l]);
                    const Point round =
                        surface(axes, x * t[i] + y * t[j] + z * t[l], x * p[i] + y * p[j] + z * p[l]);
                    const Point d = flat - round;
                    const Real off = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
                    ASSERT_LE(off, steps->bound * (1 + 1e-12L));
                    closest = std::max(closest, static_cast<double>(off / steps->bound));
                }
            }
        }
    }
    // The bound is no fantasy.
    EXPECT_GT(closest, 0.4);
}

TEST(SurfaceSteps, AreFewWhereTheToleranceIsWideAndNoneWhereItIsTooSmall) {
    EXPECT_EQ(surface_steps({1, 1, 1}, 100)->rows, 4);
    EXPECT_EQ(surface_steps({0, 0, 0}, 1)->columns, 6);
    EXPECT_EQ(surface_steps({0, 0, 0}, 1)->bound, 0);
    EXPECT_FALSE(surface_steps({1e6, 1, 1}, 1e-6));
    EXPECT_FALSE(surface_steps({1, 1, 1}, 0));
    EXPECT_FALSE(surface_steps({HUGE_VAL, 1, 1}, 1));
}

}  // namespace
}  // namespace anamorph::test_surface_steps
