// SPDX-License-Identifier: Apache-2.0
// Lists of deformations as text: what is read and written, and that every fault is one line that names the
// file and the entry.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "anamorph/deform/deformation_file.h"
#include "anamorph/error.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::test_deform_file {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kJson = R"({"deformations": [
    {"vector": [0, 0.1, -2], "center": [0.25, 1e-3], "extent": [0.5, 4]},
    {"vector": [1, 2, 3], "center": [0, 0], "extent": [1, 1], "kernel": "wendland_c2", "enabled": false}]})";

std::string fault_of(const std::string& text, const std::string& name) {
    try {
        parse_deformations_file(text, name);
    } catch (const Error& error) {
        return error.what();
    }
    return "no fault";
}

TEST(DeformationFile, ReadsBothForms) {
    const std::vector<Deformation> json = parse_deformations_file(kJson, "face.json");
    ASSERT_EQ(json.size(), 2u);
    EXPECT_EQ(json[0].vector, glm::dvec3(0, .1, -2));
    EXPECT_EQ(json[0].center, glm::dvec2(.25, .001));
    EXPECT_EQ(json[0].extent, glm::dvec2(.5, 4));
    EXPECT_EQ(json[0].kernel, DeformationKernel::gaussian);
    EXPECT_TRUE(json[0].enabled);
    EXPECT_EQ(json[1].kernel, DeformationKernel::wendland_c2);
    EXPECT_FALSE(json[1].enabled);
    const std::string csv =
        "\xef\xbb\xbf"
        "center_u,center_v,extent_u,extent_v,x,y,z\r\n\r\n# brow\r\n0.25, 1e-3,.5,+4,0,0.1,-2\r\n"
        "0,0,1,1,1,2,3,wendland_c2,0";
    EXPECT_EQ(parse_deformations_file(csv, "FACE.CSV"), json);
    EXPECT_TRUE(parse_deformations_csv("", "none.csv").empty());
    EXPECT_TRUE(parse_deformations_json(R"({"deformations": []})", "none.json").empty());
}

TEST(DeformationFile, WhatIsWrittenReadsBackToTheBit) {
    const unsigned seed = 9;
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const auto number = [&] {
        return std::ldexp(std::uniform_real_distribution<double>(-1, 1)(random),
                          static_cast<int>(random() % 200) - 100);
    };
    std::vector<Deformation> list(300);
    for (Deformation& d : list) {
        d.vector = {number(), number(), -0.0};
        d.center = {number(), number()};
        d.extent = {std::fabs(number()), std::fabs(number())};
        d.kernel = random() % 2 ? DeformationKernel::gaussian : DeformationKernel::wendland_c2;
        d.enabled = random() % 3 != 0;
        if (random() % 2) d.center_w = number();
        if (random() % 2) d.extent_w = std::fabs(number());
        d.side = static_cast<DeformationSide>(random() % 3);
    }
    const auto json = parse_deformations_json(deformations_json(list), "a.json");
    const auto csv = parse_deformations_csv(deformations_csv(list), "a.csv");
    EXPECT_EQ(json, list);
    EXPECT_EQ(csv, list);
    EXPECT_TRUE(std::signbit(json[0].vector.z));
    EXPECT_TRUE(std::signbit(csv[0].vector.z));
    EXPECT_EQ(parse_deformations_json(deformations_json({}), "a.json"), std::vector<Deformation>());
}

TEST(DeformationFile, DepthsAndSides) {
    const std::string json = R"({"deformations": [
        {"vector": [0, 0, 1], "center": [1, 2, 3], "extent": [4, 5, 6], "side": "front"},
        {"vector": [0, 0, 1], "center": [1, 2], "extent": [4, 5, 0], "side": "both"},
        {"vector": [0, 0, 1], "center": [1, 2], "extent": [4, 5], "side": "back"}]})";
    const std::vector<Deformation> list = parse_deformations_json(json, "a.json");
    ASSERT_EQ(list.size(), 3u);
    EXPECT_EQ(list[0].center_w, 3);
    EXPECT_EQ(list[0].extent_w, 6);
    EXPECT_EQ(list[0].side, DeformationSide::front);
    EXPECT_TRUE(list[1].is_plain());
    EXPECT_FALSE(list[2].has_depth());
    EXPECT_EQ(list[2].side, DeformationSide::back);
    const std::string csv =
        "1,2,4,5,0,0,1,gaussian,1,3,6,front\n1,2,4,5,0,0,1\n1,2,4,5,0,0,1,gaussian,1,0,0,back\n";
    EXPECT_EQ(parse_deformations_csv(csv, "a.csv"), list);
    // Lists without either are written as they were.
    EXPECT_EQ(deformations_csv({list[1]}),
              "center_u,center_v,extent_u,extent_v,x,y,z,kernel,enabled\n1,2,4,5,0,0,1,gaussian,1\n");
    EXPECT_EQ(deformations_json({list[1]}).find("side"), std::string::npos);
}

