// SPDX-License-Identifier: Apache-2.0
// Taps within half a texel of a point, which read nine texels (image/nine_texels-inl.h), against their bilinear values one by one
// in long double.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "anamorph/image/block_sampler.h"
#include "anamorph/number/half.h"
#include "each_instruction_set.h"
#include "guarded_memory.h"

namespace anamorph::test_nine_texels {
namespace {

constexpr unsigned kSeed = 20261129;
constexpr int kWidth = 40, kHeight = 30, kRoom = simd::kRowRoom;

long double value_of(const std::byte* p, PixelType type) {
    if (type == PixelType::float32) {
        float value;
        std::memcpy(&value, p, sizeof value);
        return value;
    }
    std::uint16_t word = 0;
    std::memcpy(&word, p, type == PixelType::uint8 ? 1 : 2);
    return type == PixelType::half ? static_cast<long double>(float_from_half(word)) : word;
}

/// Texels, points among them and taps about these.
struct Case {
    PixelType type;
    int channels, width, height;
    std::vector<std::byte> texels;
    std::vector<float> x, y;
    std::vector<simd::Tap> taps;

    Case(PixelType t, int c, int w, int h, int tap_count, std::mt19937& random)
        : type(t), channels(c), width(w), height(h) {
        texels.resize(static_cast<std::size_t>(row_bytes() * kHeight + 64));
        for (int k = 0; k + size_of(type) <= static_cast<int>(texels.size()); k += size_of(type)) {
            // Black and white side by side in some rows, where errors of the point count most; noise below.
            const bool striped = k < row_bytes() * 8;
            const double v = striped ? k / pixel_bytes() % 2 : static_cast<double>(random()) / 4294967295.0;
            put(k, v);
        }
        const auto at = [&](int count) {
            const double v =
                1 + static_cast<double>(random() % (8192U * static_cast<unsigned>(count - 2))) / 8192;
            return static_cast<float>(random() % 4 == 0 ? std::round(2 * v) / 2 : v);
        };
        for (int i = 0; i < kRoom * height; ++i) {
            x.push_back(at(kWidth));
            y.push_back(at(kHeight));
        }
        // Two directions whose lengths together reach half a texel at most.
        const auto part = [&] { return static_cast<float>(static_cast<int>(random() % 2049) - 1024) / 4096; };
        const simd::Tap a{part(), part()}, b{part(), part()};
        if (tap_count == 2)
            taps = {{-2 * a.x, -2 * a.y}, {2 * a.x, 2 * a.y}};
        else
            taps = {{-a.x - b.x, -a.y - b.y},
                    {a.x - b.x, a.y - b.y},
                    {b.x - a.x, b.y - a.y},
                    {a.x + b.x, a.y + b.y}};
    }
    void put(int k, double v) {
        std::byte* to = texels.data() + k;
        if (type == PixelType::uint8) {
            *to = static_cast<std::byte>(std::lround(255 * v));
        } else if (type == PixelType::float32) {
            const auto f = static_cast<float>(v);
            std::memcpy(to, &f, sizeof f);
        } else {
            const auto word = type == PixelType::half ? half_from_float(static_cast<float>(v))
                                                      : static_cast<std::uint16_t>(std::lround(65535 * v));
            std::memcpy(to, &word, sizeof word);
        }
    }
    int pixel_bytes() const { return channels * size_of(type); }
    int row_bytes() const { return kWidth * pixel_bytes(); }
    simd::Texels from(const std::byte* first) const {
        return {first,
                row_bytes(),
                type,
                channels,
                simd::Kernel::bilinear,
                taps.data(),
                static_cast<int>(taps.size())};
    }
    void draw(const std::byte* first, int begin, int end, int row_begin, int row_end, std::byte* to,
              int row_stride) const {
        const simd::Polynomials points{nullptr, 0, width, height, x.data(), y.data(), kRoom};
        simd::draw_block(from(first), points, begin, end, row_begin, row_end, 1, type, to, row_stride);
        simd::finish_stores();
    }
    std::vector<std::byte> draw() const {
        std::vector<std::byte> picture(static_cast<std::size_t>(width * height * pixel_bytes()));
        draw(texels.data(), 0, width, 0, height, picture.data(), width * pixel_bytes());
        return picture;
    }
    long double texel(int tx, int ty, int c) const {
        return value_of(texels.data() + ty * row_bytes() + tx * pixel_bytes() + c * size_of(type), type);
    }
    /// The mean of the taps; texels of weight 0 are not looked at.
    long double wanted(int i, int j, int c) const {
        const auto k = static_cast<std::size_t>(j * kRoom + i);
        long double sum = 0;
        for (const simd::Tap& tap : taps) {
            const long double px = static_cast<long double>(x[k]) + static_cast<long double>(tap.x) - 0.5L,
                              py = static_cast<long double>(y[k]) + static_cast<long double>(tap.y) - 0.5L;
            const auto tx = static_cast<int>(std::floor(px)), ty = static_cast<int>(std::floor(py));
            for (int n = 0; n < 2; ++n)
                for (int m = 0; m < 2; ++m) {
                    const long double weight = (n ? py - ty : 1 - (py - ty)) * (m ? px - tx : 1 - (px - tx));
                    if (weight > 0) sum += weight * texel(tx + m, ty + n, c);
                }
        }
        return sum / static_cast<long double>(taps.size());
    }
};

/// What block_sampler.h states for a value before it is rounded, and what rounding it costs.
long double error_of(PixelType type, bool packed) {
    if (type == PixelType::uint8) return 0.5L + (packed ? 1 / 15.0L : 16 * 0x1p-24L * 255);
    if (type == PixelType::uint16) return 0.5L + 16 * 0x1p-24L * 65535;
    return 16 * 0x1p-24L + (type == PixelType::half ? 0x1p-11L : 0);
}

template <class Body>
void for_cases(const Body& body) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::on_every_instruction_set([&] {
        std::mt19937 random(kSeed);
        for (const PixelType type :
             {PixelType::uint8, PixelType::uint16, PixelType::half, PixelType::float32})
            for (const int channels : {1, 3, 4, 5})
                for (const int taps : {2, 4})
                    for (const int width : {1, 7, 8, 9, 64}) {
                        Case block(type, channels, width, 16, taps, random);
                        body(block);
                    }
    });
}

TEST(NineTexels, ValuesAreWithinTheStatedError) {
    for_cases([](const Case& block) {
        const std::vector<std::byte> picture = block.draw();
        const bool packed = block.channels == 3 || block.channels == 4;
        long double worst = 0;
        for (int j = 0; j < block.height; ++j)
            for (int i = 0; i < block.width; ++i)
                for (int c = 0; c < block.channels; ++c) {
                    const std::byte* got = picture.data() + (j * block.width + i) * block.pixel_bytes() +
                                           c * size_of(block.type);
                    worst = std::max(worst, std::fabs(value_of(got, block.type) - block.wanted(i, j, c)));
                }
        EXPECT_LE(worst, error_of(block.type, packed))
            << "type " << static_cast<int>(block.type) << " channels " << block.channels << " width "
            << block.width << " taps " << block.taps.size();
    });
}

TEST(NineTexels, FlatPicturesStayFlat) {
    for_cases([](Case& block) {
        for (int k = 0; k + size_of(block.type) <= static_cast<int>(block.texels.size());
             k += size_of(block.type))
            block.put(k, 0.7);
        const std::vector<std::byte> picture = block.draw();
        for (std::size_t k = 0; k < picture.size(); k += static_cast<std::size_t>(size_of(block.type)))
            ASSERT_EQ(std::memcmp(picture.data() + k, block.texels.data(),
                                  static_cast<std::size_t>(size_of(block.type))),
                      0);
    });
}

TEST(NineTexels, PartsHaveTheBitsOfTheWhole) {
    for_cases([](const Case& block) {
        const std::vector<std::byte> whole = block.draw();
        std::mt19937 random(kSeed + static_cast<unsigned>(block.width));
        for (int round = 0; round < 10; ++round) {
            const int begin = static_cast<int>(random() % static_cast<unsigned>(block.width)),
                      row = static_cast<int>(random() % 16);
            const int end =
                begin + 1 + static_cast<int>(random() % static_cast<unsigned>(block.width - begin));
            std::vector<std::byte> part(static_cast<std::size_t>((end - begin) * block.pixel_bytes()));
            block.draw(block.texels.data(), begin, end, row, row + 1, part.data(), 0);
            EXPECT_EQ(
                std::memcmp(part.data(), whole.data() + (row * block.width + begin) * block.pixel_bytes(),
                            part.size()),
                0);
        }
    });
}

TEST(NineTexels, RowsHaveTheBitsOfBlocksButForBytes) {
    for_cases([](const Case& block) {
        if (block.type != PixelType::float32) return;
        const std::vector<std::byte> whole = block.draw();
        for (int j = 0; j < block.height; ++j) {
            std::vector<float> row(static_cast<std::size_t>(simd::kMaxRow * block.channels + 16));
            simd::sample_row(block.from(block.texels.data()),
                             {block.x.data() + j * kRoom, block.y.data() + j * kRoom, block.width},
                             row.data());
            const auto bytes = static_cast<std::size_t>(block.width * block.pixel_bytes());
            EXPECT_EQ(std::memcmp(row.data(), whole.data() + static_cast<std::size_t>(j) * bytes, bytes), 0);
        }
    });
}

TEST(NineTexels, NoTexelIsReadBeyondThoseThatPointsHaveAround) {
    const test::GuardedMemory memory(1 << 17);
    for_cases([&](Case& block) {
        // In the last texel but one of the last row but one, wherever in it.
        std::mt19937 random(kSeed);
        for (std::size_t k = 0; k < block.x.size(); ++k) {
            block.x[k] = kWidth - 2 + static_cast<float>(random() % 8192) / 8192;
            block.y[k] = kHeight - 2 + static_cast<float>(random() % 8192) / 8192;
        }
        std::byte* first = memory.last(block.texels.size());
        std::memcpy(first, block.texels.data(), block.texels.size());
        std::vector<std::byte> picture(
            static_cast<std::size_t>(block.width * block.height * block.pixel_bytes()));
        block.draw(first, 0, block.width, 0, block.height, picture.data(), block.width * block.pixel_bytes());
        EXPECT_TRUE(picture == block.draw());
    });
}

TEST(NineTexels, TexelsThatAreNoNumbersCountWhereTheyHaveWeight) {
    for_cases([](Case& block) {
        if (block.type == PixelType::uint8 || block.type == PixelType::uint16) return;
        std::mt19937 random(kSeed);
        for (int k = 0; k < 60; ++k) {
            const int at = static_cast<int>(random() % (kWidth * kHeight)) * block.pixel_bytes();
            block.put(at, k % 2 ? std::numeric_limits<double>::quiet_NaN()
                                : std::numeric_limits<double>::infinity());
        }
        const std::vector<std::byte> picture = block.draw();
        for (int j = 0; j < block.height; ++j)
            for (int i = 0; i < block.width; ++i) {
                const long double got =
                    value_of(picture.data() + (j * block.width + i) * block.pixel_bytes(), block.type);
                const long double wanted = block.wanted(i, j, 0);
                if (std::isfinite(wanted))
                    EXPECT_NEAR(got, wanted, error_of(block.type, false));
                else
                    EXPECT_FALSE(std::isfinite(got));
            }
    });
}

}  // namespace
}  // namespace anamorph::test_nine_texels
