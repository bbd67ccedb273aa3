// SPDX-License-Identifier: Apache-2.0
// output=coverage and alpha=: how much of a pixel its source covers. The truth is a source that is white: what is drawn of it, with
// black beyond its edges.
#include <OpenImageIO/imagebufalgo.h>

#include <cmath>

#include "host.h"

namespace anamorph::test_coverage {
namespace {

using namespace testing_oiio;
using testing::HasSubstr;

class Coverage : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("plate.exr", 120, 80);
        write_panorama("bytes.png", 120, 80, OIIO::TypeUInt8);
        write_panorama("rgba.exr", 120, 80, OIIO::TypeFloat, 4);
        write_white("white.exr", 120, 80, 1);
        write_text("grid.json", R"({"columns": 2, "rows": 2, "units": "fractions", "vertices": [[-0.1, 0.05],
            [0.5, -0.2], [1.3, 0], [0, 0.5], [0.55, 0.47], [1.1, 0.5], [0.2, 1], [0.5, 1.2], [1, 0.9]]})");
        write_text("lines.json", R"({"features": [{"line": [[40, 30, 80, 40], [50, 25, 90, 50]]}]})");
    }
};

/// Recipes with %s in place of each source.
const std::string kRecipes[] = {
    "v.pano?src=%s&from=rectilinear&srcfov=90&fov=110&yaw=20&pitch=10&size=100x80",
    "v.pano?src=%s&from=fisheye&srcfov=170&fov=110&yaw=50&size=100x80",
    "v.pano?src=%s&from=latlong&srcfov=200&fov=110&yaw=100&size=50x40",
    "v.pano?src=%s&from=rectilinear&srcfov=90&to=formula&ray_z=0.3+r&size=100x80",
    "v.lens?src=%s&lens=3de4:k1=-0.3",
    "v.map?src=%s&u=x*3-100+10*sin(y/7)&v=y*2.5-60",
    "v.map?src=%s&u=x*8-300&v=y*0.2+sqrt(x-20)",
    "v.warp?src=%s&mesh=grid.json",
    "v.warp?src=%s&mesh=grid.json&direction=push",
    "v.morph?a=%s&b=%s&features=lines.json&wrap=black&t=1.5&t_color=0.4",
};
std::string of(std::string recipe, const std::string& source) {
    for (std::size_t at; (at = recipe.find("%s")) != std::string::npos;) recipe.replace(at, 2, source);
    return recipe;
}

TEST_F(Coverage, IsWhatAWhiteSourceShows) {
    for (const std::string& recipe : kRecipes)
        for (const std::string filter : {"antialias", "bilinear", "bicubic", "sharp_bicubic", "nearest"}) {
            SCOPED_TRACE(recipe + " " + filter);
            const std::string keys = "&filter=" + filter;
            const std::vector<float> truth = read_floats(of(recipe, "white.exr") + keys),
                                     found = read_floats(of(recipe, "plate.exr") + keys + "&output=coverage");
            EXPECT_LT(largest_difference(found, truth), 1e-6);
            double sum = 0;
            for (const float value : found) sum += value;
            EXPECT_GT(sum, 0.05 * static_cast<double>(found.size()));
            EXPECT_LT(sum, 0.999 * static_cast<double>(found.size()));
        }
}

// Whatever stands beyond the edges, only what the source has itself covers.
TEST_F(Coverage, DoesNotDependOnWrap) {
    const std::string map = "v.map?src=plate.exr&u=x+30.25&v=y-10.5&filter=bilinear&output=coverage";
    const std::vector<float> cover = read_floats(map);
    for (const std::string wrap : {"black", "clamp", "periodic", "mirror"})
        EXPECT_EQ(read_floats(map + "&wrap=" + wrap), cover) << wrap;
    EXPECT_FLOAT_EQ(cover[120 * 20 + 0], 1);
    EXPECT_FLOAT_EQ(cover[120 * 20 + 89], 0.75f);
    EXPECT_FLOAT_EQ(cover[120 * 20 + 90], 0);
    EXPECT_FLOAT_EQ(cover[120 * 10 + 5], 0.5f);
}

