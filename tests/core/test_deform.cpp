// SPDX-License-Identifier: Apache-2.0
// Surfaces deformed by lists of bumps: the kernels and their derivatives, the distance from eq. (4.1), the
// same bits for any order, history, number of threads and cut into pieces, and refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <random>
#include <thread>

#include "anamorph/deform/deformation.h"
#include "anamorph/deform/deformed_surface.h"
#include "anamorph/image/block_sampler.h"

namespace anamorph::test_deform {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

class Random {
  public:
    explicit Random(unsigned seed) : m_engine(seed) {}
    double number(double least, double most) {
        return least + (most - least) * std::uniform_real_distribution<double>()(m_engine);
    }
    std::size_t index(std::size_t count) {
        return std::uniform_int_distribution<std::size_t>(0, count - 1)(m_engine);
    }
    Deformation deformation(double least_extent, double most_extent) {
        Deformation d;
        d.vector = {number(-.1, .1), number(-.1, .1), number(-.4, .4)};
        d.center = {number(-.2, 1.2), number(-.2, 1.2)};
        d.extent = {number(least_extent, most_extent), number(least_extent, most_extent)};
        if (index(3) == 0) d.kernel = DeformationKernel::wendland_c2;
        return d;
    }
    std::vector<Deformation> list(std::size_t count, double least_extent, double most_extent) {
        std::vector<Deformation> entries;
        for (std::size_t i = 0; i < count; ++i) entries.push_back(deformation(least_extent, most_extent));
        return entries;
    }
    template <class List>
    void shuffle(List& list) {
        std::shuffle(list.begin(), list.end(), m_engine);
    }

