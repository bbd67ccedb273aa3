// SPDX-License-Identifier: Apache-2.0
// What OpenImageIO expects of any input, asked of the recipe's: conformance items 2 to 14.
#include <OpenImageIO/imagecache.h>
#include <sys/stat.h>

#include <filesystem>
#include <random>
#include <thread>

#include "host.h"

namespace anamorph::test_conformance_input {
namespace {

using namespace testing_oiio;
using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class InputConformance : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("city.exr", 256, 128);
    }
};

const std::string kView = "city.exr.pano?yaw=30&pitch=10&size=150x100";

TEST_F(InputConformance, conformance_02_version_and_extensions_are_listed) {
    std::string extensions = "anamorph_recipes:";
    for (const Operation* operation : operations()) extensions += operation->name + ",";
    EXPECT_THAT(OIIO::get_string_attribute("extension_list"), HasSubstr(extensions + "anabuf"));
    EXPECT_THAT(OIIO::get_string_attribute("library_list"), HasSubstr("anamorph_recipes:Anamorph "));
    EXPECT_THAT(OIIO::get_string_attribute("input_format_list"), HasSubstr("anamorph_recipes"));
    EXPECT_THAT(OIIO::get_string_attribute("output_format_list"), HasSubstr("anamorph_recipes"));
}

TEST_F(InputConformance, conformance_03_valid_file_knows_names_without_reading) {
    const auto input = ImageInput::create("anamorph_recipes");
    ASSERT_TRUE(input) << OIIO::geterror();
    // Opening a pipe would wait for ever.
    ASSERT_EQ(::mkfifo("pipe.exr", 0600), 0);
    ASSERT_EQ(::mkfifo("pipe.pano", 0600), 0);
    for (const char* name :
         {"pipe.exr", "city.exr", "pano", ".pano", "a.pano.exr", "a.panox", "", "a.exr?src=b.pano"})
        EXPECT_FALSE(input->valid_file(name)) << name;
    for (const char* name : {"pipe.pano", "a.pano", "a.PaNo?x=1", "a.anabuf"})
        EXPECT_TRUE(input->valid_file(name)) << name;
}

TEST_F(InputConformance, conformance_04_upper_case_extension) {
    const Pixels lower = read_pixels(kView);
    EXPECT_EQ(read_pixels("city.exr.PANO?yaw=30&pitch=10&size=150x100"), lower);
    write_text("VIEW.PANO", "src=city.exr\nyaw=30\npitch=10\nsize=150x100\n");
    EXPECT_EQ(read_pixels("VIEW.PANO"), lower);
}

TEST_F(InputConformance, conformance_05_open_close_reopen_destroy) {
    const auto input = ImageInput::create("anamorph_recipes");
    ASSERT_TRUE(input);
    EXPECT_TRUE(input->close());
    ImageSpec spec;
    const Pixels expected = read_pixels(kView);
    for (int i = 0; i < 3; ++i) {
        ASSERT_TRUE(input->open(kView, spec)) << input->geterror();
        EXPECT_EQ(input->current_subimage(), 0);
        EXPECT_EQ(input->current_miplevel(), 0);
        EXPECT_EQ(spec.width, 150);
        std::vector<std::byte> pixels(spec.image_bytes());
        ASSERT_TRUE(input->read_image(0, 0, 0, 3, spec.format, pixels.data())) << input->geterror();
        EXPECT_EQ(pixels, expected.bytes);
        EXPECT_TRUE(input->close());
        EXPECT_TRUE(input->close());
        EXPECT_FALSE(input->read_scanline(0, 0, TypeDesc::FLOAT, pixels.data()));
        input->geterror();
    }
    // Open over an open one, and a failing open after a good one.
    ASSERT_TRUE(input->open(kView, spec));
    ASSERT_TRUE(input->open("city.exr.pano?size=8", spec));
    EXPECT_EQ(spec.width, 8);
    EXPECT_FALSE(input->open("city.exr.pano?size=none", spec));
    EXPECT_THAT(input->geterror(), HasSubstr("size=none"));
    ImageInput::create("anamorph_recipes");
    ASSERT_TRUE(ImageInput::create("anamorph_recipes")->open(kView, spec));
}

