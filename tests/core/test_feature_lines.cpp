// SPDX-License-Identifier: Apache-2.0
#include "anamorph/morph/feature_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "anamorph/error.h"

namespace anamorph::test_feature_lines {
namespace {

constexpr Size kSize{200, 160};

FeatureMap map_of(const Features& features, double t, const LineWeights& weights = {}) {
    return FeatureMap(features, {kSize, kSize}, kSize, {1 - t, t}, weights);
}

Features random_features(std::mt19937& random, int count) {
    std::uniform_real_distribution<double> x(0, kSize.width), y(0, kSize.height), d(-12, 12);
    Features features;
    for (int i = 0; i < count; ++i) {
        const Line a{{x(random), y(random)}, {x(random), y(random)}};
        const auto moved = [&](const Point<double>& p) {
            return Point<double>{p.x + d(random), p.y + d(random)};
        };
        features.add_line({a, {moved(a.p), moved(a.q)}});
    }
    return features;
}

/// Equations 5.9 to 5.11 word by word, in long double.
Point<long double> by_the_book(const Features& features, double t, const LineWeights& weights, long double x,
                               long double y, int shape) {
    long double sum = 0, sum_x = 0, sum_y = 0;
    for (std::size_t i = 0; i < features.size(); ++i) {
        const Line &a = features.line(i, 0), &b = features.line(i, 1), &s = features.line(i, shape);
        const auto mix = [&](double u, double v) { return (1 - t) * u + static_cast<long double>(t) * v; };
        const long double px = mix(a.p.x, b.p.x), py = mix(a.p.y, b.p.y);
        const long double ex = mix(a.q.x, b.q.x) - px, ey = mix(a.q.y, b.q.y) - py;
        const long double length = std::sqrt(ex * ex + ey * ey);
        const long double u = ((x - px) * ex + (y - py) * ey) / (length * length);
        const long double v = (-(x - px) * ey + (y - py) * ex) / length;
        const long double fx = s.q.x - s.p.x, fy = s.q.y - s.p.y, f = std::sqrt(fx * fx + fy * fy);
        const long double to_x = s.p.x + u * fx - v * fy / f, to_y = s.p.y + u * fy + v * fx / f;
        const long double dist = u < 0   ? std::hypot(x - px, y - py)
                                 : u > 1 ? std::hypot(x - px - ex, y - py - ey)
                                         : std::fabs(v);
        const long double weight =
            features.weight(i) *
            std::pow(std::pow(length, static_cast<long double>(weights.p)) / (weights.a + dist),
                     static_cast<long double>(weights.b));
        sum += weight;
        sum_x += weight * to_x;
        sum_y += weight * to_y;
    }
    return {sum_x / sum, sum_y / sum};
}

TEST(FeatureMap, IsTheEquationsOfThePaper) {
    constexpr unsigned kSeed = 20031;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> x(-50, 250), unit(0, 1);
    for (const LineWeights& w : {LineWeights{1, 2, 0.5}, LineWeights{0.01, 0.5, 0}, LineWeights{2, 8, 1},
                                 LineWeights{0, 1.3, 0.5}, LineWeights{0, 0, 0.5}}) {
        const Features features = random_features(random, 9);
        const double t = unit(random);
        const FeatureMap map = map_of(features, t, w);
        for (int i = 0; i < 200; ++i) {
            const double px = x(random), py = x(random);
            for (int k = 0; k < 2; ++k) {
                const Point<double> p = map(px, py, k);
                const Point<long double> q = by_the_book(features, t, w, px, py, k);
                EXPECT_NEAR(p.x, static_cast<double>(q.x), 1e-9);
                EXPECT_NEAR(p.y, static_cast<double>(q.y), 1e-9);
            }
        }
    }
}

TEST(FeatureMap, AllShapesAtOnceIsEachOfThem) {
    std::mt19937 random(7);
    const FeatureMap map = map_of(random_features(random, 5), 0.3);
    Point<double> both[2];
    map.all(31.5, 77.5, both);
    for (int k = 0; k < 2; ++k) {
        const Point<double> one = map(31.5, 77.5, k);
        EXPECT_EQ(one.x, both[k].x);
        EXPECT_EQ(one.y, both[k].y);
    }
}

TEST(FeatureMap, IsTheIdentityToTheShapeThatIsAskedFor) {
    std::mt19937 random(11);
    const Features features = random_features(random, 12);
    for (int k = 0; k < 2; ++k) {
        const FeatureMap map = map_of(features, k);
        for (double x = 0.5; x < kSize.width; x += 7)
            for (double y = 0.5; y < kSize.height; y += 7) {
                const Point<double> p = map(x, y, k);
                EXPECT_EQ(p.x, x);
                EXPECT_EQ(p.y, y);
            }
    }
}

TEST(FeatureMap, APictureOfAnotherSizeIsScaled) {
    Features features;
    features.add_line({{{10, 10}, {50, 20}}, {{20, 20}, {100, 40}}});
    const FeatureMap map(features, {{100, 80}, {200, 160}}, {100, 80}, {0.5, 0.5}, {});
    const Point<double> p = map(33.0, 44.0, 1);
    EXPECT_NEAR(p.x, 66, 1e-12);
    EXPECT_NEAR(p.y, 88, 1e-12);
}

TEST(FeatureMap, OnALineWithoutAItGoesWhereTheLineSays) {
    Features features;
    features.add_line({{{20, 40.5}, {120, 40.5}}, {{25, 50.5}, {125, 50.5}}});
    features.add_line({{{30, 100}, {90, 110}}, {{10, 100}, {95, 90}}});
    const FeatureMap map = map_of(features, 0, {0, 2, 0.5});
    const Point<double> p = map(60.5, 40.5, 1);
    EXPECT_NEAR(p.x, 65.5, 1e-12);
    EXPECT_NEAR(p.y, 50.5, 1e-12);
    // The limit a -> 0 where two lines of equal length cross: the mean of both.
    Features crossing;
    crossing.add_line({{{0, 50}, {100, 50}}, {{0, 60}, {100, 60}}});
    crossing.add_line({{{50, 0}, {50, 100}}, {{58, 0}, {58, 100}}});
    const FeatureMap cross = map_of(crossing, 0, {0, 2, 0.5});
    const Point<double> c = cross(50.0, 50.0, 1);
    EXPECT_NEAR(c.x, 54, 1e-12);
    EXPECT_NEAR(c.y, 55, 1e-12);
    const FeatureMap nearly = map_of(crossing, 0, {1e-9, 2, 0.5});
    EXPECT_NEAR(nearly(50.0, 50.0, 1).x, c.x, 1e-6);
}

TEST(FeatureMap, ItsJacobianIsItsDifferences) {
    std::mt19937 random(23);
    const FeatureMap map = map_of(random_features(random, 6), 0.4);
    using J = Jet1<double>;
    const double x = 87.3, y = 61.9, h = 1e-5;
    const Point<J> p = map(J::variable(x, 1, 0), J::variable(y, 0, 1), 0);
    const Point<double> dx{(map(x + h, y, 0).x - map(x - h, y, 0).x) / (2 * h),
                           (map(x + h, y, 0).y - map(x - h, y, 0).y) / (2 * h)};
    EXPECT_NEAR(p.x.c[1], dx.x, 1e-6);
    EXPECT_NEAR(p.y.c[1], dx.y, 1e-6);
}

TEST(FeatureMap, FarAwayAndSteepWeightsStayFinite) {
    std::mt19937 random(5);
    for (const double b : {0.0, 8.0, 16.0})
        for (const double a : {0.0, 1e-12, 1e6}) {
            const FeatureMap map = map_of(random_features(random, 20), 0.5, {a, b, 16});
            for (const double at : {-1e6, 0.0, 80.5, 1e6}) {
                const Point<double> p = map(at, at, 0);
                EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y)) << "a " << a << " b " << b;
            }
        }
}

