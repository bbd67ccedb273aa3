// SPDX-License-Identifier: Apache-2.0
// The derivatives of a displacement on grids and at points, and the normals that they turn: held against long
// double, the same bits on all instruction sets, for any order, number of threads and neighbours.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

#include "anamorph/deform/deformed_surface.h"
#include "anamorph/image/block_sampler.h"
#include "each_instruction_set.h"

namespace anamorph::test_deform_slopes {
namespace {

/// Derivatives by u and by v; `count`: how often the point was given.
struct Given {
    std::array<double, 6> by{};
    int count = 0;

    bool operator==(const Given&) const = default;
};

/// All that a surface gives.
template <class Surface>
std::vector<Given> given(const Surface& surface, std::size_t points, const std::vector<Deformation>& list,
                         const std::vector<DeformationChange>* changes = nullptr,
                         const ParallelFor& parallel_for = serial_for) {
    std::vector<Given> result(points);
    std::mutex guard;
    const auto take = [&](const SurfaceSlopes& slopes) {
        const std::lock_guard<std::mutex> lock(guard);
        EXPECT_LE(slopes.count, SurfaceSlopes::kMost);
        for (int k = 0; k < slopes.count; ++k) {
            Given& to = result.at(static_cast<std::size_t>(slopes.point(k)));
            ++to.count;
            for (std::size_t c = 0; c < 6; ++c) to.by[c] = slopes.by[c][k];
        }
    };
    surface.slopes(list, changes, take, parallel_for);
    return result;
}

/// All that points give when they are written in the same pass.
std::vector<Given> given_and_written(DeformedPoints& surface, std::size_t points,
                                     const std::vector<Deformation>& list, const ParallelFor& parallel_for,
                                     std::vector<double>& out, std::vector<double>& displacement) {
    std::vector<Given> result(points);
    std::mutex guard;
    const std::vector<double> base(3 * points, 0.7);
    out.assign(3 * points, -1);
    displacement.assign(3 * points, -1);
    const auto take = [&](const SurfaceSlopes& slopes) {
        const std::lock_guard<std::mutex> lock(guard);
        for (int k = 0; k < slopes.count; ++k) {
            Given& to = result.at(static_cast<std::size_t>(slopes.point(k)));
            ++to.count;
            for (std::size_t c = 0; c < 6; ++c) to.by[c] = slopes.by[c][k];
        }
    };
    surface.write_with_slopes(list, base.data(), out.data(), take, parallel_for, displacement.data());
    return result;
}

std::vector<Deformation> bumps(unsigned seed, std::size_t count, double least_extent, double most_extent) {
    std::mt19937 random(seed);
    const auto number = [&](double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(random);
    };
    std::vector<Deformation> list(count);
    for (std::size_t k = 0; k < count; ++k) {
        list[k].vector = {number(-.1, .1), number(-.1, .1), number(-.4, .4)};
        list[k].center = {number(-.2, 1.2), number(-.2, 1.2)};
        list[k].extent = {number(least_extent, most_extent), number(least_extent, most_extent)};
        if (k % 3 == 0) list[k].kernel = DeformationKernel::wendland_c2;
    }
    return list;
}

std::vector<double> even(int count) {
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back((i + 0.5) / count);
    return values;
}

std::vector<glm::dvec2> grid_points(const std::vector<double>& u, const std::vector<double>& v) {
    std::vector<glm::dvec2> points;
    for (const double y : v)
        for (const double x : u) points.push_back({x, y});
    return points;
}

/// dF/du and dF/dv, written out.
std::array<long double, 2> kernel_slopes(const Deformation& d, glm::dvec2 p) {
    const long double a = d.extent.x, b = d.extent.y, x = (p.x - static_cast<long double>(d.center.x)) / a,
                      y = (p.y - static_cast<long double>(d.center.y)) / b, r = std::sqrt(x * x + y * y);
    if (d.kernel == DeformationKernel::gaussian) {
        const long double f = std::exp(-x * x - y * y);
        return {-2 * x / a * f, -2 * y / b * f};
    }
    // d/dr (1 - r)^4 (4 r + 1) = -20 r (1 - r)^3, and dr/dx = x / r.
    const long double f = r < 1 ? -20 * (1 - r) * (1 - r) * (1 - r) : 0;
    return {f * x / a, f * y / b};
}

ParallelFor threads(std::int64_t count) {
    return [count](std::int64_t turns, const std::function<void(std::int64_t)>& body) {
        std::vector<std::thread> pool;
        for (std::int64_t t = 0; t < count; ++t)
            pool.emplace_back([=, &body] {
                for (std::int64_t i = turns - 1 - t; i >= 0; i -= count) body(i);
            });
        for (std::thread& thread : pool) thread.join();
    };
}

TEST(SurfaceSlopes, AreTheDerivativesOnEveryInstructionSetToTheBit) {
    std::vector<Deformation> list = bumps(3, 150, .01, .4);
    const std::vector<double> u = even(133), v = even(37);
    const std::vector<glm::dvec2> points = grid_points(u, v);
    // Centres on points, and points on the border of a compact kernel.
    for (std::size_t k = 0; k < 6; ++k) list[k].center = {u[20 * k], v[5 * k]};
    list[0].extent = {u[30] - u[0], .3};
    list[5].enabled = false;
    const DeformOptions options{0, 0x1p-40};
    std::vector<Given> first;
    test::on_every_instruction_set([&] {
        const std::vector<Given> grid = given(DeformedGrid(u, v, options), points.size(), list);
        EXPECT_EQ(grid, given(DeformedPoints(points, options), points.size(), list));
        if (first.empty()) first = grid;
        EXPECT_EQ(grid, first);
    });
    for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_EQ(first[i].count, 1);
        for (std::size_t c = 0; c < 3; ++c) {
            long double exact[2] = {}, scale[2] = {};
            for (const Deformation& d : list) {
                if (!d.enabled) continue;
                const double vector = d.vector[static_cast<int>(c)];
                for (std::size_t way = 0; way < 2; ++way) {
                    exact[way] += vector * kernel_slopes(d, points[i])[way];
                    scale[way] += std::fabs(vector) / (way == 0 ? d.extent.x : d.extent.y);
                }
            }
            // A slope changes with t by up to 20 V / a, and t errs by 2.5 2^-53 of itself; 150 sums.
            for (std::size_t way = 0; way < 2; ++way)
                ASSERT_LE(std::fabs(first[i].by[3 * way + c] - exact[way]), 200 * 0x1p-53L * scale[way]);
        }
    }
}

TEST(SurfaceSlopes, SameBitsForAnyOrderNeighboursAndThreads) {
    std::vector<Deformation> list = bumps(4, 90, .02, .3);
    const std::vector<double> u = even(171), v = even(45);
    const std::vector<glm::dvec2> points = grid_points(u, v);
    const std::vector<Given> all = given(DeformedGrid(u, v), points.size(), list);
    std::reverse(list.begin(), list.end());
    EXPECT_EQ(given(DeformedGrid(u, v), points.size(), list, nullptr, threads(3)), all);
    EXPECT_EQ(given(DeformedPoints(points), points.size(), list, nullptr, threads(3)), all);
    // A piece, as points and as a grid.
    const std::vector<glm::dvec2> piece(points.begin() + 171 * 7 + 50, points.begin() + 171 * 9 + 13);
    const std::vector<Given> of_piece = given(DeformedPoints(piece), piece.size(), list);
    EXPECT_TRUE(std::equal(of_piece.begin(), of_piece.end(), all.begin() + 171 * 7 + 50));
    const std::vector<double> some(u.begin() + 33, u.begin() + 60), row{v[20]};
    const std::vector<Given> of_row = given(DeformedGrid(some, row), some.size(), list);
    EXPECT_TRUE(std::equal(of_row.begin(), of_row.end(), all.begin() + 171 * 20 + 33));
}

TEST(SurfaceSlopes, OfAnEditAreThoseOfThePointsItReaches) {
    const std::vector<double> u = even(300), v = even(200);
    const std::vector<glm::dvec2> points = grid_points(u, v);
    std::vector<Deformation> list = bumps(5, 30, .05, .3);
    const Deformation here{{0, 0, .1}, {.3, .4}, {.004, .003}}, there{{0, .1, .1}, {.8, .1}, {.004, .005}};
    list.push_back(there);
    const std::vector<DeformationChange> changes{{here, there}};
    const double reach = DisplacementSum({}).reach(here.kernel);
    const auto check = [&](const auto& surface, std::ptrdiff_t most) {
        const std::vector<Given> all = given(surface, points.size(), list),
                                 edited = given(surface, points.size(), list, &changes);
        std::ptrdiff_t count = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            bool is_reached = false;
            for (const Deformation& d : {here, there}) {
                const glm::dvec2 t = (points[i] - d.center) / d.extent;
                is_reached = is_reached || (std::fabs(t.x) <= reach && std::fabs(t.y) <= reach);
            }
            if (is_reached) {
                ASSERT_EQ(edited[i].count, 1) << i;
            }
            if (edited[i].count == 0) continue;
            ASSERT_EQ(edited[i], all[i]) << i;
            ++count;
        }
        EXPECT_GT(count, 50);
        EXPECT_LE(count, most);
    };
    check(DeformedGrid(u, v), 400);
    check(DeformedPoints(points), 3000);
    const std::vector<DeformationChange> none;
    for (const Given& g : given(DeformedGrid(u, v), points.size(), list, &none)) EXPECT_EQ(g.count, 0);
    for (const Given& g : given(DeformedPoints(points), points.size(), list, &none)) EXPECT_EQ(g.count, 0);
}

