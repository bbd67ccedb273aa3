// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/deform/deform_lanes.cpp"
#include "anamorph/deform/deform_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <span>
#include <type_traits>
#include <vector>

#include "anamorph/number/number.h"

#include "hwy/cache_control.h"
#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "anamorph/number/lanes.h"
// It is made of those.
#include "anamorph/number/exp_of_minus.h"
// Templates over the number, compiled once for every instruction set.
#include "anamorph/deform/deformation_formula.h"

using D = hn::CappedTag<double, kPointBlock>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using VI = hn::Vec<DI>;
using L = Lanes<D>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));

/// A whole number in [-2^51, 2^51] plus this has that number in its last bits, and next to it doubles are whole numbers.
constexpr double kRounder = 0x1.8p52;
constexpr std::int64_t kRounderBits = 0x4338000000000000;

HWY_INLINE V WithRounder(VI whole) {
    return hn::BitCast(D(), hn::Add(whole, hn::Set(DI(), kRounderBits)));
}
HWY_INLINE VI WithoutRounder(V sum) {
    return hn::Sub(hn::BitCast(DI(), sum), hn::Set(DI(), kRounderBits));
}

/// The share of V that a point moves by, as products are made of it: with the last bit 1, or 0 (deform_kernels.h).
HWY_INLINE V ShareOf(V factor) {
    const V odd = hn::BitCast(D(), hn::Or(hn::BitCast(DI(), factor), hn::Set(DI(), 1)));
    return hn::IfThenElseZero(hn::Gt(factor, hn::Zero(D())), odd);
}

#if !HWY_NATIVE_FMA
/// The rest a b - round(a b), exact (Dekker 1971).
HWY_INLINE V RestOfProduct(V a, V b, V product) {
    const auto upper_half = [](V x) HWY_ATTR {
        const V c = hn::Mul(x, hn::Set(D(), 0x1p27 + 1));
        return hn::Sub(c, hn::Sub(c, x));
    };
    const V a1 = upper_half(a), a2 = hn::Sub(a, a1), b1 = upper_half(b), b2 = hn::Sub(b, b1);
    const V above = hn::Sub(hn::Mul(a1, b1), product);
    return hn::Add(hn::Add(hn::Add(above, hn::Mul(a1, b2)), hn::Mul(a2, b1)), hn::Mul(a2, b2));
}
/// Of a sum that was rounded half a unit away from what the rounded product made it, the one on the side that the product's rest
/// points to.
HWY_NOINLINE V OnTheSideOfRest(V sum, V off, V a, V b, V product) {
    const V rest = RestOfProduct(a, b, product);
    const auto beyond =
        hn::And(hn::Eq(hn::Abs(off), hn::Set(D(), 0.5)), hn::Gt(hn::Mul(off, rest), hn::Zero(D())));
    return hn::Add(sum, hn::IfThenElseZero(beyond, hn::Add(off, off)));
}
#endif

/// Are sums from -kMostInDouble up to below kMostInDouble? count: a multiple of kLanes.
bool AreInDouble(const std::int64_t* sums, std::size_t count) {
    const DI di;
    constexpr auto kMost = static_cast<std::int64_t>(kMostInDouble);
    VI bits = hn::Zero(di);
    for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(kLanes))
        bits = hn::Or(bits, hn::Add(hn::LoadU(di, sums + i), hn::Set(di, kMost)));
    return hn::AllTrue(di, hn::Eq(hn::And(bits, hn::Set(di, ~(2 * kMost - 1))), hn::Zero(di)));
}

/// sum + a b, rounded once to a whole number: `sum` is a whole number and kRounder, a a weight and b a share.
HWY_INLINE V AddRounded(V sum, V a, V b) {
#if HWY_NATIVE_FMA
    return hn::MulAdd(a, b, sum);
#else
    const V product = hn::Mul(a, b), rounded = hn::Add(sum, product);
    // Exact. A product that was rounded cannot have crossed the middle of two whole numbers, but it may have come to lie on it.
    const V off = hn::Sub(product, hn::Sub(rounded, sum));
    if (HWY_UNLIKELY(!hn::AllFalse(D(), hn::Eq(hn::Abs(off), hn::Set(D(), 0.5)))))
        return OnTheSideOfRest(rounded, off, a, b, product);
    return rounded;
#endif
}

/// The sum of rounded products, a whole number, in lanes. kInDouble: none is beyond kMostInDouble on the way; the bits are the same.
template <bool kInDouble>
class WholeSum {
  public:
    HWY_INLINE WholeSum() {}  // the compiler's own is not of the instruction set
    HWY_INLINE void clear() {
        if constexpr (kInDouble)
            m_sum = hn::Set(D(), kRounder);
        else
            m_sum = hn::Zero(DI());
    }
    HWY_INLINE void load(const std::int64_t* from) {
        const VI whole = hn::LoadU(DI(), from);
        if constexpr (kInDouble)
            m_sum = WithRounder(whole);
        else
            m_sum = whole;
    }
    HWY_INLINE void add(V weight, V share) {
        if constexpr (kInDouble)
            m_sum = AddRounded(m_sum, weight, share);
        else
            m_sum = hn::Add(m_sum, WithoutRounder(AddRounded(hn::Set(D(), kRounder), weight, share)));
    }
    HWY_INLINE void store(std::int64_t* to) const {
        if constexpr (kInDouble)
            hn::StoreU(WithoutRounder(m_sum), DI(), to);
        else
            hn::StoreU(m_sum, DI(), to);
    }

  private:
    std::conditional_t<kInDouble, V, VI> m_sum;
};

