// SPDX-License-Identifier: Apache-2.0
// Pictures on surfaces: the tolerance on the screen, no holes, and hard cases.
#include "anamorph/surface/drape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <span>

#include "anamorph/image/block_sampler.h"
#include "anamorph/surface/facet_rows.h"
#include "anamorph/surface/oka.h"
#include "drape_oracle.h"
#include "drape_scene.h"
#include "each_instruction_set.h"

namespace anamorph::test_drape {
using namespace surface;
namespace {

using test::number_of;
using test::Plain;
using test::Real;
using test::Scene;
using test::Shown;

/// Every surface, from in front, aslant, near by and in parallel.
std::vector<Scene> scenes() {
    std::vector<CameraPose> poses(4);
    poses[1].position = {1.1, 0.7, 1.3};
    poses[2].position = {0.15, 0.1, 0.75};
    poses[2].target = {0.3, 0.2, 0};
    poses[2].fov = 100;
    poses[3].position = {-1, 2, 1};
    poses[3].perspective = false;
    poses[3].extent = 1.6;
    std::vector<Scene> all;
    for (const std::string& name : surface_names())
        for (const CameraPose& pose : poses) {
            Scene scene{name};
            scene.pose = pose;
            scene.shape.aspect = 1.25;
            scene.shape.angle = name == "cylinder" ? 200 : 360;
            scene.shape.direction = 33;
            scene.shape.phase = 0.3;
            all.push_back(scene);
        }
    return all;
}

TEST(DrapedSurface, PositionsAreThoseOfFormulasWrittenOutAnotherWay) {
    constexpr unsigned kSeed = 3;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const std::string& name : surface_names())
        for (int i = 0; i < 300; ++i) {
            SurfaceShape shape;
            shape.aspect = 0.5 + uniform(random);
            shape.radius = i % 2 ? 0 : 0.05 + uniform(random);
            shape.angle = 10 + 350 * uniform(random);
            shape.direction = 360 * uniform(random);
            shape.turn = uniform(random);
            shape.phase = uniform(random);
            const double u = uniform(random), v = uniform(random);
            const auto surface = make_surface(number_of(name), shape);
            const test::Vector truth = test::oracle_surface(name, shape, u, v);
            const glm::dvec3 p = surface->position(u, v);
            const auto exact = surface->truth(u, v);
            for (int k = 0; k < 3; ++k) {
                EXPECT_NEAR(p[k], static_cast<double>(truth[static_cast<std::size_t>(k)]), 1e-14) << name;
                EXPECT_NEAR(static_cast<double>(exact[static_cast<std::size_t>(k)]),
                            static_cast<double>(truth[static_cast<std::size_t>(k)]), 1e-14)
                    << name;
            }
        }
}

TEST(DrapedSurface, PointsOfGridsAreAsExactAsOthersAndTheSameInEveryGrid) {
    constexpr unsigned kSeed = 23;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<Deformation> bumps(40);
    for (std::size_t i = 0; i < bumps.size(); ++i) {
        bumps[i].center = {uniform(random), uniform(random)};
        bumps[i].extent = {0.003 + 0.2 * square(uniform(random)), 0.003 + 0.2 * square(uniform(random))};
        bumps[i].vector = {uniform(random) - 0.5, 0, uniform(random) - 0.5};
        bumps[i].kernel = i % 3 ? DeformationKernel::gaussian : DeformationKernel::wendland_c2;
    }
    const auto surface = make_surface(number_of("sphere"), {}, bumps);
    std::vector<double> u(40), v(30);
    for (double& s : u) s = 1.2 * uniform(random) - 0.1;
    for (double& t : v) t = 1.2 * uniform(random) - 0.1;
    std::vector<glm::dvec3> points(u.size() * v.size());
    surface->positions(u, v, points.data());
    for (std::size_t j = 0; j < v.size(); ++j)
        for (std::size_t i = 0; i < u.size(); ++i) {
            const glm::dvec3& p = points[j * u.size() + i];
            const auto truth = surface->truth(u[i], v[j]);
            const double rounding = surface->rounding(u[i], v[j]);
            for (int axis = 0; axis < 3; ++axis)
                EXPECT_LE(std::fabs(static_cast<double>(p[axis] - truth[static_cast<std::size_t>(axis)])),
                          rounding)
                    << u[i] << ", " << v[j];
            glm::dvec3 alone;
            surface->positions(std::span(u).subspan(i, 1), std::span(v).subspan(j, 1), &alone);
            EXPECT_TRUE(alone == p) << u[i] << ", " << v[j];
        }
}

TEST(DrapedSurface, RangesHoldPositionsAndDifferences) {
    constexpr unsigned kSeed = 4;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const Scene& scene : scenes())
        for (int i = 0; i < 40; ++i) {
            const auto surface = make_surface(number_of(scene.surface), scene.shape);
            const double side = std::ldexp(1.0, -1 - i % 8), u = (1 - side) * uniform(random),
                         v = (1 - side) * uniform(random);
            const SurfaceRange range = surface->range({u, u + side}, {v, v + side});
            const auto at = [&](Real s, Real t) {
                return test::oracle_surface(scene.surface, scene.shape, s, t);
            };
            const Real h = side / 64;
            for (int n = 0; n < 20; ++n) {
                const Real s = u + h + (side - 2 * h) * Real(uniform(random)),
                           t = v + h + (side - 2 * h) * Real(uniform(random));
                for (std::size_t k = 0; k < 3; ++k) {
                    const Real c = at(s, t)[k];
                    // Divided differences lie in the hull of the derivatives.
                    const Real difference[6] = {c,
                                                (at(s + h, t)[k] - at(s - h, t)[k]) / (2 * h),
                                                (at(s, t + h)[k] - at(s, t - h)[k]) / (2 * h),
                                                (at(s + h, t)[k] - 2 * c + at(s - h, t)[k]) / (2 * h * h),
                                                (at(s + h, t + h)[k] - at(s + h, t - h)[k] -
                                                 at(s - h, t + h)[k] + at(s - h, t - h)[k]) /
                                                    (4 * h * h),
                                                (at(s, t + h)[k] - 2 * c + at(s, t - h)[k]) / (2 * h * h)};
                    for (int d = 0; d < 6; ++d) {
                        const Real slack = 1e-15L / (d < 1 ? 1 : d < 3 ? h : h * h);
                        EXPECT_LE(range[k].c[d].lo - slack, difference[d]) << scene.surface << d;
                        EXPECT_GE(range[k].c[d].hi + slack, difference[d]) << scene.surface << d;
                    }
                }
            }
        }
}

TEST(DrapedSurface, RangesHoldDifferencesOfWendlandsKernelAboutItsCentre) {
    constexpr unsigned kSeed = 5;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    const Deformation d{{0, 0, 1}, {0.5, 0.5}, {0.2, 0.3}, DeformationKernel::wendland_c2};
    const auto surface = make_surface(number_of("plane"), {}, {d});
    const auto height = [&](Real u, Real v) {
        const Real r = std::hypot((u - 0.5L) / Real(d.extent.x), (v - 0.5L) / Real(d.extent.y));
        return r < 1 ? 1 - 10 * r * r + 20 * r * r * r - 15 * r * r * r * r + 4 * r * r * r * r * r : 0;
    };
    for (int i = 0; i < 2000; ++i) {
        const double side = std::ldexp(1.0, -2 - i % 6),
                     u = 0.5 - side * (0.9 * uniform(random)) + 0.1 * (i % 3 - 1),
                     v = 0.5 - side * (0.9 * uniform(random)) + 0.15 * (i / 3 % 3 - 1);
        const SurfaceRange range = surface->range({u, u + side}, {v, v + side});
        const Real h = side / 32, s = u + h + (side - 2 * h) * Real(uniform(random)),
                   t = v + h + (side - 2 * h) * Real(uniform(random));
        const Real c = height(s, t);
        const Real difference[6] = {
            c,
            (height(s + h, t) - height(s - h, t)) / (2 * h),
            (height(s, t + h) - height(s, t - h)) / (2 * h),
            (height(s + h, t) - 2 * c + height(s - h, t)) / (2 * h * h),
            (height(s + h, t + h) - height(s + h, t - h) - height(s - h, t + h) + height(s - h, t - h)) /
                (4 * h * h),
            (height(s, t + h) - 2 * c + height(s, t - h)) / (2 * h * h)};
        for (int k = 0; k < 6; ++k) {
            EXPECT_LE(range[2].c[k].lo - 1e-12L, difference[k]) << k;
            EXPECT_GE(range[2].c[k].hi + 1e-12L, difference[k]) << k;
            EXPECT_LT(range[2].c[k].hi - range[2].c[k].lo, 5000) << k;
        }
    }
}

