// SPDX-License-Identifier: Apache-2.0
// The bump unit in space (Kim 2003, 4.2 to 4.5): planes, matrices, trapezoids and texels against formulas written out here in long
// double, and what comes out of them against float arithmetic, bit by bit.
#include "anamorph/machine/bump_plane.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "anamorph/error.h"
#include "anamorph/machine/bump_unit.h"

namespace anamorph::test_bump_plane {
using namespace machine;
namespace {

using Real = long double;
using testing::HasSubstr;

constexpr Real kPi = std::numbers::pi_v<Real>;
constexpr int kScreen = 512, kWidth = 2048, kHeight = 1024;
constexpr double kFov = 60, kPitch = 15, kYaw = 30;

/// A cylinder 2048 wide, whose pixels are square; seen with 60 degrees from 15 below.
Panorama pitched_view(int screen = kScreen, double yaw = kYaw, double roll = 0) {
    return Panorama(Chart(Projection::cylindrical, kWidth, kHeight),
                    Chart(Projection::rectilinear, screen, screen, kFov), {yaw, kPitch, roll});
}

Real radians(Real degrees) {
    return degrees * kPi / 180;
}

/// A point of the plane, y' down, of eye coordinates, y down, without roll; and q.
struct OnPlane {
    Real x, y, q;
};
OnPlane on_plane(Real x, Real y) {
    const Real c = std::cos(radians(kPitch)), s = std::sin(radians(kPitch)), q = c + y * s;
    return {x / q, (y * c - s) / q, q};
}

/// Texture coordinates of a point of the plane: eq. 4.2 with v down, of a cylinder of square pixels.
struct Coordinates {
    Real u, v;
};
Real height_of_cylinder() {
    return 2 * kPi * kHeight / kWidth;
}
Coordinates exact_on_plane(Real x, Real y) {
    return {0.5L + Real{kYaw} / 360 + std::atan(x) / (2 * kPi),
            0.5L + y / std::sqrt(1 + x * x) / height_of_cylinder()};
}

/// The coefficients of section 4.3 by another way: a by Newton's iteration for c = arccos of the root of 2 pi a.
struct Coefficients {
    Real a, b;
};
Coefficients coefficients(Real x_max) {
    // Extremes of atan x - k x at tan c, where cos^2 c = k, and at x_max: c - sin c cos c + atan x_max - cos^2 c x_max = 0.
    Real c = 0.5L;
    for (int i = 0; i < 60; ++i) {
        const Real f = c - std::sin(c) * std::cos(c) + std::atan(x_max) - std::cos(c) * std::cos(c) * x_max;
        const Real slope = 2 * std::sin(c) * (std::sin(c) + std::cos(c) * x_max);
        c -= f / slope;
    }
    return {std::cos(c) * std::cos(c) / (2 * kPi),
            (1 + 1 / std::sqrt(1 + x_max * x_max)) / (2 * height_of_cylinder())};
}

struct Errors {
    double mean = 0, max = 0;
};

/// Distances in pixels of the panorama.
Errors errors_of(const BumpUnit& unit) {
    const BumpedPanorama drawn(pitched_view(), unit);
    const Real tangent = std::tan(radians(kFov / 2));
    Errors errors;
    for (int j = 0; j < kScreen; ++j)
        for (int i = 0; i < kScreen; ++i) {
            const OnPlane p = on_plane(((2 * i + 1) / Real{kScreen} - 1) * tangent,
                                       ((2 * j + 1) / Real{kScreen} - 1) * tangent);
            const Coordinates exact = exact_on_plane(p.x, p.y);
            const UnitCoordinates used = drawn.at((i + 0.5) / kScreen, (j + 0.5) / kScreen);
            const auto off = static_cast<double>(
                std::hypot((used.at.x - exact.u) * kWidth, (used.at.y - exact.v) * kHeight));
            errors.mean += off / (kScreen * kScreen);
            errors.max = std::max(errors.max, off);
        }
    return errors;
}

/// The scheme's figures for a pitched view.
TEST(BumpPlane, PitchedViewsAreAsGoodAsTheSchemeSays) {
    for (const auto projecting : {BumpUnit::Projecting::vertex, BumpUnit::Projecting::pixel}) {
        BumpUnit unit;
        unit.projecting = projecting;
        EXPECT_NEAR(errors_of(unit).mean, 0.00075, 0.0002);
        unit.texel = kSigned8;
        EXPECT_NEAR(errors_of(unit).mean, 0.043, 0.015);
        unit.size = 0;
        const Errors linear = errors_of(unit);
        EXPECT_NEAR(linear.mean, 8.986, 0.001);
        EXPECT_NEAR(linear.max, 30.44, 0.01);
    }
}

TEST(BumpPlane, TheTrapezoidIsThatOfTheView) {
    const std::vector<ProjectionPlane> planes = projection_planes(pitched_view());
    ASSERT_EQ(planes.size(), 1u);
    const ProjectionPlane& plane = planes[0];
    // 45 degrees up at the middle of the upper edge, 15 down at that of the lower one.
    const Real tangent = std::tan(radians(30));
    const OnPlane top = on_plane(tangent, -tangent), bottom = on_plane(tangent, tangent);
    EXPECT_NEAR(static_cast<double>(top.y), -1, 1e-15);
    ASSERT_EQ(plane.corners.size(), 4u);
    for (const glm::dvec2& corner : plane.corners) {
        const glm::dvec3 at = plane.from_eye * glm::dvec3(corner, 1);
        const OnPlane& edge = corner.y < 0 ? top : bottom;
        EXPECT_NEAR(std::fabs(at.x / at.z), static_cast<double>(edge.x), 1e-14);
        EXPECT_NEAR(at.y / at.z, static_cast<double>(edge.y), 1e-14);
    }
    EXPECT_NEAR(plane.x_max, static_cast<double>(top.x), 1e-14);
    EXPECT_NEAR(plane.y_max, 1, 1e-14);
    const Coefficients k = coefficients(top.x);
    EXPECT_NEAR(plane.right, static_cast<double>(k.a), 1e-14);
    EXPECT_NEAR(plane.down, static_cast<double>(k.b), 1e-14);
    EXPECT_NEAR(plane.centre.x, 0.5 + kYaw / 360, 1e-14);
    EXPECT_NEAR(plane.centre.y, 0.5, 1e-14);
}

/// Eq. 4.5: M_rot of a pitch times the matrices of the paper, y down.
TEST(BumpPlane, MatricesAreThoseOfThePaper) {
    const Panorama view = pitched_view();
    const ProjectionPlane plane = projection_planes(view)[0];
    const BumpStage stage(view.source(), view.target(), plane, BumpUnit{});
    const Real c = std::cos(radians(kPitch)), s = std::sin(radians(kPitch)),
               x_max = std::tan(radians(30)) / (c - s * std::tan(radians(30)));
    const Coefficients k = coefficients(x_max);
    const Real theta = 0.5L + Real{kYaw} / 360;
    // Rows: (a x + theta z, b y + z / 2, z) for the rotated (x, y, z) = (X, c Y - s, s Y + c).
    const Real linear[3][3] = {{k.a, theta * s, theta * c}, {0, k.b * c + s / 2, c / 2 - k.b * s}, {0, s, c}};
    const Real m = 1 / (2 * x_max), n = 0.5L;
    const Real bump[3][3] = {{m, s / 2, c / 2}, {0, n * c + s / 2, c / 2 - n * s}, {0, s, c}};
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) {
            EXPECT_NEAR(stage.linear_matrix()[column][row], static_cast<double>(linear[row][column]), 2e-15);
            EXPECT_NEAR(stage.bump_matrix()[column][row], static_cast<double>(bump[row][column]), 2e-15);
        }
}

/// Texels: the residuals (4.4) in long double, over the largest of them, rounded to 8 and 16 bits.
TEST(BumpPlane, TexelsAreTheResidualsToTheBit) {
    const Panorama view = pitched_view();
    const ProjectionPlane plane = projection_planes(view)[0];
    const Real x_max = std::tan(radians(30)) /
                       (std::cos(radians(kPitch)) - std::sin(radians(kPitch)) * std::tan(radians(30)));
    const Coefficients k = coefficients(x_max);
    for (const NumberFormat& format : {kSigned8, kSigned16})
        for (const auto edge : {BumpUnit::Edge::clamp, BumpUnit::Edge::border}) {
            BumpUnit unit;
            unit.size = 64;
            unit.texel = format;
            unit.edge = edge;
            const BumpStage stage(view.source(), view.target(), plane, unit);
            const bool border = edge == BumpUnit::Edge::border;
            std::vector<Coordinates> residuals;
            Real most_u = 0, most_v = 0;
            for (int j = 0; j < 64; ++j)
                for (int i = 0; i < 64; ++i) {
                    const auto place = [&](int at) {
                        return border ? (2 * at - 63) / 62.0L : (2 * at - 63) / 64.0L;
                    };
                    const Real x = place(i) * x_max, y = place(j);
                    residuals.push_back({std::atan(x) / (2 * kPi) - k.a * x,
                                         y / std::sqrt(1 + x * x) / height_of_cylinder() - k.b * y});
                    most_u = std::max(most_u, std::fabs(residuals.back().u));
                    most_v = std::max(most_v, std::fabs(residuals.back().v));
                }
            const Real largest = std::ldexp(1.0L, format.bits - 1) - 1;
            ASSERT_EQ(stage.bumps()->texels().size(), residuals.size());
            for (std::size_t i = 0; i < residuals.size(); ++i) {
                const auto& texel = stage.bumps()->texels()[i];
                ASSERT_EQ(texel[0] * (largest + 1),
                          static_cast<double>(std::nearbyint(residuals[i].u / most_u * largest)) + 0.0)
                    << i;
                ASSERT_EQ(texel[1] * (largest + 1),
                          static_cast<double>(std::nearbyint(residuals[i].v / most_v * largest)) + 0.0)
                    << i;
            }
            EXPECT_NEAR(stage.scale()[0], static_cast<double>(most_u / largest * (largest + 1)), 1e-13);
        }
}

/// What the card makes of matrices and texels, in float: eq. 4.5, the division of Fig. 4.5, the bilinear filter with 8 bits.
class FloatCard {
  public:
    explicit FloatCard(const BumpStage& stage) : m_stage(stage), m_size(stage.bumps()->size()) {}

