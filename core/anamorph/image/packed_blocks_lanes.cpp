// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/image/packed_blocks_lanes.cpp"
#include "anamorph/image/packed_blocks.h"

#include <cstring>
#include <type_traits>

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

#include "anamorph/image/block_rows-inl.h"
#include "anamorph/image/nine_texels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Offsets of a row of pixels up to a whole group: those behind the last are the last's.
HWY_INLINE void FillGroup(int32_t* offset, int count, int group) {
    for (int i = count; i % group != 0; ++i) offset[i] = offset[count - 1];
}

/// Copies a row to the picture: whole aligned cache lines bypass the cache. There is room to read a vector behind it.
HWY_INLINE void StreamRow(const void* HWY_RESTRICT row, int count, std::byte* HWY_RESTRICT to) {
    const hn::CappedTag<uint8_t, 32> d;
    constexpr int kLine = 64;
    const auto* from = static_cast<const uint8_t*>(row);
    auto* bytes = reinterpret_cast<uint8_t*>(to);
    const int past = static_cast<int>(reinterpret_cast<uintptr_t>(to) % kLine);
    int i = HWY_MIN(count, past ? kLine - past : 0);
    if (i > 0) std::memcpy(bytes, from, static_cast<size_t>(i));
    for (; i + kLine <= count; i += kLine)
        for (int k = 0; k < kLine; k += static_cast<int>(hn::MaxLanes(d)))
            hn::Stream(hn::LoadU(d, from + i + k), d, bytes + i + k);
    if (i < count) std::memcpy(bytes + i, from + i, static_cast<size_t>(count - i));
}

// --- uint8

constexpr int kWeightBits = 14;

/// A row of pixels: the element offset of the upper left texel, and the weights of two texels above, and of those
/// below, as pairs of 16 bits.
struct WeightedRow {
    HWY_ALIGN int32_t offset[kRowRoom], above[kRowRoom], below[kRowRoom];
};

/// A row of pixels that read nine texels each: the element offset of the one in the middle, and their weights as pairs of
/// 16 bits. Two texels of each row, from the left; then the right ones of the upper two rows; then that of the lowest.
struct NineWeightedRow {
    HWY_ALIGN int32_t pair[5][kRowRoom];
};

/// Weights of nine texels in whole numbers. None is negative, and but for that they add up to 1. Above the last weight there is anything.
HWY_INLINE void WeighNine(const TapsOfRow& taps, const Positions<kRowRoom>& p, int count,
                          NineWeightedRow& to) {
    const Floats d;
    const Ints di;
    constexpr float kOne = 1 << kWeightBits;
    const auto half = hn::Set(d, 0.5f), one = hn::Set(d, kOne), unit = hn::Set(d, kUnit), zero = hn::Zero(d);
    const auto eight_units = hn::ShiftLeft<3>(hn::BitCast(di, unit));
    // In bits that count from kUnit's, of which the lower half is 0: weights are at most 1, and the lower half of theirs is the number.
    const auto bits = [&](hn::Vec<Floats> w) HWY_ATTR { return hn::BitCast(di, hn::MulAdd(w, one, unit)); };
    const auto low_half = hn::Set(di, 0xffff);
    const auto two = [&](hn::Vec<Ints> low, hn::Vec<Ints> high)
                         HWY_ATTR { return hn::Or(hn::And(low, low_half), hn::ShiftLeft<16>(high)); };
    for (int i = 0; i < count; i += static_cast<int>(kLanes)) {
        const EightWeights w =
            taps.Weights(hn::Sub(hn::Load(d, p.fx + i), half), hn::Sub(hn::Load(d, p.fy + i), half), i);
        // Sums of four may have lost so much that they are below 0.
        const auto above_left = bits(w.above_left), above = bits(hn::Max(w.above, zero)),
                   above_right = bits(w.above_right), left = bits(hn::Max(w.left, zero)),
                   right = bits(hn::Max(w.right, zero)), below_left = bits(w.below_left),
                   below = bits(hn::Max(w.below, zero)), below_right = bits(w.below_right);
        const auto around = hn::Add(hn::Add(hn::Add(above_left, above), hn::Add(above_right, left)),
                                    hn::Add(hn::Add(right, below_left), hn::Add(below, below_right)));
        const auto middle =
            hn::Max(hn::Sub(hn::Add(eight_units, hn::Set(di, 1 << kWeightBits)), around), hn::Zero(di));
        hn::Store(two(above_left, above), di, to.pair[0] + i);
        hn::Store(two(left, middle), di, to.pair[1] + i);
        hn::Store(two(below_left, below), di, to.pair[2] + i);
        hn::Store(two(above_right, right), di, to.pair[3] + i);
        hn::Store(below_right, di, to.pair[4] + i);
    }
}