/// A number and its derivative: as much of a number as kernels ask for.
struct Slope {
    L value, by;

    HWY_INLINE Slope(double k) : value(k), by(0.0) {}  // NOLINT: a number has a slope
    HWY_INLINE Slope(const L& v, const L& d) : value(v), by(d) {}

    friend HWY_INLINE Slope operator-(const Slope& a) { return {-a.value, -a.by}; }
    friend HWY_INLINE Slope operator+(const Slope& a, const Slope& b) {
        return {a.value + b.value, a.by + b.by};
    }
    friend HWY_INLINE Slope operator-(const Slope& a, const Slope& b) {
        return {a.value - b.value, a.by - b.by};
    }
    friend HWY_INLINE Slope operator*(const Slope& a, const Slope& b) {
        return {a.value * b.value, a.value * b.by + a.by * b.value};
    }
    friend HWY_INLINE Slope square(const Slope& a) { return {square(a.value), L(2.0) * a.value * a.by}; }
    friend HWY_INLINE Slope sqrt(const Slope& a) {
        const L r = sqrt(a.value);
        return {r, a.by * (L(0.5) / r)};
    }
    friend HWY_INLINE Slope exp_of_minus(const Slope& a) {
        const L e = exp_of_minus(a.value);
        return {e, -(e * a.by)};
    }
    friend HWY_INLINE L::M is_zero(const Slope& a) { return is_zero(a.value); }
    friend HWY_INLINE L::M is_negative(const Slope& a) { return is_negative(a.value); }
    friend HWY_INLINE Slope select(L::M where, const Slope& a, const Slope& b) {
        return {select(where, a.value, b.value), select(where, a.by, b.by)};
    }
};

HWY_INLINE L ZeroUnless(L::M inside, const L& a) {
    return L(hn::IfThenElseZero(inside.m, a.v));
}
HWY_INLINE Slope ZeroUnless(L::M inside, const Slope& a) {
    return {ZeroUnless(inside, a.value), ZeroUnless(inside, a.by)};
}

HWY_INLINE L DistanceOf(const AxisKernel& kernel, const L& x) {
    return (x - L(kernel.center)) * L(kernel.inverse_extent);
}
/// t, as a number of which the derivative by x is asked, or not.
template <class T>
HWY_INLINE T NumberOf(const AxisKernel& kernel, const L& t) {
    if constexpr (std::is_same_v<T, L>) {
        return t;
    } else {
        // As far out as this the factors are 0 in double, and their derivatives are finite.
        const double most = kernel.gaussian ? 30.0 : 2.0;
        return Slope(L(hn::Max(hn::Min(t.v, L(most).v), L(-most).v)), L(kernel.inverse_extent));
    }
}
/// The factor of t in one direction, not cut off. T: L, or Slope for its derivative by x too.
template <class T>
HWY_INLINE T FactorOf(const AxisKernel& kernel, const L& t) {
    const T squared = square(NumberOf<T>(kernel, t));
    return kernel.gaussian ? gaussian_of(squared) : squared;
}
template <class T>
HWY_INLINE T CutFactorOf(const AxisKernel& kernel, const L& t) {
    const T factor = FactorOf<T>(kernel, t);
    return kernel.gaussian ? ZeroUnless(L::M{hn::Le(abs(t).v, hn::Set(D(), kernel.reach))}, factor) : factor;
}

void AxisFactors(const AxisKernel& kernel, const double* x, int count, double* out, double* slope) {
    const auto at = [&](const double* from, double* to, double* slope_to) HWY_ATTR {
        const L t = DistanceOf(kernel, L::load(from));
        if (!slope_to) {
            const L factor = CutFactorOf<L>(kernel, t);
            (kernel.shares && kernel.gaussian ? L(ShareOf(factor.v)) : factor).store(to);
            return;
        }
        const Slope factor = CutFactorOf<Slope>(kernel, t);
        factor.value.store(to);
        factor.by.store(slope_to);
    };
    int i = 0;
    for (; i + kLanes <= count; i += kLanes) at(x + i, out + i, slope ? slope + i : nullptr);
    if (i >= count) return;
    HWY_ALIGN double last[kLanes] = {}, last_slope[kLanes];
    std::copy(x + i, x + count, last);
    at(last, last, slope ? last_slope : nullptr);
    std::copy(last, last + (count - i), out + i);
    if (slope) std::copy(last_slope, last_slope + (count - i), slope + i);
}

/// A term on a pair of rows.
struct PairTerm {
    const double* column;  ///< of column_begin
    int column_begin, column_end;
    bool gaussian;
    double row[kGridRows];        ///< squared distances
    double weight[kGridRows][3];  ///< units, times the row's factor for Gaussians
};

PairTerm OnRows(const GridTerm& term, int row) {
    PairTerm pair{term.column, term.column_begin, term.column_end, term.gaussian, {}, {}};
    for (int r = 0; r < kGridRows; ++r) {
        pair.row[r] = term.row[row + r - term.row_begin];
        for (int c = 0; c < 3; ++c) pair.weight[r][c] = term.units[c] * (term.gaussian ? pair.row[r] : 1);
    }
    return pair;
}

/// As many vectors of columns as there is room for in registers, with the sums of two rows and three components; Wendland's function
/// takes some itself.
template <bool kGaussian>
constexpr int kAcross = HWY_TARGET <= HWY_AVX3       ? 4
                        : HWY_NATIVE_FMA&& kGaussian ? 2
                                                     : 1;

constexpr int kBlockSums = 3 * kGridRows * kGridBlock;

