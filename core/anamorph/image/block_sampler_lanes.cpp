// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/image/block_sampler_lanes.cpp"
#include "anamorph/image/block_sampler.h"

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "hwy/cache_control.h"
#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

#include "anamorph/image/filter.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/texel_types.h"
#include "anamorph/image/weightless.h"
// Compiled for each instruction set.
#include "anamorph/image/block_rows-inl.h"
#include "anamorph/image/nine_texels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void BlockPoints(const Polynomials& block, int row, int begin, int end, float* HWY_RESTRICT out_x,
                 float* HWY_RESTRICT out_y) {
    StorePoints(block, row, begin, end, out_x, out_y);
}

/// half_from_float (number/half.h) of a vector, to `to`.
template <class D>
HWY_INLINE void StoreHalves(hn::Vec<D> v, D d, hwy::float16_t* to) {
    if constexpr (kHasHalf) {
        const hn::Rebind<hwy::float16_t, D> dh;
        hn::StoreU(hn::DemoteTo(dh, v), dh, to);
    } else {
        const hn::RebindToSigned<D> di;
        const hn::Rebind<uint16_t, D> dh;
        const auto bits = hn::BitCast(di, v), magnitude = hn::And(bits, hn::Set(di, 0x7fffffff));
        const auto sign = hn::And(hn::ShiftRight<16>(bits), hn::Set(di, 0x8000));
        const auto short_bits = hn::ShiftRight<13>(magnitude);
        const auto nan = hn::Or(hn::Set(di, 0x7e00), hn::And(short_bits, hn::Set(di, 0x3ff)));
        const auto large =
            hn::IfThenElse(hn::Gt(magnitude, hn::Set(di, 0x7f800000)), nan, hn::Set(di, 0x7c00));
        const auto small = hn::Sub(hn::BitCast(di, hn::Add(hn::BitCast(d, magnitude), hn::Set(d, 0.5f))),
                                   hn::Set(di, 0x3f000000));
        const auto odd = hn::And(short_bits, hn::Set(di, 1));
        const auto normal =
            hn::ShiftRight<13>(hn::Add(hn::Add(magnitude, hn::Set(di, 0xfff - ((127 - 15) << 23))), odd));
        const auto half =
            hn::IfThenElse(hn::Lt(magnitude, hn::Set(di, 0x38800000)), small,
                           hn::IfThenElse(hn::Lt(magnitude, hn::Set(di, 0x47800000)), normal, large));
        hn::StoreU(hn::DemoteTo(dh, hn::Or(sign, half)), dh, reinterpret_cast<uint16_t*>(to));
    }
}

template <class T>
HWY_INLINE hn::Vec<Quad> LoadQuad(const T* p) {
    return LoadFloats(Quad(), p);
}

/// Finds the positions of `count` points from `first` on, moved by a tap and back by `shift`.
template <int kCount>
HWY_INLINE void Locate(const Offsets& at, int first, int count, const Tap& tap, float shift, int channels,
                       int32_t row_elements, Positions<kCount>& p) {
    const Floats d;
    const Ints di;
    const auto dx = hn::Set(d, tap.x - shift), dy = hn::Set(d, tap.y - shift);
    const auto row = hn::Set(di, row_elements), pixel = hn::Set(di, channels);
    for (int i = 0; i < count; i += static_cast<int>(kLanes))
        Locate(hn::Add(hn::LoadU(d, at.x + first + i), dx), hn::Add(hn::LoadU(d, at.y + first + i), dy), row,
               pixel, i, p, at.whole_x ? at.whole_x + first + i : nullptr,
               at.whole_y ? at.whole_y + first + i : nullptr);
}

/// The texel pair at `p` and the pair below, mixed by fy then fx: kQuad channels of a pixel.
template <class T, int kChannels>
HWY_INLINE hn::Vec<Quad> Bilinear(const T* HWY_RESTRICT p, ptrdiff_t row, int channels, float fx, float fy) {
    const Quad d;
    const int next = kChannels ? kChannels : channels;
    const auto vx = hn::Set(d, fx), vy = hn::Set(d, fy);
#if HWY_TARGET != HWY_SCALAR
    if constexpr (kHasPair && (kChannels == 3 || kChannels == 4)) {
        // Both texels of a row at once.
        const Pair d2;
        const auto above = LoadFloats(d2, p), below = LoadFloats(d2, p + row);
        const auto both = Fused(hn::Set(d2, fy), hn::Sub(below, above), above);
        const auto first = hn::LowerHalf(d, both);
        auto second = hn::UpperHalf(d, both);
        if constexpr (kChannels == 3) {
            HWY_ALIGN static constexpr int32_t kShift[8] = {3, 4, 5, 6, 7, 7, 7, 7};
            second = hn::LowerHalf(d, hn::TableLookupLanes(both, hn::SetTableIndices(d2, kShift)));
        }
        return Fused(vx, hn::Sub(second, first), first);
    }
#endif
    const auto a = LoadQuad(p), b = LoadQuad(p + row);
    const auto left = Fused(vy, hn::Sub(b, a), a);
    const auto e = LoadQuad(p + next), f = LoadQuad(p + row + next);
    const auto right = Fused(vy, hn::Sub(f, e), e);
    return Fused(vx, hn::Sub(right, left), left);
}

