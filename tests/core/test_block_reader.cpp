// SPDX-License-Identifier: Apache-2.0
// Blocks of every kind read the texels that their points name, and no byte that is not the source's.
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <tuple>

#include "anamorph/image/block_reader.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/pyramid.h"
#include "draw_map.h"
#include "function_map.h"
#include "guarded_memory.h"
#include "remote_source.h"

namespace anamorph::test_block_reader {
namespace {

using test::FunctionMap;
using Kind = Block::Kind;

/// Packed float pixels.
struct Picture {
    int width, height, channels;
    std::vector<float> values;

    Picture(int w, int h, int c)
        : width(w),
          height(h),
          channels(c),
          values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * static_cast<std::size_t>(c)) {}
    ImageView view() {
        return packed_view(reinterpret_cast<std::byte*>(values.data()), PixelType::float32, width, height,
                           channels);
    }
    ConstImageView read() const {
        return packed_view(reinterpret_cast<const std::byte*>(values.data()), PixelType::float32, width,
                           height, channels);
    }
    float& at(int x, int y, int c = 0) {
        return values[static_cast<std::size_t>((y * width + x) * channels + c)];
    }
};

Border border_of(const Source& source, Wrap wrap) {
    const Size size = source.size(0);
    return Border(Chart(Projection::rectilinear, size.width, size.height, 90), wrap);
}

Picture draw(const BlockMap& map, const Source& source, Filter filter, Wrap wrap = Wrap::clamp) {
    Picture picture(map.width(), map.height(), source.channels());
    EXPECT_TRUE(test::draw_map(map, border_of(source, wrap), filter, Output::color, &source,
                               {0, 0, map.width(), map.height()}, picture.view(), serial_for));
    return picture;
}

/// Every texel another value.
Picture numbered(int width, int height) {
    Picture picture(width, height, 1);
    for (std::size_t i = 0; i < picture.values.size(); ++i) picture.values[i] = static_cast<float>(i + 1);
    return picture;
}

TEST(BlockReader, NearestTakesTheTexelUnderAnExactPoint) {
    Picture texels = numbered(160, 110);
    const MemorySource source(texels.read());
    // How far below (or above) whole numbers the points lie.
    for (const double below : {0x1p-24, 0x1p-25, 0x1p-26, 1e-9, 1e-12, 1e-18, 0.0, -1e-12, -1e-9, -0x1p-25}) {
        SCOPED_TRACE(below);
        const auto at = [&](double x, double y) {
            return Point<double>{std::floor(x) + 5 - below, std::floor(y) + 4 - below};
        };
        const FunctionMap map(150, 100, Kind::exact, at);
        Picture picture = draw(map, source, Filter::nearest);
        int wrong = 0;
        for (int y = 0; y < 100; ++y)
            for (int x = 0; x < 150; ++x) {
                const Point<double> p = at(x + 0.5, y + 0.5);
                wrong += picture.at(x, y) !=
                         texels.at(static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)));
            }
        EXPECT_EQ(wrong, 0);
        EXPECT_EQ(picture.values, draw(map, source, Filter::nearest).values);
    }
}

