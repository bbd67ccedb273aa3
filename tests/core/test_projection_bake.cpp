// SPDX-License-Identifier: Apache-2.0
// Panoramas baked into textures, against formulas in long double at every texel.
#include "anamorph/projector/projection_bake.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <thread>

#include "anamorph/error.h"

namespace anamorph::test_projection_bake {
namespace {

using Real = long double;
constexpr Real kPi = std::numbers::pi_v<Real>;

/// A wall at z, of 2 x 2, which fills its texture.
std::vector<BakedTriangle> wall(double z = -1) {
    const glm::dvec3 p(-1, -1, z), q(1, -1, z), r(1, 1, z), s(-1, 1, z);
    return {{{p, q, r}, {{{0, 0}, {1, 0}, {1, 1}}}}, {{p, r, s}, {{{0, 0}, {1, 1}, {0, 1}}}}};
}
/// A panorama whose first two channels are the centres of its pixels; bilinear reading gives back any point.
std::vector<float> coordinates(int width, int height) {
    std::vector<float> pixels;
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) pixels.insert(pixels.end(), {i + 0.5F, j + 0.5F, 7});
    return pixels;
}
std::vector<float> plain(int width, int height, float value) {
    return std::vector<float>(static_cast<std::size_t>(3 * width * height), value);
}

TEST(ProjectionBake, EveryTexelIsReadWhereTheFormulaSays) {
    const int width = 512, height = 256, n = 100;
    const std::vector<float> pixels = coordinates(width, height);
    const Projector projector(Chart(Projection::equirectangular, width, height), {{0.1, 0.2, 0.3}});
    BakeOptions options;
    options.size = {n, n};
    const BakedTexture texture = bake(wall(), {{projector, pixels.data()}}, options);
    EXPECT_EQ(texture.painted, n * n);
    EXPECT_EQ(texture.unseen, 0);
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const Real x = (i + 0.5L) / n * 2 - 1 - 0.1, y = 1 - (j + 0.5L) / n * 2 - 0.2, z = -1.3L;
            const Real u = (std::atan2(x, -z) / (2 * kPi) + 0.5L) * width;
            const Real v = (0.5L - std::atan2(y, std::hypot(x, z)) / kPi) * height;
            const float* p = &texture.pixels[static_cast<std::size_t>(4 * (j * n + i))];
            // The rounding of float, at 512 half of 2^-14.
            EXPECT_NEAR(p[0], static_cast<double>(u), 4e-5);
            EXPECT_NEAR(p[1], static_cast<double>(v), 4e-5);
            EXPECT_EQ(p[2], 7);
            EXPECT_EQ(p[3], 1);
        }
}

TEST(ProjectionBake, SharesAreThoseOfAnglesAndDistances) {
    const std::vector<float> low = plain(64, 32, 1), high = plain(64, 32, 5);
    const Chart chart(Projection::equirectangular, 64, 32);
    const glm::dvec3 near(0, 0, 0), far(1, 0.5, 1);
    BakeOptions options;
    options.size = {21, 21};
    const BakedTexture texture = bake(
        wall(), {{Projector(chart, {near}), low.data()}, {Projector(chart, {far}), high.data()}}, options);
    for (int j = 0; j < 21; ++j)
        for (int i = 0; i < 21; ++i) {
            const Real x = (i + 0.5L) / 21 * 2 - 1, y = 1 - (j + 0.5L) / 21 * 2;
            // Of a wall at right angles to z, a cosine is a depth over a distance.
            const auto share = [&](const glm::dvec3& from) {
                const Real dx = x - from.x, dy = y - from.y, dz = -1 - from.z;
                const Real d = std::sqrt(dx * dx + dy * dy + dz * dz);
                return std::fabs(dz) / (d * d * d);
            };
            const Real a = share(near), b = share(far);
            EXPECT_NEAR(texture.pixels[static_cast<std::size_t>(4 * (j * 21 + i))],
                        static_cast<double>((a + 5 * b) / (a + b)), 1e-6);
        }
}

