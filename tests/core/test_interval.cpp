// SPDX-License-Identifier: Apache-2.0
// long double (64 bits of significand) is the truth: its own rounding is far below an interval's margin.
#include "anamorph/number/interval.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <ostream>
#include <random>
#include <string>
#include <vector>

namespace anamorph {

static void PrintTo(const Interval& a, std::ostream* out) {
    *out << testing::Message() << std::hexfloat << '[' << a.lo << ", " << a.hi << ']';
}

}  // namespace anamorph

namespace anamorph::test_interval {
namespace {

using Real = long double;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr unsigned kSeed = 101;

class Random {
  public:
    explicit Random(unsigned seed) : m_engine(seed) {}
    double between(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(m_engine);
    }
    int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(m_engine); }
    /// Of any magnitude 2^-e to 2^e, either sign.
    double number(int e) { return std::ldexp(between(-2, 2), integer(-e, e)); }
    /// A point, a few ULP, a fraction of its magnitude, or wide.
    Interval interval(int e) {
        const double a = number(e);
        switch (integer(0, 3)) {
            case 0:
                return a;
            case 1:
                return {a, std::nextafter(std::nextafter(a, kInfinity), kInfinity)};
            case 2:
                return {a, a + std::fabs(a) * between(0, 0.5)};
            default: {
                const double b = number(e);
                return {std::min(a, b), std::max(a, b)};
            }
        }
    }
    double member(const Interval& a) {
        const int pick = integer(0, 4);
        if (pick == 0) return a.lo;
        if (pick == 1) return a.hi;
        return std::clamp(a.lo + (a.hi - a.lo) * between(0, 1), a.lo, a.hi);
    }

  private:
    std::mt19937_64 m_engine;
};

testing::AssertionResult encloses(const Interval& a, Real value) {
    if (static_cast<Real>(a.lo) <= value && value <= static_cast<Real>(a.hi))
        return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << testing::PrintToString(a) << " does not hold " << std::hexfloat << value;
}

struct Unary {
    std::string name;
    std::function<Interval(const Interval&)> interval;
    std::function<Real(Real)> truth;
    std::function<double(double)> libm;
    int exponent;  ///< magnitudes up to 2^exponent
    bool positive;
};

// The names of both kinds of functions meet in these macro-free tables through overloads.
const std::vector<Unary>& unary_functions() {
    static const std::vector<Unary> table = {
        {"sin", [](const Interval& a) { return sin(a); }, [](Real a) { return std::sin(a); },
         [](double a) { return std::sin(a); }, 20, false},
        {"cos", [](const Interval& a) { return cos(a); }, [](Real a) { return std::cos(a); },
         [](double a) { return std::cos(a); }, 20, false},
        {"sinh", [](const Interval& a) { return sinh(a); }, [](Real a) { return std::sinh(a); },
         [](double a) { return std::sinh(a); }, 8, false},
        {"cosh", [](const Interval& a) { return cosh(a); }, [](Real a) { return std::cosh(a); },
         [](double a) { return std::cosh(a); }, 8, false},
        {"asinh", [](const Interval& a) { return asinh(a); }, [](Real a) { return std::asinh(a); },
         [](double a) { return std::asinh(a); }, 300, false},
        {"tanh", [](const Interval& a) { return tanh(a); }, [](Real a) { return std::tanh(a); },
         [](double a) { return std::tanh(a); }, 300, false},
        {"exp", [](const Interval& a) { return exp(a); }, [](Real a) { return std::exp(a); },
         [](double a) { return std::exp(a); }, 8, false},
        {"log", [](const Interval& a) { return log(a); }, [](Real a) { return std::log(a); },
         [](double a) { return std::log(a); }, 300, true},
        {"sqrt", [](const Interval& a) { return sqrt(a); }, [](Real a) { return std::sqrt(a); },
         [](double a) { return std::sqrt(a); }, 400, true},
        {"square", [](const Interval& a) { return square(a); }, [](Real a) { return a * a; },
         [](double a) { return a * a; }, 400, false},
        {"minus", [](const Interval& a) { return -a; }, [](Real a) { return -a; },
         [](double a) { return -a; }, 400, false},
    };
    return table;
}

TEST(Interval, FunctionsEncloseTheirValues) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    Random random(kSeed);
    for (const Unary& f : unary_functions()) {
        for (int i = 0; i < 40000; ++i) {
            Interval a = random.interval(f.exponent);
            if (f.positive) {
                a = {std::fabs(a.lo), std::fabs(a.hi)};
                if (a.lo > a.hi) std::swap(a.lo, a.hi);
            }
            const Interval r = f.interval(a);
            for (int k = 0; k < 4; ++k) {
                const double x = random.member(a);
                ASSERT_TRUE(encloses(r, f.truth(x)))
                    << f.name << " of " << testing::PrintToString(a) << " at " << std::hexfloat << x;
            }
        }
    }
}

