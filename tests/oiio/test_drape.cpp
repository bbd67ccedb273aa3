// SPDX-License-Identifier: Apache-2.0
// Pictures on surfaces, in stock hosts: what lies behind them, surfaces from files, and films.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "anamorph/oiio_ops.h"
#include "host.h"

namespace anamorph::test_drape {
namespace {

using namespace testing_oiio;
namespace fs = std::filesystem;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using testing::HasSubstr;

class DrapeFiles : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        OIIO::ImageCache::create(true)->invalidate_all(true);
        write_panorama("page.exr", 48, 32);
    }
};

ImageBuf plain(int width, int height, const std::vector<float>& color) {
    ImageBuf image(ImageSpec(width, height, static_cast<int>(color.size()), OIIO::TypeFloat));
    OIIO::ImageBufAlgo::fill(image, color);
    return image;
}

/// A picture of numbers by a function of the texel.
template <class Value>
void write_samples(const std::string& name, int width, int height, int channels, const Value& value) {
    ImageBuf image(ImageSpec(width, height, channels, OIIO::TypeFloat));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            float numbers[3];
            value(x, y, numbers);
            image.setpixel(x, y, numbers);
        }
    write_image(image, name);
}

TEST_F(DrapeFiles, AlphaLiesOverBackgroundAndBackdrop) {
    // The flat picture fills the screen: .25 at alpha .5 over what is behind.
    write_image(plain(20, 10, {0.25f, 0.25f, 0.25f, 0.5f}), "veil.exr");
    write_image(plain(7, 5, {0.5f, 0.5f, 0.5f}), "wall.exr");
    const auto middle = [](const std::string& name) {
        const std::vector<float> all = read_floats(name);
        const float* at = &all[(5 * 20 + 10) * 4];
        return std::vector<float>(at, at + 4);
    };
    EXPECT_THAT(middle("veil.exr.drape"), testing::ElementsAre(0.25f, 0.25f, 0.25f, 0.5f));
    EXPECT_THAT(middle("veil.exr.drape?background=1,0.5,0"), testing::ElementsAre(0.75f, 0.5f, 0.25f, 1.0f));
    EXPECT_THAT(middle("veil.exr.drape?backdrop=wall.exr"), testing::ElementsAre(0.5f, 0.5f, 0.5f, 1.0f));
    const ImageBuf veil("veil.exr"), wall("wall.exr");
    EXPECT_EQ(bytes(apply("drape", {&veil, &wall}, {})),
              read_pixels("veil.exr.drape?backdrop=wall.exr").bytes);
    write_image(plain(7, 5, {0.5f}), "gray.exr");
    EXPECT_THAT(open_error("veil.exr.drape?backdrop=gray.exr"),
                HasSubstr("backdrop has 1 channels besides alpha"));
}

TEST_F(DrapeFiles, SampledSurfacesAreThoseOfTheirFormulas) {
    // Heights of a plane, and the positions of one: the same picture as the plane moved.
    write_samples("flat.exr", 12, 8, 3, [](int x, int y, float* p) {
        p[0] = 1.5f * ((static_cast<float>(x) + 0.5f) / 12 - 0.5f);
        p[1] = 0.5f - (static_cast<float>(y) + 0.5f) / 8;
        p[2] = 0.25f;
    });
    write_image(plain(9, 9, {0.5f}), "half.exr");
    const std::string look = "&camera=0.3,0.4,2&output=stmap&tol=0.01";
    const std::vector<float> moved = read_floats("page.exr.drape?move=0,0,0.25" + look);
    EXPECT_LT(
        largest_difference(read_floats("page.exr.drape?surface=positions&positions=flat.exr" + look), moved),
        1e-3);
    EXPECT_LT(
        largest_difference(read_floats("page.exr.drape?height=half.exr&height_scale=0.5" + look), moved),
        1e-3);
    // Half of a plane at 0 and half of one at .5.
    write_samples("far.exr", 2, 2, 3, [](int x, int y, float* p) {
        p[0] = 1.5f * (static_cast<float>(x) / 2 - 0.25f);
        p[1] = 0.25f - static_cast<float>(y) / 2;
        p[2] = 0.5f;
    });
    EXPECT_LT(largest_difference(
                  read_floats("page.exr.drape?blend=positions&weights=0.5&positions=far.exr" + look), moved),
              1e-3);
}

