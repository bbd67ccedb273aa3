// SPDX-License-Identifier: Apache-2.0
// What tests of windows that edit share: synthetic events, files, and the pixels that a pane shows.
#pragma once

#include <OpenImageIO/imagebuf.h>
#include <edit_window.h>
#include <gtest/gtest.h>
#include <vtkCommand.h>
#include <vtkUnsignedCharArray.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace anamorph::test {

using anamorph_editor::EditWindow;
using anamorph_editor::Pane;
using Display = std::array<int, 2>;

class WindowTest : public testing::Test {
  protected:
    void SetUp() override {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        m_folder = std::filesystem::path(testing::TempDir()) /
                   (std::string("anamorph_") + info->test_suite_name() + "_" + info->name());
        std::filesystem::remove_all(m_folder);
        std::filesystem::create_directories(m_folder);
    }
    void TearDown() override { std::filesystem::remove_all(m_folder); }

    std::string path(const std::string& name) const { return (m_folder / name).string(); }
    void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
    void write(const std::string& name, const OIIO::ImageBuf& image) const {
        ASSERT_TRUE(image.write(path(name))) << image.geterror();
    }
    std::string read(const std::string& name) const {
        std::stringstream text;
        text << std::ifstream(path(name)).rdbuf();
        return text.str();
    }

