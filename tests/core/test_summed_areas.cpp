// SPDX-License-Identifier: Apache-2.0
// Means over rectangles from a table of sums, against means of all texels one by one in long double; and drapes that read
// with them.
#include "anamorph/image/summed_areas.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <thread>
#include <vector>

#include "anamorph/image/pixel.h"
#include "anamorph/image/pyramid.h"
#include "drape_scene.h"

namespace anamorph::test_summed_areas {
using namespace surface;
namespace {

using test::Scene;
using test::Shown;

/// A picture in memory.
struct Texels {
    Size size;
    int channels;
    PixelType type;
    std::vector<std::byte> bytes;

    Texels(const Size& s, int c, PixelType t)
        : size(s),
          channels(c),
          type(t),
          bytes(static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height) *
                static_cast<std::size_t>(c * size_of(t))) {}
    std::byte* at(int x, int y, int c) {
        return bytes.data() + ((std::ptrdiff_t{y} * size.width + x) * channels + c) * size_of(type);
    }
    template <class Value>
    void fill(const Value& value) {
        for (int y = 0; y < size.height; ++y)
            for (int x = 0; x < size.width; ++x)
                for (int c = 0; c < channels; ++c)
                    store_channel(static_cast<float>(value(x, y, c)), at(x, y, c), type);
    }
    MemorySource source(int alpha = -1) const {
        return MemorySource(
            packed_view<const std::byte>(bytes.data(), type, size.width, size.height, channels), alpha);
    }
};

/// Where texel i of an endless row stands; -1: nowhere.
int place_of(long i, int size, Wrap wrap) {
    if (i >= 0 && i < size) return static_cast<int>(i);
    const long n = size;
    if (wrap == Wrap::clamp) return i < 0 ? 0 : size - 1;
    if (wrap == Wrap::periodic) return static_cast<int>((i % n + n) % n);
    if (wrap == Wrap::mirror) {
        const long r = (i % (2 * n) + 2 * n) % (2 * n);
        return static_cast<int>(r < n ? r : 2 * n - 1 - r);
    }
    return -1;
}

/// Mean of a channel over a rectangle, texel by texel.
long double mean_of(Texels& texels, int alpha, double x, double y, double w, double h, Wrap wrap, int c) {
    const auto share = [](long i, double from, double to) {
        return std::max(0.0L, std::min<long double>(to, i + 1.0L) - std::max<long double>(from, i));
    };
    const double x0 = x - w / 2, x1 = x + w / 2, y0 = y - h / 2, y1 = y + h / 2;
    long double sum = 0;
    for (long j = std::lround(std::floor(y0)); j < y1; ++j)
        for (long i = std::lround(std::floor(x0)); i < x1; ++i) {
            const int px = place_of(i, texels.size.width, wrap), py = place_of(j, texels.size.height, wrap);
            if (px < 0 || py < 0) continue;
            const auto value = [&](int k) {
                const std::byte* at = texels.at(px, py, k);
                if (texels.type == PixelType::uint8) return std::to_integer<int>(*at) / 255.0L;
                return static_cast<long double>(load_channel(at, texels.type));
            };
            sum += share(i, x0, x1) * share(j, y0, y1) * value(c) *
                   (alpha >= 0 && c != alpha ? value(alpha) : 1);
        }
    return sum / (static_cast<long double>(w) * h);
}

/// Rectangles of all sizes about points in and around a picture.
void expect_means(Texels& texels, int alpha, unsigned seed, int count, double relative) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0, 1);
    const MemorySource source = texels.source(alpha);
    const SummedAreas sums(source);
    std::vector<float> pixel(static_cast<std::size_t>(texels.channels));
    for (int n = 0; n < count; ++n)
        for (const Wrap wrap : {Wrap::black, Wrap::clamp, Wrap::periodic, Wrap::mirror}) {
            const double x = texels.size.width * (1.6 * uniform(random) - 0.3),
                         y = texels.size.height * (1.6 * uniform(random) - 0.3),
                         w = std::exp(uniform(random) * std::log(2.5 * texels.size.width + 1)),
                         h = std::exp(uniform(random) * std::log(2.5 * texels.size.height + 1));
            sums.mean(x, y, w, h, wrap, pixel.data());
            for (int c = 0; c < texels.channels; ++c) {
                const long double truth = mean_of(texels, alpha, x, y, w, h, wrap, c);
                EXPECT_NEAR(pixel[static_cast<std::size_t>(c)], static_cast<double>(truth), relative)
                    << x << "," << y << " " << w << "x" << h << " wrap " << static_cast<int>(wrap);
            }
        }
}

