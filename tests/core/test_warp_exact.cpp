// SPDX-License-Identifier: Apache-2.0
// What is proven of warps, against long double from the numbers that were given: no pixel, exact ones too, is
// farther off than its block says.
#include <gtest/gtest.h>

#include "anamorph/mesh/inverse.h"
#include "anamorph/mesh/mesh_file.h"
#include "anamorph/mesh/mesh_plan.h"
#include "anamorph/mesh/mesh_scattered.h"
#include "mesh_cases.h"
#include "warp_findings.h"
#include "warp_oracles.h"

namespace anamorph::test_warp_exact {
namespace {

const Size kTarget{180, 130}, kSource{320, 200};

struct Worst {
    double exact_bound = 0, exact_error = 0;
};

template <class Plan, class Truth>
Worst expect_bounds(const Plan& plan, const Truth& truth, double tol) {
    const test::Findings found = test::examine(plan, truth);
    EXPECT_LE(found.worst_excess, 0);
    EXPECT_LE(found.worst_bound, tol);
    EXPECT_EQ(found.overlaps, 0);
    return {found.worst_exact_bound, found.worst_exact};
}

Worst examine_points(const ControlPoints& points, double tol) {
    const ScatteredPlan plan(Scattered(points, kTarget, kSource, 1), WarpScheme::automatic, tol);
    return expect_bounds(plan, test::PointsOracle(points, plan.map(), kTarget, kSource), tol);
}

Worst examine_mesh(const ControlMesh& mesh, WarpScheme scheme, double tol, double amount) {
    const MeshPlan plan(Mesh(mesh, kTarget, kSource, amount), scheme, tol);
    return expect_bounds(plan, test::MeshOracle(mesh, kTarget, kSource, amount), tol);
}

ControlPoints some_points(test::Random& random, int count, double amplitude) {
    ControlPoints points;
    for (int i = 0; i < count; ++i) {
        const double x = random.between(-20, 200), y = random.between(-20, 150);
        points.pairs.push_back({x, y, x * 320 / 180 + random.between(-amplitude, amplitude),
                                y * 200 / 130 + random.between(-amplitude, amplitude)});
    }
    return points;
}

constexpr double kTols[] = {1, 0.01, 1e-4, 1e-6, 0};

TEST(WarpExact, PointsWithOneFarAway) {
    constexpr unsigned kSeed = 571;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    for (int n = 0; n < 4; ++n)
        for (const double tol : {0.01, 1e-5, 0.0}) {
            SCOPED_TRACE(::testing::Message() << n << ", tol " << tol);
            ControlPoints points = some_points(random, 12, 20);
            points.pairs.push_back({1e6, -2e6, 12, -7});
            const Worst worst = examine_points(points, tol);
            // Triangles a hundredth of a pixel wide reach 2 million pixels out.
            EXPECT_LE(worst.exact_bound, 1e-3);
        }
}

TEST(WarpExact, PointsNearlyOnALine) {
    constexpr unsigned kSeed = 572;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    for (const double hair : {1.0, 1e-2, 1e-3, 3e-4, 1e-4, 1e-6, 1e-9})
        for (const double tol : kTols) {
            SCOPED_TRACE(::testing::Message() << "hair " << hair << ", tol " << tol);
            ControlPoints points;
            for (int i = 0; i < 9; ++i) {
                const double x = random.between(0, 180), y = 30 + 0.4 * x + random.between(-hair, hair);
                points.pairs.push_back(
                    {x, y, x * 1.7 + random.between(-2, 2), y * 1.5 + random.between(-2, 2)});
            }
            examine_points(points, tol);
        }
}

TEST(WarpExact, PointsAnywhere) {
    constexpr unsigned kSeed = 573;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    for (const int count : {1, 2, 3, 10, 60})
        for (const double tol : kTols) {
            SCOPED_TRACE(::testing::Message() << count << " points, tol " << tol);
            EXPECT_LE(examine_points(some_points(random, count, 15), tol).exact_bound, 1e-10);
        }
}

TEST(WarpExact, MeshesOfAnyLinesAndAmounts) {
    constexpr unsigned kSeed = 574;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    for (int n = 0; n < 6; ++n) {
        const ControlMesh mesh =
            test::random_mesh(random, kTarget, kSource, random.whole(1, 9), random.whole(1, 9),
                              n == 4 ? 1e-7 : random.between(0, 0.6), n % 2, 0);
        for (const double tol : kTols)
            for (const WarpScheme scheme : {WarpScheme::automatic, WarpScheme::residual}) {
                SCOPED_TRACE(::testing::Message() << n << ", tol " << tol);
                examine_mesh(mesh, scheme, tol, n == 4 ? 1e5 : n == 5 ? -1.5 : 1);
            }
    }
    ControlMesh thin = test::identity_mesh(kSource, 4, 3);
    thin.x_lines = {0, 60.25, 60.2500015, 120.123, 180};
    thin.y_lines = {10.3, 65.1, 65.100003, 99};
    thin.vertices[6] = {100, 40};
    for (const double tol : kTols) examine_mesh(thin, WarpScheme::automatic, tol, 1);
}

// Cells smaller than pixels share a bound of their vertices.
TEST(WarpExact, MoreCellsThanPixels) {
    test::Random random(577);
    for (const bool uneven : {false, true}) {
        const ControlMesh mesh = test::random_mesh(random, kTarget, kSource, 300, 200, 0.4, uneven, 0);
        // Uneven lines end early: from a narrow cell the map goes on far.
        EXPECT_LE(examine_mesh(mesh, WarpScheme::automatic, 0.01, 1).exact_bound, uneven ? 1e-6 : 1e-9);
    }
}

// ST-maps of as many pixels as the picture, and of fewer or more, with every pixel taken or every third; across
// a seam too, where u jumps.
TEST(WarpExact, DenseStMaps) {
    constexpr unsigned kSeed = 578;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    for (const Size& size : {kTarget, Size{177, 131}, Size{90, 70}, Size{300, 260}})
        for (const int step : {1, 3})
            for (const double jump : {0.0, 0.7}) {
                SCOPED_TRACE(::testing::Message()
                             << size.width << " wide, step " << step << ", jump " << jump);
                std::vector<float> uv;
                for (int y = 0; y < size.height; ++y)
                    for (int x = 0; x < size.width; ++x) {
                        const double u = (x + 0.5) / size.width + random.between(-0.01, 0.01) + jump;
                        uv.push_back(static_cast<float>(jump > 0 ? u - std::floor(u) : u));
                        uv.push_back(
                            static_cast<float>((y + 0.5) / size.height + random.between(-0.01, 0.01)));
                    }
                const WarpMap map =
                    mesh_from_stmap(uv.data(), size.width, size.height, 2, 2 * size.width, step, "st");
                const ControlMesh& mesh = std::get<ControlMesh>(map.shape);
                for (const double tol : kTols)
                    for (const WarpScheme scheme : {WarpScheme::automatic, WarpScheme::exact})
                        EXPECT_LE(examine_mesh(mesh, scheme, tol, 1).exact_bound, 1e-6);
            }
}

// What an ST-map of the picture's own size says of a pixel is where that pixel's colour comes from.
TEST(WarpExact, StMapsOfThePicturesSizeAreReadAsTheyStand) {
    test::Random random(579);
    std::vector<float> uv;
    for (int i = 0; i < kTarget.width * kTarget.height; ++i) {
        uv.push_back(static_cast<float>(random.between(0, 1)));
        uv.push_back(static_cast<float>(random.between(0, 1)));
    }
    const WarpMap map =
        mesh_from_stmap(uv.data(), kTarget.width, kTarget.height, 2, 2 * kTarget.width, 1, "st");
    const MeshPlan plan(Mesh(std::get<ControlMesh>(map.shape), kTarget, kSource, 1), WarpScheme::automatic,
                        0.01);
    const auto truth = [&](double x, double y) {
        const float* at =
            &uv[2 * static_cast<std::size_t>(static_cast<int>(y) * kTarget.width + static_cast<int>(x))];
        return test::RealPoint{test::Real(at[0]) * kSource.width, test::Real(at[1]) * kSource.height};
    };
    expect_bounds(plan, truth, 0.01);
    EXPECT_EQ(plan.reached(serial_for).exact_fraction, 0);
}

TEST(WarpExact, HardMeshes) {
    for (const auto& [name, mesh] : test::hard_meshes(kTarget, kSource))
        for (const double tol : kTols) {
            SCOPED_TRACE(name);
            examine_mesh(mesh, WarpScheme::automatic, tol, 1);
        }
}

/// Pixels at random places against all source points; near folds, where the oracle is in doubt too, fewer.
int examine_push(const ControlMesh& mesh, test::Random& random, double tol, int pixels) {
    const InversePlan plan(Mesh(mesh, kSource, kTarget, 1), WarpScheme::automatic, tol, "mesh");
    const test::MeshOracle forward(mesh, kSource, kTarget, 1);
    const test::PushOracle oracle(forward, plan.mesh().orientation());
    int folded = 0;
    for (int n = 0; n < pixels; ++n) {
        const int i = random.whole(0, kTarget.width - 1), j = random.whole(0, kTarget.height - 1);
        SCOPED_TRACE(::testing::Message() << "pixel " << i << ", " << j << ", tol " << tol);
        const auto roots = oracle.roots(i + 0.5L, j + 0.5L);
        const bool near_fold =
            std::any_of(roots.begin(), roots.end(), [](const auto& r) { return std::fabs(r.slope) < 1e-3L; });
        if (near_fold) continue;
        folded += roots.size() > 1;
        for (const Block& block : plan.blocks(0)) {
            if (i < block.box.x0 || i >= block.box.x1 || j < block.box.y0 || j >= block.box.y1) continue;
            Point<double> at{};
            int piece = 0;
            const bool seen = plan.exact(i + 0.5, j + 0.5, 0, at, piece);
            EXPECT_EQ(seen, !roots.empty());
            if (block.kind == Block::Kind::outside) {
                EXPECT_TRUE(roots.empty());
            }
            if (!seen || roots.empty()) continue;
            EXPECT_EQ(plan.folds(i + 0.5, j + 0.5), roots.size() - 1.0f);
            alignas(64) float x[simd::kRowRoom], y[simd::kRowRoom];
            if (block.kind != Block::Kind::exact) {
                block_row(plan, block, block.box, j, x, y);
                at = {block.base_x + double(x[i - block.box.x0]), block.base_y + double(y[i - block.box.x0])};
                EXPECT_LE(block.bound, tol);
            }
            EXPECT_LE(std::hypot(at.x - roots[0].at.x, at.y - roots[0].at.y), block.bound);
            EXPECT_LE(block.bound, std::max(tol, 1e-4));
        }
    }
    return folded;
}

TEST(WarpExact, PushedMeshesDrawWhatTheRuleSays) {
    constexpr unsigned kSeed = 575;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    int folded = 0;
    for (int n = 0; n < 10; ++n) {
        SCOPED_TRACE(n);
        const ControlMesh mesh =
            test::random_mesh(random, kSource, kTarget, random.whole(1, 3), random.whole(1, 3),
                              random.between(0.6, 1.8), n % 3 == 2, 0);
        folded += examine_push(mesh, random, kTols[n % 5], 60);
    }
    EXPECT_GT(folded, 40);
}

// Cells a hair wide are found like others.
TEST(WarpExact, PushedCellsOfNoWidthLoseNoPixel) {
    ControlMesh mesh = test::identity_mesh(kTarget, 4, 2);
    mesh.x_lines = {0, 160.3, 160.3000015, 160.300003, 320};
    mesh.y_lines = {0, 77.7000001, 200};
    const InversePlan plan(Mesh(mesh, kSource, kTarget, 1), WarpScheme::automatic, 0.01, "mesh");
    int lost = 0;
    for (int y = 0; y < kTarget.height; ++y)
        for (int x = 0; x < kTarget.width; ++x) lost += plan.preimages(x + 0.5, y + 0.5).count != 1;
    EXPECT_EQ(lost, 0);
}

// A band laid to and fro eighty times: every layer counts, and the last one is drawn.
TEST(WarpExact, ManyLayersAreToldApart) {
    constexpr int kLayers = 80;
    ControlMesh mesh;
    mesh.columns = kLayers;
    for (int r = 0; r < 2; ++r)
        for (int c = 0; c <= kLayers; ++c) mesh.vertices.push_back({c % 2 ? 170.0 : 10.0, 130.0 * r});
    const InversePlan plan(Mesh(mesh, kSource, kTarget, 1), WarpScheme::automatic, 0.01, "mesh");
    EXPECT_EQ(plan.folds(90.5, 60.5), kLayers - 1);
    const Preimages all = plan.preimages(90.5, 60.5);
    EXPECT_FALSE(all.best.turned);
    EXPECT_GE(all.best.at.x, 320.0 * (kLayers - 2) / kLayers);
}

}  // namespace
}  // namespace anamorph::test_warp_exact
