// SPDX-License-Identifier: Apache-2.0
// Faces and fisheyes with a margin: within it they are the pictures that they would be without one, and beyond that their planes go on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "anamorph/chart/chart.h"
#include "anamorph/error.h"
#include "anamorph/image/picture.h"
#include "anamorph/number/rounded.h"
#include "anamorph/panorama/reproject.h"

namespace anamorph::test_padding {
namespace {

constexpr unsigned kSeed = 20261;
using enum Projection;
constexpr Projection kPadded[] = {cubemap,         cubemap3x2, cubecross, eac,           dual_fisheye,
                                  dual_fisheye_tb, fisheye,    equisolid, stereographic, orthographic};

/// A chart with faces, or a picture, of n x n pixels.
Chart chart_of(Projection projection, int n, double padding, PixelSpacing spacing = PixelSpacing::edges) {
    const FaceGrid faces = faces_of(projection);
    return {
        projection, std::max(1, faces.columns) * n, std::max(1, faces.rows) * n, 0, spacing, "src", 1, {}, {},
        padding};
}

TEST(ChartPadding, IsAroundWhatTheFieldOfViewShows) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::normal_distribution<double> normal;
    for (const Projection projection : kPadded)
        for (const PixelSpacing spacing : {PixelSpacing::edges, PixelSpacing::centers})
            for (const int padding : {1, 7, 24}) {
                SCOPED_TRACE(testing::Message() << name_of(projection) << " " << padding);
                constexpr int kSide = 100;
                const Chart padded = chart_of(projection, kSide, padding, spacing),
                            inner = chart_of(projection, kSide - 2 * padding, 0, spacing);
                ASSERT_EQ(padded.pieces().size(), inner.pieces().size());
                const auto offset = [&](std::size_t piece) {
                    const Box &box = padded.pieces()[piece].box, &other = inner.pieces()[piece].box;
                    return Point<double>{double(box.x0 + padding - other.x0),
                                         double(box.y0 + padding - other.y0)};
                };
                int seen = 0;
                for (int i = 0; i < 400; ++i) {
                    const Ray<double> ray{normal(random), normal(random), normal(random)};
                    const int piece = inner.piece_of(ray);
                    ASSERT_EQ(padded.piece_of(ray), piece);
                    if (inner.pieces().size() == 1 && !(inner.sees(ray) > 0.1)) continue;
                    const auto [dx, dy] = offset(static_cast<std::size_t>(piece));
                    const Point<double> p = padded.point(ray, piece), q = inner.point(ray, piece);
                    EXPECT_NEAR(p.x, q.x + dx, 1e-9);
                    EXPECT_NEAR(p.y, q.y + dy, 1e-9);
                    ++seen;
                }
                EXPECT_GT(seen, 100);
                // Pixels of the margin look where the plane goes on.
                std::uniform_real_distribution<double> across(0, kSide), margin(0, padding);
                for (int i = 0; i < 100; ++i)
                    for (std::size_t piece = 0; piece < padded.pieces().size(); ++piece) {
                        const Box& box = padded.pieces()[piece].box;
                        const double x = box.x0 + margin(random), y = box.y0 + across(random);
                        const auto [dx, dy] = offset(piece);
                        const int own = static_cast<int>(piece);
                        if (!(inner.inside(x - dx, y - dy, own) > 0.01)) continue;
                        const Ray<double> r = padded.ray(x, y, own), s = inner.ray(x - dx, y - dy, own);
                        EXPECT_NEAR(r.x, s.x, 1e-12);
                        EXPECT_NEAR(r.y, s.y, 1e-12);
                        EXPECT_NEAR(r.z, s.z, 1e-12);
                    }
            }
}

// Also of paddings that are no whole pixels, as coarser levels have them.
TEST(ChartPadding, ScalesAreAsPreciseAsTheySay) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> share(0, 0.2499);
    for (int i = 0; i < 2000; ++i) {
        const int n = 8 + static_cast<int>(random() % 5000);
        const double padding = i % 10 == 0 ? 1e-300 : n * share(random);
        for (const auto& [projection, plane] :
             {std::pair{cubemap, 2.0L}, {fisheye, std::numbers::pi_v<long double>}}) {
            // Both are exact in long double, but for pi.
            const long double truth = (n - 2.0L * static_cast<long double>(padding)) / plane;
            const auto scale = chart_of(projection, n, padding).pixels_per_unit().as<Rounded<DoubleDouble>>();
            EXPECT_LE(scale.range.lo, truth);
            EXPECT_GE(scale.range.hi, truth);
            EXPECT_LT(scale.error, 1e-17 * static_cast<double>(truth));
        }
    }
}

