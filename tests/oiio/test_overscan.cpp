// SPDX-License-Identifier: Apache-2.0
// overscan=: pictures with pixels beyond the edges of their display window, of every operation. Inside they are the pictures that they
// were; beyond, what a larger picture of the same scale shows.
#include <cmath>
#include <numbers>

#include "host.h"

namespace anamorph::test_overscan {
namespace {

using namespace testing_oiio;
using testing::HasSubstr;

constexpr int kWidth = 120, kHeight = 80, kAcross = 24, kDown = 16;

/// Rows [y0, y1) and columns [x0, x1) of a picture.
std::vector<float> cut(const std::vector<float>& pixels, int width, int channels, const Box& box) {
    std::vector<float> out;
    for (int y = box.y0; y < box.y1; ++y) {
        const auto row = pixels.begin() + (std::ptrdiff_t{y} * width + box.x0) * channels;
        out.insert(out.end(), row, row + std::ptrdiff_t{box.width()} * channels);
    }
    return out;
}

class Overscan : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("plate.exr", kWidth, kHeight);
        write_panorama("other.exr", kWidth, kHeight);
        write_panorama("globe.exr", 256, 128);
        write_panorama("rings.exr", 256, 192);
        write_text("lines.json",
                   R"({"features": [{"line": [[40, 30, 80, 40], [50, 25, 90, 50]]},
                                    {"line": [[30, 60, 70, 66], [34, 62, 66, 70]]}]})");
        write_text("pull.json",
                   R"({"columns": 2, "rows": 2, "units": "fractions", "vertices": [[0, 0], [0.5, 0],
            [1, 0], [0, 0.5], [0.55, 0.47], [1, 0.5], [0, 1], [0.5, 1], [1, 1]]})");
        write_text("push.json",
                   R"({"columns": 2, "rows": 1, "units": "pixels", "direction": "push",
            "vertices": [[-30, -10], [60, 4], [140, -12], [-25, 95], [66, 78], [150, 90]]})");
        write_text("points.csv", "x,y,u,v\n10,10,12,8\n100,12,98,15\n60,70,58,66\n15,60,20,64\n");
        write_text(
            "doll.n",
            "figure f 2 a b\nellipsoid a 400 500 100\nellipsoid b 300 90 100\njoint j a 0 480 0 b 0 -80 0\n"
            "repeat 0 1 moveto f a 500 400 500\nstop\n");
    }
};

/// A recipe, and the same scene in a larger picture without overscan, where keys say it.
struct Scene {
    std::string recipe, larger;
};

/// The field of view in degrees of so many pixels more of a flat picture.
double wider(double degrees) {
    const double half = degrees * std::numbers::pi / 360;
    return 360 / std::numbers::pi * std::atan(std::tan(half) * (kWidth + 2 * kAcross) / kWidth);
}