  private:
    std::mt19937 m_engine;
};

std::vector<double> even(int count) {
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back((i + 0.5) / count);
    return values;
}

template <class T>
std::vector<T> plane(const std::vector<double>& u, const std::vector<double>& v) {
    std::vector<T> points;
    for (const double y : v)
        for (const double x : u) points.insert(points.end(), {T(x), T(y), T(0.25)});
    return points;
}

std::vector<glm::dvec2> parameters(const std::vector<double>& u, const std::vector<double>& v) {
    std::vector<glm::dvec2> points;
    for (const double y : v)
        for (const double x : u) points.push_back({x, y});
    return points;
}

/// Eq. (4.1) in long double, with no cutoff.
std::vector<long double> truth(const std::vector<Deformation>& list, const std::vector<glm::dvec2>& points) {
    std::vector<long double> sums(3 * points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        for (const Deformation& d : list) {
            if (!d.enabled) continue;
            const long double x = (points[i].x - static_cast<long double>(d.center.x)) / d.extent.x,
                              y = (points[i].y - static_cast<long double>(d.center.y)) / d.extent.y;
            const long double f = kernel_value(d.kernel, x, y);
            for (int c = 0; c < 3; ++c) sums[3 * i + static_cast<std::size_t>(c)] += d.vector[c] * f;
        }
    return sums;
}

double largest_error(const std::vector<double>& values, const std::vector<long double>& exact) {
    long double most = 0;
    for (std::size_t i = 0; i < values.size(); ++i) most = std::max(most, std::fabs(values[i] - exact[i]));
    return static_cast<double>(most);
}

std::vector<DeformationChange> additions(const std::vector<Deformation>& list) {
    return difference({}, list);
}

/// Many threads, each of which takes every n-th turn, backwards.
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

std::string fault_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no fault";
}

// --- Kernels

TEST(DeformKernel, ValuesOfThePaperAndOfWendland) {
    const auto gaussian = [](double x, double y) { return kernel_value(DeformationKernel::gaussian, x, y); };
    EXPECT_EQ(gaussian(0, 0), 1);
    EXPECT_NEAR(gaussian(1, 0), std::exp(-1.0), 1e-16);
    EXPECT_NEAR(gaussian(-1, 2), std::exp(-5.0), 1e-17);
    const auto wendland = [](double x, double y) {
        return kernel_value(DeformationKernel::wendland_c2, x, y);
    };
    EXPECT_EQ(wendland(0, 0), 1);
    EXPECT_NEAR(wendland(.3, -.4), std::pow(.5, 4) * 3, 1e-16);
    EXPECT_EQ(wendland(.6, .8), 0);
    EXPECT_EQ(wendland(3, 4), 0);
}

TEST(DeformKernel, JetsAreTheDerivatives) {
    const unsigned seed = 11;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    for (int i = 0; i < 2000; ++i) {
        Deformation d = random.deformation(.1, .5);
        const double u = random.number(-.2, 1.2), v = random.number(-.2, 1.2);
        using J = Jet2<double>;
        const J f = influence(d, J::variable(u, 1, 0), J::variable(v, 0, 1));
        // Central differences in long double: step^2 against the third and fourth derivatives.
        const long double h = 1e-5L;
        const auto at = [&](long double x, long double y) {
            return kernel_value(d.kernel, (u + x - d.center.x) / static_cast<long double>(d.extent.x),
                                (v + y - d.center.y) / static_cast<long double>(d.extent.y));
        };
        EXPECT_NEAR(f.value(), static_cast<double>(at(0, 0)), 1e-15);
        EXPECT_NEAR(f.at(1, 0), static_cast<double>((at(h, 0) - at(-h, 0)) / (2 * h)), 2e-5);
        EXPECT_NEAR(f.at(0, 1), static_cast<double>((at(0, h) - at(0, -h)) / (2 * h)), 2e-5);
        EXPECT_NEAR(2 * f.at(2, 0), static_cast<double>((at(h, 0) - 2 * at(0, 0) + at(-h, 0)) / (h * h)), 1.);
        EXPECT_NEAR(f.at(1, 1),
                    static_cast<double>((at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (4 * h * h)), 1.);
    }
    // At the centre and across the border of a compact kernel the second derivatives are continuous.
    using J = Jet2<double>;
    const auto wendland = [](double x) {
        return kernel_value(DeformationKernel::wendland_c2, J::variable(x, 1, 0), J::variable(0, 0, 1));
    };
    EXPECT_EQ(wendland(0).at(2, 0), -10);
    EXPECT_NEAR(wendland(1e-9).at(2, 0), -10, 1e-6);
    EXPECT_NEAR(wendland(1 - 1e-9).at(2, 0), 0, 1e-6);
    EXPECT_EQ(wendland(1).at(2, 0), 0);
}

TEST(DeformKernel, NormalsOfABump) {
    Deformation d;
    d.vector = {0, 0, 2};
    d.extent = {2, 3};
    const double u = .7, v = -1.1, f = std::exp(-u * u / 4 - v * v / 9);
    // z = 2 F: the normal is (-z_u, -z_v, 1), and F_u = -2 u / a^2 F.
    const glm::dvec3 normal = normal_of(displacement_at({d}, {u, v}), {1, 0, 0}, {0, 1, 0});
    const double zu = 2 * -2 * u / 4 * f, zv = 2 * -2 * v / 9 * f, length = std::sqrt(zu * zu + zv * zv + 1);
    EXPECT_NEAR(normal.x, -zu / length, 1e-15);
    EXPECT_NEAR(normal.y, -zv / length, 1e-15);
    EXPECT_NEAR(normal.z, 1 / length, 1e-15);
    EXPECT_EQ(normal_of({}, {1, 0, 0}, {2, 0, 0}), glm::dvec3(0));
}

TEST(DeformKernel, NormalsOfManyPoints) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        std::vector<Deformation> list = random.list(50, .02, .3);
        list[7].enabled = false;
        const std::vector<glm::dvec2> points = parameters(even(61), even(23));
        const std::vector<glm::dvec3> base_u{{1, 0, 0}}, base_v{{0, 1, 0}};
        const DeformOptions options;
        std::vector<glm::dvec3> normals(points.size()), again(points.size());
        deformed_normals(list, points, base_u, base_v, options, normals.data());
        for (std::size_t i = 0; i < points.size(); ++i) {
            // 50 derivatives without up to 2 * 4.1 * 1e-7 * 0.42 / 0.02 each; a length near 0 magnifies that.
            const DisplacementJet d = displacement_at(list, points[i]);
            const double length = glm::length(glm::cross(base_u[0] + d.by_u, base_v[0] + d.by_v));
            const double slope = 2 + glm::length(d.by_u) + glm::length(d.by_v);
            ASSERT_LE(glm::distance(normals[i], normal_of(d, base_u[0], base_v[0])), 1e-3 * slope / length);
        }
        deformed_normals(list, points, base_u, base_v, {0, 0x1p-40}, again.data());
        for (std::size_t i = 0; i < points.size(); ++i)
            ASSERT_LE(
                glm::distance(again[i], normal_of(displacement_at(list, points[i]), base_u[0], base_v[0])),
                1e-11);
        random.shuffle(list);
        const std::vector<glm::dvec3> every_u(points.size(), base_u[0]);
        deformed_normals(list, points, every_u, base_v, options, again.data(), threads(3));
        EXPECT_EQ(again, normals);
        const std::span<const glm::dvec2> piece = std::span(points).subspan(101, 300);
        deformed_normals(list, piece, base_u, base_v, options, again.data());
        EXPECT_TRUE(std::equal(again.begin(), again.begin() + 300, normals.begin() + 101));
        EXPECT_THAT(fault_of([&] { deformed_normals(list, piece, {}, base_v, options, again.data()); }),
                    HasSubstr("base_u=0 vectors"));
        const std::vector<glm::dvec2> bad{{0, kNan}};
        EXPECT_THAT(fault_of([&] { deformed_normals(list, bad, base_u, base_v, options, again.data()); }),
                    HasSubstr("points[0]=nan"));
    }
}