TEST_F(InputConformance, conformance_06_config_and_name_agree) {
    ImageSpec config;
    config.attribute("pano:yaw", 30.0f);
    config.attribute("pano:pitch", 10);
    config.attribute("pano:tol", 0.01f);
    const int size[] = {150, 100};
    config.attribute("pano:size", TypeDesc(TypeDesc::INT, 2), size);
    config.attribute("other:thing", "ignored");
    auto input = ImageInput::open("city.exr.pano?yaw=99", &config);
    ASSERT_TRUE(input) << OIIO::geterror();
    std::vector<std::byte> pixels(input->spec().image_bytes());
    ASSERT_TRUE(input->read_image(0, 0, 0, 3, input->spec().format, pixels.data()));
    EXPECT_EQ(pixels, read_pixels(kView).bytes);

    config.attribute("pano:jaw", 1);
    EXPECT_FALSE(ImageInput::open("city.exr.pano", &config));
    EXPECT_THAT(OIIO::geterror(), AllOf(HasSubstr("jaw=1"), HasSubstr("must be one of src, from")));
    EXPECT_THAT(open_error("city.exr.pano?jaw=1"),
                AllOf(HasSubstr("jaw=1"), HasSubstr("must be one of src, from")));
}

TEST_F(InputConformance, conformance_07_every_way_to_read_gives_the_same_bits) {
    for (const TypeDesc type : {TypeDesc::UINT8, TypeDesc::UINT16, TypeDesc::HALF, TypeDesc::FLOAT}) {
        SCOPED_TRACE(type.c_str());
        const std::string source = type == TypeDesc::UINT8 || type == TypeDesc::UINT16 ? "s.tif" : "s.exr";
        write_panorama(source, 256, 128, type, 4);
        const std::string arguments = ".pano?yaw=30&pitch=80&size=150x100&tile=";
        for (const char* tile : {"32", "0", "48x16"}) {
            SCOPED_TRACE(tile);
            const auto input = open(source + arguments + tile);
            ASSERT_TRUE(input);
            const ImageSpec spec = input->spec();
            ASSERT_EQ(spec.format, type);
            const std::size_t pixel = spec.pixel_bytes(), row = pixel * 150;
            std::vector<std::byte> whole(spec.image_bytes()), other(whole.size());
            ASSERT_TRUE(input->read_image(0, 0, 0, 4, type, whole.data())) << input->geterror();
            if (spec.tile_width == 0) {
                for (int y = 99; y >= 0; --y)
                    ASSERT_TRUE(input->read_scanline(y, 0, type, &other[static_cast<std::size_t>(y) * row]));
                EXPECT_EQ(other, whole);
                std::fill(other.begin(), other.end(), std::byte{7});
                for (int y = 0; y < 100; y += 30)
                    ASSERT_TRUE(input->read_scanlines(0, 0, y, std::min(100, y + 30), 0, 0, 4, type,
                                                      &other[static_cast<std::size_t>(y) * row]));
                EXPECT_EQ(other, whole);
                continue;
            }
            // Tiles one by one, into the image, edges cut by hand.
            const int tw = spec.tile_width, th = spec.tile_height;
            std::vector<std::byte> buffer(static_cast<std::size_t>(tw * th) * pixel);
            for (int y = 0; y < 100; y += th)
                for (int x = 0; x < 150; x += tw) {
                    ASSERT_TRUE(input->read_tile(x, y, 0, type, buffer.data())) << input->geterror();
                    for (int j = y; j < std::min(100, y + th); ++j)
                        std::copy_n(
                            &buffer[static_cast<std::size_t>((j - y) * tw) * pixel],
                            static_cast<std::size_t>(std::min(150, x + tw) - x) * pixel,
                            &other[static_cast<std::size_t>(j) * row + static_cast<std::size_t>(x) * pixel]);
                }
            EXPECT_EQ(other, whole);
            std::fill(other.begin(), other.end(), std::byte{7});
            ASSERT_TRUE(input->read_tiles(0, 0, 0, 150, 0, 100, 0, 1, 0, 4, type, other.data()))
                << input->geterror();
            EXPECT_EQ(other, whole);
        }
    }
}

