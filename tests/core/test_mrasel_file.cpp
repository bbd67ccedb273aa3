// SPDX-License-Identifier: Apache-2.0
// MRASEL's frames: the example of the essay's appendix.
#include "anamorph/figure/files/mrasel_file.h"

#include <gmock/gmock.h>

#include <cmath>

#include "anamorph/error.h"
#include "anamorph/figure/files/motion_file.h"

namespace anamorph::test_mrasel_file {
using namespace figure;
namespace {

using testing::HasSubstr;

const std::string kExample =
    "3 -1 2\n255 0 0 90\n511 0 50 150\n250 250 250 3500 6050 0 0 0 0 face\n"
    "125 375 375 4575 4553 107 1800 0 230 bars\n250 50 125 3875 2050 -200 0 0 0 stripes\n";

TEST(MraselFile, TheExampleOfTheAppendix) {
    const auto motion = read_motion(kExample, "in.mrasel");
    EXPECT_EQ(motion->frame_count(), 1);
    EXPECT_THAT(motion->images(), testing::ElementsAre("face", "bars", "stripes"));
    const FigureFrame frame = motion->frame(1);
    ASSERT_EQ(frame.bodies.size(), 3u);
    ASSERT_EQ(frame.bands.size(), 2u);
    EXPECT_EQ(frame.bands[0].end, 0.5);
    EXPECT_EQ(frame.bands[0].color, glm::dvec3(0, 0, 90));
    EXPECT_EQ(frame.bands[1].end, 1);
    EXPECT_EQ(frame.bands[1].color, glm::dvec3(0, 50, 150));
    // In pixels of a screen of 512.
    const Ellipsoid& bars = frame.bodies[1].shape;
    EXPECT_LT(glm::distance(bars.axes * .512, glm::dvec3(125, 375, 375)), 1e-9);
    EXPECT_LT(glm::distance(bars.center * .512, glm::dvec3(457.5, 455.3, 10.7)), 1e-9);
    // The same turn as in the frames of the other programs, which say it alike.
    const FigureFrame same =
        read_motion("1 1 0 0 0 0 0 0\n10 20 30 0 0 0 1800 0 230 1 2 3 a 1\n-1 0\n0 2 0 0 0 0 0 0\n", "a.3")
            ->frame(1);
    for (int k = 0; k < 3; ++k)
        EXPECT_LT(glm::distance(bars.rotation[k], same.bodies[0].shape.rotation[k]), 1e-12);
    EXPECT_EQ(frame.bodies[2].texture, "stripes");
}

TEST(MraselFile, SaysWhatIsWrong) {
    const auto error = [](std::string text, const std::string& what = {}, const std::string& instead = {}) {
        if (!what.empty()) text.replace(text.find(what), what.size(), instead);
        try {
            mrasel_frame(text, "in.mrasel");
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string("no error");
    };
    EXPECT_EQ(error(kExample), "no error");
    EXPECT_EQ(error("0 0 0"), "no error");
    EXPECT_EQ(error(kExample + " \n"), "no error");
    EXPECT_EQ(error(kExample + "\nstop"),
              "in.mrasel: line 8: found \"stop\" behind the last of 3 ellipsoids");
    EXPECT_THAT(error(kExample, "3 -1", "2 -1"), HasSubstr("line 6: found \"250\" behind the last of 2"));
    EXPECT_EQ(error(""), "in.mrasel: line 1: the text ends, expected the number of ellipsoids");
    EXPECT_EQ(error(kExample, "511", "512"),
              "in.mrasel: line 3: found \"512\", expected a band's last row, a number from 255 to 511");
    EXPECT_THAT(error(kExample, "511", "254"), HasSubstr("a number from 255 to 511"));
    EXPECT_THAT(error(kExample, "3 -1", "-3 -1"), HasSubstr("the number of ellipsoids"));
    EXPECT_THAT(error(kExample, "3 -1", "2.5 -1"), HasSubstr("an integer"));
    EXPECT_THAT(error(kExample, "3 -1", "1e9 -1"), HasSubstr("to 1e+05"));
    EXPECT_THAT(error(kExample, "3500", "nan"), HasSubstr("line 4: found \"nan\", expected a coordinate"));
    EXPECT_THAT(error(kExample, "125 375", "-125 375"), HasSubstr("half an axis"));
    EXPECT_THAT(error(kExample, "3 -1", "4 -1"), HasSubstr("the text ends"));
    EXPECT_THAT(error(kExample, " stripes", ""), HasSubstr("the name of a map"));
    for (std::size_t size = 0; size + 9 < kExample.size(); ++size)
        EXPECT_NE(error(kExample.substr(0, size)), "no error") << size;
}

}  // namespace
}  // namespace anamorph::test_mrasel_file
