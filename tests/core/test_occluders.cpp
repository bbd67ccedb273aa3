// SPDX-License-Identifier: Apache-2.0
// Shadows of a projector: where they end on triangles and within them, against rays tested one by one in long double.
#include "anamorph/projector/occluders.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>
#include <random>
#include <set>
#include <tuple>

#include "anamorph/projector/projected_triangles.h"

namespace anamorph::test_occluders {
namespace {

using Triangle = std::array<glm::dvec3, 3>;
using Triangles = std::vector<Triangle>;
using Real = long double;

std::vector<glm::dvec3> corners_of(const Triangles& triangles) {
    std::vector<glm::dvec3> corners;
    for (const Triangle& t : triangles) corners.insert(corners.end(), t.begin(), t.end());
    return corners;
}
Triangles square(double z, double half, double x = 0, double y = 0) {
    const glm::dvec3 p(x - half, y - half, z), q(x + half, y - half, z), r(x + half, y + half, z),
        s(x - half, y + half, z);
    return {{p, q, r}, {p, r, s}};
}
/// A ball of many triangles.
Triangles ball(const glm::dvec3& centre, double radius, int steps) {
    const auto at = [&](int i, int j) {
        const double a = 2 * std::numbers::pi * (i % (2 * steps)) / (2 * steps),
                     b = std::numbers::pi * j / steps;
        const double around = j == 0 || j == steps ? 0 : std::sin(b);
        return centre + radius * glm::dvec3(std::cos(a) * around, std::cos(b), std::sin(a) * around);
    };
    Triangles triangles;
    for (int i = 0; i < 2 * steps; ++i)
        for (int j = 0; j < steps; ++j) {
            if (j > 0) triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
            if (j < steps - 1) triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return triangles;
}

struct Painted {
    std::vector<PaintedTriangle> pieces;
    PaintedCounts counts;
    double area[4] = {};
};
double area_of(const PaintedTriangle& p) {
    const auto& c = p.corners;
    return glm::length(glm::cross(c[1].point - c[0].point, c[2].point - c[0].point)) / 2;
}
Painted paint(const Chart& chart, const Triangles& scene, const Triangles& before, double tol,
              ProjectionOptions options = {}) {
    const Occluders occluders(corners_of(before), {});
    options.tol = tol;
    options.occluders = &occluders;
    const ScenePainter painter(Projector(chart), options);
    Painted painted;
    for (const Triangle& t : scene) painted.counts += painter.paint(t, painted.pieces);
    for (const PaintedTriangle& p : painted.pieces)
        painted.area[static_cast<std::size_t>(p.painting)] += area_of(p);
    return painted;
}
constexpr std::size_t kLit = 0, kHidden = 2;

struct Exact {
    Real x, y, z;
};
Exact minus(const Exact& a, const Exact& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Exact cross(const Exact& a, const Exact& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real dot(const Exact& a, const Exact& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Exact exact(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}
/// Moeller and Trumbore's test of a ray from the origin to a point.
bool ray_meets(const Exact& to, const Triangle& t) {
    const Exact a = exact(t[0]), e = minus(exact(t[1]), a), f = minus(exact(t[2]), a), p = cross(to, f);
    const Real det = dot(e, p);
    if (det == 0) return false;
    const Exact s{-a.x, -a.y, -a.z}, q = cross(s, e);
    const Real u = dot(s, p) / det, v = dot(to, q) / det, w = dot(f, q) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && w > 0 && w < 1 - 1.0L / 65536;
}
bool is_hidden(const glm::dvec3& point, const Triangles& before) {
    for (const Triangle& t : before)
        if (ray_meets(exact(point), t)) return true;
    return false;
}

/// Of what is seen about a point, up to so many texels from it, is there any with this answer?
bool any_about(const glm::dvec3& point, double texels, const Chart& chart, const Triangles& before,
               bool hidden) {
    const glm::dvec3 c = glm::normalize(point), e = glm::normalize(glm::cross(c, glm::dvec3(0.3, 1, 0.2))),
                     f = glm::cross(c, e);
    const double off = texels / chart.pixels_per_radian() * glm::length(point);
    // So fine that nothing is missed for its being narrow.
    constexpr int kWays = 256, kSteps = 16;
    for (int i = 0; i < kWays * kSteps; ++i) {
        const double a = 2 * std::numbers::pi * i / kWays, r = off * (1 + i / kWays) / kSteps;
        if (is_hidden(point + r * (std::cos(a) * e + std::sin(a) * f), before) == hidden) return true;
    }
    return false;
}

/// The same of what lies in a piece, sides included: a shadow may be so small that those ways miss it.
bool any_in(const PaintedTriangle& piece, const glm::dvec3& point, double texels, const Chart& chart,
            const Triangles& before, bool hidden) {
    constexpr int kSteps = 128;
    const auto& c = piece.corners;
    for (int i = 0; i <= kSteps; ++i)
        for (int k = 0; i + k <= kSteps; ++k) {
            const double u = double(i) / kSteps, v = double(k) / kSteps;
            const glm::dvec3 p = c[0].point * (1 - u - v) + c[1].point * u + c[2].point * v;
            const double angle = glm::length(glm::normalize(p) - glm::normalize(point));
            if (angle * chart.pixels_per_radian() <= texels && is_hidden(p, before) == hidden) return true;
        }
    return false;
}

/// Is a piece so narrow, as it is seen, that it counts as what its middle is (ShadowScale::thin), and does it? By its height over
/// the longest side in the plane that faces the projector.
bool is_as_its_middle(const PaintedTriangle& piece, double texels, const Chart& chart,
                      const Triangles& before) {
    const auto& c = piece.corners;
    const glm::dvec3 axis = glm::normalize(c[0].point + c[1].point + c[2].point);
    glm::dvec3 flat[3];
    for (std::size_t k = 0; k < 3; ++k) flat[k] = c[k].point / glm::dot(axis, c[k].point);
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, glm::length(flat[(k + 1) % 3] - flat[k]));
    const double height = glm::length(glm::cross(flat[1] - flat[0], flat[2] - flat[0])) / longest;
    const glm::dvec3 middle = (c[0].point + c[1].point + c[2].point) / 3.0;
    return height * chart.pixels_per_radian() <= texels &&
           is_hidden(middle, before) == (piece.painting == Painting::hidden);
}

/// Every point within pieces is as rays say, but next to borders of shadows.
void expect_as_rays_say(const Chart& chart, const Painted& painted, const Triangles& before, double tol,
                        std::mt19937& random, int each) {
    std::uniform_real_distribution<double> share(0, 1);
    for (const PaintedTriangle& p : painted.pieces) {
        if (p.painting != Painting::painted && p.painting != Painting::hidden) continue;
        for (int i = 0; i < each; ++i) {
            double a = share(random), b = share(random);
            if (a + b > 1) a = 1 - a, b = 1 - b;
            const glm::dvec3 point =
                p.corners[0].point * (1 - a - b) + p.corners[1].point * a + p.corners[2].point * b;
            const bool says = p.painting == Painting::hidden, is = is_hidden(point, before);
            if (says == is) continue;
            // What is lit may be hidden as part of a small piece; what is hidden is painted in narrow strips at most.
            const double texels = says ? std::min(tol, 1.0) : std::min(tol, 1.0) / 8;
            EXPECT_TRUE(is_as_its_middle(p, std::min(tol, 1.0) / 32, chart, before) ||
                        any_about(point, texels, chart, before, says) ||
                        any_in(p, point, texels, chart, before, says))
                << (says ? "hidden but lit" : "painted but hidden") << " at " << point.x << " " << point.y
                << " " << point.z;
        }
    }
}

/// Every side but those of the scene's own borders is that of another piece, too.
void expect_closed(const Painted& painted, const std::function<bool(const glm::dvec3&)>& at_border) {
    using Place = std::tuple<double, double, double>;
    const auto place = [](const glm::dvec3& p) { return Place(p.x, p.y, p.z); };
    std::set<std::pair<Place, Place>> sides;
    for (const PaintedTriangle& p : painted.pieces)
        for (std::size_t i = 0; i < 3; ++i)
            sides.insert({place(p.corners[i].point), place(p.corners[(i + 1) % 3].point)});
    int open = 0;
    for (const auto& [a, b] : sides) {
        const glm::dvec3 p(std::get<0>(a), std::get<1>(a), std::get<2>(a)),
            q(std::get<0>(b), std::get<1>(b), std::get<2>(b));
        open += !sides.contains({b, a}) && !(at_border(p) && at_border(q));
    }
    EXPECT_EQ(open, 0);
}

TEST(Occluders, ABorderAslantIsCutExactly) {
    const Chart chart(Projection::equirectangular, 1440, 720);
    // Half a plane, in half the distance: hidden is x + 0.3 y > 0.21 on the wall.
    const glm::dvec3 foot(0.105, 0, -0.5), along(-0.3, 1, 0), away(9, 0, 0);
    const Triangles before{{foot - 9.0 * along, foot + 9.0 * along, foot + away * 9.0}};
    const double tol = 0.5, texel = 1.5 / chart.pixels_per_radian();
    const Painted painted = paint(chart, square(-1, 1), before, tol);
    EXPECT_EQ(painted.area[3], 0);
    EXPECT_NEAR(painted.area[kLit], 2 * (1 + 0.21), 2.1 * tol / 8 * texel);
    EXPECT_NEAR(painted.area[kLit] + painted.area[kHidden], 4, 1e-12);
    for (const PaintedTriangle& p : painted.pieces)
        for (const PaintedCorner& c : p.corners) {
            const double depth = c.point.x + 0.3 * c.point.y - 0.21;
            if (p.painting == Painting::painted)
                EXPECT_LE(depth, 1.1 * tol / 8 * texel);
            else
                EXPECT_GE(depth, -1.1 * tol / 8 * texel);
        }
}

TEST(Occluders, IslandsOfShadowWithinACellAreFound) {
    const Chart chart(Projection::rectilinear, 1024, 1024, 90);
    // A cell of this projection is the whole wall.
    ASSERT_LE(paint(chart, square(-1, 0.9), {}, 0.5).pieces.size(), 32u);
    const Triangles before{{{{0.1, 0.12, -0.5}, {0.15, 0.13, -0.5}, {0.11, 0.2, -0.5}}}};
    const double shadow =
        4 * glm::length(glm::cross(before[0][1] - before[0][0], before[0][2] - before[0][0])) / 2;
    const Painted painted = paint(chart, square(-1, 0.9), before, 0.5);
    EXPECT_NEAR(painted.area[kHidden], shadow, 1e-4);
    EXPECT_LT(painted.pieces.size(), 200u);
    // A hole of light in a shadow.
    Triangles frame = square(-0.5, 0.05, -0.3, 0.05);
    for (const Triangle& t : square(-0.5, 0.05, 0.3, -0.1)) frame.push_back(t);
    const Painted two = paint(chart, square(-1, 0.9), frame, 0.5);
    EXPECT_NEAR(two.area[kHidden], 2 * 0.04, 2e-4);
}

TEST(Occluders, ManyTrianglesCastOneShadow) {
    const unsigned seed = 3;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Chart chart(Projection::equirectangular, 512, 256);
    Triangles before = ball({0.3, 0.1, -1.2}, 0.3, 8);
    for (const Triangle& t : ball({-0.25, -0.1, -1}, 0.2, 5)) before.push_back(t);
    for (const Triangle& t : square(-1.1, 0.2, 0, 0.2)) before.push_back(t);
    for (const double tol : {0.25, 2.0}) {
        SCOPED_TRACE(tol);
        const Triangles wall = square(-2, 2);
        const Painted painted = paint(chart, wall, before, tol);
        EXPECT_GT(painted.area[kHidden], 0.8);
        EXPECT_NEAR(painted.area[kLit] + painted.area[kHidden], 16, 1e-9);
        expect_as_rays_say(chart, painted, before, tol, random, 4);
        expect_closed(painted, [](const glm::dvec3& p) {
            return std::max(std::fabs(p.x), std::fabs(p.y)) > 2 - 1e-12;
        });
    }
}

TEST(Occluders, RandomTrianglesBeforeAWall) {
    std::vector<unsigned> seeds(40);
    std::iota(seeds.begin(), seeds.end(), 1u);
    // Of 6000 those in which needles of light, several texels long, were hidden.
    seeds.insert(seeds.end(), {479, 3016, 5461});
    for (const unsigned seed : seeds) {
        SCOPED_TRACE(seed);
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> part(-1, 1);
        // In this order, so that all compilers make the same scenes.
        const auto place = [&] {
            glm::dvec3 p;
            for (int k = 0; k < 3; ++k) p[k] = part(random);
            return p;
        };
        Triangles before;
        for (int i = 0; i < 12; ++i) {
            Triangle t;
            const glm::dvec3 about = place() * glm::dvec3(1, 1, 0.5) - glm::dvec3(0, 0, 0.9);
            for (glm::dvec3& c : t) c = about + 0.4 * place();
            before.push_back(t);
        }
        const Chart chart(Projection::cubemap, 64, 384);
        const Painted painted = paint(chart, square(-1, 1.5), before, 1);
        expect_as_rays_say(chart, painted, before, 1, random, 2);
        expect_closed(painted, [](const glm::dvec3& p) {
            return std::max(std::fabs(p.x), std::fabs(p.y)) > 1.5 - 1e-12;
        });
        EXPECT_NEAR(painted.area[kLit] + painted.area[kHidden] + painted.area[3], 9, 1e-9);
    }
}

TEST(Occluders, WhatMayHidePointsIsFoundForThemTogether) {
    std::mt19937 random(12);
    const auto number = [&](double most) {
        return std::uniform_real_distribution<double>(-most, most)(random);
    };
    Triangles before;
    for (int i = 0; i < 600; ++i) {
        const glm::dvec3 at(number(2), number(2), number(2));
        Triangle t;
        for (glm::dvec3& corner : t) corner = at + glm::dvec3(number(.3), number(.3), number(.3));
        before.push_back(t);
    }
    const glm::dvec3 centre(.1, -.2, .3);
    Triangles moved = before;
    for (Triangle& t : moved)
        for (glm::dvec3& corner : t) corner -= centre;
    const Occluders occluders(corners_of(before), centre);
    std::size_t found_in_all = 0, hidden = 0;
    constexpr int kRows = 800;
    for (int row = 0; row < kRows; ++row) {
        const glm::dvec3 first(number(3), number(3), number(3));
        glm::dvec3 step(number(.02), number(.02), number(.02));
        // Along axes, and all at one place, too.
        for (int d = 0; d < 3; ++d)
            if (row >> d & 1) step[d] = 0;
        std::vector<glm::dvec3> points;
        for (int i = 0; i <= row % 16; ++i) points.push_back(first + step * double(i));
        std::vector<std::int32_t> found{-1};
        occluders.find_before(points, found);
        found_in_all += found.size();
        for (const glm::dvec3& p : points) {
            const bool expected = is_hidden(p - centre, moved);
            EXPECT_EQ(occluders.hides(p), expected) << row;
            EXPECT_EQ(occluders.hides(p, found), expected) << row;
            hidden += expected ? 1 : 0;
        }
    }
    EXPECT_GT(hidden, 1200U);
    EXPECT_LT(found_in_all, kRows * before.size() / 20);
    // In planes of axes, where a row has no width that way.
    const Occluders wall(corners_of(square(-1, 0.5)), {});
    for (const double x : {-.9, 0.0, .9}) {
        const std::vector<glm::dvec3> points{{x, 0, -2}, {x, 0, -3}};
        std::vector<std::int32_t> found;
        wall.find_before(points, found);
        EXPECT_EQ(wall.hides(points[0], found), std::fabs(x) < 1);
        EXPECT_EQ(wall.hides(points[1], found), true);
        EXPECT_EQ(wall.hides({x, 0, -2}), std::fabs(x) < 1);
    }
}

TEST(Occluders, WhatMayHideATriangleHidesItsPoints) {
    std::mt19937 random(13);
    const auto number = [&](double from, double to) {
        return std::uniform_real_distribution<double>(from, to)(random);
    };
    const auto triangle = [&](double size) {
        const glm::dvec3 at(number(-2, 2), number(-2, 2), number(-2, 2));
        Triangle t;
        for (glm::dvec3& corner : t)
            for (int k = 0; k < 3; ++k) corner[k] = at[k] + number(-size, size);
        return t;
    };
    Triangles before;
    for (int i = 0; i < 600; ++i) before.push_back(triangle(.3));
    const glm::dvec3 centre(.1, -.2, .3);
    Triangles moved = before;
    for (Triangle& t : moved)
        for (glm::dvec3& corner : t) corner -= centre;
    const Occluders occluders(corners_of(before), centre);
    std::size_t hidden = 0, lit = 0, found_in_all = 0, one = 0, too_many = 0;
    constexpr int kTriangles = 2000;
    for (int i = 0; i < kTriangles; ++i) {
        // Some are parts of the scene, which hides itself.
        const Triangle t = i % 4 == 0 ? before[static_cast<std::size_t>(i) % before.size()]
                                      : triangle(i % 4 == 1 ? .3 : .02);
        std::vector<std::int32_t> found{-1};
        if (!occluders.find_before(t, 8, found)) {
            ++too_many;
            continue;
        }
        found_in_all += found.size();
        one += found.size() == 1 ? 1 : 0;
        for (int k = 0; k < 20; ++k) {
            // Corners and sides, too.
            glm::dvec3 weights(k % 3 ? number(0, 1) : 0, k % 5 ? number(0, 1) : 0, number(0, 1));
            weights /= weights.x + weights.y + weights.z;
            const glm::dvec3 p = t[0] * weights.x + t[1] * weights.y + t[2] * weights.z;
            const bool expected = is_hidden(p - centre, moved);
            EXPECT_EQ(occluders.hides(p, found), expected) << i;
            ++(expected ? hidden : lit);
        }
    }
    EXPECT_GT(hidden, 5000U);
    EXPECT_GT(lit, 5000U);
    EXPECT_GT(one, 100U);
    EXPECT_GT(too_many, 10U);
    EXPECT_LT(found_in_all, kTriangles * 4U);
    std::vector<std::int32_t> found;
    EXPECT_FALSE(
        occluders.find_before(Triangle{glm::dvec3(NAN), glm::dvec3(1.0), glm::dvec3(2.0)}, 8, found));
}

TEST(Occluders, TheFarSideOfABallIsNotCutAlongItsNearSide) {
    const Triangles scene = ball({0.3, 0.2, -3}, 1, 16);
    ProjectionOptions options;
    options.smallest = 1e-6;
    const Painted painted =
        paint(Chart(Projection::equirectangular, 4096, 2048), scene, scene, 0.125, options);
    // Triangles behind are hidden in one piece, but about the limb.
    EXPECT_GT(painted.counts.hidden, static_cast<std::int64_t>(scene.size() / 3));
    EXPECT_LT(painted.counts.hidden, static_cast<std::int64_t>(5 * scene.size()));
}

TEST(Occluders, ManyNarrowShadowsMakeAWideOne) {
    // Bars of .004 texels, side by side, of which each alone is neglected.
    const auto bars_of = [](int count) {
        Triangles bars;
        const double width = 0.004 / 1000 / 2;
        for (int i = 0; i < count; ++i) {
            const double x = i * width, y = 0.4;
            bars.push_back({glm::dvec3(x, -y, -.5), {x + width, -y, -.5}, {x + width, y, -.5}});
            bars.push_back({glm::dvec3(x, -y, -.5), {x + width, y, -.5}, {x, y, -.5}});
        }
        return corners_of(bars);
    };
    const Triangle wall{glm::dvec3(-.1, -.1, -1), {.1, -.1, -1}, {0, .1, -1}};
    const ShadowScale scale{1000, 0.01, 0x1p-40};
    EXPECT_EQ(Occluders(bars_of(1), {}).cover(wall, scale).share, ShadowCover::lit);
    EXPECT_EQ(Occluders(bars_of(80), {}).cover(wall, scale).share, ShadowCover::both);
}

TEST(Occluders, ANeedleThatIsMostlyLitIsNotHidden) {
    // The end of a needle hardly wider than what is neglected lies in a shadow, which is as wide; the light beside it is narrower.
    const Triangle needle{glm::dvec3(0, 0, -1), {0, .0101, -1}, {1, .00505, -1}};
    const glm::dvec3 corners[] = {
        {-.005, -.01, -.5}, {.025, -.01, -.5}, {.025, .015, -.5}, {-.005, .015, -.5}};
    const Triangles shadow{{corners[0], corners[1], corners[2]}, {corners[0], corners[2], corners[3]}};
    EXPECT_EQ(Occluders(corners_of(shadow), {}).cover(needle, {1, .01, 0x1p-40}).share, ShadowCover::both);
}

TEST(Occluders, WhatTouchesIsPaintedUpToTheContact) {
    // A post that stands on a floor, and the wall that it leans on.
    const Chart chart(Projection::equirectangular, 1024, 512);
    const Triangles floor{{{{-2, -1, -4}, {2, -1, -4}, {2, -1, -1}}},
                          {{{-2, -1, -4}, {2, -1, -1}, {-2, -1, -1}}}};
    const Triangles post{{{{-0.25, -1, -2}, {0.25, -1, -2}, {0.25, -0.5, -2}}},
                         {{{-0.25, -1, -2}, {0.25, -0.5, -2}, {-0.25, -0.5, -2}}}};
    Triangles before = floor;
    before.insert(before.end(), post.begin(), post.end());
    const Painted painted = paint(chart, floor, before, 0.5);
    // The shadow goes from the post's foot to twice its distance: a trapezoid as wide as 0.5 and 1.
    EXPECT_NEAR(painted.area[kHidden], (0.5 + 1) / 2 * 2, 0.01);
    EXPECT_NEAR(painted.area[kLit], 12 - 1.5, 0.01);
    const Painted on_post = paint(chart, post, before, 0.5);
    EXPECT_EQ(on_post.area[kHidden], 0);
    EXPECT_NEAR(on_post.area[kLit], 0.25, 1e-12);
}

TEST(Occluders, TheSameSurfaceTwiceDoesNotHideItself) {
    const Chart chart(Projection::equirectangular, 512, 256);
    const Triangles globe = ball({0.1, -0.2, 0.1}, 1, 10);
    Triangles twice = globe;
    twice.insert(twice.end(), globe.begin(), globe.end());
    const Painted painted = paint(chart, globe, twice, 1, {.smallest = 1e-6, .single = true});
    EXPECT_EQ(painted.area[kHidden], 0);
    EXPECT_GT(painted.area[kLit], 11);
}

TEST(Occluders, WhatIsNoTriangleHidesNothing) {
    const Chart chart(Projection::equirectangular, 512, 256);
    const glm::dvec3 p(0.1, 0, -0.5), q(0.2, 0.3, -0.5);
    const double nan = NAN, inf = HUGE_VAL;
    const Triangles before{{p, p, p},
                           {p, q, p},
                           {p, q, (p + q) * 0.5},
                           {p, q, glm::dvec3(0, nan, 0)},
                           {p, q, glm::dvec3(0, inf, -1)},
                           {p, q, glm::dvec3(0.0)},
                           {p, p * 2.0, p * 3.0}};
    EXPECT_EQ(paint(chart, square(-1, 1), before, 1).area[kHidden], 0);
    const Occluders none({}, {});
    EXPECT_FALSE(none.hides({1, 2, 3}));
    const Occluders one(corners_of(square(-0.5, 1)), {});
    EXPECT_TRUE(one.hides({0.1, 0.2, -1}));
    EXPECT_FALSE(one.hides({0.1, 0.2, -0.4}));
    EXPECT_FALSE(one.hides({0.1, 0.2, 1}));
    EXPECT_FALSE(one.hides({0, 0, 0}));
    EXPECT_FALSE(one.hides({nan, 0, -1}));
}

TEST(Occluders, DustTakesTrianglesButEnds) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> part(-1, 1);
    Triangles dust;
    for (int i = 0; i < 300; ++i) {
        const glm::dvec3 about(part(random), part(random), -1);
        dust.push_back({about, about + glm::dvec3(0.004, 0.001, 0), about + glm::dvec3(0.001, 0.004, 0)});
    }
    const Chart chart(Projection::equirectangular, 1440, 720);
    const Painted painted = paint(chart, square(-2, 2), dust, 1, {.smallest = 4e-6, .single = true});
    EXPECT_GT(painted.area[kHidden], 0.007);
    EXPECT_LT(painted.pieces.size(), 50000u);
}

}  // namespace
}  // namespace anamorph::test_occluders
