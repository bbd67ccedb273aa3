// SPDX-License-Identifier: Apache-2.0
// Taylor coefficients from interpolation in long double along lines are the truth: the part of degree k of a
// jet is a polynomial p_k(a, b) of the direction, and k + 1 directions pin all its coefficients.
#include "anamorph/number/jet.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace anamorph;
using Real = long double;

constexpr int kDegree = 4;
constexpr unsigned kSeed = 211;

/// A point of expansion and two polynomial coordinates around it, with all coefficients present.
struct Setting {
    std::array<double, 20> c;

    explicit Setting(unsigned seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> value(-0.6, 0.6);
        for (double& x : c) x = value(random);
    }
    template <class T>
    T polynomial(std::size_t at, const T& s, const T& t) const {
        return (s * c[at] + t * c[at + 1]) + (s * s * c[at + 2] + s * t * c[at + 3] + t * t * c[at + 4]) +
               (s * s * s * c[at + 5] + s * s * t * c[at + 6] + s * t * t * c[at + 7] +
                t * t * t * c[at + 8]) +
               c[at + 9];
    }
    template <class T>
    T u(const T& s, const T& t) const {
        return polynomial(0, s, t);
    }
    template <class T>
    T v(const T& s, const T& t) const {
        return polynomial(10, s, t);
    }
};

// Each formula is read with long double, jets of double and jets of intervals.
#define FORMULA(NAME, EXPRESSION)                                     \
    struct NAME {                                                     \
        static constexpr const char* name = #NAME;                    \
        template <class T>                                            \
        static T at(const Setting& setting, const T& s, const T& t) { \
            using std::asinh;                                         \
            using std::atan2;                                         \
            using std::sinh;                                          \
            using std::sqrt;                                          \
            const T u = setting.u(s, t), v = setting.v(s, t);         \
            static_cast<void>(v);                                     \
            return EXPRESSION;                                        \
        }                                                             \
    };

template <class T>
T sine(const T& a) {
    T s, c;
    sin_cos(a, s, c);
    return s;
}
template <class T>
T cosine(const T& a) {
    T s, c;
    sin_cos(a, s, c);
    return c;
}

FORMULA(Sum, u + v)
FORMULA(Difference, u - v)
FORMULA(Negative, -u)
FORMULA(Product, u* v)
FORMULA(Quotient, u / (v + 2.0))
FORMULA(Reciprocal, T(1) / (u - 2.0))
FORMULA(WithNumbers, (2.0 - u) * 3.0 + (1.5 + v) - 0.25 + 0.5 * u)
FORMULA(Square, square(u))
FORMULA(SquareRoot, sqrt(u + 2.0))
FORMULA(Sine, sine(T(u * 2.0)))
FORMULA(Cosine, cosine(T(u * 2.0)))
FORMULA(HyperbolicSine, sinh(u))
FORMULA(InverseHyperbolicSine, asinh(u))
FORMULA(AngleAhead, atan2(u, T(v + 2.0)))
FORMULA(AngleAbove, atan2(T(u + 2.0), v))
FORMULA(AngleBelow, atan2(T(u - 2.0), v))
FORMULA(AngleBehind, atan2(T(u + 1.0), T(v - 2.0)))
FORMULA(Composed, atan2(sine(u), sqrt(square(cosine(v)) + 0.5)) / (1.0 + square(v)))

template <class Formula>
class JetFormula : public testing::Test {};
using Formulas = testing::Types<Sum, Difference, Negative, Product, Quotient, Reciprocal, WithNumbers, Square,
                                SquareRoot, Sine, Cosine, HyperbolicSine, InverseHyperbolicSine, AngleAhead,
                                AngleAbove, AngleBelow, AngleBehind, Composed>;
struct FormulaNames {
    template <class Formula>
    static std::string GetName(int) {
        return Formula::name;
    }
};
TYPED_TEST_SUITE(JetFormula, Formulas, FormulaNames);

