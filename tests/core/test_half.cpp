// SPDX-License-Identifier: Apache-2.0
// The reference is arithmetic on the definition of binary16, in double.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "anamorph/image/pixel.h"
#include "anamorph/number/half.h"

namespace anamorph::test_half {
namespace {

float reference(std::uint16_t half) {
    const int exponent = (half >> 10) & 31, fraction = half & 1023;
    const double sign = half & 0x8000 ? -1 : 1;
    if (exponent == 31)
        return fraction ? std::numeric_limits<float>::quiet_NaN()
                        : static_cast<float>(sign * std::numeric_limits<double>::infinity());
    const int significand = exponent == 0 ? fraction : fraction + 1024;
    return static_cast<float>(sign * std::ldexp(significand, std::max(exponent, 1) - 25));
}

std::uint16_t reference(float value) {
    const unsigned sign = std::signbit(value) ? 0x8000 : 0;
    const double magnitude = std::fabs(static_cast<double>(value));
    if (magnitude >= 65520) return static_cast<std::uint16_t>(sign | 0x7c00);
    const int exponent = magnitude == 0 ? -14 : std::max(std::ilogb(magnitude), -14);
    // In units of the last place, ties to even; a significand of 2048 is 1024 with the next exponent.
    const unsigned significand = static_cast<unsigned>(std::nearbyint(std::ldexp(magnitude, 10 - exponent)));
    return static_cast<std::uint16_t>(sign | ((static_cast<unsigned>(exponent + 14) << 10) + significand));
}

TEST(Half, EveryHalfBecomesItsFloatAndBack) {
    for (unsigned i = 0; i < 65536; ++i) {
        const std::uint16_t half = static_cast<std::uint16_t>(i);
        const float value = float_from_half(half);
        if (std::isnan(reference(half))) {
            ASSERT_TRUE(std::isnan(value)) << half;
            ASSERT_TRUE(std::isnan(reference(half_from_float(value)))) << half;
            ASSERT_EQ(std::signbit(value), half >= 0x8000) << half;
            continue;
        }
        ASSERT_EQ(std::bit_cast<std::uint32_t>(value), std::bit_cast<std::uint32_t>(reference(half))) << half;
        ASSERT_EQ(half_from_float(value), half);
    }
}

TEST(Half, RoundsToNearestEvenBetweenAllNeighbours) {
    for (unsigned i = 0; i < 0x7c00; ++i) {
        // Past the largest half the next one would be 2^16.
        const double low = float_from_half(static_cast<std::uint16_t>(i));
        const double high = i == 0x7bff ? 65536.0 : float_from_half(static_cast<std::uint16_t>(i + 1));
        const float middle = static_cast<float>(0.5 * (low + high));
        const std::uint16_t even = static_cast<std::uint16_t>(i % 2 == 0 ? i : i + 1);
        ASSERT_EQ(half_from_float(middle), even) << i;
        ASSERT_EQ(half_from_float(std::nextafterf(middle, 0)), i) << i;
        ASSERT_EQ(half_from_float(std::nextafterf(middle, 1e30f)), i + 1) << i;
        ASSERT_EQ(half_from_float(-middle), even | 0x8000u) << i;
    }
}

TEST(Half, FloatsOfAllMagnitudesAgreeWithTheCompiler) {
    constexpr unsigned kSeed = 11;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    for (int i = 0; i < 2'000'000; ++i) {
        const float value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
        if (std::isnan(value))
            ASSERT_TRUE(std::isnan(reference(half_from_float(value))));
        else
            ASSERT_EQ(half_from_float(value), reference(value)) << value;
    }
}

TEST(Half, InfinitiesStay) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(half_from_float(kInfinity), 0x7c00);
    EXPECT_EQ(half_from_float(-kInfinity), 0xfc00);
    EXPECT_EQ(float_from_half(0x7c00), kInfinity);
    EXPECT_EQ(half_from_float(65519.996f), 0x7bff);
    EXPECT_EQ(half_from_float(65520.0f), 0x7c00);
}

TEST(Pixel, EveryStoredValueComesBack) {
    for (const PixelType type : {PixelType::uint8, PixelType::uint16}) {
        const int limit = type == PixelType::uint8 ? 255 : 65535;
        for (int i = 0; i <= limit; ++i) {
            std::byte bytes[sizeof(float)] = {};
            const float value = static_cast<float>(static_cast<double>(i) / limit);
            store_channel(value, bytes, type);
            ASSERT_EQ(load_channel(bytes, type), value) << i;
        }
    }
}

TEST(Pixel, StoringRoundsAndClamps) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const auto stored = [](float value, PixelType type) {
        std::byte bytes[sizeof(float)] = {};
        store_channel(value, bytes, type);
        return type == PixelType::uint8 ? std::to_integer<int>(bytes[0])
                                        : int{pixel_detail::get<std::uint16_t>(bytes)};
    };
    for (const PixelType type : {PixelType::uint8, PixelType::uint16}) {
        const int limit = type == PixelType::uint8 ? 255 : 65535;
        EXPECT_EQ(stored(kNan, type), 0);
        EXPECT_EQ(stored(-kInfinity, type), 0);
        EXPECT_EQ(stored(-1e-30f, type), 0);
        EXPECT_EQ(stored(kInfinity, type), limit);
        EXPECT_EQ(stored(1.5f, type), limit);
        EXPECT_EQ(stored(std::nextafterf(1, 0), type), limit);
        EXPECT_EQ(stored(10.49f / static_cast<float>(limit), type), 10);
        EXPECT_EQ(stored(10.51f / static_cast<float>(limit), type), 11);
    }
}

TEST(Pixel, AlphaMultipliesAndDividesColour) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    float pixel[] = {0.5f, kNan, 0.25f, 3};
    associate_alpha(pixel, 4, 2);
    EXPECT_EQ(pixel[0], 0.125f);
    EXPECT_TRUE(std::isnan(pixel[1]));
    EXPECT_EQ(pixel[2], 0.25f);
    EXPECT_EQ(pixel[3], 0.75f);
    unassociate_alpha(pixel, 4, 2);
    EXPECT_EQ(pixel[0], 0.5f);
    EXPECT_EQ(pixel[3], 3);

    float clear[] = {kNan, 5, 0};
    associate_alpha(clear, 3, 2);
    EXPECT_EQ(clear[0], 0);
    EXPECT_EQ(clear[1], 0);
    unassociate_alpha(clear, 3, 2);
    EXPECT_EQ(clear[1], 0);
}

}  // namespace
}  // namespace anamorph::test_half
