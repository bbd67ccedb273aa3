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

#if HWY_TARGET == HWY_WASM
/// FusedByOdd below of one number: Highway has no doubles for WebAssembly.
inline float FusedByOddOfOne(float a, float b, float c) {
    const double product = double{a} * double{b}, sum = product + double{c};
    const double of_c = sum - product, rest = (product - (sum - of_c)) + (double{c} - of_c);
    if (!(std::fabs(rest) > 0)) return static_cast<float>(sum);
    std::uint64_t bits;
    std::memcpy(&bits, &sum, sizeof(bits));
    bits = (bits - std::uint64_t{std::signbit(sum) != std::signbit(rest)}) | 1;
    double odd;
    std::memcpy(&odd, &bits, sizeof(odd));
    return static_cast<float>(odd);
}

template <class D>
HWY_NOINLINE hn::Vec<D> FusedByOdd(D d, hn::Vec<D> a, hn::Vec<D> b, hn::Vec<D> c) {
    HWY_ALIGN float of_a[hn::MaxLanes(d)], of_b[hn::MaxLanes(d)], of_c[hn::MaxLanes(d)];
    hn::Store(a, d, of_a), hn::Store(b, d, of_b), hn::Store(c, d, of_c);
    for (std::size_t i = 0; i < hn::MaxLanes(d); ++i) of_a[i] = FusedByOddOfOne(of_a[i], of_b[i], of_c[i]);
    return hn::Load(d, of_a);
}

/// Fused below of four floats, with the test of MayBeRoundedTwice, in WebAssembly's own words.
template <class D>
HWY_INLINE hn::Vec<D> FusedByWasm(D d, hn::Vec<D> a, hn::Vec<D> b, hn::Vec<D> c) {
    const auto sum_of_low = [](v128_t p, v128_t q, v128_t r) {
        return wasm_f64x2_add(
            wasm_f64x2_mul(wasm_f64x2_promote_low_f32x4(p), wasm_f64x2_promote_low_f32x4(q)),
            wasm_f64x2_promote_low_f32x4(r));
    };
    const auto upper = [](v128_t v) { return wasm_i64x2_shuffle(v, v, 1, 1); };
    const v128_t low = sum_of_low(a.raw, b.raw, c.raw),
                 high = sum_of_low(upper(a.raw), upper(b.raw), upper(c.raw));
    const v128_t rounded =
        wasm_i64x2_shuffle(wasm_f32x4_demote_f64x2_zero(low), wasm_f32x4_demote_f64x2_zero(high), 0, 2);
    const v128_t low_bits = wasm_i32x4_shuffle(low, high, 0, 2, 4, 6);
    const v128_t middle =
        wasm_i32x4_eq(wasm_v128_and(low_bits, wasm_i32x4_splat(0x1fffffff)), wasm_i32x4_splat(0x10000000));
    const v128_t twice = wasm_i32x4_sub(wasm_i32x4_shl(rounded, 1), wasm_i32x4_splat(1));
    const v128_t denormal = wasm_u32x4_lt(twice, wasm_i32x4_splat(0x00ffffff));
    if (HWY_UNLIKELY(wasm_v128_any_true(wasm_v128_or(middle, denormal)))) return FusedByOdd(d, a, b, c);
    return hn::Vec<D>{rounded};
}
#elif !HWY_NATIVE_FMA
/// Products of floats, exact in double (24 by 24 bits), and their sums with c, rounded.
template <class D>
struct SumsInDouble {
    using Doubles = hn::Rebind<double, D>;
    hn::Vec<Doubles> product, c, sum;

    HWY_INLINE SumsInDouble(hn::Vec<D> a, hn::Vec<D> b, hn::Vec<D> add)
        : product(hn::Mul(hn::PromoteTo(Doubles(), a), hn::PromoteTo(Doubles(), b))),
          c(hn::PromoteTo(Doubles(), add)),
          sum(hn::Add(product, c)) {}