TEST(BlockReader, ReadsNoByteThatIsNotTheSources) {
    // 128 columns of which the first ones are read, so that texels are read where they stand.
    constexpr int kWidth = 128, kHeight = 32;
    const test::GuardedMemory memory(kWidth * kHeight * sizeof(float));
    auto* texels = reinterpret_cast<float*>(memory.last(kWidth * kHeight * sizeof(float)));
    std::fill_n(texels, kWidth * kHeight, 1.0f);
    const MemorySource source(
        packed_view(reinterpret_cast<const std::byte*>(texels), PixelType::float32, kWidth, kHeight, 1));
    for (const Kind kind : {Kind::exact, Kind::polynomial, Kind::computed})
        for (const double below : {1e-9, 1e-6, 1e-3, 0.4999, 0.5, 0.9999999}) {
            // The last row of points lies just above the lower edge, or as far from it as the filter reaches.
            for (const Filter filter :
                 {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic}) {
                const double reach = filter == Filter::nearest ? 0 : filter == Filter::bilinear ? 0.5 : 1.5;
                const FunctionMap map(64, 28, kind, [&](double x, double y) {
                    return Point<double>{x + 8, y + 4.5 - reach - below};
                });
                Picture picture = draw(map, source, filter);
                for (const float v : picture.values) ASSERT_NEAR(v, 1, 1e-6);
                const FunctionMap up(64, 28, kind, [&](double x, double y) {
                    return Point<double>{x + 8, y - 0.5 + reach + below};
                });
                picture = draw(up, source, filter);
                for (const float v : picture.values) ASSERT_NEAR(v, 1, 1e-6);
            }
        }
}

TEST(BlockReader, RowsMayStandAnyNumberOfBytesApart) {
    // 130 columns of which the last ones are not read, so that texels could be read where they stand.
    constexpr int kWidth = 130, kHeight = 40, kGap = 3;
    std::vector<std::byte> packed(kWidth * kHeight * 2), apart((kWidth * 2 + kGap) * kHeight);
    for (std::size_t i = 0; i < packed.size(); ++i) packed[i] = static_cast<std::byte>(i * 7919 >> 3);
    ConstImageView view =
        packed_view(static_cast<const std::byte*>(packed.data()), PixelType::uint16, kWidth, kHeight, 1);
    const MemorySource source(view);
    for (int y = 0; y < kHeight; ++y)
        std::memcpy(&apart[static_cast<std::size_t>(y * (kWidth * 2 + kGap))], view.at(0, y), kWidth * 2);
    view.data = apart.data();
    view.row_stride += kGap;
    const MemorySource other(view);
    for (const Kind kind : {Kind::exact, Kind::polynomial, Kind::computed}) {
        const FunctionMap map(64, 30, kind, [](double x, double y) {
            return Point<double>{x + 3.3, y + 4.4};
        });
        EXPECT_EQ(draw(map, source, Filter::bilinear).values, draw(map, other, Filter::bilinear).values);
    }
}