TEST_F(DrapeFiles, WhatIsNoNumberIsNamed) {
    write_samples("bad.exr", 16, 16, 3, [](int x, int y, float* p) {
        p[0] = (static_cast<float>(x) + 0.5f) / 16 - 0.5f;
        p[1] = 0.5f - (static_cast<float>(y) + 0.5f) / 16;
        p[2] = x == 9 && y == 4 ? std::numeric_limits<float>::quiet_NaN() : 0;
    });
    const std::string name = "page.exr.drape?surface=positions&positions=bad.exr";
    EXPECT_EQ(read_pixels(name).spec.get_string_attribute("anamorph:missing"),
              "1 texels of positions, the first at 9,4");
    const std::vector<float> covered = read_floats(name + "&output=coverage&size=64");
    const auto holes = std::count(covered.begin(), covered.end(), 0.0f);
    EXPECT_GT(holes, 100);
    EXPECT_LT(holes, 64 * 43 / 2);
}

TEST_F(DrapeFiles, SaysWhatDoesNotGoTogether) {
    write_image(plain(9, 9, {0.5f}), "half.exr");
    for (const auto& [arguments, error] : std::initializer_list<std::pair<const char*, const char*>>{
             {"surface=positions", "positions is not given"},
             {"positions=page.exr", "positions is given: surface must be positions"},
             {"surface=positions&positions=half.exr", "has 1 channels: must have 3"},
             {"surface=page_turn&height=half.exr", "whose normals may turn abruptly"},
             {"surface=formula&height=half.exr", "surface must not be formula"},
             {"pz=1", "pz=1: is of surface=formula: surface must be formula, or blend name it"},
             {"surface=sphere&blend=formula&weights=1&pz=u+", "pz=u+: column 3: expected a number"},
             {"surface=formula&let=k=x", "let=k=x: column 3: expected a name that is known"},
             {"surface=formula&pz=k", "column 1: expected a name that is known"},
             {"surface=formula&k=2", "k=2: there is no such parameter, and no formula uses the name"},
             {"surface=formula&u=2&pz=u", "u=2: every formula has this name"},
             {"k=2", "k=2: there is no such parameter: must be one of src, surface"},
             {"surface=formula&pz=floor(9*u)&size=99", "the surface is torn near u="},
             {"blend=sphere", "weights=0 numbers: must be as many as surfaces in blend, 1"},
             {"blend=cube&weights=1", "blend=cube: must be names of surfaces"},
             {"height=none.exr", "none.exr"},
             {"keys=none.json", "none.json"}})
        EXPECT_THAT(open_error(std::string("page.exr.drape?") + arguments), HasSubstr(error)) << arguments;
}

TEST_F(DrapeFiles, FormulasHaveFramesKeysAndNames) {
    const std::string film =
        "page.exr.drape?surface=formula&pz=h*sin(2*pi*(u-frame/8))&h=0.1&output=stmap&size=60";
    write_text("h.json", R"({"keys": {"h": [[0, 0.1], [4, 0.3]]}, "interpolation": "linear"})");
    const auto still = [&](const std::string& height, const std::string& frame) {
        return read_floats("page.exr.drape?surface=formula&output=stmap&size=60&pz=" + height +
                           "*sin(2*pi*(u-" + frame + "/8))");
    };
    EXPECT_EQ(read_floats(film), still("0.1", "0"));
    EXPECT_EQ(read_floats(film + "&frame=3"), still("0.1", "3"));
    EXPECT_EQ(read_floats(film + "&keys=h.json&frame=2"), still("0.2", "2"));
    int frames = 0;
    for (const auto input = open(film + "&keys=h.json"); input->seek_subimage(frames, 0);) ++frames;
    EXPECT_EQ(frames, 5);
    // The waves of the list, by a recipe's file.
    write_text("w.drape", "src=page.exr\nsurface=formula\nk=2*pi/0.5\npz=0.05*sin(k*(u-0.5)*aspect)\n");
    EXPECT_LT(
        largest_difference(read_floats("w.drape?size=60&output=stmap&camera=1,1,3"),
                           read_floats("page.exr.drape?surface=waves&size=60&output=stmap&camera=1,1,3")),
        0.01);
}