TEST(SummedAreas, MeansAreThoseOfAllTexels) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const Size& size : {Size{1, 1}, Size{2, 3}, Size{37, 23}, Size{1, 3000}, Size{200, 2}})
        for (const PixelType type :
             {PixelType::uint8, PixelType::uint16, PixelType::half, PixelType::float32}) {
            Texels texels(size, 2, type);
            texels.fill([&](int, int, int) { return uniform(random); });
            const int count = size.height > 1000 ? 10 : 40;
            // What a float holds, and a unit of 2^-60 of the sum.
            expect_means(texels, -1, 2, count, 6e-8);
            expect_means(texels, 1, 3, count, 6e-8);
        }
}

/// The texel that stands at (x, y) of a picture all around, any distance beyond the poles.
Point<int> texel_over_poles(int x, int y, const Size& size) {
    const auto modulo = [](int a, int b) { return (a % b + b) % b; };
    y = modulo(y, 2 * size.height);
    if (y < size.height) return {modulo(x, size.width), y};
    return {modulo(x + size.width / 2, size.width), 2 * size.height - 1 - y};
}

TEST(SummedAreas, PicturesAllAroundGoOnOverTheirPoles) {
    constexpr unsigned kSeed = 5;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    const auto uniform = [&](double from, double to) {
        return std::uniform_real_distribution<double>(from, to)(random);
    };
    const Size size{12, 7};
    std::vector<float> texels(static_cast<std::size_t>(size.width) * 7);
    for (float& t : texels) t = static_cast<float>(uniform(0, 1));
    const MemorySource source(packed_view(reinterpret_cast<const std::byte*>(texels.data()),
                                          PixelType::float32, size.width, size.height, 1));
    const SummedAreas sums(source);
    for (int k = 0; k < 2000; ++k) {
        const double x = uniform(-30, 30), y = uniform(-20, 20), w = uniform(1, size.width),
                     h = uniform(1, size.height);
        const auto covered = [](int at, double middle, double side) {
            return std::max(0.0,
                            std::min(at + 1.0, middle + side / 2) - std::max(double(at), middle - side / 2));
        };
        double truth = 0;
        for (int j = -40; j < 40; ++j)
            for (int i = -50; i < 50; ++i) {
                const Point<int> texel = texel_over_poles(i, j, size);
                truth += covered(i, x, w) * covered(j, y, h) *
                         double{texels[static_cast<std::size_t>(texel.y * size.width + texel.x)]};
            }
        float mean = 0;
        sums.mean_over_poles(x, y, w, h, &mean);
        ASSERT_NEAR(mean, truth / (w * h), 1e-6) << x << "," << y << " " << w << "x" << h;
    }
    for (const double far : {1e300, -1e15, HUGE_VAL, -HUGE_VAL, std::nan("")})
        for (const double side : {0.0, 1e300, HUGE_VAL, std::nan("")}) {
            float mean = -1;
            sums.mean_over_poles(far, 1, side, 1, &mean);
            EXPECT_TRUE(mean >= 0 && mean <= 1) << far << " " << side;
            sums.mean_over_poles(1, far, 1, side, &mean);
            EXPECT_TRUE(mean >= 0 && mean <= 1) << far << " " << side;
        }
}

TEST(SummedAreas, ManyTexelsInFrontCostNoAccuracy) {
    // 2^23 white texels, and behind them small differences, which sums in float or of 32 bits would lose.
    Texels texels({4096, 2048}, 1, PixelType::float32);
    const auto value = [](int x, int y) {
        return x < 4000 || y < 2000 ? 1.0 : 1e-3 * (1 + (x * 31 + y * 17) % 97);
    };
    texels.fill([&](int x, int y, int) { return value(x, y); });
    const MemorySource source = texels.source();
    const SummedAreas sums(source);
    float mean = 0;
    for (const int side : {1, 2, 5, 20}) {
        const int x = 4050, y = 2024;
        double truth = 0;
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i) truth += double{static_cast<float>(value(x + i, y + j))};
        sums.mean(x + side / 2.0, y + side / 2.0, side, side, Wrap::clamp, &mean);
        EXPECT_NEAR(mean * side * side / truth, 1, 1e-7) << side;
    }
}

