// SPDX-License-Identifier: Apache-2.0
// What pictures of the map itself say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anamorph/panorama/reproject.h"

namespace anamorph::test_draw {
namespace {

std::vector<float> stmap_of(const Panorama& map, double tol) {
    ReprojectOptions options;
    options.tol = tol;
    options.output = Output::stmap;
    const int w = map.target().width(), h = map.target().height();
    std::vector<float> uv(static_cast<std::size_t>(w * h * 2));
    const ImageView view = packed_view(reinterpret_cast<std::byte*>(uv.data()), PixelType::float32, w, h, 2);
    EXPECT_TRUE(reprojected_picture(map, options).draw(nullptr, {0, 0, w, h}, view));
    return uv;
}

TEST(Draw, StmapsStayOnASourceThatCloses) {
    using enum Projection;
    const Chart sources[] = {
        {equirectangular, 512, 256}, {equirectangular, 513, 257, 0, PixelSpacing::centers},
        {cylindrical, 512, 4000},    {mercator, 512, 4000},
        {cubemap, 128, 768},         {cubemap3x2, 384, 256}};
    const Chart to(rectilinear, 200, 150, 100);
    for (const Chart& from : sources)
        for (const double tol : {0.0, 0.01, 2.0})
            for (const double pitch : {0.0, 88.0, -75.0}) {
                if (std::fabs(pitch) > 30 && !from.reaches_poles() && !has_faces(from.projection())) continue;
                SCOPED_TRACE(::testing::Message() << name_of(from.projection()) << " tol " << tol << " pitch "
                                                  << pitch << " of " << from.width());
                const Panorama map(from, to, {177, pitch, 12});
                const std::vector<float> uv = stmap_of(map, tol);
                int outside = 0;
                double worst = 0;
                for (int y = 0; y < to.height(); ++y)
                    for (int x = 0; x < to.width(); ++x) {
                        const float* at = &uv[static_cast<std::size_t>((y * to.width() + x) * 2)];
                        outside += !(at[0] >= 0 && at[0] <= 1 && at[1] >= 0 && at[1] <= 1);
                        Point<double> p{};
                        int piece = 0;
                        ASSERT_TRUE(map.exact(x + 0.5, y + 0.5, 0, p, piece));
                        double dx = at[0] * double(from.width()) - p.x;
                        if (from.closed()) dx -= std::round(dx / from.period()) * from.period();
                        worst = std::max(worst, std::hypot(dx, at[1] * double(from.height()) - p.y));
                    }
                EXPECT_EQ(outside, 0);
                // u and v are floats.
                EXPECT_LE(worst, tol + 0x1p-23 * (from.width() + from.height()));
            }
}

TEST(Draw, StmapsGoOnBeyondASourceThatDoesNotClose) {
    using enum Projection;
    // The larger one has regions that lie beyond the source's edges as a whole.
    for (const int width : {200, 2000}) {
        const Panorama map({rectilinear, 300, 200, 60}, {rectilinear, width, width * 3 / 4, 100}, {});
        const std::vector<float> uv = stmap_of(map, 0.01);
        // The corners of a view of 100 degrees on a source of 60: half (1 -+ tan 50 / tan 30) across.
        const double u = 0.5 * (1 - std::tan(std::numbers::pi * 50 / 180) / std::tan(std::numbers::pi / 6));
        EXPECT_NEAR(uv[0], u, 2.0 / width);
        EXPECT_NEAR(uv[uv.size() - 2], 1 - u, 2.0 / width);
    }
}

// Regions that lie beyond the source's edges are black only where nothing stands there.
TEST(Draw, WhatStandsBeyondTheEdgesIsDrawn) {
    const Chart from(Projection::rectilinear, 300, 200, 40), to(Projection::rectilinear, 1000, 700, 100);
    const std::vector<float> ones(300 * 200, 1.0f);
    const MemorySource source(packed_view(reinterpret_cast<const std::byte*>(ones.data()), PixelType::float32,
                                          from.width(), from.height(), 1));
    for (const Wrap wrap : {Wrap::automatic, Wrap::black, Wrap::clamp, Wrap::periodic, Wrap::mirror}) {
        ReprojectOptions options;
        options.wrap = wrap;
        std::vector<float> drawn(1000 * 700, -1.0f);
        const ImageView view =
            packed_view(reinterpret_cast<std::byte*>(drawn.data()), PixelType::float32, 1000, 700, 1);
        ASSERT_TRUE(
            reprojected_picture(Panorama(from, to, {}), options).draw(&source, {0, 0, 1000, 700}, view));
        const float beyond = wrap == Wrap::automatic || wrap == Wrap::black ? 0.0f : 1.0f;
        SCOPED_TRACE(static_cast<int>(wrap));
        EXPECT_NEAR(drawn.front(), beyond, 1e-6);
        EXPECT_NEAR(drawn.back(), beyond, 1e-6);
        EXPECT_NEAR(drawn[350 * 1000 + 500], 1, 1e-6);
    }
}

TEST(Draw, NothingIsWrittenBeyondTheView) {
    const Panorama map(Chart(Projection::equirectangular, 64, 32),
                       Chart(Projection::rectilinear, 40, 30, 90));
    std::vector<float> texels(64 * 32, 1), pixels(20 * 30, -1);
    const MemorySource source(
        packed_view(reinterpret_cast<const std::byte*>(texels.data()), PixelType::float32, 64, 32, 1));
    const auto small =
        packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, 20, 15, 1);
    const Picture picture = reprojected_picture(map, {});
    EXPECT_TRUE(picture.draw(&source, {0, 0, 20, 15}, small));
    for (const Box& box : {Box{0, 0, 40, 30}, Box{0, 0, 21, 15}, Box{0, 0, 20, 16}, Box{-5, 0, 20, 15}}) {
        std::fill(pixels.begin(), pixels.end(), -1.0f);
        EXPECT_THROW(picture.draw(&source, box, small), Error);
        EXPECT_EQ(std::count(pixels.begin(), pixels.end(), -1.0f), 600);
    }
    // Beyond the picture pixels become 0.
    EXPECT_TRUE(picture.draw(&source, {-20, -15, 0, 0}, small));
    EXPECT_EQ(std::count(pixels.begin(), pixels.end(), 0.0f), 300);
}

}  // namespace
}  // namespace anamorph::test_draw
