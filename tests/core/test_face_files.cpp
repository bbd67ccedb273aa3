// SPDX-License-Identifier: Apache-2.0
// The six files that a name with {face} stands for.
#include "anamorph/operation/face_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "anamorph/error.h"
#include "anamorph/operation/pano.h"

namespace anamorph::test_face_files {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

ParameterValues values(const std::vector<Assignment>& given = {}) {
    ParameterValues values(*pano_operation().parameters);
    values.assign(given);
    return values;
}
FaceFiles found(const std::string& name, const std::set<std::string>& files,
                const std::vector<Assignment>& given = {}) {
    return find_face_files("src", name, values(given),
                           [&](const std::string& n) { return files.count(n) > 0; });
}
std::string refused(const std::string& name, const std::set<std::string>& files,
                    const std::vector<Assignment>& given = {}) {
    try {
        found(name, files, given);
        return "";
    } catch (const Error& e) {
        return e.what();
    }
}

const std::set<std::string> kOpenGl = {"a_px", "a_nx", "a_py", "a_ny", "a_pz", "a_nz"},
                            kExr = {"+x", "-x", "+y", "-y", "+z", "-z"};

TEST(FaceFiles, StandInTheOrderOfTheirLayout) {
    const FaceFiles opengl = found("a_{face}", kOpenGl);
    EXPECT_EQ(opengl.layout, Projection::cubemap3x2);
    EXPECT_EQ(opengl.words, "px, nx, py, ny, pz, nz");
    EXPECT_THAT(opengl.names, ElementsAre("a_px", "a_nx", "a_py", "a_ny", "a_pz", "a_nz"));
    const FaceFiles exr = found("{face}", kExr);
    EXPECT_EQ(exr.layout, Projection::cubemap);
    EXPECT_THAT(exr.names, ElementsAre("+x", "-x", "+y", "-y", "+z", "-z"));
    // What is a direction stays one.
    const std::set<std::string> words = {"right", "left", "top", "bottom", "front", "back"};
    EXPECT_THAT(found("{face}", words).names, ElementsAre("right", "left", "top", "bottom", "front", "back"));
    EXPECT_THAT(found("{face}", words, {{"from", "cubemap"}}).names,
                ElementsAre("left", "right", "top", "bottom", "front", "back"));
    EXPECT_THAT(found("a_{face}", kOpenGl, {{"from", "cubemap"}}).names,
                ElementsAre("a_px", "a_nx", "a_py", "a_ny", "a_pz", "a_nz"));
    EXPECT_EQ(found("{face}", kExr, {{"from", "cubemap3x2"}}).layout, Projection::cubemap3x2);
}

TEST(FaceFiles, AreNamedBeforeArguments) {
    EXPECT_TRUE(has_face("a_{face}.png"));
    EXPECT_FALSE(has_face("a_face.png?x={face}"));
    EXPECT_FALSE(has_face("a_{face.png"));
    EXPECT_FALSE(has_face("a_{Face}.png"));
    EXPECT_FALSE(has_face(""));
    const std::set<std::string> files = {"0/0?n={face}", "1/1?n={face}", "2/2?n={face}",
                                         "3/3?n={face}", "4/4?n={face}", "5/5?n={face}"};
    EXPECT_EQ(found("{face}/{face}?n={face}", files).names[3], "3/3?n={face}");
}

TEST(FaceFiles, OneWayOfNamingIsComplete) {
    EXPECT_THAT(refused("a_{face}", {}), HasSubstr("src=a_{face}: there are no such files"));
    EXPECT_THAT(refused("a_{face}", {"a_px", "a_nx", "a_py", "a_pz", "a_nz", "a_0"}),
                HasSubstr("\"a_ny\" is not there: must be six files, with px, nx, py, ny, pz, nz in place"));
    std::set<std::string> both = kOpenGl;
    for (const char* name : {"a_right", "a_left", "a_up", "a_down", "a_front"}) both.insert(name);
    EXPECT_EQ(found("a_{face}", both).words, "px, nx, py, ny, pz, nz");
    both.insert("a_back");
    EXPECT_THAT(refused("a_{face}", both),
                HasSubstr("there are files for px, nx, py, ny, pz, nz and for right, left"));
    for (const char* from : {"cubecross", "eac", "octahedral", "latlong"})
        EXPECT_THAT(refused("a_{face}", kOpenGl, {{"from", from}}),
                    HasSubstr("must be cubemap or cubemap3x2"));
    // Every way is told, and there are no two of one.
    EXPECT_THAT(face_words(), HasSubstr("(0 1 2 3 4 5)"));
}

// Any name gives six files or an error of one line.
TEST(FaceFiles, OfRandomNames) {
    const unsigned seed = 20262;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const char* const parts[] = {"{face}", "{", "}", "face", "a", "/", ".", "?", "\n", "\xff", "px", "{face"};
    for (int i = 0; i < 5000; ++i) {
        std::string name;
        for (unsigned n = random() % 8; n > 0; --n) name += parts[random() % std::size(parts)];
        if (!has_face(name)) continue;
        const unsigned there = random();
        try {
            const FaceFiles files = find_face_files("src", name, values(), [&](const std::string& n) {
                return (std::hash<std::string>()(n) & there) % 4 != 3;
            });
            EXPECT_EQ(std::set<std::string>(files.names.begin(), files.names.end()).size(), 6u);
        } catch (const Error& e) {
            EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        }
    }
}

}  // namespace
}  // namespace anamorph::test_face_files
