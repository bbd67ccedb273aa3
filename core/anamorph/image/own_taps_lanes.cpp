// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/image/own_taps_lanes.cpp"
#include "anamorph/image/own_taps.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

#include "anamorph/image/footprint.h"
#include "anamorph/number/arithmetic.h"
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

/// The taps along a side: half of the way from one to the next, and their number.
struct TapsAlong {
    Step half;
    hn::Vec<Ints> count;
};

/// Half of the distance of the two taps that serve lengths l from 1 to 2: d^2 - d^3 / 2 = 2/3 (1 - 1/l) (2 - 1/l), where d / q with
/// q^2 = l - 1 is a polynomial in q here, within 1.2e-4 texels of d.
HWY_INLINE V HalfSpacingOfTwo(V length) {
    const Floats d;
    const auto q = hn::Sqrt(hn::Sub(length, hn::Set(d, 1.0f)));
    auto p = hn::Set(d, 0.67825002f);
    p = Fused(p, q, hn::Set(d, -1.9987953f));
    p = Fused(p, q, hn::Set(d, 2.6146848f));
    p = Fused(p, q, hn::Set(d, -1.9126091f));
    p = Fused(p, q, hn::Set(d, 0.73018819f));
    p = Fused(p, q, hn::Set(d, 0.065956643f));
    p = Fused(p, q, hn::Set(d, 0.82220862f));
    return hn::Mul(hn::Mul(p, q), hn::Set(d, 0.5f));
}

/// By the table, of lengths from 1 to its longest.
HWY_INLINE V HalfSpacingOfMany(const SpacingTable& table, V length, hn::Vec<Ints>& count) {
    const Floats d;
    const Ints di;
    constexpr float kNodes = SpacingTable::kNodes;
    const auto ratio =
        hn::Div(hn::Mul(hn::Add(length, length), length), Fused(hn::Set(d, 3.0f), length, hn::Set(d, -1.0f)));
    const auto fewest = hn::Ceil(ratio);
    const auto node = hn::Mul(hn::Sqrt(hn::Sub(fewest, ratio)), hn::Set(d, kNodes));
    const auto before = hn::Floor(node);
    count = hn::ConvertTo(di, fewest);
    const auto at = hn::Add(hn::Mul(count, hn::Set(di, SpacingTable::kNodes + 1)), hn::ConvertTo(di, before));
    const auto low = hn::GatherIndex(d, &table.half_spacing[0][0], at);
    const auto high = hn::GatherIndex(d, &table.half_spacing[0][0] + 1, at);
    return Fused(hn::Sub(node, before), hn::Sub(high, low), low);
}

/// The taps along a side. Of one that is no number they are so, too; of one that is too long for the table they are anywhere.
HWY_INLINE TapsAlong TapsOf(const SpacingTable& table, const Step& side, V squared_length) {
    const Floats d;
    const Ints di;
    const auto one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f), longest = hn::Set(d, SpacingTable::kLongest);
    const auto longer = hn::Gt(squared_length, one);
    const auto length = hn::Sqrt(hn::IfThenElse(longer, squared_length, one));
    const auto few = hn::Le(length, two);
    auto count = hn::IfThenElse(hn::RebindMask(di, longer), hn::Set(di, 2), hn::Set(di, 1));
    auto spacing = HalfSpacingOfTwo(hn::Min(length, two));
    if (!hn::AllTrue(d, few)) {
        hn::Vec<Ints> many;
        const auto of_many = HalfSpacingOfMany(table, hn::Min(length, longest), many);
        spacing = hn::IfThenElse(few, spacing, of_many);
        count = hn::IfThenElse(hn::RebindMask(di, few), count, many);
    }
    const auto share = hn::Div(spacing, length);
    return {{hn::Mul(side.x, share), hn::Mul(side.y, share)}, count};
}