/// Where points fall: between the texels left and right of the whole number r next to x, whose middles are at
/// r - 1/2 and r + 1/2, and so for y.
class Weighing {
  public:
    HWY_INLINE Weighing(ptrdiff_t row, int pixel)
        : m_row(hn::Set(Ints(), static_cast<int32_t>(row))),
          m_pixel(hn::Set(Ints(), pixel)),
          m_from(hn::Mul(hn::Add(m_row, m_pixel),
                         hn::Add(hn::BitCast(Ints(), hn::Set(Floats(), kUnit)), hn::Set(Ints(), 1)))) {}

    /// Whole texels are added where they are given.
    HWY_INLINE void Weigh(hn::Vec<Floats> x, hn::Vec<Floats> y, const int32_t* whole_x,
                          const int32_t* whole_y, int i, WeightedRow& to) const {
        const Ints di;
        const auto one = hn::Set(di, 1 << kWeightBits), half = hn::Set(di, 1 << (kWeightBits - 1));
        hn::Vec<Ints> texel_x, texel_y, wx, wy;
        Split(x, texel_x, wx);
        Split(y, texel_y, wy);
        if (whole_x) {
            texel_x = hn::Add(texel_x, hn::LoadU(di, whole_x));
            texel_y = hn::Add(texel_y, hn::LoadU(di, whole_y));
        }
        hn::Store(hn::Sub(hn::Add(hn::Mul(texel_y, m_row), hn::Mul(texel_x, m_pixel)), m_from), di,
                  to.offset + i);
        const auto both = hn::ShiftRight<kWeightBits>(hn::Add(hn::Mul(wx, wy), half));
        hn::Store(Two(hn::Sub(hn::Add(one, both), hn::Add(wx, wy)), hn::Sub(wx, both)), di, to.above + i);
        hn::Store(Two(hn::Sub(wy, both), both), di, to.below + i);
    }

  private:
    /// The whole number next to `at`, 1 more than the texel, in bits that count from kUnit's; and the weight of the
    /// texel behind it. The difference is exact: at most 1/2, of numbers within a factor of 2, or of 0.
    static HWY_INLINE void Split(hn::Vec<Floats> at, hn::Vec<Ints>& texel, hn::Vec<Ints>& weight) {
        const Floats d;
        const Ints di;
        constexpr float kOne = 1 << kWeightBits;
        const auto unit = hn::Set(d, kUnit), whole = hn::Add(at, unit);
        texel = hn::BitCast(di, whole);
        const auto past = hn::Sub(at, hn::Sub(whole, unit));
        weight = hn::Sub(hn::BitCast(di, hn::MulAdd(past, hn::Set(d, kOne), hn::Set(d, kUnit + kOne / 2))),
                         hn::BitCast(di, unit));
    }
    static HWY_INLINE hn::Vec<Ints> Two(hn::Vec<Ints> low, hn::Vec<Ints> high) {
        return hn::Or(low, hn::ShiftLeft<16>(high));
    }

    hn::Vec<Ints> m_row, m_pixel, m_from;
};

