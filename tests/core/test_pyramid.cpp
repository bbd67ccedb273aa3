// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/pyramid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <thread>
#include <vector>

#include "anamorph/image/pixel.h"

namespace anamorph::test_pyramid {
namespace {

constexpr PixelType kTypes[] = {PixelType::uint8, PixelType::uint16, PixelType::half, PixelType::float32};

/// Seeded noise in 0..1 as a source that counts what is read and fails on demand.
class Noise final : public Source {
  public:
    Noise(int width, int height, int channels, PixelType type, int alpha = -1, bool in_memory = true)
        : m_bytes(static_cast<std::size_t>(width * height * channels * size_of(type))),
          m_view(packed_view<const std::byte>(m_bytes.data(), type, width, height, channels)),
          m_memory(m_view, alpha),
          m_in_memory(in_memory) {
        std::mt19937 random(23);
        std::uniform_real_distribution<float> value(0, 1);
        for (std::size_t i = 0; i < m_bytes.size(); i += static_cast<std::size_t>(size_of(type)))
            store_channel(value(random), &m_bytes[i], type);
    }
    PixelType type() const noexcept override { return m_memory.type(); }
    int channels() const noexcept override { return m_memory.channels(); }
    int unassociated_alpha() const noexcept override { return m_memory.unassociated_alpha(); }
    int levels() const noexcept override { return 1; }
    Size size(int level) const noexcept override { return m_memory.size(level); }
    const ConstImageView* view(int level) const noexcept override {
        return m_in_memory ? m_memory.view(level) : nullptr;
    }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override {
        texels_read += std::int64_t{box.width()} * box.height();
        return !fails && m_memory.read(level, box, texels, row_stride);
    }
    std::byte* at(int x, int y) { return &m_bytes[static_cast<std::size_t>(m_view.at(x, y) - m_view.data)]; }

    mutable std::atomic<std::int64_t> texels_read{0};
    bool fails = false;