std::vector<Scene> scenes() {
    const std::string size = "&size=120x80", larger = "&size=168x112";
    const auto fov = [](double degrees) { return "&fov=" + shortest(degrees); };
    const std::string drape =
        "v.drape?src=plate.exr&surface=cylinder&angle=140&camera=0.2,0.3,2.2&filter=bilinear";
    return {
        {"v.pano?src=globe.exr&fov=80&yaw=30&pitch=-20&roll=10&filter=bilinear" + size,
         "v.pano?src=globe.exr&yaw=30&pitch=-20&roll=10&filter=bilinear" + fov(wider(80)) + larger},
        {"v.pano?src=globe.exr&to=fisheye&fov=150&yaw=30&filter=bilinear" + size,
         "v.pano?src=globe.exr&to=fisheye&fov=210&yaw=30&filter=bilinear" + larger},
        {"v.pano?src=globe.exr&to=formula&ray_z=1.2+0.1*x/width&filter=bilinear" + size,
         "v.pano?src=globe.exr&to=formula&ray_x=(x-24-60)/40&ray_y=(16+40-y)/40&ray_z=1.2+0.1*(x-24)/120"
         "&filter=bilinear" +
             larger},
        {"v.pano?src=globe.exr&to=formula&point_x=lon&point_y=lat+0.1*lon&filter=bilinear" + size,
         "v.pano?src=globe.exr&to=formula&point_x=lon*40/56&point_y=(lat+0.1*lon)*40/56&filter=bilinear" +
             larger},
        {"v.mosaic?src=rings.exr&circles=3&x=0.3&z=0.2&fov=80&filter=bilinear" + size,
         "v.mosaic?src=rings.exr&circles=3&x=0.3&z=0.2&filter=bilinear" + fov(wider(80)) + larger},
        {"v.lens?src=plate.exr&lens=3de4:k1=-0.15&filter=bilinear",
         "v.lens?src=plate.exr&lens=3de4:k1=-0.15&filter=bilinear" + larger},
        {"v.lens?src=plate.exr&mode=distort&lens=division:k1=-0.15&filter=bilinear", ""},
        {"v.map?src=plate.exr&u=x*0.8+5*sin(y/20)&v=y*0.7+s*20&filter=bilinear",
         "v.map?src=plate.exr&u=(x-24)*0.8+5*sin((y-16)/20)&v=(y-16)*0.7+(x-24)/120*20&filter=bilinear" +
             larger},
        {"v.map?src=plate.exr&direction=push&u=x*1.3-20+5*sin(y/20)&v=y*1.2-10&filter=bilinear",
         "v.map?src=plate.exr&direction=push&u=x*1.3-20+5*sin(y/20)+24&v=y*1.2-10+16&filter=bilinear" +
             larger},
        {"v.warp?src=plate.exr&mesh=pull.json&filter=bilinear&wrap=mirror", ""},
        {"v.warp?src=plate.exr&mesh=push.json&filter=bilinear", ""},
        {"v.warp?src=plate.exr&points=points.csv&filter=bilinear&wrap=mirror", ""},
        {"v.morph?a=plate.exr&b=other.exr&features=lines.json&filter=bilinear&wrap=mirror", ""},
        {drape + "&fov=40", drape + fov(wider(40)) + larger},
        {drape + "&view=parallel&extent=2&background=0.1,0.2,0.3",
         drape + "&view=parallel&extent=2.8&background=0.1,0.2,0.3" + larger},
        {"doll.n?size=120x80", ""},
    };
}

// The larger picture is drawn with other blocks: within the tolerance, which is set so that colours hardly differ.
TEST_F(Overscan, IsWhatALargerPictureShows) {
    for (const Scene& scene : scenes()) {
        SCOPED_TRACE(scene.recipe);
        const bool is_drape = scene.recipe.find(".drape") != std::string::npos,
                   has_tol = scene.recipe.find(".n?") == std::string::npos;
        const std::string tol = is_drape ? "&tol=0.001" : has_tol ? "&tol=0.00001" : "";
        const double allowed = is_drape ? 5e-3 : 2e-4;
        const auto input = open(scene.recipe + tol + "&overscan=24x16");
        ASSERT_TRUE(input);
        const OIIO::ImageSpec spec = input->spec();
        EXPECT_EQ(spec.x, -kAcross);
        EXPECT_EQ(spec.y, -kDown);
        EXPECT_EQ(spec.width, kWidth + 2 * kAcross);
        EXPECT_EQ(spec.height, kHeight + 2 * kDown);
        EXPECT_EQ(spec.full_x, 0);
        EXPECT_EQ(spec.full_y, 0);
        EXPECT_EQ(spec.full_width, kWidth);
        EXPECT_EQ(spec.full_height, kHeight);
        const std::vector<float> all = read_floats(scene.recipe + tol + "&overscan=24x16"),
                                 shown = read_floats(scene.recipe + tol);
        const Box inside{kAcross, kDown, kAcross + kWidth, kDown + kHeight};
        EXPECT_LT(largest_difference(cut(all, spec.width, spec.nchannels, inside), shown), allowed);
        if (scene.larger.empty()) continue;
        EXPECT_LT(largest_difference(all, read_floats(scene.larger + tol)), allowed);
        EXPECT_LE(input->spec().get_float_attribute("anamorph:max_error"), is_drape ? 1e-3f : 1e-5f);
    }
}

