// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/files/frame_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "figure_cases.h"

namespace anamorph::test_frame_file {
using namespace figure;
namespace {

using namespace figure_cases;
using testing::HasSubstr;

const std::string kFrame =
    "3 7 5000 4000 -30 1800 0 300 \n"
    "100 400 205 -17 0 53 0 2700 900 255 128  64 a 1\n"
    "100 400 200 0 800 0 0 0 0  -1  12  -7 b bricks.ppm\n"
    "50 0 50 0 0 0 0 0 0   1   2   3 c 3\n"
    "-1 1\n"
    "  0   1 0 400 -5  j\n";

TEST(FrameFile, ReadsAndWritesTheSameText) {
    const std::vector<FigureFrame> frames = parse_frames(kFrame + "0 8 5000 4000 -30 1800 0 300 \n", "own.3");
    ASSERT_EQ(frames.size(), 1u);
    const FigureFrame& frame = frames[0];
    EXPECT_EQ(frame.number, 7);
    EXPECT_EQ(frame.place, glm::dvec3(500, 400, -3));
    expect_near(frame.observe, {30, 0, 0}, 1e-9);  // the triple 180 0 30 is a turn about x
    EXPECT_EQ(frame.bodies[0].shape.axes, glm::dvec3(10, 40, 20.5));
    EXPECT_EQ(frame.bodies[0].shape.center, glm::dvec3(-1.7, 0, 5.3));
    // 0 270 90: a quarter turn about z, which takes y to -x.
    expect_near(frame.bodies[0].shape.rotation[1], {-1, 0, 0}, 1e-12);
    EXPECT_EQ(frame.bodies[1].texture, "bricks.ppm");
    EXPECT_EQ(frame.bodies[1].texture_offset, glm::dvec2(12, -7));
    EXPECT_EQ(frame.bodies[2].color, glm::dvec3(1, 2, 3));
    EXPECT_EQ(frame.joints[0].position, glm::dvec3(0, 40, -0.5));
    // What a joint connects is one figure.
    EXPECT_THAT(frame.figures, testing::ElementsAre("a", "c"));
    EXPECT_EQ(frame.bodies[1].figure, 0);
    EXPECT_EQ(frame.bodies[2].figure, 1);
    EXPECT_EQ(frame_text(frame), kFrame);
    EXPECT_EQ(frames_end_text(frame), "0 8 5000 4000 -30 1800 0 300 \n");
}

TEST(FrameFile, RoundsToTheNearest) {
    FigureFrame frame;
    frame.bodies.resize(1);
    frame.bodies[0].name.assign(1, 'e');
    frame.bodies[0].shape = {{0.04, -0.06, 12.349}, {1.26, 1.24, 0}, glm::dmat3(1.0)};
    frame.bodies[0].color = {0.4, 254.6, -3};
    EXPECT_THAT(frame_text(frame), HasSubstr("\n13 12 0 0 -1 123 0 0 0   0 255  -3 e 1\n"));
}

// Turns by angles that are printed to a tenth of a degree: never off by more than the rounding of three
// angles.
TEST(FrameFile, TurnsComeBack) {
    constexpr unsigned kSeed = 86;
    SCOPED_TRACE("seed " + std::to_string(kSeed));
    std::mt19937 random(kSeed);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 2000; ++i) {
        FigureFrame frame;
        frame.bodies.resize(1);
        frame.bodies[0].name.assign(1, 'e');
        frame.bodies[0].shape.rotation = glm::mat3_cast(glm::normalize(
            glm::dquat(normal(random), normal(random), normal(random), i % 2 ? 0 : normal(random))));
        const FigureFrame back = parse_frames(frame_text(frame), "own.3").at(0);
        EXPECT_LE(turn_between(back.bodies[0].shape.rotation, frame.bodies[0].shape.rotation), 0.2);
    }
}

// The formula of the originals, R = c I + (1 - c) u u^T - s [u]x, written out.
TEST(Rotation, AnglesAreOfAnAxisAndATurn) {
    const glm::dvec3 angles(25, -40, 70);
    const double a1 = 25 * kRadiansPerDegree, a2 = -40 * kRadiansPerDegree,
                 c = std::cos(70 * kRadiansPerDegree), s = std::sin(70 * kRadiansPerDegree);
    const double u[3] = {std::cos(a1) * std::cos(a2), std::sin(a1) * std::cos(a2), std::sin(a2)};
    const double cross[3][3] = {{0, -u[2], u[1]}, {u[2], 0, -u[0]}, {-u[1], u[0], 0}};
    const glm::dmat3 r = glm::mat3_cast(turn_of_angles(angles));
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(r[k][i], (i == k ? c : 0) + (1 - c) * u[i] * u[k] - s * cross[i][k], 1e-14);
    expect_near(angles_of_rotation(r), {25, 360 - 40, 70}, 1e-9);
    expect_near(angles_of_rotation(glm::dmat3(1.0)), {0, 0, 0}, 0);
    // Half a turn, and nearly none.
    EXPECT_NEAR(turn_between(glm::mat3_cast(turn_of_angles({30, 20, 180})), glm::dmat3(1.0)), 180, 1e-9);
    EXPECT_NEAR(angles_of_turn(turn_of_angles({30, 20, 1e-7})).z, 1e-7, 1e-15);
}

TEST(Rotation, AnglesAboutXYZ) {
    for (const glm::dvec3 angles : {glm::dvec3(20, 30, 40), glm::dvec3(-170, 89, 120), glm::dvec3(0, -60, -5),
                                    glm::dvec3(33, 90, 0), glm::dvec3(-33, -90, 0)})
        expect_near(xyz_of_rotation(glm::mat3_cast(turn_xyz(angles))), angles, 1e-6);
}

// --- What is wrong

TEST(FrameFile, NamesTheLine) {
    const auto error = [](const std::string& text) { return error_of([&] { parse_frames(text, "own.3"); }); };
    const auto with = [](std::string text, const std::string& from, const std::string& to) {
        return text.replace(text.find(from), from.size(), to);
    };
    EXPECT_EQ(error("3 x"), "own.3:1: found \"x\", expected a frame, an integer");
    EXPECT_EQ(error("3 1 0 0 0 0 0 0"), "own.3:1: the text ends inside of a frame");
    EXPECT_EQ(error(with(kFrame, "0 800 0", "0 8e2 0")),
              "own.3:3: found \"8e2\", expected a coordinate, an integer");
    EXPECT_EQ(error(with(kFrame, " c 3", "")), "own.3:4: found the end of the line, expected a name");
    EXPECT_EQ(error(with(kFrame, "50 0 50", "50 -1 50")), "own.3:4: an axis is negative");
    EXPECT_EQ(error(with(kFrame, "-1 1", "-2 1")), "own.3:5: expected -1 and a count of joints");
    EXPECT_EQ(error(with(kFrame, "-1 1", "-1 9")), "own.3:6: the text ends inside of a frame");
    EXPECT_EQ(error(with(kFrame, "  0   1", "  0   3")), "own.3:6: an ellipsoid must be from 0 to 2");
    EXPECT_EQ(error("2000000000 1 0 0 0 0 0 0"), "own.3:1: the text ends inside of a frame");
    EXPECT_EQ(error("99999999999 1 0 0 0 0 0 0"),
              "own.3:1: found \"99999999999\", expected a count of ellipsoids, an integer");
}

TEST(FrameFile, TruncatedAtEveryByte) {
    const std::string whole = kFrame + kFrame;
    for (std::size_t size = 0; size <= whole.size(); ++size) {
        const std::string what = error_of([&] { parse_frames(whole.substr(0, size), "own.3"); });
        if (what == "no error") continue;
        EXPECT_THAT(what, testing::StartsWith("own.3:")) << size;
    }
    EXPECT_EQ(parse_frames(whole, "own.3").size(), 2u);
    EXPECT_TRUE(parse_frames("", "own.3").empty());
    EXPECT_TRUE(parse_frames("\n \n", "own.3").empty());
}

TEST(FrameFile, NumbersThatDoNotFit) {
    FigureFrame frame;
    frame.bodies.resize(1);
    for (const double v : std::initializer_list<double>{NAN, INFINITY, 1e12}) {
        frame.bodies[0].shape.center.x = v;
        EXPECT_THAT(error_of([&] { frame_text(frame); }), HasSubstr("does not fit"));
    }
}

}  // namespace
}  // namespace anamorph::test_frame_file
