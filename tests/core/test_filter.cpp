// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/point_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "anamorph/image/pixel.h"

namespace anamorph::test_filter {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// An image in memory with its source and border.
struct Picture {
    Picture(const Chart& chart, int channel_count, PixelType type, Wrap wrap, int alpha = -1)
        : width(chart.width()),
          height(chart.height()),
          channels(channel_count),
          bytes(static_cast<std::size_t>(width * height * channels * size_of(type))),
          image(packed_view(bytes.data(), type, width, height, channels)),
          source(packed_view<const std::byte>(bytes.data(), type, width, height, channels), alpha),
          border(chart, wrap) {}
    template <class Function>
    void fill(const Function& value) {
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (int c = 0; c < channels; ++c)
                    store_channel(static_cast<float>(value(x + 0.5, y + 0.5, c)),
                                  image.at(x, y) + c * size_of(image.type), image.type);
    }
    std::vector<float> sample(Filter filter, double x, double y, int piece = 0) {
        std::vector<float> pixel(static_cast<std::size_t>(channels), -7);
        PointSampler sampler(source, border);
        EXPECT_TRUE(sampler.sample(filter, 0, piece, x, y, pixel.data()));
        return pixel;
    }

    int width, height, channels;
    std::vector<std::byte> bytes;
    ImageView image;
    MemorySource source;
    Border border;
};

const Chart& flat() {
    static const Chart chart(Projection::rectilinear, 40, 30);
    return chart;
}

TEST(Weights, SumToOneAndInterpolate) {
    for (int i = 0; i < 1000; ++i) {
        const double t = i / 1000.0;
        const auto w = cubic_weights(t, -0.5);
        EXPECT_NEAR(w[0] + w[1] + w[2] + w[3], 1, 1e-15);
        // First and second moments: polynomials of degree 2 are reproduced.
        EXPECT_NEAR(-w[0] + w[2] + 2 * w[3], t, 1e-15);
        EXPECT_NEAR(w[0] + w[2] + 4 * w[3], t * t, 1e-14);
        const auto f = cubic_weights(static_cast<float>(t), kBicubicSlope);
        for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(f[k], w[k], 2e-7);
        const auto b = bilinear_weights(t);
        EXPECT_EQ(b[0] + b[1], 1);
        EXPECT_EQ(b[1], t);
    }
    // In the middle of a texel, of either side, all others have no weight at all.
    for (const bool sharp : {false, true})
        for (const std::size_t middle : {0u, 1u}) {
            const auto in_float = cubic_weights(static_cast<float>(middle), cubic_slope(sharp));
            const auto in_double = cubic_weights(static_cast<double>(middle), double{cubic_slope(sharp)});
            for (std::size_t k = 0; k < 4; ++k) {
                EXPECT_EQ(in_float[k], k == middle + 1 ? 1 : 0);
                EXPECT_EQ(in_double[k], k == middle + 1 ? 1 : 0);
            }
        }
}

/// The cubics of Mitchell and Netravali 1988, eq. 8, by their B and C.
long double mitchell_netravali(long double b, long double c, long double x) {
    x = std::fabs(x);
    if (x < 1) return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
    if (x < 2)
        return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x +
                (8 * b + 24 * c)) /
               6;
    return 0;
}

TEST(Weights, CubicsAreThoseOfTheirC) {
    for (const bool sharp : {false, true}) {
        const long double c = sharp ? 2.0L / 3 : 0.5L;
        for (int i = 0; i <= 1000; ++i) {
            const double t = i / 1000.0;
            const auto w = cubic_weights(t, double{cubic_slope(sharp)});
            EXPECT_NEAR(w[0] + w[1] + w[2] + w[3], 1, 1e-15);
            for (std::size_t k = 0; k < 4; ++k) {
                const long double expected =
                    mitchell_netravali(0, c, static_cast<long double>(k) - 1 - static_cast<long double>(t));
                EXPECT_NEAR(static_cast<double>(w[k] - expected), 0, sharp ? 2e-8 : 1e-15);
            }
        }
    }
}

