// SPDX-License-Identifier: Apache-2.0
// Blocks drawn in the type of their texels: within the stated error of the bilinear value in long double, with the
// same bits in whole numbers on every instruction set, whatever part of them is drawn, and within their memory.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "anamorph/image/block_sampler.h"
#include "anamorph/image/source.h"
#include "anamorph/number/half.h"
#include "anamorph/panorama/reproject.h"
#include "each_instruction_set.h"
#include "guarded_memory.h"

namespace anamorph::test_packed_blocks {
namespace {

constexpr unsigned kSeed = 20261122;
constexpr int kWidth = 40, kHeight = 30, kRoom = simd::kRowRoom;

/// The value of a channel in its own units: levels of uint8 and uint16.
long double value_of(const std::byte* p, PixelType type) {
    std::uint16_t word = 0;
    std::memcpy(&word, p, type == PixelType::uint8 ? 1 : 2);
    return type == PixelType::half ? static_cast<long double>(float_from_half(word)) : word;
}

/// Texels, and the points of a block among them, as draw_block takes them.
struct Case {
    PixelType type;
    int channels, width, height;
    std::vector<std::byte> texels;
    std::vector<float> x, y;
    simd::Tap tap;

    Case(PixelType t, int c, int w, int h, std::mt19937& random) : type(t), channels(c), width(w), height(h) {
        texels.resize(static_cast<std::size_t>(row_bytes() * kHeight + 64));
        for (std::byte& b : texels) b = static_cast<std::byte>(random());
        if (type == PixelType::half)  // positive numbers below 8
            for (std::size_t i = 1; i < texels.size(); i += 2) texels[i] = texels[i] & std::byte{0x3f};
        // Black and white side by side, where errors of the point count most.
        for (int i = 0; i < row_bytes() * 8; ++i) {
            const bool high = i / pixel_bytes() % 2 != 0;
            const bool odd = i % 2 != 0;
            texels[static_cast<std::size_t>(i)] = !high ? std::byte{0}
                                                  : type == PixelType::half
                                                      ? static_cast<std::byte>(odd ? 0x3c : 0)
                                                      : std::byte{255};
        }
        // Multiples of 2^-13, so that moving them by half a texel rounds nothing; some stand on texels and between.
        const auto at = [&](int count) {
            // Where every texel that a point falls into has neighbours, or its half next to them.
            const double v =
                1 + static_cast<double>(random() % (8192U * static_cast<unsigned>(count - 2))) / 8192;
            return static_cast<float>(random() % 4 == 0 ? std::round(2 * v) / 2 : v);
        };
        for (int i = 0; i < kRoom * height; ++i) {
            x.push_back(at(kWidth));
            y.push_back(at(kHeight));
        }
    }
    int pixel_bytes() const { return channels * size_of(type); }
    int row_bytes() const { return kWidth * pixel_bytes(); }

    void draw(int begin, int end, int row_begin, int row_end, std::byte* to, int row_stride) const {
        const simd::Texels from{texels.data(), row_bytes(), type, channels, simd::Kernel::bilinear, &tap, 1};
        const simd::Polynomials points{nullptr, 0, width, height, x.data(), y.data(), kRoom};
        simd::draw_block(from, points, begin, end, row_begin, row_end, 1, type, to, row_stride);
        simd::finish_stores();
    }
    std::vector<std::byte> draw() const {
        std::vector<std::byte> picture(static_cast<std::size_t>(width * height * pixel_bytes()));
        draw(0, width, 0, height, picture.data(), width * pixel_bytes());
        return picture;
    }

