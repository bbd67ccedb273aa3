// SPDX-License-Identifier: Apache-2.0
// Images of which a part is cut out, and pictures over each other, against their formulas written out.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "anamorph/image/layered_picture.h"
#include "anamorph/image/masked_source.h"
#include "anamorph/panorama/reproject.h"

namespace anamorph::test_layered_picture {
namespace {

/// Pixels in memory.
struct Image {
    int width, height, channels;
    std::vector<float> values;

    Image(int w, int h, int c)
        : width(w), height(h), channels(c), values(static_cast<std::size_t>(w * h * c)) {}
    float& at(int x, int y, int c) {
        return values[static_cast<std::size_t>((y * width + x) * channels + c)];
    }
    ImageView view() {
        return packed_view(reinterpret_cast<std::byte*>(values.data()), PixelType::float32, width, height,
                           channels);
    }
    ConstImageView view() const {
        return packed_view(reinterpret_cast<const std::byte*>(values.data()), PixelType::float32, width,
                           height, channels);
    }
};

TEST(MaskedSource, CutsWhatLiesBeyondRectangleCircleAndPolygons) {
    std::mt19937 random(38);
    std::uniform_real_distribution<float> value(0.1f, 1.0f);
    Image image(40, 30, 2);
    for (float& v : image.values) v = value(random);
    const Image& fixed = image;
    const MemorySource base(fixed.view());
    SourceMask mask;
    mask.rectangle = Box{3, 2, 38, 29};
    mask.circle = {{{20, 15}, 14.3}};
    // A star, whose middle is outside by the even-odd rule, and a triangle that reaches beyond the image.
    mask.holes = {{{20, 3.2}, {26, 21}, {10.7, 10}, {29.3, 10}, {14, 21}},
                  {{-50, 24.4}, {90, 24.4}, {20, 60}}};
    const auto crosses = [](const std::vector<Point<double>>& polygon, double x, double y) {
        bool inside = false;
        for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
            const auto &a = polygon[i], &b = polygon[j];
            if ((a.y > y) != (b.y > y) && x < (b.x - a.x) * (y - a.y) / (b.y - a.y) + a.x) inside = !inside;
        }
        return inside;
    };
    const MaskedSource masked(base, mask, -1);
    ASSERT_EQ(masked.channels(), 3);
    ASSERT_EQ(masked.levels(), 1);
    // In parts, as pyramids read it.
    int counted = 0;
    for (const Box& box : {Box{0, 0, 17, 30}, Box{17, 0, 40, 11}, Box{17, 11, 40, 30}}) {
        Image part(box.width(), box.height(), 3);
        ASSERT_TRUE(masked.read(0, box, part.view().data, part.view().row_stride));
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x) {
                const double px = x + 0.5, py = y + 0.5;
                const bool counts = x >= 3 && x < 38 && y >= 2 && y < 29 &&
                                    std::hypot(px - 20, py - 15) <= 14.3 && !crosses(mask.holes[0], px, py) &&
                                    !crosses(mask.holes[1], px, py);
                counted += counts;
                for (int c = 0; c < 2; ++c)
                    ASSERT_EQ(part.at(x - box.x0, y - box.y0, c), counts ? image.at(x, y, c) : 0)
                        << x << " " << y;
                ASSERT_EQ(part.at(x - box.x0, y - box.y0, 2), counts ? 1 : 0) << x << " " << y;
            }
    }
    EXPECT_GT(counted, 200);
    // With alpha of its own the channels stay.
    const MaskedSource with_alpha(base, mask, 1);
    EXPECT_EQ(with_alpha.channels(), 2);
    Image whole(40, 30, 2);
    ASSERT_TRUE(with_alpha.read(0, {0, 0, 40, 30}, whole.view().data, whole.view().row_stride));
    EXPECT_EQ(whole.at(20, 1, 1), 0);
    EXPECT_EQ(whole.at(20, 23, 1), image.at(20, 23, 1));
}

