// SPDX-License-Identifier: Apache-2.0
// Whole pictures: the same bits however they are cut, the right colours, and damage that stays where it is.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <memory>
#include <random>
#include <thread>

#include "anamorph/image/block_sampler.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/point_sampler.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/panorama/reproject.h"

namespace anamorph::test_reproject {
namespace {

struct Picture {
    Picture(PixelType type, int width, int height, int channels)
        : bytes(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                static_cast<std::size_t>(channels * size_of(type))),
          view(packed_view(bytes.data(), type, width, height, channels)) {}
    ConstImageView read() const {
        return packed_view(bytes.data(), view.type, view.width, view.height, view.channels);
    }
    float at(int x, int y, int c) const {
        return load_channel(view.at(x, y) + c * size_of(view.type), view.type);
    }
    void set(int x, int y, int c, float value) {
        store_channel(value, view.at(x, y) + c * size_of(view.type), view.type);
    }
    std::vector<std::byte> bytes;
    ImageView view;
};

Picture noise(PixelType type, int width, int height, int channels, unsigned seed) {
    Picture p(type, width, height, channels);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(0, 1);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < channels; ++c) p.set(x, y, c, value(random));
    return p;
}

/// A smooth function of direction, so that a right picture is known without any sampling.
float sky(const Ray<double>& ray, int c) {
    const double n = std::hypot(ray.x, ray.y, ray.z);
    return static_cast<float>(0.5 + 0.2 * std::sin(2 * ray.x / n + c) +
                              0.2 * std::cos(3 * ray.y / n - c) * ray.z / n);
}

Picture paint(const Chart& chart, PixelType type, int channels) {
    Picture p(type, chart.width(), chart.height(), channels);
    for (std::size_t k = 0; k < chart.pieces().size(); ++k) {
        const Box& box = chart.pieces()[k].box;
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x)
                for (int c = 0; c < channels; ++c)
                    p.set(x, y, c, sky(chart.ray(x + 0.5, y + 0.5, static_cast<int>(k)), c));
    }
    return p;
}

void threaded_for(int threads, std::int64_t count, const std::function<void(std::int64_t)>& body) {
    std::atomic<std::int64_t> next{0};
    std::vector<std::thread> pool;
    for (int t = 0; t < threads; ++t)
        pool.emplace_back([&] {
            // From the far end: also another order.
            for (std::int64_t i; (i = next++) < count;) body(count - 1 - i);
        });
    for (std::thread& t : pool) t.join();
}

Picture draw(const anamorph::Picture& job, const Source& source, const ParallelFor& parallel_for = serial_for,
             PixelType type = PixelType::float32) {
    Picture p(type, job.width(), job.height(), job.channels(&source));
    EXPECT_TRUE(job.draw(&source, {0, 0, job.width(), job.height()}, p.view, parallel_for));
    return p;
}

struct Case {
    const char* name;
    Chart source, target;
    Orientation look;
    PixelType type;
    int channels;
    ReprojectOptions options;
};

std::vector<Case> cases() {
    using enum Projection;
    std::vector<Case> list = {
        {"view",
         {equirectangular, 700, 350},
         {rectilinear, 333, 177, 100},
         {170, 40, 10},
         PixelType::float32,
         3,
         {}},
        {"pole",
         {equirectangular, 512, 256},
         {rectilinear, 150, 130, 90},
         {0, 88, 0},
         PixelType::half,
         4,
         {}},
        {"cube", {cubemap, 96, 576}, {equirectangular, 400, 200}, {5, 6, 7}, PixelType::uint8, 3, {}},
        {"planet",
         {mercator, 300, 300},
         {stereographic, 257, 257, 300},
         {0, -90, 0},
         PixelType::uint16,
         1,
         {}},
        {"photo",
         {rectilinear, 200, 160, 80},
         {equirectangular, 512, 256},
         {30, 20, 10},
         PixelType::float32,
         2,
         {}},
        {"cross", {fisheye, 256, 256, 180}, {cubecross, 256, 192}, {0, 0, 0}, PixelType::uint8, 5, {}},
    };
    list[0].options.filter = Filter::bilinear;
    list[2].options.filter = Filter::bicubic;
    list[3].options.filter = Filter::nearest;
    list[4].options.wrap = Wrap::clamp;
    list[5].options.tol = 0;
    return list;
}