/// One bilinear tap a pixel. kChannels 0: any number, four at a time; a store's surplus lanes are overwritten
/// by the next pixel's.
template <class T, int kChannels>
HWY_INLINE void SampleBilinear(const Texels& s, const Offsets& at, float* HWY_RESTRICT out) {
    const Quad d;
    const auto* origin = reinterpret_cast<const T*>(s.texels);
    const ptrdiff_t row = s.row_stride / static_cast<ptrdiff_t>(sizeof(T));
    const int channels = kChannels ? kChannels : s.channels;
    Positions<kRowRoom> p;
    Locate(at, 0, at.count, s.taps[0], 0.5f, channels, static_cast<int32_t>(row), p);
    for (int i = 0; i < at.count; ++i)
        for (int c = 0; c < channels; c += kQuad)
            hn::StoreU(Bilinear<T, kChannels>(origin + p.offset[i] + c, row, channels, p.fx[i], p.fy[i]), d,
                       out + i * channels + c);
}

/// The mean of several bilinear taps a pixel.
template <class T, int kChannels>
HWY_INLINE void SampleTaps(const Texels& s, const Offsets& at, float* HWY_RESTRICT out) {
    const Quad d;
    const auto* origin = reinterpret_cast<const T*>(s.texels);
    const ptrdiff_t row = s.row_stride / static_cast<ptrdiff_t>(sizeof(T));
    const int channels = kChannels ? kChannels : s.channels;
    // Some pixels at a time, so that the positions of all taps stay near.
    constexpr int kGroup = 16;
    Positions<kGroup> p[4];
    const auto weight = hn::Set(d, 1.0f / static_cast<float>(s.tap_count));
    for (int first = 0; first < at.count; first += kGroup) {
        const int n = HWY_MIN(kGroup, at.count - first);
        HWY_ALIGN float sum[kGroup * kQuad];
        for (int c = 0; c < channels; c += kQuad) {
            for (int tap = 0; tap < s.tap_count; tap += 4) {
                const int taps = HWY_MIN(4, s.tap_count - tap);
                for (int k = 0; k < taps; ++k)
                    Locate(at, first, n, s.taps[tap + k], 0.5f, channels, static_cast<int32_t>(row), p[k]);
                for (int i = 0; i < n; ++i) {
                    auto v = tap == 0 ? hn::Zero(d) : hn::Load(d, sum + kQuad * i);
                    for (int k = 0; k < taps; ++k)
                        v = hn::Add(v, Bilinear<T, kChannels>(origin + p[k].offset[i] + c, row, channels,
                                                              p[k].fx[i], p[k].fy[i]));
                    hn::Store(v, d, sum + kQuad * i);
                }
            }
            // Ascending pixels: a surplus lane is overwritten by the next pixel, or by this one's next
            // channels.
            for (int i = 0; i < n; ++i) {
                HWY_ALIGN float v[kQuad];
                hn::Store(hn::Mul(hn::Load(d, sum + kQuad * i), weight), d, v);
                std::memcpy(out + (first + i) * channels + c, v,
                            sizeof(float) * static_cast<size_t>(HWY_MIN(kQuad, channels - c)));
            }
        }
    }
}

/// The weights of a row's eight texels around those that points fall into, each texel's behind one another.
struct WeightsOfRow {
    HWY_ALIGN float at[8][kRowRoom];
};

/// The texels that pixels fall into, and their weights: `fx` and `fy` are how far into it each lies.
HWY_INLINE void WeighNine(const TapsOfRow& taps, const Positions<kRowRoom>& p, int count, WeightsOfRow& to) {
    const Floats d;
    const auto half = hn::Set(d, 0.5f);
    for (int i = 0; i < count; i += static_cast<int>(kLanes)) {
        const EightWeights w =
            taps.Weights(hn::Sub(hn::Load(d, p.fx + i), half), hn::Sub(hn::Load(d, p.fy + i), half), i);
        hn::Store(w.above_left, d, to.at[0] + i);
        hn::Store(w.above, d, to.at[1] + i);
        hn::Store(w.above_right, d, to.at[2] + i);
        hn::Store(w.left, d, to.at[3] + i);
        hn::Store(w.right, d, to.at[4] + i);
        hn::Store(w.below_left, d, to.at[5] + i);
        hn::Store(w.below, d, to.at[6] + i);
        hn::Store(w.below_right, d, to.at[7] + i);
    }
}

/// kQuad channels of pixel i: the texel at `p`, and what those around it differ by, so that where they do not the pixel is it.
template <class T, int kChannels>
HWY_INLINE hn::Vec<Quad> NineTexels(const T* HWY_RESTRICT p, ptrdiff_t row, int channels,
                                    const WeightsOfRow& w, int i) {
    const Quad d;
    const int next = kChannels ? kChannels : channels;
    const auto middle = LoadQuad(p);
    auto sum = middle;
    const auto add = [&](int k, const T* from) HWY_ATTR {
        sum = Fused(hn::Set(d, w.at[k][i]), hn::Sub(LoadQuad(from), middle), sum);
    };
    add(0, p - row - next);
    add(1, p - row);
    add(2, p - row + next);
    add(3, p - next);
    add(4, p + next);
    add(5, p + row - next);
    add(6, p + row);
    add(7, p + row + next);
    return sum;
}