// A whole panorama covers every direction.
TEST_F(Coverage, IsOneOfWholePanoramas) {
    write_panorama("globe.exr", 128, 64);
    write_panorama("cube.exr", 32, 192);
    for (const std::string from :
         {"globe.exr&from=latlong", "cube.exr&from=cubemap", "globe.exr&from=sinusoidal"})
        for (const float value :
             read_floats("v.pano?src=" + from + "&to=fisheye&fov=360&size=64&output=coverage&yaw=20"))
            ASSERT_TRUE(value == 0 || std::fabs(value - 1) < 1e-6f) << from << " " << value;
}

TEST_F(Coverage, IsTheAlphaThatIsAskedFor) {
    for (const std::string& recipe : kRecipes) {
        SCOPED_TRACE(recipe);
        const std::string drawn = of(recipe, "plate.exr");
        const Pixels with = read_pixels(drawn + "&alpha=1");
        ASSERT_EQ(with.spec.nchannels, 4);
        EXPECT_EQ(with.spec.alpha_channel, 3);
        EXPECT_EQ(with.spec.channelnames[3], "A");
        const std::vector<float> color = read_floats(drawn), cover = read_floats(drawn + "&output=coverage"),
                                 all = read_floats(drawn + "&alpha=1");
        for (std::size_t i = 0; i < cover.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(all[4 * i + c], color[3 * i + c]) << i;
            ASSERT_EQ(all[4 * i + 3], cover[i]) << i;
        }
        expect_one_picture(drawn + "&alpha=1", 20, 10);
    }
}

TEST_F(Coverage, IsOfTheSourcesType) {
    const std::string map = "v.map?src=bytes.png&u=x+30.25&v=y&filter=bilinear&alpha=1";
    const Pixels all = read_pixels(map);
    EXPECT_EQ(all.spec.format, OIIO::TypeUInt8);
    ASSERT_EQ(all.spec.nchannels, 4);
    EXPECT_EQ(all.bytes[4 * 10 + 3], std::byte{255});
    EXPECT_EQ(all.bytes[4 * 89 + 3], std::byte{191});
    EXPECT_EQ(all.bytes[4 * 90 + 3], std::byte{0});
    // Moved pixels of integers have one too.
    EXPECT_EQ(read_pixels("v.map?src=bytes.png&u=x+30&v=y&filter=nearest&alpha=1").bytes[4 * 90 + 3],
              std::byte{0});
    // In another colour space alpha stays what it is.
    const Pixels linear =
        read_pixels("v.map?src=bytes.png&u=x+30.25&v=y&filter=bilinear&alpha=1&colorspace=scene_linear");
    EXPECT_EQ(linear.bytes[4 * 89 + 3], std::byte{191});
    EXPECT_EQ(linear.bytes[4 * 10], all.bytes[4 * 10]);
}

TEST_F(Coverage, StaysWhatItIsWhereTheSourceHasAlpha) {
    EXPECT_EQ(read_pixels("v.map?src=rgba.exr&u=x+30.25&alpha=1"),
              read_pixels("v.map?src=rgba.exr&u=x+30.25"));
}

// Minified, over the seam and at the edges of overscan, alpha is faded as white is.
TEST_F(Coverage, IsFadedAsColorsAre) {
    OIIO::ImageSpec spec(150, 100, 3, OIIO::TypeFloat);
    spec.x = -20;
    spec.y = -8;
    spec.full_width = 120;
    spec.full_height = 80;
    OIIO::ImageBuf over(spec);
    const float white[] = {1, 1, 1};
    OIIO::ImageBufAlgo::fill(over, white);
    write_image(over, "over.exr");
    write_white("globe.exr", 200, 100, 3);
    write_white("cube.exr", 90, 60, 3);
    for (const std::string recipe :
         {"over.exr.pano?from=rectilinear&srcfov=70&fov=150&yaw=20&size=50x40",
          "over.exr.pano?from=rectilinear&srcfov=70&fov=120&yaw=20&size=50x40",
          "over.exr.map?u=x*7-300&v=y*9-200",
          "globe.exr.pano?from=equirectangular&fov=100&size=50x40&yaw=170&wrap=black",
          "cube.exr.pano?from=cubemap3x2&fov=100&size=50x40&yaw=40&wrap=black",
          "globe.exr.pano?from=equirectangular&to=fisheye&fov=360&size=40&wrap=black"})
        for (const std::string filter : {"antialias", "bilinear", "nearest"}) {
            SCOPED_TRACE(recipe + " " + filter);
            const std::vector<float> all = read_floats(recipe + "&alpha=1&filter=" + filter);
            for (std::size_t i = 0; i + 3 < all.size(); i += 4)
                ASSERT_NEAR(all[i + 3], all[i], 1e-5) << i / 4;
        }
}