/// As above, and where the chart has no ray a value that nothing may show.
Picture paint_inside(const Chart& chart) {
    Picture p = paint(chart, PixelType::float32, 1);
    for (int y = 0; y < chart.height(); ++y)
        for (int x = 0; x < chart.width(); ++x)
            if (chart.inside(x + 0.5, y + 0.5) < 0) p.set(x, y, 0, 1e6f);
    return p;
}

TEST(Reproject, RowsThatEndWithTheSphereGoOnBeyondTheSeam) {
    const Chart views[] = {{Projection::rectilinear, 90, 70, 100}, {Projection::rectilinear, 17, 13, 100}};
    for (const Projection projection : {Projection::sinusoidal, Projection::hammer})
        for (const PixelSpacing spacing : {PixelSpacing::edges, PixelSpacing::centers})
            for (const Chart& view : views)
                for (const Filter filter : {Filter::nearest, Filter::bilinear, Filter::bicubic,
                                            Filter::sharp_bicubic, Filter::antialias})
                    for (const Orientation& look :
                         {Orientation{180, 0, 0}, {175, 40, 30}, {-170, -60, 0}, {20, 85, 0}, {0, 0, 0}}) {
                        SCOPED_TRACE(testing::Message()
                                     << name_of(projection)
                                     << (spacing == PixelSpacing::centers ? " centers" : "") << " to "
                                     << view.width() << " pixels, filter " << int(filter) << " yaw "
                                     << look.yaw << " pitch " << look.pitch);
                        const Chart chart(projection, 256, 128, 0, spacing);
                        const Picture source = paint_inside(chart);
                        const MemorySource image(source.read());
                        const Pyramid pyramid(image);
                        ReprojectOptions options;
                        options.filter = filter;
                        const Picture got =
                            draw(reprojected_picture(Panorama(chart, view, look), options), pyramid);
                        double worst = 0;
                        for (int y = 0; y < view.height(); ++y)
                            for (int x = 0; x < view.width(); ++x) {
                                const Ray<double> ray = transform(rotation(look), view.ray(x + 0.5, y + 0.5));
                                worst = std::max(worst, std::fabs(double(got.at(x, y, 0) - sky(ray, 0))));
                            }
                        // Beyond an edge a texel is up to half of one out of place, where they are widest.
                        EXPECT_LT(worst, view.width() > 50 ? 0.04 : 0.1);
                    }
}

TEST(Reproject, SameBitsForCropsTilesThreadsAndOrder) {
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        const Picture pixels = noise(c.type, c.source.width(), c.source.height(), c.channels, 7);
        const MemorySource memory(pixels.read());
        const Pyramid source(memory);
        const auto job = reprojected_picture({c.source, c.target, c.look}, c.options);
        const Picture whole = draw(job, source, serial_for, c.type);
        for (const int threads : {2, 3, 4}) {
            const auto again = reprojected_picture({c.source, c.target, c.look}, c.options);
            const Picture other = draw(
                again, source, [&](auto n, const auto& body) { threaded_for(threads, n, body); }, c.type);
            EXPECT_EQ(whole.bytes, other.bytes) << threads << " threads";
        }
        const int w = c.target.width(), h = c.target.height();
        for (const int tile : {16, 37, 64, 100, 512}) {
            Picture tiled(c.type, w, h, c.channels);
            for (int y = (h - 1) / tile * tile; y >= 0; y -= tile)
                for (int x = 0; x < w; x += tile) {
                    const Box box{x, y, std::min(x + tile, w), std::min(y + tile, h)};
                    ImageView part = tiled.view;
                    part.data = tiled.view.at(x, y);
                    ASSERT_TRUE(job.draw(&source, box, part));
                }
            EXPECT_EQ(whole.bytes, tiled.bytes) << "tiles of " << tile;
        }
    }
}