#if HWY_TARGET != HWY_SCALAR
/// kQuad channels from `p`, and from `q` behind them.
template <class T>
HWY_INLINE hn::Vec<Pair> LoadTwo(const T* p, const T* q) {
    if constexpr (kHasPair && sizeof(T) != 0)
        return hn::Combine(Pair(), LoadQuad(q), LoadQuad(p));
    else
        return LoadFloats(Pair(), p);
}

/// NineTexels of pixels i + k and i + 4 + k, the latter in the upper half.
template <class T, int kChannels, int k>
HWY_INLINE hn::Vec<Pair> NineOfTwo(const T* HWY_RESTRICT origin, ptrdiff_t row, const int32_t* offset,
                                   const WeightsOfRow& w, int i) {
    const Pair d;
    const T *p = origin + offset[i + k], *q = origin + offset[i + 4 + k];
    const auto middle = LoadTwo(p, q);
    auto sum = middle;
    const auto add = [&](int n, ptrdiff_t to) HWY_ATTR {
        const auto weight = hn::Broadcast<k>(hn::Load(d, w.at[n] + i));
        sum = Fused(weight, hn::Sub(LoadTwo(p + to, q + to), middle), sum);
    };
    add(0, -row - kChannels);
    add(1, -row);
    add(2, kChannels - row);
    add(3, -kChannels);
    add(4, kChannels);
    add(5, row - kChannels);
    add(6, row);
    add(7, row + kChannels);
    return sum;
}
#endif

/// A row of pixels that read nine texels each.
template <class T, int kChannels>
HWY_INLINE void SampleNineRow(const Texels& s, const int32_t* offset, int count, const WeightsOfRow& w,
                              float* HWY_RESTRICT out) {
    const auto* origin = reinterpret_cast<const T*>(s.texels);
    const ptrdiff_t row = s.row_stride / static_cast<ptrdiff_t>(sizeof(T));
    int i = 0;
#if HWY_TARGET != HWY_SCALAR
    if constexpr (kHasPair && kChannels != 0)
        for (; i + 8 <= count; i += 8) {
            const auto v0 = NineOfTwo<T, kChannels, 0>(origin, row, offset, w, i);
            const auto v1 = NineOfTwo<T, kChannels, 1>(origin, row, offset, w, i);
            const auto v2 = NineOfTwo<T, kChannels, 2>(origin, row, offset, w, i);
            const auto v3 = NineOfTwo<T, kChannels, 3>(origin, row, offset, w, i);
            // Ascending pixels: a surplus channel is overwritten by the next pixel's.
            const Quad half;
            float* HWY_RESTRICT to = out + i * kChannels;
            hn::StoreU(hn::LowerHalf(half, v0), half, to);
            hn::StoreU(hn::LowerHalf(half, v1), half, to + kChannels);
            hn::StoreU(hn::LowerHalf(half, v2), half, to + 2 * kChannels);
            hn::StoreU(hn::LowerHalf(half, v3), half, to + 3 * kChannels);
            hn::StoreU(hn::UpperHalf(half, v0), half, to + 4 * kChannels);
            hn::StoreU(hn::UpperHalf(half, v1), half, to + 5 * kChannels);
            hn::StoreU(hn::UpperHalf(half, v2), half, to + 6 * kChannels);
            hn::StoreU(hn::UpperHalf(half, v3), half, to + 7 * kChannels);
        }
#endif
    const int channels = kChannels ? kChannels : s.channels;
    for (; i < count; ++i)
        for (int c = 0; c < channels; c += kQuad)
            hn::StoreU(NineTexels<T, kChannels>(origin + offset[i] + c, row, channels, w, i), Quad(),
                       out + i * channels + c);
}

template <class T, int kChannels>
HWY_INLINE void SampleNine(const Texels& s, const Offsets& at, float* HWY_RESTRICT out) {
    const ptrdiff_t row = s.row_stride / static_cast<ptrdiff_t>(sizeof(T));
    const int channels = kChannels ? kChannels : s.channels;
    Positions<kRowRoom> p;
    Locate(at, 0, at.count, Tap{}, 0, channels, static_cast<int32_t>(row), p);
    WeightsOfRow w;
    WeighNine(TapsOfRow(s, at), p, at.count, w);
    SampleNineRow<T, kChannels>(s, p.offset, at.count, w, out);
}

/// The taps that pixel i of a row has for itself.
class TapsOfPixel {
  public:
    HWY_INLINE TapsOfPixel(const OwnTaps& own, int i)
        : m_a{own.x_i[i], own.y_i[i]}, m_b{own.x_j[i], own.y_j[i]}, m_near(own.taps[i] < 2) {
        if (m_near) return;
        m_across = (own.taps[i] >> kTapsAcrossShift) & 255;
        m_down = own.taps[i] >> kTapsDownShift;
    }
    /// Do nine texels suffice?
    HWY_INLINE bool IsNear() const { return m_near; }
    HWY_INLINE int Count() const { return m_across * m_down; }
    /// Finds taps k, k + 1, ... from a point.
    HWY_INLINE void From(float x, float y, int k, hn::Vec<Floats>& to_x, hn::Vec<Floats>& to_y) const {
        const Floats d;
        // Half a tap more is at least 1/32 of a row from the next one, however it is rounded.
        const auto tap = hn::Add(hn::Iota(d, 0.0f), hn::Set(d, static_cast<float>(k)));
        const auto b = hn::Floor(hn::Mul(hn::Add(tap, hn::Set(d, 0.5f)), hn::Set(d, kInverse[m_across])));
        const auto a = hn::Sub(tap, hn::Mul(b, hn::Set(d, static_cast<float>(m_across))));
        const auto da = hn::Add(hn::Add(a, a), hn::Set(d, static_cast<float>(1 - m_across)));
        const auto db = hn::Add(hn::Add(b, b), hn::Set(d, static_cast<float>(1 - m_down)));
        to_x = Fused(da, hn::Set(d, m_a.x), Fused(db, hn::Set(d, m_b.x), hn::Set(d, x)));
        to_y = Fused(da, hn::Set(d, m_a.y), Fused(db, hn::Set(d, m_b.y), hn::Set(d, y)));
    }
    /// Do all of them lie together?
    HWY_INLINE bool AreOne() const {
        const auto across = static_cast<float>(m_across - 1), down = static_cast<float>(m_down - 1);
        return across * std::fabs(m_a.x) + down * std::fabs(m_b.x) < kSameTap &&
               across * std::fabs(m_a.y) + down * std::fabs(m_b.y) < kSameTap;
    }

