// SPDX-License-Identifier: Apache-2.0
// The coefficients of lenses over rings enclose the derivatives of the root, found by halving in long double; panoramas
// through lenses are blocks nearly everywhere, whichever way their formula goes.
#include "anamorph/chart/lens_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "anamorph/lens/lens_plan.h"
#include "anamorph/panorama/panorama_plan.h"
#include "panorama_oracle.h"

namespace anamorph::test_lens_table {
namespace {

using oracle::LensOracle;
using oracle::View;
using Real = long double;

const char* const kLenses[] = {"ptlens:a=0.01,b=-0.03,c=0.02",
                               "ptlens:b=-0.45",
                               "ptlens:a=-0.2",
                               "brown:k1=-0.2,k2=0.05,k3=-0.004",
                               "brown:k1=0.1,k2=0.02,k3=0.001,k4=0.15,k5=0.01,k6=0.002",
                               "3de4:k1=0.1,k2=0.03",
                               "3de4:k1=-0.25",
                               "division:k1=-0.1,k2=0.01",
                               "poly:k0=0.03,k2=-0.04,k4=0.005",
                               "poly:k0=-0.02,k1=0.02,k2=-0.03,k3=0.01,k4=0.002,d=7,e=-12",
                               "ocam:a0=-400,a2=5e-4,a3=-1e-7,a4=2e-10,d=4.5,e=-3",
                               "ocam:a0=500,a2=-2e-4,a4=-1e-10",
                               "ocam:a0=-400,a2=5e-4,affine_c=0.9,affine_d=0.02,affine_e=-0.04,e=-3",
                               "kb4:k1=0.05,k2=-0.01,k3=0.002,k4=-0.0003"};

/// The k-th divided difference of f over k + 1 points: its k-th derivative somewhere between them, over k!.
template <class F>
Real divided_difference(const F& f, Real from, Real step, int k) {
    Real values[6];
    for (int i = 0; i <= k; ++i) values[i] = f(from + step * i);
    for (int order = 1; order <= k; ++order)
        for (int i = 0; i + order <= k; ++i) values[i] = (values[i + 1] - values[i]) / (step * order);
    return values[0];
}

/// Does every coefficient over an interval hold the divided differences of points of it?
template <class F>
void expect_encloses(const LensCoefficients& found, const Interval& squared, const F& f,
                     const std::string& words) {
    const Real width = Real(squared.hi) - squared.lo;
    for (int k = 0; k <= 5; ++k) {
        const Real step = width / std::max(k, 1);
        const Real known = divided_difference(f, squared.lo, step, k);
        // Values are off by some roundings, differences by as many times 2^k / (k! step^k).
        Real off = 64 * 0x1p-64L * f(squared.lo);
        for (int order = 1; order <= k; ++order) off *= 2 / (step * order);
        EXPECT_LE(found.c[k].lo, known + off) << words << " coefficient " << k;
        EXPECT_GE(found.c[k].hi, known - off) << words << " coefficient " << k;
    }
}

TEST(LensTable, EnclosesDerivativesOfTheRoot) {
    constexpr unsigned kSeed = 1971;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const char* text : kLenses) {
        const View view = oracle::view_through(text, {1500, 1000}, 100);
        const LensOracle truth(view);
        const Chart chart = oracle::chart_of(view);
        const LensTerms& terms = chart.lens()->terms();
        const double reach = terms.to_observed ? terms.observed_end : terms.ideal_end;
        int bounded = 0;
        for (int i = 0; i < 300; ++i) {
            // A ring as narrow as a block or as wide as a region of blocks, up to where the lens ends.
            const double low = 0.02 + 0.9 * uniform(random),
                         high = std::min(low * (1 + std::pow(10, -2 * uniform(random))), 0.97);
            const Interval squared(low * low * reach * reach, high * high * reach * reach);
            if (!(squared.hi > squared.lo * 1.001)) continue;
            const auto shrink = [&](Real q) { return truth.root(std::sqrt(q)) / std::sqrt(q); };
            const std::string words =
                std::string(text) + " from " + std::to_string(low) + " to " + std::to_string(high);
            const LensCoefficients found = shrink_coefficients(terms, squared);
            expect_encloses(found, squared, shrink, words);
            bounded += magnitude(found.c[5]) < HUGE_VAL;
            if (!terms.in_radius || !(squared.hi < terms.end * terms.end)) continue;
            const auto stretch = [&](Real q) { return truth.formula(std::sqrt(q)) / std::sqrt(q); };
            expect_encloses(stretch_coefficients(terms, squared), squared, stretch, words + ", stretched");
        }
        EXPECT_GT(bounded, 200) << text;
    }
}

// What double computes of the root is as far off as is said at most, and its coefficients enclose the derivatives.
TEST(LensTable, KnowsWhatDoubleComputes) {
    constexpr unsigned kSeed = 1968;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const char* text : kLenses) {
        const View view = oracle::view_through(text, {1500, 1000}, 100);
        const LensOracle truth(view);
        const Chart chart = oracle::chart_of(view);
        const LensTerms& terms = chart.lens()->terms();
        const auto shrink = [&](Real value) {
            const Real r = terms.in_radius ? value : std::sqrt(value);
            return truth.root(r) / r;
        };
        int inner = 0, close = 0;
        for (int i = 0; i < 300; ++i) {
            const double low = terms.value_end * std::pow(0.95 * uniform(random), 2) + 1e-4,
                         high =
                             std::min(low * (1 + std::pow(10, -4 * uniform(random))), 0.95 * terms.value_end);
            if (!(high > low)) continue;
            const std::string words =
                std::string(text) + " from " + std::to_string(low) + " to " + std::to_string(high);
            const ComputedSeries found = computed_shrink(terms, {low, high});
            if (high > low * 1.001) expect_encloses(found.exact, {low, high}, shrink, words);
            const double value = low + uniform(random) * (high - low);
            const auto series = lens_detail::shrink_series<ComputedSeries::kDegree>(
                terms, lens_formula::radial_root(terms, value));
            // The oracle's own root is known to some roundings of long double.
            const Real slack = 0x1p-60L * shrink(value);
            EXPECT_LE(std::fabs(series.c[0] - shrink(value)), found.error[0] + slack) << words;
            EXPECT_EQ(series.c[0], lens_formula::shrink(terms, value)) << words;
            const Interval range = anamorph::shrink(terms, Interval(low, high));
            EXPECT_LE(range.lo, shrink(value) + slack) << words;
            EXPECT_GE(range.hi, shrink(value) - slack) << words;
            // About within the picture, which reaches a quarter as far as the lens at most.
            if (value > terms.value_end * (terms.in_radius ? 0.25 : 0.0625)) continue;
            ++inner;
            close += found.error[0] < 1e-11 && found.error[4] < 1e-6;
        }
        EXPECT_GT(close, 0.8 * inner) << text;
        EXPECT_GT(inner, 50) << text;
    }
}