/// The points that a picture shows are seen where they are drawn: at most `tol`, and what the bound says, away; and
/// output=error says so, to within `agree`. Returns the number of pixels.
int expect_points_in_place(Shown& shown, const Scene& scene, double tol, double agree = 1e-6) {
    const std::vector<float> points = shown.values(Output::stmap), bounds = shown.values(Output::bound),
                             errors = shown.values(Output::error), covered = shown.seen();
    const DrapeMap map(cut_into_facets(shown.tree()->tree, shown.camera(), tol), shown.camera(),
                       scene.picture, tol);
    int seen = 0, over = 0;
    for (int y = 0; y < scene.screen.height; ++y)
        for (int x = 0; x < scene.screen.width; ++x) {
            const auto k = static_cast<std::size_t>(y * scene.screen.width + x);
            Point<double> p{};
            int piece = 0;
            EXPECT_EQ(map.exact(x + 0.5, y + 0.5, 0, p, piece), covered[k] == 1);
            if (covered[k] == 0) {
                EXPECT_EQ(points[2 * k], -1);
                continue;
            }
            ++seen;
            const double u = p.x / scene.picture.width, v = p.y / scene.picture.height;
            const test::OracleSight at = test::oracle_sight(
                scene.pose, scene.screen, test::oracle_surface(scene.surface, scene.shape, u, v));
            const double error = static_cast<double>(std::hypot(at.x - (x + 0.5L), at.y - (y + 0.5L)));
            over += !(error <= bounds[k]) || !(bounds[k] <= tol) ||
                    !(std::fabs(error - errors[k]) <= agree) || !(std::fabs(u - points[2 * k]) <= 1e-7) ||
                    !(std::fabs(v - points[2 * k + 1]) <= 1e-7);
        }
    EXPECT_EQ(over, 0) << scene.surface;
    return seen;
}

TEST(Drape, EveryPointIsSeenWithinTheTolerance) {
    for (const double tol : {0.5, 0.125, 0.02, 0.002})
        for (const Scene& scene : scenes()) {
            // The finest takes as many patches as there are pixels: from one place.
            if (tol < 0.02 && scene.pose.position.x != 1.1) continue;
            DrapeOptions options;
            options.tol = tol;
            Shown shown(scene, options);
            EXPECT_GT(expect_points_in_place(shown, scene, tol), 500) << scene.surface;
        }
}

TEST(Drape, AnalyticSilhouettesAreCoveredWithoutHoles) {
    // A sphere is seen exactly where the ray through a pixel passes within its radius: but for a tolerance.
    for (const double tol : {1.0, 0.125, 0.01})
        for (const Size& screen : {Size{96, 96}, Size{333, 250}}) {
            Scene scene{"sphere"};
            scene.shape.angle = 360;
            scene.pose.position = {0.4, 0.9, 1.5};
            scene.pose.target = {0.1, 0, 0};
            scene.screen = screen;
            DrapeOptions options;
            options.tol = tol;
            const std::vector<float> covered = Shown(scene, options).seen();
            const glm::dvec3 ahead = glm::normalize(scene.pose.target - scene.pose.position),
                             right = glm::normalize(glm::cross(ahead, scene.pose.up)),
                             up = glm::cross(right, ahead);
            const double focal = screen.width / (2 * std::tan(scene.pose.fov * kPi / 360));
            int wrong = 0;
            for (int y = 0; y < screen.height; ++y)
                for (int x = 0; x < screen.width; ++x) {
                    // The largest and the least distance from the axis of the ray, within the tolerance.
                    const auto inside = [&](double radius) {
                        const glm::dvec3 ray =
                            glm::normalize(ahead * focal + right * (x + 0.5 - screen.width / 2.0) -
                                           up * (y + 0.5 - screen.height / 2.0));
                        const glm::dvec3 from = scene.pose.position;
                        return glm::length(glm::cross(ray, from)) < radius;
                    };
                    // A pixel is at most this wide at the sphere.
                    const double margin = tol * 2.2 / focal;
                    const float is = covered[static_cast<std::size_t>(y * screen.width + x)];
                    wrong += inside(0.5 - margin) && is != 1;
                    wrong += !inside(0.5 + margin) && is != 0;
                }
            EXPECT_EQ(wrong, 0) << tol;
        }
}

TEST(Drape, FromInsideThereIsNoHole) {
    // At any zoom: fields of view from 150 to .01 degrees.
    for (const double fov : {150.0, 60.0, 3.0, 0.01})
        for (const double tol : {1.0, 0.125, 0.01}) {
            Scene scene{"sphere"};
            scene.shape.angle = 360;
            scene.pose.position = {0.1, -0.05, 0.2};
            scene.pose.target = {0.7, 0.3, -0.4};
            scene.pose.fov = fov;
            DrapeOptions options;
            options.tol = tol;
            const std::vector<float> covered = Shown(scene, options).seen();
            EXPECT_EQ(std::count(covered.begin(), covered.end(), 0.0f), 0) << fov << " " << tol;
        }
}

TEST(Drape, ASurfaceSeenWholeHidesWhatIsBehindIt) {
    // Height fields over the sheet: every ray that meets the frame's inside meets the surface, so that there is no hole.
    for (const std::string name : {"waves", "ripples", "plane"})
        for (const double tol : {0.5, 0.05}) {
            Scene scene{name};
            scene.pose.position = {0.2, 0.3, 1.2};
            scene.pose.fov = 20;
            scene.shape.direction = 20;
            DrapeOptions options;
            options.tol = tol;
            const std::vector<float> covered = Shown(scene, options).seen();
            EXPECT_EQ(std::count(covered.begin(), covered.end(), 0.0f), 0) << name;
        }
}

TEST(Drape, SheetsCloseTogetherStayInTheirOrder) {
    // A page turned flat over itself, at a distance of 2e-6.
    Scene scene{"page_turn"};
    scene.shape.radius = 1e-6;
    scene.shape.turn = 0.4;
    scene.pose.position = {0, 0, 1.5};
    const std::vector<float> points = Shown(scene).values(Output::stmap),
                             depth = Shown(scene).values(Output::color, DrapeOutput::depth);
    int turned = 0;
    for (std::size_t k = 0; k < depth.size(); ++k) {
        const double x = (static_cast<double>(k % 160) + 0.5 - 80) * 2 * 1.5 * std::tan(20 * kPi / 180) / 160;
        // The line is at .1, and what lies right of it comes to lie left of it, down to -.3.
        if (points[2 * k] < 0 || x > 0.09 || x < -0.29) continue;
        ++turned;
        EXPECT_NEAR(points[2 * k], 0.5 + 0.1 + (0.1 - x), 1e-3);
    }
    EXPECT_GT(turned, 2000);
}

/// How far depths are from those of the points that are shown, by the oracle; at most the bounds of their patches.
struct DepthErrors {
    double worst = 0, bound = 0;
    int pixels = 0;
};
template <class Position>
DepthErrors depth_errors(const Scene& scene, double tol, const Position& position) {
    const Shown shown(scene);
    const Facets facets = cut_into_facets(shown.tree()->tree, shown.camera(), tol);
    const DrapeMap map(facets, shown.camera(), scene.picture, tol);
    DepthErrors errors;
    errors.bound = map.max_depth_error();
    for (int y = 0; y < scene.screen.height; ++y)
        for (int x = 0; x < scene.screen.width; ++x) {
            const auto region = map.region_at(x, y);
            const SeenPixels& pixels = region->pixels();
            const std::size_t at = pixels.index(x, y);
            if (pixels.facet[at] == SeenPixels::kNone) continue;
            const double nearness = map.nearness_at(pixels, at),
                         depth = map.inverse_depth() ? 1 / nearness : -nearness;
            const test::Real truth =
                test::oracle_sight(scene.pose, scene.screen, position(pixels.u[at], pixels.v[at])).ahead;
            const double off = static_cast<double>(std::fabs(truth - depth)),
                         allowed = facets.leaves[map.facet(pixels.facet[at]).leaf].depth_bound;
            EXPECT_LE(off, allowed) << scene.surface << " " << tol << " at " << x << "," << y;
            EXPECT_LE(allowed, errors.bound);
            errors.worst = std::max(errors.worst, off);
            ++errors.pixels;
        }
    return errors;
}

