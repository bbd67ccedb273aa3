// SPDX-License-Identifier: Apache-2.0
// Means over rectangles by sums, against the plain sum over texels.
#include "anamorph/render/summed_area.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace anamorph {
namespace {

constexpr int kWidth = 12, kHeight = 7;

/// The texel that stands at (x, y), any distance beyond the edges.
int texel_at(long x, long y, SummedEdges edges) {
    const auto modulo = [](long a, long b) { return (a % b + b) % b; };
    y = modulo(y, 2 * kHeight);
    const bool over = y >= kHeight;
    if (over) y = 2 * kHeight - 1 - y;
    if (edges == SummedEdges::turn) {
        x = modulo(x + (over ? kWidth / 2 : 0), kWidth);
    } else {
        x = modulo(x, 2 * kWidth);
        if (x >= kWidth) x = 2 * kWidth - 1 - x;
    }
    return static_cast<int>(y * kWidth + x);
}

TEST(SummedArea, MeansAreThoseOfTheTexels) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> value;
    std::vector<float> texels(kWidth * kHeight * 2);
    for (float& t : texels) t = value(random);
    const MemorySource source(packed_view(reinterpret_cast<const std::byte*>(texels.data()),
                                          PixelType::float32, kWidth, kHeight, 2));
    for (const SummedEdges edges : {SummedEdges::turn, SummedEdges::reflected}) {
        const auto area = SummedArea::of(source, edges);
        ASSERT_TRUE(area);
        for (int k = 0; k < 2000; ++k) {
            const double x = std::uniform_real_distribution<double>(-30, 30)(random),
                         y = std::uniform_real_distribution<double>(-20, 20)(random),
                         a = std::uniform_real_distribution<double>(0.5, kWidth * 0.5)(random),
                         b = std::uniform_real_distribution<double>(0.5, kHeight * 0.5)(random);
            double sums[2] = {0, 0};
            for (long j = std::lround(std::floor(y - b)); j < y + b; ++j)
                for (long i = std::lround(std::floor(x - a)); i < x + a; ++i) {
                    const double across = std::min(i + 1.0, x + a) - std::max(double(i), x - a),
                                 down = std::min(j + 1.0, y + b) - std::max(double(j), y - b);
                    for (int c = 0; c < 2; ++c)
                        sums[c] += across * down *
                                   static_cast<double>(
                                       texels[static_cast<std::size_t>(2 * texel_at(i, j, edges) + c)]);
                }
            float mean[2];
            area->mean(x, y, a, b, mean);
            for (int c = 0; c < 2; ++c)
                ASSERT_NEAR(static_cast<double>(mean[c]), sums[c] / (4 * a * b), 2e-6)
                    << x << " " << y << " " << a << " " << b;
        }
    }
}

TEST(SummedArea, SmallAndLargeAndNoNumbers) {
    std::vector<float> texels(kWidth * kHeight, 0.25f);
    texels[3] = NAN;
    texels[4] = INFINITY;
    const MemorySource source(packed_view(reinterpret_cast<const std::byte*>(texels.data()),
                                          PixelType::float32, kWidth, kHeight, 1));
    const auto area = SummedArea::of(source, SummedEdges::turn);
    float mean = 0;
    area->mean(6.5, 4.5, 0, 0, &mean);
    EXPECT_EQ(mean, 0.25f);
    for (const double far : {1e300, -1e15, HUGE_VAL, -HUGE_VAL, std::nan("")})
        for (const double half : {0.0, 1e300, HUGE_VAL, std::nan("")}) {
            area->mean(far, 1, half, 1, &mean);
            EXPECT_TRUE(mean >= 0 && mean <= 0.2501f) << far << " " << half << " " << mean;
            area->mean(1, far, 1, half, &mean);
            EXPECT_TRUE(mean >= 0 && mean <= 0.2501f) << far << " " << half << " " << mean;
        }
    const float one = 0.5f;
    const MemorySource dot(
        packed_view(reinterpret_cast<const std::byte*>(&one), PixelType::float32, 1, 1, 1));
    SummedArea::of(dot, SummedEdges::reflected)->mean(-7.25, 3.5, 2, 0.1, &mean);
    EXPECT_EQ(mean, 0.5f);
}

}  // namespace
}  // namespace anamorph
