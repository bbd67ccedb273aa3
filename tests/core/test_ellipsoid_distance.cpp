// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/body/ellipsoid_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <random>

namespace anamorph::test_ellipsoid_distance {
using namespace figure;
namespace {

Ellipsoid ball(const glm::dvec3& center, double radius) {
    return {center, glm::dvec3(radius), glm::dmat3(1.0)};
}

TEST(EllipsoidContact, Balls) {
    const EllipsoidContact c = contact_of(ball({1, 2, 3}, 2), ball({1, 2 + 6, 3 + 8}, 3));
    EXPECT_NEAR(c.ratio, 10.0 / 5, 1e-15);
    EXPECT_NEAR(c.gap, 5, 1e-14);
    EXPECT_NEAR(glm::distance(c.normal, glm::dvec3(0, 0.6, 0.8)), 0, 1e-15);
    EXPECT_NEAR(contact_of(ball({0, 0, 0}, 2), ball({1, 0, 0}, 3)).ratio, 0.2, 1e-15);
    EXPECT_EQ(contact_of(ball({5, 5, 5}, 2), ball({5, 5, 5}, 3)).ratio, 0);
    EXPECT_EQ(contact_of(ball({0, 0, 0}, 0), ball({1, 0, 0}, 0)).ratio,
              std::numeric_limits<double>::infinity());
}

TEST(EllipsoidContact, AlongAnAxis) {
    const Ellipsoid a{{0, 0, 0}, {30, 20, 10}, glm::dmat3(1.0)}, b{{0, 50, 0}, {1, 5, 40}, glm::dmat3(1.0)};
    EXPECT_NEAR(contact_of(a, b).ratio, 50.0 / 25, 1e-14);
    EXPECT_NEAR(contact_of(a, b).gap, 25, 1e-13);
}

// A plane with unit normal n lies between two bodies unless r n < h_a(n) + h_b(n), where h is how far each
// reaches along n: so the ratio is the largest of r n / (h_a(n) + h_b(n)). No normal may give more, and the
// one reported gives as much. Axes differ by up to 1e6, in either body and between them; some are 0.
TEST(EllipsoidContact, IsTheLargestOverAllPlanes) {
    constexpr unsigned kSeed = 1985;
    SCOPED_TRACE("seed " + std::to_string(kSeed));
    std::mt19937_64 random(kSeed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit;
    const auto direction = [&] {
        return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    };
    const auto ellipsoid = [&](int kind) {
        Ellipsoid e;
        e.center = 3.0 * glm::dvec3(normal(random), normal(random), normal(random));
        const double spread = kind % 3 == 0 ? 0.3 : kind % 3 == 1 ? 2 : 6;
        for (int k = 0; k < 3; ++k) e.axes[k] = std::pow(10.0, spread * (unit(random) - 0.5));
        if (kind % 7 == 0) e.axes[static_cast<int>(random() % 3)] = 0;
        e.rotation = glm::mat3_cast(
            glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random))));
        return e;
    };
    double worst = 0, worst_solid = 0;
    for (int i = 0; i < 20000; ++i) {
        const Ellipsoid a = ellipsoid(i), b = ellipsoid(i / 3);
        const glm::dvec3 r = b.center - a.center;
        const EllipsoidContact c = contact_of(a, b);
        ASSERT_NEAR(glm::length(c.normal), 1, 1e-12);
        const double reach = reach_of(a, c.normal) + reach_of(b, c.normal);
        const bool solid = i % 7 && (i / 3) % 7;
        double& largest = solid ? worst_solid : worst;
        largest = std::max(largest, std::abs(glm::dot(r, c.normal) / reach / c.ratio - 1));
        EXPECT_NEAR(c.gap, glm::dot(r, c.normal) - reach, 1e-12 * (glm::length(r) + reach));
        for (int k = 0; k < 20; ++k) {
            // Anywhere, and close by.
            const glm::dvec3 n =
                k < 10 ? direction() : glm::normalize(c.normal + std::pow(10.0, -k / 3.0) * direction());
            EXPECT_LE(glm::dot(r, n) / (reach_of(a, n) + reach_of(b, n)), c.ratio * (1 + 1e-12)) << i;
        }
        // The other way round it is the same.
        EXPECT_NEAR(contact_of(b, a).ratio / c.ratio, 1, 1e-12) << i;
        if (HasFailure()) return;
    }
    // The normal of a disc, which the reach along it magnifies, is known less well than the ratio.
    EXPECT_LT(worst, 1e-8);
    EXPECT_LT(worst_solid, 1e-12);
}

