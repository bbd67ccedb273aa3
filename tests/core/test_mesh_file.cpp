// SPDX-License-Identifier: Apache-2.0
// Warps from text: what is read, and that every fault is one line that names the file and the entry.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "anamorph/error.h"
#include "anamorph/mesh/mesh.h"
#include "anamorph/mesh/mesh_file.h"

namespace anamorph::test_mesh_file {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kMesh =
    R"({"direction": "push", "units": "fractions", "columns": 2, "rows": 1,
        "vertices": [[0, 0], [0.5, 0.1], [1, 0], [0, 1], [0.4, 0.9], [1, 1]],
        "x": [0, 0.25, 1], "levels": [{"cells": [[1, 0]], "vertices": [[3, 1, 0.7, 0.5]]}]})";

std::string fault_of(const std::string& text, const std::string& name = "grid.json") {
    try {
        parse_warp_file(text, name);
    } catch (const Error& error) {
        return error.what();
    }
    return "no fault";
}

std::string with(const std::string& from, const std::string& to) {
    std::string text = kMesh;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos);
    return text.replace(at, from.size(), to);
}

TEST(MeshFile, ReadsAMesh) {
    const WarpMap map = parse_mesh_json(kMesh, "grid.json");
    EXPECT_EQ(map.name, "grid.json");
    const auto& mesh = std::get<ControlMesh>(map.shape);
    EXPECT_EQ(mesh.direction, Direction::push);
    EXPECT_EQ(mesh.units, Units::fractions);
    EXPECT_EQ(mesh.columns, 2);
    EXPECT_EQ(mesh.rows, 1);
    ASSERT_EQ(mesh.vertices.size(), 6u);
    EXPECT_EQ(mesh.vertices[4].x, 0.4);
    EXPECT_EQ(mesh.vertices[4].y, 0.9);
    EXPECT_EQ(mesh.x_lines, (std::vector<double>{0, 0.25, 1}));
    EXPECT_TRUE(mesh.y_lines.empty());
    ASSERT_EQ(mesh.levels.size(), 1u);
    EXPECT_EQ(mesh.levels[0].cells[0].column, 1);
    EXPECT_EQ(mesh.levels[0].vertices[0].at.x, 0.7);
    const Mesh built(mesh, {100, 100}, {100, 100}, 1, map.name);
    EXPECT_NEAR(built.at(25, 0).x, 50, 1e-12);
}

TEST(MeshFile, ReadsPoints) {
    const auto json = std::get<ControlPoints>(
        parse_warp_file(R"({"units": "pixels", "points": [[1, 2, 3, 4], [5, 6, 7, 8.5]]})", "p.json").shape);
    ASSERT_EQ(json.pairs.size(), 2u);
    EXPECT_EQ(json.pairs[1].v, 8.5);
    const auto csv = std::get<ControlPoints>(
        parse_warp_file("x,y,u,v\r\n# a comment\r\n\r\n1,2,3,4\r\n 5, +6 ,7,8.5", "P.CSV").shape);
    ASSERT_EQ(csv.pairs.size(), 2u);
    EXPECT_EQ(csv.pairs[0].x, 1);
    EXPECT_EQ(csv.pairs[1].y, 6);
    EXPECT_EQ(csv.pairs[1].v, 8.5);
}

TEST(MeshFile, FaultsNameFileAndEntry) {
    const auto expect = [](const std::string& text, const std::string& entry,
                           const std::string& name = "grid.json") {
        EXPECT_THAT(fault_of(text, name), AllOf(HasSubstr(name), HasSubstr(entry), Not(HasSubstr("\n"))));
    };
    expect("", "is no JSON");
    expect(kMesh.substr(0, kMesh.size() / 2), "is no JSON");
    expect("[1, 2]", "an object");
    expect(with("[0.4, 0.9]", "[0.4]"), "vertices[4]=a list of 1: must be a list of 2 numbers");
    expect(with("[0.4, 0.9]", "[0.4, \"a\\nb\"]"), "vertices[4][1]=");
    expect(with("[0.4, 0.9]", "[0.4, null]"), "vertices[4][1]=null");
    expect(with("[0.4, 0.9]", "[0.4, NaN]"), "is no JSON");
    expect(with("[0.4, 0.9]", "[0.4, 1e999]"), "is no JSON");
    expect(with(", [1, 1]]", "]"), "vertices=a list of 5: must have (columns + 1) (rows + 1) = 6 entries");
    expect(with("\"columns\": 2", "\"columns\": 2.5"), "columns=2.5");
    expect(with("\"columns\": 2", "\"columns\": -1"), "columns=-1");
    expect(with("\"columns\": 2", "\"columns\": 1e9"), "columns=");
    expect(with("\"columns\": 2", "\"colums\": 2"), "\"colums\": no such key");
    expect(with("\"rows\": 1,", ""), "rows: is missing");
    expect(with("push", "pushed"), "direction=");
    expect(with("fractions", "inches"), "units=\"inches\": must be \"pixels\" or \"fractions\"");
    expect(with("[[1, 0]]", "[[1, 0, 2]]"), "levels[0].cells[0]");
    expect(with("[3, 1, 0.7, 0.5]", "[3, 1, 0.7]"), "levels[0].vertices[0]");
    expect(with("\"levels\": [{", "\"levels\": {"), "is no JSON");
    expect(std::string(100000, '['), "deep");
    expect(R"({"points": [[1, 2, 3]]})", "points[0]");
    expect(R"({"points": 3})", "points=3: must be a list");
    expect("1,2,3,4\n5,6,7\n", "row 2", "p.csv");
    expect("1,2,3,4\n5,6,x,8\n", "row 2: must be a number, not \"x\"", "p.csv");
    expect("1,2,3,4\n5,6,,8\n", "row 2", "p.csv");
    expect("1,2,3,4,5\n", "row 1", "p.csv");
    expect("1,2,3,\n", "row 1", "p.csv");
}

