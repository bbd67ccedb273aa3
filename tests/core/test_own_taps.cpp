// SPDX-License-Identifier: Apache-2.0
// Pixels that take taps of their own (image/own_taps.h), against the rule of image/footprint.h written out in long double, and against
// 256 samples a pixel.
#include <gtest/gtest.h>

#include <algorithm>
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

/// The noise that so many taps leave: sums of the tent's autocorrelation, which is 0 from 2 texels on.
long double energy_of(int taps, long double spacing) {
    const auto tent = [](long double d) {
        if (d >= 2) return 0.0L;
        return d <= 1 ? 2.0L / 3 - d * d + d * d * d / 2 : (2 - d) * (2 - d) * (2 - d) / 6;
    };
    long double sum = 0;
    for (int i = 0; i < taps; ++i)
        for (int j = 0; j < taps; ++j) sum += tent(std::abs(i - j) * spacing);
    return sum / taps / taps;
}

/// That of the mean over a length of 1 at least.
long double energy_of_mean(long double length) {
    length = std::max(length, 1.0L);
    return (1 - 1 / (3 * length)) / length;
}

/// The smaller singular value of the matrix with these columns, by the eigenvalues of its square.
long double narrow_side(long double ax, long double ay, long double bx, long double by) {
    const long double p = ax * ax + ay * ay, q = bx * bx + by * by, r = ax * bx + ay * by;
    return std::sqrt(std::max(0.0L, (p + q) / 2 - std::sqrt((p - q) * (p - q) / 4 + r * r)));
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

/// Taps of all pixels of a block.
struct Found {
    static constexpr std::ptrdiff_t kStride = simd::kRowRoom;
    std::array<std::vector<float>, 4> taps;
    std::vector<std::int32_t> counts;
    simd::OwnReach reach;

    Found(const std::vector<float>& x, const std::vector<float>& y, int width, int height, float widest)
        : counts(x.size()) {
        for (auto& t : taps) t.resize(x.size());
        reach = simd::own_taps(
            x.data(), y.data(), kStride, width, height, widest,
            {taps[0].data(), taps[1].data(), taps[2].data(), taps[3].data(), counts.data(), kStride});
    }
    Side half(std::size_t k, bool down) const { return {taps[down ? 2 : 0][k], taps[down ? 3 : 1][k]}; }
    int count(std::size_t k, bool down) const {
        return counts[k] < 2 ? 2
                             : (counts[k] >> (down ? simd::kTapsDownShift : simd::kTapsAcrossShift)) & 255;
    }
};

/// Checks the taps of a pixel along a side.
void check_side(const Found& found, std::size_t k, bool down, const Side& side) {
    const Side half = found.half(k, down);
    const long double length = side.length(), ratio = 2.0L / 3 / energy_of_mean(length);
    // A distance of taps that lie together is not known well by what they leave; those are the polynomial's, and here is their place.
    if (length < 1.9999L) {
        EXPECT_NEAR(half.x, side.tap().x, 1e-4);
        EXPECT_NEAR(half.y, side.tap().y, 1e-4);
    }
    if (found.counts[k] < 2 || std::fabs(ratio - std::round(ratio)) < 1e-5L) return;
    const int count = found.count(k, down);
    EXPECT_EQ(count, static_cast<int>(std::ceil(ratio)));
    EXPECT_NEAR(energy_of(count, 2 * half.length()) / energy_of_mean(length), 1, 2e-4) << length;
    EXPECT_NEAR(half.x * side.y - half.y * side.x, 0, 1e-5 * length * half.length());
    EXPECT_GE(half.x * side.x + half.y * side.y, 0);
}

TEST(OwnTaps, AreThoseOfTheFootprint) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::on_every_instruction_set([] {
        std::mt19937 random(kSeed);
        constexpr std::ptrdiff_t kStride = Found::kStride;
        for (const float widest : {simd::kWidestOnFinest, std::numeric_limits<float>::infinity()})
            for (const float most : {2.0f, 9.0f})
                for (const auto& [width, height] : {std::pair{2, 2}, {3, 64}, {17, 5}, {64, 64}, {63, 2}}) {
                    const auto room = static_cast<std::size_t>(kStride * 64);
                    std::vector<float> x(room), y(room);
                    for (int j = 0; j < height; ++j)
                        for (int i = 0; i < width; ++i) {
                            const auto k = static_cast<std::size_t>(j * kStride + i);
                            const auto jitter = [&] { return static_cast<float>(random() % 1024) / 2048; };
                            // Larger and larger steps; long and narrow ones, too.
                            const float zoom = 0.6f + 0.005f * most * static_cast<float>(i);
                            x[k] = zoom * (1.2f * static_cast<float>(i) + 0.6f * static_cast<float>(j)) +
                                   jitter();
                            y[k] = (most > 2 && j > 20 ? 3 : zoom) *
                                       (-0.4f * static_cast<float>(i) + 1.1f * static_cast<float>(j)) +
                                   jitter();
                        }
                    const Found found(x, y, width, height, widest);
                    int counts[4] = {};
                    float reach_x = 0, reach_y = 0;
                    auto greatest = simd::OwnKind::one;
                    for (int j = 0; j < height; ++j)
                        for (int i = 0; i < width; ++i) {
                            const auto at = [&](int column, int row) {
                                const auto k = static_cast<std::size_t>(row * kStride + column);
                                return Point<float>{x[k], y[k]};
                            };
                            const Side a = side_of([&](int k) { return at(k, j); }, i, width),
                                       b = side_of([&](int k) { return at(i, k); }, j, height);
                            const auto k = static_cast<std::size_t>(j * kStride + i);
                            const auto kind = simd::own_kind(found.counts[k]);
                            ++counts[static_cast<int>(kind)];
                            greatest = std::max(greatest, kind);
                            const long double longest = std::max(a.length(), b.length());
                            const long double narrow = narrow_side(a.x, a.y, b.x, b.y);
                            const auto fewest = [](const Side& s) {
                                return std::ceil(2.0L / 3 / energy_of_mean(s.length()));
                            };
                            // Rounding may decide what stands on a limit.
                            const auto above = [](long double v, long double limit) {
                                return v > limit * 1.00001L;
                            };
                            const auto below = [](long double v, long double limit) {
                                return v < limit * 0.99999L;
                            };
                            const long double wide{widest};
                            if (above(longest, 23.6L) || above(narrow, wide) ||
                                (longest > 2 && fewest(a) * fewest(b) > 64)) {
                                EXPECT_EQ(kind, simd::OwnKind::others);
                            }
                            if (below(longest, 23.6L) && below(narrow, wide) && fewest(a) * fewest(b) < 60) {
                                EXPECT_NE(kind, simd::OwnKind::others);
                            }
                            if (below(longest, 1)) {
                                EXPECT_EQ(kind, simd::OwnKind::one);
                            }
                            if (kind == simd::OwnKind::others) continue;
                            check_side(found, k, false, a);
                            check_side(found, k, true, b);
                            const auto reach_along = [&](float p, float q) {
                                return static_cast<float>(found.count(k, false) - 1) * std::fabs(p) +
                                       static_cast<float>(found.count(k, true) - 1) * std::fabs(q);
                            };
                            reach_x = std::max(reach_x, reach_along(found.taps[0][k], found.taps[2][k]));
                            reach_y = std::max(reach_y, reach_along(found.taps[1][k], found.taps[3][k]));
                            if (longest > 1.9999L) continue;
                            const Side p = a.tap(), q = b.tap();
                            const long double reach =
                                std::max(std::fabs(p.x) + std::fabs(q.x), std::fabs(p.y) + std::fabs(q.y));
                            if (longest > 1.00001L && reach < 0.4998L) {
                                EXPECT_EQ(kind, simd::OwnKind::nine);
                            }
                            if (longest > 1.00001L && reach > 0.5002L) {
                                EXPECT_EQ(kind, simd::OwnKind::some);
                            }
                        }
                    EXPECT_EQ(found.reach.kind, greatest);
                    EXPECT_NEAR(found.reach.x, reach_x, 1e-5f * reach_x);
                    EXPECT_NEAR(found.reach.y, reach_y, 1e-5f * reach_y);
                    if (width < 64) continue;
                    for (int kind = 0; kind < 3; ++kind)
                        if (kind != 0 || most == 2) {
                            EXPECT_GT(counts[kind], 0) << kind;
                        }
                    if (most > 2 && widest < 9) {
                        EXPECT_GT(counts[3], 0);
                    }
                }
    });
}

