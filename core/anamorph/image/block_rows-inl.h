// SPDX-License-Identifier: Apache-2.0
// What all loops over the rows of a block share: its points, where they fall among the texels, texels as floats, and
// the order of work. Included once for every instruction set, as Highway's own headers are.
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "anamorph/image/packed_blocks.h"
#include "anamorph/image/prefetch.h"
#include "anamorph/number/fused-inl.h"
#include "hwy/cache_control.h"
#include "hwy/highway.h"

#if defined(ANAMORPH_SIMD_BLOCK_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ANAMORPH_SIMD_BLOCK_ROWS_INL_H_
#undef ANAMORPH_SIMD_BLOCK_ROWS_INL_H_
#else
#define ANAMORPH_SIMD_BLOCK_ROWS_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Coordinates: as many lanes as there are. Texels: four channels, or two neighbouring texels of them.
using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using Quad = hn::CappedTag<float, 4>;
using Pair = hn::CappedTag<float, 8>;
constexpr size_t kLanes = hn::MaxLanes(Floats());
constexpr int kQuad = static_cast<int>(hn::MaxLanes(Quad()));  // 1 where Highway has no vectors

/// The steps of s and t from pixel to pixel, halved: -1 stands at the first pixel, 1 at the last, 0 where there is one.
struct HalfSteps {
    float s, t;

    HWY_INLINE explicit HalfSteps(const Polynomials& block) : s(Of(block.width)), t(Of(block.height)) {}

  private:
    static HWY_INLINE float Of(int count) { return count > 1 ? 1.0f / static_cast<float>(count - 1) : 0.0f; }
};

/// The points of a row, by its polynomials in s or as they stand.
struct RowPoints {
    hn::Vec<Floats> x0, x1, x2, x3, y0, y1, y2, y3, step;
    float first;
    bool cubic;
    const float *x = nullptr, *y = nullptr;
    const int32_t *whole_x = nullptr, *whole_y = nullptr;

    HWY_INLINE RowPoints(const Polynomials& block, const HalfSteps& steps, int row) {
        const Floats d;
        if (block.x) {
            x = block.x + row * block.row_stride;
            y = block.y + row * block.row_stride;
            if (block.whole_x) {
                whole_x = block.whole_x + row * block.row_stride;
                whole_y = block.whole_y + row * block.row_stride;
            }
            x0 = x1 = x2 = x3 = y0 = y1 = y2 = y3 = step = hn::Zero(d);
            first = 0;
            cubic = false;
            return;
        }
        // Horner's rule for t, for all eight coefficients at once.
        const hn::CappedTag<float, 8> d8;
        const auto t = hn::Set(d8, static_cast<float>(2 * row - (block.height - 1)) * steps.t);
        HWY_ALIGN float c[8];
        for (int lane = 0; lane < 8; lane += static_cast<int>(hn::MaxLanes(d8))) {
            auto sum = hn::LoadU(d8, block.c[block.degree] + lane);
            for (int j = block.degree - 1; j >= 0; --j) sum = Fused(sum, t, hn::LoadU(d8, block.c[j] + lane));
            hn::Store(sum, d8, c + lane);
        }
        x0 = hn::Set(d, c[0]);
        x1 = hn::Set(d, c[1]);
        x2 = hn::Set(d, c[2]);
        x3 = hn::Set(d, c[3]);
        y0 = hn::Set(d, c[4]);
        y1 = hn::Set(d, c[5]);
        y2 = hn::Set(d, c[6]);
        y3 = hn::Set(d, c[7]);
        step = hn::Set(d, steps.s);
        first = static_cast<float>(1 - block.width);
        cubic = block.degree == 3;
    }
    /// The whole texels to be added from pixel i on, or null; WholeY() has those along y.
    HWY_INLINE const int32_t* WholeX(int i) const { return whole_x ? whole_x + i : nullptr; }
    HWY_INLINE const int32_t* WholeY(int i) const { return whole_y ? whole_y + i : nullptr; }
    /// Calls body(i, x, y) for the points of pixels begin + i, begin + i + 1, ... of `count`, a vector at a time.
    template <class Body>
    HWY_INLINE void ForEach(int begin, int count, const Body& body) const {
        const Floats d;
        constexpr int n = static_cast<int>(kLanes);
        if (x) {
            for (int i = 0; i < count; i += n)
                body(i, hn::LoadU(d, x + begin + i), hn::LoadU(d, y + begin + i));
            return;
        }
        // Pixel i stands 2 i - (width - 1) half steps from the middle, a whole number.
        const auto lanes = hn::Iota(d, 0.0f);
        auto half_steps = hn::Add(hn::Add(lanes, lanes), hn::Set(d, first + static_cast<float>(2 * begin)));
        const auto on = hn::Set(d, static_cast<float>(2 * n));
        if (cubic) {
            for (int i = 0; i < count; i += n, half_steps = hn::Add(half_steps, on)) {
                const auto s = hn::Mul(half_steps, step);
                body(i, Value(s, x0, x1, Fused(s, x3, x2)), Value(s, y0, y1, Fused(s, y3, y2)));
            }
        } else {
            for (int i = 0; i < count; i += n, half_steps = hn::Add(half_steps, on)) {
                const auto s = hn::Mul(half_steps, step);
                body(i, Value(s, x0, x1, x2), Value(s, y0, y1, y2));
            }
        }
    }