TEST(SummedAreas, AStripOfAnyLengthIsRead) {
    Texels texels({1, 30000}, 1, PixelType::uint8);
    texels.fill([](int, int y, int) { return (y % 7) / 6.0; });
    expect_means(texels, -1, 5, 3, 6e-8);
    const MemorySource source = texels.source();
    float mean = 0;
    SummedAreas(source).mean(0.5, 29999.5, 1, 1, Wrap::clamp, &mean);
    EXPECT_EQ(mean, load_channel(texels.at(0, 29999, 0), PixelType::uint8));
}

/// A source that counts what is read, or cannot be read.
class CountedTexels final : public Source {
  public:
    CountedTexels(const Source& base, bool fails) : m_base(base), m_fails(fails) {}
    PixelType type() const noexcept override { return m_base.type(); }
    int channels() const noexcept override { return m_base.channels(); }
    int unassociated_alpha() const noexcept override { return m_base.unassociated_alpha(); }
    int levels() const noexcept override { return 1; }
    Size size(int level) const noexcept override { return m_base.size(level); }
    bool read(int level, const Box& box, std::byte* texels, std::ptrdiff_t stride) const noexcept override {
        pixels += std::int64_t{box.width()} * box.height();
        return !m_fails && m_base.read(level, box, texels, stride);
    }
    mutable std::int64_t pixels = 0;

  private:
    const Source& m_base;
    bool m_fails;
};

TEST(SummedAreas, OnlyTilesThatAreAskedForAreRead) {
    Texels texels({4096, 4096}, 3, PixelType::uint8);
    texels.fill([](int x, int y, int c) { return (x * 31 + y * 17 + c * 5) % 256 / 255.0; });
    const MemorySource memory = texels.source();
    const CountedTexels source(memory, false);
    const SummedAreas sums(source);
    EXPECT_EQ(source.pixels, 0);
    float pixel[3];
    ASSERT_TRUE(sums.mean(1000, 2000, 100, 90, Wrap::clamp, pixel));
    EXPECT_LE(source.pixels, 4 * SummedAreas::kTile * SummedAreas::kTile);
    // All of it in order, as a small picture of it reads it: a third as many bytes as a table of it had are the most.
    std::vector<float> first;
    std::size_t most = 0;
    for (int y = 80; y < 4096; y += 160)
        for (int x = 80; x < 4096; x += 160) {
            ASSERT_TRUE(sums.mean(x, y, 170, 170, Wrap::clamp, pixel));
            first.insert(first.end(), pixel, pixel + 3);
            most = std::max(most, sums.bytes());
        }
    EXPECT_LE(most, SummedAreas::kMostBytes + (std::size_t{1} << 20));
    EXPECT_GT(most, std::size_t{1} << 24);
    // Each tile was made about once.
    EXPECT_LE(source.pixels, std::int64_t{4096} * 4096 * 5 / 4);
    // In another order, with tables that were forgotten in between: the same bits.
    std::size_t k = first.size();
    for (int row = 25; row >= 0; --row)
        for (int column = 25; column >= 0; --column) {
            if (80 + row * 160 >= 4096 || 80 + column * 160 >= 4096) continue;
            ASSERT_TRUE(sums.mean(80 + column * 160, 80 + row * 160, 170, 170, Wrap::clamp, pixel));
            k -= 3;
            for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(pixel[c], first[k + c]);
        }
    // What cannot be read says so.
    const CountedTexels broken(memory, true);
    pixel[0] = 7;
    EXPECT_FALSE(SummedAreas(broken).mean(5, 5, 2, 2, Wrap::clamp, pixel));
    EXPECT_EQ(pixel[0], 0);
    EXPECT_FALSE(SummedAreas(broken).mean_over_poles(5, 5, 2, 2, pixel));
}

/// A source with levels of its own, each the mean of 2 x 2 texels of the one before, that counts what is read of each.
class LeveledTexels final : public Source {
  public:
    explicit LeveledTexels(const Texels& base) {
        m_levels.push_back(base);
        while (m_levels.back().size.width > 8) {
            Texels& fine = m_levels.back();
            Texels coarse({fine.size.width / 2, fine.size.height / 2}, 1, PixelType::float32);
            coarse.fill([&](int x, int y, int) {
                double sum = 0;
                for (const int i : {0, 1})
                    for (const int j : {0, 1})
                        sum += double{load_channel(fine.at(2 * x + i, 2 * y + j, 0), PixelType::float32)};
                return sum / 4;
            });
            m_levels.push_back(coarse);
        }
        pixels.resize(m_levels.size());
        for (int level = 0; level < levels(); ++level)
            m_sums.push_back(std::make_unique<const SummedAreas>(*this, level));
    }
    PixelType type() const noexcept override { return PixelType::float32; }
    int channels() const noexcept override { return 1; }
    int unassociated_alpha() const noexcept override { return -1; }
    int levels() const noexcept override { return static_cast<int>(m_levels.size()); }
    Size size(int level) const noexcept override { return m_levels[static_cast<std::size_t>(level)].size; }
    bool read(int level, const Box& box, std::byte* texels, std::ptrdiff_t stride) const noexcept override {
        pixels[static_cast<std::size_t>(level)] += std::int64_t{box.width()} * box.height();
        return m_levels[static_cast<std::size_t>(level)].source().read(0, box, texels, stride);
    }
    const SummedAreas* summed_areas(int level) const noexcept override {
        return m_sums[static_cast<std::size_t>(level)].get();
    }
    mutable std::vector<std::int64_t> pixels;

