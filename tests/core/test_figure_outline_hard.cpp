// SPDX-License-Identifier: Apache-2.0
// Outlines where bodies touch, coincide, have no volume, cross the eye plane or surround the eye; bad input;
// many bodies; polylines.
#include <gtest/gtest.h>

#include <thread>

#include "anamorph/figure/outline/outline_roots.h"
#include "figure_outline_cases.h"

namespace anamorph::test_figure_outline_hard {
using namespace figure;
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double length_of(const std::vector<Arc>& arcs) {
    double sum = 0;
    for (const Arc& arc : arcs) sum += arc.length();
    return sum;
}

/// The part of each limb that is hidden.
std::vector<double> hidden_parts(const std::vector<Ellipsoid>& bodies, const View& view = {}) {
    std::vector<double> parts;
    for (const Outline& outline : outlines(bodies, view).bodies)
        parts.push_back(length_of(outline.hidden) / kTurn);
    return parts;
}

void expect_truth(const std::vector<Ellipsoid>& bodies, const View& view) {
    const test::OutlineScene scene{bodies, view};
    const test::OutlineFindings found = test::examine(scene, outlines(bodies, view), 90);
    EXPECT_GT(found.samples, 0);
    EXPECT_EQ(found.wrong, 0);
    EXPECT_EQ(found.gaps, 0);
    EXPECT_LE(found.worst_limb, 1e-9);
}

const glm::dvec3 kAxes{3, 2, 1};

TEST(FigureOutlineHard, TouchingAndNestedBodies) {
    // Side by side.
    EXPECT_EQ(hidden_parts({{{-3, 0, 0}, kAxes}, {{3, 0, 0}, kAxes}}), (std::vector<double>{0, 0}));
    // One behind the other, touching: the one behind is hidden only where the limbs' images overlap.
    EXPECT_EQ(hidden_parts({{{0, 0, 0}, kAxes}, {{0, 0, 2}, {2, 1, 1}}}), (std::vector<double>{0, 1}));
    EXPECT_EQ(hidden_parts({{{0, 0, 0}, kAxes}, {{0, 0, -2}, {2, 1, 1}}}), (std::vector<double>{0, 0}));
    // Nested; touching from inside at a point; about one centre, touching along a circle or at two points.
    EXPECT_EQ(hidden_parts({{{0, 0, 0}, kAxes}, {{0.5, 0, 0}, {1, 1, 0.5}}}), (std::vector<double>{0, 1}));
    EXPECT_EQ(hidden_parts({{{0, 0, 0}, kAxes}, {{1.5, 0, 0}, 0.5 * kAxes}}), (std::vector<double>{0, 1}));
    EXPECT_EQ(hidden_parts({{{0, 0, 0}, kAxes}, {{0, 0, 0}, {1, 2, 1}}}), (std::vector<double>{0, 1}));
    EXPECT_EQ(hidden_parts({{{0, 0, 0}, kAxes}, {{0, 0, 0}, {3, 2, 5}}}), (std::vector<double>{0, 0}));
    // About one centre, through each other: where the limbs meet, at x = y = 6 / sqrt(13), nothing else ends.
    const std::vector<double> crossed = hidden_parts({{{0, 0, 0}, {3, 2, 1}}, {{0, 0, 0}, {2, 3, 1}}});

    EXPECT_NEAR(crossed[0], crossed[1], 1e-15);
    EXPECT_NEAR(crossed[0], 2 * std::atan2(2, 3) * 2 / kTurn, 1e-15);
}

TEST(FigureOutlineHard, EqualBodiesDoNotHideEachOther) {
    constexpr std::uint64_t kSeed = 11;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::SceneMaker random(kSeed);
    for (int n = 0; n < 200; ++n) {
        const Ellipsoid e = random.body(100, 0.1, 100);
        Ellipsoid turned = e, flipped = e, sphere = e;
        turned.axes = {e.axes.y, e.axes.z, e.axes.x};
        turned.rotation = {e.rotation[1], e.rotation[2], e.rotation[0]};
        flipped.rotation = {-e.rotation[0], e.rotation[1], -e.rotation[2]};
        sphere.axes = glm::dvec3(e.axes.x);
        Ellipsoid other_sphere = sphere;
        other_sphere.rotation = random.rotation();
        const View view = random.view(n % 2 == 0);
        EXPECT_EQ(hidden_parts({e, e, turned, flipped}, view), (std::vector<double>{0, 0, 0, 0})) << n;
        EXPECT_EQ(hidden_parts({sphere, other_sphere}, view), (std::vector<double>{0, 0})) << n;
    }
}

TEST(FigureOutlineHard, AxesOfZeroAndBelow) {
    const Ellipsoid ball{{0, 0, 5}, {1, 1, 1}};
    // A disc across the view hides like a body; its limb is its rim.
    EXPECT_EQ(hidden_parts({{{0, 0, 0}, {2, 2, 0}}, ball}), (std::vector<double>{0, 1}));
    // Edge-on, as a line and as a point it hides nothing, and is hidden.
    for (const glm::dvec3& axes : {glm::dvec3(2, 0, 2), {0, 2, 2}, {2, 0, 0}, {0, 0, 2}, {0, 0, 0}}) {
        SCOPED_TRACE(::testing::Message() << axes.x << " " << axes.y << " " << axes.z);
        EXPECT_EQ(hidden_parts({{{0, 0, 0}, axes}, ball})[1], 0);
        const std::vector<double> behind = hidden_parts({{{0, 0, 10}, axes}, {{0, 0, 0}, glm::dvec3(4)}});
        EXPECT_EQ(behind, (std::vector<double>{1, 0}));
        for (const Outline& outline : outlines(std::vector<Ellipsoid>{{{0, 0, 0}, axes}}, View{}).bodies)
            for (int k = 0; k < 8; ++k) EXPECT_LE(glm::length(outline.limb(kTurn * k / 8)), 2 + 1e-15);
    }
    // A disc edge-on is seen as the segment between its ends.
    const Outline edge = outlines(std::vector<Ellipsoid>{{{0, 0, 0}, {2, 0, 3}}}, View{}).bodies[0];
    EXPECT_NEAR(principal_axes(edge.screen).major, 2, 1e-15);
    EXPECT_EQ(principal_axes(edge.screen).minor, 0);
    // Signs do not matter.
    EXPECT_EQ(hidden_parts({{{0, 0, 0}, {-2, 2, -2}}, ball}), hidden_parts({{{0, 0, 0}, {2, 2, 2}}, ball}));
    // Slanted discs through each other and through bodies, in both projections.
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        test::SceneMaker random(seed);
        test::OutlineScene scene = random.scene(test::Family::large, seed % 2 == 0);
        for (std::size_t k = 0; k < scene.bodies.size(); k += 2) scene.bodies[k].axes[random.whole(0, 2)] = 0;
        expect_truth(scene.bodies, scene.view);
    }
}