  private:
    std::vector<std::byte> m_bytes;
    ConstImageView m_view;
    MemorySource m_memory;
    bool m_in_memory;
};

std::vector<std::byte> whole(const Source& source, int level) {
    const Size size = source.size(level);
    const std::ptrdiff_t stride = std::ptrdiff_t{size.width} * source.channels() * size_of(source.type());
    std::vector<std::byte> bytes(static_cast<std::size_t>(stride * size.height));
    EXPECT_TRUE(source.read(level, {0, 0, size.width, size.height}, bytes.data(), stride));
    return bytes;
}

std::vector<float> numbers(const Source& source, int level) {
    const std::vector<std::byte> bytes = whole(source, level);
    std::vector<float> values(bytes.size() / static_cast<std::size_t>(size_of(source.type())));
    load_channels(bytes.data(), source.type(), static_cast<std::int64_t>(values.size()), values.data());
    return values;
}

std::vector<std::pair<int, int>> sizes(const Source& source) {
    std::vector<std::pair<int, int>> r;
    for (int i = 0; i < source.levels(); ++i) r.emplace_back(source.size(i).width, source.size(i).height);
    return r;
}

TEST(Pyramid, HalvesUntilItIsSmallOrPiecesWouldMix) {
    using Sizes = std::vector<std::pair<int, int>>;
    const auto of = [](int w, int h, int columns, int rows) {
        const Noise noise(w, h, 1, PixelType::uint8);
        return sizes(Pyramid(noise, columns, rows));
    };
    EXPECT_EQ(of(40, 20, 1, 1), (Sizes{{40, 20}, {20, 10}, {10, 5}}));
    EXPECT_EQ(of(37, 19, 1, 1), (Sizes{{37, 19}, {18, 9}, {9, 4}}));
    EXPECT_EQ(of(7, 7, 1, 1), (Sizes{{7, 7}}));
    EXPECT_EQ(of(1, 1, 1, 1), (Sizes{{1, 1}}));
    EXPECT_EQ(of(48, 288, 1, 6), (Sizes{{48, 288}, {24, 144}, {12, 72}, {6, 36}}));
    EXPECT_EQ(of(60, 40, 3, 2), (Sizes{{60, 40}, {30, 20}, {15, 10}}));
    EXPECT_EQ(of(28, 21, 4, 3), (Sizes{{28, 21}}));
}

TEST(Pyramid, EveryTexelIsTheAreaAverageOfTheLevelBelow) {
    for (const PixelType type : kTypes)
        for (const auto& [w, h] : {std::pair{300, 150}, {301, 143}, {263, 275}})
            for (const int alpha : {-1, 0, 2})
                for (const bool in_memory : {true, false}) {
                    const int channels = 3;
                    Noise noise(w, h, channels, type, alpha, in_memory);
                    // Some texels are clear.
                    for (int x = 0; x < 40 && alpha >= 0; ++x)
                        for (int y = 0; y < 9; ++y)
                            store_channel(0, noise.at(x, y) + alpha * size_of(type), type);
                    const Pyramid pyramid(noise);
                    const double step = type == PixelType::uint8    ? 1.0 / 255
                                        : type == PixelType::uint16 ? 1.0 / 65535
                                        : type == PixelType::half   ? 0x1p-11
                                                                    : 0;
                    for (int level = 1; level < pyramid.levels(); ++level) {
                        const std::vector<float> fine = numbers(pyramid, level - 1),
                                                 coarse = numbers(pyramid, level);
                        const auto [fw, fh] = pyramid.size(level - 1);
                        const auto [cw, ch] = pyramid.size(level);
                        const double rx = static_cast<double>(fw) / cw, ry = static_cast<double>(fh) / ch;
                        for (int y = 0; y < ch; ++y)
                            for (int x = 0; x < cw; ++x) {
                                double sum[3] = {}, covered = 0, opaque = 0;
                                for (int v = static_cast<int>(y * ry); v < std::min<double>(fh, (y + 1) * ry);
                                     ++v)
                                    for (int u = static_cast<int>(x * rx);
                                         u < std::min<double>(fw, (x + 1) * rx); ++u) {
                                        const double weight =
                                            (std::min(u + 1.0, (x + 1) * rx) - std::max<double>(u, x * rx)) *
                                            (std::min(v + 1.0, (y + 1) * ry) - std::max<double>(v, y * ry));
                                        const float* texel =
                                            &fine[static_cast<std::size_t>((v * fw + u) * channels)];
                                        const double shown =
                                            alpha < 0 ? 1 : static_cast<double>(texel[alpha]);
                                        covered += weight;
                                        opaque += weight * shown;
                                        for (int c = 0; c < channels; ++c)
                                            sum[c] += weight * shown * static_cast<double>(texel[c]);
                                    }
                                ASSERT_NEAR(covered, rx * ry, 1e-9);
                                for (int c = 0; c < channels; ++c) {
                                    const double expected = c == alpha   ? opaque / covered
                                                            : opaque > 0 ? sum[c] / opaque
                                                                         : 0;
                                    ASSERT_NEAR(coarse[static_cast<std::size_t>((y * cw + x) * channels + c)],
                                                expected, 0.5 * step + 1e-6)
                                        << level << ": " << x << ' ' << y << ' ' << c;
                                }
                            }
                    }
                }
}

TEST(Pyramid, ABrightnessStaysWhatItIs) {
    for (const PixelType type : kTypes) {
        Noise noise(101, 67, 2, type);
        for (int y = 0; y < 67; ++y)
            for (int x = 0; x < 101; ++x) {
                store_channel(0.7f, noise.at(x, y), type);
                store_channel(1, noise.at(x, y) + size_of(type), type);
            }
        const Pyramid pyramid(noise);
        const float first = numbers(pyramid, 0)[0];
        for (int level = 0; level < pyramid.levels(); ++level) {
            const std::vector<float> values = numbers(pyramid, level);
            for (std::size_t i = 0; i < values.size(); i += 2) {
                ASSERT_NEAR(values[i], first, 1e-6);
                ASSERT_NEAR(values[i + 1], 1, 1e-6);
            }
        }
    }
}

TEST(Pyramid, RoundingDoesNotDrift) {
    const Noise noise(1024, 1024, 1, PixelType::uint8);
    const Pyramid pyramid(noise);
    const auto mean = [&](int level) {
        double sum = 0;
        const std::vector<float> values = numbers(pyramid, level);
        for (const float v : values) sum += static_cast<double>(v);
        return 255 * sum / static_cast<double>(values.size());
    };
    // Rounding errors of 1/12 step^2 a texel and level: at level 5 their mean has a deviation of .01 steps.
    for (int level = 1; level <= 5; ++level) EXPECT_NEAR(mean(level), mean(0), 0.05) << level;
}

TEST(Pyramid, SameBitsInAnyOrderOnAnyThreads) {
    constexpr unsigned kSeed = 29;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    for (const PixelType type : {PixelType::uint8, PixelType::float32}) {
        const Noise noise(1311, 903, 3, type, -1, type == PixelType::uint8);
        const Pyramid once(noise);
        std::vector<std::vector<std::byte>> expected;
        for (int level = 0; level < once.levels(); ++level) expected.push_back(whole(once, level));
        for (int threads = 1; threads <= 4; ++threads) {
            const Pyramid pyramid(noise);
            std::atomic<int> wrong{0};
            const auto work = [&](unsigned seed) {
                std::mt19937 random(seed);
                for (int i = 0; i < 60; ++i) {
                    const int level = static_cast<int>(random() % static_cast<unsigned>(pyramid.levels()));
                    const auto [w, h] = pyramid.size(level);
                    const int x = static_cast<int>(random() % static_cast<unsigned>(w)),
                              y = static_cast<int>(random() % static_cast<unsigned>(h));
                    const Box box{x, y, std::min(w, x + 150), std::min(h, y + 150)};
                    const std::size_t pixel = static_cast<std::size_t>(3 * size_of(type));
                    const std::size_t row = pixel * static_cast<std::size_t>(box.width());
                    std::vector<std::byte> bytes(row * static_cast<std::size_t>(box.height()));
                    if (!pyramid.read(level, box, bytes.data(), static_cast<std::ptrdiff_t>(row))) ++wrong;
                    for (int j = 0; j < box.height(); ++j) {
                        const std::size_t from = pixel * static_cast<std::size_t>((y + j) * w + x);
                        if (std::memcmp(&bytes[row * static_cast<std::size_t>(j)],
                                        &expected[static_cast<std::size_t>(level)][from], row) != 0)
                            ++wrong;
                    }
                }
            };
            std::vector<std::thread> pool;
            for (int t = 0; t < threads; ++t) pool.emplace_back(work, kSeed + static_cast<unsigned>(t));
            for (std::thread& thread : pool) thread.join();
            EXPECT_EQ(wrong, 0) << threads << " threads";
        }
    }
}

TEST(Pyramid, ReadsWhatItNeedsOnce) {
    const Noise noise(2048, 1024, 1, PixelType::uint8, -1, false);
    const Pyramid pyramid(noise);
    std::byte texel;
    ASSERT_TRUE(pyramid.read(1, {300, 300, 301, 301}, &texel, 1));
    EXPECT_EQ(noise.texels_read, 256 * 128);
    ASSERT_TRUE(pyramid.read(1, {290, 310, 291, 311}, &texel, 1));
    EXPECT_EQ(noise.texels_read, 256 * 128);
    ASSERT_TRUE(pyramid.read(2, {300, 200, 301, 201}, &texel, 1));
    EXPECT_LE(noise.texels_read, 256 * 256 + 512 * 512);
    ASSERT_TRUE(pyramid.prepare(3, {0, 0, 256, 128}));
    EXPECT_EQ(noise.texels_read, 2048 * 1024);
}

/// Noise in a part of a picture, and nothing around it.
class NoiseInWindow final : public Source {
  public:
    NoiseInWindow(Noise& noise, const Box& window, bool says)
        : m_noise(noise), m_window(window), m_says(says) {
        const Size all = noise.size(0);
        for (int y = 0; y < all.height; ++y)
            for (int x = 0; x < all.width; ++x)
                if (!(x >= window.x0 && x < window.x1 && y >= window.y0 && y < window.y1))
                    std::fill_n(noise.at(x, y), noise.channels() * size_of(noise.type()), std::byte{});
    }
    PixelType type() const noexcept override { return m_noise.type(); }
    int channels() const noexcept override { return m_noise.channels(); }
    int levels() const noexcept override { return 1; }
    Size size(int level) const noexcept override { return m_noise.size(level); }
    Box data_window() const noexcept override { return m_says ? m_window : extent(0); }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override {
        return m_noise.read(level, box, texels, row_stride);
    }

