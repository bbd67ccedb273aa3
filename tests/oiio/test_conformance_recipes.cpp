// SPDX-License-Identifier: Apache-2.0
// What OpenImageIO expects of any input, asked of every operation and of films: the conformance items that depend
// on what is drawn, on several sources, on files beside them and on subimages.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <random>
#include <thread>

#include "host.h"

namespace anamorph::test_conformance_recipes {
namespace {

using namespace testing_oiio;
using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;
using OIIO::ustring;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

constexpr int kWidth = 150, kHeight = 75;

/// A recipe to be tested: an operation's example, with more arguments.
struct Tested {
    const Operation* operation;
    std::string name;
    std::vector<Assignment> more;
    int frames = 1;
};

std::vector<Tested> all_tested() {
    std::vector<Tested> all;
    for (const Operation* operation : operations()) all.push_back({operation, operation->name, {}});
    all.push_back({find_operation("morph"), "film", {{"frames", "3"}}, 3});
    all.push_back({find_operation("figure"), "figure_film", {{"script", "film.nudes"}}, 3});
    all.push_back({find_operation("figure"), "figure_lines", {{"style", "outline"}}});
    all.push_back({find_operation("figure"), "figure_depth", {{"style", "depth"}}});
    all.push_back(
        {find_operation("figure"), "figure_textured", {{"script", "dressed.n"}, {"style", "textured"}}});
    return all;
}

class RecipeConformance : public InFolder, public testing::WithParamInterface<Tested> {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        OIIO::ImageCache::create(true)->invalidate_all(true);
        write_panorama("city.exr", kWidth, kHeight);
        write_image(OIIO::ImageBufAlgo::flop(panorama(kWidth, kHeight)), "town.exr");
        write_text("film.nudes",
                   "figure f 1 e\nellipsoid e 200 300 100\nrepeat 0 1 moveto f e 500 500 500\n"
                   "linear 0 3 spinby f e e 60 z\nstop\n");
        write_text("dressed.n",
                   "figure f 1 e\nellipsoid e 200 300 100\nrepeat 0 1 moveto f e 500 500 500\n"
                   "repeat 0 1 texture e city.exr 0 0\nstop\n");
    }
    static const Operation& operation() { return *GetParam().operation; }
    static std::size_t sources() { return operation().least_sources; }

