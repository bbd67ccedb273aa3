// SPDX-License-Identifier: Apache-2.0
// Pictures of figures in all styles.
#include "anamorph/figure/image/figure_picture.h"

#include <gtest/gtest.h>

#include <numbers>
#include <thread>

#include "anamorph/error.h"
#include "figure_picture_cases.h"

namespace anamorph::test_figure_picture {
using namespace figure;
namespace {

using namespace figure_picture_cases;

constexpr FigureStyle kStyles[] = {FigureStyle::shaded, FigureStyle::outline, FigureStyle::stick,
                                   FigureStyle::depth,  FigureStyle::id,      FigureStyle::uv};

FigureFrame frame_of(const Scene& scene) {
    FigureFrame frame;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        Body body;
        body.shape = scene.bodies[i];
        body.name = "body";
        body.name += std::to_string(i);
        body.color = {double(i * 37 % 256), double(i * 91 % 256), double(i * 53 % 256)};
        frame.bodies.push_back(body);
        if (i > 0)
            frame.joints.push_back({"joint", static_cast<int>(i) - 1, static_cast<int>(i),
                                    0.5 * (scene.bodies[i - 1].center + scene.bodies[i].center)});
    }
    return frame;
}

std::vector<float> draw(const FigurePicture& picture, FigureStyle style, const Box& box,
                        const ParallelFor& parallel_for = serial_for) {
    const int channels = channels_of(style);
    std::vector<float> pixels(static_cast<std::size_t>(box.width() * box.height() * channels), -7.0f);
    picture.draw(box,
                 packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, box.width(),
                             box.height(), channels),
                 parallel_for);
    return pixels;
}

std::vector<float> draw(const Scene& scene, const FigureLook& look) {
    return draw(FigurePicture(frame_of(scene), scene.view, {scene.width, scene.height}, look), look.style,
                {0, 0, scene.width, scene.height});
}

/// The formulas of shading.h, of what a ray meets.
RealVector shaded(const Scene& scene, const Light& light, const Met& met, Real x, Real y) {
    const auto i = static_cast<std::size_t>(met.body);
    const Ellipsoid& e = scene.bodies[i];
    const RealVector color = RealVector(frame_of(scene).bodies[i].color) / 255.0L;
    const glm::mat<3, 3, Real> own(e.rotation), turn(scene.view.rotation);
    const RealVector axes(e.axes), at = glm::transpose(own) * (met.point - RealVector(e.center));
    RealVector g = turn * (own * (at / (axes * axes)));
    if (met.far_side) g = -g;
    const RealVector l(light.toward);
    const Real size = glm::length(g), a = light.ambient;
    if (light.lighting == Lighting::rasel)
        return color * (a + (1 - a) * (glm::dot(g, l) + size) / (2 * size));
    const RealVector direction = turn * ray_at(scene, x, y).direction,
                     v = -direction / glm::length(direction);
    const Real lambert = std::max(0.0L, glm::dot(g, l) / size);
    RealVector out = color * (a + (1 - a) * lambert);
    if (light.lighting == Lighting::blinn && lambert > 0)
        out += RealVector(light.specular * std::pow(std::max(0.0L, glm::dot(g / size, glm::normalize(l + v))),
                                                    static_cast<Real>(light.shininess)));
    return out;
}

TEST(FigurePicture, ShadesByTheFormulas) {
    for (const Lighting lighting : {Lighting::rasel, Lighting::lambert, Lighting::blinn})
        for (const double eye : {HUGE_VAL, 300.0, 20.0}) {
            SceneMaker make(static_cast<unsigned>(lighting));
            const Scene scene = make.scene(20, 10, 60, 5, eye);
            FigureLook look;
            look.antialias = false;
            look.light = {lighting, glm::normalize(glm::dvec3(-1, 2, -2)), 0.25, 0.5, 20};
            const std::vector<float> pixels = draw(scene, look);
            for (int y = 0; y < scene.height; ++y)
                for (int x = 0; x < scene.width; ++x) {
                    const Met met = meet(scene, x + 0.5L, y + 0.5L);
                    const float* p = &pixels[static_cast<std::size_t>(y * scene.width + x) * 4];
                    EXPECT_EQ(p[3], met.body < 0 ? 0 : 1);
                    const RealVector wanted =
                        met.body < 0 ? RealVector(0.0L) : shaded(scene, look.light, met, x + 0.5L, y + 0.5L);
                    for (int c = 0; c < 3; ++c)
                        EXPECT_NEAR(static_cast<double>(p[c]), static_cast<double>(wanted[c]), 1e-6);
                }
        }
}

