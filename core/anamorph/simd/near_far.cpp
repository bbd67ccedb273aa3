// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/simd/near_far.cpp"
#include "anamorph/simd/near_far.h"

#include <cmath>
#include <cstddef>

#include "hwy/foreach_target.h"  // must come before highway.h

// And this one after it.
#include "hwy/contrib/math/math-inl.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using V = hn::Vec<Floats>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(Floats()));

HWY_INLINE V Set(float x) {
    return hn::Set(Floats(), x);
}

// --- the formula, read with vectors ---------------------------------------------------------------------

/// A vector as a number that the formula's templates can read.
struct Number {
    V v;
    Number() = default;
    HWY_INLINE Number(V vector) : v(vector) {}  // NOLINT: a vector is a number
    HWY_INLINE explicit Number(float x) : v(Set(x)) {}
};
HWY_INLINE Number operator*(const Number& a, const Number& b) {
    return hn::Mul(a.v, b.v);
}
HWY_INLINE Number operator+(const Number& a, const Number& b) {
    return hn::Add(a.v, b.v);
}
HWY_INLINE Number max(const Number& a, const Number& b) {
    return hn::Max(a.v, b.v);
}
HWY_INLINE Number root(const Number& a) {
    return hn::Sqrt(a.v);
}

#include "anamorph/map/feature_formula.h"

/// 1 / x to within 3 half-ULP.
HWY_INLINE V Reciprocal(V x) {
    return hn::Div(Set(1), x);
}

/// Which fast path an exponent takes.
enum class Exponent { zero, half, one, two, other };

/// (a + dist)^-b
template <Exponent kExponent>
HWY_INLINE V Power(V x, V b) {
    switch (kExponent) {
        case Exponent::zero:
            return Set(1);
        case Exponent::half:
            return Reciprocal(hn::Sqrt(x));
        case Exponent::one:
            return Reciprocal(x);
        case Exponent::two:
            return Reciprocal(hn::Mul(x, x));
        default:
            return hn::Exp(Floats(), hn::Neg(hn::Mul(b, hn::Log(Floats(), x))));
    }
}

template <class Body>
HWY_INLINE void WithExponent(float b, const Body& body) {
    if (b == 0) return body(std::integral_constant<Exponent, Exponent::zero>{});
    if (b == 0.5f) return body(std::integral_constant<Exponent, Exponent::half>{});
    if (b == 1) return body(std::integral_constant<Exponent, Exponent::one>{});
    if (b == 2) return body(std::integral_constant<Exponent, Exponent::two>{});
    return body(std::integral_constant<Exponent, Exponent::other>{});
}

template <class Body>
HWY_INLINE void WithDegree(int k, const Body& body) {
    if (k == 4) return body(std::integral_constant<int, 4>{});
    if (k == 6) return body(std::integral_constant<int, 6>{});
    return body(std::integral_constant<int, 8>{});
}

// --- bounds
// -------------------------------------------------------------------------------------------------

/// x^-K for x = 1 / inverse.
template <int K>
HWY_INLINE V PowerOfInverse(V inverse) {
    const V x2 = hn::Mul(inverse, inverse), x4 = hn::Mul(x2, x2);
    if constexpr (K == 4) return x4;
    if constexpr (K == 6) return hn::Mul(x4, x2);
    return hn::Mul(x4, x4);
}

struct AxisError {
    V value, linear;
};

/// Relative interpolation error of (x0 + s)^-b, 0 < b <= 2, and of s times it, on [-1, 1]: near_far.cpp
/// (approx) proves it.
template <int K, bool kAboveOne>
HWY_INLINE AxisError BesideError(V x) {
    const V one = Set(1);
    const V root = hn::Sqrt(hn::Max(hn::MulSub(x, x, one), Set(0)));
    const V y = PowerOfInverse<K>(hn::Div(one, hn::Add(x, root)));
    const V g = hn::Div(hn::Add(y, y), hn::MulAdd(y, y, one));
    V e = g;
    if constexpr (kAboveOne)
        e = hn::MulAdd(hn::Mul(g, Set(K)), hn::Sqrt(hn::Div(hn::Sub(x, one), hn::Add(x, one))), g);
    return {e, hn::Mul(x, hn::Add(g, e))};
}