  private:
    static HWY_INLINE hn::Vec<Floats> Value(hn::Vec<Floats> s, hn::Vec<Floats> c0, hn::Vec<Floats> c1,
                                            hn::Vec<Floats> c2) {
        return Fused(s, Fused(s, c2, c1), c0);
    }
};

constexpr bool kHasPair = hn::MaxLanes(Pair()) == 8;  // two texels of up to four channels in one vector

// Highway's own conversions of half where the processor has none, or is to use none, cut off, and know no infinity.
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2 && !defined(HWY_DISABLE_F16C)
constexpr bool kHasHalf = true;
#else
constexpr bool kHasHalf = false;
#endif

/// float_from_half (number/half.h) for as many halves from `p` as D has lanes.
template <class D>
HWY_INLINE hn::Vec<D> LoadHalves(D d, const hwy::float16_t* p) {
    if constexpr (kHasHalf) {
        return hn::PromoteTo(d, hn::LoadU(hn::Rebind<hwy::float16_t, D>(), p));
    } else {
        const hn::RebindToSigned<D> di;
        const auto half =
            hn::PromoteTo(di, hn::LoadU(hn::Rebind<uint16_t, D>(), reinterpret_cast<const uint16_t*>(p)));
        const auto magnitude = hn::And(half, hn::Set(di, 0x7fff));
        const auto sign = hn::ShiftLeft<16>(hn::Sub(half, magnitude));
        const auto wide = hn::ShiftLeft<13>(magnitude);
        const auto denormal = hn::BitCast(di, hn::Mul(hn::ConvertTo(d, magnitude), hn::Set(d, 0x1p-24f)));
        const auto normal = hn::Add(wide, hn::Set(di, (127 - 15) << 23));
        const auto special = hn::Or(wide, hn::Set(di, 0x7f800000));
        const auto value =
            hn::IfThenElse(hn::Lt(magnitude, hn::Set(di, 0x0400)), denormal,
                           hn::IfThenElse(hn::Lt(magnitude, hn::Set(di, 0x7c00)), normal, special));
        return hn::BitCast(d, hn::Or(sign, value));
    }
}

/// Loads as many channels from `p` as D has lanes, as floats.
template <class D, class T>
HWY_INLINE hn::Vec<D> LoadFloats(D d, const T* p) {
    if constexpr (std::is_same_v<T, float>) {
        return hn::LoadU(d, p);
    } else if constexpr (std::is_same_v<T, hwy::float16_t>) {
        return LoadHalves(d, p);
    } else {
        return hn::ConvertTo(d, hn::PromoteTo(hn::RebindToSigned<D>(), hn::LoadU(hn::Rebind<T, D>(), p)));
    }
}

/// The positions of taps: whole texels as an element offset, and the fractions.
template <int kCount>
struct Positions {
    HWY_ALIGN int32_t offset[kCount];
    HWY_ALIGN float fx[kCount], fy[kCount];
};

/// Added to this number, whose last bit is worth 1, numbers between -2^22 and 2^22 are rounded to the nearest
/// whole ones, and the bits count up from its own.
constexpr float kUnit = 3 << 22;

/// Converts numbers to which kUnit was added to integers; the result is unspecified for others.
HWY_INLINE hn::Vec<Ints> ToInts(hn::Vec<Floats> v) {
    const Ints di;
    const auto unit = hn::Set(Floats(), kUnit);
    return hn::Sub(hn::BitCast(di, hn::Add(v, unit)), hn::BitCast(di, unit));
}