/// The contact function and the normal by their definition: F's derivative in l has the sign of n ((1 - l)^2 A - l^2 B) n with
/// n = ((1 - l) A + l B)^-1 r. Halved in the logarithm of l / (1 - l), in long double.
struct DefinedContact {
    using Real = long double;
    using Vector = glm::vec<3, Real>;
    using Matrix = glm::mat<3, 3, Real>;

    Real ratio = 0;
    Vector normal{Real{0}};

    static Matrix square_of(const Ellipsoid& e) {
        Matrix scaled(e.rotation);
        for (int k = 0; k < 3; ++k) scaled[k] *= Real{e.axes[k]};
        return scaled * glm::transpose(scaled);
    }
    DefinedContact(const Ellipsoid& first, const Ellipsoid& second) {
        const Matrix a = square_of(first), b = square_of(second);
        const Vector r = Vector(second.center) - Vector(first.center);
        Real low = -60, high = 60, l = 0;
        for (int i = 0; i < 80; ++i) {
            const Real middle = 0.5L * (low + high), rest = 1 / (1 + std::exp(middle));
            l = 1 - rest;
            if (middle < 0) l = std::exp(middle) * rest;
            const Matrix m = rest * a + l * b;
            const Vector x = glm::cross(m[1], m[2]), y = glm::cross(m[2], m[0]), z = glm::cross(m[0], m[1]);
            normal = Vector(glm::dot(x, r), glm::dot(y, r), glm::dot(z, r)) / glm::dot(m[0], x);
            ratio = std::sqrt(l * rest * glm::dot(r, normal));
            const Real slope =
                rest * rest * glm::dot(normal, a * normal) - l * l * glm::dot(normal, b * normal);
            (slope > 0 ? low : high) = middle;
        }
        normal = glm::normalize(normal);
    }
};

// Bodies about as large as each other, and up to 1e6 times larger, near and far.
TEST(EllipsoidContact, IsAsDefined) {
    constexpr unsigned kSeed = 40;
    SCOPED_TRACE("seed " + std::to_string(kSeed));
    std::mt19937_64 random(kSeed);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit;
    const auto ellipsoid = [&](double size, double spread, double away) {
        Ellipsoid e;
        e.center = away * glm::dvec3(normal(random), normal(random), normal(random));
        for (int k = 0; k < 3; ++k) e.axes[k] = size * std::pow(10.0, spread * (unit(random) - 0.5));
        e.rotation = glm::mat3_cast(
            glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random))));
        return e;
    };
    for (int i = 0; i < 20000; ++i) {
        const double size = i % 4 ? 1 : std::pow(10.0, 12 * unit(random) - 6);
        const double away = std::pow(10.0, 3 * unit(random) - 1), spread = i % 3;
        const Ellipsoid a = ellipsoid(1, spread, away), b = ellipsoid(size, spread, away);
        const EllipsoidContact c = contact_of(a, b);
        const DefinedContact defined(a, b);
        ASSERT_NEAR(c.ratio / static_cast<double>(defined.ratio), 1, 1e-13) << i;
        ASSERT_LE(glm::distance(c.normal, glm::dvec3(defined.normal)), 1e-12) << i;
    }
}

TEST(EllipsoidContact, NumbersThatAreNone) {
    const double odd[] = {NAN, INFINITY, -INFINITY, 1e308, 1e-308, 0};
    for (const double v : odd)
        for (int k = 0; k < 6; ++k) {
            Ellipsoid a = ball({1, 2, 3}, 4), b = ball({5, 6, 7}, 8);
            (k < 3 ? a.center[k] : a.axes[k - 3]) = v;
            EXPECT_FALSE(contact_of(a, b).ratio < 0);  // it comes back
            EXPECT_FALSE(contact_of(b, a).ratio < 0);
        }
}

}  // namespace
}  // namespace anamorph::test_ellipsoid_distance
