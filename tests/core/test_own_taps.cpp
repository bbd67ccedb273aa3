// SPDX-License-Identifier: Apache-2.0
// Pixels that take taps of their own (image/own_taps.h), against the rule of image/footprint.h written out in long double, and against
// 256 samples a pixel.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "anamorph/image/own_taps.h"
#include "anamorph/image/picture.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/number/half.h"
#include "each_instruction_set.h"
#include "function_map.h"

namespace anamorph::test_own_taps {
namespace {

constexpr unsigned kSeed = 20261129;
constexpr int kSource = 256, kSize = 128;

/// How far apart two taps are that leave white noise as strong as the mean over `length` texels: the tent's autocorrelation is
/// 2/3 - d^2 + |d|^3 / 2, and the mean leaves (1 - 1 / (3 length)) / length.
long double spacing_of(long double length) {
    if (length <= 1) return 0;
    const long double wanted = 2 * (1 - 1 / (3 * length)) / length - 2.0L / 3;
    long double near = 0, far = 1;
    for (int i = 0; i < 70; ++i) {
        const long double d = (near + far) / 2;
        (2.0L / 3 - d * d + d * d * d / 2 > wanted ? near : far) = d;
    }
    return near;
}

struct Side {
    long double x, y;
    long double length() const { return std::sqrt(x * x + y * y); }
    /// From the point to a tap.
    Side tap() const {
        const long double share = length() > 0 ? spacing_of(length()) / (2 * length()) : 0;
        return {x * share, y * share};
    }
};

/// The shorter of the steps to both neighbours of a pixel.
template <class At>
Side side_of(const At& at, int i, int count) {
    const auto step = [&](int k) {
        const auto p = at(k), q = at(k + 1);
        return Side{static_cast<long double>(q.x) - static_cast<long double>(p.x),
                    static_cast<long double>(q.y) - static_cast<long double>(p.y)};
    };
    const Side before = step(i > 0 ? i - 1 : 0), behind = step(i + 1 < count ? i : i - 1);
    return before.length() < behind.length() ? before : behind;
}

TEST(OwnTaps, AreThoseOfTheFootprint) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::on_every_instruction_set([] {
        std::mt19937 random(kSeed);
        constexpr std::ptrdiff_t kStride = simd::kRowRoom;
        for (const auto& [width, height] : {std::pair{2, 2}, {3, 64}, {17, 5}, {64, 64}, {63, 2}}) {
            const auto room = static_cast<std::size_t>(kStride * 64);
            std::vector<float> x(room), y(room);
            for (int j = 0; j < height; ++j)
                for (int i = 0; i < width; ++i) {
                    const auto k = static_cast<std::size_t>(j * kStride + i);
                    const auto jitter = [&] { return static_cast<float>(random() % 1024) / 2048; };
                    // Larger and larger steps.
                    const float zoom = 0.6f + 0.01f * static_cast<float>(i);
                    x[k] = zoom * (1.2f * static_cast<float>(i) + 0.6f * static_cast<float>(j)) + jitter();
                    y[k] = zoom * (-0.4f * static_cast<float>(i) + 1.1f * static_cast<float>(j)) + jitter();
                }
            std::array<std::vector<float>, 4> taps;
            for (auto& t : taps) t.resize(room);
            std::vector<std::int32_t> kinds(room);
            simd::own_taps(
                x.data(), y.data(), kStride, width, height,
                {taps[0].data(), taps[1].data(), taps[2].data(), taps[3].data(), kinds.data(), kStride});
            int counts[4] = {};
            for (int j = 0; j < height; ++j)
                for (int i = 0; i < width; ++i) {
                    const auto at = [&](int column, int row) {
                        const auto k = static_cast<std::size_t>(row * kStride + column);
                        return Point<float>{x[k], y[k]};
                    };
                    const Side a = side_of([&](int k) { return at(k, j); }, i, width),
                               b = side_of([&](int k) { return at(i, k); }, j, height);
                    const auto k = static_cast<std::size_t>(j * kStride + i);
                    const auto kind = static_cast<simd::OwnKind>(kinds[k]);
                    ++counts[kinds[k]];
                    const long double longest = std::max(a.length(), b.length());
                    // Rounding may decide what stands on a limit.
                    if (longest > 2.00001L) {
                        EXPECT_EQ(kind, simd::OwnKind::others);
                    }
                    if (longest < 1.99999L) {
                        EXPECT_NE(kind, simd::OwnKind::others);
                    }
                    if (longest < 0.99999L) {
                        EXPECT_EQ(kind, simd::OwnKind::one);
                    }
                    if (kind == simd::OwnKind::others) continue;
                    const Side p = a.tap(), q = b.tap();
                    EXPECT_NEAR(taps[0][k], p.x, 1e-4);
                    EXPECT_NEAR(taps[1][k], p.y, 1e-4);
                    EXPECT_NEAR(taps[2][k], q.x, 1e-4);
                    EXPECT_NEAR(taps[3][k], q.y, 1e-4);
                    const long double reach =
                        std::max(std::fabs(p.x) + std::fabs(q.x), std::fabs(p.y) + std::fabs(q.y));
                    if (longest > 1.00001L && reach < 0.4998L) {
                        EXPECT_EQ(kind, simd::OwnKind::nine);
                    }
                    if (longest > 1.00001L && reach > 0.5002L) {
                        EXPECT_EQ(kind, simd::OwnKind::four);
                    }
                }
            if (width == 64) {
                for (const int count : counts) EXPECT_GT(count, 0);
            }
        }
    });
}

TEST(OwnTaps, PixelsBesideWhatIsNoNumberHaveNone) {
    constexpr std::ptrdiff_t kStride = simd::kRowRoom;
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        std::vector<float> x(kStride * 8), y(x), taps[4] = {x, x, x, x};
        for (int j = 0; j < 8; ++j)
            for (int i = 0; i < 8; ++i) {
                x[static_cast<std::size_t>(j * kStride + i)] = static_cast<float>(i);
                y[static_cast<std::size_t>(j * kStride + i)] = static_cast<float>(j);
            }
        x[3 * kStride + 3] = bad;
        std::vector<std::int32_t> kinds(x.size());
        simd::own_taps(
            x.data(), y.data(), kStride, 8, 8,
            {taps[0].data(), taps[1].data(), taps[2].data(), taps[3].data(), kinds.data(), kStride});
        EXPECT_EQ(kinds[3 * kStride + 3], static_cast<std::int32_t>(simd::OwnKind::others));
        EXPECT_EQ(kinds[6 * kStride + 6], static_cast<std::int32_t>(simd::OwnKind::one));
    }
}

