// SPDX-License-Identifier: Apache-2.0
// .lens by stock programs: against the formula, against the panorama through the same lens, there and back.
#include <OpenImageIO/imagebufalgo.h>

#include <cmath>

#include "anamorph/oiio_ops.h"
#include "host.h"

namespace anamorph::test_lens {
namespace {

using namespace testing_oiio;
using testing::AllOf;
using testing::HasSubstr;

constexpr int kWidth = 192, kHeight = 128;

class LensRecipe : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        // Every pixel says where it is.
        OIIO::ImageBuf ramp(OIIO::ImageSpec(kWidth, kHeight, 3, OIIO::TypeFloat));
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const float value[] = {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, 1};
                ramp.setpixel(x, y, value);
            }
        write_image(ramp, "ramp.exr");
    }
};

TEST_F(LensRecipe, IsTheModelsFormula) {
    // PanoTools: radii in half of the smaller side, r (b r^2 + 1 - b), about a centre that is moved by d and e, and stays there.
    const std::vector<float> uv =
        read_floats("ramp.exr.lens?lens=ptlens:b=-0.08,d=3,e=-2&output=stmap&tol=0.0001");
    double worst = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double u = x + 0.5 - kWidth / 2.0 - 3, v = y + 0.5 - kHeight / 2.0 + 2,
                         r = std::hypot(u, v) / (kHeight / 2.0);
            const double scale = -0.08 * r * r + 1.08;
            const auto at = static_cast<std::size_t>(2 * (y * kWidth + x));
            worst = std::max({worst, std::fabs(double{uv[at]} * kWidth - (u * scale + kWidth / 2.0 + 3)),
                              std::fabs(double{uv[at + 1]} * kHeight - (v * scale + kHeight / 2.0 - 2))});
        }
    EXPECT_LT(worst, 1.5e-4);  // tol, and the rounding of an ST-map in float
}

// A panorama that leaves the projection alone does the same by way of rays, of a lens in the picture's middle: the axis of a
// panorama is in the middle of a picture without a lens.
TEST_F(LensRecipe, IsThePanoramaThroughTheSameLens) {
    for (const char* lens : {"brown:k1=-0.2,k2=0.05,p1=0.003,p2=-0.002", "3de4:k1=0.1,k2=0.03"})
        for (const bool undistort : {true, false}) {
            SCOPED_TRACE(std::string(lens) + (undistort ? " undistort" : " distort"));
            const std::string flat =
                "ramp.exr.lens?fov=84&output=stmap&tol=0.0001&lens=" + std::string(lens) +
                (undistort ? "" : "&mode=distort");
            const std::string pano =
                "ramp.exr.pano?from=rectilinear&to=rectilinear&srcfov=84&fov=84&size=192x128&output=stmap&"
                "tol=0.0001&" +
                std::string(undistort ? "srclens=" : "lens=") + lens;
            EXPECT_LT(largest_difference(read_floats(flat), read_floats(pano)), 5e-6);
        }
}

// Whole regions of blocks lie beyond the picture, where nothing else would be drawn.
TEST_F(LensRecipe, StmapsGoOnBeyondThePicture) {
    const std::string stmap = "ramp.exr.lens?lens=3de4:k1=0.02,k2=0.005&output=stmap&size=1200x900";
    const std::vector<float> uv = read_floats(stmap);
    EXPECT_LT(uv[0], -1.1f);
    EXPECT_LT(uv[1], -1.1f);
    EXPECT_EQ(largest_difference(uv, read_floats(stmap + "&wrap=clamp")), 0);
}

