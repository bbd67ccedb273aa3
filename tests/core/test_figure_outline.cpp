// SPDX-License-Identifier: Apache-2.0
// Outlines against depth tests, in seeded scenes.
#include <gtest/gtest.h>

#include "figure_outline_cases.h"

namespace anamorph {
using namespace figure;
namespace {

TEST(FigureOutline, ArcsAgreeWithDepthTests) {
    for (const test::Family family : test::kFamilies)
        for (const bool perspective : {false, true}) {
            test::OutlineFindings all;
            for (std::uint64_t seed = 1; seed <= 40; ++seed) {
                SCOPED_TRACE(::testing::Message() << test::name_of(family) << ", perspective " << perspective
                                                  << ", seed " << seed);
                const test::OutlineScene scene = test::SceneMaker(seed).scene(family, perspective);
                const test::OutlineFindings found =
                    test::examine(scene, outlines(scene.bodies, scene.view), 32);
                EXPECT_EQ(found.wrong, 0);
                EXPECT_EQ(found.gaps, 0);
                EXPECT_LE(found.worst_limb, 1e-9);
                all.add(found);
            }
            // Scenes in which nothing is hidden, or all, would prove nothing.
            EXPECT_GT(all.hidden, all.samples / 10);
            EXPECT_LT(all.hidden, all.samples * 9 / 10);
            if (family != test::Family::tangent) {
                EXPECT_LE(all.grazing + all.near, all.samples / 10000);
            }
        }
}

}  // namespace
}  // namespace anamorph