TEST(Reproject, PaintsTheSkyForEveryPairOfProjections) {
    using enum Projection;
    const Chart charts[] = {{equirectangular, 512, 256},  {cylindrical, 512, 300},
                            {rectilinear, 300, 300, 100}, {fisheye, 300, 300, 360},
                            {equisolid, 300, 300, 300},   {stereographic, 400, 400, 250},
                            {mercator, 512, 400},         {cubemap, 128, 768},
                            {cubemap3x2, 384, 256},       {cubecross, 512, 384}};
    for (const Chart& from : charts) {
        const Picture pixels = paint(from, PixelType::float32, 3);
        const MemorySource source(pixels.read());
        for (const Chart& to : charts) {
            SCOPED_TRACE(::testing::Message()
                         << name_of(from.projection()) << " -> " << name_of(to.projection()));
            ReprojectOptions options;
            options.filter = Filter::bicubic;
            const Panorama map(from, to, {20, -35, 15});
            const Picture picture = draw(reprojected_picture(map, options), source);
            double worst = 0;
            int seen = 0;
            for (std::size_t k = 0; k < to.pieces().size(); ++k)
                for (int y = to.pieces()[k].box.y0; y < to.pieces()[k].box.y1; y += 3)
                    for (int x = to.pieces()[k].box.x0; x < to.pieces()[k].box.x1; x += 3) {
                        Point<double> p{};
                        int piece = 0;
                        const int target_piece = static_cast<int>(k);
                        // Only where the filter has all its texels.
                        if (!map.exact(x + 0.5, y + 0.5, target_piece, p, piece)) continue;
                        const bool x_inside = from.closed() || (from.pieces().size() > 1) ||
                                              (p.x > 3 && p.x < from.width() - 3);
                        const bool y_inside = from.reaches_poles() || (from.pieces().size() > 1) ||
                                              (p.y > 3 && p.y < from.height() - 3);
                        if (!x_inside || !y_inside) continue;
                        ++seen;
                        const Ray<double> ray = from.ray(p.x, p.y, piece);
                        for (int c = 0; c < 3; ++c)
                            worst =
                                std::max(worst, std::fabs(double(picture.at(x, y, c)) - double(sky(ray, c))));
                    }
            EXPECT_GT(seen, 100);
            // The sky's variation over a texel at an edge of the cube, where a neighbour is the nearest
            // texel.
            EXPECT_LT(worst, (from.pieces().size() > 1) ? 0.006 : 0.002);
        }
    }
}

TEST(Reproject, ASteadySkyHasNoSeams) {
    using enum Projection;
    for (const Projection projection : {equirectangular, cubemap, cubemap3x2, cubecross}) {
        const Chart from = projection == equirectangular ? Chart(projection, 256, 128)
                           : projection == cubemap       ? Chart(projection, 64, 384)
                           : projection == cubemap3x2    ? Chart(projection, 192, 128)
                                                         : Chart(projection, 256, 192);
        for (const Filter filter :
             {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic, Filter::antialias}) {
            Picture pixels(PixelType::float32, from.width(), from.height(), 1);
            for (const Piece& piece : from.pieces())
                for (int y = piece.box.y0; y < piece.box.y1; ++y)
                    for (int x = piece.box.x0; x < piece.box.x1; ++x) pixels.set(x, y, 0, 0.75f);
            const MemorySource memory(pixels.read());
            const Pyramid source(memory);
            ReprojectOptions options;
            options.filter = filter;
            const Chart to(equirectangular, 300, 150);
            const Picture picture = draw(reprojected_picture({from, to, {33, 44, 55}}, options), source);
            for (int y = 0; y < 150; ++y)
                for (int x = 0; x < 300; ++x)
                    ASSERT_NEAR(picture.at(x, y, 0), 0.75f, 1e-5f)
                        << name_of(projection) << " " << x << "," << y << " filter "
                        << static_cast<int>(filter);
        }
    }
}

/// The distance between a picture and the scalar sampler at the exact points, in half-ULP of 1.
double against_scalar(const Case& c, const Source& source, const Picture& picture) {
    const Border border(c.source, c.options.wrap);
    PointSampler sampler(source, border);
    const Panorama map(c.source, c.target, c.look);
    double worst = 0;
    std::vector<float> pixel(static_cast<std::size_t>(c.channels));
    for (std::size_t k = 0; k < c.target.pieces().size(); ++k)
        for (int y = c.target.pieces()[k].box.y0; y < c.target.pieces()[k].box.y1; ++y)
            for (int x = c.target.pieces()[k].box.x0; x < c.target.pieces()[k].box.x1; ++x) {
                Point<double> p{};
                int piece = 0;
                if (!map.exact(x + 0.5, y + 0.5, static_cast<int>(k), p, piece)) continue;
                EXPECT_TRUE(sampler.sample(c.options.filter, 0, piece, p.x, p.y, pixel.data()));
                for (int ch = 0; ch < c.channels; ++ch)
                    worst = std::max(worst, std::fabs(double(pixel[static_cast<std::size_t>(ch)]) -
                                                      double(picture.at(x, y, ch))));
            }
    return worst / 0x1p-24;
}