TEST_F(LensRecipe, SizeAllKeepsAllAndComesBack) {
    const std::string lens = "lens=brown:k1=-0.25,k2=0.06,p1=0.002&fov=70&filter=bilinear&wrap=clamp";
    const Ran there = run("oiiotool 'ramp.exr.lens?" + lens + "&size=all' -o flat.exr");
    ASSERT_EQ(there.status, 0) << there.text;
    // The plate's format, with all that is left of it around.
    const Pixels flat = read_pixels("flat.exr");
    EXPECT_GT(flat.spec.width, kWidth);
    EXPECT_EQ(flat.spec.width, kWidth - 2 * flat.spec.x);
    EXPECT_GT(flat.spec.height, kHeight);
    EXPECT_EQ(flat.spec.height, kHeight - 2 * flat.spec.y);
    EXPECT_EQ(OIIO::ROI(flat.spec.full_x, flat.spec.full_width, flat.spec.full_y, flat.spec.full_height),
              OIIO::ROI(0, kWidth, 0, kHeight));
    const Ran back = run("oiiotool 'flat.exr.lens?mode=distort&" + lens + "' -o back.exr");
    ASSERT_EQ(back.status, 0) << back.text;
    // What lies between pixels of the flat picture is interpolated, twice; along the edge, beyond the source too.
    const std::vector<float> a = read_floats("ramp.exr"), b = read_floats("back.exr");
    double worst = 0;
    for (int y = 2; y < kHeight - 2; ++y)
        for (int x = 2; x < kWidth - 2; ++x)
            for (int c = 0; c < 2; ++c) {
                const auto at = static_cast<std::size_t>(3 * (y * kWidth + x) + c);
                worst = std::max(worst, std::fabs(double{a[at]} - b[at]));
            }
    EXPECT_LT(worst, 0.05);
}

// A plate with pixels beyond its format, as stock oiiotool shows it through an ST-map.
TEST_F(LensRecipe, PixelsBeyondTheFormatAreSeen) {
    OIIO::ImageSpec spec(240, 140, 3, OIIO::TypeFloat);
    spec.x = spec.y = -20;
    spec.full_width = 200;
    spec.full_height = 100;
    for (const int orientation : {1, 6}) {
        SCOPED_TRACE(orientation);
        OIIO::ImageBuf plate(spec);
        for (int y = -20; y < 120; ++y)
            for (int x = -20; x < 220; ++x) {
                const float value[] = {static_cast<float>(x) + 100.5f, static_cast<float>(y) + 100.5f, 1};
                plate.setpixel(x, y, value);
            }
        plate.specmod().attribute("Orientation", orientation);
        write_image(plate, "over.exr");
        const bool turned = orientation == 6;
        const int width = turned ? 100 : 200, height = turned ? 200 : 100;
        for (const char* filter : {"nearest", "bilinear", "antialias"}) {
            SCOPED_TRACE(filter);
            const std::string recipe = std::string("over.exr.lens?lens=3de4:k1=-0.1&filter=") + filter;
            const std::vector<float> seen = read_floats(recipe), uv = read_floats(recipe + "&output=stmap");
            ASSERT_EQ(seen.size(), static_cast<std::size_t>(3 * width * height));
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const auto i = static_cast<std::size_t>(y * width + x);
                    const double u = uv[2 * i] * double(width), v = uv[2 * i + 1] * double(height);
                    // Orientation 6: stored columns are rows from the top, stored rows are columns from the right.
                    const double across = turned ? v : u, down = turned ? width - u : v;
                    ASSERT_EQ(seen[3 * i + 2], 1) << x << " " << y;
                    const double most = filter[0] == 'n' ? 0.51 : 0.02;
                    ASSERT_NEAR(seen[3 * i], across + 100, most) << x << " " << y;
                    ASSERT_NEAR(seen[3 * i + 1], down + 100, most) << x << " " << y;
                }
            const std::vector<float> all = read_floats(recipe + "&size=all");
            const Pixels window = read_pixels(recipe + "&size=all");
            EXPECT_LE(window.spec.x, 0);
            EXPECT_EQ(window.spec.full_width, width);
            // The same picture where both are.
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const auto i = static_cast<std::size_t>(3 * (y * width + x)),
                               k = static_cast<std::size_t>(
                                   3 * ((y - window.spec.y) * window.spec.width + x - window.spec.x));
                    ASSERT_NEAR(all[k], seen[i], filter[0] == 'n' ? 1 : 0.1);
                }
        }
    }
    // Far beyond it too, where blocks of nothing else are left out.
    OIIO::ImageSpec wide(1000, 60, 3, OIIO::TypeHalf);
    wide.x = -900;
    wide.full_width = wide.full_height = 60;
    OIIO::ImageBuf strip(wide);
    const float white[] = {1, 1, 1};
    OIIO::ImageBufAlgo::fill(strip, white);
    write_image(strip, "wide.exr");
    for (const char* recipe : {"wide.exr.map?u=x-880&size=900x60",
                               "wide.exr.pano?from=rectilinear&srcfov=10&fov=80&yaw=-30&size=300x10"}) {
        const std::vector<float> seen = read_floats(recipe);
        EXPECT_EQ(seen[3 * 5], 1) << recipe;
    }
    // A recipe reads what is beyond the format of another's picture.
    const std::vector<float> twice =
        read_floats("x.lens?lens=3de4:k1=0.02&src=over.exr.lens?lens=3de4:k1=-0.1&size=all");
    for (std::size_t i = 2; i < twice.size(); i += 3) ASSERT_EQ(twice[i], 1) << i;
}

