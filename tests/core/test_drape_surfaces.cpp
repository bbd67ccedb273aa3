// SPDX-License-Identifier: Apache-2.0
// Surfaces that are sampled, raised, summed, moved by many deformations and written as text: their formulas, their bounds, and
// that pictures on them keep the tolerance.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "anamorph/deform/deformation_reach.h"
#include "drape_oracle.h"
#include "drape_scene.h"

namespace anamorph::test_drape_surfaces {
using namespace surface;
namespace {

using test::number_of;
using test::Real;
using test::Scene;
using test::Shown;
using test::Vector;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// The cubic of Catmull and Rom through numbers at the middles of texels, Lagrange's form of each quarter: along a line of
/// any numbers, which goes on straight at its ends.
Real cubic_along(const std::function<Real(int)>& texel, int count, Real place) {
    const std::function<Real(int)> at = [&](int i) -> Real {
        if (count == 1) return texel(0);
        if (i < 0) return texel(0) + i * (texel(1) - texel(0));
        if (i >= count) return texel(count - 1) + (i - count + 1) * (texel(count - 1) - texel(count - 2));
        return texel(i);
    };
    const Real x = place * count - Real(0.5);
    const int i = std::clamp(static_cast<int>(std::floor(x)), -1, count - 1);
    const Real t = x - i, a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
    return b + t / 2 * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

/// A field of texels, interpolated in long double.
struct OracleField {
    std::vector<float> texels;
    Size size;
    int channels;

    Real operator()(int channel, Real u, Real v) const {
        return cubic_along(
            [&](int j) {
                return cubic_along(
                    [&](int i) {
                        return Real(
                            texels[static_cast<std::size_t>((j * size.width + i) * channels + channel)]);
                    },
                    size.width, u);
            },
            size.height, v);
    }
};

OracleField noise(std::mt19937& random, const Size& size, int channels) {
    std::uniform_real_distribution<float> uniform(-1, 1);
    OracleField field{{}, size, channels};
    for (int i = 0; i < size.width * size.height * channels; ++i) field.texels.push_back(uniform(random));
    return field;
}

constexpr Size kSizes[] = {{1, 1}, {1, 9}, {2, 3}, {7, 5}, {40, 61}, {200, 3}};

TEST(SampledField, IsTheCubicOfCatmullAndRom) {
    constexpr unsigned kSeed = 21;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const Size& size : kSizes)
        for (const int channels : {1, 3}) {
            const OracleField oracle = noise(random, size, channels);
            const SampledField field(oracle.texels, size, channels);
            for (int i = 0; i < 300; ++i) {
                const double u = i == 0 ? 0 : i == 1 ? 1 : uniform(random), v = i < 2 ? i : uniform(random);
                double is[3];
                Interval about[3];
                field.read(u, v, is);
                field.read(Interval(u), Interval(v), about);
                for (int c = 0; c < channels; ++c) {
                    const Real truth = oracle(c, u, v);
                    // Texels that go on at the edges are floats.
                    EXPECT_NEAR(is[c], static_cast<double>(truth), 1e-6);
                    EXPECT_TRUE(about[c].contains(is[c]));
                    EXPECT_LT(about[c].hi - about[c].lo, 1e-10);
                }
            }
        }
}

TEST(SampledField, RangesHoldValuesAndDifferences) {
    constexpr unsigned kSeed = 22;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    using J = Jet<Interval, 2>;
    for (const Size& size : kSizes) {
        const OracleField oracle = noise(random, size, 1);
        const SampledField field(oracle.texels, size, 1);
        for (int n = 0; n < 400; ++n) {
            // Also a little beyond the picture, where the field goes on.
            const double beyond_u = n % 3 == 0 ? 1.5 / size.width : 0,
                         beyond_v = n % 3 == 0 ? 1.5 / size.height : 0;
            const double side_u = std::ldexp(1.0, -(n % 12)), side_v = std::ldexp(1.0, -(n / 12 % 12)),
                         u = (1 + 2 * beyond_u - side_u) * uniform(random) - beyond_u,
                         v = (1 + 2 * beyond_v - side_v) * uniform(random) - beyond_v;
            J range;
            field.read(J::variable({u, u + side_u}, 1.0, 0.0), J::variable({v, v + side_v}, 0.0, 1.0),
                       &range);
            const Real h = side_u / 64, k = side_v / 64;
            for (int m = 0; m < 10; ++m) {
                const Real s = u + h + (side_u - 2 * h) * Real(uniform(random)),
                           t = v + k + (side_v - 2 * k) * Real(uniform(random));
                const auto f = [&](int i, int j) { return oracle(0, s + i * h, t + j * k); };
                const Real is[6] = {f(0, 0),
                                    (f(1, 0) - f(-1, 0)) / (2 * h),
                                    (f(0, 1) - f(0, -1)) / (2 * k),
                                    (f(1, 0) - 2 * f(0, 0) + f(-1, 0)) / (2 * h * h),
                                    (f(1, 1) - f(1, -1) - f(-1, 1) + f(-1, -1)) / (4 * h * k),
                                    (f(0, 1) - 2 * f(0, 0) + f(0, -1)) / (2 * k * k)};
                const Real steps[6] = {1, h, k, h * h, h * k, k * k};
                for (int c = 0; c < 6; ++c) {
                    // Texels that go on at the edges are floats; beyond them a cubic is farther off.
                    const Real slack = (beyond_u > 0 ? 2e-5L : 2e-6L) / steps[c];
                    EXPECT_LE(range.c[c].lo - slack, is[c]) << c << " " << side_u << " " << side_v;
                    EXPECT_GE(range.c[c].hi + slack, is[c]) << c << " " << side_u << " " << side_v;
                }
            }
        }
    }
}

TEST(SampledField, RangesOfAPlaneAreThoseOfAPlane) {
    // What is linear does not bend, over any box, whatever its slope.
    const Size size{50, 30};
    std::vector<float> texels;
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) texels.push_back(static_cast<float>(3 * x - 2 * y));
    const SampledField field(texels, size, 1);
    using J = Jet<Interval, 2>;
    for (const double side : {1.0, 0.5, 0.11, 0.01, 1e-4, 1e-9}) {
        J range;
        field.read(J::variable({0.3, 0.3 + side * 0.7}, 1.0, 0.0),
                   J::variable({0.2, 0.2 + side * 0.8}, 0.0, 1.0), &range);
        EXPECT_NEAR(range.c[1].lo, 150, 1e-6);
        EXPECT_NEAR(range.c[1].hi, 150, 1e-6);
        EXPECT_NEAR(range.c[2].lo, -60, 1e-6);
        EXPECT_LT(magnitude(range.c[3]), 1e-3);
        EXPECT_LT(magnitude(range.c[4]), 1e-3);
        EXPECT_LT(magnitude(range.c[5]), 1e-3);
    }
}

TEST(SampledField, SmoothingKeepsMeansAndLeavesOutWhatIsNoNumber) {
    std::vector<float> texels(41 * 31, 0.5f);
    EXPECT_THAT(smoothed(texels, {41, 31}, 3), testing::Each(testing::FloatNear(0.5f, 1e-6f)));
    texels[15 * 41 + 20] = kNaN;
    const std::vector<float> with = smoothed(texels, {41, 31}, 3);
    for (std::size_t i = 0; i < with.size(); ++i)
        if (i == 15 * 41 + 20)
            EXPECT_TRUE(std::isnan(with[i]));
        else
            EXPECT_NEAR(with[i], 0.5f, 1e-6f);
    // A single bright texel becomes the Gaussian.
    std::vector<float> point(41 * 31, 0.0f);
    point[15 * 41 + 20] = 1;
    const std::vector<float> spread = smoothed(point, {41, 31}, 2);
    EXPECT_NEAR(spread[15 * 41 + 23] / spread[15 * 41 + 20], std::exp(-9 / 8.0), 1e-4);
}

/// The points of a picture on a surface are seen within the tolerance. Returns the number of pixels that show it.
int expect_in_place(const Scene& scene, double tol, const std::function<Vector(Real, Real)>& surface,
                    DrapeScheme scheme = DrapeScheme::automatic) {
    DrapeOptions options;
    options.tol = tol;
    options.scheme = scheme;
    const std::vector<float> points = Shown(scene, options).values(Output::stmap);
    int seen = 0, over = 0;
    for (int y = 0; y < scene.screen.height; ++y)
        for (int x = 0; x < scene.screen.width; ++x) {
            const auto k = static_cast<std::size_t>(y * scene.screen.width + x);
            if (points[2 * k] < 0) continue;
            ++seen;
            const test::OracleSight at =
                test::oracle_sight(scene.pose, scene.screen, surface(points[2 * k], points[2 * k + 1]));
            // Points are floats: 2^-25 of a picture that is a few hundred pixels large, on steep surfaces.
            over += !(std::hypot(at.x - (x + 0.5L), at.y - (y + 0.5L)) <= tol + 2e-3L);
        }
    EXPECT_EQ(over, 0);
    return seen;
}

TEST(DrapedSurface, SampledPositionsAreSeenWithinTheTolerance) {
    constexpr unsigned kSeed = 23;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<float> uniform(-0.02f, 0.02f);
    for (const Size& size : {Size{30, 20}, Size{3, 40}, Size{1, 1}}) {
        // Half a cylinder, crumpled.
        OracleField field{{}, size, 3};
        for (int y = 0; y < size.height; ++y)
            for (int x = 0; x < size.width; ++x) {
                const double turn = ((x + 0.5) / size.width - 0.5) * kPi;
                field.texels.insert(field.texels.end(),
                                    {static_cast<float>(0.5 * std::sin(turn)) + uniform(random),
                                     static_cast<float>(0.5 - (y + 0.5) / size.height) + uniform(random),
                                     static_cast<float>(0.5 * std::cos(turn)) + uniform(random)});
            }
        SurfaceSum sum;
        sum.parts = {{surface_names().size(), 1}};
        sum.positions = std::make_shared<SampledField>(field.texels, size, 3);
        for (const double tol : {1.0, 0.125, 0.02}) {
            Scene scene;
            scene.own = make_surface(sum);
            scene.pose.position = {0.5, 0.6, 1.6};
            const int seen = expect_in_place(scene, tol, [&](Real u, Real v) {
                return Vector{field(0, u, v), field(1, u, v), field(2, u, v)};
            });
            EXPECT_GE(seen, size.width > 1 ? 3000 : 0);
        }
    }
}

/// A surface's unit normal on the side that it is raised to, by differences.
Vector oracle_normal(const std::string& name, const SurfaceShape& shape, Real u, Real v) {
    const auto at = [&](Real s, Real t) { return test::oracle_surface(name, shape, s, t); };
    constexpr Real h = 1e-6L;
    const Vector a = at(u - h, v), b = at(u + h, v), c = at(u, v - h), d = at(u, v + h);
    const Real s[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, t[3] = {d[0] - c[0], d[1] - c[1], d[2] - c[2]};
    // v runs down, so that t x s is towards the viewer of the flat picture, and outwards from bodies.
    Vector n{t[1] * s[2] - t[2] * s[1], t[2] * s[0] - t[0] * s[2], t[0] * s[1] - t[1] * s[0]};
    const Real size = std::hypot(std::hypot(n[0], n[1]), n[2]);
    for (Real& x : n) x /= size;
    return n;
}

TEST(DrapedSurface, ReliefsAreRaisedAlongTheNormal) {
    constexpr unsigned kSeed = 24;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0.02, 0.98);
    const OracleField heights = noise(random, {9, 11}, 1);
    SurfaceSum sum;
    sum.heights = std::make_shared<SampledField>(heights.texels, heights.size, 1);
    sum.height_scale = 0.04;
    sum.shape.angle = 300;
    sum.shape.aspect = 1.2;
    sum.shape.direction = 30;
    for (std::size_t which = 0; which < surface_names().size(); ++which) {
        const std::string& name = surface_names()[which];
        if (!has_smooth_normals(which)) continue;
        sum.parts = {{which, 1}};
        const auto point = [&](Real u, Real v) {
            Vector p = test::oracle_surface(name, sum.shape, u, v);
            const Vector n = oracle_normal(name, sum.shape, u, v);
            for (std::size_t k = 0; k < 3; ++k) p[k] += Real(sum.height_scale) * heights(0, u, v) * n[k];
            return p;
        };
        const auto surface = make_surface(sum);
        for (int i = 0; i < 100; ++i) {
            const double u = uniform(random), v = uniform(random);
            const glm::dvec3 p = surface->position(u, v);
            for (int k = 0; k < 3; ++k)
                EXPECT_NEAR(p[k], static_cast<double>(point(u, v)[static_cast<std::size_t>(k)]), 1e-7)
                    << name;
        }
        Scene scene;
        scene.own = surface;
        scene.pose.position = {0.5, 0.6, 1.6};
        EXPECT_GT(expect_in_place(scene, 0.125, point), 2000) << name;
    }
}

TEST(DrapedSurface, SumsAreThoseOfTheirPartsPointByPoint) {
    SurfaceSum sum;
    sum.shape.angle = 360;
    sum.shape.direction = 20;
    const std::vector<std::string> names = {"plane", "sphere", "page_turn", "torus"};
    const double weights[] = {0.7, 0.5, 0.3, -0.5};
    sum.parts.clear();
    for (std::size_t i = 0; i < names.size(); ++i) sum.parts.push_back({number_of(names[i]), weights[i]});
    const auto point = [&](Real u, Real v) {
        Vector p{};
        for (std::size_t i = 0; i < names.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k)
                p[k] += weights[i] * test::oracle_surface(names[i], sum.shape, u, v)[k];
        return p;
    };
    Scene scene;
    scene.own = make_surface(sum);
    scene.pose.position = {0.5, 0.6, 1.9};
    for (const double tol : {0.5, 0.05}) EXPECT_GT(expect_in_place(scene, tol, point), 2000);
}

/// Bumps with depth and sides on a sphere, whose normals are its radii, written out; v down.
std::vector<Deformation> deep_bumps(unsigned seed) {
    std::mt19937 random(seed);
    const auto number = [&](double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(random);
    };
    std::vector<Deformation> list;
    for (int k = 0; k < 12; ++k) {
        Deformation d;
        d.vector = {number(-.1, .1), number(-.1, .1), number(-.2, .2)};
        d.center = {number(0, 1), number(0, 1)};
        d.extent = {number(.1, .4), number(.1, .4)};
        if (k % 2) d.kernel = DeformationKernel::wendland_c2;
        if (k % 3 != 2) {
            d.center_w = number(-.4, .4);
            d.extent_w = number(.15, .6);
        }
        d.side = static_cast<DeformationSide>(k / 2 % 3);
        if (d.has_depth() && k % 4 < 2)
            d.orientation = {number(-1, 1), number(-1, 1), number(-1, 1), number(.2, 1)};
        list.push_back(d);
    }
    return list;
}
/// A vector turned back by a quaternion: v - 2 w q x v / |q|^2 + 2 q x (q x v) / |q|^2.
Vector turned_back(glm::dvec4 by, const Vector& v) {
    const Real w = by.x;
    const Vector q{by.y, by.z, by.w};
    const auto cross = [](const Vector& a, const Vector& b) {
        return Vector{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const Vector once = cross(q, v), twice = cross(q, once);
    const Real length = w * w + q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
    Vector turned;
    for (std::size_t k = 0; k < 3; ++k) turned[k] = v[k] + 2 * (twice[k] - w * once[k]) / length;
    return turned;
}
Vector deep_point(const SurfaceShape& shape, const std::vector<Deformation>& list, Real u, Real v) {
    const Vector base = test::oracle_surface("sphere", shape, u, v);
    Vector p = base;
    for (const Deformation& d : list) {
        Vector from{u - d.center.x, 1 - v - d.center.y, base[2] - d.center_w};
        if (d.has_frame()) from = turned_back(d.orientation, from);
        const Real x = from[0] / d.extent.x, y = from[1] / d.extent.y,
                   z = d.extent_w > 0 ? from[2] / d.extent_w : 0, r = std::sqrt(x * x + y * y + z * z);
        Real f = d.kernel == DeformationKernel::gaussian ? std::exp(-r * r)
                 : r < 1                                 ? std::pow(1 - r, Real(4)) * (4 * r + 1)
                                                         : 0;
        const Vector along{d.vector.x, d.vector.y, d.vector.z};
        Real cosine = 0, lengths[2] = {0, 0};
        for (std::size_t k = 0; k < 3; ++k) {
            cosine += base[k] * along[k];
            lengths[0] += base[k] * base[k];
            lengths[1] += along[k] * along[k];
        }
        cosine /= std::sqrt(lengths[0]) * std::sqrt(lengths[1]);
        if (d.side != DeformationSide::both) {
            const Real t =
                std::clamp(2 * (d.side == DeformationSide::front ? cosine : -cosine), Real(0), Real(1));
            f *= t * t * (3 - 2 * t);
        }
        for (std::size_t k = 0; k < 3; ++k) p[k] += along[k] * f;
    }
    return p;
}

TEST(DrapedSurface, DeepBumpsAreEnclosedByTheirRanges) {
    constexpr unsigned kSeed = 31;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    SurfaceShape shape;
    shape.angle = 360;
    const std::vector<Deformation> all = deep_bumps(kSeed);
    for (std::size_t k = 0; k <= all.size(); ++k) {
        // Each by itself, and all.
        const std::vector<Deformation> list = k < all.size() ? std::vector{all[k]} : all;
        const auto surface = make_surface(number_of("sphere"), shape, list);
        double width = 0;
        for (int n = 0; n < 500; ++n) {
            const double side = std::ldexp(1.0, -(n % 14)), u = (1 - side) * uniform(random),
                         v = (1 - side) * uniform(random);
            const SurfaceRange range = surface->range({u, u + side}, {v, v + side});
            const double lost = surface->rounding({u, u + side}, {v, v + side});
            const Real h = side / 64;
            if (n % 14 == 10) width = std::max(width, range[2].c[0].hi - range[2].c[0].lo);
            for (int m = 0; m < 6; ++m) {
                const double s = u + static_cast<double>(h) +
                                 (side - 2 * static_cast<double>(h)) * uniform(random),
                             t = v + static_cast<double>(h) +
                                 (side - 2 * static_cast<double>(h)) * uniform(random);
                const auto f = [&](int i, int j) { return deep_point(shape, list, s + i * h, t + j * h); };
                const Vector c = f(0, 0), e = f(1, 0), w = f(-1, 0), so = f(0, 1), no = f(0, -1), a = f(1, 1),
                             b = f(-1, 1), g = f(1, -1), q = f(-1, -1);
                const glm::dvec3 computed = surface->position(s, t);
                const SurfaceFrame frame = surface->frame(s, t);
                for (std::size_t i = 0; i < 3; ++i) {
                    const Real is[6] = {c[i],
                                        (e[i] - w[i]) / (2 * h),
                                        (so[i] - no[i]) / (2 * h),
                                        (e[i] - 2 * c[i] + w[i]) / (2 * h * h),
                                        (a[i] - g[i] - b[i] + q[i]) / (4 * h * h),
                                        (so[i] - 2 * c[i] + no[i]) / (2 * h * h)};
                    const Real steps[6] = {1, h, h, h * h, h * h, h * h};
                    for (int j = 0; j < 6; ++j) {
                        EXPECT_LE(range[i].c[j].lo - 1e-17L / steps[j], is[j])
                            << k << " " << j << " " << side;
                        EXPECT_GE(range[i].c[j].hi + 1e-17L / steps[j], is[j])
                            << k << " " << j << " " << side;
                    }
                    const Real off = std::fabs(c[i] - computed[static_cast<int>(i)]);
                    EXPECT_LE(off, lost) << k;
                    EXPECT_LE(off, surface->rounding(s, t)) << k;
                    EXPECT_NEAR(frame.position[static_cast<int>(i)], computed[static_cast<int>(i)], 1e-14);
                }
            }
        }
        EXPECT_LT(width, 0.02) << k;  // small boxes are known well
    }
}

// In a thin layer a depth that is off by its rounding moves a point by far more than its own.
TEST(DrapedSurface, RoundingOfDepthsCountsInThinLayers) {
    constexpr unsigned kSeed = 33;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    SurfaceShape shape;
    shape.angle = 360;
    double worst = 0;
    for (int n = 0; n < 400; ++n) {
        const double u = uniform(random), v = 0.1 + 0.8 * uniform(random);
        Deformation d;
        d.vector = {0.1, -0.2, 0.3};
        d.center = {u, 1 - v};
        if (n % 2) d.kernel = DeformationKernel::wendland_c2;
        d.extent_w = 1e-6;
        const auto depth = static_cast<double>(test::oracle_surface("sphere", shape, u, v)[2]);
        d.center_w = depth + 1e-6 * (uniform(random) - 0.5);
        if (n % 4 > 1) {
            // A layer that is turned; its other extents are as thin, or as much larger as they may be.
            d.orientation = {uniform(random), uniform(random), uniform(random), uniform(random) + .1};
            d.extent = {n % 8 > 3 ? 1e-6 : 1., 1e-6};
            d.extent_w = n % 8 > 3 ? 1e-6 : .9;
        }
        const auto surface = make_surface(number_of("sphere"), shape, {d});
        const glm::dvec3 computed = surface->position(u, v);
        const Vector exact = deep_point(shape, {d}, u, v);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto off = static_cast<double>(std::fabs(exact[i] - computed[static_cast<int>(i)]));
            EXPECT_LE(off, surface->rounding(u, v)) << n;
            worst = std::max(worst, off);
        }
    }
    EXPECT_GT(worst, 1e-12);
}

TEST(DrapedSurface, DeepBumpsAreSeenWithinTheTolerance) {
    SurfaceShape shape;
    shape.angle = 360;
    const std::vector<Deformation> list = deep_bumps(32);
    Scene scene;
    scene.own = make_surface(number_of("sphere"), shape, list);
    scene.pose.position = {0.5, 0.6, 1.6};
    for (const double tol : {0.5, 0.02})
        for (const DrapeScheme scheme : {DrapeScheme::automatic, DrapeScheme::exact})
            EXPECT_GT(expect_in_place(
                          scene, tol, [&](Real u, Real v) { return deep_point(shape, list, u, v); }, scheme),
                      2000);
    // Points of a grid are those of position(), but for rounding.
    const std::vector<double> u = {0, .2, .45, .5, .7, 1}, v = {.1, .3, .55, .9};
    std::vector<glm::dvec3> grid(u.size() * v.size());
    scene.own->positions(u, v, grid.data());
    for (std::size_t j = 0; j < v.size(); ++j)
        for (std::size_t i = 0; i < u.size(); ++i)
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(
                    grid[j * u.size() + i][c],
                    static_cast<double>(deep_point(shape, list, u[i], v[j])[static_cast<std::size_t>(c)]),
                    scene.own->rounding(u[i], v[j]));
}

TEST(DrapedSurface, SidesAreOfSurfacesWithSmoothNormals) {
    Deformation d;
    d.vector = {0, 0, .1};
    d.side = DeformationSide::front;
    for (std::size_t which = 0; which < surface_names().size(); ++which) try {
            make_surface(which, {}, {d});
            EXPECT_TRUE(has_smooth_normals(which)) << surface_names()[which];
        } catch (const Error& error) {
            EXPECT_FALSE(has_smooth_normals(which)) << surface_names()[which];
            EXPECT_THAT(error.what(), testing::HasSubstr("side=front or back: the normals of " +
                                                         surface_names()[which] + " may turn abruptly"));
        }
}

/// A surface that is text, and the same in long double.
struct TextSurface {
    const char* name;
    SurfaceText text;
    std::function<Vector(Real, Real)> point;  ///< v up; not a number where there is no surface
    glm::dvec3 camera{0.5, 0.6, 1.9};
};

SurfaceText text_of(const std::string& px, const std::string& py, const std::string& pz,
                    const std::string& let = "") {
    return {px, py, pz, {}, let};
}

const SurfaceText kFlat;

std::vector<TextSurface> text_surfaces() {
    const Real turn = 2 * test::kHalfTurn;
    const auto raised = [](const std::function<Real(Real, Real)>& height) {
        return [height](Real u, Real v) { return Vector{u - 0.5L, v - 0.5L, height(u, v)}; };
    };
    const auto over = [](const std::string& pz) { return text_of(kFlat.px, kFlat.py, pz); };
    return {
        {"flag", over("0.2*u*sin(2*pi*(2*u-0.3))"),
         raised([=](Real u, Real) { return u * std::sin(turn * (2 * u - Real(0.3))) / 5; })},
        {"saddle", over("((u-.5)^2-(v-.5)^2)*2"),
         raised([](Real u, Real v) { return 2 * (u - v) * (u + v - 1); })},
        {"moebius",
         text_of("cos(c)*(1+w*cos(c/2))", "sin(c)*(1+w*cos(c/2))", "w*sin(c/2)", "w=(v-.5)*.6;c=2*pi*u"),
         [=](Real u, Real v) {
             const Real w = (v - 0.5L) * Real(0.6), c = turn * u, far = 1 + w * std::cos(c / 2);
             return Vector{std::cos(c) * far, std::sin(c) * far, w * std::sin(c / 2)};
         },
         {0, -2.5, 3}},
        // Creases: along a column of patches, between such, about a point.
        {"roof", over("-abs(u-0.5)"), raised([](Real u, Real) { return -std::fabs(u - 0.5L); })},
        {"crooked roof", over("-abs(u+0.3*v-0.6)"),
         raised([](Real u, Real v) { return -std::fabs(u + Real(0.3) * v - Real(0.6)); })},
        {"cone", over("-hypot(u-.4,v-.5)"),
         raised([](Real u, Real v) { return -std::hypot(u - Real(0.4), v - 0.5L); })},
        {"steps", over("0.1*clamp(8*u-4,0,1)"),
         raised([](Real u, Real) { return std::min(std::max(8 * u - 4, Real(0)), Real(1)) * Real(0.1); })},
        // Parts that are left out, by a condition, and by a root.
        {"ring", over("if(hypot(u-.5,v-.5)<0.2,1/0,0.1*sin(9*u))"),
         [=](Real u, Real v) {
             const bool hole = std::hypot(u - 0.5L, v - 0.5L) < Real(0.2);
             return Vector{hole ? NAN : u - 0.5L, v - 0.5L, std::sin(9 * u) * Real(0.1)};
         }},
        // A constant that double does not hold.
        {"far", over("pi"), raised([](Real, Real) { return test::kHalfTurn; }), {0.1, 0.1, 7}},
        // What ends at 0, where rounding might jump, and at acos(-1).
        {"ramps", over("mod(u,2)*.1+acos(1.7*(u-v))*.1"),
         [](Real u, Real v) {
             return Vector{u - 0.5L, v - 0.5L, (u + std::acos(Real(1.7) * (u - v))) * Real(0.1)};
         }},
        {"zigzag", over("acos(cos(19*u))*.1"),
         raised([](Real u, Real) { return std::acos(std::cos(19 * u)) * Real(0.1); })},
        {"arch", over("sqrt(0.2-(u-.5)^2)"),
         [=](Real u, Real v) {
             return Vector{u - 0.5L, v - 0.5L, std::sqrt(Real(0.2) - (u - 0.5L) * (u - 0.5L))};
         }},
    };
}

std::shared_ptr<const DrapedSurface> make_text_surface(const SurfaceText& text) {
    SurfaceSum sum;
    sum.parts = {{surface_names().size() + 1, 1}};
    sum.formula = parse_surface(text, {1, 0});
    return make_surface(sum);
}

TEST(DrapedSurface, TextIsSeenWithinTheTolerance) {
    for (const TextSurface& surface : text_surfaces())
        for (const double tol : {1.0, 0.125})
            for (const DrapeScheme scheme : {DrapeScheme::automatic, DrapeScheme::exact}) {
                SCOPED_TRACE(testing::Message() << surface.name << " " << tol);
                Scene scene;
                scene.own = make_text_surface(surface.text);
                scene.pose.position = surface.camera;
                EXPECT_GT(expect_in_place(
                              scene, tol, [&](Real u, Real v) { return surface.point(u, 1 - v); }, scheme),
                          2000);
            }
}

TEST(DrapedSurface, TextIsEnclosedByItsRanges) {
    constexpr unsigned kSeed = 27;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const TextSurface& text : text_surfaces()) {
        SCOPED_TRACE(text.name);
        const auto surface = make_text_surface(text.text);
        int finite = 0, defined = 0;
        for (int i = 0; i < 3000; ++i) {
            const double side = std::exp(-12 * uniform(random)), u0 = uniform(random) * (1 - side),
                         v0 = uniform(random) * (1 - side);
            const Interval u(u0, u0 + side), v(v0, v0 + side);
            const SurfaceRange range = surface->range(u, v);
            const double lost = surface->rounding(u, v);
            const Certainty missing = surface->missing(u, v);
            for (int k = 0; k < 4; ++k) {
                const double s = u0 + side * uniform(random), t = v0 + side * uniform(random);
                const Vector exact = text.point(s, 1 - Real(t));
                const bool is_defined = std::isfinite(exact[0] + exact[1] + exact[2]);
                EXPECT_TRUE(missing == Certainty::open || is_defined == (missing == Certainty::no));
                if (!is_defined) continue;
                ++defined;
                const glm::dvec3 computed = surface->position(s, t);
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const Interval& place = range[axis].c[0];
                    EXPECT_GE(exact[axis], place.lo);
                    EXPECT_LE(exact[axis], place.hi);
                    const Real off = std::fabs(exact[axis] - computed[static_cast<int>(axis)]);
                    EXPECT_LE(off, lost);
                    EXPECT_LE(off, surface->rounding(s, t));
                    // By the mean value theorem, from the middle of the box.
                    const Interval slopes = range[axis].c[1] * Interval(s - (u0 + side / 2)) +
                                            range[axis].c[2] * Interval(t - (v0 + side / 2));
                    const Real middle = text.point(u0 + side / 2, 1 - Real(v0 + side / 2))[axis];
                    if (!std::isfinite(magnitude(slopes)) || !std::isfinite(middle)) continue;
                    ++finite;
                    EXPECT_GE(exact[axis] - middle, slopes.lo - 1e-15);
                    EXPECT_LE(exact[axis] - middle, slopes.hi + 1e-15);
                }
            }
        }
        EXPECT_GT(defined, 5000);
        EXPECT_GT(finite, 5000);
    }
}

