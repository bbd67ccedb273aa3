// SPDX-License-Identifier: Apache-2.0
// Deformations as a map of space: parameters, Jacobians, inverses, folds.
#include "anamorph/deform/plane_warp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <string>

#include "anamorph/error.h"

namespace anamorph::test_plane_warp {
namespace {

class Random {
  public:
    explicit Random(unsigned seed) : m_engine(seed) {}
    double number(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(m_engine);
    }
    glm::dvec3 vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
    /// A skew plane with axes of about this length.
    ParameterPlane plane(double length) {
        return {vector(3), length * (glm::dvec3(1, .2, .1) + vector(.1)),
                length * (glm::dvec3(-.3, 1, .2) + vector(.1))};
    }
    std::vector<Deformation> list(std::size_t count, double size, double least_extent, double most_extent) {
        std::vector<Deformation> list(count);
        for (std::size_t k = 0; k < count; ++k) {
            list[k] = {vector(size),
                       {number(-1, 1), number(-1, 1)},
                       {number(least_extent, most_extent), number(least_extent, most_extent)}};
            if (k % 2) list[k].kernel = DeformationKernel::wendland_c2;
            list[k].enabled = k % 7 != 6;
        }
        return list;
    }

  private:
    std::mt19937 m_engine;
};

Deformation along_u(double x) {
    return {{x, 0, 0}, {0, 0}, {1, 1}};
}

TEST(ParameterPlane, ParametersOfItsPoints) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        const ParameterPlane plane = random.plane(std::pow(10, random.number(-6, 6)));
        const glm::dvec2 s{random.number(-5, 5), random.number(-5, 5)};
        const glm::dvec3 across = glm::cross(plane.axis_u(), plane.axis_v());
        const glm::dvec2 found = plane.parameters(plane.point(s) + 3. * across / glm::length(across));
        const double error = 1e-14 * (10 + 10 / glm::length(plane.axis_u()));
        EXPECT_NEAR(found.x, s.x, error);
        EXPECT_NEAR(found.y, s.y, error);
    }
    const ParameterPlane plain({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    EXPECT_EQ(plain, ParameterPlane());
    EXPECT_EQ(plain.parameters({.1, .2, .3}), glm::dvec2(.1, .2));
}

TEST(ParameterPlane, WhatIsRefused) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(ParameterPlane({0, 0, 0}, {1, 2, 3}, {-2, -4, -6}), Error);
    EXPECT_THROW(ParameterPlane({0, 0, 0}, {1, 0, 0}, {0, 0, 0}), Error);
    EXPECT_THROW(ParameterPlane({nan, 0, 0}, {1, 0, 0}, {0, 1, 0}), Error);
    EXPECT_THROW(ParameterPlane({0, 0, 0}, {1e-310, 0, 0}, {0, 1, 0}), Error);
}

TEST(PlaneWarp, MovesAsTheListSays) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        const ParameterPlane plane = random.plane(1);
        std::vector<Deformation> list = random.list(300, 1, .01, .1);
        list.push_back({{1, 2, 3}, {0, 0}, {5, 7}});
        const PlaneWarp warp(plane, list);
        for (int i = 0; i < 500; ++i) {
            const glm::dvec3 p = random.vector(4);
            const glm::dvec3 expected = p + displacement_at(list, plane.parameters(p)).value;
            EXPECT_LE(glm::length(warp.forward(p) - expected), 1e-13);
        }
    }
}

TEST(PlaneWarp, JacobianIsTheDerivative) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        const PlaneWarp warp(random.plane(1), random.list(20, 1, .3, 1));
        for (int i = 0; i < 50; ++i) {
            const glm::dvec3 p = warp.plane().point({random.number(-1, 1), random.number(-1, 1)});
            const glm::dmat3 jacobian = warp.jacobian(p);
            for (int c = 0; c < 3; ++c) {
                constexpr double kStep = 1e-5;  // truncation and rounding of about 1e-9
                glm::dvec3 step(0.0);
                step[c] = kStep;
                const glm::dvec3 slope = (warp.forward(p + step) - warp.forward(p - step)) / (2 * kStep);
                EXPECT_LE(glm::length(slope - jacobian[c]), 1e-6);
            }
        }
    }
}