TEST_F(LensRecipe, FunctionsDrawWindowsToo) {
    const OIIO::ImageBuf plate("ramp.exr");
    const auto lens = options({{"lens", "3de4:k1=-0.2"}, {"size", "all"}, {"mode", "distort"}});
    const OIIO::ImageBuf all = apply("lens", {&plate}, lens);
    ASSERT_FALSE(all.has_error()) << all.geterror();
    const OIIO::ImageSpec& spec = all.spec();
    EXPECT_LT(spec.x, 0);
    EXPECT_EQ(spec.x + spec.width, kWidth - spec.x);
    EXPECT_EQ(spec.full_width, kWidth);
    EXPECT_EQ(all.getchannel(kWidth / 2, kHeight / 2, 0, 2), 1);
    // A part of it.
    OIIO::ImageBuf part;
    const OIIO::ROI roi(spec.x, spec.x + 40, spec.y, 20);
    ASSERT_TRUE(apply(part, "lens", {&plate}, lens, roi)) << part.geterror();
    for (int y = roi.ybegin; y < roi.yend; ++y)
        for (int x = roi.xbegin; x < roi.xend; ++x)
            for (int c = 0; c < 3; ++c) ASSERT_EQ(part.getchannel(x, y, 0, c), all.getchannel(x, y, 0, c));
    // The recipe is the function.
    EXPECT_EQ(read_pixels("ramp.exr.lens?lens=3de4:k1=-0.2&size=all&mode=distort").bytes, bytes(all));
}

TEST_F(LensRecipe, TheImageSaysItsLens) {
    write_panorama("city.exr", 512, 256);
    const Ran made =
        run("oiiotool 'city.exr.pano?to=rectilinear&fov=84&size=192x128&lens=brown:k1=-0.1,k2=0.01' -o "
            "plate.exr");
    ASSERT_EQ(made.status, 0) << made.text;
    EXPECT_EQ(read_pixels("plate.exr.lens").bytes,
              read_pixels("plate.exr.lens?lens=brown:k1=-0.1,k2=0.01&fov=84").bytes);
}

TEST_F(LensRecipe, RefusesWhatItCannotDo) {
    EXPECT_THAT(open_error("ramp.exr.lens"), HasSubstr("lens is not given"));
    EXPECT_THAT(open_error("ramp.exr.lens?lens=none"), HasSubstr("lens=none: must be a lens"));
    EXPECT_THAT(open_error("ramp.exr.lens?lens=brown:k1=0.1"), HasSubstr("fov is not given"));
    EXPECT_THAT(open_error("ramp.exr.lens?lens=brown:k1=0.1&fov=180"), HasSubstr("fov=180"));
    EXPECT_THAT(open_error("ramp.exr.lens?lens=brown:k1=-0.5&fov=120"),
                AllOf(HasSubstr("lens=brown:k1=-0.5"), HasSubstr("folds")));
    EXPECT_THAT(open_error("ramp.exr.lens?lens=ptlens:b=nan"), HasSubstr("lens"));
    EXPECT_THAT(open_error("ramp.exr.lens?lens=ptlens:b=-0.02&size=some"), HasSubstr("or all"));
    EXPECT_THAT(open_error("ramp.exr.lens?lens=ptlens:b=-0.02&mode=both"), HasSubstr("undistort, distort"));
}

