// SPDX-License-Identifier: Apache-2.0
// What lies behind figures, and the ways to average their textures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "anamorph/figure/image/backdrop.h"
#include "anamorph/figure/image/figure_picture.h"
#include "anamorph/image/pyramid.h"
#include "figure_picture_cases.h"

namespace anamorph::test_figure_background {
using namespace figure;
namespace {

using namespace figure_picture_cases;

std::vector<float> draw(const FigureFrame& frame, const View& view, const Size& size, const FigureLook& look,
                        const std::vector<const Source*>& sources = {}) {
    std::vector<float> pixels(static_cast<std::size_t>(size.width * size.height * 4));
    FigurePicture(frame, view, size, look)
        .draw({0, 0, size.width, size.height},
              packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, size.width,
                          size.height, 4),
              serial_for, sources);
    return pixels;
}

MemorySource source_of(const std::vector<float>& texels, int width, int height, int channels) {
    return MemorySource(packed_view(reinterpret_cast<const std::byte*>(texels.data()), PixelType::float32,
                                    width, height, channels));
}

FigureFrame ball(double radius) {
    FigureFrame frame;
    Body body;
    body.shape = {{0, 0, 0}, glm::dvec3(radius), glm::dmat3(1.0)};
    body.texture = "map";
    frame.bodies.push_back(body);
    return frame;
}

TEST(FigureBackground, BandsCoverTheirShareOfEachRow) {
    // The example of the essay's appendix: two halves, here of 5 rows.
    FigureFrame frame;
    frame.bands = {{0.5, {0, 0, 90}}, {1, {0, 51, 153}}};
    const std::vector<float> pixels = draw(frame, View(), {3, 5}, FigureLook());
    const double blue[5] = {90, 90, (90 + 153) / 2.0, 153, 153}, green[5] = {0, 0, 25.5, 51, 51};
    for (std::size_t y = 0; y < 5; ++y)
        for (std::size_t x = 0; x < 3; ++x) {
            const float* p = &pixels[4 * (3 * y + x)];
            EXPECT_FLOAT_EQ(p[0], 0);
            EXPECT_FLOAT_EQ(p[1], static_cast<float>(green[y] / 255));
            EXPECT_FLOAT_EQ(p[2], static_cast<float>(blue[y] / 255));
            EXPECT_EQ(p[3], 1);
        }
    // Many to a pixel, one without height; the last goes on to the bottom.
    const glm::dvec4 mixed = band_color(
        {{0.25, {255, 0, 0}}, {0.25, {0, 255, 0}}, {0.5, {0, 0, 255}}, {0.75, {255, 255, 255}}}, 0, 1);
    EXPECT_LT(glm::length(mixed - glm::dvec4(0.75, 0.5, 0.75, 1)), 1e-15);
    // Those asked for replace those of the frame, and so does one colour.
    FigureLook look;
    look.bands = {{1, {255, 255, 255}}};
    EXPECT_EQ(draw(frame, View(), {1, 1}, look), (std::vector<float>{1, 1, 1, 1}));
    look.background = glm::dvec3(0.25);
    EXPECT_EQ(draw(frame, View(), {1, 1}, look), (std::vector<float>{.25, .25, .25, 1}));
}

TEST(FigureBackground, APictureLiesBehindAsLargeAsWhatIsDrawn) {
    // 4 x 2 texels on 8 x 4 pixels and on 2 x 1.
    std::vector<float> texels;
    for (int i = 0; i < 8; ++i)
        for (int c = 0; c < 4; ++c) texels.push_back(c == 3 ? 1.0f : 0.1f * static_cast<float>(i));
    const MemorySource source = source_of(texels, 4, 2, 4);
    FigureLook look;
    look.backdrop = true;
    const std::vector<float> large = draw({}, View(), {8, 4}, look, {&source});
    // Bilinear: a quarter of the way from the first texel to the second.
    EXPECT_FLOAT_EQ(large[0], 0);
    EXPECT_FLOAT_EQ(large[4], 0.025f);
    EXPECT_FLOAT_EQ(large[8], 0.075f);
    EXPECT_FLOAT_EQ(large[4 * (3 * 8 + 7)], 0.7f);
    const std::vector<float> small = draw({}, View(), {2, 1}, look, {&source});
    EXPECT_NEAR(small[0], (0 + .1 + .4 + .5) / 4, 0.03);
    EXPECT_NEAR(small[4], (.2 + .3 + .6 + .7) / 4, 0.03);
    // Through its alpha the background is seen, before it the bodies.
    std::vector<float> half = {0.5f, 0, 0, 0.5f};
    const MemorySource veil = source_of(half, 1, 1, 4);
    look.background = glm::dvec3(0, 1, 0);
    View view;
    view.middle = {4, 4};
    const FigureFrame frame = ball(2.5);
    const std::vector<float> seen = draw(frame, view, {8, 8}, look, {&veil});
    EXPECT_EQ(seen[0], 0.5f);
    EXPECT_EQ(seen[1], 0.5f);
    EXPECT_EQ(seen[3], 1);
    FigureLook plain = look;
    plain.backdrop = false;
    plain.background.reset();
    const std::vector<float> alone = draw(frame, view, {8, 8}, plain);
    for (std::size_t i = 0; i < seen.size(); i += 4) {
        EXPECT_NEAR(seen[i], alone[i] + (1 - alone[i + 3]) * 0.5f, 1e-6);
        EXPECT_NEAR(seen[i + 1], alone[i + 1] + (1 - alone[i + 3]) * 0.5f, 1e-6);
    }
    // One that is not there.
    EXPECT_EQ(draw({}, View(), {1, 1}, look, {nullptr}), (std::vector<float>{0, 1, 0, 1}));
    // After the textures.
    look.textures = {"map", "other"};
    EXPECT_EQ(draw({}, View(), {1, 1}, look, {nullptr, nullptr, &veil}), (std::vector<float>{.5, .5, 0, 1}));
}

/// The mean error of a ball's texture from its 16 x 16 samples, where the texture is fine; by latitude in
/// steps of 30 degrees.
std::vector<double> errors_of(TextureAverage average, const Source& source, const std::vector<float>& texels,
                              int side) {
    constexpr int kSize = 96;
    FigureLook look;
    look.style = FigureStyle::textured;
    look.light.ambient = 1;
    look.mapping = BodyMapping::mirrored;
    look.textures = {"map"};
    look.average = average;
    View view;
    view.middle = {kSize / 2, kSize / 2};
    const double radius = 0.45 * kSize;
    const std::vector<float> pixels = draw(ball(radius), view, {kSize, kSize}, look, {&source});
    std::vector<double> sums(3), counts(3);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            double sum = 0;
            int hits = 0;
            for (int i = 0; i < 256; ++i) {
                const double px = (x + (i % 16 + 0.5) / 16 - 0.5 * kSize) / radius,
                             py = -(y + (i / 16 + 0.5) / 16 - 0.5 * kSize) / radius;
                if (!(px * px + py * py < 0.98)) continue;
                const double u = 0.5 + std::asin(px / std::sqrt(1 - py * py)) / M_PI,
                             v = 0.5 - std::asin(py) / M_PI;
                sum += static_cast<double>(texels[static_cast<std::size_t>(static_cast<int>(v * side) * side +
                                                                           static_cast<int>(u * side))]);
                ++hits;
            }
            if (hits < 256) continue;
            const double sine = std::fabs((y + 0.5 - 0.5 * kSize) / radius);
            const auto band = static_cast<std::size_t>(std::asin(std::min(sine, 0.999)) * 6 / M_PI);
            sums[band] += std::fabs(
                static_cast<double>(pixels[static_cast<std::size_t>(4 * (y * kSize + x))]) - sum / 256);
            ++counts[band];
        }
    for (std::size_t k = 0; k < 3; ++k) sums[k] /= counts[k];
    return sums;
}

