// SPDX-License-Identifier: Apache-2.0
// The angle that the page computes (plugins/web/libm.cpp) is the nearest double. The reference is the C library's, of long double with its
// 64 bits here (of its error 2^-9 of the double's last place is allowed), where the page's own long double is not asked.
#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include <random>

extern "C" double __wrap_atan2(double y, double x);

namespace anamorph::test_libm {
namespace {

void expect_nearest(double y, double x) {
    const double found = __wrap_atan2(y, x);
    const long double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    ASSERT_EQ(std::signbit(found), std::signbit(exact)) << y << ' ' << x;
    const double size = std::fabs(found);
    const long double beyond = std::fabs(exact) - static_cast<long double>(size);
    // Below a power of two a double's neighbours are nearer.
    const double place = beyond > 0 ? std::nextafter(size, std::numeric_limits<double>::infinity()) - size
                                    : size - std::nextafter(size, 0.0);
    ASSERT_LE(std::fabs(beyond), (0.5L + 0x1p-9L) * static_cast<long double>(place)) << y << ' ' << x;
}

TEST(WebLibm, AnglesAreTheNearestDoubles) {
    std::mt19937_64 random(42);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 200'000; ++i) {
        const double x = unit(random);
        expect_nearest(unit(random), x);
        expect_nearest(unit(random) * std::exp2(60 * unit(random)), x);
        expect_nearest(unit(random) * std::exp2(500 * unit(random)), x * std::exp2(500 * unit(random)));
        // Beside the tangents between two angles of the table, and about the diagonals.
        expect_nearest(std::floor(64 * unit(random)) / 128 * (1 + 0x1p-50 * unit(random)), 1);
        expect_nearest(x * (1 + 0x1p-50 * unit(random)), unit(random) < 0 ? x : -x);
    }
}

TEST(WebLibm, AnglesOfSpecialNumbersAreTheCLibrarys) {
    const double infinity = std::numeric_limits<double>::infinity(),
                 least = std::numeric_limits<double>::denorm_min(), most = std::numeric_limits<double>::max();
    const double all[] = {0.0, -0.0, 1.0, -1.0, infinity, -infinity, least, -least, 1e-320, most, -most};
    for (const double y : all)
        for (const double x : all) {
            const double found = __wrap_atan2(y, x), expected = std::atan2(y, x);
            EXPECT_EQ(found, expected) << y << ' ' << x;
            EXPECT_EQ(std::signbit(found), std::signbit(expected)) << y << ' ' << x;
        }
    EXPECT_TRUE(std::isnan(__wrap_atan2(NAN, 1)));
    EXPECT_TRUE(std::isnan(__wrap_atan2(1, NAN)));
}

}  // namespace
}  // namespace anamorph::test_libm
