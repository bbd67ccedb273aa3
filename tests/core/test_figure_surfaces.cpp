// SPDX-License-Identifier: Apache-2.0
// What pixels see of ellipsoids, against the textbook's ray and quadric in long double.
#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "anamorph/error.h"
#include "anamorph/figure/image/visible_surfaces.h"
#include "figure_picture_cases.h"

namespace anamorph::test_figure_surfaces {
using namespace figure;
namespace {

using namespace figure_picture_cases;

// Doubles see a scene of a few hundred units, of bodies down to a few hundredths, to so much.
constexpr Real kDoubt = 1e-9L;

VisibleSurfaces surfaces_of(const Scene& scene) {
    return {scene.bodies, scene.view, double(scene.height)};
}

/// Every pixel's middle. Returns the pixels in which double cannot know.
int expect_points(const Scene& scene) {
    const VisibleSurfaces surfaces = surfaces_of(scene);
    const std::vector<VisiblePoint> points = surfaces.points({0, 0, scene.width, scene.height});
    int doubtful = 0;
    for (int y = 0; y < scene.height; ++y)
        for (int x = 0; x < scene.width; ++x) {
            const VisiblePoint& seen = points[static_cast<std::size_t>(y * scene.width + x)];
            const Met met = meet(scene, x + 0.5L, y + 0.5L);
            if (met.doubt < kDoubt) {
                ++doubtful;
                continue;
            }
            EXPECT_EQ(seen.body, met.body) << x << " " << y;
            if (seen.body != met.body || seen.body < 0) continue;
            EXPECT_EQ(seen.hit.far_side, met.far_side);
            const double depth = depth_of(seen.hit.nearness, surfaces.perspective());
            EXPECT_NEAR(depth, static_cast<double>(met.depth), 1e-7) << x << " " << y;
            // The point itself, and the gradient of the quadric there.
            const Ellipsoid& e = scene.bodies[static_cast<std::size_t>(seen.body)];
            const SeenSurface& surface = surfaces.surface(seen.body);
            const RealVector at(surface.unit_point(x + 0.5, y + 0.5, seen.hit.far_side)),
                outwards(surface.gradient(x + 0.5, y + 0.5, seen.hit.far_side));
            const glm::mat<3, 3, Real> own = glm::transpose(glm::mat<3, 3, Real>(e.rotation));
            const RealVector unit = own * (met.point - RealVector(e.center)) / RealVector(e.axes);
            EXPECT_LT(glm::length(unit - at), 1e-5L) << x << " " << y;
            const RealVector gradient = glm::mat<3, 3, Real>(scene.view.rotation) *
                                        (glm::transpose(own) * (unit / RealVector(e.axes)));
            EXPECT_LT(glm::length(glm::normalize(gradient) - glm::normalize(outwards)), 1e-4L);
        }
    return doubtful;
}

/// Every pixel's 256 samples. Returns the samples that differ, none by more than two of a body in a pixel.
int expect_parts(const Scene& scene) {
    const VisibleSurfaces surfaces = surfaces_of(scene);
    const VisibleParts parts = surfaces.parts({0, 0, scene.width, scene.height});
    int different = 0;
    for (int y = 0; y < scene.height; ++y)
        for (int x = 0; x < scene.width; ++x) {
            std::map<int, int> samples;
            for (int i = 0; i < 256; ++i) {
                const Met met = meet(scene, x + (i % 16 + 0.5L) / 16, y + (i / 16 + 0.5L) / 16);
                if (met.body >= 0) ++samples[2 * met.body + met.far_side];
            }
            for (const VisiblePart& part : parts.of(x, y)) {
                samples[2 * part.body + part.far_side] -= part.samples;
                EXPECT_GE(part.x, x);
                EXPECT_LE(part.x, x + 1);
                EXPECT_GE(part.y, y);
                EXPECT_LE(part.y, y + 1);
            }
            for (const auto& [body, rest] : samples) {
                EXPECT_LE(std::abs(rest), 2) << "body " << body / 2 << " in " << x << " " << y;
                different += std::abs(rest);
            }
        }
    return different;
}

TEST(FigureSurfaces, MiddlesOfPixelsMeetWhatRaysMeet) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(seed);
        SceneMaker make(seed);
        const double eye = seed % 2 ? HUGE_VAL : make.number(150, 1000);
        EXPECT_EQ(expect_points(make.scene(20, 3, 60, seed % 4 < 2 ? 5 : 1000, eye)), 0);
    }
    SceneMaker make(99);
    EXPECT_EQ(expect_points(make.scene(2000, 1, 20, 1000, HUGE_VAL, 100, 80)), 0);
    EXPECT_EQ(expect_points(make.scene(2000, 1, 20, 1000, 300, 100, 80)), 0);
}

