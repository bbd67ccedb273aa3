// SPDX-License-Identifier: Apache-2.0
// The random number that is added to the light of a pixel.
#include "anamorph/figure/image/perturbation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "anamorph/figure/image/figure_picture.h"

namespace anamorph::test_figure_perturbation {
using namespace figure;
namespace {

constexpr int kSide = 96;

/// A ball of colour 1 that fills the picture, so that its pixels are the light itself.
FigureFrame white_ball(int number = 1) {
    FigureFrame frame;
    frame.number = number;
    Body body;
    body.shape = {{0, 0, 0}, glm::dvec3(100), glm::dmat3(1.0)};
    body.color = glm::dvec3(255);
    frame.bodies.push_back(body);
    return frame;
}

View view_of(double size) {
    View view;
    view.middle = glm::dvec2(0.5 * size);
    return view;
}

std::vector<float> draw(const FigureLook& look, const Box& box, int frame = 1,
                        const ParallelFor& parallel_for = serial_for) {
    std::vector<float> pixels(static_cast<std::size_t>(box.width() * box.height() * 4));
    View view = view_of(kSide);
    view.middle += glm::dvec2(look.overscan.width, look.overscan.height);
    FigurePicture(white_ball(frame), view,
                  {kSide + 2 * look.overscan.width, kSide + 2 * look.overscan.height}, look)
        .draw(box,
              packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, box.width(),
                          box.height(), 4),
              parallel_for);
    return pixels;
}

std::vector<float> draw(const FigureLook& look, int frame = 1) {
    return draw(look, Box{0, 0, kSide, kSide}, frame);
}

FigureLook perturbed(double most, int seed = 0) {
    FigureLook look;
    look.perturbation = most;
    look.seed = seed;
    return look;
}

TEST(FigurePerturbation, IsTheHashOfSeedFrameAndPixel) {
    // SplitMix64 from the state 1234567: the first number of its public reference, whose state is one step on.
    EXPECT_EQ(mixed_bits(1234567 + 0x9e3779b97f4a7c15u), 6457827717110365317u);
    // Worked out with whole numbers of any length, in Python.
    EXPECT_EQ(random_of_pixel(0, 0, 0, 0), -0.7407087634005052);
    EXPECT_EQ(random_of_pixel(0, 1, 0, 0), 0.6328280543150682);
    EXPECT_EQ(random_of_pixel(7, 3, -5, 1000000), -0.42226081628074486);
    EXPECT_EQ(random_of_pixel(1000000000, 12, 511, 2), 0.6566594713174747);
}

TEST(FigurePerturbation, IsUniformAndPixelsDoNotKnowEachOther) {
    // 2^18 pixels: the mean is within 5 / sqrt(3 n) of 0 but once in a million, each 16th of the range has n / 16 within
    // 5 sqrt(n 15 / 256), and products of neighbours have a mean of 0 within 5 / (3 sqrt(n)).
    constexpr int n = 512;
    constexpr double kCount = 1.0 * n * n;
    for (const int seed : {0, 1, 20}) {
        double sum = 0, beside = 0, below = 0, next_frame = 0;
        std::vector<int> bins(16);
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                const double r = random_of_pixel(seed, 1, x, y);
                ASSERT_TRUE(r >= -1 && r < 1);
                sum += r;
                ++bins[static_cast<std::size_t>(8 * (r + 1))];
                beside += r * random_of_pixel(seed, 1, x + 1, y);
                below += r * random_of_pixel(seed, 1, x, y + 1);
                next_frame += r * random_of_pixel(seed, 2, x, y);
            }
        EXPECT_LT(std::fabs(sum / kCount), 5 / std::sqrt(3 * kCount));
        for (const int bin : bins) EXPECT_LT(std::fabs(bin - kCount / 16), 5 * std::sqrt(kCount * 15 / 256));
        for (const double product : {beside, below, next_frame})
            EXPECT_LT(std::fabs(product / kCount), 5 / (3 * std::sqrt(kCount)));
    }
}