TEST_F(InputConformance, conformance_08_edge_tiles_have_full_buffers) {
    const auto input = open("city.exr.pano?size=100x70&tile=64");
    ASSERT_TRUE(input);
    const std::vector<float> whole = read_floats("city.exr.pano?size=100x70&tile=64");
    for (const auto& [x, y] : {std::pair{64, 0}, {0, 64}, {64, 64}}) {
        // Exactly one tile: an address sanitizer sees what is written beyond.
        const auto tile = std::make_unique<float[]>(64 * 64 * 3);
        ASSERT_TRUE(input->read_native_tile(0, 0, x, y, 0, tile.get())) << input->geterror();
        for (int j = 0; j < 64; ++j)
            for (int i = 0; i < 64; ++i) {
                const bool inside = x + i < 100 && y + j < 70;
                const float expected =
                    inside ? whole[static_cast<std::size_t>(((y + j) * 100 + x + i) * 3)] : 0;
                ASSERT_EQ(tile[static_cast<std::size_t>((j * 64 + i) * 3)], expected) << i << " " << j;
            }
    }
}

TEST_F(InputConformance, conformance_09_formats_channels_strides) {
    write_panorama("four.exr", 256, 128, TypeDesc::FLOAT, 4);
    for (const char* tile : {"32", "0"}) {
        const std::string name = std::string("four.exr.pano?size=90x60&tile=") + tile;
        const auto input = open(name);
        ASSERT_TRUE(input);
        const std::vector<float> native = read_floats(name);
        for (const TypeDesc type : {TypeDesc::UINT8, TypeDesc::INT8, TypeDesc::UINT16, TypeDesc::INT16,
                                    TypeDesc::UINT32, TypeDesc::INT32, TypeDesc::HALF, TypeDesc::DOUBLE}) {
            SCOPED_TRACE(type.c_str());
            std::vector<std::byte> pixels(native.size() * type.size()), expected(pixels.size());
            ASSERT_TRUE(input->read_image(0, 0, 0, 4, type, pixels.data())) << input->geterror();
            OIIO::convert_pixel_values(TypeDesc::FLOAT, native.data(), type, expected.data(),
                                       static_cast<int>(native.size()));
            EXPECT_EQ(pixels, expected);
        }
        for (int begin = 0; begin < 4; ++begin)
            for (int end = begin + 1; end <= 4; ++end) {
                // With a gap of two floats after each pixel, and of one row after each row.
                const int channels = end - begin;
                const std::size_t pixel = static_cast<std::size_t>(channels) + 2, row = pixel * 90;
                std::vector<float> pixels(row * 120, -5);
                ASSERT_TRUE(input->read_image(0, 0, begin, end, TypeDesc::FLOAT, pixels.data(),
                                              OIIO::stride_t(pixel * 4), OIIO::stride_t(row * 8)))
                    << input->geterror();
                for (std::size_t y = 0; y < 60; ++y)
                    for (std::size_t x = 0; x < 90; ++x) {
                        for (int c = begin; c < end; ++c)
                            ASSERT_EQ(pixels[2 * y * row + x * pixel + static_cast<std::size_t>(c - begin)],
                                      native[(y * 90 + x) * 4 + static_cast<std::size_t>(c)]);
                        ASSERT_EQ(pixels[2 * y * row + x * pixel + pixel - 1], -5);
                    }
            }
    }
}