TEST(FeatureMap, ThreeShapesMix) {
    Features features(3);
    features.add_line({{{10, 10}, {50, 10}}, {{10, 40}, {50, 40}}, {{40, 10}, {80, 10}}});
    const std::vector<Size> sizes(3, kSize);
    const FeatureMap map(features, sizes, kSize, {0.5, 0.25, 0.25}, {});
    // A pure shift by (7.5, 7.5): back to A by as much.
    const Point<double> p = map(100.0, 100.0, 0);
    EXPECT_NEAR(p.x, 92.5, 1e-12);
    EXPECT_NEAR(p.y, 92.5, 1e-12);
    EXPECT_THROW(FeatureMap(features, sizes, kSize, {0.5, 0.5}, {}), Error);
}

TEST(FeatureMap, ThePinnedBorderStays) {
    Features features;
    features.add_line({{{90, 70}, {110, 90}}, {{120, 60}, {140, 100}}});
    features.pin_border(1);
    const FeatureMap map = map_of(features, 0.5, {0, 2, 0.5});
    const Point<double> p = map(0.0, 53.0, 1);
    EXPECT_NEAR(p.x, 0, 1e-9);
    EXPECT_NEAR(p.y, 53, 1e-9);
}

/// The message of the Error that `body` throws.
template <class Body>
std::string message(const Body& body) {
    try {
        body();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

TEST(Features, BadLinesAreNamed) {
    Features features;
    features.add_line({{{0, 0}, {1, 0}}, {{0, 0}, {1, 0}}});
    EXPECT_EQ(message([&] {
                  features.add_line({{{3, 4}, {3, 4}}, {{0, 0}, {1, 0}}}, 1, "brow");
              }),
              "brow=3,4,3,4: a line needs a length");
    EXPECT_EQ(message([&] {
                  features.add_line({{{3, NAN}, {3, 4}}, {{0, 0}, {1, 0}}});
              }),
              "line 2=3,nan,3,4: coordinates must be at most 1e9 pixels");
    EXPECT_NE(message([&] { features.add_line({{{0, 0}, {1, 0}}, {{0, 0}, {1, 0}}}, NAN); }), "no error");
    EXPECT_NE(message([&] { features.add_polyline({{{0, 0}, {1, 0}}, {{0, 0}}}); }), "no error");
    EXPECT_NE(message([&] { features.add_curve({{{0, 0}, {1, 0}}, {{0, 0}, {1, 0}}}); }), "no error");
    EXPECT_EQ(message([&] { features.set_frame(2, {10, 10}); }), "shape=2: must be 0 to 1");
    EXPECT_EQ(message([&] { features.set_frame(-1, {10, 10}); }), "shape=-1: must be 0 to 1");
    // Turned round from A to B: no length half way.
    Features turned;
    turned.add_line({{{0, 0}, {10, 0}}, {{10, 0}, {0, 0}}});
    EXPECT_EQ(message([&] { map_of(turned, 0.5); }), "line 1=5,0,5,0: a line needs a length, here too");
}

TEST(Features, CurvesBecomeChainsThatFollowThem) {
    Features features;
    const std::vector<Point<double>> a{{0, 0}, {0, 55.2}, {44.8, 100}, {100, 100}};
    features.add_curve({a, {{0, 0}, {1, 1}, {2, 2}, {3, 3}}});
    ASSERT_GT(features.size(), 3u);
    Point<double> end{0, 0};
    for (std::size_t i = 0; i < features.size(); ++i) {
        const Line& l = features.line(i, 0);
        EXPECT_EQ(l.p.x, end.x);
        EXPECT_EQ(l.p.y, end.y);
        end = l.q;
        // The curve is a quarter of a circle around (100, 0), to 0.03%.
        const double middle = std::hypot(0.5 * (l.p.x + l.q.x) - 100, 0.5 * (l.p.y + l.q.y));
        EXPECT_NEAR(middle, 100, Features::kCurveDeviation + 0.05);
    }
    EXPECT_NEAR(end.x, 100, 1e-12);
    EXPECT_NEAR(end.y, 100, 1e-12);
}

}  // namespace
}  // namespace anamorph::test_feature_lines
