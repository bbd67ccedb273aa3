// SPDX-License-Identifier: Apache-2.0
// Solid textures and bumps, against formulas that are written out, and against surfaces that are really raised.
#include <gtest/gtest.h>

#include <numbers>

#include "anamorph/figure/image/bump_map.h"
#include "anamorph/figure/image/figure_picture.h"
#include "anamorph/figure/image/solid_texture.h"
#include "anamorph/image/pyramid.h"
#include "figure_picture_cases.h"

namespace anamorph::test_figure_relief {
using namespace figure;
namespace {

using namespace figure_picture_cases;

constexpr Real kPi = std::numbers::pi_v<Real>;

FigureFrame frame_of(const Scene& scene) {
    FigureFrame frame;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        Body body;
        body.shape = scene.bodies[i];
        body.color = {200.0 - 7.0 * double(i), 51, 255};
        frame.bodies.push_back(body);
    }
    return frame;
}

std::vector<float> draw(const Scene& scene, const FigureLook& look, const std::vector<const Source*>& sources,
                        const Box& box) {
    std::vector<float> pixels(static_cast<std::size_t>(box.width() * box.height() * 4));
    FigurePicture(frame_of(scene), scene.view, {scene.width, scene.height}, look)
        .draw(box,
              packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, box.width(),
                          box.height(), 4),
              serial_for, sources);
    return pixels;
}

std::vector<float> draw(const Scene& scene, const FigureLook& look,
                        const std::vector<const Source*>& sources = {}) {
    return draw(scene, look, sources, {0, 0, scene.width, scene.height});
}

/// A point that a ray meets, in the body's own axes from its centre.
RealVector own_point(const Scene& scene, const Met& met) {
    const Ellipsoid& e = scene.bodies[static_cast<std::size_t>(met.body)];
    return glm::transpose(glm::mat<3, 3, Real>(e.rotation)) * (met.point - RealVector(e.center));
}

FigureLook solid_look(const SolidText& text, double scale = 30, int samples = 1) {
    FigureLook look;
    look.light.ambient = 1;  // colours as they are
    look.antialias = false;
    look.solid = SolidLook{text, scale, samples};
    return look;
}

TEST(FigureRelief, SolidTexturesAreFunctionsOfThePointInTheBodysAxes) {
    const SolidText text{"0.5+0.4*sin(x/scale)*cos(y/11)", "own_red*(0.5+0.5*cos(k*z))", "if(z<0,own_blue,w)",
                         "k=1/17;w=0.25+0.001*frame"};
    for (const double eye : {HUGE_VAL, 300.0, 20.0}) {
        SceneMaker make(11);
        const Scene scene = make.scene(8, 30, 60, 4, eye, 96, 72);
        const std::vector<float> pixels = draw(scene, solid_look(text));
        int drawn = 0, behind = 0;
        for (int y = 0; y < scene.height; ++y)
            for (int x = 0; x < scene.width; ++x) {
                const Met met = meet(scene, x + 0.5L, y + 0.5L);
                if (met.body < 0 || met.doubt < 1e-9L) continue;
                const RealVector p = own_point(scene, met);
                if (std::fabs(p.z) < 1e-6L) continue;
                const Real red = (200 - 7 * met.body) / 255.0L;
                const Real wanted[3] = {0.5L + 0.4L * std::sin(p.x / 30) * std::cos(p.y / 11),
                                        red * (0.5L + 0.5L * std::cos(p.z / 17)), p.z < 0 ? 1.0L : 0.25L};
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(
                        static_cast<double>(pixels[static_cast<std::size_t>((y * scene.width + x) * 4 + c)]),
                        static_cast<double>(wanted[c]), 2e-6)
                        << x << " " << y;
                ++drawn;
                behind += p.z > 0;
            }
        EXPECT_GT(drawn, 1000);
        EXPECT_GT(behind, 200);
    }
}

TEST(FigureRelief, SolidPixelsAreTheMeanOfTheirPoints) {
    // A body that fills the picture, in cubes a pixel and a half wide: against 64 x 64 points a pixel.
    Scene scene;
    scene.width = scene.height = 24;
    scene.view.middle = {12, 12};
    scene.bodies = {{{0, 0, 0}, {40, 40, 40}, glm::dmat3(1.0)}};
    const SolidText text = solid_presets()[2].text;
    double before = 1;
    for (const int samples : {1, 2, 4, 8, 16}) {
        FigureLook look = solid_look(text, 3.1, samples);
        look.antialias = true;
        const std::vector<float> pixels = draw(scene, look);
        double off = 0;
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 24; ++x) {
                Real sum = 0;
                for (int k = 0; k < 4096; ++k) {
                    const RealVector p =
                        own_point(scene, meet(scene, x + (k % 64 + 0.5L) / 64, y + (k / 64 + 0.5L) / 64));
                    const Real cubes =
                        std::floor(2 * p.x / 3.1L) + std::floor(2 * p.y / 3.1L) + std::floor(2 * p.z / 3.1L);
                    sum += std::fmod(std::fabs(cubes), 2.0L) == 1 ? 0.4L : 1;
                }
                off += std::fabs(static_cast<double>(pixels[static_cast<std::size_t>((y * 24 + x) * 4)]) -
                                 200 / 255.0 * static_cast<double>(sum) / 4096) /
                       576;
            }
        EXPECT_LT(off, 0.75 * before) << samples;
        before = off;
    }
    EXPECT_LT(before, 0.01);
}