// --- Error

TEST(DeformedSurface, StaysWithinItsErrorBound) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        const std::vector<Deformation> list = random.list(40, .01, seed % 2 ? .1 : .6);
        const std::vector<double> u = even(101), v = even(67);
        const std::vector<glm::dvec2> points = parameters(u, v);
        const std::vector<long double> exact = truth(list, points);
        for (const double cutoff : {1e-3, 1e-7, 1e-12, 0.0})
            for (const double resolution : {0x1p-20, 0x1p-40, 0x1p-48}) {
                SCOPED_TRACE("cutoff " + std::to_string(cutoff));
                const DeformOptions options{cutoff, resolution};
                std::vector<double> grid(3 * points.size(), -1), scattered(3 * points.size(), -1);
                const double bound = deform_grid<double>(list, u, v, options, nullptr, grid.data());
                DeformedPoints surface(points, options);
                surface.apply(additions(list));
                surface.write<double>(nullptr, scattered.data());
                EXPECT_EQ(surface.error_bound(), bound);
                EXPECT_LE(largest_error(grid, exact), bound);
                EXPECT_LE(largest_error(scattered, exact), bound);
                // Sharp, too: cut off at 1e-3, something errs by a tenth of what one bump may.
                if (cutoff == 1e-3) {
                    EXPECT_GE(largest_error(grid, exact), 1e-3 * .4 / 10);
                }
            }
    }
}

/// On every instruction set: within the bound, the same bits, and what cancels cancels.
TEST(DeformedSurface, EveryInstructionSet) {
    Random random(17);
    const std::vector<Deformation> list = random.list(40, .02, .4);
    const std::vector<double> u = even(101), v = even(35);
    const std::vector<glm::dvec2> points = parameters(u, v);
    const std::vector<long double> exact = truth(list, points);
    std::vector<double> first;
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        SCOPED_TRACE(*set);
        ASSERT_TRUE(simd::use_instruction_set(*set));
        std::vector<double> grid_out(3 * points.size()), points_out(grid_out.size());
        DeformedGrid grid(u, v);
        DeformedPoints scattered(points);
        grid.apply(additions(list));
        scattered.apply(additions(list));
        grid.write<double>(nullptr, grid_out.data());
        scattered.write<double>(nullptr, points_out.data());
        EXPECT_LE(largest_error(grid_out, exact), grid.error_bound());
        EXPECT_LE(largest_error(points_out, exact), grid.error_bound());
        if (first.empty()) first = grid_out;
        EXPECT_EQ(grid_out, first);
        EXPECT_EQ(points_out, first);
        grid.apply(difference(list, {}));
        scattered.apply(difference(list, {}));
        grid.update<double>(nullptr, grid_out.data());
        scattered.update<double>(nullptr, points_out.data());
        EXPECT_EQ(grid_out, std::vector<double>(grid_out.size()));
        EXPECT_EQ(points_out, std::vector<double>(points_out.size()));
    }
    simd::use_instruction_set("");
}

TEST(DeformedSurface, RoundsOnceToFloat) {
    Random random(5);
    const std::vector<Deformation> list = random.list(30, .05, .3);
    const std::vector<double> u = even(75), v = even(41);
    const std::vector<float> base = plane<float>(u, v);
    std::vector<float> out(base.size());
    std::vector<double> displacement(base.size());
    deform_grid(list, u, v, {}, base.data(), out.data());
    deform_grid<double>(list, u, v, {}, nullptr, displacement.data());
    for (std::size_t i = 0; i < out.size(); ++i)
        ASSERT_EQ(out[i], static_cast<float>(static_cast<double>(base[i]) + displacement[i])) << i;
}

// --- The same bits

