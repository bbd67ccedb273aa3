// SPDX-License-Identifier: Apache-2.0
// The curves in which bodies pass through each other: on both surfaces, within tol, complete, and hidden
// where depth tests say so.
#include <gtest/gtest.h>

#include "figure_outline_cases.h"

namespace anamorph::test_figure_outline_crossing {
using namespace figure;
namespace {

using test::Real;
using test::Vec;

OutlineOptions with_crossings(double tol) {
    OutlineOptions options;
    options.crossings = true;
    options.tol = tol;
    return options;
}

double distance_to_segment(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
    const double square = glm::dot(b - a, b - a);
    const double s = square > 0 ? std::clamp(glm::dot(p - a, b - a) / square, 0.0, 1.0) : 0;
    return glm::distance(p, a + (b - a) * s);
}

/// On the screen, from p to the nearest of a pair's loops.
double distance_to(const std::vector<CrossingCurve>& curves, int first, int second, const View& view,
                   const glm::dvec3& p) {
    double least = HUGE_VAL;
    for (const CrossingCurve& c : curves)
        if (c.first == first && c.second == second)
            for (std::size_t k = 0; k < c.points.size(); ++k)
                least =
                    std::min(least, distance_to_segment(view.project(p), view.project(c.points[k]),
                                                        view.project(c.points[(k + 1) % c.points.size()])));
    return least;
}

Real level(const Ellipsoid& e, const Vec& p) {
    return glm::length(test::to_unit(e, p - Vec(e.center))) - 1;
}

/// Points of the curve, found on random great circles of the first body.
std::vector<glm::dvec3> points_on_both(const Ellipsoid& a, const Ellipsoid& b, test::SceneMaker& random) {
    std::vector<glm::dvec3> found;
    for (int circle = 0; circle < 6; ++circle) {
        const glm::dmat3 frame = random.rotation();
        const auto at = [&](Real t) {
            const Vec u = Vec(frame[0]) * std::cos(t) + Vec(frame[1]) * std::sin(t);
            return Vec(a.center) + test::Mat(a.rotation) * (Vec(a.axes) * u);
        };
        constexpr int steps = 64;
        for (int k = 0; k < steps; ++k) {
            Real low = 2 * std::numbers::pi_v<Real> * k / steps,
                 high = 2 * std::numbers::pi_v<Real> * (k + 1) / steps;
            const bool sign = level(b, at(low)) < 0;
            if (sign == (level(b, at(high)) < 0)) continue;
            for (int i = 0; i < 70; ++i) {
                const Real middle = 0.5L * (low + high);
                ((level(b, at(middle)) < 0) == sign ? low : high) = middle;
            }
            found.emplace_back(at(low));
        }
    }
    return found;
}

/// Away from the observer?
bool faces_away(const Ellipsoid& e, const View& view, const Vec& p) {
    const Vec unit = test::to_unit(e, p - Vec(e.center)), ray = test::to_unit(e, test::ray_through(view, p));
    return glm::dot(unit, ray) > 0;
}

TEST(FigureOutlineCrossing, SpheresMeetInACircle) {
    // Radii 5 and 5, 6 apart: a circle of radius 4 half way between, seen from its side.
    const std::vector<Ellipsoid> bodies{{{-3, 0, 0}, glm::dvec3(5)}, {{3, 0, 0}, glm::dvec3(5)}};
    View view;
    view.scale = 10;
    const Outlines found = outlines(bodies, view, with_crossings(0.01));
    ASSERT_EQ(found.crossings.size(), 1u);
    const CrossingCurve& circle = found.crossings[0];
    for (const glm::dvec3& p : circle.points) {
        EXPECT_NEAR(p.x, 0, 1e-12);
        EXPECT_NEAR(glm::length(p), 4, 1e-12);
    }
    // The front half is seen.
    double visible = 0;
    for (const Arc& arc : circle.visible) visible += arc.length();
    EXPECT_NEAR(visible / static_cast<double>(circle.points.size()), 0.5, 0.05);
    // The limbs end where they meet the circle: x = 0 is where cos = -+3/5.
    for (const Outline& outline : found.bodies) {
        ASSERT_EQ(outline.hidden.size(), 1u);
        EXPECT_NEAR(outline.hidden[0].length(), 2 * std::acos(0.6), 1e-14);
    }
}

TEST(FigureOutlineCrossing, HoldsItsTolerance) {
    constexpr double kTol = 0.25;
    int curves = 0, checked = 0, hidden = 0, vertices = 0;
    for (const test::Family family : {test::Family::large, test::Family::small, test::Family::needle})
        for (std::uint64_t seed = 1; seed <= 12; ++seed) {
            SCOPED_TRACE(::testing::Message() << test::name_of(family) << ", seed " << seed);
            test::SceneMaker random(seed);
            const test::OutlineScene scene = random.scene(family, seed % 2 == 0);
            const Outlines found = outlines(scene.bodies, scene.view, with_crossings(kTol));
            double worst_surface = 0, worst_off = 0;
            int wrong = 0;
            for (const CrossingCurve& c : found.crossings) {
                ++curves;
                const Ellipsoid &a = scene.bodies[static_cast<std::size_t>(c.first)],
                                &b = scene.bodies[static_cast<std::size_t>(c.second)];
                for (std::size_t k = 0; k < c.points.size(); ++k) {
                    const Vec p(c.points[k]);
                    for (const Ellipsoid* e : {&a, &b}) {
                        // The distance from the surface, to first order.
                        const Vec u = test::to_unit(*e, p - Vec(e->center));
                        const Real slope = glm::length(u / Vec(e->axes)) / glm::length(u);
                        worst_surface =
                            std::max(worst_surface, static_cast<double>(std::fabs(level(*e, p)) / slope) /
                                                        test::size_of(*e));
                    }
                    ++vertices;
                    bool truth = faces_away(a, scene.view, p) || faces_away(b, scene.view, p);
                    for (std::size_t j = 0; j < scene.bodies.size() && !truth; ++j)
                        truth = static_cast<int>(j) != c.first && static_cast<int>(j) != c.second &&
                                test::hides(scene.bodies[j], scene.view, p);
                    const auto at = static_cast<double>(k), count = static_cast<double>(c.points.size());
                    const auto in = [&](const std::vector<Arc>& arcs) {
                        return std::any_of(arcs.begin(), arcs.end(), [&](const Arc& arc) {
                            const auto inside = [&](double s) {
                                return s > arc.begin + 1e-6 && s < arc.end - 1e-6;
                            };
                            return inside(at) || inside(at + count);
                        });
                    };
                    hidden += truth;
                    if (in(truth ? c.visible : c.hidden)) ++wrong;
                }
            }
            for (int i = 0; i < static_cast<int>(scene.bodies.size()); ++i)
                for (int j = i + 1; j < static_cast<int>(scene.bodies.size()); ++j)
                    for (const glm::dvec3& p :
                         points_on_both(scene.bodies[static_cast<std::size_t>(i)],
                                        scene.bodies[static_cast<std::size_t>(j)], random)) {
                        ++checked;
                        const double off = distance_to(found.crossings, i, j, scene.view, p);
                        // A loop that is as small as tol on the screen may be left out.
                        if (family == test::Family::needle && off == HUGE_VAL) continue;
                        worst_off = std::max(worst_off, off);
                    }
            EXPECT_LE(worst_surface, 1e-9);
            EXPECT_LE(worst_off, kTol);
            EXPECT_EQ(wrong, 0);
        }
    EXPECT_GT(curves, 200);
    EXPECT_GT(checked, 1000);
    EXPECT_GT(hidden, vertices / 10);
}

std::size_t visible_parts(const std::vector<CrossingCurve>& curves) {
    std::size_t count = 0;
    for (const CrossingCurve& curve : curves) count += curve.visible.size();
    return count;
}

// Two discs a twentieth of a pixel thick: they meet in curves half as far apart as chords may be off. What is
// seen of them does not depend on the tolerance.
TEST(FigureOutlineCrossing, ThinDiscsAreNotDashed) {
    const auto turned = [](double angle, const glm::dvec3& axis) {
        return glm::dmat3(glm::rotate(glm::dmat4(1), angle, axis));
    };
    const std::vector<Ellipsoid> discs{{{0, 0, 0}, {400, 400, 0.05}, turned(0.9, {0, 1, 0})},
                                       {{0, 0, 0}, {400, 400, 0.05}, turned(1.1, {1, 0, 0})}};
    View view;
    view.scale = 0.5;
    const Outlines coarse = outlines(discs, view, with_crossings(0.1)),
                   fine = outlines(discs, view, with_crossings(0.001));
    EXPECT_EQ(visible_parts(coarse.crossings), visible_parts(fine.crossings));
    EXPECT_GE(visible_parts(coarse.crossings), 1u);
    EXPECT_LE(visible_parts(coarse.crossings), 4u);
}

// Flakes of any size and place: a loop is seen in one part or two.
TEST(FigureOutlineCrossing, FlakesAreNotDashed) {
    std::size_t curves = 0, dashed = 0;
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        test::SceneMaker random(seed);
        const auto flake = [&](double size) {
            return Ellipsoid{random.point(0.3 * size),
                             {size, size * random.between(0.3, 1), size * random.between(2e-5, 4e-4)},
                             random.rotation()};
        };
        const std::vector<Ellipsoid> bodies{flake(6), flake(20)};
        const Outlines found = outlines(bodies, random.view(seed % 2 == 0), with_crossings(0.03));
        for (const CrossingCurve& curve : found.crossings) {
            ++curves;
            dashed += curve.visible.size() > 2;
        }
    }
    EXPECT_GT(curves, 200u);
    EXPECT_EQ(dashed, 0u);
}

// Bodies a hundred-thousandth of their thickness apart meet at angles as small; their curve holds tol still.
TEST(FigureOutlineCrossing, HoldsItsToleranceWhereBodiesNearlyCoincide) {
    constexpr double kTol = 0.05;
    int checked = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        test::SceneMaker random(seed);
        const Ellipsoid disc{random.point(20), {130, 64, 1.06}, random.rotation()};
        Ellipsoid moved = disc;
        moved.center += random.direction() * 3e-5;
        const std::vector<Ellipsoid> bodies{disc, moved};
        const View view = random.view(seed % 2 == 0);
        const Outlines found = outlines(bodies, view, with_crossings(kTol));
        double worst = 0;
        for (const glm::dvec3& p : points_on_both(disc, moved, random)) {
            ++checked;
            worst = std::max(worst, distance_to(found.crossings, 0, 1, view, p));
        }
        EXPECT_LE(worst, kTol);
    }
    EXPECT_GT(checked, 50);
}

