// SPDX-License-Identifier: Apache-2.0
// Textures around bodies, against what their definition says.
#include <gtest/gtest.h>

#include <numbers>

#include "anamorph/figure/image/figure_picture.h"
#include "anamorph/image/pyramid.h"
#include "figure_picture_cases.h"

namespace anamorph::test_figure_texture {
using namespace figure;
namespace {

using namespace figure_picture_cases;

constexpr double kPi = std::numbers::pi;
constexpr BodyMapping kMappings[] = {BodyMapping::latlong, BodyMapping::mirrored, BodyMapping::linear,
                                     BodyMapping::octahedral};

/// An image of 4 channels, the last one alpha.
struct Image {
    int width, height;
    std::vector<float> texels;

    template <class Color>
    Image(int w, int h, const Color& color) : width(w), height(h) {
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x)
                for (int c = 0; c < 4; ++c) texels.push_back(static_cast<float>(color(x, y, c)));
    }
    ConstImageView view() const {
        return packed_view(reinterpret_cast<const std::byte*>(texels.data()), PixelType::float32, width,
                           height, 4);
    }
};

/// (u, v) by the essay's trigonometry, in long double.
glm::vec<2, Real> mapped(BodyMapping mapping, const RealVector& p) {
    const Real pi = std::numbers::pi_v<Real>, latitude = std::asin(std::clamp(p.y, -1.0L, 1.0L));
    const Real v = 0.5L - latitude / pi;
    const Real sine = std::clamp(p.x / std::cos(latitude), -1.0L, 1.0L);
    if (mapping == BodyMapping::mirrored) return {0.5L + std::asin(sine) / pi, v};
    if (mapping == BodyMapping::linear) return {0.5L + std::asin(p.x) / pi, v};
    if (mapping == BodyMapping::latlong) {
        const Real longitude = p.z < 0 ? std::asin(sine) : std::copysign(pi, p.x) - std::asin(sine);
        return {0.5L + longitude / (2 * pi), v};
    }
    const Real sum = std::fabs(p.x) + std::fabs(p.y) + std::fabs(p.z);
    Real x = p.x / sum, y = p.y / sum;
    if (p.z > 0) {
        const Real old = x;
        x = (x < 0 ? -1 : 1) * (1 - std::fabs(y));
        y = (y < 0 ? -1 : 1) * (1 - std::fabs(old));
    }
    return {0.5L + 0.5L * x, 0.5L - 0.5L * y};
}

RealVector unit_of(const Scene& scene, const Met& met) {
    const Ellipsoid& e = scene.bodies[static_cast<std::size_t>(met.body)];
    return glm::transpose(glm::mat<3, 3, Real>(e.rotation)) * (met.point - RealVector(e.center)) /
           RealVector(e.axes);
}

FigureFrame frame_of(const Scene& scene) {
    FigureFrame frame;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        Body body;
        body.shape = scene.bodies[i];
        body.texture = i % 2 ? "none" : "map";
        body.color = {0, 51, 255};
        frame.bodies.push_back(body);
    }
    return frame;
}

FigureLook look_of(BodyMapping mapping) {
    FigureLook look;
    look.style = FigureStyle::textured;
    look.light.ambient = 1;  // colours as they are
    look.mapping = mapping;
    look.textures = {"other", "map", "none"};
    return look;
}

std::vector<float> draw(const Scene& scene, const FigureFrame& frame, const FigureLook& look,
                        const std::vector<const Source*>& textures) {
    std::vector<float> pixels(static_cast<std::size_t>(scene.width * scene.height * 4));
    FigurePicture(frame, scene.view, {scene.width, scene.height}, look)
        .draw({0, 0, scene.width, scene.height},
              packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, scene.width,
                          scene.height, 4),
              serial_for, textures);
    return pixels;
}

TEST(FigureTexture, ColorsAreThoseOfTheMapping) {
    // A texture that is smooth, also over the latlong seam, and finer than the picture nowhere.
    const Image map(256, 128, [](int x, int y, int c) {
        const double u = (x + 0.5) / 256, v = (y + 0.5) / 128;
        return c == 3 ? 1 : 0.5 + 0.4 * std::sin(2 * kPi * u * (c < 2 ? 1 : 2)) * std::sin(kPi * v * (c + 1));
    });
    const MemorySource source(map.view());
    for (const BodyMapping mapping : kMappings)
        for (const double eye : {HUGE_VAL, 300.0, 20.0}) {
            SCOPED_TRACE(static_cast<int>(mapping));
            SceneMaker make(7);
            const Scene scene = make.scene(6, 40, 60, 2, eye, 96, 72);
            FigureLook look = look_of(mapping);
            look.antialias = false;
            look.filter = Filter::bilinear;
            const std::vector<float> pixels = draw(scene, frame_of(scene), look, {nullptr, &source, nullptr});
            int drawn = 0;
            for (int y = 0; y < scene.height; ++y)
                for (int x = 0; x < scene.width; ++x) {
                    const Met met = meet(scene, x + 0.5L, y + 0.5L);
                    if (met.body < 0 || met.body % 2) continue;
                    const auto uv = mapped(mapping, unit_of(scene, met));
                    ++drawn;
                    for (int c = 0; c < 3; ++c) {
                        const double u = static_cast<double>(uv.x), v = static_cast<double>(uv.y);
                        const double wanted =
                            0.5 + 0.4 * std::sin(2 * kPi * u * (c < 2 ? 1 : 2)) * std::sin(kPi * v * (c + 1));
                        EXPECT_NEAR(
                            static_cast<double>(pixels[static_cast<std::size_t>((y * 96 + x) * 4 + c)]),
                            wanted, mapping == BodyMapping::latlong ? 0.005 : 0.02)
                            << x << " " << y << " u " << u << " v " << v;
                    }
                }
            EXPECT_GT(drawn, 300);
        }
}