  private:
    static constexpr float kInverse[] = {0,        1 / 1.f,  1 / 2.f,  1 / 3.f,  1 / 4.f,  1 / 5.f,
                                         1 / 6.f,  1 / 7.f,  1 / 8.f,  1 / 9.f,  1 / 10.f, 1 / 11.f,
                                         1 / 12.f, 1 / 13.f, 1 / 14.f, 1 / 15.f, 1 / 16.f};

    Tap m_a, m_b;
    int m_across = 2, m_down = 2;
    bool m_near;
};

/// Pixels with taps of their own: nine texels where these suffice, else tap by tap.
template <class T, int kChannels>
HWY_INLINE void SampleOwn(const Texels& s, const Offsets& at, float* HWY_RESTRICT out) {
    const Quad d;
    const auto* origin = reinterpret_cast<const T*>(s.texels);
    const ptrdiff_t row = s.row_stride / static_cast<ptrdiff_t>(sizeof(T));
    const int channels = kChannels ? kChannels : s.channels;
    Positions<kRowRoom> p;
    Locate(at, 0, at.count, Tap{}, 0, channels, static_cast<int32_t>(row), p);
    WeightsOfRow w;
    WeighNine(TapsOfRow(s, at), p, at.count, w);
    SampleNineRow<T, kChannels>(s, p.offset, at.count, w, out);
    Positions<kMaxTaps + kLanes> of_tap;
    const auto row_elements = hn::Set(Ints(), static_cast<int32_t>(row)), pixel = hn::Set(Ints(), channels);
    for (int i = 0; i < at.count; ++i) {
        const TapsOfPixel taps(at.own, i);
        if (taps.IsNear()) continue;
        const int count = taps.Count();
        for (int k = 0; k < count; k += static_cast<int>(kLanes)) {
            hn::Vec<Floats> x, y;
            taps.From(p.fx[i] - 0.5f, p.fy[i] - 0.5f, k, x, y);
            Locate(x, y, row_elements, pixel, k, of_tap);
        }
        const auto share = hn::Set(d, 1.0f / static_cast<float>(count));
        for (int c = 0; c < channels; c += kQuad) {
            const T* const from = origin + p.offset[i] + c;
            auto sum = hn::Zero(d);
            for (int k = 0; k < count; ++k)
                sum = hn::Add(sum, Bilinear<T, kChannels>(from + of_tap.offset[k], row, channels,
                                                          of_tap.fx[k], of_tap.fy[k]));
            HWY_ALIGN float v[kQuad];
            hn::Store(hn::Mul(sum, share), d, v);
            std::memcpy(out + i * channels + c, v,
                        sizeof(float) * static_cast<size_t>(HWY_MIN(kQuad, channels - c)));
        }
    }
}

/// Weights of the four texels about a fraction f by a cubic of slope a (filter.h).
HWY_INLINE void CubicWeights(float f, float a, float* w) {
    const float g = 1 - f;
    w[0] = a * f * g * g;
    w[1] = 1 + f * f * ((a + 2) * f - (a + 3));
    w[2] = 1 + g * g * ((a + 2) * g - (a + 3));
    w[3] = a * g * f * f;
}

template <class T, bool kClamps>
HWY_INLINE void SampleBicubic(const Texels& s, const Offsets& at, float* HWY_RESTRICT out) {
    const Quad d;
    const auto* origin = reinterpret_cast<const T*>(s.texels);
    const ptrdiff_t row = s.row_stride / static_cast<ptrdiff_t>(sizeof(T));
    Positions<kRowRoom> p;
    const float slope = cubic_slope(is_sharp(s.kernel));
    // The first of four texels is one before the one a bilinear tap starts with.
    Locate(at, 0, at.count, s.taps[0], 0.5f, s.channels, static_cast<int32_t>(row), p);
    for (int i = 0; i < at.count; ++i) {
        float wx[4], wy[4];
        CubicWeights(p.fx[i], slope, wx);
        CubicWeights(p.fy[i], slope, wy);
        for (int c = 0; c < s.channels; c += kQuad) {
            const T* texel = origin + p.offset[i] + c - row - s.channels;
            auto sum = hn::Zero(d);
            [[maybe_unused]] auto least = LoadQuad(texel), most = least;
            for (int j = 0; j < 4; ++j) {
                auto line = hn::Zero(d);
                for (int k = 0; k < 4; ++k) {
                    const auto value = LoadQuad(texel + j * row + k * s.channels);
                    line = Fused(hn::Set(d, wx[k]), value, line);
                    if constexpr (kClamps) {
                        least = hn::Min(least, value);
                        most = hn::Max(most, value);
                    }
                }
                sum = Fused(hn::Set(d, wy[j]), line, sum);
            }
            // What is not finite is mended, and clamped then.
            if constexpr (kClamps)
                sum = hn::IfThenElse(hn::IsFinite(sum), hn::Min(hn::Max(sum, least), most), sum);
            hn::StoreU(sum, d, out + i * s.channels + c);
        }
    }
}

