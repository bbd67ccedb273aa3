// SPDX-License-Identifier: Apache-2.0
// Rows of a morph's map in vectors of doubles: against FeatureMap, in double and in long double, and the bound of
// exact blocks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "anamorph/morph/feature_rows.h"
#include "anamorph/morph/near_far_exact.h"
#include "each_instruction_set.h"
#include "feature_families.h"

namespace anamorph::test_feature_rows {
namespace {

constexpr int kSize = 96, kCount = 21, kRoom = kCount + 16;
constexpr double kHypotenuseRounding = 4 * 0x1p-53;

struct Row {
    std::vector<double> x = std::vector<double>(kRoom), y = std::vector<double>(kRoom);

    Row(const FeatureMap& map, int shape, int x0, int y0) {
        simd::feature_row(map, shape, x0 + 0.5, y0 + 0.5, kCount, x.data(), y.data());
    }
};

FeatureMap map_of(const Features& features, const LineWeights& weights) {
    return {features, {{kSize, kSize}, {kSize, 2 * kSize}}, {kSize, kSize}, {0.5, 0.5}, weights};
}

/// visit(map, text) for families of lines and weights.
template <class Visit>
void each_map(const Visit& visit) {
    constexpr unsigned kSeed = 3;
    for (const std::string& family : families::names())
        for (const double a : {0.0, 0.01, 1.0})
            for (const double b : {0.0, 0.5, 1.0, 1.3, 2.0, 7.5, 16.0}) {
                const auto features = families::Maker(kSize, kSeed).make(family, 12);
                visit(map_of(*features, {a, b, 0.5}), family + " a " + std::to_string(a) + " b " +
                                                          std::to_string(b) + " seed " +
                                                          std::to_string(kSeed));
            }
}

bool has_closed_form(double b) {
    return b == 0 || b == 0.5 || b == 1 || b == 2;
}

TEST(FeatureRows, AreWhatTheMapSaysInDouble) {
    each_map([](const FeatureMap& map, const std::string& text) {
        if (!has_closed_form(map.weights().b)) return;
        for (int shape = 0; shape < 2; ++shape)
            for (const int y : {0, 17, 95}) {
                const Row row(map, shape, 3, y);
                for (std::size_t i = 0; i < kCount; ++i) {
                    const Point<double> p = map(3.5 + double(i), y + 0.5, shape);
                    ASSERT_EQ(row.x[i], p.x) << text;
                    ASSERT_EQ(row.y[i], p.y) << text;
                }
            }
    });
}

TEST(FeatureRows, AreWithinTheBoundOfExactBlocks) {
    each_map([](const FeatureMap& map, const std::string& text) {
        for (int shape = 0; shape < 2; ++shape)
            for (const int y : {0, 17, 95}) {
                // Refined about as far as it goes.
                const double bound = exact_bound(map, {shape}, {3, y, 3 + kCount, y + 1}, 1e-7);
                const Row row(map, shape, 3, y);
                for (std::size_t i = 0; i < kCount; ++i) {
                    const Point<long double> p = map(3.5L + static_cast<long double>(i), y + 0.5L, shape);
                    const auto off = static_cast<double>(std::hypot(row.x[i] - p.x, row.y[i] - p.y));
                    ASSERT_LE(off, bound * (1 + kHypotenuseRounding)) << text << " pixel " << i << ", " << y;
                }
            }
    });
}

TEST(FeatureRows, AddLittleToTheBoundFarFromLines) {
    const auto features = families::Maker(kSize, 3).make("outside", 12);
    for (const double b : {1.3, 2.0})
        EXPECT_LT(exact_bound(map_of(*features, {1, b, 0.5}), {0, 1}, {8, 8, 12, 12}, 0), 1e-9);
}

TEST(FeatureRows, TheSameBitsOnAllInstructionSets) {
    std::vector<std::vector<double>> all;
    test::on_every_instruction_set([&] {
        std::vector<double> values;
        each_map([&](const FeatureMap& map, const std::string&) {
            const Row row(map, 1, 3, 17);
            for (std::size_t i = 0; i < kCount; ++i) {
                values.push_back(row.x[i]);
                values.push_back(row.y[i]);
            }
        });
        all.push_back(values);
    });
    ASSERT_GT(all.size(), 1u);
    for (const std::vector<double>& values : all) EXPECT_EQ(values, all.front());
}

TEST(FeatureRows, TogetherTheyAreWhatTheyAreAlone) {
    each_map([](const FeatureMap& map, const std::string& text) {
        Row alone[2] = {{map, 0, 3, 17}, {map, 1, 3, 17}}, together[2] = {alone[0], alone[1]};
        for (Row& row : together) std::fill(row.x.begin(), row.x.end(), 0.0);
        const simd::FeatureRow rows[] = {{0, together[0].x.data(), together[0].y.data()},
                                         {1, together[1].x.data(), together[1].y.data()}};
        simd::feature_rows(map, rows, 3.5, 17.5, kCount);
        for (int shape = 0; shape < 2; ++shape)
            for (std::size_t i = 0; i < kCount; ++i) {
                ASSERT_EQ(together[shape].x[i], alone[shape].x[i]) << text;
                ASSERT_EQ(together[shape].y[i], alone[shape].y[i]) << text;
            }
    });
}

// Weights count in units of the nearest line's, whose reciprocal is then no double.
TEST(FeatureRows, ALineNearerThanTheLeastDoublesReciprocal) {
    Features features;
    features.add_line({Line{{4.5, 17.5}, {60.5, 17.5}}, Line{{9.5, 20.5}, {65.5, 20.5}}});
    features.add_line({Line{{4.5, 40.5}, {60.5, 50.5}}, Line{{4.5, 40.5}, {60.5, 50.5}}});
    for (const double a : {1e-308, 1e-320})
        for (const double b : {1.0, 2.0, 16.0}) {
            const FeatureMap map(features, {{kSize, kSize}, {kSize, kSize}}, {kSize, kSize}, {1, 0},
                                 {a, b, 0.5});
            const Row row(map, 1, 10, 17);
            for (std::size_t i = 0; i < kCount; ++i) {
                EXPECT_NEAR(row.x[i], 15.5 + double(i), 1e-12) << a << " " << b;
                EXPECT_NEAR(map(10.5 + double(i), 17.5, 1).y, 20.5, 1e-12) << a << " " << b;
            }
        }
}

// With a = 0 a line that a pixel lies on is all that counts there.
TEST(FeatureRows, OnALine) {
    Features features;
    features.add_line({Line{{4.5, 17.5}, {60.5, 17.5}}, Line{{9.5, 20.5}, {65.5, 20.5}}});
    features.add_line({Line{{4.5, 40.5}, {60.5, 50.5}}, Line{{4.5, 40.5}, {60.5, 50.5}}});
    const FeatureMap map(features, {{kSize, kSize}, {kSize, kSize}}, {kSize, kSize}, {1, 0}, {0, 1.3, 0.5});
    const Row row(map, 1, 10, 17);
    for (std::size_t i = 0; i < kCount; ++i) {
        EXPECT_NEAR(row.x[i], 15.5 + double(i), 1e-12);
        EXPECT_NEAR(row.y[i], 20.5, 1e-12);
    }
}

}  // namespace
}  // namespace anamorph::test_feature_rows
