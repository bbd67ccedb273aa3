// SPDX-License-Identifier: Apache-2.0
// A projection and an operation that were added by a file and a line each (tests/toys) are what stock hosts see.
#ifdef ANAMORPH_TOYS
#include <cmath>
#include <numbers>

#include "anamorph/oiio_ops.h"
#include "host.h"

namespace anamorph::test_toys {
namespace {

using namespace testing_oiio;
using testing::HasSubstr;

class Toys : public InFolder {};

TEST_F(Toys, TheProjectionIsASourceAndATarget) {
    constexpr int kWidth = 64, kHeight = 32;
    write_panorama("city.exr", kWidth, kHeight);
    const Ran map = run("oiiotool 'city.exr.pano?to=toy&size=64x24&output=stmap&tol=0' -o map.exr");
    ASSERT_EQ(map.status, 0) << map.text;
    const std::vector<float> points = read_floats("map.exr");
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double plane = (y + 0.5 - 12) * 2 * std::numbers::pi / kWidth;
            if (std::fabs(plane) > 2) continue;
            const float* at = &points[static_cast<std::size_t>(y * kWidth + x) * 2];
            EXPECT_NEAR(at[0], (x + 0.5) / kWidth, 1e-6);
            EXPECT_NEAR(at[1], 0.5 + 2 * std::atan(plane / 2) / std::numbers::pi, 1e-6);
        }
    const Ran back =
        run("oiiotool 'city.exr.pano?from=toy&to=toy&size=64x32&tol=0&filter=nearest' -o same.exr");
    ASSERT_EQ(back.status, 0) << back.text;
    const Pixels same = read_pixels("same.exr");
    EXPECT_EQ(same.bytes.size(), read_pixels("city.exr").bytes.size());
    EXPECT_EQ(same.spec.get_string_attribute("anamorph:from"), "toy (given)");
    EXPECT_EQ(same.spec.get_string_attribute("panoramaProjection"), "toy fov=360");
    // Drawn as it lies where it has rays: all but the rows beyond the poles.
    const std::vector<float> drawn = read_floats("same.exr"), city = read_floats("city.exr");
    const std::size_t row = std::size_t{kWidth} * 3;
    EXPECT_TRUE(std::equal(drawn.begin() + 8 * static_cast<std::ptrdiff_t>(row),
                           drawn.begin() + 24 * static_cast<std::ptrdiff_t>(row),
                           city.begin() + 8 * static_cast<std::ptrdiff_t>(row)));
    EXPECT_THAT(open_error("city.exr.pano?to=none"), HasSubstr("toy"));
}

TEST_F(Toys, TheOperationIsARecipeAndAFunction) {
    const Ran ran = run("oiiotool 'x.toy?size=48x24&side=6' -o toy.exr");
    ASSERT_EQ(ran.status, 0) << ran.text;
    const std::vector<float> recipe = read_floats("toy.exr");
    ASSERT_EQ(recipe.size(), 48u * 24 * 3);
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 48; ++x)
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(recipe[static_cast<std::size_t>((y * 48 + x) * 3 + c)],
                            0.5 + 0.5 * std::sin(3.0 * (x / 6) + 5.0 * (y / 6) + c), 1e-6);
    const OIIO::ImageBuf call = apply("toy", {}, options({{"size", "48x24"}, {"side", "6"}}));
    EXPECT_EQ(bytes(call), read_pixels("x.toy?size=48x24&side=6").bytes);
    EXPECT_THAT(open_error("x.toy?side=0"), HasSubstr("side=0: must be a number from 0.25 to 1000"));
}

}  // namespace
}  // namespace anamorph::test_toys
#endif
