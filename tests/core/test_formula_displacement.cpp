// SPDX-License-Identifier: Apache-2.0
// Displacements by formulas that are text: their values, derivatives and bounds, against the formulas written
// out in long double; what has no value; the same bits for any number of threads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <thread>

#include "anamorph/deform/formula_displacement.h"
#include "anamorph/error.h"
#include "anamorph/formula/formula_text.h"
#include "each_instruction_set.h"

namespace anamorph::test_formula_displacement {
namespace {

using ::testing::HasSubstr;
using Real = long double;
using Three = std::array<Real, 3>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

FormulaDisplacement displacement(const DisplacementText& text, double frame = 0) {
    return FormulaDisplacement(parse_displacement(text, frame));
}
FormulaDisplacement upwards(const std::string& z) {
    return displacement({"", "", z, ""});
}

std::string fault_of(const DisplacementText& text) {
    try {
        parse_displacement(text, 0);
    } catch (const Error& error) {
        return error.what();
    }
    return "no fault";
}

/// Points of [-1, 1]^2 as a scan has them: rows, with a hair of noise.
std::vector<glm::dvec2> points(int side, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> noise(-.3, .3);
    std::vector<glm::dvec2> all;
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
            all.emplace_back((2 * (i + noise(random)) + 1) / side - 1,
                             (2 * (j + noise(random)) + 1) / side - 1);
    return all;
}

/// A formula as text, and what it is.
struct Known {
    const char* name;
    DisplacementText text;
    std::function<Three(Real, Real)> value;  ///< NaN where there is none
    double most_bound;
};

std::vector<Known> known_formulas() {
    const auto up = [](const std::function<Real(Real, Real)>& z) {
        return [z](Real u, Real v) { return Three{0, 0, z(u, v)}; };
    };
    return {
        {"saddle", {"", "", "u^2-v^2", ""}, up([](Real u, Real v) { return (u - v) * (u + v); }), 1e-15},
        {"Moebius",
         {"(1+w)*cos(pi*u)-u", "(1+w)*sin(pi*u)-v", "v/2*sin(pi*u/2)", "w=v/2*cos(pi*u/2)"},
         [](Real u, Real v) {
             const Real turn = acosl(-1) * u, wide = 1 + v * cosl(turn / 2) / 2;
             return Three{wide * cosl(turn) - u, wide * sinl(turn) - v, v * sinl(turn / 2) / 2};
         },
         1e-13},
        {"bell",
         {"", "", "exp(-3*(u^2+v^2))", ""},
         up([](Real u, Real v) { return expl(-3 * u * u) * expl(-3 * v * v); }),
         1e-14},
        {"cancels",
         {"", "", "(1+1e-6*sin(3*u))-1", ""},
         up([](Real u, Real) { return Real(1e-6) * sinl(3 * u); }),
         1e-14},
        {"hill",
         {"", "", "sqrt(0.5-u^2-v^2)", ""},
         up([](Real u, Real v) { return sqrtl(Real(0.5) - u * u - v * v); }),
         1e-7},
        {"steps",
         {"", "", "floor(4*u)+if(v<u,1e3,0)", ""},
         up([](Real u, Real v) { return floorl(u * 4) + (v < u ? 1000 : 0); }),
         1e-12},
        {"angle",
         {"atan2(v,u)", "", "", ""},
         [](Real u, Real v) {
             return Three{atan2l(v, u), 0, 0};
         },
         1e-14},
        {"pole",
         {"", "1/u", "", ""},
         [](Real u, Real) {
             return Three{0, 1 / u, 0};
         },
         1e-11},
    };
}

TEST(FormulaDisplacement, IsWithinItsBoundOfTheFormula) {
    const std::vector<glm::dvec2> at = points(120, 1);
    for (const Known& known : known_formulas()) {
        SCOPED_TRACE(known.name);
        const FormulaOffsets offsets = displacement(known.text).offsets(at);
        ASSERT_EQ(offsets.values.size(), 3 * at.size());
        std::int64_t undefined = 0;
        Real most_error = 0, most = 0;
        for (std::size_t i = 0; i < at.size(); ++i) {
            const Three exact = known.value(at[i].x, at[i].y);
            const bool has_value = std::isfinite(exact[0] + exact[1] + exact[2]);
            if (!has_value) ++undefined;
            for (std::size_t c = 0; c < 3; ++c) {
                const Real value = offsets.values[3 * i + c];
                most_error = std::max(most_error, fabsl(value - (has_value ? exact[c] : 0)));
                most = std::max(most, fabsl(value));
            }
        }
        EXPECT_LE(most_error, offsets.error_bound);
        EXPECT_GE(most_error, offsets.error_bound / 1e7);
        EXPECT_LE(offsets.error_bound, known.most_bound);
        EXPECT_EQ(offsets.most, most);
        EXPECT_EQ(offsets.undefined, undefined);
    }
}

TEST(FormulaDisplacement, BoundsHoldAtEveryPointByItself) {
    // The bound of many points is the largest of all; here each has its own.
    for (const Known& known : known_formulas()) {
        SCOPED_TRACE(known.name);
        const FormulaDisplacement formula = displacement(known.text);
        for (const glm::dvec2& p : points(25, 2)) {
            const FormulaOffsets offsets = formula.offsets(std::span(&p, 1));
            const Three exact = known.value(p.x, p.y);
            for (std::size_t c = 0; c < 3 && offsets.undefined == 0; ++c)
                EXPECT_LE(fabsl(offsets.values[c] - exact[c]), offsets.error_bound);
        }
    }
}

TEST(FormulaDisplacement, DerivativesAreThoseOfTheFormula) {
    for (const Known& known : known_formulas()) {
        SCOPED_TRACE(known.name);
        const FormulaDisplacement formula = displacement(known.text);
        for (const glm::dvec2& p : points(30, 3)) {
            const Real h = 1e-6L;
            const auto difference = [&](Real du, Real dv, std::size_t c) {
                return (known.value(p.x + du, p.y + dv)[c] - known.value(p.x - du, p.y - dv)[c]) / (2 * h);
            };
            const DisplacementJet jet = formula.jet(p);
            for (std::size_t c = 0; c < 3; ++c) {
                const Real by_u = difference(h, 0, c), by_v = difference(0, h, c);
                // Next to a border, a pole or a jump differences say nothing.
                if (!(fabsl(by_u) < 5 && fabsl(by_v) < 5)) continue;
                EXPECT_NEAR(jet.by_u[static_cast<int>(c)], by_u, 1e-7);
                EXPECT_NEAR(jet.by_v[static_cast<int>(c)], by_v, 1e-7);
            }
        }
    }
    // The tip of a cone has none.
    const DisplacementJet tip = upwards("2-hypot(u,v)").jet({0, 0});
    EXPECT_EQ(tip.value, glm::dvec3(0, 0, 2));
    EXPECT_EQ(tip.by_u, glm::dvec3(0.0));
    EXPECT_EQ(tip.by_v, glm::dvec3(0.0));
}

TEST(FormulaDisplacement, SlopesAreAddedToThoseOfAList) {
    const std::vector<glm::dvec2> at = points(9, 4);
    const FormulaDisplacement formula = displacement({"u*v", "", "sin(u)", ""});
    double by[6][SurfaceSlopes::kMost] = {};
    by[2][1] = 10;
    const std::int32_t chosen[] = {7, 70};
    formula.add_slopes(at, {2, 0, chosen, by});
    EXPECT_EQ(by[0][0], at[7].y);
    EXPECT_EQ(by[3][1], at[70].x);
    EXPECT_NEAR(by[2][0], std::cos(at[7].x), 1e-15);
    EXPECT_NEAR(by[2][1], 10 + std::cos(at[70].x), 1e-14);
    EXPECT_EQ(by[1][0], 0);
}

TEST(FormulaDisplacement, RoundingDecidesOnAJump) {
    // 10 u is 3 in double, and less than 3 exactly.
    const glm::dvec2 on_jump(.3, 0), off(.31, 0);
    const FormulaDisplacement steps = upwards("floor(10*u)");
    EXPECT_EQ(steps.offsets(std::span(&on_jump, 1)).error_bound, 1);
    EXPECT_LE(steps.offsets(std::span(&off, 1)).error_bound, 1e-15);
    // The border of the domain: the root of what rounding leaves of 0.
    const glm::dvec2 border(.6, .8);
    const FormulaOffsets hill = upwards("sqrt(1-u^2-v^2)").offsets(std::span(&border, 1));
    EXPECT_GT(hill.error_bound, 0);
    EXPECT_LT(hill.error_bound, 1e-7);
    // What is next to infinite there is not known.
    EXPECT_EQ(upwards("1/sqrt(1-u^2-v^2)").offsets(std::span(&border, 1)).error_bound, kInf);
}

TEST(FormulaDisplacement, PointsWithoutAValueStay) {
    const std::vector<glm::dvec2> at = {{0, 0}, {-1, 0}, {1, 0}, {kNan, 0}, {0, kInf}, {800, 0}, {4, 0}};
    const FormulaOffsets roots = displacement({"1", "sqrt(u)", "", ""}).offsets(at);
    EXPECT_EQ(
        roots.values,
        (std::vector<double>{0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 1, std::sqrt(800.), 0, 1, 2, 0}));
    EXPECT_EQ(roots.undefined, 2);
    EXPECT_LT(roots.error_bound, 1e-14);
    // What double does not hold is no value either.
    const FormulaOffsets powers = upwards("exp(u)").offsets(at);
    EXPECT_EQ(powers.undefined, 1);
    EXPECT_EQ(powers.values[17], 0);
    EXPECT_LT(powers.error_bound, 1e-13);
    EXPECT_EQ(upwards("1/0").offsets(at).undefined, 5);
    EXPECT_EQ(upwards("1").offsets({}).values.size(), 0u);
}

TEST(FormulaDisplacement, SameBitsForAnyThreadsAndCut) {
    const std::vector<glm::dvec2> at = points(70, 5);
    const FormulaDisplacement formula = displacement({"sin(9*u)*exp(v)", "atan2(u,v)", "log(u)", ""});
    const FormulaOffsets all = formula.offsets(at);
    const ParallelFor threads = [](std::int64_t count, const std::function<void(std::int64_t)>& body) {
        std::vector<std::thread> pool;
        for (std::int64_t t = 0; t < 3; ++t)
            pool.emplace_back([=, &body] {
                for (std::int64_t i = count - 1 - t; i >= 0; i -= 3) body(i);
            });
        for (std::thread& thread : pool) thread.join();
    };
    const FormulaOffsets again = formula.offsets(at, threads);
    EXPECT_EQ(again.values, all.values);
    EXPECT_EQ(again.error_bound, all.error_bound);
    EXPECT_EQ(again.undefined, all.undefined);
    for (const std::size_t first : {std::size_t{1}, std::size_t{1000}, at.size() - 5}) {
        const FormulaOffsets part = formula.offsets(std::span(at).subspan(first));
        EXPECT_TRUE(std::equal(part.values.begin(), part.values.end(),
                               all.values.begin() + static_cast<std::ptrdiff_t>(3 * first)));
    }
}

/// A grid of a width that fills no vector, deformed by a bump and by a formula: points are rounded from the base
/// plus the sum and the offset.
template <class T>
void expect_offsets_added() {
    constexpr int kColumns = 45, kRows = 7;
    std::vector<double> u, v;
    for (int i = 0; i < kColumns; ++i) u.push_back(.013 * i);
    for (int j = 0; j < kRows; ++j) v.push_back(.1 * j);
    std::vector<glm::dvec2> at;
    std::vector<T> base;
    for (const double y : v)
        for (const double x : u) {
            at.emplace_back(x, y);
            base.insert(base.end(), {T(x), T(y), T(.3)});
        }
    const std::vector<Deformation> list = {{{.1, -.2, .3}, {.2, .3}, {.2, .2}}};
    const auto changes = difference({}, list);
    const std::vector<double> offsets = displacement({"sin(u)", "v/3", "exp(u*v)", ""}).offsets(at).values;
    std::vector<double> sums(base.size());
    deform_grid<double>(list, u, v, {}, nullptr, sums.data());

    std::vector<T> of_grid(base.size()), moved(base.size()), of_points(base.size());
    DeformedGrid grid(u, v);
    grid.set_offsets(offsets.data());
    grid.apply(changes);
    grid.write<T>(base.data(), of_grid.data(), serial_for, moved.data());
    DeformedPoints points(at);
    points.set_offsets(offsets.data());
    points.apply(changes);
    points.write<T>(base.data(), of_points.data());
    EXPECT_EQ(of_points, of_grid);
    for (std::size_t k = 0; k < base.size(); ++k) {
        const double displacement = sums[k] + offsets[k];
        ASSERT_EQ(of_grid[k], static_cast<T>(displacement + base[k]));
        ASSERT_EQ(moved[k], static_cast<T>(displacement));
    }
}

TEST(FormulaDisplacement, OffsetsAreAddedToSums) {
    test::on_every_instruction_set([] {
        expect_offsets_added<float>();
        expect_offsets_added<double>();
    });
}

TEST(FormulaDisplacement, TextIsOfUAndVAndFrame) {
    const glm::dvec2 p(.25, .75);
    EXPECT_EQ(displacement({"u", "v", "frame", ""}, 2.5).jet(p).value, glm::dvec3(.25, .75, 2.5));
    EXPECT_EQ(displacement({"", "k*u", "", "k=2;unused=3"}).jet(p).value, glm::dvec3(0, .5, 0));
    EXPECT_EQ(fault_of({"aspect", "", "", ""}),
              "x=aspect: column 1: expected a name that is known, not aspect");
    EXPECT_THAT(fault_of({"", "1+", "", ""}), HasSubstr("y=1+: column 3: expected a number, a name or ("));
    EXPECT_THAT(fault_of({"", "", "(u", ""}), HasSubstr("z=(u: column 3: expected )"));
    EXPECT_THAT(fault_of({"", "", "u", "u=3"}), HasSubstr("let=u=3: column 1: expected another name"));
    EXPECT_THAT(fault_of({"", "", "u", "a"}), HasSubstr("let=a: column 2: expected ="));
    EXPECT_TRUE(upwards("u+v") == upwards(" u + v"));
    EXPECT_FALSE(upwards("u+v") == upwards("u-v"));
    EXPECT_FALSE(displacement({"frame", "", "", ""}, 1) == displacement({"frame", "", "", ""}, 2));
}

}  // namespace
}  // namespace anamorph::test_formula_displacement