/// The shares of a term in one of its rows. columns: of its table.
template <bool kGaussian>
HWY_INLINE V ShareInRow(const PairTerm& term, int r, V columns) {
    if constexpr (kGaussian) return columns;
    return ShareOf(wendland_of(L(hn::Add(columns, hn::Set(D(), term.row[r])))).v);
}

/// Adds one term or more, of one kernel, to a block of kGridBlock columns from `column` on; sums as in grid_sums(). fresh: they begin at 0.
template <bool kInDouble, bool kGaussian>
void AddToBlock(std::span<const PairTerm* const> terms, int column, bool fresh, std::int64_t* sums) {
    constexpr int kStep = std::min(kAcross<kGaussian> * kLanes, kGridBlock), kVectors = kStep / kLanes;
    const D d;
    for (int at = 0; at < kGridBlock; at += kStep) {
        WholeSum<kInDouble> sum[kGridRows][3][kVectors];
        const auto place = [&](int r, int c, int v) {
            return sums + (3 * r + c) * kGridBlock + at + v * kLanes;
        };
        for (int r = 0; r < kGridRows; ++r)
            for (int c = 0; c < 3; ++c)
                for (int v = 0; v < kVectors; ++v)
                    if (fresh)
                        sum[r][c][v].clear();
                    else
                        sum[r][c][v].load(place(r, c, v));
        const PairTerm* const* of = terms.data();
        do {  // not once is no case of its own
            const PairTerm& term = **of;
            const double* from = term.column + (column - term.column_begin) + at;
            for (int r = 0; r < kGridRows; ++r) {
                V shares[kVectors];
                for (int v = 0; v < kVectors; ++v)
                    shares[v] = ShareInRow<kGaussian>(term, r, hn::LoadU(d, from + v * kLanes));
                for (int c = 0; c < 3; ++c) {
                    const V weight = hn::Set(d, term.weight[r][c]);
                    for (int v = 0; v < kVectors; ++v) sum[r][c][v].add(weight, shares[v]);
                }
            }
        } while (++of != terms.data() + terms.size());
        for (int r = 0; r < kGridRows; ++r)
            for (int c = 0; c < 3; ++c)
                for (int v = 0; v < kVectors; ++v) sum[r][c][v].store(place(r, c, v));
    }
}

HWY_INLINE V LoadAsDoubles(const float* from) {
    return hn::PromoteTo(D(), hn::LoadU(hn::Rebind<float, D>(), from));
}
HWY_INLINE V LoadAsDoubles(const double* from) {
    return hn::LoadU(D(), from);
}
HWY_INLINE hn::Vec<hn::Rebind<float, D>> StoreAs(const float*, V v) {
    return hn::DemoteTo(hn::Rebind<float, D>(), v);
}
HWY_INLINE V StoreAs(const double*, V v) {
    return v;
}

constexpr std::uintptr_t kStreamed = 16;  ///< bytes that are written past the caches at once

/// Writes numbers; past the caches if `stream`, to multiples of kStreamed.
template <class T>
HWY_INLINE void StoreNumbers(V v, bool stream, T* out) {
    const hn::Rebind<T, D> dt;
    const auto numbers = StoreAs(out, v);
    constexpr int kPart = static_cast<int>(kStreamed / sizeof(T));
    if constexpr (kLanes % kPart == 0) {
        if (stream) {
            if constexpr (kLanes == kPart) {
                hn::Stream(numbers, dt, out);
            } else {
                HWY_ALIGN T values[kLanes];
                hn::Store(numbers, dt, values);
                const hn::CappedTag<T, kPart> part;
                constexpr int kAtOnce = static_cast<int>(hn::MaxLanes(part));
                for (int i = 0; i < kLanes; i += kAtOnce)
                    hn::Stream(hn::Load(part, values + i), part, out + i);
            }
            return;
        }
    }
    hn::StoreU(numbers, dt, out);
}

/// x, y and z of the points of a vector, point by point.
HWY_INLINE void PointByPoint(V (&p)[3]) {
#if HWY_TARGET == HWY_AVX2
    // As Highway stores them interleaved, but not to memory.
    const D d;
    const V xy = hn::InterleaveLower(d, p[0], p[1]), yz = hn::InterleaveUpper(d, p[1], p[2]),
            zx = hn::OddEven(p[0], p[2]);
    p[0] = hn::ConcatLowerLower(d, zx, xy);
    p[1] = hn::ConcatUpperLower(d, xy, yz);
    p[2] = hn::ConcatUpperUpper(d, yz, zx);
#else
    HWY_ALIGN double numbers[3 * kLanes];
    hn::StoreInterleaved3(p[0], p[1], p[2], D(), numbers);
    for (int c = 0; c < 3; ++c) p[c] = hn::Load(D(), numbers + c * kLanes);
#endif
}