/// The same of (a + |s - z|)^-b with z = sigma + i eta, the end of a line beside the cell.
template <int K>
HWY_INLINE AxisError EndError(V sigma, V eta) {
    const V one = Set(1), zero = Set(0);
    const V eta2 = hn::Mul(eta, eta), minus = hn::Sub(sigma, one), plus = hn::Add(sigma, one);
    const V a = hn::Mul(
        Set(0.5f), hn::Add(hn::Sqrt(hn::MulAdd(minus, minus, eta2)), hn::Sqrt(hn::MulAdd(plus, plus, eta2))));
    const V a1 = hn::Max(a, one);
    const V y = PowerOfInverse<K>(hn::Div(one, hn::Add(a1, hn::Sqrt(hn::MulSub(a1, a1, one)))));
    const V g = hn::Div(hn::Add(y, y), hn::NegMulAdd(y, y, one));
    // The slope of the linear factor: by its value over eta, or by the derivative on the real axis.
    const V s1 = hn::Max(sigma, one), sinh = hn::Sqrt(hn::Max(hn::MulSub(s1, s1, one), zero));
    const V ys = PowerOfInverse<K>(hn::Div(one, hn::Add(s1, sinh))), ys2 = hn::Mul(ys, ys);
    const V below = hn::Sub(one, ys2);
    const V derivative =
        hn::Div(hn::Mul(hn::Mul(Set(2 * K), ys), hn::Add(one, ys2)), hn::Mul(sinh, hn::Mul(below, below)));
    const V slope = hn::IfThenElse(hn::Ge(eta, one), hn::Div(g, hn::Max(eta, one)), derivative);
    const V most = hn::Max(eta, plus);
    const V value = hn::MulAdd(plus, slope, g);
    return {value, hn::MulAdd(slope, hn::MulAdd(plus, plus, hn::Mul(most, most)), value)};
}

/// Both axes together, interpolating along the worse one last.
HWY_INLINE AxisError Both(const AxisError& s, const AxisError& t, V lebesgue) {
    const auto swap = hn::Lt(s.value, t.value);
    const V value = hn::MulAdd(lebesgue, hn::Min(s.value, t.value), hn::Max(s.value, t.value));
    const V linear = hn::IfThenElse(swap, hn::MulAdd(lebesgue, s.linear, t.linear),
                                    hn::MulAdd(lebesgue, t.linear, s.linear));
    return {value, linear};
}

/// Interpolating functions whose second derivative jumps: the error per unit of the jump, and per unit of the
/// third derivative on either side (suprema of Peano's kernel and of its integral, rounded up).
template <int K>
constexpr float kJumpError = K == 4   ? 0.0190f
                             : K == 6 ? 0.00775f
                                      : 0.00425f;
template <int K>
constexpr float kThirdError = K == 4   ? 0.0161f
                              : K == 6 ? 0.0049f
                                       : 0.0023f;