TEST(Interval, OperationsEncloseTheirValues) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    Random random(kSeed);
    for (int i = 0; i < 100000; ++i) {
        const Interval a = random.interval(200), b = random.interval(200);
        const Interval sum = a + b, difference = a - b, product = a * b, quotient = a / b;
        Interval in_place = a;
        in_place += b;
        EXPECT_EQ(in_place.lo, sum.lo);
        for (int k = 0; k < 4; ++k) {
            const Real x = random.member(a), y = random.member(b);
            ASSERT_TRUE(encloses(sum, x + y));
            ASSERT_TRUE(encloses(difference, x - y));
            ASSERT_TRUE(encloses(product, x * y));
            if (y != 0) {
                ASSERT_TRUE(encloses(quotient, x / y));
            }
        }
    }
}

TEST(Interval, PowersEncloseTheirValues) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    Random random(kSeed);
    for (int i = 0; i < 100000; ++i) {
        Interval a = random.interval(20), b = random.interval(4);
        a = {std::min(std::fabs(a.lo), std::fabs(a.hi)), std::max(std::fabs(a.lo), std::fabs(a.hi))};
        if (i % 10 == 0) a.lo = 0;
        const Interval r = pow(a, b);
        for (int k = 0; k < 4; ++k) {
            const Real x = random.member(a), y = random.member(b);
            if (x == 0 && y < 0) continue;
            ASSERT_TRUE(encloses(r, std::pow(x, y)))
                << testing::PrintToString(a) << ' ' << testing::PrintToString(b);
        }
    }
    EXPECT_EQ(pow(Interval(-1, 1), Interval(2)), Interval::all());
}

TEST(Interval, UnderflowIsEnclosed) {
    Random random(kSeed);
    for (int i = 0; i < 100000; ++i) {
        const auto tiny = [&] {
            const double v = random.number(1) * std::ldexp(1.0, random.integer(-600, -480));
            return random.integer(0, 1) ? Interval(v) : Interval(std::min(v, -v / 3), std::max(v, -v / 3));
        };
        const Interval a = tiny(), b = tiny(), large = random.number(1) * std::ldexp(1.0, 540);
        const Real x = random.member(a), y = random.member(b), z = large.lo;
        ASSERT_TRUE(encloses(a * b, x * y)) << testing::PrintToString(a) << ' ' << testing::PrintToString(b);
        ASSERT_TRUE(encloses(square(a), x * x)) << testing::PrintToString(a);
        ASSERT_TRUE(encloses(a / large, x / z)) << testing::PrintToString(a);
        ASSERT_TRUE(encloses(Interval(1) / (large * large), 1 / (z * z)));
        ASSERT_TRUE(encloses(atan2(a, Interval(std::fabs(large.lo))), std::atan2(x, std::fabs(z))));
    }
    for (const double x : {-740.0, -745.0, -750.0, -1e4, 709.0, 710.0, 1e4})
        ASSERT_TRUE(encloses(exp(Interval(x)), std::exp(static_cast<Real>(x)))) << x;
    // Nothing times nothing stays nothing.
    EXPECT_EQ(Interval(0) * Interval(-3, 5), Interval(0));
    EXPECT_EQ(Interval(0, 2) * Interval(3, 4) >= Interval(-1e-300), true);
}