    /// A smooth picture with all its colours in all its parts.
    static OIIO::ImageBuf picture(int width, int height, double phase = 0,
                                  OIIO::TypeDesc type = OIIO::TypeUInt8) {
        OIIO::ImageBuf image(OIIO::ImageSpec(width, height, 3, type));
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const double a = 9 * (x + 0.5) / width + phase, b = 7 * (y + 0.5) / height;
                const float pixel[3] = {static_cast<float>(0.5 + 0.45 * std::sin(a) * std::cos(b)),
                                        static_cast<float>(0.5 + 0.45 * std::sin(2 * b + a)),
                                        static_cast<float>(0.5 + 0.45 * std::cos(3 * a - b))};
                image.setpixel(x, y, pixel);
            }
        return image;
    }

    static void prepare(EditWindow& window, int width, int height) {
        window.window()->SetSize(width, height);
        window.window()->OffScreenRenderingOn();
        window.interactor()->Initialize();
        window.window()->Render();
        ASSERT_EQ(window.error(), "");
    }
    static void event(EditWindow& window, unsigned long id, const Display& at, const char* key = nullptr,
                      bool control = false, bool shift = false, int repeat = 0) {
        window.interactor()->SetEventInformation(at[0], at[1], control, shift, 0, repeat, key);
        window.interactor()->InvokeEvent(id);
    }
    static void key(EditWindow& window, const char* name, bool control = false, bool shift = false,
                    const Display& at = {}) {
        event(window, vtkCommand::KeyPressEvent, at, name, control, shift);
    }
    /// Presses the left button, moves in some steps, and lets go.
    static void drag(EditWindow& window, const Display& from, const Display& to, bool control = false,
                     bool shift = false) {
        event(window, vtkCommand::LeftButtonPressEvent, from, nullptr, control, shift);
        for (int k = 1; k <= 3; ++k)
            event(window, vtkCommand::MouseMoveEvent,
                  {from[0] + (to[0] - from[0]) * k / 3, from[1] + (to[1] - from[1]) * k / 3}, nullptr,
                  control, shift);
        event(window, vtkCommand::LeftButtonReleaseEvent, to, nullptr, control, shift);
    }
    static void click(EditWindow& window, const Display& at, bool control = false, bool shift = false) {
        drag(window, at, at, control, shift);
    }
    static void double_click(EditWindow& window, const Display& at) {
        for (int i = 0; i < 2; ++i) {
            event(window, vtkCommand::LeftButtonPressEvent, at, nullptr, false, false, i);
            event(window, vtkCommand::LeftButtonReleaseEvent, at);
        }
    }

    /// The pixel of the window that a position of a pane's picture is in.
    static Display display(EditWindow& window, std::size_t pane, const Point<double>& picture) {
        Pane& of = window.pane(pane);
        const Point<double> at = of.to_renderer(picture);
        const int* corner = of.renderer()->GetOrigin();
        return {corner[0] + static_cast<int>(std::floor(at.x)),
                corner[1] + static_cast<int>(std::ceil(at.y)) - 1};
    }
    /// The colours that the window shows, from its lower left corner.
    static std::vector<std::array<int, 3>> shown(EditWindow& window) {
        const int* size = window.window()->GetSize();
        vtkNew<vtkUnsignedCharArray> seen;
        window.window()->Render();
        window.window()->GetPixelData(0, 0, size[0] - 1, size[1] - 1, 0, seen);
        std::vector<std::array<int, 3>> colors;
        for (vtkIdType i = 0; i < seen->GetNumberOfTuples(); ++i)
            colors.push_back({int(seen->GetComponent(i, 0)), int(seen->GetComponent(i, 1)),
                              int(seen->GetComponent(i, 2))});
        return colors;
    }
    static std::array<int, 3> shown_at(EditWindow& window, const Display& at) {
        return shown(window)[static_cast<std::size_t>(at[1] * window.window()->GetSize()[0] + at[0])];
    }
    /// The most that a pane is off a picture of values 0 to 1, in levels of 255; each pixel of it is looked at in its middle.
    static int off(EditWindow& window, std::size_t pane, const OIIO::ImageBuf& expected) {
        EXPECT_FALSE(expected.has_error()) << expected.geterror();
        const std::vector<std::array<int, 3>> colors = shown(window);
        const int width = window.window()->GetSize()[0];
        const OIIO::ImageSpec& spec = expected.spec();
        int most = 0;
        for (int y = 0; y < spec.height; ++y)
            for (int x = 0; x < spec.width; ++x) {
                const Display at = display(window, pane,
                                           {(x + 0.5) / spec.width * window.pane(pane).picture().width,
                                            (y + 0.5) / spec.height * window.pane(pane).picture().height});
                float pixel[4];
                expected.getpixel(x, y, pixel, 3);
                for (std::size_t c = 0; c < 3; ++c)
                    most =
                        std::max(most, std::abs(int(std::lround(255 * pixel[c])) -
                                                colors[static_cast<std::size_t>(at[1] * width + at[0])][c]));
            }
        return most;
    }
    /// A picture of floats that alternate from texel to texel between -most and most, red along rows and green down columns: read bilinearly
    /// it changes by at most 2 `most` a texel, and nearly everywhere lies beyond what a screen shows.
    static OIIO::ImageBuf steep_picture(int width, int height, float most) {
        OIIO::ImageBuf image(OIIO::ImageSpec(width, height, 3, OIIO::TypeFloat));
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const float pixel[3] = {x % 2 ? most : -most, y % 2 ? most : -most, 0.5f};
                image.setpixel(x, y, pixel);
            }
        return image;
    }
    /// What a comparison of such a picture found.
    struct Steep {
        int misfits = 0;   ///< values that source points within the bound do not explain
        int measured = 0;  ///< values that a screen tells apart from those beside them
    };
    /// Compares red and green of a pane, one pixel of the window for each, with values that change by at most `slope` a texel, where source
    /// points are off by at most `bound`. A level is allowed for what the screen's curve is rounded by.
    static Steep compare_steep(EditWindow& window, std::size_t pane, const OIIO::ImageBuf& expected,
                               double slope, double bound) {
        EXPECT_FALSE(expected.has_error()) << expected.geterror();
        // sRGB of IEC 61966-2-1.
        const auto level = [](double v) {
            v = std::min(std::max(v, 0.0), 1.0);
            return 255 * (v > 0.0031308 ? 1.055 * std::pow(v, 1 / 2.4) - 0.055 : 12.92 * v);
        };
        const std::vector<std::array<int, 3>> colors = shown(window);
        const int width = window.window()->GetSize()[0];
        Steep found;
        for (int y = 0; y < expected.spec().height; ++y)
            for (int x = 0; x < expected.spec().width; ++x) {
                const Display at = display(window, pane, {x + 0.5, y + 0.5});
                float pixel[4];
                expected.getpixel(x, y, pixel, 3);
                for (std::size_t c = 0; c < 2; ++c) {
                    const int seen = colors[static_cast<std::size_t>(at[1] * width + at[0])][c];
                    const double value = double(pixel[c]);
                    found.misfits += seen < level(value - slope * bound) - 1.5 ||
                                     seen > level(value + slope * bound) + 1.5;
                    found.measured += seen > 0 && seen < 255;
                }
            }
        return found;
    }
    /// Runs a program. Returns what it ended with, and what it said.
    std::pair<int, std::string> run(const std::string& program, const std::string& arguments) const {
        const int status =
            std::system((program + " " + arguments + " > " + path("log.txt") + " 2>&1").c_str());
        return {status, read("log.txt")};
    }

    std::filesystem::path m_folder;
};

}  // namespace anamorph::test