TEST(DeformedSurface, OrderThreadsAndPiecesDoNotMatter) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        std::vector<Deformation> list = random.list(60, .02, .5);
        const std::vector<double> u = even(131), v = even(77);
        const std::vector<float> base = plane<float>(u, v);
        std::vector<float> expected(base.size()), out(base.size());
        deform_grid(list, u, v, {}, base.data(), expected.data());

        random.shuffle(list);
        for (const std::int64_t count : {1, 2, 7}) {
            std::fill(out.begin(), out.end(), -1.f);
            DeformedGrid grid(u, v);
            for (const Deformation& d : list) grid.apply({std::nullopt, d});
            grid.write(base.data(), out.data(), threads(count));
            EXPECT_EQ(out, expected);
            std::fill(out.begin(), out.end(), -1.f);
            deform_grid(list, u, v, {}, base.data(), out.data(), threads(count));
            EXPECT_EQ(out, expected);
        }

        // A piece of the surface, from any column and row on.
        const std::size_t column = random.index(100), row = random.index(60);
        const std::vector<double> part_u(u.begin() + static_cast<std::ptrdiff_t>(column), u.end()),
            part_v(v.begin() + static_cast<std::ptrdiff_t>(row), v.end());
        std::vector<float> part_base = plane<float>(part_u, part_v), part(part_base.size());
        deform_grid(list, part_u, part_v, {}, part_base.data(), part.data());
        for (std::size_t j = 0; j < part_v.size(); ++j)
            for (std::size_t i = 0; i < 3 * part_u.size(); ++i)
                ASSERT_EQ(part[j * 3 * part_u.size() + i],
                          expected[(j + row) * 3 * u.size() + 3 * column + i]);
    }
}

TEST(DeformedSurface, PointsDoNotDependOnOrderThreadsAndPieces) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        std::vector<Deformation> list = random.list(60, .02, .5);
        std::vector<glm::dvec2> points;
        for (int i = 0; i < 5000; ++i)
            points.push_back({random.number(0, 1), std::pow(random.number(0, 1), 4)});
        const std::vector<double> base(3 * points.size(), .125);
        std::vector<double> expected(base.size());
        DeformedPoints all(points);
        all.apply(additions(list));
        all.write(base.data(), expected.data());
        random.shuffle(list);
        DeformedPoints again(points);
        std::vector<double> out(base.size());
        for (const Deformation& d : list) {
            again.apply({std::nullopt, d});
            again.update(base.data(), out.data(), threads(3));
        }
        again.write(base.data(), out.data(), threads(5));
        EXPECT_EQ(out, expected);
        // A third of the points, in another order.
        std::vector<std::size_t> which(points.size());
        std::iota(which.begin(), which.end(), std::size_t{0});
        random.shuffle(which);
        which.resize(points.size() / 3);
        std::vector<glm::dvec2> some;
        for (const std::size_t i : which) some.push_back(points[i]);
        DeformedPoints piece(some);
        piece.apply(additions(list));
        piece.write(base.data(), out.data());
        for (std::size_t i = 0; i < which.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(out[3 * i + c], expected[3 * which[i] + c]);
    }
}

/// Random edits of a list: whatever they were, the surface is that of the list at the end.
TEST(DeformedSurface, GridsAndPointsAgreeToTheBit) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Random random(seed);
        std::vector<Deformation> list = random.list(60, .02, .5);
        for (std::size_t k = 0; k < list.size(); k += 2) list[k].kernel = DeformationKernel::wendland_c2;
        const std::vector<double> u = even(131), v = even(77);
        std::vector<glm::dvec2> points;
        for (const double y : v)
            for (const double x : u) points.push_back({x, y});
        const std::vector<double> base = plane<double>(u, v);
        std::vector<double> grid(base.size()), moved(base.size()), scattered(base.size()),
            scattered_moved(base.size());
        DeformedGrid on_grid(u, v);
        DeformedPoints on_points(points);
        on_grid.write(base.data(), grid.data(), serial_for, moved.data());
        on_points.write(base.data(), scattered.data(), serial_for, scattered_moved.data());
        EXPECT_EQ(grid, base);
        for (const Deformation& d : list) {
            const DeformationChange change{std::nullopt, d};
            on_grid.apply(change);
            on_points.apply(change);
            on_grid.update(base.data(), grid.data(), threads(2), moved.data());
            on_points.update(base.data(), scattered.data(), threads(3), scattered_moved.data());
        }
        EXPECT_EQ(grid, scattered);
        EXPECT_EQ(moved, scattered_moved);
        on_grid.write<double>(nullptr, grid.data());
        EXPECT_EQ(grid, moved);
    }
}

