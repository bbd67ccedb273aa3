// SPDX-License-Identifier: Apache-2.0
// Bumps that have a depth or a side: displacements and derivatives held against long double written out, the same bits for any history,
// threads and instruction set, and who refuses them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

#include "anamorph/deform/deformed_surface.h"
#include "anamorph/deform/plane_warp.h"
#include "anamorph/error.h"
#include "each_instruction_set.h"

namespace anamorph::test_deform_depth {
namespace {

using ::testing::HasSubstr;
using Real = long double;
using Real3 = std::array<Real, 3>;

class Random {
  public:
    explicit Random(unsigned seed) : m_engine(seed) {}
    double number(double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(m_engine);
    }
    glm::dvec3 unit() {
        glm::dvec3 v;
        do v = {number(-1, 1), number(-1, 1), number(-1, 1)};
        while (glm::length(v) < .1);
        return glm::normalize(v);
    }

  private:
    std::mt19937 m_engine;
};

/// Bumps of every kind about the unit cube.
std::vector<Deformation> bumps(unsigned seed, int count) {
    Random random(seed);
    std::vector<Deformation> list;
    for (int k = 0; k < count; ++k) {
        Deformation d;
        d.vector = random.number(.1, .8) * random.unit();
        d.center = {random.number(0, 1), random.number(0, 1)};
        d.extent = {random.number(.1, .6), random.number(.1, .6)};
        if (k % 2) d.kernel = DeformationKernel::wendland_c2;
        if (k % 3 != 1) {
            d.center_w = random.number(-.5, .5);
            d.extent_w = random.number(.2, .9);
        }
        d.side = static_cast<DeformationSide>(k % 4 == 3 ? 0 : k % 4);
        list.push_back(d);
    }
    return list;
}

/// A cloud of points, some of them without a normal or depth.
struct Cloud {
    std::vector<glm::dvec2> parameters;
    PointDepths depths;
};
Cloud cloud(unsigned seed, int count) {
    Random random(seed);
    Cloud points;
    for (int i = 0; i < count; ++i) {
        points.parameters.push_back({random.number(-.2, 1.2), random.number(-.2, 1.2)});
        points.depths.w.push_back(i % 97 == 5 ? std::numeric_limits<double>::quiet_NaN()
                                              : random.number(-.8, .8));
        points.depths.normal.push_back(i % 89 == 7 ? glm::dvec3(0) : random.unit());
    }
    return points;
}

/// F S at a point, and its derivatives by u, v, w and the normal's coordinates, written out.
struct Share {
    Real value = 0;
    std::array<Real, 6> by{};
};
Share share_of(const Deformation& d, glm::dvec2 p, double w, glm::dvec3 n) {
    Share share;
    const Real a[3] = {d.extent.x, d.extent.y, d.extent_w};
    Real x[3] = {(p.x - Real(d.center.x)) / a[0], (p.y - Real(d.center.y)) / a[1], 0};
    if (d.extent_w != 0) {
        if (!std::isfinite(w)) return share;
        x[2] = (w - Real(d.center_w)) / a[2];
    }
    const Real r = std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    Real f, over_r;  // F, and F' / r
    if (d.kernel == DeformationKernel::gaussian) {
        f = std::exp(-r * r);
        over_r = -2 * f;
    } else {
        const Real rest = r < 1 ? 1 - r : 0;
        f = rest * rest * rest * rest * (1 + 4 * r);
        over_r = -20 * rest * rest * rest;
    }
    Real s = 1, slope = 0;
    Real3 v{};
    if (d.side != DeformationSide::both) {
        const Real length = std::sqrt(Real(d.vector.x) * d.vector.x + Real(d.vector.y) * d.vector.y +
                                      Real(d.vector.z) * d.vector.z),
                   sign = d.side == DeformationSide::front ? 1 : -1;
        for (std::size_t c = 0; c < 3; ++c) v[c] = sign * d.vector[static_cast<int>(c)] / length;
        const Real t = 2 * (v[0] * n.x + v[1] * n.y + v[2] * n.z);
        if (t <= 0)
            s = 0;
        else if (t < 1) {
            s = 3 * t * t - 2 * t * t * t;
            slope = 2 * (6 * t - 6 * t * t);
        }
    }
    share.value = f * s;
    for (std::size_t k = 0; k < 3; ++k) {
        share.by[k] = k < 2 || d.extent_w != 0 ? over_r * x[k] / a[k] * s : 0;
        share.by[3 + k] = f * slope * v[k];
    }
    return share;
}

Real3 displaced(const std::vector<Deformation>& list, const Cloud& points, std::size_t i) {
    Real3 sum{};
    for (const Deformation& d : list) {
        const Real f = share_of(d, points.parameters[i], points.depths.w[i], points.depths.normal[i]).value;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += d.vector[static_cast<int>(c)] * f;
    }
    return sum;
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

std::vector<double> written(DeformedPoints& surface, std::size_t count,
                            const ParallelFor& parallel_for = serial_for) {
    std::vector<double> out(3 * count);
    surface.write<double>(nullptr, out.data(), parallel_for);
    return out;
}

std::string fault_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no fault";
}

TEST(DeformDepth, PointsAreWhereTheFormulaHasThem) {
    for (unsigned seed = 1; seed <= 4; ++seed)
        for (const double cutoff : {0., 1e-7, 1e-3}) {
            SCOPED_TRACE("seed " + std::to_string(seed) + ", cutoff " + std::to_string(cutoff));
            const Cloud points = cloud(seed, 2000);
            const std::vector<Deformation> list = bumps(seed + 50, 24);
            DeformedPoints surface(points.parameters, points.depths, {cutoff, 0x1p-50});
            surface.apply(difference({}, list));
            const std::vector<double> out = written(surface, points.parameters.size());
            Real most = 0, moved = 0;
            for (std::size_t i = 0; i < points.parameters.size(); ++i) {
                const Real3 exact = displaced(list, points, i);
                for (std::size_t c = 0; c < 3; ++c) {
                    most = std::max(most, std::fabs(out[3 * i + c] - exact[c]));
                    moved = std::max(moved, std::fabs(exact[c]));
                }
                const glm::dvec3 read =
                    displacement_at(list, points.parameters[i],
                                    std::isfinite(points.depths.w[i]) ? points.depths.w[i] : HUGE_VAL,
                                    points.depths.normal[i]);
                for (std::size_t c = 0; c < 3; ++c)
                    ASSERT_NEAR(read[static_cast<int>(c)], static_cast<double>(exact[c]), 1e-13);
            }
            EXPECT_LE(most, surface.error_bound());
            EXPECT_LT(surface.error_bound(), cutoff == 0 ? 2e-13 : 20 * cutoff);
            EXPECT_GT(moved, .3);
        }
}

TEST(DeformDepth, DerivativesAreThoseOfTheFormula) {
    const Cloud points = cloud(9, 3000);
    const std::vector<Deformation> list = bumps(10, 30);
    const DeformOptions options{0, 0x1p-50};
    DeformedPoints surface(points.parameters, points.depths, options);
    std::vector<int> given(points.parameters.size());
    Real most = 0;
    const auto take = [&](const SurfaceSlopes& slopes) {
        ASSERT_EQ(slopes.parameters, 6);
        for (int k = 0; k < slopes.count; ++k) {
            const auto i = static_cast<std::size_t>(slopes.point(k));
            ++given[i];
            std::array<Real, 18> exact{};
            for (const Deformation& d : list) {
                const Share share =
                    share_of(d, points.parameters[i], points.depths.w[i], points.depths.normal[i]);
                for (std::size_t j = 0; j < 18; ++j)
                    exact[j] += d.vector[static_cast<int>(j % 3)] * share.by[j / 3];
            }
            for (std::size_t j = 0; j < 18; ++j) most = std::max(most, std::fabs(slopes.by[j][k] - exact[j]));
        }
    };
    surface.slopes(list, nullptr, take);
    EXPECT_LT(most, 1e-12);
    EXPECT_EQ(std::count(given.begin(), given.end(), 1), 3000);
    // In one pass with the points there are the same.
    std::vector<double> out(9000);
    most = 0;
    surface.write_with_slopes<double>(list, nullptr, out.data(), take);
    EXPECT_LT(most, 1e-12);
    DeformedPoints other(points.parameters, points.depths, options);
    other.apply(difference({}, list));
    EXPECT_EQ(written(other, 3000), out);
}

TEST(DeformDepth, SameBitsForAnyHistoryThreadsAndInstructions) {
    const Cloud points = cloud(3, 3001);
    const std::vector<Deformation> list = bumps(4, 20);
    const DeformOptions options;
    std::vector<double> expected;
    test::on_every_instruction_set([&] {
        DeformedPoints surface(points.parameters, points.depths, options);
        surface.apply(difference({}, list));
        const std::vector<double> out = written(surface, 3001, threads(3));
        if (expected.empty()) expected = out;
        EXPECT_EQ(out, expected);
    });
    // Another order, and bumps that come and go.
    DeformedPoints surface(points.parameters, points.depths, options);
    std::vector<double> out(3 * 3001);
    surface.write<double>(nullptr, out.data());
    for (const Deformation& d : bumps(77, 12)) surface.apply(DeformationChange{std::nullopt, d});
    for (auto d = list.rbegin(); d != list.rend(); ++d) surface.apply(DeformationChange{std::nullopt, *d});
    surface.update<double>(nullptr, out.data());
    EXPECT_NE(out, expected);
    for (const Deformation& d : bumps(77, 12)) surface.apply(DeformationChange{d, std::nullopt});
    surface.update<double>(nullptr, out.data());
    EXPECT_EQ(out, expected);
}

TEST(DeformDepth, PlainBumpsHaveTheBitsTheyHave) {
    const Cloud points = cloud(5, 2000);
    std::vector<Deformation> list = bumps(6, 20);
    for (Deformation& d : list) {
        d.extent_w = 0;
        d.side = DeformationSide::both;
    }
    DeformedPoints with(points.parameters, points.depths, {}), without(points.parameters);
    with.apply(difference({}, list));
    without.apply(difference({}, list));
    EXPECT_EQ(written(with, 2000), written(without, 2000));
    EXPECT_EQ(with.error_bound(), without.error_bound());
    // A depth so large that it is none, and a side that all points are on, are off by no more than both may be.
    std::vector<Deformation> wide = list;
    for (Deformation& d : wide) d.extent_w = 1e30;
    Cloud flat = points;
    flat.depths.w.assign(2000, .3);
    DeformedPoints deep(flat.parameters, flat.depths, {});
    deep.apply(difference({}, wide));
    const std::vector<double> a = written(deep, 2000), b = written(without, 2000);
    for (std::size_t k = 0; k < a.size(); ++k)
        ASSERT_NEAR(a[k], b[k], deep.error_bound() + without.error_bound());
}

TEST(DeformDepth, ASphereGetsAPeakAndNoDent) {
    // The top and the bottom of a sphere have the same (u, v).
    const std::vector<glm::dvec2> twice = {{.1, .2}, {.1, .2}};
    const double z = std::sqrt(1 - .01 - .04);
    const PointDepths depths{{z, -z}, {{.1, .2, z}, {.1, .2, -z}}};
    Deformation d;
    d.vector = {0, 0, 1};
    d.extent = {.5, .5};
    const auto heights = [&](const Deformation& bump) {
        DeformedPoints surface(twice, depths, {});
        surface.apply(DeformationChange{std::nullopt, bump});
        const std::vector<double> out = written(surface, 2);
        return std::array<double, 2>{out[2], out[5]};
    };
    const double full = std::exp(-.05 / .25);
    EXPECT_NEAR(heights(d)[0], full, 1e-9);
    EXPECT_NEAR(heights(d)[1], full, 1e-9);
    Deformation front = d, back = d, deep = d;
    front.side = DeformationSide::front;
    EXPECT_NEAR(heights(front)[0], full, 1e-9);
    EXPECT_EQ(heights(front)[1], 0);
    back.side = DeformationSide::back;
    back.vector = {0, 0, -1};  // a dent into the top
    EXPECT_NEAR(heights(back)[0], -full, 1e-9);
    EXPECT_EQ(heights(back)[1], 0);
    deep.center_w = 1;
    deep.extent_w = .4;
    EXPECT_NEAR(heights(deep)[0], full * std::exp(-(z - 1) * (z - 1) / .16), 1e-9);
    EXPECT_EQ(heights(deep)[1], 0);
}

TEST(DeformDepth, NormalsTurnWithTheDepth) {
    const unsigned seed = 12;
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const ParameterPlane plane({.1, .2, -.3}, {1, .2, 0}, {-.1, .8, .3});
    std::vector<Deformation> list = bumps(8, 12);
    for (Deformation& d : list) d.side = DeformationSide::both;
    std::vector<glm::dvec2> parameters;
    PointDepths depths;
    std::vector<glm::dvec3> normals;
    std::vector<glm::dvec3> places;
    for (int i = 0; i < 400; ++i) {
        places.push_back({random.number(0, 1), random.number(0, 1), random.number(-.5, .5)});
        parameters.push_back(plane.parameters(places.back()));
        depths.w.push_back(plane.depth(places.back()));
        depths.normal.push_back(random.unit());
        normals.push_back(depths.normal.back());
    }
    // Two tangents of the undeformed surface, moved by long double's central differences.
    const auto moved = [&](glm::dvec3 p, const Real3& step) {
        const Real3 q{p.x + step[0], p.y + step[1], p.z + step[2]};
        const auto along = [&](glm::dvec3 g, glm::dvec3 from) {
            return g.x * (q[0] - from.x) + g.y * (q[1] - from.y) + g.z * (q[2] - from.z);
        };
        const Real u = along(plane.gradient_u(), plane.origin()),
                   v = along(plane.gradient_v(), plane.origin()), w = along(plane.normal(), plane.origin());
        Real3 sum = q;
        for (const Deformation& d : list) {
            const Real x = (u - d.center.x) / d.extent.x, y = (v - d.center.y) / d.extent.y,
                       z = d.extent_w != 0 ? (w - d.center_w) / d.extent_w : 0,
                       r = std::sqrt(x * x + y * y + z * z),
                       f = d.kernel == DeformationKernel::gaussian ? std::exp(-r * r)
                           : r < 1                                 ? std::pow(1 - r, Real(4)) * (4 * r + 1)
                                                                   : 0;
            for (std::size_t c = 0; c < 3; ++c) sum[c] += d.vector[static_cast<int>(c)] * f;
        }
        return sum;
    };
    DeformedPoints surface(parameters, depths, {0, 0x1p-50});
    const auto take = [&](const SurfaceSlopes& slopes) {
        double to[3][SurfaceSlopes::kMost] = {};
        for (int k = 0; k < slopes.count; ++k)
            for (int c = 0; c < 3; ++c) to[c][k] = normals[static_cast<std::size_t>(slopes.point(k))][c];
        turn_normals(slopes, plane.gradient_u(), plane.gradient_v(), to, plane.normal());
        for (int k = 0; k < slopes.count; ++k) {
            const auto i = static_cast<std::size_t>(slopes.point(k));
            const glm::dvec3 n = normals[i], s = glm::normalize(glm::cross(n, random.unit())),
                             t = glm::cross(n, s);
            const auto tangent = [&](glm::dvec3 v) {
                const Real h = 1e-6L;
                const Real3 there = moved(places[i], {h * v.x, h * v.y, h * v.z}),
                            here = moved(places[i], {-h * v.x, -h * v.y, -h * v.z});
                return glm::dvec3(static_cast<double>((there[0] - here[0]) / (2 * h)),
                                  static_cast<double>((there[1] - here[1]) / (2 * h)),
                                  static_cast<double>((there[2] - here[2]) / (2 * h)));
            };
            const glm::dvec3 exact = glm::cross(tangent(s), tangent(t));
            if (glm::length(exact) < 1e-2) continue;
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(to[c][k], glm::normalize(exact)[c], 1e-7);
        }
    };
    surface.slopes(list, nullptr, take);
}

TEST(DeformDepth, WhoHasNoDepthsRefusesThem) {
    Deformation deep, sided;
    deep.vector = sided.vector = {0, 0, 1};
    deep.extent_w = 2.5;
    sided.side = DeformationSide::back;
    const std::vector<glm::dvec2> points = {{0, 0}, {1, 1}};
    std::vector<DisplacementJet> jets(2);
    for (const auto& [bump, words] :
         {std::pair(deep, "extent=2.5: "), std::pair(sided, "side=front or back: ")}) {
        const DeformationChange added{std::nullopt, bump};
        EXPECT_THAT(fault_of([&] { DeformedGrid({0, 1}, {0, 1}).apply(added); }), HasSubstr(words));
        EXPECT_THAT(fault_of([&] { DeformedPoints(std::span(points)).apply(added); }), HasSubstr(words));
        EXPECT_THAT(fault_of([&] { displacement_jets({bump}, points, {}, jets.data()); }), HasSubstr(words));
    }
    EXPECT_THAT(fault_of([&] { PlaneWarp({}, {deep}); }), HasSubstr("extent=2.5: a transform of space"));
    EXPECT_THAT(fault_of([&] { PlaneWarp({}, {sided}); }), HasSubstr("side=back: a transform of space"));
    deep.extent_w = -1;
    EXPECT_THAT(fault_of([&] { check_deformation(deep); }), HasSubstr("extent=-1"));
    deep.extent_w = 1;
    deep.center_w = HUGE_VAL;
    EXPECT_THAT(fault_of([&] { check_deformation(deep); }), HasSubstr("center=inf"));
    PointDepths few{{0}, {{0, 0, 1}}};
    EXPECT_THAT(fault_of([&] { DeformedPoints(points, few, {}); }), HasSubstr("as many as points, 2"));
    few = {{0, 0}, {{0, 0, 1}, {0, std::nan(""), 1}}};
    EXPECT_THAT(fault_of([&] { DeformedPoints(points, few, {}); }), HasSubstr("normal[1]=nan"));
}

TEST(DeformDepth, ExtremeNumbers) {
    Deformation d;
    d.side = DeformationSide::front;
    for (const double size : {1e-308, 1e308, 5e-324}) {
        d.vector = {0, size, 0};
        const Triple<double> direction = side_direction<double>(d);
        EXPECT_EQ(direction.x, 0);
        EXPECT_EQ(direction.y, 1);
    }
    d.vector = {1e308, 1e308, -1e308};
    EXPECT_NEAR(side_direction<double>(d).z, -std::sqrt(1. / 3), 1e-15);
    // The least and the largest extent in depth.
    const std::vector<glm::dvec2> points = {{0, 0}, {0, 0}};
    const PointDepths depths{{0, 1e300}, {{0, 0, 1}, {0, 0, 1}}};
    for (const double extent : {1e-300, 1e300}) {
        DeformedPoints surface(points, depths, {});
        Deformation bump;
        bump.vector = {0, 0, 1};
        bump.extent_w = extent;
        surface.apply(DeformationChange{std::nullopt, bump});
        const std::vector<double> out = written(surface, 2);
        EXPECT_EQ(out[2], 1);
        EXPECT_NEAR(out[5], extent == 1e300 ? std::exp(-1) : 0, 1e-6);
    }
}

}  // namespace
}  // namespace anamorph::test_deform_depth
