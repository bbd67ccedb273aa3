// SPDX-License-Identifier: Apache-2.0
// The mesh's map: through its vertices, linear where they are, smooth and without cracks at every edge.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>

#include "anamorph/error.h"
#include "anamorph/mesh/mesh.h"
#include "mesh_cases.h"

namespace anamorph::test_mesh {
namespace {

using J = Jet1<double>;

std::vector<MeshCell> cells_of(const Mesh& mesh) {
    std::vector<MeshCell> cells;
    mesh.each_cell(-1e9, -1e9, 1e9, 1e9, [&](const MeshCell& c) { cells.push_back(c); });
    return cells;
}

std::string message_of(const std::function<void()>& body) {
    try {
        body();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(Mesh, BasisIsExactAtTheEnds) {
    const auto a = hermite_basis(0.0), b = hermite_basis(1.0);
    EXPECT_EQ(a, (std::array<double, 4>{1, 0, 0, 0}));
    EXPECT_EQ(b, (std::array<double, 4>{0, 1, 0, 0}));
}

TEST(Mesh, GoesThroughItsVertices) {
    constexpr unsigned kSeed = 521;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    const Size from{300, 200}, to{500, 450};
    const ControlMesh given = test::random_mesh(random, from, to, 6, 4, 0.5, false, 0);
    const Mesh mesh(given, from, to, 1);
    for (int r = 0; r <= 4; ++r)
        for (int c = 0; c <= 6; ++c) {
            const Point<double> p = mesh.at(50.0 * c, 50.0 * r),
                                v = given.vertices[static_cast<std::size_t>(r * 7 + c)];
            EXPECT_NEAR(p.x, v.x, 1e-11);
            EXPECT_NEAR(p.y, v.y, 1e-11);
        }
}

TEST(Mesh, DerivativesAreCatmullRoms) {
    // Eq. 5.8 at an inner vertex of cells of 50 pixels.
    test::Random random(522);
    const Size from{300, 200}, to{300, 200};
    const ControlMesh given = test::random_mesh(random, from, to, 6, 4, 0.5, false, 0);
    const Mesh mesh(given, from, to, 1);
    const auto v = [&](int c, int r) { return given.vertices[static_cast<std::size_t>(r * 7 + c)]; };
    using J2 = Jet2<double>;
    const Point<J2> p =
        mesh.at(mesh.patch(mesh.cell_at(125, 125)), J2::variable(100, 1, 0), J2::variable(100, 0, 1));
    EXPECT_NEAR(p.x.at(1, 0) * 50, (v(3, 2).x - v(1, 2).x) / 2, 1e-11);
    EXPECT_NEAR(p.x.at(0, 1) * 50, (v(2, 3).x - v(2, 1).x) / 2, 1e-11);
    EXPECT_NEAR(p.y.at(1, 1) * 2500, (v(3, 3).y - v(1, 3).y - v(3, 1).y + v(1, 1).y) / 4, 1e-11);
}

TEST(Mesh, LinearMapsStayLinear) {
    // On even and uneven lines, outside the lines, and on finer levels.
    const Size from{300, 200}, to{300, 200};
    test::Random random(523);
    for (const bool uneven : {false, true}) {
        ControlMesh given = test::random_mesh(random, from, to, 5, 4, 0, uneven, 3);
        const auto linear = [](double x, double y) {
            return Point<double>{20 + 0.7 * x - 0.2 * y, -9 + 0.3 * x + 1.1 * y};
        };
        const auto line = [&](const std::vector<double>& lines, int i, int cells, int size) {
            return lines.empty() ? double(size) * i / cells : lines[static_cast<std::size_t>(i)];
        };
        for (int r = 0; r <= 4; ++r)
            for (int c = 0; c <= 5; ++c)
                given.vertices[static_cast<std::size_t>(r * 6 + c)] =
                    linear(line(given.x_lines, c, 5, 300), line(given.y_lines, r, 4, 200));
        for (ControlMesh::Level& level : given.levels) level.vertices.clear();
        const Mesh mesh(given, from, to, 1);
        for (int n = 0; n < 500; ++n) {
            const double x = random.between(0, 300), y = random.between(0, 200);
            const Point<double> p = mesh.at(x, y), q = linear(x, y);
            EXPECT_NEAR(p.x, q.x, 1e-9);
            EXPECT_NEAR(p.y, q.y, 1e-9);
        }
    }
}

TEST(Mesh, AmountBlends) {
    test::Random random(524);
    const Size from{300, 200}, to{360, 150};
    const ControlMesh given = test::random_mesh(random, from, to, 5, 4, 0.4, true, 2);
    const Mesh none(given, from, to, 0), half(given, from, to, 0.5), full(given, from, to, 1),
        twice(given, from, to, 2);
    for (int n = 0; n < 300; ++n) {
        const double x = random.between(0, 300), y = random.between(0, 200);
        const Point<double> a = none.at(x, y), b = full.at(x, y);
        EXPECT_EQ(a.x, x * 1.2);
        EXPECT_EQ(a.y, y * 0.75);
        EXPECT_NEAR(half.at(x, y).x, 0.5 * (a.x + b.x), 1e-10);
        EXPECT_NEAR(twice.at(x, y).y, 2 * b.y - a.y, 1e-10);
    }
}

// Along every edge of every cell: the map there is one, whichever side is asked, to the bit; a cell's own
// patch agrees with its neighbour's of the same level to the bit, and with a coarser one's to rounding; so do
// slopes.
void expect_no_cracks(const Mesh& mesh, test::Random& random) {
    const std::vector<MeshCell> cells = cells_of(mesh);
    int compared = 0, across_levels = 0;
    for (const MeshCell& cell : cells) {
        const Patch patch = mesh.patch(cell);
        for (int n = 0; n < 8; ++n) {
            const double part = n == 0 ? 0 : n == 1 ? 1 : n == 2 ? 0.5 : random.between(0, 1);
            for (const bool vertical : {true, false}) {
                // The left and the upper edge; every inner edge is one of these for some cell.
                if (vertical ? cell.column == 0 : cell.row == 0) continue;
                const double x = vertical ? cell.x0 : cell.x0 + (cell.x1 - cell.x0) * part;
                const double y = vertical ? cell.y0 + (cell.y1 - cell.y0) * part : cell.y0;
                const MeshCell other = mesh.leaf_at(x, y, vertical, !vertical);
                const Point<double> own = mesh.at(patch, x, y), across = mesh.at(mesh.patch(other), x, y);
                const bool corner = part == 0 || part == 1;
                ++compared;
                if (other.level == cell.level) {
                    EXPECT_EQ(own.x, across.x);
                    EXPECT_EQ(own.y, across.y);
                } else if (!corner) {
                    ++across_levels;
                    EXPECT_EQ(std::abs(other.level - cell.level), 1);
                    EXPECT_NEAR(own.x, across.x, 1e-10);
                    EXPECT_NEAR(own.y, across.y, 1e-10);
                    // What is drawn there is the coarser cell's, from either side.
                    const Point<double> drawn = mesh.at(x, y);
                    const Point<double>& coarse = other.level < cell.level ? across : own;
                    EXPECT_EQ(drawn.x, coarse.x);
                    EXPECT_EQ(drawn.y, coarse.y);
                }
                // C1.
                const Point<J> a = mesh.at(patch, J::variable(x, 1, 0), J::variable(y, 0, 1));
                const Point<J> b = mesh.at(mesh.patch(other), J::variable(x, 1, 0), J::variable(y, 0, 1));
                for (int k = 1; k <= 2; ++k) {
                    EXPECT_NEAR(a.x.c[k], b.x.c[k], 1e-10);
                    EXPECT_NEAR(a.y.c[k], b.y.c[k], 1e-10);
                }
            }
        }
    }
    EXPECT_GT(compared, 0);
    if (cells.size() > static_cast<std::size_t>(mesh.columns() * mesh.rows())) {
        EXPECT_GT(across_levels, 0);
    }
}

TEST(Mesh, HasNoCracksAndNoKinks) {
    constexpr unsigned kSeed = 525;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    const Size from{300, 200}, to{300, 200};
    for (int n = 0; n < 12; ++n) {
        SCOPED_TRACE(n);
        const ControlMesh given = test::random_mesh(random, from, to, random.whole(1, 7), random.whole(2, 6),
                                                    0.5, n % 2 == 1, n % 6);
        expect_no_cracks(Mesh(given, from, to, 1), random);
    }
}

TEST(Mesh, CellsCoverTheImageOnce) {
    test::Random random(526);
    const Size from{300, 200}, to{300, 200};
    const ControlMesh given = test::random_mesh(random, from, to, 6, 5, 0.2, false, 5);
    const Mesh mesh(given, from, to, 1);
    double area = 0;
    int finest = 0;
    for (const MeshCell& c : cells_of(mesh)) {
        area += (c.x1 - c.x0) * (c.y1 - c.y0);
        finest = std::max(finest, c.level);
        const MeshCell found = mesh.leaf_at(c.x0, c.y0);
        EXPECT_EQ(found.level, c.level);
        EXPECT_EQ(found.column, c.column);
        EXPECT_EQ(found.row, c.row);
    }
    EXPECT_NEAR(area, 300.0 * 200, 1e-7);
    EXPECT_EQ(finest, 5);
}

TEST(Mesh, FinerVerticesAreMet) {
    // One cell of 2 x 2 cut, and its neighbours with it, so that all vertices inside are real.
    const Size size{64, 64};
    ControlMesh given = test::identity_mesh(size, 2, 2);
    given.levels.push_back({{{0, 0}, {1, 0}, {0, 1}, {1, 1}}, {{1, 1, {20, 11}}, {2, 1, {37, 18}}}});
    const Mesh mesh(given, size, size, 1);
    EXPECT_NEAR(mesh.at(16, 16).x, 20, 1e-12);
    EXPECT_NEAR(mesh.at(16, 16).y, 11, 1e-12);
    EXPECT_NEAR(mesh.at(32, 16).x, 37, 1e-12);
    // With only the left cells cut, (2, 1) is a T-vertex: the coarser edge's.
    given.levels[0].cells = {{0, 0}, {0, 1}};
    const Mesh half(given, size, size, 1);
    EXPECT_NEAR(half.at(16, 16).x, 20, 1e-12);
    EXPECT_NEAR(half.at(32, 16).x, 32, 1e-12);
}

TEST(Mesh, RefusesWhatIsNoMesh) {
    const Size size{64, 64};
    const ControlMesh good = test::identity_mesh(size, 3, 2);
    const auto refused = [&](const ControlMesh& mesh, double amount = 1) {
        const std::string message = message_of([&] { Mesh(mesh, size, size, amount, "grid.json"); });
        EXPECT_EQ(message.find('\n'), std::string::npos);
        return message;
    };
    EXPECT_EQ(refused(good), "");
    ControlMesh bad = good;
    bad.vertices[6].y = std::nan("");
    EXPECT_NE(refused(bad).find("grid.json: vertex [2, 1]"), std::string::npos) << refused(bad);
    bad.vertices[6].y = HUGE_VAL;
    EXPECT_NE(refused(bad).find("vertex [2, 1]"), std::string::npos);
    bad = good;
    bad.vertices.pop_back();
    EXPECT_NE(refused(bad).find("must be 4 x 3"), std::string::npos) << refused(bad);
    bad = good;
    bad.columns = 0;
    EXPECT_NE(refused(bad).find("columns"), std::string::npos);
    bad = good;
    bad.x_lines = {0, 20, 20, 64};
    EXPECT_NE(refused(bad).find("x[2]"), std::string::npos) << refused(bad);
    bad.x_lines = {0, 20};
    EXPECT_NE(refused(bad).find("2 lines"), std::string::npos);
    bad = good;
    bad.levels.push_back({{{3, 0}}, {}});
    EXPECT_NE(refused(bad).find("levels[0].cells"), std::string::npos);
    bad.levels[0] = {{{0, 0}}, {{7, 0, {1, 1}}}};
    EXPECT_NE(refused(bad).find("levels[0].vertices[0]"), std::string::npos);
    bad.levels[0] = {{{0, 0}}, {{1, 1, {std::nan(""), 1}}}};
    EXPECT_NE(refused(bad).find("levels[0].vertices[0]"), std::string::npos);
    EXPECT_NE(refused(good, std::nan("")).find("amount"), std::string::npos);
    EXPECT_NE(refused(good, HUGE_VAL).find("amount"), std::string::npos);
}

}  // namespace
}  // namespace anamorph::test_mesh
