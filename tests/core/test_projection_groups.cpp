// SPDX-License-Identifier: Apache-2.0
// Kim 2003, 4.2 to 4.4: linear parts and residuals about directions of projection, against his formulas in long double.
#include "anamorph/projector/projection_groups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "anamorph/chart/chart_formulas.h"
#include "anamorph/error.h"

namespace anamorph::test_projection_groups {
namespace {

using Real = long double;
constexpr Real kPi = std::numbers::pi_v<Real>;

/// A point of the scene for a ray, right, down and forward, of a projector that looks along -z.
glm::dvec3 point_of(const glm::dvec3& ray) {
    return {ray.x, -ray.y, -ray.z};
}

TEST(ProjectionGroups, LinearPartsOfACylinderAreMinimax) {
    const int width = 1000, height = 400;
    const Projector projector(Chart(Projection::cylindrical, width, height));
    for (const double x_max : {0.3, 1.0, 2.0}) {
        const ProjectionGroups groups(projector, {{0, 0, 1}}, {x_max, 0.7, 17, 9});
        const glm::dmat3 m = groups.groups()[0].linear;
        const Real a = m[0][0] / static_cast<Real>(width), scale = width / (2 * kPi), b = m[1][1] / scale;
        EXPECT_EQ(m[0][1], 0);
        EXPECT_EQ(m[1][0], 0);
        // Eq. 4.4, theta: an extreme within and the end have one size and two signs.
        const auto residual = [&](Real x, Real slope) { return std::atan(x) / (2 * kPi) - slope * x; };
        const Real x_c = std::sqrt(1 / (2 * kPi * a) - 1);
        EXPECT_LT(x_c, x_max);
        EXPECT_NEAR(static_cast<double>(residual(x_c, a) + residual(x_max, a)), 0, 1e-14);
        const auto worst = [&](Real slope) {
            Real most = 0;
            for (int i = 0; i <= 4000; ++i)
                most = std::max(most, std::fabs(residual(x_max * i / 4000.0L, slope)));
            return most;
        };
        EXPECT_LT(worst(a), worst(a * 1.01L));
        EXPECT_LT(worst(a), worst(a * 0.99L));
        // v: those at x' = 0 and at x_max.
        EXPECT_NEAR(static_cast<double>(1 - b),
                    static_cast<double>(b - 1 / std::sqrt(1 + Real{x_max} * x_max)), 1e-13);
    }
}

TEST(ProjectionGroups, SumsAreWithinTheirBoundOfEquation4_2) {
    const unsigned seed = 2;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share(-1, 1);
    const int width = 4096, height = 1024;
    const Projector projector(Chart(Projection::cylindrical, width, height));
    for (const int nodes : {17, 65, 256}) {
        const ProjectionGroups groups(projector, ProjectionGroups::level_directions(6),
                                      {1, 0.75, nodes, nodes});
        Real worst = 0;
        for (int k = 0; k < 6; ++k)
            for (int i = 0; i < 2000; ++i) {
                const Real x = share(random), y = 0.75L * share(random), angle = k * kPi / 3;
                const glm::dvec3 ray(static_cast<double>(std::sin(angle) + x * std::cos(angle)),
                                     static_cast<double>(y),
                                     static_cast<double>(std::cos(angle) - x * std::sin(angle)));
                Point<double> at{};
                if (!groups.texel(k, point_of(ray * 3.0), at)) continue;
                const Real azimuth = std::atan2(Real{ray.x}, Real{ray.z}),
                           slope = ray.y / std::hypot(Real{ray.x}, Real{ray.z});
                const Real u = (azimuth / (2 * kPi) + 0.5L) * width,
                           v = slope / (2 * kPi) * width + height / 2;
                Real across = std::fabs(u - at.x);
                across = std::min(across, std::fabs(across - width));
                worst = std::max(worst, std::hypot(across, v - at.y));
            }
        double bound = 0;
        for (const ProjectionGroup& group : groups.groups()) bound = std::max(bound, group.bound);
        EXPECT_LE(worst, bound);
        EXPECT_LT(bound, 2 * worst);
        // 90 degrees: without the table it is far off (the paper: 0.074 of the picture at most).
        EXPECT_GT(groups.groups()[0].linear_error, 20);
        if (nodes == 256) {
            EXPECT_LT(bound, 0.03);
        }
    }
}

TEST(ProjectionGroups, OtherProjectionsHoldTheirBoundsToo) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> share(-1, 1);
    for (const Projection projection :
         {Projection::equirectangular, Projection::mercator, Projection::fisheye, Projection::rectilinear,
          Projection::stereographic}) {
        SCOPED_TRACE(name_of(projection));
        const Chart chart(projection, 800, 400, projection == Projection::rectilinear ? 120 : 0);
        const Projector projector(chart);
        // The middle of a fisheye is an axis that no bound is known about.
        const double aside = projection == Projection::fisheye ? 1 : 0.2;
        const ProjectionGroups groups(projector, {{aside, 0.1, 1}}, {0.5, 0.4, 33, 33});
        const ProjectionGroup& group = groups.groups()[0];
        ASSERT_LT(group.bound, 0.5);
        for (int i = 0; i < 500; ++i) {
            const glm::dvec3 ray =
                group.axes[0] * 0.5 * share(random) + group.axes[1] * 0.4 * share(random) + group.axes[2];
            Point<double> at{};
            if (!groups.texel(0, point_of(ray), at)) continue;
            const Point<Real> truth = chart.point(Ray<Real>{ray.x, ray.y, ray.z}, 0);
            EXPECT_LE(std::hypot(truth.x - at.x, truth.y - at.y), group.bound);
        }
    }
}

TEST(ProjectionGroups, GeometryStaysInItsFieldOfView) {
    const Projector projector(Chart(Projection::cylindrical, 1000, 300));
    const ProjectionGroups groups(projector, ProjectionGroups::level_directions(8), {1, 1, 5, 5});
    std::mt19937 random(6);
    std::uniform_real_distribution<double> share(-1, 1);
    for (int i = 0; i < 500; ++i) {
        // Azimuths within 45 degrees, which 8 directions of 90 always hold.
        const double about = 4 * share(random);
        std::array<glm::dvec3, 3> triangle;
        for (glm::dvec3& p : triangle) {
            const double a = about + 0.39 * share(random);
            p = point_of(glm::dvec3(std::sin(a), 0.3 * share(random), std::cos(a)) * (2 + share(random)));
        }
        const int group = groups.group_of(triangle);
        ASSERT_GE(group, 0);
        Point<double> at{};
        for (const glm::dvec3& p : triangle) EXPECT_TRUE(groups.texel(group, p, at));
    }
    EXPECT_EQ(groups.group_of({{{-1, 0, 1}, {1, 0, 1}, {0, 0, -1}}}), -1);
    EXPECT_EQ(groups.group_of({{{0, 0, 0}, {1, 0, 1}, {1, 0.1, 1}}}), -1);
    EXPECT_EQ(groups.group_of({{{0, 5, -1}, {0.1, 5, -1}, {0, 5.1, -1}}}), -1);
    EXPECT_EQ(groups.group_of({{{0, NAN, -1}, {0.1, 0, -1}, {0, 0.1, -1}}}), -1);
}

TEST(ProjectionGroups, DirectionsNextToTheAxisAndNone) {
    const Projector projector(Chart(Projection::cylindrical, 1000, 300));
    // 89.999 degrees off: the plane goes far beyond what is smooth, and no bound is claimed.
    const double tilt = 0.001 * std::numbers::pi / 180;
    const ProjectionGroups steep(projector, {{0, std::cos(tilt), std::sin(tilt)}}, {1, 1, 9, 9});
    EXPECT_EQ(steep.groups()[0].bound, HUGE_VAL);
    using testing::ThrowsMessage;
    EXPECT_THAT(
        [&] {
            ProjectionGroups(projector, {{0, -2, 0}});
        },
        ThrowsMessage<Error>("direction=0,-2,0: must be finite and not along y"));
    EXPECT_THAT(
        [&] {
            ProjectionGroups(projector, {{0, NAN, 1}});
        },
        ThrowsMessage<Error>("direction=0,nan,1: must be finite and not along y"));
    EXPECT_THAT(
        [&] {
            ProjectionGroups(projector, {}, {0, 1});
        },
        ThrowsMessage<Error>("x_max=0: must be a number above 0, to 1000"));
    EXPECT_THAT(
        [&] {
            ProjectionGroups(projector, {}, {1, 1, 1});
        },
        ThrowsMessage<Error>("columns=1: must be an integer from 2 to 4096"));
}

}  // namespace
}  // namespace anamorph::test_projection_groups
