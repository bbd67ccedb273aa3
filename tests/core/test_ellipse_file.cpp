// SPDX-License-Identifier: Apache-2.0
// Outlines as HIDE and VISIB write them: against what a view ray meets, worked out in long double.
#include "anamorph/figure/files/ellipse_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat2x2.hpp>
#include <random>

#include "anamorph/error.h"

namespace anamorph::test_ellipse_file {
using namespace figure;
namespace {

using testing::HasSubstr;
using Real = long double;

/// An ellipsoid as the window shows it: x' A^-1 x = 1 about its centre, with A = R diag(a^2) R' turned into the view.
struct Seen {
    glm::mat<3, 3, Real> a;
    glm::vec<3, Real> center;

    Seen(const FigureFrame& frame, const Ellipsoid& e) {
        const glm::mat<3, 3, Real> view(frame.observer), own(e.rotation);
        const glm::mat<3, 3, Real> turned = view * own;
        glm::mat<3, 3, Real> squares(Real{0});
        for (int k = 0; k < 3; ++k) squares[k][k] = static_cast<Real>(e.axes[k]) * e.axes[k];
        a = turned * squares * glm::transpose(turned);
        center = view * (glm::vec<3, Real>(e.center) - glm::vec<3, Real>(frame.place)) +
                 glm::vec<3, Real>(500, 500, 0);
    }
    /// The shadow on the screen is where d' S^-1 d = 1, S the upper left of A.
    Real form(const glm::vec<2, Real>& d) const { return glm::dot(d, back(d)); }
    glm::vec<2, Real> back(const glm::vec<2, Real>& d) const {
        const Real det = a[0][0] * a[1][1] - a[0][1] * a[0][1];
        return glm::vec<2, Real>(a[1][1] * d.x - a[0][1] * d.y, a[0][0] * d.y - a[0][1] * d.x) / det;
    }
    /// The depth of the plane of the limb, and half of the body's depth there.
    Real middle(const glm::vec<2, Real>& d) const {
        return center.z + glm::dot(glm::vec<2, Real>(a[0][2], a[1][2]), back(d));
    }
    Real half(const glm::vec<2, Real>& d) const {
        const glm::vec<2, Real> lean(a[0][2], a[1][2]);
        return std::sqrt((a[2][2] - glm::dot(lean, back(lean))) * (1 - form(d)));
    }
};

FigureFrame random_frame(unsigned seed, int count) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> at(300, 700), axis(20, 150), turn(-1, 1);
    const auto rotation = [&] {
        return glm::mat3_cast(
            glm::normalize(glm::dquat(turn(random), turn(random), turn(random), turn(random))));
    };
    FigureFrame frame;
    frame.number = static_cast<int>(seed);
    frame.observer = rotation();
    for (int i = 0; i < count; ++i) {
        Body body;
        body.shape = {
            {at(random), at(random), at(random)}, {axis(random), axis(random), axis(random)}, rotation()};
        body.name = "b";
        body.name += std::to_string(i);
        frame.bodies.push_back(body);
    }
    return frame;
}

TEST(EllipseFile, EllipsesAreTheOutlinesAndArcsTheirHiddenParts) {
    int hidden_points = 0, visible_points = 0;
    for (unsigned seed = 1; seed <= 40; ++seed) {
        SCOPED_TRACE(seed);
        const FigureFrame frame = random_frame(seed, 6);
        std::vector<Seen> seen;
        for (const Body& body : frame.bodies) seen.emplace_back(frame, body.shape);
        const EllipseFrame flat = ellipses_of(frame, true);
        ASSERT_EQ(flat.ellipses.size(), frame.bodies.size());
        EXPECT_EQ(flat.number, frame.number);
        for (std::size_t i = 0; i < seen.size(); ++i) {
            const FlatEllipse& e = flat.ellipses[i];
            ASSERT_LE(e.minor, e.major);
            ASSERT_TRUE(e.phi > 0 && e.phi <= 180);
            double last = 0;
            for (const auto& [begin, end] : e.hidden) {
                ASSERT_TRUE(begin >= last && end > begin && end <= 360);
                last = end;
            }
            for (double p = 0.05; p < 360; p += 1.7) {
                // The format's definition, in long double.
                const Real pi = std::acos(Real{-1}), angle = (p + 90) * pi / 180, phi = e.phi * pi / 180;
                const glm::vec<2, Real> u(std::cos(phi), std::sin(phi)), v(-u.y, u.x);
                const glm::vec<2, Real> d = static_cast<Real>(e.minor) * std::cos(angle) * u +
                                            static_cast<Real>(e.major) * std::sin(angle) * v;
                ASSERT_NEAR(static_cast<double>(seen[i].form(d)), 1, 1e-9);
                const glm::vec<2, Real> at = d + glm::vec<2, Real>(e.center);
                const Real depth = seen[i].middle(d);
                bool is_hidden = false;
                for (std::size_t j = 0; j < seen.size(); ++j) {
                    const glm::vec<2, Real> from = at - glm::vec<2, Real>(seen[j].center);
                    if (j != i && seen[j].form(from) < 1 && seen[j].middle(from) - seen[j].half(from) < depth)
                        is_hidden = true;
                }
                bool in_arc = false, near_end = false;
                for (const auto& [begin, end] : e.hidden) {
                    in_arc = in_arc || (p > begin && p < end);
                    near_end = near_end || std::fabs(p - begin) < 1e-5 || std::fabs(p - end) < 1e-5;
                }
                if (!near_end) {
                    ASSERT_EQ(in_arc, is_hidden) << i << " " << p;
                }
                ++(is_hidden ? hidden_points : visible_points);
            }
        }
        for (const FlatEllipse& e : ellipses_of(frame, false).ellipses) EXPECT_TRUE(e.hidden.empty());
    }
    EXPECT_GT(hidden_points, 10000);
    EXPECT_GT(visible_points, 10000);
}

TEST(EllipseFile, TheTextHasTheNearestWholeNumbers) {
    FigureFrame frame;
    frame.number = 7;
    Body near, far;
    near.shape = {{500.4, 499.6, 200}, glm::dvec3(100), glm::dmat3(1.0)};
    far.shape = {{600.4, 499.6, 800}, glm::dvec3(100), glm::dmat3(1.0)};
    frame.bodies = {near, far};
    const std::string text = ellipse_text(ellipses_of(frame, true));
    const std::vector<EllipseFrame> read = parse_ellipses(text + text, "a.2");
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read[1].number, 7);
    ASSERT_EQ(read[0].ellipses.size(), 2u);
    const FlatEllipse& e = read[0].ellipses[1];
    EXPECT_EQ(e.center, glm::dvec2(600, 500));
    EXPECT_EQ(e.minor, 100);
    EXPECT_EQ(e.major, 100);
    // Of two circles whose centres are a radius apart, a third of the farther one is hidden, on the side of the nearer.
    // That is about the angle 0: in two arcs.
    ASSERT_EQ(e.hidden.size(), 2u);
    EXPECT_EQ(e.hidden[0].begin, 0);
    EXPECT_EQ(e.hidden[1].end, 360);
    EXPECT_NEAR(e.hidden[0].end, 60, 0.11);
    EXPECT_NEAR(e.hidden[1].begin, 300, 0.11);
    EXPECT_LT(glm::distance(e.at(0), glm::dvec2(500, 500)), 1e-9);
    EXPECT_TRUE(read[0].ellipses[0].hidden.empty());
    EXPECT_THAT(ellipse_text(ellipses_of(frame, false)), HasSubstr(" 0\n600 500 100 100 "));
    // Hidden as a whole, and one where no whole numbers are.
    frame.bodies[1].shape.center.x = 500.4;
    frame.bodies[1].shape.axes = glm::dvec3(50);
    EXPECT_THAT(ellipse_text(ellipses_of(frame, true)), HasSubstr("1\n0 3600\n"));
    frame.bodies[1].shape.center.x = 1e20;
    EXPECT_THROW(ellipse_text(ellipses_of(frame, true)), Error);
}