    Point<float> by_matrices(float x, float y) const {
        const auto row = [&](const glm::dmat3& m, int i) {
            return x * static_cast<float>(m[0][i]) + y * static_cast<float>(m[1][i]) +
                   1.0F * static_cast<float>(m[2][i]);
        };
        const float q = row(m_stage.linear_matrix(), 2);
        return perturbed(row(m_stage.linear_matrix(), 0) / q, row(m_stage.linear_matrix(), 1) / q,
                         row(m_stage.bump_matrix(), 0) / q, row(m_stage.bump_matrix(), 1) / q);
    }
    /// Of a rectangle of four corners, whose diagonal goes down to the right.
    Point<float> by_trapezoid(double s, double t) const {
        const auto& c = m_stage.corners();
        // Weights of the right upper, the right lower and the left lower corner.
        const bool right = s > t;
        const auto l1 = static_cast<float>(right ? s - t : s), l2 = static_cast<float>(right ? t : t - s);
        float n[5];
        for (std::size_t i = 0; i < 5; ++i) {
            const auto first = static_cast<float>(c[0].numbers[i]),
                       one = static_cast<float>(c[right ? 1 : 2].numbers[i]),
                       two = static_cast<float>(c[right ? 2 : 3].numbers[i]);
            n[i] = first + (one - first) * l1 + (two - first) * l2;
        }
        return perturbed(n[0] / n[4], n[1] / n[4], n[2] / n[4], n[3] / n[4]);
    }

