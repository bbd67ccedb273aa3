// SPDX-License-Identifier: Apache-2.0
// Weighted sums of surfaces against long double, their weights, and key frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include "anamorph/deform/inbetween.h"
#include "anamorph/deform/key_frames.h"

namespace anamorph::test_deform_inbetween {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

std::string fault_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no fault";
}

ParallelFor two_threads() {
    return [](std::int64_t turns, const std::function<void(std::int64_t)>& body) {
        std::thread other([&] {
            for (std::int64_t i = turns - 1; i >= 0; i -= 2) body(i);
        });
        for (std::int64_t i = turns - 2; i >= 0; i -= 2) body(i);
        other.join();
    };
}

template <class T>
struct Shapes {
    Shapes(unsigned seed, std::size_t count, std::size_t values) : data(count) {
        std::mt19937 random(seed);
        for (std::vector<T>& shape : data)
            for (std::size_t i = 0; i < values; ++i)
                shape.push_back(static_cast<T>(std::uniform_real_distribution<double>(-2, 2)(random)));
        for (const std::vector<T>& shape : data) pointers.push_back(shape.data());
    }
    std::vector<std::vector<T>> data;
    std::vector<const T*> pointers;
};

template <class T>
class Inbetween : public ::testing::Test {};
using Types = ::testing::Types<float, double>;
TYPED_TEST_SUITE(Inbetween, Types);

/// Half a unit in the last place of a result of T, and what double arithmetic adds to sums of magnitude
/// `size`.
template <class T>
double rounding(long double result, double size) {
    const double half = std::is_same_v<T, float> ? 0x1p-24 : 0x1p-53;
    return half * static_cast<double>(std::fabs(result)) * 1.001 + 16 * 0x1p-53 * size;
}

TYPED_TEST(Inbetween, IsTheWeightedSum) {
    const unsigned seed = 4;
    SCOPED_TRACE("seed " + std::to_string(seed));
    for (const std::int64_t points : {1, 7, 5000})
        for (const int components : {1, 3}) {
            const std::size_t values = static_cast<std::size_t>(points * components);
            const Shapes<TypeParam> shapes(seed, 10, values);
            const std::vector<double> weights = {.3, .2, -.1, .4, 0, .05, .15, .2, -.3, .1};
            std::vector<TypeParam> out(values), again(values);
            inbetween<TypeParam>(shapes.pointers, weights, WeightSum::checked, points, components,
                                 out.data());
            for (std::size_t i = 0; i < values; ++i) {
                long double sum = 0;
                for (std::size_t k = 0; k < 10; ++k)
                    sum += static_cast<long double>(weights[k]) * shapes.data[k][i];
                ASSERT_NEAR(out[i], static_cast<double>(sum), rounding<TypeParam>(sum, 4));
            }
            inbetween<TypeParam>(shapes.pointers, weights, WeightSum::checked, points, components,
                                 again.data(), two_threads());
            EXPECT_EQ(again, out);
            // A piece that starts elsewhere, in place.
            if (points > 1) {
                Shapes<TypeParam> moved = shapes;
                std::vector<const TypeParam*> from;
                for (auto& shape : moved.data) from.push_back(shape.data() + components);
                inbetween<TypeParam>(from, weights, WeightSum::checked, points - 1, components,
                                     moved.data[2].data() + components);
                EXPECT_TRUE(
                    std::equal(out.begin() + components, out.end(), moved.data[2].begin() + components));
            }
        }
}