TEST(DrapedSurface, WhatTextLeavesOutIsNotSeen) {
    const TextSurface ring = text_surfaces()[7];
    ASSERT_STREQ(ring.name, "ring");
    Scene scene;
    scene.own = make_text_surface(ring.text);
    scene.pose.perspective = false;
    scene.pose.extent = 1;
    scene.pose.position = {0, 0, 1};
    scene.screen = {200, 200};
    for (const double tol : {1.0, 0.05}) {
        DrapeOptions options;
        options.tol = tol;
        const std::vector<float> seen = Shown(scene, options).seen();
        int wrong = 0, holes = 0;
        for (int y = 1; y < 199; ++y)
            for (int x = 1; x < 199; ++x) {
                const double from_rim = std::hypot(x - 99.5, y - 99.5) - 40;
                const bool hole = seen[static_cast<std::size_t>(y * 200 + x)] == 0;
                wrong += from_rim < -0.1 ? !hole : from_rim > tol + 0.1 ? hole : 0;
                holes += hole;
            }
        EXPECT_EQ(wrong, 0) << tol;
        EXPECT_GT(holes, 4900);
    }
    Scene nothing;
    nothing.own = make_text_surface(text_of("u", "v", "if(u<2,0/0,1)"));
    EXPECT_THAT(Shown(nothing).seen(), testing::Each(0.0f));
}