TEST(ChartPadding, IsHalvedWithThePicture) {
    const Chart chart = chart_of(cubemap3x2, 101, 6), half = chart.resized(150, 100);
    EXPECT_EQ(chart.padding(), 6);
    EXPECT_NEAR(half.padding().pixels, 6 * 150.0 / 303, 1e-15);
    const Chart film(eac, 640, 360, 0, PixelSpacing::edges, "", 1, {}, {}, Padding(4, true));
    EXPECT_EQ(film.resized(160, 90).padding(), Padding(1, true));
    const Ray<double> ray{0.3, -0.2, 1};
    const int front = chart.piece_of(ray);
    EXPECT_NEAR(half.point(ray, front).x, chart.point(ray, front).x * 150 / 303, 1e-9);
}

// Pictures of padded faces, from padded faces: what is used is off by what is said at most.
TEST(ChartPadding, PicturesHoldTheirBounds) {
    for (const Projection from : {cubemap, eac, dual_fisheye, fisheye})
        for (const Projection to : {cubemap3x2, eac, fisheye})
            for (const double tol : {0.5, 0.01, 1e-6, 0.0}) {
                SCOPED_TRACE(testing::Message() << name_of(from) << " to " << name_of(to) << " tol " << tol);
                ReprojectOptions options;
                options.tol = tol;
                options.output = Output::error;
                const Panorama map(chart_of(from, 120, 13), chart_of(to, 64, 9), {20, 30, 40}, {-5, 3, 2});
                const Picture picture = reprojected_picture(map, options);
                const double bound = picture.reached().max_error;
                // Exact pixels have their rounding, which next to the point behind a fisheye is large.
                EXPECT_LE(bound, tol == 0 ? 1e-4 : tol);
                std::vector<float> errors(static_cast<std::size_t>(picture.width() * picture.height()));
                ASSERT_TRUE(
                    picture.draw(nullptr, {0, 0, picture.width(), picture.height()},
                                 packed_view(reinterpret_cast<std::byte*>(errors.data()), PixelType::float32,
                                             picture.width(), picture.height(), 1)));
                EXPECT_LE(*std::max_element(errors.begin(), errors.end()), bound * (1 + 1e-6));
            }
}

/// The pixel of a direction in an equi-angular cube of `width` x `height` pixels with a margin around each row of faces, written out
/// in long double. `column` and `row` say on which face.
Point<long double> equi_angular_pixel(const Ray<double>& ray, int width, int height, long double margin,
                                      int& column, int& row) {
    const long double x = ray.x, y = ray.y, z = ray.z;
    const long double ax = std::fabs(x), ay = std::fabs(y), az = std::fabs(z);
    long double across, down, ahead;
    if (ax >= ay && ax >= az) {
        row = 0, column = x > 0 ? 2 : 0;
        across = x > 0 ? -z : z, down = y, ahead = ax;
    } else if (az >= ay && z > 0) {
        row = 0, column = 1;
        across = x, down = y, ahead = az;
    } else if (az >= ay) {
        // Behind, with its left side down: its upper edge is at the right.
        row = 1, column = 1;
        across = -y, down = -x, ahead = az;
    } else {
        row = 1, column = y > 0 ? 0 : 2;
        across = y > 0 ? -z : z, down = -x, ahead = ay;
    }
    constexpr long double kPi = std::numbers::pi_v<long double>;
    const long double side = (width - 2 * margin) / 3, tall = height / 2.0L - 2 * margin;
    return {margin + side * (column + 0.5L + std::atan2(across, ahead) / (kPi / 2)),
            row * (height / 2.0L) + margin + tall * (0.5L + std::atan2(down, ahead) / (kPi / 2))};
}

