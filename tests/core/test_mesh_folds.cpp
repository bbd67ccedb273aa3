// SPDX-License-Identifier: Apache-2.0
// How much of a picture a warp folds, found cell by cell, is what counting its pixels gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "anamorph/map/mesh_file.h"
#include "anamorph/render/mesh_warp.h"

namespace anamorph {
namespace {

TEST(MeshFolds, TheFractionIsThatOfThePixels) {
    const unsigned seed = 31;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    constexpr int kWidth = 201, kHeight = 157;
    int folded_maps = 0;
    for (int trial = 0; trial < 40; ++trial) {
        SCOPED_TRACE(trial);
        ControlMesh mesh;
        mesh.units = Units::fractions;
        mesh.columns = 1 + trial % 9;
        mesh.rows = 1 + trial % 7;
        // From hardly moved to thrown about; some mirrored as a whole.
        const double most = 0.6 * (trial / 40.0) / std::max(mesh.columns, mesh.rows) * 4;
        for (int j = 0; j <= mesh.rows; ++j)
            for (int i = 0; i <= mesh.columns; ++i) {
                const double x = double(i) / mesh.columns, y = double(j) / mesh.rows;
                mesh.vertices.push_back(
                    {(trial % 5 == 0 ? 1 - x : x) + most * uniform(random), y + most * uniform(random)});
            }
        if (mesh.columns > 2) mesh.levels.push_back({{{1, 0}}, {}});
        MeshWarpOptions options;
        options.folds = true;
        const MeshWarp warp({"mesh", mesh}, 120, 90, kWidth, kHeight, options);
        std::vector<float> folds(kWidth * kHeight, -1);
        ASSERT_TRUE(warp.draw(
            nullptr, {0, 0, kWidth, kHeight},
            packed_view(reinterpret_cast<std::byte*>(folds.data()), PixelType::float32, kWidth, kHeight, 1)));
        const auto folded = std::count_if(folds.begin(), folds.end(), [](float f) { return f != 0; });
        EXPECT_EQ(warp.folded_fraction(), double(folded) / (kWidth * kHeight));
        folded_maps += folded > 0 && folded < kWidth * kHeight;
    }
    EXPECT_GT(folded_maps, 10);
    EXPECT_LT(folded_maps, 40);
}

// A panorama turned by a fifth, as an ST-map: u jumps from 1 to 0 at the seam, and only there the map runs
// backwards.
TEST(MeshFolds, AMapAcrossTheSeamIsNotTurnedOver) {
    constexpr int kWidth = 200, kHeight = 100;
    for (const bool mirrored : {false, true}) {
        std::vector<float> uv;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const double u = (x + 0.5) / kWidth + 0.2;
                uv.push_back(static_cast<float>(mirrored ? 1 - (u - std::floor(u)) : u - std::floor(u)));
                uv.push_back(static_cast<float>((y + 0.5) / kHeight));
            }
        const WarpMap map = mesh_from_stmap(uv.data(), kWidth, kHeight, 2, 2 * kWidth, 1, "st");
        const MeshWarp warp(map, 400, 200, kWidth, kHeight, {});
        // The seam's cell, and half of those beside it.
        EXPECT_GT(warp.folded_fraction(), 0);
        EXPECT_LE(warp.folded_fraction(), 3.0 / kWidth);
    }
}

}  // namespace
}  // namespace anamorph