// What lies beyond the edges is proven as what lies within: no point is farther from the formula than its bound says.
TEST_F(Overscan, IsWithinItsBound) {
    for (const Scene& scene : scenes()) {
        if (scene.recipe.find(".n?") != std::string::npos ||
            scene.recipe.find(".drape") != std::string::npos ||
            scene.recipe.find(".mosaic") != std::string::npos)
            continue;
        for (const std::string tol : {"0.3", "0.003", "0"}) {
            SCOPED_TRACE(scene.recipe + " " + tol);
            const std::string recipe = scene.recipe + "&overscan=30%&tol=" + tol;
            const std::vector<float> errors = read_floats(recipe + "&output=error"),
                                     bounds = read_floats(recipe + "&output=bound");
            ASSERT_EQ(errors.size(), bounds.size());
            float most = 0;
            for (std::size_t i = 0; i < errors.size(); ++i) {
                ASSERT_LE(errors[i], bounds[i] * 1.0001f + 1e-12f) << "pixel " << i;
                most = std::max(most, bounds[i]);
            }
            if (tol != "0") {
                EXPECT_LE(most, std::stof(tol) * 1.0001f);
            }
            EXPECT_FLOAT_EQ(open(recipe)->spec().get_float_attribute("anamorph:max_error"), most);
        }
    }
}

// Beyond a mesh that pulls the map goes on, around one that pushes the picture is what the mesh makes of it, and a morph's
// lines have influence everywhere: an even shift stays even.
TEST_F(Overscan, GoesOnWithMeshesPointsAndMorphs) {
    write_text("shift.json", R"({"columns": 1, "rows": 1, "units": "pixels",
        "vertices": [[30, 20], [90, 20], [30, 60], [90, 60]]})");
    write_text("away.json", R"({"columns": 1, "rows": 1, "units": "pixels", "direction": "push",
        "vertices": [[-60, -40], [180, -40], [-60, 120], [180, 120]]})");
    write_text("halves.csv", "x,y,u,v\n0,0,30,20\n120,0,90,20\n0,80,30,60\n120,80,90,60\n");
    const std::string halves =
        "v.map?src=plate.exr&u=30+x/2&v=20+y/2&filter=bilinear&overscan=20&tol=0.00001";
    const std::vector<float> expected = read_floats(halves);
    for (const char* map : {"mesh=shift.json", "mesh=away.json", "points=halves.csv"}) {
        SCOPED_TRACE(map);
        const std::string warp =
            "v.warp?src=plate.exr&" + std::string(map) + "&filter=bilinear&overscan=20&tol=0.00001";
        EXPECT_LT(largest_difference(read_floats(warp), expected), 1e-4);
    }
    write_text("moved.json", R"({"features": [{"line": [[10, 20, 50, 40], [20, 26, 60, 46]]},
        {"line": [[30, 60, 70, 66], [40, 66, 80, 72]]}]})");
    // At half way every pixel comes from 5 to the left and 3 above in a, and as far the other way in b.
    const std::vector<float>
        morph = read_floats(
            "v.morph?a=plate.exr&b=other.exr&features=moved.json&t_color=0&filter=bilinear"
            "&wrap=black&overscan=20&tol=0.00001"),
        moved = read_floats("v.map?src=plate.exr&u=x-5&v=y-3&filter=bilinear&overscan=20&tol=0.00001");
    EXPECT_LT(largest_difference(morph, moved), 1e-4);
}

TEST_F(Overscan, IsOnePictureHoweverItIsRead) {
    for (const Scene& scene : scenes()) {
        std::string recipe = scene.recipe + "&overscan=150x40";
        // Drapes find how far their picture is seen anew for each size.
        if (recipe.find("v.") != 0) continue;
        expect_one_picture(recipe, -70, -20);
    }
}

// The picture shows its own pixels, whatever is drawn beyond.
TEST_F(Overscan, ChangesNoPixelInside) {
    for (const std::string recipe :
         {"v.pano?src=globe.exr&fov=80&yaw=30&size=600x500", "v.map?src=globe.exr&u=x+5*sin(y/20)&v=y",
          "v.lens?src=globe.exr&lens=3de4:k1=-0.15", "v.morph?a=plate.exr&b=other.exr&features=lines.json"}) {
        SCOPED_TRACE(recipe);
        const Pixels all = read_pixels(recipe + "&overscan=31x300"), shown = read_pixels(recipe);
        const int width = shown.spec.width, height = shown.spec.height;
        std::vector<float> a(all.bytes.size() / 4), b(shown.bytes.size() / 4);
        std::memcpy(a.data(), all.bytes.data(), all.bytes.size());
        std::memcpy(b.data(), shown.bytes.data(), shown.bytes.size());
        const Box whole_regions{31, 300, 31 + width / 256 * 256, 300 + height / 256 * 256};
        // Regions on the right and lower edges are others.
        EXPECT_EQ(cut(a, all.spec.width, 3, whole_regions),
                  cut(b, width, 3, {0, 0, width / 256 * 256, height / 256 * 256}));
    }
}