TEST(DeformedSurface, LargeSumsOnGridsAreThoseOfPoints) {
    // Sums from below 2^51 resolutions to beyond 2^53, of either sign.
    const DeformOptions options{1e-7, 1};
    const std::vector<double> u = even(70), v = even(9);
    std::vector<glm::dvec2> points;
    for (const double y : v)
        for (const double x : u) points.push_back({x, y});
    for (const double sign : {1.0, -1.0}) {
        Random random(31);
        std::vector<Deformation> list;
        double most = 0;
        for (int k = 0; k < 40; ++k) {
            list.push_back(random.deformation(.3, .9));
            list.back().vector = sign * glm::dvec3(1e15, 1.1e15 - k, 2e13 * k);
            std::vector<double> grid(3 * points.size()), scattered(grid);
            deform_grid<double>(list, u, v, options, nullptr, grid.data());
            DeformedPoints on_points(points, options);
            on_points.apply(additions(list));
            on_points.write<double>(nullptr, scattered.data());
            ASSERT_EQ(grid, scattered) << k;
            for (const double x : grid) most = std::max(most, std::fabs(x));
        }
        EXPECT_GT(most, 0x1p53);
    }
}

/// Large surfaces are written past the caches: their bits are those of strips, which are not, wherever the
/// points lie in memory, and nothing beside them is touched.
template <class T>
void expect_that_large_surfaces_are_their_strips(int columns, int rows, std::size_t offset) {
    SCOPED_TRACE(std::to_string(columns) + "x" + std::to_string(rows) + ", offset " + std::to_string(offset));
    Random random(23);
    std::vector<Deformation> list = random.list(4, .05, .3);
    const std::vector<double> u = even(columns), v = even(rows);
    const std::vector<T> base = plane<T>(u, v);
    const std::size_t count = base.size();
    const auto expected = [&] {
        std::vector<T> out(count);
        const int strip = rows / 8;
        for (int row = 0; row < rows; row += strip) {
            const std::size_t first = 3 * u.size() * static_cast<std::size_t>(row);
            const auto part = std::span(v).subspan(static_cast<std::size_t>(row),
                                                   static_cast<std::size_t>(std::min(strip, rows - row)));
            deform_grid<T>(list, u, part, {}, base.data() + first, out.data() + first);
        }
        return out;
    };
    std::vector<T> room(count + 2 * offset + 32, T(-7)), moved(count);
    T* const out = room.data() + 8 + offset;
    DeformedGrid grid(u, v);
    grid.apply(additions(list));
    grid.write(base.data(), out, threads(2));
    EXPECT_TRUE(std::equal(out, out + count, expected().begin()));
    const Deformation before = list[1];
    list[1] = random.deformation(.1, .2);
    grid.apply({before, list[1]});
    grid.update(base.data(), out, threads(2), moved.data());
    EXPECT_TRUE(std::equal(out, out + count, expected().begin()));
    grid.write<T>(nullptr, out, threads(2));
    EXPECT_TRUE(std::all_of(room.data(), out, [](T x) { return x == T(-7); }));
    EXPECT_TRUE(std::all_of(out + count, room.data() + room.size(), [](T x) { return x == T(-7); }));
    deform_grid(list, u, v, {}, base.data(), out);
    EXPECT_TRUE(std::equal(out, out + count, expected().begin()));
}
TEST(DeformedSurface, LargeSurfacesAreTheirStrips) {
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        SCOPED_TRACE(*set);
        ASSERT_TRUE(simd::use_instruction_set(*set));
        expect_that_large_surfaces_are_their_strips<float>(900, 750, 0);
        expect_that_large_surfaces_are_their_strips<float>(901, 750, 1);
        expect_that_large_surfaces_are_their_strips<double>(700, 500, 0);
        expect_that_large_surfaces_are_their_strips<double>(701, 500, 1);
    }
    simd::use_instruction_set("");
}

