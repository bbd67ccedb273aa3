// SPDX-License-Identifier: Apache-2.0
// Views of concentric mosaics against a scene whose every line of sight is known: a wall all around, at one distance from
// the centre, whose pixels say where they are. What stands here shares no formula with what it tests.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <numbers>

#include "anamorph/image/part_source.h"
#include "anamorph/operation/operation.h"
#include "anamorph/panorama/concentric_view.h"

namespace anamorph::test_concentric {
namespace {

using Real = long double;
constexpr Real kPi = std::numbers::pi_v<long double>;

struct Place {
    Real x, z;
};
/// Of the wall: azimuth from straight ahead to the right, and height, downwards.
struct OnWall {
    Real azimuth, height;
};

/// Where a line of sight from `from`, towards the azimuth `turn` and down by `slope`, meets a wall at `distance`: the root of
/// |from + k u|^2 = distance^2 in front.
OnWall seen_on_wall(const Place& from, Real turn, Real slope, Real distance) {
    const Real ux = std::sin(turn), uz = std::cos(turn);
    const Real along = from.x * ux + from.z * uz,
               rest = from.x * from.x + from.z * from.z - distance * distance;
    const Real k = -along + std::sqrt(along * along - rest);
    return {std::atan2(from.x + k * ux, from.z + k * uz), slope * k};
}

Real turned_into(Real angle) {
    return angle - 2 * kPi * std::round(angle / (2 * kPi));
}

/// A stack of cylindrical panoramas of a wall: two channels of the place along it, one of the height.
struct Wall {
    int width, rows, circles;
    Real distance;
    std::vector<float> texels = {};

    Real radius(int circle) const { return circles == 1 ? 0 : Real(2 * circle) / (circles - 1) - 1; }

    /// What all of them show of the wall, less a tenth.
    Real height() const { return Real(0.9) * rows * kPi / width * std::sqrt(distance * distance - 1); }

    void draw() {
        texels.resize(static_cast<std::size_t>(width * rows * circles * 3));
        float* to = texels.data();
        for (int k = 0; k < circles; ++k)
            for (int y = 0; y < rows; ++y)
                for (int x = 0; x < width; ++x, to += 3) {
                    // A slit stands where its circle touches its line of sight: to the right of the centre.
                    const Real turn = (x + Real(0.5)) / width * 2 * kPi - kPi;
                    const Place slit{radius(k) * std::cos(turn), -radius(k) * std::sin(turn)};
                    const Real slope = (y + Real(0.5) - Real(rows) / 2) / (width / (2 * kPi));
                    const OnWall seen = seen_on_wall(slit, turn, slope, distance);
                    to[0] = static_cast<float>(std::sin(seen.azimuth));
                    to[1] = static_cast<float>(std::cos(seen.azimuth));
                    to[2] = static_cast<float>(seen.height);
                }
    }
    MemorySource source() const {
        return MemorySource(packed_view(std::as_bytes(std::span(texels)).data(), PixelType::float32, width,
                                        rows * circles, 3));
    }
};

/// A rectilinear view of 90 degrees, and where its pixels look.
struct View {
    int side;
    double yaw, pitch;