TYPED_TEST(Inbetween, AddsRegionsToABase) {
    const unsigned seed = 6;
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::int64_t points = 4500;
    const std::size_t values = static_cast<std::size_t>(3 * points);
    const Shapes<TypeParam> shapes(seed, 4, values);
    const TypeParam* base = shapes.data[3].data();
    const std::vector<const TypeParam*> used(shapes.pointers.begin(), shapes.pointers.begin() + 3);
    const std::vector<double> weights = {.5, -1.25, 2};
    std::mt19937 random(seed);
    std::vector<float> left, grey;
    for (std::int64_t p = 0; p < points; ++p) {
        left.push_back(p < points / 2 ? 1.f : 0.f);
        grey.push_back(std::uniform_real_distribution<float>(0, 1)(random));
    }
    std::vector<TypeParam> out(values), again(values);
    const auto check = [&](const std::vector<const float*>& masks) {
        inbetween_from_base<TypeParam>(base, used, weights, masks, points, 3, out.data());
        for (std::size_t i = 0; i < values; ++i) {
            long double sum = base[i];
            for (std::size_t k = 0; k < 3; ++k) {
                const float mask = masks.empty() || !masks[k] ? 1 : masks[k][i / 3];
                sum += weights[k] * static_cast<long double>(mask) *
                       (static_cast<long double>(used[k][i]) - base[i]);
            }
            ASSERT_NEAR(out[i], static_cast<double>(sum), rounding<TypeParam>(sum, 20));
        }
        inbetween_from_base<TypeParam>(base, used, weights, masks, points, 3, again.data(), two_threads());
        EXPECT_EQ(again, out);
    };
    check({});
    check({left.data(), nullptr, grey.data()});
    // Where nothing is masked in, the base stays as it is.
    const std::vector<float> none(static_cast<std::size_t>(points), 0.f);
    inbetween_from_base<TypeParam>(base, used, weights, std::vector<const float*>(3, none.data()), points, 3,
                                   out.data());
    EXPECT_EQ(out, shapes.data[3]);
}

TEST(InbetweenWeights, CheckedOrNormalized) {
    EXPECT_EQ(inbetween_weights(std::vector<double>{2, -1}, WeightSum::checked),
              (std::vector<double>{2, -1}));
    EXPECT_EQ(inbetween_weights(std::vector<double>{1, 3}, WeightSum::normalized),
              (std::vector<double>{.25, .75}));
    EXPECT_EQ(inbetween_weights(std::vector<double>{-1, -3}, WeightSum::normalized),
              (std::vector<double>{.25, .75}));
    const auto fault = [](std::vector<double> weights, WeightSum sum) {
        return fault_of([&] { inbetween_weights(weights, sum); });
    };
    EXPECT_THAT(fault({.5, .6}, WeightSum::checked), HasSubstr("weights=sum 1.1"));
    EXPECT_THAT(fault({}, WeightSum::checked), HasSubstr("weights=sum 0"));
    EXPECT_THAT(fault({1, -1}, WeightSum::normalized), HasSubstr("cannot be normalized"));
    EXPECT_THAT(fault({1, -1 + 1e-12}, WeightSum::normalized), HasSubstr("cannot be normalized"));
    EXPECT_THAT(fault({0, 0}, WeightSum::normalized), HasSubstr("cannot be normalized"));
    EXPECT_THAT(fault({1e308, 1e308}, WeightSum::normalized), HasSubstr("cannot be normalized"));
    for (const double bad : {kNan, kInf})
        for (const WeightSum sum : {WeightSum::checked, WeightSum::normalized})
            EXPECT_THAT(fault({1, bad}, sum), HasSubstr("weights[1]="));
}

TEST(InbetweenWeights, WhatIsRefused) {
    const std::vector<float> shape(6, 1.f);
    std::vector<float> out(6);
    const std::vector<const float*> shapes{shape.data(), shape.data()};
    const std::vector<double> one{1}, two{.5, .5}, bad{.5, kNan};
    const auto blend = [&](const std::vector<double>& weights, std::int64_t points, int components) {
        return fault_of(
            [&] { inbetween<float>(shapes, weights, WeightSum::checked, points, components, out.data()); });
    };
    EXPECT_EQ(blend(two, 2, 3), "no fault");
    EXPECT_THAT(blend(one, 2, 3), HasSubstr("weights=1 numbers"));
    EXPECT_THAT(blend(two, -1, 3), HasSubstr("points=-1"));
    EXPECT_THAT(blend(two, 2, 0), HasSubstr("components=0"));
    const auto add = [&](const std::vector<double>& weights, const std::vector<const float*>& masks) {
        return fault_of(
            [&] { inbetween_from_base<float>(shape.data(), shapes, weights, masks, 2, 3, out.data()); });
    };
    const float mask[] = {1, std::numeric_limits<float>::infinity()};
    EXPECT_THAT(add(bad, {}), HasSubstr("weights[1]=nan"));
    EXPECT_THAT(add(two, {nullptr}), HasSubstr("masks=1"));
    EXPECT_THAT(add(two, {nullptr, mask}), AllOf(HasSubstr("masks[1][1]=inf"), Not(HasSubstr("\n"))));
    // A shape of weight 0 is not read, whatever it holds.
    const std::vector<float> poison(6, std::numeric_limits<float>::quiet_NaN());
    const std::vector<const float*> with_poison{shape.data(), poison.data()};
    inbetween<float>(with_poison, std::vector<double>{1, 0}, WeightSum::checked, 2, 3, out.data());
    EXPECT_EQ(out, shape);
}