#if HWY_TARGET == HWY_SCALAR
constexpr int kGroup = 1;

template <int kChannels>
HWY_INLINE void SampleGroup(const uint8_t* origin, const uint8_t* next_row, const WeightedRow& at, int i,
                            uint8_t* HWY_RESTRICT out) {
    const uint8_t *p = origin + at.offset[i], *q = next_row + at.offset[i];
    const int32_t above = at.above[i], below = at.below[i], half = 1 << (kWeightBits - 1);
    for (int c = 0; c < kChannels; ++c, ++p, ++q)
        out[c] = static_cast<uint8_t>((p[0] * (above & 0xffff) + p[kChannels] * (above >> 16) +
                                       q[0] * (below & 0xffff) + q[kChannels] * (below >> 16) + half) >>
                                      kWeightBits);
}

template <int kChannels>
HWY_INLINE void SampleNine(const uint8_t* origin, ptrdiff_t row, const int32_t* offset,
                           const NineWeightedRow& w, int i, uint8_t* HWY_RESTRICT out) {
    const uint8_t* p = origin + offset[i] - kChannels;
    for (int c = 0; c < kChannels; ++c, ++p) {
        int32_t sum = 1 << (kWeightBits - 1);
        for (int j = 0; j < 3; ++j) {
            const uint8_t* texel = p + (j - 1) * row;
            const int32_t two = w.pair[j][i], right = j < 2 ? w.pair[3][i] >> (16 * j) : w.pair[4][i];
            sum += texel[0] * (two & 0xffff) + texel[kChannels] * (two >> 16) +
                   texel[2 * kChannels] * (right & 0xffff);
        }
        out[c] = static_cast<uint8_t>(sum >> kWeightBits);
    }
}
#else
// Four channels of a pixel fill a block of 16 bytes; a vector has one such block, or two. Pixel k of a group stands in
// its lower block, pixel k + 4 in its upper one, so that Broadcast<k> gives both their weights.
using Sums = hn::CappedTag<int32_t, 8>;
using Bytes = hn::Repartition<uint8_t, Sums>;
using Words = hn::Repartition<int16_t, Sums>;
using Block16 = hn::CappedTag<uint8_t, 16>;
constexpr int kBlocks = static_cast<int>(hn::MaxLanes(Sums())) / 4;
constexpr int kGroup = 4 * kBlocks;

/// The products of neighbours, added.
HWY_INLINE hn::Vec<Sums> AddPairs(hn::Vec<Words> a, hn::Vec<Words> b) {
    const Sums d;
    auto odd = hn::Zero(d);
    const auto sum = hn::ReorderWidenMulAccumulate(d, a, b, hn::Zero(d), odd);
    return hn::RearrangeToOddPlusEven(sum, odd);
}

/// The bytes of each block of 16 that `order` names; 0 for 0x80. Highway 1.0 looks them up one by one in WebAssembly, whose engines had no
/// instruction for that once.
HWY_INLINE hn::Vec<Bytes> Reordered(hn::Vec<Bytes> bytes, const uint8_t* order) {
    const auto from = hn::LoadDup128(Bytes(), order);
#if HWY_TARGET == HWY_WASM
    return hn::Vec<Bytes>{wasm_i8x16_swizzle(bytes.raw, from.raw)};
#else
    return hn::TableLookupBytesOr0(bytes, from);
#endif
}

/// 16 bytes from `p`, and in a vector of two blocks 16 from `q`.
template <class D>
HWY_INLINE hn::Vec<D> LoadBlocks(D d, const uint8_t* p, const uint8_t* q) {
    if constexpr (kBlocks == 2)
        return hn::Combine(d, hn::LoadU(Block16(), q), hn::LoadU(Block16(), p));
    else
        return hn::LoadU(d, p);
}