TEST(Reproject, EveryInstructionSetAgreesWithTheScalarSampler) {
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        ASSERT_TRUE(simd::use_instruction_set(*set));
        for (Case c : cases())
            for (const Filter filter : {Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic}) {
                SCOPED_TRACE(::testing::Message()
                             << *set << " " << c.name << " filter " << static_cast<int>(filter));
                c.options.tol = 0;
                c.options.filter = filter;
                const Picture pixels = noise(c.type, c.source.width(), c.source.height(), c.channels, 9);
                const MemorySource source(pixels.read());
                const Picture picture =
                    draw(reprojected_picture({c.source, c.target, c.look}, c.options), source);
                EXPECT_LE(against_scalar(c, source, picture), is_cubic(filter) ? 32 : 16);
            }
        // Blocks against exact: noise changes by at most 2 per pixel of distance, along each axis.
        for (Case c : cases()) {
            SCOPED_TRACE(::testing::Message() << *set << " " << c.name << " in blocks");
            c.options.filter = Filter::bilinear;
            c.options.tol = 1e-3;
            const Picture pixels = noise(c.type, c.source.width(), c.source.height(), c.channels, 9);
            const MemorySource source(pixels.read());
            const Picture picture =
                draw(reprojected_picture({c.source, c.target, c.look}, c.options), source);
            EXPECT_LE(against_scalar(c, source, picture), 4e-3 / 0x1p-24);
        }
    }
    ASSERT_TRUE(simd::use_instruction_set(""));
    EXPECT_FALSE(simd::use_instruction_set("abacus"));
}

TEST(Reproject, NotANumberStaysInItsFootprint) {
    using enum Projection;
    const Chart from(equirectangular, 256, 128), to(rectilinear, 200, 200, 60);
    for (const float bad : {float(NAN), float(INFINITY)})
        for (const Filter filter :
             {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic}) {
            Picture pixels = noise(PixelType::float32, 256, 128, 3, 3);
            pixels.set(128, 64, 1, bad);
            const MemorySource source(pixels.read());
            ReprojectOptions options;
            options.filter = filter;
            const Panorama map(from, to);
            const Picture picture = draw(reprojected_picture(map, options), source);
            const double reach = filter == Filter::nearest ? 0.5 : filter == Filter::bilinear ? 1 : 2;
            int hit = 0;
            for (int y = 0; y < 200; ++y)
                for (int x = 0; x < 200; ++x) {
                    Point<double> p{};
                    int piece = 0;
                    ASSERT_TRUE(map.exact(x + 0.5, y + 0.5, 0, p, piece));
                    const double far = std::max(std::fabs(p.x - 128.5), std::fabs(p.y - 64.5));
                    EXPECT_TRUE(std::isfinite(picture.at(x, y, 0)) && std::isfinite(picture.at(x, y, 2)));
                    if (!std::isfinite(picture.at(x, y, 1))) {
                        ++hit;
                        EXPECT_LT(far, reach + 0.02);
                    }
                }
            EXPECT_GT(hit, 0);
        }
}

TEST(Reproject, AlphaWeighsColour) {
    using enum Projection;
    // Red and opaque beside green and transparent: no green may bleed.
    Picture pixels(PixelType::uint8, 64, 32, 4);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) {
            const bool red = x / 4 % 2 == 0;
            pixels.set(x, y, red ? 0 : 1, 1);
            pixels.set(x, y, 3, red ? 1 : 0);
        }
    const MemorySource source(pixels.read(), 3);
    ReprojectOptions options;
    options.filter = Filter::bilinear;
    const Picture picture = draw(
        reprojected_picture({{equirectangular, 64, 32}, {rectilinear, 100, 100, 90}, {}}, options), source);
    int mixed = 0;
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 100; ++x) {
            const float alpha = picture.at(x, y, 3);
            mixed += alpha > 0.01f && alpha < 0.99f;
            if (alpha > 0.001f) {
                EXPECT_NEAR(picture.at(x, y, 0), 1, 1e-4);
                EXPECT_NEAR(picture.at(x, y, 1), 0, 1e-4);
            }
        }
    EXPECT_GT(mixed, 100);
}

