// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/mesh/cubic_rows_lanes.cpp"
#include "anamorph/mesh/cubic_rows.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using F = hn::Rebind<float, D>;
using V = hn::Vec<D>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));

/// A cubic's coefficients in vectors.
struct Cubic {
    V c0, c1, c2, c3;

    HWY_INLINE explicit Cubic(const CubicRow& row)
        : c0(hn::Set(D(), row.c[0])),
          c1(hn::Set(D(), row.c[1])),
          c2(hn::Set(D(), row.c[2])),
          c3(hn::Set(D(), row.c[3])) {}
    // No fused multiply-adds, which some processors have.
    HWY_INLINE hn::Vec<F> At(V s) const {
        const V inner = hn::Add(c1, hn::Mul(s, hn::Add(c2, hn::Mul(s, c3))));
        return hn::DemoteTo(F(), hn::Add(c0, hn::Mul(s, inner)));
    }
};

void WriteCubics(std::span<const CubicRun> runs, double from, double step, float* HWY_RESTRICT to_x,
                 float* HWY_RESTRICT to_y) {
    const V first = hn::Iota(D(), 0), each = hn::Set(D(), step);
    for (const CubicRun& run : runs) {
        const Cubic x(run.x), y(run.y);
        for (int i = run.begin; i < run.end; i += kLanes) {
            const V s = hn::Mul(hn::Add(first, hn::Set(D(), from + i)), each);
            hn::StoreU(x.At(s), F(), to_x + i);
            hn::StoreU(y.At(s), F(), to_y + i);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(WriteCubics);

void write_cubics(std::span<const CubicRun> runs, double from, double step, float* to_x, float* to_y) {
    HWY_DYNAMIC_DISPATCH(WriteCubics)(runs, from, step, to_x, to_y);
}

}  // namespace anamorph::simd
#endif