template <class T>
HWY_INLINE void SampleNearest(const Texels& s, const Offsets& at, float* HWY_RESTRICT out) {
    const auto* origin = reinterpret_cast<const T*>(s.texels);
    const ptrdiff_t row = s.row_stride / static_cast<ptrdiff_t>(sizeof(T));
    Positions<kRowRoom> p;
    Locate(at, 0, at.count, s.taps[0], 0.0f, s.channels, static_cast<int32_t>(row), p);
    for (int i = 0; i < at.count; ++i)
        for (int c = 0; c < s.channels; c += kQuad)
            hn::StoreU(LoadQuad(origin + p.offset[i] + c), Quad(), out + i * s.channels + c);
}

/// Weights of the texels about a fraction, of the kernel's, moved to the middle of one that is so near.
HWY_INLINE void KernelWeights(Kernel kernel, float f, float* w) {
    f = f < kSameTexel ? 0 : f > 1 - kSameTexel ? 1 : f;
    if (is_cubic(kernel)) return CubicWeights(f, cubic_slope(is_sharp(kernel)), w);
    w[0] = 1 - f;
    w[1] = f;
}

/// Are several taps as good as one in their middle?
HWY_INLINE bool TapsLieTogether(const Texels& s) {
    bool all = s.tap_count > 1;
    for (int i = 0; i < s.tap_count; ++i)
        all &= std::fabs(s.taps[i].x) < kSameTap && std::fabs(s.taps[i].y) < kSameTap;
    return all;
}

/// Finds the positions of a tap that each pixel has for itself, if it has so many; those that lie together are one in their middle.
HWY_INLINE void LocateOwn(const Offsets& at, int k, int channels, int32_t row, Positions<kRowRoom>& p) {
    HWY_ALIGN float x[kRowRoom] = {}, y[kRowRoom] = {};
    for (int i = 0; i < at.count; ++i) {
        const TapsOfPixel taps(at.own, i);
        x[i] = at.x[i];
        y[i] = at.y[i];
        if (k >= taps.Count() || taps.AreOne()) continue;
        hn::Vec<Floats> tap_x, tap_y;
        taps.From(x[i], y[i], k, tap_x, tap_y);
        x[i] = hn::GetLane(tap_x);
        y[i] = hn::GetLane(tap_y);
    }
    Locate({x, y, at.count, at.whole_x, at.whole_y}, 0, at.count, Tap{}, 0.5f, channels, row, p);
}

/// The channels of a row that came out infinite or as no numbers, again, as weightless.h says.
HWY_NOINLINE void MendChannels(const Texels& s, const Offsets& at, float* HWY_RESTRICT out) {
    const int bytes = size_of(s.type), count = at.count * s.channels, side = is_cubic(s.kernel) ? 4 : 2;
    const std::ptrdiff_t pixel = std::ptrdiff_t{s.channels} * bytes;
    const auto row = static_cast<int32_t>(s.row_stride / bytes);
    std::vector<double> sum(static_cast<size_t>(count));
    const bool own = at.own.x_i, together = !own && TapsLieTogether(s);
    const auto taps_of = [&](int i) {
        return own ? TapsOfPixel(at.own, i).Count() : together ? 1 : s.tap_count;
    };
    int most = 0;
    for (int i = 0; i < at.count; ++i) most = HWY_MAX(most, taps_of(i));
    for (int tap = 0; tap < most; ++tap) {
        Positions<kRowRoom> p;
        if (own)
            LocateOwn(at, tap, s.channels, row, p);
        else
            Locate(at, 0, at.count, together ? Tap{} : s.taps[tap], 0.5f, s.channels, row, p);
        for (int i = 0; i < at.count; ++i) {
            if (tap >= taps_of(i)) continue;
            float wx[4], wy[4];
            KernelWeights(s.kernel, p.fx[i], wx);
            KernelWeights(s.kernel, p.fy[i], wy);
            const std::byte* first = s.texels + std::ptrdiff_t{p.offset[i]} * bytes;
            if (is_cubic(s.kernel)) first -= s.row_stride + pixel;
            for (int c = 0; c < s.channels; ++c) {
                const int k = i * s.channels + c;
                if (std::isfinite(out[k])) continue;
                double& value = sum[static_cast<size_t>(k)];
                TapRange range;
                for (int j = 0; j < side; ++j)
                    for (int n = 0; n < side; ++n) {
                        const double weight = double{wy[j]} * double{wx[n]};
                        const std::byte* texel = first + j * s.row_stride + n * pixel + c * bytes;
                        const double level{load_channel(texel, s.type)};
                        if (weight != 0) value += weight * level;
                        range.add(level, weight);
                    }
                if (is_clamped(s.kernel)) value = range.clamped(value);
            }
        }
    }
    for (int k = 0; k < count; ++k)
        if (!std::isfinite(out[k]))
            out[k] = static_cast<float>(sum[static_cast<size_t>(k)] / taps_of(k / s.channels));
}

