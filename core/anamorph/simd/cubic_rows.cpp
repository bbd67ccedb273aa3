// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/simd/cubic_rows.cpp"
#include "anamorph/simd/cubic_rows.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void WriteCubic(const CubicRow& cubic, int count, float* HWY_RESTRICT to) {
    const hn::CappedTag<double, 8> d;
    const hn::Rebind<float, decltype(d)> df;
    constexpr int kLanes = static_cast<int>(hn::MaxLanes(d));
    const auto d0 = hn::Set(d, cubic.d0), d1 = hn::Set(d, cubic.d1), d2 = hn::Set(d, cubic.d2),
               d3 = hn::Set(d, cubic.d3), h = hn::Set(d, cubic.h), twice = hn::Set(d, 2 * cubic.h),
               base = hn::Set(d, cubic.base);
    // No fused multiply-adds, which some processors have.
    const auto values = [&](int i) HWY_ATTR {
        const auto x = hn::Iota(d, i);
        const auto inner = hn::Add(d2, hn::Mul(hn::Sub(x, twice), d3));
        const auto middle = hn::Add(d1, hn::Mul(hn::Sub(x, h), inner));
        return hn::DemoteTo(df, hn::Sub(hn::Add(d0, hn::Mul(x, middle)), base));
    };
    int i = 0;
    for (; i + kLanes <= count; i += kLanes) hn::StoreU(values(i), df, to + i);
    if (i == count) return;
    HWY_ALIGN float last[8];
    hn::Store(values(i), df, last);
    for (int n = 0; i + n < count; ++n) to[i + n] = last[n];
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(WriteCubic);

void write_cubic(const CubicRow& cubic, int count, float* to) {
    HWY_DYNAMIC_DISPATCH(WriteCubic)(cubic, count, to);
}

}  // namespace anamorph::simd
#endif