/// The smaller singular value of the map's derivative.
HWY_INLINE V LeastStretch(const Step& across, const Step& down) {
    const auto sum = SquaredLength({hn::Add(across.x, down.y), hn::Sub(across.y, down.x)});
    const auto difference = SquaredLength({hn::Sub(across.x, down.y), hn::Add(across.y, down.x)});
    return hn::Mul(hn::Set(Floats(), 0.5f), hn::Abs(hn::Sub(hn::Sqrt(sum), hn::Sqrt(difference))));
}

/// Finds the taps of pixels by their sides, and what is greatest of all.
class TapFinder {
  public:
    HWY_INLINE TapFinder(float widest, const OwnTapRows& to)
        : m_table(SpacingTable::get()),
          m_to(to),
          m_widest(hn::Set(Floats(), widest)),
          m_reach_x(hn::Zero(Floats())),
          m_reach_y(hn::Zero(Floats())),
          m_most(hn::Zero(Ints())) {}

    /// The taps of `count` pixels to entry k and behind.
    HWY_INLINE void Find(const Step& across, const Step& down, int count, ptrdiff_t k) {
        const Floats d;
        const Ints di;
        const auto a2 = SquaredLength(across), b2 = SquaredLength(down);
        const TapsAlong a = TapsOf(m_table, across, a2), b = TapsOf(m_table, down, b2);
        const auto one = hn::Set(d, 1.0f), two = hn::Set(d, 4.0f), half = hn::Set(d, 0.5f);
        const auto few = hn::And(hn::Le(a2, two), hn::Le(b2, two));
        auto taps = Counts(a, b);
        if (!hn::AllTrue(d, few)) {
            const auto most = hn::Set(d, SpacingTable::kLongest * SpacingTable::kLongest);
            // Written so that what is no number is among the others.
            const auto fits = hn::And(hn::And(hn::Le(a2, most), hn::Le(b2, most)),
                                      hn::Le(LeastStretch(across, down), m_widest));
            const auto not_many =
                hn::Lt(hn::Mul(a.count, b.count), hn::Set(di, static_cast<int32_t>(kMostOwnTaps + 1)));
            taps = hn::IfThenElse(hn::And(hn::RebindMask(di, fits), not_many), taps, hn::Set(di, kNoOwnTaps));
        }
        const auto magnified = hn::And(hn::Le(a2, one), hn::Le(b2, one));
        const auto near = hn::And(few, hn::And(hn::Le(hn::Add(hn::Abs(a.half.x), hn::Abs(b.half.x)), half),
                                               hn::Le(hn::Add(hn::Abs(a.half.y), hn::Abs(b.half.y)), half)));
        taps =
            hn::IfThenElse(hn::RebindMask(di, near), hn::Set(di, static_cast<int32_t>(OwnKind::nine)), taps);
        taps = hn::IfThenElse(hn::RebindMask(di, magnified), hn::Zero(di), taps);
        hn::StoreU(a.half.x, d, m_to.x_i + k);
        hn::StoreU(a.half.y, d, m_to.y_i + k);
        hn::StoreU(b.half.x, d, m_to.x_j + k);
        hn::StoreU(b.half.y, d, m_to.y_j + k);
        hn::StoreU(taps, di, m_to.taps + k);

        const auto inside = hn::FirstN(di, static_cast<size_t>(HWY_MIN(count, static_cast<int>(kWide))));
        m_most = hn::Max(m_most, hn::IfThenElseZero(inside, taps));
        const auto counted = hn::RebindMask(d, hn::And(inside, hn::Lt(taps, hn::Set(di, kNoOwnTaps))));
        const auto steps = [&](const TapsAlong& side)
                               HWY_ATTR { return hn::ConvertTo(d, hn::Sub(side.count, hn::Set(di, 1))); };
        const auto na = steps(a), nb = steps(b);
        const auto reach = [&](V of_a, V of_b) HWY_ATTR {
            return hn::IfThenElseZero(counted, Fused(na, hn::Abs(of_a), hn::Mul(nb, hn::Abs(of_b))));
        };
        m_reach_x = hn::Max(m_reach_x, reach(a.half.x, b.half.x));
        m_reach_y = hn::Max(m_reach_y, reach(a.half.y, b.half.y));
    }

