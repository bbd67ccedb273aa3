// SPDX-License-Identifier: Apache-2.0
// Texels that are infinite or no numbers count where they have weight, and nowhere else; and what is finite keeps its bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "anamorph/image/pixel.h"
#include "anamorph/image/point_sampler.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/image/summed_areas.h"
#include "anamorph/number/half.h"
#include "draw_map.h"
#include "each_instruction_set.h"
#include "function_map.h"

namespace anamorph::test_weightless {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
constexpr int kWidth = 150, kHeight = 90;

/// Random texels, and a few that are special, far from each other.
class Picture32 {
  public:
    Picture32(PixelType type, int channels, bool special) : m_type(type), m_channels(channels) {
        std::mt19937 random(7);
        std::uniform_real_distribution<float> uniform(-2, 2);
        m_bytes.resize(static_cast<std::size_t>(kWidth * kHeight * channels * size_of(type)));
        for (int i = 0; i < kWidth * kHeight * channels; ++i) put(i, uniform(random));
        if (!special) return;
        for (const auto& [x, y, value] : kSpecial)
            for (int c = 0; c < channels; c += 2) put((y * kWidth + x) * channels + c, value);
    }
    ConstImageView view() const {
        return packed_view<const std::byte>(m_bytes.data(), m_type, kWidth, kHeight, m_channels);
    }

    struct Special {
        int x, y;
        float value;
    };
    static constexpr Special kSpecial[] = {
        {30, 20, kNaN}, {70, 40, kInf}, {100, 60, -kInf}, {63, 63, kInf}, {0, 0, kInf}};

  private:
    void put(int i, float value) {
        store_channel(value, m_bytes.data() + std::ptrdiff_t{i} * size_of(m_type), m_type);
    }