// A shell nearer to a sphere than chords may be off hides all of what crosses the sphere, or nothing.
TEST(FigureOutlineCrossing, CloseShellsDoNotDash) {
    for (const double shell : {-0.02, 0.02}) {
        const std::vector<Ellipsoid> bodies{{{0, 0, 0}, glm::dvec3(300)},
                                            {{0, 0, 0}, glm::dvec3(300 + shell)},
                                            {{150, 20, -80}, {200, 300, 250}}};
        const Outlines found = outlines(bodies, View{}, with_crossings(0.1));
        EXPECT_EQ(found.crossings.size(), 2u);
        for (const CrossingCurve& curve : found.crossings) {
            const bool outer = curve.first == (shell > 0 ? 1 : 0);
            EXPECT_LE(curve.visible.size(), 1u);
            EXPECT_EQ(curve.visible.empty(), !outer) << curve.first;
        }
    }
}

// Of curves of which nothing is seen none is kept where that is asked for; the others are the same to the
// bit.
TEST(FigureOutlineCrossing, HiddenCurvesNeedNotBeKept) {
    int kept = 0, all = 0;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        SCOPED_TRACE(::testing::Message() << "seed " << seed);
        test::SceneMaker random(seed);
        std::vector<Ellipsoid> bodies;
        for (int k = 0; k < 40; ++k) bodies.push_back(random.body(100, 20, 60));
        const View view = random.view(seed % 2 == 0);
        OutlineOptions options = with_crossings(0.5);
        const Outlines with = outlines(bodies, view, options);
        options.keep_hidden = false;
        const Outlines without = outlines(bodies, view, options);
        std::size_t k = 0;
        for (const CrossingCurve& curve : with.crossings) {
            ++all;
            if (curve.visible.empty()) continue;
            ++kept;
            ASSERT_LT(k, without.crossings.size());
            EXPECT_EQ(curve.points, without.crossings[k].points);
            EXPECT_EQ(curve.visible, without.crossings[k].visible);
            ++k;
        }
        EXPECT_EQ(k, without.crossings.size());
    }
    EXPECT_GT(kept, 500);
    EXPECT_GT(all, 2 * kept);
}

TEST(FigureOutlineCrossing, TolerancesThatAskForTooMuchAreRefused) {
    const std::vector<Ellipsoid> bodies{{{-3, 0, 0}, glm::dvec3(5)}, {{3, 0, 0}, glm::dvec3(5)}};
    EXPECT_THROW(outlines(bodies, View{}, with_crossings(1e-13)), Error);
}

}  // namespace
}  // namespace anamorph::test_figure_outline_crossing