    /// The sums rounded to odd: to the nearest double where it is one, else to that neighbour of which the last bit is 1. A sum is off by
    /// `rest`, which is exact (Knuth 1969, Two-Sum), and is one of both neighbours: it stays where it is odd, and is followed or preceded
    /// by the odd one, whichever way the rest points. Odd stays odd where 1 is taken off and the last bit set.
    HWY_INLINE hn::Vec<Doubles> RoundedToOdd() const {
        const Doubles d;
        const hn::RebindToUnsigned<Doubles> du;
        const auto of_c = hn::Sub(sum, product);
        const auto rest = hn::Add(hn::Sub(product, hn::Sub(sum, of_c)), hn::Sub(c, of_c));
        // Not where the sum is infinite or no number, and the rest none.
        const auto inexact = hn::BitCast(du, hn::VecFromMask(d, hn::Gt(hn::Abs(rest), hn::Zero(d))));
        const auto bits = hn::BitCast(du, sum);
        const auto towards_zero = hn::ShiftRight<63>(hn::And(hn::Xor(bits, hn::BitCast(du, rest)), inexact));
        return hn::BitCast(d, hn::Or(hn::Sub(bits, towards_zero), hn::ShiftRight<63>(inexact)));
    }
};

/// The nearest floats, beyond the largest infinity: Highway's own conversion of single numbers ends at the largest.
template <class D>
HWY_INLINE hn::Vec<D> NearestFloats(D d, hn::Vec<hn::Rebind<double, D>> v) {
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
    HWY_ALIGN double from[hn::MaxLanes(d)];
    HWY_ALIGN float to[hn::MaxLanes(d)];
    hn::Store(v, hn::Rebind<double, D>(), from);
    for (std::size_t i = 0; i < hn::MaxLanes(d); ++i) to[i] = static_cast<float>(from[i]);
    return hn::Load(d, to);
#else
    return hn::DemoteTo(d, v);
#endif
}

/// a b + c, rounded once: to odd in 53 bits it is rounded to 24, or to fewer of a small number, as if it had been at once, since
/// 53 >= 24 + 2 (Boldo and Melquiond 2008).
template <class D>
HWY_NOINLINE hn::Vec<D> FusedByOdd(D d, hn::Vec<D> a, hn::Vec<D> b, hn::Vec<D> c) {
#if HWY_TARGET != HWY_SCALAR
    if constexpr (hn::MaxLanes(d) > 2) {
        const hn::Half<D> half;
        const auto upper = SumsInDouble<decltype(half)>(hn::UpperHalf(half, a), hn::UpperHalf(half, b),
                                                        hn::UpperHalf(half, c));
        const auto lower = SumsInDouble<decltype(half)>(hn::LowerHalf(half, a), hn::LowerHalf(half, b),
                                                        hn::LowerHalf(half, c));
        return hn::Combine(d, NearestFloats(half, upper.RoundedToOdd()),
                           NearestFloats(half, lower.RoundedToOdd()));
    } else
#endif
        return NearestFloats(d, SumsInDouble<D>(a, b, c).RoundedToOdd());
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
#endif

/// a b + c of floats, rounded once.
template <class V>
HWY_INLINE V Fused(V a, V b, V c) {
#if HWY_NATIVE_FMA
    return hn::MulAdd(a, b, c);
#else
    const hn::DFromV<V> d;
    static_assert(sizeof(hn::TFromV<V>) == sizeof(float));
#if HWY_TARGET == HWY_WASM
    return FusedByWasm(d, a, b, c);
#elif HWY_TARGET == HWY_SCALAR
    const SumsInDouble<decltype(d)> sums(a, b, c);
    const V rounded = NearestFloats(d, sums.sum);
    std::int64_t bits;
    std::memcpy(&bits, &sums.sum.raw, sizeof(bits));
    if (HWY_UNLIKELY(MayBeRoundedTwice(d, rounded,
                                       hn::Set(hn::RebindToSigned<decltype(d)>(), static_cast<int>(bits)))))
        return FusedByOdd(d, a, b, c);
    return rounded;
#else
    if constexpr (hn::MaxLanes(d) <= 2) {
        return FusedByOdd(d, a, b, c);
    } else {
        const hn::Half<decltype(d)> half;
        const hn::RebindToSigned<decltype(d)> di;
        const auto upper = SumsInDouble<decltype(half)>(hn::UpperHalf(half, a), hn::UpperHalf(half, b),
                                                        hn::UpperHalf(half, c));
        const auto lower = SumsInDouble<decltype(half)>(hn::LowerHalf(half, a), hn::LowerHalf(half, b),
                                                        hn::LowerHalf(half, c));
        const V rounded = hn::Combine(d, NearestFloats(half, upper.sum), NearestFloats(half, lower.sum));
        if (HWY_UNLIKELY(MayBeRoundedTwice(
                d, rounded, hn::ConcatEven(di, hn::BitCast(di, upper.sum), hn::BitCast(di, lower.sum)))))
            return FusedByOdd(d, a, b, c);
        return rounded;
    }
#endif
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#endif
