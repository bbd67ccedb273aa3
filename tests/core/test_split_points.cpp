// SPDX-License-Identifier: Apache-2.0
// Points in double, split into whole texels and the rest, on every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "anamorph/image/block_sampler.h"
#include "anamorph/image/split_points.h"
#include "each_instruction_set.h"

namespace anamorph::test_split_points {
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

/// Rows of 2.5 with another value somewhere in them, and values behind them that do not count.
template <class Real>
void expect_ends(int width, int height) {
    constexpr Real kNaN = std::numeric_limits<Real>::quiet_NaN();
    const std::ptrdiff_t stride = width + 16;
    std::vector<Real> values(std::size_t(stride * height), Real(1e9));
    const auto at = [&](int i, int j) -> Real& { return values[std::size_t(j * stride + i)]; };
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) at(i, j) = Real(2.5);
    const simd::ValueRows<Real> rows{values.data(), stride, width, height};
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            SCOPED_TRACE(testing::Message() << i << ", " << j << " of " << width << " x " << height);
            at(i, j) = -7;
            simd::Ends ends = simd::ends_of(rows);
            EXPECT_EQ(ends.low, -7);
            EXPECT_EQ(ends.high, width * height > 1 ? 2.5 : -7);
            if (i > 0) {
                // What leads from each to the next.
                ends = simd::ends_of(simd::ValueRows<Real>{values.data(), stride, width - 1, height, 1});
                EXPECT_EQ(ends.low, -9.5);
                EXPECT_EQ(ends.high, i + 1 < width ? 9.5 : width > 2 || height > 1 ? 0 : -9.5);
            }
            at(i, j) = std::numeric_limits<Real>::max();
            EXPECT_EQ(simd::ends_of(rows).high, std::numeric_limits<Real>::max());
            for (const Real none : {kNaN, std::numeric_limits<Real>::infinity()}) {
                at(i, j) = none;
                ends = simd::ends_of(rows);
                EXPECT_TRUE(std::isnan(ends.low) && std::isnan(ends.high));
            }
            at(i, j) = Real(2.5);
        }
}

TEST(EndsOf, FindsTheEndsAndWhatIsNoNumber) {
    test::on_every_instruction_set([&] {
        for (const int width : {1, 3, 8, 15, 16, 17, 29, 64})
            for (const int height : {1, 3}) {
                expect_ends<float>(width, height);
                expect_ends<double>(width, height);
            }
    });
}

TEST(PlaceIn, CountsTexelsFromTheCornerAndFindsThoseOutside) {
    constexpr unsigned kSeed = 5;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    constexpr int kCount = 61;
    const simd::Readable all_around[] = {{{0, 3, 100, 40}, 1, 100, 100},
                                         {{0, 3, 101, 40}, 2, 101, 100},
                                         {{7, 3, 60, 40}, 1, 101, 0},
                                         {{7, 3, 60, 40}, 0, 101, 0}};
    for (const auto& readable : all_around)
        test::on_every_instruction_set([&] {
            const Box& box = readable.box;
            const int reach = readable.reach;
            std::uniform_int_distribution<std::int32_t> row(0, 43);
            std::vector<std::int32_t> x(kCount + 16), y(kCount + 16), outside(kCount + 16);
            for (int from = -150; from < 250; from += kCount) {
                std::iota(x.begin(), x.end(), from);
                for (auto& v : y) v = row(random);
                const auto from_x = x, from_y = y;
                const bool any = simd::place_in(readable, kCount, x.data(), y.data(), outside.data());
                EXPECT_TRUE(any);
                for (std::size_t i = 0; i < kCount; ++i) {
                    int at = from_x[i], end = box.x1;
                    if (readable.turn > 0 && (at + reach < 0 || at - reach >= readable.width)) {
                        at += at < 0 ? readable.turn : -readable.turn;
                        end = readable.turn;
                    }
                    const bool is_in = at - reach >= box.x0 && at + reach < end &&
                                       from_y[i] - reach >= box.y0 && from_y[i] + reach < box.y1;
                    EXPECT_EQ(outside[i] == 0, is_in) << from_x[i] << ", " << from_y[i];
                    EXPECT_EQ(x[i], is_in ? at - box.x0 : reach);
                    EXPECT_EQ(y[i], is_in ? from_y[i] - box.y0 : reach);
                }
            }
            // All inside.
            std::fill(x.begin(), x.end(), box.x0 + reach);
            std::fill(y.begin(), y.end(), box.y1 - 1 - reach);
            EXPECT_FALSE(simd::place_in(readable, kCount, x.data(), y.data(), outside.data()));
        });
}

}  // namespace
}  // namespace anamorph::test_split_points
