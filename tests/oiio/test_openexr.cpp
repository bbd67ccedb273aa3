// SPDX-License-Identifier: Apache-2.0
// Our charts with pixels=centers are OpenEXR's environment maps: ImfEnvmap's own functions say so.
#include <OpenEXR/ImfEnvmap.h>
#include <gtest/gtest.h>

#include <random>

#include "anamorph/chart/chart.h"

namespace anamorph::test_openexr {
namespace {

/// Our ray in OpenEXR's frame: x to the left, y up, z forward.
Imath::V3f to_exr(const Ray<double>& ray) {
    return {static_cast<float>(-ray.x), static_cast<float>(-ray.y), static_cast<float>(ray.z)};
}

Ray<double> random_ray(std::mt19937& random) {
    std::normal_distribution<double> normal;
    return {normal(random), normal(random), normal(random)};
}

TEST(OpenExr, LatLongMap) {
    SCOPED_TRACE("seed 3");
    std::mt19937 random(3);
    for (const int height : {16, 128, 777}) {
        const Chart chart(Projection::equirectangular, 2 * height, height, 360, PixelSpacing::centers);
        const Imath::Box2i window({0, 0}, {2 * height - 1, height - 1});
        for (int i = 0; i < 2000; ++i) {
            const Ray<double> ray = random_ray(random);
            const Point<double> ours = chart.point(ray, 0);
            const Imath::V2f theirs = Imf::LatLongMap::pixelPosition(window, to_exr(ray));
            // Theirs counts pixel centres from 0.
            ASSERT_NEAR(ours.x - 0.5, theirs.x, 1e-5 * height);
            ASSERT_NEAR(ours.y - 0.5, theirs.y, 1e-5 * height);
        }
    }
}

TEST(OpenExr, CubeMap) {
    SCOPED_TRACE("seed 4");
    std::mt19937 random(4);
    for (const int size : {16, 128, 777}) {
        const Chart chart(Projection::cubemap, size, 6 * size, 90, PixelSpacing::centers);
        const Imath::Box2i window({0, 0}, {size - 1, 6 * size - 1});
        ASSERT_EQ(Imf::CubeMap::sizeOfFace(window), size);
        for (int i = 0; i < 2000; ++i) {
            const Ray<double> ray = random_ray(random);
            const int piece = chart.piece_of(ray);
            const Point<double> ours = chart.point(ray, piece);
            Imf::CubeMapFace face;
            Imath::V2f in_face;
            Imf::CubeMap::faceAndPixelPosition(to_exr(ray), window, face, in_face);
            const Imath::V2f theirs = Imf::CubeMap::pixelPosition(face, window, in_face);
            ASSERT_EQ(piece, static_cast<int>(face));
            ASSERT_NEAR(ours.x - 0.5, theirs.x, 1e-5 * size);
            ASSERT_NEAR(ours.y - 0.5, theirs.y, 6e-5 * size);
        }
    }
}

}  // namespace
}  // namespace anamorph::test_openexr
