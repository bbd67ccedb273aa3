// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/mesh/sample_rows_lanes.cpp"
#include "anamorph/mesh/sample_rows.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void ExtendSampleRange(const float* HWY_RESTRICT uv, std::ptrdiff_t count, SampleRange& range) {
    // u in even lanes, v in odd ones.
    constexpr int kWide = 16;
    const hn::CappedTag<float, kWide> d;
    constexpr int kLanes = static_cast<int>(hn::MaxLanes(d)), kParts = kWide / kLanes;
    HWY_ALIGN float low[kWide], high[kWide], none[kWide];
    for (int i = 0; i < kWide; ++i) {
        low[i] = range.low[i & 1];
        high[i] = range.high[i & 1];
        none[i] = range.low[i & 1] == range.low[i & 1] ? 0.0f : range.low[i & 1];
    }
    const std::ptrdiff_t numbers = 2 * count;
    std::ptrdiff_t i = 0;
    if (kLanes > 1) {
        hn::Vec<decltype(d)> least[kParts], greatest[kParts], nothing[kParts];
        for (int p = 0; p < kParts; ++p) {
            least[p] = hn::Load(d, low + p * kLanes);
            greatest[p] = hn::Load(d, high + p * kLanes);
            nothing[p] = hn::Load(d, none + p * kLanes);
        }
        for (; i + kWide <= numbers; i += kWide)
            for (int p = 0; p < kParts; ++p) {
                const auto v = hn::LoadU(d, uv + i + p * kLanes);
                least[p] = hn::Min(least[p], v);
                greatest[p] = hn::Max(greatest[p], v);
                // 0, or NaN where a value is infinite or none; minima may lose a NaN.
                nothing[p] = hn::Add(nothing[p], hn::Sub(v, v));
            }
        for (int p = 0; p < kParts; ++p) {
            hn::Store(least[p], d, low + p * kLanes);
            hn::Store(greatest[p], d, high + p * kLanes);
            hn::Store(nothing[p], d, none + p * kLanes);
        }
    }
    for (; i < numbers; ++i) {
        low[i & 1] = HWY_MIN(low[i & 1], uv[i]);
        high[i & 1] = HWY_MAX(high[i & 1], uv[i]);
        none[i & 1] += uv[i] - uv[i];
    }
    for (int n = 0; n < kWide; ++n) {
        range.low[n & 1] = HWY_MIN(range.low[n & 1], low[n]);
        range.high[n & 1] = HWY_MAX(range.high[n & 1], high[n]);
    }
    float lost[2] = {0, 0};
    for (int n = 0; n < kWide; ++n) lost[n & 1] += none[n];
    for (int k = 0; k < 2; ++k) {
        range.low[k] += lost[k];
        range.high[k] += lost[k];
    }
}

void SamplePlaces(const float* HWY_RESTRICT uv, int count, const SampleAxis& x, const SampleAxis& y,
                  float* HWY_RESTRICT to_x, float* HWY_RESTRICT to_y) {
    const hn::CappedTag<double, 8> d;
    const hn::Rebind<float, decltype(d)> df;
    constexpr int kLanes = static_cast<int>(hn::MaxLanes(d));
    HWY_ALIGN float last[2 * 8] = {};
    const auto lanes = hn::Iota(d, 0);
    const auto place = [&](const SampleAxis& axis, int i, hn::Vec<decltype(df)> v) HWY_ATTR {
        const auto at = hn::Add(lanes, hn::Set(d, i));
        const auto start = hn::Add(hn::Mul(at, hn::Set(d, axis.step)), hn::Set(d, axis.first));
        return hn::DemoteTo(df, hn::Add(hn::Mul(hn::PromoteTo(d, v), hn::Set(d, axis.scale)), start));
    };
    for (int i = 0; i < count; i += kLanes) {
        const float* from = uv + 2 * i;
        // Behind the last sample nothing may be read.
        if (i + kLanes > count) {
            for (int n = 0; n < 2 * (count - i); ++n) last[n] = from[n];
            from = last;
        }
        hn::Vec<decltype(df)> u, v;
        hn::LoadInterleaved2(df, from, u, v);
        hn::StoreU(place(x, i, u), df, to_x + i);
        hn::StoreU(place(y, i, v), df, to_y + i);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(ExtendSampleRange);
HWY_EXPORT(SamplePlaces);

void extend_range(const float* uv, std::ptrdiff_t count, SampleRange& range) {
    HWY_DYNAMIC_DISPATCH(ExtendSampleRange)(uv, count, range);
}
void sample_places(const float* uv, int count, const SampleAxis& x, const SampleAxis& y, float* to_x,
                   float* to_y) {
    HWY_DYNAMIC_DISPATCH(SamplePlaces)(uv, count, x, y, to_x, to_y);
}

}  // namespace anamorph::simd
#endif