/// From two texels of bytes, the left one's and the right one's channel side by side, as 16 bits.
template <int kChannels>
HWY_INLINE hn::Vec<Words> Neighbours(hn::Vec<Bytes> texels) {
    constexpr uint8_t k = kChannels, no = 0x80;
    HWY_ALIGN static constexpr uint8_t kPairs[16] = {0, no, k,     no, 1, no, k + 1, no,
                                                     2, no, k + 2, no, 3, no, k + 3, no};
    return hn::BitCast(Words(), Reordered(texels, kPairs));
}

/// Pixels k and k + 4 of a group, in units of 2^-kWeightBits.
template <int kChannels, int k>
HWY_INLINE hn::Vec<Sums> WeightedSum(const uint8_t* origin, const uint8_t* next_row, const int32_t* offset,
                                     hn::Vec<Sums> above, hn::Vec<Sums> below) {
    const Words d;
    const ptrdiff_t p = offset[k], q = offset[kGroup - 4 + k];
    const auto top = Neighbours<kChannels>(LoadBlocks(Bytes(), origin + p, origin + q));
    const auto bottom = Neighbours<kChannels>(LoadBlocks(Bytes(), next_row + p, next_row + q));
    return hn::Add(AddPairs(top, hn::BitCast(d, hn::Broadcast<k>(above))),
                   AddPairs(bottom, hn::BitCast(d, hn::Broadcast<k>(below))));
}

/// Two sums a lane, rounded to whole levels: the even 16 bits from `a`, the odd ones from `b`.
HWY_INLINE hn::Vec<hn::Repartition<uint16_t, Sums>> Rounded(hn::Vec<Sums> a, hn::Vec<Sums> b) {
    const hn::Repartition<uint16_t, Sums> d;
    // One bit more than whole levels, which the average with 0 rounds off.
    const auto twice = hn::OddEven(hn::BitCast(d, hn::ShiftLeft<17 - kWeightBits>(b)),
                                   hn::BitCast(d, hn::ShiftRight<kWeightBits - 1>(a)));
    return hn::AverageRound(twice, hn::Zero(d));
}

/// Four sums of a group, rounded, to `out`, and 4 bytes behind them.
template <int kChannels, class V>
HWY_INLINE void StoreGroup(V v0, V v1, V v2, V v3, uint8_t* HWY_RESTRICT out) {
    const Bytes d8;
    const auto a = Rounded(v0, v1), b = Rounded(v2, v3);
    // Channel by channel the bytes of pixels 0, 2, 1, 3.
    const auto mixed = hn::BitCast(d8, hn::Or(a, hn::ShiftLeft<8>(b)));
    if constexpr (kChannels == 4) {
        HWY_ALIGN static constexpr uint8_t kOrder[16] = {0, 4, 8, 12, 2, 6, 10, 14,
                                                         1, 5, 9, 13, 3, 7, 11, 15};
        hn::StoreU(Reordered(mixed, kOrder), d8, out);
    } else {
        HWY_ALIGN static constexpr uint8_t kOrder[16] = {0, 4, 8, 2, 6, 10, 1, 5, 9, 3, 7, 11, 0, 0, 0, 0};
        const auto pixels = Reordered(mixed, kOrder);
        const Block16 half;
        if constexpr (kBlocks == 2) {
            hn::StoreU(hn::LowerHalf(half, pixels), half, out);
            hn::StoreU(hn::UpperHalf(half, pixels), half, out + 4 * kChannels);
        } else
            hn::StoreU(pixels, half, out);
    }
}

/// Draws a group of pixels to `out`, and 4 bytes behind it.
template <int kChannels>
HWY_INLINE void SampleGroup(const uint8_t* origin, const uint8_t* next_row, const WeightedRow& at, int i,
                            uint8_t* HWY_RESTRICT out) {
    const Sums d;
    const auto above = hn::Load(d, at.above + i), below = hn::Load(d, at.below + i);
    const int32_t* offset = at.offset + i;
    StoreGroup<kChannels>(WeightedSum<kChannels, 0>(origin, next_row, offset, above, below),
                          WeightedSum<kChannels, 1>(origin, next_row, offset, above, below),
                          WeightedSum<kChannels, 2>(origin, next_row, offset, above, below),
                          WeightedSum<kChannels, 3>(origin, next_row, offset, above, below), out);
}