TEST(BlockReader, RowsMayStandGigabytesApart) {
    constexpr int kWidth = 64, kHeight = 60;
    constexpr std::ptrdiff_t kStride = std::ptrdiff_t{1} << (sizeof(std::ptrdiff_t) == 8 ? 27 : 24);
    // Addresses alone: only the rows' own pages are touched.
    void* const memory = mmap(nullptr, kStride * kHeight, PROT_READ | PROT_WRITE,
                              MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    ASSERT_NE(memory, MAP_FAILED);
    Picture texels = numbered(kWidth, kHeight);
    for (float& v : texels.values) v = std::sin(v);
    ConstImageView view = texels.read();
    for (int y = 0; y < kHeight; ++y)
        std::memcpy(static_cast<std::byte*>(memory) + y * kStride, view.at(0, y), kWidth * sizeof(float));
    const MemorySource packed(view);
    view.data = static_cast<const std::byte*>(memory);
    view.row_stride = kStride;
    const MemorySource apart(view);
    for (const Kind kind : {Kind::exact, Kind::polynomial, Kind::computed})
        for (const Filter filter :
             {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic}) {
            const FunctionMap map(48, 40, kind, [](double x, double y) {
                return Point<double>{1.1 * x + 0.013 * y + 3.3, 1.07 * y + 0.1 * x + 4.4};
            });
            EXPECT_EQ(draw(map, packed, filter).values, draw(map, apart, filter).values);
        }
    munmap(memory, kStride * kHeight);
}

TEST(BlockReader, PointsThatAreNoneOrFarAwayHarmNoOthers) {
    Picture texels = numbered(90, 50);
    const MemorySource base(texels.read());
    const Pyramid source(base);
    const double far[] = {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e9, -1e9, 1e300, -1e300};
    for (const Kind kind : {Kind::exact, Kind::computed})
        for (const Filter filter :
             {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic, Filter::antialias})
            for (const double bad : far) {
                SCOPED_TRACE(::testing::Message() << "kind " << static_cast<int>(kind) << " filter "
                                                  << static_cast<int>(filter) << " at " << bad);
                const auto good = [](double x, double y) { return Point<double>{x + 8.25, y + 4.5}; };
                const FunctionMap map(64, 32, kind, [&](double x, double y) {
                    const bool off = std::floor(x) == 20 && std::floor(y) < 32 && std::floor(y) != 16;
                    Point<double> p = good(x, y);
                    if (off) (std::fmod(std::floor(y), 2) == 0 ? p.x : p.y) = bad;
                    return p;
                });
                Picture picture = draw(map, source, filter, Wrap::black);
                Picture alone = draw(FunctionMap(64, 32, kind, good), source, filter, Wrap::black);
                int wrong = 0, lit = 0;
                for (int y = 0; y < 32; ++y)
                    for (int x = 0; x < 64; ++x) {
                        const bool off = x == 20 && y != 16;
                        lit += off && picture.at(x, y) != 0;
                        // Next to it a footprint may be another; else only the order of sums is.
                        if (off || (filter == Filter::antialias && std::abs(x - 20) < 2)) continue;
                        wrong += !(std::fabs(picture.at(x, y) - alone.at(x, y)) <= 1e-6f * 4500);
                    }
                EXPECT_EQ(wrong, 0);
                EXPECT_EQ(lit, 0);
            }
}

TEST(BlockReader, PointsFarApartAreReadEachFromItsOwnTexels) {
    constexpr int kWidth = 2400, kHeight = 1300, kAcross = 100, kDown = 50;
    const unsigned seed = 5;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    // Some 600 texels a pixel, and points over every edge.
    const auto at = [](double x, double y) {
        return Point<double>{24.7 * x - 1.3 * y + 0.01 * x * y - 30, 25.9 * y + 2.1 * x - 60.3};
    };
    for (const int channels : {1, 3, 4, 5}) {
        Picture texels(kWidth, kHeight, channels);
        // Not transparent: colour is divided by alpha, of which bicubic weights may leave little.
        for (float& v : texels.values) v = 0.5f + static_cast<float>(random() % 4096) / 8192;
        for (const int alpha : {-1, channels - 1}) {
            const MemorySource source(texels.read(), alpha);
            for (const Kind kind : {Kind::exact, Kind::polynomial, Kind::computed})
                for (const Filter filter :
                     {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic})
                    for (const Wrap wrap : {Wrap::black, Wrap::mirror}) {
                        SCOPED_TRACE(::testing::Message()
                                     << channels << " channels, alpha " << alpha << ", kind "
                                     << static_cast<int>(kind) << ", filter " << static_cast<int>(filter)
                                     << ", wrap " << static_cast<int>(wrap));
                        const FunctionMap map(kAcross, kDown, kind, at);
                        const Picture picture = draw(map, source, filter, wrap);
                        EXPECT_EQ(picture.values, draw(map, test::Remote(source), filter, wrap).values);
                        // A crop, whose rows begin elsewhere.
                        const Box box{17, 9, 83, 40};
                        Picture crop(box.width(), box.height(), channels);
                        ASSERT_TRUE(test::draw_map(map, border_of(source, wrap), filter, Output::color,
                                                   &source, box, crop.view()));
                        const Border border = border_of(source, wrap);
                        PointSampler sampler(source, border);
                        std::vector<float> pixel(static_cast<std::size_t>(channels));
                        double worst = 0;
                        for (int y = box.y0; y < box.y1; ++y)
                            for (int x = box.x0; x < box.x1; ++x) {
                                const auto* drawn =
                                    &picture.values[static_cast<std::size_t>((y * kAcross + x) * channels)];
                                for (int c = 0; c < channels; ++c)
                                    ASSERT_EQ(drawn[c], crop.at(x - box.x0, y - box.y0, c));
                                // Polynomials and offsets in float may be off by more; nearest takes another texel then.
                                if (kind != Kind::exact) continue;
                                const Point<double> p = at(x + 0.5, y + 0.5);
                                ASSERT_TRUE(sampler.sample(filter, 0, 0, p.x, p.y, pixel.data()));
                                if (alpha >= 0) unassociate_alpha(pixel.data(), channels, alpha);
                                for (int c = 0; c < channels; ++c)
                                    worst = std::max(worst,
                                                     std::fabs(double{drawn[c]} -
                                                               double{pixel[static_cast<std::size_t>(c)]}));
                            }
                        EXPECT_LE(worst, alpha >= 0 ? 1e-4 : 2e-6);
                    }
        }
    }
}

void expect_read_around_the_sphere(PixelSpacing spacing) {
    constexpr int kWidth = 2400, kHeight = 1200, kAcross = 100, kDown = 50;
    const unsigned seed = 11;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Picture texels(kWidth, kHeight, 3);
    for (float& v : texels.values) v = static_cast<float>(random() % 4096) / 4096;
    const MemorySource source(texels.read());
    const Border border(Chart(Projection::equirectangular, kWidth, kHeight, 360, spacing), Wrap::automatic);
    // Over the seam, more than a turn away, over either pole, and from 20 to 600 texels a pixel.
    for (const auto& [step, x0, y0] : {std::tuple{22.7, -700.0, 30.0},
                                       {22.7, 1900.0, -90.4},
                                       {4.3, 2390.0, 1100.0},
                                       {24.6, -3800.0, 90.0},
                                       {9.1, 2300.0, -3.0}}) {
        const auto at = [step = step, x0 = x0, y0 = y0](double x, double y) {
            return Point<double>{step * x - 1.3 * y + x0, step * y + 0.4 * x + y0};
        };
        for (const Kind kind : {Kind::exact, Kind::computed})
            for (const Filter filter :
                 {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic}) {
                SCOPED_TRACE(::testing::Message()
                             << step << " texels a step from " << x0 << ", " << y0 << ", kind "
                             << static_cast<int>(kind) << ", filter " << static_cast<int>(filter));
                const FunctionMap map(kAcross, kDown, kind, at);
                const auto drawn = [&](const Source& from, const Box& box) {
                    Picture picture(box.width(), box.height(), 3);
                    EXPECT_TRUE(test::draw_map(map, border, filter, Output::color, &from, box, picture.view(),
                                               serial_for));
                    return picture;
                };
                Picture all = drawn(source, {0, 0, kAcross, kDown});
                EXPECT_EQ(all.values, drawn(test::Remote(source), {0, 0, kAcross, kDown}).values);
                const Box box{17, 9, 83, 40};
                Picture crop = drawn(source, box);
                PointSampler sampler(source, border);
                float pixel[3];
                double worst = 0;
                for (int y = box.y0; y < box.y1; ++y)
                    for (int x = box.x0; x < box.x1; ++x) {
                        const Point<double> p = at(x + 0.5, y + 0.5);
                        ASSERT_TRUE(sampler.sample(filter, 0, 0, p.x, p.y, pixel));
                        for (int c = 0; c < 3; ++c) {
                            ASSERT_EQ(all.at(x, y, c), crop.at(x - box.x0, y - box.y0, c));
                            if (kind == Kind::exact)
                                worst = std::max(worst, std::fabs(double{all.at(x, y, c)} - pixel[c]));
                        }
                    }
                EXPECT_LE(worst, 2e-6);
            }
    }
}

TEST(BlockReader, PointsApartAreReadAroundTheSphere) {
    expect_read_around_the_sphere(PixelSpacing::edges);
}
// The last texel of a row repeats the first.
TEST(BlockReader, PointsApartAreReadAroundASphereWithAnOverlap) {
    expect_read_around_the_sphere(PixelSpacing::centers);
}

TEST(BlockReader, PointsApartHaveTheSameBitsWhereverTheirTexelsStand) {
    constexpr int kWidth = 2400, kHeight = 1300, kAcross = 100, kDown = 50;
    const unsigned seed = 7;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    // Some 600 and 20 texels a pixel: on the source and, moved, over its edges.
    for (const auto& [step, aside] : {std::pair{22.7, 60.0}, {22.7, -60.3}, {4.3, 60.0}, {4.3, -60.3}})
        for (const PixelType type : {PixelType::uint8, PixelType::uint16, PixelType::half})
            for (const int channels : {1, 3, 4}) {
                const std::ptrdiff_t pixel = std::ptrdiff_t{channels} * size_of(type);
                std::vector<std::byte> texels(static_cast<std::size_t>(kWidth * kHeight * pixel));
                // Halves below 2: no exponent of theirs is that of infinity.
                for (std::byte& b : texels) b = static_cast<std::byte>(random() & 0x3f);
                const MemorySource source(
                    packed_view<const std::byte>(texels.data(), type, kWidth, kHeight, channels));
                const test::Remote remote(source);
                const auto at = [step = step, aside = aside](double x, double y) {
                    return Point<double>{step * x - 1.3 * y + aside, 1.05 * step * y + 0.4 * x + aside};
                };
                const auto drawn = [&](const FunctionMap& map, const Source& from, Filter filter,
                                       const Box& box) {
                    std::vector<std::byte> to(static_cast<std::size_t>(box.width() * box.height() * pixel));
                    EXPECT_TRUE(test::draw_map(
                        map, border_of(source, Wrap::mirror), filter, Output::color, &from, box,
                        packed_view(to.data(), type, box.width(), box.height(), channels), serial_for));
                    return to;
                };
                for (const Kind kind : {Kind::exact, Kind::computed})
                    for (const Filter filter :
                         {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic}) {
                        SCOPED_TRACE(::testing::Message()
                                     << step << " texels a step, " << aside << " aside, type "
                                     << static_cast<int>(type) << ", " << channels << " channels, kind "
                                     << static_cast<int>(kind) << ", filter " << static_cast<int>(filter));
                        const FunctionMap map(kAcross, kDown, kind, at);
                        const std::vector<std::byte> all = drawn(map, source, filter, {0, 0, kAcross, kDown});
                        EXPECT_TRUE(all == drawn(map, remote, filter, {0, 0, kAcross, kDown}));
                        // A crop, whose rows begin elsewhere and are narrower.
                        const Box box{17, 9, 83, 40};
                        const std::vector<std::byte> crop = drawn(map, source, filter, box);
                        for (int y = box.y0; y < box.y1; ++y)
                            ASSERT_EQ(std::memcmp(
                                          &crop[static_cast<std::size_t>((y - box.y0) * box.width() * pixel)],
                                          &all[static_cast<std::size_t>((y * kAcross + box.x0) * pixel)],
                                          static_cast<std::size_t>(box.width() * pixel)),
                                      0)
                                << y;
                    }
            }
}

TEST(BlockReader, PointsFarApartAreNoNumbersOnlyByTheirOwnTexels) {
    constexpr int kWidth = 2400, kHeight = 1300, kAcross = 100, kDown = 50;
    // On the source and over its edges.
    const auto at = [](double x, double y) {
        return Point<double>{24.7 * x - 1.3 * y - 30.4137, 25.9 * y + 0.1 * x - 20.3219};
    };
    const std::pair<Filter, int> filters[] = {
        {Filter::nearest, 1}, {Filter::bilinear, 2}, {Filter::bicubic, 4}, {Filter::sharp_bicubic, 4}};
    for (const auto& [filter, side] : filters) {
        SCOPED_TRACE(side);
        Picture texels(kWidth, kHeight, 3);
        std::fill(texels.values.begin(), texels.values.end(), NAN);
        const MemorySource source(texels.read());
        const Border border = border_of(source, Wrap::mirror);
        for (int y = 0; y < kDown; ++y)
            for (int x = 0; x < kAcross; ++x) {
                const Point<double> p = at(x + 0.5, y + 0.5);
                const auto first = [side = side](double v) {
                    return static_cast<int>(std::floor(v - 0.5 * (side - 1)));
                };
                for (int j = 0; j < side; ++j)
                    for (int i = 0; i < side; ++i) {
                        const Texel own = border.resolve(first(p.x) + i, first(p.y) + j, 0, source.size(0));
                        for (int c = 0; c < 3; ++c) texels.at(own.x, own.y, c) = 1;
                    }
            }
        const FunctionMap map(kAcross, kDown, Kind::exact, at);
        for (const float v : draw(map, source, filter, Wrap::mirror).values) ASSERT_NEAR(v, 1, 1e-6);
    }
}

TEST(BlockReader, PointsFarApartStayWithinTheirFloats) {
    // A slope in each direction: a value says where it was read.
    constexpr int kWidth = 3000, kHeight = 1500;
    Picture texels(kWidth, kHeight, 2);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            texels.at(x, y, 0) = static_cast<float>(x) / 4096;
            texels.at(x, y, 1) = static_cast<float>(y) / 4096;
        }
    const MemorySource source(texels.read());
    const auto at = [](double x, double y) {
        return Point<double>{25.3 * x + 7 * y + 30, 26.1 * y + 3 * x + 20};
    };
    for (const Kind kind : {Kind::exact, Kind::polynomial, Kind::computed})
        for (const Filter filter : {Filter::bilinear, Filter::bicubic}) {
            const Picture picture = draw(FunctionMap(100, 44, kind, at), source, filter);
            double worst = 0;
            for (int y = 0; y < 44; ++y)
                for (int x = 0; x < 100; ++x) {
                    const Point<double> p = at(x + 0.5, y + 0.5);
                    const auto* v = &picture.values[static_cast<std::size_t>((y * 100 + x) * 2)];
                    worst = std::max({worst, std::fabs(4096 * double{v[0]} + 0.5 - p.x),
                                      std::fabs(4096 * double{v[1]} + 0.5 - p.y)});
                }
            // Offsets of up to 2000 texels, and values of up to 1 in sums, in float: 2.4e-4 texels each.
            EXPECT_LE(worst, 1e-3);
        }
}