TEST(Reproject, ErrorPictureStaysUnderBoundPicture) {
    using enum Projection;
    for (const Scheme scheme : {Scheme::automatic, Scheme::blocks, Scheme::residual, Scheme::exact}) {
        const Panorama map({equirectangular, 4096, 2048}, {rectilinear, 300, 200, 100}, {175, 75, 10});
        ReprojectOptions options;
        options.scheme = scheme;
        options.tol = 0.25;
        const auto picture_of = [&](Output output, int channels) {
            options.output = output;
            Picture p(PixelType::float32, 300, 200, channels);
            EXPECT_TRUE(reprojected_picture(map, options).draw(nullptr, {0, 0, 300, 200}, p.view));
            return p;
        };
        const Picture error = picture_of(Output::error, 1), bound = picture_of(Output::bound, 1);
        const Picture stmap = picture_of(Output::stmap, 2);
        float most = 0;
        for (int y = 0; y < 200; ++y)
            for (int x = 0; x < 300; ++x) {
                EXPECT_LE(error.at(x, y, 0), bound.at(x, y, 0));
                EXPECT_LE(bound.at(x, y, 0), 0.25f);
                most = std::max(most, bound.at(x, y, 0));
                Point<double> p{};
                int piece = 0;
                ASSERT_TRUE(map.exact(x + 0.5, y + 0.5, 0, p, piece));
                double du = double(stmap.at(x, y, 0)) - p.x / 4096;
                du -= std::round(du);
                EXPECT_NEAR(du * 4096, 0, 0.251);
                EXPECT_NEAR(double(stmap.at(x, y, 1)) * 2048, p.y, 0.251);
            }
        EXPECT_EQ(most, static_cast<float>(reprojected_picture(map, options).reached().max_error));
        EXPECT_GT(most, 0);
        if (scheme == Scheme::exact) {
            EXPECT_LT(most, 1e-6f);
        }
    }
}

// A point on the seam of a map that ends in an outline has two images, and rounding chooses.
TEST(Reproject, AtASeamEitherEndIsRight) {
    for (const Projection from : {Projection::sinusoidal, Projection::hammer})
        for (const double pitch : {0.0, 90.0}) {
            const Panorama map(Chart(from, 64, 48), Chart(Projection::cubecross, 64, 48), {180, pitch, 45});
            const auto drawn = [&](Output output) {
                ReprojectOptions options;
                options.output = output;
                options.scheme = Scheme::exact;
                Picture picture(PixelType::float32, 64, 48, 1);
                reprojected_picture(map, options).draw(nullptr, {0, 0, 64, 48}, picture.view, serial_for);
                return picture;
            };
            const Picture error = drawn(Output::error), bound = drawn(Output::bound);
            for (int y = 0; y < 48; ++y)
                for (int x = 0; x < 64; ++x)
                    EXPECT_LE(error.at(x, y, 0), bound.at(x, y, 0) * (1 + 1e-6f))
                        << name_of(from) << " " << x << " " << y;
        }
}

TEST(Reproject, BoundsGoOnWhereSourcePointsDo) {
    using enum Projection;
    // The view looks past all four edges of the photograph.
    const Panorama map({rectilinear, 200, 160, 40}, {rectilinear, 300, 240, 120}, {10, 5, 20});
    for (const Scheme scheme : {Scheme::automatic, Scheme::exact})
        for (const Wrap wrap : {Wrap::automatic, Wrap::black}) {
            ReprojectOptions options;
            options.scheme = scheme;
            options.wrap = wrap;
            const auto picture_of = [&](Output output, int channels) {
                options.output = output;
                Picture p(PixelType::float32, 300, 240, channels);
                EXPECT_TRUE(reprojected_picture(map, options).draw(nullptr, {0, 0, 300, 240}, p.view));
                return p;
            };
            const Picture stmap = picture_of(Output::stmap, 2), bound = picture_of(Output::bound, 1);
            int beyond = 0;
            for (int y = 0; y < 240; ++y)
                for (int x = 0; x < 300; ++x) {
                    Point<double> p;
                    int piece;
                    ASSERT_TRUE(map.exact(x + 0.5, y + 0.5, 0, p, piece));
                    beyond += p.x < 0 || p.x > 200 || p.y < 0 || p.y > 160;
                    ASSERT_NEAR(stmap.at(x, y, 0), p.x / 200, 1e-4 * std::max(1.0, std::fabs(p.x) / 200));
                    ASSERT_GT(bound.at(x, y, 0), 0) << x << ' ' << y;
                }
            EXPECT_GT(beyond, 300 * 240 / 2);
        }
}