    PixelType m_type;
    int m_channels;
    std::vector<std::byte> m_bytes;
};

std::vector<float> draw(const BlockMap& map, Filter filter, const ConstImageView& image, const Box& box,
                        PixelType to) {
    const MemorySource source(image);
    const Pyramid pyramid(source);
    const Border border(Chart(Projection::rectilinear, kWidth, kHeight), Wrap::clamp);
    const int values = box.width() * box.height() * image.channels;
    std::vector<std::byte> pixels(static_cast<std::size_t>(values * size_of(to)));
    EXPECT_TRUE(test::draw_map(map, border, filter, Output::color, &pyramid, box,
                               packed_view(pixels.data(), to, box.width(), box.height(), image.channels)));
    std::vector<float> result(static_cast<std::size_t>(values));
    load_channels(pixels.data(), to, values, result.data());
    return result;
}

bool same_bits(float a, float b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

/// May a filter read a special texel? Its pixel is computed another way then, without it, and rounded otherwise.
bool beside_special(int x, int y) {
    return std::any_of(std::begin(Picture32::kSpecial), std::end(Picture32::kSpecial),
                       [&](const auto& s) { return std::abs(s.x - x) <= 2 && std::abs(s.y - y) <= 2; });
}
bool near(float a, float b) {
    // A unit of half, or of the points' float.
    return std::fabs(a - b) <= 0x1p-9f;
}

/// How many texels either way have weight: 0 where the point is in the middle of one.
int reach_of(Filter filter, double shift) {
    return shift == 0 || filter == Filter::nearest ? 0 : is_cubic(filter) ? 2 : 1;
}

/// Draws the picture moved by `shift` of a texel to the left, and finds what is not finite where it has to be.
void check(Block::Kind kind, Filter filter, PixelType type, PixelType to, int channels, double shift) {
    SCOPED_TRACE(testing::Message() << "kind " << int(kind) << " filter " << int(filter) << " type "
                                    << int(type) << " to " << int(to) << " channels " << channels << " shift "
                                    << shift);
    const test::FunctionMap map(kWidth, kHeight, kind, [=](double x, double y) {
        return Point<double>{x + shift, y};
    });
    const Picture32 special(type, channels, true), plain(type, channels, false);
    const Box whole{0, 0, kWidth, kHeight};
    const std::vector<float> got = draw(map, filter, special.view(), whole, to);
    const std::vector<float> finite = draw(map, filter, plain.view(), whole, to);
    const int reach = reach_of(filter, shift);
    int wrong = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int c = 0; c < channels; ++c) {
                const auto i = static_cast<std::size_t>((y * kWidth + x) * channels + c);
                const Picture32::Special* hit = nullptr;
                for (const auto& s : Picture32::kSpecial) {
                    // Pixels whose points lie within the reach of the texel; the border repeats the first.
                    const int to_right = s.x - x;
                    const bool in_row = reach == 0 ? to_right == 0 : to_right > -reach && to_right <= reach;
                    if (c % 2 == 0 && y == s.y && in_row) hit = &s;
                }
                const bool fits =
                    !hit ? (beside_special(x, y) ? near(got[i], finite[i]) : same_bits(got[i], finite[i]))
                    : std::isnan(hit->value) ? std::isnan(got[i])
                    : is_cubic(filter)       ? !std::isfinite(got[i])
                                             : got[i] == hit->value;
                if (!fits && ++wrong < 5)
                    ADD_FAILURE() << x << "," << y << " channel " << c << ": " << got[i] << " in place of "
                                  << (hit ? hit->value : finite[i]);
            }
    // The same bits whatever part is asked for.
    const Box part{20, 11, 103, 71};
    const std::vector<float> cut = draw(map, filter, special.view(), part, to);
    for (int y = part.y0; y < part.y1; ++y)
        for (int k = 0; k < part.width() * channels; ++k) {
            const float whole_one = got[static_cast<std::size_t>((y * kWidth + part.x0) * channels + k)],
                        cut_one = cut[static_cast<std::size_t>((y - part.y0) * part.width() * channels + k)];
            ASSERT_TRUE(same_bits(whole_one, cut_one) || (std::isnan(whole_one) && std::isnan(cut_one)));
        }
}

TEST(Weightless, TexelsWithoutWeightDoNotCount) {
    using Kind = Block::Kind;
    for (const Kind kind : {Kind::polynomial, Kind::computed, Kind::exact})
        for (const Filter filter : {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic,
                                    Filter::antialias, Filter::pyramid})
            for (const PixelType type : {PixelType::float32, PixelType::half})
                for (const int channels : {1, 3, 4, 5})
                    for (const double shift : {0.0, 0.25}) check(kind, filter, type, type, channels, shift);
}

TEST(Weightless, OnEveryInstructionSet) {
    using Kind = Block::Kind;
    test::on_every_instruction_set([] {
        for (const Kind kind : {Kind::polynomial, Kind::exact})
            for (const Filter filter : {Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic})
                for (const PixelType type : {PixelType::float32, PixelType::half})
                    for (const int channels : {3, 4})
                        for (const PixelType to : {PixelType::float32, PixelType::half})
                            check(kind, filter, type, to, channels, 0.25);
    });
}

TEST(Weightless, SumsTellWhatIsInfinite) {
    const Picture32 picture(PixelType::float32, 3, true);
    const MemorySource source(picture.view());
    const SummedAreas sums(source);
    float pixel[3];
    for (const auto& [x, y, value] : Picture32::kSpecial) {
        for (const double off : {0.0, 1e-6, -1e-6}) {
            sums.mean(x + 0.5 + off, y + 0.5 + off, 1, 1, Wrap::clamp, pixel);
            EXPECT_TRUE(std::isnan(value) ? std::isnan(pixel[0]) : pixel[0] == value) << x << " " << pixel[0];
            EXPECT_TRUE(std::isfinite(pixel[1]));
            sums.mean(x + 1.5 + off, y + 0.5 + off, 1, 1, Wrap::clamp, pixel);
            EXPECT_TRUE(std::isfinite(pixel[0])) << x;
        }
        sums.mean(x + 0.5, y + 0.5, 5, 5, Wrap::clamp, pixel);
        EXPECT_TRUE(std::isnan(value) ? std::isnan(pixel[0]) : pixel[0] == value);
    }
    // Both of them in one.
    sums.mean(85, 50, 60, 60, Wrap::clamp, pixel);
    EXPECT_TRUE(std::isnan(pixel[0]));
    EXPECT_TRUE(std::isfinite(pixel[1]));
}

TEST(Weightless, SinglePointsTakeTheMiddleOfATexelThatIsAsNear) {
    const Picture32 picture(PixelType::float32, 3, true);
    const MemorySource source(picture.view());
    const Border border(Chart(Projection::rectilinear, kWidth, kHeight), Wrap::clamp);
    PointSampler sampler(source, border);
    float pixel[3];
    for (const Filter filter : {Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic})
        for (const double off : {0.0, 1e-9, -1e-9}) {
            ASSERT_TRUE(sampler.sample(filter, 0, 0, 70.5 + off, 40.5 - off, pixel));
            EXPECT_EQ(pixel[0], kInf);
            for (const int beside : {-1, 1}) {
                ASSERT_TRUE(sampler.sample(filter, 0, 0, 70.5 + off + beside, 40.5 - off, pixel));
                EXPECT_TRUE(std::isfinite(pixel[0])) << off;
            }
            ASSERT_TRUE(sampler.sample(filter, 0, 0, 69.51 + off, 40.5, pixel));
            EXPECT_FALSE(std::isfinite(pixel[0])) << off;
        }
}

/// Bits that stand for integers, denormal numbers, and numbers that are none, as they are.
TEST(Weightless, NearestMovesEveryBit) {
    std::mt19937 random(11);
    std::vector<std::uint32_t> ids(kWidth * kHeight * 3);
    for (std::uint32_t& id : ids) id = static_cast<std::uint32_t>(random());
    for (const std::uint32_t id :
         {0u, 1u, 16777217u, 4000000001u, 0x7f800001u, 0xff812345u, 0x80000000u, 0xffffffffu})
        ids[random() % ids.size()] = id;
    const auto image =
        packed_view(reinterpret_cast<const std::byte*>(ids.data()), PixelType::float32, kWidth, kHeight, 3);
    const MemorySource source(image);
    const Border border(Chart(Projection::rectilinear, kWidth, kHeight), Wrap::clamp);
    test::on_every_instruction_set([&] {
        for (const Block::Kind kind : {Block::Kind::polynomial, Block::Kind::computed, Block::Kind::exact}) {
            const test::FunctionMap map(kWidth, kHeight, kind, [](double x, double y) {
                return Point<double>{x, y};
            });
            std::vector<std::uint32_t> got(ids.size());
            ASSERT_TRUE(test::draw_map(map, border, Filter::nearest, Output::color, &source,
                                       {0, 0, kWidth, kHeight},
                                       packed_view(reinterpret_cast<std::byte*>(got.data()),
                                                   PixelType::float32, kWidth, kHeight, 3)));
            EXPECT_TRUE(got == ids) << int(kind);
        }
    });
    PointSampler sampler(source, border);
    float pixel[3];
    for (int x = 0; x < kWidth; ++x) {
        ASSERT_TRUE(sampler.sample(Filter::nearest, 0, 0, x + 0.5, 7.5, pixel));
        EXPECT_EQ(std::memcmp(pixel, &ids[static_cast<std::size_t>((7 * kWidth + x) * 3)], sizeof pixel), 0)
            << x;
    }
}

}  // namespace
}  // namespace anamorph::test_weightless
