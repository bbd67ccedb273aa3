// SPDX-License-Identifier: Apache-2.0
// Vectors as numbers, on every instruction set that this machine has: the errors that lanes.h and
// exp_of_minus.h state, held against long double, and the same bits on all of them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "anamorph/number/number.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "test_lanes.cpp"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::test::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "anamorph/number/lanes.h"
// It is made of those.
#include "anamorph/number/exp_of_minus.h"

static_assert(FormulaNumber<Lanes<hn::ScalableTag<double>>> && FormulaNumber<Lanes<hn::ScalableTag<float>>>);

/// out[i] = function `which` of (a[i], b[i]), in the order of kNames.
template <class S>
void Evaluate(int which, const S* a, const S* b, std::size_t count, S* out) {
    using L = Lanes<hn::ScalableTag<S>>;
    const std::size_t lanes = hn::Lanes(typename L::D());
    for (std::size_t i = 0; i < count; i += lanes) {
        const L x = L::load(a + i), y = L::load(b + i);
        L s, c, r;
        switch (which) {
            case 0:
                sin_cos(x, r, c);
                break;
            case 1:
                sin_cos(x, s, r);
                break;
            case 2:
                r = atan2(x, y);
                break;
            case 3:
                r = exp(x);
                break;
            case 4:
                r = log(x);
                break;
            case 5:
                scaled_sinh(x, r);
                break;
            case 6:
                r = asinh(x);
                break;
            case 7:
                r = sqrt(L(square(x) + square(y)));
                break;
            case 9:
                r = scaled_sinh(x, s);
                break;
            case 10:
                sine_versine(x, r, c);
                break;
            case 11:
                sine_versine(x, s, r);
                break;
            case 12:
                r = small_atan(x);
                break;
            case 13:
                r = small_angle(x, y);
                break;
            default:
                r = x / y;
        }
        r.store(out + i);
    }
}
void EvaluateDouble(int which, const double* a, const double* b, std::size_t count, double* out) {
    Evaluate(which, a, b, count, out);
}
void EvaluateFloat(int which, const float* a, const float* b, std::size_t count, float* out) {
    Evaluate(which, a, b, count, out);
}

void EvaluateExpOfMinus(const double* a, std::size_t count, double* out) {
    using L = Lanes<hn::ScalableTag<double>>;
    for (std::size_t i = 0; i < count; i += hn::Lanes(L::D())) exp_of_minus(L::load(a + i)).store(out + i);
}

}  // namespace anamorph::test::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::test {
HWY_EXPORT(EvaluateDouble);
HWY_EXPORT(EvaluateFloat);
HWY_EXPORT(EvaluateExpOfMinus);