/// Coefficients 0 to 4 of the polynomial through f at 17 points of [-h, h].
std::array<Real, kDegree + 1> taylor(const std::function<Real(Real)>& f) {
    constexpr int kNodes = 17;
    const Real h = 0.1L;
    std::array<Real, kNodes> x, d;
    for (int i = 0; i < kNodes; ++i) {
        x[i] = h * std::cos(3.14159265358979323846264L * (i + 0.5L) / kNodes);
        d[i] = f(x[i]);
    }
    // Newton's divided differences, then to powers by Horner's scheme on polynomials.
    for (int k = 1; k < kNodes; ++k)
        for (int i = kNodes - 1; i >= k; --i) d[i] = (d[i] - d[i - 1]) / (x[i] - x[i - k]);
    std::array<Real, kNodes> c{};
    for (int k = kNodes - 1; k >= 0; --k) {
        for (int i = kNodes - 1; i > 0; --i) c[i] = c[i - 1] - x[k] * c[i];
        c[0] = d[k] - x[k] * c[0];
    }
    return {c[0], c[1], c[2], c[3], c[4]};
}

TYPED_TEST(JetFormula, HasTheTaylorCoefficientsUpToDegreeFour) {
    using J = Jet<double, kDegree>;
    for (unsigned seed = kSeed; seed < kSeed + 20; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Setting setting(seed);
        const J jet = TypeParam::template at<J>(setting, J::variable(0, 1, 0), J::variable(0, 0, 1));
        for (int direction = 0; direction < 7; ++direction) {
            const double a = std::cos(0.3 + direction * 0.45), b = std::sin(0.3 + direction * 0.45);
            const auto truth =
                taylor([&](Real r) { return TypeParam::template at<Real>(setting, a * r, b * r); });
            for (int k = 0; k <= kDegree; ++k) {
                Real part = 0;
                for (int j = 0; j <= k; ++j)
                    part += static_cast<Real>(jet.at(k - j, j)) * std::pow(static_cast<Real>(a), k - j) *
                            std::pow(static_cast<Real>(b), j);
                ASSERT_NEAR(static_cast<double>(part),
                            static_cast<double>(truth[static_cast<std::size_t>(k)]), 1e-9)
                    << "degree " << k;
            }
        }
    }
}

TYPED_TEST(JetFormula, LowerDegreesAreTheSameNumbers) {
    using J4 = Jet<double, 4>;
    const Setting setting(kSeed);
    const J4 four = TypeParam::template at<J4>(setting, J4::variable(0.01, 1, 0), J4::variable(0.02, 0, 1));
    const auto one = TypeParam::template at<Jet1<double>>(setting, Jet1<double>::variable(0.01, 1, 0),
                                                          Jet1<double>::variable(0.02, 0, 1));
    const auto two = TypeParam::template at<Jet2<double>>(setting, Jet2<double>::variable(0.01, 1, 0),
                                                          Jet2<double>::variable(0.02, 0, 1));
    for (int i = 0; i < Jet1<double>::kSize; ++i) EXPECT_EQ(one.c[i], four.c[i]);
    for (int i = 0; i < Jet2<double>::kSize; ++i) EXPECT_EQ(two.c[i], four.c[i]);
}

TYPED_TEST(JetFormula, IntervalsEncloseTheJetsOfAllPoints) {
    using J = Jet<double, kDegree>;
    using I = Jet<Interval, kDegree>;
    for (unsigned seed = kSeed; seed < kSeed + 20; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Setting setting(seed);
        std::mt19937 random(seed);
        for (const double radius : {0.0, 1e-9, 1e-3, 0.1}) {
            const I enclosure =
                TypeParam::template at<I>(setting, I::variable(Interval(-radius, radius), 1, 0),
                                          I::variable(Interval(-radius, radius), 0, 1));
            std::uniform_real_distribution<double> inside(-radius, radius);
            for (int i = 0; i < 20; ++i) {
                const double s = inside(random), t = inside(random);
                const J jet = TypeParam::template at<J>(setting, J::variable(s, 1, 0), J::variable(t, 0, 1));
                for (int k = 0; k < J::kSize; ++k)
                    ASSERT_TRUE(enclosure.c[k].contains(jet.c[k]))
                        << "coefficient " << k << ": " << jet.c[k] << " not in " << enclosure.c[k].lo << ", "
                        << enclosure.c[k].hi;
            }
        }
    }
}