TEST(ProjectionBake, ASlideFadesToItsBorder) {
    const Projector slide(Chart(Projection::rectilinear, 200, 200, 60));
    Point<double> texel{};
    const double full = share_of(slide, {0, 0, -1}, {0, 0, 1}, 50, texel);
    EXPECT_DOUBLE_EQ(full, 1);
    EXPECT_NEAR(texel.x, 100, 1e-9);
    // 25 texels from the border, at tan(30 degrees) 3/4.
    const double t = std::tan(std::numbers::pi / 6) * 0.75, d = std::hypot(t, 1.0);
    EXPECT_NEAR(share_of(slide, {t, 0, -1}, {0, 0, -3}, 50, texel), 0.5 / (d * d * d), 1e-12);
    EXPECT_EQ(share_of(slide, {1, 0, -1}, {0, 0, 1}, 50, texel), 0);
    EXPECT_EQ(share_of(slide, {0, 0, 1}, {0, 0, 1}, 50, texel), 0);
    EXPECT_EQ(share_of(slide, {0.1, 0, -1}, {1, 0, 0.1}, 0, texel), 0);
    // No normal, no point.
    EXPECT_EQ(share_of(slide, {0, 0, -1}, {0, 0, 0}, 0, texel), 0);
    EXPECT_EQ(share_of(slide, {0, NAN, -1}, {0, 0, 1}, 0, texel), 0);
    // Where nothing borders, nothing fades.
    const Projector all(Chart(Projection::equirectangular, 400, 200));
    EXPECT_DOUBLE_EQ(share_of(all, {0, 0, 2}, {0, 0, 1}, 1000, texel), 0.25);
}

TEST(ProjectionBake, WhatOneDoesNotSeeTheOtherPaints) {
    const std::vector<float> one = plain(64, 32, 1), two = plain(64, 32, 2);
    const Chart chart(Projection::equirectangular, 64, 32);
    const glm::dvec3 a(0, 0, 1), b(0.5, 0, 0);
    const std::vector<glm::dvec3> board{{-0.25, -9, 0.5},    {0.25, -9, 0.5},  {0, 30, 0.5},
                                        {0.25, -0.25, -0.5}, {9, -0.25, -0.5}, {0.25, 0.25, -0.5}};
    const Occluders before_a(board, a), before_b(board, b);
    BakeOptions options;
    options.size = {64, 64};
    const BakedTexture texture =
        bake(wall(),
             {{Projector(chart, {a}), one.data(), &before_a}, {Projector(chart, {b}), two.data(), &before_b}},
             options);
    int only_two = 0, unseen = 0;
    for (int j = 0; j < 64; ++j)
        for (int i = 0; i < 64; ++i) {
            const glm::dvec3 p((i + 0.5) / 32 - 1, 1 - (j + 0.5) / 32, -1);
            const float* t = &texture.pixels[static_cast<std::size_t>(4 * (j * 64 + i))];
            const bool from_a = !before_a.hides(p), from_b = !before_b.hides(p);
            EXPECT_EQ(t[3], from_a || from_b);
            if (from_a != from_b) {
                EXPECT_EQ(t[0], from_a ? 1 : 2);
            }
            only_two += from_b && !from_a;
            unseen += !from_a && !from_b;
        }
    EXPECT_GT(only_two, 100);
    EXPECT_GT(unseen, 10);
    EXPECT_EQ(texture.unseen, unseen);
    EXPECT_EQ(texture.painted + texture.unseen, 64 * 64);
}

TEST(ProjectionBake, WhatIsHiddenBeyondATriangleStaysUnpainted) {
    // Corners at x = 0.3; a board hides what is to the right of 0.305, and texels beyond the triangle go on to 0.38.
    const auto corner = [](double x, double y) { return glm::dvec2((x + 1) / 2, (y + 1) / 2); };
    const std::vector<BakedTriangle> mesh{{{glm::dvec3(-.5, -.5, -1), {.3, -.5, -1}, {-.5, .3, -1}},
                                           {corner(-.5, -.5), corner(.3, -.5), corner(-.5, .3)}}};
    const Occluders board({{.1525, -9, -.5}, {9, 0, -.5}, {.1525, 9, -.5}}, {});
    const Chart chart(Projection::equirectangular, 64, 32);
    const std::vector<float> pixels = plain(64, 32, 1);
    BakeOptions options;
    options.size = {100, 100};
    options.margin = 4;
    const BakedTexture all = bake(mesh, {{Projector(chart), pixels.data()}}, options),
                       seen = bake(mesh, {{Projector(chart), pixels.data(), &board}}, options);
    int hidden = 0;
    for (std::size_t j = 0; j < 100; ++j)
        for (std::size_t i = 0; i < 100; ++i) {
            const double x = (static_cast<double>(i) + 0.5) / 50 - 1;
            const float painted = all.pixels[4 * (100 * j + i) + 3];
            hidden += painted != 0 && x > .305 ? 1 : 0;
            EXPECT_EQ(seen.pixels[4 * (100 * j + i) + 3], x > .305 ? 0 : painted) << i << " " << j;
        }
    EXPECT_GT(hidden, 10);
    EXPECT_EQ(seen.unseen, hidden);
}