TEST(Interval, ComparisonsHoldForAllMembers) {
    EXPECT_TRUE(Interval(1, 2) < Interval(3, 4));
    EXPECT_FALSE(Interval(1, 3) < Interval(3, 4));
    EXPECT_TRUE(Interval(1, 3) <= Interval(3, 4));
    EXPECT_FALSE(Interval(1, 5) < Interval(3, 4));
    EXPECT_FALSE(Interval(1, 5) >= Interval(3, 4));
    EXPECT_TRUE(Interval(5, 6) > Interval(3, 4));
    EXPECT_TRUE(Interval(1, 2) == Interval(1, 2));
    EXPECT_FALSE(Interval(1, 2) == Interval(1, 3));
    EXPECT_FALSE(Interval(kNan) < Interval(1));
    EXPECT_FALSE(Interval(kNan) == Interval(kNan));
}

TEST(Interval, AnglesEncloseTheirValues) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    Random random(kSeed);
    for (int i = 0; i < 200000; ++i) {
        const int e = i % 2 ? 3 : 100;
        const Interval y = random.interval(e), x = random.interval(e);
        const Interval r = atan2(y, x);
        for (int k = 0; k < 4; ++k) {
            const Real v = random.member(y), u = random.member(x);
            if (u == 0 && v == 0) continue;
            ASSERT_TRUE(encloses(r, std::atan2(v, u)))
                << testing::PrintToString(y) << ' ' << testing::PrintToString(x);
        }
    }
}

TEST(Interval, LibmStaysWellInsideTheMargin) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    Random random(kSeed);
    const auto relative = [](double found, Real truth) {
        return truth == 0 ? Real(0) : std::fabs((static_cast<Real>(found) - truth) / truth);
    };
    const Real allowed = interval_detail::kLibmMargin / 2;
    for (const Unary& f : unary_functions())
        for (int i = 0; i < 200000; ++i) {
            double x = random.number(f.exponent);
            if (f.positive) x = std::fabs(x);
            ASSERT_LE(relative(f.libm(x), f.truth(x)), allowed) << f.name << ' ' << std::hexfloat << x;
        }
    for (int i = 0; i < 500000; ++i) {
        const double y = random.number(i % 2 ? 3 : 100), x = random.number(i % 2 ? 3 : 100);
        ASSERT_LE(relative(std::atan2(y, x), std::atan2(static_cast<Real>(y), static_cast<Real>(x))),
                  allowed);
    }
}

TEST(Interval, PointsStayNarrow) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    Random random(kSeed);
    const auto width = [](const Interval& r) { return (r.hi - r.lo) / magnitude(r); };
    for (int i = 0; i < 20000; ++i) {
        const double a = random.number(60), b = random.number(60);
        EXPECT_LE(width(Interval(a) + Interval(b)), 4 * 0x1p-52);
        EXPECT_LE(width(Interval(a) * Interval(b)), 4 * 0x1p-52);
        EXPECT_LE(width(Interval(a) / Interval(b)), 8 * 0x1p-52);
        EXPECT_LE(width(square(Interval(a))), 4 * 0x1p-52);
        EXPECT_LE(width(sqrt(Interval(std::fabs(a)))), 4 * 0x1p-52);
        EXPECT_LE(width(atan2(Interval(a), Interval(std::fabs(b)))), 20 * 0x1p-52);
        EXPECT_LE(width(asinh(Interval(a))), 20 * 0x1p-52);
    }
    // Away from their extrema and zeros, where the test for an extremum must not fire.
    for (const double x : {0.3, 1.2, 2.0, -0.7, 4.0, 100.0}) {
        EXPECT_LE(width(sin(Interval(x))), 20 * 0x1p-52) << x;
        EXPECT_LE(width(cos(Interval(x))), 20 * 0x1p-52) << x;
    }
}

