// SPDX-License-Identifier: Apache-2.0
// anamorph-warp: what is dragged, cut and taken back, and what its window shows against the operation itself.
#include <gmock/gmock.h>
#include <warp_window.h>

#include <random>

#include "anamorph/mesh/mesh_file.h"
#include "anamorph/oiio_ops.h"
#include "window_support.h"

namespace anamorph {
namespace {

using anamorph_editor::WarpWindow;
using testing::HasSubstr;
using Place = MeshEditor::Place;

class VtkWarpWindow : public test::WindowTest {
  protected:
    static constexpr Size kPicture{120, 90};

    /// A mesh of 4 by 3 cells, one of them cut, in fractions; its inner points a little off.
    static ControlMesh mesh(Direction direction = Direction::pull) {
        ControlMesh mesh;
        mesh.units = Units::fractions;
        mesh.direction = direction;
        mesh.columns = 4;
        mesh.rows = 3;
        for (int r = 0; r <= 3; ++r)
            for (int c = 0; c <= 4; ++c)
                mesh.vertices.push_back(
                    {c / 4.0 + 0.02 * ((3 * c + r) % 3 - 1), r / 3.0 + 0.02 * ((c + 2 * r) % 3 - 1)});
        mesh.levels.push_back({{{1, 1}}, {{3, 3, {0.39, 0.52}}}});
        return mesh;
    }
    std::string recipe(const std::string& more = "") const {
        return path("p.png") + ".warp?mesh=" + path("m.json") + more;
    }
    void write_all(Direction direction = Direction::pull) {
        write("p.png", picture(kPicture.width, kPicture.height));
        write("m.json", mesh_json(mesh(direction)));
    }
    std::unique_ptr<WarpWindow> open(const std::string& more = "", int width = 640, int height = 300) {
        auto window = std::make_unique<WarpWindow>(recipe(more));
        prepare(*window, width, height);
        return window;
    }
    /// The picture by the operation, by a file of its own.
    OIIO::ImageBuf drawn(const std::string& file, const Size& size = kPicture,
                         const std::string& direction = "") {
        const OIIO::ImageBuf source(path("p.png"));
        OIIO::ParamValueList options;
        options.attribute("mesh", path(file));

        options.attribute("size", std::to_string(size.width) + "x" + std::to_string(size.height));
        if (!direction.empty()) options.attribute("direction", direction);
        return apply("warp", {&source}, options);
    }
    static Point<double> position(const WarpWindow& window, const Place& place) {
        for (const MeshEditor::ControlPoint& point : window.editor().points())
            if (point.place == place) return point.at;
        ADD_FAILURE();
        return {};
    }
    static test::Display display_of(WarpWindow& window, const Place& place) {
        return display(window, window.edited_pane(), position(window, place));
    }
};

TEST_F(VtkWarpWindow, ShowsSourceAndPicture) {
    write_all();
    const auto window = open();
    EXPECT_EQ(window->pane(1).drawn_size(), kPicture) << "each pixel a square of 2";
    EXPECT_FALSE(window->has_changes());
    EXPECT_THAT(window->status(), HasSubstr("off by at most "));
    key(*window, "g");
    EXPECT_EQ(off(*window, 1, drawn("m.json")), 0);
    EXPECT_EQ(off(*window, 0, OIIO::ImageBuf(path("p.png"))), 0);
    // Smaller than it is: as the operation draws it in that size.
    window->window()->SetSize(180, 90);
    window->window()->Render();
    const Size small = window->pane(1).drawn_size();
    EXPECT_LT(small.width, kPicture.width);
    EXPECT_EQ(off(*window, 1, drawn("m.json", small)), 0);
}

TEST_F(VtkWarpWindow, PicturesOfFloatAreShownAsLight) {
    write("p.exr", picture(kPicture.width, kPicture.height, 0, OIIO::TypeHalf));
    write("m.json", mesh_json(mesh()));
    WarpWindow window(path("p.exr") + ".warp?mesh=" + path("m.json"));
    prepare(window, 640, 300);
    key(window, "g");
    OIIO::ImageBuf light(path("p.exr"));
    ASSERT_TRUE(light.read(0, 0, true, OIIO::TypeFloat));
    for (OIIO::ImageBuf::Iterator<float> p(light); !p.done(); ++p)
        for (int c = 0; c < 3; ++c)
            // sRGB of IEC 61966-2-1.
            p[c] = p[c] > 0.0031308f ? 1.055f * std::pow(p[c], 1 / 2.4f) - 0.055f : 12.92f * p[c];
    EXPECT_LE(off(window, 0, light), 1);
}

TEST_F(VtkWarpWindow, APointIsDraggedSavedAndTakenBack) {
    write_all();
    const auto window = open();
    const std::string before = read("m.json");
    const Place place{0, 2, 1};
    const Point<double> from = position(*window, place);
    const test::Display at = display_of(*window, place);
    drag(*window, at, {at[0] + 18, at[1] - 12});
    EXPECT_THAT(window->editor().selected(), testing::ElementsAre(place));
    // Two pixels of the window are one of the picture, and rows go down.
    EXPECT_NEAR(position(*window, place).x, from.x + 9, 1e-9);
    EXPECT_NEAR(position(*window, place).y, from.y + 6, 1e-9);
    EXPECT_TRUE(window->has_changes());
    EXPECT_THAT(window->status(), HasSubstr("not saved"));
    EXPECT_LE(window->drawn_pixels(), kPicture.width * kPicture.height) << "nothing twice";
    key(*window, "s", true);
    EXPECT_EQ(window->error(), "");
    EXPECT_FALSE(window->has_changes());
    EXPECT_NE(read("m.json"), before);
    key(*window, "g");
    EXPECT_EQ(off(*window, 1, drawn("m.json")), 0);
    key(*window, "z", true);
    EXPECT_NEAR(position(*window, place).x, from.x, 1e-12);
    EXPECT_TRUE(window->has_changes());
    key(*window, "y", true);
    EXPECT_FALSE(window->has_changes());
    key(*window, "z", true);
    key(*window, "Z", true, true);
    EXPECT_FALSE(window->has_changes());
    key(*window, "z", true);
    write("before.json", before);
    EXPECT_EQ(off(*window, 1, drawn("before.json")), 0);
}

TEST_F(VtkWarpWindow, PointsOfARectangleMoveTogether) {
    write_all();
    const auto window = open();
    const test::Display a = display_of(*window, {0, 1, 1}), b = display_of(*window, {0, 3, 2});
    drag(*window, {a[0] - 12, a[1] + 12}, {b[0] + 12, b[1] - 12});
    const std::size_t inside = window->editor().selected().size();
    EXPECT_GE(inside, 6u);
    drag(*window, {a[0] - 12, a[1] + 12}, {a[0] + 5, a[1] - 5}, true);
    EXPECT_EQ(window->editor().selected().size(), inside - 1) << "ctrl: as it was not";
    click(*window, display_of(*window, {0, 0, 0}), false, true);
    EXPECT_EQ(window->editor().selected().size(), inside) << "shift: one more";
    const Point<double> from = position(*window, {0, 2, 2}), corner = position(*window, {0, 0, 0}),
                        still = position(*window, {0, 1, 1});
    drag(*window, b, {b[0] + 6, b[1]});
    EXPECT_NEAR(position(*window, {0, 2, 2}).x, from.x + 3, 1e-9);
    EXPECT_NEAR(position(*window, {0, 0, 0}).x, corner.x + 3, 1e-9);
    EXPECT_NEAR(position(*window, {0, 1, 1}).x, still.x, 1e-12);
    click(*window, {a[0] - 12, a[1] + 12});
    EXPECT_TRUE(window->editor().selected().empty()) << "a click beside points";
    key(*window, "a", false, false, a);
    std::size_t movable = 0;
    for (const auto& point : window->editor().points()) movable += !point.is_fixed;
    EXPECT_EQ(window->editor().selected().size(), movable);
    key(*window, "Escape");
    EXPECT_TRUE(window->editor().selected().empty());
}

TEST_F(VtkWarpWindow, EscapeGivesADragUp) {
    write_all();
    const auto window = open();
    const test::Display at = display_of(*window, {0, 2, 1});
    event(*window, vtkCommand::LeftButtonPressEvent, at);
    event(*window, vtkCommand::MouseMoveEvent, {at[0] + 20, at[1]});
    EXPECT_TRUE(window->has_changes());
    key(*window, "Escape");
    event(*window, vtkCommand::MouseMoveEvent, {at[0] + 30, at[1]});
    event(*window, vtkCommand::LeftButtonReleaseEvent, {at[0] + 30, at[1]});
    EXPECT_FALSE(window->has_changes());
    EXPECT_EQ(window->editor().steps(), 0u);
    key(*window, "g");
    EXPECT_EQ(off(*window, 1, drawn("m.json")), 0);
}

TEST_F(VtkWarpWindow, CellsAreCutAndTVerticesShown) {
    write_all();
    const auto window = open();
    std::vector<Point<double>> fixed;
    for (const auto& point : window->editor().points())
        if (point.is_fixed) fixed.push_back(point.at);
    ASSERT_EQ(fixed.size(), 4u);
    const test::Display cross = display(*window, 0, fixed[0]);
    const std::array<int, 3> color = shown_at(*window, cross);
    EXPECT_GT(color[1], 200) << "a cross of cyan";
    EXPECT_LT(color[0], 120);
    click(*window, cross);
    EXPECT_TRUE(window->editor().selected().empty()) << "it cannot be dragged";
    const std::size_t before = window->editor().points().size();
    double_click(*window, display(*window, 0, {15, 15}));
    EXPECT_GT(window->editor().points().size(), before);
    EXPECT_EQ(window->editor().steps(), 1u);
    // In the picture's pane, where the mesh lies, and by a key.
    key(*window, "c", false, false, display(*window, 1, {105, 75}));
    EXPECT_EQ(window->editor().steps(), 2u);
    key(*window, "s", true);
    key(*window, "g");
    EXPECT_EQ(off(*window, 1, drawn("m.json")), 0);
    double_click(*window, {3, 290});
    EXPECT_THAT(window->error(), HasSubstr("no cell"));
}

TEST_F(VtkWarpWindow, MeshesThatPushAreDraggedInThePicture) {
    write_all(Direction::push);
    const auto window = open();
    EXPECT_EQ(window->edited_pane(), 1u);
    const Place place{0, 2, 1};
    const Point<double> from = position(*window, place);
    const test::Display at = display_of(*window, place);
    drag(*window, at, {at[0] + 10, at[1] + 4});
    EXPECT_NEAR(position(*window, place).x, from.x + 5, 1e-9);
    EXPECT_NEAR(position(*window, place).y, from.y - 2, 1e-9);
    key(*window, "s", true);
    key(*window, "g");
    EXPECT_EQ(off(*window, 1, drawn("m.json")), 0);
}

TEST_F(VtkWarpWindow, TheRecipeSaysTheDirectionAndTheFileKeepsItsOwn) {
    write_all(Direction::push);
    const auto window = open("&direction=pull");
    EXPECT_EQ(window->edited_pane(), 0u);
    const test::Display at = display_of(*window, {0, 2, 1});
    drag(*window, at, {at[0] + 10, at[1] + 4});
    key(*window, "s", true);
    EXPECT_EQ(std::get<ControlMesh>(parse_mesh_json(read("m.json"), "m").shape).direction, Direction::push);
    key(*window, "g");
    EXPECT_EQ(off(*window, 1, drawn("m.json", kPicture, "pull")), 0);
}

TEST_F(VtkWarpWindow, PicturesDrawnInPartsAreThoseDrawnWhole) {
    constexpr unsigned kSeed = 551;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    write("p.png", picture(900, 700));
    ControlMesh pixels = mesh();
    for (auto& v : pixels.vertices) v = {v.x * 900, v.y * 700};
    for (auto& v : pixels.levels[0].vertices) v.at = {v.at.x * 900, v.at.y * 700};
    pixels.units = Units::pixels;
    write("m.json", mesh_json(pixels));
    WarpWindow window(recipe());
    prepare(window, 640, 300);
    window.pane(1).zoom({480, 150}, true);
    std::int64_t drawn = 0, whole = 0;
    for (int i = 0; i < 12; ++i) {
        const auto& points = window.editor().points();
        const auto& point = points[random() % points.size()];
        if (point.is_fixed) continue;
        const test::Display at = display(window, 0, point.at);
        event(window, vtkCommand::LeftButtonPressEvent, at);
        event(window, vtkCommand::MouseMoveEvent,
              {at[0] + int(random() % 21) - 10, at[1] + int(random() % 21) - 10});
        drawn += window.drawn_pixels();
        whole += std::int64_t{window.pane(1).pixels().box.width()} * window.pane(1).pixels().box.height();
        event(window, vtkCommand::LeftButtonReleaseEvent, at);
        if (i % 4 == 3) key(window, "c", false, false, {at[0] + 7, at[1] + 7});
    }
    EXPECT_LT(double(drawn), 0.8 * double(whole));
    ASSERT_EQ(window.error(), "");
    const auto parts = window.pane(1).pixels().rgb;
    key(window, "s", true);
    WarpWindow other(recipe());
    prepare(other, 640, 300);
    other.pane(1).zoom({480, 150}, true);
    other.window()->Render();
    EXPECT_EQ(window.pane(1).pixels().box, other.pane(1).pixels().box);
    EXPECT_EQ(parts, other.pane(1).pixels().rgb);
}

TEST_F(VtkWarpWindow, PanesAreMagnifiedAndMoved) {
    write_all();
    const auto window = open();
    const test::Display at{100, 150};
    const Point<double> place = window->pane(0).to_picture(at);
    for (int i = 0; i < 3; ++i) event(*window, vtkCommand::MouseWheelForwardEvent, at);
    EXPECT_EQ(window->pane(0).pixel(), 1 / 5.0);
    // Each step puts it on whole pixels again.
    EXPECT_NEAR(window->pane(0).to_picture(at).x, place.x, 1.5);
    EXPECT_NEAR(window->pane(0).to_picture(at).y, place.y, 1.5);
    const double moved = window->pane(0).to_picture(at).x;
    event(*window, vtkCommand::MiddleButtonPressEvent, at);
    for (int k = 1; k <= 20; ++k) event(*window, vtkCommand::MouseMoveEvent, {at[0] + k, at[1] - k});
    event(*window, vtkCommand::MiddleButtonReleaseEvent, {at[0] + 20, at[1] - 20});
    EXPECT_NEAR(window->pane(0).to_picture({at[0] + 20, at[1] - 20}).x, moved, 1e-9);
    // Points are still hit, and dragged by pixels of the picture.
    const Place corner{0, 1, 1};
    const Point<double> from = position(*window, corner);
    const test::Display point = display_of(*window, corner);
    drag(*window, point, {point[0] + 10, point[1]});
    EXPECT_NEAR(position(*window, corner).x, from.x + 2, 1e-9);
    for (int i = 0; i < 60; ++i) event(*window, vtkCommand::MouseWheelBackwardEvent, at);
    for (int i = 0; i < 90; ++i) event(*window, vtkCommand::MouseWheelForwardEvent, at);
    EXPECT_EQ(window->error(), "");
    key(*window, "f");
    EXPECT_EQ(window->pane(0).pixel(), 0.5);
    key(*window, "g");
    EXPECT_EQ(off(*window, 0, OIIO::ImageBuf(path("p.png"))), 0);
}

TEST_F(VtkWarpWindow, ANewMeshStartsEven) {
    write("p.png", picture(kPicture.width, kPicture.height));
    WarpWindow window(recipe(), {5, 4});
    prepare(window, 640, 300);
    EXPECT_TRUE(window.has_changes()) << "there is no file yet";
    EXPECT_EQ(window.editor().points().size(), 30u);
    key(window, "g");
    EXPECT_EQ(off(window, 1, OIIO::ImageBuf(path("p.png"))), 0);
    EXPECT_TRUE(window.save());
    EXPECT_FALSE(window.has_changes());
    EXPECT_EQ(std::get<ControlMesh>(parse_mesh_json(read("m.json"), "m").shape).columns, 5);
}

TEST_F(VtkWarpWindow, ChangesAreNotLostInSilence) {
    write_all();
    const std::string elsewhere = path("none/there.json");
    WarpWindow window(recipe(), {}, elsewhere);
    prepare(window, 640, 300);
    double_click(window, display(window, 0, {15, 15}));
    key(window, "s", true);
    EXPECT_THAT(window.error(), HasSubstr("there.json cannot be written"));
    EXPECT_TRUE(window.has_changes());
    key(window, "q");
    EXPECT_FALSE(window.ended());
    EXPECT_THAT(window.status(), HasSubstr("not saved"));
    EXPECT_THAT(window.error(), HasSubstr("ctrl+s saves them"));
    key(window, "g");
    key(window, "q");
    EXPECT_FALSE(window.ended()) << "another key between them";
    key(window, "q");
    EXPECT_TRUE(window.ended());
    const auto saved = open();
    key(*saved, "q");
    EXPECT_TRUE(saved->ended());
}

TEST_F(VtkWarpWindow, TheCardDrawsWithinItsBound) {
    constexpr Size kLarge{800, 600};
    constexpr float kMost = 100;
    write("p.exr", steep_picture(kLarge.width, kLarge.height, kMost));
    write("m.json", mesh_json(mesh()));
    ControlMesh moved = mesh();
    for (Point<double>& vertex : moved.vertices) vertex.x += 0.002 / kLarge.width;
    write("moved.json", mesh_json(moved));
    const auto expected = [&](const std::string& file) {
        const OIIO::ImageBuf source(path("p.exr"));
        OIIO::ParamValueList options;
        options.attribute("mesh", path(file));
        options.attribute("filter", "bilinear");
        options.attribute("tol", "0");
        return apply("warp", {&source}, options);
    };
    WarpWindow window(path("p.exr") + ".warp?mesh=" + path("m.json") + "&filter=bilinear");
    window.draw_by_fragments(true);
    prepare(window, 1640, 700);
    key(window, "g");
    ASSERT_EQ(window.pane(1).drawn_size(), kLarge) << "pixel for pixel";
    EXPECT_THAT(window.status(), HasSubstr("by fragments"));
    EXPECT_GT(window.bound(), 1e-6);
    EXPECT_LT(window.bound(), 5e-4);
    const Steep found = compare_steep(window, 1, expected("m.json"), 2 * kMost, window.bound());
    EXPECT_EQ(found.misfits, 0);
    EXPECT_GT(found.measured, 1000) << "to a 5000th of a texel";
    EXPECT_GT(compare_steep(window, 1, expected("moved.json"), 2 * kMost, window.bound()).misfits, 500)
        << "it would notice";
    // Drawn by the core again, it is what it was.
    key(window, "v");
    EXPECT_EQ(compare_steep(window, 1, expected("m.json"), 2 * kMost, 0.01).misfits, 0);
    EXPECT_THAT(window.status(), HasSubstr("(tol 0.01)"));
}

TEST_F(VtkWarpWindow, TheCardReadsImagesAsTheCoreDoes) {
    write("p.png", picture(kPicture.width, kPicture.height));
    ControlMesh far = mesh();
    // Beyond all edges, turned over in part, by more than the image's size.
    for (Point<double>& vertex : far.vertices)
        vertex = {2.6137 * vertex.x - 0.8071, 0.5 - 2.2217 * (vertex.y - 0.5113)};
    far.levels[0].vertices[0].at = {0.3019, 0.4007};
    write("m.json", mesh_json(far));
    for (const char* wrap : {"black", "clamp", "periodic", "mirror"})
        for (const char* filter : {"bilinear", "nearest"}) {
            SCOPED_TRACE(std::string(wrap) + " " + filter);
            const OIIO::ImageBuf source(path("p.png"));
            OIIO::ParamValueList options;
            options.attribute("mesh", path("m.json"));
            options.attribute("filter", filter);
            options.attribute("wrap", wrap);
            options.attribute("tol", "0");
            WarpWindow window(recipe(std::string("&wrap=") + wrap + "&filter=" + filter));
            window.draw_by_fragments(true);
            prepare(window, 640, 300);
            key(window, "g");
            EXPECT_LE(off(window, 1, apply("warp", {&source}, options)), 1);
            // Larger, in part, and moved.
            event(window, vtkCommand::MouseWheelForwardEvent, {500, 170});
            event(window, vtkCommand::MiddleButtonPressEvent, {500, 170});
            event(window, vtkCommand::MouseMoveEvent, {470, 180});
            event(window, vtkCommand::MiddleButtonReleaseEvent, {470, 180});
            const std::array<int, 3> card = shown_at(window, {450, 150});
            key(window, "v");
            const std::array<int, 3> core = shown_at(window, {450, 150});
            for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(card[c], core[c], 2);
        }
}

TEST_F(VtkWarpWindow, TheCardAveragesWhatItShowsSmaller) {
    constexpr Size kLarge{960, 720};
    write("p.png", picture(kLarge.width, kLarge.height));
    write("m.json", mesh_json(mesh()));
    WarpWindow window(recipe("&wrap=clamp"));
    window.draw_by_fragments(true);
    prepare(window, 640, 300);
    key(window, "g");
    const Size drawn_size = window.pane(1).drawn_size();
    EXPECT_LT(3 * drawn_size.width, kLarge.width);
    const OIIO::ImageBuf source(path("p.png"));
    OIIO::ParamValueList options;
    options.attribute("mesh", path("m.json"));
    options.attribute("size", std::to_string(drawn_size.width) + "x" + std::to_string(drawn_size.height));
    options.attribute("wrap", "clamp");
    EXPECT_LE(off(window, 1, apply("warp", {&source}, options)), 8) << "not by the same weights";
}

TEST_F(VtkWarpWindow, TheCardFollowsDragsAndCuts) {
    write_all();
    const auto window = open("&filter=bilinear");
    key(*window, "v");
    EXPECT_TRUE(window->draws_by_fragments());
    const test::Display at = display_of(*window, {0, 2, 1});
    drag(*window, at, {at[0] + 18, at[1] - 12});
    key(*window, "c", false, false, display(*window, 0, {90, 20}));
    EXPECT_EQ(window->error(), "");
    key(*window, "s", true);
    key(*window, "g");
    const OIIO::ImageBuf source(path("p.png"));
    OIIO::ParamValueList options;
    options.attribute("mesh", path("m.json"));
    options.attribute("filter", "bilinear");
    options.attribute("tol", "0");
    EXPECT_LE(off(*window, 1, apply("warp", {&source}, options)), 1);
    key(*window, "z", true);
    key(*window, "v");
    key(*window, "z", true);
    write_all();
    EXPECT_EQ(off(*window, 1, apply("warp", {&source}, options)), 0)
        << "the core draws all that changed since";
}

TEST_F(VtkWarpWindow, WhatIsDrawnInPartsIsAsDrawnWhole) {
    constexpr unsigned kSeed = 552;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    write_all();
    for (const bool by_fragments : {false, true}) {
        const auto window = open("&filter=bilinear");
        window->draw_by_fragments(by_fragments);
        int parts = 0;
        for (int i = 0; i < 24; ++i) {
            const auto& points = window->editor().points();
            const test::Display at = display(*window, 0, points[random() % points.size()].at);
            const test::Display to{at[0] + int(random() % 41) - 20, at[1] + int(random() % 41) - 20};
            if (i % 6 == 5) key(*window, "c", false, false, to);
            event(*window, vtkCommand::LeftButtonPressEvent, at, nullptr, i % 3 == 1);
            event(*window, vtkCommand::MouseMoveEvent, to);
            parts += window->drawn_area() > 0 && window->drawn_area() < 640 * 300 / 2;
            const auto in_parts = shown(*window);
            // As if nothing were known of what was drawn.
            window->draw_by_fragments(by_fragments);
            const auto whole = shown(*window);
            int differ = 0;
            for (std::size_t k = 24 * 640; k < whole.size(); ++k) differ += whole[k] != in_parts[k];
            EXPECT_EQ(differ, 0) << i;
            if (i % 4 == 3) key(*window, "Escape");
            event(*window, vtkCommand::LeftButtonReleaseEvent, to);
        }
        EXPECT_GT(parts, 8);
    }
}

TEST_F(VtkWarpWindow, WhatNoCardDrawsIsSaid) {
    write_all();
    for (const auto& [more, message] : std::vector<std::pair<std::string, std::string>>{
             {"&direction=push", "meshes that push"},
             {"&filter=bicubic", "filters other than nearest, bilinear"},
             {"&scheme=hardware", "scheme=hardware"},
             {"&scheme=residual", "scheme=residual"},
             {"&output=stmap", "another output than color"},
             {"&output=mesh", "another output than color"}}) {
        SCOPED_TRACE(more);
        const auto window = open(more);
        key(*window, "v");
        EXPECT_THAT(window->error(), HasSubstr("a graphics card does not draw "));
        EXPECT_THAT(window->error(), HasSubstr(message));
        key(*window, "v");
        window->window()->Render();
        EXPECT_EQ(window->error(), "");
    }
    ControlMesh fine;
    fine.units = Units::fractions;
    fine.columns = fine.rows = 200;
    for (int r = 0; r <= 200; ++r)
        for (int c = 0; c <= 200; ++c) fine.vertices.push_back({c / 200.0, r / 200.0});
    write("m.json", mesh_json(fine));
    write("p.png", picture(400, 300));
    const auto window = open("", 900, 340);
    key(*window, "v");
    EXPECT_THAT(window->error(), HasSubstr("a mesh of 40000 cells: must have at most 16384"));
}

TEST_F(VtkWarpWindow, WhatCannotBeDrawnIsSaidAndTheMeshStays) {
    write_all();
    const auto window = open();
    const std::string before = mesh_json(window->editor().mesh());
    const test::Display at = display_of(*window, {0, 2, 1});
    event(*window, vtkCommand::LeftButtonPressEvent, at);
    // Farther than positions may lie.
    for (int i = 0; i < 3; ++i) event(*window, vtkCommand::MouseMoveEvent, {2000000000, at[1]});
    EXPECT_THAT(window->error(), HasSubstr("must stand for at most 1e8 pixels"));
    event(*window, vtkCommand::LeftButtonReleaseEvent, {2000000000, at[1]});
    EXPECT_EQ(mesh_json(window->editor().mesh()), before);
}

TEST_F(VtkWarpWindow, TheProgramWritesItsWindowAndSaysWhatIsWrong) {
    write_all();
    write("bad.json", R"({"columns": 2, "rows": 2, "vertices": [[0, 0]]})");
    write("points.json", R"({"points": [[0, 0, 1, 1], [9, 0, 9, 1], [0, 9, 0, 9]]})");
    write("cut.json", mesh_json(mesh()).substr(0, 90));
    write("a.warp", "src=p.png\nmesh=m.json\n");
    const std::string program = ANAMORPH_WARP, p = path("p.png") + ".warp?mesh=";
    const auto [status, text] =
        run(program, "'" + path("a.warp") + "' --size 640 300 --picture " + path("seen.png"));
    ASSERT_EQ(status, 0) << text;
    EXPECT_EQ(OIIO::ImageBuf(path("seen.png")).spec().width, 640);
    for (const auto& [arguments, message] : std::vector<std::pair<std::string, std::string>>{
             {p + path("bad.json"), "bad.json"},
             {p + path("cut.json"), "cut.json"},
             {p + path("points.json"), "the file holds points: must hold a mesh"},
             {p + path("none.json"), "does not exist: must be a mesh, or --cells be given"},
             {p + path("m.json") + " --cells 3 3", "is there already: must be another file"},
             {p + path("p.png"), "must be a .json file to be edited"},
             {path("p.png") + ".warp", "mesh is not given"},
             {path("none.png") + ".warp?mesh=" + path("m.json"), "none.png"},
             {p + path("m.json") + "&tol=-1", "tol=-1"},
             {p + path("m.json") + "&overscan=8", "overscan=8"},
             {p + path("m.json") + "&tolerance=1", "tolerance"},
             {path("p.png"), "is not a recipe's name"},
             {path("p.png") + ".pano?to=fisheye", "a recipe of .pano has no mesh: must be one that has"},
             {p + path("m.json") + "&filter=bicubic --draw fragments --picture " + path("x.png"),
              "a graphics card does not draw by filters other than"},
             {p + path("m.json") + " --draw paper --picture " + path("x.png"),
              "draw=paper: must be picture or fragments"},
             {p + path("m.json") + " --save x.txt --picture " + path("x.png"),
              "--save=x.txt: must be a .json file"},
             {p + path("m.json") + " --picture " + path("none/x.png"), "x.png"}}) {
        const std::size_t space = arguments.find(" --");
        const auto [failed, said] =
            run(program,
                "'" + arguments.substr(0, space) + "'" +
                    (space == std::string::npos ? " --picture " + path("x.png") : arguments.substr(space)));
        EXPECT_EQ(WEXITSTATUS(failed), 1) << arguments << said;
        EXPECT_THAT(said, HasSubstr("anamorph-warp: ")) << arguments;
        EXPECT_THAT(said, HasSubstr(message)) << arguments;
        EXPECT_LE(said.size(), 400u) << said;
    }
}

}  // namespace
}  // namespace anamorph