/// From three texels of bytes, the right one's channels as the lower ones of two times 16 bits each, or as the upper ones.
template <int kChannels, bool kUpper>
HWY_INLINE hn::Vec<Words> RightOne(hn::Vec<Bytes> texels) {
    constexpr uint8_t k = 2 * kChannels, no = 0x80;
    HWY_ALIGN static constexpr uint8_t kPlaces[2][16] = {
        {k, no, no, no, k + 1, no, no, no, k + 2, no, no, no, k + 3, no, no, no},
        {no, no, k, no, no, no, k + 1, no, no, no, k + 2, no, no, no, k + 3, no}};
    return hn::BitCast(Words(), Reordered(texels, kPlaces[kUpper]));
}

/// Pixels k and k + 4 of a group, from nine texels each, in units of 2^-kWeightBits.
template <int kChannels, int k>
HWY_INLINE hn::Vec<Sums> NineSum(const uint8_t* origin, ptrdiff_t row, const int32_t* offset,
                                 const NineWeightedRow& w, int i) {
    const Words d;
    const uint8_t *p = origin + offset[k] - kChannels, *q = origin + offset[kGroup - 4 + k] - kChannels;
    const auto upper = LoadBlocks(Bytes(), p - row, q - row), middle = LoadBlocks(Bytes(), p, q),
               lower = LoadBlocks(Bytes(), p + row, q + row);
    const auto weights = [&](int n) HWY_ATTR {
        return hn::BitCast(d, hn::Broadcast<k>(hn::Load(Sums(), w.pair[n] + i)));
    };
    const auto left = hn::Add(AddPairs(Neighbours<kChannels>(upper), weights(0)),
                              AddPairs(Neighbours<kChannels>(middle), weights(1)));
    const auto right = hn::Add(
        AddPairs(Neighbours<kChannels>(lower), weights(2)),
        AddPairs(hn::Or(RightOne<kChannels, false>(upper), RightOne<kChannels, true>(middle)), weights(3)));
    const auto last = AddPairs(RightOne<kChannels, false>(lower), weights(4));
    return hn::Add(hn::Add(left, right), last);
}

/// Draws a group of pixels that read nine texels each to `out`, and 4 bytes behind it.
template <int kChannels>
HWY_INLINE void SampleNine(const uint8_t* origin, ptrdiff_t row, const int32_t* offset,
                           const NineWeightedRow& w, int i, uint8_t* HWY_RESTRICT out) {
    StoreGroup<kChannels>(NineSum<kChannels, 0>(origin, row, offset + i, w, i),
                          NineSum<kChannels, 1>(origin, row, offset + i, w, i),
                          NineSum<kChannels, 2>(origin, row, offset + i, w, i),
                          NineSum<kChannels, 3>(origin, row, offset + i, w, i), out);
}

#endif

template <int kChannels>
void DrawBytes(const Drawing& to) {
    const Texels& s = to.texels;
    const auto* origin = reinterpret_cast<const uint8_t*>(s.texels);
    const int count = to.end - to.begin;
    const HalfSteps steps(to.block);
    const Weighing weighing(s.row_stride, kChannels);
    WeightedRow rows[kRows];
    HWY_ALIGN uint8_t values[2][kRowRoom * kChannels + 16];

    const auto locate = [&](int j) HWY_ATTR {
        const RowPoints points(to.block, steps, j);
        WeightedRow& row = rows[j % kRows];
        points.ForEach(to.begin, count, [&](int i, hn::Vec<Floats> x, hn::Vec<Floats> y) HWY_ATTR {
            weighing.Weigh(x, y, points.WholeX(to.begin + i), points.WholeY(to.begin + i), i, row);
        });
        FetchBilinear<uint8_t, kChannels>(s, row.offset, count);
        FillGroup(row.offset, count, kGroup);
    };
    const auto sample = [&](int j) HWY_ATTR {
        for (int i = 0; i < count; i += kGroup)
            SampleGroup<kChannels>(origin, origin + s.row_stride, rows[j % kRows], i,
                                   values[j & 1] + i * kChannels);
    };
    const auto store = [&](int j) HWY_ATTR {
        StreamRow(values[j & 1], count * kChannels, to.to + (j - to.row_begin) * to.row_stride);
    };
    InStages(to, locate, sample, store);
}

