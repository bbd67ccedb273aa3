// SPDX-License-Identifier: Apache-2.0
#include "anamorph/morph/morph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <thread>

#include "anamorph/parameter/parameter.h"

namespace anamorph::test_morph {
namespace {

/// A packed picture and its source.
template <class T>
struct Picture {
    Picture(int w, int h, int c, PixelType pixel_type)
        : width(w),
          height(h),
          channels(c),
          type(pixel_type),
          pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h * c)) {}
    ConstImageView source() const {
        return packed_view(reinterpret_cast<const std::byte*>(pixels.data()), type, width, height, channels);
    }
    ImageView view() {
        return packed_view(reinterpret_cast<std::byte*>(pixels.data()), type, width, height, channels);
    }
    T& at(int x, int y, int c) { return pixels[static_cast<std::size_t>((y * width + x) * channels + c)]; }
    int width, height, channels;
    PixelType type;
    std::vector<T> pixels;
};
using FloatPicture = Picture<float>;
using BytePicture = Picture<std::uint8_t>;

FloatPicture noise(int w, int h, int c, unsigned seed) {
    FloatPicture p(w, h, c, PixelType::float32);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(0, 1);
    for (float& v : p.pixels) v = value(random);
    return p;
}

std::shared_ptr<const Features> face(double scale_b = 1) {
    auto features = std::make_shared<Features>();
    const auto add = [&](Line a, Line b) {
        for (Point<double>* p : {&b.p, &b.q}) *p = {p->x * scale_b, p->y * scale_b};
        features->add_line({a, b});
    };
    add({{40, 40}, {80, 38}}, {{44, 50}, {82, 44}});
    add({{110, 38}, {150, 42}}, {{108, 46}, {146, 52}});
    add({{60, 110}, {130, 112}}, {{66, 100}, {124, 106}});
    add({{95, 55}, {96, 90}}, {{95, 60}, {93, 88}});
    return features;
}

constexpr int kWidth = 190, kHeight = 150;
constexpr Size kSize{kWidth, kHeight};

FloatPicture draw(const anamorph::Picture& morph, const std::vector<const Source*>& sources, int channels,
                  const Box& box = {0, 0, kWidth, kHeight}, const ParallelFor& parallel_for = serial_for) {
    FloatPicture p(box.width(), box.height(), channels, PixelType::float32);
    EXPECT_TRUE(morph.draw(sources, box, p.view(), parallel_for));
    return p;
}

void threads(std::int64_t count, const std::function<void(std::int64_t)>& body) {
    std::vector<std::thread> pool;
    for (int t = 0; t < 3; ++t)
        pool.emplace_back([&, t] {
            for (std::int64_t i = count - 1 - t; i >= 0; i -= 3) body(i);
        });
    for (std::thread& t : pool) t.join();
}

TEST(Morph, AtItsEndsItIsThePicturesToTheBit) {
    FloatPicture a = noise(kWidth, kHeight, 3, 1), b = noise(kWidth, kHeight, 3, 2);
    // The other picture is not read: what it holds does not matter.
    for (int end = 0; end < 2; ++end) {
        FloatPicture &kept = end ? b : a, poison = noise(kWidth, kHeight, 3, 3);
        std::fill(poison.pixels.begin(), poison.pixels.end(), NAN);
        const MemorySource sa(end ? poison.source() : kept.source()),
            sb(end ? kept.source() : poison.source());
        for (const Filter filter :
             {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic, Filter::antialias})
            for (const MorphScheme scheme : {MorphScheme::automatic, MorphScheme::exact}) {
                MorphOptions options;
                options.t = end;
                options.tol = 0;
                options.filter = filter;
                options.scheme = scheme;
                const auto morph = morphed_picture(face(), {kSize, kSize}, kSize, options);
                EXPECT_EQ(draw(morph, {&sa, &sb}, 3).pixels, kept.pixels);
                EXPECT_TRUE(morph.reads(0) == (end == 0) && morph.reads(1) == (end == 1));
            }
    }
}