TEST(ProjectionBake, SeamsAreReadAcrossAndFacesAreNot) {
    // Behind, where the panorama closes: columns 0 and 63 are the same wall.
    std::vector<float> pixels = plain(64, 32, 0);
    for (int j = 0; j < 32; ++j)
        for (int c = 0; c < 3; ++c)
            pixels[static_cast<std::size_t>(3 * (64 * j) + c)] =
                pixels[static_cast<std::size_t>(3 * (64 * j + 63) + c)] = 4;
    const Projector projector(Chart(Projection::equirectangular, 64, 32));
    BakeOptions options;
    options.size = {401, 3};
    const BakedTexture texture = bake(wall(1), {{projector, pixels.data()}}, options);
    EXPECT_FLOAT_EQ(texture.pixels[static_cast<std::size_t>(4 * (401 + 200))], 4);
    // A face of 1, others of 0: the floor below shows 1 alone.
    std::vector<float> faces = plain(16, 96, 0);
    const Chart cube(Projection::cubemap, 16, 96);
    const Box box = cube.pieces()[static_cast<std::size_t>(cube.piece_of(Ray<double>{0, 1, 0}))].box;
    for (int j = static_cast<int>(box.y0); j < box.y1; ++j)
        for (int i = 0; i < 48; ++i) faces[static_cast<std::size_t>(48 * j + i)] = 1;
    std::vector<BakedTriangle> floor = wall();
    for (BakedTriangle& t : floor)
        for (glm::dvec3& p : t.points) p = {p.x, -1, p.y};
    options.size = {50, 50};
    options.margin = 0;
    const BakedTexture below = bake(floor, {{Projector(cube), faces.data()}}, options);
    for (std::size_t i = 0; i < below.pixels.size(); i += 4) EXPECT_EQ(below.pixels[i], 1);
}

TEST(ProjectionBake, QuartersOfAnOctahedronAreReadAcross) {
    // Ahead four texels meet, of which one has a value: the middle of the wall has a quarter of it.
    std::vector<float> pixels = plain(64, 64, 0);
    for (int c = 0; c < 3; ++c) pixels[static_cast<std::size_t>(3 * (64 * 32 + 32) + c)] = 4;
    BakeOptions options;
    options.size = {401, 401};
    const Projector projector(Chart(Projection::octahedral, 64, 64));
    const BakedTexture texture = bake(wall(), {{projector, pixels.data()}}, options);
    EXPECT_NEAR(texture.pixels[static_cast<std::size_t>(4 * (401 * 200 + 200))], 1, 0.05);
}

TEST(ProjectionBake, TexelsBeyondABorderGoOnAndTheFirstTriangleHasThem) {
    std::vector<BakedTriangle> one{wall()[0]};
    const std::vector<float> pixels = plain(64, 32, 1);
    const Projector projector(Chart(Projection::equirectangular, 64, 32));
    BakeOptions options;
    options.size = {64, 64};
    for (const double margin : {0.0, 2.0}) {
        options.margin = margin;
        const BakedTexture texture = bake(one, {{projector, pixels.data()}}, options);
        // Half the square, its diagonal through centres of texels, and strips along that.
        EXPECT_NEAR(static_cast<double>(texture.painted), 32 * 65 + margin * std::sqrt(2.0) * 64,
                    margin * 40 + 0.5);
    }
    // The same triangles elsewhere in the scene, behind those that have the texels.
    std::vector<BakedTriangle> twice = wall();
    for (const BakedTriangle& t : wall(NAN)) twice.push_back(t);
    EXPECT_EQ(bake(twice, {{projector, pixels.data()}}, options).painted, 64 * 64);
}

TEST(ProjectionBake, AnyThreadsGiveTheSameBits) {
    const std::vector<float> pixels = coordinates(256, 128);
    const Projector projector(Chart(Projection::equirectangular, 256, 128), {{0.4, 0, 0.1}});
    BakeOptions options;
    options.size = {60, 70};
    const auto threads = [](std::int64_t count, const std::function<void(std::int64_t)>& body) {
        std::vector<std::thread> all;
        for (int k = 0; k < 3; ++k)
            all.emplace_back([&, k] {
                for (std::int64_t i = count - 1 - k; i >= 0; i -= 3) body(i);
            });
        for (std::thread& t : all) t.join();
    };
    EXPECT_EQ(bake(wall(), {{projector, pixels.data()}}, options).pixels,
              bake(wall(), {{projector, pixels.data()}}, options, threads).pixels);
}

