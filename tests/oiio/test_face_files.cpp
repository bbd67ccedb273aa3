// SPDX-License-Identifier: Apache-2.0
// Cubes of six files: what they show is what the same faces show in one file, however they are named.
#include <OpenImageIO/imagebufalgo.h>

#include <array>
#include <filesystem>

#include "host.h"

namespace anamorph::test_face_files {
namespace {

using namespace testing_oiio;
using OIIO::ImageBuf;
using testing::AllOf;
using testing::HasSubstr;

constexpr int kSide = 24;
using Names = std::array<std::string, 6>;

/// Ways of naming: right, left, up, down, front, back, or OpenGL's +x to -z.
const Names kAxes = {"px", "nx", "py", "ny", "pz", "nz"};
const Names kWays[] = {kAxes,
                       {"posx", "negx", "posy", "negy", "posz", "negz"},
                       {"right", "left", "up", "down", "front", "back"},
                       {"right", "left", "top", "bottom", "front", "back"},
                       {"Right", "Left", "Up", "Down", "Front", "Back"},
                       {"r", "l", "u", "d", "f", "b"},
                       {"0", "1", "2", "3", "4", "5"}};
const Names kExr = {"+x", "-x", "+y", "-y", "+z", "-z"};

const char* const kViews[] = {"to=equirectangular&size=60x30",
                              "to=rectilinear&fov=100&yaw=40&pitch=30&size=40x30",
                              "to=fisheye&fov=360&size=12&pitch=50", "to=cubecross&size=32&yaw=20"};

class FaceFilesInAFolder : public InFolder {
  protected:
    void SetUp() override {
        InFolder::SetUp();
        write_panorama("whole.exr", 128, 64);
        for (const std::string layout : {"grid", "strip"}) {
            const std::string to = layout == "grid" ? "to=cubemap3x2&size=72" : "to=cubemap&size=24";
            const ImageBuf cube("whole.exr.pano?from=latlong&tol=0.0001&" + to);
            write_image(cube, layout + ".exr");
            write_image(cube, layout + ".png");
        }
    }