TEST_F(Overscan, IsKeptByStockPrograms) {
    ASSERT_EQ(run("oiiotool 'v.pano?src=globe.exr&size=100x60&overscan=10%' -o out.exr").status, 0);
    const Pixels out = read_pixels("out.exr");
    EXPECT_EQ(out.spec.x, -10);
    EXPECT_EQ(out.spec.y, -6);
    EXPECT_EQ(out.spec.width, 120);
    EXPECT_EQ(out.spec.full_width, 100);
    // Read again, it is a source with overscan: turned by an eighth, the camera still has something to show.
    const std::vector<float> seen = read_floats("out.exr.map?u=x+8&v=y&filter=nearest");
    const std::vector<float> whole =
        read_floats("v.map?src=(v.pano?src=globe.exr&size=100x60&overscan=10%)&u=x+8&v=y&filter=nearest");
    EXPECT_EQ(seen, whole);
    EXPECT_GT(seen[3 * 99], 0);
}

// A chain reads what the picture in the middle has beyond its edges, and no more.
TEST_F(Overscan, IsReadThroughChains) {
    const struct {
        const char *inner, *chain;
    } cases[] = {
        {"plate.exr.map?u=x*0.8+7&v=y*0.9+5&overscan=20x12", "map of map"},
        {"plate.exr.lens?lens=3de4:k1=0.2&overscan=20x12", "map of lens"},
        {"plate.exr.pano?from=rectilinear&srcfov=90&fov=60&size=120x80&overscan=20x12", "map of pano"},
        {"plate.exr.lens?lens=3de4:k1=0.2&size=all", "map of lens"}};
    for (const auto& c : cases) {
        SCOPED_TRACE(c.inner);
        const std::string outer = "v.map?u=x*1.2-14&v=y*1.1-8&filter=bilinear&tol=0.00001",
                          chain = outer + "&src=(" + c.inner + "&filter=bilinear&tol=0.00001)";
        EXPECT_EQ(open(chain)->spec().get_string_attribute("anamorph:chain"), c.chain);
        draw(std::string(c.inner) + "&tol=0.00001&output=coverage&filter=nearest", "cover.exr");
        // Where the picture in the middle has pixels of the plate, around a point and beside it, the chain shows them.
        const std::vector<float> joined = read_floats(chain + "&output=coverage"),
                                 cover = read_floats(outer + "&concatenate=0&src=cover.exr");
        std::size_t shown = 0, differ = 0;
        for (std::size_t i = 0; i < cover.size(); ++i) {
            shown += cover[i] == 1;
            differ += (cover[i] == 1 && joined[i] < 0.5f) || (cover[i] == 0 && joined[i] > 0.5f);
        }
        EXPECT_GT(shown, cover.size() / 2);
        EXPECT_LT(differ, cover.size() / 100);
        EXPECT_GT(joined[120 * 40 + 8], 0.9f);  // left of the display window of the picture in the middle
        const std::vector<float> errors = read_floats(chain + "&output=error"),
                                 bounds = read_floats(chain + "&output=bound");
        for (std::size_t i = 0; i < errors.size(); ++i)
            ASSERT_LE(errors[i], bounds[i] * 1.0001f + 1e-12f) << i;
    }
}

