// SPDX-License-Identifier: Apache-2.0
// Points of surfaces that are seen at a place: what proves them single, found for one point or shared by many.
#include "anamorph/surface/polish.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace anamorph::surface::test_polish {
namespace {

// Waves that are seen aslant hide parts of themselves: from points on one side of a fold Newton's method may lead to the other.
TEST(PointPolish, SharedSlopesProveWhatTheyHoldAlone) {
    constexpr unsigned kSeed = 41;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    const auto& names = surface_names();
    const auto waves =
        make_surface(static_cast<std::size_t>(std::find(names.begin(), names.end(), "waves") - names.begin()),
                     SurfaceShape{});
    CameraPose pose;
    pose.position = {2.5, 0.3, 0.9};
    const Camera camera(pose, glm::dmat3(1.0), glm::dvec3(0.0), {400, 400});
    const PointPolish to(*waves, camera);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> within(0.02, 0.98), near(-0.3, 0.3);
    int single = 0, folded = 0;
    for (int n = 0; n < 4000; ++n) {
        const double u = within(random), v = within(random);
        const Point<double> seen = camera.seen(camera.in_frame(waves->position(u, v)));
        const double from_u = std::clamp(u + near(random), 0.0, 1.0),
                     from_v = std::clamp(v + near(random) / 10, 0.0, 1.0);
        const PointPolish::Polished own = to.polish(seen.x, seen.y, from_u, from_v);
        // Slopes about the point that is found, without the way there.
        const auto about = [](double at) { return Interval(at - 1e-6, at + 1e-6); };
        const PointPolish::Slopes elsewhere = to.slopes(about(own.u), about(own.v));
        const PointPolish::Polished shared = to.polish(seen.x, seen.y, from_u, from_v, &elsewhere);
        ASSERT_EQ(shared.bound, own.bound) << n;
        ASSERT_EQ(shared.u, own.u);
        ASSERT_EQ(shared.v, own.v);
        (own.bound < HUGE_VAL ? single : folded) += 1;
        // Those that hold it find no other point.
        const auto around = [](double a, double b) {
            return Interval(std::min(a, b) - 0.01, std::max(a, b) + 0.01);
        };
        const PointPolish::Slopes wider = to.slopes(around(from_u, own.u), around(from_v, own.v));
        const PointPolish::Polished by_wider = to.polish(seen.x, seen.y, from_u, from_v, &wider);
        ASSERT_EQ(by_wider.bound, own.bound);
        ASSERT_EQ(by_wider.u, own.u);
    }
    EXPECT_GT(single, 300);
    EXPECT_GT(folded, 300);
}

}  // namespace
}  // namespace anamorph::surface::test_polish