TEST_F(DrapeFiles, KeyFramesAreAFilm) {
    write_text("turn.json", R"({"keys": {"turn": [[0, 0.1], [3, 0.7]]}, "interpolation": "linear"})");
    const std::string film = "page.exr.drape?surface=page_turn&keys=turn.json";
    const auto input = open(film);
    int frames = 0;
    for (; input->seek_subimage(frames, 0); ++frames)
        EXPECT_EQ(input->spec().get_int_attribute("anamorph:frame"), frames);
    EXPECT_EQ(frames, 4);
    EXPECT_EQ(read_pixels(film + "&frame=1"), read_pixels("page.exr.drape?surface=page_turn&turn=0.3"));
    const Ran ran = run("oiiotool '" + film + "' --sisplit -o:all=1 f.%04d.exr");
    ASSERT_EQ(ran.status, 0) << ran.text;
    EXPECT_EQ(read_floats("f.0002.exr"), read_floats(film + "&frame=1"));
    const ImageBuf page("page.exr");
    EXPECT_EQ(bytes(drape(page, options({{"surface", "page_turn"}, {"keys", "turn.json"}, {"frame", "3"}}))),
              read_pixels(film + "&frame=3").bytes);
}

// An edge of the surface that crosses the outermost pixels is faded there as it is farther in.
TEST_F(DrapeFiles, EdgesAreFadedAtTheBordersOfTheScreen) {
    for (const std::string drape : {"page.exr.drape?rotate=0,30,0&size=120x80",
                                    "page.exr.drape?surface=sphere&rotate=20,30,0&tol=0.01&size=120x80",
                                    "page.exr.drape?rotate=0,0,30&size=90x60&camera=0,0,1.7"})
        for (const std::string output : {"&output=coverage", ""}) {
            SCOPED_TRACE(drape + output);
            constexpr int kMore = 8;
            const auto input = open(drape);
            const int width = input->spec().width, height = input->spec().height;
            const std::vector<float> shown = read_floats(drape + output),
                                     all = read_floats(drape + output + "&overscan=8");
            const std::size_t channels = shown.size() / static_cast<std::size_t>(width * height);
            double most = 0;
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x)
                    for (std::size_t c = 0; c < channels; ++c) {
                        const auto at = static_cast<std::size_t>(y * width + x) * channels + c,
                                   there = static_cast<std::size_t>((y + kMore) * (width + 2 * kMore) + x +
                                                                    kMore) *
                                               channels +
                                           c;
                        most = std::max(most, double{std::fabs(shown[at] - all[there])});
                    }
            EXPECT_LT(most, 0.08);
        }
}

// --- the far side ---

TEST_F(DrapeFiles, TheFarSideHasItsOwnPicture) {
    ASSERT_EQ(run("oiiotool page.exr --flip --mulc 0.5 -o back.exr").status, 0);
    for (const std::string keys :
         {"", "&filter=bilinear", "&filter=nearest", "&shading=phong", "&background=1,0.5,0", "&scheme=oka",
          "&overscan=5", "&filter=summed_area", "&filter=pyramid"}) {
        SCOPED_TRACE(keys);
        // From the front nothing of it is seen, from behind nothing else, the right way round.
        EXPECT_EQ(read_floats("page.exr.drape?back=back.exr" + keys),
                  read_floats("page.exr.drape?scale=1" + keys));
        EXPECT_LT(largest_difference(read_floats("page.exr.drape?rotate=0,180,0&back=back.exr" + keys),
                                     read_floats("back.exr.drape?scale=1" + keys)),
                  1e-4);
    }
    // Without it, the front shows through.
    ASSERT_EQ(run("oiiotool page.exr --flop -o flop.exr").status, 0);
    EXPECT_LT(largest_difference(read_floats("page.exr.drape?rotate=0,180,0"), read_floats("flop.exr.drape")),
              1e-4);
}