TEST(ProjectionBake, SharedRowsMakeTheWhole) {
    const std::vector<float> pixels = coordinates(64, 32);
    const Projector projector(Chart(Projection::equirectangular, 64, 32), {{0.1, 0.2, 0.3}});
    BakeOptions options;
    options.size = {20, 17};
    options.margin = 2;
    const BakedTexture whole = bake(wall(), {{projector, pixels.data()}}, options);
    ASSERT_EQ(whole.painted, 20 * 17);
    std::int64_t painted = 0;
    options.row_step = 3;
    for (options.first_row = 0; options.first_row < 3; ++options.first_row) {
        const BakedTexture part = bake(wall(), {{projector, pixels.data()}}, options);
        painted += part.painted;
        for (std::size_t i = 0; i < whole.pixels.size(); ++i) {
            const bool mine = static_cast<int>(i / 80) % 3 == options.first_row;
            EXPECT_EQ(part.pixels[i], mine ? whole.pixels[i] : 0);
        }
    }
    EXPECT_EQ(painted, whole.painted);
}

TEST(ProjectionBake, APartHoldsItsRowsAlone) {
    const std::vector<float> pixels = coordinates(64, 32);
    const Projector projector(Chart(Projection::equirectangular, 64, 32), {{0.1, 0.2, 0.3}});
    BakeOptions options;
    options.size = {20, 17};
    options.margin = 2;
    const BakedTexture whole = bake(wall(), {{projector, pixels.data()}}, options);
    std::vector<float> all;
    std::int64_t painted = 0;
    const std::vector<int> edges = {0, 0, 1, 9, 17, 40};
    for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
        options.begin_row = edges[k];
        options.end_row = edges[k + 1];
        const BakedTexture part = bake(wall(), {{projector, pixels.data()}}, options);
        EXPECT_EQ(part.pixels.size(),
                  static_cast<std::size_t>(80 * (std::min(edges[k + 1], 17) - std::min(edges[k], 17))));
        all.insert(all.end(), part.pixels.begin(), part.pixels.end());
        painted += part.painted;
    }
    EXPECT_EQ(all, whole.pixels);
    EXPECT_EQ(painted, whole.painted);
}

TEST(ProjectionBake, RefusesInWordsAndTakesTrianglesThatAreNone) {
    const std::vector<float> pixels = plain(64, 32, 1);
    const Projector projector(Chart(Projection::equirectangular, 64, 32));
    const auto with = [&](auto set) {
        BakeOptions options;
        options.size = {8, 8};
        set(options);
        return [=] { bake(wall(), {{projector, pixels.data()}}, options); };
    };
    using testing::HasSubstr;
    using testing::ThrowsMessage;
    EXPECT_THAT(with([](BakeOptions& o) { o.size.width = 0; }),
                ThrowsMessage<Error>("size=0: must be from 1 to 32768"));
    EXPECT_THAT(with([](BakeOptions& o) { o.channels = 65; }),
                ThrowsMessage<Error>("channels=65: must be from 1 to 64"));
    EXPECT_THAT(with([](BakeOptions& o) { o.fade = NAN; }),
                ThrowsMessage<Error>(HasSubstr("fade=nan: must be from 0")));
    EXPECT_THAT(with([](BakeOptions& o) { o.margin = -1; }),
                ThrowsMessage<Error>("margin=-1: must be from 0 to 64"));
    EXPECT_THAT(with([](BakeOptions& o) { o.begin_row = -1; }),
                ThrowsMessage<Error>("begin_row=-1: must be at least 0"));
    EXPECT_THAT(with([](BakeOptions& o) {
                    o.begin_row = 5;
                    o.end_row = 4;
                }),
                ThrowsMessage<Error>("end_row=4: must be at least begin_row"));
    EXPECT_THAT(
        [&] {
            bake(wall(), {{projector, nullptr}});
        },
        ThrowsMessage<Error>("pictures=none: must have pixels"));
    std::vector<BakedTriangle> bad{wall()[0], wall()[0], wall()[0]};
    bad[0].coordinates[1].x = NAN;
    bad[1].coordinates[1] = bad[1].coordinates[0];
    bad[2].points[0].y = HUGE_VAL;
    BakeOptions options;
    options.size = {8, 8};
    EXPECT_EQ(bake(bad, {{projector, pixels.data()}}, options).painted, 0);
    EXPECT_EQ(bake({}, {{projector, pixels.data()}}, options).painted, 0);
    EXPECT_EQ(bake(wall(), {}, options).unseen, 64);
}

}  // namespace
}  // namespace anamorph::test_projection_bake