struct NamedMap {
    const char* name;
    test::FunctionMap::Function function;
    /// The root mean square and the largest difference from 256 samples of white noise that pixels had where cells of a block shared
    /// their footprints, to within a quarter of their sides or half a source pixel; and of the smooth picture.
    double noise, smooth;
};

/// Magnification, minification, turns, skews, folds and seams.
std::vector<NamedMap> maps() {
    const auto wave = [](double zoom, double amount, double k) {
        return [=](double x, double y) {
            return Point<double>{
                kSource / 2 + zoom * (x - kSize / 2) + amount * std::sin(k * y + 0.3 * std::sin(k * x)),
                kSource / 2 + zoom * (y - kSize / 2) + amount * std::cos(k * x)};
        };
    };
    return {
        {"magnified", wave(0.6, 3, 0.05), 0.062629, 0.004867},
        {"about one", wave(1, 4, 0.06), 0.01369, 0.00018},
        {"1.3", wave(1.3, 3, 0.1), 0.02018, 0.001857},
        {"1.6", wave(1.6, 6, 0.12), 0.015702, 0.001281},
        {"1.9", wave(1.9, 5, 0.1), 0.009967, 0.000517},
        {"4",
         [](double x, double y) {
             return Point<double>{128 + 4 * (x - 64), 128 + 4 * (y - 64) + std::sin(x)};
         },
         0.027636, 0.002741},
        {"64",
         [](double x, double y) {
             return Point<double>{128 + 64 * (x - 64), 128 + 64 * (y - 64)};
         },
         0.016214, 0.00159},
        {"20 to 1",
         [](double x, double y) {
             return Point<double>{128 + 2 * (x - 64), 128 + 0.1 * (y - 64)};
         },
         0.083412, 0.011728},
        {"fold",
         [](double x, double y) {
             return Point<double>{60 + 1.4 * std::fabs(x - 64 + 0.3 * y), 30 + 1.5 * y};
         },
         0.017647, 0.002639},
        {"seam",
         [](double x, double y) {
             return Point<double>{30 + 1.2 * x + (x + 0.2 * y > 75 ? 40 : 0), 30 + 1.4 * y};
         },
         0.018964, 0.005754},
        {"turned",
         [](double x, double y) {
             const double u = 1.06 * (x - 64), v = 1.06 * (y - 64);
             return Point<double>{128 + u - v + 4 * std::sin(0.1 * x), 128 + u + v + 4 * std::sin(0.1 * y)};
         },
         0.025813, 0.000412},
        {"skewed",
         [](double x, double y) {
             const double u = x - 64, v = y - 64;
             return Point<double>{128 + 1.2 * u + v + 3 * std::sin(0.1 * y),
                                  128 + 1.3 * v + 3 * std::sin(0.12 * x)};
         },
         0.02729, 0.001795},
    };
}

