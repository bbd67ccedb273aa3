// SPDX-License-Identifier: Apache-2.0
// Points in double, split into whole texels and the rest, on every instruction set.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "anamorph/simd/block_sampler.h"
#include "anamorph/simd/split_points.h"
#include "each_instruction_set.h"

namespace anamorph {
namespace {

TEST(SplitPoints, WholeAndRestAreThePoint) {
    constexpr unsigned kSeed = 11;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    constexpr int kCount = 61;
    std::vector<double> points(kCount + 16);
    for (int i = 0; i < kCount; ++i) points[std::size_t(i)] = std::ldexp(uniform(random), i / 2);
    // Whole, next to whole, and what float would round up to the next texel.
    points[0] = 0;
    points[1] = -3;
    points[2] = std::nextafter(5.0, 0.0);
    points[3] = std::nextafter(-7.0, 0.0);
    points[4] = 9 - 0x1p-40;
    for (const double scale : {1.0, 0.25, 1 / 3.0})
        test::on_every_instruction_set([&] {
            std::vector<std::int32_t> texels(kCount + 16);
            std::vector<float> rests(kCount + 16);
            simd::split_points(points.data(), kCount, scale, -12, texels.data(), rests.data());
            for (std::size_t i = 0; i < kCount; ++i) {
                const double at = points[i] * scale;
                EXPECT_EQ(texels[i] - 12, std::floor(at)) << at;
                EXPECT_GE(rests[i], 0) << at;
                EXPECT_LT(rests[i], 1) << at;
                EXPECT_LE(std::fabs(texels[i] - 12 + double{rests[i]} - at), 0x1p-24) << at;
            }
        });
}

TEST(ExtendRange, FindsTheEndsAndWhatIsNoNumber) {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    test::on_every_instruction_set([&] {
        for (std::size_t count : {1U, 3U, 8U, 29U})
            for (std::size_t at = 0; at < count; ++at) {
                std::vector<double> values(count, 2.5);
                double low = 2, high = 3;
                values[at] = -7;
                simd::extend_range(values.data(), int(count), low, high);
                EXPECT_EQ(low, -7);
                EXPECT_EQ(high, 3);
                values[at] = 1e300;
                simd::extend_range(values.data(), int(count), low, high);
                EXPECT_EQ(high, 1e300);
                values[at] = kNaN;
                simd::extend_range(values.data(), int(count), low, high);
                EXPECT_FALSE(low <= high);
                // It stays so.
                values[at] = 0;
                simd::extend_range(values.data(), int(count), low, high);
                EXPECT_FALSE(low <= high);
            }
    });
}

TEST(PlaceIn, CountsTexelsFromTheCornerAndFindsThoseOutside) {
    constexpr unsigned kSeed = 5;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    constexpr int kCount = 61;
    const simd::Readable all_around[] = {{{0, 3, 100, 40}, 1, 100, 100},
                                         {{0, 3, 100, 40}, 2, 101, 100},
                                         {{7, 3, 60, 40}, 1, 101, 0},
                                         {{7, 3, 60, 40}, 0, 101, 0}};
    for (const auto& readable : all_around)
        test::on_every_instruction_set([&] {
            const Box& box = readable.box;
            const int reach = readable.reach;
            std::uniform_int_distribution<std::int32_t> column(-150, 250), row(0, 43);
            std::vector<std::int32_t> x(kCount + 16), y(kCount + 16), outside(kCount + 16);
            for (auto& v : x) v = column(random);
            for (auto& v : y) v = row(random);
            const auto from_x = x, from_y = y;
            const bool any = simd::place_in(readable, kCount, x.data(), y.data(), outside.data());
            for (std::size_t i = 0; i < kCount; ++i) {
                int at = from_x[i], end = box.x1;
                if (readable.turn > 0 && (at + reach < 0 || at - reach >= readable.width)) {
                    at += at < 0 ? readable.turn : -readable.turn;
                    end = readable.turn;
                }
                const bool is_in = at - reach >= box.x0 && at + reach < end && from_y[i] - reach >= box.y0 &&
                                   from_y[i] + reach < box.y1;
                EXPECT_EQ(outside[i] == 0, is_in) << from_x[i] << ", " << from_y[i];
                EXPECT_EQ(x[i], is_in ? at - box.x0 : reach);
                EXPECT_EQ(y[i], is_in ? from_y[i] - box.y0 : reach);
            }
            EXPECT_TRUE(any);
            // All inside.
            std::fill(x.begin(), x.end(), box.x0 + reach);
            std::fill(y.begin(), y.end(), box.y1 - 1 - reach);
            EXPECT_FALSE(simd::place_in(readable, kCount, x.data(), y.data(), outside.data()));
        });
}

}  // namespace
}  // namespace anamorph