  private:
    std::vector<Texels> m_levels;
    std::vector<std::unique_ptr<const SummedAreas>> m_sums;
};

TEST(SummedAreas, LargeRectanglesReadTheLevelThatIsEnoughWithinItsBound) {
    Texels texels({1024, 512}, 1, PixelType::float32);
    std::mt19937 random(4711);
    std::uniform_real_distribution<double> share(0, 1);
    // Of one checkered half, where the edge of a rectangle is as wrong as it can be, and one of noise.
    texels.fill([&](int x, int y, int) { return x < 512 ? (x / 4 + y / 4) % 2 : share(random); });
    const LeveledTexels source(texels);
    SummedLevels sums(source);
    double worst = 0;
    for (int k = 0; k < 300; ++k) {
        const double w = 130 + 200 * share(random), h = 130 + 150 * share(random),
                     x = w / 2 + (1024 - w) * share(random), y = h / 2 + (512 - h) * share(random);
        float mean = -1;
        ASSERT_TRUE(sums.mean(x, y, w, h, Wrap::clamp, &mean));
        long double sum = 0;
        const auto cover = [](int i, double from, double to) {
            return std::max(0.0, std::min(to, i + 1.0) - std::max(from, double(i)));
        };
        for (int j = 0; j < 512; ++j)
            if (const double down = cover(j, y - h / 2, y + h / 2); down > 0)
                for (int i = 0; i < 1024; ++i)
                    sum += static_cast<long double>(cover(i, x - w / 2, x + w / 2) * down *
                                                    double{load_channel(texels.at(i, j, 0), texels.type)});
        const double error = std::fabs(static_cast<double>(sum / (w * h)) - double{mean});
        // Of the level whose texels are 4 of the base.
        ASSERT_LE(error, (4 / w + 4 / h) / 2 + 1e-6) << "seed 4711, rectangle " << k;
        worst = std::max(worst, error);
    }
    EXPECT_GT(worst, 1e-5);
    EXPECT_EQ(source.pixels[0], 0);
    EXPECT_EQ(source.pixels[1], 0);
    EXPECT_GT(source.pixels[2], 0);
    // Thin ones need all texels, however long they are.
    float mean = 0;
    ASSERT_TRUE(sums.mean(500, 200, 400, 20, Wrap::clamp, &mean));
    EXPECT_GT(source.pixels[0], 0);
    ASSERT_TRUE(sums.mean_over_poles(500, 20, 300, 300, &mean));
    EXPECT_GT(source.pixels[3], 0);
}

TEST(SummedAreas, LevelsOfOddSizesHoldTheBoundToo) {
    Texels texels({1021, 397}, 1, PixelType::float32);
    texels.fill([](int x, int y, int) { return x % 90 < 45 ? y / 397.0 : 1 - x / 1021.0; });
    const MemorySource memory = texels.source();
    const Pyramid pyramid(memory);
    SummedLevels sums(pyramid);
    const SummedAreas all(memory);
    std::mt19937 random(31);
    std::uniform_real_distribution<double> share(0, 1);
    for (int k = 0; k < 200; ++k) {
        const double w = 70 + 500 * share(random), h = 70 + 250 * share(random), x = 1021 * share(random),
                     y = 397 * share(random);
        const double level = std::floor(std::log2(std::min(w * 510 / 1021, h * 198 / 397) / 32)) + 1;
        const double texel = std::exp2(std::max(level, 0.0));
        for (const Wrap wrap : {Wrap::black, Wrap::clamp, Wrap::mirror}) {
            float mean = -1, exact = -1;
            ASSERT_TRUE(sums.mean(x, y, w, h, wrap, &mean) && all.mean(x, y, w, h, wrap, &exact));
            ASSERT_LE(std::fabs(mean - exact), (texel / w + texel / h) / 2 * 1.02) << "seed 31, " << k;
        }
    }
}