TEST(DeformedSurface, AHundredThousandEditsLeaveNoTrace) {
    const unsigned seed = 3;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const std::vector<double> u = even(37), v = even(23);
    const std::vector<double> base = plane<double>(u, v);
    const std::vector<glm::dvec2> points = parameters(u, v);
    std::vector<double> grid_out = base, points_out = base;
    DeformedGrid grid(u, v);
    DeformedPoints scattered(points);
    DeformationList list;
    const auto apply = [&](const DeformationChange& change) {
        grid.apply(change);
        scattered.apply(change);
    };
    for (int edit = 0; edit < 100000; ++edit) {
        const std::size_t count = list.entries().size(), kind = random.index(6);
        if (count < 5 || (kind == 0 && count < 50)) {
            apply(list.insert(random.index(count + 1), random.deformation(.02, .3)));
        } else {
            const std::size_t at = random.index(count);
            if (kind == 1)
                apply(list.remove(at));
            else if (kind == 2)
                list.move(at, random.index(count));
            else if (kind == 3)
                apply(list.enable(at, !list.entries()[at].enabled));
            else if (kind == 4) {
                const DeformationChange change = list.remove(at);
                apply(change);
                apply(change.undo());
                apply(change);
            } else
                apply(list.change(at, random.deformation(.02, .3)));
        }
        // Some edits one by one, some together.
        if (random.index(4) == 0) {
            grid.update(base.data(), grid_out.data());
            scattered.update(base.data(), points_out.data());
        }
    }
    grid.update(base.data(), grid_out.data());
    scattered.update(base.data(), points_out.data());
    std::vector<double> expected(base.size());
    const double bound = deform_grid(list.entries(), u, v, {}, base.data(), expected.data());
    EXPECT_EQ(grid_out, expected);
    EXPECT_EQ(grid.error_bound(), bound);
    DeformedPoints fresh(points);
    fresh.apply(additions(list.entries()));
    fresh.write(base.data(), expected.data());
    EXPECT_EQ(points_out, expected);

    while (!list.entries().empty()) apply(list.remove(random.index(list.entries().size())));
    grid.update(base.data(), grid_out.data());
    scattered.update(base.data(), points_out.data());
    EXPECT_EQ(grid_out, base);
    EXPECT_EQ(points_out, base);
    EXPECT_EQ(grid.error_bound(), 0);
}

TEST(DeformedSurface, OnlyWhatAnEditReachesIsWritten) {
    const std::vector<double> u = even(200), v = even(100);
    const std::vector<float> base = plane<float>(u, v);
    std::vector<float> out(base.size(), 7.f);
    DeformedGrid grid(u, v);
    EXPECT_TRUE(grid.update(base.data(), out.data()).empty());
    Deformation d;
    d.vector = {0, 0, 1};
    d.center = {.5, .5};
    d.extent = {.02, .02};
    grid.apply({std::nullopt, d});
    const GridPart part = grid.update(base.data(), out.data());
    // 4.02 extents are 16.1 columns and 8.1 rows each way.
    EXPECT_LE(part.column_begin, 84);
    EXPECT_GE(part.column_end, 116);
    EXPECT_LE(part.row_begin, 42);
    EXPECT_GE(part.row_end, 58);
    EXPECT_LE((part.column_end - part.column_begin) * (part.row_end - part.row_begin), 96 * 20);
    for (std::size_t j = 0; j < v.size(); ++j)
        for (std::size_t i = 0; i < u.size(); ++i) {
            const bool inside = static_cast<int>(i) >= part.column_begin &&
                                static_cast<int>(i) < part.column_end &&
                                static_cast<int>(j) >= part.row_begin && static_cast<int>(j) < part.row_end;
            ASSERT_EQ(out[3 * (j * u.size() + i)] != 7.f, inside) << i << ", " << j;
        }
    // What another bump far away does is seen nowhere here.
    d.center = {40, 40};
    grid.apply({std::nullopt, d});
    EXPECT_TRUE(grid.update(base.data(), out.data()).empty());
    EXPECT_TRUE(grid.update(base.data(), out.data()).empty());

    DeformedPoints points(parameters(u, v));
    points.apply({std::nullopt, d});
    EXPECT_EQ(points.update(base.data(), out.data()), 0);
    d.center = {.5, .5};
    points.apply({std::nullopt, d});
    const std::int64_t written = points.update(base.data(), out.data());
    EXPECT_GE(written, 32 * 16);
    EXPECT_LE(written, 6000);
}

// --- Lists

TEST(DeformationList, EditsSayWhatTheyDo) {
    Deformation a, b;
    a.vector = {1, 0, 0};
    b.vector = {0, 1, 0};
    DeformationList list;
    const DeformationChange added = list.add(a);
    EXPECT_FALSE(added.before);
    EXPECT_EQ(added.after, a);
    list.insert(0, b);
    EXPECT_EQ(list.entries(), (std::vector<Deformation>{b, a}));
    list.move(0, 1);
    EXPECT_EQ(list.entries(), (std::vector<Deformation>{a, b}));
    const DeformationChange off = list.enable(0, false);
    EXPECT_EQ(off.before, a);
    EXPECT_FALSE(off.after);
    EXPECT_FALSE(list.enable(0, false).before);
    EXPECT_FALSE(list.remove(0).before);
    EXPECT_EQ(list.change(0, a).before, b);
    EXPECT_EQ(list.remove(0).undo().after, a);
    EXPECT_THAT(fault_of([&] { list.remove(0); }), HasSubstr("position=0: the list is empty"));
    list.add(a);
    EXPECT_THAT(fault_of([&] { list.move(0, 1); }), HasSubstr("position=1"));
}

