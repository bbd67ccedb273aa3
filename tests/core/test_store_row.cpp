// SPDX-License-Identifier: Apache-2.0
// Rows are stored without a byte read or written past their end: both stand against a page that must not be
// touched. Values in and out are rounded as stated on every instruction set.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "anamorph/image/block_sampler.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/window.h"
#include "guarded_memory.h"

namespace anamorph::test_store_row {
namespace {

TEST(StoreRow, StaysWithinItsRow) {
    const test::GuardedMemory from, to;
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        SCOPED_TRACE(*set);
        ASSERT_TRUE(simd::use_instruction_set(*set));
        for (const PixelType type :
             {PixelType::uint8, PixelType::uint16, PixelType::half, PixelType::float32})
            for (int count = 1; count <= 70; ++count) {
                const auto n = static_cast<std::size_t>(count);
                auto* values = reinterpret_cast<float*>(from.last(n * sizeof(float)));
                for (int i = 0; i < count; ++i) values[i] = static_cast<float>(i);
                std::byte* row = to.last(n * static_cast<std::size_t>(size_of(type)));
                simd::store_row(values, count, 1, type, row);
                simd::finish_stores();
                const float one = type == PixelType::uint8    ? 255.0f
                                  : type == PixelType::uint16 ? 65535.0f
                                                              : 1.0f;
                for (int i = 0; i < count; ++i)
                    EXPECT_EQ(std::round(load_channel(row + i * size_of(type), type) * one), i) << count;
            }
    }
    simd::use_instruction_set("");
}

/// binary16 by its definition.
double value_of(unsigned half) {
    const int exponent = static_cast<int>((half >> 10) & 31), fraction = static_cast<int>(half & 1023);
    const double sign = half & 0x8000 ? -1 : 1;
    if (exponent == 31) return fraction ? std::nan("") : sign * HUGE_VAL;
    return sign * std::ldexp(exponent ? 1024 + fraction : fraction, std::max(exponent, 1) - 25);
}

TEST(StoreRow, HalvesAreRoundedToNearestEvenOnEveryInstructionSet) {
    // Every half, every middle of two and its neighbours in float, and the half that each becomes.
    std::vector<float> values;
    std::vector<std::uint16_t> expected;
    const auto add = [&](float value, unsigned half) {
        values.insert(values.end(), {value, -value});
        expected.push_back(static_cast<std::uint16_t>(half));
        expected.push_back(static_cast<std::uint16_t>(half | 0x8000));
    };
    for (unsigned half = 0; half < 0x7c00; ++half) {
        const double low = value_of(half), high = half == 0x7bff ? 65536 : value_of(half + 1);
        const auto middle = static_cast<float>(0.5 * (low + high));
        add(static_cast<float>(low), half);
        add(std::nextafterf(middle, 0), half);
        add(middle, half + half % 2);
        add(std::nextafterf(middle, 1e30f), half + 1);
    }
    add(1e30f, 0x7c00);
    add(HUGE_VALF, 0x7c00);
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        SCOPED_TRACE(*set);
        ASSERT_TRUE(simd::use_instruction_set(*set));
        std::vector<std::uint16_t> stored(values.size() + 1);
        simd::store_row(values.data(), static_cast<int>(values.size()), 1, PixelType::half,
                        reinterpret_cast<std::byte*>(stored.data()));
        const float nan = std::nanf("");
        simd::store_row(&nan, 1, 1, PixelType::half, reinterpret_cast<std::byte*>(&stored.back()));
        simd::finish_stores();
        EXPECT_TRUE(std::isnan(value_of(stored.back())));
        stored.pop_back();
        EXPECT_TRUE(stored == expected);
    }
    simd::use_instruction_set("");
}

TEST(StoreRow, IntegersAreRoundedAndClampedOnEveryInstructionSet) {
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        SCOPED_TRACE(*set);
        ASSERT_TRUE(simd::use_instruction_set(*set));
        for (const PixelType type : {PixelType::uint8, PixelType::uint16}) {
            const int one = type == PixelType::uint8 ? 255 : 65535;
            std::vector<float> values = {std::nanf(""), -std::nanf(""), HUGE_VALF, -HUGE_VALF,
                                         -1e30f,        1e30f,          -1,        -0.4f,
                                         -0.0f,         1e-40f,         0x1p31f,   0x1p32f};
            std::vector<int> expected = {0, 0, one, 0, 0, one, 0, 0, 0, 0, one, one};
            for (int n = 0; n < one; ++n) {
                const float middle = static_cast<float>(n) + 0.5f;
                values.insert(values.end(), {static_cast<float>(n), std::nextafterf(middle, 0), middle,
                                             std::nextafterf(middle, 1e9f)});
                expected.insert(expected.end(), {n, n, n + n % 2, n + 1});
            }
            values.insert(values.end(), {static_cast<float>(one), static_cast<float>(one) + 0.5f});
            expected.insert(expected.end(), {one, one});
            const auto pixel = static_cast<std::size_t>(size_of(type));
            std::vector<std::byte> stored(values.size() * pixel);
            simd::store_row(values.data(), static_cast<int>(values.size()), 1, type, stored.data());
            simd::finish_stores();
            int wrong = 0;
            for (std::size_t i = 0; i < values.size(); ++i) {
                int got = 0;  // the machines this runs on are little-endian
                std::memcpy(&got, stored.data() + i * pixel, pixel);
                wrong += got != expected[i];
            }
            EXPECT_EQ(wrong, 0);
        }
    }
    simd::use_instruction_set("");
}

TEST(SampleRow, EveryHalfIsLoadedOnEveryInstructionSet) {
    std::vector<std::uint16_t> texels(65536 + Window::kSlack);
    for (unsigned i = 0; i < 65536; ++i) texels[i] = static_cast<std::uint16_t>(i);
    float x[simd::kRowRoom] = {}, y[simd::kRowRoom] = {};
    for (int i = 0; i < simd::kMaxRow; ++i) x[i] = static_cast<float>(i);
    const simd::Tap tap;
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        SCOPED_TRACE(*set);
        ASSERT_TRUE(simd::use_instruction_set(*set));
        int wrong = 0;
        for (unsigned first = 0; first < 65536; first += simd::kMaxRow) {
            float out[simd::kMaxRow + 16];
            simd::sample_row({reinterpret_cast<const std::byte*>(&texels[first]), 131072, PixelType::half, 1,
                              simd::Kernel::nearest, &tap, 1},
                             {x, y, simd::kMaxRow}, out);
            for (unsigned i = 0; i < simd::kMaxRow; ++i) {
                const double value = value_of(first + i);
                wrong += std::isnan(value) ? !std::isnan(out[i])
                                           : out[i] != static_cast<float>(value) ||
                                                 std::signbit(out[i]) != std::signbit(value);
            }
        }
        EXPECT_EQ(wrong, 0);
    }
    simd::use_instruction_set("");
}

}  // namespace
}  // namespace anamorph::test_store_row
