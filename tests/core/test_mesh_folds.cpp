// SPDX-License-Identifier: Apache-2.0
// How much of a picture a warp folds, found cell by cell, is what counting its pixels gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "anamorph/mesh/mesh_file.h"
#include "anamorph/mesh/mesh_warp.h"

namespace anamorph::test_mesh_folds {
namespace {

double folded_fraction(const Picture& picture) {
    return std::get<double>(picture.says(serial_for).at(0).value);
}

/// Counts the folded pixels of a picture that shows them, and expects folded_fraction to say the same. Is it
/// neither none nor all of them?
bool expect_the_fraction_of_pixels(const WarpMap& map, int width, int height) {
    MeshWarpOptions options;
    options.folds = true;
    const Picture warp = warped_picture(map, {120, 90}, {width, height}, options);
    std::vector<float> folds(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), -1);
    EXPECT_TRUE(warp.draw(
        nullptr, {0, 0, width, height},
        packed_view(reinterpret_cast<std::byte*>(folds.data()), PixelType::float32, width, height, 1)));
    const auto folded = std::count_if(folds.begin(), folds.end(), [](float f) { return f != 0; });
    EXPECT_EQ(folded_fraction(warp), double(folded) / (double(width) * height));
    return folded > 0 && folded < width * height;
}

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
        folded_maps += expect_the_fraction_of_pixels({"mesh", mesh}, kWidth, kHeight);
    }
    EXPECT_GT(folded_maps, 10);
    EXPECT_LT(folded_maps, 40);
}

TEST(MeshFolds, OfCellsAsSmallAsPixelsAndOfPoints) {
    const unsigned seed = 32;
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int meshes = 0, points = 0;
    for (int trial = 0; trial < 12; ++trial) {
        SCOPED_TRACE(trial);
        ControlMesh mesh;
        mesh.units = Units::fractions;
        mesh.columns = 40 + 9 * trial;
        mesh.rows = 70;
        for (int j = 0; j <= mesh.rows; ++j)
            for (int i = 0; i <= mesh.columns; ++i) {
                const double x = double(i) / mesh.columns, y = double(j) / mesh.rows, most = 0.001 * trial;
                mesh.vertices.push_back(
                    {(trial % 3 == 0 ? 1 - x : x) + most * uniform(random), y + most * uniform(random)});
            }
        meshes += expect_the_fraction_of_pixels({"mesh", mesh}, 201, 157);

        ControlPoints pairs;
        pairs.units = Units::fractions;
        for (int i = 0; i < 3 + 8 * trial; ++i) {
            const double x = 0.5 + 0.5 * uniform(random), y = 0.5 + 0.5 * uniform(random),
                         most = 0.02 * trial;
            pairs.pairs.push_back(
                {x, y, (trial % 4 == 0 ? 1 - x : x) + most * uniform(random), y + most * uniform(random)});
        }
        points += expect_the_fraction_of_pixels({"points", pairs}, 201, 157);
    }
    EXPECT_GT(meshes, 5);
    EXPECT_GT(points, 5);
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
        const Picture warp = warped_picture(map, {400, 200}, {kWidth, kHeight}, {});
        // The seam's cell, and half of those beside it.
        EXPECT_GT(folded_fraction(warp), 0);
        EXPECT_LE(folded_fraction(warp), 3.0 / kWidth);
    }
}

}  // namespace
}  // namespace anamorph::test_mesh_folds