/// A white image whose data window is `data` of a display window of 120x80.
void write_framed(const std::string& name, const OIIO::ROI& data) {
    OIIO::ImageSpec spec(data.width(), data.height(), 3, OIIO::TypeFloat);
    spec.x = data.xbegin;
    spec.y = data.ybegin;
    spec.full_width = 120;
    spec.full_height = 80;
    OIIO::ImageBuf image(spec);
    const float white[] = {1, 1, 1};
    OIIO::ImageBufAlgo::fill(image, white);
    write_image(image, name);
}

// Data windows inside of the display window, across its edges, beside it and around it: what the file has, no more.
TEST_F(Coverage, IsWhatTheFileHas) {
    const OIIO::ROI windows[] = {{31, 77, 12, 53},   {-20, 47, -8, 33},  {90, 141, 40, 95},
                                 {-30, 151, 22, 41}, {127, 190, 10, 60}, {-37, 163, -5, 99},
                                 {0, 120, 0, 80},    {119, 120, 79, 80}};
    int number = 0;
    for (const OIIO::ROI& data : windows) {
        // Its own name each, which no cache knows yet.
        const std::string name = "framed" + std::to_string(number++) + ".exr";
        write_framed(name, data);
        // One pixel for each of the display window: exactly its own.
        const std::vector<float> own = read_floats(name + ".map?u=x&v=y&output=coverage");
        for (int y = 0; y < 80; ++y)
            for (int x = 0; x < 120; ++x) {
                const bool has = data.contains(x, y);
                ASSERT_EQ(own[static_cast<std::size_t>(120 * y + x)], has ? 1.0f : 0.0f) << x << " " << y;
            }
        // Half a pixel to the right: the mean of two, in closed form.
        const std::vector<float> half =
            read_floats(name + ".map?u=x+0.5&v=y&filter=bilinear&output=coverage");
        for (int x = 0; x < 120; ++x) {
            const int y = std::clamp((data.ybegin + data.yend) / 2, 0, 79);
            const float truth =
                0.5f * (data.contains(x, y) ? 1 : 0) + 0.5f * (data.contains(x + 1, y) ? 1 : 0);
            ASSERT_FLOAT_EQ(half[static_cast<std::size_t>(120 * y + x)], truth) << x;
        }
        // However it is drawn and minified, what is white says it.
        for (const std::string recipe :
             {".lens?lens=3de4:k1=-0.3", ".lens?lens=3de4:k1=0.1&size=all", ".map?u=x*7-300&v=y*9-200",
              ".map?u=x*13-600&v=y*5-150", ".pano?from=rectilinear&srcfov=70&fov=150&yaw=20&size=50x40",
              ".pano?from=fisheye&srcfov=120&fov=160&size=30x20"})
            for (const std::string filter :
                 {"antialias", "bilinear", "bicubic", "sharp_bicubic", "nearest"}) {
                SCOPED_TRACE(name + recipe + " " + filter);
                const std::string drawn = name + recipe + "&filter=" + filter;
                const std::vector<float> all = read_floats(drawn + "&alpha=1"),
                                         cover = read_floats(drawn + "&output=coverage");
                ASSERT_EQ(all.size(), 4 * cover.size());
                for (std::size_t i = 0; i < cover.size(); ++i) {
                    ASSERT_NEAR(all[4 * i + 3], all[4 * i], 2e-6) << i;
                    ASSERT_EQ(all[4 * i + 3], cover[i]) << i;
                }
            }
    }
}