TEST(FigureOutlineHard, Needles) {
    // A million times as long as wide: beside, behind, through a ball.
    const Ellipsoid needle{{0, 0, 0}, {1e3, 1e-3, 1e-3}};
    EXPECT_EQ(hidden_parts({needle, {{0, 10, 0}, glm::dvec3(9)}}), (std::vector<double>{0, 0}));
    // Inside from x = -9 to 9.
    const Outline through =
        outlines(std::vector<Ellipsoid>{needle, {{0, 0, 0}, glm::dvec3(9)}}, View{}).bodies[0];
    ASSERT_EQ(through.hidden.size(), 2u);
    for (const Arc& arc : through.hidden)
        for (const double t : {arc.begin, arc.end})
            EXPECT_NEAR(glm::length(glm::dvec2(through.limb(t))), 9, 9e-9);
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        test::SceneMaker random(seed);
        test::OutlineScene scene = random.scene(test::Family::large, seed % 2 == 0);
        for (Ellipsoid& e : scene.bodies)
            if (random.whole(0, 1))
                e.axes *= random.whole(0, 1) ? glm::dvec3(1, 1, 1e-6) : glm::dvec3(1, 1e-6, 1e-6);
        expect_truth(scene.bodies, scene.view);
    }
}

TEST(FigureOutlineHard, BodiesAcrossTheEyePlaneAndAroundTheEye) {
    int cut = 0, around = 0, behind = 0;
    for (std::uint64_t seed = 1; seed <= 150; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        test::SceneMaker random(seed);
        std::vector<Ellipsoid> bodies;
        for (int k = random.whole(3, 8); k > 0; --k) bodies.push_back(random.body(100, 5, 120));
        View view = random.view(true);
        view.eye_distance = random.between(1, 100);
        view.near = 0.5;
        for (const Outline& outline : outlines(bodies, view).bodies) {
            cut += outline.kind == OutlineKind::cut;
            around += outline.kind == OutlineKind::around_eye;
            behind += outline.kind == OutlineKind::behind;
            if (outline.kind == OutlineKind::around_eye || outline.kind == OutlineKind::behind) {
                EXPECT_TRUE(outline.visible.empty() && outline.hidden.empty());
            }
            for (const auto* arcs : {&outline.visible, &outline.hidden})
                for (const Arc& arc : *arcs)
                    for (const double part : {0.0, 0.3, 1.0})
                        EXPECT_GE(outline.viewed(arc.begin + part * arc.length()).z, view.near * (1 - 1e-9));
        }
        const test::OutlineFindings found = test::examine({bodies, view}, outlines(bodies, view), 60);
        EXPECT_EQ(found.wrong, 0);
    }
    EXPECT_GT(cut, 30);
    EXPECT_GT(around, 30);
    EXPECT_GT(behind, 30);
}