// --- Key frames

const std::vector<double> kTimes = {-1, 0, .5, 3, 3.25};
const KeyInterpolation kAll[] = {KeyInterpolation::step, KeyInterpolation::linear,
                                 KeyInterpolation::catmull_rom, KeyInterpolation::monotone_cubic};

std::vector<std::vector<double>> random_frames(unsigned seed, std::size_t numbers) {
    std::mt19937 random(seed);
    std::vector<std::vector<double>> frames(kTimes.size());
    for (std::vector<double>& frame : frames)
        for (std::size_t i = 0; i < numbers; ++i)
            frame.push_back(std::uniform_real_distribution<double>(-1, 1)(random));
    return frames;
}

TEST(KeyFrames, AreMadeOfKeysInAnyOrder) {
    const ShapeFrames frames = frames_of_keys({{2, 1, 0.5}, {-1, 0, 3}, {2, 2, -4}}, 3, "Shape", "a shape");
    EXPECT_EQ(frames.times, (std::vector<double>{-1, 2}));
    EXPECT_EQ(frames.weights, (std::vector<std::vector<double>>{{3, 0, 0}, {0, 0.5, -4}}));
    const auto error_of = [](const std::vector<ShapeKey>& keys) -> std::string {
        try {
            frames_of_keys(keys, 3, "Shape", "a shape");
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(error_of({{0, 2, 1}, {0, 3, 1}}), "Keys[1].Shape=3: must be a shape from 0 to 2");
    EXPECT_EQ(error_of({{0, 0.5, 1}}), "Keys[0].Shape=0.5: must be a shape from 0 to 2");
    EXPECT_EQ(error_of({{0, -1, 1}}), "Keys[0].Shape=-1: must be a shape from 0 to 2");
    EXPECT_EQ(error_of({{0, NAN, 1}}), "Keys[0].Shape=nan: must be a shape from 0 to 2");
    EXPECT_EQ(error_of({{NAN, 0, 1}}), "Keys[0].Time=nan: must be a finite number");
    EXPECT_EQ(error_of({{4, 1, 1}, {5, 1, 1}, {4, 1, 2}}),
              "Keys[2].Time=4: shape 1 has a key at this time already");
}

TEST(KeyFrames, MeetTheFramesAndStandStillOutside) {
    const auto frames = random_frames(1, 3);
    for (const KeyInterpolation interpolation : kAll) {
        const KeyFrames keys(kTimes, frames, interpolation);
        EXPECT_EQ(keys.size(), 3u);
        for (std::size_t k = 0; k < kTimes.size(); ++k) EXPECT_EQ(keys.at(kTimes[k]), frames[k]);
        EXPECT_EQ(keys.at(-kInf), frames.front());
        EXPECT_EQ(keys.at(kInf), frames.back());
        // Continuous from the left, unless in steps.
        for (std::size_t k = 1; k < kTimes.size(); ++k)
            for (std::size_t i = 0; i < 3; ++i) {
                const double before = keys.at(kTimes[k] - 1e-9)[i];
                EXPECT_NEAR(before, frames[interpolation == KeyInterpolation::step ? k - 1 : k][i], 1e-6);
            }
        EXPECT_THAT(fault_of([&] { keys.at(kNan); }), HasSubstr("time=nan"));
        EXPECT_EQ(KeyFrames({2}, {{5, 6}}, interpolation).at(7), (std::vector<double>{5, 6}));
    }
    EXPECT_NEAR(KeyFrames({0, 4}, {{1}, {3}}, KeyInterpolation::linear).at(1)[0], 1.5, 1e-15);
}

TEST(KeyFrames, CatmullRomKeepsParabolasAndSums) {
    // The slope at a frame between even ones is that of the parabola through all three.
    const KeyFrames parabola({0, 1, 2, 3}, {{0}, {1}, {4}, {9}}, KeyInterpolation::catmull_rom);
    for (double t = 1; t <= 2; t += .125) EXPECT_NEAR(parabola.at(t)[0], t * t, 1e-14);
    auto frames = random_frames(2, 4);
    for (auto& frame : frames) frame[3] = 1 - frame[0] - frame[1] - frame[2];
    for (const KeyInterpolation interpolation :
         {KeyInterpolation::step, KeyInterpolation::linear, KeyInterpolation::catmull_rom}) {
        const KeyFrames keys(kTimes, frames, interpolation);
        for (double t = -1.1; t < 3.5; t += .01) {
            const std::vector<double> w = keys.at(t);
            EXPECT_NEAR(w[0] + w[1] + w[2] + w[3], 1, 1e-14) << t;
        }
    }
}

TEST(KeyFrames, CubicsHaveContinuousSlopes) {
    const auto frames = random_frames(3, 2);
    for (const KeyInterpolation interpolation :
         {KeyInterpolation::catmull_rom, KeyInterpolation::monotone_cubic}) {
        const KeyFrames keys(kTimes, frames, interpolation);
        const double h = 1e-6;
        for (std::size_t k = 1; k + 1 < kTimes.size(); ++k)
            for (std::size_t i = 0; i < 2; ++i) {
                const double t = kTimes[k], at = frames[k][i];
                EXPECT_NEAR((keys.at(t + h)[i] - at) / h, (at - keys.at(t - h)[i]) / h, 2e-3);
            }
    }
}

TEST(KeyFrames, MonotoneCubicsDoNotOvershoot) {
    bool catmull_overshoots = false;
    for (unsigned seed = 1; seed <= 200; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        const auto frames = random_frames(seed, 1);
        const KeyFrames monotone(kTimes, frames, KeyInterpolation::monotone_cubic);
        const KeyFrames catmull(kTimes, frames, KeyInterpolation::catmull_rom);
        for (std::size_t k = 0; k + 1 < kTimes.size(); ++k) {
            const double from = frames[k][0], to = frames[k + 1][0];
            double last = from;
            for (int step = 1; step <= 50; ++step) {
                const double t = kTimes[k] + (kTimes[k + 1] - kTimes[k]) * step / 50.0;
                const double value = monotone.at(t)[0], other = catmull.at(t)[0];
                EXPECT_GE((value - last) * (to > from ? 1 : -1), -1e-15);
                last = value;
                if (other < std::min(from, to) - .01 || other > std::max(from, to) + .01)
                    catmull_overshoots = true;
            }
        }
    }
    EXPECT_TRUE(catmull_overshoots);
}

TEST(KeyFrames, ExtremeTimesAndValues) {
    for (const KeyInterpolation interpolation : kAll) {
        const KeyFrames keys({-1e300, 0, 1e-300, 1e300}, {{-1e300}, {1e300}, {-1e300}, {3}}, interpolation);
        for (const double t : {-1e300, -1e299, -1.0, 0.0, 5e-301, 1e-300, 1.0, 1e299, 1e300})
            EXPECT_FALSE(std::isnan(keys.at(t)[0])) << t;
    }
}

TEST(KeyFrames, WhatIsRefused) {
    const auto fault = [](std::vector<double> times, std::vector<std::vector<double>> values) {
        return fault_of([&] { KeyFrames(times, values, KeyInterpolation::linear); });
    };
    EXPECT_THAT(fault({}, {}), HasSubstr("times=no numbers"));
    EXPECT_THAT(fault({0, 1}, {{1}}), HasSubstr("values=1 frames"));
    EXPECT_THAT(fault({0, 0}, {{1}, {1}}), HasSubstr("times[1]=0"));
    EXPECT_THAT(fault({0, kNan}, {{1}, {1}}), HasSubstr("times[1]=nan"));
    EXPECT_THAT(fault({-kInf, 1}, {{1}, {1}}), HasSubstr("times[0]=-inf"));
    EXPECT_THAT(fault({0, 1}, {{1, 2}, {1}}), HasSubstr("values[1]=1 numbers"));
    EXPECT_THAT(fault({0, 1}, {{1, 2}, {1, kInf}}), HasSubstr("values[1][1]=inf"));
}

}  // namespace
}  // namespace anamorph::test_deform_inbetween