// Both ways the picture says what it shows, so that no key is needed to read it.
TEST_F(LensRecipe, SaysWhatItsPictureIs) {
    write_panorama("plate.exr", 96, 64);
    const auto said = [](const std::string& name) {
        return std::string(open(name)->spec().get_string_attribute("panoramaProjection"));
    };
    const std::string lens = "lens=brown:k1=-0.1,k2=0.02&fov=70";
    EXPECT_EQ(said("plate.exr.lens?" + lens), "rectilinear fov=70");
    EXPECT_EQ(said("plate.exr.lens?mode=distort&" + lens), "rectilinear fov=70 lens=brown:k1=-0.1,k2=0.02");
    EXPECT_EQ(said("plate.exr.lens?mode=distort&lens=kb4:k1=0.05&fov=150"),
              "fisheye fov=150 lens=kb4:k1=0.05");
    // Twice as many pixels of the same size show more; what has no field of view says none.
    EXPECT_EQ(said("plate.exr.lens?size=192x128&" + lens).substr(0, 21), "rectilinear fov=108.9");
    EXPECT_EQ(said("plate.exr.lens?lens=3de4:k1=-0.1"), "");
    // Others do not need theirs, but say it where it is known.
    EXPECT_EQ(said("plate.exr.lens?lens=3de4:k1=-0.1&fov=84"), "rectilinear fov=84");
    OIIO::ImageBuf plate("plate.exr");
    plate.read(0, 0, true);
    plate.specmod().attribute("panoramaProjection", "rectilinear fov=84");
    ASSERT_TRUE(plate.write("said.exr"));
    EXPECT_EQ(said("said.exr.lens?lens=ptlens:b=-0.02"), "rectilinear fov=84");
    EXPECT_EQ(said("said.exr.lens?lens=3de4:k1=-0.1&fov=60"), "rectilinear fov=60");
    EXPECT_EQ(said("said.exr.lens?lens=division:k1=-0.1&mode=distort"),
              "rectilinear fov=84 lens=division:k1=-0.1");
    EXPECT_EQ(said("said.exr.lens?lens=3de4:k1=-0.1&mode=distort&size=all"), "");
    EXPECT_EQ(read_floats("said.exr.lens?lens=3de4:k1=-0.1&fov=60"),
              read_floats("plate.exr.lens?lens=3de4:k1=-0.1"));
    EXPECT_THAT(open_error("plate.exr.lens?lens=3de4:k1=-0.1&fov=180"), HasSubstr("fov=180"));
    ASSERT_EQ(run("oiiotool 'said.exr.lens?mode=distort&lens=3de4:k1=-0.1' -o bent_by_size.exr").status, 0);
    EXPECT_EQ(read_floats("bent_by_size.exr.pano?fov=60&size=40x30"),
              read_floats(
                  "bent_by_size.exr.pano?from=rectilinear&srcfov=84&srclens=3de4:k1=-0.1&fov=60&size=40x30"));
    ASSERT_EQ(run("oiiotool 'plate.exr.lens?mode=distort&" + lens + "' -o bent.exr").status, 0);
    EXPECT_EQ(
        read_floats("bent.exr.pano?fov=60&size=40x30"),
        read_floats(
            "bent.exr.pano?from=rectilinear&srcfov=70&srclens=brown:k1=-0.1,k2=0.02&fov=60&size=40x30"));
}

}  // namespace
}  // namespace anamorph::test_lens