// Between two arcs that one body hides, where one of them goes over the turn, nothing is left to be drawn.
TEST(FigureOutlineHard, NoArcsWithoutLength) {
    int arcs = 0, over_the_turn = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        test::SceneMaker random(seed);
        const test::OutlineScene scene =
            random.scene(seed % 2 ? test::Family::large : test::Family::small, seed % 4 < 2);
        for (const Outline& outline : outlines(scene.bodies, scene.view).bodies)
            for (const auto* list : {&outline.visible, &outline.hidden})
                for (const Arc& arc : *list) {
                    ++arcs;
                    over_the_turn += arc.end > kTurn;
                    EXPECT_GT(arc.length(), 1e-12);
                }
    }
    EXPECT_GT(arcs, 1000);
    EXPECT_GT(over_the_turn, 100);
}

TEST(FigureOutlineHard, RootsHalfATurnAround) {
    // Crossings at every angle, 180 degrees among them, where tan(t / 2) is infinite.
    for (int n = 0; n < 72; ++n) {
        const double angle = kTurn * n / 72;
        const glm::dvec3 at(5 * std::cos(angle), 5 * std::sin(angle), -1);
        const Outline outline =
            outlines(std::vector<Ellipsoid>{{{0, 0, 0}, glm::dvec3(5)}, {at, glm::dvec3(1)}}, View{})
                .bodies[0];
        ASSERT_EQ(outline.hidden.size(), 1u) << n;
        // The chord from the middle of the small circle's image to the crossing is 1.
        EXPECT_NEAR(outline.hidden[0].length(), 4 * std::asin(0.1), 1e-14);
    }
    // The roots themselves: x^2 + y^2 - w^2 = 2 k (cos(t) - 1) + ... with a double root at 180 degrees pulled
    // apart.
    WaveSquares f;
    f.x = {1, 1, 0};
    for (const double gap : {1e-2, 1e-5, 1e-9}) {
        // x is rounded to 2^-53 where it is `gap`, and has the slope `away` there.
        f.w.k = gap;
        Roots roots;
        add_roots(f, roots);
        ASSERT_EQ(roots.count, 2) << gap;
        // 1 + cos(t) = gap.
        const double away = 2 * std::asin(std::sqrt(gap / 2));
        EXPECT_NEAR(roots.angle[0], std::numbers::pi - away, 0x1p-52 / away + 1e-15);
        EXPECT_NEAR(roots.angle[1], std::numbers::pi + away, 0x1p-52 / away + 1e-15);
    }
}

TEST(FigureOutlineHard, TenThousandBodies) {
    constexpr std::uint64_t kSeed = 5;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::SceneMaker random(kSeed);
    std::vector<Ellipsoid> bodies;
    for (int k = 0; k < 10000; ++k) bodies.push_back(random.body(1000, 1, 30));
    const View view = random.view(false);
    const Outlines found = outlines(bodies, view);
    ASSERT_EQ(found.bodies.size(), bodies.size());
    const test::OutlineScene scene{bodies, view};
    int wrong = 0, hidden = 0;
    for (std::size_t i = 0; i < bodies.size(); i += 400)
        for (int k = 0; k < 8; ++k) {
            const double t = kTurn * (k + 0.5) / 8;
            const bool truth = test::is_hidden(scene, i, test::Vec(found.bodies[i].limb(t)));
            hidden += truth;
            wrong += truth != test::in_arcs(found.bodies[i].hidden, t);
        }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(hidden, 10);
}