TEST(MeshFile, RefusesHugeText) {
    const std::string huge(std::size_t{100} << 20, ' ');
    EXPECT_THAT(fault_of(huge), AllOf(HasSubstr("grid.json"), HasSubstr("64 MB")));
    EXPECT_THAT(fault_of(huge, "p.csv"), AllOf(HasSubstr("p.csv"), HasSubstr("64 MB")));
}

TEST(MeshFile, TakesEveryNthPixelOfAnStMap) {
    // An ST-map of a linear map of a 20 x 12 picture; the mesh says the same everywhere.
    constexpr int kWidth = 20, kHeight = 12;
    std::vector<float> uv;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            uv.push_back(0.25f + 0.5f * (static_cast<float>(x) + 0.5f) / kWidth);
            uv.push_back(1 - (static_cast<float>(y) + 0.5f) / kHeight);
            uv.push_back(7);  // a third channel
        }
    for (const int step : {1, 3, 5, 19, 1000}) {
        const WarpMap map = mesh_from_stmap(uv.data(), kWidth, kHeight, 3, 3 * kWidth, step, "st.exr");
        const Mesh mesh(std::get<ControlMesh>(map.shape), {200, 120}, {400, 100}, 1);
        for (const auto& [x, y] : {std::pair{0.5, 0.5}, {77.0, 31.5}, {199.5, 119.5}}) {
            EXPECT_NEAR(mesh.at(x, y).x, (0.25 + 0.5 * x / 200) * 400, 1e-3) << step;
            EXPECT_NEAR(mesh.at(x, y).y, (1 - y / 120) * 100, 1e-3) << step;
        }
    }
    uv[3 * (2 * kWidth + 5) + 1] = std::nanf("");
    try {
        mesh_from_stmap(uv.data(), kWidth, kHeight, 3, 3 * kWidth, 1, "st.exr");
        FAIL();
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), AllOf(HasSubstr("st.exr: pixel [5, 2]"), HasSubstr("nan")));
    }
    EXPECT_THROW(mesh_from_stmap(uv.data(), kWidth, kHeight, 3, 3 * kWidth, 0, "st.exr"), Error);
    EXPECT_THROW(mesh_from_stmap(uv.data(), 1, kHeight, 3, 3, 1, "st.exr"), Error);
}

TEST(MeshFile, PixelsOfAnStMapThatAreNoNumbersAreHoles) {
    std::vector<float> uv(2 * 9 * 5, 0.25f);
    uv[7] = -3;
    uv[0] = NAN;
    uv[21] = INFINITY;
    uv[40] = -INFINITY;
    uv[41] = NAN;
    const WarpMap map = mesh_from_stmap(uv, 9, 5, "st.exr");
    const StSamples& samples = *std::get<ControlMesh>(map.shape).samples;
    EXPECT_EQ(samples.holes, 3);
    EXPECT_EQ(samples.most, 3);
    for (std::size_t i = 0; i < uv.size(); i += 2) {
        const bool hole = i == 0 || i == 20 || i == 40;
        EXPECT_EQ(std::isnan(samples.uv[i]), hole) << i;
        EXPECT_EQ(std::isnan(samples.uv[i + 1]), hole) << i;
    }
    try {
        mesh_from_stmap(std::vector<float>(2 * 9 * 5, NAN), 9, 5, "st.exr");
        FAIL();
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("st.exr has no pixel that comes from anywhere"));
    }
}

}  // namespace
}  // namespace anamorph::test_mesh_file
