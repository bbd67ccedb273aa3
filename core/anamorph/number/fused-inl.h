// SPDX-License-Identifier: Apache-2.0
// a b + c, rounded once: one result on every processor. Kernels whose numbers become colours use it in place of Highway's MulAdd,
// which rounds the product where an instruction set cannot do both at once (tests/core/fused.py looks for that one).
// Included once for every instruction set, as Highway's own headers are.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "hwy/highway.h"
#if HWY_ARCH_WASM
#include <wasm_simd128.h>
#endif

#if defined(ANAMORPH_NUMBER_FUSED_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ANAMORPH_NUMBER_FUSED_INL_H_
#undef ANAMORPH_NUMBER_FUSED_INL_H_
#else
#define ANAMORPH_NUMBER_FUSED_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if !HWY_NATIVE_FMA
/// a b + c, rounded once: to odd in 53 bits it is rounded to 24, or to fewer of a small number, as if it had been at once, since
/// 53 >= 24 + 2 (Boldo and Melquiond 2008). The product is exact in double (24 by 24 bits). Their sum is off by `rest`, which is exact
/// (Knuth 1969, Two-Sum), and is one of both neighbours: rounded to odd it stays where it is odd, and is followed or preceded by the odd
/// one, whichever way the rest points. Odd stays odd where 1 is taken off and the last bit set.
inline float FusedByOdd(float a, float b, float c) {
    const double product = double{a} * double{b}, sum = product + double{c};
    const double of_c = sum - product, rest = (product - (sum - of_c)) + (double{c} - of_c);
    // The sum is exact, or infinite, or no number, and the rest none.
    if (!(std::fabs(rest) > 0)) return static_cast<float>(sum);
    std::uint64_t bits;
    std::memcpy(&bits, &sum, sizeof(bits));
    bits = (bits - std::uint64_t{std::signbit(sum) != std::signbit(rest)}) | 1;
    double odd;
    std::memcpy(&odd, &bits, sizeof(odd));
    return static_cast<float>(odd);
}

template <class D>
HWY_NOINLINE hn::Vec<D> FusedOneByOne(D d, hn::Vec<D> a, hn::Vec<D> b, hn::Vec<D> c) {
    HWY_ALIGN float of_a[hn::MaxLanes(d)], of_b[hn::MaxLanes(d)], of_c[hn::MaxLanes(d)];
    hn::Store(a, d, of_a), hn::Store(b, d, of_b), hn::Store(c, d, of_c);
    for (std::size_t i = 0; i < hn::MaxLanes(d); ++i) of_a[i] = FusedByOdd(of_a[i], of_b[i], of_c[i]);
    return hn::Load(d, of_a);
}

/// May a float that is a rounded sum be another than if it had been rounded at once? Only where the sum, of which `low_bits` are the last
/// 32, is the middle of two floats, as the 29 bits say that a float lacks; and among denormal floats, which lack more: of bits m without
/// sign these are 0 < m < 2^23, that is, 2 m - 1 below 2^24 - 1 as a number without sign. Where the float is 0, the sum is exact: c, a
/// multiple of 2^-149, is 0 or cancels a product of 48 bits, all of which are left.
template <class D>
HWY_INLINE bool MayBeRoundedTwice(D, hn::Vec<D> rounded, hn::Vec<hn::RebindToSigned<D>> low_bits) {
    const hn::RebindToSigned<D> di;
    const auto bits = hn::BitCast(di, rounded);
    const auto middle = hn::Eq(hn::And(low_bits, hn::Set(di, 0x1fffffff)), hn::Set(di, 0x10000000));
    const auto twice =
        hn::Add(hn::Add(bits, bits), hn::Set(di, 0x7fffffff));  // less 1, and signed as they were ordered
    const auto denormal = hn::Lt(twice, hn::Set(di, static_cast<int>(0x80000000u + 0x00ffffff)));
    return !hn::AllFalse(di, hn::Or(middle, denormal));
}