TEST(DeformationList, DifferencesLeadFromOneSurfaceToAnother) {
    const unsigned seed = 21;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    std::vector<Deformation> from = random.list(20, .1, .3), to = from;
    from.push_back(from[3]);  // twice the same
    to[4].enabled = false;
    to[5].vector *= 2;
    to[6].vector = glm::dvec3(0);
    to.push_back(random.deformation(.1, .3));
    random.shuffle(to);
    const std::vector<DeformationChange> changes = difference(from, to);
    EXPECT_EQ(changes.size(), 1u + 1u + 2u + 1u + 1u);
    const std::vector<double> u = even(40);
    std::vector<double> expected(3 * 1600), out(3 * 1600);
    deform_grid<double>(to, u, u, {}, nullptr, expected.data());
    DeformedGrid grid(u, u);
    grid.apply(additions(from));
    grid.write<double>(nullptr, out.data());
    EXPECT_NE(out, expected);
    grid.apply(changes);
    grid.update<double>(nullptr, out.data());
    EXPECT_EQ(out, expected);
}

// --- Hard cases and refusals

TEST(DeformedSurface, HardCases) {
    const std::vector<double> u = even(64), v = even(3);
    std::vector<double> out(3 * 64 * 3);
    const auto draw = [&](const Deformation& d, double cutoff = 1e-7) {
        deform_grid<double>({d}, u, v, {cutoff, 0x1p-40}, nullptr, out.data());
        std::vector<double> scattered(out.size());
        DeformedPoints points(parameters(u, v), {cutoff, 0x1p-40});
        points.apply({std::nullopt, d});
        points.write<double>(nullptr, scattered.data());
        for (std::size_t i = 0; i < out.size(); ++i) EXPECT_NEAR(out[i], scattered[i], 0x1p-39);
    };
    for (const auto kernel : {DeformationKernel::gaussian, DeformationKernel::wendland_c2}) {
        Deformation d;
        d.kernel = kernel;
        d.vector = {1, -2, 1000};
        d.center = {u[5], v[1]};
        for (const double extent : {1e-300, 1e-30}) {  // one point alone
            d.extent = {extent, extent};
            draw(d);
            for (std::size_t i = 0; i < 64 * 3; ++i)
                ASSERT_EQ(out[3 * i + 2], i == 64 + 5 ? 1000 : 0) << i << " " << extent;
        }
        for (const double extent : {1e30, 1e300}) {  // all points alike
            d.extent = {extent, extent};
            draw(d);
            for (std::size_t i = 0; i < 64 * 3; ++i) ASSERT_EQ(out[3 * i + 1], -2) << i << " " << extent;
        }
        d.extent = {.1, .1};
        d.center = {1e308, -1e308};
        draw(d);
        EXPECT_EQ(std::count(out.begin(), out.end(), 0.0), static_cast<std::ptrdiff_t>(out.size()));
        draw(d, 0);
        EXPECT_EQ(std::count(out.begin(), out.end(), 0.0), static_cast<std::ptrdiff_t>(out.size()));
    }
}

TEST(DeformedSurface, AHundredThousandBumps) {
    const unsigned seed = 77;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    std::vector<Deformation> list = random.list(100000, .001, .01);
    list.resize(100010);
    for (std::size_t i = 100000; i < list.size(); ++i) list[i] = random.deformation(.3, .6);
    const std::vector<double> u = even(13), v = even(7);
    const std::vector<glm::dvec2> points = parameters(u, v);
    std::vector<double> grid(3 * points.size()), scattered(grid.size());
    const double bound = deform_grid<double>(list, u, v, {}, nullptr, grid.data());
    DeformedPoints surface(points);
    surface.apply(additions(list));
    surface.write<double>(nullptr, scattered.data(), threads(2));
    const std::vector<long double> exact = truth(list, points);
    EXPECT_LE(largest_error(grid, exact), bound);
    EXPECT_LE(largest_error(scattered, exact), bound);
}

/// More factors than fit into the tables at once.
TEST(DeformedSurface, ManyWideBumpsOnAFineGrid) {
    const unsigned seed = 78;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const std::vector<Deformation> list = random.list(3000, .5, .9);
    const std::vector<double> u = even(2000), v = even(5);
    std::vector<float> base = plane<float>(u, v), expected(base.size()), out(base.size());
    deform_grid(list, u, v, {}, base.data(), expected.data());
    DeformedGrid grid(u, v);
    const std::vector<DeformationChange> changes = additions(list);
    for (std::size_t i = 0; i < changes.size(); i += 100) {
        grid.apply(std::span(changes).subspan(i, std::min<std::size_t>(100, changes.size() - i)));
        grid.update(base.data(), out.data());
    }
    EXPECT_EQ(out, expected);
}