TEST(DrapedSurface, TextThatIsTornSaysWhere) {
    for (const char* pz : {"if(u<0.3,0,0.2)", "floor(3.1*v)", "floor(9*u)", "atan2(v-.5,u-.7)", "1/(u-.3)"}) {
        Scene scene;
        scene.own = make_text_surface(text_of(kFlat.px, kFlat.py, pz));
        scene.pose.position = {0, 0, 5};
        try {
            Shown(scene).seen();
            FAIL() << pz;
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr("the surface is torn near u=")) << pz;
        }
    }
}

TEST(DrapedSurface, TextOfTheListsSurfacesGivesTheirPoints) {
    constexpr unsigned kSeed = 28;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    const std::pair<const char*, SurfaceText> all[] = {
        {"plane", {}},
        {"cylinder", text_of("sin(pi*(u-.5))/pi", "v-.5", "cos(pi*(u-.5))/pi")},
        {"sphere", text_of("sin(b)*sin(a)/2", "cos(b)/2", "sin(b)*cos(a)/2", "a=pi*(u-.5);b=pi*(1-v)")},
        {"torus", text_of("o*sin(a)", "0.2*sin(b)", "o*cos(a)", "a=pi*(u-.5);b=2*pi*(1-v);o=.5-.2*cos(b)")},
        {"waves", text_of(kFlat.px, kFlat.py, "0.1*sin(4*pi*(u-.5))")},
        {"ripples", text_of(kFlat.px, kFlat.py, "0.1*sin(4*pi*hypot(hypot(u-.5,v-.5),1/16))")}};
    for (const auto& [name, text] : all) {
        const auto written = make_text_surface(text), listed = make_surface(number_of(name), {});
        for (int i = 0; i < 1000; ++i) {
            const double u = uniform(random), v = uniform(random);
            const glm::dvec3 p = written->position(u, v), q = listed->position(u, v);
            const double lost = written->rounding(u, v) + listed->rounding(u, v);
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(p[k], q[k], lost) << name;
        }
    }
}

