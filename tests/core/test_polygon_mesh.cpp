// SPDX-License-Identifier: Apache-2.0
// Warps over meshes of polygons: every side is one Hermite cubic, sides join smoothly, and plans hold their tolerance.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "anamorph/error.h"
#include "anamorph/mesh/mesh_file.h"
#include "anamorph/mesh/mesh_scattered.h"
#include "anamorph/mesh/scattered.h"
#include "scattered_findings.h"

namespace anamorph::test_polygon_mesh {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr Size kTarget{400, 300}, kSource{500, 350};

/// Long quadrilaterals across the picture, in whose middle Delaunay would not go along their sides: rows of points near
/// each other, joined in strips that lean.
ControlPoints strips(std::mt19937& random, int rows) {
    const auto some = [&](double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(random);
    };
    ControlPoints points;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i < 3; ++i) {
            const double x = 40 + 160 * i + some(-8, 8),
                         y = 40 + j * 220.0 / rows + 30 * (i % 2) + some(-2, 2);
            points.pairs.push_back({x, y, 1.2 * x + some(-15, 15), 1.1 * y + some(-15, 15)});
        }
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < 2; ++i) {
            const int k = 3 * j + i;
            points.polygons.push_back({k, k + 1, k + 4, k + 3});
        }
    return points;
}

/// The point of the map along a side, at t.
Point<double> along(const Scattered& map, const ControlPoints& points, int a, int b, double t) {
    const ControlPoints::Pair &p = points.pairs[static_cast<std::size_t>(a)],
                              &q = points.pairs[static_cast<std::size_t>(b)];
    return map.at(p.x + t * (q.x - p.x), p.y + t * (q.y - p.y));
}

/// How far the map along a side is from one cubic: the largest fourth difference of nine points.
double off_cubic(const Scattered& map, const ControlPoints& points, int a, int b) {
    double worst = 0;
    for (int k = 0; k < 5; ++k) {
        double x = 0, y = 0;
        const double weight[5] = {1, -4, 6, -4, 1};
        for (int n = 0; n < 5; ++n) {
            const Point<double> at = along(map, points, a, b, (k + n) / 8.0);
            x += weight[n] * at.x;
            y += weight[n] * at.y;
        }
        worst = std::max({worst, std::fabs(x), std::fabs(y)});
    }
    return worst;
}

TEST(PolygonMesh, SidesAreOneCubicEach) {
    std::mt19937 random(17);
    int not_delaunay = 0;
    for (int n = 0; n < 20; ++n) {
        const ControlPoints points = strips(random, 6 + n);
        ControlPoints alone = points;
        alone.polygons.clear();
        const Scattered map(points, kTarget, kSource, 1), free(alone, kTarget, kSource, 1);
        for (const ControlPoints::Pair& p : points.pairs) {
            const Point<double> at = map.at(p.x, p.y);
            EXPECT_NEAR(at.x, p.u, 1e-9);
            EXPECT_NEAR(at.y, p.v, 1e-9);
        }
        for (const std::vector<int>& polygon : points.polygons)
            for (std::size_t k = 0; k < 4; ++k) {
                EXPECT_LT(off_cubic(map, points, polygon[k], polygon[(k + 1) % 4]), 1e-9) << n;
                not_delaunay += off_cubic(free, points, polygon[k], polygon[(k + 1) % 4]) > 1e-3;
            }
    }
    // Without polygons many are not.
    EXPECT_GT(not_delaunay, 100);
}

TEST(PolygonMesh, IsSmoothAcrossSides) {
    std::mt19937 random(23);
    const ControlPoints points = strips(random, 9);
    const Scattered map(points, kTarget, kSource, 1);
    for (const std::vector<int>& polygon : points.polygons)
        for (std::size_t k = 0; k < 4; ++k)
            for (const double t : {0.13, 0.5, 0.81}) {
                const auto &p = points.pairs[static_cast<std::size_t>(polygon[k])],
                           &q = points.pairs[static_cast<std::size_t>(polygon[(k + 1) % 4])];
                const double x = p.x + t * (q.x - p.x), y = p.y + t * (q.y - p.y),
                             length = std::hypot(q.x - p.x, q.y - p.y), h = 1e-6;
                const double nx = -(q.y - p.y) / length * h, ny = (q.x - p.x) / length * h;
                const Point<double> at = map.at(x, y), left = map.at(x + nx, y + ny),
                                    right = map.at(x - nx, y - ny);
                EXPECT_NEAR((left.x - at.x) / h, (at.x - right.x) / h, 1e-4);
                EXPECT_NEAR((left.y - at.y) / h, (at.y - right.y) / h, 1e-4);
            }
}

TEST(PolygonMesh, PlansHoldTheirTolerance) {
    std::mt19937 random(29);
    const ControlPoints points = strips(random, 9);
    for (const double tol : {1.0, 0.1, 0.01}) {
        const ScatteredPlan plan(Scattered(points, kTarget, kSource, 1), WarpScheme::automatic, tol);
        const test::Findings found = test::findings_of(plan);
        EXPECT_LE(found.worst_excess, 0);
        EXPECT_LE(found.worst_bound, tol);
        EXPECT_EQ(found.overlaps, 0);
        EXPECT_EQ(found.pixels, std::int64_t{kTarget.width} * kTarget.height);
    }
}