TEST(OwnTaps, PixelsBesideWhatIsNoNumberHaveNone) {
    constexpr std::ptrdiff_t kStride = simd::kRowRoom;
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        std::vector<float> x(kStride * 8), y(x);
        for (int j = 0; j < 8; ++j)
            for (int i = 0; i < 8; ++i) {
                x[static_cast<std::size_t>(j * kStride + i)] = static_cast<float>(i);
                y[static_cast<std::size_t>(j * kStride + i)] = static_cast<float>(j);
            }
        x[3 * kStride + 3] = bad;
        const Found found(x, y, 8, 8, simd::kWidestOnFinest);
        EXPECT_EQ(simd::own_kind(found.counts[3 * kStride + 3]), simd::OwnKind::others);
        EXPECT_EQ(simd::own_kind(found.counts[6 * kStride + 6]), simd::OwnKind::one);
        EXPECT_EQ(found.reach.kind, simd::OwnKind::others);
        EXPECT_LT(found.reach.x, 0.1f);
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
        {"waves",
         [](double x, double y) {
             return Point<double>{128 + 1.5 * (x - 64) + 27 * std::sin(0.3 * y), 128 + 1.2 * (y - 64)};
         },
         0.044021, 0.002402},
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

int fewest_taps(const Side& side) {
    return static_cast<int>(std::ceil(2.0L / 3 / energy_of_mean(side.length()) - 1e-9L));
}

/// The taps along a side by the rule of image/footprint.h: the fewest, as far apart as they have to be.
struct TapsAlong {
    int count;
    Side half{0, 0};

    explicit TapsAlong(const Side& side) : count(fewest_taps(side)) {
        if (count < 2) return;
        long double near = 0, far = 2;
        for (int i = 0; i < 30; ++i) {
            const long double d = (near + far) / 2;
            (energy_of(count, d) > energy_of_mean(side.length()) ? near : far) = d;
        }
        const long double share = near / 2 / side.length();
        half = {side.x * share, side.y * share};
    }
};

/// A pixel, where its taps lie and how far its value may be off.
struct OwnPixel {
    int x, y;
    std::vector<Point<long double>> taps;
    double off;
};

/// The pixels of a picture that take taps of their own.
std::vector<OwnPixel> own_pixels(const NamedMap& map, const Picture& picture) {
    std::vector<OwnPixel> all;
    for (std::int64_t region = 0; region < picture.maps[0].blocks->regions(); ++region)
        for (const Block& block : picture.maps[0].blocks->blocks(region)) {
            const Box& b = block.box;
            const auto at = [&](int x, int y) { return map.function(x + 0.5, y + 0.5); };
            // A block whose pixels are alike takes the footprint in its middle for all of them, and parts of one that has
            // others may share one.
            const auto sides = [&](int x, int y) {
                return std::pair(side_of([&](int k) { return at(b.x0 + k, y); }, x - b.x0, b.width()),
                                 side_of([&](int k) { return at(x, b.y0 + k); }, y - b.y0, b.height()));
            };
            bool differ = false, others = false;
            const auto [a0, b0] = sides((b.x0 + b.x1) / 2, (b.y0 + b.y1) / 2);
            const auto unlike = [](const Side& s, const Side& to) {
                return std::hypot(s.x - to.x, s.y - to.y) > std::max(0.55L, 0.26L * to.length());
            };
            for (int y = b.y0; y < b.y1; ++y)
                for (int x = b.x0; x < b.x1; ++x) {
                    const auto [p, q] = sides(x, y);
                    differ |= unlike(p, a0) || unlike(q, b0);
                    others |=
                        !(p.length() < 20 && q.length() < 20 && narrow_side(p.x, p.y, q.x, q.y) < 2.61L &&
                          fewest_taps(p) * fewest_taps(q) < 60);
                }
            if (!differ || others) continue;
            for (int y = b.y0; y < b.y1; ++y)
                for (int x = b.x0; x < b.x1; ++x) {
                    const auto [p, q] = sides(x, y);
                    const TapsAlong u(p), v(q);
                    const Point<double> point = at(x, y);
                    // Of two taps up to a texel apart half of 1.2e-4 texels for each axis, and points in float; of others as far as
                    // what they leave allows.
                    OwnPixel pixel{x, y, {}, p.length() < 1.9999L && q.length() < 1.9999L ? 4e-4 : 1e-2};
                    for (int m = 0; m < v.count; ++m)
                        for (int n = 0; n < u.count; ++n) {
                            const int s = 2 * n - (u.count - 1), t = 2 * m - (v.count - 1);
                            pixel.taps.push_back({point.x + s * u.half.x + t * v.half.x - 0.5L,
                                                  point.y + s * u.half.y + t * v.half.y - 0.5L});
                        }
                    all.push_back(pixel);
                }
        }
    return all;
}

TEST(OwnTaps, PixelsAreTheMeansOfTheirOwnTaps) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    for (const NamedMap& map : maps()) {
        const Picture picture = picture_of(map);
        const std::vector<OwnPixel> pixels = own_pixels(map, picture);
        for (const PixelType type :
             {PixelType::uint8, PixelType::uint16, PixelType::half, PixelType::float32}) {
            Texels texels(type, false);
            const std::vector<float> values = drawn(picture, texels, {0, 0, kSize, kSize});
            for (const OwnPixel& pixel : pixels) {
                long double wanted = 0;
                for (const Point<long double>& tap : pixel.taps) {
                    const auto x = static_cast<int>(std::floor(tap.x)),
                               y = static_cast<int>(std::floor(tap.y));
                    for (int n = 0; n < 4; ++n)
                        wanted += (n & 1 ? tap.x - x : 1 - tap.x + x) * (n & 2 ? tap.y - y : 1 - tap.y + y) *
                                  static_cast<long double>(texels(x + (n & 1), y + (n >> 1), 0)) /
                                  static_cast<long double>(pixel.taps.size());
                }
                EXPECT_NEAR(values[static_cast<std::size_t>((pixel.y * kSize + pixel.x) * 3)], wanted,
                            pixel.off)
                    << map.name << ' ' << pixel.x << ' ' << pixel.y;
            }
        }
        const std::string name = map.name;
        if (name == "1.6" || name == "fold" || name == "turned" || name == "waves") {
            EXPECT_GT(pixels.size(), 1000U) << name;
        }
        if (name == "waves") {
            EXPECT_TRUE(std::any_of(pixels.begin(), pixels.end(),
                                    [](const OwnPixel& p) { return p.taps.size() > 9; }));
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
    for (const NamedMap& map : maps()) {
        if (map.name != std::string("1.9") && map.name != std::string("waves")) continue;
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
                // Places of taps are rounded otherwise where pixels are mended: by 2^-24 of 64 texels.
                EXPECT_NEAR(values[k], clean[k], 5e-6);
            }
        }
        EXPECT_GT(lost, 100);
        EXPECT_LT(lost, kSize * kSize / 4);
    }
}

}  // namespace
}  // namespace anamorph::test_own_taps
