// SPDX-License-Identifier: Apache-2.0
// Channels that hold no colour, and channels of several types: ids and depth are moved, never mixed, unless that is asked for.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "host.h"

namespace anamorph::test_channels {
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

/// A picture of colors and of ids of 32 bits, none of which float has. `types`: of each channel, or of all.
class IdsAmongColors : public InFolder {
  protected:
    static unsigned id_at(int x, int y, unsigned first = 0) {
        return 4000000001u + first + 2 * static_cast<unsigned>(y * kWidth + x);
    }
    static float color_at(int x, int y, int c) {
        return 0.125f * static_cast<float>((x * (c + 3) + y * 5) % 8);
    }
    static void write(const std::string& name, TypeDesc color, unsigned first = 0, int height = kHeight) {
        OIIO::ImageSpec spec(kWidth, height, 4, TypeDesc(TypeDesc::UINT32));
        spec.channelnames = {"R", "G", "B", "id"};
        spec.alpha_channel = -1;
        if (color != TypeDesc(TypeDesc::UINT32))
            spec.channelformats = {color, color, color, TypeDesc::UINT32};
        std::vector<std::byte> pixels;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < kWidth; ++x) {
                for (int c = 0; c < 3; ++c) {
                    const float value = color_at(x, y, c);
                    std::byte stored[8];
                    OIIO::convert_pixel_values(OIIO::TypeFloat, &value, color, stored, 1);
                    pixels.insert(pixels.end(), stored, stored + color.size());
                }
                const unsigned id = id_at(x, y, first);
                const auto* bytes = reinterpret_cast<const std::byte*>(&id);
                pixels.insert(pixels.end(), bytes, bytes + sizeof id);
            }
        const auto output = OIIO::ImageOutput::create(name);
        ASSERT_TRUE(output && output->open(name, spec) &&
                    output->write_image(OIIO::TypeUnknown, pixels.data()) && output->close());
    }
    /// The ids of a picture, by whatever calls a host makes.
    static std::vector<unsigned> ids_of(const std::string& name) {
        const auto input = open(name);
        if (!input) return {};
        EXPECT_EQ(input->spec().channelformat(3), TypeDesc(TypeDesc::UINT32)) << name;
        std::vector<unsigned> ids(input->spec().image_pixels());
        EXPECT_TRUE(input->read_image(0, 0, 3, 4, TypeDesc(TypeDesc::UINT32), ids.data()))
            << input->geterror();
        return ids;
    }
};

