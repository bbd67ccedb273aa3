// SPDX-License-Identifier: Apache-2.0
// Four jets at once: polynomials and bounds of formulas, held against the formulas in long double; each of four as if it
// were alone, with the same bits on every instruction set.
#include "anamorph/number/jets.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <vector>

#include "each_instruction_set.h"

namespace anamorph::test_jets {
namespace {

using simd::BoundJets;
using simd::kJets;
using simd::TaylorJets;

static_assert(FormulaNumber<TaylorJets> && FormulaNumber<BoundJets>);

constexpr int kFunctions = 14;
constexpr const char* kNames[kFunctions] = {"product", "quotient", "square", "sqrt", "sin",
                                            "cos",     "atan2",    "exp",    "log",  "asinh",
                                            "sinh",    "select",   "sums",   "line"};

/// Formulas of two variables that lie between -1 and 1.
template <class T>
T formula(int which, const T& x, const T& y) {
    const T u = x * y + x * 0.5 + 2.0, v = square(y) - x * 0.75 + 0.25;
    T s, c;
    switch (which) {
        case 0:
            return u * v;
        case 1:
            return v / u;
        case 2:
            return square(v);
        case 3:
            return sqrt(u);
        case 4:
            sin_cos(v, s, c);
            return s;
        case 5:
            sin_cos(v, s, c);
            return c;
        case 6:
            return atan2(v, u);
        case 7:
            return exp(v);
        case 8:
            return log(u);
        case 9:
            return asinh(v);
        case 10: {
            const T one = T(1.0) * scaled_sinh(v, s);
            return s / one;
        }
        case 11:
            return select(is_negative(T(u - 100.0)), u, v) + min(T(x - 5.0), T(y + 5.0)) - max(x, T(y + 5.0));
        case 12:
            return 3.0 - (u - v * 0.3) + (-x);
        default:
            return 2.0 * x - y + 1.0;
    }
}

struct Case {
    double x[kJets], y[kJets], size[kJets];
};
Case random_case(std::mt19937& random) {
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    Case c;
    for (int i = 0; i < kJets; ++i) {
        c.x[i] = between(-0.9, 0.9);
        c.y[i] = between(-0.9, 0.9);
        c.size[i] = std::ldexp(1.0, -static_cast<int>(between(4, 9)));
    }
    return c;
}

TaylorJets taylor(int which, const Case& c) {
    constexpr double kNone[kJets] = {};
    return formula(which, TaylorJets::variable(c.x, c.size, kNone), TaylorJets::variable(c.y, kNone, c.size));
}
BoundJets bound(int which, const Case& c) {
    constexpr double kOnes[kJets] = {1, 1, 1, 1}, kNone[kJets] = {};
    Interval x[kJets], y[kJets];
    for (int i = 0; i < kJets; ++i) {
        x[i] = {c.x[i] - c.size[i], c.x[i] + c.size[i]};
        y[i] = {c.y[i] - c.size[i], c.y[i] + c.size[i]};
    }
    return formula(which, BoundJets::variable(x, kOnes, kNone), BoundJets::variable(y, kNone, kOnes));
}

/// The polynomial is within the remainder of the formula all over its box, which the bound's constant part holds.
void examine(int which, const Case& c, std::mt19937& random) {
    const TaylorJets polynomials = taylor(which, c);
    const BoundJets bounds = bound(which, c);
    for (int i = 0; i < kJets; ++i) {
        const Jet<double, 4> p = polynomials.at(i);
        const Jet<Interval, 5> b = bounds.at(i);
        double remainder = 0;
        for (int j = 0; j <= 5; ++j) remainder += magnitude(b.at(5 - j, j)) * std::pow(c.size[i], 5);
        EXPECT_LT(remainder, 0.1);
        for (int k = 0; k < 8; ++k) {
            const double s = std::uniform_real_distribution<double>(-1, 1)(random),
                         t = std::uniform_real_distribution<double>(-1, 1)(random);
            const long double exact =
                formula<long double>(which, c.x[i] + static_cast<long double>(s) * c.size[i],
                                     c.y[i] + static_cast<long double>(t) * c.size[i]);
            long double sum = 0;
            for (int d = 0; d <= 4; ++d)
                for (int j = 0; j <= d; ++j)
                    sum += static_cast<long double>(p.at(d - j, j)) *
                           std::pow(static_cast<long double>(s), d - j) *
                           std::pow(static_cast<long double>(t), j);
            EXPECT_LE(std::fabs(static_cast<double>(sum - exact)), remainder + 1e-14);
            EXPECT_TRUE(b.c[0].lo <= exact && exact <= b.c[0].hi);
        }
    }
}

TEST(NumbersJets, PolynomialsAreWithinTheirBounds) {
    test::on_every_instruction_set([] {
        std::mt19937 random(7);
        for (int which = 0; which < kFunctions; ++which) {
            SCOPED_TRACE(kNames[which]);
            for (int n = 0; n < 200; ++n) examine(which, random_case(random), random);
        }
    });
}

template <class T, int N>
std::vector<double> bits(const simd::Jets<T, N>& jets, int i) {
    std::vector<double> all;
    const Jet<T, N> jet = jets.at(i);
    for (const T& c : jet.c)
        if constexpr (std::is_same_v<T, Interval>)
            all.insert(all.end(), {c.lo, c.hi});
        else
            all.push_back(c);
    return all;
}
bool same(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST(NumbersJets, EachIsAsIfAloneAndTheSameOnEveryInstructionSet) {
    for (int which = 0; which < kFunctions; ++which) {
        SCOPED_TRACE(kNames[which]);
        std::mt19937 random(8);
        for (int n = 0; n < 50; ++n) {
            const Case c = random_case(random);
            const TaylorJets p = taylor(which, c);
            const BoundJets b = bound(which, c);
            // Behind another, in the other order.
            Case turned = random_case(random);
            for (int i = 0; i < kJets - 1; ++i) {
                turned.x[i + 1] = c.x[kJets - 1 - i];
                turned.y[i + 1] = c.y[kJets - 1 - i];
                turned.size[i + 1] = c.size[kJets - 1 - i];
            }
            turned.x[0] = n % 2 == 0 ? NAN : 1e300;
            test::on_every_instruction_set([&] {
                const TaylorJets q = taylor(which, c), r = taylor(which, turned);
                const BoundJets d = bound(which, c), e = bound(which, turned);
                for (int i = 0; i < kJets; ++i) {
                    EXPECT_TRUE(same(bits(p, i), bits(q, i)) && same(bits(b, i), bits(d, i)));
                    if (i == 0) continue;
                    EXPECT_TRUE(same(bits(p, i), bits(r, kJets - i)) && same(bits(b, i), bits(e, kJets - i)));
                }
            });
        }
    }
}

TEST(NumbersJets, NothingIsKnownOfWhatIsNotFinite) {
    const double x[kJets] = {0, NAN, HUGE_VAL, 1}, ones[kJets] = {1, 1, 1, 1}, none[kJets] = {};
    const Interval across[kJets] = {{-1, 1}, {NAN, NAN}, {0, HUGE_VAL}, 1};
    const BoundJets b = BoundJets(1.0) / BoundJets::variable(across, ones, none);
    const TaylorJets t = sqrt(TaylorJets::variable(x, ones, none));
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(magnitude(b.at(i).at(1, 0)) < 1e300) << i;
    EXPECT_TRUE(b.at(3).c[0].contains(1) && b.at(3).c[1].contains(-1));
    EXPECT_FALSE(std::fabs(t.at(0).c[1]) < 1e300 || std::fabs(t.at(1).c[1]) < 1e300);
    EXPECT_EQ(t.at(3).c[1], 0.5);
}

}  // namespace
}  // namespace anamorph::test_jets
