// SPDX-License-Identifier: Apache-2.0
// Values that float does not hold: what is only moved (filter=nearest) keeps every bit of integers of 32 bits and of doubles,
// whatever the operation, the file and the host.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>

#include <cstring>

#include "anamorph/oiio_ops.h"
#include "host.h"

namespace anamorph::test_stored_values {
namespace {

using namespace testing_oiio;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::TypeDesc;
using testing::HasSubstr;

constexpr int kWidth = 64, kHeight = 32;

/// A number for each pixel, none of which float holds, of so many bits.
template <class T>
T id_of(int i) {
    if constexpr (std::is_same_v<T, double>) return 1.0 / 3 + i * 1.000000001;
    const std::uint64_t id = i == 5   ? 4000000001u
                             : i == 6 ? 0x7f800001u
                                      : 16777217u + 2u * static_cast<unsigned>(i);
    return static_cast<T>(sizeof(T) == 2 ? 3 * i - 3000 : id);
}

template <class T>
ImageBuf ids(TypeDesc type, int channels) {
    ImageBuf image(ImageSpec(kWidth, kHeight, channels, type));
    auto* to = static_cast<T*>(image.localpixels());
    for (int i = 0; i < kWidth * kHeight; ++i)
        for (int c = 0; c < channels; ++c) *to++ = id_of<T>(i + 7 * c);
    return image;
}

/// Of each pixel its number, which float holds.
ImageBuf numbers(int channels) {
    ImageBuf image(ImageSpec(kWidth, kHeight, channels, OIIO::TypeFloat));
    auto* to = static_cast<float*>(image.localpixels());
    for (int i = 0; i < kWidth * kHeight; ++i)
        for (int c = 0; c < channels; ++c) *to++ = static_cast<float>(i + 1);
    return image;
}

const char* const kGrid = R"({"columns": 2, "rows": 2, "units": "fractions", "vertices": [
    [0, 0], [0.5, 0], [1, 0],  [0, 0.5], [0.61, 0.42], [1, 0.5],  [0, 1], [0.5, 1], [1, 1]]})";

class StoredValues : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_text("grid.json", kGrid);
        write_text("lines.csv", "8,8,50,12,12,10,44,20\n");
    }
    static void write(ImageBuf image, const std::string& name, int tile) {
        image.set_write_tiles(tile, tile);
        ASSERT_TRUE(image.write(name)) << image.geterror();
    }

    /// Recipes of every operation that reads an image, of one that has `name`.
    static std::vector<std::string> recipes(const std::string& name) {
        const std::string nearest = "&filter=nearest";
        return {
            name + ".pano?from=equirectangular&to=equirectangular&size=64x32" + nearest,
            name + ".pano?from=equirectangular&yaw=30&pitch=40&size=70x50" + nearest,
            name + ".pano?from=equirectangular&yaw=30&pitch=40&size=70x50&tol=0&tile=16" + nearest,
            name + ".pano?from=fisheye&to=rectilinear&size=50x40&tile=0" + nearest,
            name + ".pano?from=rectilinear&to=fisheye&srcfov=100&fov=300&wrap=mirror&size=500x400" + nearest,
            name + ".lens?lens=ptlens:b=-0.05" + nearest,
            name + ".warp?mesh=grid.json&size=130x70" + nearest,
            name + ".mosaic?circles=2&circle=2&size=40x30&from=equirectangular" + nearest,
            name + ".drape?surface=cylinder&angle=120" + nearest,
            name + ".morph?b=" + name + "&features=lines.csv&t=1" + nearest,
            name + ".morph?b=" + name + "&features=lines.csv&shape_weights=0.5,0.5&color_weights=1,0" +
                nearest,
            "outer.warp?mesh=grid.json&filter=nearest&src=" + name +
                ".lens?lens=ptlens:b=-0.05&filter=nearest"};
    }

    /// Each pixel of a recipe against that of the same recipe of numbers.
    template <class T>
    void check(const std::string& name, TypeDesc type, int channels) {
        write(numbers(channels), "numbers.exr", 0);
        const std::vector<std::string> own = recipes(name), of_numbers = recipes("numbers.exr");
        for (std::size_t k = 0; k < own.size(); ++k) {
            SCOPED_TRACE(own[k]);
            const Pixels got = read_pixels(own[k]);
            const std::vector<float> number = read_floats(of_numbers[k]);
            ASSERT_EQ(got.spec.format, type);
            ASSERT_EQ(got.bytes.size(), number.size() * sizeof(T));
            std::size_t seen = 0, wrong = 0;
            for (std::size_t i = 0; i < number.size(); ++i) {
                T value;
                std::memcpy(&value, got.bytes.data() + i * sizeof(T), sizeof(T));
                const int pixel = static_cast<int>(number[i]), c = static_cast<int>(i) % channels;
                seen += pixel > 0;
                wrong += value != (pixel > 0 ? id_of<T>(pixel - 1 + 7 * c) : T(0));
            }
            EXPECT_EQ(wrong, 0u);
            EXPECT_GT(seen, number.size() / 20);
        }
    }
};

TEST_F(StoredValues, EveryOperationMovesEveryBit) {
    for (const int tile : {0, 16}) {
        write(ids<std::uint32_t>(TypeDesc::UINT32, 1), "u.tif", tile);
        check<std::uint32_t>("u.tif", TypeDesc::UINT32, 1);
    }
}

