// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/image/own_taps_lanes.cpp"
#include "anamorph/image/own_taps.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

#include "anamorph/number/fused-inl.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using V = hn::Vec<Floats>;

struct Step {
    V x, y;
};

HWY_INLINE V SquaredLength(const Step& s) {
    return Fused(s.x, s.x, hn::Mul(s.y, s.y));
}

/// The step from the points at `from` to those `ahead` entries farther on.
HWY_INLINE Step StepFrom(const float* x, const float* y, ptrdiff_t from, ptrdiff_t ahead) {
    const Floats d;
    return {hn::Sub(hn::LoadU(d, x + from + ahead), hn::LoadU(d, x + from)),
            hn::Sub(hn::LoadU(d, y + from + ahead), hn::LoadU(d, y + from))};
}

HWY_INLINE Step Shorter(const Step& a, const Step& b) {
    const auto first = hn::Lt(SquaredLength(a), SquaredLength(b));
    return {hn::IfThenElse(first, a.x, b.x), hn::IfThenElse(first, a.y, b.y)};
}

/// Half of the way between the two taps of a side: along it, half as long as their distance d. Two taps d apart are as good as an
/// exact average over a length l where (2/3 + A(d)) / 2 = (1 - 1 / (3 l)) / l (footprint.h), which is d^2 - d^3 / 2 = 2/3 (1 - 1/l)
/// (2 - 1/l); d / q with q^2 = l - 1 is a polynomial in q here, within 1.2e-4 texels of d for l up to 2.
HWY_INLINE Step TapOf(const Step& side, V squared_length) {
    const Floats d;
    const auto one = hn::Set(d, 1.0f);
    const auto length = hn::Sqrt(hn::Max(squared_length, one));
    const auto q = hn::Sqrt(hn::Sub(length, one));
    auto p = hn::Set(d, 0.67825002f);
    p = Fused(p, q, hn::Set(d, -1.9987953f));
    p = Fused(p, q, hn::Set(d, 2.6146848f));
    p = Fused(p, q, hn::Set(d, -1.9126091f));
    p = Fused(p, q, hn::Set(d, 0.73018819f));
    p = Fused(p, q, hn::Set(d, 0.065956643f));
    p = Fused(p, q, hn::Set(d, 0.82220862f));
    const auto share = hn::Div(hn::Mul(hn::Mul(p, q), hn::Set(d, 0.5f)), length);
    return {hn::Mul(side.x, share), hn::Mul(side.y, share)};
}

/// The taps of pixels whose sides these are, to entry k and behind.
HWY_INLINE void StoreTaps(const Step& across, const Step& down, const OwnTapRows& to, ptrdiff_t k) {
    const Floats d;
    const Ints di;
    const auto a2 = SquaredLength(across), b2 = SquaredLength(down);
    const Step a = TapOf(across, a2), b = TapOf(down, b2);
    hn::StoreU(a.x, d, to.x_i + k);
    hn::StoreU(a.y, d, to.y_i + k);
    hn::StoreU(b.x, d, to.x_j + k);
    hn::StoreU(b.y, d, to.y_j + k);
    const auto most = hn::Set(d, kLongestOwnSide * kLongestOwnSide), one = hn::Set(d, 1.0f),
               half = hn::Set(d, 0.5f);
    const auto kind = [&](OwnKind which) HWY_ATTR { return hn::Set(di, static_cast<int32_t>(which)); };
    // Written so that what is no number is among the others.
    const auto own = hn::And(hn::Le(a2, most), hn::Le(b2, most));
    const auto magnified = hn::And(hn::Le(a2, one), hn::Le(b2, one));
    const auto near = hn::And(hn::Le(hn::Add(hn::Abs(a.x), hn::Abs(b.x)), half),
                              hn::Le(hn::Add(hn::Abs(a.y), hn::Abs(b.y)), half));
    const auto either = [&](hn::Mask<Floats> yes, hn::Vec<Ints> then, hn::Vec<Ints> otherwise)
                            HWY_ATTR { return hn::IfThenElse(hn::RebindMask(di, yes), then, otherwise); };
    hn::StoreU(
        either(magnified, kind(OwnKind::one),
               either(own, either(near, kind(OwnKind::nine), kind(OwnKind::four)), kind(OwnKind::others))),
        di, to.kind + k);
}

/// The steps to the left and to the right of every pixel of a row: entry i is the one to the left of pixel i. The first and the last
/// have one neighbour.
struct StepsAcross {
    float x[kRowRoom + 16], y[kRowRoom + 16];

    HWY_INLINE StepsAcross(const float* px, const float* py, int width) {
        const Floats d;
        for (int i = 0; i < width - 1; i += static_cast<int>(hn::MaxLanes(d))) {
            const Step s = StepFrom(px, py, i, 1);
            hn::StoreU(s.x, d, x + i + 1);
            hn::StoreU(s.y, d, y + i + 1);
        }
        x[0] = x[1];
        y[0] = y[1];
        x[width] = x[width - 1];
        y[width] = y[width - 1];
    }
    HWY_INLINE Step LeftOf(int i) const { return {hn::LoadU(Floats(), x + i), hn::LoadU(Floats(), y + i)}; }
};

void FindOwnTaps(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y, ptrdiff_t stride, int width,
                 int height, const OwnTapRows& to) {
    for (int j = 0; j < height; ++j) {
        const ptrdiff_t row = j * stride;
        const ptrdiff_t up = j > 0 ? row - stride : row, down = j + 1 < height ? row : row - stride;
        const StepsAcross across(x + row, y + row, width);
        for (int i = 0; i < width; i += static_cast<int>(hn::MaxLanes(Floats())))
            StoreTaps(Shorter(across.LeftOf(i), across.LeftOf(i + 1)),
                      Shorter(StepFrom(x, y, up + i, stride), StepFrom(x, y, down + i, stride)), to,
                      j * to.stride + i);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(FindOwnTaps);

void own_taps(const float* x, const float* y, std::ptrdiff_t row_stride, int width, int height,
              const OwnTapRows& to) {
    HWY_DYNAMIC_DISPATCH(FindOwnTaps)(x, y, row_stride, width, height, to);
}

}  // namespace anamorph::simd
#endif