/// How far an antialiased picture of stripes, `wave` source pixels wide, is from the average of 16 x 16
/// points a pixel.
struct Off {
    double worst = 0, mean_square = 0;
};
template <class Ignore>
Off off_stripes(int width, int height, double wave, const FunctionMap& map, const Ignore& ignore) {
    const auto stripes = [&](double x) { return 0.5 + 0.5 * std::cos(2 * std::numbers::pi / wave * x); };
    Picture texels(width, height, 1);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) texels.at(x, y) = static_cast<float>(stripes(x + 0.5));
    const MemorySource base(texels.read());
    Picture picture = draw(map, Pyramid(base), Filter::antialias, Wrap::periodic);
    Off off;
    int count = 0;
    for (int y = 0; y < map.height(); ++y)
        for (int x = 0; x < map.width(); ++x) {
            if (ignore(x + 0.5, y + 0.5)) continue;
            double mean = 0;
            for (int k = 0; k < 256; ++k) {
                Point<double> p{};
                int piece = 0;
                map.exact(x + (k % 16 + 0.5) / 16, y + (k / 16 + 0.5) / 16, 0, p, piece);
                mean += stripes(p.x) / 256;
            }
            const double error = std::fabs(double{picture.at(x, y)} - mean);
            off.worst = std::max(off.worst, error);
            off.mean_square += error * error;
            ++count;
        }
    off.mean_square /= count;
    return off;
}

