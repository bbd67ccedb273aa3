// SPDX-License-Identifier: Apache-2.0
// anamorph-view: what its window shows against the operation of the core over the whole image in memory, drawn exactly.
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <panorama_viewer.h>
#include <vtkUnsignedCharArray.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "anamorph/oiio_ops.h"

namespace {

using anamorph::Assignment;
using anamorph_viewer::PanoramaViewer;
using anamorph_viewer::View;
using testing::HasSubstr;

constexpr int kWidth = 320, kHeight = 240;

/// Smooth, with a highlight of 40 and the darkest of 0.01, so that exposures count.
OIIO::ImageBuf panorama(int width, int height, double phase) {
    OIIO::ImageBuf image(OIIO::ImageSpec(width, height, 3, OIIO::TypeHalf));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double a = 2 * M_PI * (x + 0.5) / width + phase, b = M_PI * (y + 0.5) / height;
            const float pixel[3] = {static_cast<float>(0.5 + 0.49 * std::sin(3 * a) * std::sin(b)),
                                    static_cast<float>(std::pow(10, 1.6 * std::cos(a) * std::sin(b))),
                                    static_cast<float>(0.5 + 0.49 * std::cos(5 * b))};
            image.setpixel(x, y, pixel);
        }
    return image;
}

class VtkViewer : public testing::Test {
  protected:
    void SetUp() override {
        const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
        m_folder = std::filesystem::path(testing::TempDir()) / ("anamorph_viewer_" + name);
        std::filesystem::remove_all(m_folder);
        std::filesystem::create_directories(m_folder);
    }
    void TearDown() override { std::filesystem::remove_all(m_folder); }

    std::string path(const std::string& name) const { return (m_folder / name).string(); }
    void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
    void write(const std::string& name, OIIO::ImageBuf image) const {
        image.set_write_tiles(64, 64);
        ASSERT_TRUE(image.write(path(name))) << image.geterror();
    }

    static std::unique_ptr<PanoramaViewer> viewer_of(const std::string& file,
                                                     const std::vector<Assignment>& options = {}) {
        auto viewer = std::make_unique<PanoramaViewer>(anamorph::Tour{{file}}, "", options);
        prepare(*viewer);
        return viewer;
    }
    static void prepare(PanoramaViewer& viewer) {
        viewer.window()->SetSize(kWidth, kHeight);
        viewer.window()->OffScreenRenderingOn();
        viewer.interactor()->Initialize();
        viewer.window()->Render();
    }
    static void event(PanoramaViewer& viewer, unsigned long id, std::array<int, 2> at,
                      const char* key = nullptr) {
        viewer.interactor()->SetEventInformation(at[0], at[1], 0, 0, 0, 0, key);
        viewer.interactor()->InvokeEvent(id);
    }
    static void drag(PanoramaViewer& viewer, std::array<int, 2> from, std::array<int, 2> to) {
        event(viewer, vtkCommand::LeftButtonPressEvent, from);
        event(viewer, vtkCommand::MouseMoveEvent, to);
        event(viewer, vtkCommand::LeftButtonReleaseEvent, to);
    }
    static void click(PanoramaViewer& viewer, std::array<int, 2> at) { drag(viewer, at, at); }

    /// Levels of 255 by which the window is off what `expected` (float, linear) is at an exposure, but for some of the channels.
    static int off(PanoramaViewer& viewer, const OIIO::ImageBuf& expected, double but = 0) {
        EXPECT_FALSE(expected.has_error()) << expected.geterror();
        vtkNew<vtkUnsignedCharArray> seen;
        viewer.window()->Render();
        viewer.window()->GetPixelData(0, 0, kWidth - 1, kHeight - 1, 0, seen);
        EXPECT_EQ(seen->GetNumberOfTuples(), kWidth * kHeight);
        std::vector<int> levels;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                float pixel[4];
                expected.getpixel(x, y, pixel, 3);
                for (int c = 0; c < 3; ++c) {
                    // sRGB of IEC 61966-2-1, by its own words.
                    const double v = std::max(0.0, pixel[c] * std::pow(2, viewer.exposure()));
                    const double s = v > 0.0031308 ? 1.055 * std::pow(v, 1 / 2.4) - 0.055 : 12.92 * v;
                    const int level = int(std::floor(255 * std::min(s, 1.0) + 0.5));
                    const int is = int(seen->GetComponent((kHeight - 1 - y) * kWidth + x, c));
                    levels.push_back(std::abs(level - is));
                }
            }
        std::sort(levels.begin(), levels.end());
        return levels[static_cast<std::size_t>((1 - but) * static_cast<double>(levels.size() - 1))];
    }
    /// The view by the operation, exactly, of an image in memory.
    static OIIO::ImageBuf drawn(const OIIO::ImageBuf& source, const View& view,
                                const std::vector<Assignment>& more = {}, const char* operation = "pano") {
        OIIO::ParamValueList options;
        for (const Assignment& a : more) options.attribute(a.key, a.value);
        options.attribute("yaw", anamorph::shortest(view.yaw));
        options.attribute("pitch", anamorph::shortest(view.pitch));
        options.attribute("fov", anamorph::shortest(view.fov));
        options.attribute("size", std::to_string(kWidth) + "x" + std::to_string(kHeight));
        options.attribute("tol", "0");
        return anamorph::apply(operation, {&source}, options);
    }

    std::filesystem::path m_folder;
};