// A display window that does not begin at 0,0 stays where it is in pictures of the same format; what is in it is the same.
TEST_F(Overscan, DisplayWindowsStayWhereTheyAre) {
    OIIO::ImageBuf plate = panorama(64, 48);
    write_image(plate, "plate.exr");
    plate.specmod().x = plate.specmod().full_x = 30;
    plate.specmod().y = plate.specmod().full_y = -7;
    write_image(plate, "moved.exr");
    write_text("grid.json", R"({"columns": 1, "rows": 1, "units": "fractions",
                                "vertices": [[0.1, -0.1], [1, 0.1], [0, 0.9], [1.2, 1]]})");
    write_text("lines.csv", "10,10,40,20,12,14,41,18\n");
    const auto windows = [](const std::string& name) {
        const auto input = open(name);
        return input ? std::vector<int>{input->spec().x, input->spec().y, input->spec().full_x,
                                        input->spec().full_y}
                     : std::vector<int>();
    };
    for (const char* keys : {".lens?lens=3de4:k1=-0.1", ".map?u=x+3&v=y*0.9", ".warp?mesh=grid.json",
                             ".morph?b=plate.exr&features=lines.csv", ".map?u=x+3&v=y&overscan=5"}) {
        SCOPED_TRACE(keys);
        const int over = std::string(keys).find("overscan") == std::string::npos ? 0 : 5;
        EXPECT_EQ(read_floats(std::string("moved.exr") + keys), read_floats(std::string("plate.exr") + keys));
        EXPECT_EQ(windows(std::string("moved.exr") + keys), (std::vector<int>{30 - over, -7 - over, 30, -7}));
        EXPECT_EQ(windows(std::string("plate.exr") + keys), (std::vector<int>{-over, -over, 0, 0}));
    }
    // Pictures of another format, and of levels, begin at 0,0.
    for (const char* keys :
         {".map?u=x&v=y&size=20x10", ".pano?from=rectilinear&srcfov=60&size=64x48", ".map?u=x&v=y&mip=1"})
        EXPECT_EQ(windows(std::string("moved.exr") + keys), (std::vector<int>{0, 0, 0, 0})) << keys;
    // A recipe of a recipe, joined and not, and what stock programs write.
    for (const char* joined : {"0", "1"}) {
        const std::string chain =
            std::string("x.map?u=x&v=y+1&concatenate=") + joined + "&src=(moved.exr.lens?lens=3de4:k1=-0.1)";
        EXPECT_EQ(windows(chain), (std::vector<int>{30, -7, 30, -7}));
        EXPECT_EQ(read_floats(chain), read_floats(std::string("x.map?u=x&v=y+1&concatenate=") + joined +
                                                  "&src=(plate.exr.lens?lens=3de4:k1=-0.1)"));
    }
    ASSERT_EQ(run("oiiotool 'moved.exr.lens?lens=3de4:k1=-0.1' -o written.exr").status, 0);
    EXPECT_EQ(windows("written.exr"), (std::vector<int>{30, -7, 30, -7}));
    // Some pixels of it alone, as a cache and scanlines read them.
    expect_one_picture("moved.exr.lens?lens=3de4:k1=-0.1", 10, 8);
}

TEST_F(Overscan, IsRefusedWhereItCannotBe) {
    const auto refused = [](const std::string& recipe, const char* why) {
        EXPECT_THAT(open_error(recipe), HasSubstr(why)) << recipe;
    };
    for (const char* bad :
         {"-1", "1.5", "x", "5%x", "x5", "nan", "inf", "1048577", "1e300", "5%%", "%", "3x4x5", "-0.1%"})
        refused("v.map?src=plate.exr&overscan=" + std::string(bad), "overscan");
    refused("v.map?src=plate.exr&overscan=600000", "makes 1200120x1200080 pixels");
    refused("v.map?src=plate.exr&overscan=1e9%", "must be whole pixels or per cent");
    refused("v.pano?src=globe.exr&to=cubemap&overscan=5", "must be of a picture in one piece");
    refused("v.pano?src=globe.exr&scheme=hardware&overscan=5", "must not be given with scheme=hardware");
    refused("v.lens?src=plate.exr&lens=3de4:k1=0.1&size=all&overscan=5", "together with size=all");
    refused("v.warp?src=plate.exr&mesh=pull.json&amount=0.5&overscan=5", "together with amount");
    ASSERT_EQ(run("oiiotool 'v.map?src=plate.exr&output=stmap' -o st.exr").status, 0);
    refused("v.warp?src=plate.exr&mesh=st.exr&overscan=5", "of an ST-map");
    // None is none.
    for (const char* none : {"0", "0%", "0x0"})
        EXPECT_EQ(read_pixels("v.map?src=plate.exr&overscan=" + std::string(none)),
                  read_pixels("v.map?src=plate.exr"));
}

}  // namespace
}  // namespace anamorph::test_overscan