// A part of a panorama, turned by its file, and one of two eyes have what the file has of them.
TEST_F(Coverage, IsWhatTheFileHasOfParts) {
    write_framed("part.exr", {31, 77, 12, 53});
    for (const std::string keys : {"from=latlong&fov=110", "from=latlong&to=fisheye&fov=300&yaw=100",
                                   "from=latlong&fov=110&wrap=black", "from=cylindrical&fov=160",
                                   "from=latlong&srcfov=180&stereo=side-by-side&eye=right&fov=110"}) {
        const std::string recipe = "part.exr.pano?size=60x40&" + keys;
        SCOPED_TRACE(recipe);
        const std::vector<float> all = read_floats(recipe + "&alpha=1");
        double sum = 0;
        for (std::size_t i = 0; i + 3 < all.size(); i += 4) {
            ASSERT_NEAR(all[i + 3], all[i], 1e-5) << i / 4;
            sum += static_cast<double>(all[i]);
        }
        EXPECT_GT(sum, 5);
        EXPECT_LT(sum, 2300);
    }
    ASSERT_EQ(run("oiiotool part.exr --orientation 6 -o turned.exr").status, 0);
    const std::vector<float> all = read_floats("turned.exr.lens?lens=3de4:k1=-0.1&alpha=1");
    double sum = 0;
    for (std::size_t i = 0; i + 3 < all.size(); i += 4) {
        ASSERT_NEAR(all[i + 3], all[i], 1e-5) << i / 4;
        sum += static_cast<double>(all[i]);
    }
    EXPECT_NEAR(sum, 46 * 41, 0.1 * 46 * 41);
}

// An image of a project is cut out of what its file has.
TEST_F(Coverage, IsWhatTheFileHasOfProjects) {
    write_framed("cut.exr", {31, 77, 12, 53});
    write_text("cut.pto", R"(p f0 w120 h80 v60 E0 R0 n"TIFF_m c:NONE"
i w120 h80 f0 v60 r0 p0 y0 a0 b0 c0 d0 e0 g0 t0 S10,110,5,75 n"cut.exr"
)");
    const std::vector<float> all = read_floats("cut.pto.pano?filter=bilinear&alpha=1");
    ASSERT_EQ(all.size(), std::size_t{4 * 120 * 80});
    double sum = 0;
    for (std::size_t i = 0; i < all.size(); i += 4) {
        ASSERT_NEAR(all[i + 3], all[i], 1e-5) << i / 4;
        sum += static_cast<double>(all[i]);
    }
    EXPECT_NEAR(sum, 46 * 41, 0.1 * 46 * 41);
}

// The chain is drawn from the first source, and covered by it.
TEST_F(Coverage, GoesThroughChains) {
    const std::string inner = "(v.lens?lens=3de4:k1=-0.3&src=%s)",
                      chain = "v.map?u=x*1.3-20&v=y*1.2&src=" + inner;
    const std::vector<float> truth = read_floats(of(chain, "white.exr"));
    EXPECT_LT(
        largest_difference(
            read_floats(of("v.map?u=x*1.3-20&v=y*1.2&output=coverage&src=" + inner, "plate.exr")), truth),
        1e-6);
    for (const std::string with :
         {"v.map?u=x*1.3-20&v=y*1.2&alpha=1&src=(v.lens?lens=3de4:k1=-0.3&src=%s)",
          "v.map?u=x*1.3-20&v=y*1.2&src=(v.lens?lens=3de4:k1=-0.3&alpha=1&src=%s)"}) {
        SCOPED_TRACE(with);
        const std::string name = of(with, "plate.exr");
        EXPECT_EQ(open(name)->spec().get_string_attribute("anamorph:chain"), "map of lens");
        const std::vector<float> all = read_floats(name);
        ASSERT_EQ(all.size(), 4 * truth.size());
        for (std::size_t i = 0; i < truth.size(); ++i) ASSERT_NEAR(all[4 * i + 3], truth[i], 1e-6) << i;
    }
}