TEST_F(InputConformance, conformance_10_data_and_display_windows) {
    // A crop of a panorama, its display window anywhere, is that panorama with black around the crop.
    const OIIO::ImageBuf whole = panorama(256, 128);
    OIIO::ImageBuf padded(ImageSpec(256, 128, 3, OIIO::TypeFloat));
    const OIIO::ROI crop(40, 200, 20, 101, 0, 1, 0, 3);
    std::vector<float> pixels(static_cast<std::size_t>(crop.npixels()) * 3);
    ASSERT_TRUE(whole.get_pixels(crop, OIIO::TypeFloat, pixels.data()));
    ASSERT_TRUE(padded.set_pixels(crop, OIIO::TypeFloat, pixels.data()));
    write_image(padded, "padded.exr");
    for (const auto& [dx, dy, tile] : {std::tuple{0, 0, 0}, {0, 0, 32}, {-300, 17, 0}, {1000, -500, 32}}) {
        SCOPED_TRACE(dx);
        ImageSpec spec(crop.width(), crop.height(), 3, OIIO::TypeFloat);
        spec.x = crop.xbegin + dx;
        spec.y = crop.ybegin + dy;
        spec.full_x = dx;
        spec.full_y = dy;
        spec.full_width = 256;
        spec.full_height = 128;
        OIIO::ImageBuf cropped(spec);
        ASSERT_TRUE(cropped.set_pixels(cropped.roi(), OIIO::TypeFloat, pixels.data()));
        if (tile) cropped.set_write_tiles(tile, tile);
        const std::string name = "cropped" + std::to_string(dx) + "_" + std::to_string(tile) + ".exr";
        write_image(cropped, name);
        for (const char* arguments :
             {".pano?yaw=60&size=100", ".pano?to=equirectangular&size=300", ".pano?pitch=90&size=64"})
            EXPECT_EQ(read_pixels(name + arguments), read_pixels(std::string("padded.exr") + arguments))
                << arguments;
        const ImageSpec made = read_pixels(name + ".pano?size=64").spec;
        EXPECT_EQ(made.x, 0);
        EXPECT_EQ(made.full_x, 0);
        EXPECT_EQ(made.full_width, 64);
    }
}

TEST_F(InputConformance, conformance_11_bad_subimage_level_and_range) {
    const auto input = open(kView + "&tile=64");
    ASSERT_TRUE(input);
    std::vector<float> pixels(1 << 16);
    EXPECT_FALSE(input->seek_subimage(1, 0));
    EXPECT_FALSE(input->seek_subimage(0, 1));
    EXPECT_FALSE(input->seek_subimage(-1, 0));
    const auto fails = [&](bool ok, const char* what) {
        EXPECT_FALSE(ok) << what;
        EXPECT_THAT(input->geterror(), Not(testing::IsEmpty())) << what;
    };
    fails(input->read_native_tile(1, 0, 0, 0, 0, pixels.data()), "subimage");
    fails(input->read_native_tile(0, 3, 0, 0, 0, pixels.data()), "level");
    fails(input->read_native_tile(0, 0, 192, 0, 0, pixels.data()), "right of the image");
    fails(input->read_native_tile(0, 0, 0, -64, 0, pixels.data()), "above the image");
    fails(input->read_native_scanlines(0, 0, 90, 101, 0, pixels.data()), "below the image");
    fails(input->read_native_scanlines(0, 0, 10, 10, 0, pixels.data()), "no lines");
    fails(input->read_native_scanline(0, 0, -1, 0, pixels.data()), "line above");
    fails(input->read_native_scanlines(0, 0, 0, 1, 0, 2, 4, pixels.data()), "channels");
    fails(input->read_native_tiles(0, 0, 64, 64, 0, 64, 0, 1, pixels.data()), "no tiles");
    EXPECT_TRUE(input->read_native_tile(0, 0, 128, 64, 0, pixels.data())) << input->geterror();
}