    /// Azimuth and slope downwards of a pixel, by turning its ray about x, then about the vertical.
    std::pair<Real, Real> sight(int i, int j) const {
        const Real x = (i + Real(0.5)) * 2 / side - 1, y = (j + Real(0.5)) * 2 / side - 1;
        const Real p = pitch * kPi / 180;
        const Real down = y * std::cos(p) - std::sin(p), ahead = y * std::sin(p) + std::cos(p);
        return {std::atan2(x, ahead) + yaw * kPi / 180, down / std::hypot(x, ahead)};
    }
    Panorama of(const Wall& wall) const {
        return Panorama(Chart(Projection::cylindrical, wall.width, wall.rows, 360),
                        Chart(Projection::rectilinear, side, side, 90), {.yaw = yaw, .pitch = pitch});
    }
};

std::vector<float> draw(const Picture& picture, const Wall& wall, int side, int channels = 3) {
    const MemorySource stack = wall.source();
    std::vector<PartSource> strips;
    for (int i = 0; i < wall.circles; ++i)
        strips.emplace_back(stack, Box{0, i * wall.rows, stack.size(0).width, (i + 1) * wall.rows});
    std::vector<const Source*> sources;
    for (const PartSource& strip : strips) sources.push_back(&strip);
    std::vector<float> pixels(static_cast<std::size_t>(side * side * channels));
    EXPECT_TRUE(picture.draw(sources, {0, 0, side, side},
                             packed_view(std::as_writable_bytes(std::span(pixels)).data(), PixelType::float32,
                                         side, side, channels),
                             serial_for));
    return pixels;
}

/// What a picture of the wall is off by: the place along it in texels of a panorama from the centre, and the height as it
/// is drawn relative to the true one, between the least and the most.
struct Off {
    double across = 0, least_height = HUGE_VAL, most_height = 0;
};
Off off(const std::vector<float>& pixels, const Wall& wall, const View& view, const Place& from) {
    Off worst;
    for (int j = 0; j < view.side; ++j)
        for (int i = 0; i < view.side; ++i) {
            const float* p = &pixels[static_cast<std::size_t>(j * view.side + i) * 3];
            const auto [turn, slope] = view.sight(i, j);
            const OnWall truth = seen_on_wall(from, turn, slope, wall.distance);
            // Nearer to the upper and lower edges of the panoramas there is black.
            if (std::fabs(truth.height) > wall.height()) continue;
            const Real azimuth = std::atan2(Real(p[0]), Real(p[1]));
            const Real across = std::fabs(turned_into(azimuth - truth.azimuth)) * wall.width / (2 * kPi);
            worst.across = std::max(worst.across, static_cast<double>(across));
            if (std::fabs(truth.height) < wall.distance / 8) continue;
            // What stands where the other should be is drawn at the other's height.
            const auto height = static_cast<double>(truth.height / p[2]);
            worst.least_height = std::min(worst.least_height, height);
            worst.most_height = std::max(worst.most_height, height);
        }
    return worst;
}

ReprojectOptions bilinear() {
    ReprojectOptions options;
    options.filter = Filter::bilinear;
    return options;
}

TEST(Concentric, AWallAtTheStatedDepthIsExact) {
    const Place from{0.55L, -0.4L};
    for (const int circles : {1, 2, 5}) {
        Wall wall{1024, 400, circles, 2.5L};
        wall.draw();
        for (const View& view : {View{96, 30, 0}, View{96, 171, 12}, View{96, -100, -20}}) {
            ConcentricStack stack{circles, 2.5, {double(from.x), double(from.z)}};
            const Picture seen = mosaic_picture(view.of(wall), stack, bilinear());
            const Off worst = off(draw(seen, wall, view.side), wall, view, from);
            // tol, and what the middle of a chord between two texels is off its arc.
            EXPECT_LT(worst.across, 0.012) << circles << " circles, yaw " << view.yaw;
            EXPECT_NEAR(worst.least_height, 1, 2e-4);
            EXPECT_NEAR(worst.most_height, 1, 2e-4);
            EXPECT_LE(seen.reached(serial_for).max_error, 0.01);
        }
    }
}

TEST(Concentric, OtherWallsAreExactAcrossAndOffInHeightAsStated) {
    const Place from{0.3L, 0.6L};
    const double along = std::atan2(0.3, 0.6) * 180 / std::numbers::pi;
    Wall wall{512, 320, 17, 2};
    wall.draw();
    for (const double depth : {double(HUGE_VAL), 4.0}) {
        ConcentricStack stack{wall.circles, depth, {double(from.x), double(from.z)}};
        double largest = 0;
        for (const double yaw : {along, along + 180}) {
            const View view{96, yaw, 5};
            const Picture seen = mosaic_picture(view.of(wall), stack, bilinear());
            const Off worst = off(draw(seen, wall, view.side), wall, view, from);
            // tol, and what the middle between two circles, an eighth apart, is off the arc over it.
            EXPECT_LT(worst.across, 0.012 + 0.02) << yaw;
            largest = std::max({largest, worst.most_height - 1, 1 - worst.least_height});
        }
        const double stated = stack.vertical_distortion(2.0);
        // And 2e-4 of a height by bilinear texels, as in the test above.
        EXPECT_LE(largest, stated + 2e-4 * (1 + stated)) << depth;
        EXPECT_GE(largest, 0.9 * stated) << depth;
    }
}

TEST(Concentric, DistortionInClosedForm) {
    // Looking away from the centre and back to it, at things at 3 and at infinity, which are taken to be at 5.
    const ConcentricStack stack{9, 5, {0.6, 0}};
    const double away = 1 / (1 - 0.6 / 5) - 1, back = 1 - 1 / (1 + 0.6 / 5);  // those at infinity
    EXPECT_NEAR(stack.vertical_distortion({1, 0, 0}, 3), away, 1e-12);
    EXPECT_NEAR(stack.vertical_distortion({-1, 0, 0}, 3), back, 1e-12);
    EXPECT_NEAR(stack.vertical_distortion(3), away, 1e-3);
    // Things at 1.2 that are taken to be at 5: drawn too low ahead, too high behind.
    EXPECT_NEAR(stack.vertical_distortion({1, 0, 0}, 1.2), 1 - (1 - 0.6 / 1.2) / (1 - 0.6 / 5), 1e-12);
    EXPECT_NEAR(stack.vertical_distortion({-1, 0, 0}, 1.2), (1 + 0.6 / 1.2) / (1 + 0.6 / 5) - 1, 1e-12);
    EXPECT_EQ(ConcentricStack({9, HUGE_VAL, {0, 0}}).vertical_distortion(2), 0);
}

/// The point of a panorama of a circle that shows what a viewpoint sees, by way of the wall at the stack's depth.
Point<Real> source_point(const Wall& wall, const Place& from, int circle, Real turn, Real slope) {
    const OnWall seen = seen_on_wall(from, turn, slope, wall.distance);
    const Real r = wall.radius(circle), across = std::sqrt(wall.distance * wall.distance - r * r);
    // The slit whose line of sight goes there: the tangent's foot is acos(r / distance) before the place.
    const Real column = seen.azimuth + std::acos(r / wall.distance) - kPi / 2;
    const Real per_radian = wall.width / (2 * kPi);
    return {(turned_into(column) + kPi) * per_radian,
            Real(wall.rows) / 2 + seen.height / across * per_radian};
}

TEST(Concentric, SourcePointsHoldTheToleranceInEveryScheme) {
    const Place from{-0.7L, 0.2L};
    const Wall wall{512, 256, 4, 1.5L};
    for (const Scheme scheme : {Scheme::automatic, Scheme::exact, Scheme::blocks, Scheme::residual})
        for (const double tol : {0.25, 0.01, 1e-6})
            for (const int circle : {0, 1, 3}) {
                const View view{160, 175, -8};
                ReprojectOptions options;
                options.scheme = scheme;
                options.tol = tol;
                options.output = Output::stmap;
                const ConcentricStack stack{wall.circles, 1.5, {double(from.x), double(from.z)}};
                const Picture seen = mosaic_picture(view.of(wall), stack, options, circle);
                const std::vector<float> st = draw(seen, wall, view.side, 2);
                double worst = 0;
                int found = 0;
                for (int j = 0; j < view.side; ++j)
                    for (int i = 0; i < view.side; ++i) {
                        const float* p = &st[static_cast<std::size_t>(j * view.side + i) * 2];
                        if (p[0] < 0) continue;
                        const auto [turn, slope] = view.sight(i, j);
                        const Point<Real> truth = source_point(wall, from, circle, turn, slope);
                        Real dx = std::fabs(p[0] * wall.width - truth.x);
                        dx = std::min(dx, wall.width - dx);
                        worst = std::max(worst, double(std::hypot(dx, p[1] * wall.rows - truth.y)));
                        ++found;
                    }
                EXPECT_GT(found, view.side * view.side / 3);
                EXPECT_LE(worst, tol + 4e-5) << "as far as float holds them, circle " << circle;
                EXPECT_LE(seen.reached(serial_for).max_error, std::max(tol, 1e-9));
            }
}

TEST(Concentric, StraightUpThereIsNothing) {
    // The middles of the first and last rows are the poles.
    const Chart slit(Projection::cylindrical, 24, 6, 360), view(Projection::equirectangular, 4, 3, 360);
    ReprojectOptions options;
    options.output = Output::bound;
    for (const double tol : {0.0, 0.01}) {
        options.tol = tol;
        const Picture seen = mosaic_picture(Panorama(slit, view), {2, 4, {0.4, 0.3}}, options);
        std::vector<float> bounds(12, -1);
        ASSERT_TRUE(seen.draw(
            {nullptr, nullptr}, {0, 0, 4, 3},
            packed_view(std::as_writable_bytes(std::span(bounds)).data(), PixelType::float32, 4, 3, 1),
            serial_for));
        for (const float bound : bounds) EXPECT_LT(bound, 1e-9f);
        EXPECT_LT(seen.reached(serial_for).max_error, 1e-9);
    }
}

TEST(Concentric, StraightUpIsThePole) {
    const Chart turn(Projection::equirectangular, 24, 12), view(Projection::rectilinear, 3, 3, 90);
    for (const double pitch : {90.0, -90.0})
        for (const double tol : {0.0, 0.01}) {
            ReprojectOptions options;
            options.tol = tol;
            const auto drawn = [&](Output output, std::optional<int> circle) {
                options.output = output;
                const Picture seen =
                    mosaic_picture(Panorama(turn, view, {0, pitch, 0}), {2, 4, {0.4, 0.3}}, options, circle);
                EXPECT_LT(seen.reached(serial_for).max_error, 1e-9);
                std::vector<float> values(18, -1);
                EXPECT_TRUE(seen.draw({nullptr, nullptr}, {0, 0, 3, 3},
                                      packed_view(std::as_writable_bytes(std::span(values)).data(),
                                                  PixelType::float32, 3, 3, output == Output::stmap ? 2 : 1),
                                      serial_for));
                return values;
            };
            EXPECT_EQ(drawn(Output::stmap, 0)[9], pitch > 0 ? 0 : 1);
            EXPECT_LT(drawn(Output::bound, {})[4], 1e-9f);
        }
}

TEST(Concentric, WeightsOfAllCirclesAddUp) {
    const ConcentricStack stack{7, HUGE_VAL, {0.5, 0.5}};
    for (double offset = -1; offset <= 1; offset += 1.0 / 64) {
        double sum = 0;
        for (int i = 0; i < 7; ++i) sum += stack.weight(i, offset);
        EXPECT_NEAR(sum, 1, 1e-12);
    }
    EXPECT_EQ(stack.weight(2, stack.radius(2)), 1);
    EXPECT_EQ(stack.weight(2, stack.radius(4)), 0);
}

TEST(Concentric, WhatHasNoWeightDoesNotShow) {
    // From the centre only the middle circle counts, whatever the others hold.
    Wall wall{64, 20, 3, 2};
    wall.draw();
    const std::size_t strip = wall.texels.size() / 3;
    std::fill_n(wall.texels.begin(), strip, HUGE_VALF);
    std::fill_n(wall.texels.begin() + static_cast<std::ptrdiff_t>(2 * strip), strip, std::nanf(""));
    const View view{48, 77, 0};
    for (const double tol : {0.01, 0.0}) {
        ReprojectOptions options = bilinear();
        options.tol = tol;
        const Picture mixed = mosaic_picture(view.of(wall), {3, 2, {0, 0}}, options),
                      alone = mosaic_picture(view.of(wall), {3, 2, {0, 0}}, options, 1);
        EXPECT_EQ(draw(mixed, wall, 48), draw(alone, wall, 48));
    }
}

TEST(Concentric, PartsAreTheSameAsTheWhole) {
    Wall wall{128, 40, 5, 2};
    wall.draw();
    const View view{64, 100, 10};
    for (const double tol : {0.01, 0.0}) {
        ReprojectOptions options;
        options.tol = tol;
        const Picture seen = mosaic_picture(view.of(wall), {5, HUGE_VAL, {0.5, -0.6}}, options);
        const std::vector<float> whole = draw(seen, wall, 64), part = [&] {
            const MemorySource stack = wall.source();
            std::deque<PartSource> strips;
            std::vector<const Source*> sources;
            for (int i = 0; i < 5; ++i)
                sources.push_back(
                    &strips.emplace_back(stack, Box{0, 8 * 5 * i, stack.size(0).width, 8 * 5 * i + 40}));
            std::vector<float> pixels(30 * 20 * 3);
            EXPECT_TRUE(seen.draw(
                sources, {21, 33, 51, 53},
                packed_view(std::as_writable_bytes(std::span(pixels)).data(), PixelType::float32, 30, 20, 3),
                serial_for));
            return pixels;
        }();
        for (std::size_t row = 0; row < 20; ++row)
            EXPECT_TRUE(std::equal(part.begin() + static_cast<std::ptrdiff_t>(row * 90),
                                   part.begin() + static_cast<std::ptrdiff_t>(row * 90 + 90),
                                   whole.begin() + static_cast<std::ptrdiff_t>(((row + 33) * 64 + 21) * 3)));
    }
}

TEST(PartSource, KeepsTheLevelsThatDoNotMix) {
    std::vector<std::byte> texels(16 * 24);
    for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = std::byte(i);
    const MemorySource base(packed_view<const std::byte>(texels.data(), PixelType::uint8, 16, 24, 1));
    const PartSource strip(base, {0, 8, 16, 16});
    EXPECT_EQ(strip.levels(), 1);
    EXPECT_EQ(strip.size(0), (Size{16, 8}));
    std::byte row[16];
    ASSERT_TRUE(strip.read(0, {0, 3, 16, 4}, row, 16));
    EXPECT_EQ(row[5], texels[(8 + 3) * 16 + 5]);
    ASSERT_NE(strip.view(0), nullptr);
    EXPECT_EQ(*strip.view(0)->at(5, 3), row[5]);
}

std::string error_of(const std::vector<Assignment>& assignments, const Size& source = {64, 24}) {
    const Operation& mosaic = *find_operation("mosaic");
    ParameterValues values(*mosaic.parameters);
    values.assign(assignments);
    SourceImage image;
    image.facts.width = source.width;
    image.facts.height = source.height;
    image.channels = 3;
    struct NoFiles final : SideFileReader {
        std::string text(const std::string& name) const override { throw Error(name); }
        std::unique_ptr<SideImage> image(const std::string&, const std::string& name) const override {
            throw Error(name);
        }
    } reader;
    try {
        static_cast<void>(mosaic.read({values, {image}, {}, reader}));
        return "";
    } catch (const Error& e) {
        return e.what();
    }
}

TEST(MosaicRequest, SaysWhatIsWrong) {
    EXPECT_EQ(error_of({{"circles", "3"}, {"x", "0.6"}, {"z", "-0.8"}}), "");
    EXPECT_EQ(error_of({{"circles", "5"}}), "circles=5: must divide the source's height, 24");
    EXPECT_EQ(error_of({{"x", "0.8"}, {"z", "0.7"}}),
              "z=0.7: must be inside the outer circle together with x=0.8");
    EXPECT_EQ(error_of({{"circles", "3"}, {"circle", "4"}}), "circle=4: must be one of the circles, 1 to 3");
    EXPECT_EQ(error_of({{"output", "distortion"}}), "output=distortion: needs nearest or depth");
    EXPECT_EQ(error_of({{"output", "distortion"}, {"nearest", "3"}}), "");
}

}  // namespace
}  // namespace anamorph::test_concentric
