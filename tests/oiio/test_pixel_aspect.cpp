// SPDX-License-Identifier: Apache-2.0
// Sources whose pixels are not square, by PixelAspectRatio: each operation against its formula, written out in such pixels.
#include <OpenImageIO/imagebufalgo.h>

#include <cmath>
#include <numbers>

#include "host.h"

namespace anamorph::test_pixel_aspect {
namespace {

using namespace testing_oiio;
using testing::HasSubstr;

constexpr int kWidth = 120, kHeight = 100;
constexpr double kAspect = 2;

class PixelAspect : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write("plate.exr", kWidth, kHeight, kAspect);
        write_text("grid.json", R"({"columns": 1, "rows": 1, "units": "fractions", "vertices": [
            [0.1, 0.05], [0.9, 0], [0, 1], [1, 0.9]]})");
        write_text("lines.json", R"({"features": [{"line": [[40, 30, 80, 40], [50, 25, 90, 50]]}]})");
    }
    static void write(const std::string& name, int width, int height, double aspect) {
        OIIO::ImageBuf image = panorama(width, height);
        image.specmod().attribute("PixelAspectRatio", static_cast<float>(aspect));
        write_image(image, name);
    }
    /// Source points in pixels of an ST-map of the plate against a formula; the largest distance.
    template <class Formula>
    static double worst_of(const std::string& recipe, int width, int height, const Formula& formula) {
        const std::vector<float> uv = read_floats(recipe + "&output=stmap&tol=0.0001");
        EXPECT_EQ(uv.size(), static_cast<std::size_t>(2 * width * height));
        double worst = 0;
        int counted = 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const auto at = static_cast<std::size_t>(2 * (y * width + x));
                const auto [u, v] = formula(x + 0.5, y + 0.5);
                if (!(std::fabs(u) < 1e4 && std::fabs(v) < 1e4) || uv[at] == -1) continue;
                ++counted;
                worst = std::max(worst,
                                 std::hypot(double{uv[at]} * kWidth - u, double{uv[at + 1]} * kHeight - v));
            }
        EXPECT_GT(counted, width * height / 2);
        return worst;
    }
    static float aspect_of(const std::string& recipe) {
        const auto input = open(recipe);
        return input ? input->spec().get_float_attribute("PixelAspectRatio", 1.0f) : 0;
    }
};