TEST(FigurePerturbation, MovesTheLightByThatAtMost) {
    const FigureLook plain;
    const std::vector<float> without = draw(plain), with = draw(perturbed(0.03));
    // Light is within .3 and 1; where it would go beyond 1 it stays there.
    double most = 0;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const auto i = static_cast<std::size_t>(4 * (y * kSide + x));
            const double expected =
                std::clamp(static_cast<double>(without[i]) + 0.03 * random_of_pixel(0, 1, x, y), 0.0, 1.0);
            ASSERT_NEAR(with[i], expected, 1e-6);
            for (const std::size_t c : {1u, 2u}) ASSERT_EQ(with[i + c], with[i]);
            ASSERT_EQ(with[i + 3], 1);
            most = std::max(most, std::fabs(static_cast<double>(with[i] - without[i])));
        }
    EXPECT_GT(most, 0.0299);
    // Off, nothing changes; seeds and frames differ.
    EXPECT_EQ(draw(perturbed(0, 5)), without);
    EXPECT_NE(draw(perturbed(0.03, 5)), with);
    EXPECT_NE(draw(perturbed(0.03), 2), with);
    EXPECT_EQ(draw(perturbed(0.03)), with);
}

TEST(FigurePerturbation, IsTheSameForAnyPartOverscanAndThread) {
    const ParallelFor threads = [](std::int64_t count, const std::function<void(std::int64_t)>& body) {
        std::vector<std::thread> all;
        for (std::int64_t t = 0; t < 3; ++t)
            all.emplace_back([&, t] {
                for (std::int64_t i = count - 1 - t; i >= 0; i -= 3) body(i);
            });
        for (std::thread& thread : all) thread.join();
    };
    for (const bool antialias : {true, false}) {
        FigureLook look = perturbed(0.1, 3);
        look.antialias = antialias;
        const std::vector<float> all = draw(look);
        EXPECT_EQ(draw(look, {0, 0, kSide, kSide}, 1, threads), all);
        FigureLook wide = look;
        wide.overscan = {8, 5};
        for (const auto& [part, moved] :
             {std::pair{draw(look, {10, 20, 50, 90}), 0}, {draw(wide, {18, 25, 58, 95}), 1}})
            for (int y = 20; y < 90; ++y)
                for (int x = 10; x < 50; ++x)
                    for (int c = 0; c < 4; ++c)
                        ASSERT_EQ(part[static_cast<std::size_t>(4 * (40 * (y - 20) + x - 10) + c)],
                                  all[static_cast<std::size_t>(4 * (y * kSide + x) + c)])
                            << moved;
    }
}

TEST(FigurePerturbation, FewLevelsShowNoContours) {
    // With 8 levels, and half a step either way: the mean over 12 x 12 pixels is what is to be shown, within the 5 sigmas
    // of 144 pixels that are each off by sqrt(p (1 - p)) steps, half a step at most. Without it, contours are off by half.
    constexpr double kStep = 1.0 / 7;
    const std::vector<float> exact = draw(FigureLook()), noisy = draw(perturbed(0.5 * kStep, 11));
    const auto shown = [&](float v) { return std::round(static_cast<double>(v) / kStep) * kStep; };
    double worst_plain = 0, worst = 0;
    for (int y0 = 24; y0 + 12 <= kSide; y0 += 12)
        for (int x0 = 24; x0 + 12 <= kSide - 24; x0 += 12) {
            double plain = 0, random = 0, truth = 0;
            for (int y = y0; y < y0 + 12; ++y)
                for (int x = x0; x < x0 + 12; ++x) {
                    const auto i = static_cast<std::size_t>(4 * (y * kSide + x));
                    truth += static_cast<double>(exact[i]) / 144;
                    plain += shown(exact[i]) / 144;
                    random += shown(noisy[i]) / 144;
                }
            worst_plain = std::max(worst_plain, std::fabs(plain - truth));
            worst = std::max(worst, std::fabs(random - truth));
        }
    EXPECT_LT(worst, 5 * 0.5 * kStep / 12);
    EXPECT_LT(2 * worst, worst_plain);
}

}  // namespace
}  // namespace anamorph::test_figure_perturbation