/// Three pictures of random colours and alpha, each drawn as it stands.
class Layers : public testing::Test {
  protected:
    static constexpr int kWide = 24, kHigh = 17;

    Layers() : m_images(3, Image(kWide, kHigh, 4)) {
        std::mt19937 random(381);
        std::uniform_real_distribution<float> value(0.0f, 1.0f);
        for (Image& image : m_images)
            for (int i = 0; i < kWide * kHigh; ++i) {
                const float alpha = i % 3 == 0 ? 0 : i % 3 == 1 ? 1 : value(random);
                for (int c = 0; c < 3; ++c) image.at(i % kWide, i / kWide, c) = alpha * value(random);
                image.at(i % kWide, i / kWide, 3) = alpha;
            }
    }
    LayeredPicture picture(Layering layering, bool weighted, const Size& size = {kWide, kHigh}) const {
        LayeredPicture picture;
        picture.layering = layering;
        picture.alpha = 3;
        const Chart chart(Projection::rectilinear, kWide, kHigh, 60),
            target(Projection::rectilinear, size.width, size.height, 60);
        ReprojectOptions options;
        options.filter = Filter::nearest;
        for (int i = 0; i < 3; ++i) {
            PictureLayer layer{reprojected_picture(Panorama(chart, target), options)};
            layer.picture.maps.front().layers.front().source = i;
            if (weighted)
                layer.weights = [i](const Box& box, float* to, const ParallelFor&) {
                    for (int y = box.y0; y < box.y1; ++y)
                        for (int x = box.x0; x < box.x1; ++x) *to++ = weight(x, y, i);
                };
            picture.layers.push_back(std::move(layer));
        }
        return picture;
    }
    static float weight(int x, int y, int i) {
        return static_cast<float>(1 + (x * 3 + y * 5 + i * 7) % 8) / 8;
    }

    Image drawn(const LayeredPicture& picture, const Box& box, int channels) const {
        std::vector<MemorySource> sources;
        for (const Image& image : m_images) sources.emplace_back(image.view(), m_unassociated);
        Image to(box.width(), box.height(), channels);
        EXPECT_TRUE(picture.draw({&sources[0], &sources[1], &sources[2]}, box, to.view(), serial_for));
        return to;
    }

    std::vector<Image> m_images;
    int m_unassociated = -1;  ///< the channel of alpha where colours are not multiplied by it
};

TEST_F(Layers, AreMixedAsTheirFormulaSays) {
    for (const Layering layering : {Layering::over, Layering::mean})
        for (const bool weighted : {false, true}) {
            const Image got = drawn(picture(layering, weighted), {0, 0, kWide, kHigh}, 4);
            for (int y = 0; y < kHigh; ++y)
                for (int x = 0; x < kWide; ++x) {
                    double sum[3] = {}, all = 0, through = 1, uncovered = 1;
                    for (int i = 2; i >= 0; --i) {
                        Image image = m_images[static_cast<std::size_t>(i)];
                        const double a = image.at(x, y, 3), g = weighted ? weight(x, y, i) : 1;
                        const double w = layering == Layering::over ? through * g : g;
                        for (int c = 0; c < 3; ++c) sum[c] += w * image.at(x, y, c);
                        all += w * a;
                        through *= 1 - g * a;
                        uncovered *= 1 - a;
                    }
                    Image pixels = got;
                    ASSERT_NEAR(pixels.at(x, y, 3), 1 - uncovered, 1e-6);
                    for (int c = 0; c < 3; ++c)
                        ASSERT_NEAR(pixels.at(x, y, c), all > 0 ? sum[c] * (1 - uncovered) / all : 0, 2e-6)
                            << x << " " << y << " " << weighted;
                }
        }
}

