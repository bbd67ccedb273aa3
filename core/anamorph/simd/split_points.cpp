// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/simd/split_points.cpp"
#include "anamorph/simd/split_points.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void SplitPoints(const double* HWY_RESTRICT points, int count, double scale, std::int32_t base,
                 std::int32_t* HWY_RESTRICT texels, float* HWY_RESTRICT rests) {
    const hn::CappedTag<double, 16> d;
    const hn::Rebind<float, decltype(d)> df;
    const hn::Rebind<std::int32_t, decltype(d)> di;
    const auto to_level = hn::Set(d, scale);
    const auto origin = hn::Set(di, base);
    const auto most = hn::Set(df, 0x1.fffffep-1f);
    for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(d))) {
        const auto at = hn::Mul(hn::LoadU(d, points + i), to_level);
        const auto whole = hn::Floor(at);
        hn::StoreU(hn::Sub(hn::DemoteTo(di, whole), origin), di, texels + i);
        hn::StoreU(hn::Min(hn::DemoteTo(df, hn::Sub(at, whole)), most), df, rests + i);
    }
}

void ExtendRange(const double* HWY_RESTRICT values, int count, double& low, double& high) {
    const hn::CappedTag<double, 16> d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    // 0, or NaN; minima may lose a NaN.
    double none = low == low ? 0 : low;
    auto least = hn::Set(d, low), greatest = hn::Set(d, high), nothing = hn::Zero(d);
    int i = 0;
    for (; i + lanes <= count; i += lanes) {
        const auto v = hn::LoadU(d, values + i);
        least = hn::Min(least, v);
        greatest = hn::Max(greatest, v);
        nothing = hn::Add(nothing, hn::Sub(v, v));
    }
    low = hn::GetLane(hn::MinOfLanes(d, least));
    high = hn::GetLane(hn::MaxOfLanes(d, greatest));
    none += hn::GetLane(hn::SumOfLanes(d, nothing));
    for (; i < count; ++i) {
        low = HWY_MIN(low, values[i]);
        high = HWY_MAX(high, values[i]);
        none += values[i] - values[i];
    }
    low += none;
    high += none;
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(SplitPoints);
HWY_EXPORT(ExtendRange);

void split_points(const double* points, int count, double scale, std::int32_t base, std::int32_t* texels,
                  float* rests) {
    HWY_DYNAMIC_DISPATCH(SplitPoints)(points, count, scale, base, texels, rests);
}

void extend_range(const double* values, int count, double& low, double& high) {
    HWY_DYNAMIC_DISPATCH(ExtendRange)(values, count, low, high);
}

}  // namespace anamorph::simd
#endif