/// A source of one type in memory, as values from 0 to 1.
struct Texels {
    PixelType type;
    std::vector<std::byte> bytes;

    Texels(PixelType t, bool smooth) : type(t) {
        bytes.resize(std::size_t{kSource} * kSource * 3 * static_cast<std::size_t>(size_of(type)));
        std::mt19937 random(kSeed);
        for (int y = 0; y < kSource; ++y)
            for (int x = 0; x < kSource; ++x)
                for (int c = 0; c < 3; ++c)
                    put(x, y, c,
                        smooth ? 0.5 + 0.3 * std::sin(0.02 * x) + 0.2 * std::sin(0.3 * y + c)
                               : static_cast<double>(random()) / 4294967295.0);
    }
    std::byte* at(int x, int y, int c) { return bytes.data() + ((y * kSource + x) * 3 + c) * size_of(type); }
    void put(int x, int y, int c, double v) {
        if (type == PixelType::float32) {
            const auto f = static_cast<float>(v);
            std::memcpy(at(x, y, c), &f, sizeof f);
        } else if (type == PixelType::uint8) {
            *at(x, y, c) = static_cast<std::byte>(std::lround(255 * v));
        } else {
            const auto word = type == PixelType::half ? half_from_float(static_cast<float>(v))
                                                      : static_cast<std::uint16_t>(std::lround(65535 * v));
            std::memcpy(at(x, y, c), &word, sizeof word);
        }
    }
    double operator()(int x, int y, int c) {
        if (x < 0 || y < 0 || x >= kSource || y >= kSource) return 0;
        if (type == PixelType::uint8) return static_cast<double>(*at(x, y, c)) / 255;
        if (type == PixelType::float32) {
            float f;
            std::memcpy(&f, at(x, y, c), sizeof f);
            return static_cast<double>(f);
        }
        std::uint16_t word;
        std::memcpy(&word, at(x, y, c), sizeof word);
        return type == PixelType::half ? static_cast<double>(float_from_half(word)) : word / 65535.0;
    }
    ConstImageView view() const {
        return packed_view(static_cast<const std::byte*>(bytes.data()), type, kSource, kSource, 3);
    }
};

Picture picture_of(const NamedMap& map) {
    return picture_through(
        std::make_shared<test::FunctionMap>(kSize, kSize, Block::Kind::computed, map.function),
        Border(Chart(Projection::rectilinear, kSource, kSource), Wrap::automatic), Filter::antialias,
        Output::color);
}

