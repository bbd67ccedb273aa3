// SPDX-License-Identifier: Apache-2.0
// The language: what is read, and what is said about what is not.
#include "anamorph/figure/script.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "anamorph/error.h"

namespace anamorph {
namespace {

using testing::HasSubstr;

const std::string kFigure =
    "figure f 2 a b\n"
    "ellipsoid a 10 40 20\n"
    "ellipsoid b 10 40 20\n"
    "joint j a 0 40 0 b 0 -40 0\n";

TEST(FigureScript, ReadsDeclarationsAndMovements) {
    const Program p = parse_program(kFigure + "linear 0 4 moveto f a 100 -2.5 +3 stop", "own.n");
    ASSERT_EQ(p.ellipsoids.size(), 3u);
    EXPECT_EQ(p.ellipsoids[2].name, "b");
    EXPECT_EQ(p.ellipsoids[2].axes, glm::dvec3(10, 40, 20));
    ASSERT_EQ(p.joints.size(), 1u);
    EXPECT_EQ(p.joints[0].second_offset, glm::dvec3(0, -40, 0));
    ASSERT_EQ(p.subroutines[0].movements.size(), 1u);
    const Movement& m = p.subroutines[0].movements[0];
    EXPECT_EQ(m.action, Action::moveto);
    EXPECT_EQ(m.distribution, Distribution::linear);
    EXPECT_EQ(m.operands[3].number, -2.5);
    EXPECT_EQ(p.where(m.position), "own.n:5:12");
}

}  // namespace
}  // namespace anamorph