TEST(BlockReader, FootprintsFollowTheMapAroundAPole) {
    // A pixel at a distance r from the pole is 1 / r of a turn wide; one footprint for a block of them is far
    // too wide for most.
    constexpr int kWidth = 4096, kHeight = 256;
    const auto from_pole = [](double x, double y) { return Point<double>{x - 20.3, y - 33.1}; };
    const auto at = [&](double x, double y) {
        const Point<double> p = from_pole(x, y);
        return Point<double>{kWidth * (0.5 + std::atan2(p.y, p.x) / (2 * std::numbers::pi)),
                             2 * std::hypot(p.x, p.y) + 40};
    };
    for (const Kind kind : {Kind::exact, Kind::computed}) {
        SCOPED_TRACE(static_cast<int>(kind));
        const Off off = off_stripes(kWidth, kHeight, kWidth / 6.0, FunctionMap(64, 64, kind, at),
                                    [&](double x, double y) {
                                        const Point<double> p = from_pole(x, y);
                                        return std::hypot(p.x, p.y) < 3;
                                    });
        // The filter is no box, and footprints are shared: one for every block was off by .066 and .0043.
        EXPECT_LT(off.worst, 0.05);
        EXPECT_LT(std::sqrt(off.mean_square), 0.002);
    }
}