TEST(FigurePicture, AlphaAndColorsAreTheMeanOfSamples) {
    for (unsigned seed = 0; seed < 4; ++seed) {
        SceneMaker make(seed);
        const Scene scene = make.scene(15, 8, 60, seed % 2 ? 4 : 1000, seed < 2 ? HUGE_VAL : 250, 20, 15);
        const FigureLook look;
        const std::vector<float> pixels = draw(scene, look);
        double off = 0;
        for (int y = 0; y < scene.height; ++y)
            for (int x = 0; x < scene.width; ++x) {
                RealVector sum(0.0L);
                int hits = 0;
                for (int i = 0; i < 256; ++i) {
                    const Real sx = x + (i % 16 + 0.5L) / 16, sy = y + (i / 16 + 0.5L) / 16;
                    const Met met = meet(scene, sx, sy);
                    if (met.body < 0) continue;
                    ++hits;
                    sum += shaded(scene, look.light, met, sx, sy);
                }
                const float* p = &pixels[static_cast<std::size_t>(y * scene.width + x) * 4];
                EXPECT_NEAR(static_cast<double>(p[3]), hits / 256.0, 1.0 / 128);
                // A colour is that in the middle of samples: limbs are curved, and pixels here are large.
                for (int c = 0; c < 3; ++c) {
                    const double wanted = static_cast<double>(sum[c]) / 256;
                    EXPECT_NEAR(static_cast<double>(p[c]), wanted, 0.05);
                    off += std::fabs(static_cast<double>(p[c]) - wanted);
                }
            }
        EXPECT_LT(off / (3 * scene.width * scene.height), 0.003);
    }
}

TEST(FigurePicture, DepthIdAndUv) {
    SceneMaker make(3);
    for (const double eye : {HUGE_VAL, 200.0}) {
        const Scene scene = make.scene(12, 10, 60, 5, eye);
        FigureLook look;
        look.style = FigureStyle::depth;
        const std::vector<float> depth = draw(scene, look);
        look.style = FigureStyle::id;
        const std::vector<float> id = draw(scene, look);
        look.style = FigureStyle::uv;
        const std::vector<float> uv = draw(scene, look);
        for (int y = 0; y < scene.height; ++y)
            for (int x = 0; x < scene.width; ++x) {
                const auto k = static_cast<std::size_t>(y * scene.width + x);
                const Met met = meet(scene, x + 0.5L, y + 0.5L);
                EXPECT_EQ(id[k], static_cast<float>(met.body + 1));
                if (met.body < 0) {
                    EXPECT_EQ(depth[k], kNoDepth);
                    EXPECT_EQ(uv[2 * k], -1);
                    EXPECT_EQ(uv[2 * k + 1], -1);
                    continue;
                }
                EXPECT_NEAR(static_cast<double>(depth[k]), static_cast<double>(met.depth), 2e-5);
                const Ellipsoid& e = scene.bodies[static_cast<std::size_t>(met.body)];
                const RealVector p = glm::transpose(glm::mat<3, 3, Real>(e.rotation)) *
                                     (met.point - RealVector(e.center)) / RealVector(e.axes);
                // Back from (u, v) to the sphere.
                const double longitude = (double(uv[2 * k]) - 0.5) * 2 * std::numbers::pi,
                             latitude = (0.5 - double(uv[2 * k + 1])) * std::numbers::pi;
                EXPECT_NEAR(std::sin(longitude) * std::cos(latitude), static_cast<double>(p.x), 2e-6);
                EXPECT_NEAR(std::sin(latitude), static_cast<double>(p.y), 2e-6);
                EXPECT_NEAR(-std::cos(longitude) * std::cos(latitude), static_cast<double>(p.z), 2e-6);
            }
    }
}

