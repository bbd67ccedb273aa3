// SPDX-License-Identifier: Apache-2.0
// Sticks, level of detail, spheres along limbs, connected outlines.
#include <gtest/gtest.h>

#include "anamorph/figure/body/skeleton.h"
#include "anamorph/figure/outline/connected.h"
#include "anamorph/figure/outline/level_of_detail.h"
#include "anamorph/figure/outline/spheres.h"
#include "figure_outline_cases.h"

namespace anamorph::test_figure_skeleton {
using namespace figure;
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// An upper and a lower arm, bent, and a hand.
FigureFrame arm() {
    FigureFrame frame;
    frame.bodies.resize(3);
    frame.bodies[0].shape = {{0, 0, 0}, {4, 1, 1}};
    frame.bodies[1].shape = {{4, 3, 0}, {1, 3, 1}};
    frame.bodies[2].shape = {{4, 7, 0}, {1, 0.5, 1}};
    frame.joints = {{"elbow", 0, 1, {4, 0, 0}}, {"wrist", 1, 2, {4, 6, 0}}};
    return frame;
}

TEST(FigureSkeleton, SticksAreLongestAxesOrLeadFromJointToJoint) {
    const FigureFrame frame = arm();
    const std::vector<Stick> axes = axis_sticks(frame);
    ASSERT_EQ(axes.size(), 3u);
    EXPECT_EQ(axes[0].from, glm::dvec3(-4, 0, 0));
    EXPECT_EQ(axes[0].to, glm::dvec3(4, 0, 0));
    EXPECT_EQ(axes[1].from, glm::dvec3(4, 0, 0));
    EXPECT_EQ(axes[1].to, glm::dvec3(4, 6, 0));
    EXPECT_EQ(axes[2].to, glm::dvec3(5, 7, 0));

    const std::vector<Stick> joints = joint_sticks(frame);
    ASSERT_EQ(joints.size(), 3u);
    EXPECT_EQ(joints[0].from, glm::dvec3(0, 0, 0));
    EXPECT_EQ(joints[0].to, glm::dvec3(4, 0, 0));
    EXPECT_EQ(joints[1].from, glm::dvec3(4, 0, 0));
    EXPECT_EQ(joints[1].to, glm::dvec3(4, 6, 0));
    EXPECT_EQ(joints[2].body, 2);
    EXPECT_EQ(joints[2].to, glm::dvec3(4, 6, 0));

    // A negative axis is as long as a positive one.
    const std::vector<Ellipsoid> turned{{{0, 0, 0}, {1, -5, 2}}};
    EXPECT_EQ(glm::length(axis_sticks(turned)[0].to), 5);
}

TEST(FigureSkeleton, DetailFollowsTheSizeOnTheScreen) {
    const std::vector<Ellipsoid> bodies{{{0, 0, 0}, {1, 1, 1}}};
    View view;
    DetailOptions options;
    options.lod = 2;
    const auto at = [&](double scale, const glm::dvec3& axes) {
        view.scale = scale;
        return levels_of_detail(std::vector<Ellipsoid>{{{0, 0, 0}, axes}}, view, options)[0];
    };
    EXPECT_EQ(at(0.5, {1, 1, 1}), Detail::dot);
    EXPECT_EQ(at(1.01, {1, 0.5, 9}), Detail::line);
    EXPECT_EQ(at(2, {1, 1, 1}), Detail::ellipse);
    EXPECT_EQ(at(20, {1, 1, 1}), Detail::body);
    options.lod = 0;
    EXPECT_EQ(at(0.5, {1, 1, 1}), Detail::body);
    options.lod = 1;
    view.eye_distance = 100;
    view.near = 1;
    EXPECT_EQ(at(10, {1, 1, 99.5}), Detail::body);
    view.center = {0, 0, 200};
    EXPECT_EQ(at(10, {1, 1, 1}), Detail::none);
    options.lod = -1;
    EXPECT_THROW(at(1, {1, 1, 1}), Error);
    options.lod = std::nan("");
    EXPECT_THROW(at(1, {1, 1, 1}), Error);
}

TEST(FigureSkeleton, SpheresFillBodiesToTheirDeviation) {
    constexpr std::uint64_t kSeed = 7;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::SceneMaker random(kSeed);
    double least_use = 1;
    for (int n = 0; n < 40; ++n) {
        Ellipsoid body = random.body(10, 0.2, 5);
        if (n % 4 == 1) body.axes.y = body.axes.z;
        if (n % 4 == 2) body.axes = {5, 0.1, 0.4};
        if (n == 4) body.axes = glm::dvec3(2);
        if (n == 8) body.axes.x = 0;
        if (n == 12) body.axes = -body.axes;
        SphereOptions options;
        options.tol = random.between(0.02, 0.3);
        const SphereFill fill = fill_with_spheres(body, options);
        SCOPED_TRACE(::testing::Message()
                     << "case " << n << ", tol " << options.tol << ", axes " << body.axes.x << " "
                     << body.axes.y << " " << body.axes.z << ": " << fill.spheres.size());
        EXPECT_EQ(fill.deviation, options.tol);
        double outside = 0, worst = 0;
        for (int k = 0; k < 3000; ++k) {
            const glm::dvec3 u = random.direction(), p = body.center + body.rotation * (body.axes * u);
            double least = HUGE_VAL;
            for (const Sphere& s : fill.spheres)
                least = std::min(least, glm::distance(p, s.center) - s.radius);
            worst = std::max(worst, least);
            outside = std::max(outside, -least);
        }
        // No surface point is inside a sphere, none too far from all.
        EXPECT_LE(outside, 1e-12);
        EXPECT_LE(worst, fill.deviation);
        least_use = std::min(least_use, worst / fill.deviation);
        if (n == 4) {
            EXPECT_EQ(fill.spheres.size(), 1u);
        }
    }
    SphereOptions few;
    few.tol = 1e-9;
    few.most_spheres = 50;
    const SphereFill fill = fill_with_spheres({{0, 0, 0}, {9, 3, 1}}, few);
    EXPECT_LE(fill.spheres.size(), 50u);
    EXPECT_GT(fill.deviation, few.tol);
    few.tol = 0;
    EXPECT_THROW(fill_with_spheres({}, few), Error);
    EXPECT_THROW(fill_with_spheres({{0, 0, std::nan("")}, {1, 1, 1}}), Error);
}

/// How far the screen outline reaches along n.
double reach(const Outline& outline, const View& view, const glm::dvec2& n) {
    double most = -HUGE_VAL;
    for (int k = 0; k < 720; ++k)
        most = std::max(most, glm::dot(outline.on_screen(kTurn * k / 720, view), n));
    return most;
}

TEST(FigureSkeleton, StrokesAreCommonTangents) {
    for (const double eye : {HUGE_VAL, 40.0})
        for (std::uint64_t seed = 1; seed <= 30; ++seed) {
            SCOPED_TRACE(::testing::Message() << "seed " << seed << ", eye " << eye);
            test::SceneMaker random(seed);
            const std::vector<Ellipsoid> bodies{random.body(4, 0.5, 5), random.body(4, 0.5, 5)};
            View view = random.view(false);
            view.center = {0, 0, 0};
            view.scale = 20;
            view.eye_distance = eye;
            const Outlines both = outlines(bodies, view);
            const std::vector<Joint> joints{{"j", 0, 1, {0, 0, 0}}};
            const std::vector<Connection> found = connections(joints, bodies, both, view);
            ASSERT_EQ(found.size(), 1u);
            EXPECT_EQ(found[0].strokes.size() % 2, 0u);
            for (const ConnectingStroke& stroke : found[0].strokes) {
                const glm::dvec2 from = view.project(stroke.line.from), to = view.project(stroke.line.to);
                EXPECT_LT(glm::distance(from, both.bodies[0].on_screen(stroke.first_angle, view)), 1e-9);
                // Nothing of either outline is on the far side of the stroke.
                const glm::dvec2 along = glm::normalize(to - from);
                glm::dvec2 n{along.y, -along.x};
                if (glm::dot(both.bodies[0].screen.center - from, n) > 0) n = -n;
                for (const Outline& outline : both.bodies)
                    EXPECT_LE(reach(outline, view, n) - glm::dot(from, n), 1e-9);
                double length = 0;
                for (const auto* arcs : {&stroke.line.visible, &stroke.line.hidden})
                    for (const Arc& arc : *arcs) length += arc.length();
                EXPECT_NEAR(length, 1, 1e-12);
            }
            // A point of a limb is inside the hull where the arcs say so: there the other reaches farther
            // along its normal.
            for (int body = 0; body < 2; ++body) {
                const Outline& own = both.bodies[static_cast<std::size_t>(body)];
                const Outline& other = both.bodies[static_cast<std::size_t>(1 - body)];
                const std::vector<Arc>& inside = body ? found[0].second_inside : found[0].first_inside;
                for (int k = 0; k < 60; ++k) {
                    const double t = kTurn * (k + 0.5) / 60;
                    const glm::dvec2 p = own.on_screen(t, view);
                    const glm::dvec2 tangent = own.on_screen(t + 1e-6, view) - own.on_screen(t - 1e-6, view);
                    glm::dvec2 n = glm::normalize(glm::dvec2(tangent.y, -tangent.x));
                    if (glm::dot(p - own.screen.center, n) < 0) n = -n;
                    const double lead = reach(other, view, n) - glm::dot(p, n);
                    if (std::fabs(lead) > 0.02) {
                        EXPECT_EQ(test::in_arcs(inside, t), lead > 0) << "body " << body << ", angle " << t;
                    }
                }
            }
        }
    // One around the other: no strokes, and the smaller wholly inside.
    const std::vector<Ellipsoid> nested{{{0, 0, 0}, {1, 1, 1}}, {{0, 0, 0}, {3, 3, 3}}};
    const std::vector<Joint> joints{{"j", 0, 1, {0, 0, 0}}};
    const Connection c = connections(joints, nested, outlines(nested, View{}), View{})[0];
    EXPECT_TRUE(c.strokes.empty());
    ASSERT_EQ(c.first_inside.size(), 1u);
    EXPECT_EQ(c.first_inside[0].length(), kTurn);
    EXPECT_TRUE(c.second_inside.empty());
    const std::vector<Joint> wrong{{"j", 0, 2, {0, 0, 0}}};
    EXPECT_THROW(connections(wrong, nested, outlines(nested, View{}), View{}), Error);
}

TEST(FigureSkeleton, ConnectionsOfAFrameComeFromItsJoints) {
    const FigureFrame frame = arm();
    const View view;
    const std::vector<Connection> found = connections(frame, outlines(frame, view), view);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[1].first, 1);
    EXPECT_EQ(found[0].strokes.size(), 2u);
}

}  // namespace
}  // namespace anamorph::test_figure_skeleton