#if HWY_TARGET == HWY_WASM
/// Sums a b + c in double, rounded to floats, and their last 32 bits, in WebAssembly's own words: Highway has no doubles for it.
template <class D>
HWY_INLINE hn::Vec<D> SumsInDouble(D, hn::Vec<D> a, hn::Vec<D> b, hn::Vec<D> c,
                                   hn::Vec<hn::RebindToSigned<D>>& low_bits) {
    const auto sum_of_low = [](v128_t p, v128_t q, v128_t r) {
        return wasm_f64x2_add(
            wasm_f64x2_mul(wasm_f64x2_promote_low_f32x4(p), wasm_f64x2_promote_low_f32x4(q)),
            wasm_f64x2_promote_low_f32x4(r));
    };
    const auto upper = [](v128_t v) { return wasm_i64x2_shuffle(v, v, 1, 1); };
    const v128_t low = sum_of_low(a.raw, b.raw, c.raw),
                 high = sum_of_low(upper(a.raw), upper(b.raw), upper(c.raw));
    low_bits.raw = wasm_i32x4_shuffle(low, high, 0, 2, 4, 6);
    return hn::Vec<D>{
        wasm_i64x2_shuffle(wasm_f32x4_demote_f64x2_zero(low), wasm_f32x4_demote_f64x2_zero(high), 0, 2)};
}
#elif HWY_TARGET == HWY_SCALAR
template <class D>
HWY_INLINE hn::Vec<D> SumsInDouble(D d, hn::Vec<D> a, hn::Vec<D> b, hn::Vec<D> c,
                                   hn::Vec<hn::RebindToSigned<D>>& low_bits) {
    const double sum = double{a.raw} * double{b.raw} + double{c.raw};
    std::int64_t bits;
    std::memcpy(&bits, &sum, sizeof(bits));
    low_bits = hn::Set(hn::RebindToSigned<D>(), static_cast<int>(bits));
    return hn::Set(d, static_cast<float>(sum));
}
#else
/// The nearest floats, beyond the largest infinity: Highway's own conversion of single numbers ends at the largest.
template <class D>
HWY_INLINE hn::Vec<D> NearestFloats(D d, hn::Vec<hn::Rebind<double, D>> v) {
#if HWY_TARGET == HWY_EMU128
    HWY_ALIGN double from[hn::MaxLanes(d)];
    HWY_ALIGN float to[hn::MaxLanes(d)];
    hn::Store(v, hn::Rebind<double, D>(), from);
    for (std::size_t i = 0; i < hn::MaxLanes(d); ++i) to[i] = static_cast<float>(from[i]);
    return hn::Load(d, to);
#else
    return hn::DemoteTo(d, v);
#endif
}

/// Sums a b + c in double, rounded to floats, and their last 32 bits.
template <class D>
HWY_INLINE hn::Vec<D> SumsInDouble(D d, hn::Vec<D> a, hn::Vec<D> b, hn::Vec<D> c,
                                   hn::Vec<hn::RebindToSigned<D>>& low_bits) {
    const hn::Half<D> half;
    const hn::Rebind<double, hn::Half<D>> doubles;
    const hn::RebindToSigned<D> di;
    const auto sum = [&](hn::Vec<hn::Half<D>> p, hn::Vec<hn::Half<D>> q, hn::Vec<hn::Half<D>> r) HWY_ATTR {
        return hn::Add(hn::Mul(hn::PromoteTo(doubles, p), hn::PromoteTo(doubles, q)),
                       hn::PromoteTo(doubles, r));
    };
    const auto upper = sum(hn::UpperHalf(half, a), hn::UpperHalf(half, b), hn::UpperHalf(half, c));
    const auto lower = sum(hn::LowerHalf(half, a), hn::LowerHalf(half, b), hn::LowerHalf(half, c));
    low_bits = hn::ConcatEven(di, hn::BitCast(di, upper), hn::BitCast(di, lower));
    return hn::Combine(d, NearestFloats(half, upper), NearestFloats(half, lower));
}
#endif

/// a b + c by doubles: long, and so a function that is called, but in WebAssembly, all of whose pictures are drawn by it.
template <class V>
#if HWY_ARCH_WASM
HWY_INLINE
#else
HWY_NOINLINE
#endif
V FusedByDoubles(V a, V b, V c) {
    const hn::DFromV<V> d;
    if constexpr (HWY_TARGET != HWY_SCALAR && hn::MaxLanes(d) <= 2) {
        return FusedOneByOne(d, a, b, c);
    } else {
        hn::Vec<hn::RebindToSigned<decltype(d)>> low_bits;
        const V rounded = SumsInDouble(d, a, b, c, low_bits);
        if (HWY_UNLIKELY(MayBeRoundedTwice(d, rounded, low_bits))) return FusedOneByOne(d, a, b, c);
        return rounded;
    }
}
#endif

/// a b + c of floats, rounded once.
template <class V>
HWY_INLINE V Fused(V a, V b, V c) {
    static_assert(sizeof(hn::TFromV<V>) == sizeof(float));
#if HWY_NATIVE_FMA
    return hn::MulAdd(a, b, c);
#else
    return FusedByDoubles(a, b, c);
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#endif