TEST(BlockReader, FootprintsFollowTheMapWithinLargePolynomials) {
    // From .4 to 19.6 source pixels a pixel within a block.
    const auto at = [](double x, double y) {
        return Point<double>{10 * x + 0.15 * (x - 32) * (x - 32) + 300, y + 100};
    };
    for (const Kind kind : {Kind::exact, Kind::computed, Kind::polynomial}) {
        SCOPED_TRACE(static_cast<int>(kind));
        const Off off =
            off_stripes(1200, 256, 24, FunctionMap(64, 32, kind, at), [](double, double) { return false; });
        EXPECT_LT(off.worst, 0.13);
        EXPECT_LT(std::sqrt(off.mean_square), 0.045);
    }
}

TEST(BlockPoints, RoundNoMoreThanTheirTermsMay) {
    std::mt19937 random(31);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        SCOPED_TRACE(*set);
        ASSERT_TRUE(simd::use_instruction_set(*set));
        double worst = 0;
        for (int trial = 0; trial < 2000; ++trial) {
            const int degree = 2 + trial % 2, width = 1 + static_cast<int>(random() % 64),
                      height = 1 + static_cast<int>(random() % 64),
                      row = static_cast<int>(random() % static_cast<unsigned>(height));
            float c[4][8] = {};
            double allowed[2] = {};
            for (int j = 0; j <= degree; ++j)
                for (int k = 0; k < 8; ++k) {
                    const int i = k % 4;
                    if (i > degree) continue;
                    c[j][k] = static_cast<float>(unit(random) * std::pow(10, 3 * unit(random)));
                    allowed[k / 4] += std::fabs(double{c[j][k]}) * term_rounding(i + j);
                }
            float x[simd::kRowRoom], y[simd::kRowRoom];
            simd::block_points({c, degree, width, height}, row, 0, width, x, y);
            const long double t = height > 1 ? 2.0L * row / (height - 1) - 1 : 0;
            for (int i = 0; i < width; ++i) {
                const long double s = width > 1 ? 2.0L * i / (width - 1) - 1 : 0;
                for (int k = 0; k < 2; ++k) {
                    long double sum = 0;
                    for (int b = 0; b <= degree; ++b)
                        for (int a = 0; a <= degree; ++a)
                            sum += c[b][4 * k + a] * std::pow(s, a) * std::pow(t, b);
                    const long double off = std::fabs((k ? y : x)[i] - sum);
                    worst = std::max(worst, static_cast<double>(off / allowed[k]));
                }
            }
        }
        EXPECT_LE(worst, 1);
        EXPECT_GT(worst, 0.05);
    }
    simd::use_instruction_set("");
}