TEST(Reproject, WhatNeitherOfTwoLensesSeesIsBlack) {
    // The lens that looks back is 5, the one that looks ahead is 7; each sees 60 degrees from its axis.
    constexpr int kSize = 64;
    Picture pixels(PixelType::float32, 2 * kSize, kSize, 1);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < 2 * kSize; ++x) pixels.set(x, y, 0, x < kSize ? 5.0f : 7.0f);
    const MemorySource source(pixels.read());
    const Chart from(Projection::dual_fisheye, 2 * kSize, kSize, 120);
    const Panorama map(from, {Projection::equirectangular, 360, 180}, {});
    for (const Filter filter :
         {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic, Filter::antialias})
        for (const double tol : {0.0, 0.01}) {
            SCOPED_TRACE(testing::Message() << static_cast<int>(filter) << " tol " << tol);
            ReprojectOptions options;
            options.filter = filter;
            options.tol = tol;
            const Picture picture = draw(reprojected_picture(map, options), source);
            for (int y = 0; y < 180; ++y)
                for (int x = 0; x < 360; ++x) {
                    const double azimuth = (x + 0.5 - 180) / 180 * std::numbers::pi,
                                 elevation = (y + 0.5 - 90) / 180 * std::numbers::pi;
                    const double z = std::cos(azimuth) * std::cos(elevation);
                    const double from_axis = std::acos(std::fabs(z)) / std::numbers::pi * 180;
                    const float value = picture.at(x, y, 0), own = z > 0 ? 7.0f : 5.0f;
                    if (from_axis > 60) {
                        ASSERT_EQ(value, 0) << x << ' ' << y;
                    } else if (from_axis < 57) {
                        // Two texels from the edge, whose own are mixed with what is not there.
                        ASSERT_NEAR(value, own, 1e-5) << x << ' ' << y;
                    } else {
                        ASSERT_LE(value, own * 1.13f) << x << ' ' << y;
                    }
                }
        }
}

TEST(Reproject, AnOctahedronIsOnePicture) {
    // Of ones, whatever stands beyond its edges, and whether pixels' edges or centres are at them.
    Picture pixels(PixelType::float32, 64, 64, 1);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) pixels.set(x, y, 0, 1);
    const MemorySource source(pixels.read());
    for (const PixelSpacing spacing : {PixelSpacing::edges, PixelSpacing::centers})
        for (const Wrap wrap : {Wrap::automatic, Wrap::black, Wrap::clamp, Wrap::periodic, Wrap::mirror})
            for (const Filter filter :
                 {Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic, Filter::antialias}) {
                ReprojectOptions options;
                options.filter = filter;
                options.wrap = wrap;
                // Three quarters of the way to the diamond's edge, across all lines where quarters meet.
                const Panorama map({Projection::octahedral, 64, 64, 0, spacing},
                                   {Projection::rectilinear, 33, 33, 90}, {});
                const Picture picture = draw(reprojected_picture(map, options), source);
                for (int y = 0; y < 33; ++y)
                    for (int x = 0; x < 33; ++x) ASSERT_FLOAT_EQ(picture.at(x, y, 0), 1) << x << ' ' << y;
            }
}

class BrokenSource final : public Source {
  public:
    PixelType type() const noexcept override { return PixelType::float32; }
    int channels() const noexcept override { return 1; }
    int levels() const noexcept override { return 1; }
    Size size(int) const noexcept override { return {64, 32}; }
    bool read(int, const Box&, std::byte*, std::ptrdiff_t) const noexcept override { return false; }
};

TEST(Reproject, SaysWhatIsWrong) {
    using enum Projection;
    const Panorama map({equirectangular, 64, 32}, {rectilinear, 50, 50, 90});
    const auto job = reprojected_picture(map, {});
    Picture picture(PixelType::float32, 50, 50, 1);
    EXPECT_FALSE(job.draw(std::make_unique<BrokenSource>().get(), {0, 0, 50, 50}, picture.view));
    const Picture other = noise(PixelType::float32, 65, 32, 1, 1),
                  three = noise(PixelType::float32, 64, 32, 3, 1);
    EXPECT_THROW(job.draw(std::make_unique<MemorySource>(other.read()).get(), {0, 0, 50, 50}, picture.view),
                 Error);
    EXPECT_THROW(job.draw(std::make_unique<MemorySource>(three.read()).get(), {0, 0, 50, 50}, picture.view),
                 Error);
    EXPECT_THROW(job.draw(nullptr, {0, 0, 50, 50}, picture.view), Error);
}

}  // namespace
}  // namespace anamorph::test_reproject