TEST(Weights, TheSharpCubicKeepsAFifthOfTheSamplingRate) {
    // The response is the integral of the kernel times the cosine: weights of points that lie evenly between texels.
    const auto response = [](bool sharp, long double frequency) {
        constexpr int kPoints = 4096;
        const long double pi = std::acos(-1.0L);
        long double sum = 0;
        for (int i = 0; i < kPoints; ++i) {
            const long double t = (i + 0.5L) / kPoints;
            const auto w = cubic_weights(static_cast<double>(t), double{cubic_slope(sharp)});
            for (std::size_t k = 0; k < 4; ++k)
                sum += static_cast<long double>(w[k]) *
                       std::cos(2 * pi * frequency * (static_cast<long double>(k) - 1 - t));
        }
        return static_cast<double>(sum / kPoints);
    };
    EXPECT_NEAR(response(true, 0.2L), 0.9976, 5e-5);
    EXPECT_NEAR(response(false, 0.2L), 0.973, 5e-4);
    for (int i = 0; i <= 200; ++i) {
        const double kept = response(true, i / 1000.0L);
        EXPECT_GE(kept, 0.99);
        EXPECT_LE(kept, 1.0076);
    }
}

TEST(PointSampler, NearestReadsTheTexelUnderThePoint) {
    Picture picture(flat(), 1, PixelType::float32, Wrap::automatic);
    picture.fill([](double x, double y, int) { return std::floor(x) + 100 * std::floor(y); });
    EXPECT_EQ(picture.sample(Filter::nearest, 7.0, 3.999)[0], 307);
    EXPECT_EQ(picture.sample(Filter::nearest, 39.999, 29.999)[0], 2939);
    EXPECT_EQ(picture.sample(Filter::nearest, 40.0, 29.0)[0], 0);
    EXPECT_EQ(picture.sample(Filter::nearest, -1e-9, 5.0)[0], 0);
}

TEST(PointSampler, BilinearReproducesLinearAndBicubicQuadraticFunctions) {
    constexpr unsigned kSeed = 5;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> inner(2.5, 27.5);
    for (const PixelType type : {PixelType::uint8, PixelType::uint16, PixelType::half, PixelType::float32}) {
        const double step = type == PixelType::uint8    ? 0.5 / 255
                            : type == PixelType::uint16 ? 0.5 / 65535
                                                        : 0x1p-11;
        const double allowed = type == PixelType::float32 ? 1e-6 : 1.6 * step;
        Picture linear(flat(), 3, type, Wrap::automatic), quadratic(flat(), 3, type, Wrap::automatic);
        const auto plane = [](double x, double y, int c) { return 0.02 * x + 0.003 * (c + 1) * y; };
        const auto bowl = [](double x, double y, int c) {
            return (x * x + (c + 1) * y * x - y * y + 900) / 6000;
        };
        linear.fill(plane);
        quadratic.fill(bowl);
        for (int i = 0; i < 300; ++i) {
            const double x = inner(random), y = inner(random);
            const auto one = linear.sample(Filter::bilinear, x, y),
                       two = quadratic.sample(Filter::bicubic, x, y);
            for (int c = 0; c < 3; ++c) {
                ASSERT_NEAR(one[static_cast<std::size_t>(c)], plane(x, y, c), allowed);
                ASSERT_NEAR(two[static_cast<std::size_t>(c)], bowl(x, y, c), allowed);
            }
        }
    }
}

TEST(PointSampler, TexelCentresAreReadExactly) {
    Picture picture(flat(), 1, PixelType::float32, Wrap::automatic);
    picture.fill([](double x, double y, int) { return std::sin(13 * x + 7 * y); });
    for (const Filter filter : {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic})
        for (int y = 0; y < 30; ++y)
            for (int x = 0; x < 40; ++x)
                ASSERT_EQ(picture.sample(filter, x + 0.5, y + 0.5)[0],
                          load_channel(picture.image.at(x, y), PixelType::float32));
}