TEST(Drape, DepthsAreWithinTheirBound) {
    for (const Scene& scene : scenes())
        for (const double tol : {0.02, 0.5, 8.0}) {
            const DepthErrors errors = depth_errors(scene, tol, [&](double u, double v) {
                return test::oracle_surface(scene.surface, scene.shape, u, v);
            });
            EXPECT_GT(errors.pixels, 500) << scene.surface;
            // The bound is no guess far above, where there is any error but rounding.
            if (errors.worst > 1e-9) {
                EXPECT_LE(errors.bound, 60 * errors.worst) << scene.surface << " " << tol;
            }
        }
}

TEST(Drape, ABumpTowardsAParallelCameraHasABoundOfItsDepth) {
    // No point of the screen moves, so that few patches serve, flat or nearly so where the bump is.
    Scene scene{"plane"};
    scene.pose.perspective = false;
    scene.pose.extent = 1;
    Deformation bump;
    bump.vector = {0, 0, 0.3};
    bump.center = {0.5, 0.5};
    bump.extent = {0.1, 0.15};
    scene.deformations = {bump};
    const DepthErrors errors = depth_errors(scene, 0.125, [&](double u, double v) {
        // Oka 1987, eq. 4.2: the bump is exp(-r^2), v up.
        const test::Real across = (test::Real(u) - 0.5L) / 0.1L, up = (0.5L - test::Real(v)) / 0.15L;
        const test::Vector flat = test::oracle_surface("plane", scene.shape, u, v);
        return test::Vector{flat[0], flat[1], test::Real(0.3) * std::exp(-across * across - up * up)};
    });
    EXPECT_GT(errors.worst, 0.05);
    EXPECT_GT(errors.bound, errors.worst);
    EXPECT_LT(errors.bound, 100 * errors.worst);
}

/// A surface that counts what it is asked for.
class Counting final : public DrapedSurface {
  public:
    explicit Counting(const std::string& name) : m_of(make_surface(number_of(name), SurfaceShape{})) {}

    glm::dvec3 position(double u, double v) const noexcept override {
        ++points;
        return m_of->position(u, v);
    }
    double rounding(double u, double v) const noexcept override { return m_of->rounding(u, v); }
    SurfaceFrame frame(double u, double v) const noexcept override {
        ++frames;
        return m_of->frame(u, v);
    }
    std::array<DoubleDouble, 3> truth(DoubleDouble u, DoubleDouble v) const noexcept override {
        return m_of->truth(u, v);
    }
    SurfaceRange range(const Interval& u, const Interval& v) const noexcept override {
        ++ranges;
        return m_of->range(u, v);
    }
    Certainty missing(const Interval& u, const Interval& v) const noexcept override {
        return m_of->missing(u, v);
    }
    mutable std::atomic<int> points = 0, frames = 0, ranges = 0;

  private:
    std::shared_ptr<const DrapedSurface> m_of;
};

TEST(Drape, ATileAsksForItsOwnBlocks) {
    const auto surface = std::make_shared<Counting>("waves");
    Scene scene{"waves"};
    scene.own = surface;
    scene.screen = scene.picture = {256, 256};
    const Plain plain(scene.picture, {0.25f, 0.5f, 0.75f});
    for (const DrapeScheme scheme : {DrapeScheme::oka, DrapeScheme::oka_z}) {
        DrapeOptions options;
        options.scheme = scheme;
        options.filter = Filter::antialias;
        options.lighting.shading = DrapeShading::phong;
        options.block = 4;
        constexpr int kBlocks = 64 * 64;
        const Shown shown(scene, options);
        const Drape drape(shown.tree(), shown.camera(), scene.picture, options);
        const auto drawn = [&](const Box& box) {
            surface->points = surface->frames = surface->ranges = 0;
            std::vector<float> pixels(static_cast<std::size_t>(box.width() * box.height() * 3));
            EXPECT_TRUE(drape.draw(plain.source(), box,
                                   packed_view(reinterpret_cast<std::byte*>(pixels.data()),
                                               PixelType::float32, box.width(), box.height(), 3),
                                   serial_for));
        };
        // Five points and four lit corners for each block of the tile, and of the runs that these are made in.
        drawn({92, 92, 124, 124});
        EXPECT_GT(surface->points, 0);
        EXPECT_LT(surface->points, 5 * kBlocks / 4);
        EXPECT_GT(surface->frames, 0);
        EXPECT_LT(surface->frames, 4 * kBlocks / 4);
        EXPECT_EQ(surface->ranges, 0) << "nothing is bounded";
        drawn({92, 92, 124, 124});
        EXPECT_EQ(surface->points, 0);
        drape.reached(serial_for);
        EXPECT_GT(surface->ranges, 0);
    }
}

TEST(Drape, HardCasesAreDrawn) {
    const auto covered = [](const Scene& scene) {
        const std::vector<float> all = Shown(scene).seen();
        return std::count(all.begin(), all.end(), 1.0f);
    };
    Scene edge_on;
    edge_on.pose.position = {2, 0, 0};
    EXPECT_LE(covered(edge_on), 160);
    Scene behind;
    behind.pose.position = {0, 0, -2};
    behind.pose.target = {0, 0, -3};
    EXPECT_EQ(covered(behind), 0);
    // The plane reaches behind the camera, and is clipped there, not mirrored: it ends at the horizon.
    Scene ground;
    ground.pose.position = {0, -0.2, 0.05};
    ground.pose.target = {0, 0.3, 0.05};
    ground.pose.up = {0, 0, 1};
    ground.pose.fov = 90;
    const std::vector<float> below = Shown(ground).seen();
    EXPECT_EQ(std::count(below.begin(), below.begin() + 160 * 60, 1.0f), 0);
    EXPECT_EQ(std::count(below.begin() + 160 * 100, below.end(), 1.0f), 160 * 20);
    Scene torus{"torus"};
    torus.shape.tube = 0.8;  // it meets itself
    EXPECT_GT(covered(torus), 5000);
    Scene far;
    far.deformations = {{{0, 0, 1e12}, {0.5, 0.5}, {0.1, 0.1}}};
    far.screen = {40, 30};
    EXPECT_GE(covered(far), 0);
    Scene needle;
    needle.deformations = {{{0, 0, 0.1}, {0.5, 0.5}, {1e-12, 1e-12}}};
    EXPECT_GT(covered(needle), 1000);
    for (const Size& picture : {Size{1, 1}, Size{1, 30000}}) {
        Scene strip{"cylinder"};
        strip.picture = picture;
        const std::vector<float> texels(static_cast<std::size_t>(picture.width * picture.height), 0.5f);
        const MemorySource source(packed_view(reinterpret_cast<const std::byte*>(texels.data()),
                                              PixelType::float32, picture.width, picture.height, 1));
        DrapeOptions options;
        options.filter = Filter::bilinear;
        const std::vector<float> drawn = Shown(strip, options).draw(&source, 1);
        for (const float value : drawn) EXPECT_TRUE(value == 0 || std::fabs(value - 0.5f) < 1e-6f) << value;
    }
}

/// What the blocks of a scene are off, block by block: the largest error at a pixel, and the bound; of those that show
/// at least `least` pixels.
struct BlockErrors {
    std::vector<double> error, bound;

    BlockErrors(const Scene& scene, double side, int least) {
        DrapeOptions options;
        options.scheme = DrapeScheme::oka_z;
        options.block = side;
        Shown shown(scene, options);
        const std::vector<float> errors = shown.values(Output::error), bounds = shown.values(Output::bound),
                                 blocks = shown.values(Output::color, DrapeOutput::patch);
        std::map<float, std::array<double, 3>> found;  // pixels, error, bound
        for (std::size_t k = 0; k < errors.size(); ++k) {
            EXPECT_LE(errors[k], bounds[k] + 1e-4);
            if (blocks[k] < 0) continue;
            std::array<double, 3>& one = found[blocks[k]];
            one = {one[0] + 1, std::max(one[1], double{errors[k]}), bounds[k]};
        }
        for (const auto& [block, one] : found) {
            if (one[0] < least) continue;
            error.push_back(one[1]);
            bound.push_back(one[2]);
        }
    }
};

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
}

/// Scenes of three pixels a texel, so that pixels come near the worst points of blocks.
std::vector<Scene> scenes_of_blocks(const std::vector<std::string>& names) {
    std::vector<Scene> all;
    for (const std::string& name : names) {
        Scene scene{name};
        scene.shape.angle = 150;
        scene.picture = {512, 512};
        scene.screen = {512, 512};
        scene.pose.position = {0.8, -0.6, 1.7};
        scene.pose.fov = 10;
        all.push_back(scene);
    }
    return all;
}