// Radii are those of the scene: x counts twice.
TEST_F(PixelAspect, OfALensIsThatOfItsCircle) {
    // 3DEqualizer: u (1 + k1 r^2 + k2 r^4), r in half diagonals, of a point d and e beside the middle.
    const double half_diagonal = std::hypot(kWidth * kAspect, kHeight) / 2;
    EXPECT_LT(worst_of("plate.exr.lens?lens=3de4:k1=0.08,k2=0.02,d=3,e=-4&mode=distort", kWidth, kHeight,
                       [&](double x, double y) {
                           const double px = x - kWidth / 2.0 - 3, py = y - kHeight / 2.0 + 4,
                                        r2 = (px * kAspect * px * kAspect + py * py) /
                                             (half_diagonal * half_diagonal),
                                        scale = 1 + 0.08 * r2 + 0.02 * r2 * r2;
                           return std::pair(px * scale + kWidth / 2.0 + 3, py * scale + kHeight / 2.0 - 4);
                       }),
              1.5e-4);
    // PanoTools: in halves of the smaller side, of a scene of 240 x 100.
    EXPECT_LT(worst_of("plate.exr.lens?lens=ptlens:b=-0.02,c=0.01", kWidth, kHeight,
                       [&](double x, double y) {
                           const double px = x - kWidth / 2.0, py = y - kHeight / 2.0,
                                        r = std::hypot(px * kAspect, py) / (kHeight / 2.0),
                                        scale = -0.02 * r * r + 0.01 * r + 1.01;
                           return std::pair(px * scale + kWidth / 2.0, py * scale + kHeight / 2.0);
                       }),
              1.5e-4);
    // OpenCV: focal lengths fx and fy in pixels, fy = aspect fx.
    const double fx = kWidth / 2.0 / std::tan(70 / 2.0 * std::numbers::pi / 180), fy = kAspect * fx;
    const auto brown = [&](double x, double y) {
        const double a = (x - kWidth / 2.0) / fx, b = (y - kHeight / 2.0) / fy, r2 = a * a + b * b,
                     s = 1 - 0.2 * r2 + 0.05 * r2 * r2;
        return std::pair(fx * (a * s + 2 * 0.003 * a * b - 0.002 * (r2 + 2 * a * a)) + kWidth / 2.0,
                         fy * (b * s + 0.003 * (r2 + 2 * b * b) - 2 * 0.002 * a * b) + kHeight / 2.0);
    };
    const std::string lens = "plate.exr.lens?fov=70&lens=brown:k1=-0.2,k2=0.05,p1=0.003,p2=-0.002";
    EXPECT_LT(worst_of(lens, kWidth, kHeight, brown), 1.5e-4);
    // A larger picture is as fine, about the same middle.
    EXPECT_LT(
        worst_of(lens + "&size=160x120", 160, 120, [&](double x, double y) { return brown(x - 20, y - 10); }),
        1.5e-4);
    // All of it comes back.
    ASSERT_EQ(run("oiiotool '" + lens + "&size=all&filter=bicubic' -o flat.exr").status, 0);
    EXPECT_EQ(aspect_of("flat.exr"), 2);
    ASSERT_EQ(run("oiiotool "
                  "'flat.exr.lens?mode=distort&fov=70&filter=bicubic&lens=brown:k1=-0.2,k2=0.05,p1=0.003,p2=-"
                  "0.002' "
                  "-o back.exr")
                  .status,
              0);
    const std::vector<float> back = read_floats("back.exr"), plate = read_floats("plate.exr");
    double sum = 0;
    int count = 0;
    for (int y = 10; y < kHeight - 10; ++y)
        for (int x = 10; x < kWidth - 10; ++x, ++count)
            sum += std::fabs(double{back[static_cast<std::size_t>(3 * (y * kWidth + x))]} -
                             double{plate[static_cast<std::size_t>(3 * (y * kWidth + x))]});
    EXPECT_LT(sum / count, 0.02);
}