template <Exponent kExponent, int K>
HWY_INLINE void BoundLines(const LineTable& lines, const CellFrame& cell, const WeightParameters& weights,
                           float lebesgue, LineBounds& out) {
    const Floats d;
    const V x = Set(cell.x), y = Set(cell.y), half = Set(cell.half), zero = Set(0), one = Set(1);
    const V a = Set(weights.a), b = Set(weights.b), least_distance = Set(kLeastDistance);
    const V diagonal = Set(cell.half * 1.41422f), constant = Set(lebesgue), infinite = Set(HUGE_VALF);
    const bool smooth = weights.b > 0 && weights.b <= 2, above_one = weights.b > 1;
    // Bounds of the second and third derivatives of (a + r)^-b along a line, times (r / half side)^2 and ^3
    // over the function, times the interpolation's constant on both axes.
    const float b1 = weights.b < 1 ? HWY_MAX(weights.b + 1, 2 / std::sqrt(2 - weights.b)) : weights.b + 1;
    const float axes = kThirdError<K> * (1 + lebesgue);
    const float third_of_weight = axes * weights.b * (weights.b + 2) * b1;
    const float second_of_weight = axes * 3 * weights.b * (weights.b + 1);
    V sums[kSums], least_sum = zero;
    for (V& s : sums) s = zero;
    for (int i = 0; i < lines.count; i += kLanes) {
        const auto field = [&](int f) HWY_ATTR { return hn::LoadU(d, lines.data + f * lines.stride + i); };
        const V ux = field(LineTable::kAlongX), uy = field(LineTable::kAlongY);
        const V factor = field(LineTable::kFactor);
        const V along = hn::MulAdd(ux, x, hn::Mul(uy, y));
        const V before = hn::Sub(field(LineTable::kBefore), along);
        const V behind = hn::Add(field(LineTable::kBehind), along);
        const V beside = hn::Add(field(LineTable::kBeside), hn::MulSub(ux, y, hn::Mul(uy, x)));
        const V far = distance_to_line<Number>(before, behind, beside).v;

        // Distances change by no more than the way.
        const V rounding = hn::MulAdd(far, Set(1e-6f), Set(1e-3f));
        const V nearest =
            hn::Max(hn::Add(a, hn::Max(hn::Sub(hn::Sub(far, diagonal), rounding), zero)), least_distance);
        const V farthest = hn::Add(a, hn::Add(hn::Add(far, diagonal), rounding));
        const V most = hn::Mul(factor, Power<kExponent>(nearest, b));
        const V least = hn::Mul(factor, Power<kExponent>(farthest, b));
        const V weight = hn::Mul(factor, Power<kExponent>(hn::Max(hn::Add(a, far), least_distance), b));
        hn::StoreU(most, d, out.most + i);
        hn::StoreU(nearest, d, out.nearest + i);
        hn::StoreU(least, d, out.least + i);
        least_sum = hn::Add(least_sum, least);
        sums[0] = hn::Add(sums[0], weight);
        for (int c = 0; c < kComponents; ++c) {
            const V right = hn::LoadU(d, lines.right + c * lines.stride + i);
            const V down = hn::LoadU(d, lines.down + c * lines.stride + i);
            const V at = hn::MulAdd(right, x, hn::MulAdd(down, y, field(LineTable::kAt + c)));
            hn::StoreU(at, d, out.displacement[c] + i);
            sums[c + 1] = hn::MulAdd(weight, at, sums[c + 1]);
        }

        AxisError error{zero, zero};
        if (weights.b > 0) {
            // From anywhere but on the line itself: its ends' levels are jumps of the second derivative.
            const V hx = hn::Mul(half, hn::Abs(ux)), hy = hn::Mul(half, hn::Abs(uy));
            const V extent = hn::Add(hn::Add(hx, hy), rounding);
            const V clear = hn::Sub(hn::Sub(far, diagonal), rounding);
            const V apart = hn::Max(clear, Set(1e-3f)), size = hn::Div(half, apart),
                    size2 = hn::Mul(size, size);
            const V larger = hn::Max(hn::Mul(ux, ux), hn::Mul(uy, uy));
            const V jumps = hn::Add(hn::IfThenElseZero(hn::Lt(hn::Abs(before), extent), one),
                                    hn::IfThenElseZero(hn::Lt(hn::Abs(behind), extent), one));
            const V jump = hn::Mul(hn::Mul(jumps, hn::Mul(size, hn::Div(half, nearest))),
                                   hn::MulAdd(larger, hn::Sub(one, constant), constant));
            const V third = hn::Mul(size2, hn::Mul(size, Set(third_of_weight)));
            error.value = hn::MulAdd(jump, Set(kJumpError<K> * weights.b), third);
            error.linear = hn::MulAdd(size2, Set(second_of_weight), error.value);
            const auto is_apart = hn::Gt(clear, Set(1e-3f));
            error.value = hn::IfThenElse(is_apart, error.value, infinite);
            error.linear = hn::IfThenElse(is_apart, error.linear, infinite);
            if (smooth) {
                // Beside the line, on one side of it, from end to end.
                const V distance = hn::Sub(hn::Add(a, hn::Abs(beside)), rounding);
                const auto is_beside =
                    hn::And(hn::And(hn::Lt(before, hn::Neg(extent)), hn::Lt(behind, hn::Neg(extent))),
                            hn::Gt(hn::Abs(beside), extent));
                const V tiny = Set(cell.half * 1e-6f);
                const V xs = hn::Max(hn::Div(hn::Sub(distance, hx), hn::Max(hy, tiny)), one);
                const V xt = hn::Max(hn::Div(hn::Sub(distance, hy), hn::Max(hx, tiny)), one);
                const AxisError by_line =
                    above_one ? Both(BesideError<K, true>(xs), BesideError<K, true>(xt), constant)
                              : Both(BesideError<K, false>(xs), BesideError<K, false>(xt), constant);
                // Beyond an end, seen from everywhere in the cell.
                const V beyond = hn::Max(before, behind);
                const auto is_beyond = hn::Gt(beyond, extent);
                const V z = hn::IfThenElse(hn::Gt(before, behind), before, hn::Neg(behind));
                const V unit = Set(1 / cell.half), room = hn::Mul(rounding, unit);
                const V px = hn::Max(
                    hn::Sub(hn::Mul(hn::Abs(hn::MulAdd(z, ux, hn::Mul(beside, uy))), unit), room), zero);
                const V py = hn::Max(
                    hn::Sub(hn::Mul(hn::Abs(hn::MulSub(z, uy, hn::Mul(beside, ux))), unit), room), zero);
                const V ex = hn::Max(hn::Sub(px, one), zero), ey = hn::Max(hn::Sub(py, one), zero);
                const AxisError by_end = Both(EndError<K>(px, ey), EndError<K>(py, ex), constant);
                const auto outside = hn::And(is_beyond, hn::Gt(hn::Max(px, py), Set(1.05f)));
                const auto better = [&](V general, V line, V end) HWY_ATTR {
                    const V closed = hn::IfThenElse(is_beside, line, hn::IfThenElse(outside, end, infinite));
                    return hn::Min(general, closed);
                };
                error.value = better(error.value, by_line.value, by_end.value);
                error.linear = better(error.linear, by_line.linear, by_end.linear);
            }
        }
        const V change = hn::Mul(half, field(LineTable::kSlope));
        // Lines of factor 0 fill up the last vector.
        const auto real = hn::Gt(factor, zero);
        hn::StoreU(hn::IfThenElse(real, hn::Mul(most, error.value), zero), d, out.value + i);
        hn::StoreU(hn::IfThenElse(real, hn::Mul(hn::Mul(most, error.linear), change), zero), d,
                   out.linear + i);
    }
    for (int c = 0; c < kSums; ++c)
        out.center[c] = static_cast<double>(hn::GetLane(hn::SumOfLanes(d, sums[c])));
    out.least_sum = static_cast<double>(hn::GetLane(hn::SumOfLanes(d, least_sum)));
}

