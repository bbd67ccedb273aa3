// SPDX-License-Identifier: Apache-2.0
// The root of a sum of squares: near the exact one, and the same bits on every processor.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "anamorph/number/double_double.h"
#include "anamorph/number/hypot.h"

namespace anamorph::test_hypot {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A number of either sign with an exponent from `least` to `most`.
double number(std::mt19937& random, int least, int most) {
    const double upper = random() * 0x1p-32, lower = random() * 0x1p-64, fraction = 1 + upper + lower;
    const int exponent = least + static_cast<int>(random() % static_cast<unsigned>(most - least + 1));
    return std::ldexp(random() % 2 ? fraction : -fraction, exponent);
}

// DoubleDouble's is off by less than 2^-100 of it.
TEST(Hypot, IsWithinOneUnitOfTheExactRoot) {
    std::mt19937 random(20261201);
    SCOPED_TRACE("seed 20261201");
    for (const int range : {2, 60, 600, 1020}) {
        double worst = 0;
        for (int i = 0; i < 50'000; ++i) {
            const double x = number(random, -range, range), y = number(random, -range, range);
            const DoubleDouble exact = hypot(DoubleDouble(x), DoubleDouble(y));
            const double result = hypot(x, y);
            ASSERT_EQ(result, hypot(-y, x)) << x << ' ' << y;
            const double unit = std::ldexp(1, std::ilogb(exact.upper()) - 52);
            worst = std::max(worst, std::fabs(static_cast<double>(DoubleDouble(result) - exact)) / unit);
        }
        EXPECT_LT(worst, 1) << range;
    }
}

TEST(Hypot, OfThreeIsNearTheExactRoot) {
    std::mt19937 random(7);
    SCOPED_TRACE("seed 7");
    for (int i = 0; i < 50'000; ++i) {
        const double x = number(random, -30, 30), y = number(random, -30, 30), z = number(random, -30, 30);
        const DoubleDouble exact = hypot(hypot(DoubleDouble(x), DoubleDouble(y)), DoubleDouble(z));
        EXPECT_LE(std::fabs(static_cast<double>(DoubleDouble(hypot(x, y, z)) / exact - 1)), 0x1p-50);
    }
    EXPECT_DOUBLE_EQ(hypot(2e300, 3e300, 6e300), 7e300);
    EXPECT_EQ(hypot(0, 0, 0), 0);
    EXPECT_EQ(hypot(0, -kInfinity, kNaN), kInfinity);
    EXPECT_TRUE(std::isnan(hypot(1, kNaN, 2)));
    EXPECT_TRUE(std::isnan(hypot(kNaN, 0, 0)));
}

TEST(Hypot, OfNumbersAtTheEnds) {
    constexpr double kMost = std::numeric_limits<double>::max(),
                     kLeast = std::numeric_limits<double>::denorm_min();
    EXPECT_EQ(hypot(3, 4), 5);
    EXPECT_EQ(hypot(3 * 0x1p1000, -4 * 0x1p1000), 5 * 0x1p1000);
    EXPECT_EQ(hypot(3 * kLeast, 4 * kLeast), 5 * kLeast);
    EXPECT_EQ(hypot(0, -7), 7);
    EXPECT_EQ(hypot(0, 0), 0);
    EXPECT_EQ(hypot(1, 0x1p-25), 1 + 0x1p-51);
    EXPECT_EQ(hypot(kMost, 1), kMost);
    EXPECT_EQ(hypot(kMost, kMost), kInfinity);
    EXPECT_EQ(hypot(kNaN, -kInfinity), kInfinity);
    EXPECT_EQ(hypot(kInfinity, 1), kInfinity);
    EXPECT_TRUE(std::isnan(hypot(kNaN, 0)));
    EXPECT_TRUE(std::isnan(hypot(1, kNaN)));
}

/// All bits of the roots of ten thousand pairs, as one number.
std::uint64_t bits_of_many() {
    std::mt19937 random(42);
    std::uint64_t bits = 0;
    for (int i = 0; i < 10'000; ++i) {
        const double x = number(random, -12, 12), y = number(random, -12, 12);
        bits = (bits ^ std::bit_cast<std::uint64_t>(hypot(x, y))) * 0x9e3779b97f4a7c15u;
    }
    return bits;
}

TEST(Hypot, HasTheSameBitsOnEveryProcessor) {
    EXPECT_EQ(bits_of_many(), 0x224aa19642c67659u);
}

}  // namespace
}  // namespace anamorph::test_hypot
