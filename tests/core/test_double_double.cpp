// SPDX-License-Identifier: Apache-2.0
// DoubleDouble against numbers of 80 digits.
#include "anamorph/number/double_double.h"

#include <gtest/gtest.h>

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <functional>
#include <random>

#include "anamorph/number/rounded.h"

namespace anamorph::test_double_double {
namespace {

using Exact =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<80>, boost::multiprecision::et_off>;

Exact exact(const DoubleDouble& a) {
    return Exact(a.upper()) + Exact(a.lower());
}

/// Is the upper part the nearest double of both?
bool is_ordered(const DoubleDouble& a) {
    return a.upper() + a.lower() == a.upper();
}

/// Numbers of all magnitudes from 2^-range to 2^range, of either sign; one in eight has no second part.
class Numbers {
  public:
    explicit Numbers(unsigned seed) : m_random(seed) {}
    DoubleDouble operator()(int range) {
        const double upper = std::ldexp(fraction(), static_cast<int>(m_random() % (2u * range + 1u)) - range);
        const double signed_upper = m_random() % 2 ? upper : -upper;
        const double half_unit = std::ldexp(1.0, std::ilogb(upper) - 53);
        const double lower = m_random() % 8 ? (2 * (fraction() - 0.5) - 0.5) * half_unit : 0;
        return signed_upper + lower == signed_upper ? DoubleDouble(signed_upper, lower) : signed_upper;
    }