// Lagrange: the coefficients of degree N over a box bound what the polynomial of degree N - 1 at its centre
// misses.
TYPED_TEST(JetFormula, IntervalsBoundTheRemainder) {
    using J = Jet<double, 2>;
    using I = Jet<Interval, 2>;
    const double h = 0.05;
    for (unsigned seed = kSeed; seed < kSeed + 20; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Setting setting(seed);
        const J jet = TypeParam::template at<J>(setting, J::variable(0, 1, 0), J::variable(0, 0, 1));
        const I box = TypeParam::template at<I>(setting, I::variable(Interval(-h, h), 1, 0),
                                                I::variable(Interval(-h, h), 0, 1));
        for (double s = -h; s <= h; s += h / 4)
            for (double t = -h; t <= h; t += h / 4) {
                const Real missed = TypeParam::template at<Real>(setting, s, t) -
                                    (jet.c[0] + jet.c[1] * Real(s) + jet.c[2] * Real(t));
                const Interval bound =
                    box.c[3] * Interval(s * s) + box.c[4] * Interval(s * t) + box.c[5] * Interval(t * t);
                ASSERT_GE(static_cast<double>(missed), bound.lo - 1e-14);
                ASSERT_LE(static_cast<double>(missed), bound.hi + 1e-14);
            }
    }
}

using J = Jet<double, kDegree>;

void expect_same(const J& a, const J& b, double allowed = 1e-13) {
    for (int i = 0; i < J::kSize; ++i) EXPECT_NEAR(a.c[i], b.c[i], allowed) << i;
}

TEST(Jet, IdentitiesHoldInEveryCoefficient) {
    for (unsigned seed = kSeed; seed < kSeed + 50; ++seed) {
        SCOPED_TRACE(testing::Message() << "seed " << seed);
        const Setting setting(seed);
        const J s = J::variable(0, 1, 0), t = J::variable(0, 0, 1);
        const J u = setting.u(s, t), v = setting.v(s, t);
        expect_same(square(u), u * u);
        expect_same(u / (v + 3.0) * (v + 3.0), u);
        expect_same(square(sqrt(u + 3.0)), u + 3.0);
        expect_same(square(sine(u)) + square(cosine(u)), J(1));
        expect_same(asinh(sinh(u)), u, 1e-12);
        expect_same(atan2((v + 3.0) * sine(u), (v + 3.0) * cosine(u)), u, 1e-12);
        expect_same(sine(u + v), sine(u) * cosine(v) + cosine(u) * sine(v));
    }
}

TEST(Jet, OnAPartIsTheSamePolynomialInItsOffsets) {
    SCOPED_TRACE("seed " + std::to_string(kSeed));
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> value(-1, 1);
    const auto at = [](const Jet<double, kDegree>& f, double s, double t) {
        Real sum = 0;
        for (int i = 0; i <= kDegree; ++i)
            for (int j = 0; i + j <= kDegree; ++j)
                sum += f.at(i, j) * std::pow(Real(s), i) * std::pow(Real(t), j);
        return static_cast<double>(sum);
    };
    for (int round = 0; round < 50; ++round) {
        Jet<double, kDegree> f;
        for (double& c : f.c) c = value(random);
        const double shift_s = value(random), shift_t = value(random);
        const double scale_s = round % 3 ? value(random) : 1, scale_t = round % 4 ? value(random) : 1;
        // A side that is not scaled is the whole side, and not moved either.
        const double moved_s = scale_s == 1 ? 0 : shift_s, moved_t = scale_t == 1 ? 0 : shift_t;
        const auto g = on_part(f, moved_s, scale_s, moved_t, scale_t);
        for (int point = 0; point < 10; ++point) {
            const double s = value(random), t = value(random);
            EXPECT_NEAR(at(g, s, t), at(f, moved_s + scale_s * s, moved_t + scale_t * t), 1e-13);
        }
    }
}

TEST(Jet, CoefficientsStandWhereTheHeaderSays) {
    const J s = J::variable(0, 1, 0), t = J::variable(0, 0, 1);
    const J p = s * s * s * t * 7.0 + t * t * 5.0 + s * 2.0 + 11.0;
    for (int i = 0; i <= 4; ++i)
        for (int j = 0; i + j <= 4; ++j) {
            const double expected = i == 3 && j == 1   ? 7
                                    : i == 0 && j == 2 ? 5
                                    : i == 1 && j == 0 ? 2
                                    : i + j == 0       ? 11
                                                       : 0;
            EXPECT_EQ(p.at(i, j), expected) << i << ' ' << j;
        }
    // Products above the degree are cut off.
    const J zero = s * s * s * (t * t);
    for (const double c : zero.c) EXPECT_EQ(c, 0);
    EXPECT_EQ(J(3).value(), 3);
    EXPECT_EQ(J(2.0f).value(), 2);
    EXPECT_EQ(constant_part(p), 11);
    EXPECT_EQ(lower_end(Interval(2, 3)), 2);
    EXPECT_TRUE(is_zero(Interval(0)));
    EXPECT_FALSE(is_zero(Interval(0, 1)));
}

