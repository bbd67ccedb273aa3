// SPDX-License-Identifier: Apache-2.0
// Warps and morphs as shaders: what is handed to fragments, and what is proven of them. That pictures hold it is tested where there is
// OpenGL (tests/vtk/viewer).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "anamorph/error.h"
#include "anamorph/mesh/mesh_glsl.h"
#include "anamorph/morph/feature_glsl.h"

namespace anamorph::test_fragments {
namespace {

using testing::HasSubstr;
using testing::Not;

ControlMesh bent_mesh(int columns, int rows, double by = 0.05) {
    ControlMesh mesh;
    mesh.units = Units::fractions;
    mesh.columns = columns;
    mesh.rows = rows;
    for (int r = 0; r <= rows; ++r)
        for (int c = 0; c <= columns; ++c)
            mesh.vertices.push_back({double(c) / columns + by * ((c * 7 + r * 3) % 5 - 2) / columns,
                                     double(r) / rows + by * ((c * 3 + r * 5) % 7 - 3) / rows});
    return mesh;
}

TEST(MeshFragments, CellsHoldEveryPixelOnceAndTheirOwnPatch) {
    ControlMesh given = bent_mesh(5, 4);
    given.levels.push_back({{{1, 1}, {2, 1}}, {}});
    given.levels.push_back({{{3, 3}}, {}});
    const Mesh mesh(given, {203, 117}, {400, 300}, 1);
    std::vector<int> held(203 * 117);
    for (const CellFragments& cell : cell_fragments(mesh)) {
        const Box& box = cell.pixels;
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x) {
                ++held[static_cast<std::size_t>(y * 203 + x)];
                const MeshCell own = mesh.leaf_at(x + 0.5, y + 0.5);
                const double s = double{cell.parameters[0]} + (x - box.x0) * double{cell.parameters[2]},
                             t = double{cell.parameters[1]} + (y - box.y0) * double{cell.parameters[3]};
                ASSERT_NEAR(s, (x + 0.5 - own.x0) / (own.x1 - own.x0), 1e-6);
                ASSERT_NEAR(t, (y + 0.5 - own.y0) / (own.y1 - own.y0), 1e-6);
                const Patch patch = mesh.patch(own);
                for (std::size_t i = 0; i < 16; ++i) {
                    ASSERT_EQ(cell.patch[2 * i], static_cast<float>(patch.g[i / 4][i % 4].x));
                    ASSERT_EQ(cell.patch[2 * i + 1], static_cast<float>(patch.g[i / 4][i % 4].y));
                }
            }
    }
    EXPECT_EQ(std::count(held.begin(), held.end(), 1), 203 * 117);
}

TEST(MeshFragments, TooManyCellsAreRefused) {
    const Mesh fits(bent_mesh(128, 128), {512, 512}, {512, 512}, 1);
    EXPECT_EQ(cell_fragments(fits).size(), 16384u);
    const Mesh more(bent_mesh(129, 128), {512, 512}, {512, 512}, 1);
    try {
        cell_fragments(more);
        ADD_FAILURE();
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("a mesh of 16512 cells: must have at most 16384"));
    }
}

TEST(MeshFragments, TheBoundIsThatOfFloats) {
    // With u = 2^-24, source points up to 2048 are rounded by 2048 u; some 30 pixels of displacement, some 30 times.
    const double unit = 0x1p-24;
    const Mesh mesh(bent_mesh(12, 12, 0.1), {2048, 2048}, {2048, 2048}, 1);
    EXPECT_GT(mesh_glsl_bound(mesh), 2048 * unit);
    EXPECT_LT(mesh_glsl_bound(mesh), 10 * 2048 * unit);
    const Mesh small(bent_mesh(12, 12, 0.1), {128, 128}, {128, 128}, 1);
    EXPECT_NEAR(mesh_glsl_bound(mesh) / mesh_glsl_bound(small), 16, 1);
    const Mesh huge(bent_mesh(2, 2, 1), {100, 100}, {100, 100}, 1e6);
    EXPECT_GT(mesh_glsl_bound(huge), 1);
}

