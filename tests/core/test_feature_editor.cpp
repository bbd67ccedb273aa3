// SPDX-License-Identifier: Apache-2.0
// Editing features: what is selected, what moves, what is added and taken away, and that every step may be taken back; and the files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "anamorph/error.h"
#include "anamorph/morph/feature_editor.h"
#include "anamorph/morph/features_file.h"
#include "mesh_cases.h"

namespace anamorph::test_feature_editor {
namespace {

using Place = FeatureEditor::Place;
using Kind = Features::Given::Kind;
using testing::ElementsAre;
using testing::HasSubstr;

std::string refusal(const std::function<void()>& body) {
    try {
        body();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

/// Features of every kind, of `shapes` shapes; CSV has lines alone.
Features random_features(test::Random& random, int shapes, bool lines_alone) {
    Features features(shapes);
    const int count = random.whole(1, 9);
    for (int i = 0; i < count; ++i) {
        const int kind = lines_alone ? 0 : random.whole(0, 2);
        const int points = kind == 0 ? 2 : kind == 1 ? random.whole(2, 5) : 3 * random.whole(1, 2) + 1;
        Features::Given given{static_cast<Kind>(kind), {}, i % 3 == 1 ? random.between(0.1, 4) : 1, ""};
        if (!lines_alone && i % 4 == 2) given.name = "brow & \"ear\" " + std::to_string(i);
        for (int k = 0; k < shapes; ++k) {
            given.points.emplace_back();
            for (int n = 0; n < points; ++n)
                given.points.back().push_back({random.between(-50, 900), random.between(-50, 700)});
        }
        features.add(given);
    }
    return features;
}

/// Are the lines that two files make the same to the bit?
void expect_same_lines(const Features& a, const Features& b) {
    ASSERT_EQ(a.size(), b.size());
    ASSERT_EQ(a.shapes(), b.shapes());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a.weight(i), b.weight(i));
        for (int k = 0; k < a.shapes(); ++k) {
            const Line &l = a.line(i, k), &m = b.line(i, k);
            EXPECT_TRUE(l.p.x == m.p.x && l.p.y == m.p.y && l.q.x == m.q.x && l.q.y == m.q.y) << i;
        }
    }
    EXPECT_EQ(a.border_weight(), b.border_weight());
    for (int k = 0; k < a.shapes(); ++k) EXPECT_EQ(a.frame(k).width, b.frame(k).width);
}

TEST(FeatureEditor, WritesWhatItReads) {
    constexpr unsigned kSeed = 3702;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    for (int i = 0; i < 60; ++i) {
        const int shapes = random.whole(2, 4);
        Features features = random_features(random, shapes, false);
        if (i % 2)
            for (int k = 0; k < shapes; ++k)
                features.set_frame(k, {random.between(10, 999), random.between(10, 999)});
        expect_same_lines(parse_features_svg(features_svg(features), "f.svg"), features);
        if (i % 3 == 0) features.pin_border(random.between(0.1, 3));
        const Features read = parse_features_json(features_json(features), "f.json");
        expect_same_lines(read, features);
        ASSERT_EQ(read.given().size(), features.given().size());
        for (std::size_t n = 0; n < read.given().size(); ++n) {
            EXPECT_EQ(read.given()[n].kind, features.given()[n].kind);
            EXPECT_EQ(read.given()[n].name, features.given()[n].name);
        }
        const Features lines = random_features(random, 2, true);
        expect_same_lines(parse_features_csv(features_csv(lines), "f.csv"), lines);
        for (const char* name : {"f.json", "f.csv", "f.svg"})
            expect_same_lines(parse_features_file(features_text(lines, name), name), lines);
    }
}

TEST(FeatureEditor, SvgKeepsItsPictures) {
    Features features(2);
    features.add_line({{{0, 0}, {9, 1}}, {{2, 0}, {7, 3}}});
    features.set_title(1, "dog", "dog.png");
    features.set_frame(1, {640, 480});
    const Features read = parse_features_svg(features_svg(features), "f.svg");
    EXPECT_EQ(read.title(1), "dog");
    EXPECT_EQ(read.picture(1), "dog.png");
    EXPECT_EQ(read.frame(1).height, 480);
    EXPECT_EQ(read.frame(0).height, 0);
    EXPECT_THAT(refusal([&] { features_json(features); }),
                HasSubstr("must be those of all pictures or of none"));
}

TEST(FeatureEditor, RefusesWhatAFormatLacks) {
    Features features(2);
    features.add_line({{{0, 0}, {9, 1}}, {{2, 0}, {7, 3}}}, 1, "brow");
    EXPECT_THAT(refusal([&] { features_csv(features); }),
                HasSubstr("CSV has no names of lines: must be saved as"));
    features.pin_border(1);
    EXPECT_THAT(refusal([&] { features_csv(features); }), HasSubstr("CSV has no pin_border"));
    EXPECT_THAT(refusal([&] { features_svg(features); }), HasSubstr("SVG has no pin_border"));
    Features curve(2);
    curve.add_curve({{{0, 0}, {1, 0}, {2, 1}, {3, 3}}, {{0, 0}, {1, 0}, {2, 1}, {3, 3}}});
    EXPECT_THAT(refusal([&] { features_csv(curve); }), HasSubstr("CSV has no curves"));
    curve.set_frame(0, {9, 9});
    EXPECT_THAT(refusal([&] { features_csv(curve); }), HasSubstr("CSV has no sizes"));
    EXPECT_THAT(refusal([&] { features_csv(random_features(*std::make_unique<test::Random>(1u), 3, true)); }),
                HasSubstr("more than two shapes"));
}

FeatureEditor corner() {
    Features features(2);
    features.add_line({{{0, 0}, {10, 0}}, {{1, 1}, {11, 1}}});
    features.add_line({{{10, 0}, {10, 20}}, {{12, 1}, {12, 21}}});
    features.add_curve({{{0, 0}, {1, 0}, {2, 1}, {3, 3}}, {{0, 0}, {1, 0}, {2, 1}, {3, 3}}});
    return FeatureEditor(features);
}

TEST(FeatureEditor, SelectsPointsThatMeetAndDragsThem) {
    FeatureEditor editor = corner();
    EXPECT_EQ(editor.points(0).size(), 8u);
    EXPECT_FALSE(editor.point_near(0, {14, 0}, 3));
    EXPECT_FALSE(editor.point_near(0, {NAN, 0}, 1e9));
    const auto near = editor.point_near(0, {11, 0}, 3);
    ASSERT_TRUE(near);
    editor.select(*near, Selecting::only);
    EXPECT_THAT(editor.selected(), ElementsAre(Place{0, 0, 1}, Place{1, 0, 0}));
    editor.drag({1, 2});
    editor.drag({3, 4});
    EXPECT_EQ(editor.at({0, 0, 1}).x, 13);
    EXPECT_EQ(editor.at({1, 0, 0}).y, 4);
    EXPECT_EQ(editor.at({0, 1, 1}).x, 11) << "the other shape stays";
    editor.end_drag();
    EXPECT_EQ(editor.steps(), 1u);
    EXPECT_TRUE(editor.undo());
    EXPECT_EQ(editor.at({0, 0, 1}).x, 10);
    EXPECT_FALSE(editor.undo());
    EXPECT_TRUE(editor.redo());
    EXPECT_EQ(editor.at({0, 0, 1}).x, 13);
    EXPECT_FALSE(editor.redo());
    editor.drag({5, 5});
    editor.end_drag(false);
    EXPECT_EQ(editor.at({0, 0, 1}).x, 13);
    EXPECT_EQ(editor.steps(), 1u);
}

TEST(FeatureEditor, WhatHasNoLengthIsRefusedAndAllStays) {
    FeatureEditor editor = corner();
    editor.select({0, 1, 1}, Selecting::only);
    EXPECT_THAT(refusal([&] { editor.drag({-10, 0}); }), HasSubstr("a line needs a length"));
    EXPECT_THAT(refusal([&] { editor.drag({NAN, 0}); }), HasSubstr("coordinates"));
    EXPECT_THAT(refusal([&] { editor.drag({2e9, 0}); }), HasSubstr("coordinates"));
    EXPECT_EQ(editor.at({0, 1, 1}).x, 11);
    editor.drag({-3, 0});
    EXPECT_THAT(refusal([&] { editor.drag({-10, 0}); }), HasSubstr("a line needs a length"));
    EXPECT_EQ(editor.at({0, 1, 1}).x, 8);
    editor.end_drag();
    EXPECT_EQ(editor.steps(), 1u);
}

TEST(FeatureEditor, LinesAreAddedAndTakenAway) {
    FeatureEditor editor(Features(2));
    editor.add_line({{{0, 0}, {5, 5}}, {{1, 0}, {6, 5}}});
    EXPECT_EQ(editor.selected().size(), 4u);
    EXPECT_THAT(refusal([&] { editor.add_line({{{0, 0}, {0, 0}}, {{1, 0}, {6, 5}}}); }), HasSubstr("length"));
    EXPECT_EQ(editor.features().size(), 1u);
    editor.add_line({{{7, 0}, {5, 5}}, {{1, 0}, {6, 5}}});
    editor.select_none();
    EXPECT_FALSE(editor.remove_selected());
    editor.select_in(0, {-1, -1, 1, 1}, Selecting::only);
    EXPECT_TRUE(editor.remove_selected());
    EXPECT_EQ(editor.features().size(), 1u);
    EXPECT_EQ(editor.features().line(0, 0).p.x, 7);
    EXPECT_TRUE(editor.undo());
    EXPECT_EQ(editor.features().size(), 2u);
    EXPECT_EQ(editor.selected().size(), 1u);
}

TEST(FeatureEditor, ShapesInAnotherOrderTakeWhatWasGivenAlong) {
    const Features turned = corner().features().in_order({1, 0});
    EXPECT_EQ(turned.given()[1].points[0][0].x, 12);
    EXPECT_EQ(turned.given()[1].points[1][0].x, 10);
    EXPECT_EQ(turned.line(1, 0).p.x, 12);
}

TEST(FeatureEditor, KeepsTheLastStepsThatItPromises) {
    FeatureEditor editor((Features(2)));
    editor.add_line({{{0, 0}, {10, 0}}, {{0, 0}, {10, 0}}});
    for (std::size_t i = 0; i < kMostUndoSteps + 5; ++i) {
        editor.drag({1, 0});
        editor.end_drag();
    }
    EXPECT_EQ(editor.steps(), kMostUndoSteps);
    for (std::size_t i = 0; i < kMostUndoSteps; ++i) ASSERT_TRUE(editor.undo());
    EXPECT_FALSE(editor.undo());
    EXPECT_EQ(editor.features().line(0, 0).p.x, 5);
}

}  // namespace
}  // namespace anamorph::test_feature_editor
