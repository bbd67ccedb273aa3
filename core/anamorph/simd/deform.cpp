// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/simd/deform.cpp"
#include "anamorph/simd/deform.h"

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <vector>

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

// After foreach_target.h: compiled once for every instruction set.
#include "hwy/contrib/math/math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, kPointBlock>;
using DI = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using VI = hn::Vec<DI>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));

/// A number in [-2^51, 2^51] plus this has the rounded number in its last bits.
constexpr double kRounder = 0x1.8p52;
constexpr std::int64_t kRounderBits = 0x4338000000000000;

/// sum + round(a b), and kRounderBits too many.
HWY_INLINE VI AddRounded(VI sum, V a, V b) {
    return hn::Add(sum, hn::BitCast(DI(), hn::MulAdd(a, b, hn::Set(D(), kRounder))));
}
/// Takes away what `times` calls of AddRounded added too many, modulo 2^64.
HWY_INLINE VI WithoutRounders(VI sum, std::size_t times) {
    const auto bits = static_cast<std::uint64_t>(kRounderBits) * static_cast<std::uint64_t>(times);
    return hn::Sub(sum, hn::Set(DI(), static_cast<std::int64_t>(bits)));
}

HWY_INLINE V GaussianOf(V squared) {
    // Beyond 800 the value is 0 in double; infinities stay out of the exponential.
    return hn::Exp(D(), hn::Neg(hn::Min(squared, hn::Set(D(), 800.0))));
}
/// (1 - r)^4 (4 r + 1), 0 from r = 1 on.
HWY_INLINE V WendlandOf(V squared) {
    const D d;
    const V r = hn::Sqrt(squared), rest = hn::Max(hn::Sub(hn::Set(d, 1.0), r), hn::Zero(d));
    const V rest2 = hn::Mul(rest, rest);
    return hn::Mul(hn::Mul(rest2, rest2), hn::MulAdd(hn::Set(d, 4.0), r, hn::Set(d, 1.0)));
}

/// out[i] = f(t[i]), t = (x - center) inverse_extent, with full vectors only.
template <class F>
HWY_INLINE void EachDistance(const double* x, int count, double center, double inverse_extent, double* out,
                             const F& f) {
    const D d;
    const V c = hn::Set(d, center), a = hn::Set(d, inverse_extent);
    int i = 0;
    for (; i + kLanes <= count; i += kLanes)
        hn::StoreU(f(hn::Mul(hn::Sub(hn::LoadU(d, x + i), c), a)), d, out + i);
    if (i >= count) return;
    HWY_ALIGN double last[kLanes] = {};
    std::copy(x + i, x + count, last);
    hn::Store(f(hn::Mul(hn::Sub(hn::Load(d, last), c), a)), d, last);
    std::copy(last, last + (count - i), out + i);
}

void GaussianFactors(const double* x, int count, double center, double inverse_extent, double reach,
                     double* out) {
    EachDistance(x, count, center, inverse_extent, out, [reach](V t) HWY_ATTR {
        const auto inside = hn::Le(hn::Abs(t), hn::Set(D(), reach));
        return hn::IfThenElseZero(inside, GaussianOf(hn::Mul(t, t)));
    });
}