TEST(FigurePicture, MappingsShowTheFrontAlike) {
    constexpr double pi = std::numbers::pi;
    for (const BodyMapping m :
         {BodyMapping::latlong, BodyMapping::mirrored, BodyMapping::linear, BodyMapping::octahedral}) {
        const glm::dvec2 middle = texture_point(m, {0, 0, -1});
        EXPECT_EQ(middle, glm::dvec2(0.5));
        EXPECT_GT(texture_point(m, {0.6, 0, -0.8}).x, 0.5);  // right
        EXPECT_LT(texture_point(m, {0, 0.6, -0.8}).y, 0.5);  // up
        SceneMaker make(1);
        for (int i = 0; i < 1000; ++i) {
            const glm::dvec3 p =
                glm::normalize(glm::dvec3(make.number(-1, 1), make.number(-1, 1), make.number(-1, 1)));
            const glm::dvec2 uv = texture_point(m, p);
            EXPECT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
            if (m == BodyMapping::octahedral) continue;
            EXPECT_NEAR(std::sin(pi * (0.5 - uv.y)), p.y, 1e-12);
            const double longitude = pi * (uv.x - 0.5);
            // The essay's formulas.
            if (m == BodyMapping::linear) {
                EXPECT_NEAR(std::sin(longitude), p.x, 1e-12);
            } else if (m == BodyMapping::mirrored) {
                EXPECT_NEAR(std::sin(longitude), p.x / std::cos(std::asin(p.y)), 1e-9);
            } else {
                EXPECT_NEAR(std::cos(2 * longitude) * std::cos(std::asin(p.y)), -p.z, 1e-9);
            }
        }
        for (const glm::dvec3& pole : {glm::dvec3(0, 1, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1)})
            EXPECT_TRUE(std::isfinite(texture_point(m, pole).x + texture_point(m, pole).y));
    }
    // Octahedral: no two points of the sphere on one of the square, and its inverse is known.
    SceneMaker make(2);
    for (int i = 0; i < 1000; ++i) {
        const glm::dvec3 p =
            glm::normalize(glm::dvec3(make.number(-1, 1), make.number(-1, 1), make.number(-1, 1)));
        const glm::dvec2 uv = texture_point(BodyMapping::octahedral, p), q(2 * uv.x - 1, 1 - 2 * uv.y);
        glm::dvec3 back(q.x, q.y, std::fabs(q.x) + std::fabs(q.y) - 1);
        if (back.z > 0) {
            back.x = (1 - std::fabs(q.y)) * (q.x < 0 ? -1 : 1);
            back.y = (1 - std::fabs(q.x)) * (q.y < 0 ? -1 : 1);
        }
        EXPECT_LT(glm::length(glm::normalize(back) - p), 1e-12);
    }
}

TEST(FigurePicture, LinesCoverWhatIsWithinHalfTheirWidth) {
    Scene scene;
    scene.bodies = {{{0, 0, 0}, {20, 20, 20}, glm::dmat3(1.0)}};
    scene.view.middle = {32.3, 24.1};
    FigureLook look;
    look.style = FigureStyle::outline;
    look.lines.tol = 0.01;
    for (const double width : {0.5, 1.0, 3.5}) {
        look.lines.line_width = width;
        const std::vector<float> pixels = draw(scene, look);
        for (int y = 0; y < scene.height; ++y)
            for (int x = 0; x < scene.width; ++x) {
                int hits = 0;
                for (int i = 0; i < 256; ++i) {
                    const double dx = x + (i % 16 + 0.5) / 16 - 32.3,
                                 dy = y + (i / 16 + 0.5) / 16 - (48 - 24.1);
                    hits += std::fabs(std::hypot(dx, dy) - 20) <= 0.5 * width;
                }
                // Chords are inside the circle by 0.01 pixels at most.
                EXPECT_NEAR(static_cast<double>(pixels[static_cast<std::size_t>(y * 64 + x) * 4 + 3]),
                            hits / 256.0, 0.07)
                    << x << " " << y;
            }
    }
    // The middle of sticks.
    look.style = FigureStyle::stick;
    look.lines.line_width = 4;
    scene.bodies.push_back({{10, 5, 0}, {3, 3, 3}, glm::dmat3(1.0)});
    const std::vector<float> sticks = draw(scene, look);
    EXPECT_EQ(sticks[static_cast<std::size_t>((24 - 1) * 64 + 32 + 2) * 4 + 3], 1);
    EXPECT_EQ(sticks[static_cast<std::size_t>(40 * 64 + 10) * 4 + 3], 0);
}