// All of what the lens reaches, what lies beyond, and what is no interval at all.
TEST(LensTable, TakesAnyInterval) {
    for (const char* text : kLenses) {
        const Chart chart = oracle::chart_of(oracle::view_through(text, {1500, 1000}, 100));
        const LensTerms& terms = chart.lens()->terms();
        const double reach = terms.to_observed ? terms.observed_end : terms.ideal_end;
        for (const Interval& squared :
             {Interval(0), Interval(0, reach * reach), Interval(0, 1e6 * reach * reach), Interval(1e6),
              Interval::all(), Interval(NAN, NAN)}) {
            const LensCoefficients found = shrink_coefficients(terms, squared);
            const Constant(&shear)[4] = terms.shear;
            const Real area =
                terms.sheared ? shear[0].value() * shear[3].value() - shear[1].value() * shear[2].value() : 1;
            const Real magnified = chart.lens()->magnification() / std::sqrt(area),
                       centre = terms.to_observed ? 1 / magnified : magnified;
            if (squared.contains(0)) {
                EXPECT_LE(found.c[0].lo, centre + 1e-15L) << text;
                EXPECT_GE(found.c[0].hi, centre - 1e-15L) << text;
            }
            EXPECT_FALSE(found.c[5].lo > found.c[5].hi) << text;
            const Interval value = terms.in_radius && squared.lo >= 0 ? sqrt(squared) : squared;
            const ComputedSeries computed = computed_shrink(terms, value);
            const bool within = value.lo >= 0 && value.hi <= terms.value_end;
            EXPECT_TRUE(within || !(computed.error[0] < HUGE_VAL)) << text;
        }
    }
}

double exact_fraction_of(const BlockMap& plan) {
    return plan.reached(serial_for).exact_fraction;
}

// What a lens bends costs few polynomials more than the view without it, as far as remainders are known well: k1 alone folds next
// to the picture's corner.
TEST(LensTable, ViewsThroughLensesTakeFewBlocks) {
    const Size size{1024, 1024};
    const Chart sphere(Projection::equirectangular, 8192, 4096);
    const auto blocks_of = [&](const Chart& target) {
        // Where bounds cost little more than polynomials, few blocks are what bounds allow.
        PlanOptions options;
        options.costs = PlanCosts{.bound = 170, .further_bound = 10, .rounding = 60};
        const PanoramaPlan plan(Panorama(sphere, target, {30, 20, 10}), options);
        std::size_t count = 0;
        for (std::int64_t region = 0; region < plan.regions(); ++region) count += plan.blocks(region).size();
        return count;
    };
    const std::size_t bare = blocks_of(Chart(Projection::rectilinear, size.width, size.height, 90));
    for (const char* text : {"brown:k1=-0.1,k2=0.02,p1=0.002,p2=-0.003",
                             "brown:k1=-0.1,k2=0.02,s1=0.002,s3=-0.001", "3de4:k1=0.1,k2=0.03"})
        EXPECT_LE(2 * blocks_of(oracle::chart_of(oracle::view_through(text, size, 90))), 3 * bare) << text;
}

TEST(LensTable, PicturesThroughLensesAreBlocks) {
    const Chart sphere(Projection::equirectangular, 4096, 2048), flat(Projection::rectilinear, 600, 600, 60);
    const Size size{1024, 1024};
    // What is exact lies about the centres of lenses that have powers of the distance itself, and about their ends.
    constexpr double kMost = 0.15;
    for (const char* text : {"ptlens:a=0.01,b=-0.03,c=0.02", "brown:k1=-0.2,k2=0.05,k3=-0.004",
                             "brown:k1=-0.1,k2=0.02,p1=0.002,p2=-0.003", "3de4:k1=0.1,k2=0.03",
                             "kb4:k1=0.05,k2=-0.01,k3=0.002,k4=-0.0003"}) {
        SCOPED_TRACE(text);
        const Chart observed = oracle::chart_of(oracle::view_through(text, size, 90));
        EXPECT_LT(exact_fraction_of(PanoramaPlan(Panorama(sphere, observed, {30, 20, 10}), {})), kMost);
        EXPECT_LT(exact_fraction_of(PanoramaPlan(Panorama(observed, flat, {30, 20, 10}), {})), kMost);
        for (const LensMode mode : {LensMode::undistort, LensMode::distort})
            EXPECT_LT(exact_fraction_of(LensPlan(LensMap(observed, mode, size, size, size), {})), kMost);
    }
}

}  // namespace
}  // namespace anamorph::test_lens_table
