// SPDX-License-Identifier: Apache-2.0
// Views that figures fill, against points all over the bodies.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <random>

#include "anamorph/figure/body/rotation.h"
#include "anamorph/figure/outline/fit.h"

namespace anamorph::test_figure_fit {
using namespace figure;
namespace {

FigureFrame random_frame(std::mt19937& random, int bodies) {
    std::uniform_real_distribution<double> place(0, 1000), axis(5, 200), angle(0, 360);
    FigureFrame frame;
    for (int k = 0; k < bodies; ++k) {
        Body body;
        body.shape.center = {place(random), place(random), place(random)};
        body.shape.axes = {axis(random), axis(random), axis(random)};
        body.shape.rotation = glm::mat3_cast(turn_xyz({angle(random), angle(random), angle(random)}));
        frame.bodies.push_back(body);
    }
    return frame;
}

TEST(FitView, BodiesFillThePictureToItsMargin) {
    const unsigned seed = 3;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (const double eye : {HUGE_VAL, 3000., 1500.})
        for (const glm::dvec2 size : {glm::dvec2(400, 300), glm::dvec2(200, 500)})
            for (int round = 0; round < 10; ++round) {
                const FigureFrame frame = random_frame(random, 4);
                View view = view_in(frame, size);
                view.rotation = glm::mat3_cast(turn_xyz({20, 130, 50}));
                view.eye_distance = eye;
                SeenExtent extent;
                add_seen_extent(frame, view, extent);
                fit_view(view, extent, size);
                glm::dvec2 least(HUGE_VAL), most(-HUGE_VAL);
                for (const Body& body : frame.bodies)
                    for (int k = 0; k < 4000; ++k) {
                        const glm::dvec3 n =
                            glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
                        const glm::dvec2 p =
                            view.project(body.shape.center + body.shape.rotation * (body.shape.axes * n));
                        least = glm::min(least, p);
                        most = glm::max(most, p);
                    }
                const glm::dvec2 margin = 0.05 * size;
                EXPECT_GE(least.x, margin.x - 1e-9);
                EXPECT_GE(least.y, margin.y - 1e-9);
                EXPECT_LE(most.x, size.x - margin.x + 1e-9);
                EXPECT_LE(most.y, size.y - margin.y + 1e-9);
                // One way the picture is filled; samples come within two pixels of the outline.
                const glm::dvec2 left = (size - 2.0 * margin) - (most - least);
                EXPECT_LE(std::min(left.x, left.y), 2);
                EXPECT_NEAR(least.x + most.x, size.x, 4);
                EXPECT_NEAR(least.y + most.y, size.y, 4);
            }
}

TEST(FitView, NothingToSeeChangesNothing) {
    View view;
    const View before = view;
    fit_view(view, SeenExtent(), {100, 100});
    EXPECT_EQ(view.scale, before.scale);
    EXPECT_EQ(view.middle, before.middle);
    // A point is put into the middle.
    SeenExtent point;
    FigureFrame frame;
    frame.bodies.emplace_back().shape = {{3, 4, 5}, {0, 0, 0}, glm::dmat3(1.0)};
    add_seen_extent(frame, view, point);
    fit_view(view, point, {100, 80});
    EXPECT_EQ(view.scale, before.scale);
    EXPECT_EQ(view.project({3, 4, 5}), glm::dvec2(50, 40));
    // Behind the eye.
    view.eye_distance = 10;
    SeenExtent behind;
    frame.bodies[0].shape.center.z = -20;
    add_seen_extent(frame, view, behind);
    EXPECT_TRUE(behind.empty());
}

}  // namespace
}  // namespace anamorph::test_figure_fit