    long double texel(int tx, int ty, int c) const {
        return value_of(texels.data() + ty * row_bytes() + tx * pixel_bytes() + c * size_of(type), type);
    }
    /// The bilinear value of a pixel, and the largest of its texels.
    long double wanted(int i, int j, int c, long double& largest) const {
        const auto k = static_cast<std::size_t>(j * kRoom + i);
        const long double px = x[k] - 0.5L, py = y[k] - 0.5L;
        const int tx = std::min(static_cast<int>(px), kWidth - 2),
                  ty = std::min(static_cast<int>(py), kHeight - 2);
        const long double fx = px - tx, fy = py - ty;
        const long double a = texel(tx, ty, c), b = texel(tx + 1, ty, c);
        const long double d = texel(tx, ty + 1, c), e = texel(tx + 1, ty + 1, c);
        largest = std::max(std::max(a, b), std::max(d, e));
        return (1 - fy) * ((1 - fx) * a + fx * b) + fy * ((1 - fx) * d + fx * e);
    }
};

/// What block_sampler.h states for a value before it is rounded, and what rounding it costs.
long double error_of(PixelType type, long double largest) {
    if (type == PixelType::uint8) return 0.5L + 1 / 32.0L;
    const long double in_float = 16 * 0x1p-24L * largest;
    return in_float + (type == PixelType::uint16 ? 0.5L : 0x1p-11L * std::max(largest, 0x1p-13L));
}

TEST(PackedBlocks, ValuesAreWithinTheStatedError) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::on_every_instruction_set([] {
        std::mt19937 random(kSeed);
        for (const PixelType type : {PixelType::uint8, PixelType::uint16, PixelType::half})
            for (const int channels : {1, 2, 3, 4, 5})
                for (const int width : {1, 2, 7, 8, 9, 63, 64}) {
                    const Case block(type, channels, width, 32, random);
                    const std::vector<std::byte> picture = block.draw();
                    long double worst = 0;
                    for (int j = 0; j < block.height; ++j)
                        for (int i = 0; i < width; ++i)
                            for (int c = 0; c < channels; ++c) {
                                long double largest = 0;
                                const long double wanted = block.wanted(i, j, c, largest);
                                const std::byte* got = picture.data() +
                                                       (j * width + i) * block.pixel_bytes() +
                                                       c * size_of(type);
                                worst = std::max(
                                    worst, std::fabs(value_of(got, type) - wanted) / error_of(type, largest));
                            }
                    EXPECT_LE(worst, 1) << "type " << static_cast<int>(type) << " channels " << channels
                                        << " width " << width;
                }
    });
}

TEST(PackedBlocks, WholeTexelsAreAddedToOffsets) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::on_every_instruction_set([] {
        std::mt19937 random(kSeed);
        for (const PixelType type : {PixelType::uint8, PixelType::uint16, PixelType::half})
            for (const int channels : {3, 4, 5}) {
                Case block(type, channels, 61, 32, random);
                const std::vector<std::byte> wanted = block.draw();
                std::vector<std::int32_t> whole_x, whole_y;
                for (float& x : block.x) {
                    whole_x.push_back(static_cast<std::int32_t>(x));
                    x -= std::floor(x);
                }
                for (float& y : block.y) {
                    whole_y.push_back(static_cast<std::int32_t>(y));
                    y -= std::floor(y);
                }
                std::vector<std::byte> picture(wanted.size());
                const simd::Texels from{block.texels.data(),    block.row_bytes(), type, channels,
                                        simd::Kernel::bilinear, &block.tap,        1,    /*apart=*/true};
                const simd::Polynomials points{
                    nullptr,        0,     block.width,    block.height,  block.x.data(),
                    block.y.data(), kRoom, whole_x.data(), whole_y.data()};
                simd::draw_block(from, points, 0, block.width, 0, block.height, 1, type, picture.data(),
                                 block.width * block.pixel_bytes());
                simd::finish_stores();
                // Multiples of 2^-13 are moved without rounding.
                EXPECT_TRUE(picture == wanted) << static_cast<int>(type) << ' ' << channels;
            }
    });
}

TEST(PackedBlocks, WholeNumbersAreTheSameOnEveryInstructionSet) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    for (const int channels : {3, 4}) {
        std::vector<std::byte> first;
        test::on_every_instruction_set([&] {
            std::mt19937 random(kSeed);
            const std::vector<std::byte> picture = Case(PixelType::uint8, channels, 61, 32, random).draw();
            if (first.empty()) first = picture;
            EXPECT_TRUE(picture == first);
        });
    }
}

TEST(PackedBlocks, FlatPicturesStayFlat) {
    test::on_every_instruction_set([] {
        std::mt19937 random(kSeed);
        for (const int channels : {3, 4}) {
            Case block(PixelType::uint8, channels, 64, 32, random);
            for (int level = 0; level < 256; ++level) {
                std::fill(block.texels.begin(), block.texels.end(), static_cast<std::byte>(level));
                for (const std::byte b : block.draw()) ASSERT_EQ(static_cast<int>(b), level);
            }
        }
    });
}