TEST_F(InputConformance, conformance_12_seeks_out_of_order) {
    const std::string name = kView + "&mip=1&tile=16";
    const auto input = open(name);
    ASSERT_TRUE(input);
    std::vector<Pixels> levels;
    for (int level = 0; input->seek_subimage(0, level); ++level) {
        EXPECT_EQ(input->spec().width, std::max(1, 150 >> level));
        EXPECT_EQ(input->spec().height, std::max(1, 100 >> level));
        levels.push_back(read_pixels(name, level));
    }
    ASSERT_EQ(levels.size(), 8u);
    std::mt19937 random(5);
    SCOPED_TRACE("seed 5");
    for (int i = 0; i < 100; ++i) {
        const auto level = static_cast<int>(random() % levels.size());
        const ImageSpec spec = input->spec(0, level);
        std::vector<std::byte> pixels(spec.image_bytes());
        if (i % 3 == 0) {
            ASSERT_TRUE(input->seek_subimage(0, level));
            EXPECT_EQ(input->current_miplevel(), level);
        }
        ASSERT_TRUE(input->read_image(0, level, 0, 3, spec.format, pixels.data())) << input->geterror();
        ASSERT_EQ(pixels, levels[static_cast<std::size_t>(level)].bytes) << level;
    }
}

TEST_F(InputConformance, conformance_13_one_input_many_threads) {
    const std::string name = kView + "&tile=16";
    const std::vector<float> whole = read_floats(name);
    const auto input = open(name);
    ASSERT_TRUE(input);
    std::atomic<int> wrong{0};
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < 6; ++t)
        threads.emplace_back([&, t] {
            std::mt19937 random(t);
            std::vector<float> tile(16 * 16 * 3);
            for (int i = 0; i < 200; ++i) {
                const int x = static_cast<int>(random() % 9) * 16, y = static_cast<int>(random() % 6) * 16;
                if (!input->read_native_tile(0, 0, x, y, 0, tile.data())) ++wrong;
                for (int j = 0; j < 16 * 16 * 3; ++j)
                    if (tile[static_cast<std::size_t>(j)] !=
                        whole[static_cast<std::size_t>(((y + j / 48) * 150 + x) * 3 + j % 48)])
                        ++wrong;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0);
}

TEST_F(InputConformance, conformance_14_tiles_and_threads_never_change_pixels) {
    for (const char* arguments :
         {"yaw=170&pitch=60&fov=120&size=300x200", "to=equirectangular&roll=20&size=256x128",
          "to=cubemap&size=48&filter=bicubic", "to=fisheye&fov=300&size=200&tol=0"}) {
        SCOPED_TRACE(arguments);
        const std::string name = std::string("city.exr.pano?") + arguments;
        OIIO::attribute("threads", 1);
        const Pixels expected = read_pixels(name + "&tile=0");
        for (const char* tile : {"16", "17x31", "64", "100x33", "512", "0"})
            for (const int threads : {1, 2, 3, 4}) {
                OIIO::attribute("threads", threads);
                EXPECT_EQ(read_pixels(name + "&tile=" + tile), expected) << tile << " " << threads;
            }
        // In any order, through a cache.
        OIIO::ImageBuf all(name + "&tile=16");
        ASSERT_TRUE(all.read(0, 0, true));
        std::mt19937 random(11);
        auto cache = OIIO::ImageCache::create(false);
        for (int i = 0; i < 300; ++i) {
            const int x = static_cast<int>(random() % unsigned(all.spec().width)),
                      y = static_cast<int>(random() % unsigned(all.spec().height));
            float pixel[3], whole[3];
            ASSERT_TRUE(cache->get_pixels(OIIO::ustring(name + "&tile=16"), 0, 0, x, x + 1, y, y + 1, 0, 1,
                                          OIIO::TypeFloat, pixel))
                << cache->geterror();
            all.getpixel(x, y, whole);
            for (int c = 0; c < 3; ++c) ASSERT_EQ(pixel[c], whole[c]);
        }
        OIIO::ImageCache::destroy(cache);
    }
    OIIO::attribute("threads", 0);
}

}  // namespace
}  // namespace anamorph::test_conformance_input
