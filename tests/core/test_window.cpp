// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "anamorph/image/pixel.h"
#include "remote_source.h"

namespace anamorph::test_window {
namespace {

using test::Remote;

/// Random bytes as pixels; `padding` bytes between rows.
struct Picture {
    Picture(int width, int height, int channels, PixelType type, int padding = 0, int alpha = -1)
        : stride(width * channels * size_of(type) + padding),
          size(static_cast<std::size_t>(stride * height)),
          bytes(new std::byte[size]),
          view(packed_view<const std::byte>(bytes.get(), type, width, height, channels)) {
        view.row_stride = stride;
        std::mt19937 random(3);
        for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(random() & 0xff);
        source = std::make_unique<MemorySource>(view, alpha);
    }
    int stride;
    std::size_t size;
    // Exactly as many bytes as the image has, for the address sanitizer.
    std::unique_ptr<std::byte[]> bytes;
    ConstImageView view;
    std::unique_ptr<MemorySource> source;
};

void expect_equals_resolve(const Window& window, const Picture& picture, const Border& border, int piece) {
    const std::size_t pixel = static_cast<std::size_t>(picture.view.channels * size_of(picture.view.type));
    const std::vector<std::byte> black(pixel);
    for (int y = window.box.y0; y < window.box.y1; ++y)
        for (int x = window.box.x0; x < window.box.x1; ++x) {
            const Texel texel = border.resolve(x, y, piece, picture.source->size(0));
            const std::byte* expected = texel.none ? black.data() : picture.view.at(texel.x, texel.y);
            const std::byte* found = window.texels + (y - window.box.y0) * window.row_stride +
                                     (x - window.box.x0) * static_cast<std::ptrdiff_t>(pixel);
            ASSERT_EQ(std::memcmp(found, expected, pixel), 0) << x << ' ' << y;
        }
}

/// The promise of kSlack: the bytes can be read, which the address sanitizer checks.
unsigned touch_slack(const Window& window) {
    unsigned sum = 0;
    const std::ptrdiff_t end = window.box.width() * std::ptrdiff_t{window.channels} * size_of(window.type);
    for (int y = 0; y < window.box.height(); ++y)
        for (std::ptrdiff_t i = 0; i < Window::kSlack; ++i)
            sum += std::to_integer<unsigned>(window.texels[y * window.row_stride + end + i]);
    return sum;
}

struct Case {
    Projection projection;
    int width, height;
};
constexpr Case kCases[] = {{Projection::equirectangular, 48, 24}, {Projection::cylindrical, 40, 21},
                           {Projection::rectilinear, 30, 26},     {Projection::cubemap, 16, 96},
                           {Projection::cubemap3x2, 48, 32},      {Projection::cubecross, 64, 48}};

TEST(Window, EqualsResolvePerTexelOverAllEdgesAndDirectEqualsCopied) {
    constexpr unsigned kSeed = 17;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    const auto between = [&](int low, int high) { return std::uniform_int_distribution(low, high)(random); };
    for (const Case& c : kCases)
        for (const PixelSpacing spacing : {PixelSpacing::edges, PixelSpacing::centers})
            for (const Wrap wrap : {Wrap::automatic, Wrap::black, Wrap::clamp, Wrap::periodic, Wrap::mirror})
                for (const PixelType type : {PixelType::uint8, PixelType::half, PixelType::float32}) {
                    const Picture picture(c.width, c.height, between(1, 5), type, between(0, 1) * 8);
                    const Remote remote(*picture.source);
                    const Chart chart(c.projection, c.width, c.height, 0, spacing);
                    const Border border(chart, wrap);
                    WindowReader near(*picture.source, border), far(remote, border);
                    for (int i = 0; i < 12; ++i) {
                        const int piece = between(0, static_cast<int>(chart.pieces().size()) - 1);
                        const Box own = border.interior(piece, picture.source->size(0));
                        const int x = between(own.x0 - 20, own.x1 + 10),
                                  y = between(own.y0 - 20, own.y1 + 10);
                        const Box box{x, y, x + between(1, 30), y + between(1, 30)};
                        Window window;
                        for (WindowReader* reader : {&near, &far}) {
                            ASSERT_TRUE(reader->get(0, piece, box, window));
                            ASSERT_EQ(window.box, box);
                            ASSERT_EQ(window.type, type);
                            expect_equals_resolve(window, picture, border, piece);
                            touch_slack(window);
                            if (HasFatalFailure()) return;
                        }
                    }
                }
}

TEST(Window, PointsIntoMemoryWhereItMay) {
    const Picture picture(64, 32, 3, PixelType::float32);
    const Chart chart(Projection::equirectangular, 64, 32);
    const Border border(chart, Wrap::automatic);
    WindowReader reader(*picture.source, border);
    Window window;
    const auto direct = [&](const Box& box) {
        EXPECT_TRUE(reader.get(0, 0, box, window));
        touch_slack(window);
        expect_equals_resolve(window, picture, border, 0);
        return window.texels == picture.view.at(box.x0, box.y0) &&
               window.row_stride == picture.view.row_stride;
    };
    EXPECT_TRUE(direct({0, 0, 64, 31}));
    EXPECT_TRUE(direct({5, 5, 20, 20}));
    EXPECT_TRUE(direct({5, 5, 58, 32}));
    EXPECT_FALSE(direct({5, 5, 59, 32}));
    EXPECT_FALSE(direct({0, 0, 64, 32}));
    EXPECT_FALSE(direct({-1, 0, 20, 20}));
}

TEST(Window, NegativeStridesAndGapsAreUnderstood) {
    const Picture picture(20, 18, 4, PixelType::uint8);
    const Chart chart(Projection::rectilinear, 20, 18);
    const Border border(chart, Wrap::automatic);
    // Upside down, and every other pixel.
    ConstImageView flipped = picture.view;
    flipped.data = picture.view.at(0, 17);
    flipped.row_stride = -picture.view.row_stride;
    ConstImageView sparse = picture.view;
    sparse.width = 10;
    sparse.pixel_stride *= 2;
    for (const ConstImageView& view : {flipped, sparse}) {
        const MemorySource source(view);
        WindowReader reader(source, border);
        for (const Box box :
             {Box{0, 0, 10, 18}, Box{2, 3, 6, 9}, Box{3, 0, 10, 1}, Box{0, 17, 5, 18}, Box{-2, -2, 12, 20}}) {
            Window window;
            ASSERT_TRUE(reader.get(0, 0, box, window));
            touch_slack(window);
            for (int y = box.y0; y < box.y1; ++y)
                for (int x = box.x0; x < box.x1; ++x) {
                    const bool inside = x >= 0 && y >= 0 && x < view.width && y < view.height;
                    const std::byte black[4] = {};
                    ASSERT_EQ(std::memcmp(window.texels + (y - box.y0) * window.row_stride + (x - box.x0) * 4,
                                          inside ? view.at(x, y) : black, 4),
                              0);
                }
        }
    }
}

TEST(Window, ReadsFewRectangles) {
    const Picture picture(256, 128, 3, PixelType::half);
    const Remote remote(*picture.source);
    const Border border(Chart(Projection::equirectangular, 256, 128), Wrap::automatic);
    WindowReader reader(remote, border);
    Window window;
    ASSERT_TRUE(reader.get(0, 0, {10, 10, 90, 90}, window));
    EXPECT_EQ(remote.reads, 1);
    // Both sides of the seam.
    remote.reads = 0;
    ASSERT_TRUE(reader.get(0, 0, {-20, 10, 40, 90}, window));
    EXPECT_EQ(remote.reads, 2);
    expect_equals_resolve(window, picture, border, 0);
    // Over the pole rows run backwards.
    remote.reads = 0;
    ASSERT_TRUE(reader.get(0, 0, {10, -4, 40, 20}, window));
    EXPECT_EQ(remote.reads, 5);
    expect_equals_resolve(window, picture, border, 0);
}

TEST(Window, UnassociatedAlphaIsMultipliedIn) {
    const Picture picture(20, 18, 3, PixelType::uint16, 0, 1);
    const Border border(Chart(Projection::rectilinear, 20, 18), Wrap::automatic);
    WindowReader reader(*picture.source, border);
    Window window;
    ASSERT_TRUE(reader.get(0, 0, {-1, 4, 8, 9}, window));
    ASSERT_EQ(window.type, PixelType::float32);
    touch_slack(window);
    for (int y = 4; y < 9; ++y)
        for (int x = -1; x < 8; ++x) {
            float expected[3] = {}, found[3];
            if (x >= 0) load_channels(picture.view.at(x, y), PixelType::uint16, 3, expected);
            std::memcpy(found, window.texels + (y - 4) * window.row_stride + (x + 1) * 12, 12);
            EXPECT_EQ(found[1], expected[1]);
            EXPECT_EQ(found[0], expected[0] * expected[1]);
            EXPECT_EQ(found[2], expected[2] * expected[1]);
        }
}

TEST(Window, BoxesWhollyBeyondASeamAreReadWhereTheirTexelsStand) {
    const Picture picture(48, 24, 3, PixelType::uint16);
    const Border sphere(Chart(Projection::equirectangular, 48, 24), Wrap::automatic);
    WindowReader direct(*picture.source, sphere);
    Remote remote(*picture.source);
    WindowReader copying(remote, sphere);
    const auto equal = [&](const Box& box, bool in_place) {
        SCOPED_TRACE(testing::Message() << box.x0 << ' ' << box.y0 << ' ' << box.x1 << ' ' << box.y1);
        Window window, copied;
        EXPECT_EQ(direct.get_in_place(0, 0, box, window), in_place);
        ASSERT_TRUE(direct.get(0, 0, box, window));
        EXPECT_EQ(window.box, box);
        expect_equals_resolve(window, picture, sphere, 0);
        touch_slack(window);
        ASSERT_TRUE(copying.get(0, 0, box, copied));
        expect_equals_resolve(copied, picture, sphere, 0);
    };
    for (const int turns : {-3, -1, 0, 1, 2}) {
        const int to = 48 * turns;
        equal({to + 7, 5, to + 19, 16}, true);
        equal({to, 0, to + 48, 20}, true);
        // Across the seam, over either pole, and with no slack behind the last row.
        equal({to + 40, 5, to + 52, 9}, false);
        equal({to + 5, -6, to + 12, -2}, false);
        equal({to + 5, -2, to + 12, 3}, false);
        equal({to + 5, 22, to + 12, 26}, false);
        equal({to + 40, 20, to + 48, 24}, false);
    }
    Window window;
    ASSERT_TRUE(direct.get(0, 0, {48 + 7, 5, 48 + 19, 16}, window));
    EXPECT_EQ(window.texels, picture.view.at(7, 5));

    // Both ways round, and numbers that ints just hold.
    const Border tiles(Chart(Projection::rectilinear, 48, 24), Wrap::periodic);
    WindowReader tiled(*picture.source, tiles);
    constexpr int kLeast = std::numeric_limits<int>::min(), kMost = std::numeric_limits<int>::max();
    ASSERT_TRUE(tiled.get_in_place(0, 0, {7 - 96, 5 + 72, 19 - 96, 16 + 72}, window));
    expect_equals_resolve(window, picture, tiles, 0);
    EXPECT_EQ(window.texels, picture.view.at(7, 5));
    ASSERT_TRUE(tiled.get(0, 0, {kMost - 2, kLeast, kMost, kLeast + 2}, window));
    expect_equals_resolve(window, picture, tiles, 0);
    EXPECT_FALSE(tiled.get(0, 0, {kLeast, kLeast, kMost, kMost}, window));
}

TEST(Window, WhatCannotBeHadIsRefused) {
    const Picture picture(20, 18, 1, PixelType::float32);
    Remote remote(*picture.source);
    const Border border(Chart(Projection::rectilinear, 20, 18), Wrap::clamp);
    WindowReader reader(remote, border);
    Window window;
    EXPECT_FALSE(reader.get(0, 0, {5, 5, 5, 9}, window));
    EXPECT_FALSE(reader.get(0, 0, {5, 9, 7, 5}, window));
    EXPECT_FALSE(reader.get(0, 0, {0, 0, 1 << 13, 1 << 12}, window));
    constexpr int kLeast = std::numeric_limits<int>::min(), kMost = std::numeric_limits<int>::max();
    EXPECT_FALSE(reader.get(0, 0, {kLeast, kLeast, kMost, kMost}, window));
    ASSERT_TRUE(reader.get(0, 0, {kMost - 2, kLeast, kMost, kLeast + 2}, window));
    expect_equals_resolve(window, picture, border, 0);
    remote.fails = true;
    EXPECT_FALSE(reader.get(0, 0, {5, 5, 9, 9}, window));
    EXPECT_FALSE(reader.get(0, 0, {-5, -5, -2, -2}, window));
}

}  // namespace
}  // namespace anamorph::test_window
