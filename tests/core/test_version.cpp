// SPDX-License-Identifier: Apache-2.0
#include <anamorph/version.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

TEST(Version, IsThreeNumbers) {
    EXPECT_THAT(anamorph::version(), testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
}
