// SPDX-License-Identifier: Apache-2.0
// anamorph-warp with morphs: features that are dragged, drawn and taken away, sliders, playing, and what its window shows against the
// operation itself.
#include <gmock/gmock.h>
#include <morph_window.h>

#include "anamorph/morph/features_file.h"
#include "anamorph/oiio_ops.h"
#include "window_support.h"

namespace anamorph {
namespace {

using anamorph_editor::MorphWindow;
using testing::HasSubstr;

class VtkMorphWindow : public test::WindowTest {
  protected:
    static constexpr Size kPicture{90, 70};

    void write_all() {
        write("a.png", picture(kPicture.width, kPicture.height));
        write("b.png", picture(kPicture.width, kPicture.height, 1.3));
        write("f.csv", "10,10,60,20,20,15,70,12,1\n60,20,50,60,70,12,60,55,2\n");
    }
    std::string recipe(const std::string& features = "f.csv",
                       const std::string& more = "&t=0.25&wrap=clamp") const {
        return path("a.png") + ".morph?b=" + path("b.png") + "&features=" + path(features) + more;
    }
    static void prepare_all(MorphWindow& window) { prepare(window, 630, 260); }
    OIIO::ImageBuf drawn(const std::string& features, double t, double a = 1,
                         const Size& size = kPicture) const {
        const OIIO::ImageBuf first(path("a.png")), second(path("b.png"));
        OIIO::ParamValueList options;
        options.attribute("features", path(features));
        options.attribute("t", shortest(t));
        options.attribute("weight_a", shortest(a));
        options.attribute("size", std::to_string(size.width) + "x" + std::to_string(size.height));
        return apply("morph", {&first, &second}, options);
    }
};

TEST_F(VtkMorphWindow, ShowsBothPicturesAndWhatIsBetween) {
    write_all();
    MorphWindow window(recipe());
    prepare_all(window);
    EXPECT_FALSE(window.has_changes()) << window.status();
    EXPECT_EQ(window.pane(2).drawn_size(), kPicture);
    EXPECT_EQ(off(window, 2, drawn("f.csv", 0.25)), 0);
    key(window, "g");
    EXPECT_EQ(off(window, 0, OIIO::ImageBuf(path("a.png"))), 0);
    EXPECT_EQ(off(window, 1, OIIO::ImageBuf(path("b.png"))), 0);
    EXPECT_THAT(window.status(), HasSubstr("off by at most "));
    // Smaller than it is: a counts in its pixels.
    window.window()->SetSize(200, 120);
    window.window()->Render();
    const Size small = window.pane(2).drawn_size();
    EXPECT_LT(small.width, kPicture.width);
    EXPECT_EQ(off(window, 2, drawn("f.csv", 0.25, double(small.width) / kPicture.width, small)), 0);
}

TEST_F(VtkMorphWindow, EndsThatMeetAreDraggedInEitherPicture) {
    write_all();
    MorphWindow window(recipe());
    prepare_all(window);
    const double scale = 1 / window.pane(0).pixel();
    const test::Display at = display(window, 0, {60, 20});
    drag(window, at, {at[0] + int(6 * scale), at[1] - int(4 * scale)});
    EXPECT_NEAR(window.editor().features().line(0, 0).q.x, 66, 1e-9);
    EXPECT_NEAR(window.editor().features().line(1, 0).p.y, 24, 1e-9);
    EXPECT_EQ(window.editor().features().line(0, 1).q.x, 70);
    const test::Display b = display(window, 1, {60, 55});
    drag(window, b, {b[0] - int(5 * scale), b[1]});
    EXPECT_NEAR(window.editor().features().line(1, 1).q.x, 55, 1e-9);
    key(window, "s", true);
    EXPECT_EQ(window.error(), "");
    EXPECT_THAT(read("f.csv"), HasSubstr("66,24"));
    EXPECT_EQ(off(window, 2, drawn("f.csv", 0.25)), 0);
    key(window, "z", true);
    key(window, "z", true);
    EXPECT_EQ(window.editor().features().line(0, 0).q.x, 60);
    key(window, "y", true);
    EXPECT_TRUE(window.has_changes());
    key(window, "y", true);
    EXPECT_FALSE(window.has_changes());
    // A line without a length is refused, and all stays.
    const test::Display p = display(window, 0, {10, 10}), q = display(window, 0, {66, 24});
    event(window, vtkCommand::LeftButtonPressEvent, p);
    event(window, vtkCommand::MouseMoveEvent, q);
    EXPECT_THAT(window.error(), HasSubstr("a line needs a length"));
    event(window, vtkCommand::LeftButtonReleaseEvent, q);
    EXPECT_FALSE(window.has_changes());
}

TEST_F(VtkMorphWindow, LinesAreDrawnAndTakenAway) {
    write_all();
    MorphWindow window(recipe("new.json"), true);
    prepare_all(window);
    EXPECT_EQ(window.editor().features().size(), 0u);
    key(window, "n");
    EXPECT_THAT(window.status(), HasSubstr("drawing lines"));
    drag(window, display(window, 0, {10.2, 10.2}), display(window, 0, {50.2, 30.2}));
    drag(window, display(window, 1, {20.2, 60.2}), display(window, 1, {80.2, 50.2}));
    EXPECT_EQ(window.error(), "");
    ASSERT_EQ(window.editor().features().size(), 2u);
    EXPECT_NEAR(window.editor().features().line(1, 0).q.x, 80, 0.5) << "in both pictures";
    key(window, "n");
    const test::Display end = display(window, 1, window.editor().features().line(0, 1).q);
    drag(window, end, {end[0] + 12, end[1]});
    EXPECT_EQ(window.error(), "");
    key(window, "s", true);
    EXPECT_EQ(off(window, 2, drawn("new.json", 0.25)), 0);
    click(window, display(window, 0, window.editor().features().line(1, 0).p));
    key(window, "Delete");
    EXPECT_EQ(window.editor().features().size(), 1u);
    key(window, "z", true);
    EXPECT_EQ(window.editor().features().size(), 2u);
    EXPECT_EQ(off(window, 2, drawn("new.json", 0.25)), 0);
}

TEST_F(VtkMorphWindow, SlidersSetTheirValues) {
    write_all();
    MorphWindow window(recipe());
    prepare_all(window);
    // The first quarter of the strip is t's, its middle four fifths from 0 to 1.
    const int height = window.window()->GetSize()[1] * 12 / 100 - 34;
    const auto at = [&](int slider, double part) {
        return test::Display{int(630 / 4.0 * (slider + 0.1 + 0.8 * part)), std::max(height, 0)};
    };
    drag(window, at(0, 0.25), at(0, 0.75));
    EXPECT_NEAR(window.slider("t").value(), 0.75, 0.02);
    EXPECT_EQ(off(window, 2, drawn("f.csv", window.slider("t").value())), 0);
    drag(window, at(1, 0.1), at(1, 0.4));
    EXPECT_NEAR(window.slider("weight_a").value(), 20, 1);
    EXPECT_EQ(off(window, 2, drawn("f.csv", window.slider("t").value(), window.slider("weight_a").value())),
              0);
    drag(window, at(3, 0.5), {-50, 0});
    EXPECT_EQ(window.slider("weight_p").value(), 0);
    EXPECT_FALSE(window.has_changes()) << "the file has none of them";
}

TEST_F(VtkMorphWindow, PlaysAndSteps) {
    write_all();
    MorphWindow window(recipe());
    prepare_all(window);
    key(window, "period");
    EXPECT_NEAR(window.slider("t").value(), 0.3, 1e-12);
    key(window, "comma");
    key(window, "comma");
    EXPECT_NEAR(window.slider("t").value(), 0.2, 1e-12);
    key(window, "space");
    EXPECT_TRUE(window.plays());
    const auto tick = [&] { window.interactor()->InvokeEvent(vtkCommand::TimerEvent); };
    for (int i = 0; i < 6; ++i) tick();
    EXPECT_NEAR(window.slider("t").value(), 0.3, 1e-9);
    EXPECT_EQ(off(window, 2, drawn("f.csv", window.slider("t").value())), 0);
    for (int i = 0; i < 60; ++i) tick();
    EXPECT_NEAR(window.slider("t").value(), 0.7, 1e-9) << "on to 1 and back";
    key(window, "space");
    EXPECT_FALSE(window.plays());
    tick();
    EXPECT_NEAR(window.slider("t").value(), 0.7, 1e-9);
}

TEST_F(VtkMorphWindow, TheCardDrawsWithinItsBound) {
    constexpr Size kLarge{480, 360};
    constexpr float kMost = 8;
    write("a.exr", steep_picture(kLarge.width, kLarge.height, kMost));
    write("b.exr", steep_picture(kLarge.width, kLarge.height, kMost));
    std::string lines;
    for (int i = 0; i < 24; ++i) {
        const int x = 40 + 61 * (7 * i % 24) % 400, y = 30 + 47 * i % 290;
        const auto at = [&](int dx, int dy) { return std::to_string(x + dx) + "," + std::to_string(y + dy); };
        lines += at(0, 0) + "," + at(40, i) + "," + at(3 + i % 5, i % 7) + "," + at(44, i - 3) + "," +
                 std::to_string(1 + i % 3) + "\n";
    }
    write("f.csv", lines);
    const OIIO::ImageBuf a(path("a.exr")), b(path("b.exr"));
    const auto expected = [&](const char* t, const char* weight_b) {
        OIIO::ParamValueList options;
        for (const auto& [key, value] :
             std::vector<std::pair<std::string, std::string>>{{"features", path("f.csv")},
                                                              {"t", t},
                                                              {"weight_b", weight_b},
                                                              {"filter", "bilinear"},
                                                              {"tol", "0"}})
            options.attribute(key, value);
        return apply("morph", {&a, &b}, options);
    };
    for (const char* weight_b : {"2", "1", "0.5", "1.25", "0"}) {
        SCOPED_TRACE(weight_b);
        MorphWindow window(path("a.exr") + ".morph?b=" + path("b.exr") + "&features=" + path("f.csv") +
                           "&filter=bilinear&t=0.25&weight_b=" + weight_b);
        window.draw_by_fragments(true);
        prepare(window, 1500, 460);
        ASSERT_EQ(window.pane(2).drawn_size(), kLarge) << "pixel for pixel";
        EXPECT_GT(window.bound(), 1e-6);
        EXPECT_LT(window.bound(), 0.2);
        const Steep found = compare_steep(window, 2, expected("0.25", weight_b), 2 * kMost, window.bound());
        EXPECT_EQ(found.misfits, 0) << window.bound();
        EXPECT_GT(found.measured, 1000);
        // Far below the bound it still fits nearly everywhere; a little later in the morph it does not.
        EXPECT_LT(compare_steep(window, 2, expected("0.25", weight_b), 2 * kMost, 1e-3).misfits, 20);
        EXPECT_GT(compare_steep(window, 2, expected("0.27", weight_b), 2 * kMost, 1e-3).misfits, 1000);
    }
}

TEST_F(VtkMorphWindow, TheCardFollowsDragsAndSliders) {
    write_all();
    MorphWindow window(recipe("f.csv", "&t=0.25&pin_border=1&filter=bilinear"));
    prepare_all(window);
    key(window, "v");
    const test::Display at = display(window, 0, {60, 20});
    drag(window, at, {at[0] + 12, at[1] - 8});
    key(window, "period");
    EXPECT_EQ(window.error(), "");
    EXPECT_THAT(window.status(), HasSubstr("by fragments"));
    const auto card = shown(window);
    key(window, "v");
    const auto core = shown(window);
    int most = 0;
    for (std::size_t i = 0; i < card.size(); ++i) {
        // But for the line of words.
        if (i < 36 * 630) continue;
        for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(card[i][c] - core[i][c]));
    }
    EXPECT_LE(most, 1);
}

TEST_F(VtkMorphWindow, WhatNoCardDrawsIsSaid) {
    write_all();
    for (const auto& [more, message] :
         std::vector<std::pair<std::string, std::string>>{{"&filter=bicubic", "filters other than"},
                                                          {"&output=lines", "another output"},
                                                          {"&scheme=hardware", "scheme=hardware"}}) {
        MorphWindow window(recipe("f.csv", "&t=0.25&wrap=clamp" + more));
        prepare_all(window);
        key(window, "v");
        EXPECT_THAT(window.error(), HasSubstr("a graphics card does not draw "));
        EXPECT_THAT(window.error(), HasSubstr(message));
        key(window, "v");
        window.window()->Render();
        EXPECT_EQ(window.error(), "");
    }
    std::string lines;
    for (int i = 0; i < 193; ++i) {
        const std::string y = std::to_string(i / 3.0);
        lines += "10," + y + ",60," + y + ",12," + y + ",62," + y + "\n";
    }
    write("many.csv", lines);
    MorphWindow window(recipe("many.csv"));
    prepare_all(window);
    key(window, "v");
    EXPECT_THAT(window.error(), HasSubstr("features of 193 lines: must have at most 192"));
}

TEST_F(VtkMorphWindow, SvgIsOpenedByItsPicturesAndSaved) {
    write_all();
    // The lower layer is of b.
    Features features(2);
    features.add_curve({{{10, 10}, {20, 5}, {50, 8}, {70, 30}}, {{15, 12}, {30, 5}, {50, 8}, {60, 36}}}, 1,
                       "brow");
    features.add_line({{{10, 50}, {60, 50}}, {{20, 55}, {70, 50}}}, 2);
    for (int k = 0; k < 2; ++k) {
        features.set_title(k, k ? "one" : "two", k ? "a.png" : "b.png");
        features.set_frame(k, {180, 140});
    }
    write("f.svg", features_svg(features));
    MorphWindow window(recipe("f.svg"));
    prepare_all(window);
    EXPECT_FALSE(window.has_changes());
    EXPECT_EQ(window.editor().features().picture(0), "a.png");
    write("ordered.json", features_json(features.in_order({1, 0})));
    EXPECT_EQ(off(window, 2, drawn("ordered.json", 0.25)), 0);
    const test::Display at = display(window, 0, {10, 27.5});
    drag(window, at, {at[0] + 8, at[1]});
    const double moved = window.editor().features().given()[1].points[0][0].x;
    EXPECT_GT(moved, 22);
    key(window, "s", true);
    EXPECT_EQ(window.error(), "");
    MorphWindow again(recipe("f.svg"));
    EXPECT_EQ(again.editor().features().given()[1].points[0][0].x, moved);
    EXPECT_EQ(again.editor().features().given()[0].kind, Features::Given::Kind::curve);
    EXPECT_EQ(again.editor().features().given()[0].name, "brow");
}

TEST_F(VtkMorphWindow, TheProgramSaysWhatIsWrong) {
    write_all();
    write("c.json", R"({"features": [{"line": [[1,2,3,4],[1,2,3,4],[1,2,3,5]]}]})");
    write("bad.csv", "1,2,3\n");
    const std::string program = ANAMORPH_WARP;
    const auto [status, text] =
        run(program, "'" + recipe() + "' --size 630 260 --picture " + path("seen.png"));
    ASSERT_EQ(status, 0) << text;
    EXPECT_EQ(OIIO::ImageBuf(path("seen.png")).spec().width, 630);
    for (const auto& [name, more, message] : std::vector<std::array<std::string, 3>>{
             {recipe("bad.csv"), "", "bad.csv"},
             {recipe("c.json"), "", "has 3 shapes: must have two"},
             {recipe("none.json"), "", "does not exist: must be a file, or --new be given"},
             {recipe(), "--new", "is there already"},
             {recipe("f.csv", "&shape_weights=0.5,0.5"), "", "the window has t"},
             {recipe("f.csv", "&frames=5"), "", "frames=5"},
             {recipe("f.csv", "&c=" + path("a.png")), "", "must have two, a and b"},
             {recipe(), "--save x.txt", "--save=x.txt: must be a .json, .csv or .svg file"},
             {path("a.png") + ".morph?b=" + path("b.png"), "", "features is not given"},
             {path("a.png") + ".morph?features=" + path("f.csv"), "", "must have two"}}) {
        const auto [failed, said] = run(program, "'" + name + "' " + more + " --picture " + path("x.png"));
        EXPECT_EQ(WEXITSTATUS(failed), 1) << name << said;
        EXPECT_THAT(said, HasSubstr("anamorph-warp: "));
        EXPECT_THAT(said, HasSubstr(message));
        EXPECT_LE(said.size(), 400u) << said;
    }
}

}  // namespace
}  // namespace anamorph