TEST_F(VtkViewer, ShowsWhatTheOperationDraws) {
    const OIIO::ImageBuf image = panorama(512, 256, 0);
    write("a.exr", image);
    const auto viewer = viewer_of(path("a.exr"));
    EXPECT_LE(off(*viewer, drawn(image, {0, 0, 90})), 1);
    drag(*viewer, {160, 120}, {60, 150});
    event(*viewer, vtkCommand::MouseWheelForwardEvent, {160, 120});
    event(*viewer, vtkCommand::KeyPressEvent, {160, 120}, "bracketleft");
    event(*viewer, vtkCommand::KeyPressEvent, {160, 120}, "bracketleft");
    EXPECT_EQ(viewer->exposure(), -1);
    const View view = viewer->view();
    EXPECT_GT(view.yaw, 20);
    EXPECT_LT(view.pitch, -5);
    EXPECT_NEAR(view.fov, 90 / 1.1, 1e-9);
    EXPECT_LE(off(*viewer, drawn(image, view)), 1);
    EXPECT_GT(off(*viewer, drawn(image, {0, 0, 90})), 20);
    // The seam behind, and the pole.
    viewer->look({178, 80, 120});
    EXPECT_LE(off(*viewer, drawn(image, {178, 80, 120})), 1);
    EXPECT_EQ(viewer->error(), "");
}

TEST_F(VtkViewer, AnyProjectionAndLens) {
    const OIIO::ImageBuf image = panorama(256, 256, 0);
    write("a.exr", image);
    for (const std::vector<Assignment>& options :
         {std::vector<Assignment>{{"from", "fisheye"}, {"srcfov", "200"}, {"srclens", "kb4:k1=0.02"}},
          std::vector<Assignment>{{"from", "cylindrical"}, {"to", "stereographic"}, {"srcpitch", "10"}}}) {
        const auto viewer = viewer_of(path("a.exr"), options);
        viewer->look({40, -10, 100});
        EXPECT_LE(off(*viewer, drawn(image, {40, -10, 100}, options)), 1) << options[0].value;
    }
}

using anamorph_viewer::Drawing;

TEST_F(VtkViewer, TheCardShowsWhatTheOperationDraws) {
    const OIIO::ImageBuf image = panorama(512, 256, 0);
    write("a.exr", image);
    const auto viewer = viewer_of(path("a.exr"));
    // About poles a card reads levels that are too coarse, as it takes one for both directions.
    const auto vertices = [&](const View& view) {
        viewer->look(view);
        EXPECT_LE(off(*viewer, drawn(image, view), view.pitch > 60 ? 0.05 : 0), 3)
            << view.yaw << " " << view.pitch;
        EXPECT_EQ(viewer->error(), "");
        return viewer->by_vertices();
    };
    viewer->set_drawing(Drawing::fragments);
    // Also where the seam and the pole are seen.
    for (const View& view : {View{0, 0, 90}, View{-50, 25, 60}, View{178, 80, 120}})
        EXPECT_FALSE(vertices(view));
    viewer->set_drawing(Drawing::vertices);
    // The same table for other directions, across the seam, and another one for another field of view.
    for (const View& view : {View{0, 0, 80}, View{40, 10, 70}, View{179, -12, 70}, View{-30, 20, 40}}) {
        EXPECT_TRUE(vertices(view)) << view.yaw;
        EXPECT_LE(viewer->card()->bound(), 0.25);
        EXPECT_GT(viewer->card()->bound(), 0);
    }
    // No projection plane has all of it.
    EXPECT_FALSE(vertices({178, 80, 120}));
    EXPECT_EQ(viewer->card()->bound(), 0);
    // Exposure, by the key, and the mouse.
    viewer->look({0, 0, 80});
    event(*viewer, vtkCommand::KeyPressEvent, {160, 120}, "bracketleft");
    drag(*viewer, {160, 120}, {100, 20});
    const View view = viewer->view();
    EXPECT_LE(off(*viewer, drawn(image, view)), 3);
    for (const Drawing next : {Drawing::picture, Drawing::fragments, Drawing::vertices}) {
        event(*viewer, vtkCommand::KeyPressEvent, {160, 120}, "v");
        EXPECT_EQ(viewer->drawing(), next);
        EXPECT_LE(off(*viewer, drawn(image, view)), 3);
    }
}