TEST_F(StoredValues, OfEveryTypeThatFilesHave) {
    write(ids<std::uint32_t>(TypeDesc::UINT32, 3), "u.exr", 16);
    check<std::uint32_t>("u.exr", TypeDesc::UINT32, 3);
    write(ids<std::int32_t>(TypeDesc::INT32, 2), "i.tif", 0);
    check<std::int32_t>("i.tif", TypeDesc::INT32, 2);
    // OpenImageIO 2.4 does not read back the doubles that it writes to tiles.
    write(ids<double>(TypeDesc::DOUBLE, 3), "d.tif", 0);
    check<double>("d.tif", TypeDesc::DOUBLE, 3);
    write(ids<std::int16_t>(TypeDesc::INT16, 1), "s.tif", 0);
    check<std::int16_t>("s.tif", TypeDesc::INT16, 1);
}

/// Other filters compute with them, in float.
TEST_F(StoredValues, WhatIsComputedIsFloat) {
    write(ids<std::uint32_t>(TypeDesc::UINT32, 1), "u.tif", 0);
    for (const char* recipe :
         {"u.tif.pano?from=fisheye&filter=bilinear&size=8", "u.tif.pano?from=fisheye&size=8",
          "u.tif.morph?b=u.tif&features=lines.csv&filter=nearest",
          "u.tif.morph?b=u.tif&features=lines.csv&filter=nearest&frames=3",
          "u.tif.drape?filter=nearest&shading=phong"})
        EXPECT_EQ(read_pixels(recipe).spec.format, OIIO::TypeFloat) << recipe;
}

TEST_F(StoredValues, ChannelsOfSeveralTypesStayTheirs) {
    ImageSpec spec(kWidth, kHeight, 4, OIIO::TypeFloat);
    spec.channelnames = {"R", "G", "B", "id"};
    spec.channelformats = {TypeDesc::HALF, TypeDesc::HALF, TypeDesc::HALF, TypeDesc::UINT32};
    struct Packed {
        std::uint16_t color[3];
        std::uint16_t id[2];
    };
    std::vector<Packed> pixels(kWidth * kHeight);
    for (int i = 0; i < kWidth * kHeight; ++i) {
        auto& p = pixels[static_cast<std::size_t>(i)];
        for (int c = 0; c < 3; ++c) p.color[c] = static_cast<std::uint16_t>(0x3800 + i % 0x400 + c);
        const auto id = id_of<std::uint32_t>(i);
        std::memcpy(p.id, &id, sizeof id);
    }
    auto out = OIIO::ImageOutput::create("mixed.exr");
    ASSERT_TRUE(out->open("mixed.exr", spec)) << out->geterror();
    ASSERT_TRUE(out->write_image(TypeDesc::UNKNOWN, pixels.data())) << out->geterror();
    out->close();
    // EXR files have their channels in the order of the alphabet, and readers put R, G, B in front.
    const auto stored = open("mixed.exr"),
               moved = open("mixed.exr.lens?lens=ptlens:c=0.000001&filter=nearest");
    ASSERT_TRUE(stored && moved);
    EXPECT_EQ(moved->spec().channelformats, stored->spec().channelformats);
    const std::size_t bytes = stored->spec().image_bytes(true);
    ASSERT_EQ(moved->spec().image_bytes(true), bytes);
    std::vector<std::byte> a(bytes), b(bytes);
    ASSERT_TRUE(stored->read_image(0, 0, 0, 4, TypeDesc::UNKNOWN, a.data()));
    ASSERT_TRUE(moved->read_image(0, 0, 0, 4, TypeDesc::UNKNOWN, b.data())) << moved->geterror();
    EXPECT_TRUE(a == b);
}

TEST_F(StoredValues, StockProgramsWriteThem) {
    write(ids<std::uint32_t>(TypeDesc::UINT32, 1), "u.tif", 0);
    const std::string recipe =
        "'u.tif.pano?from=equirectangular&to=equirectangular&size=64x32&filter=nearest'";
    for (const std::string& command :
         {"oiiotool --native " + recipe + " -o out.tif", "iconvert " + recipe + " out.tif",
          "oiiotool --native " + recipe + " -o out.exr && oiiotool --native out.exr -o out.tif"}) {
        SCOPED_TRACE(command);
        const Ran ran = run(command);
        ASSERT_EQ(ran.status, 0) << ran.text;
        EXPECT_TRUE(read_pixels("out.tif") == read_pixels("u.tif"));
    }
}

TEST_F(StoredValues, ImagesInMemoryToo) {
    const ImageBuf source = ids<std::uint32_t>(TypeDesc::UINT32, 3);
    const auto o = options({{"from", "fisheye"}, {"filter", "nearest"}, {"size", "40x30"}, {"yaw", "10"}});
    const ImageBuf made = reproject(source, o);
    ASSERT_FALSE(made.has_error()) << made.geterror();
    EXPECT_EQ(made.spec().format, TypeDesc(TypeDesc::UINT32));
    write(source, "u.tif", 0);
    EXPECT_EQ(bytes(made), read_pixels("u.tif.pano?from=fisheye&filter=nearest&size=40x30&yaw=10").bytes);
    // Into a part of another image, and into one of doubles.
    ImageBuf part(ImageSpec(40, 30, 3, TypeDesc::UINT32));
    ASSERT_TRUE(reproject(part, source, o, OIIO::ROI(5, 25, 3, 20, 0, 1, 1, 3))) << part.geterror();
    for (const auto& [x, y] : {std::pair{5, 3}, {24, 19}, {13, 9}}) {
        const auto* a = static_cast<const std::uint32_t*>(made.pixeladdr(x, y));
        const auto* b = static_cast<const std::uint32_t*>(part.pixeladdr(x, y));
        EXPECT_EQ(b[0], 0u);
        EXPECT_EQ(a[1], b[1]);
        EXPECT_EQ(a[2], b[2]);
    }
}

}  // namespace
}  // namespace anamorph::test_stored_values