TEST_F(IdsAmongColors, KeepTheirBits) {
    write("half.exr", TypeDesc::HALF);
    write("float.exr", TypeDesc::FLOAT);
    write("whole.exr", TypeDesc(TypeDesc::UINT32));
    for (const std::string source : {"half.exr", "float.exr", "whole.exr"}) {
        SCOPED_TRACE(source);
        const std::string moved = source + ".map?u=x+2.25&v=y+1&filter=bilinear";
        for (const std::string keys : {"", "&tile=0", "&tile=16", "&alpha=1", "&concatenate=0"}) {
            const std::vector<unsigned> ids = ids_of(moved + keys);
            for (int y = 0; y + 1 < kHeight; ++y)
                for (int x = 0; x + 2 < kWidth; ++x)
                    ASSERT_EQ(ids[static_cast<std::size_t>(y * kWidth + x)], id_at(x + 2, y + 1))
                        << keys << " " << x << " " << y;
            // Beyond the edges there is none.
            EXPECT_EQ(ids.back(), 0u);
        }
        // Colors are mixed as ever.
        const std::vector<float> seen = read_floats(moved);
        for (int x = 0; x + 3 < kWidth; ++x)
            ASSERT_NEAR(seen[static_cast<std::size_t>(4 * x)],
                        0.75f * color_at(x + 2, 1, 0) + 0.25f * color_at(x + 3, 1, 0), 1e-3)
                << x;
        // Every id of any view is one that there is.
        for (const std::string view :
             {".pano?from=rectilinear&srcfov=60&fov=50&yaw=3&size=60x40", ".lens?lens=3de4:k1=-0.2",
              ".warp?mesh=grid.json", ".pano?from=rectilinear&srcfov=60&to=formula&size=40x24"}) {
            write_text("grid.json", R"({"columns": 1, "rows": 1, "units": "fractions", "vertices": [
                [0.1, 0.05], [0.9, 0], [0, 1], [1, 0.9]]})");
            int there = 0;
            for (const unsigned id : ids_of(source + view)) {
                if (id == 0) continue;
                ASSERT_GE(id, 4000000001u) << view;
                ASSERT_LT(id, id_at(0, kHeight)) << view;
                ASSERT_EQ(id % 2, 1u) << view;
                ++there;
            }
            EXPECT_GT(there, 100) << view;
        }
        // Through chains, joined or not.
        for (const std::string keys : {"", "concatenate=0&"}) {
            const std::vector<unsigned> ids =
                ids_of("v.map?u=x+0.25&v=y&" + keys + "src=(" + source + ".map?u=x+1.5&v=y)");
            for (int x = 0; x + 3 < kWidth; ++x)
                ASSERT_EQ(ids[static_cast<std::size_t>(5 * kWidth + x)], id_at(x + 2, 5)) << keys << x;
        }
    }
    // Films, eyes and written files.
    write_text("pan.json", R"({"interpolation": "linear", "keys": {"yaw": [[0, 0], [4, 8]]}})");
    const std::string view = "half.exr.pano?from=rectilinear&srcfov=60&fov=50&size=40x24";
    EXPECT_EQ(ids_of(view + "&keys=pan.json&frame=2"), ids_of(view + "&yaw=4"));
    EXPECT_EQ(ids_of("half.exr.pano?from=latlong&srcfov=180&stereo=side-by-side&eye=right&size=20x24&fov=90"),
              ids_of("right.exr.pano?from=latlong&srcfov=180&size=20x24&fov=90&src=(half.exr.map?u=x+20&v=y&"
                     "size=20x24)"));
    ASSERT_EQ(run("iconvert 'half.exr.map?u=x+2.25&v=y' out.exr").status, 0);
    EXPECT_EQ(ids_of("out.exr"), ids_of("half.exr.map?u=x+2.25&v=y"));
}

// Of two fisheyes that are mixed an id is that of the lens that counts more, and a project's crop is a part of its whole.
TEST_F(IdsAmongColors, OfFisheyesAndCroppedProjectsKeepTheirBits) {
    write("half.exr", TypeDesc::HALF, 0, kWidth / 2);
    const std::string view =
        "half.exr.pano?from=dual_fisheye&srcfov=200&to=equirectangular&size=60x30&seam=20";
    const std::vector<unsigned> mixed = ids_of(view), nearest = ids_of(view + "&filter=nearest");
    for (const unsigned id : mixed) ASSERT_TRUE(id >= id_at(0, 0) && id < id_at(0, kWidth / 2)) << id;
    EXPECT_EQ(mixed, nearest);
    const std::string project = "p f2 w64 h32 v360 S10,50,4,30\ni w" + std::to_string(kWidth) + " h" +
                                std::to_string(kWidth / 2) + " f0 v120 y0 p0 r0 n\"half.exr\"\n";
    write_text("part.pto", project);
    const std::vector<unsigned> part = ids_of("part.pto"), whole = ids_of("part.pto?size=64x32");
    ASSERT_EQ(part.size(), 40u * 26);
    ASSERT_EQ(whole.size(), 64u * 32);
    EXPECT_NE(part, std::vector<unsigned>(part.size()));
    for (std::size_t y = 0; y < 26; ++y)
        for (std::size_t x = 0; x < 40; ++x) ASSERT_EQ(part[y * 40 + x], whole[(y + 4) * 64 + x + 10]);
}