TEST(FigureRelief, TexturesOfOursAreThereAndDifferAndColorsStayInTheirRange) {
    SceneMaker make(5);
    const Scene scene = make.scene(6, 40, 60, 2, 300, 64, 48);
    std::vector<std::vector<float>> all;
    for (const SolidPreset& preset : solid_presets()) {
        all.push_back(draw(scene, solid_look(preset.text)));
        for (const float v : all.back()) EXPECT_TRUE(v >= 0 && v <= 1);
        EXPECT_FALSE(preset.documentation.empty());
    }
    ASSERT_EQ(all.size(), 3u);
    EXPECT_NE(all[0], all[1]);
    EXPECT_NE(all[1], all[2]);
    // Where a formula is not defined, infinite or no number, the body has its own color; beyond 0 and 1 it is cut off.
    for (const char* bad : {"1/0", "sqrt(-1-x*x)", "log(-1-y*y)", "1e308*1e308"})
        EXPECT_EQ(draw(scene, solid_look({bad, "own_green", "own_blue", ""})), draw(scene, solid_look({})))
            << bad;
    EXPECT_EQ(draw(scene, solid_look({"7", "-3", "1e300", ""})),
              draw(scene, solid_look({"1", "0", "1", ""})));
}

TEST(FigureRelief, ReliefsHaveTheSameBitsInParts) {
    std::vector<float> texels;
    for (int i = 0; i < 64 * 32; ++i) texels.push_back(static_cast<float>(i * 37 % 101) / 101);
    const MemorySource source(
        packed_view(reinterpret_cast<const std::byte*>(texels.data()), PixelType::float32, 64, 32, 1));
    const Pyramid pyramid(source, 1, 1);
    SceneMaker make(3);
    const Scene scene = make.scene(6, 20, 60, 4, 300, 64, 48);
    FigureLook look;
    look.solid = SolidLook{solid_presets()[0].text, 40, 4};
    look.bumps = true;
    const std::vector<float> whole = draw(scene, look, {&pyramid});
    for (const Box& box : {Box{0, 0, 17, 48}, Box{17, 5, 64, 30}, Box{40, 40, 41, 41}}) {
        const std::vector<float> part = draw(scene, look, {&pyramid}, box);
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x)
                for (int c = 0; c < 4; ++c)
                    ASSERT_EQ(
                        part[static_cast<std::size_t>(((y - box.y0) * box.width() + x - box.x0) * 4 + c)],
                        whole[static_cast<std::size_t>((y * 64 + x) * 4 + c)]);
    }
}

/// Heights that are smooth, also over the seam and at the poles, at a point of the unit sphere, by longitude and latitude.
Real height_at(const RealVector& p) {
    const Real u = 0.5L + std::atan2(p.x, -p.z) / (2 * kPi),
               v = 0.5L - std::asin(std::clamp(p.y, -1.0L, 1.0L)) / kPi;
    const Real sine = std::sin(kPi * v);
    return 0.5L + 0.4L * std::sin(2 * kPi * 5 * u) * sine * sine * std::sin(kPi * 6 * v);
}

TEST(FigureRelief, SlopesAreOfATexelToEitherSide) {
    // Waves of four texels: over two to either side there is no slope at all.
    constexpr int kWidth = 64, kHeight = 32;
    std::vector<float> texels;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) texels.push_back(x % 4 < 2 ? 0.0f : 1.0f);
    const MemorySource source(packed_view(reinterpret_cast<const std::byte*>(texels.data()),
                                          PixelType::float32, kWidth, kHeight, 1));
    const Pyramid pyramid(source, 1, 1);
    SceneMaker make(23);
    // A texel is several pixels wide.
    const Scene scene = make.scene(1, 100, 100, 1, HUGE_VAL, 200, 200);
    FigureLook look;
    look.antialias = false;
    look.light = {Lighting::lambert, glm::normalize(glm::dvec3(-1, 2, -2)), 0, 0, 1};
    look.bump_scale = 5;
    const std::vector<float> smooth = draw(scene, look);
    look.bumps = true;
    const std::vector<float> pixels = draw(scene, look, {&pyramid});
    double moved = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) moved += std::fabs(pixels[i] - smooth[i]);
    EXPECT_GT(moved / static_cast<double>(pixels.size()), 0.01);
}