// Across and down, levels of odd sizes have scales of their own. The mean of a slope is what it has in the middle.
TEST(SummedAreas, LevelsOfASlopeHaveItsMiddle) {
    Texels texels({1021, 71}, 1, PixelType::float32);
    texels.fill([](int x, int y, int) { return (x + 0.5) / 1021 + (y + 0.5) / 71; });
    const MemorySource memory = texels.source();
    const Pyramid pyramid(memory);
    ASSERT_EQ(pyramid.size(1).height, 35);
    SummedLevels sums(pyramid);
    for (const double y : {34.0, 35.5, 37.0})
        for (const double x : {100.0, 507.3, 950.0}) {
            float mean = -1;
            ASSERT_TRUE(sums.mean(x, y, 66, 66, Wrap::clamp, &mean));
            EXPECT_NEAR(mean, x / 1021 + y / 71, 5e-4);
        }
}

TEST(SummedAreas, RectanglesOverTilesAreThoseOfAllTexels) {
    for (const PixelType type : {PixelType::uint8, PixelType::uint16, PixelType::half, PixelType::float32})
        for (const int alpha : {-1, 1}) {
            Texels texels({300, 270}, 2, type);
            std::mt19937 random(11);
            texels.fill([&](int x, int, int) {
                return (type == PixelType::float32 && x > 200 ? 1e-3 : 1) *
                       std::uniform_real_distribution<double>(0, 1)(random);
            });
            expect_means(texels, alpha, 4, 40, 6e-8);
        }
}

TEST(SummedAreas, ThreadsThatForgetAndMakeTilesAgree) {
    Texels texels({3000, 2800}, 3, PixelType::half);
    texels.fill([](int x, int y, int c) { return (x * 31 + y * 17 + c * 5) % 256 / 255.0; });
    const MemorySource source = texels.source();
    const SummedAreas sums(source);
    const auto walk = [&](int from) {
        double sum = 0;
        float pixel[3];
        for (int k = 0; k < 900; ++k) {
            const int at = (k + from) % 900;
            EXPECT_TRUE(sums.mean(50 + at % 30 * 97, 50 + at / 30 * 90, 150, 140, Wrap::mirror, pixel));
            sum += std::floor(double{pixel[at % 3]} * 0x1p20);
        }
        return sum;
    };
    const double alone = walk(0);
    std::vector<double> together(4);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 4; ++t)
        threads.emplace_back([&, t] { together[t] = walk(static_cast<int>(t) * 225); });
    for (std::thread& thread : threads) thread.join();
    for (const double sum : together) EXPECT_EQ(sum, alone);
    EXPECT_LE(sums.bytes(), SummedAreas::kMostBytes + (std::size_t{8} << 20));
}

TEST(SummedAreas, WhatIsNoNumberIsLocal) {
    for (const float bad : {NAN, HUGE_VALF, -HUGE_VALF}) {
        Texels texels({20, 10}, 2, PixelType::float32);
        texels.fill([&](int x, int y, int c) { return x == 5 && y == 4 && c == 0 ? bad : 0.5f; });
        const MemorySource source = texels.source();
        const SummedAreas sums(source);
        float pixel[2];
        sums.mean(6, 5, 3, 3, Wrap::clamp, pixel);
        EXPECT_TRUE(std::isnan(bad) ? std::isnan(pixel[0]) : pixel[0] == bad);
        EXPECT_FLOAT_EQ(pixel[1], 0.5f);
        for (const double x : {7.0, 15.0, 19.9}) {
            sums.mean(x, 7, 2, 2, Wrap::clamp, pixel);
            EXPECT_FLOAT_EQ(pixel[0], 0.5f);
        }
        for (const double side : {double{NAN}, HUGE_VAL, -1.0, 1e300, 0.0}) {
            sums.mean(12.5, 5.5, side, 1, Wrap::periodic, pixel);
            EXPECT_FLOAT_EQ(pixel[1], 0.5f) << side;
        }
        sums.mean(NAN, 5, 1, 1, Wrap::clamp, pixel);
        EXPECT_EQ(pixel[1], 0);
    }
}

