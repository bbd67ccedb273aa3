// SPDX-License-Identifier: Apache-2.0
// Formulas that are text: what they say, where there is no point, and blocks whose bounds hold wherever a formula jumps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <random>

#include "anamorph/error.h"
#include "anamorph/formula/text_plan.h"
#include "block_points.h"
#include "each_instruction_set.h"

namespace anamorph::test_text_map {
namespace {

constexpr Size kPicture{48, 32}, kSource{200, 100};

Point<double> point_of(const FormulaText& text, double x, double y,
                       FormulaSetting setting = {kPicture, kSource}) {
    const PlaneFormula formula = parse_formula(text, setting);
    return read_point(formula.point, x, y);
}
double value_of(const std::string& expression, double x = 20.5, double y = 10.5) {
    FormulaText text;
    text.u = expression;
    return point_of(text, x, y).x;
}
bool is_inside(const std::string& expression, double x = 20.5, double y = 10.5) {
    FormulaText text;
    text.u = expression;
    const PlaneFormula formula = parse_formula(text, {kPicture, kSource});
    return formula.is_everywhere || read_point(formula.domain, x, y).x > 0;
}

TEST(TextMap, NamesStandForThePlaceOfAPixel) {
    const double px = (20.5 - 24) / 16, py = (16 - 10.5) / 16;
    EXPECT_EQ(value_of("x"), 20.5);
    EXPECT_EQ(value_of("y"), 10.5);
    EXPECT_DOUBLE_EQ(value_of("s"), 20.5 / 48);
    EXPECT_DOUBLE_EQ(value_of("t"), 10.5 / 32);
    EXPECT_DOUBLE_EQ(value_of("px"), px);
    EXPECT_DOUBLE_EQ(value_of("py"), py);
    EXPECT_DOUBLE_EQ(value_of("r"), std::hypot(px, py));
    EXPECT_DOUBLE_EQ(value_of("a"), std::atan2(py, px));
    EXPECT_EQ(value_of("width*1000+height"), 48032);
    EXPECT_EQ(value_of("src_width*1000+src_height"), 200100);
    EXPECT_DOUBLE_EQ(value_of("pi"), std::numbers::pi);
    FormulaText text;
    text.u = "s+frame";
    text.v = "t";
    const Point<double> p = point_of(text, 24, 8, {kPicture, kSource, 2, true});
    EXPECT_DOUBLE_EQ(p.x, 500);
    EXPECT_DOUBLE_EQ(p.y, 25);
}

TEST(TextMap, OperatorsBindAsInMathematics) {
    for (const auto& [text, value] :
         std::vector<std::pair<std::string, double>>{{"1+2*3", 7},
                                                     {"(1+2)*3", 9},
                                                     {"10-4-3", 3},
                                                     {"64/4/2", 8},
                                                     {"-2^2", -4},
                                                     {"2^3^2", 512},
                                                     {"2^-1", 0.5},
                                                     {"--3", 3},
                                                     {"2*-3", -6},
                                                     {"7%3", 1},
                                                     {"-7%3", 2},
                                                     {"1e3+.5+1.25E-2", 1000.5125},
                                                     {"if(1<2,3,4)", 3},
                                                     {"if(2<=2 and not 2!=2,3,4)", 3},
                                                     {"if(1>2 or 2>=3 or 1==2,3,4)", 4},
                                                     {"if(not(1<2) or 1<2 and 2<1,3,4)", 4},
                                                     {"if((1<2),(3),(4))", 3},
                                                     {"(-2)^101/2^101", -1},
                                                     {"(0.1*3-0.3)*2^54", 1},
                                                     {"atan2(0,-(y-y))", 0},
                                                     {"atan2(-(y-y),-1)", std::numbers::pi},
                                                     {"round(2.5)+round(-2.5)", 1},
                                                     {"(-2)^ceil(0.5)", -2},
                                                     {"(-2)^floor(3.5)", -8},
                                                     {"(-2)^round(1.2)", -2},
                                                     {"(-2)^sqrt(4)", 4}})
        EXPECT_DOUBLE_EQ(value_of(text), value) << text;
}

TEST(TextMap, FunctionsAreThoseOfGlsl) {
    const double k = 0.3;
    for (const auto& [text, value] :
         std::vector<std::pair<std::string, double>>{{"sin(.3)", std::sin(k)},
                                                     {"cos(.3)", std::cos(k)},
                                                     {"tan(.3)", std::tan(k)},
                                                     {"asin(.3)", std::asin(k)},
                                                     {"acos(.3)", std::acos(k)},
                                                     {"atan(.3)", std::atan(k)},
                                                     {"atan(.3,-2)", std::atan2(k, -2)},
                                                     {"atan2(-.3,-2)", std::atan2(-k, -2)},
                                                     {"sinh(.3)", std::sinh(k)},
                                                     {"cosh(.3)", std::cosh(k)},
                                                     {"tanh(.3)", std::tanh(k)},
                                                     {"asinh(.3)", std::asinh(k)},
                                                     {"exp(.3)", std::exp(k)},
                                                     {"log(.3)", std::log(k)},
                                                     {"sqrt(.3)", std::sqrt(k)},
                                                     {"cbrt(-.3)", std::cbrt(-k)},
                                                     {"pow(.3,1.7)", std::pow(k, 1.7)},
                                                     {"pow(-.3,3)", std::pow(-k, 3)},
                                                     {"hypot(.3,.4)", 0.5},
                                                     {"abs(-.3)", k},
                                                     {"sign(-.3)+sign(0)*10+sign(2)*100", 99},
                                                     {"min(.3,.2)", 0.2},
                                                     {"max(.3,.2)", k},
                                                     {"mod(-.3,1)", 0.7},
                                                     {"floor(-.3)", -1},
                                                     {"ceil(-.3)+ceil(1.2)", 2},
                                                     {"round(2.6)", 3},
                                                     {"clamp(.3,.4,1)", 0.4},
                                                     {"mix(2,4,.3)", 2.6},
                                                     {"step(.3,.2)+2*step(.3,.3)", 2},
                                                     {"smoothstep(0,1,.3)", k * k * (3 - 2 * k)}})
        EXPECT_NEAR(value_of(text), value, 1e-15 * std::max(1.0, std::fabs(value))) << text;
}

TEST(TextMap, DefinitionsAreKnownToWhatFollows) {
    FormulaText text;
    text.let = "k = 0.5; wide = k*4 ;k=wide+1";
    text.u = "k*10+wide";
    EXPECT_EQ(point_of(text, 1, 1).x, 32);
    text.let += ";";
    EXPECT_EQ(point_of(text, 1, 1).x, 32);
}

TEST(TextMap, ThereIsNoPointWhereAFormulaHasNoValue) {
    for (const char* none : {"sqrt(-x)", "log(-1)", "log(x-20.5)", "asin(2)", "acos(-1.5)", "1/(x-20.5)",
                             "pow(-2,.5)", "if(x>3,sqrt(-1),1)", "min(1,log(-1))", "sqrt(-1)^0",
                             "x+sqrt(-1)^0", "sqrt(-1)^0*2", "-(sqrt(-1)^0)", "1/log(-1)^0", "0*log(-1)",
                             "(x-x)*log(-1)", "cbrt(y-10.5)", "if(sqrt(-s)<1 or s<2,1,0)"})
        EXPECT_FALSE(is_inside(none)) << none;
    for (const char* some : {"sqrt(x)", "log(x)", "asin(.5)", "1/x", "pow(-2,3)", "(-2)^1000",
                             "if(x<3,sqrt(-1),1)", "if(x>3,1,1/(x-20.5))", "if(s<2 or sqrt(-s)<1,1,0)"})
        EXPECT_TRUE(is_inside(some)) << some;
}

TEST(TextMap, PixelsWithoutAPointAreCounted) {
    const Size target{150, 97};
    for (const char* u : {"x", "sqrt(r-0.5)", "log(px*py)", "1/floor(4*s)", "asin(2*px)", "sqrt(-1-r)",
                          "1e308*r", "if(hypot(px,py)<0.7,x,1/0)", "1/(x-50.5)"}) {
        FormulaText text;
        text.u = u;
        const TextMap map(parse_formula(text, {target, kSource}), target, target, kSource);
        std::int64_t count = 0;
        for (int y = 0; y < target.height; ++y)
            for (int x = 0; x < target.width; ++x) {
                const Point<DoubleDouble> at{x + 0.5, y + 0.5};
                const Point<DoubleDouble> p = map.source_point(at.x, at.y);
                count += !(map.inside(at.x, at.y) > 0 && fabs(p.x) <= std::numeric_limits<double>::max());
            }
        EXPECT_EQ(map.undefined_pixels({0, 0, target.width, target.height}), count) << u;
    }
}

TEST(TextMap, KeysOfTheirOwnDefineNames) {
    const auto value_of = [](const std::vector<Assignment>& definitions, const std::string& let,
                             const std::string& u) {
        FormulaText text;
        text.definitions = definitions;
        text.let = let;
        text.u = u;
        return read_point(parse_formula(text, {kPicture, kSource}).point, 0.5, 0.5).x;
    };
    EXPECT_EQ(value_of({{"k", "3"}, {"c", "k+1"}}, "", "c*10"), 40);
    // They stand before `let`, and stay what they are.
    EXPECT_EQ(value_of({{"k", "3"}}, "k=5;c=k+1", "c"), 4);
    const auto error_of = [&](const std::vector<Assignment>& definitions, const std::string& let = "") {
        try {
            value_of(definitions, let, "x+c");
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    EXPECT_EQ(error_of({{"c", "k"}, {"k", "3"}}), "c=k: column 1: expected a name that is known, not k");
    EXPECT_EQ(error_of({{"c", ""}}), "c=: column 1: expected a number, a name or (");
    EXPECT_EQ(error_of({{"tool", "0.1"}}, "c=1"),
              "tool=0.1: there is no such parameter, and no formula uses the name");
    EXPECT_EQ(error_of({{"camra", "0,0,2"}}, "c=1"),
              "camra=0,0,2: there is no such parameter, and no formula uses the name");
    EXPECT_EQ(error_of({{"width", "3"}}, "c=width"), "width=3: every formula has this name: must be another");
    EXPECT_EQ(error_of({{"sin", "3"}}, "c=1"), "sin=3: must be a name that is no function's");
    EXPECT_EQ(error_of({{"2c", "3"}}, "c=1"), "2c=3: must be a name that is no function's");
}

TEST(TextMap, ErrorsNameTheColumn) {
    const auto error_of = [](const std::string& u, const std::string& let = "") {
        FormulaText text;
        text.u = u;
        text.let = let;
        try {
            parse_formula(text, {kPicture, kSource});
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    EXPECT_EQ(error_of("x+"), "u=x+: column 3: expected a number, a name or (");
    EXPECT_EQ(error_of("sin(x"), "u=sin(x: column 6: expected )");
    EXPECT_EQ(error_of("x*foo"), "u=x*foo: column 3: expected a name that is known, not foo");
    EXPECT_EQ(error_of("x<y"), "u=x<y: column 1: expected a number");
    EXPECT_EQ(error_of("1+(x<y)"), "u=1+(x<y): column 3: expected a number");
    EXPECT_EQ(error_of("if(x,1,2)"), "u=if(x,1,2): column 4: expected a condition");
    EXPECT_EQ(error_of("1e999"), "u=1e999: column 1: expected a number that double can hold");
    EXPECT_EQ(error_of("clamp(x,1)"), "u=clamp(x,1): column 1: expected clamp with 3 arguments");
    EXPECT_EQ(error_of("atan(1,2,3)"), "u=atan(1,2,3): column 1: expected atan with 1 or 2 arguments");
    EXPECT_EQ(error_of("if(x=1,1,2)"), "u=if(x=1,1,2): column 5: expected ==");
    EXPECT_EQ(error_of("x y"), "u=x y: column 3: expected an operator or the end");
    EXPECT_EQ(error_of("x", "k=2 k"), "let=k=2 k: column 5: expected ;");
    EXPECT_EQ(error_of("x", "sin=2"), "let=sin=2: column 1: expected a name that is no function's");
    EXPECT_EQ(error_of("x", "k=1; r=2"),
              "let=k=1; r=2: column 6: expected another name: every formula has this one");
    EXPECT_THAT(error_of(std::string(100000, '(')),
                testing::HasSubstr("no more than 200 expressions in each other"));
    EXPECT_THAT(error_of(std::string(100000, '-') + "x"), testing::HasSubstr("no more than 200"));
    EXPECT_THAT(error_of(std::string(100000, 'q')), testing::HasSubstr("a name that is known"));
    EXPECT_THAT(error_of("1" + std::string(100000, '0')),
                testing::HasSubstr("a number that double can hold"));
    std::string wide = "x";
    for (int i = 0; i < 100; ++i) wide = "sin(x*" + std::to_string(i + 2) + ")+(" + wide + ")";
    EXPECT_EQ(error_of(wide), "u and v: the formula needs more than 64 numbers at once: must be simpler");
    std::string numbers = "x";
    for (int i = 0; i < 300; ++i) numbers += "+x*" + std::to_string(i + 2);
    EXPECT_EQ(error_of(numbers),
              "u and v: the formula needs more than 256 different numbers: must be simpler");
    std::string many = "k=x";
    for (int i = 0; i < 9000; ++i) many += ";k=sin(k+" + std::to_string(i + 2) + ")";
    EXPECT_THAT(error_of("k", many),
                testing::AllOf(testing::StartsWith("let=k=x;k=sin(k+2)"),
                               testing::EndsWith("needs more than 16384 operations: must be simpler")));
}

TextPlan plan_of(const FormulaText& text, const Size& picture) {
    PlanOptions options;
    options.cull = false;
    return TextPlan(TextMap(parse_formula(text, {picture, kSource}), picture, picture, kSource), options);
}

// Beyond double nothing is known, and that is said.
TEST(TextMap, WhatOverflowsHasNoBound) {
    for (const char* u :
         {"x+sin(3e28*s)", "x+sin(exp(y*20))", "x+5*exp(20*y)*exp(-20*y)", "x+min(1,exp(exp(y)))",
          "x+1e200*x*1e200/1e200/1e200", "x+exp(1000)-exp(1000)", "x+(x-x)*exp(1000)", "x+(y-y)*exp(y*1000)",
          "x+floor(s)*exp(y*1000)", "x+hypot(1e200*x,1e200*y)/1e200"}) {
        FormulaText text;
        text.u = u;
        const TextPlan plan = plan_of(text, kPicture);
        for (std::int64_t region = 0; region < plan.regions(); ++region)
            for (const Block& block : plan.blocks(region)) {
                ASSERT_FALSE(std::isnan(block.bound)) << u;
                Point<double> p{};
                int piece = 0;
                const bool is_drawn = static_cast<const BlockMap&>(plan).exact(block, block.box.x0 + 0.5,
                                                                               block.box.y0 + 0.5, p, piece);
                if (block.kind == Block::Kind::exact && !is_drawn) {
                    EXPECT_EQ(block.bound, HUGE_VAL) << u;
                }
            }
    }
}

// What is a whole number, or on the axis, without rounding is on no side of a jump but its own.
TEST(TextMap, JumpsAreDecidedWhereNothingIsRounded) {
    for (const char* u :
         {"x+if(mod(floor(x/8)+floor(y/8),2)<1,5,-5)", "x+8*floor(floor(x/8)/2)", "x+mod(floor(x/8),2)*8",
          "x+floor(x-.5)", "x+round(x)", "x+floor(width/2)+mod(width,2)+mod(8,4)", "x+5*cos(a)",
          "width/2+height/2*r*cos(a+0.6*exp(-4*r^2))", "x+5*sin(2*a)", "x+tanh(50*(x-20))"})
        for (const Size picture : {kPicture, Size{47, 31}}) {
            FormulaText text;
            text.u = u;
            const TextPlan plan = plan_of(text, picture);
            for (std::int64_t region = 0; region < plan.regions(); ++region)
                for (const Block& block : plan.blocks(region))
                    EXPECT_LE(block.bound, 0.01) << u << " at " << block.box.x0 << ", " << block.box.y0;
        }
}

TEST(TextMap, WhatUnderflowsIsOffByNoMoreThanItsBound) {
    for (const char* u : {"-.3^612", "1e-200*(x*1e-150)", "exp(-740)*1.1", "(1e-170*x)^2", "x*1e-320/3"}) {
        FormulaText text;
        text.u = u;
        text.v = "0";
        const TextPlan plan = plan_of(text, kPicture);
        for (const Block& block : plan.blocks(0)) {
            if (block.kind != Block::Kind::exact) continue;
            const double x = block.box.x0 + 0.5, y = block.box.y0 + 0.5;
            Point<double> p{};
            Point<DoubleDouble> truth{};
            int piece = 0;
            ASSERT_TRUE(static_cast<const BlockMap&>(plan).exact(block, x, y, p, piece)) << u;
            ASSERT_TRUE(plan.truth(x, y, 0, truth, piece)) << u;
            EXPECT_LE(fabs(p.x - truth.x), block.bound) << u;
        }
    }
}

// --- what rounding does to exp and log of jets ---

/// The sum of magnitudes of coefficients, from that of degree `first` on.
template <class T>
long double norm_of(const Jet<T, 4>& jet, int first = 0) {
    long double sum = 0;
    for (int k = first; k < Jet<T, 4>::kSize; ++k) sum += std::fabs(static_cast<long double>(jet.c[k]));
    return sum;
}

/// Jets in Real, whose constant parts are off by `off` and the others up to `spread`, and what Rounded says of a function of
/// them.
template <class Real, class Function>
void expect_bounded(const Function& function, double off, double spread) {
    constexpr unsigned kSeed = 53;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", off " << off << ", spread " << spread);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    long double most = 0;
    for (int i = 0; i < 2000; ++i) {
        Jet<Real, 4> computed(static_cast<Real>(1 + 0.4 * uniform(random)));
        for (int k = 1; k < Jet<Real, 4>::kSize; ++k)
            computed.c[k] = static_cast<Real>(spread * uniform(random));
        Jet<long double, 4> exact;
        for (int k = 0; k < Jet<Real, 4>::kSize; ++k) exact.c[k] = static_cast<long double>(computed.c[k]);
        exact.c[0] -= off;
        const double about = static_cast<double>(exact.c[0]);
        const Rounded<Real> said = function(
            Rounded<Real>(Interval(about - 1e-9, about + 1e-9), static_cast<double>(norm_of(exact, 1)), off));
        const Jet<Real, 4> found = function(computed);
        const Jet<long double, 4> truth = function(exact);
        long double error = 0;
        for (int k = 0; k < Jet<Real, 4>::kSize; ++k)
            error += std::fabs(static_cast<long double>(found.c[k]) - truth.c[k]);
        ASSERT_LE(error, said.error);
        ASSERT_LE(norm_of(truth, 1), said.radius);
        most = std::max(most, error / said.error);
    }
    // Half of what is said of numbers that are off does not hold.
    if (off > 0 && spread == 0) {
        EXPECT_GT(most, 0.9L);
    }
}

template <class Real>
void expect_exp_and_log_bounded() {
    for (const double off : {0.0, 1e-3})
        for (const double spread : {0.0, 0.02}) {
            expect_bounded<Real>([](const auto& a) { return exp(a); }, off, spread);
            expect_bounded<Real>([](const auto& a) { return log(a); }, off, spread);
        }
}

TEST(TextMap, RoundingOfExpAndLogIsBounded) {
    expect_exp_and_log_bounded<float>();
    expect_exp_and_log_bounded<double>();
}

// --- random formulas against long double ---

using Real = long double;

/// A formula as text, and as a function that shares nothing with what reads the text. `margin` becomes how far the formula is
/// from having no value, at most.
struct Formula {
    std::string text;
    std::function<Real(Real, Real, Real&)> value;
};

class Generator {
  public:
    explicit Generator(unsigned seed) : m_random(seed) {}

    Formula make(int depth) {
        if (depth == 0 || below(8) == 0) return leaf();
        switch (below(24)) {
            case 0:
            case 1:
                return binary("(", "+", ")", depth, [](Real a, Real b, Real&) { return a + b; });
            case 2:
                return binary("(", "-", ")", depth, [](Real a, Real b, Real&) { return a - b; });
            case 3:
            case 4:
                return binary("(", "*", ")", depth, [](Real a, Real b, Real&) { return a * b; });
            case 5:
                return binary("(", "/", ")", depth, [](Real a, Real b, Real& margin) {
                    margin = std::min(margin, std::fabs(b));
                    return a / b;
                });
            case 6:
                return binary("min(", ",", ")", depth, [](Real a, Real b, Real&) { return std::min(a, b); });
            case 7:
                return binary("max(", ",", ")", depth, [](Real a, Real b, Real&) { return std::max(a, b); });
            case 8:
                return binary("mod(", ",", ")", depth, [](Real a, Real b, Real& margin) {
                    margin = std::min(margin, std::fabs(b));
                    return a - b * std::floor(a / b);
                });
            case 9:
                return binary("hypot(", ",", ")", depth,
                              [](Real a, Real b, Real&) { return std::hypot(a, b); });
            case 10:
                return binary("atan2(", ",", ")", depth,
                              [](Real a, Real b, Real&) { return std::atan2(a + 0, b); });
            case 11:
                return unary("sin(", depth, [](Real a, Real&) { return std::sin(a); });
            case 12:
                return unary("cos(", depth, [](Real a, Real&) { return std::cos(a); });
            case 13:
                return unary(
                    "exp(-abs(", depth, [](Real a, Real&) { return std::exp(-std::fabs(a)); }, "))");
            case 14:
                return unary("sqrt(", depth, [](Real a, Real& margin) {
                    margin = std::min(margin, a);
                    return std::sqrt(a);
                });
            case 15:
                return unary("log(", depth, [](Real a, Real& margin) {
                    margin = std::min(margin, a);
                    return std::log(a);
                });
            case 16:
                return unary("abs(", depth, [](Real a, Real&) { return std::fabs(a); });
            case 17:
                return unary("floor(", depth, [](Real a, Real&) { return std::floor(a); });
            case 18:
                return unary("asinh(", depth, [](Real a, Real&) { return std::asinh(a); });
            case 19:
                return unary("tanh(", depth, [](Real a, Real&) { return std::tanh(a); });
            case 20:
                return unary(
                    "(", depth, [](Real a, Real&) { return a * a; }, ")^2");
            case 21:
                return unary("asin(", depth, [](Real a, Real& margin) {
                    margin = std::min(margin, (1 - a) * (1 + a));
                    return std::asin(a);
                });
            default:
                return choice(depth);
        }
    }
    /// Without a jump, a crease or an end.
    Formula make_smooth(int depth) {
        if (depth == 0 && below(2) == 0) return {"px", [](Real x, Real, Real&) { return px(x); }};
        if (depth == 0) return {"py", [](Real, Real y, Real&) { return py(y); }};
        const Formula a = make_smooth(depth - 1), b = make_smooth(depth - 1);
        const auto of_one = [&](const std::string& before, const std::string& behind, Real (*f)(Real)) {
            return Formula{before + a.text + behind,
                           [a, f](Real x, Real y, Real& m) { return f(a.value(x, y, m)); }};
        };
        switch (below(9)) {
            case 0:
                return {"(" + a.text + "+" + b.text + ")",
                        [a, b](Real x, Real y, Real& m) { return a.value(x, y, m) + b.value(x, y, m); }};
            case 1:
                return {"(" + a.text + "*" + b.text + ")",
                        [a, b](Real x, Real y, Real& m) { return a.value(x, y, m) * b.value(x, y, m); }};
            case 2:
                return of_one("sin(", ")", [](Real v) { return std::sin(v); });
            case 3:
                return of_one("exp(-(", ")^2)", [](Real v) { return std::exp(-v * v); });
            case 4:
                return of_one("log(1+(", ")^2)", [](Real v) { return std::log(1 + v * v); });
            case 5:
                return of_one("sqrt(1+(", ")^2)", [](Real v) { return std::sqrt(1 + v * v); });
            case 6:
                return of_one("asinh(", ")", [](Real v) { return std::asinh(v); });
            case 7:
                return of_one("tanh(", ")", [](Real v) { return std::tanh(v); });
            default:
                return of_one("1/(2+cos(", "))", [](Real v) { return 1 / (2 + std::cos(v)); });
        }
    }
    int below(int n) { return static_cast<int>(m_random() % static_cast<unsigned>(n)); }

  private:
    static Real px(Real x) { return (x - kPicture.width / 2.0L) / (kPicture.height / 2.0L); }
    static Real py(Real y) { return (kPicture.height / 2.0L - y) / (kPicture.height / 2.0L); }

    template <class Function>
    Formula unary(const std::string& before, int depth, const Function& f, const std::string& behind = ")") {
        const Formula a = make(depth - 1);
        return {before + a.text + behind, [a, f](Real x, Real y, Real& margin) {
                    const Real of_a = a.value(x, y, margin);
                    return static_cast<Real>(f(of_a, margin));
                }};
    }
    template <class Function>
    Formula binary(const std::string& before, const std::string& between, const std::string& behind,
                   int depth, const Function& f) {
        const Formula a = make(depth - 1), b = make(depth - 1);
        return {before + a.text + between + b.text + behind, [a, b, f](Real x, Real y, Real& margin) {
                    const Real of_a = a.value(x, y, margin), of_b = b.value(x, y, margin);
                    return static_cast<Real>(f(of_a, of_b, margin));
                }};
    }
    Formula choice(int depth) {
        const Formula a = make(depth - 1), b = make(depth - 1), c = make(depth - 1), d = make(depth - 1);
        return {"if(" + a.text + "<" + b.text + "," + c.text + "," + d.text + ")",
                [a, b, c, d](Real x, Real y, Real& margin) {
                    const bool is_less = a.value(x, y, margin) < b.value(x, y, margin);
                    return (is_less ? c : d).value(x, y, margin);
                }};
    }
    Formula leaf() {
        const Real w = kPicture.width;
        switch (below(9)) {
            case 0:
                return {"x", [](Real x, Real, Real&) { return x; }};
            case 1:
                return {"y", [](Real, Real y, Real&) { return y; }};
            case 2:
                return {"s", [=](Real x, Real, Real&) { return x / w; }};
            case 3:
                return {"px", [](Real x, Real, Real&) { return px(x); }};
            case 4:
                return {"py", [](Real, Real y, Real&) { return py(y); }};
            case 5:
                return {"r", [](Real x, Real y, Real&) { return std::hypot(px(x), py(y)); }};
            case 6:
                return {"a", [](Real x, Real y, Real&) { return std::atan2(py(y), px(x)); }};
            default: {
                const double value = std::pow(10.0, std::uniform_real_distribution<double>(-6, 6)(m_random)) *
                                     (below(2) == 0 ? -1 : 1);
                char text[40];
                std::snprintf(text, sizeof text, "(%.17g)", value);
                return {text, [value](Real, Real, Real&) { return static_cast<Real>(value); }};
            }
        }
    }

    std::mt19937 m_random;
};

struct Findings {
    int pixels = 0, exact = 0, direct = 0, unknown = 0;  ///< of all, those found so and those on a jump
    int over = 0, above_tol = 0, lost = 0,
        extra = 0;  ///< bounds and tolerances broken, points that are or are not there
};

/// Compares all pixels of a plan with the truth.
Findings examine(const TextPlan& plan, double tol, const Formula& u, const Formula& v) {
    Findings found;
    for (std::int64_t region = 0; region < plan.regions(); ++region)
        for (const Block& block : plan.blocks(region))
            for (int j = block.box.y0; j < block.box.y1; ++j) {
                const test::BlockRow row(plan, block, j);
                const bool is_exact = block.kind == Block::Kind::exact;
                std::vector<double> exact_x(static_cast<std::size_t>(block.box.width())), exact_y = exact_x;
                std::vector<std::int32_t> piece(exact_x.size());
                if (is_exact)
                    plan.exact_rows(block, j - block.box.y0, j - block.box.y0 + 1,
                                    {exact_x.data(), exact_y.data(), piece.data(), block.box.width()});
                for (int i = block.box.x0; i < block.box.x1; ++i) {
                    ++found.pixels;
                    found.exact += is_exact;
                    found.direct += block.kind == Block::Kind::computed;
                    Real margin = 1;
                    const Real x = u.value(i + 0.5L, j + 0.5L, margin),
                               y = v.value(i + 0.5L, j + 0.5L, margin);
                    const bool is_seen = margin > 0 && std::isfinite(x) && std::isfinite(y);
                    // No one can tell on which side of a jump such a pixel lies.
                    if (!std::isfinite(block.bound)) {
                        found.unknown += 1;
                        continue;
                    }
                    const auto k = static_cast<std::size_t>(i - block.box.x0);
                    const bool is_drawn = is_exact ? piece[k] >= 0 : test::has_points(block);
                    Point<double> p{};
                    if (is_drawn) p = is_exact ? Point<double>{exact_x[k], exact_y[k]} : row.at(i);
                    if (is_drawn && is_seen) {
                        const Real error = std::hypot(p.x - x, p.y - y);
                        // What long double itself is off.
                        const Real slack = 0x1p-60L * (std::fabs(x) + std::fabs(y));
                        found.over += !(error <= block.bound + slack);
                        // Pixels that are computed in double one by one are exact, too, where 0 is asked for.
                        const bool is_held = tol > 0 || block.kind != Block::Kind::computed;
                        found.above_tol += !is_exact && is_held && !(block.bound <= tol);
                    }
                    found.lost +=
                        !is_drawn && is_seen && margin > 1e-12L && std::fabs(x) < 1e6L && std::fabs(y) < 1e6L;
                    found.extra += is_drawn && !is_seen && margin < -1e-12L;
                }
            }
    return found;
}

TEST(TextMap, RandomFormulasHoldTheirBounds) {
    constexpr unsigned kSeed = 2026;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    Generator generator(kSeed);
    const double tols[] = {1, 0.01, 1e-4, 1e-8, 0};
    int pixels = 0, unknown = 0, direct = 0;
    for (int k = 0; k < 200; ++k) {
        const Formula u = generator.make(1 + k % 12), v = generator.make(1 + k / 17);
        FormulaText text;
        text.u = u.text;
        text.v = v.text;
        SCOPED_TRACE(testing::Message() << k << ": u=" << u.text << " v=" << v.text);
        PlanOptions options;
        options.tol = tols[k % 5];
        options.cull = false;
        PlaneFormula formula;
        try {
            formula = parse_formula(text, {kPicture, kSource});
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), testing::HasSubstr("needs more than"));
            continue;
        }
        for (const Scheme scheme : {Scheme::automatic, Scheme::direct}) {
            options.scheme = scheme;
            const Findings found =
                examine(TextPlan(TextMap(formula, kPicture, kPicture, kSource), options), options.tol, u, v);
            EXPECT_EQ(found.over, 0);
            EXPECT_EQ(found.above_tol, 0);
            EXPECT_EQ(found.lost, 0);
            EXPECT_EQ(found.extra, 0);
            pixels += found.pixels;
            unknown += found.unknown;
            direct += found.direct;
        }
    }
    EXPECT_GT(pixels, 500000);
    EXPECT_LT(unknown, pixels / 10);
    EXPECT_GT(direct, 5000);
}

/// The source points of all direct pixels of a plan, row by row, or parts of rows by `part`.
std::vector<float> direct_points(const TextPlan& plan, int part) {
    std::vector<float> points;
    for (std::int64_t region = 0; region < plan.regions(); ++region)
        for (const Block& block : plan.blocks(region)) {
            if (block.kind != Block::Kind::computed || block.precise) continue;
            for (int row = 0; row < block.box.height(); ++row)
                for (int begin = 0; begin < block.box.width(); begin += part) {
                    const int end = std::min(begin + part, block.box.width());
                    float x[simd::kRowRoom], y[simd::kRowRoom];
                    plan.computed_row(block, row, begin, end, x, y);
                    for (int i = 0; i < end - begin; ++i) points.insert(points.end(), {x[i], y[i]});
                }
        }
    return points;
}

TEST(TextMap, DirectPixelsAreTheSameOnEveryInstructionSetAndInAnyPart) {
    for (const char* u : {"100*px*sin(r)", "50*atan2(py+3,px)", "20*asinh(px*py)", "x/(2+cos(py))",
                          "if(x+y<30,3*x,2*y)+100*sqrt(1+px^2)"}) {
        SCOPED_TRACE(u);
        FormulaText text;
        text.u = u;
        text.v = "y+3*cos(2*px)*px^2";
        PlanOptions options;
        options.scheme = Scheme::direct;
        options.cull = false;
        const Size picture{256, 192};
        const TextPlan plan(TextMap(parse_formula(text, {picture, kSource}), picture, picture, kSource),
                            options);
        const std::vector<float> whole = direct_points(plan, simd::kRowRoom);
        EXPECT_GT(whole.size(), 20000u);
        test::on_every_instruction_set([&] {
            for (const int part : {64, 7, 1}) {
                const std::vector<float> points = direct_points(plan, part);
                ASSERT_EQ(points.size(), whole.size());
                EXPECT_EQ(std::memcmp(points.data(), whole.data(), points.size() * sizeof(float)), 0);
            }
        });
    }
}

TEST(TextMap, DirectPixelsOfAnotherSizeHoldTheirBounds) {
    constexpr int kTimes = 7;
    const Size large{kTimes * kPicture.width, kTimes * kPicture.height};
    FormulaText text;
    text.u = "60*sin(0.1*x)";
    text.v = "50+y*y/40+20*cos(0.2*y)";
    const Formula u{text.u, [](Real x, Real, Real&) { return 60 * std::sin(x / kTimes / 10); }};
    const Formula v{text.v, [](Real, Real y, Real&) {
                        const Real at = y / kTimes;
                        return 50 + at * at / 40 + 20 * std::cos(at / 5);
                    }};
    for (const double tol : {0.01, 1e-6}) {
        PlanOptions options;
        options.scheme = Scheme::direct;
        options.tol = tol;
        options.cull = false;
        const TextMap map(parse_formula(text, {kPicture, kSource}), kPicture, large, kSource);
        const Findings found = examine(TextPlan(map, options), tol, u, v);
        EXPECT_EQ(found.over + found.above_tol + found.lost + found.extra + found.unknown, 0) << tol;
        EXPECT_EQ(found.direct, found.pixels) << tol;
    }
}

TEST(TextMap, JetsAcrossAJumpAreNotBounded) {
    using J = simd::BoundJets;
    const double one[] = {1, 1, 1, 1}, none[] = {0, 0, 0, 0};
    // Boxes from x = 10 to 20, from 20 to 30, and so on; only the second one meets x = 24.
    const Interval x[] = {{10, 20}, {20, 30}, {30, 40}, {40, 48}}, y[] = {{2, 30}, {2, 30}, {2, 30}, {2, 30}};
    for (const char* u : {"if(x<24,y,x)", "abs(x-24)", "floor(x/24)", "atan2((x-24)/100,-1)"}) {
        FormulaText text;
        text.u = u;
        const PlaneFormula formula = parse_formula(text, {kPicture, kSource});
        const J found = read_point(formula.point, J::variable(x, one, none), J::variable(y, none, one)).x;
        for (int i = 0; i < 4; ++i) {
            const bool crosses = i == 1 || (i == 3 && text.u == "floor(x/24)");
            EXPECT_EQ(std::isfinite(found.at(i).c[0].hi) && std::isfinite(found.at(i).c[1].hi), !crosses)
                << u << ", box " << i;
            using One = Jet<Interval, 1>;
            const One alone =
                read_point(formula.point, One::variable(x[i], 1, 0), One::variable(y[i], 0, 1)).x;
            EXPECT_EQ(std::isfinite(alone.c[1].hi), !crosses) << u << ", box " << i;
        }
    }
}

/// A formula of a picture, with v = y.
Findings examine(const Formula& u, const Size& picture) {
    FormulaText text;
    text.u = u.text;
    const Formula v{"y", [](Real, Real y, Real&) { return y; }};
    return examine(plan_of(text, picture), 0.01, u, v);
}

// Every step, over all that its operands may be.
TEST(TextMap, RowsHoldTheBoundOfExactPixelsOnEveryInstructionSet) {
    const Size picture{100, 3};
    for (const char* u : {"sin(x)",
                          "sin(1e3*x)",
                          "cos(3e5*x)",
                          "sin(1e17*x)",
                          "tan(x)",
                          "exp(x)",
                          "exp(-20*x)",
                          "exp(20*x)",
                          "log(x)",
                          "log(x*1e-300)",
                          "log(x*1e-160*1e-160)",
                          "log(x*1e300)",
                          "log(50-x)",
                          "asinh(x-50)",
                          "asinh(x*1e200)",
                          "asinh(x*1e-200)",
                          "atan2(y-1.5,x-50.5)",
                          "atan2((y-1.5)*1e200,(x-50)*1e200)",
                          "atan2((y-1.5)*1e-200,(x-50)*1e-200)",
                          "atan2(y-1.5,(x-50)*1e-300)",
                          "atan2(-(y-y),x-50)",
                          "sqrt(x-50)",
                          "1/(x-50.5)",
                          "floor(x/7)",
                          "floor(x*1e17)",
                          "floor(7/(x-50.5))",
                          "if(x<50,y,2*x)",
                          "(x-50)^3",
                          "x^2.5",
                          "mod(x,7)",
                          "cbrt(x-50)",
                          "cosh(x)",
                          "tanh(x-50)",
                          "hypot(x,y)",
                          "x*1e308*10",
                          "exp(1/(x-50.5))"}) {
        SCOPED_TRACE(u);
        FormulaText text;
        text.u = u;
        const TextMap map(parse_formula(text, {picture, kSource}), picture, picture, kSource);
        std::vector<double> first;
        test::on_every_instruction_set([&] {
            for (int j = 0; j < picture.height; ++j) {
                std::vector<double> x(100), y(100), alone(1), alone_y(1);
                std::vector<std::int32_t> piece(100), piece_alone(1);
                map.exact_row(0.5, j + 0.5, 100, x.data(), y.data(), piece.data());
                // Rows of any length.
                for (const int count : {9, 31, 33, 64}) {
                    std::vector<double> part(100), part_y(100);
                    std::vector<std::int32_t> part_piece(100);
                    map.exact_row(0.5, j + 0.5, count, part.data(), part_y.data(), part_piece.data());
                    const auto length = static_cast<std::size_t>(count);
                    EXPECT_EQ(std::memcmp(part.data(), x.data(), length * sizeof(double)), 0) << count;
                    EXPECT_EQ(std::memcmp(part_y.data(), y.data(), length * sizeof(double)), 0) << count;
                    EXPECT_TRUE(std::equal(part_piece.begin(), part_piece.begin() + count, piece.begin()))
                        << count;
                }
                for (int i = 0; i < 100; ++i) {
                    const auto k = static_cast<std::size_t>(i);
                    // The same, whatever stands beside it.
                    map.exact_row(i + 0.5, j + 0.5, 1, alone.data(), alone_y.data(), piece_alone.data());
                    EXPECT_EQ(std::memcmp(&alone[0], &x[k], sizeof(double)), 0) << i;
                    EXPECT_EQ(piece_alone[0], piece[k]) << i;
                    const double bound =
                        map.exact_error<double>(Interval(i + 0.5), Interval(j + 0.5), 0) +
                        map.exact_error<DoubleDouble>(Interval(i + 0.5), Interval(j + 0.5), 0);
                    Point<DoubleDouble> truth{};
                    int at = 0;
                    const bool is_seen = map.exact<DoubleDouble>(i + 0.5, j + 0.5, 0, truth, at);
                    if (!std::isfinite(bound)) continue;
                    ASSERT_EQ(piece[k] >= 0, is_seen) << i;
                    if (is_seen) {
                        EXPECT_LE(fabs(x[k] - truth.x), bound) << i;
                    }
                }
                if (j == 0 && first.empty()) first = x;
                if (j == 0) {
                    EXPECT_EQ(std::memcmp(first.data(), x.data(), 100 * sizeof(double)), 0);
                }
            }
        });
    }
}

// Where no pixel holds the tolerance, those on a jump keep their bound to themselves.
TEST(TextMap, BoundsOfAJumpAreNotThoseOfItsNeighbours) {
    FormulaText text;
    text.u = "x/3+if(sin(y)<sin(8.5),0,40)";
    const TextMap map(parse_formula(text, {kPicture, kSource}), kPicture, kPicture, kSource);
    for (const Scheme scheme : {Scheme::automatic, Scheme::exact}) {
        PlanOptions options;
        options.scheme = scheme;
        options.tol = 1e-21;
        const TextPlan plan(map, options);
        int on_jump = 0;
        for (std::int64_t region = 0; region < plan.regions(); ++region)
            for (const Block& block : plan.blocks(region)) {
                EXPECT_GT(block.bound, options.tol);
                if (block.bound > 1e-9) on_jump += block.box.width() * block.box.height();
            }
        EXPECT_EQ(on_jump, kPicture.width);
    }
}

// In a picture that is large enough for blocks none of them crosses a jump or a crease.
TEST(TextMap, BlocksEndWhereFormulasJump) {
    const Size picture{384, 256};
    const auto px = [](Real x) { return (x - 192) / 128; };
    const auto py = [](Real y) { return (128 - y) / 128; };
    for (const Formula& u : std::vector<Formula>{
             {"if(px<py,100*px,100*py+3)",
              [&](Real x, Real y, Real&) { return px(x) < py(y) ? 100 * px(x) : 100 * py(y) + 3; }},
             {"if(px<.3,7,9)", [&](Real x, Real, Real&) { return px(x) < Real{0.3} ? 7.0L : 9.0L; }},
             {"100*abs(px)", [&](Real x, Real, Real&) { return 100 * std::fabs(px(x)); }},
             {"100*max(px,py)", [&](Real x, Real y, Real&) { return 100 * std::max(px(x), py(y)); }},
             {"20*floor(3*px)+10*px",
              [&](Real x, Real, Real&) { return 20 * std::floor(3 * px(x)) + 10 * px(x); }},
             {"30*a", [&](Real x, Real y, Real&) { return 30 * std::atan2(py(y), px(x)); }},
             {"30*atan2(.2-py,px)",
              [&](Real x, Real y, Real&) { return 30 * std::atan2(Real{0.2} - py(y), px(x)); }},
             {"step(.1,px)*50", [&](Real x, Real, Real&) { return px(x) < Real{0.1} ? 0.0L : 50.0L; }}}) {
        SCOPED_TRACE(u.text);
        const Findings found = examine(u, picture);
        EXPECT_EQ(found.over + found.above_tol + found.lost + found.extra + found.unknown, 0);
        EXPECT_LT(found.exact, found.pixels / 2);
    }
}

// Double lands on the other side of a jump: 0.3 and 0.1 are less and more than they say, and what is made of them is rounded.
TEST(TextMap, JumpsThatRoundingCrossesAreNoticed) {
    for (const Formula& u : std::vector<Formula>{
             {"if(x<x*.1*10,50,0)",
              [](Real x, Real, Real&) { return x < x * Real{0.1} * 10 ? 50.0L : 0.0L; }},
             {"5*floor((x-.5)*.3*10)",
              [](Real x, Real, Real&) { return 5 * std::floor((x - 0.5L) * Real{0.3} * 10); }},
             {"10*atan2(x*.3*10-x*3,-1)",
              [](Real x, Real, Real&) { return 10 * std::atan2(x * Real{0.3} * 10 - x * 3, -1.0L); }}}) {
        SCOPED_TRACE(u.text);
        const Findings found = examine(u, kPicture);
        EXPECT_EQ(found.over + found.lost + found.extra, 0);
    }
}

// A picture eight times as large as the one that the formulas speak of: large enough for blocks.
TEST(TextMap, SmoothFormulasAreDrawnByBlocks) {
    constexpr unsigned kSeed = 87;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    Generator generator(kSeed);
    constexpr int kTimes = 8;
    const Size large{kTimes * kPicture.width, kTimes * kPicture.height};
    const auto shrunk = [](const Formula& f) {
        return Formula{f.text,
                       [f](Real x, Real y, Real& m) { return 100 * f.value(x / kTimes, y / kTimes, m); }};
    };
    int pixels = 0, exact = 0;
    for (int k = 0; k < 30; ++k) {
        const Formula u = generator.make_smooth(1 + k % 4), v = generator.make_smooth(1 + k / 8);
        FormulaText text;
        text.u = "100*(" + u.text + ")";
        text.v = "100*(" + v.text + ")";
        SCOPED_TRACE(testing::Message() << k << ": u=" << u.text << " v=" << v.text);
        PlanOptions options;
        options.tol = k % 2 == 0 ? 0.01 : 1e-4;
        options.cull = false;
        const TextMap map(parse_formula(text, {kPicture, kSource}), kPicture, large, kSource);
        const Findings found = examine(TextPlan(map, options), options.tol, shrunk(u), shrunk(v));
        EXPECT_EQ(found.over + found.above_tol + found.lost + found.extra + found.unknown, 0);
        if (options.tol < 0.01) continue;
        pixels += found.pixels;
        exact += found.exact;
    }
    EXPECT_LT(exact, pixels / 10);
}

}  // namespace
}  // namespace anamorph::test_text_map
