// SPDX-License-Identifier: Apache-2.0
// The promise for mesh warps: no pixel's source point is farther from the exact one than its block's bound,
// and no bound than tol.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "anamorph/mesh/mesh_plan.h"
#include "mesh_cases.h"
#include "warp_findings.h"

namespace anamorph::test_mesh_plan {
namespace {

constexpr double kTols[] = {1, 1.0 / 4, 1.0 / 16, 1.0 / 64, 0.01};
constexpr WarpScheme kSchemes[] = {WarpScheme::automatic, WarpScheme::hermite, WarpScheme::residual,
                                   WarpScheme::exact};

/// The map in long double: the truth for double itself.
Point<long double> truth(const Mesh& mesh, double x, double y) {
    return mesh.at(mesh.patch(mesh.cell_at(x, y)), static_cast<long double>(x), static_cast<long double>(y));
}

void expect_promise(const ControlMesh& given, const Size& target, const Size& source, WarpScheme scheme,
                    double tol, double amount = 1, bool all_exact = false) {
    SCOPED_TRACE(::testing::Message() << "scheme " << static_cast<int>(scheme) << ", tol " << tol);
    const MeshPlan plan(Mesh(given, target, source, amount), scheme, tol);
    const test::Findings found =
        test::examine(plan, [&](double x, double y) { return truth(plan.mesh(), x, y); });
    EXPECT_LE(found.worst_excess, 0);
    EXPECT_LE(found.worst_bound, tol);
    EXPECT_EQ(found.pixels, std::int64_t{target.width} * target.height);
    EXPECT_EQ(found.overlaps, 0);
    EXPECT_LE(found.worst_exact, 1e-7);
    if (all_exact) {
        EXPECT_EQ(found.exact_pixels, found.pixels);
    }
}

TEST(MeshPlan, HoldsTheToleranceOnRandomMeshes) {
    constexpr unsigned kSeed = 5301;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    for (int n = 0; n < 12; ++n) {
        const Size target{random.whole(40, 700), random.whole(40, 300)},
            source{random.whole(40, 3000), random.whole(40, 3000)};
        const ControlMesh mesh =
            test::random_mesh(random, target, source, random.whole(1, 9), random.whole(1, 9),
                              random.between(0, 0.6), n % 3 == 0, n % 2 ? 3 : 0);
        SCOPED_TRACE(n);
        for (const WarpScheme scheme : kSchemes)
            for (const double tol : kTols) expect_promise(mesh, target, source, scheme, tol);
    }
}

// Pixels evaluated in double, too, in blocks of any size.
TEST(MeshPlan, ExactPixelsKeepSmallTolerances) {
    constexpr unsigned kSeed = 5302;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    for (int n = 0; n < 4; ++n) {
        const Size target{random.whole(200, 500), random.whole(100, 300)}, source{500, 400};
        const ControlMesh mesh = test::random_mesh(random, target, source, 6, 6, 0.5, false, n % 2 ? 2 : 0);
        for (const double tol : {1e-6, 1e-8, 1e-9, 1e-10}) {
            SCOPED_TRACE(::testing::Message() << "mesh " << n << ", tol " << tol);
            const MeshPlan plan(Mesh(mesh, target, source, 1), WarpScheme::automatic, tol);
            const test::Findings found =
                test::examine(plan, [&](double x, double y) { return truth(plan.mesh(), x, y); });
            EXPECT_LE(found.worst_excess, 0);
            EXPECT_LE(found.worst_exact_bound, tol);
        }
    }
}

TEST(MeshPlan, HoldsTheToleranceOnHardMeshes) {
    const Size target{300, 200}, source{320, 240};
    for (const auto& [name, mesh] : test::hard_meshes(target, source)) {
        SCOPED_TRACE(name);
        for (const WarpScheme scheme : kSchemes)
            for (const double tol : kTols)
                for (const double amount : {1.0, -1.5})
                    expect_promise(mesh, target, source, scheme, tol, amount);
    }
}

TEST(MeshPlan, ManyCells) {
    constexpr unsigned kSeed = 5302;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    const Size target{640, 400}, source{640, 400};
    const ControlMesh mesh = test::random_mesh(random, target, source, 1000, 1000, 0.3, false, 0);
    for (const WarpScheme scheme : kSchemes) expect_promise(mesh, target, source, scheme, 1.0 / 16);
}

TEST(MeshPlan, TolZeroIsExact) {
    test::Random random(5303);
    const Size target{200, 100}, source{220, 90};
    const ControlMesh mesh = test::random_mesh(random, target, source, 4, 3, 0.3, false, 2);
    for (const WarpScheme scheme : kSchemes) expect_promise(mesh, target, source, scheme, 0, 1, true);
}

TEST(MeshPlan, MostPixelsNeedNoExactPoints) {
    test::Random random(5304);
    const Size target{1024, 1024}, source{1024, 1024};
    const ControlMesh mesh = test::random_mesh(random, target, source, 12, 12, 0.2, false, 0);
    for (const WarpScheme scheme : {WarpScheme::automatic, WarpScheme::hermite, WarpScheme::residual}) {
        const MeshPlan plan(Mesh(mesh, target, source, 1), scheme, 1.0 / 16);
        const Reached reached = plan.reached(serial_for);
        EXPECT_EQ(reached.exact_fraction, 0) << static_cast<int>(scheme);
        EXPECT_GT(reached.max_error, 0);
        EXPECT_LE(reached.max_error, 1.0 / 16);
    }
}

TEST(MeshPlan, BoundsAreNotFarAboveTheError) {
    test::Random random(5305);
    const Size target{512, 512}, source{512, 512};
    const ControlMesh mesh = test::random_mesh(random, target, source, 5, 5, 0.3, false, 0);
    const auto median_ratio = [&](WarpScheme scheme, double tol) {
        const MeshPlan plan(Mesh(mesh, target, source, 1), scheme, tol);
        std::vector<double> ratios =
            test::examine(plan, [&](double x, double y) { return truth(plan.mesh(), x, y); }).ratios;
        EXPECT_FALSE(ratios.empty());
        std::nth_element(ratios.begin(), ratios.begin() + long(ratios.size() / 2), ratios.end());
        return ratios[ratios.size() / 2];
    };
    // Quadratics err by what they leave out, whole patches by rounding only, whose worst case is rare.
    EXPECT_LT(median_ratio(WarpScheme::automatic, 1), 2);
    EXPECT_LT(median_ratio(WarpScheme::hermite, 1), 8);
}

TEST(MeshPlan, EveryInstructionSetKeepsTheBound) {
    constexpr unsigned kSeed = 5307;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    const Size target{300, 200}, source{65536, 200};
    const ControlMesh mesh = test::random_mesh(random, target, source, 3, 3, 0.3, false, 1);
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        SCOPED_TRACE(*set);
        ASSERT_TRUE(simd::use_instruction_set(*set));
        for (const double tol : {1.0, 1.0 / 64})
            expect_promise(mesh, target, source, WarpScheme::automatic, tol);
    }
    simd::use_instruction_set("");
}

// Whole patches need not be cut: a tolerance a thousand times smaller costs no more blocks.
TEST(MeshPlan, SmallTolerancesNeedNoSmallBlocks) {
    test::Random random(5306);
    const Size size{512, 512};
    const ControlMesh mesh = test::random_mesh(random, size, size, 5, 5, 0.3, false, 0);
    const auto blocks = [&](double tol) {
        const MeshPlan plan(Mesh(mesh, size, size, 1), WarpScheme::automatic, tol);
        std::size_t count = 0;
        for (std::int64_t r = 0; r < plan.regions(); ++r) count += plan.blocks(r).size();
        return count;
    };
    EXPECT_EQ(blocks(1), blocks(1e-3));
}

TEST(MeshPlan, RefusesATolerance) {
    const ControlMesh mesh = test::identity_mesh({10, 10}, 1, 1);
    for (const double tol : {-1.0, std::nan(""), HUGE_VAL})
        EXPECT_THROW(MeshPlan(Mesh(mesh, {10, 10}, {10, 10}, 1), WarpScheme::automatic, tol), Error);
}

TEST(MeshPlan, FoldsWhereTheMapTurnsOver) {
    const Size size{300, 200};
    ControlMesh mesh = test::identity_mesh(size, 3, 2);
    const MeshPlan plain(Mesh(mesh, size, size, 1), WarpScheme::automatic, 0.1);
    EXPECT_EQ(plain.folded_pixels({0, 0, 300, 200}), 0);
    // Mirrored as a whole is not folded.
    for (Point<double>& p : mesh.vertices) p.x = 300 - p.x;
    const MeshPlan mirrored(Mesh(mesh, size, size, 1), WarpScheme::automatic, 0.1);
    EXPECT_EQ(mirrored.folded_pixels({0, 0, 300, 200}), 0);
    // Columns 1 and 2 change places: between them x runs backwards.
    mesh = test::identity_mesh(size, 3, 2);
    for (std::size_t r = 0; r < 3; ++r) std::swap(mesh.vertices[4 * r + 1], mesh.vertices[4 * r + 2]);
    const MeshPlan folded(Mesh(mesh, size, size, 1), WarpScheme::automatic, 0.1);
    EXPECT_EQ(folded.folds(150, 100), 1);
    EXPECT_EQ(folded.folds(10, 100), 0);
    std::int64_t count = 0;
    for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 300; ++x) count += folded.folds(x + 0.5, y + 0.5) != 0;
    EXPECT_EQ(folded.folded_pixels({0, 0, 300, 200}), count);
    // There x' = 50 - 900 s + 900 s^2 is negative from s = 0.059 to 0.941: 88 pixels of 100.
    EXPECT_EQ(count, 88 * 200);
}

}  // namespace
}  // namespace anamorph::test_mesh_plan