TEST(FigureTextureAverage, EachIsBetterThanMraselsAtEveryLatitude) {
    constexpr int kSide = 256;
    std::vector<float> texels;
    std::mt19937 random(9);
    for (int i = 0; i < kSide * kSide; ++i) texels.push_back(static_cast<float>(random() % 2));
    const MemorySource base = source_of(texels, kSide, kSide, 1);
    const Pyramid source(base);
    const auto mrasel = errors_of(TextureAverage::mrasel, source, texels, kSide);
    const auto trilinear = errors_of(TextureAverage::trilinear, source, texels, kSide);
    const auto summed = errors_of(TextureAverage::summed_area, source, texels, kSide);
    const auto footprint = errors_of(TextureAverage::footprint, source, texels, kSide);
    for (std::size_t k = 0; k < 3; ++k) {
        SCOPED_TRACE(k);
        EXPECT_LT(trilinear[k], mrasel[k]);
        EXPECT_LT(summed[k], trilinear[k]);
        EXPECT_LT(footprint[k], trilinear[k]);
        EXPECT_LT(summed[k], 0.05);
    }
}

TEST(FigureTextureAverage, OfAPlainTextureAllAreThatColor) {
    std::vector<float> texels(64 * 32 * 3);
    for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = i % 3 == 0 ? 0.25f : 0.75f;
    const MemorySource base = source_of(texels, 64, 32, 3);
    const Pyramid source(base);
    FigureLook look;
    look.style = FigureStyle::textured;
    look.light.ambient = 1;
    look.textures = {"map"};
    View view;
    view.middle = {16, 16};
    for (const TextureAverage average : {TextureAverage::footprint, TextureAverage::trilinear,
                                         TextureAverage::summed_area, TextureAverage::mrasel})
        for (const BodyMapping mapping :
             {BodyMapping::latlong, BodyMapping::mirrored, BodyMapping::linear, BodyMapping::octahedral}) {
            look.average = average;
            look.mapping = mapping;
            const std::vector<float> pixels = draw(ball(12), view, {32, 32}, look, {&source});
            for (std::size_t i = 0; i < pixels.size(); i += 4) {
                ASSERT_NEAR(pixels[i], 0.25f * pixels[i + 3], 1e-5f);
                ASSERT_NEAR(pixels[i + 1], 0.75f * pixels[i + 3], 1e-5f);
            }
        }
}

}  // namespace
}  // namespace anamorph::test_figure_background