TEST(PolygonMesh, PolygonsOfAnyShapeAreTaken) {
    // A star of ten corners about a pentagon, a triangle beside it, points that no polygon has.
    ControlPoints points;
    for (int k = 0; k < 10; ++k) {
        const double r = k % 2 ? 40 : 120, a = k * 0.6283185307179586;
        points.pairs.push_back(
            {200 + r * std::cos(a), 150 + r * std::sin(a), 250 + r * std::sin(a), 175 + r * std::cos(a)});
    }
    points.pairs.push_back({390, 5, 10, 10});
    points.pairs.push_back({380, 290, 400, 30});
    points.pairs.push_back({395, 150, 4, 300});
    points.polygons = {
        {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, {1, 3, 5, 7, 9}, {10, 11, 12}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}};
    const Scattered map(points, kTarget, kSource, 1);
    for (const std::vector<int>& polygon : points.polygons)
        for (std::size_t k = 0; k < polygon.size(); ++k)
            EXPECT_LT(off_cubic(map, points, polygon[k], polygon[(k + 1) % polygon.size()]), 1e-8);
}

TEST(PolygonMesh, ASideMayCrossWhateverLiesInItsWay) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> across(5, 395), down(5, 295);
        ControlPoints points;
        for (int i = 0; i < 120; ++i) {
            const double x = across(random), y = down(random);
            points.pairs.push_back({x, y, 1.2 * x + 9 * std::sin(y / 30), 1.1 * y + 7 * std::cos(x / 40)});
        }
        points.pairs.push_back({1, 1, 2, 2});
        points.pairs.push_back({399, 298, 490, 340});
        points.pairs.push_back({2, 299, 4, 345});
        points.polygons = {{120, 121, 122}};
        const Scattered map(points, kTarget, kSource, 1);
        for (int k = 0; k < 3; ++k)
            EXPECT_LT(off_cubic(map, points, 120 + k, 120 + (k + 1) % 3), 1e-8) << "seed " << seed;
    }
}

std::string refusal(std::vector<ControlPoints::Pair> pairs, std::vector<std::vector<int>> polygons) {
    ControlPoints points;
    points.pairs = std::move(pairs);
    points.polygons = std::move(polygons);
    try {
        Scattered(points, kTarget, kSource, 1, "m.json");
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

TEST(PolygonMesh, WhatIsWrongIsNamed) {
    const std::vector<ControlPoints::Pair> square = {
        {10, 10, 1, 1}, {90, 10, 2, 1}, {90, 90, 2, 2}, {10, 90, 1, 2}, {50, 50, 1, 1}};
    EXPECT_EQ(refusal(square, {{0, 1, 2, 3}}), "no error");
    EXPECT_THAT(refusal(square, {{0, 1}}),
                AllOf(HasSubstr("m.json: polygons[0]"), HasSubstr("must have at least 3")));
    for (const int bad : {-1, 5, 2147483647})
        EXPECT_THAT(refusal(square, {{0, 1, 4}, {0, 1, bad}}),
                    AllOf(HasSubstr("polygons[1]=" + std::to_string(bad)), HasSubstr("from 0 to 4")));
    EXPECT_THAT(refusal(square, {{0, 1, 1}}), HasSubstr("must not have one corner twice in a row"));
    // The diagonal goes through the middle; and two sides that cross.
    EXPECT_THAT(refusal(square, {{0, 2, 3}}),
                HasSubstr("from point 0 to 2 must not go through a point: points[4]"));
    const std::vector<ControlPoints::Pair> four(square.begin(), square.end() - 1);
    EXPECT_THAT(refusal(four, {{0, 2, 3}, {0, 1, 3}}), HasSubstr("must not cross the side from point"));
    EXPECT_LE(refusal(four, {{0, 2, 3}, {0, 1, 3}}).size(), 400u);
}

TEST(PolygonMesh, AFileHasPolygons) {
    const char* const text =
        R"({"points": [[0, 0, 0, 0], [99, 0, 9, 0], [99, 99, 9, 9], [0, 99, 0, 9]], "polygons": [[0, 1, 2], [0, 2, 3]]})";
    const WarpMap map = parse_mesh_json(text, "m.json");
    EXPECT_EQ(std::get<ControlPoints>(map.shape).polygons,
              (std::vector<std::vector<int>>{{0, 1, 2}, {0, 2, 3}}));
    for (const char* bad :
         {R"({"points": [[0,0,0,0]], "polygons": 3})", R"({"points": [[0,0,0,0]], "polygons": [[0,1,"a"]]})",
          R"({"points": [[0,0,0,0]], "polygons": [[0,1,1.5]]})",
          R"({"points": [[0,0,0,0]], "polygons": [[0,-1,1]]})",
          R"({"points": [[0,0,0,0]], "polygons": [[0,1,99999999999]]})"})
        EXPECT_THROW(parse_mesh_json(bad, "m.json"), Error) << bad;
}

}  // namespace
}  // namespace anamorph::test_polygon_mesh