void SquaredDistances(const double* x, int count, double center, double inverse_extent, double* out) {
    EachDistance(x, count, center, inverse_extent, out,
                 [](V t) HWY_ATTR { return hn::Min(hn::Mul(t, t), hn::Set(D(), 2.0)); });
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

// Sums that stay in registers: two rows, three components, and as many vectors as there is room for.
constexpr int kAcross = HWY_TARGET <= HWY_AVX3 ? 4 : 1;
constexpr int kStep = std::min(kAcross * kLanes, kGridBlock);
constexpr int kVectors = kStep / kLanes;

constexpr int kBlockSums = 3 * kGridRows * kGridBlock;

/// Adds terms to a block of kGridBlock columns from `column` on; sums as in grid_sums().
void AddToBlock(const PairTerm* const* terms, std::size_t count, int column, std::int64_t* sums) {
    const D d;
    const DI di;
    for (int at = 0; at < kGridBlock; at += kStep) {
        VI sum[kGridRows][3][kVectors];
        const auto place = [&](int r, int c, int v) {
            return sums + (3 * r + c) * kGridBlock + at + v * kLanes;
        };
        for (int r = 0; r < kGridRows; ++r)
            for (int c = 0; c < 3; ++c)
                for (int v = 0; v < kVectors; ++v)
                    sum[r][c][v] = WithoutRounders(hn::LoadU(di, place(r, c, v)), count);
        for (std::size_t k = 0; k < count; ++k) {
            const PairTerm& term = *terms[k];
            const double* from = term.column + (column - term.column_begin) + at;
            for (int v = 0; v < kVectors; ++v) {
                const V across = hn::LoadU(d, from + v * kLanes);
                for (int r = 0; r < kGridRows; ++r) {
                    const V f = term.gaussian ? across : WendlandOf(hn::Add(across, hn::Set(d, term.row[r])));
                    for (int c = 0; c < 3; ++c)
                        sum[r][c][v] = AddRounded(sum[r][c][v], hn::Set(d, term.weight[r][c]), f);
                }
            }
        }
        for (int r = 0; r < kGridRows; ++r)
            for (int c = 0; c < 3; ++c)
                for (int v = 0; v < kVectors; ++v) hn::StoreU(sum[r][c][v], di, place(r, c, v));
    }
}

HWY_INLINE V LoadDoubles(const float*, hn::Vec<hn::Rebind<float, D>> v) {
    return hn::PromoteTo(D(), v);
}
HWY_INLINE V LoadDoubles(const double*, V v) {
    return v;
}
HWY_INLINE hn::Vec<hn::Rebind<float, D>> StoreAs(const float*, V v) {
    return hn::DemoteTo(hn::Rebind<float, D>(), v);
}
HWY_INLINE V StoreAs(const double*, V v) {
    return v;
}

/// out = base + sums * resolution for `count` <= kGridBlock points of a row, without gaps. The product is
/// exact.
template <class T>
void WritePoints(const std::int64_t* sums, int count, double resolution, const T* base, T* out) {
    const D d;
    const DI di;
    const hn::Rebind<T, D> dt;
    const V unit = hn::Set(d, resolution);
    int i = 0;
    for (; i + kLanes <= count; i += kLanes) {
        V p[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        if (base) {
            hn::Vec<decltype(dt)> x, y, z;
            hn::LoadInterleaved3(dt, base + 3 * i, x, y, z);
            p[0] = LoadDoubles(base, x);
            p[1] = LoadDoubles(base, y);
            p[2] = LoadDoubles(base, z);
        }
        for (int c = 0; c < 3; ++c)
            p[c] = hn::MulAdd(hn::ConvertTo(d, hn::LoadU(di, sums + c * kGridBlock + i)), unit, p[c]);
        hn::StoreInterleaved3(StoreAs(out, p[0]), StoreAs(out, p[1]), StoreAs(out, p[2]), dt, out + 3 * i);
    }
    for (; i < count; ++i)
        for (int c = 0; c < 3; ++c) {
            const double start = base ? static_cast<double>(base[3 * i + c]) : 0;
            out[3 * i + c] =
                static_cast<T>(static_cast<double>(sums[c * kGridBlock + i]) * resolution + start);
        }
}

template <class T>
void DeformBand(const GridBand<T>& band) {
    HWY_ALIGN std::int64_t room[kBlockSums];
    std::vector<PairTerm> on_rows;
    std::vector<const PairTerm*> on_block;
    for (int row = band.row_begin; row < band.row_end; row += kGridRows) {
        on_rows.clear();
        for (std::size_t k = 0; k < band.count; ++k)
            if (band.terms[k].row_begin <= row && row < band.terms[k].row_end)
                on_rows.push_back(OnRows(band.terms[k], row));
        if (on_rows.empty() && !band.all) continue;
        for (int column = 0; column < band.columns; column += kGridBlock) {
            on_block.clear();
            for (const PairTerm& term : on_rows)
                if (term.column_begin <= column && column < term.column_end) on_block.push_back(&term);
            if (on_block.empty() && !band.all) continue;
            std::int64_t* sums = room;
            if (band.sums)
                sums = band.sums + grid_sums(row, band.columns) + 3 * kGridRows * std::ptrdiff_t{column};
            else
                std::memset(room, 0, sizeof(room));
            if (!on_block.empty()) AddToBlock(on_block.data(), on_block.size(), column, sums);
            if (!band.out) continue;
            const int count = std::min(kGridBlock, band.columns - column);
            for (int r = 0; r < kGridRows && row + r < band.row_end; ++r) {
                const std::ptrdiff_t first = 3 * (std::ptrdiff_t{row + r} * band.columns + column);
                WritePoints(sums + 3 * r * kGridBlock, count, band.resolution,
                            band.base ? band.base + first : nullptr, band.out + first);
            }
        }
    }
}
void DeformBandFloat(const GridBand<float>& band) {
    DeformBand(band);
}
void DeformBandDouble(const GridBand<double>& band) {
    DeformBand(band);
}

void DeformPoints(const PointTerm* const* terms, std::size_t term_count, const double* u, const double* v,
                  std::size_t count, std::int64_t* const* sums) {
    const D d;
    const DI di;
    for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(kLanes)) {
        const V pu = hn::LoadU(d, u + i), pv = hn::LoadU(d, v + i);
        VI sum[3];
        for (int c = 0; c < 3; ++c) sum[c] = hn::LoadU(di, sums[c] + i);
        for (std::size_t k = 0; k < term_count; ++k) {
            const PointTerm& term = *terms[k];
            const V x = hn::Mul(hn::Sub(pu, hn::Set(d, term.center[0])), hn::Set(d, term.inverse_extent[0]));
            const V y = hn::Mul(hn::Sub(pv, hn::Set(d, term.center[1])), hn::Set(d, term.inverse_extent[1]));
            const V reach = hn::Set(d, term.reach);
            const auto inside = hn::And(hn::Le(hn::Abs(x), reach), hn::Le(hn::Abs(y), reach));
            if (hn::AllFalse(d, inside)) continue;
            // Factors and products as on grids, so that a point gets the same bits there and here.
            const V across2 = hn::Mul(x, x), down2 = hn::Mul(y, y);
            const V across = term.gaussian ? GaussianOf(across2) : WendlandOf(hn::Add(across2, down2));
            const V f = hn::IfThenElseZero(inside, across);
            const V down = hn::IfThenElseZero(inside, term.gaussian ? GaussianOf(down2) : hn::Set(d, 1.0));
            for (int c = 0; c < 3; ++c)
                sum[c] = WithoutRounders(AddRounded(sum[c], hn::Mul(hn::Set(d, term.units[c]), down), f), 1);
        }
        for (int c = 0; c < 3; ++c) hn::StoreU(sum[c], di, sums[c] + i);
    }
}

/// Values i, i + 1, ... of `from` as doubles.
HWY_INLINE V At(const float* from, std::size_t i) {
    return hn::PromoteTo(D(), hn::LoadU(hn::Rebind<float, D>(), from + i));
}
HWY_INLINE V At(const double* from, std::size_t i) {
    return hn::LoadU(D(), from + i);
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
            a = hn::MulAdd(w, At(shapes[k], i), a);
            b = hn::MulAdd(w, At(shapes[k], i + kLane), b);
            c = hn::MulAdd(w, At(shapes[k], i + 2 * kLane), c);
            e = hn::MulAdd(w, At(shapes[k], i + 3 * kLane), e);
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
            sum = hn::MulAdd(hn::Set(one, weights[k]), hn::Set(one, static_cast<double>(shapes[k][i])), sum);
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
            sum = hn::MulAdd(w, hn::Sub(load(d, shapes[k], i), start), sum);
        }
        return sum;
    };
    std::size_t i = 0;
    for (; i + static_cast<std::size_t>(kLanes) <= count; i += static_cast<std::size_t>(kLanes)) {
        const V sum = sum_at(D(), i, [](D, const auto* p, std::size_t at) HWY_ATTR { return At(p, at); });
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

HWY_EXPORT(GaussianFactors);
HWY_EXPORT(SquaredDistances);
HWY_EXPORT(DeformBandFloat);
HWY_EXPORT(DeformBandDouble);
HWY_EXPORT(DeformPoints);
HWY_EXPORT(BlendFloat);
HWY_EXPORT(BlendDouble);
HWY_EXPORT(BlendMaskedFloat);
HWY_EXPORT(BlendMaskedDouble);

void gaussian_factors(const double* x, int count, double center, double inverse_extent, double reach,
                      double* out) {
    HWY_DYNAMIC_DISPATCH(GaussianFactors)(x, count, center, inverse_extent, reach, out);
}
void squared_distances(const double* x, int count, double center, double inverse_extent, double* out) {
    HWY_DYNAMIC_DISPATCH(SquaredDistances)(x, count, center, inverse_extent, out);
}
void deform_band(const GridBand<float>& band) {
    HWY_DYNAMIC_DISPATCH(DeformBandFloat)(band);
}
void deform_band(const GridBand<double>& band) {
    HWY_DYNAMIC_DISPATCH(DeformBandDouble)(band);
}
void deform_points(const PointTerm* const* terms, std::size_t term_count, const double* u, const double* v,
                   std::size_t count, std::int64_t* const sums[3]) {
    HWY_DYNAMIC_DISPATCH(DeformPoints)(terms, term_count, u, v, count, sums);
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
