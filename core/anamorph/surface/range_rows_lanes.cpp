// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/surface/range_rows_lanes.cpp"
#include "anamorph/surface/range_rows.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::surface::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void ReachAlong(const Axes& axes, const FloatRange* HWY_RESTRICT ranges, int count,
                double (*HWY_RESTRICT reach)[4]) {
    const hn::CappedTag<double, 4> d;
    for (int k = 0; k < 4; k += static_cast<int>(hn::Lanes(d))) {
        const auto x = hn::LoadU(d, axes.coordinates[0] + k), y = hn::LoadU(d, axes.coordinates[1] + k),
                   z = hn::LoadU(d, axes.coordinates[2] + k);
        const auto size_x = hn::Abs(x), size_y = hn::Abs(y), size_z = hn::Abs(z);
        for (int i = 0; i < count; ++i) {
            const auto along = [&](const float* v, auto a, auto b, auto c) HWY_ATTR {
                return hn::Add(
                    hn::Add(hn::Mul(a, hn::Set(d, double{v[0]})), hn::Mul(b, hn::Set(d, double{v[1]}))),
                    hn::Mul(c, hn::Set(d, double{v[2]})));
            };
            hn::StoreU(hn::Add(hn::Abs(along(ranges[i].middle, x, y, z)),
                               along(ranges[i].radius, size_x, size_y, size_z)),
                       d, reach[i] + k);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::surface::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::surface::simd {

HWY_EXPORT(ReachAlong);

void reach_along(const Axes& axes, const FloatRange* ranges, int count, double (*reach)[4]) {
    HWY_DYNAMIC_DISPATCH(ReachAlong)(axes, ranges, count, reach);
}

}  // namespace anamorph::surface::simd
#endif