TEST(Morph, AShapeAndTheOthersColour) {
    const FloatPicture a = noise(kWidth, kHeight, 3, 1), b = noise(kWidth, kHeight, 3, 2);
    const MemorySource sa(a.source()), sb(b.source());
    MorphOptions options;
    options.t = 0.4;
    options.t_color = 1;
    options.filter = Filter::bilinear;
    const auto morph = morphed_picture(face(), {kSize, kSize}, kSize, options);
    EXPECT_TRUE(!morph.reads(0) && morph.reads(1));
    options.t_color.reset();
    options.picture = 1;
    const auto warp = morphed_picture(face(), {kSize, kSize}, kSize, options);
    EXPECT_EQ(draw(morph, {nullptr, &sb}, 3).pixels, draw(warp, {&sa, &sb}, 3).pixels);
}

TEST(Morph, BlendsTheTwoWarps) {
    const FloatPicture a = noise(kWidth, kHeight, 3, 4), b = noise(kWidth, kHeight, 3, 5);
    const MemorySource sa(a.source()), sb(b.source());
    MorphOptions options;
    options.t = 0.5;
    options.t_color = 0.25;
    options.tol = 0;
    options.filter = Filter::bilinear;
    const auto drawn = [&](std::optional<int> picture) {
        options.picture = picture;
        return draw(morphed_picture(face(), {kSize, kSize}, kSize, options), {&sa, &sb}, 3);
    };
    const FloatPicture morph = drawn({}), wa = drawn(0), wb = drawn(1);
    for (std::size_t i = 0; i < morph.pixels.size(); ++i)
        ASSERT_NEAR(morph.pixels[i], 0.75f * wa.pixels[i] + 0.25f * wb.pixels[i], 1e-6f);
}

TEST(Morph, BitsDependOnNeitherCropNorThreads) {
    const FloatPicture a = noise(kWidth, kHeight, 3, 6), b = noise(kWidth, kHeight, 3, 7);
    const MemorySource sa(a.source()), sb(b.source());
    for (const MorphScheme scheme : {MorphScheme::automatic, MorphScheme::exact})
        for (const char* shown : {"color", "stmap", "lines"}) {
            SCOPED_TRACE(shown);
            MorphOptions options;
            options.scheme = scheme;
            options.lines = shown == std::string("lines");
            if (shown == std::string("stmap")) {
                options.output = Output::stmap;
                options.picture = 1;
            }
            options.tol = 0.02;
            const int channels = options.picture ? 2 : 3;
            const auto morph = morphed_picture(face(), {kSize, kSize}, kSize, options);
            const FloatPicture whole = draw(morph, {&sa, &sb}, channels);
            const auto again = morphed_picture(face(), {kSize, kSize}, kSize, options);
            EXPECT_EQ(whole.pixels,
                      draw(again, {&sa, &sb}, channels, {0, 0, kWidth, kHeight}, threads).pixels);
            for (const Box& box : {Box{17, 23, 18, 24}, Box{100, 60, 163, 131}, Box{-5, -7, 60, 40}}) {
                const auto fresh = morphed_picture(face(), {kSize, kSize}, kSize, options);
                FloatPicture part = draw(fresh, {&sa, &sb}, channels, box);
                for (int y = std::max(0, box.y0); y < box.y1; ++y)
                    for (int x = std::max(0, box.x0); x < box.x1; ++x)
                        for (int c = 0; c < channels; ++c)
                            ASSERT_EQ(
                                part.at(x - box.x0, y - box.y0, c),
                                whole.pixels[static_cast<std::size_t>((y * kWidth + x) * channels + c)]);
            }
        }
}