void BoundLinesOf(const LineTable& lines, const CellFrame& cell, const WeightParameters& weights, int k,
                  float lebesgue, LineBounds& out) {
    WithExponent(weights.b, [&](auto exponent) HWY_ATTR {
        WithDegree(k, [&](auto degree) HWY_ATTR {
            BoundLines<decltype(exponent)::value, decltype(degree)::value>(lines, cell, weights, lebesgue,
                                                                           out);
        });
    });
}

SpreadSums BoundDisplacements(const LineTable& lines, const CellFrame& cell, const float* center, float much,
                              const LineBounds& bounds, float* reach, float* error) {
    const Floats d;
    const V zero = Set(0), infinite = Set(HUGE_VALF);
    V farthest = zero, heavy = zero, light = zero, steep = zero, slope = zero;
    V most_sum = zero, reach_sum = zero, near_sum = zero, near_reach = zero;
    for (int i = 0; i < lines.count; i += kLanes) {
        V square = zero;
        for (int c = 0; c < kComponents; c += 2) {
            const V dx = hn::Sub(hn::LoadU(d, bounds.displacement[c] + i), Set(center[c]));
            const V dy = hn::Sub(hn::LoadU(d, bounds.displacement[c + 1] + i), Set(center[c + 1]));
            square = hn::Max(square, hn::MulAdd(dx, dx, hn::Mul(dy, dy)));
        }
        const auto real = hn::Gt(hn::LoadU(d, lines.data + LineTable::kFactor * lines.stride + i), zero);
        const V distance = hn::IfThenElseZero(real, hn::Sqrt(square));
        const V change = hn::LoadU(d, lines.data + LineTable::kSlope * lines.stride + i);
        const V r = hn::MulAdd(Set(cell.half), change, distance);
        hn::StoreU(r, d, reach + i);
        const V value = hn::LoadU(d, bounds.value + i), linear = hn::LoadU(d, bounds.linear + i);
        // An unknown error stays so, whatever the displacement.
        const auto known = hn::Lt(value, infinite);
        hn::StoreU(hn::IfThenElse(known, hn::MulAdd(value, distance, linear), infinite), d, error + i);

        const V m = hn::LoadU(d, bounds.most + i);
        const V near = hn::Div(m, hn::LoadU(d, bounds.nearest + i));
        const auto is_light = hn::Le(m, Set(much)), may_be_far = hn::And(is_light, known);
        farthest = hn::Max(farthest, r);
        heavy = hn::Max(heavy, hn::IfThenZeroElse(is_light, r));
        light = hn::Add(light, hn::IfThenElseZero(is_light, hn::Mul(m, r)));
        steep = hn::MulAdd(near, r, steep);
        slope = hn::MulAdd(m, change, slope);
        most_sum = hn::Add(most_sum, hn::IfThenElseZero(may_be_far, m));
        reach_sum = hn::Add(reach_sum, hn::IfThenElseZero(may_be_far, hn::Mul(m, r)));
        near_sum = hn::Add(near_sum, hn::IfThenElseZero(may_be_far, near));
        near_reach = hn::Add(near_reach, hn::IfThenElseZero(may_be_far, hn::Mul(near, r)));
    }
    const auto sum = [&](V v) HWY_ATTR { return static_cast<double>(hn::GetLane(hn::SumOfLanes(d, v))); };
    const auto max_of = [&](V v) HWY_ATTR { return static_cast<double>(hn::GetLane(hn::MaxOfLanes(d, v))); };
    return {max_of(farthest), max_of(heavy),  sum(light),    sum(steep),     sum(slope),
            sum(most_sum),    sum(reach_sum), sum(near_sum), sum(near_reach)};
}

