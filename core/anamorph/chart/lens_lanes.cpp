// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/chart/lens_lanes.cpp"
#include "anamorph/chart/lens_lanes.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "anamorph/number/lanes.h"

using D = hn::CappedTag<double, kJets>;
using L = Lanes<D>;

// The formulas once more, for this instruction set.
namespace formulas {
HWY_INLINE bool somewhere(const LaneMask<D>& condition) {
    return !hn::AllFalse(D(), condition.m);
}
/// By the table, as for double.
HWY_INLINE L near_root(const LensTerms& lens, const L& value) {
    HWY_ALIGN double each[L::kCount];
    value.store(each);
    for (double& one : each) one = anamorph::near_root(lens, one);
    return L::load(each);
}
#include "anamorph/chart/lens_formula.h"
}  // namespace formulas

void ComputeShrinkSeries(const LensTerms& lens, const Four<double>& values, Four<double>* c) {
    constexpr int kDegree = TaylorJets::kDegree;
    for (int lane = 0; lane < kJets; lane += L::kCount) {
        const L root = formulas::radial_root(lens, L::load(values.v + lane));
        const auto series = formulas::shrink_series<kDegree>(lens, root);
        for (int k = 0; k <= kDegree; ++k) series.c[k].store(c[k].v + lane);
    }
}
void ComputeSettled(const LensTerms& lens, const Point<Four<double>>& v, Point<Four<double>>& u) {
    for (int lane = 0; lane < kJets; lane += L::kCount) {
        const Point<L> found =
            formulas::settled(lens, Point<L>{L::load(v.x.v + lane), L::load(v.y.v + lane)});
        found.x.store(u.x.v + lane);
        found.y.store(u.y.v + lane);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(ComputeShrinkSeries);
HWY_EXPORT(ComputeSettled);

void shrink_series_of(const LensTerms& lens, const Four<double>& values,
                      Four<double> (&coefficients)[TaylorJets::kDegree + 1]) {
    HWY_DYNAMIC_DISPATCH(ComputeShrinkSeries)(lens, values, coefficients);
}
void settled_of(const LensTerms& lens, const Point<Four<double>>& v, Point<Four<double>>& u) {
    HWY_DYNAMIC_DISPATCH(ComputeSettled)(lens, v, u);
}

}  // namespace anamorph::simd
#endif