// Where pictures are blended, ids are those of the picture that counts most.
TEST_F(IdsAmongColors, OfMorphsAreOfTheGreaterWeight) {
    write("a.exr", TypeDesc::HALF);
    write("b.exr", TypeDesc::HALF, 100000);
    write("c.exr", TypeDesc::HALF, 200000);
    write_text("lines.json", R"({"features": [{"line": [[4, 4, 30, 6], [8, 2, 32, 10]]}]})");
    write_text("three.json", R"({"features": [{"line": [[4, 4, 30, 6], [8, 2, 32, 10], [6, 6, 28, 12]]}]})");
    const std::string two = "v.morph?a=a.exr&b=b.exr&features=lines.json&t=0.4";
    const std::vector<unsigned> of_a = ids_of(two + "&picture=a&filter=nearest"),
                                of_b = ids_of(two + "&picture=b&filter=nearest");
    EXPECT_NE(of_a, of_b);
    EXPECT_EQ(ids_of(two), of_a);
    EXPECT_EQ(ids_of(two + "&t_color=0.3"), of_a);
    EXPECT_EQ(ids_of(two + "&t_color=0.5"), of_a);
    EXPECT_EQ(ids_of(two + "&t_color=0.51"), of_b);
    EXPECT_EQ(ids_of(two + "&t_color=0.3&filter=nearest"), of_a);
    EXPECT_EQ(ids_of(two + "&t_color=0.7&output=lines"), of_b);
    const std::string three =
        "v.morph?a=a.exr&b=b.exr&c=c.exr&features=three.json&shape_weights=0.3,0.3,0.4&color_weights=";
    EXPECT_EQ(ids_of(three + "0.2,0.3,0.5"), ids_of(three + "0,0,1&picture=c&filter=nearest"));
    EXPECT_EQ(ids_of(three + "0.3,0.4,0.3"), ids_of(three + "0,1,0&picture=b&filter=nearest"));
    // Colors are blended, and ids too where that is asked for.
    const std::vector<float> blend = read_floats(two + "&t_color=0.3"), a = read_floats(two + "&picture=a"),
                             b = read_floats(two + "&picture=b");
    for (std::size_t i = 0; i + 3 < blend.size(); i += 4)
        ASSERT_NEAR(blend[i], 0.7f * a[i] + 0.3f * b[i], 2e-3) << i;
    EXPECT_NE(read_floats(two + "&t_color=0.3&data_channels=none"), blend);
}

TEST_F(IdsAmongColors, OfMosaicsAreOfTheNearestCircle) {
    // Each circle has a color of its own, so that the mixture tells the weights.
    OIIO::ImageSpec spec(96, 3 * 32, 4, OIIO::TypeFloat);
    spec.channelnames = {"R", "G", "B", "id"};
    spec.alpha_channel = -1;
    OIIO::ImageBuf rings(spec);
    for (int y = 0; y < spec.height; ++y)
        for (int x = 0; x < spec.width; ++x) {
            const float pixel[] = {y / 32 == 0 ? 1.0f : 0, y / 32 == 1 ? 1.0f : 0, y / 32 == 2 ? 1.0f : 0,
                                   static_cast<float>(1 + y * spec.width + x)};
            rings.setpixel(x, y, pixel);
        }
    write_image(rings, "rings.exr");
    const std::string view =
        "rings.exr.mosaic?circles=3&x=0.8&z=0.3&to=equirectangular&yaw=30&size=60x40&depth=3&wrap=clamp";
    const std::vector<float> seen = read_floats(view);
    std::vector<float> alone[3];
    for (int k = 0; k < 3; ++k)
        alone[k] = read_floats(view + "&filter=nearest&circle=" + std::to_string(k + 1));
    int counts[3] = {};
    for (std::size_t i = 0; i + 3 < seen.size(); i += 4) {
        const auto* const greatest = std::max_element(&seen[i], &seen[i] + 3);
        const auto k = static_cast<std::size_t>(greatest - &seen[i]);
        float others[3] = {seen[i], seen[i + 1], seen[i + 2]};
        std::sort(others, others + 3);
        if (others[2] - others[1] < 1e-4f) continue;  // as good as equal
        ASSERT_EQ(seen[i + 3], alone[k][i + 3]) << i / 4;
        ++counts[k];
    }
    EXPECT_GT(std::count_if(counts, counts + 3, [](int count) { return count > 20; }), 1);
    expect_one_picture(view, 5, 3);
}