TEST(DeformationFile, FaultsNameFileAndEntry) {
    const auto expect = [](const std::string& text, const std::string& name, const std::string& entry,
                           const std::string& what) {
        EXPECT_THAT(fault_of(text, name),
                    AllOf(HasSubstr(name), HasSubstr(entry), HasSubstr(what), Not(HasSubstr("\n"))));
    };
    const auto with = [](const std::string& from, const std::string& to) {
        std::string text = kJson;
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return text.replace(at, from.size(), to);
    };
    const auto json = [&](const std::string& text, const std::string& entry, const std::string& what) {
        expect(text, "face.json", entry, what);
    };
    json("", "", "no JSON");
    json(kJson.substr(0, 90), "", "no JSON");
    json(with("0.25", "NaN"), "", "no JSON");
    json(with("0.25", "1e999"), "", "no JSON");
    json(std::string(100000, '['), "", "brackets");
    json("[]", "", "deformations");
    json(R"({"deformations": 3})", "", "a list");
    json(R"({"deformations": [], "x": 1})", "", "nothing but");
    json(R"({"deformations": [7]})", "deformations[0]", "an object");
    json(with("\"extent\": [1, 1]", "\"extent\": [1]"), "deformations[1]", "extent: must be a list of 2");
    json(with("\"extent\": [1, 1]", "\"extent\": [1, \"a\"]"), "deformations[1]", "extent: must be a list");
    json(with("\"extent\": [1, 1], ", ""), "deformations[1]", "extent: must be a list");
    json(with("\"extent\": [0.5, 4]", "\"extent\": [0, 4]"), "deformations[0]", "extent=0: must be");
    json(with("wendland_c2", "wend\\nland"), "deformations[1]", "kernel=");
    json(with("\"wendland_c2\"", "2"), "deformations[1]", "kernel: must be");
    json(with("false", "0"), "deformations[1]", "enabled: must be true or false");
    json(with("\"enabled\"", "\"on\""), "deformations[1]", "on: must be one of");
    json(with("\"enabled\": false", "\"side\": 1"), "deformations[1]", "side: must be a name in quotes");
    json(with("\"enabled\": false", "\"side\": \"left\""), "deformations[1]",
         "side=left: must be both, front or back");
    json(with("\"extent\": [1, 1]", "\"extent\": [1, 1, -2]"), "deformations[1]", "extent=-2: must be");
    json(with("\"extent\": [1, 1]", "\"extent\": [1, 1, 2, 3]"), "deformations[1]",
         "a list of 2 or 3 numbers");
    json(with("\"center\": [0, 0]", "\"center\": [0]"), "deformations[1]", "a list of 2 or 3 numbers");

    const auto csv = [&](const std::string& row, const std::string& what) {
        expect("# list\n" + row, "face.csv", "row 2", what);
    };
    csv("1,2,3,4,5,6", "not 6 fields");
    csv("1,2,3,4,5,6,7,gaussian,1,2", "not 10 fields");
    csv("1,2,3,4,5,6,x", "not \"x\"");
    csv("1,2,3,4,5,6,", "not \"\"");
    csv("1,2,3,4,5,6,1e999", "must be a number");
    csv("nan,2,3,4,5,6,7", "center=nan");
    csv("1,2,inf,4,5,6,7", "extent=inf");
    csv("1,2,3,4,5,-inf,7", "vector=-inf");
    csv("1,2,3,-4,5,6,7", "extent=-4");
    csv("1,2,3,4,5,6,7,round", "kernel=round");
    csv("1,2,3,4,5,6,7,gaussian,yes", "enabled=yes");
    csv("1,2,3,4,5,6,7,gaussian,1,0,-1", "extent=-1");
    csv("1,2,3,4,5,6,7,gaussian,1,inf,1", "center=inf");
    csv("1,2,3,4,5,6,7,gaussian,1,0,1,2", "side=2");
    expect(std::string(text_file::kMostBytes + 1, ' '), "long.csv", "", "64 MB");
    std::string many;
    for (std::size_t i = 0; i <= kMaxDeformations; ++i) many += "1,1,1,1,1,1,1\n";
    expect(many, "many.csv", "row 1048577", "at most 1048576 deformations");
}

}  // namespace
}  // namespace anamorph::test_deform_file