TEST(MeshFragments, TheTextIsOfTheFormula) {
    const std::string text = mesh_glsl("warped");
    EXPECT_THAT(text,
                HasSubstr("vec2 warped(vec4 g[8], vec4 parameters, vec2 first, vec2 scale, vec2 pixel) {"));
    // All 32 elements are read, and nothing else is constant than eq. 5.2's numbers.
    for (int k = 0; k < 8; ++k)
        for (const char* part : {".x", ".y", ".z", ".w"})
            EXPECT_THAT(text, HasSubstr("g[" + std::to_string(k) + "]" + part));
    for (const char* wrong : {"nan", "inf", "/"}) EXPECT_THAT(text, Not(HasSubstr(wrong)));
}

Features some_lines(std::size_t count) {
    Features features;
    for (std::size_t i = 0; i < count; ++i) {
        const double x = 10 + 13.0 * double(i % 17), y = 5 + 1.1 * double(i);
        features.add_line({{{x, y}, {x + 20, y + 3}}, {{x + 4, y - 2}, {x + 26, y + 4}}}, 1 + double(i % 3));
    }
    return features;
}
FeatureMap map_of(const Features& features, const LineWeights& weights, int side = 300) {
    return FeatureMap(features, {{side, side}, {side, side}}, {side, side}, {0.5, 0.5}, weights);
}

TEST(FeatureFragments, LinesAreHandedOverWhole) {
    const FeatureMap map = map_of(some_lines(64), {1, 2, 0.5});
    const auto vectors = line_uniforms(map, {0, 1});
    ASSERT_EQ(vectors.size(), 64u * kVectorsOfLine);
    EXPECT_EQ(vectors[5][0], static_cast<float>(map.line(1).p.x));
    EXPECT_EQ(vectors[6][1], static_cast<float>(map.line(1).factor));
    EXPECT_EQ(vectors[9][1], static_cast<float>(map.displacement(1, 1).beside_rate.y));
    EXPECT_NO_THROW(line_uniforms(map_of(some_lines(192), {}), {0, 1}));
    EXPECT_THROW(line_uniforms(map_of(some_lines(193), {}), {0, 1}), Error);
}

TEST(FeatureFragments, TextsDifferByTheExponentAlone) {
    EXPECT_EQ(own_exponent(2), 2);
    EXPECT_EQ(own_exponent(1.7), own_exponent(3));
    const std::string squares = feature_glsl("mixed", 3, own_exponent(2)),
                      any = feature_glsl("mixed", 3, own_exponent(1.7));
    EXPECT_THAT(squares, HasSubstr("vec4 mixed(vec2 at, vec2 weight, vec4 scale) {"));
    EXPECT_THAT(squares, HasSubstr("mixedLines[14]"));
    EXPECT_THAT(squares, Not(HasSubstr("mixedLines[15]")));
    EXPECT_THAT(squares, Not(HasSubstr("pow(")));
    EXPECT_THAT(any, HasSubstr("pow("));
    for (const char* wrong : {"nan", "inf"}) EXPECT_THAT(squares, Not(HasSubstr(wrong)));
}

TEST(FeatureFragments, TheBoundIsThatOfFloats) {
    const FeatureMap map = map_of(some_lines(64), {1, 2, 0.5});
    const double bound = feature_glsl_bound(map, {0, 1});
    // More than a place's own rounding, and less than a pixel; twice the picture, twice the bound.
    EXPECT_GT(bound, 300 * 0x1p-24);
    EXPECT_LT(bound, 0.5);
    EXPECT_GT(feature_glsl_bound(map_of(some_lines(64), {0, 2, 0.5}), {0, 1}), bound)
        << "nothing softens a line";
}

}  // namespace
}  // namespace anamorph::test_fragments
