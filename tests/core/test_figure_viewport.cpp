// SPDX-License-Identifier: Apache-2.0
// Drawings in an elliptical viewport, against points of limbs and of the page in long double.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/outline/drawing.h"
#include "figure_outline_cases.h"

namespace anamorph::test::test_figure_viewport {
namespace {

using namespace figure;
using testing::HasSubstr;

constexpr double kPage = 1000;

long double depth_in(const Viewport& v, const glm::dvec2& p) {
    const long double x = (static_cast<long double>(p.x) - v.middle.x) / v.half_axes.x,
                      y = (static_cast<long double>(p.y) - v.middle.y) / v.half_axes.y;
    return 1 - std::hypot(x, y);
}

double distance_to(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
    const glm::dvec2 d = b - a;
    const double square = glm::dot(d, d), s = square > 0 ? glm::dot(p - a, d) / square : 0;
    return glm::distance(p, a + std::clamp(s, 0.0, 1.0) * d);
}

bool inside(const glm::dvec2& p, const std::vector<glm::dvec2>& polygon) {
    bool in = false;
    for (std::size_t k = 0; k + 1 < polygon.size(); ++k) {
        const glm::dvec2 &a = polygon[k], &b = polygon[k + 1];
        if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) in = !in;
    }
    return in;
}

double to_border(const glm::dvec2& p, const std::vector<glm::dvec2>& polygon) {
    double least = HUGE_VAL;
    for (std::size_t k = 0; k + 1 < polygon.size(); ++k)
        least = std::min(least, distance_to(p, polygon[k], polygon[k + 1]));
    return least;
}

FigureFrame frame_of(const std::vector<Ellipsoid>& shapes) {
    FigureFrame frame;
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        Body body;
        body.shape = shapes[i];
        body.name = std::to_string(i);
        frame.bodies.push_back(body);
    }
    return frame;
}

View plain_view() {
    View view;
    view.middle = {500, 500};
    return view;
}

Viewport some_viewport(SceneMaker& make) {
    return {{make.between(200, 800), make.between(200, 800)}, {make.between(20, 500), make.between(20, 500)}};
}

/// What is drawn lies in the viewport; of a limb whatever lies in it, away from its border, is drawn.
TEST(FigureViewport, LinesAreThoseWithin) {
    for (int seed = 0; seed < 150; ++seed) {
        SCOPED_TRACE(seed);
        SceneMaker make(static_cast<std::uint64_t>(seed));
        const OutlineScene scene = make.scene(kFamilies[seed % 4], seed % 3 == 0);
        const FigureFrame frame = frame_of(scene.bodies);
        DrawingOptions options;
        options.tol = 0.1;
        const Drawing whole = draw(frame, scene.view, {kPage, kPage}, options);
        options.viewport = some_viewport(make);
        const Drawing cut = draw(frame, scene.view, {kPage, kPage}, options);
        for (const Stroke& stroke : cut.strokes)
            for (const glm::dvec2& p : stroke.points) EXPECT_GE(depth_in(*options.viewport, p), -1e-9L);
        for (const Stroke& stroke : whole.strokes)
            for (std::size_t k = 0; k + 1 < stroke.points.size(); ++k) {
                const glm::dvec2 p = glm::mix(stroke.points[k], stroke.points[k + 1], make.between(0, 1));
                if (depth_in(*options.viewport, p) < 1e-6L) continue;
                double least = HUGE_VAL;
                for (const Stroke& other : cut.strokes)
                    if (other.body == stroke.body) least = std::min(least, to_border(p, other.points));
                // Pieces shorter than a file's last decimal are left out.
                EXPECT_LT(least, 1e-3) << p.x << " " << p.y;
            }
    }
}