TEST_F(VtkViewer, TheCardDrawsCylindersByVertices) {
    const OIIO::ImageBuf image = panorama(720, 240, 0);
    write("a.exr", image);
    const std::vector<Assignment> options = {{"from", "cylindrical"}, {"srcyaw", "20"}, {"srcpitch", "7"}};
    const auto viewer = viewer_of(path("a.exr"), options);
    for (const View& view : {View{20, 10, 60}, View{70, 0, 45}}) {
        viewer->look(view);
        // Texture units weigh texels with 8 bits, which shows where it is dark.
        viewer->set_drawing(Drawing::fragments);
        EXPECT_LE(off(*viewer, drawn(image, view, options)), 6) << view.yaw;
        viewer->set_drawing(Drawing::vertices);
        EXPECT_LE(off(*viewer, drawn(image, view, options)), 6) << view.yaw;
        EXPECT_TRUE(viewer->by_vertices());
    }
}

TEST_F(VtkViewer, WhatNoCardDrawsIsSaid) {
    write("a.exr", panorama(256, 240, 0));
    for (const auto& [options, message] : std::vector<std::pair<std::vector<Assignment>, std::string>>{
             {{{"circles", "3"}, {"circle", "2"}}, "one circle alone"},
             {{{"from", "fisheye"}, {"to", "stereographic"}}, "not rectilinear"}}) {
        const auto viewer = viewer_of(path("a.exr"), options);
        viewer->set_drawing(Drawing::vertices);
        viewer->window()->Render();
        EXPECT_THAT(viewer->error(), HasSubstr(message));
        viewer->set_drawing(Drawing::picture);
        viewer->window()->Render();
        EXPECT_EQ(viewer->error(), "");
    }
}

TEST_F(VtkViewer, SourcesLargerThanTheCache) {
    // 12 MB of texels in tiles, and MIP levels, where OpenImageIO may keep 1 MB.
    const OIIO::ImageBuf image = panorama(2048, 1024, 1);
    OIIO::ImageSpec how;
    how.attribute("maketx:filtername", "box");
    ASSERT_TRUE(
        OIIO::ImageBufAlgo::make_texture(OIIO::ImageBufAlgo::MakeTxTexture, image, path("a.tx"), how));
    const auto cache = OIIO::ImageCache::create(true);
    float before = 0;
    cache->getattribute("max_memory_MB", before);
    cache->attribute("max_memory_MB", 1.0f);
    const auto viewer = viewer_of(path("a.tx"), {{"from", "equirectangular"}});
    for (const double yaw : {0.0, 90.0, 180.0}) {
        viewer->look({yaw, 10, 40});
        EXPECT_LE(off(*viewer, drawn(image, {yaw, 10, 40})), 1);
    }
    // A wide view reads a coarser level: a mean of the same texels, but not of the same numbers.
    viewer->look({0, 0, 130});
    EXPECT_LE(off(*viewer, drawn(image, {0, 0, 130})), 3);
    cache->attribute("max_memory_MB", before);
}