TEST(PointSampler, NanAndInfinityStayInTheirFootprint) {
    for (const float poison : {kNan, std::numeric_limits<float>::infinity()}) {
        Picture picture(flat(), 1, PixelType::float32, Wrap::automatic);
        picture.fill([&](double x, double y, int) {
            return std::floor(x) == 12 && std::floor(y) == 9 ? poison : 1.0;
        });
        // Texel 12 has its centre at 12.5; a filter of reach r sees it from points nearer than r.
        const std::pair<Filter, double> reaches[] = {
            {Filter::bilinear, 1}, {Filter::bicubic, 2}, {Filter::sharp_bicubic, 2}};
        for (const auto& [filter, reach] : reaches)
            for (double y = 6; y < 13; y += 0.25)
                for (double x = 9; x < 16; x += 0.25) {
                    bool sees = std::fabs(x - 12.5) < reach && std::fabs(y - 9.5) < reach;
                    // Catmull-Rom is zero at the other texels' centres.
                    for (const double d : {x - 12.5, y - 9.5}) sees = sees && !(d != 0 && std::floor(d) == d);
                    const float value = picture.sample(filter, x, y)[0];
                    ASSERT_EQ(sees, !std::isfinite(value)) << x << ' ' << y;
                    if (!sees) {
                        ASSERT_NEAR(value, 1, 1e-6);
                    }
                }
    }
}

TEST(PointSampler, PointsFarAwayOrNoPointsAreSafe) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    for (const Wrap wrap : {Wrap::automatic, Wrap::black, Wrap::clamp, Wrap::periodic, Wrap::mirror}) {
        Picture picture(flat(), 1, PixelType::float32, wrap);
        picture.fill([](double, double, int) { return 2; });
        for (const Filter filter :
             {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic})
            for (const double far : {1e9, 1e30, kInfinity, -1e30, -kInfinity}) {
                const float expected = wrap == Wrap::automatic || wrap == Wrap::black ? 0 : 2;
                EXPECT_EQ(picture.sample(filter, far, 5.25)[0], expected);
                EXPECT_EQ(picture.sample(filter, 5.25, far)[0], expected);
                EXPECT_EQ(picture.sample(filter, static_cast<double>(kNan), 5)[0], 0);
                EXPECT_EQ(picture.sample(filter, 5, static_cast<double>(kNan))[0], 0);
            }
    }
}

TEST(PointSampler, FootprintsOverAndBesideTheEdgeAreTheMeanOfTheirTaps) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    for (const Wrap wrap : {Wrap::automatic, Wrap::black, Wrap::clamp, Wrap::periodic, Wrap::mirror}) {
        Picture picture(flat(), 1, PixelType::float32, wrap);
        picture.fill([](double x, double y, int) { return 1 + std::sin(13 * x + 7 * y); });
        const FootprintChooser chooser(picture.source);
        PointSampler sampler(picture.source, picture.border);
        int beside = 0, over = 0;
        for (const double step : {1.0, 3.0, 9.0, 40.0, 1e4})
            for (const double slant : {0.0, 0.3})
                for (const double x : {20.3, -2.1, 55.0, 400.0, -3e4, kInfinity, double(kNan)})
                    for (const double y : {15.2, 31.7, -90.0}) {
                        SCOPED_TRACE(::testing::Message() << static_cast<int>(wrap) << " step " << step
                                                          << " slant " << slant << " at " << x << ", " << y);
                        const Jacobian jacobian{step, slant * step, -slant * step, step};
                        const Footprint footprint = chooser(jacobian);
                        float found = -7;
                        ASSERT_TRUE(sampler.sample(footprint, jacobian, 0, x, y, &found));
                        const TapOffsets offset(footprint, jacobian, {1, 1});
                        double sum = 0;
                        for (int j = 0; j < footprint.taps_b; ++j)
                            for (int i = 0; i < footprint.taps_a; ++i) {
                                const Point<double> tap = offset(i, j);
                                sum += double(picture.sample(Filter::bilinear, x + tap.x, y + tap.y)[0]);
                            }
                        ASSERT_EQ(found, static_cast<float>(sum / (footprint.taps_a * footprint.taps_b)));
                        beside += found == 0;
                        over += found != 0;
                    }
        EXPECT_GT(over, 20);
        if (wrap == Wrap::automatic || wrap == Wrap::black) {
            EXPECT_GT(beside, 40);
        }
        float pixel = -7;
        for (const double bad : {kInfinity, double(kNan)})
            EXPECT_TRUE(sampler.sample(Filter::antialias, chooser, {bad, 0, 0, 1}, 0, 5, 5, &pixel));
    }
}