TEST(Drape, WhatIsNoNumberIsAHoleAndNoMore) {
    // A plane of 20 x 20 samples that fills the screen, one of which is missing: up to two texels about it.
    const Size size{20, 20};
    for (const float bad : {kNaN, HUGE_VALF, 1e13f}) {
        std::vector<float> texels;
        for (int y = 0; y < 20; ++y)
            for (int x = 0; x < 20; ++x)
                texels.insert(texels.end(), {(x + 0.5f) / 20 - 0.5f, 0.5f - (y + 0.5f) / 20, 0});
        texels[3 * (8 * 20 + 12) + 1] = bad;
        SurfaceSum sum;
        sum.parts = {{surface_names().size(), 1}};
        const auto field = std::make_shared<SampledField>(texels, size, 3);
        EXPECT_EQ(field->missing_texels(), 1u);
        EXPECT_EQ(field->first_missing().x, 12);
        EXPECT_EQ(field->first_missing().y, 8);
        sum.positions = field;
        Scene scene;
        scene.own = make_surface(sum);
        scene.pose.perspective = false;
        scene.pose.extent = 1;
        scene.screen = {200, 200};
        for (const double tol : {1.0, 0.05}) {
            DrapeOptions options;
            options.tol = tol;
            const std::vector<float> covered = Shown(scene, options).seen();
            int holes = 0, wrong = 0;
            for (int y = 1; y < 199; ++y)
                for (int x = 1; x < 199; ++x) {
                    const double from =
                        std::max(std::fabs((x + 0.5) / 10 - 12.5), std::fabs((y + 0.5) / 10 - 8.5));
                    const bool hole = covered[static_cast<std::size_t>(y * 200 + x)] == 0;
                    holes += hole;
                    // A little of the neighbouring cells goes with it.
                    wrong += from < 1.9 ? !hole : from > 2.2 ? hole : 0;
                }
            EXPECT_EQ(wrong, 0);
            EXPECT_GT(holes, 1400);
        }
    }
}