/// out = base + (offset + sums * resolution) for `count` <= kGridBlock points of a row, without gaps. The
/// product is exact.
template <bool kInDouble, class T>
void WritePoints(const std::int64_t* sums, int count, double resolution, bool stream, const double* offset,
                 const T* base, T* out) {
    const D d;
    const DI di;
    const V unit = hn::Set(d, resolution), zero = hn::Zero(d);
    int i = 0;
    for (; i + kLanes <= count; i += kLanes) {
        V p[3];
        for (int c = 0; c < 3; ++c) {
            const VI sum = hn::LoadU(di, sums + c * kGridBlock + i);
            const V whole =
                kInDouble ? hn::Sub(WithRounder(sum), hn::Set(d, kRounder)) : hn::ConvertTo(d, sum);
            p[c] = hn::Mul(whole, unit);
        }
        PointByPoint(p);
        for (int c = 0; c < 3; ++c) {
            const int at = 3 * i + c * kLanes;
            const V more = offset ? LoadAsDoubles(offset + at) : zero;
            const V start = base ? LoadAsDoubles(base + at) : zero;
            StoreNumbers(hn::Add(hn::Add(p[c], more), start), stream, out + at);
        }
    }
    for (; i < count; ++i)
        for (int c = 0; c < 3; ++c) {
            const double start = base ? static_cast<double>(base[3 * i + c]) : 0;
            const double more = offset ? offset[3 * i + c] : 0;
            const double moved = static_cast<double>(sums[c * kGridBlock + i]) * resolution + more;
            out[3 * i + c] = static_cast<T>(moved + start);
        }
}

/// The terms of a pair of rows, sorted into the blocks of columns that they reach.
class TermsOfBlocks {
  public:
    explicit TermsOfBlocks(int columns)
        : m_begin(static_cast<std::size_t>((columns + kGridBlock - 1) / kGridBlock + 1)) {}

    void sort(const std::vector<const PairTerm*>& terms) {
        std::fill(m_begin.begin(), m_begin.end(), 0u);
        for (const PairTerm* const term : terms)
            for_blocks(*term, [&](std::size_t block) { ++m_begin[block]; });
        std::partial_sum(m_begin.begin(), m_begin.end(), m_begin.begin());
        m_terms.resize(m_begin.back());
        // From the last one on: what was where a block ends becomes where it begins.
        for (std::size_t k = terms.size(); k-- > 0;)
            for_blocks(*terms[k], [&](std::size_t block) { m_terms[--m_begin[block]] = terms[k]; });
    }
    std::span<const PairTerm* const> of(int column) const {
        const std::size_t* const begin = &m_begin[static_cast<std::size_t>(column / kGridBlock)];
        return std::span(m_terms).subspan(begin[0], begin[1] - begin[0]);
    }

  private:
    template <class Body>
    static void for_blocks(const PairTerm& term, const Body& body) {
        for (int column = term.column_begin; column < term.column_end; column += kGridBlock)
            body(static_cast<std::size_t>(column / kGridBlock));
    }

    std::vector<std::size_t> m_begin;  ///< of each block's terms, and the end
    std::vector<const PairTerm*> m_terms;
};

/// A block of columns of a pair of rows, and the terms that reach it.
struct BlockTerms {
    int row, column;
    std::span<const PairTerm*const> gaussians, others;

    bool empty() const { return gaussians.empty() && others.empty(); }
};

/// Adds terms to the sums of a block, and writes its points. fresh: the sums begin at 0.
template <bool kInDouble, class T>
void DrawBlock(const GridBand<T>& band, const BlockTerms& terms, bool fresh, std::int64_t* sums) {
    if (fresh && terms.empty()) std::memset(sums, 0, kBlockSums * sizeof(*sums));
    if (!terms.gaussians.empty()) AddToBlock<kInDouble, true>(terms.gaussians, terms.column, fresh, sums);
    if (!terms.others.empty())
        AddToBlock<kInDouble, false>(terms.others, terms.column, fresh && terms.gaussians.empty(), sums);
    if (!band.out) return;
    const int count = std::min(kGridBlock, band.columns - terms.column);
    for (int r = 0; r < kGridRows && terms.row + r < band.row_end; ++r) {
        const std::ptrdiff_t at = 3 * (std::ptrdiff_t{terms.row + r} * band.columns + terms.column);
        T* const out = band.out + at;
        const bool stream = band.stream && reinterpret_cast<std::uintptr_t>(out) % kStreamed == 0;
        WritePoints<kInDouble>(sums + 3 * r * kGridBlock, count, band.resolution, stream,
                               band.offset ? band.offset + at : nullptr, band.base ? band.base + at : nullptr,
                               out);
    }
}

template <class T>
void DeformBand(const GridBand<T>& band) {
    HWY_ALIGN std::int64_t room[kBlockSums];
    std::vector<PairTerm> on_rows(band.count);
    std::vector<const PairTerm*> now[2], sorted[2];  // Gaussians and others
    TermsOfBlocks gaussians(band.columns), others(band.columns);
    for (int row = band.row_begin; row < band.row_end; row += kGridRows) {
        for (auto& terms : now) terms.clear();
        for (std::size_t k = 0; k < band.count; ++k) {
            if (row < band.terms[k].row_begin || band.terms[k].row_end <= row) continue;
            on_rows[k] = OnRows(band.terms[k], row);
            now[on_rows[k].gaussian ? 0 : 1].push_back(&on_rows[k]);
        }
        if (now[0].empty() && now[1].empty() && !band.all) continue;
        // Next rows have mostly the same ones.
        if (now[0] != sorted[0]) gaussians.sort(sorted[0] = now[0]);
        if (now[1] != sorted[1]) others.sort(sorted[1] = now[1]);
        for (int column = 0; column < band.columns; column += kGridBlock) {
            const BlockTerms terms{row, column, gaussians.of(column), others.of(column)};
            if (terms.empty() && !band.all) continue;
            if (!band.sums) {
                (band.in_double ? DrawBlock<true, T> : DrawBlock<false, T>)(band, terms, true, room);
                continue;
            }
            std::int64_t* const sums =
                band.sums + grid_sums(row, band.columns) + 3 * kGridRows * std::ptrdiff_t{column};
            const bool in_double = band.in_double && AreInDouble(sums, kBlockSums);
            (in_double ? DrawBlock<true, T> : DrawBlock<false, T>)(band, terms, false, sums);
        }
    }
    if (band.stream) hwy::FlushStream();
}
void DeformBandFloat(const GridBand<float>& band) {
    DeformBand(band);
}
void DeformBandDouble(const GridBand<double>& band) {
    DeformBand(band);
}

