// SPDX-License-Identifier: Apache-2.0
// Levels of detail and elliptic cylinders in place of outlines: how far off they are, by support functions of points in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "anamorph/figure/outline/drawing.h"
#include "anamorph/figure/outline/simple_outlines.h"
#include "figure_picture_cases.h"

namespace anamorph::test_figure_levels {
using namespace figure;
namespace {

using namespace figure_picture_cases;

constexpr Real kPi = std::numbers::pi_v<Real>;
using Screen = glm::vec<2, Real>;

/// Where a point is seen, by the words of View.
Screen seen(const View& view, const RealVector& p) {
    const RealVector q = glm::mat<3, 3, Real>(view.rotation) * (p - RealVector(view.center));
    const Real zoom =
        view.perspective() ? view.scale * view.eye_distance / (q.z + view.eye_distance) : view.scale;
    return {view.middle.x + zoom * q.x, view.middle.y + zoom * q.y};
}

/// Points all over a body.
std::vector<Screen> points_of(const Ellipsoid& body, const View& view) {
    std::vector<Screen> points;
    const glm::mat<3, 3, Real> turn(body.rotation);
    for (int j = 0; j <= 45; ++j)
        for (int i = 0; i < 90; ++i) {
            const Real lat = (j / 45.0L - 0.5L) * kPi, lon = i / 45.0L * kPi;
            const RealVector unit(std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon),
                                  std::sin(lat));
            points.push_back(seen(view, RealVector(body.center) + turn * (RealVector(body.axes) * unit)));
        }
    return points;
}

/// The distance of two convex hulls: the largest difference of what they reach in any direction.
Real apart(const std::vector<Screen>& a, const std::vector<Screen>& b) {
    Real most = 0;
    for (int k = 0; k < 120; ++k) {
        const Screen to(std::cos(k * kPi / 60), std::sin(k * kPi / 60));
        const auto reach = [&](const std::vector<Screen>& of) {
            Real r = -HUGE_VALL;
            for (const Screen& p : of) r = std::max(r, glm::dot(p, to));
            return r;
        };
        most = std::max(most, std::fabs(reach(a) - reach(b)));
    }
    return most;
}

std::vector<Screen> ends_of(const std::vector<ShapeLine>& lines, const View& view) {
    std::vector<Screen> points;
    for (const ShapeLine& line : lines)
        for (const glm::dvec3& p : {line.from, line.to}) points.push_back(seen(view, RealVector(p)));
    return points;
}

FigureFrame frame_of(const std::vector<Ellipsoid>& bodies) {
    FigureFrame frame;
    for (const Ellipsoid& shape : bodies) {
        Body body;
        body.shape = shape;
        body.name = "b" + std::to_string(frame.bodies.size());
        frame.bodies.push_back(body);
    }
    frame.figures = {"doll"};
    return frame;
}

TEST(FigureLevels, WhatStandsForABodyIsAsFarOffAsIsSaidAtMost) {
    Real sharpest[5] = {};
    for (const double eye : {HUGE_VAL, 900.0}) {
        SceneMaker make(31);
        for (int n = 0; n < 40; ++n) {
            const Scene scene = make.scene(1, 5, 60, 8, eye, 800, 600);
            const Ellipsoid& body = scene.bodies[0];
            const View& view = scene.view;
            const std::vector<Screen> whole = points_of(body, view);
            std::vector<int> left_out;
            std::vector<Screen> cylinder;
            for (const CylinderLine& line : cylinder_lines(frame_of({body}), view, 0.01, left_out))
                for (const glm::dvec2& p : line.points) cylinder.emplace_back(p);
            ASSERT_TRUE(left_out.empty());
            const std::pair<std::vector<Screen>, double> all[] = {
                {{seen(view, RealVector(body.center))}, dot_error(body, view)},
                {ends_of({axis_line(body)}, view), stick_error(body, view)},
                {ends_of(box_lines(body, view), view), box_error(body, view)},
                {ends_of(contour_lines(body, view, 5, 0.001), view), contour_error(body, view, 5)},
                {cylinder, cylinder_error(body, view)}};
            int k = 0;
            for (const auto& [shape, error] : all) {
                // Points of the body are four degrees apart.
                const Real off = apart(whole, shape), size = dot_error(body, view);
                EXPECT_LE(off, error + 0.002L * size + 0.02L) << k << " n " << n;
                if (eye == HUGE_VAL) sharpest[k] = std::max(sharpest[k], off / error);
                ++k;
            }
        }
    }
    // Far from where the observer looks depths move points as well.
    for (const double side : {300.0, 900.0, 3000.0}) {
        View view;
        view.scale = 1;
        view.eye_distance = 300;
        const Ellipsoid ball{{side, 0.4 * side, 0}, {3, 3, 3}, glm::dmat3(1.0)};
        const Real off = apart(points_of(ball, view), {seen(view, RealVector(ball.center))});
        EXPECT_LE(off, dot_error(ball, view)) << side;
        EXPECT_GT(off, 0.5 * dot_error(ball, view)) << side;
    }
    // And it is not much less.
    for (const Real ratio : sharpest) EXPECT_GT(ratio, 0.8L);
}

TEST(FigureLevels, MoreContoursAreNearerAndAsFewAsHold) {
    SceneMaker make(7);
    const Scene scene = make.scene(1, 60, 60, 2, HUGE_VAL, 800, 600);
    for (const double tol : {50.0, 5.0, 0.5, 0.05}) {
        const int n = contours_for(scene.bodies[0], scene.view, tol);
        ASSERT_GT(n, 0);
        EXPECT_LE(contour_error(scene.bodies[0], scene.view, n), tol);
        if (n > 1) {
            EXPECT_GT(contour_error(scene.bodies[0], scene.view, n - 1), tol);
        }
    }
    EXPECT_EQ(contours_for(scene.bodies[0], scene.view, 1e-9), 0);
    // A body that the eye is in has no such lines.
    View inside = scene.view;
    inside.eye_distance = 2;
    inside.center = scene.bodies[0].center;
    EXPECT_EQ(box_error(scene.bodies[0], inside), HUGE_VAL);
    EXPECT_EQ(contours_for(scene.bodies[0], inside, 1), 0);
}

TEST(FigureLevels, AFigureIsADotSticksBoxesAndContoursByItsSize) {
    SceneMaker make(13);
    FigureFrame frame = frame_of(make.scene(12, 20, 60, 3, HUGE_VAL).bodies);
    std::size_t before = 0;
    std::vector<FigureLevel> levels;
    for (const double scale : {0.002, 0.03, 0.08, 1.0, 4.0}) {
        View view;
        view.scale = scale;
        view.middle = {400, 300};
        DrawingOptions options;
        options.style = OutlineStyle::levels;
        options.simple_tol = 1;
        const Drawing drawing = draw(frame, view, {800, 600}, options);
        std::size_t points = 0;
        for (const Stroke& stroke : drawing.strokes) points += stroke.points.size();
        EXPECT_GE(points, before) << scale;
        EXPECT_LE(drawing.max_error, 1);
        before = points;
        levels.push_back(figure_levels(frame, view, 1)[0]);
        if (levels.back() == FigureLevel::dot) {
            EXPECT_EQ(points, 1u);
        }
    }
    EXPECT_EQ(levels.front(), FigureLevel::dot);
    EXPECT_EQ(levels.back(), FigureLevel::contours);
    EXPECT_TRUE(std::is_sorted(levels.begin(), levels.end()));
    // Another figure, far from it, has a level of its own.
    frame.figures = {"doll", "speck"};
    Body speck;
    speck.shape = {{150, 150, 0}, {0.1, 0.1, 0.1}, glm::dmat3(1.0)};
    speck.figure = 1;
    frame.bodies.push_back(speck);
    View view;
    view.scale = 4;
    EXPECT_EQ(figure_levels(frame, view, 1), (std::vector{FigureLevel::contours, FigureLevel::dot}));
}

TEST(FigureLevels, ADotIsOffByWhatIsApartFromIt) {
    // Two specks, between which the dot stands.
    View view;
    view.scale = 2;
    const auto dot_or_not = [&](double distance) {
        const Ellipsoid speck{{0, 0, 0}, {0.1, 0.1, 0.1}, glm::dmat3(1.0)};
        Ellipsoid other = speck;
        other.center.x = distance;
        return figure_levels(frame_of({speck, other}), view, 1)[0] == FigureLevel::dot;
    };
    EXPECT_TRUE(dot_or_not(0.79));
    EXPECT_FALSE(dot_or_not(0.81));
    EXPECT_FALSE(dot_or_not(20));
}

TEST(FigureLevels, WhatADrawingSaysHoldsItsToleranceChordsIncluded) {
    SceneMaker make(17);
    const FigureFrame frame = frame_of(make.scene(7, 20, 60, 3, HUGE_VAL).bodies);
    View view;
    view.middle = {400, 300};
    for (const OutlineStyle style : {OutlineStyle::levels, OutlineStyle::contours})
        for (const double tol : {0.001, 0.01, 0.05, 0.5, 5.0}) {
            DrawingOptions options;
            options.style = style;
            options.simple_tol = tol;
            const Drawing drawing = draw(frame, view, {800, 600}, options);
            EXPECT_LE(drawing.max_error, tol);
            EXPECT_GT(drawing.max_error, 0);
            EXPECT_TRUE(drawing.simple);
        }
}

TEST(FigureLevels, ADotSaysHowFarItIsFromWhatItStandsFor) {
    SceneMaker make(19);
    const FigureFrame frame = frame_of(make.scene(9, 20, 60, 3, HUGE_VAL).bodies);
    View view;
    view.middle = {400, 300};
    DrawingOptions options;
    options.style = OutlineStyle::levels;
    options.simple_tol = 1e5;
    const Drawing drawing = draw(frame, view, {800, 600}, options);
    ASSERT_EQ(drawing.strokes.size(), 1u);
    const glm::dvec2 dot = drawing.strokes[0].points.at(0);
    // The farthest point of the bodies' surfaces, and how far they reach to each side.
    double farthest = 0;
    glm::dvec2 low(HUGE_VAL), high(-HUGE_VAL);
    for (const Body& body : frame.bodies)
        for (int i = 0; i <= 180; ++i)
            for (int j = 0; j < 360; ++j) {
                const double a = i * std::numbers::pi / 180, b = j * std::numbers::pi / 180;
                const glm::dvec3 unit(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
                const glm::dvec2 at =
                    view.project(body.shape.center + body.shape.rotation * (body.shape.axes * unit));
                const glm::dvec2 on_page(at.x, 600 - at.y);
                farthest = std::max(farthest, glm::length(on_page - dot));
                low = glm::min(low, on_page), high = glm::max(high, on_page);
            }
    EXPECT_LE(farthest, drawing.max_error + 1e-3);
    EXPECT_GE(farthest, 0.8 * drawing.max_error);
    // In the middle, give or take how much rounder discs are than the bodies.
    EXPECT_LT(glm::length(dot - 0.5 * (low + high)), 40);
}

TEST(FigureLevels, FarSidesOfBoxesAndContoursAreHidden) {
    // A ball's contours across x, seen along x's side: half of each is behind it.
    View view;
    view.middle = {400, 300};
    view.scale = 1;
    const FigureFrame ball = frame_of({{{0, 0, 0}, {101, 100, 100}, glm::dmat3(1.0)}});
    const auto length_of = [&](OutlineStyle style, HiddenLines hidden) {
        DrawingOptions options;
        options.style = style;
        options.hidden = hidden;
        double sum = 0;
        for (const Stroke& stroke : draw(ball, view, {800, 600}, options).strokes)
            for (std::size_t k = 0; k + 1 < stroke.points.size(); ++k)
                if (stroke.kind == StrokeKind::visible)
                    sum += glm::length(stroke.points[k + 1] - stroke.points[k]);
        return sum;
    };
    for (const OutlineStyle style : {OutlineStyle::contours})
        EXPECT_NEAR(length_of(style, HiddenLines::remove) / length_of(style, HiddenLines::draw), 0.5, 0.02);
    // Of a box that is seen along its axes the edges of the near face, each again as an end of a side.
    EXPECT_NEAR(length_of(OutlineStyle::boxes, HiddenLines::remove), 4 * 2 * 100 * 2 / (1 + std::sqrt(3.0)),
                5);
}

/// Two cylinders with a joint, bent by an angle in degrees.
FigureFrame bent(double angle) {
    const double turn = angle * std::numbers::pi / 180, c = std::cos(turn), s = std::sin(turn);
    FigureFrame frame =
        frame_of({{{-100, 0, 0}, {100, 20, 20}, glm::dmat3(1.0)},
                  {{100 * c, 100 * s, 0}, {100, 20, 20}, glm::dmat3(c, s, 0, -s, c, 0, 0, 0, 1)}});
    frame.joints = {{"knee", 0, 1, {0, 0, 0}}};
    return frame;
}

TEST(FigureLevels, CylindersAreJoinedByClipAndCreaseAndByArcs) {
    View view;
    std::vector<int> left_out;
    // Half-lengths and radii are those of the bodies times 2 / (1 + sqrt(2)).
    const double k = 2 / (1 + std::sqrt(2.0)), radius = 20 * k;
    const std::vector<CylinderLine> lines = cylinder_lines(bent(100), view, 0.01, left_out);
    // Four shadow lines, two ends, an arc, a crease.
    ASSERT_EQ(lines.size(), 8u);
    int shadows = 0, creases = 0, arcs = 0, ends = 0;
    std::vector<glm::dvec2> inner;
    for (const CylinderLine& line : lines) {
        const auto& p = line.points;
        // Ends that no joint has lie far from it.
        const double far = std::max(glm::length(p.front()), glm::length(p.back())),
                     near = std::min(glm::length(p.front()), glm::length(p.back()));
        if (near > 100)
            ++ends;  // seen from aside, a line
        else if (p.size() == 2 && far > 150)
            ++shadows;
        else if (p.size() == 2)
            ++creases, inner = p;
        else {
            ++arcs;
            // From the first end on, about the joint.
            const double r = glm::length(p.front());
            for (std::size_t i = 0; i + 1 < p.size(); ++i) EXPECT_NEAR(glm::length(p[i]), r, 1e-9);
        }
    }
    EXPECT_EQ(shadows, 4);
    EXPECT_EQ(creases, 1);
    EXPECT_EQ(arcs, 1);
    EXPECT_EQ(ends, 2);
    // The crease: on the inner side the lines y = radius and that of the other body cross on the bisector.
    ASSERT_EQ(inner.size(), 2u);
    const double half = (180 - 100) / 2.0 * std::numbers::pi / 180;
    EXPECT_NEAR(inner[0].y, radius, 1e-9);
    EXPECT_NEAR(inner[0].x, -radius / std::tan(half), 1e-6);
    // To the middle between the two ends that are cut off: of the first line, (-100 + 100 k, radius).
    const double turn = 100 * std::numbers::pi / 180;
    const glm::dvec2 along(std::cos(turn), std::sin(turn)), aside(-std::sin(turn), std::cos(turn));
    const glm::dvec2 other = (100 - 100 * k) * along + radius * aside, first(-100 + 100 * k, radius);
    EXPECT_NEAR(glm::length(inner[1] - 0.5 * (first + other)), 0, 1e-6);
    // A joint in the middle of a body connects nothing: each body has its lines and both ends.
    FigureFrame crossed = bent(100);
    crossed.joints[0].position = {-100, 5, 0};
    int whole_ends = 0;
    for (const CylinderLine& line : cylinder_lines(crossed, view, 0.01, left_out))
        whole_ends += std::fabs(glm::distance(line.points.front(), line.points.back()) - 2 * radius) < 0.02;
    EXPECT_EQ(whole_ends, 4);
    EXPECT_EQ(cylinder_lines(crossed, view, 0.01, left_out).size(), 8u);
    // A cylinder that is seen along its axis has no shadow lines: both ends are drawn whole.
    View along_x;
    along_x.rotation = glm::dmat3(0, 0, 1, 0, 1, 0, -1, 0, 0);
    const std::vector<CylinderLine> end_on =
        cylinder_lines(frame_of({bent(0).bodies[0].shape}), along_x, 0.01, left_out);
    ASSERT_EQ(end_on.size(), 2u);
    for (const CylinderLine& line : end_on) {
        EXPECT_EQ(line.points.front(), line.points.back());
        for (const glm::dvec2& p : line.points) EXPECT_NEAR(glm::length(p), radius, 1e-9);
    }
    EXPECT_TRUE(left_out.empty());
    // What reaches before the near plane is named.
    View near = view;
    near.eye_distance = 50;
    cylinder_lines(bent(90), near, 0.01, left_out);
    EXPECT_FALSE(left_out.empty());
}

}  // namespace
}  // namespace anamorph::test_figure_levels
