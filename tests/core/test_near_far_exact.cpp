// SPDX-License-Identifier: Apache-2.0
// Exact pixels of a morph with weight_a = 0 whose centre lies on a line but for rounding. Lines are level and
// only moved along themselves, so that where a pixel comes from is known by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "anamorph/morph/near_far.h"
#include "each_feature_block.h"

namespace anamorph::test_near_far_exact {
namespace {

constexpr int kSize = 32;
constexpr double kMoved = 8, kMiddle = 10.5;  ///< the pixel is (15, 10)
/// The distance between numbers near kMiddle.
constexpr double kUlp = 0x1p-49;

/// A line that is level at y0 in shape 0 and at y1 in shape 1, `moved` pixels to the right of the target's.
std::vector<Line> level_line(double moved, double y0, double y1) {
    const auto at = [](double x, double y) { return Line{{2 + x, y}, {30 + x, y}}; };
    return {at(moved, y0), at(-moved, y1)};
}

struct Found {
    double x;  ///< how far to the right in shape 0 the pixel comes from
    double bound;
};

/// In the middle of shapes 0 and 1.
Found pixel_of(const std::vector<Line>& first, const std::vector<Line>& second) {
    Features features(2);
    features.add_line(first);
    features.add_line(second);
    const Size size{kSize, kSize};
    const FeatureMap map(features, {size, size}, size, {0.5, 0.5}, {0, 0.5, 0.5});
    NearFarOptions options;
    options.tol = 0;
    options.shapes = {0};
    const NearFar plan(map, options);
    Found found{map(15.5, kMiddle, 0).x - 15.5, NAN};
    each_feature_block(plan, [&](int, const Block& block, const BlockPoints&) { found.bound = block.bound; });
    return found;
}

// The middle of two heights half a unit apart from a double is that double: the line's distance is 2^-50,
// where double says 0. The other's is 2^-14, so that its weight is sqrt(2^-36) of the first one's.
TEST(NearFarExact, OneLineWithinRoundingOfThePixel) {
    const double other = kMiddle + 0x1p-14;
    const Found found =
        pixel_of(level_line(-kMoved, kMiddle + kUlp, kMiddle), level_line(kMoved, other, other));
    const double part = 0x1p-18, truth = (-kMoved + kMoved * part) / (1 + part);
    EXPECT_GT(std::fabs(found.x - truth), 1e-5);
    EXPECT_LE(std::fabs(found.x - truth), found.bound);
}

// The second line passes through the pixel's centre, the first only as double sees it: the second decides.
TEST(NearFarExact, TwoLinesWithinRoundingOfThePixel) {
    const Found found =
        pixel_of(level_line(-kMoved, kMiddle + kUlp, kMiddle), level_line(kMoved, kMiddle, kMiddle));
    EXPECT_LE(std::fabs(found.x - kMoved), found.bound);
}

TEST(NearFarExact, LinesThroughThePixelToTheLastDigit) {
    const Found found = pixel_of(level_line(-kMoved, kMiddle, kMiddle), level_line(kMoved, kMiddle, kMiddle));
    EXPECT_LE(std::fabs(found.x), found.bound);
    EXPECT_LT(found.bound, 1e-7);
}

}  // namespace
}  // namespace anamorph::test_near_far_exact