TEST(DeformedSurface, WhatIsRefused) {
    const auto refused = [](const std::function<void(Deformation&)>& set, const std::string& parameter,
                            const std::string& value) {
        Deformation d;
        d.vector = {0, 0, 1};
        set(d);
        const auto is_named = AllOf(HasSubstr(parameter + "=" + value), Not(HasSubstr("\n")));
        DeformationList list;
        EXPECT_THAT(fault_of([&] { list.add(d); }), is_named);
        EXPECT_TRUE(list.entries().empty());
        DeformedGrid grid({0.0}, {0.0});
        EXPECT_THAT(fault_of([&] { grid.apply({std::nullopt, d}); }), is_named);
        EXPECT_EQ(grid.error_bound(), 0);
    };
    for (const double bad : {kNan, kInf, -kInf}) {
        const std::string text = std::isnan(bad) ? "nan" : bad < 0 ? "-inf" : "inf";
        for (int c = 0; c < 3; ++c) refused([&](Deformation& d) { d.vector[c] = bad; }, "vector", text);
        for (int c = 0; c < 2; ++c) {
            refused([&](Deformation& d) { d.center[c] = bad; }, "center", text);
            refused([&](Deformation& d) { d.extent[c] = bad; }, "extent", text);
        }
        EXPECT_THAT(fault_of([&] { DeformedGrid({0, bad}, {0}); }), HasSubstr("u[1]=" + text));
        EXPECT_THAT(fault_of([&] { DeformedGrid({0}, {bad}); }), HasSubstr("v[0]=" + text));
        const std::vector<glm::dvec2> points{{0, 1}, {0, bad}};
        EXPECT_THAT(fault_of([&] { DeformedPoints surface(points); }), HasSubstr("points[1]=" + text));
        EXPECT_THAT(fault_of([&] { DisplacementSum({bad, 1}); }), HasSubstr("cutoff=" + text));
        EXPECT_THAT(fault_of([&] { DisplacementSum({1e-7, bad}); }), HasSubstr("resolution=" + text));
    }
    refused([](Deformation& d) { d.extent.x = 0; }, "extent", "0");
    refused([](Deformation& d) { d.extent.y = -1; }, "extent", "-1");
    refused([](Deformation& d) { d.extent.y = 1e-310; }, "extent", "1e-310");
    EXPECT_THAT(fault_of([] { DeformedGrid({}, {0.0}); }), HasSubstr("u=0 values"));
    const std::vector<double> many(std::size_t{1} << 21);
    EXPECT_THAT(fault_of([&] { DeformedGrid(many, many); }), HasSubstr("2097152x2097152 points"));
    EXPECT_THAT(fault_of([] { DisplacementSum({1, 1}); }), HasSubstr("cutoff=1"));
    EXPECT_THAT(fault_of([] { DisplacementSum({1e-7, 3}); }), HasSubstr("resolution=3"));
    DeformedPoints none(std::span<const glm::dvec2>{});
    none.write<float>(nullptr, nullptr);
}

TEST(DeformedSurface, RangeOfFixedPoint) {
    DisplacementSum sum(DeformOptions{});
    Deformation d;
    d.vector = {0, 1024, 0};
    const auto add = [&](DisplacementSum& to, double v) {
        d.vector.y = v;
        const DeformationChange change{std::nullopt, d};
        to.apply(std::span(&change, 1));
    };
    EXPECT_THAT(fault_of([&] { add(sum, 1024); }),
                AllOf(HasSubstr("vector=1024"), HasSubstr("resolution"), HasSubstr("below 1024")));
    EXPECT_THAT(fault_of([&] { add(sum, 1e300); }), HasSubstr("vector=1e+300"));
    // 2^22 in all: 4096 times nearly 2^10.
    for (int i = 0; i < 4096; ++i) add(sum, 1023.9 * (i % 2 ? 1 : -1));
    EXPECT_THAT(fault_of([&] { add(sum, 1000); }), AllOf(HasSubstr("vector=1000"), HasSubstr("together")));
    DisplacementSum coarse({1e-7, 1});
    add(coarse, 1e15);
    EXPECT_GE(coarse.error_bound(), 1e8);
}

}  // namespace
}  // namespace anamorph::test_deform
