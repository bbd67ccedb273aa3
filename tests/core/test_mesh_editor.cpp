// SPDX-License-Identifier: Apache-2.0
// Editing a mesh: what is selected, what moves, what is cut, and that every step may be taken back; and the file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "anamorph/error.h"
#include "anamorph/image/source.h"
#include "anamorph/mesh/mesh_editor.h"
#include "anamorph/mesh/mesh_file.h"
#include "anamorph/mesh/mesh_warp.h"
#include "mesh_cases.h"

namespace anamorph::test_mesh_editor {
namespace {

using Place = MeshEditor::Place;
using testing::ElementsAre;
using testing::HasSubstr;

bool same(const ControlMesh& a, const ControlMesh& b) {
    return mesh_json(a) == mesh_json(b);
}
Point<double> position(const MeshEditor& editor, const Place& place) {
    for (const MeshEditor::ControlPoint& point : editor.points())
        if (point.place == place) return point.at;
    ADD_FAILURE() << "no point " << place.level << ": " << place.column << "," << place.row;
    return {NAN, NAN};
}
bool is_fixed(const MeshEditor& editor, const Place& place) {
    for (const MeshEditor::ControlPoint& point : editor.points())
        if (point.place == place) return point.is_fixed;
    ADD_FAILURE() << "no point " << place.level << ": " << place.column << "," << place.row;
    return false;
}
std::string refusal(const std::function<void()>& body) {
    try {
        body();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

const Size kSize{400, 300};

MeshEditor four_by_three() {
    return {test::identity_mesh(kSize, 4, 3), kSize, kSize};
}

TEST(MeshEditor, WritesWhatItReads) {
    constexpr unsigned kSeed = 3701;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    for (int i = 0; i < 40; ++i) {
        ControlMesh mesh = test::random_mesh(random, kSize, kSize, random.whole(1, 9), random.whole(1, 9),
                                             0.4, i % 2, i % 4);
        if (i % 3 == 0) mesh.direction = Direction::push;
        if (i % 5 == 0) mesh.units = Units::fractions;
        const std::string text = mesh_json(mesh);
        const auto read = std::get<ControlMesh>(parse_mesh_json(text, "m.json").shape);
        ASSERT_EQ(read.vertices.size(), mesh.vertices.size());
        EXPECT_EQ(std::memcmp(read.vertices.data(), mesh.vertices.data(), mesh.vertices.size() * 16), 0);
        EXPECT_EQ(read.x_lines, mesh.x_lines);
        EXPECT_EQ(read.y_lines, mesh.y_lines);
        EXPECT_EQ(read.units, mesh.units);
        EXPECT_EQ(read.direction, mesh.direction);
        ASSERT_EQ(read.levels.size(), mesh.levels.size());
        for (std::size_t k = 0; k < mesh.levels.size(); ++k) {
            const ControlMesh::Level &a = read.levels[k], &b = mesh.levels[k];
            ASSERT_EQ(a.cells.size(), b.cells.size());
            ASSERT_EQ(a.vertices.size(), b.vertices.size());
            for (std::size_t n = 0; n < b.cells.size(); ++n)
                EXPECT_TRUE(a.cells[n].column == b.cells[n].column && a.cells[n].row == b.cells[n].row);
            for (std::size_t n = 0; n < b.vertices.size(); ++n)
                EXPECT_TRUE(
                    a.vertices[n].column == b.vertices[n].column && a.vertices[n].row == b.vertices[n].row &&
                    a.vertices[n].at.x == b.vertices[n].at.x && a.vertices[n].at.y == b.vertices[n].at.y);
        }
    }
}

TEST(MeshEditor, RefusesToWriteWhatJsonLacks) {
    ControlMesh mesh = test::identity_mesh(kSize, 1, 1);
    mesh.vertices[2].x = NAN;
    EXPECT_THAT(refusal([&] { mesh_json(mesh); }), HasSubstr("nan: must be a finite number"));
    mesh.vertices[2].x = std::numeric_limits<double>::infinity();
    EXPECT_THAT(refusal([&] { mesh_json(mesh); }), HasSubstr("inf: must be a finite number"));
    const WarpMap map = mesh_from_stmap(std::vector<float>{0, 0, 1, 0, 0, 1, 1, 1}, 2, 2, "map");
    const auto& st = std::get<ControlMesh>(map.shape);
    EXPECT_THAT(refusal([&] { mesh_json(st); }), HasSubstr("ST-map"));
    EXPECT_THAT(refusal([&] { MeshEditor(st, {2, 2}, {2, 2}, "map"); }), HasSubstr("map is an ST-map"));
}

TEST(MeshEditor, SelectsOneMoreAndOther) {
    MeshEditor editor = four_by_three();
    EXPECT_EQ(editor.points().size(), 20u);
    const Place a{0, 1, 1}, b{0, 2, 1};
    EXPECT_EQ(editor.point_near({103, 98}, 6), a);
    EXPECT_FALSE(editor.point_near({103, 98}, 3));
    EXPECT_FALSE(editor.point_near({NAN, 98}, 1e9));
    editor.select(a, Selecting::only);
    editor.select(b, Selecting::more);
    editor.select(b, Selecting::more);
    EXPECT_THAT(editor.selected(), ElementsAre(a, b));
    editor.select(a, Selecting::other);
    EXPECT_THAT(editor.selected(), ElementsAre(b));
    editor.select_in({90, 90, 210, 110}, Selecting::other);
    EXPECT_THAT(editor.selected(), ElementsAre(a));
    editor.select_in({90, 90, 210, 110}, Selecting::more);
    EXPECT_THAT(editor.selected(), ElementsAre(a, b));
    editor.select({0, 9, 9}, Selecting::only);
    EXPECT_THAT(editor.selected(), ElementsAre(a, b));
    editor.select_in({0, 0, 1, 1}, Selecting::only);
    EXPECT_THAT(editor.selected(), ElementsAre(Place{0, 0, 0}));
    editor.select_none();
    EXPECT_TRUE(editor.selected().empty());
}

TEST(MeshEditor, DragsWhatIsSelectedAsOneStep) {
    MeshEditor editor = four_by_three();
    const ControlMesh first = editor.mesh();
    editor.drag({5, 5});
    EXPECT_FALSE(editor.is_dragging()) << "nothing is selected";
    editor.select({0, 1, 1}, Selecting::only);
    editor.select({0, 2, 1}, Selecting::more);
    editor.drag({3, 1});
    editor.drag({10, -4});
    EXPECT_TRUE(editor.is_dragging());
    EXPECT_EQ(editor.steps(), 0u);
    editor.end_drag();
    EXPECT_EQ(editor.steps(), 1u);
    EXPECT_EQ(editor.mesh().vertices[6].x, 110);
    EXPECT_EQ(editor.mesh().vertices[6].y, 96);
    EXPECT_EQ(editor.mesh().vertices[7].x, 210);
    EXPECT_EQ(editor.mesh().vertices[8].x, 300);
    EXPECT_EQ(position(editor, {0, 1, 1}).x, 110);
    const ControlMesh second = editor.mesh();
    editor.drag({1, 1});
    editor.end_drag(false);
    EXPECT_TRUE(same(editor.mesh(), second));
    EXPECT_EQ(editor.steps(), 1u);
    EXPECT_TRUE(editor.undo());
    EXPECT_TRUE(same(editor.mesh(), first));
    EXPECT_EQ(position(editor, {0, 1, 1}).x, 100);
    EXPECT_FALSE(editor.undo());
    EXPECT_TRUE(editor.redo());
    EXPECT_TRUE(same(editor.mesh(), second));
    EXPECT_FALSE(editor.redo());
    editor.undo();
    editor.drag({1, 0});
    editor.end_drag();
    EXPECT_FALSE(editor.redo()) << "another step was taken";
}

TEST(MeshEditor, KeepsItsUnits) {
    ControlMesh mesh = test::identity_mesh({1, 1}, 2, 2);
    mesh.units = Units::fractions;
    MeshEditor editor(mesh, {400, 300}, {800, 200});
    EXPECT_EQ(position(editor, {0, 1, 1}).x, 400);
    editor.select({0, 1, 1}, Selecting::only);
    editor.drag({80, 50});
    editor.end_drag();
    EXPECT_DOUBLE_EQ(editor.mesh().vertices[4].x, 0.6);
    EXPECT_DOUBLE_EQ(editor.mesh().vertices[4].y, 0.75);
    ASSERT_TRUE(editor.cut_at({10, 10}));
    ASSERT_TRUE(editor.cut_at({790, 190}));
    editor.select({1, 1, 1}, Selecting::only);
    const Point<double> was = position(editor, {1, 1, 1});
    editor.drag({8, 2});
    EXPECT_NEAR(position(editor, {1, 1, 1}).x, was.x + 8, 1e-9);
    EXPECT_NEAR(position(editor, {1, 1, 1}).y, was.y + 2, 1e-9);
}

TEST(MeshEditor, RefusesWhatIsNoPlaceAndStaysAsItWas) {
    MeshEditor editor = four_by_three();
    const ControlMesh first = editor.mesh();
    editor.select({0, 1, 1}, Selecting::only);
    for (const double far : {1e9, -1e300, double(NAN), std::numeric_limits<double>::infinity()}) {
        EXPECT_THAT(refusal([&] { editor.drag({far, 0}); }), HasSubstr("vertex"));
        EXPECT_TRUE(same(editor.mesh(), first));
        EXPECT_FALSE(editor.is_dragging());
    }
    editor.drag({7, 0});
    EXPECT_NE(refusal([&] { editor.drag({0, 1e9}); }), "");
    EXPECT_EQ(editor.mesh().vertices[6].x, 107);
    editor.end_drag();
    EXPECT_TRUE(editor.undo());
    EXPECT_TRUE(same(editor.mesh(), first));
    EXPECT_FALSE(editor.cut_at({NAN, 3}));
    EXPECT_FALSE(editor.cut_at({-1, 3}));
}

TEST(MeshEditor, CutsTheCellThatShowsThere) {
    MeshEditor editor = four_by_three();
    ASSERT_TRUE(editor.cut_at({150, 150}));
    ASSERT_EQ(editor.mesh().levels.size(), 1u);
    EXPECT_EQ(editor.mesh().levels[0].cells[0].column, 1);
    EXPECT_EQ(editor.mesh().levels[0].cells[0].row, 1);
    EXPECT_EQ(editor.points().size(), 25u);
    // The middle is free, what lies on neighbours that are not cut is not.
    EXPECT_FALSE(is_fixed(editor, {1, 3, 3}));
    for (const Place& place : {Place{1, 3, 2}, {1, 2, 3}, {1, 4, 3}, {1, 3, 4}}) {
        EXPECT_TRUE(is_fixed(editor, place));
        editor.select(place, Selecting::more);
    }
    EXPECT_TRUE(editor.selected().empty());
    // Once the neighbour is cut, what lies between both is free.
    ASSERT_TRUE(editor.cut_at({250, 150}));
    EXPECT_FALSE(is_fixed(editor, {1, 4, 3}));
    editor.select({1, 4, 3}, Selecting::only);
    editor.drag({-9, 6});
    editor.end_drag();
    EXPECT_EQ(position(editor, {1, 4, 3}).x, 191);
    EXPECT_EQ(editor.map().at(200, 150).y, 156);
    // It is free no more where the cut is taken back.
    EXPECT_TRUE(editor.undo() && editor.undo());
    EXPECT_TRUE(editor.selected().empty());
    EXPECT_EQ(editor.points().size(), 25u);
}

TEST(MeshEditor, CutsTheFinestCellsAgainAndTheirNeighboursToo) {
    MeshEditor editor = four_by_three();
    for (int i = 0; i < ControlMesh::kMaxLevels; ++i) ASSERT_TRUE(editor.cut_at({100.0001, 100.0001})) << i;
    const ControlMesh mesh = editor.mesh();
    EXPECT_THAT(refusal([&] { editor.cut_at({100.0001, 100.0001}); }), HasSubstr("levels"));
    EXPECT_TRUE(same(editor.mesh(), mesh));
    // The neighbours were cut so that none is more than a level off.
    EXPECT_EQ(editor.map().leaf_at(99.9999, 99.9999).level, ControlMesh::kMaxLevels - 2);
    EXPECT_EQ(editor.map().leaf_at(100.0001, 99.9999).level, ControlMesh::kMaxLevels - 1);
}

TEST(MeshEditor, CutsWhereTheMeshWasDraggedTo) {
    MeshEditor editor = four_by_three();
    editor.select({0, 1, 1}, Selecting::only);
    editor.drag({60, 0});
    ASSERT_TRUE(editor.cut_at({130, 90}));
    EXPECT_EQ(editor.mesh().levels[0].cells[0].column, 0);
    EXPECT_FALSE(editor.is_dragging());
    EXPECT_EQ(editor.steps(), 2u);
}

TEST(MeshEditor, DragsThePositionThatCounts) {
    // The vertex in the middle is given for level 1 too, where all around it is cut: that is what the map reads.
    ControlMesh mesh = test::identity_mesh(kSize, 2, 2);
    mesh.levels.push_back({{{0, 0}, {1, 0}, {0, 1}, {1, 1}}, {{2, 2, {190, 140}}}});
    MeshEditor editor(mesh, kSize, kSize);
    EXPECT_EQ(position(editor, {0, 1, 1}).x, 190);
    editor.select({0, 1, 1}, Selecting::only);
    editor.drag({5, 5});
    EXPECT_EQ(position(editor, {0, 1, 1}).x, 195);
    EXPECT_EQ(position(editor, {0, 1, 1}).y, 145);
    EXPECT_EQ(editor.mesh().vertices[4].x, 200);
}

TEST(MeshEditor, HasNoPointsOnLinesThatItAdds) {
    ControlMesh mesh = test::identity_mesh(kSize, 2, 2);
    mesh.x_lines = {50, 200, 350};
    mesh.y_lines = {0, 150, 300};
    for (int i = 0; i < 9; ++i)
        mesh.vertices[static_cast<std::size_t>(i)].x = mesh.x_lines[static_cast<std::size_t>(i % 3)];
    MeshEditor editor(mesh, kSize, kSize);
    EXPECT_EQ(editor.points().size(), 9u);
    EXPECT_EQ(position(editor, {0, 0, 0}).x, 50);
    EXPECT_FALSE(editor.cut_at({20, 20})) << "beyond the mesh's lines";
    ASSERT_TRUE(editor.cut_at({60, 20}));
    EXPECT_EQ(editor.mesh().levels[0].cells[0].column, 0);
    EXPECT_FALSE(is_fixed(editor, {1, 1, 1}));
    EXPECT_NEAR(position(editor, {1, 1, 1}).x, 125, 1e-9);
    editor.select({1, 1, 1}, Selecting::only);
    editor.drag({4, 0});
    EXPECT_NEAR(position(editor, {1, 1, 1}).x, 129, 1e-9);
}

TEST(MeshEditor, EdgesFollowTheMap) {
    constexpr unsigned kSeed = 3702;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    MeshEditor editor(test::random_mesh(random, kSize, kSize, 4, 3, 0.3, false, 0), kSize, kSize);
    const auto edges = editor.edges();
    ASSERT_EQ(edges.size(), 4u * 4 + 5u * 3);
    // The second line is the right side of the first cell, downwards.
    for (int i = 0; i <= MeshEditor::kEdgeSteps; ++i) {
        const Point<double> at = editor.map().at(100, 100.0 * i / MeshEditor::kEdgeSteps),
                            drawn = edges[1][static_cast<std::size_t>(i)];
        EXPECT_NEAR(drawn.x, at.x, 1e-10);
        EXPECT_NEAR(drawn.y, at.y, 1e-10);
    }
}

/// Pixels of noise.
struct Noise {
    std::vector<unsigned char> pixels;
    ConstImageView view;
    explicit Noise(test::Random& random, const Size& size)
        : pixels(static_cast<std::size_t>(size.width * size.height * 3)) {
        for (unsigned char& p : pixels) p = static_cast<unsigned char>(random.whole(0, 255));
        view = packed_view(reinterpret_cast<const std::byte*>(pixels.data()), PixelType::uint8, size.width,
                           size.height, 3);
    }
};

TEST(MeshEditor, OutsideOfChangedPixelsAPictureHasTheSameBits) {
    constexpr unsigned kSeed = 3703;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    const Size size{397, 301};
    const Noise noise(random, size);
    const MemorySource source(noise.view);
    std::int64_t changed = 0, all = 0;
    for (int trial = 0; trial < 60; ++trial) {
        const int columns = random.whole(1, trial % 4 == 3 ? 90 : 14),
                  rows = random.whole(1, trial % 4 == 3 ? 90 : 14);
        const bool uneven = trial % 2, cut = trial % 5 == 0;
        MeshEditor editor(test::random_mesh(random, size, size, columns, rows, 0.3, uneven, cut ? 2 : 0),
                          size, size);
        MeshWarpOptions options;
        options.tol = trial % 3 == 0 ? 0 : trial % 3 == 1 ? 0.01 : 0.2;
        const auto drawn = [&] {
            const Picture picture = warped_picture({"mesh", editor.mesh()}, size, size, options);
            std::vector<unsigned char> pixels(static_cast<std::size_t>(size.width * size.height * 3));
            EXPECT_TRUE(picture.draw(&source, {0, 0, size.width, size.height},
                                     packed_view(reinterpret_cast<std::byte*>(pixels.data()),
                                                 PixelType::uint8, size.width, size.height, 3)));
            return pixels;
        };
        const std::vector<unsigned char> before = drawn();
        const Mesh map = editor.map();
        EXPECT_TRUE(changed_pixels(map, map).empty());
        if (trial % 7 == 6) {
            editor.cut_at({random.between(0, 397), random.between(0, 301)});
        } else {
            for (int i = random.whole(1, 3); i > 0; --i) {
                const auto n = static_cast<std::size_t>(random.whole(0, int(editor.points().size()) - 1));
                editor.select(editor.points()[n].place, Selecting::more);
            }
            editor.drag({random.between(-9, 9), random.between(-9, 9)});
        }
        const std::vector<unsigned char> after = drawn();
        std::vector<char> may(static_cast<std::size_t>(size.width * size.height));
        for (const Box& box : changed_pixels(map, editor.map()))
            for (int y = box.y0; y < box.y1; ++y)
                for (int x = box.x0; x < box.x1; ++x)
                    may.at(static_cast<std::size_t>(y * size.width + x)) = 1;
        for (std::size_t i = 0; i < may.size(); ++i) {
            changed += may[i];
            if (!may[i]) {
                ASSERT_EQ(std::memcmp(&before[3 * i], &after[3 * i], 3), 0)
                    << "trial " << trial << ", pixel " << i;
            }
        }
        all += std::int64_t(may.size());
    }
    EXPECT_LT(double(changed), 0.7 * double(all)) << "little would be gained";
}

}  // namespace
}  // namespace anamorph::test_mesh_editor