  private:
    Point<float> perturbed(float u, float v, float across, float down) const {
        const auto place = [&](float at, int& first, float& weight) {
            const double in = std::clamp(double{at} * m_size - 0.5, 0.0, m_size - 1.0);
            first = static_cast<int>(std::floor(in));
            weight = static_cast<float>(std::nearbyint((in - first) * 256) / 256);
        };
        int i = 0, j = 0;
        float wx = 0, wy = 0;
        place(across, i, wx);
        place(down, j, wy);
        const auto texel = [&](int x, int y, std::size_t k) {
            return static_cast<float>(m_stage.bumps()->texels()[static_cast<std::size_t>(
                std::min(y, m_size - 1) * m_size + std::min(x, m_size - 1))][k]);
        };
        const auto read = [&](std::size_t k) {
            const float upper = texel(i, j, k) + (texel(i + 1, j, k) - texel(i, j, k)) * wx,
                        lower = texel(i, j + 1, k) + (texel(i + 1, j + 1, k) - texel(i, j + 1, k)) * wx;
            return upper + (lower - upper) * wy;
        };
        return {u + read(0) * static_cast<float>(m_stage.scale()[0]),
                v + read(1) * static_cast<float>(m_stage.scale()[1])};
    }

    const BumpStage& m_stage;
    int m_size;
};

TEST(BumpPlane, CoordinatesAreThoseOfFloatsToTheBit) {
    const Panorama view = pitched_view();
    const ProjectionPlane plane = projection_planes(view)[0];
    const double tangent = std::tan(std::numbers::pi / 6);
    for (const NumberFormat& format : {kSigned8, kSigned16}) {
        BumpUnit unit;
        unit.size = 100;
        unit.texel = format;
        for (const auto projecting : {BumpUnit::Projecting::vertex, BumpUnit::Projecting::pixel}) {
            unit.projecting = projecting;
            const BumpStage stage(view.source(), view.target(), plane, unit);
            const FloatCard card(stage);
            for (int j = 0; j < kScreen; j += 3)
                for (int i = 0; i < kScreen; ++i) {
                    const double s = (i + 0.5) / kScreen, t = (j + 0.5) / kScreen;
                    const Point<double> used = stage(s, t).at;
                    const Point<float> at = projecting == BumpUnit::Projecting::vertex
                                                ? card.by_trapezoid(s, t)
                                                : card.by_matrices(static_cast<float>((2 * s - 1) * tangent),
                                                                   static_cast<float>((2 * t - 1) * tangent));
                    ASSERT_EQ(used.x, double{at.x}) << i << " " << j;
                    ASSERT_EQ(used.y, double{at.y}) << i << " " << j;
                }
        }
    }
}

/// Views that are turned every way, of cylinders that were held askew too: what is off is the table's.
TEST(BumpPlane, TurnedViewsAreAsGood) {
    for (const Projection from : {Projection::cylindrical, Projection::equirectangular, Projection::mercator})
        for (const double roll : {0.0, 25.0, -90.0, 180.0})
            for (const double yaw : {0.0, 171.0, -100.0}) {
                const Panorama view(Chart(from, 1000, 600), Chart(Projection::rectilinear, 80, 60, 70),
                                    {yaw, -12, roll}, {20, 5, -7});
                const BumpedPanorama drawn(view, BumpUnit{});
                EXPECT_LT(drawn.reached(serial_for).max_error, 0.1)
                    << name_of(from) << " " << yaw << " " << roll;
                BumpUnit linear;
                linear.size = 0;
                EXPECT_GT(BumpedPanorama(view, linear).reached(serial_for).max_error, 3);
            }
}

/// Coefficients of other panoramas: no other slope is better.
TEST(BumpPlane, SlopesOfOtherPanoramasAreMinimaxToo) {
    for (const Projection from : {Projection::equirectangular, Projection::mercator}) {
        const Panorama view(Chart(from, 1000, 600), Chart(Projection::rectilinear, 80, 60, 90));
        const ProjectionPlane plane = projection_planes(view)[0];
        const auto largest = [&](double slope) {
            // Formulas in radians; 1000 pixels are 2 pi of them.
            double most = 0;
            for (int i = 0; i <= 200; ++i)
                for (int j = 0; j <= 200; ++j) {
                    const double x = plane.x_max * i / 200, y = plane.y_max * j / 200,
                                 up = y / std::hypot(1, x);
                    const double v = from == Projection::mercator ? std::asinh(up) : std::atan(up);
                    most = std::max(most, std::fabs(v * 1000 / (2 * std::numbers::pi) / 600 - slope * y));
                }
            return most;
        };
        const double best = largest(plane.down);
        EXPECT_GT(largest(plane.down * 1.01), best);
        EXPECT_GT(largest(plane.down * 0.99), best);
    }
}

/// More planes have smaller residuals: of the azimuth, those of an angle half or a quarter as wide.
TEST(BumpPlane, MorePlanesHaveSmallerResiduals) {
    const Panorama view(Chart(Projection::cylindrical, 2048, 1024),
                        Chart(Projection::rectilinear, 200, 100, 120), {10, 20, 5});
    double last = HUGE_VAL;
    for (const int count : {1, 2, 4}) {
        BumpUnit unit;
        unit.planes.count = count;
        unit.size = 0;
        const BumpedPanorama linear(view, unit);
        ASSERT_EQ(linear.stages().size(), static_cast<std::size_t>(count));
        const double error = linear.reached(serial_for).max_error;
        EXPECT_LT(error, last / 2) << count;
        last = error;
        unit.size = 256;
        for (const auto projecting : {BumpUnit::Projecting::vertex, BumpUnit::Projecting::pixel}) {
            unit.projecting = projecting;
            unit.edge = BumpUnit::Edge::border;
            EXPECT_LT(BumpedPanorama(view, unit).reached(serial_for).max_error, 0.05) << count;
        }
        // Each point of the screen lies in the part of one plane, whose range it is in.
        const std::vector<ProjectionPlane> planes = projection_planes(view, unit.planes);
        for (const ProjectionPlane& plane : planes) {
            EXPECT_GE(plane.corners.size(), 3u);
            for (const glm::dvec2& corner : plane.corners) {
                const glm::dvec3 at = plane.from_eye * glm::dvec3(corner, 1);
                EXPECT_LE(std::fabs(at.x), plane.x_max * at.z * (1 + 1e-12));
                EXPECT_LE(std::fabs(at.y), plane.y_max * at.z * (1 + 1e-12));
            }
        }
    }
}

TEST(BumpPlane, ARangeMayBeLargerThanTheView) {
    const PlaneOptions wide{1, 1, 1.5};
    const ProjectionPlane plane = projection_planes(pitched_view(), wide)[0];
    EXPECT_EQ(plane.x_max, 1);
    EXPECT_EQ(plane.y_max, 1.5);
    EXPECT_NEAR(plane.right, static_cast<double>(coefficients(1).a), 1e-14);
    EXPECT_NEAR(plane.down, static_cast<double>(coefficients(1).b), 1e-14);
}

std::string refusal_of(const Panorama& view, const PlaneOptions& options = {}) {
    try {
        projection_planes(view, options);
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

TEST(BumpPlane, WhatTheSchemeCannotMeanIsRefused) {
    const Chart cylinder(Projection::cylindrical, 2048, 1024), screen(Projection::rectilinear, 64, 64, 60);
    const std::string draws =
        "machine: embm-2003 draws rectilinear views, without a lens, of cylindrical, equirectangular and "
        "mercator panoramas: ";
    EXPECT_EQ(refusal_of({Chart(Projection::cubemap, 64, 384), screen}),
              draws + "the source's projection is cubemap");
    EXPECT_EQ(refusal_of({Chart(Projection::fisheye, 64, 64), screen}),
              draws + "the source's projection is fisheye");
    EXPECT_EQ(refusal_of({cylinder, Chart(Projection::fisheye, 64, 64, 90)}),
              draws + "the picture's projection is fisheye");
    EXPECT_EQ(refusal_of({cylinder, Chart(Projection::cubemap, 64, 384)}),
              draws + "the picture's projection is cubemap");
    const LensModel lens = LensModel::parse("ptlens:a=0,b=0.01,c=0", "lens");
    EXPECT_EQ(
        refusal_of({cylinder, Chart(Projection::rectilinear, 64, 64, 60, PixelSpacing::edges, "", 1, lens)}),
        draws + "the picture has a lens");
    // The pole is seen from 60 degrees on; at 90 it is straight ahead.
    for (const double pitch : {60.0, 61.0, 90.0, -90.0, -75.0, 120.0})
        for (const int count : {1, 4})
            EXPECT_THAT(refusal_of({cylinder, screen, {0, pitch, 0}}, {count}),
                        HasSubstr("a part of the view is 90 degrees or more from the horizontal direction"))
                << pitch;
    // At 55 degrees up the plane reaches tan 85 = 11.4.
    EXPECT_EQ(refusal_of({cylinder, screen, {0, 45, 0}}), "");
    EXPECT_THAT(refusal_of({cylinder, screen, {0, 55, 0}}),
                HasSubstr("times the source's size, and a bump map holds -1 to 1"));
    EXPECT_THAT(refusal_of({cylinder, screen, {0, 59.99, 0}}), HasSubstr("times the source's size"));
    EXPECT_EQ(
        refusal_of({cylinder, screen}, {1, 0.5, 0}),
        "machine: x_max=0.5: must be 0 or at least 0.5773502691896257, as far as the view reaches on its "
        "projection plane");
}

}  // namespace
}  // namespace anamorph::test_bump_plane