/// The same with taps that read nine texels.
template <int kChannels>
void DrawNineBytes(const Drawing& to) {
    const Texels& s = to.texels;
    const auto* origin = reinterpret_cast<const uint8_t*>(s.texels);
    const int count = to.end - to.begin;
    const TapsOfRow taps(s, {});
    const RowLocator<uint8_t, kChannels> locator(to, 0);
    Positions<kRowRoom> positions[kRows];
    NineWeightedRow weights;
    HWY_ALIGN uint8_t values[2][kRowRoom * kChannels + 16];

    const auto locate = [&](int j) HWY_ATTR {
        locator.Row(j, positions[j % kRows]);
        FillGroup(positions[j % kRows].offset, count, kGroup);
    };
    const auto sample = [&](int j) HWY_ATTR {
        const Positions<kRowRoom>& p = positions[j % kRows];
        WeighNine(taps, p, count, weights);
        for (int i = 0; i < count; i += kGroup)
            SampleNine<kChannels>(origin, s.row_stride, p.offset, weights, i, values[j & 1] + i * kChannels);
    };
    const auto store = [&](int j) HWY_ATTR {
        StreamRow(values[j & 1], count * kChannels, to.to + (j - to.row_begin) * to.row_stride);
    };
    InStages(to, locate, sample, store);
}

// --- uint16 and half

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2 && !defined(HWY_DISABLE_F16C)
constexpr bool kHasFloats = true;

/// Two texels as floats. uint16: the left one's channels in the lower half, the right one's in the upper.
template <int kChannels>
HWY_INLINE hn::Vec<Pair> LoadPair(const hwy::float16_t* p) {
    return hn::PromoteTo(Pair(), hn::LoadU(hn::Rebind<hwy::float16_t, Pair>(), p));
}
template <int kChannels>
HWY_INLINE hn::Vec<Pair> LoadPair(const uint16_t* p) {
    constexpr uint8_t k = 2 * kChannels, no = 0x80;
    HWY_ALIGN static constexpr uint8_t kApart[32] = {
        0, 1,     no, no, 2,     3,     no, no, 4,     5,     no, no, 6,     7,     no, no,
        k, k + 1, no, no, k + 2, k + 3, no, no, k + 4, k + 5, no, no, k + 6, k + 7, no, no};
    const auto both = hn::LoadDup128(Bytes(), reinterpret_cast<const uint8_t*>(p));
    const auto apart = hn::TableLookupBytesOr0(both, hn::Load(Bytes(), kApart));
    return hn::ConvertTo(Pair(), hn::BitCast(hn::RebindToSigned<Pair>(), apart));
}

/// The texel pair at `p` mixed with the pair below.
template <class T, int kChannels>
HWY_INLINE hn::Vec<Pair> MixRows(const T* HWY_RESTRICT p, ptrdiff_t row, float fy) {
    const auto above = LoadPair<kChannels>(p), below = LoadPair<kChannels>(p + row);
    return Fused(hn::Set(Pair(), fy), hn::Sub(below, above), above);
}