TEST(FigureSurfaces, FromAmongAndInsideBodies) {
    // In some, the near plane leaves nothing of a body but the inside of what is beyond its limb.
    for (unsigned seed = 0; seed < 150; ++seed) {
        SCOPED_TRACE(seed);
        SceneMaker make(seed);
        // The eye is where the bodies are, and in a room.
        Scene scene = make.scene(15, 5, 80, seed % 2 ? 4 : 300, make.number(1, 60));
        scene.view.near = make.number(0.01, 20);
        if (seed % 3 == 0) scene.bodies.push_back({{0, 0, 0}, {300, 350, 400}, make.turn()});
        EXPECT_LE(expect_points(scene), 1);
    }
}

TEST(FigureSurfaces, PartsAreWhatAllSamplesMeet) {
    int different = 0;
    for (unsigned seed = 0; seed < 12; ++seed) {
        SCOPED_TRACE(seed);
        SceneMaker make(seed);
        const double eye = seed % 2 ? HUGE_VAL : make.number(120, 600);
        different +=
            expect_parts(make.scene(seed % 3 ? 12 : 60, 3, 50, seed % 4 < 2 ? 4 : 1000, eye, 18, 14));
    }
    EXPECT_LE(different, 2);
    different = 0;
    for (unsigned seed = 0; seed < 6; ++seed) {
        SCOPED_TRACE(seed);
        SceneMaker make(seed);
        Scene scene = make.scene(10, 5, 80, 4, make.number(1, 60), 18, 14);
        scene.view.near = make.number(0.01, 20);
        if (seed % 2 == 0) scene.bodies.push_back({{0, 0, 0}, {300, 350, 400}, make.turn()});
        different += expect_parts(scene);
    }
    EXPECT_LE(different, 2);
}

/// The same without rounding of centres: one body, whose limb is the ellipse x^2 / a^2 + y^2 / b^2 = 1.
TEST(FigureSurfaces, AnUnturnedBodyCoversItsEllipse) {
    Scene scene;
    scene.bodies = {{{0, 0, 7}, {20.25, 11.5, 3}, glm::dmat3(1.0)}};
    scene.view.middle = {32, 24};
    const VisibleParts parts = surfaces_of(scene).parts({0, 0, 64, 48});
    double area = 0;
    for (const VisiblePart& part : parts.parts) area += part.samples / 256.0;
    EXPECT_NEAR(area, std::numbers::pi * 20.25 * 11.5, 0.2);
    EXPECT_EQ(parts.of(32, 24).size(), 1u);
    EXPECT_EQ(parts.of(32, 24)[0].samples, 256);
    EXPECT_TRUE(parts.of(0, 0).empty());
}

TEST(FigureSurfaces, TangentAndCoincidentBodies) {
    Scene scene;
    scene.view.middle = {32, 24};
    // Two that touch beside each other, one inside that touches the first from within, and the first again.
    const Ellipsoid first = {{-10, 0, 0}, {10, 10, 10}, glm::dmat3(1.0)};
    scene.bodies = {first,
                    {{10, 0, 0}, {10, 10, 10}, glm::dmat3(1.0)},
                    {{-10, 0, -5}, {5, 5, 5}, glm::dmat3(1.0)},
                    first};
    const VisibleSurfaces surfaces = surfaces_of(scene);
    const VisibleParts parts = surfaces.parts({0, 0, 64, 48});
    double shown[4] = {};
    for (const VisiblePart& part : parts.parts) shown[part.body] += part.samples / 256.0;
    EXPECT_NEAR(shown[0], std::numbers::pi * 100, 0.2);
    EXPECT_NEAR(shown[1], std::numbers::pi * 100, 0.2);
    EXPECT_LT(shown[2], 1);  // it touches at the nearest point
    EXPECT_EQ(shown[3], 0);  // of two that coincide the first is seen
    for (const VisiblePoint& point : surfaces.points({0, 0, 64, 48})) EXPECT_NE(point.body, 3);
}