TEST(Drape, ASurfaceThatIsMissingIsNotSeen) {
    const std::vector<float> texels(3 * 16, kNaN);
    SurfaceSum sum;
    sum.parts = {{surface_names().size(), 1}};
    sum.positions = std::make_shared<SampledField>(texels, Size{4, 4}, 3);
    Scene scene;
    scene.own = make_surface(sum);
    EXPECT_THAT(Shown(scene).seen(), testing::Each(0.0f));
}

TEST(DeformationReach, WhatIsFarAddsNoMoreThanItSays) {
    constexpr unsigned kSeed = 25;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Deformation> list(200);
    for (Deformation& d : list) {
        d.center = {uniform(random), uniform(random)};
        d.extent = {std::exp(-12 * uniform(random)), std::exp(-12 * uniform(random))};
        d.vector = {uniform(random), -uniform(random), 1e3 * uniform(random)};
        if (uniform(random) < 0.3) d.kernel = DeformationKernel::wendland_c2;
    }
    const DeformationReach reach(list);
    using J = Jet<long double, 2>;
    double sharpest = 0;
    for (int i = 0; i < 2000; ++i) {
        const Deformation& about = list[static_cast<std::size_t>(i) % list.size()];
        // Also just beyond the boxes of some.
        const double far = i % 3 ? 9 : 30,
                     u = about.center.x + far * about.extent.x * (uniform(random) - 0.5),
                     v = about.center.y + far * about.extent.y * (uniform(random) - 0.5);
        std::vector<bool> near(list.size());
        reach.each_near(Interval(u), Interval(v), [&](std::size_t k) { near[k] = true; });
        std::array<long double, 6> rest{};
        for (std::size_t k = 0; k < list.size(); ++k) {
            if (near[k]) continue;
            const Deformation& d = list[k];
            const J x = (J::variable(u, 1, 0) - J(d.center.x)) * J(1 / Real(d.extent.x)),
                    y = (J::variable(v, 0, 1) - J(d.center.y)) * J(1 / Real(d.extent.y));
            if (d.kernel == DeformationKernel::wendland_c2) {
                EXPECT_GE(std::hypot(x.c[0], y.c[0]), 1);
                continue;
            }
            const J f = exp(-(x * x + y * y));
            for (std::size_t c = 0; c < 6; ++c) rest[c] += std::fabs(d.vector.z * f.c[c]);
        }
        for (const long double r : rest) {
            EXPECT_LE(r, reach.far().z);
            sharpest = std::max(sharpest, static_cast<double>(r) / reach.far().z);
        }
    }
    EXPECT_LT(reach.far().z, 1e-20);
    EXPECT_GT(sharpest, 0) << "nothing was far";
}