// A page that is rolled up shows both sides: which one, its source points tell.
TEST_F(DrapeFiles, EachPixelShowsTheSideThatIsSeen) {
    write_image(plain(48, 32, {1, 0, 0}), "red.exr");
    write_image(plain(48, 32, {0, 0, 1}), "blue.exr");
    constexpr int kWidth = 96, kHeight = 64;
    for (const std::string keys : {"", "&filter=bilinear", "&alpha=1"}) {
        SCOPED_TRACE(keys);
        const std::string bare =
            "red.exr.drape?surface=cylinder&angle=220&rotate=20,110,0&camera=0,0.2,1.2&size=96x64";
        const std::string roll = bare + keys, values = keys == "&alpha=1" ? bare : roll;
        const std::vector<float> seen = read_floats(roll + "&back=blue.exr"),
                                 st = read_floats(values + "&output=stmap"),
                                 cover = read_floats(values + "&output=coverage");
        const std::size_t channels = seen.size() / cover.size();
        const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * kWidth + x); };
        int sides[2] = {};
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const float *pixel = &seen[channels * at(x, y)], red = pixel[0], blue = pixel[2];
                ASSERT_NEAR(red + blue, cover[at(x, y)], 1e-6) << x << " " << y;
                if (x == 0 || y == 0 || x + 1 == kWidth || y + 1 == kHeight || red * blue != 0) continue;
                // Where the four around lie near in the picture, they lie on one side.
                const float *left = &st[2 * at(x - 1, y)], *right = &st[2 * at(x + 1, y)],
                            *up = &st[2 * at(x, y - 1)], *down = &st[2 * at(x, y + 1)];
                const float a = right[0] - left[0], b = down[0] - up[0], c = right[1] - left[1],
                            d = down[1] - up[1];
                const bool is_near =
                    std::max({std::fabs(a), std::fabs(b), std::fabs(c), std::fabs(d)}) < 0.2f;
                if (!is_near || left[0] < 0 || right[0] < 0 || up[0] < 0 || down[0] < 0) continue;
                const bool shows_back = a * d - b * c < 0;
                ASSERT_EQ(blue > 0, shows_back) << x << " " << y;
                ++sides[shows_back ? 1 : 0];
            }
        EXPECT_GT(sides[0], 200);
        EXPECT_GT(sides[1], 200);
        expect_one_picture(roll + "&back=blue.exr", 20, 10);
    }
}

// A picture on the far side is stretched over it, whatever its size: alone there it would be the same.
TEST_F(DrapeFiles, TheFarSideMayHaveAnySize) {
    for (const std::string size : {"96x20", "7x5", "300x200"}) {
        ASSERT_EQ(run("oiiotool page.exr --resize " + size + " --mulc 0.5 -o back" + size + ".exr").status,
                  0);
        for (const std::string keys : {"", "&filter=bilinear", "&filter=nearest", "&shading=phong",
                                       "&filter=summed_area", "&filter=pyramid", "&scheme=exact"}) {
            SCOPED_TRACE(size + keys);
            // In a picture and at a place of its own; square pixels are those of the near side, 48x32.
            const std::string view = "size=90x60" + keys;
            EXPECT_EQ(read_floats("page.exr.drape?back=back" + size + ".exr&" + view),
                      read_floats("page.exr.drape?" + view));
            // Nearest texels differ where two are as near.
            if (size != "300x200" || keys == "&filter=nearest") continue;
            EXPECT_LT(largest_difference(
                          read_floats("page.exr.drape?rotate=0,180,0&back=back" + size + ".exr&" + view),
                          read_floats("back" + size + ".exr.drape?" + view)),
                      1e-4);
        }
        expect_one_picture(
            "page.exr.drape?rotate=20,150,0&surface=cylinder&angle=220&back=back" + size + ".exr", 20, 10);
        // The paper's blocks are those of the near side.
        const std::string blocks = "page.exr.drape?rotate=0,150,0&scheme=oka&size=90x60";
        std::vector<float> other = read_floats(blocks + "&back=back" + size + ".exr"),
                           plain = read_floats(blocks);
        ASSERT_EQ(other.size(), plain.size());
        int seen[2] = {0, 0};
        for (std::size_t i = 0; i < other.size(); ++i) {
            if (plain[i] != 0) ++seen[0];
            if ((plain[i] != 0) != (other[i] != 0)) ++seen[1];
        }
        EXPECT_GT(seen[0], 1000);
        EXPECT_LT(seen[1], seen[0] / 20);
    }
}