/// The rectangle that a pixel of a map covers on the picture, and where.
struct Rectangle {
    double x, y, w, h;
};
Rectangle rectangle_of(const DrapeMap& map, int x, int y) {
    Point<double> p{};
    int piece = 0;
    EXPECT_TRUE(map.exact(x + 0.5, y + 0.5, 0, p, piece));
    const Jacobian j = map.jacobian(x + 0.5, y + 0.5, 0);
    return {p.x, p.y, std::fabs(j.x_i) + std::fabs(j.x_j), std::fabs(j.y_i) + std::fabs(j.y_j)};
}

TEST(SummedAreas, DrapesReadThePapersRectangle) {
    Scene scene{"plane"};
    scene.picture = {640, 480};
    scene.shape.aspect = 4.0 / 3;
    scene.pose.position = {0.9, -0.7, 1.5};
    Texels texels(scene.picture, 1, PixelType::uint8);
    std::mt19937 random(7);
    texels.fill([&](int, int, int) { return std::uniform_real_distribution<double>(0, 1)(random); });
    DrapeOptions options;
    options.filter = Filter::summed_area;
    Shown shown(scene, options);
    const MemorySource source = texels.source();
    const std::vector<float> drawn = shown.draw(&source, 1), covered = shown.seen();
    const DrapeMap map(cut_into_facets(shown.tree()->tree, shown.camera(), options.tol), shown.camera(),
                       scene.picture, options.tol);
    options.filter = Filter::pyramid;
    const Pyramid pyramid(source);
    const std::vector<float> by_pyramid = Shown(scene, options).draw(&pyramid, 1);
    int seen = 0;
    double squares[2] = {};
    for (int y = 1; y < 119; ++y)
        for (int x = 1; x < 159; ++x) {
            const auto whole = [&](int i, int j) {
                return covered[static_cast<std::size_t>(j * 160 + i)] == 1;
            };
            if (!whole(x, y) || !whole(x - 1, y) || !whole(x + 1, y) || !whole(x, y - 1) || !whole(x, y + 1))
                continue;
            const Rectangle r = rectangle_of(map, x, y);
            const auto k = static_cast<std::size_t>(y * 160 + x);
            const auto truth = static_cast<double>(
                mean_of(texels, -1, r.x, r.y, std::max(1.0, r.w), std::max(1.0, r.h), Wrap::clamp, 0));
            // Points are floats: 2^-24 of a block's reach, times differences between texels.
            EXPECT_NEAR(drawn[k], truth, 1e-4);
            squares[0] += std::pow(truth - 0.5, 2);
            squares[1] += std::pow(double{by_pyramid[k]} - 0.5, 2);
            ++seen;
        }
    ASSERT_GT(seen, 3000);
    // The picture is noise: what is left of it tells over how many texels a filter averages.
    EXPECT_NEAR(squares[1] / squares[0], 1, 0.15);
}

TEST(SummedAreas, EveryPartOfADrapeHasTheSameBits) {
    Scene scene{"sphere"};
    scene.shape.angle = 360;
    scene.picture = {500, 300};
    scene.pose.position = {0.2, 0.4, 2.4};
    Texels texels(scene.picture, 4, PixelType::uint8);
    texels.fill([](int x, int y, int c) { return (x * 31 + y * 17 + c * 5) % 256 / 255.0; });
    for (const Filter filter : {Filter::pyramid, Filter::summed_area})
        for (const int alpha : {-1, 3}) {
            DrapeOptions options;
            options.filter = filter;
            options.alpha = 3;
            options.background = {1, 0, 0};
            Shown shown(scene, options);
            const MemorySource memory = texels.source(alpha);
            const Pyramid source(memory);
            const std::vector<float> whole = shown.draw(&source, 4);
            const Drape drape(shown.tree(), shown.camera(), scene.picture, options);
            for (const Box& box : {Box{3, 5, 50, 61}, Box{40, 0, 160, 120}, Box{77, 50, 78, 51}}) {
                std::vector<float> part(static_cast<std::size_t>(box.width() * box.height() * 4));
                ASSERT_TRUE(drape.draw(&source, box,
                                       packed_view(reinterpret_cast<std::byte*>(part.data()),
                                                   PixelType::float32, box.width(), box.height(), 4),
                                       serial_for));
                for (int y = box.y0; y < box.y1; ++y)
                    for (int i = 0; i < box.width() * 4; ++i)
                        ASSERT_EQ(part[static_cast<std::size_t>((y - box.y0) * box.width() * 4 + i)],
                                  whole[static_cast<std::size_t>((y * 160 + box.x0) * 4 + i)]);
            }
        }
}

}  // namespace
}  // namespace anamorph::test_summed_areas
