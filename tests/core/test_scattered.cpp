// SPDX-License-Identifier: Apache-2.0
// Warps through pairs of points: through all of them, C1, exact for affine maps, and within the tolerance.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "anamorph/error.h"
#include "anamorph/mesh/mesh_scattered.h"
#include "each_instruction_set.h"
#include "mesh_cases.h"
#include "scattered_findings.h"

namespace anamorph::test_scattered {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const Size kTarget{300, 200}, kSource{320, 260};

ControlPoints random_points(test::Random& random, int count, double amplitude) {
    ControlPoints points;
    for (int i = 0; i < count; ++i) {
        const double x = random.between(-20, 320), y = random.between(-20, 220);
        points.pairs.push_back({x, y, x * 320 / 300 + random.between(-amplitude, amplitude),
                                y * 260 / 200 + random.between(-amplitude, amplitude)});
    }
    return points;
}

TEST(Scattered, GoesThroughItsPoints) {
    constexpr unsigned kSeed = 561;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    for (const int count : {1, 2, 3, 4, 50, 500}) {
        const ControlPoints points = random_points(random, count, 20);
        const Scattered map(points, kTarget, kSource, 1);
        for (const ControlPoints::Pair& p : points.pairs) {
            const Point<double> q = map.at(p.x, p.y);
            EXPECT_NEAR(q.x, p.u, 1e-8);
            EXPECT_NEAR(q.y, p.v, 1e-8);
        }
        const Scattered none(points, kTarget, kSource, 0);
        EXPECT_NEAR(none.at(120.25, 70).x, 120.25 * 320 / 300, 1e-12);
    }
}

TEST(Scattered, AffineMapsStayAffine) {
    test::Random random(562);
    for (const int count : {3, 7, 100}) {
        ControlPoints points = random_points(random, count, 0);
        const auto affine = [](double x, double y) {
            return Point<double>{12 + 0.8 * x - 0.3 * y, -7 + 0.2 * x + 1.2 * y};
        };
        for (ControlPoints::Pair& p : points.pairs) {
            p.u = affine(p.x, p.y).x;
            p.v = affine(p.x, p.y).y;
        }
        const Scattered map(points, kTarget, kSource, 1);
        for (int n = 0; n < 300; ++n) {
            const double x = random.between(0, 300), y = random.between(0, 200);
            EXPECT_NEAR(map.at(x, y).x, affine(x, y).x, 1e-8);
            EXPECT_NEAR(map.at(x, y).y, affine(x, y).y, 1e-8);
        }
    }
}

TEST(Scattered, IsSmoothAcrossEveryEdge) {
    constexpr unsigned kSeed = 563;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    const Scattered map(random_points(random, 60, 20), kTarget, kSource, 1);
    using J = Jet1<double>;
    int compared = 0;
    for (const CubicTriangle& t : map.triangles())
        for (std::size_t e = 0; e < 3; ++e) {
            const double k = random.between(0.1, 0.9);
            const Point<double> p = t.corner[e], q = t.corner[(e + 1) % 3];
            const double x = p.x + k * (q.x - p.x), y = p.y + k * (q.y - p.y);
            map.tree().each({x, y, x, y}, [&](std::int32_t i) {
                const CubicTriangle& other = map.triangles()[static_cast<std::size_t>(i)];
                if (&other == &t || other.inside(x, y) < -1e-12) return;
                ++compared;
                const Point<J> a = map.at(t, J::variable(x, 1, 0), J::variable(y, 0, 1));
                const Point<J> b = map.at(other, J::variable(x, 1, 0), J::variable(y, 0, 1));
                for (int c = 0; c < 3; ++c) {
                    EXPECT_NEAR(a.x.c[c], b.x.c[c], 1e-7);
                    EXPECT_NEAR(a.y.c[c], b.y.c[c], 1e-7);
                }
            });
        }
    EXPECT_GT(compared, 300);
}

TEST(Scattered, HoldsTheTolerance) {
    constexpr unsigned kSeed = 564;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    for (const int count : {1, 3, 30, 400})
        for (const double tol : {1.0, 0.25, 1.0 / 16, 1.0 / 64, 0.01}) {
            SCOPED_TRACE(::testing::Message() << count << " points, tol " << tol);
            const ScatteredPlan plan(Scattered(random_points(random, count, 15), kTarget, kSource, 1),
                                     WarpScheme::automatic, tol);
            const test::Findings found = test::findings_of(plan);
            EXPECT_LE(found.worst_excess, 0);
            EXPECT_LE(found.worst_bound, tol);
            EXPECT_EQ(found.overlaps, 0);
            EXPECT_EQ(found.pixels, std::int64_t{kTarget.width} * kTarget.height);
            // Only blocks of a few pixels where triangles have no size.
            EXPECT_LT(found.exact_pixels, 100);
        }
}

// Points within hairs of lines: triangles so thin that rounding decides on which side their corners lie.
TEST(Scattered, PartsOfRowsAreThoseOfTheWholeOnAllInstructionSets) {
    constexpr unsigned kSeed = 21;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    const Size size{256, 192};
    ControlPoints points;
    for (int i = 0; i < 60; ++i) {
        const double x = random.between(0, size.width), y = random.between(0, size.height);
        points.pairs.push_back({x, y, x + random.between(-6, 6), y + random.between(-6, 6)});
    }
    const ScatteredPlan plan(Scattered(points, size, size, 1), WarpScheme::automatic, 1e-3);
    std::vector<std::vector<float>> all;
    int compared = 0;
    test::on_every_instruction_set([&] {
        std::vector<float>& values = all.emplace_back();
        for (std::int64_t r = 0; r < plan.regions(); ++r)
            for (const Block& block : plan.blocks(r)) {
                if (block.kind != Block::Kind::computed) continue;
                const int row = block.box.height() / 2, begin = block.box.width() / 3,
                          end = block.box.width();
                float x[simd::kRowRoom], y[simd::kRowRoom], part_x[simd::kRowRoom], part_y[simd::kRowRoom];
                plan.computed_row(block, row, 0, end, x, y);
                plan.computed_row(block, row, begin, end - 1, part_x, part_y);
                for (int i = 0; i < end; ++i) {
                    values.push_back(x[i]);
                    values.push_back(y[i]);
                    if (i < begin || i >= end - 1) continue;
                    ASSERT_EQ(part_x[i - begin], x[i]);
                    ASSERT_EQ(part_y[i - begin], y[i]);
                    ++compared;
                }
            }
    });
    EXPECT_GT(compared, 100);
    for (const std::vector<float>& values : all) EXPECT_EQ(values, all.front());
}

TEST(Scattered, ThinTrianglesKeepTheTolerance) {
    constexpr unsigned kSeed = 565;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    for (const double hair : {1e-4, 1e-8, 1e-11, 1e-13}) {
        SCOPED_TRACE(hair);
        ControlPoints points;
        for (int i = 0; i < 12; ++i) {
            const double x = random.between(0, 300), y = 100 + 0.25 * x + random.between(-hair, hair);
            points.pairs.push_back({x, y, x + random.between(-2, 2), y + random.between(-2, 2)});
        }
        for (const double tol : {1.0, 1.0 / 64}) {
            const ScatteredPlan plan(Scattered(points, kTarget, kSource, 1), WarpScheme::automatic, tol);
            const test::Findings found = test::findings_of(plan);
            EXPECT_LE(found.worst_excess, 0);
            EXPECT_EQ(found.overlaps, 0);
        }
    }
}

TEST(Scattered, PointsOnALineOrAGridAreNoTrouble) {
    for (const bool grid : {false, true}) {
        ControlPoints points;
        for (int i = 0; i < 10; ++i)
            for (int j = 0; j < (grid ? 10 : 1); ++j)
                points.pairs.push_back(
                    {30.0 * i, 20.0 * j + 3, 31.0 * i + 5 * (i % 2), 26.0 * j + 3 * (i % 3)});
        const Scattered map(points, kTarget, kSource, 1);
        for (const ControlPoints::Pair& p : points.pairs) {
            EXPECT_NEAR(map.at(p.x, p.y).x, p.u, 1e-8);
            EXPECT_NEAR(map.at(p.x, p.y).y, p.v, 1e-8);
        }
        const ScatteredPlan plan(map, WarpScheme::automatic, 1.0 / 16);
        EXPECT_LE(plan.reached(serial_for).max_error, 1.0 / 16);
    }
}

TEST(Scattered, RefusesWhatAreNoPoints) {
    const auto refused = [](const ControlPoints& points, double amount = 1) -> std::string {
        try {
            Scattered(points, kTarget, kSource, amount, "p.csv");
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_THAT(refused({}), HasSubstr("p.csv"));
    ControlPoints points;
    points.pairs = {{1, 2, 3, 4}, {5, 6, 7, 8}, {1, 2, 9, 9}};
    EXPECT_THAT(refused(points),
                AllOf(HasSubstr("p.csv: points[2]"), HasSubstr("points[0]"), Not(HasSubstr("\n"))));
    points.pairs[2] = {9, 9, std::nan(""), 1};
    EXPECT_THAT(refused(points), HasSubstr("p.csv: points[2]"));
    points.pairs[2] = {9, 9, 1, 1e12};
    EXPECT_THAT(refused(points), HasSubstr("p.csv: points[2]"));
    points.pairs[2] = {9, 9, 1, 1};
    EXPECT_EQ(refused(points), "");
    EXPECT_THAT(refused(points, HUGE_VAL), HasSubstr("amount"));
}

}  // namespace
}  // namespace anamorph::test_scattered