// Turned by yaw, then tilted: rays of square pixels, and the source's own of fx and fy = aspect fx.
TEST_F(PixelAspect, OfAPanoramaIsItsVerticalFieldOfView) {
    const double radian = std::numbers::pi / 180, yaw = 12 * radian, pitch = 7 * radian;
    const double fx = kWidth / 2.0 / std::tan(95 / 2.0 * radian), fy = kAspect * fx,
                 f = 80 / 2.0 / std::tan(40 / 2.0 * radian);
    const auto ray = [&](double x, double y) {
        const double a = (x - 40) / f, b = (30 - y) / f;  // right and up
        const double up = b * std::cos(pitch) + std::sin(pitch),
                     ahead = std::cos(pitch) - b * std::sin(pitch);
        return std::array{a * std::cos(yaw) + ahead * std::sin(yaw), up,
                          ahead * std::cos(yaw) - a * std::sin(yaw)};
    };
    const std::string view = "plate.exr.pano?fov=40&yaw=12&pitch=7&size=80x60&";
    EXPECT_LT(worst_of(view + "from=rectilinear&srcfov=95", 80, 60,
                       [&](double x, double y) {
                           const auto [right, up, ahead] = ray(x, y);
                           return std::pair(fx * right / ahead + kWidth / 2.0,
                                            kHeight / 2.0 - fy * up / ahead);
                       }),
              2e-4);
    // A fisheye: the angle from the axis along the scene's own direction.
    const double per_radian = kWidth / (150 * radian);
    EXPECT_LT(worst_of(view + "from=fisheye&srcfov=150", 80, 60,
                       [&](double x, double y) {
                           const auto [right, up, ahead] = ray(x, y);
                           const double side = std::hypot(right, up), t = std::atan2(side, ahead) / side;
                           return std::pair(per_radian * t * right + kWidth / 2.0,
                                            kHeight / 2.0 - kAspect * per_radian * t * up);
                       }),
              2e-4);
    // Said otherwise: by srcvfov, which wins.
    const double vfov = 2 * std::atan(kHeight / 2.0 / fy) / radian;
    write("square.exr", kWidth, kHeight, 1);
    const std::string turned = ".pano?fov=40&yaw=12&size=80x60&from=rectilinear&srcfov=95";
    EXPECT_LT(largest_difference(read_floats("plate.exr" + turned),
                                 read_floats("square.exr" + turned + "&srcvfov=" + shortest(vfov))),
              1e-5);
    EXPECT_EQ(read_floats("plate.exr" + turned + "&srcvfov=50"),
              read_floats("square.exr" + turned + "&srcvfov=50"));
    // With a vertical field of view alone the horizontal one follows.
    EXPECT_LT(
        largest_difference(
            read_floats("plate.exr.pano?fov=40&yaw=12&size=80x60&from=rectilinear&srcvfov=" + shortest(vfov)),
            read_floats("plate.exr" + turned)),
        1e-5);
    // By Exif: 28 mm on film of the same diagonal.
    OIIO::ImageBuf photo = panorama(kWidth, kHeight);
    photo.specmod().attribute("PixelAspectRatio", 2.0f);
    photo.specmod().attribute("Exif:FocalLengthIn35mmFilm", 28);
    write_image(photo, "photo.exr");
    const double across = 28 * std::hypot(2 * kWidth, kHeight) / std::hypot(36, 24) / 2;
    const double exif_fov = 2 * std::atan(kWidth / 2.0 / across) / radian;
    EXPECT_LT(largest_difference(read_floats("photo.exr.pano?fov=40&size=80x60&from=rectilinear"),
                                 read_floats("plate.exr.pano?fov=40&size=80x60&from=rectilinear&srcfov=" +
                                             shortest(exif_fov))),
              1e-5);
    EXPECT_EQ(aspect_of("plate.exr" + turned), 1);
}

// A whole panorama, squeezed to a square, is one.
TEST_F(PixelAspect, OfAWholePanoramaIsItsShape) {
    write("squeezed.exr", 128, 128, 2);
    write("plain.exr", 128, 128, 1);
    EXPECT_THAT(open("squeezed.exr.pano")->spec().get_string_attribute("anamorph:from"),
                HasSubstr("equirectangular (assumed from the 2:1 shape"));
    for (const std::string view : {"&size=60x40&pitch=80", "&to=fisheye&fov=360&size=60"})
        EXPECT_EQ(read_floats("squeezed.exr.pano?from=latlong" + view),
                  read_floats("plain.exr.pano?from=latlong&srcvfov=180" + view));
    // A part of it, by key, is as oblong as the whole.
    EXPECT_LT(
        largest_difference(
            read_floats("squeezed.exr.pano?from=latlong&srccrop=256x256+60+40&size=60x40&fov=60"),
            read_floats("plain.exr.pano?from=latlong&srccrop=256x256+60+40&srcvfov=180&size=60x40&fov=60")),
        1e-5);
}