TEST_F(Layers, HaveTheSameBitsInAnyBox) {
    LayeredPicture picture = this->picture(Layering::mean, true);
    const Image whole = drawn(picture, {0, 0, kWide, kHigh}, 4), part = drawn(picture, {5, 3, 20, 16}, 4);
    Image all = whole, some = part;
    for (int y = 3; y < 16; ++y)
        for (int x = 5; x < 20; ++x)
            for (int c = 0; c < 4; ++c) ASSERT_EQ(all.at(x, y, c), some.at(x - 5, y - 3, c));
    Image colors = drawn(picture, {0, 0, kWide, kHigh}, 3);
    picture.shows_alpha = true;
    Image alpha = drawn(picture, {0, 0, kWide, kHigh}, 1);
    for (int y = 0; y < kHigh; ++y)
        for (int x = 0; x < kWide; ++x) {
            ASSERT_EQ(colors.at(x, y, 1), all.at(x, y, 1));
            ASSERT_EQ(alpha.at(x, y, 0), all.at(x, y, 3));
        }
}

// A box of more pixels than are mixed at a time.
TEST_F(Layers, HaveTheSameBitsInALargeBox) {
    constexpr int kLargeWidth = 700, kLargeHeight = 500;
    const LayeredPicture picture = this->picture(Layering::over, true, {kLargeWidth, kLargeHeight});
    const Box middle{13, 360, 690, 390};  // 2^18 pixels end in row 374
    Image all = drawn(picture, {0, 0, kLargeWidth, kLargeHeight}, 4), some = drawn(picture, middle, 4);
    for (int y = middle.y0; y < middle.y1; ++y)
        for (int x = middle.x0; x < middle.x1; ++x)
            for (int c = 0; c < 4; ++c)
                ASSERT_EQ(all.at(x, y, c), some.at(x - middle.x0, y - middle.y0, c)) << x << " " << y;
}

TEST_F(Layers, InfinityBelowIsNotSeen) {
    for (int c = 0; c < 3; ++c) m_images[0].at(1, 0, c) = HUGE_VALF;
    m_images[0].at(1, 0, 3) = 1;
    for (int c = 0; c < 4; ++c) m_images[2].at(1, 0, c) = c == 3 ? 1.0f : 0.25f;
    Image got = drawn(picture(Layering::over, false), {0, 0, kWide, kHigh}, 4);
    EXPECT_EQ(got.at(1, 0, 0), 0.25f);
}

TEST_F(Layers, ColorsThatAreNotMultipliedAreWeighedByAlpha) {
    m_unassociated = 3;
    Image got = drawn(picture(Layering::mean, true), {0, 0, kWide, kHigh}, 4);
    for (int y = 0; y < kHigh; ++y)
        for (int x = 0; x < kWide; ++x) {
            double sum = 0, all = 0;
            for (int i = 0; i < 3; ++i) {
                Image& image = m_images[static_cast<std::size_t>(i)];
                const double by_alpha = double(weight(x, y, i)) * image.at(x, y, 3);
                sum += by_alpha * image.at(x, y, 1);
                all += by_alpha;
            }
            ASSERT_NEAR(got.at(x, y, 1), all > 0 ? sum / all : 0, 2e-6) << x << " " << y;
        }
}

TEST_F(Layers, ColorsAreMultipliedInAllSourcesOrInNone) {
    const LayeredPicture layers = picture(Layering::over, false);
    const MemorySource one(static_cast<const Image&>(m_images[0]).view()),
        other(static_cast<const Image&>(m_images[1]).view(), 3);
    Image to(kWide, kHigh, 4);
    EXPECT_THROW(layers.draw({&one, &other, &one}, {0, 0, kWide, kHigh}, to.view(), serial_for), Error);
}

TEST_F(Layers, AMissingSourceIsAnError) {
    const LayeredPicture layers = picture(Layering::over, false);
    const MemorySource one(static_cast<const Image&>(m_images[0]).view());
    Image to(kWide, kHigh, 4);
    EXPECT_THROW(layers.draw({&one, nullptr, &one}, {0, 0, kWide, kHigh}, to.view(), serial_for), Error);
    EXPECT_THROW(layers.draw({&one}, {0, 0, kWide, kHigh}, to.view(), serial_for), Error);
}

}  // namespace
}  // namespace anamorph::test_layered_picture