/// Levels of a size that no power of two divides, so that coordinates are rounded anew on each; texels are 0
/// and 1 by turns, so that a value tells where between two of them it was read: channel 0 across, 1 down.
class Parity final : public Source {
  public:
    PixelType type() const noexcept override { return PixelType::float32; }
    int channels() const noexcept override { return 2; }
    int levels() const noexcept override { return 3; }
    Size size(int level) const noexcept override {
        return level == 0 ? Size{40009, 40013} : level == 1 ? Size{10007, 10009} : Size{2503, 2511};
    }
    bool read(int, const Box& box, std::byte* texels, std::ptrdiff_t row_stride) const noexcept override {
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x) {
                const float pixel[2] = {static_cast<float>(x & 1), static_cast<float>(y & 1)};
                std::memcpy(texels + (y - box.y0) * row_stride +
                                (x - box.x0) * static_cast<std::ptrdiff_t>(sizeof pixel),
                            pixel, sizeof pixel);
            }
        return true;
    }
};

/// What a bilinear filter reads of texels 0, 1, 0, 1, ... at a place.
long double parity_at(long double at) {
    const long double below = std::floor(at - 0.5L), rest = at - 0.5L - below;
    return std::fmod(below, 2.0L) == 0 ? rest : 1 - rest;
}