    /// Cuts the faces of a file into files of their own: NAME's faces by their order, `columns` in a row.
    static void cut(const std::string& layout, int columns, const Names& words, const std::string& before,
                    const std::string& after) {
        for (int i = 0; i < 6; ++i) {
            ImageBuf whole(layout), face;
            ASSERT_TRUE(whole.read(0, 0, true, whole.nativespec().format));
            const int x = i % columns * kSide, y = i / columns * kSide;
            ASSERT_TRUE(OIIO::ImageBufAlgo::cut(face, whole, OIIO::ROI(x, x + kSide, y, y + kSide)));
            write_image(face, before + words[static_cast<std::size_t>(i)] + after);
        }
    }
    static void cut_grid(const Names& words = kAxes, const std::string& before = "sky_") {
        cut("grid.exr", 3, words, before, ".exr");
    }
};

std::string says_from(const std::string& name) {
    return std::string(open(name)->spec().get_string_attribute("anamorph:from"));
}

TEST_F(FaceFilesInAFolder, AreWhatOneFileShowsPixelForPixel) {
    int way = 0;
    for (const Names& words : kWays) {
        SCOPED_TRACE(words[0] + " " + words[2]);
        const std::string folder = "way" + std::to_string(way++);
        std::filesystem::create_directory(folder);
        for (const std::string ending : {".exr", ".png"}) {
            cut("grid" + ending, 3, words, folder + "/sky_", "_1k" + ending);
            for (const std::string view : kViews)
                for (const std::string filter :
                     {"nearest", "bilinear", "bicubic", "sharp_bicubic", "antialias"}) {
                    SCOPED_TRACE(view + " " + filter);
                    const std::string keys = "?filter=" + filter + "&" + view;
                    EXPECT_EQ(largest_difference(
                                  read_floats(folder + "/sky_{face}_1k" + ending + ".pano" + keys),
                                  read_floats("grid" + ending + ".pano" + keys + "&from=cubemap3x2")),
                              0);
                }
        }
    }
    cut_grid();
    EXPECT_EQ(says_from("sky_{face}.exr.pano?size=8"), "cubemap3x2 (as {face}=px, nx, py, ny, pz, nz says)");
    EXPECT_EQ(says_from("x.pano?size=8&src=sky_{face}.exr"),
              "cubemap3x2 (as {face}=px, nx, py, ny, pz, nz says)");
    // In a recipe file, whose folder the names are relative to; twice in the name.
    std::filesystem::create_directory("deep");
    for (const std::string& word : kAxes) std::filesystem::create_directory("deep/" + word);
    for (const std::string& word : kAxes)
        std::filesystem::copy_file("sky_" + word + ".exr", "deep/" + word + "/" + word + ".exr");
    write_text("deep/view.pano", "src={face}/{face}.exr\nsize=20\n");
    EXPECT_EQ(read_floats("deep/view.pano"), read_floats("sky_{face}.exr.pano?size=20"));
    expect_one_picture("deep/view.pano?size=64x48&fov=120&yaw=40&pitch=30", 10, 8);
    // oiiotool takes braces for expressions unless it is told not to.
    EXPECT_EQ(run("oiiotool --evaloff 'sky_{face}.exr.pano?size=20' -o told.exr").status, 0);
    EXPECT_EQ(largest_difference(read_floats("told.exr"), read_floats("deep/view.pano")), 0);
}

TEST_F(FaceFilesInAFolder, OfOpenExrAreThoseOfItsStrip) {
    cut("strip.exr", 1, kExr, "sky_", ".exr");
    for (const std::string view : kViews) {
        SCOPED_TRACE(view);
        const std::vector<float> strip = read_floats("strip.exr.pano?from=cubemap&" + view);
        EXPECT_EQ(largest_difference(read_floats("sky_{face}.exr.pano?" + view), strip), 0);
    }
    EXPECT_EQ(says_from("sky_{face}.exr.pano?size=8"), "cubemap (as {face}=+x, -x, +y, -y, +z, -z says)");
    // Names of axes and numbers are of the layout that is asked for; directions are directions.
    const std::string view = "&to=equirectangular&size=40";
    const std::vector<float> strip = read_floats("strip.exr.pano?from=cubemap" + view),
                             grid = read_floats("grid.exr.pano?from=cubemap3x2" + view);
    cut("strip.exr", 1, kAxes, "axes_", ".exr");
    cut("strip.exr", 1, {"left", "right", "up", "down", "front", "back"}, "words_", ".exr");
    for (const std::string name : {"axes_", "words_"})
        EXPECT_EQ(largest_difference(read_floats(name + "{face}.exr.pano?from=cubemap" + view), strip), 0);
    cut_grid(kExr, "grid_");
    EXPECT_EQ(largest_difference(read_floats("grid_{face}.exr.pano?from=cubemap3x2" + view), grid), 0);
}

// In a chain the files themselves are sampled.
TEST_F(FaceFilesInAFolder, AreDrawnByOneResampling) {
    cut_grid();
    const std::string chain = "x.lens?lens=3de4:k1=0.1&filter=bilinear&src=(";
    const auto of = [](const std::string& source) {
        return source + "?filter=bilinear&fov=70&pitch=40&size=40x30&";
    };
    EXPECT_EQ(read_floats(chain + of("sky_{face}.exr.pano") + "yaw=5)"),
              read_floats(chain + of("grid.exr.pano") + "yaw=5&from=cubemap3x2)"));
    EXPECT_EQ(std::string(open(chain + of("sky_{face}.exr.pano") + "yaw=5)")
                              ->spec()
                              .get_string_attribute("anamorph:chain")),
              "lens of pano");
}

// Pictures of one face each, by the words of the key, are read again as a cube.
TEST_F(FaceFilesInAFolder, AreWrittenByTheKeyFace) {
    const auto written = [](const std::string& to, const Names& words, const std::string& before) {
        for (const std::string& word : words)
            write_image(ImageBuf("whole.exr.pano?from=latlong&tol=0.0001&size=24&to=" + to + "&face=" + word),
                        before + word + ".exr");
    };
    written("cubemap3x2", kAxes, "gl_");
    written("cubecross", kWays[2], "words_");
    written("cubemap", kExr, "exr_");
    const std::string view = "&to=equirectangular&size=60&tol=0.0001&filter=bilinear";
    const std::vector<float> grid = read_floats("grid.exr.pano?from=cubemap3x2" + view),
                             strip = read_floats("strip.exr.pano?from=cubemap" + view);
    // Faces and layouts are planned in blocks of their own, each within its tolerance.
    EXPECT_LT(largest_difference(read_floats("gl_{face}.exr.pano?srcyaw=0" + view), grid), 1e-3);
    EXPECT_LT(largest_difference(read_floats("words_{face}.exr.pano?srcyaw=0" + view), grid), 1e-3);
    EXPECT_LT(largest_difference(read_floats("exr_{face}.exr.pano?srcyaw=0" + view), strip), 1e-3);
    EXPECT_EQ(read_floats("whole.exr.pano?from=latlong&to=cubemap3x2&size=24&face=ny"),
              read_floats("whole.exr.pano?from=latlong&to=cubemap3x2&size=24&face=down"));
    EXPECT_THAT(open_error("whole.exr.pano?from=latlong&to=cubemap&size=24&face=px"),
                AllOf(HasSubstr("face=px"), HasSubstr("must be +x to -z or right to back")));
}

TEST_F(FaceFilesInAFolder, OfFfmpegAreItsLayouts) {
    if (run("ffmpeg -version").status != 0) GTEST_SKIP() << "ffmpeg is not installed";
    ASSERT_EQ(run("oiiotool whole.exr -d uint8 -o whole.png && "
                  "ffmpeg -v error -i whole.png -vf v360=e:c6x1:w=144:h=24 row.png && "
                  "ffmpeg -v error -i whole.png -vf v360=e:c3x2:w=72:h=48 grid2.png")
                  .status,
              0);
    cut("row.png", 6, {"r", "l", "u", "d", "f", "b"}, "row_", ".png");
    for (const std::string view : kViews)
        EXPECT_EQ(largest_difference(read_floats("row_{face}.png.pano?filter=bilinear&" + view),
                                     read_floats("grid2.png.pano?from=cubemap3x2&filter=bilinear&" + view)),
                  0)
            << view;
}

// Windows, turned files, ids, alpha, tiles and parts: each face as it is read alone.
TEST_F(FaceFilesInAFolder, AreReadAsOtherSourcesAre) {
    const auto expect_as_grid = [](const std::string& name, const std::string& keys) {
        SCOPED_TRACE(name + keys);
        EXPECT_EQ(read_pixels(name + "_{face}.exr.pano?srcyaw=10" + keys),
                  read_pixels(name + ".exr.pano?from=cubemap3x2&srcyaw=10" + keys));
    };
    // Of uint ids no bit is lost.
    ImageBuf ids(OIIO::ImageSpec(3 * kSide, 2 * kSide, 1, OIIO::TypeUInt32));
    std::vector<std::uint32_t> values;
    for (unsigned i = 0; i < 6 * kSide * kSide; ++i) values.push_back(4000000001u + i);
    ids.set_pixels(ids.roi(), OIIO::TypeUInt32, values.data());
    write_image(ids, "ids.exr");
    cut("ids.exr", 3, kAxes, "ids_", ".exr");
    expect_as_grid("ids", "&filter=nearest&size=40&fov=120&pitch=40");
    EXPECT_EQ(read_pixels("ids_{face}.exr.pano?filter=nearest&size=4").spec.format, OIIO::TypeUInt32);
    // Alpha, tiles, MIP levels of the picture.
    write_panorama("alpha.exr", 3 * kSide, 2 * kSide, OIIO::TypeHalf, 4);
    cut("alpha.exr", 3, kAxes, "alpha_", ".exr");
    expect_as_grid("alpha", "&size=40&fov=120&pitch=40");
    expect_as_grid("alpha", "&size=40&fov=120&pitch=40&output=coverage");
    // One file is stored turned, another has a data window of its own.
    cut_grid();
    ASSERT_EQ(
        run("oiiotool sky_px.exr --rotate90 --attrib Orientation 8 -o turned.exr && mv turned.exr sky_px.exr")
            .status,
        0);
    ASSERT_EQ(run("oiiotool grid.exr --fill:color=0,0,0 24x4+0+24 -o holed.exr && oiiotool sky_ny.exr --crop "
                  "24x20+0+4 -o cropped.exr && mv cropped.exr sky_ny.exr")
                  .status,
              0);
    EXPECT_EQ(
        largest_difference(read_floats("sky_{face}.exr.pano?size=60&fov=150&pitch=-30&yaw=60"),
                           read_floats("holed.exr.pano?from=cubemap3x2&size=60&fov=150&pitch=-30&yaw=60")),
        0);
    // Parts.
    for (const std::string& word : kAxes)
        ASSERT_EQ(run("oiiotool alpha_" + word + ".exr alpha_" + word +
                      ".exr --mulc 0.5 --siappendall -o two_" + word + ".exr")
                      .status,
                  0);
    EXPECT_EQ(read_pixels("two_{face}.exr.pano?subimage=0&size=20"),
              read_pixels("alpha_{face}.exr.pano?size=20"));
    const std::vector<float> half = read_floats("two_{face}.exr.pano?subimage=1&size=20&filter=bilinear"),
                             full = read_floats("alpha_{face}.exr.pano?size=20&filter=bilinear");
    ASSERT_EQ(half.size(), full.size());
    EXPECT_NEAR(half[40], full[40] / 2, 1e-3);
    std::filesystem::copy_file("alpha_nz.exr", "two_nz.exr",
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_THAT(open_error("two_{face}.exr.pano?size=20"),
                AllOf(HasSubstr("\"two_nz.exr\" has 1 parts"), HasSubstr("\"two_px.exr\"")));
}

TEST_F(FaceFilesInAFolder, ThatChangeAreSeen) {
    cut_grid();
    const std::string name = "sky_{face}.exr.pano?size=20&pitch=-90";
    const std::vector<float> before = read_floats(name);
    ASSERT_EQ(run("sleep 0.02; oiiotool sky_ny.exr --mulc 0.25 -o sky_ny.exr").status, 0);
    const std::vector<float> after = read_floats(name);
    EXPECT_NEAR(after[630], 0.25 * before[630], 1e-3);  // its middle
    // A name that is one of a file is that file.
    write_panorama("sky_{face}.exr", 20, 10);
    EXPECT_EQ(says_from("sky_{face}.exr.pano?size=8"), "equirectangular (assumed from the 2:1 shape)");
}

TEST_F(FaceFilesInAFolder, SayWhatIsWrong) {
    const std::string name = "sky_{face}.exr.pano?size=8";
    EXPECT_THAT(open_error(name), AllOf(HasSubstr("src=sky_{face}.exr: there are no such files: must be six"),
                                        HasSubstr("(px nx py ny pz nz)")));
    cut_grid();
    std::filesystem::remove("sky_ny.exr");
    EXPECT_THAT(open_error(name),
                AllOf(HasSubstr("src=sky_{face}.exr: \"sky_ny.exr\" is not there"), HasSubstr("px, nx, py")));
    std::filesystem::create_directory("sky_ny.exr");
    EXPECT_THAT(open_error(name), HasSubstr("\"sky_ny.exr\" is not there"));
    std::filesystem::remove("sky_ny.exr");
    write_text("sky_ny.exr", "no image");
    EXPECT_THAT(open_error(name), HasSubstr("sky_ny.exr"));
    cut_grid(kWays[6]);
    cut_grid();
    EXPECT_THAT(open_error(name),
                HasSubstr("there are files for px, nx, py, ny, pz, nz and for 0, 1, 2, 3, 4, 5: "
                          "must be one of them"));
    std::filesystem::remove("sky_3.exr");
    EXPECT_EQ(open(name)->spec().width, 8);
    for (const std::string from : {"cubecross", "eac", "fisheye", "latlong"})
        EXPECT_THAT(open_error(name + "&from=" + from),
                    HasSubstr("must be cubemap or cubemap3x2 of six files"));
    EXPECT_THAT(open_error(name + "&from=cubes"), HasSubstr("from=cubes"));

    const auto with = [&](const std::string& command) {
        const Ran ran = run("cp sky_pz.exr kept.exr; oiiotool kept.exr " + command + " -o sky_pz.exr");
        EXPECT_EQ(ran.status, 0) << ran.text;
        const std::string error = open_error(name);
        run("mv kept.exr sky_pz.exr");
        return error;
    };
    EXPECT_THAT(with("--resize 20x20"), AllOf(HasSubstr("source \"sky_pz.exr\" has 20x20 pixels: must be as "
                                                        "\"sky_px.exr\" has it, 24x24 pixels")));
    EXPECT_THAT(with("--resize 24x20"), HasSubstr("source \"sky_pz.exr\" has 24x20 pixels: must be square"));
    EXPECT_THAT(with("--ch R,G"),
                AllOf(HasSubstr("the channels R (float) G (float):"), HasSubstr("sky_pz.exr")));
    EXPECT_THAT(with("-d half"), AllOf(HasSubstr("R (half)"), HasSubstr("sky_pz.exr")));
    EXPECT_THAT(open_error("sky_{face}.exr.lens?lens=3de4:k1=0.1"), HasSubstr("sky_{face}.exr"));
}

}  // namespace
}  // namespace anamorph::test_face_files