TEST(Drape, ErrorsOfParallelogramsGoAsTheSquareOfTheirSide) {
    // Oka 1987, (2.10): the slope of log(error) over log(d) is 2, by least squares over d = 4 to 32.
    for (const Scene& scene : scenes_of_blocks({"cylinder", "sphere", "ripples"})) {
        std::vector<double> logs;
        for (const double side : {4.0, 8.0, 16.0, 32.0}) {
            const std::vector<double> errors = BlockErrors(scene, side, 1).error;
            logs.push_back(std::log2(std::accumulate(errors.begin(), errors.end(), 0.0) /
                                     static_cast<double>(errors.size())));
        }
        const double slope = (3 * (logs[3] - logs[0]) + logs[2] - logs[1]) / 10;
        EXPECT_NEAR(slope, 2, 0.1) << scene.surface << testing::PrintToString(logs);
    }
}

TEST(Drape, BoundsOfParallelogramsAreNotFarFromTheirErrors) {
    std::vector<Scene> all =
        scenes_of_blocks({"cylinder", "sphere", "torus", "ripples", "waves", "plane", "plane"});
    constexpr unsigned kSeed = 9;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 50; ++i)
        all[5].deformations.push_back({{0, 0, 0.1 * uniform(random) - 0.03},
                                       {uniform(random), uniform(random)},
                                       glm::dvec2(0.03 + 0.1 * uniform(random))});
    std::vector<float> heights(64 * 64);
    for (float& h : heights) h = static_cast<float>(uniform(random));
    SurfaceSum relief;
    relief.heights = std::make_shared<SampledField>(smoothed(heights, {64, 64}, 4), Size{64, 64}, 1);
    relief.height_scale = 0.3;
    all[6].own = make_surface(relief);
    // These take longer: a part of the view.
    for (Scene* scene : {&all[5], &all[6]}) {
        scene->screen = {200, 200};
        scene->pose.fov = 3.9;
    }
    for (const Scene& scene : all) {
        // Those that are seen nearly whole.
        const BlockErrors blocks(scene, 8, 250);
        ASSERT_GT(blocks.error.size(), 50u) << scene.surface;
        std::vector<double> ratios;
        for (std::size_t i = 0; i < blocks.error.size(); ++i)
            ratios.push_back(blocks.bound[i] / blocks.error[i]);
        EXPECT_LT(median(ratios), 2) << scene.surface;
    }
}

TEST(Drape, ShadingFollowsTheNormals) {
    // A sphere lit from the camera: the normal at a pixel is the point itself over the radius.
    Scene scene{"sphere"};
    scene.shape.angle = 360;
    scene.pose.perspective = false;
    scene.pose.extent = 1.2;
    scene.pose.position = {0, 0, 5};
    const std::vector<float> normals = Shown(scene).values(Output::color, DrapeOutput::normal),
                             covered = Shown(scene).seen();
    const std::vector<float> texels(64 * 64 * 3, 1);
    const MemorySource source(
        packed_view(reinterpret_cast<const std::byte*>(texels.data()), PixelType::float32, 64, 64, 3));
    for (const DrapeShading shading : {DrapeShading::gouraud, DrapeShading::phong}) {
        DrapeOptions options;
        options.lighting = {shading, {{0, 0, 1}}, 0.1, 0.6, 0.2, 8};
        const std::vector<float> lit = Shown(scene, options).draw(&source, 3);
        for (int y = 0; y < 120; ++y)
            for (int x = 0; x < 160; ++x) {
                const auto k = static_cast<std::size_t>(y * 160 + x);
                const double px = (x + 0.5 - 80) * 1.2 / 160, py = -(y + 0.5 - 60) * 1.2 / 160;
                const double pz = std::sqrt(std::max(0.0, 0.25 - px * px - py * py));
                if (covered[k] == 0 || pz < 0.05) continue;
                EXPECT_NEAR(normals[3 * k], px / 0.5, 0.01);
                EXPECT_NEAR(normals[3 * k + 1], py / 0.5, 0.01);
                EXPECT_NEAR(normals[3 * k + 2], pz / 0.5, 0.02);
                const double n_l = pz / 0.5;
                EXPECT_NEAR(lit[3 * k], 0.1 + 0.6 * n_l + 0.2 * std::pow(n_l, 8), 0.03);
            }
    }
}

TEST(Drape, FacetsAreTheSameOnEveryInstructionSet) {
    Scene scene{"torus"};
    scene.pose.position = {1.1, 0.7, 1.3};
    std::vector<std::vector<float>> maps;
    test::on_every_instruction_set([&] { maps.push_back(Shown(scene).values(Output::stmap)); });
    for (const std::vector<float>& map : maps) EXPECT_TRUE(map == maps.front());
}

TEST(Drape, AConstantPictureStaysConstant) {
    const std::vector<float> texels(64 * 64, 0.75f);
    const MemorySource source(
        packed_view(reinterpret_cast<const std::byte*>(texels.data()), PixelType::float32, 64, 64, 1));
    for (const Filter filter : {Filter::nearest, Filter::bilinear, Filter::antialias})
        for (const Scene& scene : scenes()) {
            DrapeOptions options;
            options.filter = filter;
            Shown shown(scene, options);
            const std::vector<float> drawn = shown.draw(&source, 1), covered = shown.seen(),
                                     shares = shown.coverage();
            const int width = scene.screen.width, height = scene.screen.height;
            int slits = 0;
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const auto at = [&](int i, int j) {
                        return covered[static_cast<std::size_t>(std::clamp(j, 0, height - 1) * width +
                                                                std::clamp(i, 0, width - 1))];
                    };
                    const float value = drawn[static_cast<std::size_t>(y * width + x)];
                    // Edge pixels of an antialiased picture are covered in part, and so are those that see a slit
                    // between two sheets. Of the outermost ones the edge may lie beyond the screen; each shows as much as
                    // its share.
                    const float share = shares[static_cast<std::size_t>(y * width + x)];
                    EXPECT_NEAR(value, 0.75f * share, 1e-5f) << scene.surface << " " << x << " " << y;
                    const bool outermost = x == 0 || y == 0 || x + 1 == width || y + 1 == height;
                    const bool edge = outermost || at(x - 1, y) != at(x, y) || at(x + 1, y) != at(x, y) ||
                                      at(x, y - 1) != at(x, y) || at(x, y + 1) != at(x, y);
                    const bool whole = std::fabs(value - 0.75f * at(x, y)) <= 1e-5f;
                    EXPECT_TRUE(whole || (filter == Filter::antialias && value >= 0 && value < 0.75f))
                        << scene.surface << " " << value;
                    slits += !whole && !edge;
                }
            EXPECT_LE(slits, 5) << scene.surface;
        }
}

TEST(Drape, EdgesAreCoveredAsFarAsTheSilhouetteSays) {
    // A sphere seen in parallel is a disc. Against 64 x 64 samples of it; a pixel's samples are 8 x 8, and the silhouette
    // may be off by the tolerance.
    Scene scene{"sphere"};
    scene.shape.angle = 360;
    scene.pose.perspective = false;
    scene.pose.extent = 1.3;
    scene.pose.position = {0.03, 0.02, 5};
    scene.pose.target = {0.03, 0.02, 0};
    DrapeOptions options;
    options.tol = 0.02;
    options.background = {0.25f};
    const std::vector<float> texels(64 * 64, 1.0f);
    const MemorySource source(
        packed_view(reinterpret_cast<const std::byte*>(texels.data()), PixelType::float32, 64, 64, 1));
    const std::vector<float> drawn = Shown(scene, options).draw(&source, 1);
    const double unit = 160 / 1.3, radius = 0.5 * unit;
    double sum = 0, worst = 0;
    int edges = 0;
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 160; ++x) {
            int inside = 0;
            for (int j = 0; j < 64; ++j)
                for (int i = 0; i < 64; ++i)
                    inside += std::hypot(x + (i + 0.5) / 64 - 80 + 0.03 * unit,
                                         y + (j + 0.5) / 64 - 60 - 0.02 * unit) < radius;
            const double truth = 0.25 + 0.75 * inside / 4096;
            const double off = std::fabs(drawn[static_cast<std::size_t>(y * 160 + x)] - truth);
            worst = std::max(worst, off);
            if (inside > 0 && inside < 4096) {
                sum += off;
                ++edges;
            }
        }
    EXPECT_GT(edges, 300);
    // A row or column of samples, and the tolerance.
    EXPECT_LT(worst, 0.75 * (1.0 / 8 + 0.03));
    EXPECT_LT(sum / edges, 0.75 * 0.03);
}

