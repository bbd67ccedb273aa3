// SPDX-License-Identifier: Apache-2.0
// Cubics that stand for warps in windows: their errors, and what is said of boxes, against the warps at points.
#include "anamorph/mesh/window_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "anamorph/mesh/mesh_windows.h"
#include "anamorph/mesh/st_windows.h"
#include "mesh_cases.h"

namespace anamorph::test_window_map {
namespace {

constexpr unsigned kSeed = 7101;
constexpr Size kTarget{300, 280}, kSource{500, 330};

/// A bent picture with uneven cells or samples.
Point<double> bent(double s, double t, double bend) {
    return {0.03 + 0.9 * s + bend * (0.05 * std::sin(5 * t) + 0.02 * std::cos(7 * s)),
            0.02 + 0.93 * t + bend * (0.03 * std::sin(6 * s) - 0.05 * s * t)};
}

/// `spikes`: how far one vertex in ten is moved, in pixels.
MeshWindows mesh_windows(test::Random& random, int columns, int rows, double bend, double noise,
                         double spikes = 0) {
    ControlMesh mesh;
    mesh.columns = columns, mesh.rows = rows;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const Point<double> p = bent(double(i) / columns, double(j) / rows, bend);
            const double spike = random.whole(0, 9) == 0 ? spikes : 0;
            mesh.vertices.push_back({p.x * kSource.width + random.between(-noise, noise) + spike,
                                     p.y * kSource.height + random.between(-noise, noise)});
        }
    return MeshWindows(std::make_shared<const Mesh>(mesh, kTarget, kSource, 1));
}
/// `stripes`: how far every other two columns are moved, in pixels.
StWindows st_windows(test::Random& random, double bend, double noise_x, double noise_y, double stripes = 0) {
    StSamples samples;
    for (int j = 0; j < kTarget.height; ++j)
        for (int i = 0; i < kTarget.width; ++i) {
            const Point<double> p = bent((i + 0.5) / kTarget.width, (j + 0.5) / kTarget.height, bend);
            samples.uv.push_back(static_cast<float>(
                p.x + (random.between(-noise_x, noise_x) + (i / 2 % 2) * stripes) / kSource.width));
            samples.uv.push_back(
                static_cast<float>(p.y + random.between(-noise_y, noise_y) / kSource.height));
        }
    samples.most = 2;
    return StWindows(
        std::make_shared<const StLattice>(std::make_shared<const StSamples>(samples), kTarget, kSource, 1));
}

double distance(const Point<double>& a, const Point<double>& b) {
    return std::hypot(a.x - b.x, a.y - b.y);
}
Point<double> point_of(const WindowSource& source, double x, double y) {
    Point<double> p{};
    EXPECT_TRUE(source.exact(x, y, p));
    return p;
}

/// How far cubics of random windows are off at most, and what they say, in sums over all windows.
struct Sums {
    double off = 0, said = 0;
    int windows = 0;
};
/// `grid`: what their corners are multiples of.
void check_windows(const WindowSource& source, test::Random& random, Sums& sums, int grid = 1) {
    for (const int side : {20, 36, 68, 132, 260}) {
        const int x = grid * random.whole(0, (kTarget.width - side) / grid),
                  y = grid * random.whole(0, (kTarget.height - side) / grid);
        const WindowCubic cubic = source.cubic_over({x, y, x + side, y + side}, 1e6);
        if (!cubic.serves()) continue;
        double worst = 0;
        for (int n = 0; n < 400; ++n) {
            const double px = random.between(cubic.x.lo, cubic.x.hi),
                         py = random.between(cubic.y.lo, cubic.y.hi);
            worst = std::max(worst, distance(cubic(px, py), point_of(source, px, py)));
        }
        ASSERT_LE(worst, cubic.error) << side << " at " << x << ", " << y;
        sums.off += worst, sums.said += cubic.error, ++sums.windows;
    }
}

/// What moves within a box, and where its points lie.
void check_boxes(const WindowSource& source, test::Random& random) {
    for (int n = 0; n < 60; ++n) {
        const double size = n % 3 ? random.between(0, 3) : 0, off = random.between(0, 0.3);
        const double x0 = random.between(0, kTarget.width - size),
                     y0 = random.between(0, kTarget.height - size);
        const Interval x(x0 - off, x0 + size + off), y(y0 - off, y0 + size + off);
        const double bound = source.exact_error(x, y, off);
        const auto all = source.points_of(x, y);
        ASSERT_LT(bound, 400 * off + 1e-6);
        ASSERT_TRUE(all);
        for (int k = 0; k < 40; ++k) {
            const double px = random.between(x0, x0 + size), py = random.between(y0, y0 + size),
                         angle = random.between(0, 7);
            const Point<double> p = point_of(source, px, py),
                                moved =
                                    point_of(source, px + off * std::cos(angle), py + off * std::sin(angle));
            ASSERT_LE(distance(p, moved), bound);
            for (const Point<double>& at : {p, moved}) {
                ASSERT_TRUE(all->x.contains(at.x)) << at.x;
                ASSERT_TRUE(all->y.contains(at.y)) << at.y;
            }
        }
    }
}

TEST(WindowMap, CubicsOfMeshesAreOffByNoMoreThanTheySay) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    Sums sums;
    for (const int cells : {5, 12, 40})
        for (const double noise : {0.0, 0.02, 3.0}) {
            const MeshWindows windows = mesh_windows(random, cells, cells, 1, noise);
            check_windows(windows, random, sums);
            check_boxes(windows, random);
        }
    // Of 20 and of 260 pixels these are windows of whole cells.
    for (int n = 0; n < 4; ++n)
        check_windows(mesh_windows(random, kTarget.width / 10, kTarget.height / 10, 1, 0.1), random, sums,
                      10);
    // Beside a vertex that is moved, only slopes are wrong.
    for (int n = 0; n < 40; ++n)
        check_windows(mesh_windows(random, kTarget.width / 10, kTarget.height / 10, 0, 0, 20), random, sums,
                      10);
    EXPECT_GT(sums.windows, 60);
    EXPECT_LT(sums.said, 4 * sums.off);
}

TEST(WindowMap, CubicsOfStMapsAreOffByNoMoreThanTheySay) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    Sums sums;
    for (const double bend : {0.2, 1.0})
        for (const auto& [noise_x, noise_y] : {std::pair{0.0, 0.0}, {0.01, 0.01}, {1.0, 0.0}, {0.0, 1.0}}) {
            const StWindows windows = st_windows(random, bend, noise_x, noise_y);
            check_windows(windows, random, sums);
            check_boxes(windows, random);
        }
    // Between two that are moved alike the map goes beyond both.
    check_boxes(st_windows(random, 0, 0, 0, 5), random);
    EXPECT_GT(sums.windows, 25);
    EXPECT_LT(sums.said, 4 * sums.off);
}

}  // namespace
}  // namespace anamorph::test_window_map