namespace {

constexpr int kFunctions = 14;
const char* const kNames[kFunctions] = {"sin",  "cos",     "atan2",      "exp",        "log",
                                        "tanh", "asinh",   "hypot",      "quotient",   "sech",
                                        "sine", "versine", "small atan", "small angle"};
constexpr unsigned kSeed = 4711;
constexpr std::size_t kCount = 1 << 16;  // a multiple of any number of lanes

void evaluate(int which, const std::vector<double>& a, const std::vector<double>& b,
              std::vector<double>& out) {
    HWY_DYNAMIC_DISPATCH(EvaluateDouble)(which, a.data(), b.data(), a.size(), out.data());
}
void evaluate(int which, const std::vector<float>& a, const std::vector<float>& b, std::vector<float>& out) {
    HWY_DYNAMIC_DISPATCH(EvaluateFloat)(which, a.data(), b.data(), a.size(), out.data());
}

long double truth(int which, long double a, long double b, bool precise) {
    switch (which) {
        case 0:
            return std::sin(a);
        case 1:
            return std::cos(a);
        case 2:
            return std::atan2(a, b);
        case 3:
            return std::exp(a);
        case 4:
            return std::log(a);
        case 5:
            return std::tanh(a);
        case 6:
            return std::asinh(a);
        case 7:
            return std::sqrt(a * a + b * b);
        case 9:
            return std::max(1 / std::cosh(a), precise ? static_cast<long double>(kLeastScale) : 0x1p-100L);
        case 10:
            return std::sin(a);
        case 11:
            return 2 * std::sin(a / 2) * std::sin(a / 2);
        case 12:
            return std::atan(a);
        case 13:
            return std::atan(a / b);
        default:
            return a / b;
    }
}

/// What lanes.h states, in units of half the spacing relative to the value.
constexpr double kStated[kFunctions] = {4, 4, 5, 3, 3, 8, 8, 3, 1, 5, 4, 4, 4, 6};

long double stated(int which, long double a, long double value, bool precise) {
    if (which < 2 && !precise) return 2 + std::fabs(a) / 2048;
    return kStated[which] * std::fabs(value);
}

/// Arguments of both signs over many magnitudes, as far as the function takes them.
template <class S>
void arguments(int which, std::mt19937& random, std::vector<S>& a, std::vector<S>& b) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    const bool precise = sizeof(S) == 8;
    for (std::size_t i = 0; i < kCount; ++i) {
        const double u = uniform(random), wide = uniform(random) * (precise ? 200 : 25);
        const double spread = std::copysign(std::exp2(wide), uniform(random));
        b[i] = static_cast<S>(i % 3 ? uniform(random)
                                    : std::copysign(std::exp2(uniform(random) * 20), uniform(random)));
        switch (which) {
            case 0:
            case 1:
                a[i] = static_cast<S>(i % 2 ? 7 * u : 1e4 * u);
                break;
            case 2:
            case 7:
            case 8:
                a[i] = static_cast<S>(i % 3 == 1 ? u : std::copysign(std::exp2(uniform(random) * 20), u));
                break;
            case 3:
                a[i] = static_cast<S>(i % 2 ? u : u * (precise ? 700 : 85));
                break;
            case 4:
                a[i] = static_cast<S>(i % 2 ? 1 + 0.5 * u : std::fabs(spread));
                break;
            case 5:
            case 9:
                a[i] = static_cast<S>(i % 3 == 0 ? u * 1e-6 : i % 2 ? u : u * (precise ? 700 : 85));
                break;
            case 10:
            case 11:
                a[i] = static_cast<S>((i % 2 ? u : u * 1e-5) * (M_PI / 4));
                break;
            case 12:
                a[i] = static_cast<S>((i % 2 ? u : u * 1e-5) * (M_SQRT2 - 1));
                break;
            case 13:
                // Whole vectors of small angles, too.
                b[i] = static_cast<S>(std::exp2(uniform(random) * 20));
                a[i] = static_cast<S>((i / 32 % 2 ? u * (M_SQRT2 - 1) : u * (M_SQRT2 + 1)) * b[i]);
                break;
            default:
                a[i] = static_cast<S>(i % 2 ? u : spread);
        }
    }
}

/// body() once for every instruction set that this machine has, with its name traced.
void on_every_target(const std::function<void()>& body) {
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        SCOPED_TRACE(hwy::TargetName(target));
        hwy::SetSupportedTargetsForTest(target);
        body();
    }
    hwy::SetSupportedTargetsForTest(0);
}

template <class S>
void expect_stated_errors_and_the_same_bits() {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    constexpr long double kUnit = std::numeric_limits<S>::epsilon() / 2.0L;
    for (int f = 0; f < kFunctions; ++f) {
        SCOPED_TRACE(kNames[f]);
        std::vector<S> a(kCount), b(kCount), first, out(kCount);
        arguments(f, random, a, b);
        on_every_target([&] {
            evaluate(f, a, b, out);
            if (first.empty()) first = out;
            EXPECT_EQ(std::memcmp(first.data(), out.data(), kCount * sizeof(S)), 0);
        });
        long double worst = 0, at = 0;
        for (std::size_t i = 0; i < kCount; ++i) {
            const long double value = truth(f, a[i], b[i], sizeof(S) == 8);
            const long double error =
                std::fabs(out[i] - value) / (kUnit * stated(f, a[i], value, sizeof(S) == 8));
            if (!(error <= worst)) worst = error, at = a[i];
        }
        EXPECT_LE(worst, 1) << "of what is stated, at " << static_cast<double>(at);
        EXPECT_GT(worst, 0.1L) << "stated far too large";
    }
}