TEST(DeformationReach, FewOfManyAreNear) {
    std::mt19937 random(26);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Deformation> list(1000);
    for (Deformation& d : list) {
        d.center = {uniform(random), uniform(random)};
        d.extent = glm::dvec2(0.003);
        d.vector = {0, 0, 1};
    }
    const DeformationReach reach(list);
    int near = 0;
    for (int i = 0; i < 100; ++i)
        reach.each_near(Interval(uniform(random)), Interval(uniform(random)), [&](std::size_t) { ++near; });
    // Each is reached by a box of .06 x .06: some four at a point.
    EXPECT_LT(near, 100 * 20);
    EXPECT_GT(near, 100);
}

/// What bumps add to a point and its derivatives is found by fewer operations than their formula has, and the same.
TEST(DrapedSurface, FramesHaveTheBitsOfTheFormulaOfBumps) {
    using J = Jet<double, 1>;
    std::mt19937 random(11);
    const auto any = [&](double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(random);
    };
    const std::size_t plane = 0;
    const auto flat = surface::make_surface(plane, {});
    for (int i = 0; i < 3000; ++i) {
        Deformation d;
        d.kernel = i % 4 == 0 ? DeformationKernel::wendland_c2 : DeformationKernel::gaussian;
        d.center = {any(0, 1), any(0, 1)};
        d.extent = {std::exp(any(-6, 2)), std::exp(any(-6, 2))};
        d.vector = {any(-1, 1), any(-1, 1), any(-1, 1)};
        const double u = any(0, 1), v = any(0, 1);
        const surface::SurfaceFrame with = surface::make_surface(plane, {}, {d})->frame(u, v),
                                    without = flat->frame(u, v);
        Deformation down = d;
        down.center.y = 1 - d.center.y;
        const J share = influence(down, J::variable(u, 1, 0), J::variable(v, 0, 1));
        for (int k = 0; k < 3; ++k) {
            // Bumps that do not reach are left out.
            if (std::fabs(share.c[0]) < 1e-20) continue;
            EXPECT_EQ(with.position[k], without.position[k] + share.c[0] * d.vector[k]) << i;
            EXPECT_EQ(with.by_u[k], without.by_u[k] + share.c[1] * d.vector[k]) << i;
            EXPECT_EQ(with.by_v[k], without.by_v[k] + share.c[2] * d.vector[k]) << i;
        }
    }
}

}  // namespace
}  // namespace anamorph::test_drape_surfaces
