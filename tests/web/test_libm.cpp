// SPDX-License-Identifier: Apache-2.0
// The functions that the page computes (plugins/web/libm.cpp) are the nearest doubles. The reference is the C library's, of long double with its
// 64 bits here (of its error 2^-9 of the double's last place is allowed).
#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include <random>

extern "C" {
double __wrap_sin(double x);
double __wrap_cos(double x);
double __wrap_tan(double x);
double __wrap_asin(double x);
double __wrap_acos(double x);
double __wrap_atan(double x);
double __wrap_atan2(double y, double x);

// The linker's names of what is wrapped.
double __real_sin(double x) {
    return std::sin(x);
}
double __real_cos(double x) {
    return std::cos(x);
}
double __real_tan(double x) {
    return std::tan(x);
}
double __real_atan2(double y, double x) {
    return std::atan2(y, x);
}
}

namespace anamorph::test_libm {
namespace {

void expect_nearest(double found, long double exact) {
    ASSERT_EQ(std::signbit(found), std::signbit(exact)) << exact;
    const double size = std::fabs(found);
    const long double beyond = std::fabs(exact) - static_cast<long double>(size);
    // Below a power of two a double's neighbours are nearer.
    const double place = beyond > 0 ? std::nextafter(size, std::numeric_limits<double>::infinity()) - size
                                    : size - std::nextafter(size, 0.0);
    ASSERT_LE(std::fabs(beyond), (0.5L + 0x1p-9L) * static_cast<long double>(place)) << exact;
}
void expect_nearest_angle(double y, double x) {
    SCOPED_TRACE(testing::Message() << y << ' ' << x);
    expect_nearest(__wrap_atan2(y, x), std::atan2(static_cast<long double>(y), static_cast<long double>(x)));
}

TEST(WebLibm, FunctionsAreTheNearestDoubles) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 20'000; ++i) {
        const double part = unit(random), angle = part * std::exp2(29 * unit(random));
        SCOPED_TRACE(testing::Message() << part << ' ' << angle);
        expect_nearest(__wrap_sin(angle), std::sin(static_cast<long double>(angle)));
        expect_nearest(__wrap_cos(angle), std::cos(static_cast<long double>(angle)));
        expect_nearest(__wrap_tan(angle), std::tan(static_cast<long double>(angle)));
        expect_nearest(__wrap_asin(part), std::asin(static_cast<long double>(part)));
        expect_nearest(__wrap_acos(part), std::acos(static_cast<long double>(part)));
        expect_nearest(__wrap_atan(angle), std::atan(static_cast<long double>(angle)));
    }
    for (const double x : {0.0, -0.0, 1.0, -1.0, HUGE_VAL, -HUGE_VAL}) {
        expect_nearest(__wrap_atan(x), std::atan(static_cast<long double>(x)));
        if (!std::isfinite(x)) continue;
        expect_nearest(__wrap_sin(x), std::sin(static_cast<long double>(x)));
        expect_nearest(__wrap_tan(x), std::tan(static_cast<long double>(x)));
        expect_nearest(__wrap_asin(x), std::asin(static_cast<long double>(x)));
        expect_nearest(__wrap_acos(x), std::acos(static_cast<long double>(x)));
    }
    EXPECT_EQ(__wrap_sin(1e300), std::sin(1e300));
    EXPECT_EQ(__wrap_cos(1e300), std::cos(1e300));
    EXPECT_EQ(__wrap_tan(1e300), std::tan(1e300));
    for (const double x : {2.0, -1.5, double{NAN}})
        EXPECT_TRUE(std::isnan(__wrap_asin(x)) && std::isnan(__wrap_acos(x)));
    EXPECT_TRUE(std::isnan(__wrap_sin(HUGE_VAL)) && std::isnan(__wrap_cos(NAN)) &&
                std::isnan(__wrap_tan(-HUGE_VAL)));
}

TEST(WebLibm, AnglesAreTheNearestDoubles) {
    std::mt19937_64 random(42);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 200'000; ++i) {
        const double x = unit(random);
        expect_nearest_angle(unit(random), x);
        expect_nearest_angle(unit(random) * std::exp2(60 * unit(random)), x);
        expect_nearest_angle(unit(random) * std::exp2(500 * unit(random)), x * std::exp2(500 * unit(random)));
        // Beside the tangents between two angles of the table, and about the diagonals.
        expect_nearest_angle(std::floor(64 * unit(random)) / 128 * (1 + 0x1p-50 * unit(random)), 1);
        expect_nearest_angle(x * (1 + 0x1p-50 * unit(random)), unit(random) < 0 ? x : -x);
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