// --- sums --------------------------------------------------------------------------------------------------

/// A line on one row of pixels.
struct LineOnRow {
    float before, behind, beside, along_x, along_y, factor;
    float at[kComponents], right[kComponents];

    HWY_INLINE LineOnRow(const FieldLine& l, float y)
        : before(l.before - l.along_y * y),
          behind(l.behind + l.along_y * y),
          beside(l.beside + l.along_x * y),
          along_x(l.along_x),
          along_y(l.along_y),
          factor(l.factor) {
        for (int c = 0; c < kComponents; ++c) {
            at[c] = l.at[c] + l.down[c] * y;
            right[c] = l.right[c];
        }
    }
};

/// Adds what one line says about the pixels at x.
template <Exponent kExponent, int kCount>
HWY_INLINE void AddLine(const LineOnRow& l, V x, V a, V b, V* HWY_RESTRICT sums) {
    const V along = hn::Mul(Set(l.along_x), x);
    const V before = hn::Sub(Set(l.before), along), behind = hn::Add(Set(l.behind), along);
    const V beside = hn::NegMulAdd(Set(l.along_y), x, Set(l.beside));
    const V far =
        hn::Max(hn::Add(a, distance_to_line<Number>(before, behind, beside).v), Set(kLeastDistance));
    const V weight = hn::Mul(Set(l.factor), Power<kExponent>(far, b));
    sums[0] = hn::Add(sums[0], weight);
    for (int c = 0; c < kCount; ++c)
        sums[c + 1] = hn::MulAdd(weight, hn::MulAdd(Set(l.right[c]), x, Set(l.at[c])), sums[c + 1]);
}

/// The same for points each with a y of its own.
template <Exponent kExponent>
HWY_INLINE void AddLineAt(const FieldLine& l, V x, V y, V a, V b, V* HWY_RESTRICT sums) {
    const V ux = Set(l.along_x), uy = Set(l.along_y);
    const V along = hn::MulAdd(ux, x, hn::Mul(uy, y));
    const V before = hn::Sub(Set(l.before), along), behind = hn::Add(Set(l.behind), along);
    const V beside = hn::Add(Set(l.beside), hn::MulSub(ux, y, hn::Mul(uy, x)));
    const V far =
        hn::Max(hn::Add(a, distance_to_line<Number>(before, behind, beside).v), Set(kLeastDistance));
    const V weight = hn::Mul(Set(l.factor), Power<kExponent>(far, b));
    sums[0] = hn::Add(sums[0], weight);
    for (int c = 0; c < kComponents; ++c)
        sums[c + 1] = hn::MulAdd(
            weight, hn::MulAdd(Set(l.right[c]), x, hn::MulAdd(Set(l.down[c]), y, Set(l.at[c]))), sums[c + 1]);
}