TEST(PointSampler, UnassociatedAlphaWeighsColour) {
    Picture picture(flat(), 2, PixelType::float32, Wrap::automatic, 1);
    // Bright colour under zero alpha must not bleed.
    picture.fill(
        [](double x, double, int c) { return x < 20 ? (c == 0 ? 0.25 : 1.0) : (c == 0 ? 1000.0 : 0.0); });
    std::vector<float> pixel = picture.sample(Filter::bilinear, 20.0, 10.0);
    EXPECT_FLOAT_EQ(pixel[0], 0.125f);
    EXPECT_FLOAT_EQ(pixel[1], 0.5f);
    unassociate_alpha(pixel.data(), 2, 1);
    EXPECT_FLOAT_EQ(pixel[0], 0.25f);
}

TEST(PointSampler, HasNoSeamAcrossAPanorama) {
    const Chart chart(Projection::equirectangular, 64, 32);
    Picture picture(chart, 1, PixelType::float32, Wrap::automatic);
    // A smooth function of direction, also over the poles.
    const auto value = [&](double x, double y) {
        const Ray<double> ray = chart.ray(x, y);
        return 1 + 0.5 * ray.x - 0.25 * ray.z + 0.125 * ray.y;
    };
    picture.fill([&](double x, double y, int) { return value(x, y); });
    for (double x = -3; x < 67; x += 0.37)
        for (double y = 0; y <= 32; y += 0.29) {
            ASSERT_NEAR(picture.sample(Filter::bicubic, x, y)[0], value(x, y), 2e-4) << x << ' ' << y;
            ASSERT_NEAR(picture.sample(Filter::bilinear, x, y)[0], value(x, y), 3e-3) << x << ' ' << y;
        }
}

TEST(PointSampler, AFootprintIsTheMeanOfItsTaps) {
    Picture picture(flat(), 2, PixelType::float32, Wrap::automatic);
    picture.fill([](double x, double y, int c) { return c == 0 ? 3 * x - y : x * x; });
    PointSampler sampler(picture.source, picture.border);
    float pixel[2], one[2];
    const Jacobian jacobian{3, 4, -4, 3};
    // The centre of symmetry keeps linear functions.
    ASSERT_TRUE(sampler.sample(Footprint{0, 3, 2, 1.5f, 1.0f}, jacobian, 0, 20.2, 15.3, pixel));
    EXPECT_NEAR(pixel[0], 3 * 20.2 - 15.3, 1e-4);
    double sum = 0;
    for (const double a : {-1.5, 0.0, 1.5})
        for (const double b : {-0.5, 0.5}) {
            ASSERT_TRUE(sampler.sample(Filter::bilinear, 0, 0, 20.2 + 0.6 * a - 0.8 * b,
                                       15.3 + 0.8 * a + 0.6 * b, one));
            sum += static_cast<double>(one[1]);
        }
    EXPECT_NEAR(pixel[1], sum / 6, 1e-3);
}

}  // namespace
}  // namespace anamorph::test_filter