TEST(Morph, BeyondThePictureThereIsNothing) {
    // As in the last tiles of a file. Memory that was used before is not 0.
    constexpr int kSmall = 70;
    const FloatPicture a = noise(kSmall, kSmall, 1, 8), b = noise(kSmall, kSmall, 1, 9);
    const MemorySource sa(a.source()), sb(b.source());
    const auto morph = morphed_picture(face(), {{kSmall, kSmall}, {kSmall, kSmall}}, {kSmall, kSmall}, {});
    for (int i = 0; i < 4; ++i) {
        std::vector<std::vector<float>> used;
        for (std::size_t size = 1000; size < 20000; size += 1000)
            used.emplace_back(size, std::numeric_limits<float>::quiet_NaN());
        used.clear();
        FloatPicture drawn = draw(morph, {&sa, &sb}, 1, {0, 0, 100, 110});
        for (int y = 0; y < 110; ++y)
            for (int x = 0; x < 100; ++x)
                if (x >= kSmall || y >= kSmall) {
                    ASSERT_EQ(drawn.at(x, y, 0), 0) << x << " " << y;
                }
    }
}

TEST(Morph, PicturesOfAnotherSizeShowTheSame) {
    // B is twice as large and its features too: a morph of a smooth picture with itself.
    const auto smooth = [](int w, int h) {
        FloatPicture p(w, h, 1, PixelType::float32);
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x)
                p.at(x, y, 0) = static_cast<float>((x + 0.5) / w + 0.5 * (y + 0.5) / h);
        return p;
    };
    const FloatPicture a = smooth(kWidth, kHeight), b = smooth(2 * kWidth, 2 * kHeight);
    const MemorySource sa(a.source()), sb(b.source());
    auto features = std::make_shared<Features>();
    features->add_line({{{40, 40}, {80, 45}}, {{40, 40}, {80, 45}}});
    features->set_frame(0, {kWidth, kHeight});
    features->set_frame(1, {kWidth, kHeight});
    MorphOptions options;
    options.filter = Filter::bilinear;
    const auto morph = morphed_picture(features, {kSize, {2 * kWidth, 2 * kHeight}}, kSize, options);
    const FloatPicture m = draw(morph, {&sa, &sb}, 1);
    for (std::size_t i = 0; i < m.pixels.size(); ++i) ASSERT_NEAR(m.pixels[i], a.pixels[i], 2e-5f);
}

TEST(Morph, KeepsTheTypeOfWhatItIsAskedFor) {
    BytePicture a(kWidth, kHeight, 3, PixelType::uint8), b(kWidth, kHeight, 3, PixelType::uint8);
    std::fill(a.pixels.begin(), a.pixels.end(), 200);
    std::fill(b.pixels.begin(), b.pixels.end(), 100);
    const MemorySource sa(a.source()), sb(b.source());
    BytePicture to(kWidth, kHeight, 3, PixelType::uint8);
    const auto morph = morphed_picture(face(), {kSize, kSize}, kSize, {});
    ASSERT_TRUE(morph.draw({&sa, &sb}, {0, 0, kWidth, kHeight}, to.view()));
    for (const std::uint8_t v : to.pixels) ASSERT_EQ(v, 150);
}

TEST(Morph, UnassociatedAlphaWeighsColour) {
    // A is red and opaque, B is green and clear: what is seen half way is red.
    FloatPicture a(kWidth, kHeight, 4, PixelType::float32), b = a;
    for (std::size_t i = 0; i < a.pixels.size(); i += 4) {
        a.pixels[i] = a.pixels[i + 3] = 1;
        b.pixels[i + 1] = 1;
    }
    const MemorySource sa(a.source(), 3), sb(b.source(), 3);
    const FloatPicture m = draw(morphed_picture(face(), {kSize, kSize}, kSize, {}), {&sa, &sb}, 4);
    for (std::size_t i = 0; i < m.pixels.size(); i += 4) {
        ASSERT_NEAR(m.pixels[i], 1, 1e-6);
        ASSERT_NEAR(m.pixels[i + 1], 0, 1e-6);
        ASSERT_NEAR(m.pixels[i + 3], 0.5, 1e-6);
    }
}