/// Draws to floats.
std::vector<float> drawn(const Picture& picture, const Texels& texels, const Box& box) {
    const MemorySource memory(texels.view());
    const Pyramid pyramid(memory);
    const Source* const source = &pyramid;
    std::vector<float> values(static_cast<std::size_t>(box.width() * box.height() * 3));
    EXPECT_TRUE(picture.draw(source, box,
                             packed_view(reinterpret_cast<std::byte*>(values.data()), PixelType::float32,
                                         box.width(), box.height(), 3)));
    return values;
}

TEST(OwnTaps, PixelsAreTheMeansOfTheirOwnTaps) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    for (const PixelType type : {PixelType::uint8, PixelType::uint16, PixelType::half, PixelType::float32}) {
        Texels texels(type, false);
        for (const NamedMap& map : maps()) {
            const Picture picture = picture_of(map);
            const std::vector<float> values = drawn(picture, texels, {0, 0, kSize, kSize});
            int own = 0;
            for (std::int64_t region = 0; region < picture.maps[0].blocks->regions(); ++region)
                for (const Block& block : picture.maps[0].blocks->blocks(region)) {
                    const Box& b = block.box;
                    const auto at = [&](int x, int y) { return map.function(x + 0.5, y + 0.5); };
                    // A block whose pixels are alike takes the footprint in its middle for all of them, and parts of one that has
                    // larger footprints may share one.
                    const auto sides = [&](int x, int y) {
                        return std::pair(
                            side_of([&](int k) { return at(b.x0 + k, y); }, x - b.x0, b.width()),
                            side_of([&](int k) { return at(x, b.y0 + k); }, y - b.y0, b.height()));
                    };
                    bool differ = false, large = false;
                    const auto [a0, b0] = sides((b.x0 + b.x1) / 2, (b.y0 + b.y1) / 2);
                    for (int y = b.y0; y < b.y1; ++y)
                        for (int x = b.x0; x < b.x1; ++x) {
                            const auto [p, q] = sides(x, y);
                            differ |= std::hypot(p.x - a0.x, p.y - a0.y) > 0.55L ||
                                      std::hypot(q.x - b0.x, q.y - b0.y) > 0.55L;
                            large |= !(p.length() < 1.9999L && q.length() < 1.9999L);
                        }
                    if (!differ || large) continue;
                    for (int y = b.y0; y < b.y1; ++y)
                        for (int x = b.x0; x < b.x1; ++x) {
                            const auto [p, q] = sides(x, y);
                            ++own;
                            const Side u = p.tap(), v = q.tap();
                            const Point<double> point = at(x, y);
                            long double wanted = 0;
                            for (int k = 0; k < 4; ++k) {
                                const int s = k & 1 ? 1 : -1, t = k & 2 ? 1 : -1;
                                const long double tx = point.x + s * u.x + t * v.x - 0.5L,
                                                  ty = point.y + s * u.y + t * v.y - 0.5L;
                                const auto ix = static_cast<int>(std::floor(tx)),
                                           iy = static_cast<int>(std::floor(ty));
                                for (int n = 0; n < 4; ++n)
                                    wanted +=
                                        (n & 1 ? tx - ix : 1 - tx + ix) * (n & 2 ? ty - iy : 1 - ty + iy) *
                                        static_cast<long double>(texels(ix + (n & 1), iy + (n >> 1), 0)) / 4;
                            }
                            // Half of 1.2e-4 texels for each tap and axis, and points in float.
                            EXPECT_NEAR(values[static_cast<std::size_t>((y * kSize + x) * 3)], wanted, 4e-4)
                                << map.name << ' ' << x << ' ' << y;
                        }
                }
            const std::string name = map.name;
            if (name == "1.6" || name == "fold" || name == "turned") {
                EXPECT_GT(own, 1000) << name;
            }
        }
    }
}