TEST(Drape, FacetsMeetAlongWholeEdgesAlsoNextToWhatIsHidden) {
    constexpr unsigned kSeed = 12;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 150; ++i) {
        Scene scene;
        for (int n = 0; n < 6; ++n)
            scene.deformations.push_back(
                {{0, 0, uniform(random) - 0.5},
                 {uniform(random), uniform(random)},
                 {0.02 + 0.2 * uniform(random), 0.02 + 0.2 * uniform(random)},
                 n % 2 ? DeformationKernel::gaussian : DeformationKernel::wendland_c2});
        scene.pose.position = {uniform(random) - 0.5, uniform(random) - 0.5, 0.6 + uniform(random)};
        scene.pose.target = {uniform(random) - 0.5, uniform(random) - 0.5, 0};
        const Shown shown(scene);
        const Facets facets = cut_into_facets(shown.tree()->tree, shown.camera(), 4);
        // Edges along u or v that a single facet has: (line, from) to the other end.
        std::map<std::array<double, 4>, int> uses;
        for (const Facet& facet : facets.facets)
            for (int k = 0; k < 3; ++k) {
                const FacetCorner &p = facets.corners[facet.corner[k]],
                                  &q = facets.corners[facet.corner[(k + 1) % 3]];
                if (p.u == q.u) ++uses[{0, p.u, std::min(p.v, q.v), std::max(p.v, q.v)}];
                if (p.v == q.v) ++uses[{1, p.v, std::min(p.u, q.u), std::max(p.u, q.u)}];
            }
        std::vector<std::array<double, 4>> single;
        for (const auto& [edge, count] : uses)
            if (count == 1) single.push_back(edge);
        for (std::size_t k = 1; k < single.size(); ++k) {
            const auto &before = single[k - 1], &edge = single[k];
            const bool same_line = before[0] == edge[0] && before[1] == edge[1];
            EXPECT_FALSE(same_line && before[3] > edge[2])
                << i << ": a crack at " << edge[1] << ", " << edge[2];
        }
    }
}

TEST(Drape, FacetsDoNotDependOnTheViewsBefore) {
    Scene scene{"torus"};
    scene.pose.position = {1.1, 0.7, 1.3};
    const Shown shown(scene), fresh(scene);
    scene.pose.position = {-0.4, 0.2, 0.9};
    FacetRoom room;
    cut_into_facets(shown.tree()->tree, Shown(scene).camera(), 0.02, room);
    cut_into_facets(shown.tree()->tree, shown.camera(), 0.25, room);
    const Facets wanted = cut_into_facets(fresh.tree()->tree, fresh.camera(), 0.25);
    ASSERT_EQ(room.facets.facets.size(), wanted.facets.size());
    ASSERT_EQ(room.facets.corners.size(), wanted.corners.size());
    for (std::size_t i = 0; i < wanted.facets.size(); ++i)
        for (int k = 0; k < 3; ++k)
            ASSERT_EQ(room.facets.facets[i].corner[k], wanted.facets[i].corner[k]) << i;
    for (std::size_t i = 0; i < wanted.corners.size(); ++i) {
        const FacetCorner &a = room.facets.corners[i], &b = wanted.corners[i];
        ASSERT_TRUE(a.x == b.x && a.y == b.y && a.weight == b.weight && a.u == b.u && a.v == b.v) << i;
    }
}

TEST(Drape, PatchesNextToSmallerOnesHaveAsFewFacetsAsTheirCornersAllow) {
    // Of n corners round a patch, n - 2.
    Scene scene;
    scene.deformations = {{{0, 0, 0.4}, {0.3, 0.4}, {0.1, 0.1}, DeformationKernel::gaussian}};
    const Shown shown(scene);
    const Facets facets = cut_into_facets(shown.tree()->tree, shown.camera(), 0.125);
    std::map<std::uint32_t, std::set<std::uint32_t>> corners;
    std::map<std::uint32_t, std::size_t> counts;
    for (const Facet& facet : facets.facets) {
        corners[facet.leaf].insert(std::begin(facet.corner), std::end(facet.corner));
        ++counts[facet.leaf];
    }
    std::size_t five = 0;
    for (const auto& [leaf, own] : corners) {
        if (own.size() > 5) continue;
        EXPECT_EQ(counts[leaf], own.size() - 2) << leaf;
        five += own.size() == 5;
    }
    EXPECT_GT(five, 20u);
}

TEST(Drape, WhatIsSeenFromVeryNearIsDrawnOrRefused) {
    Scene scene;
    scene.pose.perspective = false;
    scene.pose.extent = 1e-6;
    scene.screen = {64, 64};
    Shown near(scene);
    EXPECT_EQ(expect_points_in_place(near, scene, 0.125), 64 * 64);
    // What double loses of a wave of this amplitude is seen.
    scene.surface = "waves";
    scene.shape.amplitude = 1000;
    scene.shape.wavelength = 0.01;
    scene.shape.phase = 1000;
    scene.pose.position = {0.0005, 0.001, 0};
    scene.pose.up = {0, 0, 1};
    scene.pose.extent = 1e-9;
    EXPECT_THROW(Shown(scene).seen(), Error);
    scene.pose.extent = 1e-3;
    Shown shown(scene);
    expect_points_in_place(shown, scene, 0.125, 1e-3);
}

TEST(Drape, NarrowDeformationsAreDrawn) {
    for (const glm::dvec2 extent :
         {glm::dvec2(1e-7, 1000), glm::dvec2(1e-12, 1000), glm::dvec2(1e-12, 1e-12)}) {
        Scene scene;
        scene.deformations = {{{0, 0, 0.5}, {0.5, 0.5}, extent}};
        scene.pose.position = {0.3, 0.3, 1.5};
        scene.screen = {64, 64};
        const std::vector<float> covered = Shown(scene).seen();
        EXPECT_GT(std::count(covered.begin(), covered.end(), 1.0f), 500);
    }
    Scene dense{"ripples"};
    dense.shape.amplitude = 1000;
    dense.shape.wavelength = 0.01;
    dense.pose.position = {0.3, 0.3, 1.5};
    try {
        Shown(dense).seen();
        ADD_FAILURE() << "four million patches";
    } catch (const Error& error) {
        // No tolerance up to 64 times as large works either.
        EXPECT_THAT(error.what(), testing::StartsWith("tol=0.125: takes more than"));
        EXPECT_THAT(error.what(), testing::HasSubstr(" patches of the surface, and so does 8"));
    }
}

TEST(Drape, TheErrorSaysTheLeastToleranceThatWorks) {
    Scene dense{"ripples"};
    dense.shape.amplitude = 0.5;
    dense.shape.wavelength = 0.05;
    dense.screen = {64, 64};
    try {
        Shown(dense).seen();
        ADD_FAILURE() << "too few patches";
    } catch (const Error& error) {
        const std::string text = error.what(), ahead = " patches of the surface: must be at least ";
        EXPECT_THAT(text, testing::HasSubstr("tol=0.125: takes more than"));
        const std::size_t at = text.find(ahead);
        ASSERT_NE(at, std::string::npos) << text;
        DrapeOptions options;
        options.tol = std::stod(text.substr(at + ahead.size()));
        EXPECT_NO_THROW(Shown(dense, options).seen()) << text;
        options.tol *= 0.75;
        EXPECT_THROW(Shown(dense, options).seen(), Error) << text;
    }
}

TEST(Drape, CoverageIsTheShareThatColorsAreFadedBy) {
    for (const DrapeScheme scheme : {DrapeScheme::automatic, DrapeScheme::exact, DrapeScheme::oka}) {
        Scene scene{"sphere"};
        scene.shape.angle = 360;
        scene.pose.position = {0.3, 0.2, 1.9};
        scene.screen = {150, 140};
        DrapeOptions options;
        options.scheme = scheme;
        const Plain white({64, 64}, {1, 1, 1});
        for (const Filter filter : {Filter::antialias, Filter::pyramid, Filter::bilinear}) {
            options.filter = filter;
            Shown shown(scene, options);
            const std::vector<float> drawn = Shown(scene, options).draw(white.source(), 3),
                                     covered = shown.coverage(), seen = shown.seen();
            int shares = 0, pixels = 0;
            double area = 0;
            for (std::size_t i = 0; i < covered.size(); ++i) {
                ASSERT_NEAR(covered[i], drawn[3 * i], 1e-6) << i;
                ASSERT_TRUE(seen[i] == 0 || seen[i] == 1);
                shares += covered[i] > 0 && covered[i] < 1;
                pixels += seen[i] == 1;
                area += covered[i];
            }
            EXPECT_EQ(shares > 100, averages(filter)) << shares;
            EXPECT_NEAR(area, pixels, 0.01 * pixels);
        }
    }
}