TEST(Lanes, DoubleHoldsItsErrorsWithTheSameBitsEverywhere) {
    expect_stated_errors_and_the_same_bits<double>();
}
TEST(Lanes, FloatHoldsItsErrorsWithTheSameBitsEverywhere) {
    expect_stated_errors_and_the_same_bits<float>();
}

TEST(Lanes, ExpOfMinusHoldsItsErrorWithTheSameBitsEverywhere) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<double> a, first, out(kCount);
    constexpr double kInf = HUGE_VAL, kBeyond = 700.0000000000002;
    for (const double x : {0.0, -0.0, 5e-324, 1e-300, 0x1p-53, 700.0, kBeyond, 1e300, kInf, double{NAN}})
        a.push_back(x);
    // Around the halves of log 2, where the exponent changes, too.
    while (a.size() < kCount) {
        const double kinds[] = {
            uniform(random), 20 * uniform(random), 700 * uniform(random),
            (static_cast<double>(random() % 2000) / 2) * M_LN2 * (1 + 1e-15 * uniform(random))};
        a.push_back(std::min(kinds[a.size() % 4], 700.0));
    }
    on_every_target([&] {
        HWY_DYNAMIC_DISPATCH(EvaluateExpOfMinus)(a.data(), a.size(), out.data());
        if (first.empty()) first = out;
        EXPECT_EQ(std::memcmp(first.data(), out.data(), kCount * sizeof(double)), 0);
    });
    long double worst = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
        if (!(a[i] <= 700)) {
            EXPECT_EQ(out[i], 0) << a[i];
            continue;
        }
        const long double value = std::exp(-static_cast<long double>(a[i]));
        worst = std::max(worst, std::fabs(out[i] - value) / (value * 0x1p-53L));
    }
    EXPECT_EQ(out[0], 1);
    EXPECT_EQ(out[1], 1);
    EXPECT_LE(worst, 2);
    EXPECT_GT(worst, 0.5);
}

TEST(Lanes, SpecialValues) {
    constexpr double kInf = HUGE_VAL, kNan = NAN;
    struct Case {
        int which;
        double a, b, expected;
    };
    const Case cases[] = {{2, 0, 0, 0},
                          {2, 0, -1, M_PI},
                          {2, -0.0, -1, -M_PI},
                          {2, 1, 0, M_PI_2},
                          {2, -1, 0, -M_PI_2},
                          {2, 0, 1, 0},
                          {3, 0, 0, 1},
                          {3, -800, 0, 0},
                          {3, 800, 0, kInf},
                          {3, kNan, 0, kNan},
                          {4, 1, 0, 0},
                          {4, 0, 0, -kInf},
                          {4, -1, 0, kNan},
                          {4, kInf, 0, kInf},
                          {4, kNan, 0, kNan},
                          {4, 5e-324, 0, std::log(5e-324)},
                          {5, 0, 0, 0},
                          {6, 0, 0, 0},
                          {0, kNan, 0, kNan},
                          {2, kNan, 1, kNan},
                          {6, 1e300, 0, std::asinh(1e300)},
                          {5, 1000, 0, 1},
                          {5, -kInf, 0, -1},
                          {9, kInf, 0, kLeastScale},
                          {5, kNan, 0, kNan}};
    on_every_target([&] {
        for (const Case& c : cases) {
            const std::vector<double> a(16, c.a), b(16, c.b);
            std::vector<double> out(16);
            evaluate(c.which, a, b, out);
            const std::string what = std::string(kNames[c.which]) + " of " + std::to_string(c.a);
            if (std::isnan(c.expected))
                EXPECT_TRUE(std::isnan(out[3])) << what;
            else if (std::isinf(c.expected))
                EXPECT_EQ(out[3], c.expected) << what;
            else
                EXPECT_NEAR(out[3], c.expected, 1e-14 * std::fabs(c.expected)) << what;
            EXPECT_TRUE(std::isnan(c.expected) || std::signbit(out[3]) == std::signbit(c.expected)) << what;
        }
    });
}

}  // namespace
}  // namespace anamorph::test
#endif