TEST(FigurePicture, BackgroundLiesBehind) {
    SceneMaker make(8);
    const Scene scene = make.scene(9, 10, 60, 5, HUGE_VAL);
    FigureLook look;
    for (const FigureStyle style : {FigureStyle::shaded, FigureStyle::outline}) {
        look.style = style;
        look.background.reset();
        const std::vector<float> before = draw(scene, look);
        look.background = {0.25, 0.5, 1};
        const std::vector<float> with = draw(scene, look);
        for (std::size_t i = 0; i < with.size(); i += 4) {
            EXPECT_EQ(with[i + 3], 1);
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(with[i + c],
                            before[i + c] + (1 - before[i + 3]) *
                                                static_cast<float>((*look.background)[static_cast<int>(c)]),
                            1e-6f);
        }
    }
}

TEST(FigurePicture, AnyBoxAndThreadsAreTheSame) {
    SceneMaker make(5);
    const Scene scene = make.scene(40, 3, 60, 100, 300, 300, 170);
    const ParallelFor threads = [](std::int64_t count, const std::function<void(std::int64_t)>& body) {
        std::vector<std::thread> all;
        for (int t = 0; t < 3; ++t)
            all.emplace_back([&, t] {
                for (std::int64_t i = count - 1 - t; i >= 0; i -= 3) body(i);
            });
        for (std::thread& t : all) t.join();
    };
    for (const FigureStyle style : kStyles) {
        SCOPED_TRACE(static_cast<int>(style));
        FigureLook look;
        look.style = style;
        const FigurePicture picture(frame_of(scene), scene.view, {scene.width, scene.height}, look);
        const std::vector<float> whole = draw(picture, style, {0, 0, 300, 170});
        EXPECT_EQ(draw(picture, style, {0, 0, 300, 170}, threads), whole);
        const auto channels = static_cast<std::size_t>(channels_of(style));
        for (const Box& box : {Box{7, 3, 8, 4}, Box{100, 50, 290, 168}, Box{250, 120, 520, 330}}) {
            const std::vector<float> part = draw(picture, style, box);
            for (int y = box.y0; y < box.y1; ++y)
                for (int x = box.x0; x < box.x1; ++x)
                    for (std::size_t c = 0; c < channels; ++c) {
                        const float at =
                            part[static_cast<std::size_t>((y - box.y0) * box.width() + x - box.x0) *
                                     channels +
                                 c];
                        if (x >= 300 || y >= 170)
                            EXPECT_EQ(at, 0);
                        else
                            ASSERT_EQ(at, whole[static_cast<std::size_t>(y * 300 + x) * channels + c])
                                << x << " " << y;
                    }
        }
    }
}

TEST(FigurePicture, NothingIsWrittenBeyondTheView) {
    EXPECT_THROW(FigurePicture(FigureFrame(), View(), {0, 40}, {}), Error);
    const FigurePicture picture(FigureFrame(), View(), {40, 40}, {});
    std::vector<float> pixels(20 * 10 * 4, -1);
    const auto small =
        packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, 10, 10, 4);
    EXPECT_THROW(picture.draw({0, 0, 10, 11}, small), Error);
    EXPECT_THROW(picture.draw({0, 0, 11, 10}, small), Error);
    EXPECT_EQ(std::count(pixels.begin(), pixels.end(), -1.0f), 800);
    picture.draw({35, 35, 45, 45}, small);
    EXPECT_EQ(std::count(pixels.begin(), pixels.end(), -1.0f), 400);
}

TEST(FigurePicture, BadBodiesAreNamed) {
    Scene scene;
    scene.bodies = {{}, {{0, 0, NAN}, {1, 1, 1}, glm::dmat3(1.0)}};
    for (const FigureStyle style : kStyles) {
        FigureLook look;
        look.style = style;
        if (style == FigureStyle::stick) continue;  // bodies are not looked at
        try {
            draw(scene, look);
            ADD_FAILURE() << "no error";
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("body1"), std::string::npos) << e.what();
        }
    }
}

}  // namespace
}  // namespace anamorph::test_figure_picture