TEST(Morph, ThreePicturesMixByTheirWeights) {
    auto features = std::make_shared<Features>(3);
    features->add_line({{{40, 40}, {80, 38}}, {{44, 50}, {82, 44}}, {{30, 45}, {85, 40}}});
    std::vector<FloatPicture> pictures;
    std::vector<MemorySource> sources;
    for (int k = 0; k < 3; ++k) {
        pictures.emplace_back(kWidth, kHeight, 1, PixelType::float32);
        std::fill(pictures.back().pixels.begin(), pictures.back().pixels.end(), static_cast<float>(k));
    }
    for (const FloatPicture& p : pictures) sources.emplace_back(p.source());
    MorphOptions options;
    options.shape_weights = {0.2, 0.3, 0.5};
    const auto morph = morphed_picture(features, {kSize, kSize, kSize}, kSize, options);
    const FloatPicture m = draw(morph, {&sources[0], &sources[1], &sources[2]}, 1);
    for (const float v : m.pixels) ASSERT_NEAR(v, 1.3f, 1e-5f);
    options.shape_weights = {0.2, 0.3, 0.4};
    EXPECT_THROW(morphed_picture(features, {kSize, kSize, kSize}, kSize, options), Error);
    options.shape_weights.clear();
    EXPECT_THROW(morphed_picture(features, {kSize, kSize, kSize}, kSize, options), Error);
}

TEST(Morph, AsManySourcesAreGivenAsThereAreShapes) {
    const FloatPicture a = noise(kWidth, kHeight, 3, 1);
    const MemorySource sa(a.source());
    FloatPicture to(kWidth, kHeight, 3, PixelType::float32);
    MorphOptions options;
    options.t = 0;  // B is not read, but counts
    const auto morph = morphed_picture(face(), {kSize, kSize}, kSize, options);
    const auto message = [&](const std::vector<const Source*>& sources) -> std::string {
        try {
            morph.draw(sources, {0, 0, kWidth, kHeight}, to.view());
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    };
    EXPECT_EQ(message({&sa, nullptr}), "no error");
    EXPECT_EQ(message({&sa}), "pictures=1: must be 2");
    EXPECT_EQ(message({&sa, nullptr, nullptr}), "pictures=3: must be 2");
}

TEST(Morph, BadParametersAreNamed) {
    const auto message = [](MorphOptions options, Size b = kSize) -> std::string {
        try {
            const auto morph = morphed_picture(face(), {kSize, b}, kSize, options);
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    };
    MorphOptions options;
    EXPECT_EQ(message(options), "no error");
    options.tol = -1;
    EXPECT_EQ(message(options), "tol=-1: must be 0 (exact) or a finite number of source pixels above it");
    options = {};
    options.tol = NAN;
    options.scheme = MorphScheme::exact;
    EXPECT_NE(message(options), "no error");
    options = {};
    options.t = NAN;
    EXPECT_EQ(message(options), "t=nan: must be a number from -1e+06 to 1e+06");
    options.t = 1e7;
    EXPECT_EQ(message(options), "t=1e+07: must be a number from -1e+06 to 1e+06");
    options = {};
    options.weight_b = NAN;
    EXPECT_EQ(message(options), "weight_b=nan: must be a number from 0 to 16");
    options = {};
    EXPECT_NE(message(options, {0, 5}), "no error");
    options = {};
    for (const std::vector<double>& weights :
         {std::vector<double>{1.5, 1.5}, {0.25, 0.25, 0.5}, {1}, {NAN, 1}, {-1e7, 1e7 + 1}}) {
        options.shape_weights = weights;
        std::string text;
        for (const double w : weights) text += (text.empty() ? "" : ",") + shortest(w);
        EXPECT_EQ(message(options),
                  "shape_weights=" + text +
                      ": must be 2 numbers from -1e+06 to 1e+06, one for each picture, with sum 1");
    }
    options = {};
    options.weight_b = std::nextafter(16.0, 17.0);
    EXPECT_EQ(message(options), "weight_b=16.000000000000004: must be a number from 0 to 16");
}

}  // namespace
}  // namespace anamorph::test_morph