TEST_F(DrapeFiles, TheFarSideIsRefusedWhereItDoesNotFit) {
    write_image(plain(48, 32, {1}), "grey.exr");
    EXPECT_THAT(open_error("page.exr.drape?back=grey.exr"),
                HasSubstr("has 1 channels, none of them alpha: must be as src, 3 channels"));
    EXPECT_THAT(open_error("page.exr.drape?back=nothing.exr"), HasSubstr("nothing.exr"));
    EXPECT_THAT(open_error("page.exr.drape?back=page.exr&scheme=hardware"),
                HasSubstr("must not be given with scheme=hardware"));
    // In memory it is a file as well.
    const ImageBuf page("page.exr");
    ImageBuf from_memory;
    ASSERT_TRUE(drape(from_memory, page, options({{"back", "grey.exr"}})) == false);
    EXPECT_THAT(from_memory.geterror(), HasSubstr("must be as src"));
    ASSERT_EQ(run("oiiotool page.exr --flip -o back.exr").status, 0);
    ImageBuf turned;
    ASSERT_TRUE(drape(turned, page, options({{"back", "back.exr"}, {"rotate", "0,180,0"}})))
        << turned.geterror();
    EXPECT_EQ(bytes(turned), read_pixels("page.exr.drape?back=back.exr&rotate=0,180,0").bytes);
}

/// Files that blend names are found beside the recipe file that names them, as others are, and a picture changes with them.
TEST_F(DrapeFiles, DesignedSurfacesAreFoundBesideTheirRecipe) {
    fs::create_directory("faces");
    const auto list = [](double z) {
        return OIIO::Strutil::fmt::format(
            R"({{"deformations": [{{"vector": [0, 0, {}], "center": [0.5, 0.5], "extent": [0.3, 0.3]}}]}})",
            z);
    };
    write_text("faces/smile.json", list(0.5));
    write_text("both.json", list(0.25));
    write_text("faces/face.drape", "src=../page.exr\nblend=smile.json\nweights=0.5\n");
    const std::vector<std::byte> expected = read_pixels("page.exr.drape?deform=both.json").bytes;
    EXPECT_EQ(read_pixels("faces/face.drape").bytes, expected);
    EXPECT_EQ(read_pixels("page.exr.drape?blend=faces/smile.json&weights=0.5").bytes, expected);
    EXPECT_THAT(open_error("page.exr.drape?blend=smile.json&weights=0.5"), HasSubstr("smile.json"));
    const ImageBuf page("page.exr");
    ImageBuf from_memory;
    ASSERT_TRUE(drape(from_memory, page, options({{"blend", "faces/smile.json"}, {"weights", "0.5"}})))
        << from_memory.geterror();
    EXPECT_EQ(bytes(from_memory), expected);
    write_text("faces/smile.json", list(0.75));
    EXPECT_NE(read_pixels("faces/face.drape").bytes, expected);
}

}  // namespace
}  // namespace anamorph::test_drape