// Holes of an ST-map in the middle of a chain are cut out of color, alpha and coverage alike, with no pixel in between.
TEST_F(Coverage, OfHolesGoesThroughChains) {
    constexpr int kWidth = 360, kHeight = 240;
    OIIO::ImageBuf map(OIIO::ImageSpec(kWidth, kHeight, 4, OIIO::TypeFloat));
    const auto is_hole = [](int x, int y) { return x >= 90 && x < 170 && y >= 60 && y < 130; };
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float texel[] = {(static_cast<float>(x) + 0.5f) / kWidth,
                                   (static_cast<float>(y) + 0.5f) / kHeight, 0, is_hole(x, y) ? 0.f : 1.f};
            map.setpixel(x, y, texel);
        }
    write_image(map, "holes.exr");
    for (const std::string outer :
         {"v.map?u=x*0.7+53.3&v=y*0.8+28.1", "v.pano?from=rectilinear&srcfov=60&fov=40&yaw=3&size=300x200"}) {
        SCOPED_TRACE(outer);
        const std::string source = "&src=(w.warp?mesh=holes.exr&src=%s)";
        const std::string colored = of(outer + "&alpha=1" + source, "plate.exr");
        EXPECT_THAT(open(colored)->spec().get_string_attribute("anamorph:chain"), HasSubstr(" of warp"));
        const std::vector<float> all = read_floats(colored),
                                 cover = read_floats(of(outer + "&output=coverage" + source, "plate.exr")),
                                 white = read_floats(of(outer + source, "white.exr"));
        ASSERT_EQ(all.size(), 4 * cover.size());
        ASSERT_EQ(white.size(), cover.size());
        int holes = 0;
        for (std::size_t i = 0; i < cover.size(); ++i) {
            ASSERT_EQ(all[4 * i + 3], cover[i]) << i;
            ASSERT_NEAR(white[i], cover[i], 1e-6) << i;
            ASSERT_TRUE(cover[i] == 0 || cover[i] > 0.999f) << i;
            if (cover[i] == 0) {
                ++holes;
                for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(all[4 * i + c], 0) << i;
            }
        }
        EXPECT_GT(holes, static_cast<int>(cover.size()) / 20);
    }
}

TEST_F(Coverage, OfDrapesIsTheirOwn) {
    const std::string drape =
        "v.drape?src=plate.exr&surface=cylinder&angle=200&camera=0.2,0.3,2.2&size=90x70";
    for (const std::string keys : {"", "&filter=bilinear", "&overscan=9", "&scheme=oka"}) {
        SCOPED_TRACE(keys);
        const std::vector<float> color = read_floats(drape + keys),
                                 cover = read_floats(drape + keys + "&output=coverage"),
                                 all = read_floats(drape + keys + "&alpha=1");
        ASSERT_EQ(all.size(), 4 * cover.size());
        for (std::size_t i = 0; i < cover.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(all[4 * i + c], color[3 * i + c]) << i;
            ASSERT_EQ(all[4 * i + 3], cover[i]) << i;
        }
    }
    EXPECT_THAT(open_error(drape + "&alpha=1&background=1,1,1"), HasSubstr("together with background"));
}

TEST_F(Coverage, IsRefusedWhereColorsAreNotFaded) {
    for (const std::string wrap : {"clamp", "periodic", "mirror"})
        EXPECT_THAT(open_error("v.map?src=plate.exr&alpha=1&wrap=" + wrap),
                    HasSubstr("must be given with wrap=black"));
    EXPECT_THAT(open_error("v.morph?a=plate.exr&b=plate.exr&features=lines.json&alpha=1"),
                HasSubstr("must be given with wrap=black"));
    EXPECT_THAT(open_error("v.pano?src=plate.exr&from=latlong&alpha=1&scheme=hardware"),
                HasSubstr("must not be given with scheme=hardware"));
}

}  // namespace
}  // namespace anamorph::test_coverage
