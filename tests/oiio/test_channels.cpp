// SPDX-License-Identifier: Apache-2.0
// Channels that hold no colour, and channels of several types: ids and depth are moved, never mixed, unless that is asked for.
#include <cmath>
#include <cstring>

#include "host.h"

namespace anamorph {
namespace {

using namespace testing_oiio;
using OIIO::TypeDesc;
using testing::HasSubstr;

constexpr int kWidth = 40, kHeight = 24;
// In the order in which OpenImageIO reads them.
const std::vector<std::string> kNames = {
    "R", "G", "B", "A", "Z", "grid", "objectId", "CryptoObject00.R", "CryptoObject00.G"};
const std::vector<TypeDesc> kTypes = {TypeDesc::HALF,  TypeDesc::HALF,  TypeDesc::HALF,
                                      TypeDesc::HALF,  TypeDesc::FLOAT, TypeDesc::HALF,
                                      TypeDesc::FLOAT, TypeDesc::FLOAT, TypeDesc::FLOAT};

float value_at(int x, int y, int c) {
    if (c == 3) return 1;
    if (c == 4) return 1000.5f + static_cast<float>(x * 7 % 13) + 0.001f * static_cast<float>(y);
    if (c == 6) return static_cast<float>(16000001 + x * 31 + y);
    // Ids of Cryptomatte are bits that are floats by chance.
    if (c == 7) return std::ldexp(1.0f + static_cast<float>(x * 57 % 101) / 128, (y * 37 + x) % 60 - 30);
    return 0.25f * static_cast<float>((x * (c + 3) + y * 5) % 8);
}

class Channels : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        OIIO::ImageSpec spec(kWidth, kHeight, static_cast<int>(kNames.size()), OIIO::TypeFloat);
        spec.channelnames = kNames;
        spec.channelformats = kTypes;
        spec.alpha_channel = 3;
        spec.z_channel = 4;
        spec.attribute("cryptomatte/89abcde/name", "CryptoObject");
        std::vector<float> values;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                for (int c = 0; c < spec.nchannels; ++c) values.push_back(value_at(x, y, c));
        const auto output = OIIO::ImageOutput::create("render.exr");
        ASSERT_TRUE(output && output->open("render.exr", spec) &&
                    output->write_image(OIIO::TypeFloat, values.data()));
    }
};

float of(const std::vector<float>& pixels, int x, int y, int c) {
    return pixels[(static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)) * kNames.size() +
                  static_cast<std::size_t>(c)];
}
bool is_data(int c) {
    return c == 4 || c >= 6;
}

const std::string kHalfway = "render.exr.map?u=x+0.25&v=y&filter=bilinear";

TEST_F(Channels, IdsAndDepthAreMovedAndColorsAreMixed) {
    const std::vector<float> seen = read_floats(kHalfway);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x + 1 < kWidth; ++x)
            for (int c = 0; c < static_cast<int>(kNames.size()); ++c) {
                const float here = value_at(x, y, c), mixed = 0.75f * here + 0.25f * value_at(x + 1, y, c);
                ASSERT_NEAR(of(seen, x, y, c), is_data(c) ? here : mixed, is_data(c) ? 0 : 1e-3)
                    << x << " " << y << " " << kNames[static_cast<std::size_t>(c)];
            }
    for (const std::string recipe : {"render.exr.pano?from=rectilinear&srcfov=60&fov=50&yaw=3&size=40x24",
                                     "render.exr.lens?lens=3de4:k1=-0.1",
                                     "render.exr.pano?from=rectilinear&srcfov=60&to=formula&size=40x24"}) {
        SCOPED_TRACE(recipe);
        const std::vector<float> all = read_floats(recipe), moved = read_floats(recipe + "&filter=nearest");
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                for (const int c : {4, 6, 7, 8})
                    ASSERT_EQ(of(all, x, y, c), of(moved, x, y, c)) << x << " " << y;
    }
}

TEST_F(Channels, AreMixedWhereThatIsAskedFor) {
    const std::vector<float> mixed = read_floats(kHalfway + "&data_filter=bilinear"),
                             all_color = read_floats(kHalfway + "&data_channels=none"),
                             some = read_floats(kHalfway + "&data_channels=R,grid");
    EXPECT_EQ(mixed, all_color);
    for (int x = 0; x + 1 < kWidth; ++x) {
        EXPECT_NEAR(of(mixed, x, 3, 4), 0.75f * value_at(x, 3, 4) + 0.25f * value_at(x + 1, 3, 4), 1e-3);
        EXPECT_EQ(of(some, x, 3, 0), value_at(x, 3, 0));
        EXPECT_EQ(of(some, x, 3, 5), value_at(x, 3, 5));
        EXPECT_EQ(of(some, x, 3, 4), of(mixed, x, 3, 4));
    }
}