/// A deformation at the points of a vector.
struct AtPoints {
    AxisKernel across, down;
    L x, y;
    L::M inside;

    HWY_INLINE AtPoints(const PointTerm& term, const L& u, const L& v)
        : across{term.center[0], term.inverse_extent[0], term.reach, term.gaussian},
          down{term.center[1], term.inverse_extent[1], term.reach, term.gaussian},
          x(DistanceOf(across, u)),
          y(DistanceOf(down, v)),
          inside{hn::And(hn::Le(abs(x).v, hn::Set(D(), term.reach)),
                         hn::Le(abs(y).v, hn::Set(D(), term.reach)))} {}
};

/// Adds V dF/du and V dF/dv of a term with these factors.
HWY_INLINE void AddSlopes(const Slope& across, const Slope& down, bool gaussian, const double (&vector)[3],
                          L* sum) {
    L by_u, by_v;
    if (gaussian) {
        by_u = across.by * down.value;
        by_v = across.value * down.by;
    } else {
        const L f = wendland_of(Slope(across.value + down.value, L(1.0))).by;
        by_u = f * across.by;
        by_v = f * down.by;
    }
    for (int c = 0; c < 3; ++c) {
        sum[c] = sum[c] + L(vector[c]) * by_u;
        sum[c + 3] = sum[c + 3] + L(vector[c]) * by_v;
    }
}

void AddRowSlopes(const RowTerm* terms, std::size_t term_count, std::size_t count, double* const* sums) {
    for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(kLanes)) {
        L sum[6];
        for (int c = 0; c < 6; ++c) sum[c] = L::load(sums[c] + i);
        for (std::size_t k = 0; k < term_count; ++k) {
            const RowTerm& term = terms[k];
            AddSlopes(Slope(L::load(term.column + i), L::load(term.column_slope + i)),
                      Slope(L(term.row), L(term.row_slope)), term.gaussian, term.vector, sum);
        }
        for (int c = 0; c < 6; ++c) sum[c].store(sums[c] + i);
    }
}

HWY_INLINE const L& ValueOf(const L& a) {
    return a;
}
HWY_INLINE const L& ValueOf(const Slope& a) {
    return a.value;
}

/// A bump with depth or side at the points of a vector: its three ways, each in extents, and what each way's kernel is.
struct DeepWays {
    AxisKernel kernel[3];
    L x[3];
    L::M inside;

    HWY_INLINE DeepWays(const PointTerm& term, const TermPoints& points, std::size_t i)
        : kernel{{term.center[0], term.inverse_extent[0], term.reach, term.gaussian},
                 {term.center[1], term.inverse_extent[1], term.reach, term.gaussian},
                 {term.center_w, term.inverse_extent_w, term.reach, term.gaussian}} {
        const L u = L::load(points.u + i), v = L::load(points.v + i);
        if (term.has_frame) {
            const L from[3] = {u - L(term.center[0]), v - L(term.center[1]),
                               L::load(points.w + i) - L(term.center_w)};
            for (int k = 0; k < 3; ++k)
                x[k] = (from[0] * L(term.turn[0][k]) + from[1] * L(term.turn[1][k]) +
                        from[2] * L(term.turn[2][k])) *
                       L(kernel[k].inverse_extent);
        } else {
            x[0] = DistanceOf(kernel[0], u);
            x[1] = DistanceOf(kernel[1], v);
            x[2] = term.has_depth ? DistanceOf(kernel[2], L::load(points.w + i)) : L(0.0);
        }
        inside = {hn::And(hn::Le(abs(x[0]).v, hn::Set(D(), term.reach)),
                          hn::Le(abs(x[1]).v, hn::Set(D(), term.reach)))};
        if (term.has_depth) inside = both(inside, L::M{hn::Le(abs(x[2]).v, hn::Set(D(), term.reach))});
    }
};

/// Adds V dF/dx of a term with depth or side; x: u, v, w and the normal's coordinates. f: F by three ways; share: S and its slope.
HWY_INLINE void AddDeepSlopes(const PointTerm& term, const Slope (&ways)[3], const Slope& share,
                              L (&sum)[kDeepSlopes]) {
    const auto& [across, down, deep] = ways;
    L by[6], value;
    if (term.gaussian) {
        value = across.value * down.value * deep.value;
        by[0] = across.by * down.value * deep.value;
        by[1] = across.value * down.by * deep.value;
        by[2] = across.value * down.value * deep.by;
    } else {
        const Slope f = wendland_of(Slope(across.value + down.value + deep.value, L(1.0)));
        value = f.value;
        for (int k = 0; k < 3; ++k) by[k] = f.by * ways[k].by;
    }
    if (term.has_frame) {
        const L own[3] = {by[0], by[1], by[2]};
        for (int j = 0; j < 3; ++j)
            by[j] = own[0] * L(term.turn[j][0]) + own[1] * L(term.turn[j][1]) + own[2] * L(term.turn[j][2]);
    }
    for (int k = 0; k < 3; ++k) by[k] = by[k] * share.value;
    for (int k = 0; k < 3; ++k) by[3 + k] = value * share.by * L(term.direction[k]);
    for (int k = 0; k < 6; ++k)
        for (int c = 0; c < 3; ++c) sum[3 * k + c] = sum[3 * k + c] + L(term.vector[c]) * by[k];
}