TEST(Interval, WavesReachTheirExtrema) {
    const double pi = 3.14159265358979323846;
    for (int k = -3; k <= 3; ++k) {
        const double top = 2 * k * pi;
        EXPECT_EQ(cos(Interval(top - 0.1, top + 0.2)).hi, 1);
        EXPECT_EQ(cos(Interval(top + pi - 0.1, top + pi + 0.2)).lo, -1);
        EXPECT_EQ(sin(Interval(top + pi / 2 - 0.1, top + pi / 2 + 0.2)).hi, 1);
        EXPECT_EQ(sin(Interval(top - pi / 2 - 0.1, top - pi / 2 + 0.2)).lo, -1);
        const Interval slope = cos(Interval(top + 0.1, top + 3));
        EXPECT_LT(slope.hi, 0.9951);
        EXPECT_GT(slope.lo, -0.99);
    }
    const Interval whole = sin(Interval(0, 7));
    EXPECT_EQ(whole.lo, -1);
    EXPECT_EQ(whole.hi, 1);
    EXPECT_EQ(cosh(Interval(-1, 2)).lo <= 1, true);
}

TEST(Interval, SquaresAreNeverNegative) {
    EXPECT_EQ(square(Interval(-3, 2)).lo, 0);
    EXPECT_GE(square(Interval(-3, 2)).hi, 9);
    EXPECT_GE(square(Interval(1e-160, 1)).lo, 0);
    EXPECT_GE(sqrt(Interval(0, 4)).lo, 0);
}

TEST(Interval, TheCutIsAWholeCircle) {
    const Interval r = atan2(Interval(-1, 1), Interval(-2, -1));
    EXPECT_LE(r.lo, -3.141592653589793);
    EXPECT_GE(r.hi, 3.141592653589793);
    const Interval at_origin = atan2(Interval(0), Interval(0));
    EXPECT_LE(at_origin.lo, -3.141592653589793);
    // Beside the cut it is not.
    EXPECT_GT(atan2(Interval(0.5, 1), Interval(-2, -1)).lo, 2);
    EXPECT_LT(atan2(Interval(-1, -0.5), Interval(-2, -1)).hi, -2);
}

// What has no bound must fail the test every bound is put to.
TEST(Interval, WhatHasNoBoundFailsEveryBound) {
    const auto holds = [](const Interval& a) { return magnitude(a) <= 1e308; };
    EXPECT_TRUE(holds(Interval(1, 2)));
    EXPECT_FALSE(holds(Interval(1) / Interval(-1, 1)));
    EXPECT_FALSE(holds(Interval(0) / Interval(0, 1)));
    EXPECT_FALSE(holds(Interval(1) / Interval(0)));
    EXPECT_FALSE(holds(sqrt(Interval(-4, -1))));
    EXPECT_FALSE(holds(Interval::all()));
    EXPECT_FALSE(holds(Interval::all() - Interval::all()));
    EXPECT_FALSE(holds(Interval::all() * Interval(1, 2)));
    EXPECT_FALSE(holds(Interval::all() * Interval(-1, 1)));
    const Interval bad[] = {Interval(kNan), Interval(kNan, 1), Interval(1, kNan), sqrt(Interval(-1, 4)),
                            -sqrt(Interval(-1, 4))};
    for (const Interval& a : bad) {
        EXPECT_FALSE(holds(a));
        EXPECT_FALSE(holds(-a));
        for (const Interval& b : {Interval(1), Interval(-2, 3), Interval::all(), a}) {
            EXPECT_FALSE(holds(a + b));
            EXPECT_FALSE(holds(a - b));
            EXPECT_FALSE(holds(b - a));
            EXPECT_FALSE(holds(a * b));
            EXPECT_FALSE(holds(b * a));
            EXPECT_FALSE(holds(a / b));
            EXPECT_FALSE(holds(b / a));
        }
        EXPECT_FALSE(holds(square(a)));
        EXPECT_FALSE(holds(sinh(a)));
        EXPECT_FALSE(holds(cosh(a)));
        EXPECT_FALSE(holds(asinh(a)));
    }
}

}  // namespace
}  // namespace anamorph::test_interval