TEST(SurfaceSlopes, WrittenWithPointsAreTheSameBits) {
    const std::vector<glm::dvec2> points = grid_points(even(171), even(45));
    const std::vector<Deformation> list = bumps(11, 90, .02, .3), others = bumps(12, 40, .02, .3);
    DeformedPoints apart(points);
    apart.apply(difference({}, list));
    const std::vector<double> base(3 * points.size(), 0.7);
    std::vector<double> out(base.size()), displacement(base.size());
    apart.write(base.data(), out.data(), serial_for, displacement.data());
    const std::vector<Given> slopes = given(apart, points.size(), list);
    test::on_every_instruction_set([&] {
        DeformedPoints together(points);
        // What was drawn or taken before leaves no trace.
        std::vector<double> out_together = out, displacement_together;
        together.apply(difference({}, others));
        together.write(base.data(), out_together.data());
        together.apply(DeformationChange{others[3], others[4]});
        EXPECT_EQ(
            given_and_written(together, points.size(), list, threads(3), out_together, displacement_together),
            slopes);
        EXPECT_EQ(out_together, out);
        EXPECT_EQ(displacement_together, displacement);
        EXPECT_EQ(together.error_bound(), apart.error_bound());
        // Edits go on from there.
        together.apply(DeformationChange{list[0], std::nullopt});
        together.update(base.data(), out_together.data());
        DeformedPoints fresh(points);
        fresh.apply(difference({}, std::vector<Deformation>(list.begin() + 1, list.end())));
        std::vector<double> out_fresh(base.size());
        fresh.write(base.data(), out_fresh.data());
        EXPECT_EQ(out_together, out_fresh);
    });
}