    /// The recipe under test with more arguments.
    static std::string name(const std::vector<Assignment>& more = {}) {
        return name_of({"city.exr", "town.exr"}, more);
    }
    static std::string name_of(const std::vector<std::string>& images,
                               const std::vector<Assignment>& more = {}) {
        std::vector<Assignment> all = GetParam().more;
        if (sources() == 0) all.push_back({"size", std::to_string(kWidth) + "x" + std::to_string(kHeight)});
        all.insert(all.end(), more.begin(), more.end());
        return example(operation(), images, all);
    }
};

std::string test_name(const testing::TestParamInfo<Tested>& info) {
    return info.param.name;
}
INSTANTIATE_TEST_SUITE_P(Operations, RecipeConformance, testing::ValuesIn(all_tested()), test_name);

/// What is asked of those that draw sources.
class SourceConformance : public RecipeConformance {};

std::vector<Tested> all_with_sources() {
    std::vector<Tested> all = all_tested();
    std::erase_if(all, [](const Tested& tested) { return tested.operation->least_sources == 0; });
    return all;
}
INSTANTIATE_TEST_SUITE_P(Operations, SourceConformance, testing::ValuesIn(all_with_sources()), test_name);

std::vector<float> read_subimage(ImageInput& input, int subimage, int level = 0) {
    const ImageSpec spec = input.spec(subimage, level);
    std::vector<float> pixels(static_cast<std::size_t>(spec.image_pixels()) *
                              static_cast<std::size_t>(spec.nchannels));
    EXPECT_TRUE(input.read_image(subimage, level, 0, spec.nchannels, TypeDesc::FLOAT, pixels.data()))
        << input.geterror();
    return pixels;
}

TEST_P(RecipeConformance, conformance_03_04_names) {
    const auto input = ImageInput::create("anamorph_recipes");
    ASSERT_TRUE(input);
    const std::string extension = "." + operation().name, capitals = OIIO::Strutil::upper(extension);
    for (const std::string& known : {"a" + extension, "a" + capitals + "?x=1", "a.b" + extension})
        EXPECT_TRUE(input->valid_file(known));
    for (const std::string& other : {extension, operation().name, "a" + extension + ".exr",
                                     "a" + extension + "s", "a.exr?b=c" + extension})
        EXPECT_FALSE(input->valid_file(other)) << other;
    std::string upper = name();
    upper.replace(upper.find('?') - extension.size(), extension.size(), capitals);
    EXPECT_EQ(read_pixels(upper), read_pixels(name()));
}

TEST_P(RecipeConformance, conformance_05_open_close_reopen) {
    const auto input = ImageInput::create("anamorph_recipes");
    ImageSpec spec;
    const Pixels expected = read_pixels(name());
    for (int i = 0; i < 3; ++i) {
        ASSERT_TRUE(input->open(name(), spec)) << input->geterror();
        EXPECT_EQ(input->current_subimage(), 0);
        std::vector<std::byte> pixels(spec.image_bytes());
        ASSERT_TRUE(input->read_image(0, 0, 0, spec.nchannels, spec.format, pixels.data()));
        EXPECT_EQ(pixels, expected.bytes);
        EXPECT_TRUE(input->close());
        EXPECT_EQ(input->current_subimage(), -1);
        EXPECT_TRUE(input->close());
    }
    ASSERT_TRUE(input->open("city.exr.pano?from=latlong&size=8", spec));
    ASSERT_TRUE(input->open(name(), spec));
    EXPECT_FALSE(input->open(name({{"size", "none"}}), spec));
    EXPECT_THAT(input->geterror(), HasSubstr("size=none"));
}

TEST_P(RecipeConformance, conformance_06_config_and_name_agree) {
    const std::vector<float> plain = read_floats(name());
    int changed = 0;
    for (const Parameter& p : *operation().parameters) {
        if (p.type != ParameterType::number || name().find("&" + p.name + "=") != std::string::npos) continue;
        SCOPED_TRACE(p.name);
        ImageSpec config;
        config.attribute(operation().name + ":" + p.name, 0.75f);
        config.attribute("other:yaw", 3.0f);
        const auto input = ImageInput::open(name(), &config);
        const std::string error = input ? "" : OIIO::geterror();
        const std::string named = name({{p.name, "0.75"}});
        if (!input) {
            EXPECT_EQ(open_error(named), error);
            continue;
        }
        const std::vector<float> pixels = read_subimage(*input, 0);
        EXPECT_TRUE(pixels == read_floats(named));
        changed += pixels != plain;
    }
    EXPECT_GT(changed, 0);
    ImageSpec config;
    config.attribute(operation().name + ":jaw", 1);
    EXPECT_FALSE(ImageInput::open(name(), &config));
    EXPECT_THAT(OIIO::geterror(), HasSubstr("jaw=1: there is no such parameter"));
}

TEST_P(RecipeConformance, conformance_07_08_every_way_to_read_gives_the_same_bits) {
    for (const std::string tile : {"32", "0", "48x16"}) {
        SCOPED_TRACE(tile);
        const auto input = open(name({{"tile", tile}}));
        ASSERT_TRUE(input);
        for (int subimage = 0; input->seek_subimage(subimage, 0); ++subimage) {
            const ImageSpec spec = input->spec();
            const int n = spec.nchannels;
            const std::vector<float> whole = read_subimage(*input, subimage);
            std::vector<float> other(whole.size());
            ASSERT_TRUE(input->seek_subimage(subimage, 0));
            if (spec.tile_width == 0) {
                for (int y = kHeight - 1; y >= 0; --y)
                    ASSERT_TRUE(input->read_scanline(y, 0, TypeDesc::FLOAT,
                                                     &other[static_cast<std::size_t>(y * kWidth * n)]));
                EXPECT_TRUE(other == whole);
                continue;
            }
            const int tw = spec.tile_width, th = spec.tile_height;
            for (int y = 0; y < kHeight; y += th)
                for (int x = 0; x < kWidth; x += tw) {
                    // Exactly one tile: an address sanitizer sees what is written beyond.
                    const std::size_t values = static_cast<std::size_t>(tw * th * n);
                    const auto buffer = std::make_unique<float[]>(values);
                    ASSERT_TRUE(input->read_native_tile(subimage, 0, x, y, 0, buffer.get()))
                        << input->geterror();
                    for (int j = 0; j < th; ++j)
                        for (int i = 0; i < tw * n; ++i) {
                            const float value = buffer[static_cast<std::size_t>(j * tw * n + i)];
                            if (y + j < kHeight && x * n + i < kWidth * n)
                                other[static_cast<std::size_t>(((y + j) * kWidth + x) * n + i)] = value;
                            else
                                ASSERT_EQ(value, 0) << "outside the picture";
                        }
                }
            EXPECT_TRUE(other == whole);
            ASSERT_TRUE(input->read_tiles(subimage, 0, 0, kWidth, 0, kHeight, 0, 1, 0, n, TypeDesc::FLOAT,
                                          other.data()));
            EXPECT_TRUE(other == whole);
        }
    }
}

TEST_P(RecipeConformance, conformance_10_data_windows_of_the_sources) {
    // A crop whose display window is the whole is the whole with black around it.
    const std::vector<std::string> images = {"city.exr", "town.exr"};
    // Of names of their own: a file that is written again within a second is not seen to be another.
    const std::vector<std::string> parts = {"part_a.exr", "part_b.exr"}, pads = {"pad_a.exr", "pad_b.exr"};
    for (std::size_t i = 0; i < sources(); ++i) {
        const std::string& part = parts[i];
        const std::string& pad = pads[i];
        const Ran ran = run("oiiotool " + images[i] + " --crop 100x40+30+25 -o " + part);
        ASSERT_EQ(ran.status, 0) << ran.text;
        OIIO::ImageBuf padded(ImageSpec(kWidth, kHeight, 3, TypeDesc::FLOAT)), crop(part);
        ASSERT_TRUE(OIIO::ImageBufAlgo::paste(padded, 0, 0, 0, 0, crop)) << padded.geterror();
        write_image(padded, pad);
        std::vector<std::string> cropped = images, whole = images;
        cropped[i] = part;
        whole[i] = pad;
        EXPECT_TRUE(read_pixels(name_of(cropped)) == read_pixels(name_of(whole))) << images[i];
        // The first frame of a film is the first picture.
        const bool drawn = i == 0 || GetParam().frames == 1;
        EXPECT_EQ(read_pixels(name_of(cropped)) == read_pixels(name()), !drawn) << images[i];
    }
}

TEST_P(RecipeConformance, conformance_11_12_subimages_and_levels) {
    const auto input = open(name({{"mip", "1"}, {"tile", "32"}}));
    ASSERT_TRUE(input);
    const int frames = GetParam().frames;
    std::vector<std::vector<std::vector<float>>> expected(static_cast<std::size_t>(frames));
    for (int i = 0; i < frames; ++i)
        for (int level = 0; input->seek_subimage(i, level); ++level) {
            EXPECT_EQ(input->spec().width, std::max(1, kWidth >> level));
            expected[static_cast<std::size_t>(i)].push_back(read_subimage(*input, i, level));
        }
    EXPECT_FALSE(input->seek_subimage(frames, 0));
    EXPECT_FALSE(input->seek_subimage(-1, 0));
    ASSERT_EQ(expected[0].size(), 8u);
    std::vector<float> pixels(32 * 32 * 4);
    EXPECT_FALSE(input->read_native_tile(frames, 0, 0, 0, 0, pixels.data()));
    EXPECT_THAT(input->geterror(), HasSubstr("there are " + std::to_string(frames)));
    EXPECT_FALSE(input->read_native_tile(0, 8, 0, 0, 0, pixels.data()));
    EXPECT_THAT(input->geterror(), Not(testing::IsEmpty()));
    std::mt19937 random(7);
    SCOPED_TRACE("seed 7");
    for (int k = 0; k < 60; ++k) {
        const auto i = random() % unsigned(frames);
        const auto level = random() % unsigned(expected[i].size());
        ASSERT_TRUE(read_subimage(*input, static_cast<int>(i), static_cast<int>(level)) ==
                    expected[i][level]);
    }
}

TEST_P(RecipeConformance, conformance_13_one_input_many_threads) {
    const auto input = open(name({{"tile", "16"}}));
    ASSERT_TRUE(input);
    const int n = input->spec().nchannels;
    std::vector<std::vector<float>> whole;
    for (int i = 0; input->seek_subimage(i, 0); ++i) whole.push_back(read_subimage(*input, i));
    std::atomic<int> wrong{0};
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < 6; ++t)
        threads.emplace_back([&, t] {
            std::mt19937 random(t);
            std::vector<float> tile(static_cast<std::size_t>(16 * 16 * n));
            for (int k = 0; k < 100; ++k) {
                const auto subimage = random() % unsigned(whole.size());
                const int x = static_cast<int>(random() % 9) * 16, y = static_cast<int>(random() % 4) * 16;
                if (!input->read_native_tile(static_cast<int>(subimage), 0, x, y, 0, tile.data())) ++wrong;
                for (int j = 0; j < 16 * 16 * n; ++j)
                    wrong +=
                        tile[static_cast<std::size_t>(j)] !=
                        whole[subimage]
                             [static_cast<std::size_t>(((y + j / (16 * n)) * kWidth + x) * n + j % (16 * n))];
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0);
}

TEST_P(RecipeConformance, conformance_15_19_behind_a_cache_with_little_memory) {
    const auto cache = OIIO::ImageCache::create(true);
    // A morph's pictures have as many channels.
    std::string inner = name({{"tile", "16"}});
    if (sources() > 0) inner = example(*find_operation("warp"), {"city.exr"}, {{"tile", "16"}});
    const std::string nested = example(*find_operation("morph"), {"n", name()},
                                       {{"tile", "16"}, {"a", '(' + inner + ')'}, {"b", '(' + name() + ')'}});
    const std::vector<std::string> names = {name({{"tile", "16"}}), nested};
    std::vector<std::vector<float>> expected;
    for (const std::string& n : names) expected.push_back(read_floats(n));
    for (const auto& [megabytes, files] : {std::pair{256.0f, 100}, {10.0f, 1}}) {
        cache->invalidate_all(true);
        cache->attribute("max_memory_MB", megabytes);
        cache->attribute("max_open_files", files);
        read_from_threads(*cache, names, expected, kWidth, kHeight);
    }
    EXPECT_THAT(cache->getstats(5), HasSubstr("ImageCache statistics"));
    cache->attribute("max_memory_MB", 256.0f);
    cache->attribute("max_open_files", 100);
}

TEST_P(SourceConformance, conformance_17_18_sources_that_change) {
    const auto input = open(name());
    ASSERT_TRUE(input);
    const std::vector<float> first = read_floats(name());
    write_panorama("city.exr", 80, 40);
    OIIO::ImageCache::create(true)->invalidate_all(true);
    std::vector<float> pixels(kWidth * kHeight * 3);
    EXPECT_FALSE(input->read_image(0, 0, 0, 3, TypeDesc::FLOAT, pixels.data()));
    EXPECT_THAT(input->geterror(), HasSubstr("has changed since it was opened"));
    // Opened again, it is what is there now.
    EXPECT_EQ(read_pixels(name()).spec.width, 80);
    write_image(OIIO::ImageBufAlgo::mul(panorama(kWidth, kHeight), 0.5f), "city.exr");
    EXPECT_FALSE(read_floats(name()) == first);
    write_panorama("city.exr", kWidth, kHeight);
    EXPECT_TRUE(read_floats(name()) == first);
    fs::remove("city.exr");
    EXPECT_THAT(open_error(name()), HasSubstr("city.exr"));
}

TEST_P(RecipeConformance, conformance_22_special_characters) {
    std::string command = "oiiotool";
    for (const char* odd :
         {"a b", "a,b", "a:b", "a;b", "a=b", "a(b)", "(ab)", "a[b]", "a+b", "\xC3\xBC", "a%20x"}) {
        SCOPED_TRACE(odd);
        const std::string text = name();
        std::vector<std::string> files = {"town.exr", "city.exr"};
        for (const auto& [file, content] : operation().example.files) files.push_back(file);
        for (const std::string& file : files) {
            const std::string other = odd + file.substr(file.find('.'));
            const std::size_t at = text.find(file);
            if (at == std::string::npos) continue;
            fs::copy_file(file, other, fs::copy_options::overwrite_existing);
            const std::string renamed = text.substr(0, at) + other + text.substr(at + file.size());
            EXPECT_TRUE(read_pixels(renamed) == read_pixels(name())) << renamed;
            command += " '" + renamed + "' -o out.exr";
        }
    }
    const Ran ran = run(command);
    EXPECT_EQ(ran.status, 0) << ran.text;
}

TEST_P(SourceConformance, conformance_29_a_crop_reads_only_what_it_needs) {
    const auto cache = OIIO::ImageCache::create(true);
    cache->invalidate_all(true);
    write_panorama("fine.exr", 4096, 2048, TypeDesc::HALF, 3, 64);
    const std::string fine = name_of({"fine.exr", "fine.exr"}, {{"tile", "64"}});
    std::vector<float> pixels(128 * 128 * 3);
    ASSERT_TRUE(
        cache->get_pixels(ustring(fine), 0, 0, 1024, 1152, 1024, 1152, 0, 1, OIIO::TypeFloat, pixels.data()))
        << cache->geterror();
    long long tiles = -1;
    ASSERT_TRUE(cache->get_image_info(ustring("fine.exr"), 0, 0, ustring("stat:tilesread"),
                                      OIIO::TypeDesc::INT64, &tiles));
    // 128 pixels each way, hardly scaled, of each picture: of 2048 tiles.
    EXPECT_GT(tiles, 0);
    EXPECT_LE(tiles, 64);
}

TEST_P(RecipeConformance, conformance_31_a_thousand_opens) {
    const auto& table = *operation().parameters;
    const bool has_tol =
        std::any_of(table.begin(), table.end(), [](const Parameter& p) { return p.name == "tol"; });
    const auto open_many = [&](int from, int to) {
        for (int i = from; i < to; ++i) {
            std::vector<Assignment> more = {
                {"size", std::to_string(16 + i % 100) + "x" + std::to_string(16 + i / 100)}};
            if (has_tol) more.push_back({"tol", "0.0" + std::to_string(i + 1)});
            auto input = ImageInput::open(name(more));
            ASSERT_TRUE(input) << OIIO::geterror();
            if (i % 2) read_subimage(*input, 0);
            if (i % 3) input->close();
        }
    };
    expect_nothing_left_behind(open_many, 30);
}

TEST_P(RecipeConformance, conformance_21_32_random_names_and_recipes) {
    const unsigned seed = 4711;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto pick = [&](const auto& list) { return list[random() % list.size()]; };
    std::vector<std::string> keys = {"x", ""},
                             values = {"city.exr", "town.exr",  "(city.exr.warp?mesh=grid.json)",
                                       "(a?b",     "grid.json", "lines.json",
                                       "0",        "1",         "0.5",
                                       "-3",       "1e300",     "1e-300",
                                       "8x4",      "16",        "0.5,0.5",
                                       "1,",       "nan",       "\xff",
                                       "?",        "="};
    for (const Parameter& p : *operation().parameters) {
        keys.push_back(p.name);
        values.insert(values.end(), p.choices.begin(), p.choices.end());
    }
    const std::string base = name().substr(0, name().find('?'));
    int opened = 0;
    for (int i = 0; i < rounds(1500); ++i) {
        std::string text = random() % 2 ? name().substr(base.size() + 1) : std::string();
        for (unsigned n = random() % 4; n > 0; --n) {
            if (!text.empty()) text += '&';
            text += pick(keys) + "=" + pick(values);
        }
        if (random() % 4 == 0 && !text.empty())
            text[random() % text.size()] = static_cast<char>(random() % 256);
        if (text.find("size") == std::string::npos) text += std::string(text.empty() ? "" : "&") + "size=9x7";
        if (i % 2 == 0) {
            std::replace(text.begin(), text.end(), '&', '\n');
            const std::string file = std::string("r").append(base.substr(base.rfind('.')));
            write_text(file, text);
            text = file;
        } else {
            text = base + "?" + text;
        }
        auto input = ImageInput::open(text);
        opened += input ? 1 : 0;
        if (!input) {
            const std::string error = OIIO::geterror();
            ASSERT_NE(error, "") << text;
            ASSERT_THAT(error, Not(HasSubstr("\n"))) << text;
        } else if (input->spec().image_pixels() <= 4096) {
            read_subimage(*input, 0);
        }
    }
    // The first quarter has fewer that can be opened.
    EXPECT_GT(opened, rounds(1500) < 1500 ? 7 : 50);
}

}  // namespace
}  // namespace anamorph::test_conformance_recipes