TEST(BlockReader, StaysWithinTheBoundOnEveryLevel) {
    const Parity source;
    for (const char* const* set = simd::instruction_sets(); *set; ++set)
        // Minified so that one tap on a level stands for the footprint.
        for (const int level : {0, 1, 2}) {
            ASSERT_TRUE(simd::use_instruction_set(*set));
            const long double scale_x =
                                  static_cast<long double>(source.size(level).width) / source.size(0).width,
                              scale_y =
                                  static_cast<long double>(source.size(level).height) / source.size(0).height;
            const double step = level == 0 ? 0.93 : level == 1 ? 4.6 : 18.4;
            const auto at = [&](double x, double y) {
                return Point<double>{31234.377 + step * x + 0.0007 * step * x * x - 0.0004 * step * x * y,
                                     17.6180339 + step * y - 0.0005 * step * x * y};
            };
            for (const Kind kind : {Kind::exact, Kind::polynomial, Kind::computed}) {
                SCOPED_TRACE(::testing::Message()
                             << *set << " level " << level << " kind " << static_cast<int>(kind));
                const FunctionMap map(64, 32, kind, at);
                Picture picture = draw(map, source, Filter::antialias);
                const SharedBlocks blocks = map.blocks(0);
                const Block& block = *blocks.begin();
                // Offsets of a computed block, which the map rounds, and the sampler; and the value's
                // rounding.
                const double bound =
                    kind == Kind::computed ? block.bound + 2 * 0x1p-24 * 64 * step * 2 : block.bound;
                double worst = 0;
                for (int y = 0; y < 32; ++y)
                    for (int x = 0; x < 64; ++x) {
                        const Point<double> p = at(x + 0.5, y + 0.5);
                        const long double u = parity_at(p.x * scale_x), v = parity_at(p.y * scale_y);
                        const long double off = std::hypot(picture.at(x, y, 0) - u, picture.at(x, y, 1) - v);
                        const long double allowed = bound * std::max(scale_x, scale_y) +
                                                    std::numbers::sqrt2 * (kLevelRounding + 2 * 0x1p-24);
                        worst = std::max(worst, static_cast<double>(off / allowed));
                    }
                EXPECT_LE(worst, 1);
            }
        }
    simd::use_instruction_set("");
}

}  // namespace
}  // namespace anamorph::test_block_reader
