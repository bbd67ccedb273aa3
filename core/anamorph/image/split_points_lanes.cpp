// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/image/split_points_lanes.cpp"
#include "anamorph/image/split_points.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void SplitPoints(const double* HWY_RESTRICT points, int count, double scale, std::int32_t base,
                 std::int32_t* HWY_RESTRICT texels, float* HWY_RESTRICT rests) {
    const hn::CappedTag<double, 16> d;
    const hn::Rebind<float, decltype(d)> df;
    const hn::Rebind<std::int32_t, decltype(d)> di;
    const auto to_level = hn::Set(d, scale);
    const auto origin = hn::Set(di, base);
    const auto most = hn::Set(df, 0x1.fffffep-1f);
    for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(d))) {
        const auto at = hn::Mul(hn::LoadU(d, points + i), to_level);
        const auto whole = hn::Floor(at);
        hn::StoreU(hn::Sub(hn::DemoteTo(di, whole), origin), di, texels + i);
        hn::StoreU(hn::Min(hn::DemoteTo(df, hn::Sub(at, whole)), most), df, rests + i);
    }
}

/// The ends of some values at once: lane by lane, and a number that is NaN where one is not finite (minima
/// may lose a NaN).
template <class D>
struct LaneEnds {
    hn::Vec<D> least, greatest, nothing;

    HWY_INLINE explicit LaneEnds(hn::Vec<D> v) : least(v), greatest(v), nothing(hn::Sub(v, v)) {}
    HWY_INLINE void Take(hn::Vec<D> v) {
        least = hn::Min(least, v);
        greatest = hn::Max(greatest, v);
        nothing = hn::Add(nothing, hn::Sub(v, v));
    }
};

/// The ends of rows at least as wide as a vector of D; the last vector of each may have values twice.
template <class D, class Real>
HWY_INLINE Ends EndsIn(D d, const ValueRows<Real>& rows) {
    const auto at = [&](const Real* p) HWY_ATTR {
        const auto v = hn::LoadU(d, p);
        return rows.ahead == 0 ? v : hn::Sub(hn::LoadU(d, p + rows.ahead), v);
    };
    const int lanes = static_cast<int>(hn::Lanes(d)), last = rows.width - lanes;
    LaneEnds<D> ends(at(rows.values));
    for (int j = 0; j < rows.height; ++j) {
        const Real* const row = rows.values + j * rows.stride;
        for (int i = 0; i < last; i += lanes) ends.Take(at(row + i));
        ends.Take(at(row + last));
    }
    const double none{hn::GetLane(hn::SumOfLanes(d, ends.nothing))};
    return {double{hn::GetLane(hn::MinOfLanes(d, ends.least))} + none,
            double{hn::GetLane(hn::MaxOfLanes(d, ends.greatest))} + none};
}

template <class Real>
HWY_INLINE Ends EndsOf(const ValueRows<Real>& rows) {
    const hn::CappedTag<Real, 16> d;
    const hn::CappedTag<Real, 1> one;
    return rows.width >= static_cast<int>(hn::Lanes(d)) ? EndsIn(d, rows) : EndsIn(one, rows);
}
Ends EndsOfFloats(const ValueRows<float>& rows) {
    return EndsOf(rows);
}
Ends EndsOfDoubles(const ValueRows<double>& rows) {
    return EndsOf(rows);
}

bool PlaceIn(const Readable& readable, int count, std::int32_t* HWY_RESTRICT x, std::int32_t* HWY_RESTRICT y,
             std::int32_t* HWY_RESTRICT outside) {
    const hn::CappedTag<std::int32_t, 16> d;
    const Box& box = readable.box;
    const auto reach = hn::Set(d, readable.reach), turn = hn::Set(d, readable.turn);
    // The first and the last texel that pixels may have; the last one of those that went around is another.
    const auto left = hn::Set(d, box.x0 + readable.reach), right = hn::Set(d, box.x1 - 1 - readable.reach),
               top = hn::Set(d, box.y0 + readable.reach), bottom = hn::Set(d, box.y1 - 1 - readable.reach);
    const auto last = readable.turn == 0 ? right : hn::Set(d, readable.turn - 1 - readable.reach);
    const auto beyond_left = hn::Set(d, -readable.reach),
               beyond_right = hn::Set(d, readable.width - 1 + readable.reach);
    const auto corner_x = hn::Set(d, box.x0), corner_y = hn::Set(d, box.y0);
    auto any = hn::Zero(d);
    for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(d))) {
        auto tx = hn::LoadU(d, x + i);
        const auto ty = hn::LoadU(d, y + i);
        const auto before = hn::Lt(tx, beyond_left), behind = hn::Gt(tx, beyond_right);
        tx = hn::Sub(hn::Add(tx, hn::IfThenElseZero(before, turn)), hn::IfThenElseZero(behind, turn));
        const auto out =
            hn::Or(hn::Or(hn::Lt(tx, left), hn::Gt(tx, hn::IfThenElse(hn::Or(before, behind), last, right))),
                   hn::Or(hn::Lt(ty, top), hn::Gt(ty, bottom)));
        hn::StoreU(hn::IfThenElse(out, reach, hn::Sub(tx, corner_x)), d, x + i);
        hn::StoreU(hn::IfThenElse(out, reach, hn::Sub(ty, corner_y)), d, y + i);
        const auto is_out = hn::VecFromMask(d, out);
        hn::StoreU(is_out, d, outside + i);
        any = hn::Or(any, is_out);
    }
    return !hn::AllTrue(d, hn::Eq(any, hn::Zero(d)));
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(SplitPoints);
HWY_EXPORT(EndsOfFloats);
HWY_EXPORT(EndsOfDoubles);
HWY_EXPORT(PlaceIn);

void split_points(const double* points, int count, double scale, std::int32_t base, std::int32_t* texels,
                  float* rests) {
    HWY_DYNAMIC_DISPATCH(SplitPoints)(points, count, scale, base, texels, rests);
}

Ends ends_of(const ValueRows<float>& rows) {
    return HWY_DYNAMIC_DISPATCH(EndsOfFloats)(rows);
}

Ends ends_of(const ValueRows<double>& rows) {
    return HWY_DYNAMIC_DISPATCH(EndsOfDoubles)(rows);
}

bool place_in(const Readable& readable, int count, std::int32_t* x, std::int32_t* y, std::int32_t* outside) {
    return HWY_DYNAMIC_DISPATCH(PlaceIn)(readable, count, x, y, outside);
}

}  // namespace anamorph::simd
#endif