TEST(EllipseFile, WhatIsNotHiddenIsDrawnWithinTheTolerance) {
    const EllipseFrame frame =
        parse_ellipses("2 3\n500 500 40 200 300 1\n3000 3900\n600 100 50 50 1800 0\n", "a.2")[0];
    for (const double tol : {0.01, 1.0}) {
        const Drawing drawing = plotted(frame, 500, tol);
        ASSERT_EQ(drawing.frame, 3);
        ASSERT_EQ(drawing.strokes.size(), 2u);
        EXPECT_EQ(drawing.strokes[0].body, "1");
        const auto& points = drawing.strokes[0].points;
        // From 30 to 300 degrees.
        const auto on_page = [&](double p) {
            const glm::dvec2 q = 0.5 * frame.ellipses[0].at(p);
            return glm::dvec2(q.x, 500 - q.y);
        };
        EXPECT_LT(glm::distance(points.front(), on_page(30)), 1e-9);
        EXPECT_LT(glm::distance(points.back(), on_page(300)), 1e-9);
        for (double p = 30; p <= 300; p += 0.25) {
            double nearest = HUGE_VAL;
            for (std::size_t k = 0; k + 1 < points.size(); ++k) {
                const glm::dvec2 d = points[k + 1] - points[k], q = on_page(p) - points[k];
                const double t = std::clamp(glm::dot(q, d) / glm::dot(d, d), 0.0, 1.0);
                nearest = std::min(nearest, glm::length(q - t * d));
            }
            ASSERT_LE(nearest, tol * (1 + 1e-9));
        }
        EXPECT_EQ(drawing.strokes[1].points.front(), drawing.strokes[1].points.back());
    }
    EXPECT_GT(plotted(frame, 500, 0.01).strokes[0].points.size(),
              plotted(frame, 500, 1).strokes[0].points.size());
}

TEST(EllipseFile, SaysWhatIsWrong) {
    const auto error = [](const std::string& text) {
        try {
            parse_ellipses(text, "a.2");
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string("no error");
    };
    EXPECT_EQ(error(""), "no error");
    EXPECT_EQ(error("0 1\n"), "no error");
    const std::string good = "1 1\n500 500 40 200 300 1\n300 900\n";
    EXPECT_EQ(error(good), "no error");
    EXPECT_EQ(error("1 1\n5 5 4.5"),
              "a.2: line 2: found \"4.5\", expected half an axis, an integer from 0 to 1000000");
    EXPECT_THAT(error("-1 1"), HasSubstr("line 1: found \"-1\", expected a count of ellipses"));
    EXPECT_THAT(error("1 nan"), HasSubstr("expected a frame"));
    EXPECT_THAT(error("1 1 2147483648"), HasSubstr("expected a coordinate"));
    EXPECT_THAT(error("1 1 0 0 -1"), HasSubstr("expected half an axis"));
    EXPECT_THAT(error("1 1 0 0 1 1 0 1 900 300"),
                HasSubstr("expected an arc's end, an integer from 900 to 4500"));
    for (std::size_t size = 1; size + 4 < good.size(); ++size)
        EXPECT_THAT(error(good.substr(0, size)), HasSubstr("a.2: line")) << size;
}

}  // namespace
}  // namespace anamorph::test_ellipse_file