/// The element offsets of texels (floor x, floor y), whole texels added where they are given, and the fractions.
HWY_INLINE hn::Vec<Ints> OffsetsOf(hn::Vec<Floats> x, hn::Vec<Floats> y, hn::Vec<Ints> row,
                                   hn::Vec<Ints> pixel, hn::Vec<Floats>& fx, hn::Vec<Floats>& fy,
                                   const int32_t* whole_x = nullptr, const int32_t* whole_y = nullptr) {
    const Ints di;
    const auto ix = hn::Floor(x), iy = hn::Floor(y);
    fx = hn::Sub(x, ix);
    fy = hn::Sub(y, iy);
    auto tx = ToInts(ix), ty = ToInts(iy);
    if (whole_x) {
        tx = hn::Add(tx, hn::LoadU(di, whole_x));
        ty = hn::Add(ty, hn::LoadU(di, whole_y));
    }
    return hn::Add(hn::Mul(ty, row), hn::Mul(tx, pixel));
}

/// Stores the element offsets and fractions of texels (floor x, floor y) into entries i, i + 1, ... of positions.
template <int kCount>
HWY_INLINE void Locate(hn::Vec<Floats> x, hn::Vec<Floats> y, hn::Vec<Ints> row, hn::Vec<Ints> pixel, int i,
                       Positions<kCount>& p, const int32_t* whole_x = nullptr,
                       const int32_t* whole_y = nullptr) {
    hn::Vec<Floats> fx, fy;
    hn::Store(OffsetsOf(x, y, row, pixel, fx, fy, whole_x, whole_y), Ints(), p.offset + i);
    hn::Store(fx, Floats(), p.fx + i);
    hn::Store(fy, Floats(), p.fy + i);
}

/// Is each of `count` values a finite number? Behind them there is room to read a vector.
HWY_INLINE bool AllFinite(const float* HWY_RESTRICT values, int count) {
    const Ints d;
    const auto bits = [&](int i) HWY_ATTR {
        return hn::And(hn::BitCast(d, hn::LoadU(Floats(), values + i)), hn::Set(d, 0x7fffffff));
    };
    constexpr int n = static_cast<int>(kLanes);
    auto most = hn::Zero(d);
    int i = 0;
    for (; i + n <= count; i += n) most = hn::Max(most, bits(i));
    if (i < count)
        most = hn::Max(most, hn::IfThenElseZero(hn::FirstN(d, static_cast<size_t>(count - i)), bits(i)));
    return hn::AllTrue(d, hn::Lt(most, hn::Set(d, 0x7f800000)));
}
HWY_INLINE bool AllFinite(const hwy::float16_t* HWY_RESTRICT values, int count) {
    const hn::CappedTag<int16_t, 32> d;
    const auto bits = [&](int i) HWY_ATTR {
        return hn::And(hn::LoadU(d, reinterpret_cast<const int16_t*>(values) + i), hn::Set(d, 0x7fff));
    };
    constexpr int n = static_cast<int>(hn::MaxLanes(d));
    auto most = hn::Zero(d);
    int i = 0;
    for (; i + n <= count; i += n) most = hn::Max(most, bits(i));
    if (i < count)
        most = hn::Max(most, hn::IfThenElseZero(hn::FirstN(d, static_cast<size_t>(count - i)), bits(i)));
    return hn::AllTrue(d, hn::Lt(most, hn::Set(d, 0x7c00)));
}
HWY_INLINE bool AllFinite(const uint16_t*, int) {
    return true;
}

/// Stores the points of pixels [begin, end) of a row to arrays with room for a vector behind.
HWY_INLINE void StorePoints(const Polynomials& block, int row, int begin, int end, float* HWY_RESTRICT x,
                            float* HWY_RESTRICT y) {
    const Floats d;
    const RowPoints points(block, HalfSteps(block), row);
    points.ForEach(begin, end - begin, [&](int i, hn::Vec<Floats> px, hn::Vec<Floats> py) HWY_ATTR {
        hn::StoreU(px, d, x + i);
        hn::StoreU(py, d, y + i);
    });
}

/// The points of a drawing's row; they are computed into x and y where they do not stand in memory.
HWY_INLINE Offsets PointsOfRow(const Drawing& drawing, int row, float* HWY_RESTRICT x,
                               float* HWY_RESTRICT y) {
    const Polynomials& block = drawing.block;
    const int count = drawing.end - drawing.begin;
    if (block.x) {
        const ptrdiff_t given = row * block.row_stride + drawing.begin;
        return {block.x + given, block.y + given, count, block.whole_x ? block.whole_x + given : nullptr,
                block.whole_x ? block.whole_y + given : nullptr};
    }
    StorePoints(block, row, drawing.begin, drawing.end, x, y);
    return {x, y, count};
}

