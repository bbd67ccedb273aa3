// SPDX-License-Identifier: Apache-2.0
// Kim 2003, chapter 4: the linear coefficients and the errors that were published.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "anamorph/panorama/panorama_residual.h"

namespace anamorph::test_residual {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

TEST(Residual, MinimaxCoefficientsBalanceTheirExtremes) {
    for (const double x_max : {0.1, 0.5, 1.0, 3.0}) {
        const double height = 2;
        const auto [a, b] = minimax_coefficients(x_max, height);
        const auto theta = [&, a = a](double x) { return std::atan(x) / kTurn - a * x; };
        const auto v = [&, b = b](double x) { return 1 / height / std::sqrt(1 + x * x) - b; };
        const double x_c = std::sqrt(1 / (kTurn * a) - 1);
        EXPECT_NEAR(theta(x_c), -theta(x_max), 1e-14);
        EXPECT_NEAR(v(0), -v(x_max), 1e-14);
        // No other slope does better.
        const auto worst = [&](double slope) {
            double most = 0;
            for (int i = 0; i <= 1000; ++i) {
                const double x = x_max * i / 1000;
                most = std::max(most, std::fabs(std::atan(x) / kTurn - slope * x));
            }
            return most;
        };
        EXPECT_LE(worst(a), worst(a * 1.001));
        EXPECT_LE(worst(a), worst(a * 0.999));
    }
}

/// Section 4.6: a panorama of 256 x 256, 90 degrees high, drawn 512 x 512 with 90 degrees; texture
/// coordinates 0..1.
TEST(Residual, PublishedErrorsOfTheLinearPartComeOut) {
    // Square pixels do not fit 256 x 256 over 360 by 90 degrees: measure in texture coordinates on a chart of
    // the same directions, 360 degrees around and 2 tan 45 degrees high.
    const int width = 1024, height = static_cast<int>(std::lround(1024 * 2 / kTurn));
    const Panorama map(Chart(Projection::cylindrical, width, height),
                       Chart(Projection::rectilinear, 512, 512, 90));
    const LinearPart linear = linear_part(map, 0);
    const double unit_v = map.source().scale_y() * 2;  // pixels per height of the unit cylinder
    double sum = 0, most = 0;
    for (int j = 0; j < 512; ++j)
        for (int i = 0; i < 512; ++i) {
            Point<double> exact{};
            int piece = 0;
            ASSERT_TRUE(map.exact(i + 0.5, j + 0.5, 0, exact, piece));
            const Point<double> l = linear(i + 0.5, j + 0.5);
            const double e = std::hypot((exact.x - l.x) / width, (exact.y - l.y) / unit_v);
            sum += e;
            most = std::max(most, e);
        }
    // The paper read its figures back from hardware, through a texture of 256 texels.
    EXPECT_NEAR(sum / (512 * 512), 0.023, 0.0005);
    EXPECT_NEAR(most, 0.074, 0.001);
}

TEST(Residual, LinearPartIsTheDerivativeElsewhere) {
    const Panorama map(Chart(Projection::equirectangular, 2048, 1024),
                       Chart(Projection::rectilinear, 500, 400, 60), {20, 30, 40});
    const LinearPart linear = linear_part(map, 0);
    for (const auto& [dx, dy] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {-1.0, 1.0}}) {
        Point<double> exact{};
        int piece = 0;
        ASSERT_TRUE(map.exact(linear.cx + dx, linear.cy + dy, 0, exact, piece));
        const Point<double> l = linear(linear.cx + dx, linear.cy + dy);
        EXPECT_NEAR(l.x, exact.x, 0.01);
        EXPECT_NEAR(l.y, exact.y, 0.01);
    }
}

}  // namespace
}  // namespace anamorph::test_residual
