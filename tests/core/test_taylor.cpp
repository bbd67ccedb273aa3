// SPDX-License-Identifier: Apache-2.0
// Polynomials of lower degree are as near to those of degree 4 as they say.
#include "anamorph/plan/taylor.h"

#include <gtest/gtest.h>

#include <random>

namespace anamorph::test_taylor {
namespace {

using Quartic = Jet<double, 4>;

/// A polynomial whose coefficients stand degree by degree: those of s^k, s^(k-1) t, ... t^k.
long double value(const double* c, int degree, long double s, long double t) {
    long double sum = 0;
    for (int k = 0; k <= degree; ++k)
        for (int j = 0; j <= k; ++j) sum += *c++ * std::pow(s, k - j) * std::pow(t, j);
    return sum;
}

struct Farthest {
    double cubic = 0, quadratic = 0;
};

/// The largest distances on [-1, 1]^2, on a grid with its corners, edges and middle.
Farthest farthest(const Quartic& f) {
    const EconomizedCubic cubic(f);
    const Economized quadratic(cubic);
    Farthest found;
    constexpr int kSteps = 40;
    for (int j = 0; j <= kSteps; ++j)
        for (int i = 0; i <= kSteps; ++i) {
            const long double s = 2.0L * i / kSteps - 1, t = 2.0L * j / kSteps - 1;
            const long double exact = value(f.c, 4, s, t);
            const auto off = [&](const double* c, int degree) {
                return static_cast<double>(std::fabs(value(c, degree, s, t) - exact));
            };
            found.cubic = std::max(found.cubic, off(cubic.c, 3));
            found.quadratic = std::max(found.quadratic, off(quadratic.c, 2));
        }
    return found;
}

TEST(Taylor, EconomizedPolynomialsAreAsNearAsTheySay) {
    constexpr unsigned kSeed = 1854;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int round = 0; round < 50; ++round) {
        Quartic f;
        for (double& c : f.c) c = any(random);
        const EconomizedCubic cubic(f);
        const Farthest found = farthest(f);
        EXPECT_LE(found.cubic, cubic.error + 1e-14);
        EXPECT_LE(found.quadratic, Economized(cubic).error + 1e-14);
    }
}

// Of one term alone nothing nearer can be said.
TEST(Taylor, OneTermIsAsFarAsItSays) {
    for (int k = 0; k < Quartic::kSize; ++k) {
        SCOPED_TRACE(::testing::Message() << "coefficient " << k);
        Quartic f;
        f.c[k] = -3;
        const EconomizedCubic cubic(f);
        const Farthest found = farthest(f);
        EXPECT_NEAR(found.cubic, cubic.error, 1e-14);
        EXPECT_NEAR(found.quadratic, Economized(cubic).error, 1e-14);
        EXPECT_EQ(cubic.error == 0, k < Quartic::part(4));
        EXPECT_EQ(Economized(cubic).error == 0, k < Quartic::part(3));
    }
}

}  // namespace
}  // namespace anamorph::test_taylor