TEST(FigureOutlineHard, BadInputIsNamed) {
    const auto message = [](const std::vector<Ellipsoid>& bodies, const View& view,
                            const OutlineOptions& options) {
        try {
            outlines(bodies, view, options);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    OutlineOptions named;
    named.names = {"head", "left\nhand"};
    const Ellipsoid good;
    Ellipsoid bad;
    bad.center.y = kNaN;
    EXPECT_EQ(message({good, bad}, {}, {}), "body 1 center=0,nan,0: must be finite numbers up to 1e25");
    EXPECT_NE(message({bad}, {}, named).find("body head center="), std::string::npos);
    EXPECT_EQ(message({good, bad}, {}, named).find('\n'), std::string::npos);
    bad = {};
    bad.axes.z = HUGE_VAL;
    EXPECT_NE(message({bad}, {}, {}).find("body 0 axes="), std::string::npos);
    bad = {};
    bad.axes.z = 1e60;
    EXPECT_NE(message({bad}, {}, {}).find("body 0 axes="), std::string::npos);
    bad = {};
    bad.rotation[0][0] = 2;
    EXPECT_NE(message({bad}, {}, {}).find("body 0 rotation="), std::string::npos);
    bad.rotation[0][0] = kNaN;
    EXPECT_NE(message({bad}, {}, {}).find("body 0 rotation="), std::string::npos);
    View view;
    view.scale = 0;
    EXPECT_NE(message({good}, view, {}).find("scale="), std::string::npos);
    view = {};
    view.rotation[1] = {0, 0, 0};
    EXPECT_NE(message({good}, view, {}).find("rotation="), std::string::npos);
    view = {};
    view.eye_distance = kNaN;
    EXPECT_NE(message({good}, view, {}).find("eye_distance="), std::string::npos);
    view.eye_distance = 10;
    view.near = 0;
    EXPECT_NE(message({good}, view, {}).find("near="), std::string::npos);
    OutlineOptions options;
    options.crossings = true;
    options.tol = kNaN;
    EXPECT_NE(message({good}, {}, options).find("tol="), std::string::npos);
    EXPECT_TRUE(message({}, {}, {}).empty());
    // Large and small numbers that are allowed do not fail.
    EXPECT_EQ(hidden_parts({{{1e25, 0, 0}, {1e25, 1, 1e-25}}, {{0, 0, 0}, glm::dvec3(1e-25)}})[1], 0);
    EXPECT_EQ(hidden_parts({{{0, 0, 0}, glm::dvec3(1e25)}, {{0, 0, 0}, glm::dvec3(1e-25)}})[1], 1);
}

TEST(FigureOutlineHard, ThreadsDoNotMatter) {
    const ParallelFor threads = [](std::int64_t count, const std::function<void(std::int64_t)>& body) {
        std::vector<std::thread> pool;
        for (std::int64_t i = count; i-- > 0;) pool.emplace_back([&, i] { body(i); });
        for (std::thread& thread : pool) thread.join();
    };
    test::SceneMaker random(3);
    std::vector<Ellipsoid> bodies;
    for (int k = 0; k < 40; ++k) bodies.push_back(random.body(100, 4, 30));
    OutlineOptions options;
    options.crossings = true;
    options.tol = 2;
    const View view = random.view(true);
    const Outlines one = outlines(bodies, view, options), many = outlines(bodies, view, options, threads);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        EXPECT_EQ(one.bodies[i].visible, many.bodies[i].visible);
        EXPECT_EQ(one.bodies[i].hidden, many.bodies[i].hidden);
    }
    ASSERT_EQ(one.crossings.size(), many.crossings.size());
    for (std::size_t i = 0; i < one.crossings.size(); ++i) {
        EXPECT_EQ(one.crossings[i].points, many.crossings[i].points);
        EXPECT_EQ(one.crossings[i].visible, many.crossings[i].visible);
    }
}

double distance_to_segment(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
    const double square = glm::dot(b - a, b - a);
    const double s = square > 0 ? std::clamp(glm::dot(p - a, b - a) / square, 0.0, 1.0) : 0;
    return glm::distance(p, a + (b - a) * s);
}

TEST(FigureOutlineHard, ChordsHoldTheirTolerance) {
    double least_use = 1;
    for (const double eye : {HUGE_VAL, 500.0, 60.0})
        for (std::uint64_t seed = 1; seed <= 60; ++seed) {
            SCOPED_TRACE(::testing::Message() << "seed " << seed << ", eye " << eye);
            test::SceneMaker random(seed);
            const Ellipsoid body = random.body(100, 1, 100);
            View view = random.view(false);
            view.eye_distance = eye;
            const double tol = std::pow(10, random.between(-3, 1));
            const Outline outline = outlines(std::vector<Ellipsoid>{body}, view).bodies[0];
            double worst = 0;
            for (const Arc& arc : outline.visible) {
                const std::vector<double> angles = chord_angles(outline, arc, view, tol);
                const std::vector<glm::dvec2> points = chords(outline, arc, view, tol);
                ASSERT_EQ(angles.size(), points.size());
                EXPECT_EQ(angles.front(), arc.begin);
                EXPECT_EQ(angles.back(), arc.end);
                for (std::size_t k = 0; k + 1 < points.size(); ++k)
                    for (const double part : {0.1, 0.35, 0.5, 0.8})
                        worst = std::max(worst, distance_to_segment(
                                                    outline.on_screen(
                                                        angles[k] + part * (angles[k + 1] - angles[k]), view),
                                                    points[k], points[k + 1]));
            }
            EXPECT_LE(worst, tol * (1 + 1e-9));
            if (worst > 0) least_use = std::min(least_use, worst / tol);
            // The image of the limb is the ellipse `screen`, at the angle screen_angle.
            if (outline.kind == OutlineKind::whole)
                for (int k = -8; k < 16; ++k) {
                    const double t = kTurn * k / 8 + 0.1, s = outline.screen_angle(t, view);
                    EXPECT_LT(glm::distance(outline.screen(s), outline.on_screen(t, view)),
                              1e-9 * (1 + glm::length(outline.screen.cosine)));
                    EXPECT_NEAR(outline.limb_angle(s, view), t, 1e-9);
                    EXPECT_LT(std::fabs(s - t), std::numbers::pi);
                }
        }
    const Outline circle = outlines(std::vector<Ellipsoid>{{{0, 0, 0}, glm::dvec3(100)}}, View{}).bodies[0];
    // 1 - cos(pi / n) <= tol / r.
    EXPECT_EQ(chord_angles(circle, {0, kTurn}, View{}, 0.125).size(), 1u + 63u);
    EXPECT_THROW(chord_angles(circle, {0, kTurn}, View{}, 0), Error);
    EXPECT_THROW(chord_angles(circle, {0, kTurn}, View{}, 1e-12), Error);
}

TEST(FigureOutlineHard, LinesAreHiddenAsDepthTestsSay) {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        test::SceneMaker random(seed);
        test::OutlineScene scene =
            random.scene(seed % 3 ? test::Family::large : test::Family::needle, seed % 2 == 0);
        std::vector<SeenLine> lines(10);
        for (SeenLine& line : lines) {
            line.from = random.point(150);
            line.to = random.point(150);
        }
        hide_lines(lines, scene.bodies, scene.view);
        int wrong = 0;
        for (const SeenLine& line : lines) {
            EXPECT_NEAR(length_of(line.visible) + length_of(line.hidden), 1, 1e-12);
            for (int k = 0; k < 40; ++k) {
                const double s = (k + 0.5) / 40;
                const auto truth_at = [&](double at) {
                    return test::is_hidden(scene, scene.bodies.size(),
                                           test::Vec(line.from + (line.to - line.from) * at));
                };
                if (truth_at(s) != test::in_arcs(line.hidden, s))
                    wrong += truth_at(s - 1e-6) == truth_at(s + 1e-6);
            }
        }
        EXPECT_EQ(wrong, 0);
    }
    std::vector<SeenLine> bad(1);
    bad[0].to.x = kNaN;
    EXPECT_THROW(hide_lines(bad, {}, View{}), Error);
}