TEST(Drape, EdgesMixWhatIsMultipliedWithItsAlpha) {
    std::vector<float> texels;
    for (int i = 0; i < 64 * 64; ++i) texels.insert(texels.end(), {0.4f, 0.4f, 0.4f, 0.5f});
    const MemorySource source(
        packed_view(reinterpret_cast<const std::byte*>(texels.data()), PixelType::float32, 64, 64, 4), 3);
    Scene scene{"sphere"};
    scene.shape.angle = 360;
    scene.pose.position = {0.2, 0.3, 2.5};
    for (const std::vector<float>& background :
         {std::vector<float>{1, 1, 1, 0}, std::vector<float>{1, 1, 1}, std::vector<float>{1, 1, 1, 0.5f}}) {
        DrapeOptions options;
        options.background = background;
        for (const float value : Shown(scene, options).draw(&source, 4)) EXPECT_LE(value, 1.00001f);
    }
}

TEST(Drape, WhatIsTransparentShowsWhatIsBehind) {
    // Porter and Duff 1984, over: C = F + (1 - a_F) B, of colours multiplied with their alpha. In front .4 at alpha .5;
    // behind it a picture of .6 at alpha .75 over a colour of 1 at alpha .5.
    Scene scene{"sphere"};
    scene.shape.angle = 360;
    scene.pose.position = {0.2, 0.3, 2.5};
    DrapeOptions options;
    options.alpha = 1;
    options.background = {0.5f, 0.5f};
    const std::vector<float> covered = Shown(scene, options).seen();
    const Plain multiplied({64, 64}, {0.2f, 0.5f}), straight({64, 64}, {0.4f, 0.5f}, 1),
        opaque({32, 32}, {0.6f}), veil({32, 32}, {0.45f, 0.75f});
    struct Case {
        const Source *front, *behind;
        int behind_alpha;
        float value, alpha;
    };
    for (const Case& c : {Case{multiplied.source(), nullptr, -1, 0.5f, 0.5f},
                          Case{multiplied.source(), opaque.source(), -1, 0.6f, 1},
                          Case{multiplied.source(), veil.source(), 1, 0.45f + 0.25f * 0.5f, 0.875f},
                          Case{straight.source(), nullptr, -1, 0.5f, 0.5f},
                          Case{straight.source(), opaque.source(), -1, 0.6f, 1}}) {
        DrapeOptions o = options;
        o.backdrop_alpha = c.behind_alpha;
        const bool is_straight = c.front == straight.source();
        // A background's colour is as the picture's.
        const float behind = is_straight && !c.behind ? c.value * c.alpha : c.value;
        const std::vector<float> drawn = Shown(scene, o).draw(c.front, 2, c.behind);
        for (std::size_t k = 0; k < covered.size(); ++k) {
            const float alpha = drawn[2 * k + 1], value = drawn[2 * k] * (is_straight ? alpha : 1);
            const float whole = 0.2f + 0.5f * behind, whole_alpha = 0.5f + 0.5f * c.alpha;
            // Between what is behind and what is in front, as far as the pixel is covered.
            const float share = (value - behind) / (whole - behind);
            EXPECT_NEAR(alpha, c.alpha + share * (whole_alpha - c.alpha), 2e-5f);
            EXPECT_GE(share, -1e-5f);
            EXPECT_LE(share, 1 + 1e-5f);
        }
        const std::size_t middle = 60 * 160 + 80;
        ASSERT_EQ(covered[middle], 1);
        EXPECT_NEAR(drawn[2 * middle + 1], 0.5f + 0.5f * c.alpha, 1e-6f);
        EXPECT_EQ(covered[0], 0);
        EXPECT_NEAR(drawn[1], c.alpha, 1e-6f);
    }
}

TEST(Drape, ABackdropOfTheScreensSizeIsSeenAsItStands) {
    Scene scene{"sphere"};
    scene.shape.angle = 360;
    scene.pose.position = {0.2, 0.3, 2.5};
    std::vector<float> behind;
    for (int i = 0; i < 160 * 120; ++i) behind.push_back(static_cast<float>(i * 7919 % 1009) / 1009);
    const MemorySource backdrop(
        packed_view(reinterpret_cast<const std::byte*>(behind.data()), PixelType::float32, 160, 120, 1));
    const Plain front({64, 64}, {2.0f});
    const std::vector<float> drawn = Shown(scene).draw(front.source(), 1, &backdrop),
                             covered = Shown(scene).seen();
    int seen = 0;
    for (int y = 1; y < 119; ++y)
        for (int x = 1; x < 159; ++x) {
            const auto at = [&](int i, int j) { return covered[static_cast<std::size_t>(j * 160 + i)]; };
            const auto k = static_cast<std::size_t>(y * 160 + x);
            const float about = at(x - 1, y) + at(x + 1, y) + at(x, y - 1) + at(x, y + 1) + at(x, y);
            const bool inside = about == 5, outside = about == 0;
            if (inside || outside) {
                EXPECT_EQ(drawn[k], inside ? 2.0f : behind[k]);
            }
            seen += outside;
        }
    EXPECT_GT(seen, 1000);
}

/// Of the blocks whose parallelogram holds a place on the screen, what the one shows that is nearest in its middle, or there.
Point<double> nearest_block_at(const std::vector<OkaBlock>& blocks, double x, double y, bool linear_depth) {
    Point<double> found{-1, -1};
    double nearest = HUGE_VAL;
    for (const OkaBlock& b : blocks) {
        const double dx = x - b.centre.x, dy = y - b.centre.y;
        const double area = b.by_u.x * b.by_v.y - b.by_u.y * b.by_v.x;
        const double s = (dx * b.by_v.y - dy * b.by_v.x) / area, t = (dy * b.by_u.x - dx * b.by_u.y) / area;
        if (!(b.u + s >= b.u0 && b.u + s < b.u1 && b.v + t >= b.v0 && b.v + t < b.v1)) continue;
        const double depth = b.centre.z + (linear_depth ? s * b.by_u.z + t * b.by_v.z : 0);
        if (!(depth < nearest)) continue;
        nearest = depth;
        found = {b.u + s, b.v + t};
    }
    return found;
}

/// Each pixel shows the block that nearest_block_at finds.
void expect_nearest_blocks(const char* surface, const CameraPose& pose) {
    for (const DrapeScheme scheme : {DrapeScheme::oka, DrapeScheme::oka_z}) {
        Scene scene{surface};
        scene.pose = pose;
        DrapeOptions options;
        options.scheme = scheme;
        options.block = 4;
        options.overlap = 1;
        Shown shown(scene, options);
        const std::vector<float> points = shown.values(Output::stmap);
        const OkaBlocks cut{options.block, options.overlap, scheme == DrapeScheme::oka_z};
        std::vector<OkaBlock> blocks;
        for (int j = 0; j < 16; ++j)
            for (int i = 0; i < 16; ++i)
                if (OkaBlock b;
                    oka_block(shown.tree()->tree.surface(), shown.camera(), scene.picture, cut, i, j, b))
                    blocks.push_back(b);
        int differ = 0, seen = 0;
        for (int y = 0; y < scene.screen.height; ++y)
            for (int x = 0; x < scene.screen.width; ++x) {
                const auto k = static_cast<std::size_t>(2 * (y * scene.screen.width + x));
                const Point<double> truth =
                    nearest_block_at(blocks, x + 0.5 - scene.screen.width / 2.0,
                                     y + 0.5 - scene.screen.height / 2.0, cut.linear_depth);
                differ += std::hypot(points[k] - truth.x, points[k + 1] - truth.y) > 1e-6;
                seen += truth.x >= 0;
            }
        EXPECT_GT(seen, 2000) << surface;
        // Where two are as near as each other, which is a matter of rounding.
        EXPECT_LE(differ, scene.screen.width * scene.screen.height / 500) << surface;
    }
}

TEST(Drape, BlocksLieOverThoseThatAreFarther) {
    for (const char* surface : {"sphere", "page_turn", "torus"}) {
        expect_nearest_blocks(surface, {.position = {0.7, 0.4, 1.6}});
        // Where the depths of all blocks are one number in float.
        expect_nearest_blocks(surface, {.position = {7e8, 4e8, 16e8}, .perspective = false, .extent = 1.3});
    }
}