/// Fills are the pixels in both ellipses.
TEST(FigureViewport, FillsAreWhatBothEllipsesHold) {
    for (int seed = 0; seed < 300; ++seed) {
        SCOPED_TRACE(seed);
        SceneMaker make(static_cast<std::uint64_t>(1000 + seed));
        const double a = make.between(5, 400), b = make.between(5, 400), turn = make.between(0, 3);
        const glm::dvec2 middle(make.between(100, 900), make.between(100, 900));
        glm::dmat3 rotation(1.0);
        rotation[0] = {std::cos(turn), std::sin(turn), 0};
        rotation[1] = {-std::sin(turn), std::cos(turn), 0};
        DrawingOptions options;
        options.tol = 0.05;
        options.fill = true;
        options.viewport = some_viewport(make);
        const Viewport& v = *options.viewport;
        const Drawing drawing = draw(frame_of({{{middle - 500.0, 0}, {a, b, 50}, rotation}}), plain_view(),
                                     {kPage, kPage}, options);
        std::vector<glm::dvec2> fill;
        for (const Stroke& stroke : drawing.strokes)
            if (stroke.kind == StrokeKind::fill) fill = stroke.points;
        EXPECT_TRUE(fill.empty() || fill.front() == fill.back());
        for (int i = 0; i < 400; ++i) {
            const glm::dvec2 p(make.between(0, kPage), make.between(0, kPage));
            const long double x = p.x - middle.x, y = (kPage - p.y) - middle.y,
                              c = std::cos(static_cast<long double>(turn)),
                              s = std::sin(static_cast<long double>(turn));
            const bool in_body = std::hypot((c * x + s * y) / a, (c * y - s * x) / b) < 1;
            const bool in = in_body && depth_in(v, p) > 0;
            if (in == inside(p, fill)) continue;
            // Where they differ p is at a border of both: no farther than a chord from a curve.
            const long double to_body = std::fabs(1 - std::hypot((c * x + s * y) / a, (c * y - s * x) / b)) *
                                        std::min(a, b),
                              to_view = std::fabs(depth_in(v, p)) * std::min(v.half_axes.x, v.half_axes.y);
            EXPECT_LT(std::min(to_body, to_view), 0.05L) << p.x << " " << p.y;
        }
    }
}

TEST(FigureViewport, TheSameEllipseAsTheBody) {
    DrawingOptions options;
    options.fill = true;
    for (const double by : {1 - 1e-3, 1 - 1e-12, 1.0, 1 + 1e-12, 1 + 1e-3}) {
        SCOPED_TRACE(by);
        options.viewport = Viewport{{500, 500}, {100 * by, 60 * by}};
        const Drawing drawing = draw(frame_of({{{0, 0, 0}, {100, 60, 50}, glm::dmat3(1.0)}}), plain_view(),
                                     {kPage, kPage}, options);
        double area = 0;
        for (const Stroke& stroke : drawing.strokes)
            if (stroke.kind == StrokeKind::fill)
                for (std::size_t k = 0; k + 1 < stroke.points.size(); ++k) {
                    const glm::dvec2 a = stroke.points[k] - 500.0, b = stroke.points[k + 1] - 500.0;
                    area += (a.x * b.y - a.y * b.x) / 2;
                }
        EXPECT_NEAR(std::fabs(area), std::numbers::pi * 6000 * std::min(by * by, 1.0), 60);
    }
}

TEST(FigureViewport, SticksAndDotsEndAtIt) {
    const FigureFrame frame = frame_of({{{0, 0, 0}, {200, 10, 10}, glm::dmat3(1.0)},
                                        {{0, 90, 0}, {1, 1, 1}, glm::dmat3(1.0)},
                                        {{0, 110, 0}, {1, 1, 1}, glm::dmat3(1.0)}});
    DrawingOptions options;
    options.viewport = Viewport{{500, 500}, {50, 100}};
    options.sticks = Sticks::axes;
    Drawing drawing = draw(frame, plain_view(), {kPage, kPage}, options);
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const Stroke& stroke : drawing.strokes)
        if (stroke.body == "0")
            for (const glm::dvec2& p : stroke.points) low = std::min(low, p.x), high = std::max(high, p.x);
    EXPECT_NEAR(low, 450, 1e-9);
    EXPECT_NEAR(high, 550, 1e-9);
    options.sticks = Sticks::none;
    options.lod = 4;
    drawing = draw(frame, plain_view(), {kPage, kPage}, options);
    int dots = 0;
    for (const Stroke& stroke : drawing.strokes) dots += stroke.kind == StrokeKind::dot;
    EXPECT_EQ(dots, 1);
}

TEST(FigureViewport, WhatIsWrongIsNamed) {
    const auto failure = [](std::vector<double> numbers) -> std::string {
        try {
            viewport_of("viewport", "it", numbers);
        } catch (const Error& e) {
            return e.what();
        }
        return "no error";
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(failure({.5, .5, .5, .5}), "no error");
    for (const std::vector<double>& wrong : std::vector<std::vector<double>>{{},
                                                                             {.5, .5, .5},
                                                                             {.5, .5, .5, .5, .5},
                                                                             {.5, .5, 0, .5},
                                                                             {.5, .5, .5, -1},
                                                                             {nan, .5, .5, .5},
                                                                             {.5, .5, .5, nan},
                                                                             {.5, HUGE_VAL, .5, .5},
                                                                             {.5, .5, 11, .5},
                                                                             {.5, 2147483648.0, .5, .5}})
        EXPECT_THAT(failure(wrong), HasSubstr("viewport=it: must be x,y,a,b: the middle, from -10 to 10"));
}

}  // namespace
}  // namespace anamorph::test::test_figure_viewport