  private:
    Noise& m_noise;
    Box m_window;
    bool m_says;
};

/// Noise that notes the rows that are asked for.
class RowsAsked final : public Source {
  public:
    explicit RowsAsked(const Noise& base) : m_base(base) {}
    PixelType type() const noexcept override { return m_base.type(); }
    int channels() const noexcept override { return m_base.channels(); }
    int unassociated_alpha() const noexcept override { return -1; }
    int levels() const noexcept override { return 1; }
    Size size(int level) const noexcept override { return m_base.size(level); }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override {
        first = std::min(first, box.y0);
        end = std::max(end, box.y1);
        return m_base.read(level, box, texels, row_stride);
    }
    mutable int first = 1 << 30, end = 0;

  private:
    const Noise& m_base;
};

TEST(Pyramid, CoarseLevelsReadTheRowsThatTheyNeed) {
    const Noise noise(256, 4096, 1, PixelType::uint8);
    for (const int level : {1, 3, 5, 6}) {
        const int rows = 4096 >> level;
        for (const int row : {0, rows / 2 - 1, rows - 1}) {
            const RowsAsked base(noise);
            const Pyramid pyramid(base);
            std::vector<std::byte> texel(1);
            ASSERT_TRUE(pyramid.read(level, {0, row, 1, row + 1}, texel.data(), 1));
            // A tile is as high as 128 rows of the base, or 4 of its own.
            const int high = std::max(128, 4 << level), from = (row << level) / high * high;
            EXPECT_EQ(base.first, from) << level;
            EXPECT_EQ(base.end, from + high) << level;
        }
    }
}

TEST(Pyramid, WhatAnImageHasNothingOfIsNotRead) {
    for (const Box& window :
         {Box{0, 0, 1, 1}, Box{700, 500, 701, 502}, Box{256, 256, 512, 512}, Box{1498, 0, 1499, 1100}}) {
        Noise noise(1499, 1100, 2, PixelType::uint16, -1, false);
        const NoiseInWindow silent(noise, window, false), saying(noise, window, true);
        const Pyramid whole(silent), part(saying);
        for (int level = 1; level < whole.levels(); ++level) {
            const Size size = whole.size(level);
            std::vector<std::byte> a(static_cast<std::size_t>(size.width * size.height * 4)), b(a.size());
            ASSERT_TRUE(whole.read(level, {0, 0, size.width, size.height}, a.data(), size.width * 4));
            const std::int64_t before = noise.texels_read;
            ASSERT_TRUE(part.read(level, {0, 0, size.width, size.height}, b.data(), size.width * 4));
            EXPECT_EQ(a, b) << level;
            if (level == 1) {
                EXPECT_LT(noise.texels_read - before, before / 2);
            }
        }
    }
}

TEST(Pyramid, APreparedViewIsWhatIsRead) {
    const Noise noise(700, 500, 3, PixelType::half);
    const Pyramid pyramid(noise), other(noise);
    ASSERT_NE(pyramid.view(0), nullptr);
    const Box box{100, 60, 190, 120};
    ASSERT_TRUE(pyramid.prepare(2, {100, 60, 175, 120}));
    const ConstImageView* view = pyramid.view(2);
    ASSERT_NE(view, nullptr);
    EXPECT_EQ(view->width, 175);
    EXPECT_TRUE(view->packed());
    const std::vector<std::byte> all = whole(other, 2);
    for (int y = box.y0; y < box.y1; ++y)
        EXPECT_EQ(std::memcmp(view->at(100, y), &all[static_cast<std::size_t>((y * 175 + 100) * 6)], 75 * 6),
                  0);
}

TEST(Pyramid, ASourceThatFailsIsAskedAgain) {
    Noise noise(300, 200, 1, PixelType::float32, -1, false);
    const Pyramid pyramid(noise);
    float texel = -1;
    std::byte* bytes = reinterpret_cast<std::byte*>(&texel);
    noise.fails = true;
    EXPECT_FALSE(pyramid.read(2, {5, 5, 6, 6}, bytes, 4));
    EXPECT_FALSE(pyramid.prepare(1, {5, 5, 6, 6}));
    noise.fails = false;
    ASSERT_TRUE(pyramid.read(2, {5, 5, 6, 6}, bytes, 4));
    EXPECT_EQ(texel, numbers(Pyramid(noise), 2)[5 * 75 + 5]);
}

TEST(Pyramid, ASourcesOwnLevelsAreUsed) {
    const Noise noise(64, 32, 1, PixelType::uint8);
    const Pyramid own(noise);
    ASSERT_GT(own.levels(), 1);
    const Pyramid pyramid(static_cast<const Source&>(own));
    EXPECT_EQ(sizes(pyramid), sizes(own));
    for (int level = 0; level < own.levels(); ++level) {
        EXPECT_EQ(pyramid.view(level), own.view(level));
        EXPECT_EQ(whole(pyramid, level), whole(own, level));
    }
}

TEST(Pyramid, NanStaysLocal) {
    Noise noise(64, 64, 1, PixelType::float32);
    store_channel(std::numeric_limits<float>::quiet_NaN(), noise.at(21, 38), PixelType::float32);
    const Pyramid pyramid(noise);
    for (int level = 0; level < pyramid.levels(); ++level) {
        const std::vector<float> values = numbers(pyramid, level);
        for (int i = 0; i < static_cast<int>(values.size()); ++i) {
            const int x = i % (64 >> level), y = i / (64 >> level);
            EXPECT_EQ(std::isnan(values[static_cast<std::size_t>(i)]), x == 21 >> level && y == 38 >> level);
        }
    }
}

}  // namespace
}  // namespace anamorph::test_pyramid
