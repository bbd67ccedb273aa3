// SPDX-License-Identifier: Apache-2.0
// Panoramas thrown onto scenes: eq. 4.1, the tolerance across triangles, no cracks, and hard cases.
#include "anamorph/projector/projected_triangles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <tuple>

#include "anamorph/chart/chart_formulas.h"
#include "panorama_oracle.h"
#include "projection_cases.h"

namespace anamorph::test_projector {
namespace {

using testing::HasSubstr;
using Real = long double;
using Triangle = std::array<glm::dvec3, 3>;
constexpr double kInf = HUGE_VAL, kNan = NAN;

struct Exact {
    Real x, y, z;
};
Exact exact(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}
Exact operator-(const Exact& a, const Exact& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Real dot(const Exact& a, const Exact& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Exact cross(const Exact& a, const Exact& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Exact unit(const Exact& a) {
    const Real n = std::sqrt(dot(a, a));
    return {a.x / n, a.y / n, a.z / n};
}

/// The ray to a point, right, down, forward, in long double from the pose itself.
Ray<Real> exact_ray(const ProjectorPose& pose, const Exact& point) {
    const Exact forward = unit(exact(pose.direction)), right = unit(cross(forward, exact(pose.up))),
                up = cross(right, forward), to = point - exact(pose.position);
    return {dot(right, to), -dot(up, to), dot(forward, to)};
}

/// Kim 2003, eq. 4.1, in his frame: z along the axis, x towards theta = 0, and H the height of the unit cylinder.
Point<Real> kim(const Ray<Real>& ray, const Chart& chart) {
    const Real x = ray.z, y = -ray.x, z = -ray.y;
    const Real height = 2 * std::numbers::pi_v<Real> * chart.height() / chart.width();
    const Real theta = std::atan2(y, x) / (2 * std::numbers::pi_v<Real>)+0.5L;
    const Real v = z / std::sqrt(x * x + y * y) / height + 0.5L;
    return {(1 - theta) * chart.width(), (1 - v) * chart.height()};
}

glm::dvec3 random_vector(std::mt19937& random) {
    std::uniform_real_distribution<double> part(-1, 1);
    return {part(random), part(random), part(random)};
}
ProjectorPose random_pose(std::mt19937& random) {
    return {random_vector(random) * 0.6, random_vector(random), random_vector(random)};
}

/// A box from -1 to 1 of two triangles a side, outwards; the projector may be in it.
std::vector<Triangle> box(double half = 1) {
    std::vector<Triangle> triangles;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-half, half}) {
            const int a = (axis + 1) % 3, b = (axis + 2) % 3;
            const auto corner = [&](double s, double t) {
                glm::dvec3 p;
                p[axis] = side, p[a] = s, p[b] = t;
                return p;
            };
            const glm::dvec3 p = corner(-half, -half), q = corner(half, -half), r = corner(half, half),
                             s = corner(-half, half);
            if (side > 0) {
                triangles.push_back({p, q, r});
                triangles.push_back({p, r, s});
            } else {
                triangles.push_back({p, r, q});
                triangles.push_back({p, s, r});
            }
        }
    return triangles;
}

struct Painted {
    std::vector<PaintedTriangle> pieces;
    PaintedCounts counts;
};
Painted paint(const Chart& chart, const ProjectorPose& pose, const std::vector<Triangle>& scene,
              ProjectionOptions options = {}) {
    const ScenePainter painter(Projector(chart, pose), options);
    Painted painted;
    for (const Triangle& triangle : scene) painted.counts += painter.paint(triangle, painted.pieces);
    return painted;
}

/// Points of painted pieces, with the texel that is interpolated there.
template <class Body>
void for_samples(const Painted& painted, std::mt19937& random, int each, const Body& body) {
    std::uniform_real_distribution<double> share(0, 1);
    for (const PaintedTriangle& piece : painted.pieces) {
        if (piece.painting != Painting::painted) continue;
        for (int i = 0; i < each; ++i) {
            Real a = share(random), b = share(random);
            if (a + b > 1) a = 1 - a, b = 1 - b;
            const Real weights[] = {1 - a - b, a, b};
            Exact point{0, 0, 0};
            Point<Real> texel{0, 0};
            for (std::size_t k = 0; k < 3; ++k) {
                const PaintedCorner& c = piece.corners[k];
                point = {point.x + weights[k] * c.point.x, point.y + weights[k] * c.point.y,
                         point.z + weights[k] * c.point.z};
                texel = {texel.x + weights[k] * c.texel.x, texel.y + weights[k] * c.texel.y};
            }
            body(point, texel);
        }
    }
}

/// What is far from its texel is next to a pole, and seen from the centre it is off by less than the tolerance.
void expect_at_pole(const Chart& chart, const Ray<Real>& ray, const Point<Real>& texel, double tol) {
    EXPECT_EQ(chart.counted(), Counted::azimuth);
    const Ray<Real> meant = chart.ray(texel.x, texel.y);
    const Exact a = unit({ray.x, ray.y, ray.z}), b = unit({meant.x, meant.y, meant.z});
    const Exact apart = a - b;
    EXPECT_LE(std::sqrt(dot(apart, apart)) * chart.pixels_per_radian(), tol);
    EXPECT_LE(std::hypot(a.x, a.z) * chart.pixels_per_radian(),
              tol + std::sqrt(tol * chart.pixels_per_radian()));
}

void expect_within(const Chart& chart, const ProjectorPose& pose, const Painted& painted, double tol,
                   std::mt19937& random) {
    Real worst = 0;
    for_samples(painted, random, 3, [&](const Exact& point, const Point<Real>& texel) {
        const Ray<Real> ray = exact_ray(pose, point);
        // On a border of two faces, the nearer one counts.
        Real off = kInf;
        for (int piece = 0; piece < static_cast<int>(chart.pieces().size()); ++piece) {
            const Point<Real> truth = chart.point(ray, piece);
            Real across = std::fabs(truth.x - texel.x);
            if (chart.closed()) across = std::min(across, std::fabs(across - chart.period()));
            off = std::min(off, std::hypot(across, truth.y - texel.y));
        }
        if (off > tol)
            expect_at_pole(chart, ray, texel, tol);
        else
            worst = std::max(worst, off);
    });
    EXPECT_LE(worst, painted.counts.max_error + 1e-7);
    EXPECT_LE(painted.counts.max_error, tol);
}

/// Is a corner on a border of a panorama?
bool on_border(const PaintedCorner& c, const Chart& chart) {
    const auto at = [](double p, double border) { return std::fabs(p - border) < 1e-5; };
    return at(c.texel.x, 0) || at(c.texel.x, chart.width()) || at(c.texel.y, 0) ||
           at(c.texel.y, chart.height());
}

/// Of a closed surface, every side of a painted piece that does not touch the panorama's border is that of another piece,
/// the other way round.
void expect_closed(const Painted& painted, const Chart& chart) {
    const auto place = [](const glm::dvec3& p) { return std::tuple(p.x, p.y, p.z); };
    std::set<std::pair<std::tuple<double, double, double>, std::tuple<double, double, double>>> sides;
    for (const PaintedTriangle& piece : painted.pieces)
        for (std::size_t i = 0; i < 3; ++i)
            sides.insert({place(piece.corners[i].point), place(piece.corners[(i + 1) % 3].point)});
    int open = 0;
    for (const PaintedTriangle& piece : painted.pieces)
        for (std::size_t i = 0; i < 3 && piece.painting == Painting::painted; ++i) {
            const PaintedCorner &a = piece.corners[i], &b = piece.corners[(i + 1) % 3];
            if (!on_border(a, chart) && !on_border(b, chart))
                open += !sides.contains({place(b.point), place(a.point)});
        }
    EXPECT_EQ(open, 0);
}

double area(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return glm::length(glm::cross(b - a, c - a)) / 2;
}

TEST(Projector, CylindersAreReadByKimsFormula) {
    const Chart chart(Projection::cylindrical, 2048, 600);
    for (unsigned seed = 1; seed <= 200; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937 random(seed);
        const ProjectorPose pose = random_pose(random);
        const Projector projector(chart, pose);
        const glm::dvec3 point = random_vector(random) * 3.0;
        const Point<Real> truth = kim(exact_ray(pose, exact(point)), chart);
        Point<double> texel{};
        const bool inside = truth.y >= 0 && truth.y <= chart.height();
        ASSERT_EQ(projector.receive(point, texel), inside ? Received::texel : Received::nothing);
        if (!inside) continue;
        EXPECT_NEAR(texel.x, static_cast<double>(truth.x), 1e-9);
        EXPECT_NEAR(texel.y, static_cast<double>(truth.y), 1e-9);
    }
}

TEST(Projector, RefusesALensWhoseSeamCannotBeTurnedAway) {
    for (const Projection projection : {Projection::cylindrical, Projection::equirectangular})
        EXPECT_THAT(
            [&] {
                Projector(Chart(projection, 600, 300, 200, PixelSpacing::edges, "", {},
                                LensModel::parse("ptlens:b=0.03")),
                          {});
            },
            testing::ThrowsMessage<Error>(
                HasSubstr("must be none for " + std::string(name_of(projection)) + " in a scene")));
}

TEST(Projector, ThrowsTheMiddleAheadTheRightToTheRightAndUpUp) {
    const Projector projector(Chart(Projection::equirectangular, 400, 200));
    Point<double> texel{};
    const auto at = [&](double x, double y, double z) {
        EXPECT_EQ(projector.receive({x, y, z}, texel), Received::texel);
        return std::pair(std::round(texel.x * 1e6) / 1e6, std::round(texel.y * 1e6) / 1e6);
    };
    EXPECT_EQ(at(0, 0, -3), std::pair(200., 100.));
    EXPECT_EQ(at(2, 0, 0), std::pair(300., 100.));
    EXPECT_EQ(at(-2, 0, 0), std::pair(100., 100.));
    EXPECT_EQ(at(0, 1, -1), std::pair(200., 50.));
    EXPECT_EQ(at(0, 5, 0).second, 0.);
    // At any distance that double has.
    EXPECT_EQ(at(1e300, 1e300, 0), at(1e-300, 1e-300, 0));
    EXPECT_EQ(at(5e-324, 0, 0), std::pair(300., 100.));
}

TEST(Projector, PointsWithoutDirectionReceiveNothing) {
    Point<double> texel{};
    for (const Projection projection : {Projection::cylindrical, Projection::mercator}) {
        const Projector projector(Chart(projection, 400, 200), {{1, 2, 3}});
        EXPECT_EQ(projector.receive({1, 9, 3}, texel), Received::no_direction);
        EXPECT_EQ(projector.receive({1, -9, 3}, texel), Received::no_direction);
        EXPECT_EQ(projector.receive({1, 9, 3.001}, texel), Received::nothing);
        EXPECT_EQ(projector.receive({1, 2, 3}, texel), Received::no_direction);
        for (const double bad : {kNan, kInf, -kInf})
            EXPECT_EQ(projector.receive({1, bad, 2}, texel), Received::no_direction);
        EXPECT_EQ(projector.receive({1, 2, 2}, texel), Received::texel);
    }
    const Projector slide(Chart(Projection::rectilinear, 400, 200, 90));
    EXPECT_EQ(slide.receive({0, 0, 1}, texel), Received::nothing);
    EXPECT_EQ(slide.receive({0, 0, -1}, texel), Received::texel);
    EXPECT_EQ(slide.receive({1.001, 0, -1}, texel), Received::nothing);
}

TEST(Projector, WhatNeitherOfTwoLensesSeesReceivesNothing) {
    Point<double> texel{};
    const Projector projector(Chart(Projection::dual_fisheye, 400, 200, 120));
    const auto at = [&](double degrees) {
        const double t = degrees / 180 * std::numbers::pi;
        return projector.receive({std::sin(t), 0, -std::cos(t)}, texel);
    };
    for (const double degrees : {0.0, 59.9, 120.1, 180.0, -59.9, -120.1})
        EXPECT_EQ(at(degrees), Received::texel) << degrees;
    for (const double degrees : {60.1, 80.0, 90.0, 119.9, -60.1, -90.0, -119.9})
        EXPECT_EQ(at(degrees), Received::nothing) << degrees;
    ASSERT_EQ(at(30), Received::texel);
    EXPECT_NEAR(texel.x, 350, 1e-9);
}

TEST(Projector, WhatIsNoPoseIsRefused) {
    const Chart chart(Projection::equirectangular, 400, 200);
    const auto error = [&](const ProjectorPose& pose) {
        try {
            Projector projector(chart, pose);
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    EXPECT_EQ(error({{0, kNan, 0}}), "position=0,nan,0: must be finite");
    EXPECT_EQ(error({{}, {0, 0, 0}}), "direction=0,0,0: must be finite and not all 0");
    EXPECT_EQ(error({{}, {0, 0, kInf}}), "direction=0,0,inf: must be finite and not all 0");
    EXPECT_EQ(error({{}, {0, 0, 1}, {0, 0, -7}}), "up=0,0,-7: must not be along the direction");
    EXPECT_EQ(error({{}, {0, 0, 1e-300}, {0, 1e300, 0}}), "");
}

TEST(Projector, OptionsAreRefusedInWords) {
    const Projector projector(Chart(Projection::equirectangular, 400, 200));
    EXPECT_THAT([&] { ScenePainter(projector, {.tol = 0}); },
                testing::ThrowsMessage<Error>(HasSubstr("tol=0: must be a number above 0")));
    EXPECT_THAT([&] { ScenePainter(projector, {.tol = kNan}); },
                testing::ThrowsMessage<Error>(HasSubstr("tol=nan")));
    EXPECT_THAT([&] { ScenePainter(projector, {.smallest = -1}); },
                testing::ThrowsMessage<Error>(HasSubstr("smallest=-1")));
    EXPECT_THAT([&] { paint(projector.panorama(), {}, box(), {.tol = 0.01, .most_triangles = 1000}); },
                testing::ThrowsMessage<Error>("tol=0.01: takes more than 1000 triangles"));
}

TEST(ProjectedTriangles, EveryProjectionHoldsTheToleranceWithoutCracks) {
    unsigned seed = 0;
    for (const Projection projection : kProjections)
        for (const double tol : {0.5, 4.0}) {
            SCOPED_TRACE(std::string(name_of(projection)) + ", seed " + std::to_string(++seed));
            std::mt19937 random(seed);
            const Chart chart = test::chart_of_width(projection, 360);
            const ProjectorPose pose = random_pose(random);
            const Painted painted = paint(chart, pose, box(), {.tol = tol});
            expect_within(chart, pose, painted, tol, random);
            expect_closed(painted, chart);
            EXPECT_GT(painted.counts.painted, 50);
        }
}

TEST(ProjectedTriangles, FieldsOfViewAndLensesHoldTheTolerance) {
    std::mt19937 random(7);
    const ProjectorPose pose = random_pose(random);
    for (const Projection projection : kProjections)
        for (const double fov : test::fovs_of(projection)) {
            if (fov < 1) continue;
            SCOPED_TRACE(std::string(name_of(projection)) + " " + std::to_string(fov));
            const Chart chart = test::chart_of_width(projection, 240, fov);
            const Painted painted = paint(chart, pose, box(), {.tol = 2});
            expect_within(chart, pose, painted, 2, random);
            expect_closed(painted, chart);
        }
    for (const char* lens :
         {"brown:k1=-0.1,k2=0.02,p1=0.001", "ptlens:a=0.01,b=-0.03,c=0.01", "3de4:k1=0.05"}) {
        SCOPED_TRACE(lens);
        const Chart chart(Projection::rectilinear, 300, 200, 80, PixelSpacing::edges, "", 1,
                          LensModel::parse(lens));
        const Painted painted = paint(chart, pose, box(), {.tol = 0.5});
        expect_within(chart, pose, painted, 0.5, random);
        EXPECT_GT(painted.counts.painted, 10);
    }
}

TEST(ProjectedTriangles, FormulasOfTheOracleAgree) {
    std::mt19937 random(11);
    const ProjectorPose pose{{0.2, -0.1, 0.3}, {0.3, 0.2, -1}, {0.1, 1, 0}};
    for (const Projection projection :
         {Projection::equirectangular, Projection::cylindrical, Projection::mercator, Projection::fisheye,
          Projection::equisolid, Projection::stereographic}) {
        SCOPED_TRACE(name_of(projection));
        const oracle::View view{projection, 512, 256, 180};
        const Chart chart = oracle::chart_of(view);
        const Painted painted = paint(chart, pose, box(), {.tol = 0.25});
        std::int64_t compared = 0;
        for_samples(painted, random, 1, [&](const Exact& point, const Point<Real>& texel) {
            const Ray<Real> ray = exact_ray(pose, point);
            const Point<Real> truth = oracle::point_of(view, chart.pieces()[0], {ray.x, ray.y, ray.z});
            EXPECT_LE(std::hypot(truth.x - texel.x, truth.y - texel.y), 0.25);
            ++compared;
        });
        EXPECT_GT(compared, 100);
    }
}

/// The largest error within each painted piece, on a lattice.
std::vector<double> errors_of(const Chart& chart, const ProjectorPose& pose, const Painted& painted) {
    std::vector<double> errors;
    for (const PaintedTriangle& piece : painted.pieces) {
        if (piece.painting != Painting::painted) continue;
        const auto at = [&](double a, double b) {
            const double w[] = {1 - a - b, a, b};
            PaintedCorner sum;
            for (std::size_t k = 0; k < 3; ++k) {
                sum.point += w[k] * piece.corners[k].point;
                sum.texel = sum.texel + piece.corners[k].texel * w[k];
            }
            return sum;
        };
        const Ray<Real> middle = exact_ray(pose, exact(at(1. / 3, 1. / 3).point));
        double worst = 0;
        for (int i = 0; i <= 8; ++i)
            for (int j = 0; i + j <= 8; ++j) {
                const PaintedCorner c = at(i / 8., j / 8.);
                const Point<Real> truth =
                    chart.point(exact_ray(pose, exact(c.point)), chart.piece_of(middle));
                double across = static_cast<double>(std::fabs(truth.x - c.texel.x));
                if (chart.closed()) across = std::min(across, std::fabs(across - chart.period()));
                worst = std::max(worst, std::hypot(across, static_cast<double>(truth.y - c.texel.y)));
            }
        errors.push_back(worst);
    }
    return errors;
}

TEST(ProjectedTriangles, ErrorsAreNotFarBelowTheTolerance) {
    // Halving a side takes a factor of 4, so that no rule that halves has a median far below 2.
    const ProjectorPose pose{{0.2, 0.1, -0.3}, {0.3, -0.1, -1}, {0.1, 1, 0.2}};
    for (const Projection projection :
         {Projection::equirectangular, Projection::cylindrical, Projection::cubemap}) {
        SCOPED_TRACE(name_of(projection));
        const Chart chart = test::chart_of_width(projection, 400);
        std::vector<double> errors = errors_of(chart, pose, paint(chart, pose, box(), {.tol = 0.25}));
        ASSERT_GT(errors.size(), 500u);
        std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2),
                         errors.end());
        EXPECT_LT(0.25 / errors[errors.size() / 2], 3.6);
    }
}

TEST(ProjectedTriangles, PiecesCoverTheirTriangleAndKnowTheirWeights) {
    std::mt19937 random(3);
    const ProjectorPose pose = random_pose(random);
    for (const Projection projection :
         {Projection::equirectangular, Projection::cubemap, Projection::rectilinear}) {
        const Chart chart = test::chart_of_width(projection, 300);
        const ScenePainter painter(Projector(chart, pose), {.tol = 1});
        for (const Triangle& triangle : box()) {
            std::vector<PaintedTriangle> pieces;
            painter.paint(triangle, pieces);
            double covered = 0;
            const glm::dvec3 normal = glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
            for (const PaintedTriangle& piece : pieces) {
                const auto& c = piece.corners;
                covered += area(c[0].point, c[1].point, c[2].point);
                EXPECT_GE(glm::dot(glm::cross(c[1].point - c[0].point, c[2].point - c[0].point), normal),
                          -1e-12);
                for (const PaintedCorner& corner : c) {
                    const glm::dvec3 by_weights = triangle[0] * corner.weights[0] +
                                                  triangle[1] * corner.weights[1] +
                                                  triangle[2] * corner.weights[2];
                    EXPECT_LT(glm::length(by_weights - corner.point), 1e-14);
                }
            }
            EXPECT_NEAR(covered, area(triangle[0], triangle[1], triangle[2]), 1e-9);
        }
    }
}

TEST(ProjectedTriangles, SeamsAreSplitAndNotSmeared) {
    const Chart chart(Projection::equirectangular, 720, 360);
    // A wall right behind, across the seam.
    const std::vector<Triangle> wall{{glm::dvec3(-1, -1, 2), {1, -1, 2}, {0, 1, 2}}};
    const Painted painted = paint(chart, {}, wall, {.tol = 2});
    int left = 0, right = 0;
    for (const PaintedTriangle& piece : painted.pieces) {
        ASSERT_EQ(piece.painting, Painting::painted);
        double low = kInf, high = -kInf;
        for (const PaintedCorner& corner : piece.corners) {
            low = std::min(low, corner.texel.x);
            high = std::max(high, corner.texel.x);
        }
        EXPECT_LT(high - low, 100);
        EXPECT_GE(low, -1e-6);
        EXPECT_LE(high, 720 + 1e-6);
        left += low < 1e-6;
        right += high > 720 - 1e-6;
    }
    EXPECT_GT(left, 0);
    EXPECT_GT(right, 0);
}

TEST(ProjectedTriangles, TheOrderOfCornersChangesNoSide) {
    const Chart chart(Projection::cylindrical, 1024, 400);
    std::mt19937 random(5);
    const ProjectorPose pose = random_pose(random);
    const Projector projector(chart, pose);
    const EdgeRule rule(projector, 0.5, 0);
    for (int i = 0; i < 1000; ++i) {
        glm::dvec3 a = random_vector(random), b = random_vector(random);
        EXPECT_NE(EdgeRule::in_order(a, b), EdgeRule::in_order(b, a));
        const EdgeFinding one = rule.judge(a, b), other = rule.judge(b, a);
        EXPECT_EQ(one.verdict, other.verdict);
        EXPECT_NEAR(one.bound, other.bound, 1e-12 + 1e-9 * one.bound);
    }
}

TEST(ProjectedTriangles, WhatIsAboutTheCentreIsCutToItAndCounted) {
    for (const Projection projection :
         {Projection::equirectangular, Projection::cylindrical, Projection::cubemap}) {
        SCOPED_TRACE(name_of(projection));
        const Chart chart = test::chart_of_width(projection, 120);
        const double tol = 8;
        std::mt19937 random(1);
        // The centre within a triangle, on a side, in a corner.
        for (const Triangle& triangle : {Triangle{glm::dvec3(-1, -1, 0.5), {1, -1, 0}, {0, 1, -0.25}},
                                         Triangle{glm::dvec3(-1, 0, 0), {1, 0, 0}, {0, 1, 0.3}},
                                         Triangle{glm::dvec3(0, 0, 0), {1, 0, 0.2}, {0, 1, -0.3}}}) {
            const Painted painted = paint(chart, {}, {triangle}, {.tol = tol, .smallest = 1e-3});
            EXPECT_GT(painted.counts.painted, 10);
            EXPECT_GT(painted.counts.no_direction, 0);
            expect_within(chart, {}, painted, tol, random);
            double lost = 0;
            for (const PaintedTriangle& piece : painted.pieces)
                if (piece.painting == Painting::no_direction)
                    lost += area(piece.corners[0].point, piece.corners[1].point, piece.corners[2].point);
            EXPECT_LT(lost, 1e-4);
        }
    }
}

TEST(ProjectedTriangles, TrianglesThatAreNoneDoNoHarm) {
    const Chart chart(Projection::equirectangular, 400, 200);
    const glm::dvec3 p(1, 0, 0.1), q(0.5, 1, -1);
    for (const Triangle& triangle :
         {Triangle{p, p, p}, Triangle{p, q, p}, Triangle{p, q, (p + q) * 0.5},
          Triangle{glm::dvec3(0.0), glm::dvec3(0.0), glm::dvec3(0.0)}, Triangle{p, q, glm::dvec3(0, kNan, 0)},
          Triangle{p, q, glm::dvec3(kInf, 0, 0)}, Triangle{p, q, glm::dvec3(1e308, 0, -1e308)}}) {
        const Painted painted = paint(chart, {}, {triangle}, {.tol = 4, .smallest = 1e-6});
        EXPECT_GE(painted.pieces.size(), 1u);
        for (const PaintedTriangle& piece : painted.pieces)
            for (const PaintedCorner& corner : piece.corners)
                EXPECT_TRUE(piece.painting != Painting::painted || std::isfinite(corner.texel.x));
    }
    EXPECT_EQ(paint(chart, {}, {{p, q, glm::dvec3(0, kNan, 0)}}, {}).counts.no_direction, 1);
}

TEST(ProjectedTriangles, HoldsTheToleranceSeenEdgeOn) {
    // A floor that starts 0.00002 below the projector: 89.999 degrees off its normal.
    std::mt19937 random(9);
    const Chart chart(Projection::cylindrical, 1024, 512);
    const double low = std::tan(0.001 * std::numbers::pi / 180);
    const std::vector<Triangle> floor{{glm::dvec3(-1, -low, -1), {1, -low, -1}, {1, -low, -3}},
                                      {glm::dvec3(-1, -low, -1), {1, -low, -3}, {-1, -low, -3}}};
    const Painted painted = paint(chart, {}, floor, {.tol = 0.5});
    EXPECT_GT(painted.counts.painted, 10);
    EXPECT_EQ(painted.counts.no_direction, 0);
    expect_within(chart, {}, painted, 0.5, random);
}

TEST(ProjectedTriangles, AllOfABoxAroundAFullPanoramaIsPainted) {
    for (const Projection projection : {Projection::equirectangular, Projection::cubemap,
                                        Projection::octahedral, Projection::hammer, Projection::eac}) {
        SCOPED_TRACE(name_of(projection));
        const PaintedCounts counts =
            paint(test::chart_of_width(projection, 400), {}, box(), {.tol = 1}).counts;
        EXPECT_EQ(counts.outside, 0);
        EXPECT_EQ(counts.no_direction, 0);
        EXPECT_GT(counts.painted, 100);
    }
}

TEST(ProjectedTriangles, PiecesAboutACubesCornerStayOnTheirFace) {
    const unsigned seed = 17;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Chart chart(Projection::cubemap, 32, 192, 90);
    std::vector<Triangle> scene = {{{{-0.61920320702185982, 0.393099212360285, -1.6485710778796032},
                                     {-1.6223429353068104, 0.67043409741391558, -0.37121399593011017},
                                     {-0.82666285582012655, 1.4901324170410757, -1.3840469860977733}}},
                                   {{{-1, 0.5, -1}, {-1, 1.5, -1}, {0, 1, -1}}}};
    std::uniform_real_distribution<double> off(-0.7, 0.7);
    for (int k = 0; k < 300; ++k) {
        Triangle triangle;
        for (glm::dvec3& corner : triangle) corner = {-1 + off(random), 1 + off(random), -1 + off(random)};
        scene.push_back(triangle);
    }
    const Painted painted = paint(chart, {}, scene, {.tol = 0.125, .smallest = 1e-6});
    expect_within(chart, {}, painted, 0.125, random);
    // A point's own face is one of those in whose direction it lies most, but for rounding of corners.
    const Projector projector(chart);
    for_samples(painted, random, 20, [&](const Exact& exact_point, const Point<Real>& texel) {
        const glm::dvec3 point(static_cast<double>(exact_point.x), static_cast<double>(exact_point.y),
                               static_cast<double>(exact_point.z));
        Point<double> own{};
        ASSERT_EQ(projector.receive(point, own), Received::texel);
        if (std::hypot(own.x - texel.x, own.y - texel.y) <= 0.125L) return;
        double axes[3] = {std::fabs(point.x), std::fabs(point.y), std::fabs(point.z)};
        std::sort(axes, axes + 3);
        EXPECT_LE(axes[2] - axes[1], 1e-5 * axes[2]) << point.x << " " << point.y << " " << point.z;
    });
}

TEST(ProjectedTriangles, WhatLiesInTheSeamIsPaintedOnce) {
    // A triangle in the plane of the seam, behind the projector's middle.
    const Chart chart(Projection::equirectangular, 64, 32);
    const Triangle triangle{{{0, 0, 1}, {0, 1, 1}, {0, 0, 2}}};
    const Painted painted = paint(chart, {}, {triangle}, {.tol = 0.5, .smallest = 1e-4});
    EXPECT_EQ(painted.counts.outside, 0);
    double covered = 0;
    for (const PaintedTriangle& piece : painted.pieces)
        covered += area(piece.corners[0].point, piece.corners[1].point, piece.corners[2].point);
    EXPECT_NEAR(covered, area(triangle[0], triangle[1], triangle[2]), 1e-12);
}

TEST(ProjectedTriangles, RoundedToFloatCornersFitAndAreFloats) {
    const Chart chart(Projection::equirectangular, 400, 200);
    std::mt19937 random(13);
    const ProjectorPose pose{{0.1, 0.2, -0.3}, {1, 0, 1}, {0, 1, 0.5}};
    const Painted painted = paint(chart, pose, box(), {.tol = 1, .smallest = 0x1p-20, .single = true});
    expect_closed(painted, chart);
    expect_within(chart, pose, painted, 1, random);
    for (const PaintedTriangle& piece : painted.pieces)
        for (const PaintedCorner& corner : piece.corners)
            for (int i = 0; i < 3; ++i)
                EXPECT_EQ(corner.point[i], double{static_cast<float>(corner.point[i])});
}

}  // namespace
}  // namespace anamorph::test_projector