/// Adds a term with depth or side at the points of a vector.
template <bool kSums, bool kSlopes, class Sum>
HWY_INLINE void AddDeepTerm(const PointTerm& term, const TermPoints& points, std::size_t i, Sum (&sum)[3],
                            L (&slope)[kDeepSlopes]) {
    const DeepWays at(term, points, i);
    const L::M inside = at.inside;
    if (hn::AllFalse(D(), inside.m)) return;
    Slope share(1.0);
    if (term.has_side) {
        L facing(0.0);
        for (int c = 0; c < 3; ++c) facing = facing + L::load(points.normal[c] + i) * L(term.direction[c]);
        share = side_share(Slope(facing, L(1.0)));
    }
    // What is not inside gets nothing, neither a displacement nor a slope.
    share = ZeroUnless(inside, share);
    const Slope ways[3] = {
        FactorOf<Slope>(at.kernel[0], at.x[0]), FactorOf<Slope>(at.kernel[1], at.x[1]),
        term.has_depth ? FactorOf<Slope>(at.kernel[2], at.x[2]) : Slope(term.gaussian ? 1.0 : 0.0)};
    if constexpr (kSums) {
        const L f = term.gaussian ? ways[0].value * ways[1].value * ways[2].value
                                  : wendland_of(ways[0].value + ways[1].value + ways[2].value);
        const V whole = ShareOf(ZeroUnless(inside, f * share.value).v);
        for (int c = 0; c < 3; ++c) sum[c].add(hn::Set(D(), term.units[c]), whole);
    }
    if constexpr (kSlopes) AddDeepSlopes(term, ways, share, slope);
}

/// Adds terms at points to displacements, to slopes, or to both. kDeep: points have depths and normals. kInDouble: WholeSum's.
template <bool kSums, bool kSlopes, bool kDeep, bool kInDouble>
HWY_INLINE void AddAtPoints(const PointTerm* const* terms, std::size_t term_count, const TermPoints& points,
                            std::size_t count, std::int64_t* const* sums, double* const* slopes) {
    using Factor = std::conditional_t<kSlopes, Slope, L>;
    constexpr int kSlopeCount = kDeep ? kDeepSlopes : kPlainSlopes;
    const D d;
    for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(kLanes)) {
        const L pu = L::load(points.u + i), pv = L::load(points.v + i);
        WholeSum<kInDouble> sum[3];
        L slope[kSlopeCount];
        if constexpr (kSums)
            for (int c = 0; c < 3; ++c) sum[c].load(sums[c] + i);
        if constexpr (kSlopes)
            for (int c = 0; c < kSlopeCount; ++c) slope[c] = L::load(slopes[c] + i);
        for (std::size_t k = 0; k < term_count; ++k) {
            const PointTerm& term = *terms[k];
            if constexpr (kDeep)
                if (term.has_depth || term.has_side) {
                    AddDeepTerm<kSums, kSlopes>(term, points, i, sum, slope);
                    continue;
                }
            const AtPoints at(term, pu, pv);
            if (hn::AllFalse(d, at.inside.m)) continue;
            Factor across = FactorOf<Factor>(at.across, at.x);
            const Factor down = FactorOf<Factor>(at.down, at.y);
            if (term.gaussian) across = ZeroUnless(at.inside, across);
            if constexpr (kSums) {
                // Products as on grids, so that a point gets the same bits there and here.
                const L f = term.gaussian
                                ? ValueOf(across)
                                : ZeroUnless(at.inside, wendland_of(ValueOf(across) + ValueOf(down)));
                const L weight = term.gaussian ? ZeroUnless(at.inside, ValueOf(down)) : L(1.0);
                const V share = ShareOf(f.v);
                for (int c = 0; c < 3; ++c) sum[c].add((L(term.units[c]) * weight).v, share);
            }
            if constexpr (kSlopes) AddSlopes(across, down, term.gaussian, term.vector, slope);
        }
        if constexpr (kSums)
            for (int c = 0; c < 3; ++c) sum[c].store(sums[c] + i);
        if constexpr (kSlopes)
            for (int c = 0; c < kSlopeCount; ++c) slope[c].store(slopes[c] + i);
    }
}
bool AreInDouble(const std::int64_t* const (&sums)[3], std::size_t count) {
    for (const std::int64_t* const of : sums)
        if (!AreInDouble(of, count)) return false;
    return true;
}
template <bool kSums, bool kSlopes, bool kInDouble>
void AddTerms(const PointTerm* const* terms, std::size_t term_count, const TermPoints& points,
              std::size_t count, std::int64_t* const* sums, double* const* slopes) {
    if (points.w)
        AddAtPoints<kSums, kSlopes, true, kInDouble>(terms, term_count, points, count, sums, slopes);
    else
        AddAtPoints<kSums, kSlopes, false, kInDouble>(terms, term_count, points, count, sums, slopes);
}
void DeformPoints(const PointTerm* const* terms, std::size_t term_count, const TermPoints& points,
                  std::size_t count, std::int64_t* const* sums, bool in_double) {
    const bool holds = in_double && AreInDouble({sums[0], sums[1], sums[2]}, count);
    (holds ? AddTerms<true, false, true> : AddTerms<true, false, false>)(terms, term_count, points, count,
                                                                         sums, nullptr);
}
void AddPointSlopes(const PointTerm* const* terms, std::size_t term_count, const TermPoints& points,
                    std::size_t count, double* const* slopes) {
    AddTerms<false, true, true>(terms, term_count, points, count, nullptr, slopes);
}
void DeformPointsWithSlopes(const PointTerm* const* terms, std::size_t term_count, const TermPoints& points,
                            std::size_t count, std::int64_t* const* sums, double* const* slopes,
                            bool in_double) {
    const bool holds = in_double && AreInDouble({sums[0], sums[1], sums[2]}, count);
    (holds ? AddTerms<true, true, true> : AddTerms<true, true, false>)(terms, term_count, points, count, sums,
                                                                       slopes);
}

