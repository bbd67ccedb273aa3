// SPDX-License-Identifier: Apache-2.0
// Roots of lenses for four points at once: as for one, whatever stands beside it, and the same bits on every instruction set;
// and polynomials through lenses, held against derivatives in long double.
#include "anamorph/chart/lens_lanes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "anamorph/chart/chart_jets.h"
#include "each_instruction_set.h"
#include "panorama_oracle.h"

namespace anamorph::test_lens_lanes {
namespace {

using simd::Four;
using simd::kJets;
using simd::TaylorJets;

const char* const kLenses[] = {"ptlens:a=0.01,b=-0.03,c=0.02",
                               "brown:k1=-0.2,k2=0.05,k3=-0.004",
                               "brown:k1=0.1,k2=0.02,k3=0.001,k4=0.15,k5=0.01,k6=0.002",
                               "brown:k1=-0.1,k2=0.02,p1=0.002,p2=-0.003",
                               "brown:p1=-0.01,d=30",
                               "brown:k1=-0.1,k2=0.02,s1=0.002,s2=-0.001,s3=-0.003,s4=0.0005",
                               "brown:k1=0.1,p1=0.002,p2=-0.001,s1=-0.003,s2=0.0004,d=9",
                               "brown:k1=0.05,k4=0.02,p1=0.005,p2=0.02,e=-20",
                               "3de4:k1=0.1,k2=0.03",
                               "division:k1=-0.1,k2=0.01",
                               "poly:k0=0.03,k2=-0.04,k4=0.005",
                               "poly:k0=-0.02,k1=0.02,k2=-0.03,k3=0.01,k4=0.002,d=7,e=-12",
                               "ocam:a0=-400,a2=5e-4,a3=-1e-7,a4=2e-10,d=4.5,e=-3",
                               "ocam:a0=500,a2=-2e-4,a4=-1e-10",
                               "ocam:a0=-400,a2=5e-4,affine_c=0.9,affine_d=0.02,affine_e=-0.04,e=-3",
                               "kb4:k1=0.05,k2=-0.01,k3=0.002,k4=-0.0003"};

Chart chart_with(const char* text) {
    return oracle::chart_of(oracle::view_through(text, {1500, 1000}, 100));
}

/// The same bits; one NaN is as good as another.
bool same(double a, double b) {
    return (std::isnan(a) && std::isnan(b)) || std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(LensLanes, EachIsAsIfAlone) {
    std::mt19937 random(1986);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const char* text : kLenses) {
        SCOPED_TRACE(text);
        const Chart chart = chart_with(text);
        const LensTerms& terms = chart.lens()->terms();
        for (int n = 0; n < 100; ++n) {
            Four<double> values;
            for (int i = 0; i < kJets; ++i) values.set(i, terms.value_end * uniform(random));
            if (n % 5 == 0) values.set(n % kJets, NAN);
            if (n % 7 == 0) values.set(n % kJets, 2 * terms.value_end);
            test::on_every_instruction_set([&] {
                Four<double> c[TaylorJets::kDegree + 1];
                simd::shrink_series_of(terms, values, c);
                for (int i = 0; i < kJets; ++i) {
                    const auto one = lens_formula::shrink_series<TaylorJets::kDegree>(
                        terms, lens_formula::radial_root(terms, values[i]));
                    for (int k = 0; k <= TaylorJets::kDegree; ++k)
                        EXPECT_TRUE(same(c[k][i], one.c[k])) << values[i] << ' ' << k;
                }
            });
        }
    }
}

TEST(LensLanes, EachPointIsSettledAsIfAlone) {
    std::mt19937 random(1987);
    std::uniform_real_distribution<double> uniform(-0.7, 0.7);
    for (const char* text : kLenses) {
        SCOPED_TRACE(text);
        const Chart chart = chart_with(text);
        const LensTerms& terms = chart.lens()->terms();
        if (!terms.tangential) continue;
        for (int n = 0; n < 100; ++n) {
            Point<Four<double>> v, u;
            for (int i = 0; i < kJets; ++i) {
                v.x.set(i, terms.observed_end * uniform(random));
                v.y.set(i, terms.observed_end * uniform(random));
            }
            if (n % 5 == 0) v.x.set(n % kJets, NAN);
            test::on_every_instruction_set([&] {
                simd::settled_of(terms, v, u);
                for (int i = 0; i < kJets; ++i) {
                    const Point<double> one = lens_formula::settled(terms, Point<double>{v.x[i], v.y[i]});
                    EXPECT_TRUE(same(u.x[i], one.x) && same(u.y[i], one.y)) << v.x[i] << ' ' << v.y[i];
                }
            });
        }
    }
}

/// Four polynomials about points of a lens's plane, their derivatives, and what rounding may do to them.
template <class Through>
int examine(const double (&x)[kJets], const double (&y)[kJets], double h, const Through& through) {
    using J = Jet<long double, 4>;
    using R = Rounded<double>;
    const double sizes[kJets] = {h, h, h, h}, none[kJets] = {};
    const Point<TaylorJets> four = through(
        Point<TaylorJets>{TaylorJets::variable(x, sizes, none), TaylorJets::variable(y, none, sizes)});
    int known = 0;
    for (int i = 0; i < kJets; ++i) {
        const Point<J> exact = through(Point<J>{J::variable(x[i], h, 0), J::variable(y[i], 0, h)});
        const Point<R> bound = through(Point<R>{R(x[i], h, 0), R(y[i], h, 0)});
        if (!(bound.x.error < 1e-6 && bound.y.error < 1e-6)) continue;
        ++known;
        const auto off = [&](const TaylorJets& jets, const J& truth) {
            const Jet<double, 4> jet = jets.at(i);
            long double sum = 0;
            for (int k = 0; k < J::kSize; ++k) sum += std::fabs(jet.c[k] - truth.c[k]);
            return static_cast<double>(sum);
        };
        EXPECT_LE(off(four.x, exact.x), bound.x.error) << x[i] << ' ' << y[i];
        EXPECT_LE(off(four.y, exact.y), bound.y.error) << x[i] << ' ' << y[i];
    }
    return known;
}

TEST(LensLanes, PolynomialsAreWithinTheirRounding) {
    std::mt19937 random(1988);
    std::uniform_real_distribution<double> uniform(-0.6, 0.6);
    for (const char* text : kLenses) {
        SCOPED_TRACE(text);
        const Chart chart = chart_with(text);
        const Lens& lens = *chart.lens();
        int known = 0;
        for (int n = 0; n < 60; ++n) {
            double x[kJets], y[kJets];
            for (int i = 0; i < kJets; ++i) {
                x[i] = lens.reach() * uniform(random);
                y[i] = lens.reach() * uniform(random);
            }
            const double h = lens.reach() * std::ldexp(1.0, -4 - n % 8);
            known += examine(x, y, h, [&](const auto& p) { return lens.ideal(p); });
        }
        EXPECT_GT(known, 100);
    }
}

}  // namespace
}  // namespace anamorph::test_lens_lanes