/// Can a filter make a channel infinite, or no number, where it should not be? Integers are finite, and nearest moves texels.
HWY_INLINE bool NeedsMending(const Texels& s) {
    return s.kernel != Kernel::nearest && (s.type == PixelType::half || s.type == PixelType::float32);
}

/// Mends a row that may have such channels.
HWY_INLINE void Mend(const Texels& s, const Offsets& at, float* out) {
    if (NeedsMending(s) && !AllFinite(out, at.count * s.channels)) MendChannels(s, at, out);
}

/// MendChannels of a row of a drawing, whose points are computed once more.
HWY_NOINLINE void MendDrawnRow(const Drawing& to, int row, float* values) {
    HWY_ALIGN float x[kRowRoom], y[kRowRoom];
    MendChannels(to.texels, PointsOfRow(to, row, x, y), values);
}
/// Mends a row of a drawing that may have such channels.
HWY_INLINE void MendRow(const Drawing& to, int row, float* values) {
    if (NeedsMending(to.texels) && !AllFinite(values, (to.end - to.begin) * to.texels.channels))
        MendDrawnRow(to, row, values);
}

/// Fetches what SampleTyped is to read of a row: of several taps, which lie next to each other, one in four.
template <class T>
HWY_INLINE void FetchRow(const Texels& s, const Offsets& at) {
    const auto row = static_cast<int32_t>(s.row_stride / static_cast<ptrdiff_t>(sizeof(T)));
    const int side = is_cubic(s.kernel) ? 4 : s.kernel == Kernel::bilinear ? 2 : 1;
    const float shift = 0.5f * static_cast<float>(side - 1);
    // Where texels lie together those farther up came with an earlier row of pixels.
    const int first = s.apart ? 0 : HWY_MAX(0, side - 2);
    for (int tap = 0; tap < s.tap_count; tap += 4) {
        Positions<kRowRoom> p;
        Locate(at, 0, at.count, s.taps[tap], shift, s.channels, row, p);
        for (int k = first; k < side; ++k) Fetch<T, 0>(s, p.offset, at.count, k, side);
    }
}

template <class T>
void SampleTyped(const Texels& s, const Offsets& at, float* out) {
    if (s.kernel == Kernel::nearest) return SampleNearest<T>(s, at, out);
    if (is_clamped(s.kernel)) return SampleBicubic<T, true>(s, at, out);
    if (is_cubic(s.kernel)) return SampleBicubic<T, false>(s, at, out);
    const auto with = [&](auto channels) {
        constexpr int k = decltype(channels)::value;
        if (at.own.x_i)
            SampleOwn<T, k>(s, at, out);
        else if (s.tap_count == 1)
            SampleBilinear<T, k>(s, at, out);
        else if (ReadNine(s))
            SampleNine<T, k>(s, at, out);
        else
            SampleTaps<T, k>(s, at, out);
    };
    // Single numbers are sampled one by one, however many channels there are.
    if constexpr (kQuad == 4) {
        if (s.channels == 3) return with(std::integral_constant<int, 3>{});
        if (s.channels == 4) return with(std::integral_constant<int, 4>{});
    }
    with(std::integral_constant<int, 0>{});
}

template <PixelType kType, class T, class Loop>
HWY_INLINE void ForTexelsOf(const Loop& loop) {
    if constexpr (has_loops(kType))
        loop(T{});
    else
        refuse_texels(kType);
}
/// Calls `loop` with a texel of type `type`, for its C++ type.
template <class Loop>
HWY_INLINE void ForTexels(PixelType type, const Loop& loop) {
    switch (type) {
        case PixelType::uint8:
            return ForTexelsOf<PixelType::uint8, uint8_t>(loop);
        case PixelType::uint16:
            return ForTexelsOf<PixelType::uint16, uint16_t>(loop);
        case PixelType::half:
            return ForTexelsOf<PixelType::half, hwy::float16_t>(loop);
        case PixelType::float32:
            return ForTexelsOf<PixelType::float32, float>(loop);
    }
}

void SampleRow(const Texels& s, const Offsets& at, float* out) {
    ForTexels(s.type, [&]<class T>(T) { SampleTyped<T>(s, at, out); });
    Mend(s, at, out);
}

/// Float to float, multiplied or, with the very bits, moved: whole aligned vectors bypass the cache.
template <bool kScales>
void StoreFloats(const float* HWY_RESTRICT values, int count, float scale, float* HWY_RESTRICT to) {
    const hn::ScalableTag<float> d;
    constexpr size_t kLine = 64;
    const auto v = hn::Set(d, scale);
    int i = 0;
    const size_t misaligned = reinterpret_cast<uintptr_t>(to) % kLine;
    const int head = HWY_MIN(count, static_cast<int>(misaligned ? (kLine - misaligned) / sizeof(float) : 0));
    for (; i < head; ++i) to[i] = kScales ? values[i] * scale : values[i];
    const int lanes = static_cast<int>(hn::Lanes(d));
    const int line = static_cast<int>(kLine / sizeof(float));
    for (; i + line <= count; i += line)
        for (int k = 0; k < line; k += lanes) {
            const auto value = hn::LoadU(d, values + i + k);
            hn::Stream(kScales ? hn::Mul(v, value) : value, d, to + i + k);
        }
    for (; i < count; ++i) to[i] = kScales ? values[i] * scale : values[i];
}