TEST(PackedBlocks, PartsHaveTheBitsOfTheWholeAndStayWithinTheirRows) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    const test::GuardedMemory memory;
    test::on_every_instruction_set([&] {
        std::mt19937 random(kSeed);
        for (const PixelType type : {PixelType::uint8, PixelType::uint16, PixelType::half})
            for (const int channels : {3, 4}) {
                const Case block(type, channels, 64, 32, random);
                const std::vector<std::byte> whole = block.draw();
                for (int round = 0; round < 300; ++round) {
                    const int begin = static_cast<int>(random() % 64), row = static_cast<int>(random() % 32);
                    const int end =
                        begin + 1 + static_cast<int>(random() % (64U - static_cast<unsigned>(begin)));
                    const auto bytes = static_cast<std::size_t>((end - begin) * block.pixel_bytes());
                    // Against a page that must not be touched, behind or in front.
                    std::byte* to = round % 2 == 0 ? memory.last(bytes) : memory.first();
                    block.draw(begin, end, row, row + 1, to, 0);
                    EXPECT_EQ(std::memcmp(to, whole.data() + (row * 64 + begin) * block.pixel_bytes(), bytes),
                              0);
                }
            }
    });
}

TEST(PackedBlocks, TexelsAreReadNoFurtherThan64BytesBehindTheirRow) {
    std::mt19937 random(kSeed);
    const test::GuardedMemory memory(1 << 16);
    test::on_every_instruction_set([&] {
        for (const PixelType type : {PixelType::uint8, PixelType::uint16, PixelType::half})
            for (const int channels : {3, 4}) {
                Case block(type, channels, 64, 32, random);
                // The points all lie between the last two texels of the last two rows.
                std::fill(block.x.begin(), block.x.end(), kWidth - 1.0f);
                std::fill(block.y.begin(), block.y.end(), kHeight - 1.0f);
                std::byte* from = memory.last(block.texels.size());
                std::memcpy(from, block.texels.data(), block.texels.size());
                std::vector<std::byte> to(static_cast<std::size_t>(64 * 32 * block.pixel_bytes()));
                simd::draw_block(
                    {from, block.row_bytes(), type, channels, simd::Kernel::bilinear, &block.tap, 1},
                    {nullptr, 0, 64, 32, block.x.data(), block.y.data(), kRoom}, 0, 64, 0, 32, 1, type,
                    to.data(), 64 * block.pixel_bytes());
                simd::finish_stores();
                EXPECT_TRUE(to == block.draw());
            }
    });
}

TEST(PackedBlocks, PixelsWithGapsHaveTheSameBits) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    constexpr int kSize = 100, kGap = 5;
    for (const PixelType type : {PixelType::uint8, PixelType::uint16, PixelType::half}) {
        std::vector<std::byte> texels(static_cast<std::size_t>(256 * 128 * 3 * size_of(type)));
        for (std::byte& b : texels) b = static_cast<std::byte>(random() & 0x3f);
        const MemorySource source(
            packed_view(static_cast<const std::byte*>(texels.data()), type, 256, 128, 3));
        ReprojectOptions options;
        options.filter = Filter::bilinear;
        const auto view = reprojected_picture(Panorama(Chart(Projection::equirectangular, 256, 128),
                                                       Chart(Projection::rectilinear, kSize, kSize, 90)),
                                              options);
        const int pixel = 3 * size_of(type);
        std::vector<std::byte> packed(static_cast<std::size_t>(kSize * kSize * pixel)),
            apart(static_cast<std::size_t>(kSize * kSize * (pixel + kGap)));
        ImageView to = packed_view(apart.data(), type, kSize, kSize, 3);
        to.pixel_stride = pixel + kGap;
        to.row_stride = kSize * to.pixel_stride;
        ASSERT_TRUE(
            view.draw(&source, {0, 0, kSize, kSize}, packed_view(packed.data(), type, kSize, kSize, 3)));
        ASSERT_TRUE(view.draw(&source, {0, 0, kSize, kSize}, to));
        int wrong = 0;
        for (int i = 0; i < kSize * kSize; ++i)
            wrong += std::memcmp(packed.data() + i * pixel, apart.data() + i * to.pixel_stride,
                                 static_cast<std::size_t>(pixel)) != 0;
        EXPECT_EQ(wrong, 0);
    }
}

}  // namespace
}  // namespace anamorph::test_packed_blocks
