// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/surface/facet_rows_lanes.cpp"
#include "anamorph/surface/facet_rows.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::surface::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Puts the lanes of a mask. Where it is not said which lanes are written stores are several times as fast.
template <class V, class M>
HWY_INLINE void Put(V values, M where, double* to) {
    const hn::DFromV<V> d;
    hn::StoreU(hn::IfThenElse(where, values, hn::LoadU(d, to)), d, to);
}

/// The columns of a row, of `width`, that may be in a triangle: a pixel more on each side, for what this loses.
struct Columns {
    int first, end;

    HWY_INLINE Columns(int from, int to) : first(from), end(to) {}
    HWY_INLINE Columns(const FacetSetup& f, const double (&inverse)[3], int row, int width) {
        double low = 0, high = width;
        for (int k = 0; k < 3; ++k) {
            const double at = (f.least[k] - (f.e[k] + row * f.down[k])) * inverse[k];
            if (f.right[k] > 0) low = HWY_MAX(low, at - 1);
            if (f.right[k] < 0) high = HWY_MIN(high, at + 2);
        }
        first = static_cast<int>(HWY_MIN(low, width));
        end = static_cast<int>(HWY_MAX(high, 0));
    }
};

// Products and sums are rounded one by one, so that sets with and without fused operations agree. Sums of e_i times
// what is not negative lose a few units of 2^-53, and e_i themselves are exact.
void DrawFacet(const FacetSetup& f, int width, int height, const FacetPlanes& to) {
    const hn::CappedTag<double, 16> d;
    using V = hn::Vec<decltype(d)>;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const V end = hn::Set(d, width), lane = hn::Iota(d, 0);
    const auto sum = [&](const V& a, const V& b, const V& c, const double* of) HWY_ATTR {
        return hn::Add(hn::Add(hn::Mul(a, hn::Set(d, of[0])), hn::Mul(b, hn::Set(d, of[1]))),
                       hn::Mul(c, hn::Set(d, of[2])));
    };
    // Worth their while in long rows.
    const bool trims = width > 2 * lanes;
    double inverse[3] = {0, 0, 0};
    for (int k = 0; trims && k < 3; ++k) inverse[k] = 1 / f.right[k];
    for (int j = 0; j < height; ++j) {
        const Columns columns = trims ? Columns(f, inverse, j, width) : Columns{0, width};
        const std::ptrdiff_t row = j * to.stride;
        const auto edge = [&](int k, const V& column) HWY_ATTR {
            return hn::Add(hn::Set(d, f.e[k] + j * f.down[k]), hn::Mul(column, hn::Set(d, f.right[k])));
        };
        for (int i = columns.first; i < columns.end; i += lanes) {
            const V column = hn::Add(lane, hn::Set(d, i));
            const V a = edge(0, column), b = edge(1, column), c = edge(2, column);
            auto in = hn::And(hn::Ge(a, hn::Set(d, f.least[0])), hn::Ge(b, hn::Set(d, f.least[1])));
            in = hn::And(hn::And(in, hn::Ge(c, hn::Set(d, f.least[2]))), hn::Lt(column, end));
            if (hn::AllFalse(d, in)) continue;
            double* const nearness = to.nearness + row + i;
            const V near = sum(a, b, c, f.nearness);
            in = hn::And(in, hn::Gt(near, hn::LoadU(d, nearness)));
            if (hn::AllFalse(d, in)) continue;
            const V scale = hn::Div(hn::Set(d, 1), sum(a, b, c, f.weight));
            Put(near, in, nearness);
            Put(hn::Mul(sum(a, b, c, f.u), scale), in, to.u + row + i);
            Put(hn::Mul(sum(a, b, c, f.v), scale), in, to.v + row + i);
            Put(hn::Set(d, f.id), in, to.id + row + i);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::surface::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::surface::simd {

HWY_EXPORT(DrawFacet);

void draw_facet(const FacetSetup& facet, int width, int height, const FacetPlanes& to) {
    HWY_DYNAMIC_DISPATCH(DrawFacet)(facet, width, height, to);
}

}  // namespace anamorph::surface::simd
#endif
