// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/surface/parallelogram_rows_lanes.cpp"
#include "anamorph/surface/parallelogram_rows.h"

#include "hwy/cache_control.h"
#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::surface::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// The pixels of a view that a parallelogram may cover.
HWY_INLINE Box PixelsOf(const Parallelogram& p, const ParallelogramView& view) {
    if (view.times == 1) return intersection(p.pixels, view.box);
    const int n = view.times;
    return intersection(
        {(p.pixels.x0 - 1) * n, (p.pixels.y0 - 1) * n, (p.pixels.x1 + 1) * n, (p.pixels.y1 + 1) * n},
        view.box);
}

/// Puts the lanes of a mask. Where it is not said which lanes are written stores are several times as fast.
template <class V, class M>
HWY_INLINE void Put(V values, M where, double* to) {
    const hn::DFromV<V> d;
    hn::StoreU(hn::IfThenElse(where, values, hn::LoadU(d, to)), d, to);
}

// Products and sums are rounded one by one, so that sets with and without fused operations agree; and nothing depends on
// where the box begins.
template <bool kByDepth>
HWY_INLINE void DrawOne(const Parallelogram& p, double id, const ParallelogramGrid& whole,
                        const ParallelogramView& view, const FacetPlanes& to) {
    const hn::CappedTag<double, 16> d;
    using V = hn::Vec<decltype(d)>;
    constexpr int kLanes = static_cast<int>(hn::MaxLanes(d));
    const Box box = PixelsOf(p, view);
    if (box.empty()) return;
    const ParallelogramGrid grid = p.level == 0 ? whole : whole.at(p.level);
    const double u = (p.column + 0.5) * grid.side_u, v = (p.row + 0.5) * grid.side_v;
    const V low_u = hn::Set(d, HWY_MAX(-grid.half_u, -u)), high_u = hn::Set(d, HWY_MIN(grid.half_u, 1 - u)),
            low_v = hn::Set(d, HWY_MAX(-grid.half_v, -v)), high_v = hn::Set(d, HWY_MIN(grid.half_v, 1 - v));
    const V centre_u = hn::Set(d, u), centre_v = hn::Set(d, v), number = hn::Set(d, id);
    const V lane = hn::Iota(d, 0);
    const V u_x = hn::Set(d, p.u_x), v_x = hn::Set(d, p.v_x);
    const double left = 0.5 * view.width + p.x, top = 0.5 * view.height + p.y, step = 1.0 / view.times;
    for (int j = box.y0; j < box.y1; ++j) {
        const double dy = (j + 0.5) * step - top;
        const V row_u = hn::Set(d, dy * p.u_y), row_v = hn::Set(d, dy * p.v_y);
        const std::ptrdiff_t row = (j - view.box.y0) * to.stride - view.box.x0;
        for (int i = box.x0; i < box.x1; i += kLanes) {
            const V column = hn::Add(lane, hn::Set(d, i + 0.5));
            const V dx = hn::Sub(hn::Mul(column, hn::Set(d, step)), hn::Set(d, left));
            const V du = hn::Add(hn::Mul(dx, u_x), row_u), dv = hn::Add(hn::Mul(dx, v_x), row_v);
            auto in = hn::And(hn::And(hn::Ge(du, low_u), hn::Lt(du, high_u)),
                              hn::And(hn::Ge(dv, low_v), hn::Lt(dv, high_v)));
            if (kByDepth) {
                double* const nearness = to.nearness + row + i;
                const V depth = hn::Add(
                    hn::Add(hn::Mul(du, hn::Set(d, p.z_u)), hn::Mul(dv, hn::Set(d, p.z_v))), hn::Set(d, p.z));
                in = hn::And(in, hn::Gt(hn::Neg(depth), hn::LoadU(d, nearness)));
                Put(hn::Neg(depth), in, nearness);
            }
            if (hn::AllFalse(d, in)) continue;
            Put(hn::Add(centre_u, du), in, to.u + row + i);
            Put(hn::Add(centre_v, dv), in, to.v + row + i);
            Put(number, in, to.id + row + i);
        }
    }
}

void DrawParallelograms(const Parallelogram* HWY_RESTRICT all, const std::uint32_t* HWY_RESTRICT list,
                        std::size_t count, const ParallelogramGrid& grid, const ParallelogramView& view,
                        bool by_depth, const FacetPlanes& to) {
    for (std::size_t k = 0; k < count; ++k) {
        constexpr std::size_t kAhead = 4;
        if (k + kAhead < count) hwy::Prefetch(all + list[k + kAhead]);
        const Parallelogram& p = all[list[k]];
        if (by_depth)
            DrawOne<true>(p, 2.0 * list[k], grid, view, to);
        else
            DrawOne<false>(p, 2.0 * list[k], grid, view, to);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::surface::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::surface::simd {

HWY_EXPORT(DrawParallelograms);

void draw_parallelograms(const Parallelogram* all, const std::uint32_t* list, std::size_t count,
                         const ParallelogramGrid& grid, const ParallelogramView& view, bool by_depth,
                         const FacetPlanes& to) {
    HWY_DYNAMIC_DISPATCH(DrawParallelograms)(all, list, count, grid, view, by_depth, to);
}

}  // namespace anamorph::surface::simd
#endif
