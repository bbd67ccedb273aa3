// SPDX-License-Identifier: Apache-2.0
// Drapes at any tolerance and zoom, and numbers at the ends of what is allowed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "anamorph/error.h"
#include "drape_scene.h"

namespace anamorph::test_drape_hard {
using namespace surface;
namespace {

using test::number_of;
using test::Plain;
using test::Scene;
using test::Shown;

/// Views that a surface fills: from inside of what is closed, and near before the others.
std::vector<Scene> full_views() {
    std::vector<Scene> all;
    for (const std::string name : {"sphere", "torus", "cylinder", "page_turn", "waves", "ripples", "plane"}) {
        Scene scene{name};
        scene.shape.angle = 360;
        scene.shape.direction = 33;
        scene.shape.turn = 0.25;
        scene.pose.position = {0.1, -0.05, 0.9};
        scene.pose.target = {0.05, 0.03, 0};
        if (name == "sphere") scene.pose.position = {0.1, -0.05, 0.2};
        if (name == "cylinder") {
            scene.pose.position = {0.02, -0.05, 0.03};
            scene.pose.target = {0.6, 0, -0.3};
        }
        if (name == "torus") {
            scene.pose.position = {0.5, 0.02, 0};
            scene.pose.target = {0.5, -0.03, 0.3};
        }
        scene.screen = {48, 40};
        scene.picture = {40, 30};
        all.push_back(scene);
    }
    return all;
}

TEST(DrapeHard, AConstantPictureHasNoHoleAtAnyToleranceAndZoom) {
    const Plain plain({40, 30}, {0.75f});
    for (Scene scene : full_views())
        for (const double fov : {35.0, 2.0, 0.03})
            for (const double tol : {16.0, 0.5, 0.015})
                for (const DrapeScheme scheme : {DrapeScheme::automatic, DrapeScheme::exact})
                    for (const Filter filter : {Filter::bilinear, Filter::antialias, Filter::summed_area}) {
                        // What differs by the scheme are points, not pixels.
                        if (scheme == DrapeScheme::exact && filter != Filter::antialias) continue;
                        scene.pose.fov = fov;
                        DrapeOptions options;
                        options.tol = tol;
                        options.scheme = scheme;
                        options.filter = filter;
                        const std::vector<float> drawn = Shown(scene, options).draw(plain.source(), 1);
                        EXPECT_THAT(drawn, testing::Each(testing::FloatNear(0.75f, 1e-5f)))
                            << scene.surface << " fov " << fov << " tol " << tol;
                        if (HasFailure()) return;
                    }
}

TEST(DrapeHard, ExtentsOfNothingAreRefusedAndTheLeastAreDrawn) {
    for (const double extent : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        const Deformation d{{0, 0, 0.1}, {0.5, 0.5}, {extent, 0.1}};
        EXPECT_THROW(make_surface(number_of("plane"), {}, {d}), Error) << extent;
    }
    // A needle of 1e-12 is between the pixels; the sheet about it is whole.
    Scene scene;
    scene.deformations = {{{0, 0, 0.1}, {0.5, 0.5}, {1e-12, 1e-12}}};
    scene.pose.fov = 20;
    const std::vector<float> covered = Shown(scene).seen();
    EXPECT_EQ(std::count(covered.begin(), covered.end(), 0.0f), 0);
}

TEST(DrapeHard, ADisplacementOfATrillionLeavesTheRestInPlace) {
    // Towards the viewer, beside what is in view.
    Scene scene;
    scene.deformations = {{{0, 0, 1e12}, {0.25, 0.5}, {0.01, 0.01}, DeformationKernel::wendland_c2}};
    scene.pose.position = {0.3, 0, 1};
    scene.pose.target = {0.3, 0, 0};
    scene.pose.fov = 15;
    const std::vector<float> points = Shown(scene).values(Output::stmap);
    const double width = 2 * std::tan(7.5 * kPi / 180);
    for (int x = 0; x < 160; ++x) {
        const std::size_t k = 2 * (60 * 160 + static_cast<std::size_t>(x));
        EXPECT_NEAR(points[k], 0.5 + 0.3 + width * ((x + 0.5) / 160 - 0.5), 0.2 * width / 160);
    }
}

TEST(DrapeHard, AHeightThatIsNoNumberIsAHoleAndNoMore) {
    const Size size{20, 20};
    std::vector<float> heights(400, 0.5f);
    heights[8 * 20 + 12] = std::numeric_limits<float>::quiet_NaN();
    SurfaceSum sum;
    sum.heights = std::make_shared<SampledField>(heights, size, 1);
    sum.height_scale = 0.1;
    EXPECT_EQ(sum.heights->first_missing().x, 12);
    EXPECT_EQ(sum.heights->first_missing().y, 8);
    Scene scene;
    scene.own = make_surface(sum);
    scene.pose.perspective = false;
    scene.pose.extent = 1;
    scene.screen = {200, 200};
    const std::vector<float> covered = Shown(scene).seen();
    int wrong = 0, holes = 0;
    for (int y = 1; y < 199; ++y)
        for (int x = 1; x < 199; ++x) {
            const double from = std::max(std::fabs((x + 0.5) / 10 - 12.5), std::fabs((y + 0.5) / 10 - 8.5));
            const bool hole = covered[static_cast<std::size_t>(y * 200 + x)] == 0;
            holes += hole;
            wrong += from < 1.9 ? !hole : from > 2.2 ? hole : 0;
        }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(holes, 1400);
}

}  // namespace
}  // namespace anamorph::test_drape_hard