/// A drape's colours, drawn in parts of this size.
std::vector<float> drawn_in_parts(const Drape& drape, const Source& source, const Size& screen,
                                  const Size& part) {
    std::vector<float> pixels(static_cast<std::size_t>(3 * screen.width * screen.height));
    for (int y = 0; y < screen.height; y += part.height)
        for (int x = 0; x < screen.width; x += part.width) {
            const Box box =
                intersection({x, y, x + part.width, y + part.height}, {0, 0, screen.width, screen.height});
            std::vector<float> own(static_cast<std::size_t>(3 * box.width() * box.height()));
            EXPECT_TRUE(drape.draw(&source, box,
                                   packed_view(reinterpret_cast<std::byte*>(own.data()), PixelType::float32,
                                               box.width(), box.height(), 3),
                                   serial_for));
            for (int j = 0; j < box.height(); ++j)
                std::copy_n(own.begin() + 3 * j * box.width(), 3 * box.width(),
                            pixels.begin() + 3 * ((box.y0 + j) * screen.width + box.x0));
        }
    return pixels;
}

TEST(Drape, BlocksHaveTheSameBitsInPartsAndOnEveryInstructionSet) {
    for (const Size& picture : {Size{64, 64}, Size{1, 1}, Size{1, 3000}})
        for (const DrapeScheme scheme : {DrapeScheme::oka, DrapeScheme::oka_z}) {
            // A block that goes all round has no linear map.
            Scene scene{picture.width > 1 ? "sphere" : "cylinder"};
            scene.shape.angle = picture.width > 1 ? 360 : 90;
            scene.picture = picture;
            scene.pose.position = {0.4, 0.3, 1.2};
            const Shown shown(scene);
            std::vector<float> texels(static_cast<std::size_t>(3 * picture.width * picture.height));
            for (std::size_t i = 0; i < texels.size(); ++i)
                texels[i] = static_cast<float>(i * 37 % 101 + 1) / 102;
            const MemorySource source(packed_view(reinterpret_cast<const std::byte*>(texels.data()),
                                                  PixelType::float32, picture.width, picture.height, 3));
            DrapeOptions options;
            options.scheme = scheme;
            options.block = 4;
            options.lighting.shading = DrapeShading::phong;
            const Drape drape(shown.tree(), shown.camera(), picture, options);
            const std::vector<float> whole = drawn_in_parts(drape, source, scene.screen, scene.screen);
            EXPECT_GT(std::count_if(whole.begin(), whole.end(), [](float v) { return v > 0; }), 5000);
            EXPECT_EQ(whole, drawn_in_parts(drape, source, scene.screen, {37, 23}));
            for (const char* const* set = anamorph::simd::instruction_sets(); *set; ++set) {
                SCOPED_TRACE(*set);
                ASSERT_TRUE(anamorph::simd::use_instruction_set(*set));
                const std::vector<float> points = Shown(scene, options).values(Output::stmap);
                anamorph::simd::use_instruction_set("");
                EXPECT_EQ(points, Shown(scene, options).values(Output::stmap));
            }
        }
}

TEST(Drape, BlocksBehindTheCameraAndEdgeOnAreLeftOut) {
    for (const glm::dvec3& position :
         {glm::dvec3(0.1, 0.05, 0), glm::dvec3(0, 0, 1e-9), glm::dvec3(3, 0, 0)}) {
        Scene scene{position.x == 3 ? "plane" : "sphere"};
        scene.shape.angle = 360;
        scene.pose.position = position;
        scene.pose.target = position - glm::dvec3(1, 0, 0);
        for (const DrapeScheme scheme : {DrapeScheme::oka, DrapeScheme::oka_z}) {
            DrapeOptions options;
            options.scheme = scheme;
            Shown shown(scene, options);
            const std::vector<float> depths = shown.values(Output::color, DrapeOutput::depth);
            for (const float depth : depths) EXPECT_GT(depth, 0);
            const auto seen =
                std::count_if(depths.begin(), depths.end(), [](float d) { return d < HUGE_VALF; });
            if (position.x == 3)
                EXPECT_EQ(seen, 0);
            else
                EXPECT_GT(seen, 1000);
        }
    }
}

/// A floor that begins behind the camera: every ray that meets it in front shows it, by the paper's blocks, too, of any size, where it
/// belongs as far as the bound says. The ray's own equation is the reference.
TEST(Drape, BlocksPartlyBehindTheCameraAreDrawnInParts) {
    for (const double block : {4.0, 16.0, 64.0})
        for (const DrapeScheme scheme : {DrapeScheme::oka, DrapeScheme::oka_z}) {
            Scene scene;
            scene.pose = {.position = {0.03, -0.1, 0.08}, .target = {0, 0.3, 0}, .up = {0, 0, 1}, .fov = 90};
            DrapeOptions options;
            options.scheme = scheme;
            options.block = block;
            Shown shown(scene, options);
            const Drape drape(shown.tree(), shown.camera(), scene.picture, options);
            EXPECT_EQ(drape.left_out(), 0);
            const double bound = drape.reached(serial_for).max_error;
            const std::vector<float> points = shown.values(Output::stmap);
            const int width = scene.screen.width, height = scene.screen.height;
            const glm::dvec3 eye = scene.pose.position, ahead = glm::normalize(scene.pose.target - eye),
                             right = glm::normalize(glm::cross(ahead, scene.pose.up)),
                             down = glm::cross(ahead, right);
            int floor = 0, empty = 0;
            double worst = 0;
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const glm::dvec3 ray = ahead + (2 * x + 1 - width) / double(width) * right +
                                           (2 * y + 1 - height) / double(width) * down;
                    const glm::dvec3 at = eye - eye.z / ray.z * ray;
                    const double u = at.x + 0.5, v = 0.5 - at.y;
                    // Well within the picture, whose far edges are thrown by as much as the bound.
                    if (!(ray.z < 0 && std::fmin(u, 1 - u) > 0.1 && std::fmin(v, 1 - v) > 0.1)) continue;
                    ++floor;
                    const float* const shows = &points[static_cast<std::size_t>(2 * (y * width + x))];
                    if (shows[0] < 0) {
                        ++empty;
                        continue;
                    }
                    const glm::dvec3 drawn = glm::dvec3(shows[0] - 0.5, 0.5 - shows[1], 0) - eye;
                    const double scale = 0.5 * width / glm::dot(drawn, ahead);
                    worst = std::fmax(worst,
                                      std::hypot(scale * glm::dot(drawn, right) - (x + 0.5 - 0.5 * width),
                                                 scale * glm::dot(drawn, down) - (y + 0.5 - 0.5 * height)));
                }
            EXPECT_GT(floor, 4000);
            // Steep blocks that are all in front of the camera are drawn by their linear maps, which may not meet.
            EXPECT_LE(empty, block > 4 ? floor / 20 : 0) << block;
            EXPECT_LE(worst, bound + 1e-3) << block;
        }
    // Straight through the floor: what is nearer than the near plane is counted.
    Scene scene;
    scene.pose = {.position = {0, 0, 1e-4}, .target = {0, 0, -1}};
    DrapeOptions options;
    options.scheme = DrapeScheme::oka;
    const Shown shown(scene, options);
    EXPECT_EQ(Drape(shown.tree(), shown.camera(), scene.picture, options).left_out(), 0);
    scene.pose = {.position = {0, 0, 1e-6}, .target = {0, 0.5, 0}, .up = {0, 0, 1}};
    const Shown grazing(scene, options);
    EXPECT_GT(Drape(grazing.tree(), grazing.camera(), scene.picture, options).left_out(), 0);
}

/// Counts how often it is asked for ranges.
class CountedSurface final : public DrapedSurface {
  public:
    explicit CountedSurface(std::shared_ptr<const DrapedSurface> surface) : m_surface(std::move(surface)) {}
    glm::dvec3 position(double u, double v) const noexcept override { return m_surface->position(u, v); }
    double rounding(double u, double v) const noexcept override { return m_surface->rounding(u, v); }
    SurfaceFrame frame(double u, double v) const noexcept override { return m_surface->frame(u, v); }
    std::array<DoubleDouble, 3> truth(DoubleDouble u, DoubleDouble v) const noexcept override {
        return m_surface->truth(u, v);
    }
    SurfaceRange range(const Interval& u, const Interval& v) const noexcept override {
        ++count;
        return m_surface->range(u, v);
    }
    Certainty missing(const Interval& u, const Interval& v) const noexcept override {
        return m_surface->missing(u, v);
    }

    mutable std::size_t count = 0;

  private:
    std::shared_ptr<const DrapedSurface> m_surface;
};