/// Pixels k and k + 4 of the eight from i on.
template <class T, int kChannels, int k>
HWY_INLINE hn::Vec<Pair> MixPixels(const T* HWY_RESTRICT origin, ptrdiff_t row, const Positions<kRowRoom>& at,
                                   int i, hn::Vec<Pair> fx) {
    const Pair d;
    const auto p = MixRows<T, kChannels>(origin + at.offset[i + k], row, at.fy[i + k]);
    const auto q = MixRows<T, kChannels>(origin + at.offset[i + 4 + k], row, at.fy[i + 4 + k]);
    const auto left = hn::ConcatLowerLower(d, q, p);
    auto right = hn::ConcatUpperUpper(d, q, p);
    // Three channels of half come without a gap: the fourth is the right texel's first.
    if constexpr (std::is_same_v<T, hwy::float16_t> && kChannels == 3)
        right = hn::CombineShiftRightBytes<12>(d, right, left);
    return Fused(hn::Broadcast<k>(fx), hn::Sub(right, left), left);
}

/// Eight pixels, k and k + 4 in v[k], to `out`, and a channel more.
template <int kChannels>
HWY_INLINE void StoreEight(const hn::Vec<Pair> (&v)[4], hwy::float16_t* HWY_RESTRICT out) {
    const hn::Rebind<hwy::float16_t, Pair> d;
    const hn::Half<decltype(d)> half;
    const hn::Vec<decltype(d)> h[4] = {hn::DemoteTo(d, v[0]), hn::DemoteTo(d, v[1]), hn::DemoteTo(d, v[2]),
                                       hn::DemoteTo(d, v[3])};
    // Ascending pixels: a surplus channel is overwritten by the next pixel.
    for (int k = 0; k < 4; ++k) hn::StoreU(hn::LowerHalf(half, h[k]), half, out + k * kChannels);
    for (int k = 0; k < 4; ++k) hn::StoreU(hn::UpperHalf(half, h[k]), half, out + (4 + k) * kChannels);
}

/// `a` and `b` rounded, the pixels of each half next to each other; three channels each, with anything behind.
template <int kChannels>
HWY_INLINE hn::Vec<Bytes> Rounded(hn::Vec<Pair> a, hn::Vec<Pair> b) {
    // Added to 2^23 they are rounded, and their low bits are the integer's.
    const Words d;
    const auto unit = hn::Set(Pair(), 0x1p23f);
    const auto low = hn::BitCast(d, hn::Add(a, unit));
    const auto high = hn::ShiftLeft<16>(hn::BitCast(Sums(), hn::Add(b, unit)));
    const auto mixed = hn::BitCast(Bytes(), hn::OddEven(hn::BitCast(d, high), low));
    HWY_ALIGN static constexpr uint8_t kOrder[2][16] = {
        {0, 1, 4, 5, 8, 9, 2, 3, 6, 7, 10, 11, 0, 0, 0, 0},
        {0, 1, 4, 5, 8, 9, 12, 13, 2, 3, 6, 7, 10, 11, 14, 15}};
    return hn::TableLookupBytes(mixed, hn::LoadDup128(Bytes(), kOrder[kChannels - 3]));
}
template <int kChannels>
HWY_INLINE void StoreEight(const hn::Vec<Pair> (&v)[4], uint16_t* HWY_RESTRICT out) {
    const Block16 d;
    const auto a = Rounded<kChannels>(v[0], v[1]), b = Rounded<kChannels>(v[2], v[3]);
    auto* to = reinterpret_cast<uint8_t*>(out);
    constexpr int kTwo = 4 * kChannels;
    // Ascending pixels, as above.
    hn::StoreU(hn::LowerHalf(d, a), d, to);
    hn::StoreU(hn::LowerHalf(d, b), d, to + kTwo);
    hn::StoreU(hn::UpperHalf(d, a), d, to + 2 * kTwo);
    hn::StoreU(hn::UpperHalf(d, b), d, to + 3 * kTwo);
}