TEST_F(VtkViewer, HotSpotsLeadToOtherPanoramas) {
    const OIIO::ImageBuf hall = panorama(256, 128, 0), garden = panorama(128, 64, 2);
    write("hall.exr", hall);
    write("garden.exr", garden);
    const char* const text = R"({"panoramas": [
        {"file": "hall.exr", "yaw": 10, "fov": 80, "spots": [
            {"yaw": 30, "pitch": 5, "radius": 4, "target": "garden.exr", "view": {"yaw": -60}},
            {"yaw": -10, "pitch": 0, "radius": 4, "target": "gone.exr"}]},
        {"file": "garden.exr", "options": "srcyaw=20", "pitch": 15},
        {"file": "gone.exr"}]})";
    PanoramaViewer viewer(anamorph::parse_tour_json(text, "tour.json"), m_folder.string(), {});
    prepare(viewer);
    EXPECT_EQ(viewer.view().yaw, 10);
    EXPECT_LE(off(viewer, drawn(hall, {10, 0, 80})), 1);
    // 20 degrees to the right of the middle and 5 degrees up, by the pinhole's formula.
    const double focal = kWidth / 2.0 / std::tan(40 * M_PI / 180);
    const int x = int(kWidth / 2.0 + focal * std::tan(20 * M_PI / 180));
    const int y = int(kHeight / 2.0 + focal * std::tan(5 * M_PI / 180) / std::cos(20 * M_PI / 180));
    const int radius = int(focal * std::tan(4 * M_PI / 180));
    click(viewer, {x, y - 2 * radius});
    EXPECT_EQ(viewer.place(), 0u) << "beside the spot";
    drag(viewer, {x, y}, {x + 40, y});
    EXPECT_EQ(viewer.place(), 0u) << "a drag is no click";
    viewer.look({10, 0, 80});
    viewer.window()->Render();
    event(viewer, vtkCommand::MouseMoveEvent, {x, y});
    EXPECT_EQ(viewer.window()->GetCurrentCursor(), VTK_CURSOR_HAND);
    click(viewer, {x, y});
    ASSERT_EQ(viewer.place(), 1u);
    EXPECT_EQ(viewer.view().yaw, -60) << "the spot's";
    EXPECT_EQ(viewer.view().pitch, 15) << "the panorama's own";
    EXPECT_EQ(viewer.view().fov, 80) << "as it was";
    EXPECT_LE(off(viewer, drawn(garden, {-60, 15, 80}, {{"srcyaw", "20"}})), 1);
    // A panorama that is not there leaves all as it is.
    EXPECT_FALSE(viewer.go_to(2, {}));
    EXPECT_EQ(viewer.place(), 1u);
    EXPECT_THAT(viewer.error(), HasSubstr("gone.exr"));
    EXPECT_LE(off(viewer, drawn(garden, {-60, 15, 80}, {{"srcyaw", "20"}})), 1);
}

TEST_F(VtkViewer, MovesInConcentricMosaics) {
    const OIIO::ImageBuf stack = panorama(256, 240, 0);  // 3 panoramas, whatever they show
    write("stack.exr", stack);
    const std::vector<Assignment> options = {{"circles", "3"}, {"depth", "3"}};
    const auto viewer = viewer_of(path("stack.exr"), options);
    viewer->look({30, 0, 70});
    event(*viewer, vtkCommand::KeyPressEvent, {0, 0}, "w");
    event(*viewer, vtkCommand::KeyPressEvent, {0, 0}, "w");
    event(*viewer, vtkCommand::KeyPressEvent, {0, 0}, "d");
    const double c = std::cos(30 * M_PI / 180), s = 0.5;
    std::vector<Assignment> moved = options;
    moved.push_back({"x", anamorph::shortest(0.1 * s + 0.05 * c)});
    moved.push_back({"z", anamorph::shortest(0.1 * c - 0.05 * s)});
    EXPECT_LE(off(*viewer, drawn(stack, {30, 0, 70}, moved, "mosaic")), 1);
    EXPECT_GT(off(*viewer, drawn(stack, {30, 0, 70}, options, "mosaic")), 1);
    for (int i = 0; i < 40; ++i) event(*viewer, vtkCommand::KeyPressEvent, {0, 0}, "w");
    EXPECT_EQ(viewer->error(), "") << "it stays inside the circle";
}

TEST_F(VtkViewer, TheCardDrawsConcentricMosaics) {
    for (const auto& [circles, from, depth] :
         {std::tuple("3", "cylindrical", "3"), std::tuple("4", "equirectangular", "1.5"),
          std::tuple("1", "mercator", ""), std::tuple("2", "cylindrical", "")}) {
        SCOPED_TRACE(std::string(circles) + from);
        const OIIO::ImageBuf stack = panorama(512, 144 * std::stoi(circles), 0);
        write("stack.exr", stack);
        std::vector<Assignment> options = {{"circles", circles}, {"from", from}};
        if (*depth) options.push_back({"depth", depth});
        const auto viewer = viewer_of(path("stack.exr"), options);
        viewer->set_drawing(Drawing::fragments);
        std::vector<Assignment> moved = options;
        double right = 0, ahead = 0;
        for (const View& view : {View{30, 0, 70}, View{-100, 15, 60}, View{178, -10, 50}}) {
            viewer->look(view);
            EXPECT_LE(off(*viewer, drawn(stack, view, moved, "mosaic"), 0.002), 6) << view.yaw;
            EXPECT_EQ(viewer->error(), "");
            if (right != 0 && stack.spec().height > 144) {
                EXPECT_GT(off(*viewer, drawn(stack, view, options, "mosaic"), 0.002), 6) << "it has moved";
            }
            // Per vertex it is the same.
            viewer->set_drawing(Drawing::vertices);
            EXPECT_LE(off(*viewer, drawn(stack, view, moved, "mosaic"), 0.002), 6) << view.yaw;
            EXPECT_FALSE(viewer->by_vertices());
            viewer->set_drawing(Drawing::fragments);
            // Steps to the right and ahead, for the next one.
            const double c = std::cos(view.yaw * M_PI / 180), s = std::sin(view.yaw * M_PI / 180);
            for (int k = 0; k < 6; ++k) {
                event(*viewer, vtkCommand::KeyPressEvent, {0, 0}, k < 4 ? "d" : "w");
                right += 0.05 * (k < 4 ? c : s), ahead += 0.05 * (k < 4 ? -s : c);
            }
            moved = options;
            moved.push_back({"x", anamorph::shortest(right)});
            moved.push_back({"z", anamorph::shortest(ahead)});
        }
    }
}