/// The root mean square of what pixels differ by from 256 samples of the texels that they show, where all of these are in the source.
double off_samples(const NamedMap& map, bool smooth) {
    Texels texels(PixelType::float32, smooth);
    const std::vector<float> values = drawn(picture_of(map), texels, {0, 0, kSize, kSize});
    double sum = 0;
    int count = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            double mean = 0;
            bool inside = true;
            for (int k = 0; k < 256 && inside; ++k) {
                const Point<double> p = map.function(x + (k % 16 + 0.5) / 16, y + (k / 16 + 0.5) / 16);
                inside = p.x > 3 && p.y > 3 && p.x < kSource - 3 && p.y < kSource - 3;
                if (inside) mean += texels(static_cast<int>(p.x), static_cast<int>(p.y), 0) / 256;
            }
            if (!inside) continue;
            const double off =
                static_cast<double>(values[static_cast<std::size_t>((y * kSize + x) * 3)]) - mean;
            sum += off * off;
            ++count;
        }
    return std::sqrt(sum / std::max(count, 1));
}

// How far off pixels were before they took taps of their own is written beside the maps.
TEST(OwnTaps, AreNoFartherFrom256SamplesThanSharedOnes) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    for (const NamedMap& map : maps()) {
        const double noise = off_samples(map, false), smooth = off_samples(map, true);
        // The last digit that is written there, and taps to 1.2e-4 texels, may add that.
        EXPECT_LE(noise, map.noise + 2e-5) << map.name;
        EXPECT_LE(smooth, map.smooth + 2e-5) << map.name;
    }
}

TEST(OwnTaps, PartsHaveTheBitsOfTheWhole) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    for (const PixelType type : {PixelType::uint8, PixelType::float32}) {
        const Texels texels(type, false);
        for (const NamedMap& map : maps()) {
            const Picture picture = picture_of(map);
            const std::vector<float> whole = drawn(picture, texels, {0, 0, kSize, kSize});
            for (int round = 0; round < 12; ++round) {
                const auto from = [&] { return static_cast<int>(random() % kSize); };
                const int x = from(), y = from();
                // Thin ones too.
                const int width = round % 3 == 0 ? 1 : kSize - x, height = round % 3 == 1 ? 1 : kSize - y;
                const std::vector<float> part = drawn(picture, texels, {x, y, x + width, y + height});
                for (int j = 0; j < height; ++j)
                    EXPECT_EQ(std::memcmp(part.data() + static_cast<std::ptrdiff_t>(j) * width * 3,
                                          whole.data() + ((y + j) * kSize + x) * 3,
                                          static_cast<std::size_t>(width) * 3 * sizeof(float)),
                              0)
                        << map.name << ' ' << x << ' ' << y;
            }
        }
    }
}

TEST(OwnTaps, TexelsThatAreNoNumbersCountWhereTheyHaveWeight) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    const NamedMap map = maps()[4];
    Texels texels(PixelType::float32, false), without = texels;
    std::mt19937 random(kSeed);
    for (int k = 0; k < 200; ++k) {
        const auto x = static_cast<int>(random() % kSource), y = static_cast<int>(random() % kSource);
        texels.put(x, y, 0, std::numeric_limits<double>::quiet_NaN());
    }
    const Picture picture = picture_of(map);
    const std::vector<float> values = drawn(picture, texels, {0, 0, kSize, kSize}),
                             clean = drawn(picture, without, {0, 0, kSize, kSize});
    int lost = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (std::isnan(values[k])) ++lost;
        // What has no weight on them is what it was; another channel always.
        if (k % 3 != 0) {
            EXPECT_EQ(values[k], clean[k]);
        }
        if (k % 3 == 0 && !std::isnan(values[k])) {
            EXPECT_NEAR(values[k], clean[k], 1e-6);
        }
    }
    EXPECT_GT(lost, 100);
    EXPECT_LT(lost, kSize * kSize / 4);
}

}  // namespace
}  // namespace anamorph::test_own_taps