template <class T, int kChannels>
HWY_INLINE void SampleEight(const T* HWY_RESTRICT origin, ptrdiff_t row, const Positions<kRowRoom>& at, int i,
                            T* HWY_RESTRICT out) {
    const auto fx = hn::Load(Pair(), at.fx + i);
    const hn::Vec<Pair> v[4] = {MixPixels<T, kChannels, 0>(origin, row, at, i, fx),
                                MixPixels<T, kChannels, 1>(origin, row, at, i, fx),
                                MixPixels<T, kChannels, 2>(origin, row, at, i, fx),
                                MixPixels<T, kChannels, 3>(origin, row, at, i, fx)};
    StoreEight<kChannels>(v, out);
}

/// A row that is not finite everywhere, by sample_row, which mends it.
template <class T>
void SampleAgain(const Drawing& to, int row, T* values) {
    HWY_ALIGN float x[kRowRoom], y[kRowRoom], pixels[kRowRoom * 4];
    const Offsets at = PointsOfRow(to, row, x, y);
    sample_row(to.texels, at, pixels);
    store_row(pixels, at.count * to.texels.channels, 1, to.type, reinterpret_cast<std::byte*>(values));
}

template <class T, int kChannels>
void DrawFloats(const Drawing& to) {
    const Texels& s = to.texels;
    const auto* origin = reinterpret_cast<const T*>(s.texels);
    const ptrdiff_t row = s.row_stride / static_cast<ptrdiff_t>(sizeof(T));
    const int count = to.end - to.begin;
    const RowLocator<T, kChannels> locator(to, 0.5f);
    Positions<kRowRoom> positions[kRows];
    HWY_ALIGN T values[2][kRowRoom * kChannels + 32];

    const auto locate = [&](int j) HWY_ATTR {
        locator.Row(j, positions[j % kRows]);
        FillGroup(positions[j % kRows].offset, count, 8);
    };
    const auto sample = [&](int j) HWY_ATTR {
        for (int i = 0; i < count; i += 8)
            SampleEight<T, kChannels>(origin, row, positions[j % kRows], i, values[j & 1] + i * kChannels);
    };
    const auto store = [&](int j) HWY_ATTR {
        if (!AllFinite(values[j & 1], count * kChannels)) SampleAgain(to, j, values[j & 1]);
        StreamRow(values[j & 1], count * kChannels * static_cast<int>(sizeof(T)),
                  to.to + (j - to.row_begin) * to.row_stride);
    };
    InStages(to, locate, sample, store);
}
#else
constexpr bool kHasFloats = false;
template <class T, int kChannels>
void DrawFloats(const Drawing&) {}
#endif

bool DrawPacked(const Drawing& drawing) {
    const bool three = drawing.texels.channels == 3;
    if (drawing.texels.tap_count > 1) {
        if (drawing.type != PixelType::uint8 || !ReadNine(drawing.texels)) return false;
        three ? DrawNineBytes<3>(drawing) : DrawNineBytes<4>(drawing);
        return true;
    }
    switch (drawing.type) {
        case PixelType::uint8:
            three ? DrawBytes<3>(drawing) : DrawBytes<4>(drawing);
            return true;
        case PixelType::uint16:
            three ? DrawFloats<uint16_t, 3>(drawing) : DrawFloats<uint16_t, 4>(drawing);
            return kHasFloats;
        case PixelType::half:
            three ? DrawFloats<hwy::float16_t, 3>(drawing) : DrawFloats<hwy::float16_t, 4>(drawing);
            return kHasFloats;
        case PixelType::float32:
            return false;
    }
    return false;
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(DrawPacked);

bool draw_packed_block(const Drawing& drawing) {
    const Texels& s = drawing.texels;
    const bool packed = s.type == drawing.type && drawing.scale == 1 && s.kernel == Kernel::bilinear &&
                        (s.tap_count > 1 || (s.taps[0].x == 0 && s.taps[0].y == 0)) &&
                        (s.channels == 3 || s.channels == 4);
    return packed && HWY_DYNAMIC_DISPATCH(DrawPacked)(drawing);
}

}  // namespace anamorph::simd
#endif
