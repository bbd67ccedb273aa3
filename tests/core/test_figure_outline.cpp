// SPDX-License-Identifier: Apache-2.0
// Outlines against depth tests, in seeded scenes.
#include <gtest/gtest.h>

#include <glm/common.hpp>
#include <numbers>

#include "figure_outline_cases.h"

namespace anamorph::test_figure_outline {
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

// In a window, limbs have the arcs that they have without one, or none where no point of them is in it.
TEST(FigureOutline, WindowsLeaveOutOnlyWhatIsOutside) {
    constexpr std::uint64_t kSeed = 17;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    int left_out = 0, kept = 0;
    for (std::uint64_t seed = kSeed; seed < kSeed + 60; ++seed) {
        test::SceneMaker random(seed);
        const bool perspective = seed % 2 == 0;
        const test::OutlineScene scene = random.scene(test::Family::small, perspective);
        const Outlines all = outlines(scene.bodies, scene.view);
        OutlineOptions options;
        const glm::dvec2 corner = scene.view.middle + glm::dvec2(random.point(50) * scene.view.scale);
        options.window = {glm::min(corner, scene.view.middle), glm::max(corner, scene.view.middle)};
        const Outlines some = outlines(scene.bodies, scene.view, options);
        for (std::size_t i = 0; i < all.bodies.size(); ++i) {
            const Outline &whole = all.bodies[i], &part = some.bodies[i];
            EXPECT_EQ(part.kind, whole.kind);
            EXPECT_EQ(part.limb.cosine, whole.limb.cosine);
            if (part.visible == whole.visible && part.hidden == whole.hidden) {
                ++kept;
                continue;
            }
            ++left_out;
            EXPECT_TRUE(part.visible.empty() && part.hidden.empty());
            ASSERT_EQ(whole.kind, OutlineKind::whole);  // what the near plane cuts has no bounds
            for (int k = 0; k < 360; ++k) {
                const glm::dvec2 p = whole.on_screen(k * std::numbers::pi / 180, scene.view);
                EXPECT_FALSE(p.x > options.window.low.x && p.y > options.window.low.y &&
                             p.x < options.window.high.x && p.y < options.window.high.y)
                    << seed << " " << i;
            }
        }
    }
    EXPECT_GT(left_out, 50);
    EXPECT_GT(kept, 50);
}

}  // namespace
}  // namespace anamorph::test_figure_outline