/// `values` where a whole vector can be read there, else a copy of the rest in `padded`.
const float* whole_vector(const float* values, int rest, float* padded) {
    if (rest >= static_cast<int>(kLanes)) return values;
    std::memcpy(padded, values, sizeof(float) * static_cast<size_t>(rest));
    return padded;
}

/// Float to 8 or 16 bits: rounded to nearest, clamped, NaN to 0.
template <class T>
void StoreIntegers(const float* HWY_RESTRICT values, int count, float scale, T* HWY_RESTRICT to) {
    const Floats d;
    const hn::Rebind<T, Floats> dt;
    const auto v = hn::Set(d, scale), zero = hn::Zero(d),
               most = hn::Set(d, static_cast<float>(hwy::LimitsMax<T>()));
    HWY_ALIGN T tail[kLanes];
    HWY_ALIGN float padded[kLanes] = {};
    for (int i = 0; i < count; i += static_cast<int>(kLanes)) {
        auto x = hn::Mul(v, hn::LoadU(d, whole_vector(values + i, count - i, padded)));
        x = hn::Min(hn::IfThenElse(hn::Gt(x, zero), x, zero), most);
        const auto n = hn::DemoteTo(dt, hn::NearestInt(x));
        const int rest = count - i;
        if (rest >= static_cast<int>(kLanes)) {
            hn::StoreU(n, dt, to + i);
        } else {
            hn::StoreU(n, dt, tail);
            std::memcpy(to + i, tail, sizeof(T) * static_cast<size_t>(rest));
        }
    }
}

void StoreHalf(const float* HWY_RESTRICT values, int count, float scale, hwy::float16_t* HWY_RESTRICT to) {
    const Floats d;
    const auto v = hn::Set(d, scale);
    HWY_ALIGN hwy::float16_t tail[kLanes];
    HWY_ALIGN float padded[kLanes] = {};
    for (int i = 0; i < count; i += static_cast<int>(kLanes)) {
        const int rest = count - i;
        const auto x = hn::Mul(v, hn::LoadU(d, whole_vector(values + i, rest, padded)));
        if (rest >= static_cast<int>(kLanes)) {
            StoreHalves(x, d, to + i);
        } else {
            StoreHalves(x, d, tail);
            std::memcpy(to + i, tail, sizeof(hwy::float16_t) * static_cast<size_t>(rest));
        }
    }
}

void StoreRow(const float* values, int count, float scale, PixelType type, std::byte* to) {
    switch (type) {
        case PixelType::uint8:
            return StoreIntegers(values, count, scale, reinterpret_cast<uint8_t*>(to));
        case PixelType::uint16:
            return StoreIntegers(values, count, scale, reinterpret_cast<uint16_t*>(to));
        case PixelType::half:
            return StoreHalf(values, count, scale, reinterpret_cast<hwy::float16_t*>(to));
        case PixelType::float32:
            return scale == 1 ? StoreFloats<false>(values, count, scale, reinterpret_cast<float*>(to))
                              : StoreFloats<true>(values, count, scale, reinterpret_cast<float*>(to));
    }
}

/// The common case without detours: one bilinear tap, three or four channels.
template <class T, int kChannels>
void DrawBilinear(const Drawing& to) {
    const Texels& s = to.texels;
    const auto* origin = reinterpret_cast<const T*>(s.texels);
    const ptrdiff_t row = s.row_stride / static_cast<ptrdiff_t>(sizeof(T));
    const int count = to.end - to.begin;
    const RowLocator<T, kChannels> locator(to, 0.5f);
    Positions<kRowRoom> positions[kRows];
    HWY_ALIGN float values[2][kRowRoom * kChannels];

    const auto locate = [&](int j) HWY_ATTR { locator.Row(j, positions[j % kRows]); };
    const auto sample = [&](int j) HWY_ATTR {
        const Positions<kRowRoom>& p = positions[j % kRows];
        float* HWY_RESTRICT out = values[j & 1];
        HWY_UNROLL(8)
        for (int i = 0; i < count; ++i)
            hn::StoreU(Bilinear<T, kChannels>(origin + p.offset[i], row, kChannels, p.fx[i], p.fy[i]), Quad(),
                       out + i * kChannels);
    };
    const auto store = [&](int j) HWY_ATTR {
        MendRow(to, j, values[j & 1]);
        StoreRow(values[j & 1], count * kChannels, to.scale, to.type,
                 to.to + (j - to.row_begin) * to.row_stride);
    };
    InStages(to, locate, sample, store);
}

/// Taps that read nine texels, three or four channels.
template <class T, int kChannels>
void DrawNine(const Drawing& to) {
    const Texels& s = to.texels;
    const int count = to.end - to.begin;
    const TapsOfRow taps(s, {});
    const RowLocator<T, kChannels> locator(to, 0);
    Positions<kRowRoom> positions[kRows];
    WeightsOfRow weights;
    HWY_ALIGN float values[2][kRowRoom * kChannels];

    const auto locate = [&](int j) HWY_ATTR { locator.Row(j, positions[j % kRows]); };
    const auto sample = [&](int j) HWY_ATTR {
        const Positions<kRowRoom>& p = positions[j % kRows];
        WeighNine(taps, p, count, weights);
        SampleNineRow<T, kChannels>(s, p.offset, count, weights, values[j & 1]);
    };
    const auto store = [&](int j) HWY_ATTR {
        MendRow(to, j, values[j & 1]);
        StoreRow(values[j & 1], count * kChannels, to.scale, to.type,
                 to.to + (j - to.row_begin) * to.row_stride);
    };
    InStages(to, locate, sample, store);
}