TEST(FigureSurfaces, BodiesWithoutVolume) {
    Scene scene;
    scene.view.middle = {32, 24};
    scene.bodies = {{{0, 0, 0}, {15, 10, 0}, glm::dmat3(1.0)},   // a disc, seen from the front
                    {{0, 0, 5}, {0, 20, 12}, glm::dmat3(1.0)},   // one seen from the side
                    {{0, 0, -5}, {0, 0, 0}, glm::dmat3(1.0)},    // a point
                    {{0, 0, -5}, {25, 0, 0}, glm::dmat3(1.0)}};  // a line
    double shown[4] = {};
    for (const VisiblePart& part : surfaces_of(scene).parts({0, 0, 64, 48}).parts)
        shown[part.body] += part.samples / 256.0;
    EXPECT_NEAR(shown[0], std::numbers::pi * 150, 0.2);
    for (const int i : {1, 2, 3}) EXPECT_LT(shown[i], 0.1) << i;
    scene.bodies[0].axes = {-15, 10, -3};
    EXPECT_EQ(surfaces_of(scene).points({0, 0, 64, 48})[24 * 64 + 32].body, 0);
}

TEST(FigureSurfaces, AnyBoxIsTheSame) {
    SceneMaker make(5);
    Scene scene = make.scene(60, 3, 60, 300, 200, 90, 70);
    scene.bodies.push_back({{0, 0, 0}, {400, 350, 400}, make.turn()});
    const VisibleSurfaces surfaces = surfaces_of(scene);
    const VisibleParts whole = surfaces.parts({0, 0, 90, 70});
    const std::vector<VisiblePoint> points = surfaces.points({0, 0, 90, 70});
    for (const Box& box : {Box{13, 5, 14, 6}, Box{0, 33, 90, 34}, Box{40, 20, 77, 63}, Box{-5, -7, 20, 10}}) {
        const VisibleParts part = surfaces.parts(box);
        const std::vector<VisiblePoint> some = surfaces.points(box);
        for (int y = std::max(0, box.y0); y < box.y1; ++y)
            for (int x = std::max(0, box.x0); x < box.x1; ++x) {
                const auto a = part.of(x, y), b = whole.of(x, y);
                ASSERT_EQ(a.size(), b.size()) << x << " " << y;
                for (std::size_t k = 0; k < a.size(); ++k) {
                    EXPECT_EQ(a[k].body, b[k].body);
                    EXPECT_EQ(a[k].samples, b[k].samples);
                    EXPECT_EQ(a[k].x, b[k].x);
                    EXPECT_EQ(a[k].y, b[k].y);
                }
                const VisiblePoint& p =
                    some[static_cast<std::size_t>((y - box.y0) * box.width() + x - box.x0)];
                EXPECT_EQ(p.body, points[static_cast<std::size_t>(y * 90 + x)].body);
                EXPECT_EQ(p.hit.nearness, points[static_cast<std::size_t>(y * 90 + x)].hit.nearness);
            }
    }
}

TEST(FigureSurfaces, ValuesThatAreNoNumbersAreNamed) {
    Scene scene;
    scene.bodies = {{}, {{0, NAN, 0}, {1, 1, 1}, glm::dmat3(1.0)}};
    EXPECT_THROW(
        {
            try {
                VisibleSurfaces(scene.bodies, scene.view, 48, {"head", "neck"});
            } catch (const Error& e) {
                EXPECT_NE(std::string(e.what()).find("body neck center=0,nan,0"), std::string::npos)
                    << e.what();
                throw;
            }
        },
        Error);
    scene.bodies[1].center.y = 0;
    scene.bodies[1].axes.x = HUGE_VAL;
    EXPECT_THROW(surfaces_of(scene), Error);
    scene.bodies[1].axes.x = 1e25;
    scene.view.scale = NAN;
    EXPECT_THROW(surfaces_of(scene), Error);
    // Values that are allowed give a picture, whatever it is.
    scene.view.scale = 1e-20;
    for (const double eye : {HUGE_VAL, 1e-3, 1e24}) {
        scene.view.eye_distance = eye;
        const VisibleParts parts = surfaces_of(scene).parts({0, 0, 8, 8});
        for (const VisiblePart& part : parts.parts) EXPECT_GE(part.body, 0);
    }
}

}  // namespace
}  // namespace anamorph::test_figure_surfaces