// Spheroids that share an axis, seen along another: the limb of one touches the other's rim at the axis'
// ends, and goes from before it to behind it there.
TEST(FigureOutlineHard, LimbsPassBehindWhereTheyTouchTheRim) {
    const glm::dvec3 axes(74, 74, 0.157);
    for (const double angle : {0.3, 1.0, 2.0, 2.9}) {
        const std::vector<Ellipsoid> bodies{
            {{0, 0, 0}, axes}, {{0, 0, 0}, axes, glm::dmat3(glm::rotate(glm::dmat4(1), angle, {1, 0, 0}))}};
        const Outlines found = outlines(bodies, View{});
        double hidden = 0;
        for (const Arc& arc : found.bodies[1].hidden) hidden += arc.length();
        EXPECT_NEAR(hidden, std::numbers::pi, 1e-6) << angle;
    }
}

// What lies beyond a limb's plane is told by the rounding of depths, not by that of the small body's image.
TEST(FigureOutlineHard, SmallBodiesHideWhatIsALittleBehindThem) {
    const std::vector<Ellipsoid> bodies{{{1000, 0, 0}, glm::dvec3(1e-4)},
                                        {{1000, 0, -2e-7}, glm::dvec3(1.000001e-4)}};
    const Outlines found = outlines(bodies, View{});
    EXPECT_TRUE(found.bodies[0].visible.empty());
    EXPECT_TRUE(found.bodies[1].hidden.empty());
}

}  // namespace
}  // namespace anamorph::test_figure_outline_hard