template <Exponent kExponent, int K>
HWY_INLINE void NodeSums(const FieldLine* lines, const int32_t* which, int count, const CellFrame& cell,
                         const WeightParameters& weights, const float* nodes, double* sums) {
    // Floats are added up over few lines only.
    constexpr int kRun = 8;
    constexpr int kNodes = (K * K + 15) / 16 * 16;
    const Floats d;
    HWY_ALIGN float x[kNodes], y[kNodes], part[kLanes];
    for (int n = 0; n < kNodes; ++n) {
        const int at = n < K * K ? n : 0;
        x[n] = cell.x + cell.half * nodes[at % K];
        y[n] = cell.y + cell.half * nodes[at / K];
    }
    const V a = Set(weights.a), b = Set(weights.b);
    for (int first = 0; first < count; first += kRun) {
        const int last = HWY_MIN(count, first + kRun);
        for (int n = 0; n < K * K; n += kLanes) {
            const V vx = hn::Load(d, x + n), vy = hn::Load(d, y + n);
            V s[kSums];
            for (V& v : s) v = Set(0);
            for (int i = first; i < last; ++i) AddLineAt<kExponent>(lines[which[i]], vx, vy, a, b, s);
            const int lanes = HWY_MIN(kLanes, K * K - n);
            for (int c = 0; c < kSums; ++c) {
                hn::Store(s[c], d, part);
                for (int j = 0; j < lanes; ++j) sums[(n + j) * 8 + c] += static_cast<double>(part[j]);
            }
        }
    }
}

void NodeSumsOf(const FieldLine* lines, const int32_t* which, int count, const CellFrame& cell,
                const WeightParameters& weights, int k, const float* nodes, double* sums) {
    WithExponent(weights.b, [&](auto exponent) HWY_ATTR {
        WithDegree(k, [&](auto degree) HWY_ATTR {
            NodeSums<decltype(exponent)::value, decltype(degree)::value>(lines, which, count, cell, weights,
                                                                         nodes, sums);
        });
    });
}

template <int K>
HWY_INLINE void TransformDegree(const double* left, const double* right, const double* HWY_RESTRICT from,
                                double* HWY_RESTRICT to) {
#if HWY_HAVE_FLOAT64 && HWY_TARGET != HWY_SCALAR
    const hn::CappedTag<double, 8> d;
#else
    const hn::CappedTag<double, 1> d;
#endif
    constexpr int kStep = static_cast<int>(hn::MaxLanes(d));
    HWY_ALIGN double between[K * K * 8];
    for (int lane = 0; lane < kSums; lane += kStep) {
        for (int i = 0; i < K; ++i) {
            hn::Vec<decltype(d)> column[K];
            HWY_UNROLL(8)
            for (int j = 0; j < K; ++j) column[j] = hn::LoadU(d, from + (j * K + i) * 8 + lane);
            HWY_UNROLL(8)
            for (int m = 0; m < K; ++m) {
                auto sum = hn::Mul(hn::Set(d, left[m * K]), column[0]);
                HWY_UNROLL(8)
                for (int j = 1; j < K; ++j) sum = hn::MulAdd(hn::Set(d, left[m * K + j]), column[j], sum);
                hn::Store(sum, d, between + (m * K + i) * 8 + lane);
            }
        }
        for (int m = 0; m < K; ++m) {
            hn::Vec<decltype(d)> row[K];
            HWY_UNROLL(8)
            for (int i = 0; i < K; ++i) row[i] = hn::Load(d, between + (m * K + i) * 8 + lane);
            HWY_UNROLL(8)
            for (int n = 0; n < K; ++n) {
                auto sum = hn::Mul(hn::Set(d, right[n * K]), row[0]);
                HWY_UNROLL(8)
                for (int i = 1; i < K; ++i) sum = hn::MulAdd(hn::Set(d, right[n * K + i]), row[i], sum);
                hn::StoreU(sum, d, to + (m * K + n) * 8 + lane);
            }
        }
    }
}

void Transform(const double* left, const double* right, int k, const double* from, double* to) {
    WithDegree(
        k, [&](auto degree) HWY_ATTR { TransformDegree<decltype(degree)::value>(left, right, from, to); });
}

// --- pixels ------------------------------------------------------------------------------------------------

