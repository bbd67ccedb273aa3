// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "anamorph/error.h"
#include "anamorph/projector/tour_file.h"

namespace anamorph::test_tour_file {
namespace {

using testing::StartsWith;

const char* const kTour = R"({"panoramas": [
    {"file": "hall.exr", "options": "srcyaw=12", "yaw": 30, "fov": 80, "spots": [
        {"yaw": 175, "pitch": 10, "radius": 20, "target": "garden.exr", "view": {"yaw": -90, "fov": 60}},
        {"yaw": -170, "pitch": 10, "radius": 8, "target": "hall.exr"}]},
    {"file": "garden.exr"}]})";

TEST(Tour, ReadsPanoramasAndTheirSpots) {
    const Tour tour = parse_tour_json(kTour, "tour.json");
    ASSERT_EQ(tour.size(), 2u);
    EXPECT_EQ(tour[0].file, "hall.exr");
    EXPECT_EQ(tour[0].options, "srcyaw=12");
    EXPECT_EQ(tour[0].view.yaw, 30);
    EXPECT_FALSE(tour[0].view.pitch);
    ASSERT_EQ(tour[0].spots.size(), 2u);
    EXPECT_EQ(tour[0].spots[0].target, 1u);
    EXPECT_EQ(tour[0].spots[0].view.fov, 60);
    EXPECT_EQ(tour[0].spots[1].target, 0u);
    EXPECT_TRUE(tour[1].spots.empty());
}

TEST(Tour, SpotsAreDiscsOnTheSphere) {
    const Tour tour = parse_tour_json(kTour, "tour.json");
    EXPECT_EQ(tour[0].spot_at(175, 10), 0);
    EXPECT_EQ(tour[0].spot_at(175 + 360, 29.9), 0);
    EXPECT_EQ(tour[0].spot_at(175, 30.1), -1);
    EXPECT_EQ(tour[0].spot_at(-171, 12), 1) << "across the seam, in both: the nearer centre";
    EXPECT_EQ(tour[0].spot_at(0, 0), -1);
    EXPECT_EQ(tour[1].spot_at(0, 0), -1);
    // By the angle's cosine.
    const double d = std::numbers::pi / 180;
    EXPECT_NEAR(
        std::cos(angle_between(20, 35, -50, -10) * d),
        std::sin(35 * d) * std::sin(-10 * d) + std::cos(35 * d) * std::cos(-10 * d) * std::cos(70 * d),
        1e-14);
    EXPECT_NEAR(angle_between(10, 0, 10 + 1e-9, 0), 1e-9, 1e-15);
    EXPECT_NEAR(angle_between(0, 90, 77, 90), 0, 1e-12);
}

std::string error_of(const std::string& text) {
    try {
        static_cast<void>(parse_tour_json(text, "t.json"));
        return "";
    } catch (const Error& e) {
        return e.what();
    }
}

TEST(Tour, SaysWhatIsWrongInOneLine) {
    const auto with_spot = [](const std::string& spot) {
        return error_of(R"({"panoramas": [{"file": "a", "spots": [)" + spot + "]}]}");
    };
    EXPECT_THAT(error_of("{"), StartsWith("t.json: is no JSON: "));
    EXPECT_EQ(error_of("[]"), "t.json: must be an object with panoramas");
    EXPECT_EQ(error_of("{}"), "t.json: panoramas: must be a list of at least 1");
    EXPECT_EQ(error_of(R"({"panoramas": 3})"), "t.json: panoramas: must be a list of at most 4096");
    EXPECT_EQ(error_of(R"({"panoramas": [{}]})"), "t.json: panorama 1: file is missing: must be given");
    EXPECT_EQ(error_of(R"({"panoramas": [{"file": "a", "fov": 180}]})"),
              "t.json: panorama 1: fov: must be a number from 1 to 179");
    EXPECT_EQ(error_of(R"({"panoramas": [{"file": "a", "zoom": 1}]})"),
              "t.json: panorama 1: \"zoom\": must be one of file, fov, options, pitch, spots, yaw");
    EXPECT_EQ(error_of(R"({"panoramas": [{"file": "a"}, {"file": "a"}]})"),
              "t.json: panorama 2: file \"a\" is given twice: must be given once");
    EXPECT_EQ(with_spot(R"({"yaw": 0, "pitch": 91, "radius": 1, "target": "a"})"),
              "t.json: panorama 1: pitch: must be a number from -90 to 90");
    EXPECT_EQ(with_spot(R"({"yaw": 0, "pitch": 0, "radius": "1", "target": "a"})"),
              "t.json: panorama 1: radius: must be a number from 0 to 180");
    EXPECT_EQ(with_spot(R"({"yaw": 0, "pitch": 0, "radius": 1, "target": "b"})"),
              "t.json: panorama 1: target \"b\": must be the file of a panorama");
    EXPECT_EQ(with_spot(R"({"yaw": 0, "pitch": 0, "radius": 1, "target": "a", "view": 3})"),
              "t.json: panorama 1: must be an object with fov, pitch, yaw");
}

}  // namespace
}  // namespace anamorph::test_tour_file