TEST(FigureRelief, BumpsTurnNormalsAsARaisedSurfaceHasThem) {
    constexpr int kWidth = 2048, kHeight = 1024;
    std::vector<float> texels;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const Real lon = ((x + 0.5L) / kWidth - 0.5L) * 2 * kPi,
                       lat = (0.5L - (y + 0.5L) / kHeight) * kPi;
            const Real height =
                height_at({std::cos(lat) * std::sin(lon), std::sin(lat), -std::cos(lat) * std::cos(lon)});
            // Brightness is the mean of three channels.
            for (const Real part : {0.5L, 1.5L, 1.0L}) texels.push_back(static_cast<float>(height * part));
        }
    const MemorySource source(packed_view(reinterpret_cast<const std::byte*>(texels.data()),
                                          PixelType::float32, kWidth, kHeight, 3));
    const Pyramid pyramid(source, 1, 1);
    for (const double eye : {HUGE_VAL, 400.0}) {
        SceneMaker make(21);
        const Scene scene = make.scene(4, 50, 70, 1.7, eye, 320, 240);
        FigureLook look;
        look.antialias = false;
        look.light = {Lighting::lambert, glm::normalize(glm::dvec3(-1, 2, -2)), 0, 0, 1};
        look.bumps = true;
        look.bump_scale = 2;
        const std::vector<float> pixels = draw(scene, look, {&pyramid});
        look.bumps = false;
        const std::vector<float> smooth = draw(scene, look);
        double worst = 0, off = 0, moved = 0;
        int drawn = 0;
        for (int y = 0; y < scene.height; y += 3)
            for (int x = 0; x < scene.width; x += 3) {
                const Met met = meet(scene, x + 0.5L, y + 0.5L);
                if (met.body < 0 || met.doubt < 0.02L) continue;
                const auto i = static_cast<std::size_t>(met.body);
                const Ellipsoid& e = scene.bodies[i];
                const glm::mat<3, 3, Real> own(e.rotation), turn(scene.view.rotation);
                const RealVector axes(e.axes), unit = own_point(scene, met) / axes;
                // The surface that is raised along its normals, and its own normal by differences.
                const auto raised = [&](const RealVector& at) {
                    const RealVector q = glm::normalize(at);
                    return own * (q * axes) + 2.0L * height_at(q) * glm::normalize(own * (q / axes));
                };
                const RealVector aside = glm::normalize(glm::cross(unit, RealVector(0.3L, -0.5L, 0.8L))),
                                 across = glm::cross(unit, aside);
                const Real h = 1e-5L;
                RealVector n = glm::cross(raised(unit + h * aside) - raised(unit - h * aside),
                                          raised(unit + h * across) - raised(unit - h * across));
                if (glm::dot(n, own * (unit / axes)) < 0) n = -n;
                const Real lambert =
                    std::max(0.0L, glm::dot(turn * glm::normalize(n), RealVector(look.light.toward)));
                const auto at = static_cast<std::size_t>((y * scene.width + x) * 4);
                const double here =
                    std::fabs(static_cast<double>(pixels[at + 2]) - static_cast<double>(lambert));
                worst = std::fmax(worst, here);
                off += here;
                moved += std::fabs(static_cast<double>(smooth[at + 2]) - static_cast<double>(lambert));
                ++drawn;
            }
        EXPECT_GT(drawn, 1000);
        // What F times the turn of n leaves out is a fiftieth of the slopes here.
        EXPECT_LT(worst, 0.012);
        EXPECT_LT(off, 0.15 * moved);
        EXPECT_GT(moved / drawn, 0.01);
    }
}

TEST(FigureRelief, HeightsThatAreNoNumbersOrFlatTurnNothing) {
    SceneMaker make(2);
    const Scene scene = make.scene(4, 40, 60, 3, 300);
    FigureLook look;
    const std::vector<float> smooth = draw(scene, look);
    look.bumps = true;
    for (const float height : {0.7f, NAN, INFINITY}) {
        const std::vector<float> texels(32 * 16, height);
        const MemorySource source(
            packed_view(reinterpret_cast<const std::byte*>(texels.data()), PixelType::float32, 32, 16, 1));
        const Pyramid pyramid(source, 1, 1);
        const std::vector<float> drawn = draw(scene, look, {&pyramid});
        for (std::size_t k = 0; k < drawn.size(); ++k) EXPECT_NEAR(drawn[k], smooth[k], 1e-6f);
    }
    EXPECT_EQ(draw(scene, look, {nullptr}), smooth);
    EXPECT_EQ(bumped({0, 0, 1}, {INFINITY, 0, 0}), glm::dvec3(0, 0, 1));
    EXPECT_EQ(bumped({0, 0, 1}, {0, 0, 5}), glm::dvec3(0, 0, 1));
}

}  // namespace
}  // namespace anamorph::test_figure_relief