template <class T>
void DrawTyped(const Drawing& to) {
    const Texels& s = to.texels;
    if constexpr (kQuad == 4) {
        if (ReadNine(s)) {
            if (s.channels == 3) return DrawNine<T, 3>(to);
            if (s.channels == 4) return DrawNine<T, 4>(to);
        }
        if (s.kernel == Kernel::bilinear && s.tap_count == 1) {
            if (s.channels == 3) return DrawBilinear<T, 3>(to);
            if (s.channels == 4) return DrawBilinear<T, 4>(to);
        }
    }
    const int count = to.end - to.begin;
    HWY_ALIGN float x[kRows][kRowRoom], y[kRows][kRowRoom];
    Offsets rows[kRows];
    const std::size_t room = static_cast<size_t>(kMaxRow * s.channels + 16);
    std::vector<float> values(2 * room);
    const auto locate = [&](int j) HWY_ATTR {
        rows[j % kRows] = PointsOfRow(to, j, x[j % kRows], y[j % kRows]);
        FetchRow<T>(s, rows[j % kRows]);
    };
    const auto sample = [&](int j) { SampleTyped<T>(s, rows[j % kRows], values.data() + (j & 1) * room); };
    const auto store = [&](int j) HWY_ATTR {
        MendRow(to, j, values.data() + (j & 1) * room);
        StoreRow(values.data() + (j & 1) * room, count * s.channels, to.scale, to.type,
                 to.to + (j - to.row_begin) * to.row_stride);
    };
    InStages(to, locate, sample, store);
}

void DrawBlock(const Drawing& drawing) {
    ForTexels(drawing.texels.type, [&]<class T>(T) { DrawTyped<T>(drawing); });
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(BlockPoints);
HWY_EXPORT(SampleRow);
HWY_EXPORT(StoreRow);
HWY_EXPORT(DrawBlock);

void block_points(const Polynomials& block, int row, int begin, int end, float* out_x, float* out_y) {
    HWY_DYNAMIC_DISPATCH(BlockPoints)(block, row, begin, end, out_x, out_y);
}

void draw_block(const Texels& texels, const Polynomials& block, int begin, int end, int row_begin,
                int row_end, float scale, PixelType type, std::byte* to, std::ptrdiff_t row_stride) {
    const Drawing drawing{texels, block, begin, end, row_begin, row_end, scale, type, to, row_stride};
    if (!draw_packed_block(drawing)) HWY_DYNAMIC_DISPATCH(DrawBlock)(drawing);
}

void sample_row(const Texels& texels, const Offsets& offsets, float* out) {
    HWY_DYNAMIC_DISPATCH(SampleRow)(texels, offsets, out);
}

namespace {

/// The row of a pixel's own texel, and the other row that is read.
void fetch(const std::byte* texel, float y, std::ptrdiff_t row_stride) {
    prefetch_to_second_level(texel);
    prefetch_to_second_level(texel + (y < 0.5f ? -row_stride : row_stride));
}

}  // namespace

void fetch_row(const Texels& s, const Offsets& at) {
    const std::ptrdiff_t pixel = std::ptrdiff_t{s.channels} * size_of(s.type);
    for (int i = 0; i < at.count; ++i)
        fetch(s.texels + at.whole_y[i] * s.row_stride + at.whole_x[i] * pixel, at.y[i], s.row_stride);
}

void fetch_row(const std::byte* const* texels, const float* y, int count, std::ptrdiff_t row_stride) {
    for (int i = 0; i < count; ++i)
        if (texels[i]) fetch(texels[i], y[i], row_stride);
}

void store_row(const float* values, int count, float scale, PixelType type, std::byte* to) {
    HWY_DYNAMIC_DISPATCH(StoreRow)(values, count, scale, type, to);
}

void finish_stores() {
    hwy::FlushStream();
}

namespace {

const std::vector<std::pair<int64_t, std::string>>& available() {
    static const auto sets = [] {
        std::vector<std::pair<int64_t, std::string>> list;
        // Better instruction sets have lower bits.
        for (int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1)
            list.emplace_back(left & -left, hwy::TargetName(left & -left));
        return list;
    }();
    return sets;
}

}  // namespace

const char* const* instruction_sets() {
    static const auto names = [] {
        std::vector<const char*> list;
        for (const auto& set : available()) list.push_back(set.second.c_str());
        list.push_back(nullptr);
        return list;
    }();
    return names.data();
}

bool use_instruction_set(const char* name) {
    // With a set go the weaker ones, for source files that are not compiled for this one; with none, all.
    int64_t sets = 0;
    for (const auto& set : available())
        if (sets != 0 || set.second == name) sets |= set.first;
    if (sets == 0 && *name != '\0') return false;
    hwy::SetSupportedTargetsForTest(sets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return true;
}

}  // namespace anamorph::simd
#endif