  private:
    /// From 1/2 to 1.
    double fraction() { return 0.5 + static_cast<double>(m_random() % (1u << 31)) * 0x1p-32 + 0x1p-50; }
    std::mt19937 m_random;
};

/// The largest error of `computed` relative to `truth` over many numbers, as a power of two.
double log2_of_error(
    int range, unsigned seed,
    const std::function<std::pair<DoubleDouble, Exact>(const DoubleDouble&, const DoubleDouble&)>& both) {
    Numbers numbers(seed);
    double most = -1000;
    for (int i = 0; i < 1000; ++i) {
        const DoubleDouble a = numbers(range), b = numbers(range);
        const auto [computed, truth] = both(a, b);
        EXPECT_TRUE(is_ordered(computed)) << a.upper() << " " << b.upper();
        if (truth == 0) {
            EXPECT_EQ(computed.upper(), 0);
            continue;
        }
        const double error = static_cast<double>(abs((exact(computed) - truth) / truth));
        if (error > 0) most = std::max(most, std::log2(error));
    }
    return most;
}

TEST(DoubleDouble, ArithmeticIsAsExactAsItSays) {
    constexpr unsigned kSeed = 1;
    RecordProperty("seed", static_cast<int>(kSeed));
    using D = DoubleDouble;
    EXPECT_LT(
        log2_of_error(60, kSeed,
                      [](const D& a, const D& b) { return std::pair(a + b, Exact(exact(a) + exact(b))); }),
        -102);
    EXPECT_LT(
        log2_of_error(2, kSeed,
                      [](const D& a, const D& b) { return std::pair(a - b, Exact(exact(a) - exact(b))); }),
        -102);
    EXPECT_LT(
        log2_of_error(300, kSeed,
                      [](const D& a, const D& b) { return std::pair(a * b, Exact(exact(a) * exact(b))); }),
        -102);
    EXPECT_LT(
        log2_of_error(300, kSeed,
                      [](const D& a, const D& b) { return std::pair(a / b, Exact(exact(a) / exact(b))); }),
        -102);
    EXPECT_LT(log2_of_error(
                  300, kSeed,
                  [](const D& a, const D&) { return std::pair(sqrt(fabs(a)), Exact(sqrt(abs(exact(a))))); }),
              -102);
    EXPECT_LT(log2_of_error(900, kSeed,
                            [](const D& a, const D& b) {
                                return std::pair(hypot(a, b),
                                                 Exact(sqrt(exact(a) * exact(a) + exact(b) * exact(b))));
                            }),
              -102);
}

TEST(DoubleDouble, FunctionsAreAsExactAsTheySay) {
    constexpr unsigned kSeed = 2;
    RecordProperty("seed", static_cast<int>(kSeed));
    using D = DoubleDouble;
    const auto error_of = [](int range, auto computed, auto truth) {
        return log2_of_error(range, kSeed, [&](const D& a, const D& b) {
            return std::pair(DoubleDouble(computed(a, b)), Exact(truth(exact(a), exact(b))));
        });
    };
    using std::pair;
    const auto sine = [](const D& a, const D&) {
        D s, c;
        sin_cos(a, s, c);
        return s;
    };
    const auto cosine = [](const D& a, const D&) {
        D s, c;
        sin_cos(a, s, c);
        return c;
    };
    const auto tanh_of = [](const D& a, const D&) {
        D s;
        scaled_sinh(a, s);
        return s;
    };
    const auto sech_of = [](const D& a, const D&) {
        D s;
        return scaled_sinh(a, s);
    };
    EXPECT_LT(error_of(8, sine, [](const Exact& a, const Exact&) { return sin(a); }), -94);
    EXPECT_LT(error_of(8, cosine, [](const Exact& a, const Exact&) { return cos(a); }), -94);
    EXPECT_LT(error_of(51, sine, [](const Exact& a, const Exact&) { return sin(a); }), -94);
    EXPECT_LT(error_of(
                  4, [](const D& a, const D&) { return tan(a); },
                  [](const Exact& a, const Exact&) { return tan(a); }),
              -94);
    EXPECT_LT(error_of(
                  100, [](const D& a, const D& b) { return atan2(a, b); },
                  [](const Exact& a, const Exact& b) { return atan2(a, b); }),
              -94);
    EXPECT_LT(log2_of_error(40, kSeed,
                            [](const D& a, const D&) {
                                const D part = a / (1 + fabs(a));
                                return pair(asin(part), Exact(asin(exact(part))));
                            }),
              -94);
    EXPECT_LT(log2_of_error(40, kSeed,
                            [](const D& a, const D&) {
                                const D part = a / (1 + fabs(a));
                                return pair(acos(part), Exact(acos(exact(part))));
                            }),
              -94);
    EXPECT_LT(error_of(
                  6, [](const D& a, const D&) { return exp(a); },
                  [](const Exact& a, const Exact&) { return exp(a); }),
              -94);
    EXPECT_LT(error_of(
                  300, [](const D& a, const D&) { return log(fabs(a)); },
                  [](const Exact& a, const Exact&) { return log(abs(a)); }),
              -94);
    // Next to 1 next to nothing is left.
    EXPECT_LT(log2_of_error(40, kSeed,
                            [](const D& a, const D&) {
                                const D near = 1 + a * 0x1p-45;
                                return pair(log(near), Exact(log(exact(near))));
                            }),
              -94);
    EXPECT_LT(error_of(
                  300, [](const D& a, const D&) { return asinh(a); },
                  [](const Exact& a, const Exact&) { return asinh(a); }),
              -94);
    EXPECT_LT(error_of(6, tanh_of, [](const Exact& a, const Exact&) { return tanh(a); }), -94);
    EXPECT_LT(error_of(6, sech_of, [](const Exact& a, const Exact&) { return 1 / cosh(a); }), -94);
    EXPECT_LT(error_of(
                  6, [](const D& a, const D&) { return pow(fabs(a), 1.7); },
                  [](const Exact& a, const Exact&) { return pow(abs(a), Exact(1.7)); }),
              -94);
}

TEST(DoubleDouble, WhatCancelsLeavesAsManyDigits) {
    constexpr unsigned kSeed = 3;
    RecordProperty("seed", static_cast<int>(kSeed));
    using D = DoubleDouble;
    const auto next_to = [](const D& a, const D& b) {
        return D(a.upper() * (1 + std::ldexp(1.0, -52 + std::abs(std::ilogb(b.upper())) % 8)),
                 b.lower() / b.upper() * a.upper());
    };
    EXPECT_LT(log2_of_error(2, kSeed,
                            [&](const D& a, const D& b) {
                                const D near = next_to(a, b);
                                return std::pair(near - a, Exact(exact(near) - exact(a)));
                            }),
              -102);
    // Next to multiples of a quarter of a turn, which are known to more digits than a DoubleDouble has.
    EXPECT_LT(log2_of_error(50, kSeed,
                            [](const D& a, const D&) {
                                const D near = std::round(std::fabs(a.upper())) * (D::pi() / 2);
                                D s, c;
                                sin_cos(near, s, c);
                                return std::pair(s * c, Exact(sin(exact(near)) * cos(exact(near))));
                            }),
              -92);
}

// Beyond kLargestAngle the second part of an angle is not asked: bounds know.
TEST(DoubleDouble, BoundsCountWhatLargeAnglesLose) {
    using R = Rounded<DoubleDouble>;
    for (const double lower : {1.5, -40.0, 100.0}) {
        const DoubleDouble angle(0x1p60, lower);
        DoubleDouble s, c;
        sin_cos(angle, s, c);
        R bound_s, bound_c;
        sin_cos(R(Interval(0x1p60 - 256, 0x1p60 + 256), 0, 0), bound_s, bound_c);
        EXPECT_GT(abs(exact(s) - sin(exact(angle))), 0.01);
        EXPECT_LE(abs(exact(s) - sin(exact(angle))), bound_s.error);
        EXPECT_LE(abs(exact(c) - cos(exact(angle))), bound_c.error);
    }
}

TEST(DoubleDouble, ConstantsAreNearest) {
    const Exact pi = boost::math::constants::pi<Exact>();
    EXPECT_LT(abs(exact(DoubleDouble::pi()) - pi), Exact(0x1p-107));
    EXPECT_EQ(DoubleDouble::pi().upper(), static_cast<double>(pi));
}

TEST(DoubleDouble, ExtremesAreThoseOfDouble) {
    const DoubleDouble huge = 0x1.fp1023, infinite = HUGE_VAL, none = NAN, zero = 0.0, tiny = 0x1p-1074;
    const auto is = [](const DoubleDouble& a, double value) {
        EXPECT_EQ(a.upper(), value);
        EXPECT_EQ(std::signbit(a.upper()), std::signbit(value));
        EXPECT_EQ(a.lower(), 0);
    };
    is(huge + huge, HUGE_VAL);
    is(-huge - huge, -HUGE_VAL);
    is(huge * -2, -HUGE_VAL);
    is(infinite + 1, HUGE_VAL);
    is(1 / zero, HUGE_VAL);
    is(1 / -zero, -HUGE_VAL);
    is(1 / infinite, 0);
    is(-zero * 1, -0.0);
    is(-zero + -zero, -0.0);
    is(tiny * 0.25, 0);
    is(huge / huge, 1);
    is(DoubleDouble(0x1.fffffffffffffp1023) / 0x1.fffffffffffffp1023, 1);
    is(sqrt(zero), 0);
    is(sqrt(infinite), HUGE_VAL);
    is(hypot(infinite, none), HUGE_VAL);
    is(hypot(-infinite, zero), HUGE_VAL);
    is(hypot(zero, -zero), 0);
    is(exp(-infinite), 0);
    is(exp(infinite), HUGE_VAL);
    is(exp(DoubleDouble(710)), HUGE_VAL);
    is(exp(DoubleDouble(-746)), 0);
    is(log(zero), -HUGE_VAL);
    is(log(infinite), HUGE_VAL);
    is(log(DoubleDouble(1)), 0);
    is(asinh(-infinite), -HUGE_VAL);
    is(asinh(-zero), -0.0);
    is(pow(zero, -2), HUGE_VAL);
    is(pow(zero, 2), 0);
    EXPECT_EQ(log(DoubleDouble(0x1.fffffffffffffp1023)).upper(), std::log(0x1.fffffffffffffp1023));
    EXPECT_EQ(log(tiny).upper(), std::log(0x1p-1074));
    EXPECT_EQ(asinh(DoubleDouble(0x1p1000)).upper(), std::asinh(0x1p1000));
    EXPECT_EQ(asinh(DoubleDouble(0x1p513)).upper(), std::asinh(0x1p513));
    is(atan2(-tiny, huge), -0.0);
    is(floor(DoubleDouble(2, -0x1p-60)), 1);
    is(floor(DoubleDouble(-2.5)), -3);
    for (const double y : {0.0, -0.0, 1.0, -1.0, HUGE_VAL, -HUGE_VAL})
        for (const double x : {0.0, -0.0, 1.0, -1.0, HUGE_VAL, -HUGE_VAL})
            EXPECT_EQ(atan2(DoubleDouble(y), DoubleDouble(x)).upper(), std::atan2(y, x)) << y << " " << x;
    DoubleDouble s, c;
    sin_cos(-zero, s, c);
    is(s, -0.0);
    is(c, 1);
    for (const DoubleDouble& a : {none, infinite, DoubleDouble(0x1p60)}) {
        sin_cos(a, s, c);
        if (isfinite(a))
            EXPECT_EQ(s.upper(), std::sin(0x1p60));
        else
            EXPECT_TRUE(isnan(s) && isnan(c));
    }
    for (const DoubleDouble& a :
         {none + 1, none * 0, none / 1, sqrt(-infinite), log(DoubleDouble(-1)), infinite - infinite,
          zero / zero, sqrt(DoubleDouble(-1)), exp(none), atan2(none, zero), asinh(none)})
        EXPECT_TRUE(isnan(a));
    // Of what underflows or overflows within a function nothing is seen.
    EXPECT_EQ(hypot(3 * huge, zero).upper(), HUGE_VAL);
    EXPECT_EQ(hypot(DoubleDouble(0x3p1020), DoubleDouble(0x4p1020)).upper(), 0x5p1020);
    EXPECT_EQ(hypot(DoubleDouble(0x3p-1060), DoubleDouble(0x4p-1060)).upper(), 0x5p-1060);
    EXPECT_EQ(atan2(DoubleDouble(0x3p-1060), DoubleDouble(0x3p-1060)).upper(), std::atan2(1, 1));
    EXPECT_EQ(atan2(DoubleDouble(0x3p1020), DoubleDouble(0x3p1020)).upper(), std::atan2(1, 1));
    EXPECT_EQ(scaled_sinh(DoubleDouble(-1000), s).upper(), kLeastScale);
    EXPECT_EQ(s.upper(), -1);
}

TEST(DoubleDouble, IsComparedByBothParts) {
    const DoubleDouble one = 1, more(1, 0x1p-80);
    EXPECT_TRUE(one < more && more > one && one != more && max(one, more) == more && min(one, more) == one);
    EXPECT_FALSE(DoubleDouble(NAN) < one || DoubleDouble(NAN) > one ||
                 DoubleDouble(NAN) == DoubleDouble(NAN));
    EXPECT_TRUE(is_zero(DoubleDouble(-0.0)) && is_negative(-one) && !is_negative(more));
    EXPECT_EQ(without_hair(DoubleDouble(-0x1p-40)), DoubleDouble());
    EXPECT_EQ(without_hair(DoubleDouble(-0x1p-30)), DoubleDouble(-0x1p-30));
}

}  // namespace
}  // namespace anamorph::test_double_double
