// SPDX-License-Identifier: Apache-2.0
// Bump maps of V8U8 and V16U16 against rounding written out, and the bound of what is read of them against reading at random.
#include "anamorph/machine/bump_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace anamorph::test_bump_table {
using namespace machine;
namespace {

BumpTexels smooth(unsigned seed, int columns, int rows) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> some(-1, 1);
    const double a = some(random), b = some(random), c = some(random);
    BumpTexels texels;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
            texels.push_back({0.03 * std::sin(6 * a * i / columns + 5.0 * j / rows),
                              0.02 * (b * i / columns + c * j / rows) * std::cos(4.0 * j / rows)});
    return texels;
}

TEST(BumpTable, TexelsAreSignedNumbersOfTheirBits) {
    const BumpTexels residuals = smooth(3, 40, 30);
    for (const int bits : {8, 16})
        for (const bool scaled : {false, true}) {
            const BumpTable table = bump_table(residuals, bits == 8 ? kSigned8 : kSigned16, scaled);
            const long double unit = std::ldexp(1.0L, bits - 1);
            for (std::size_t c = 0; c < 2; ++c) {
                long double most = 0;
                for (const auto& r : residuals) most = std::max(most, std::fabs((long double)r[c]));
                const long double scale = scaled ? most / ((unit - 1) / unit) : 1;
                EXPECT_NEAR(table.scale[c], double(scale), 1e-15);
                for (std::size_t i = 0; i < residuals.size(); ++i) {
                    const long double units = table.texels[i][c] * unit,
                                      exact = residuals[i][c] / scale * unit;
                    EXPECT_EQ(units, std::nearbyint(units));
                    EXPECT_LE(std::fabs(units - exact), 0.5L + 1e-9L);
                    EXPECT_LE(std::fabs(units), unit);
                }
            }
            EXPECT_EQ(table.saturated, 0);
        }
    // What the range does not hold.
    const BumpTable beyond = bump_table({{2, -3}, {0.5, 0.5}, {-1, 0}}, kSigned8, false);
    EXPECT_EQ(beyond.saturated, 1);
    EXPECT_EQ(beyond.texels[0][0], 127.0 / 128);
    EXPECT_EQ(beyond.texels[0][1], -1);
    EXPECT_EQ(beyond.texels[2][0], -1);
    EXPECT_NEAR(reading_error({{2, -3}, {0.5, 0.5}, {-1, 0}}, beyond, 3, 23)[1], 2, 1e-6);
    // Nothing to scale, and floats, which need none.
    EXPECT_EQ(bump_table({{0, 0}}, kSigned8, true).scale[0], 1);
    EXPECT_EQ(bump_table({{0.3, 0.2}}, kFloat16, true).scale[0], 1);
}

TEST(BumpTable, WhatIsReadHoldsItsBound) {
    constexpr int kColumns = 24, kRows = 17;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> across(0, kColumns - 1), down(0, kRows - 1);
    for (const NumberFormat& format : {kSigned8, kSigned16, kFloat32})
        for (const int weight_bits : {0, 3, 8, 23}) {
            const BumpTexels residuals = smooth(5, kColumns, kRows);
            const BumpTable table = bump_table(residuals, format, true);
            const auto bound = reading_error(residuals, table, kColumns, weight_bits);
            long double worst[2] = {0, 0};
            const long double unit = std::ldexp(1.0L, weight_bits);
            for (int n = 0; n < 20000; ++n) {
                const double x = across(random), y = down(random);
                const int i = std::min(int(x), kColumns - 2), j = std::min(int(y), kRows - 2);
                const long double s = x - i, t = y - j, rs = std::nearbyint(s * unit) / unit,
                                  rt = std::nearbyint(t * unit) / unit;
                const auto read = [&](const BumpTexels& of, std::size_t c, long double p, long double q) {
                    const auto at = [&](int a, int b) {
                        return (long double)of[static_cast<std::size_t>((j + b) * kColumns + i + a)][c];
                    };
                    return (1 - q) * ((1 - p) * at(0, 0) + p * at(1, 0)) +
                           q * ((1 - p) * at(0, 1) + p * at(1, 1));
                };
                for (std::size_t c = 0; c < 2; ++c)
                    worst[c] = std::max(worst[c], std::fabs(read(table.texels, c, rs, rt) * table.scale[c] -
                                                            read(residuals, c, s, t)));
            }
            for (std::size_t c = 0; c < 2; ++c) {
                EXPECT_LE(worst[c], bound[c] * (1 + 1e-9)) << name_of(format) << " " << weight_bits;
                EXPECT_GE(worst[c], 0.25 * bound[c]) << name_of(format) << " " << weight_bits;
            }
        }
    // A NaN is no bound.
    EXPECT_TRUE(std::isnan(reading_error({{NAN, 0}}, bump_table({{NAN, 0}}, kFloat32, false), 1, 8)[0]));
}

}  // namespace
}  // namespace anamorph::test_bump_table