TEST(FigureTexture, ATextureOfAnyShapeGoesOnAroundAndOverThePoles) {
    for (const int width : {16, 24, 48}) {
        SCOPED_TRACE(width);
        const Image map(width, 24, [&](int, int, int) { return 1; });
        const MemorySource source(map.view());
        const Pyramid pyramid(source, 1, 1);
        for (const glm::dvec2& offset : {glm::dvec2(0), glm::dvec2(5, 30), glm::dvec2(-70, -500)})
            for (const TextureAverage average :
                 {TextureAverage::footprint, TextureAverage::trilinear, TextureAverage::summed_area}) {
                // Seen from above.
                Scene scene;
                scene.width = scene.height = 40;
                scene.view.middle = {20, 20};
                scene.view.rotation = {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
                scene.bodies = {{{0, 0, 0}, {30, 30, 30}, glm::dmat3(1)}};
                FigureFrame frame = frame_of(scene);
                frame.bodies[0].texture_offset = offset;
                FigureLook look = look_of(BodyMapping::latlong);
                look.average = average;
                const std::vector<float> pixels = draw(scene, frame, look, {nullptr, &pyramid, nullptr});
                for (const float value : pixels) ASSERT_NEAR(value, 1, 1e-6);
            }
    }
}

TEST(FigureTexture, FinePatternsAreAveraged) {
    // Stripes of two texels, some to a pixel near the middle and very many near limbs and poles.
    const Image map(1024, 512, [](int x, int y, int c) { return c == 3 || (x / 2 + y / 2) % 2 ? 1.0 : 0.0; });
    const MemorySource base(map.view());
    const Pyramid source(base);
    for (const BodyMapping mapping : kMappings) {
        SCOPED_TRACE(static_cast<int>(mapping));
        Scene scene;
        scene.width = 48, scene.height = 40;
        scene.view.middle = {24, 20};
        SceneMaker make(3);
        scene.bodies = {{{0, 0, 0}, {20, 18, 9}, make.turn()}};
        const FigureLook look = look_of(mapping);
        const std::vector<float> pixels = draw(scene, frame_of(scene), look, {nullptr, &source, nullptr});
        double worst = 0, total = 0;
        int count = 0;
        for (int y = 0; y < scene.height; ++y)
            for (int x = 0; x < scene.width; ++x) {
                double sum = 0;
                int hits = 0;
                for (int i = 0; i < 1024; ++i) {
                    const Met met = meet(scene, x + (i % 32 + 0.5L) / 32, y + (i / 32 + 0.5L) / 32);
                    if (met.body < 0) continue;
                    const auto uv = mapped(mapping, unit_of(scene, met));
                    const int u = std::clamp(static_cast<int>(uv.x * 1024), 0, 1023),
                              v = std::clamp(static_cast<int>(uv.y * 512), 0, 511);
                    sum += static_cast<double>(map.texels[static_cast<std::size_t>((v * 1024 + u) * 4)]);
                    ++hits;
                }
                const float* p = &pixels[static_cast<std::size_t>(y * 48 + x) * 4];
                EXPECT_NEAR(static_cast<double>(p[3]), hits / 1024.0, 0.05);
                if (hits < 1024) continue;
                const double error = std::fabs(static_cast<double>(p[0]) - sum / 1024);
                worst = std::max(worst, error);
                total += error;
                ++count;
            }
        EXPECT_LT(total / count, 0.04);
        EXPECT_LT(worst, 0.35);
    }
}

TEST(FigureTexture, WhatIsMissingHasItsOwnColor) {
    Scene scene;
    scene.view.middle = {32, 24};
    scene.bodies = {{{0, 0, 0}, {20, 20, 20}, glm::dmat3(1.0)}};
    const FigureFrame frame = frame_of(scene);
    const FigureLook look = look_of(BodyMapping::latlong);
    FigureLook plain = look;
    plain.style = FigureStyle::shaded;
    const std::vector<float> own = draw(scene, frame, plain, {});
    EXPECT_EQ(draw(scene, frame, look, {}), own);
    EXPECT_EQ(draw(scene, frame, look, {nullptr, nullptr, nullptr}), own);
    /// One that cannot be read.
    class Broken final : public Source {
      public:
        PixelType type() const noexcept override { return PixelType::uint8; }
        int channels() const noexcept override { return 3; }
        int levels() const noexcept override { return 1; }
        Size size(int) const noexcept override { return {64, 32}; }
        bool read(int, const Box&, std::byte*, std::ptrdiff_t) const noexcept override { return false; }
    };
    const Broken broken;
    EXPECT_EQ(draw(scene, frame, look, {nullptr, &broken, nullptr}), own);
    // Transparent texels show the body's own colour; offsets move the texture.
    const Image clear(64, 32, [](int, int, int) { return 0.0; });
    const MemorySource source(clear.view());
    EXPECT_EQ(draw(scene, frame, look, {nullptr, &source, nullptr}), own);
    const Image stripe(64, 32, [](int x, int, int c) { return c == 3 || (x >= 28 && x < 36) ? 1.0 : 0.0; });
    const MemorySource striped(stripe.view());
    FigureFrame moved = frame;
    const std::vector<float> front = draw(scene, frame, look, {nullptr, &striped, nullptr});
    EXPECT_EQ(front[(24 * 64 + 32) * 4], 1);
    moved.bodies[0].texture_offset = {20, 0};
    EXPECT_EQ(draw(scene, moved, look, {nullptr, &striped, nullptr})[(24 * 64 + 32) * 4], 0);
}

}  // namespace
}  // namespace anamorph::test_figure_texture