TEST_F(Channels, KeepTheirTypes) {
    for (const std::string keys : {"", "&tile=0", "&mip=1"}) {
        SCOPED_TRACE(keys);
        const auto input = open(kHalfway + keys);
        ASSERT_TRUE(input);
        EXPECT_EQ(input->spec().channelformats, kTypes);
        EXPECT_EQ(input->spec().channelnames, kNames);
    }
    ASSERT_EQ(run("iconvert '" + kHalfway + "' out.exr").status, 0);
    EXPECT_EQ(open("out.exr")->spec().channelformats, kTypes);
    EXPECT_EQ(read_floats("out.exr"), read_floats(kHalfway));
    // Any part of any channels, in tiles and in rows.
    const auto input = open(kHalfway + "&tile=16");
    const std::vector<float> whole = read_floats(kHalfway);
    std::vector<float> part(static_cast<std::size_t>(2 * kWidth * kHeight));
    ASSERT_TRUE(input->read_image(0, 0, 4, 6, OIIO::TypeFloat, part.data()));
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            for (int c = 0; c < 2; ++c)
                ASSERT_EQ(part[static_cast<std::size_t>((y * kWidth + x) * 2 + c)], of(whole, x, y, 4 + c))
                    << x << " " << y;
}

// A chain moves them through all its maps.
TEST_F(Channels, GoThroughChains) {
    const std::string chain =
        "v.map?u=x+0.25&v=y&filter=bilinear&src=(render.exr.map?u=x+1.5&v=y&filter=bilinear)";
    EXPECT_EQ(open(chain)->spec().get_string_attribute("anamorph:chain"), "map of map");
    const std::vector<float> seen = read_floats(chain);
    for (int x = 0; x + 3 < kWidth; ++x)
        for (const int c : {4, 6, 7, 8}) EXPECT_EQ(of(seen, x, 5, c), value_at(x + 2, 5, c)) << x;
}

// OpenImageIO takes the last channel of a layer for alpha where a file has no other.
TEST_F(Channels, CryptomatteHasNoAlpha) {
    OIIO::ImageSpec spec(kWidth, kHeight, 7, OIIO::TypeFloat);
    spec.channelnames = {
        "R", "G", "B", "uCrypto00.red", "uCrypto00.green", "uCrypto00.blue", "uCrypto00.alpha"};
    spec.attribute("cryptomatte/89abcde/name", "uCrypto");
    OIIO::ImageBuf image(spec);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            float pixel[7];
            for (int c = 0; c < 7; ++c) pixel[c] = 0.1f * static_cast<float>((x * (c + 2) + y) % 9);
            image.setpixel(x, y, pixel);
        }
    write_image(image, "crypto.exr");
    const std::string moved = "crypto.exr.map?u=x+0.25&v=y&filter=bilinear";
    const std::vector<float> seen = read_floats(moved), alpha = read_floats(moved + "&alpha=1");
    const std::vector<float> stored = read_floats("crypto.exr");
    ASSERT_EQ(alpha.size() / 8, seen.size() / 7);
    for (std::size_t i = 0; i + 1 < static_cast<std::size_t>(kWidth); ++i)
        for (std::size_t c = 3; c < 7; ++c) EXPECT_EQ(seen[7 * i + c], stored[7 * i + c]) << i << " " << c;
}

// A picture of nothing but ids is only moved: all its bits stay.
TEST_F(Channels, OfIdsAloneKeepTheirBits) {
    OIIO::ImageSpec spec(kWidth, kHeight, 1, OIIO::TypeUInt32);
    spec.channelnames = {"id"};
    std::vector<unsigned> ids;
    for (unsigned i = 0; i < static_cast<unsigned>(kWidth * kHeight); ++i)
        ids.push_back(i % 3 == 0 ? i : 4000000001u + i);
    const auto output = OIIO::ImageOutput::create("ids.exr");
    ASSERT_TRUE(output && output->open("ids.exr", spec) &&
                output->write_image(OIIO::TypeUInt32, ids.data()) && output->close());
    for (const std::string recipe : {"ids.exr.map?u=x&v=y", "ids.exr.lens?lens=3de4:k1=0"}) {
        const Pixels seen = read_pixels(recipe);
        EXPECT_EQ(seen.spec.format, OIIO::TypeUInt32);
        std::vector<unsigned> found(seen.bytes.size() / sizeof(unsigned));
        std::memcpy(found.data(), seen.bytes.data(), seen.bytes.size());
        EXPECT_EQ(found, ids) << recipe;
    }
    EXPECT_EQ(read_pixels("ids.exr.map?u=x&v=y&data_channels=none").spec.format, OIIO::TypeFloat);
}

TEST_F(Channels, AreNamedWhereTheyAreNotKnown) {
    EXPECT_THAT(open_error(kHalfway + "&data_channels=Q"),
                HasSubstr("must be none, or some of the source's channels, R, G, B, A, Z, grid, objectId"));
    EXPECT_THAT(open_error(kHalfway + "&data_channels="), HasSubstr("data_channels"));
    EXPECT_THAT(open_error(kHalfway + "&data_channels=Z,"), HasSubstr("data_channels"));
    EXPECT_THAT(open_error(kHalfway + "&data_filter=cubic"), HasSubstr("data_filter"));
}

}  // namespace
}  // namespace anamorph