    HWY_INLINE OwnReach Reach() const {
        const Floats d;
        const Ints di;
        return {hn::GetLane(hn::MaxOfLanes(d, m_reach_x)), hn::GetLane(hn::MaxOfLanes(d, m_reach_y)),
                own_kind(hn::GetLane(hn::MaxOfLanes(di, m_most)))};
    }

    static constexpr size_t kWide = hn::MaxLanes(Floats());

  private:
    static HWY_INLINE hn::Vec<Ints> Counts(const TapsAlong& a, const TapsAlong& b) {
        return hn::Add(
            hn::Add(hn::ShiftLeft<kTapsAcrossShift>(a.count), hn::ShiftLeft<kTapsDownShift>(b.count)),
            hn::Set(Ints(), static_cast<int32_t>(OwnKind::some)));
    }
    const SpacingTable& m_table;
    const OwnTapRows& m_to;
    V m_widest, m_reach_x, m_reach_y;
    hn::Vec<Ints> m_most;
};

/// The steps to the left and to the right of every pixel of a row: entry i is the one to the left of pixel i. The first and the last
/// have one neighbour.
struct StepsAcross {
    float x[kRowRoom + 16], y[kRowRoom + 16];

    HWY_INLINE StepsAcross(const float* px, const float* py, int width) {
        const Floats d;
        int i = 0;
        do {  // at least once, as there are two pixels or more
            const Step s = StepFrom(px, py, i, 1);
            hn::StoreU(s.x, d, x + i + 1);
            hn::StoreU(s.y, d, y + i + 1);
            i += static_cast<int>(hn::MaxLanes(d));
        } while (i < width - 1);
        x[0] = x[1];
        y[0] = y[1];
        x[width] = x[width - 1];
        y[width] = y[width - 1];
    }
    HWY_INLINE Step LeftOf(int i) const { return {hn::LoadU(Floats(), x + i), hn::LoadU(Floats(), y + i)}; }
};

OwnReach FindOwnTaps(const float* HWY_RESTRICT x, const float* HWY_RESTRICT y, ptrdiff_t stride, int width,
                     int height, float widest, const OwnTapRows& to) {
    TapFinder finder(widest, to);
    for (int j = 0; j < height; ++j) {
        const ptrdiff_t row = j * stride;
        const ptrdiff_t up = j > 0 ? row - stride : row, down = j + 1 < height ? row : row - stride;
        const StepsAcross across(x + row, y + row, width);
        for (int i = 0; i < width; i += static_cast<int>(hn::MaxLanes(Floats())))
            finder.Find(Shorter(across.LeftOf(i), across.LeftOf(i + 1)),
                        Shorter(StepFrom(x, y, up + i, stride), StepFrom(x, y, down + i, stride)), width - i,
                        j * to.stride + i);
    }
    return finder.Reach();
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(FindOwnTaps);

SpacingTable::SpacingTable() : half_spacing{} {
    for (int n = 2; n <= kMost; ++n)
        for (int k = 0; k <= kNodes; ++k) {
            const double ratio = n - square(static_cast<double>(k) / kNodes);
            half_spacing[n][k] = static_cast<float>(spacing_for(n, 2.0 / 3 / ratio) / 2);
        }
}

const SpacingTable& SpacingTable::get() {
    static const SpacingTable table;
    return table;
}

OwnReach own_taps(const float* x, const float* y, std::ptrdiff_t row_stride, int width, int height,
                  float widest, const OwnTapRows& to) {
    return HWY_DYNAMIC_DISPATCH(FindOwnTaps)(x, y, row_stride, width, height, widest, to);
}

}  // namespace anamorph::simd
#endif