TEST_F(PixelAspect, IsThatOfPicturesOfTheSamePixels) {
    for (const std::string recipe :
         {"plate.exr.lens?lens=3de4:k1=0.1", "plate.exr.lens?lens=3de4:k1=0.1&size=200x300",
          "plate.exr.lens?lens=3de4:k1=0.1&size=all", "plate.exr.lens?lens=3de4:k1=0.1&overscan=10",
          "plate.exr.map?u=x+3&v=y", "plate.exr.map?u=x+3&overscan=5", "plate.exr.warp?mesh=grid.json",
          "plate.exr.warp?mesh=grid.json&overscan=4", "plate.exr.morph?b=plate.exr&features=lines.json",
          "v.map?u=x&v=y&src=(plate.exr.lens?lens=3de4:k1=0.1)"})
        EXPECT_EQ(aspect_of(recipe), 2) << recipe;
    for (const std::string recipe :
         {"plate.exr.map?u=x+3&size=240x100", "plate.exr.warp?mesh=grid.json&size=64",
          "plate.exr.morph?b=plate.exr&features=lines.json&size=99x100", "plate.exr.drape"})
        EXPECT_EQ(aspect_of(recipe), 1) << recipe;
    // Positions are those of pixels.
    write("square.exr", kWidth, kHeight, 1);
    for (const std::string recipe : {".map?u=x*0.9+3&v=y+2*sin(x/9)", ".warp?mesh=grid.json"})
        EXPECT_EQ(read_floats("plate.exr" + recipe), read_floats("square.exr" + recipe)) << recipe;
    // As written and read by stock programs; turned by a quarter pixels are higher than wide.
    ASSERT_EQ(run("oiiotool 'plate.exr.lens?lens=3de4:k1=0.1' -o out.exr").status, 0);
    EXPECT_EQ(open("out.exr")->spec().get_float_attribute("PixelAspectRatio"), 2);
    ASSERT_EQ(run("oiiotool plate.exr --orientation 6 -o turned.exr").status, 0);
    EXPECT_EQ(aspect_of("turned.exr.map?u=x&v=y"), 0.5f);
    // ST-maps may be as oblong as they are.
    ASSERT_EQ(
        run("oiiotool 'plate.exr.lens?lens=3de4:k1=0.1&output=stmap' --attrib PixelAspectRatio 2.0 -o st.exr")
            .status,
        0);
    EXPECT_EQ(aspect_of("plate.exr.warp?mesh=st.exr"), 2);
}

TEST_F(PixelAspect, OfADrapeIsTheShapeOfThePicture) {
    EXPECT_EQ(open("plate.exr.drape")->spec().width, 2 * kWidth);
    // Seen straight on, the flat picture fills its screen: each texel is two pixels wide.
    const std::vector<float> flat = read_floats("plate.exr.drape?filter=nearest"),
                             plate = read_floats("plate.exr");
    for (int y = 1; y + 1 < kHeight; ++y)
        for (int x = 1; x + 1 < 2 * kWidth; ++x)
            ASSERT_EQ(flat[static_cast<std::size_t>(3 * (y * 2 * kWidth + x))],
                      plate[static_cast<std::size_t>(3 * (y * kWidth + x / 2))])
                << x << " " << y;
    write("thin.exr", 60, 40, 0.5);
    EXPECT_EQ(open("thin.exr.drape")->spec().height, 80);
}

TEST_F(PixelAspect, IsRefusedWhereItMeansNothing) {
    for (const float aspect : {0.0f, -1.0f, 1000.0f, 0.001f, HUGE_VALF, NAN}) {
        OIIO::ImageBuf image = panorama(64, 32);
        image.specmod().attribute("PixelAspectRatio", aspect);
        write_image(image, "bad.anabuf");
        EXPECT_THAT(open_error("bad.anabuf.map"), HasSubstr("must be from 0.01 to 100")) << aspect;
    }
    write("cube.exr", 32, 192, 2);
    for (const std::string from : {"cubemap", "octahedral", "hammer", "mirror_ball"})
        EXPECT_THAT(open_error("cube.exr.pano?from=" + from), HasSubstr("PixelAspectRatio=2")) << from;
    EXPECT_THAT(open_error("plate.exr.mosaic"), HasSubstr("PixelAspectRatio=2: must be 1 in mosaics"));
    write("square.exr", kWidth, kHeight, 1);
    EXPECT_THAT(open_error("plate.exr.morph?b=square.exr&features=lines.json"),
                HasSubstr("picture b has PixelAspectRatio=1 and a has 2: must have the same"));
    write("high.exr", 20, 400, 0.1);
    EXPECT_THAT(open_error("high.exr.pano?from=fisheye&srcfov=100"), HasSubstr("PixelAspectRatio=0.1"));
    EXPECT_THAT(open_error("high.exr.lens?lens=kb4:k1=0.01&fov=100"), HasSubstr("PixelAspectRatio=0.1"));
}

}  // namespace
}  // namespace anamorph::test_pixel_aspect