/// The number of pixels by which texels are prefetched before they are read, and the number of rows for which there is room.
constexpr int kAhead = 192, kRows = 8;

/// Prefetches what pixels read of one row of texels, `below` rows farther down: `texels` from `offset` elements on. Where
/// the texels of neighbours lie far apart, those of each pixel are fetched, of which a vector is loaded that may lie on two
/// cache lines; elsewhere the first texels of a few pixels are enough to fetch every line.
template <class T, int kChannels>
HWY_INLINE void Fetch(const Texels& s, const int32_t* offset, int count, int below, int texels) {
    const auto* origin = reinterpret_cast<const T*>(s.texels + below * s.row_stride);
    const int channels = kChannels ? kChannels : s.channels;
    if (s.apart) {
        constexpr int kLoaded = sizeof(T) == 1 ? 16 : 8, kLine = 64 / sizeof(T);
        const int last = HWY_MAX(kLoaded, texels * channels) - 1;
        for (int i = 0; i < count; ++i) {
            for (int k = 0; k < last; k += kLine) prefetch_to_second_level(origin + offset[i] + k);
            prefetch_to_second_level(origin + offset[i] + last);
        }
        return;
    }
    // Texels of as many pixels span up to the root of 3 times that, less than a line's 64 bytes.
    constexpr int kBytes = 36;
    const int step = HWY_MAX(1, kBytes / (channels * static_cast<int>(sizeof(T))));
    for (int i = 0; i < count; i += step) hwy::Prefetch(origin + offset[i]);
}

/// Prefetches the two rows of a bilinear tap.
template <class T, int kChannels>
HWY_INLINE void FetchBilinear(const Texels& s, const int32_t* offset, int count) {
    Fetch<T, kChannels>(s, offset, count, 0, 2);
    Fetch<T, kChannels>(s, offset, count, 1, 2);
}

/// Finds the positions of the pixels of a drawing's rows among its texels: of their one bilinear tap, with a shift of half a
/// texel, or of the points themselves, with none.
template <class T, int kChannels>
class RowLocator {
  public:
    HWY_INLINE RowLocator(const Drawing& drawing, float shift)
        : m_drawing(drawing),
          m_steps(drawing.block),
          m_row(hn::Set(Ints(),
                        static_cast<int32_t>(drawing.texels.row_stride / static_cast<ptrdiff_t>(sizeof(T))))),
          m_pixel(hn::Set(Ints(), kChannels)),
          m_shift_x(hn::Set(Floats(), shift > 0 ? drawing.texels.taps[0].x - shift : 0)),
          m_shift_y(hn::Set(Floats(), shift > 0 ? drawing.texels.taps[0].y - shift : 0)) {}

    HWY_INLINE void Row(int j, Positions<kRowRoom>& to) const {
        const int begin = m_drawing.begin, count = m_drawing.end - begin;
        const RowPoints points(m_drawing.block, m_steps, j);
        points.ForEach(begin, count, [&](int i, hn::Vec<Floats> x, hn::Vec<Floats> y) HWY_ATTR {
            Locate(hn::Add(x, m_shift_x), hn::Add(y, m_shift_y), m_row, m_pixel, i, to,
                   points.WholeX(begin + i), points.WholeY(begin + i));
        });
        FetchBilinear<T, kChannels>(m_drawing.texels, to.offset, count);
    }

  private:
    const Drawing& m_drawing;
    HalfSteps m_steps;
    hn::Vec<Ints> m_row, m_pixel;
    hn::Vec<Floats> m_shift_x, m_shift_y;
};

/// Draws rows in three stages: located and their texels fetched, kAhead pixels later sampled, and a row later stored.
/// Reading what was just written in pieces of another size would wait for those writes.
template <class Locating, class Sampling, class Storing>
HWY_INLINE void InStages(const Drawing& drawing, const Locating& locate, const Sampling& sample,
                         const Storing& store) {
    const int begin = drawing.row_begin, end = drawing.row_end;
    const int ahead = HWY_MAX(1, HWY_MIN(kAhead / (drawing.end - drawing.begin), kRows - 1));
    // Each stage stands here once, as it is long.
    for (int j = begin - ahead; j <= end; ++j) {
        if (j + ahead < end) locate(j + ahead);
        if (j >= begin && j < end) sample(j);
        if (j > begin) store(j - 1);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#endif