TEST(Drape, TheLargestBoundOfParallelogramsIsFoundWithoutAllOfThem) {
    for (const char* const name : {"cylinder", "sphere", "torus", "page_turn", "waves", "ripples"}) {
        SCOPED_TRACE(name);
        Scene scene{name};
        scene.pose.position = {0.3, 0.5, 1.6};
        scene.picture = {512, 512};
        const auto counted = std::make_shared<CountedSurface>(make_surface(number_of(name), scene.shape));
        scene.own = counted;
        const Shown shown(scene);
        const OkaRaster blocks(counted, shown.camera(), scene.picture, {4, 0.5, false}, DrapeMap::kSquare,
                               std::make_shared<RoomPool<OkaRoom>>());
        const double most = blocks.most_bound(serial_for);
        // Two for each block, seventeen for those few that are looked at closely.
        EXPECT_LT(counted->count, 8 * blocks.count());
        double wanted = 0;
        for (std::size_t i = 0; i < blocks.count(); ++i) wanted = std::max(wanted, blocks.bound_of(i));
        EXPECT_EQ(most, wanted);
    }
}

TEST(Drape, BoundsOfParallelogramsHoldForWideOverlaps) {
    Scene scene{"page_turn"};
    scene.pose.position = {0.3, 0.3, 2};
    for (const auto& [block, overlap] : {std::pair(1.0, 64.0), std::pair(2.0, 20.0), std::pair(8.0, 0.5)}) {
        DrapeOptions options;
        options.scheme = DrapeScheme::oka_z;
        options.block = block;
        options.overlap = overlap;
        Shown shown(scene, options);
        const std::vector<float> errors = shown.values(Output::error), bounds = shown.values(Output::bound);
        int over = 0;
        for (std::size_t k = 0; k < errors.size(); ++k) over += !(errors[k] <= bounds[k] * 1.00001f);
        EXPECT_EQ(over, 0) << block << " " << overlap;
    }
}

TEST(Drape, JacobiansAreTheStepsFromPixelToPixel) {
    Scene scene;
    scene.pose.position = {0.5, -0.6, 1.4};
    scene.pose.fov = 20;
    const Shown shown(scene);
    const DrapeMap map(cut_into_facets(shown.tree()->tree, shown.camera(), 0.125), shown.camera(),
                       scene.picture, 0.125);
    for (int y = 10; y < 110; y += 9)
        for (int x = 10; x < 150; x += 9) {
            const auto at = [&](int i, int j) {
                Point<double> p{};
                int piece = 0;
                EXPECT_TRUE(map.exact(i + 0.5, j + 0.5, 0, p, piece));
                return p;
            };
            const Point<double> across = (at(x + 1, y) - at(x - 1, y)) * 0.5,
                                down = (at(x, y + 1) - at(x, y - 1)) * 0.5;
            const Jacobian j = map.jacobian(x + 0.5, y + 0.5, 0);
            EXPECT_NEAR(j.x_i, across.x, 1e-4);
            EXPECT_NEAR(j.y_i, across.y, 1e-4);
            EXPECT_NEAR(j.x_j, down.x, 1e-4);
            EXPECT_NEAR(j.y_j, down.y, 1e-4);
        }
}

TEST(Drape, WhereSheetsMeetWhatLiesBetweenThemOnThePictureIsNotRead) {
    Scene scene{"page_turn"};
    scene.shape.direction = 30;
    scene.pose.position = {0.3, 0.5, 1.6};
    scene.screen = scene.picture = {512, 512};
    const Shown shown(scene);
    const DrapeMap map(cut_into_facets(shown.tree()->tree, shown.camera(), 0.125), shown.camera(),
                       scene.picture, 0.125);
    // The texels that blocks of 16 pixels and more lie in, and their pixels.
    double texels = 0, count = 0;
    for (const std::int64_t region : map.regions_in({0, 0, 512, 512}))
        for (const Block& block : map.blocks(region)) {
            const Box& box = block.box;
            if (block.kind != Block::Kind::computed || box.width() < 16 || box.height() < 16) continue;
            Point<double> low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
            for (int y = box.y0; y < box.y1; ++y)
                for (int x = box.x0; x < box.x1; ++x) {
                    Point<double> p{0, 0};
                    int piece = 0;
                    ASSERT_TRUE(map.exact(x + 0.5, y + 0.5, 0, p, piece));
                    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
                    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
                }
            texels += (high.x - low.x) * (high.y - low.y);
            count += box.width() * box.height();
        }
    EXPECT_GT(count, 50000);
    EXPECT_LT(texels, 15 * count);
}

TEST(Drape, HolesAreThePixelsOfTheSurfaceThatBlocksLeaveOut) {
    Scene scene{"sphere"};
    scene.shape.angle = 360;
    scene.pose.position = {0.3, 0.5, 1.6};
    scene.screen = {300, 200};
    DrapeOptions options;
    const auto holes = [&] {
        return Drape(Shown(scene).tree(), Shown(scene).camera(), scene.picture, options).holes(serial_for);
    };
    EXPECT_EQ(holes(), 0);
    const std::vector<float> cover = Shown(scene, options).seen();
    for (const DrapeScheme scheme : {DrapeScheme::oka, DrapeScheme::oka_z})
        for (const double overlap : {0.0, 0.5}) {
            options.scheme = scheme;
            options.overlap = overlap;
            const std::vector<float> drawn = Shown(scene, options).seen();
            int wanted = 0;
            for (int y = 1; y < 199; ++y)
                for (int x = 1; x < 299; ++x) {
                    bool hole = drawn[static_cast<std::size_t>(300 * y + x)] == 0;
                    for (int k = 0; hole && k < 9; ++k)
                        hole = cover[static_cast<std::size_t>(300 * (y + k / 3 - 1) + x + k % 3 - 1)] == 1;
                    wanted += hole;
                }
            EXPECT_EQ(holes(), wanted);
            EXPECT_TRUE(overlap > 0 || wanted > 0);
        }
}

TEST(Drape, RefusesWhatIsNoCamera) {
    CameraPose pose;
    pose.position = pose.target;
    const auto make = [&] { Camera(pose, glm::dmat3(1.0), glm::dvec3(0.0), {10, 10}); };
    EXPECT_THROW(make(), Error);
    pose = {};
    pose.up = {0, 0, 1};
    EXPECT_THROW(make(), Error);
    DrapeOptions options;
    options.tol = 1e-9;
    EXPECT_THROW(Shown(Scene{}, options).seen(), Error);
    options.scheme = DrapeScheme::oka;
    options.block = 0.25;
    Scene large;
    large.picture = {4096, 4096};
    EXPECT_THROW(Shown(large, options).seen(), Error);
}

TEST(Drape, NothingIsProvenOfParallelogramsOverWhatIsMissing) {
    // Two sheets in a plane, 0.3 apart along x, with a column of no numbers between.
    constexpr int kSide = 24, kColumn = 14;
    std::vector<float> texels;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
            const float x = (static_cast<float>(i) + 0.5f) / kSide - 0.5f + (i > kColumn ? 0.3f : 0);
            texels.insert(texels.end(),
                          {i == kColumn ? NAN : x, 0.5f - (static_cast<float>(j) + 0.5f) / kSide, 0});
        }
    SurfaceSum sum;
    sum.parts = {{surface_names().size(), 1}};
    sum.positions = std::make_shared<SampledField>(texels, Size{kSide, kSide}, 3);
    const std::shared_ptr<const DrapedSurface> surface = make_surface(sum);
    CameraPose pose;
    pose.target = {0.1, 0, 0};
    pose.position = {0.1, 0, 2};
    const Size screen{100, 100};
    const Camera camera(pose, glm::dmat3(1.0), glm::dvec3(0.0), screen);
    for (const double block : {8.0, 20.0, 64.0, 100.0}) {
        DrapeOptions options;
        options.scheme = DrapeScheme::oka;
        options.block = block;
        const auto drawn = [&](Output output) {
            options.output = output;
            const Drape drape(std::make_shared<SharedTree>(surface), camera, {100, 100}, options);
            std::vector<float> values(static_cast<std::size_t>(screen.width * screen.height));
            EXPECT_TRUE(drape.draw(nullptr, {0, 0, screen.width, screen.height},
                                   packed_view(reinterpret_cast<std::byte*>(values.data()),
                                               PixelType::float32, screen.width, screen.height, 1),
                                   serial_for));
            return values;
        };
        const std::vector<float> errors = drawn(Output::error), bounds = drawn(Output::bound);
        int beyond = 0, unknown = 0;
        for (std::size_t i = 0; i < errors.size(); ++i) {
            beyond += errors[i] > bounds[i];
            unknown += std::isnan(errors[i]) && std::isfinite(bounds[i]);
        }
        EXPECT_EQ(beyond, 0) << block;
        EXPECT_EQ(unknown, 0) << block;
    }
}

}  // namespace
}  // namespace anamorph::test_drape