// Rows of faces with a margin around them alone, and faces that are no whole pixels wide, as films have them.
TEST(ChartPadding, RowsOfFacesAreWhereTheyBelong) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::normal_distribution<double> normal;
    for (const auto& [width, height] :
         {std::pair{1280, 720}, {2560, 1440}, {640, 360}, {7, 8}, {1048573, 1048576}})
        for (const int margin : {0, 2, 31}) {
            if (margin > 0 && 8 * margin > std::min(width / 3, height / 2)) continue;
            const Chart chart(eac, width, height, 0, PixelSpacing::edges, "", 1, {}, {},
                              Padding(margin, true));
            const double rounding = 1e-15 * 8 * std::max(width, height);
            for (int i = 0; i < 2000; ++i) {
                const Ray<double> ray{normal(random), normal(random), normal(random)};
                const int piece = chart.piece_of(ray);
                int column = 0, row = 0;
                const Point<long double> truth = equi_angular_pixel(ray, width, height, margin, column, row);
                ASSERT_EQ(piece, 3 * row + column);
                const Point<double> found = chart.point(ray, piece);
                EXPECT_NEAR(found.x, static_cast<double>(truth.x), rounding);
                EXPECT_NEAR(found.y, static_cast<double>(truth.y), rounding);
                // And what rounding is said to do.
                using R = Rounded<double>;
                const glm::dmat3 turned = glm::transpose(chart.branch(piece).axes);
                const Point<R> bound = chart.local_point(
                    transform(turned, Ray<R>{R(ray.x), R(ray.y), R(ray.z)}), chart.branch(piece));
                EXPECT_LE(std::fabs(static_cast<double>(found.x - truth.x)), bound.x.error);
                EXPECT_LE(std::fabs(static_cast<double>(found.y - truth.y)), bound.y.error);
                const Ray<double> back = chart.ray(found.x, found.y, piece);
                const double length = std::hypot(ray.x, ray.y, ray.z),
                             other = std::hypot(back.x, back.y, back.z);
                EXPECT_NEAR(ray.x / length, back.x / other, 1e-14);
                EXPECT_NEAR(ray.y / length, back.y / other, 1e-14);
                // A pixel belongs to the face that its middle lies on.
                const Box& box = chart.pieces()[static_cast<std::size_t>(piece)].box;
                EXPECT_GE(found.x, box.x0 - 0.5);
                EXPECT_LE(found.x, box.x1 + 0.5);
            }
            int pixels = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                EXPECT_EQ(chart.pieces()[i].box.x0, pixels);
                pixels = chart.pieces()[i].box.x1;
            }
            EXPECT_EQ(pixels, width);
        }
}

TEST(ChartPadding, PicturesOfRowsHoldTheirBounds) {
    const auto rows = [](int width, int height, double margin) {
        return Chart(eac, width, height, 0, PixelSpacing::edges, "", 1, {}, {}, Padding(margin, true));
    };
    for (const double tol : {0.5, 0.01, 1e-6, 0.0})
        for (const auto& [from, to] : {std::pair{rows(320, 180, 2), chart_of(cubemap3x2, 64, 9)},
                                       {rows(320, 180, 0), chart_of(fisheye, 96, 0)},
                                       {chart_of(cubemap, 120, 0), rows(160, 90, 2)},
                                       {rows(319, 200, 3), rows(161, 98, 0)}}) {
            SCOPED_TRACE(testing::Message() << to.width() << "x" << to.height() << " tol " << tol);
            ReprojectOptions options;
            options.tol = tol;
            options.output = Output::error;
            const Picture picture =
                reprojected_picture(Panorama(from, to, {20, 30, 40}, {-5, 3, 2}), options);
            const double bound = picture.reached().max_error;
            EXPECT_LE(bound, tol == 0 ? 1e-4 : tol);
            std::vector<float> errors(static_cast<std::size_t>(picture.width() * picture.height()));
            ASSERT_TRUE(picture.draw(nullptr, {0, 0, picture.width(), picture.height()},
                                     packed_view(reinterpret_cast<std::byte*>(errors.data()),
                                                 PixelType::float32, picture.width(), picture.height(), 1)));
            EXPECT_LE(*std::max_element(errors.begin(), errors.end()), bound * (1 + 1e-6));
        }
}

TEST(ChartPadding, ErrorsNameTheParameterItsValueAndWhatIsAllowed) {
    const auto error = [](Projection projection, double padding, const LensModel& lens = {},
                          const VerticalField& vertical = {}) -> std::string {
        const FaceGrid faces = faces_of(projection);
        try {
            Chart(projection, std::max(1, faces.columns) * 40, std::max(1, faces.rows) * 40, 0,
                  PixelSpacing::edges, "src", 1, lens, vertical, padding);
            return "";
        } catch (const Error& e) {
            EXPECT_EQ(e.parameter(), "srcpadding");
            return e.what();
        }
    };
    using testing::HasSubstr;
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = HUGE_VAL;
    for (const double bad : {10.0, -1.0, 1e9, kNan, kInfinity, -kInfinity})
        EXPECT_THAT(error(cubemap, bad), HasSubstr("less than a quarter of the sides, 40x40 pixels"));
    EXPECT_THAT(error(cubemap, 9.999), "");
    for (const Projection projection :
         {equirectangular, rectilinear, octahedral, mercator, pannini, mirror_ball})
        EXPECT_THAT(error(projection, 2),
                    HasSubstr("srcpadding=2: must be of a layout of faces or of a fisheye"));
    EXPECT_THAT(error(fisheye, 2, LensModel::parse("kb4:k1=0.1")),
                HasSubstr("must not be given with srclens"));
    EXPECT_THAT(error(fisheye, 2, {}, {100}), HasSubstr("must not be given with srcvfov"));
}

}  // namespace
}  // namespace anamorph::test_padding