TEST_F(IdsAmongColors, OfOpenShuttersAreOfTheFirstMoment) {
    write("a.exr", TypeDesc::HALF);
    write_text("pan.json", R"({"interpolation": "linear", "keys": {"yaw": [[0, 0], [4, 40]]}})");
    const std::string view = "a.exr.pano?from=rectilinear&srcfov=60&fov=50&size=40x24";
    EXPECT_EQ(ids_of(view + "&keys=pan.json&frame=2&shutter=0.5&samples=4"), ids_of(view + "&yaw=18.125"));
}

TEST_F(IdsAmongColors, OfDrapesAreOfWhatIsSeenInTheMiddle) {
    write("a.exr", TypeDesc::HALF);
    write("back.exr", TypeDesc::HALF, 100000);
    write("behind.exr", TypeDesc::HALF, 200000);
    const std::string drape = "v.drape?src=a.exr&surface=cylinder&angle=300&camera=0.4,0.5,2.4&size=40x24";
    const std::vector<unsigned> bare = ids_of(drape + "&filter=nearest");
    const std::vector<float> seen = read_floats(drape + "&output=seen");
    EXPECT_GT(std::count(bare.begin(), bare.end(), 0u), 50);
    EXPECT_GT(std::count_if(bare.begin(), bare.end(), [](unsigned id) { return id % 2 == 1; }), 200);
    for (std::size_t i = 0; i < bare.size(); ++i) ASSERT_EQ(bare[i] != 0, seen[i] != 0) << i;
    for (const std::string keys : {"", "&shading=phong", "&alpha=1", "&filter=pyramid"})
        EXPECT_EQ(ids_of(drape + keys), bare) << keys;
    // The machine of 1987 mixes none either, whatever their type.
    ASSERT_EQ(run("oiiotool a.exr -d float -o floats.exr").status, 0);
    const std::vector<float> all = read_floats("floats.exr"),
                             by_blocks = read_floats(
                                 "v.drape?src=floats.exr&scheme=hardware&size=40x24"
                                 "&surface=cylinder&angle=120&data_channels=id");
    for (std::size_t i = 3; i < by_blocks.size(); i += 4) {
        bool is_there = by_blocks[i] == 0;
        for (std::size_t k = 3; k < all.size() && !is_there; k += 4) is_there = by_blocks[i] == all[k];
        ASSERT_TRUE(is_there) << i;
    }
    // With pictures on the far side and behind, in float: as near as that has them.
    write("small.exr", TypeDesc::HALF);
    const auto float_ids = [&](const std::string& keys) {
        const std::vector<float> pixels = read_floats(drape + keys);
        std::vector<float> ids;
        for (std::size_t i = 3; i < pixels.size(); i += 4) ids.push_back(pixels[i]);
        return ids;
    };
    const std::vector<float> behind = float_ids("&shading=phong&backdrop=behind.exr"),
                             nothing = float_ids("&filter=nearest&data_channels=none");
    const std::vector<float> stored = read_floats("behind.exr");
    for (std::size_t i = 0; i < behind.size(); ++i)
        ASSERT_FLOAT_EQ(behind[i], seen[i] != 0 ? nothing[i] : stored[4 * i + 3]) << i;
    EXPECT_EQ(float_ids("&shading=phong&back=back.exr"),
              float_ids("&filter=nearest&back=back.exr&data_channels=none"));
}

TEST_F(Channels, AreNamedWhereTheyAreNotKnown) {
    EXPECT_THAT(open_error(kHalfway + "&data_channels=Q"),
                HasSubstr("must be none, or some of the source's channels, R, G, B, A, Z, grid, objectId"));
    EXPECT_THAT(open_error(kHalfway + "&data_channels="), HasSubstr("data_channels"));
    EXPECT_THAT(open_error(kHalfway + "&data_channels=Z,"), HasSubstr("data_channels"));
    EXPECT_THAT(open_error(kHalfway + "&data_filter=cubic"), HasSubstr("data_filter"));
}

}  // namespace
}  // namespace anamorph::test_channels