TEST(VtkViewerShown, ValuesOfFilesThatAreEncodedStayAsTheyAre) {
    using anamorph_viewer::shown;
    for (int i = 0; i < 256; ++i) {
        EXPECT_EQ(shown(float(i) / 255, false, 1), i);
        // There and back by way of light.
        EXPECT_EQ(shown(float(i) / 255, false, 1 + 1e-9), i);
    }
    EXPECT_EQ(shown(0.5f, true, 1), 188);
    EXPECT_EQ(shown(0.25f, true, 2), 188);
    EXPECT_EQ(shown(NAN, true, 1), 0);
    EXPECT_EQ(shown(-1, true, 1), 0);
    EXPECT_EQ(shown(INFINITY, true, 1), 255);
}

TEST_F(VtkViewer, TheProgramWritesItsWindowAndSaysWhatIsWrong) {
    const OIIO::ImageBuf image = panorama(256, 128, 0);
    write("a.exr", image);
    write("bad.json", R"({"panoramas": [{"file": "a.exr", "zoom": 1}]})");
    write("tour.json", R"({"panoramas": [{"file": "a.exr", "yaw": 70}]})");
    const std::string program = ANAMORPH_VIEW, log = path("log.txt");
    const auto run = [&](const std::string& arguments) {
        const int status = std::system((program + " " + arguments + " > " + log + " 2>&1").c_str());
        std::stringstream text;
        text << std::ifstream(log).rdbuf();
        return std::pair(status, text.str());
    };
    const auto [status, text] =
        run(path("tour.json") + " tol=0 --fov 60 --exposure 1 --size 320 240 --picture " + path("seen.png"));
    ASSERT_EQ(status, 0) << text;
    const OIIO::ImageBuf seen(path("seen.png")), expected = drawn(image, {70, 0, 60});
    ASSERT_EQ(seen.spec().width, kWidth);
    double worst = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            float a[4], b[4];
            seen.getpixel(x, y, a, 3);
            expected.getpixel(x, y, b, 3);
            const double v = 2 * double(b[0]),
                         s = v > 0.0031308 ? 1.055 * std::pow(v, 1 / 2.4) - 0.055 : 12.92 * v;
            worst = std::max(worst, std::fabs(std::min(s, 1.0) - a[0]));
        }
    EXPECT_LT(worst, 1.0 / 255);
    for (const auto& [arguments, message] : std::vector<std::pair<std::string, std::string>>{
             {path("bad.json"),
              "panorama 1: \"zoom\": must be one of file, fov, options, pitch, spots, yaw\n"},
             {path("none.exr"), "none.exr"},
             {path("none.json"), "none.json"},
             {path("a.exr") + " from=nonesuch", "from=nonesuch: must be one of"},
             {path("a.exr") + " --draw paper", "draw=paper: must be picture, fragments or vertices\n"},
             {path("a.exr") + " nonesuch", "\"nonesuch\": must be key=value, as in from=cylindrical\n"},
             {path("a.exr") + " yaw=3", "yaw is the viewer's own: must not be given\n"},
             {path("a.exr") + " --fov 400 --picture " + path("x.png"), ""},
             {path("a.exr") + " --picture " + path("none/x.png"), "x.png"}}) {
        const auto [failed, said] = run(arguments);
        if (message.empty()) continue;
        EXPECT_NE(failed, 0) << arguments;
        EXPECT_THAT(said, HasSubstr("anamorph-view: ")) << arguments;
        EXPECT_THAT(said, HasSubstr(message));
    }
}

}  // namespace