template <Exponent kExponent, int K, int kCount>
HWY_INLINE void FieldPoints(const FieldCell& cell, const FieldOutput& out) {
    const Floats d;
    const V a = Set(cell.weights.a), b = Set(cell.weights.b);
    const V lanes = hn::Iota(d, 0.0f);
    const V unit = Set(1 / cell.frame.half), center = Set(cell.frame.x);
    constexpr int kPairs = K ? K * 8 : 8;  // coefficients of one power of t
    HWY_ALIGN float row[kPairs < 16 ? 16 : kPairs];
    for (int j = 0; j < out.height; ++j) {
        const float y = out.y + static_cast<float>(j);
        if constexpr (K > 0) {
            // The polynomial on this row.
            const V t = Set((y - cell.frame.y) / cell.frame.half);
            for (int m = 0; m < kPairs; m += kLanes) {
                V s = hn::LoadU(d, cell.coefficients + (K - 1) * kPairs + m);
                for (int n = K - 2; n >= 0; --n)
                    s = hn::MulAdd(s, t, hn::LoadU(d, cell.coefficients + n * kPairs + m));
                hn::Store(s, d, row + m);
            }
        }
        for (int i = 0; i < out.width; i += kLanes) {
            const V x = hn::Add(lanes, Set(out.x + static_cast<float>(i)));
            V sums[kSums];
            if constexpr (K > 0) {
                const V s = hn::Mul(hn::Sub(x, center), unit);
                for (int c = 0; c <= kCount; ++c) {
                    V sum = Set(row[(K - 1) * 8 + c]);
                    for (int m = K - 2; m >= 0; --m) sum = hn::MulAdd(sum, s, Set(row[m * 8 + c]));
                    sums[c] = sum;
                }
            } else
                for (int c = 0; c <= kCount; ++c) sums[c] = Set(0);
            for (int n = 0; n < cell.near_count; ++n)
                AddLine<kExponent, kCount>(LineOnRow(cell.near_lines[n], y), x, a, b, sums);
            const V inverse = Reciprocal(sums[0]);
            for (int c = 0; c < kCount; ++c) {
                // x + its displacement, or y and its.
                const V identity = c & 1 ? Set(out.offset[c] + out.slope[c] * y)
                                         : hn::MulAdd(Set(out.slope[c]), x, Set(out.offset[c]));
                hn::StoreU(hn::MulAdd(sums[c + 1], inverse, identity), d, out.to[c] + j * out.stride + i);
            }
        }
    }
}

void FieldPointsOf(const FieldCell& cell, const FieldOutput& out) {
    WithExponent(cell.weights.b, [&](auto exponent) HWY_ATTR {
        constexpr Exponent kExponent = decltype(exponent)::value;
        const auto with_degree = [&](auto count) HWY_ATTR {
            constexpr int kCount = decltype(count)::value;
            if (cell.k == 0) return FieldPoints<kExponent, 0, kCount>(cell, out);
            WithDegree(cell.k, [&](auto degree) HWY_ATTR {
                FieldPoints<kExponent, decltype(degree)::value, kCount>(cell, out);
            });
        };
        if (out.components == 2)
            with_degree(std::integral_constant<int, 2>{});
        else
            with_degree(std::integral_constant<int, 4>{});
    });
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(BoundLinesOf);
HWY_EXPORT(BoundDisplacements);
HWY_EXPORT(NodeSumsOf);
HWY_EXPORT(Transform);
HWY_EXPORT(FieldPointsOf);

void bound_lines(const LineTable& lines, const CellFrame& cell, const WeightParameters& weights, int k,
                 float lebesgue, LineBounds& bounds) {
    HWY_DYNAMIC_DISPATCH(BoundLinesOf)(lines, cell, weights, k, lebesgue, bounds);
}
SpreadSums bound_displacements(const LineTable& lines, const CellFrame& cell, const float* center, float much,
                               const LineBounds& bounds, float* reach, float* error) {
    return HWY_DYNAMIC_DISPATCH(BoundDisplacements)(lines, cell, center, much, bounds, reach, error);
}
void node_sums(const FieldLine* lines, const std::int32_t* which, int count, const CellFrame& cell,
               const WeightParameters& weights, int k, const float* nodes, double* sums) {
    HWY_DYNAMIC_DISPATCH(NodeSumsOf)(lines, which, count, cell, weights, k, nodes, sums);
}
void transform(const double* left, const double* right, int k, const double* from, double* to) {
    HWY_DYNAMIC_DISPATCH(Transform)(left, right, k, from, to);
}
void field_points(const FieldCell& cell, const FieldOutput& output) {
    HWY_DYNAMIC_DISPATCH(FieldPointsOf)(cell, output);
}

}  // namespace anamorph::simd
#endif