// Coefficients of all magnitudes, narrow, wide, of either sign and zero: products of members are enclosed. An
// end that is no number bounds nothing, and says so.
TEST(Jet, ProductsOfIntervalsEncloseThoseOfTheirMembers) {
    SCOPED_TRACE("seed " + std::to_string(kSeed));
    std::mt19937 random(kSeed);
    using I = Jet<Interval, 5>;
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    // A box of coefficients, and members of it, most often its ends.
    const auto fill = [&](I& box, std::array<Real, I::kSize>& member, double least, double most) {
        for (std::size_t i = 0; i < member.size(); ++i) {
            const double a = between(-1, 1) * std::exp2(between(least, most));
            const double b =
                random() % 3 ? a * between(0.5, 1.5) : between(-1, 1) * std::exp2(between(least, most));
            box.c[i] = random() % 6 ? Interval(std::min(a, b), std::max(a, b)) : Interval(0);
            member[i] = random() % 3
                            ? (random() % 2 ? box.c[i].lo : box.c[i].hi)
                            : std::clamp(between(box.c[i].lo, box.c[i].hi), box.c[i].lo, box.c[i].hi);
        }
    };
    int bounded = 0, all = 0;
    for (int round = 0; round < 3000; ++round) {
        const double middle = round % 2 ? 0 : between(-1060, 1000), spread = between(0, 40);
        I f, g;
        std::array<Real, I::kSize> p, q;
        fill(f, p, std::max(-1074.0, middle - spread), std::min(1023.0, middle + spread));
        fill(g, q, -spread, spread);
        const I product = f * g;
        for (int k = 0; k <= 5; ++k)
            for (int m = 0; m <= k; ++m) {
                Real exact = 0, size = 0;
                for (int a = 0; a <= k; ++a)
                    for (int i = std::max(0, m - (k - a)); i <= std::min(a, m); ++i) {
                        const Real term = p[static_cast<std::size_t>(I::part(a) + i)] *
                                          q[static_cast<std::size_t>(I::part(k - a) + m - i)];
                        exact += term;
                        size += std::fabs(term);
                    }
                const Interval& bound = product.c[I::part(k) + m];
                bounded += bound.hi - bound.lo <= 4 * size + 1e-280L;
                ++all;
                ASSERT_FALSE(bound.lo > exact + 1e-18L * size) << round << ' ' << k << ' ' << m;
                ASSERT_FALSE(bound.hi < exact - 1e-18L * size) << round << ' ' << k << ' ' << m;
            }
    }
    EXPECT_GT(bounded, all / 4);
}

// Of log(x + i y), with coefficients of magnitude (i + j over i) / ((i + j) |x + i y|^(i + j)), a box as wide as a quarter of its
// distance knows little more than what is nearest to 0 in it.
TEST(Jet, AnglesAreBoundedOverWideBoxes) {
    using I = Jet<Interval, 5>;
    for (const double turn : {0.0, 0.7, 2.0, -3.0}) {
        const double at_x = std::cos(turn), at_y = std::sin(turn), half = 0.125;
        const I x = I::variable({at_x - half, at_x + half}, 1, 0),
                y = I::variable({at_y - half, at_y + half}, 0, 1), angle = atan2(y, x);
        const double nearest = 1 - half * (std::fabs(at_x) + std::fabs(at_y));
        const double over[] = {1, 5, 10, 10, 5, 1};
        for (int j = 0; j <= 5; ++j)
            EXPECT_LE(magnitude(angle.at(5 - j, j)), 2.5 * over[j] / 5 * std::pow(nearest, -5)) << turn << j;
    }
}

TEST(Jet, WhatHasNoDerivativeHasNoBound) {
    using I = Jet2<Interval>;
    const I s = I::variable(Interval(-1, 1), 1, 0);
    const auto bounded = [](const I& jet) {
        bool all = true;
        for (const Interval& c : jet.c) all = all && magnitude(c) <= 1e300;
        return all;
    };
    EXPECT_TRUE(bounded(s * s));
    EXPECT_FALSE(bounded(I(1) / s));
    EXPECT_FALSE(bounded(sqrt(s)));
    EXPECT_FALSE(bounded(sqrt(square(s))));
    EXPECT_FALSE(bounded(atan2(s, s)));
    EXPECT_FALSE(bounded(atan2(s, I(0))));
}

}  // namespace