/// The vector of length 1 in the same direction; 0 where the length is 0 or not finite.
HWY_INLINE Triple<L> UnitOf(const Triple<L>& a) {
    const L length = sqrt(dot_product(a, a)), inverse = L(1.0) / length;
    const L::M good = both(L(0.0) < length, length < L(HUGE_VAL));
    return {ZeroUnless(good, a.x * inverse), ZeroUnless(good, a.y * inverse),
            ZeroUnless(good, a.z * inverse)};
}

void TurnNormals(const double* const* slopes, bool by_depth, const double (&gradients)[3][3],
                 std::size_t count, double* const* normals) {
    const auto gradient = [&](int i) HWY_ATTR {
        return Triple<L>{gradients[i][0], gradients[i][1], gradients[i][2]};
    };
    const Triple<L> g = gradient(0), h = gradient(1), k = gradient(2), gh = cross_product(g, h);
    for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(kLanes)) {
        const auto loaded = [i](const double* const* from) HWY_ATTR {
            return Triple<L>{L::load(from[0] + i), L::load(from[1] + i), L::load(from[2] + i)};
        };
        const Triple<L> n = UnitOf(loaded(normals));
        Triple<L> longer = turned_normal(n, loaded(slopes), loaded(slopes + 3), g, h, gh);
        if (by_depth) {
            const Triple<L> more =
                turned_further(n, loaded(slopes), loaded(slopes + 3), loaded(slopes + 6), g, h, k);
            longer = {longer.x + more.x, longer.y + more.y, longer.z + more.z};
        }
        const Triple<L> turned = UnitOf(longer);
        turned.x.store(normals[0] + i);
        turned.y.store(normals[1] + i);
        turned.z.store(normals[2] + i);
    }
}

void CornerNormals(const CornerEdges& corners, double unit, std::size_t count, double* const* out) {
    const L inverse(1 / unit);
    for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(kLanes)) {
        const auto edge = [&](const double* const(&undeformed)[3], const double* const(&by)[6]) HWY_ATTR {
            const auto moved = [&](int c) HWY_ATTR {
                L sum = L::load(undeformed[c] + i);
                for (int k = 0; k < corners.parameters; ++k)
                    sum = sum + L::load(by[k] + i) * L::load(corners.by[3 * k + c] + i);
                return sum;
            };
            return UnitOf({moved(0), moved(1), moved(2)});
        };
        L angle;
        const Triple<L> normal = corner_normal(edge(corners.next, corners.next_by),
                                               edge(corners.previous, corners.previous_by), angle);
        const L weight = (angle - L::load(corners.turns + i)) * inverse;
        L(hn::Round((normal.x * weight).v)).store(out[0] + i);
        L(hn::Round((normal.y * weight).v)).store(out[1] + i);
        L(hn::Round((normal.z * weight).v)).store(out[2] + i);
    }
}

template <class T>
void Blend(const T* const* shapes, const double* weights, std::size_t shape_count, std::size_t count,
           T* out) {
    const D d;
    const hn::Rebind<T, D> dt;
    constexpr std::size_t kUnrolled = 4, kLane = static_cast<std::size_t>(kLanes);
    std::size_t i = 0;
    for (; i + kUnrolled * kLane <= count; i += kUnrolled * kLane) {
        V a = hn::Zero(d), b = a, c = a, e = a;
        for (std::size_t k = 0; k < shape_count; ++k) {
            const V w = hn::Set(d, weights[k]);
            a = hn::Add(hn::Mul(w, LoadAsDoubles(shapes[k] + i)), a);
            b = hn::Add(hn::Mul(w, LoadAsDoubles(shapes[k] + i + kLane)), b);
            c = hn::Add(hn::Mul(w, LoadAsDoubles(shapes[k] + i + 2 * kLane)), c);
            e = hn::Add(hn::Mul(w, LoadAsDoubles(shapes[k] + i + 3 * kLane)), e);
        }
        hn::StoreU(StoreAs(out, a), dt, out + i);
        hn::StoreU(StoreAs(out, b), dt, out + i + kLane);
        hn::StoreU(StoreAs(out, c), dt, out + i + 2 * kLane);
        hn::StoreU(StoreAs(out, e), dt, out + i + 3 * kLane);
    }
    const hn::CappedTag<double, 1> one;
    for (; i < count; ++i) {
        auto sum = hn::Zero(one);
        for (std::size_t k = 0; k < shape_count; ++k)
            sum = hn::Add(hn::Mul(hn::Set(one, weights[k]), hn::Set(one, static_cast<double>(shapes[k][i]))),
                          sum);
        out[i] = static_cast<T>(hn::GetLane(sum));
    }
}
void BlendFloat(const float* const* shapes, const double* weights, std::size_t shape_count, std::size_t count,
                float* out) {
    Blend(shapes, weights, shape_count, count, out);
}
void BlendDouble(const double* const* shapes, const double* weights, std::size_t shape_count,
                 std::size_t count, double* out) {
    Blend(shapes, weights, shape_count, count, out);
}