TEST(PlaneWarp, InverseRoundTrip) {
    int one_to_one = 0;
    for (unsigned seed = 1; seed <= 12; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        const PlaneWarp warp(random.plane(1), random.list(30, .05, .3, 1));
        if (warp.find_fold().answer != FoldAnswer::none) continue;
        ++one_to_one;
        for (int i = 0; i < 200; ++i) {
            const glm::dvec3 p = random.vector(3);
            const auto [back, found] = warp.inverse(warp.forward(p));
            EXPECT_TRUE(found);
            EXPECT_LE(glm::length(back - p), 1e-12);
            EXPECT_LE(glm::length(warp.forward(warp.inverse(p).point) - p), 1e-12);
        }
    }
    EXPECT_GE(one_to_one, 6);
    // Far off, displacements that are across the plane, and steep ones that just do not fold.
    const PlaneWarp relief({}, {{{0, 0, 1e6}, {0, 0}, {1e-3, 1e-3}}});
    EXPECT_EQ(relief.inverse(relief.forward({0, 0, 0})).point, glm::dvec3(0.0));
    const PlaneWarp steep({}, {along_u(1.16)});
    for (double x = -3; x <= 3; x += 1. / 64) {
        const auto [back, found] = steep.inverse(steep.forward({x, .1, 0}));
        EXPECT_TRUE(found);
        EXPECT_NEAR(back.x, x, 1e-12);
    }
}

TEST(PlaneWarp, Folds) {
    // The steepest slope of a Gaussian is sqrt(2 / e) = 0.8578 of its height over its extent.
    EXPECT_EQ(PlaneWarp({}, {along_u(1.165)}).find_fold().answer, FoldAnswer::none);
    const Fold fold = PlaneWarp({}, {along_u(1.166)}).find_fold();
    EXPECT_EQ(fold.answer, FoldAnswer::found);
    EXPECT_NEAR(std::fabs(fold.parameters.x), std::sqrt(.5), .05);
    // Wendland's is 20 r (1 - r)^3 at r = 1/4: 135/64.
    Deformation compact = along_u(.47);
    compact.kernel = DeformationKernel::wendland_c2;
    EXPECT_EQ(PlaneWarp({}, {compact}).find_fold().answer, FoldAnswer::none);
    compact.vector.x = .475;
    EXPECT_EQ(PlaneWarp({}, {compact}).find_fold().answer, FoldAnswer::found);
    // Across the plane, nothing folds; a disabled one does nothing.
    EXPECT_EQ(PlaneWarp({}, {{{0, 0, 1e9}, {0, 0}, {1, 1}}}).find_fold().answer, FoldAnswer::none);
    Deformation off = along_u(5);
    off.enabled = false;
    EXPECT_EQ(PlaneWarp({}, {off}).find_fold().answer, FoldAnswer::none);
    EXPECT_EQ(PlaneWarp({}, {along_u(5)}).find_fold(0).answer, FoldAnswer::undecided);
}

// Heights to either side of where the determinant is 0, down to the last digits of double: an answer is true,
// or none is given.
TEST(PlaneWarp, FoldsAtTheLastDigits) {
    const long double steepest = sqrtl(2 / expl(1));
    int none = 0, found = 0;
    for (int step = -4000; step <= 4000; ++step) {
        const double height = static_cast<double>(1 / steepest) * (1 + step * 0x1p-52);
        const Fold fold = PlaneWarp({}, {along_u(height)}).find_fold(300);
        const long double least = 1 - height * steepest;
        none += fold.answer == FoldAnswer::none;
        found += fold.answer == FoldAnswer::found;
        if (fold.answer == FoldAnswer::none) {
            EXPECT_GT(least, 0) << step;
        }
        if (fold.answer == FoldAnswer::found) {
            EXPECT_LE(least, 0) << step;
        }
    }
    EXPECT_LT(none, 4001);
    EXPECT_LT(found, 4001);
    EXPECT_EQ(PlaneWarp({}, {along_u(1.16)}).find_fold().answer, FoldAnswer::none);
}

TEST(PlaneWarp, HardCases) {
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    // Folded: some solution, or none, but an end.
    const PlaneWarp folded({}, {along_u(5), {{0, 3, 0}, {.5, .5}, {.2, .2}}});
    for (double x = -3; x <= 3; x += 1. / 16) {
        const auto [back, found] = folded.inverse({x, .3, 0});
        if (found) {
            EXPECT_LE(glm::length(folded.forward(back) - glm::dvec3(x, .3, 0)), 1e-12);
        }
    }
    EXPECT_FALSE(folded.inverse({nan, 0, 0}).found);
    EXPECT_TRUE(std::isnan(folded.forward({nan, 0, 0}).x));
    EXPECT_EQ(folded.forward({inf, 0, 0}).x, inf);
    for (const double extent : {1e-30, 1e30, 1e-300, 1e300}) {
        const PlaneWarp warp({}, {{{1, 2, 3}, {0, 0}, {extent, extent}}});
        EXPECT_EQ(warp.forward({0, 0, 0}), glm::dvec3(1, 2, 3));
        (void)warp.find_fold();
        (void)warp.inverse({.5, .5, 0});
    }
    EXPECT_THROW(PlaneWarp({}, {{{1, 0, 0}, {0, 0}, {0, 1}}}), Error);
    EXPECT_EQ(PlaneWarp({}, {}).forward({1, 2, 3}), glm::dvec3(1, 2, 3));
}

}  // namespace
}  // namespace anamorph::test_plane_warp