TEST(SurfaceSlopes, HardListsAndPoints) {
    std::vector<Deformation> list;
    for (const double extent : {1e-30, 1e30, 1e-300, 1e300})
        for (const DeformationKernel kernel : {DeformationKernel::gaussian, DeformationKernel::wendland_c2})
            list.push_back({{.1, .2, .3}, {.5, .5}, {extent, extent}, kernel});
    list.push_back({{1, 1, 1}, {1e300, -1e300}, {1e-5, 1}});
    // Thousands of points in one place: more than are given at once.
    std::vector<glm::dvec2> points(3000, glm::dvec2(.25, .75));
    for (int i = 0; i < 300; ++i) points.push_back({i / 299., .5});
    for (const double cutoff : {0., 1e-7}) {
        const std::vector<Given> all = given(DeformedPoints(points, {cutoff, 0x1p-40}), points.size(), list);
        for (const Given& g : all) {
            EXPECT_EQ(g.count, 1);
            for (const double by : g.by) EXPECT_TRUE(std::isfinite(by));
        }
        std::vector<double> u;
        for (int i = 0; i < 300; ++i) u.push_back(i / 299.);
        EXPECT_TRUE(std::equal(all.begin() + 3000, all.end(),
                               given(DeformedGrid(u, {.5}, {cutoff, 0x1p-40}), u.size(), list).begin()));
    }
}

TEST(TurnedNormals, AreThoseOfMovedTangents) {
    using Vector = glm::vec<3, long double>;
    std::mt19937 random(9);
    const auto number = [&] { return std::normal_distribution<double>()(random); };
    const glm::dvec3 g(.3, -1.2, .4), h(2, .1, -.7);
    double by[6][SurfaceSlopes::kMost];
    double start[3][SurfaceSlopes::kMost];
    for (int k = 0; k < SurfaceSlopes::kMost; ++k) {
        for (int c = 0; c < 6; ++c) by[c][k] = number();
        for (int c = 0; c < 3; ++c) start[c][k] = number() * std::pow(10, k % 7 - 3);
    }
    for (int c = 0; c < 3; ++c) start[c][5] = 0;
    start[1][6] = std::numeric_limits<double>::quiet_NaN();
    start[2][7] = std::numeric_limits<double>::infinity();
    const SurfaceSlopes slopes{251, 0, nullptr, by};
    double first[3][SurfaceSlopes::kMost], normals[3][SurfaceSlopes::kMost];
    bool is_first = true;
    test::on_every_instruction_set([&] {
        std::copy(&start[0][0], &start[0][0] + 3 * SurfaceSlopes::kMost, &normals[0][0]);
        turn_normals(slopes, g, h, normals);
        if (is_first) std::copy(&normals[0][0], &normals[0][0] + 3 * SurfaceSlopes::kMost, &first[0][0]);
        is_first = false;
        for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::equal(normals[c], normals[c] + 251, first[c]));
    });
    for (int k = 0; k < 251; ++k) {
        const glm::dvec3 turned(first[0][k], first[1][k], first[2][k]);
        if (k >= 5 && k <= 7) {
            EXPECT_EQ(turned, glm::dvec3(0));
            continue;
        }
        // Two tangents of the surface, and where the displacement takes them.
        const Vector n(start[0][k], start[1][k], start[2][k]);
        const Vector s = glm::cross(Vector(1, 2, 3), n), t = glm::cross(n, s);
        const auto moved = [&](const Vector& tangent) {
            return tangent + glm::dot(Vector(g), tangent) * Vector(slopes.by_u(k)) +
                   glm::dot(Vector(h), tangent) * Vector(slopes.by_v(k));
        };
        EXPECT_LE(glm::distance(Vector(turned), glm::normalize(glm::cross(moved(s), moved(t)))), 1e-13L) << k;
    }
}

}  // namespace
}  // namespace anamorph::test_deform_slopes