template <class T>
void BlendMasked(const T* const* shapes, const float* const* masks, const double* weights,
                 std::size_t shape_count, const T* base, std::size_t count, T* out) {
    const auto sum_at = [&](auto d, std::size_t i, auto&& load) HWY_ATTR {
        const auto start = load(d, base, i);
        auto sum = start;
        for (std::size_t k = 0; k < shape_count; ++k) {
            auto w = hn::Set(d, weights[k]);
            if (masks[k]) w = hn::Mul(w, load(d, masks[k], i));
            sum = hn::Add(hn::Mul(w, hn::Sub(load(d, shapes[k], i), start)), sum);
        }
        return sum;
    };
    std::size_t i = 0;
    for (; i + static_cast<std::size_t>(kLanes) <= count; i += static_cast<std::size_t>(kLanes)) {
        const V sum =
            sum_at(D(), i, [](D, const auto* p, std::size_t at) HWY_ATTR { return LoadAsDoubles(p + at); });
        hn::StoreU(StoreAs(out, sum), hn::Rebind<T, D>(), out + i);
    }
    for (; i < count; ++i) {
        const hn::CappedTag<double, 1> one;
        out[i] =
            static_cast<T>(hn::GetLane(sum_at(one, i, [](auto d, const auto* p, std::size_t at) HWY_ATTR {
                return hn::Set(d, static_cast<double>(p[at]));
            })));
    }
}
void BlendMaskedFloat(const float* const* shapes, const float* const* masks, const double* weights,
                      std::size_t shape_count, const float* base, std::size_t count, float* out) {
    BlendMasked(shapes, masks, weights, shape_count, base, count, out);
}
void BlendMaskedDouble(const double* const* shapes, const float* const* masks, const double* weights,
                       std::size_t shape_count, const double* base, std::size_t count, double* out) {
    BlendMasked(shapes, masks, weights, shape_count, base, count, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(AxisFactors);
HWY_EXPORT(AddRowSlopes);
HWY_EXPORT(AddPointSlopes);
HWY_EXPORT(TurnNormals);
HWY_EXPORT(CornerNormals);
HWY_EXPORT(DeformBandFloat);
HWY_EXPORT(DeformBandDouble);
HWY_EXPORT(DeformPoints);
HWY_EXPORT(DeformPointsWithSlopes);
HWY_EXPORT(BlendFloat);
HWY_EXPORT(BlendDouble);
HWY_EXPORT(BlendMaskedFloat);
HWY_EXPORT(BlendMaskedDouble);

void axis_factors(const AxisKernel& kernel, const double* x, int count, double* out, double* slope) {
    HWY_DYNAMIC_DISPATCH(AxisFactors)(kernel, x, count, out, slope);
}
void add_row_slopes(const RowTerm* terms, std::size_t term_count, std::size_t count, double* const sums[6]) {
    HWY_DYNAMIC_DISPATCH(AddRowSlopes)(terms, term_count, count, sums);
}
void add_point_slopes(const PointTerm* const* terms, std::size_t term_count, const TermPoints& points,
                      std::size_t count, double* const* slopes) {
    HWY_DYNAMIC_DISPATCH(AddPointSlopes)(terms, term_count, points, count, slopes);
}
void turn_normals(const double* const* slopes, bool by_depth, const double (&gradients)[3][3],
                  std::size_t count, double* const normals[3]) {
    HWY_DYNAMIC_DISPATCH(TurnNormals)(slopes, by_depth, gradients, count, normals);
}
void corner_normals(const CornerEdges& corners, double unit, std::size_t count, double* const out[3]) {
    HWY_DYNAMIC_DISPATCH(CornerNormals)(corners, unit, count, out);
}
void deform_band(const GridBand<float>& band) {
    HWY_DYNAMIC_DISPATCH(DeformBandFloat)(band);
}
void deform_band(const GridBand<double>& band) {
    HWY_DYNAMIC_DISPATCH(DeformBandDouble)(band);
}
void deform_points(const PointTerm* const* terms, std::size_t term_count, const TermPoints& points,
                   std::size_t count, std::int64_t* const sums[3], bool in_double) {
    HWY_DYNAMIC_DISPATCH(DeformPoints)(terms, term_count, points, count, sums, in_double);
}
void deform_points_with_slopes(const PointTerm* const* terms, std::size_t term_count,
                               const TermPoints& points, std::size_t count, std::int64_t* const sums[3],
                               double* const* slopes, bool in_double) {
    HWY_DYNAMIC_DISPATCH(DeformPointsWithSlopes)(terms, term_count, points, count, sums, slopes, in_double);
}
void blend(const float* const* shapes, const double* weights, std::size_t shape_count, std::size_t count,
           float* out) {
    HWY_DYNAMIC_DISPATCH(BlendFloat)(shapes, weights, shape_count, count, out);
}
void blend(const double* const* shapes, const double* weights, std::size_t shape_count, std::size_t count,
           double* out) {
    HWY_DYNAMIC_DISPATCH(BlendDouble)(shapes, weights, shape_count, count, out);
}
void blend_masked(const float* const* shapes, const float* const* masks, const double* weights,
                  std::size_t shape_count, const float* base, std::size_t count, float* out) {
    HWY_DYNAMIC_DISPATCH(BlendMaskedFloat)(shapes, masks, weights, shape_count, base, count, out);
}
void blend_masked(const double* const* shapes, const float* const* masks, const double* weights,
                  std::size_t shape_count, const double* base, std::size_t count, double* out) {
    HWY_DYNAMIC_DISPATCH(BlendMaskedDouble)(shapes, masks, weights, shape_count, base, count, out);
}

}  // namespace anamorph::simd
#endif
