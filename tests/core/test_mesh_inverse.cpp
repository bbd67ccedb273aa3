// SPDX-License-Identifier: Apache-2.0
// Meshes that push: the inverse is one, its blocks hold their bounds, and folds are found.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "anamorph/mesh/inverse.h"
#include "mesh_cases.h"
#include "warp_findings.h"

namespace anamorph::test_mesh_inverse {
namespace {

constexpr double kTols[] = {1, 1.0 / 4, 1.0 / 16, 1.0 / 64, 0.01};

/// Every pixel: blocks within their bounds of the exact point, and that one a source point of the pixel.
test::Findings expect_promise(const ControlMesh& given, const Size& source, const Size& target, double tol,
                              double amount = 1) {
    SCOPED_TRACE(::testing::Message() << "tol " << tol << ", amount " << amount);
    const InversePlan plan(Mesh(given, source, target, amount), WarpScheme::automatic, tol, "mesh");
    int lost = 0, unseen_folds = 0;
    double worst_return = 0;
    const test::Findings found = test::examine(plan, [&](double x, double y) {
        Point<double> p{};
        int piece = 0;
        lost += !plan.exact(x, y, 0, p, piece);
        const Point<double> back = plan.mesh().at(p.x, p.y);
        worst_return = std::max(worst_return, std::hypot(back.x - x, back.y - y));
        return Point<long double>{p.x, p.y};
    });
    EXPECT_LE(found.worst_excess, 0);
    EXPECT_LE(found.worst_bound, tol);
    EXPECT_EQ(found.overlaps, 0);
    EXPECT_EQ(found.pixels, std::int64_t{target.width} * target.height);
    // What is proven to be one to one, or nothing, is.
    for (std::int64_t r = 0; r < plan.regions(); ++r)
        for (const Block& block : plan.blocks(r))
            for (int y = block.box.y0; y < block.box.y1; ++y)
                for (int x = block.box.x0; x < block.box.x1; ++x) {
                    if (block.kind == Block::Kind::exact) continue;
                    const Preimages all = plan.preimages(x + 0.5, y + 0.5);
                    unseen_folds += all.on_fold || all.count != (block.kind == Block::Kind::outside ? 0 : 1);
                }
    EXPECT_EQ(unseen_folds, 0);
    return found;
}

TEST(MeshInverse, HoldsTheToleranceOnRandomMeshes) {
    constexpr unsigned kSeed = 551;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    for (int n = 0; n < 10; ++n) {
        SCOPED_TRACE(n);
        const Size source{random.whole(40, 400), random.whole(40, 400)},
            target{random.whole(40, 400), random.whole(40, 300)};
        // Amplitudes up to where neighbours change places.
        const ControlMesh mesh =
            test::random_mesh(random, source, target, random.whole(1, 9), random.whole(1, 9),
                              random.between(0, 0.7), n % 3 == 0, n % 2 ? 2 : 0);
        for (const double tol : kTols) expect_promise(mesh, source, target, tol);
    }
}

TEST(MeshInverse, HoldsTheToleranceOnHardMeshes) {
    const Size source{160, 120}, target{150, 100};
    for (const auto& [name, mesh] : test::hard_meshes(source, target)) {
        SCOPED_TRACE(name);
        for (const double amount : {1.0, 0.0, -1.5}) expect_promise(mesh, source, target, 1.0 / 16, amount);
    }
}

TEST(MeshInverse, InvertsThePullOfTheSameMesh) {
    // A point pushed by the mesh comes back.
    test::Random random(552);
    const Size source{300, 200}, target{400, 300};
    const ControlMesh given = test::random_mesh(random, source, target, 5, 4, 0.2, false, 1);
    const InversePlan plan(Mesh(given, source, target, 1), WarpScheme::automatic, 0.01, "mesh");
    int compared = 0;
    for (int n = 0; n < 2000; ++n) {
        const double x = random.between(0, 300), y = random.between(0, 200);
        const Point<double> to = plan.mesh().at(x, y);
        if (!(to.x > 0 && to.x < 400 && to.y > 0 && to.y < 300)) continue;
        Point<double> back{};
        int piece = 0;
        ASSERT_TRUE(plan.exact(to.x, to.y, 0, back, piece));
        EXPECT_NEAR(back.x, x, 1e-9);
        EXPECT_NEAR(back.y, y, 1e-9);
        EXPECT_EQ(plan.folds(to.x, to.y), 0);
        ++compared;
        // Derivatives of inverse functions are inverse matrices.
        using J = Jet1<double>;
        const Point<J> f = plan.mesh().at(plan.mesh().patch(plan.mesh().cell_at(x, y)), J::variable(x, 1, 0),
                                          J::variable(y, 0, 1));
        const Jacobian j = plan.jacobian(to.x, to.y, 0);
        EXPECT_NEAR(j.x_i * f.x.c[1] + j.x_j * f.y.c[1], 1, 1e-7);
        EXPECT_NEAR(j.x_i * f.x.c[2] + j.x_j * f.y.c[2], 0, 1e-7);
        EXPECT_NEAR(j.y_i * f.x.c[2] + j.y_j * f.y.c[2], 1, 1e-7);
    }
    EXPECT_GT(compared, 1000);
}

TEST(MeshInverse, FindsAllSourcePointsOfAFold) {
    // x runs 0, 200, 100, 300: between the turns every column has three source points.
    const Size size{300, 60};
    ControlMesh mesh = test::identity_mesh(size, 3, 1);
    for (std::size_t r = 0; r < 2; ++r) std::swap(mesh.vertices[4 * r + 1], mesh.vertices[4 * r + 2]);
    const InversePlan plan(Mesh(mesh, size, size, 1), WarpScheme::automatic, 1.0 / 16, "mesh");
    // In the middle cell x(s) = 200 + 50 s - 450 s^2 + 300 s^3 turns at s = 1/2 -+ sqrt(7/36).
    const auto x_of = [](double s) { return 200 + s * (50 + s * (-450 + s * 300)); };
    const double low = x_of(0.5 + std::sqrt(7.0 / 36)), high = x_of(0.5 - std::sqrt(7.0 / 36));
    std::int64_t folded = 0;
    for (int x = 0; x < 300; ++x) {
        const float expected = x + 0.5 > low && x + 0.5 < high ? 2 : 0;
        if (std::min(std::fabs(x + 0.5 - low), std::fabs(x + 0.5 - high)) < 0.1) continue;
        EXPECT_EQ(plan.folds(x + 0.5, 30.5), expected) << x;
        folded += expected != 0;
    }
    EXPECT_GT(folded, 90);
    EXPECT_NEAR(double(plan.folded_pixels({0, 0, 300, 60})), double(folded) * 60, 2 * 60);
    // Drawn is the sheet that is not turned over and was laid last.
    Point<double> p{};
    int piece = 0;
    ASSERT_TRUE(plan.exact(150.5, 30.5, 0, p, piece));
    EXPECT_GT(p.x, 200);
}

TEST(MeshInverse, NothingWhereTheMeshDoesNotReach) {
    const Size size{200, 100};
    ControlMesh mesh = test::identity_mesh(size, 2, 2);
    for (Point<double>& v : mesh.vertices) v = {50 + v.x / 2, 25 + v.y / 2};
    const InversePlan plan(Mesh(mesh, size, size, 1), WarpScheme::automatic, 1.0 / 16, "mesh");
    Point<double> p{};
    int piece = 0;
    EXPECT_FALSE(plan.exact(49.5, 50, 0, p, piece));
    EXPECT_TRUE(plan.exact(50.5, 50, 0, p, piece));
    EXPECT_NEAR(p.x, 1, 1e-9);
    EXPECT_EQ(plan.folded_pixels({0, 0, 200, 100}), 0);
}

// The mesh ends at the picture's edge, within it, or beyond it: blocks along its edge are polynomials, and hold.
TEST(MeshInverse, TheMeshsEdgeTakesNoExactPoints) {
    constexpr unsigned kSeed = 554;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    const Size size{512, 384};
    for (const double grown : {1.0, 0.7, 1.3}) {
        SCOPED_TRACE(grown);
        test::Random random(kSeed);
        ControlMesh mesh = test::identity_mesh(size, 6, 5);
        for (int r = 0; r <= 5; ++r)
            for (int c = 0; c <= 6; ++c) {
                Point<double>& v = mesh.vertices[static_cast<std::size_t>(r * 7 + c)];
                if (c > 0 && c < 6) v.x += random.between(-8, 8);
                if (r > 0 && r < 5) v.y += random.between(-8, 8);
                v = {256 + grown * (v.x - 256), 192 + grown * (v.y - 192)};
            }
        for (const double tol : {1.0, 0.01}) expect_promise(mesh, size, size, tol);
        const InversePlan plan(Mesh(mesh, size, size, 1), WarpScheme::automatic, 1, "mesh");
        // Within the picture the edge is a line between blocks and pixels without a source.
        if (grown >= 1) {
            EXPECT_EQ(plan.reached(serial_for).exact_fraction, 0);
        }
    }
}

TEST(MeshInverse, LinesBeyondThePictureHold) {
    const Size size{300, 200};
    ControlMesh mesh = test::identity_mesh(size, 8, 6);
    for (int i = 0; i <= 8; ++i) mesh.x_lines.push_back(-150 + 75.0 * i);
    for (int i = 0; i <= 6; ++i) mesh.y_lines.push_back(-100 + 400.0 / 6 * i);
    test::Random random(555);
    for (int r = 0; r <= 6; ++r)
        for (int c = 0; c <= 8; ++c)
            mesh.vertices[static_cast<std::size_t>(r * 9 + c)] = {
                75 + 0.5 * mesh.x_lines[static_cast<std::size_t>(c)] + random.between(-3, 3),
                50 + 0.5 * mesh.y_lines[static_cast<std::size_t>(r)] + random.between(-3, 3)};
    for (const double tol : {1.0, 0.01}) expect_promise(mesh, size, size, tol);
}

TEST(MeshInverse, MostPixelsNeedNoExactPoints) {
    test::Random random(553);
    const Size size{1024, 1024};
    ControlMesh mesh = test::random_mesh(random, size, size, 12, 12, 0.15, false, 0);
    const InversePlan plan(Mesh(mesh, size, size, 1), WarpScheme::automatic, 1.0 / 16, "mesh");
    const Reached reached = plan.reached(serial_for);
    EXPECT_LT(reached.exact_fraction, 0.05);
    EXPECT_LE(reached.max_error, 1.0 / 16);
    EXPECT_EQ(plan.folded_pixels({0, 0, 1024, 1024}), 0);
}

}  // namespace
}  // namespace anamorph::test_mesh_inverse
