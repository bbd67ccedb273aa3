// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/morph/near_far_lanes.cpp"
#include "anamorph/morph/near_far_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "hwy/foreach_target.h"  // must come before highway.h

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

// The lanes of sums, so that bits are the same whatever the processor: no fused multiply-adds, which some
// have, and no estimates of quotients and roots, which differ; sums run over kWide lanes, in as many vectors
// as that takes.
constexpr int kWide = 16;
constexpr int kParts = kWide / kLanes;

/// a b + c, rounded twice.
template <class T>
HWY_INLINE T TimesPlus(T a, T b, T c) {
    return hn::Add(hn::Mul(a, b), c);
}
/// a b - c, rounded twice.
HWY_INLINE V TimesMinus(V a, V b, V c) {
    return hn::Sub(hn::Mul(a, b), c);
}
HWY_INLINE V Reciprocal(V x) {
    return hn::Div(Set(1), x);
}

/// kWide lanes of sums or maxima, and all of them together in an order of their own.
struct Wide {
    V part[kParts];

    HWY_INLINE Wide() {
        for (V& v : part) v = Set(0);
    }
    /// The part for the lines from i on.
    HWY_INLINE V& At(int i) { return part[i / kLanes % kParts]; }
    template <class Join>
    HWY_INLINE float Folded(const Join& join) const {
        HWY_ALIGN float all[kWide];
        for (int n = 0; n < kParts; ++n) hn::Store(part[n], Floats(), all + n * kLanes);
        for (int n = kWide / 2; n > 0; n /= 2)
            for (int j = 0; j < n; ++j) all[j] = join(all[j], all[j + n]);
        return all[0];
    }
    HWY_INLINE float Sum() const {
        return Folded([](float x, float y) { return x + y; });
    }
    HWY_INLINE float Max() const {
        return Folded([](float x, float y) { return HWY_MAX(x, y); });
    }
};

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

#include "anamorph/morph/feature_formula.h"

HWY_INLINE V Distance(V before, V behind, V beside) {
    return distance_to_line<Number>(before, behind, beside).v;
}

/// Which fast path an exponent takes.
enum class Exponent { zero, half, one, two, other };

/// log2(x) for x > 0, normal and finite; off by at most u (|log2(x)| + 2.4).
HWY_INLINE V Log2(V x) {
    const hn::RebindToSigned<Floats> di;
    // x = m 2^e with m in [sqrt(1/2), sqrt(2)), and log2(m) = 2 / ln(2) artanh((m - 1) / (m + 1)): with |s| <
    // 0.172 what is left out is below 1e-9 s. s is off by 2 u, the sum of the series by 1.6 u, their product
    // by 4.7 u of at most 1/2; m - 1 is exact, and so is e.
    const auto bits = hn::Sub(hn::BitCast(di, x), hn::Set(di, 0x3f3504f3));
    const auto e = hn::ShiftRight<23>(bits);
    const V m = hn::BitCast(Floats(), hn::Sub(hn::BitCast(di, x), hn::ShiftLeft<23>(e)));
    const V s = hn::Div(hn::Sub(m, Set(1)), hn::Add(m, Set(1))), z = hn::Mul(s, s);
    V sum = Set(0.320598898f);
    for (const float c : {0.412198583f, 0.577078016f, 0.961796694f, 2.88539008f})
        sum = TimesPlus(sum, z, Set(c));
    return hn::Add(hn::ConvertTo(Floats(), e), hn::Mul(s, sum));
}

/// 2^t to within 3 u of it; from about 2^-126 down to 0, from 2^128 up infinite.
HWY_INLINE V Exp2(V t) {
    const hn::RebindToSigned<Floats> di;
    t = hn::Min(hn::Max(t, Set(-252)), Set(252));
    // 2^t = 2^n e^g, |g| < 0.3466: t - n is exact, g off by 0.52 u; Taylor's polynomial leaves out 0.1 u, and
    // Horner's rule adds 1 u at its last step and 1.3 u before.
    const V n = hn::Round(t), g = hn::Mul(hn::Sub(t, n), Set(0.693147181f));
    V e = Set(1.0f / 5040);
    for (const float c : {1.0f / 720, 1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f})
        e = TimesPlus(e, g, Set(c));
    const auto exponent = hn::ConvertTo(di, n), half = hn::ShiftRight<1>(exponent);
    const auto power = [&](auto k) HWY_ATTR {
        return hn::BitCast(Floats(), hn::ShiftLeft<23>(hn::Add(k, hn::Set(di, 127))));
    };
    return hn::Mul(hn::Mul(e, power(half)), power(hn::Sub(exponent, half)));
}

/// x^-b; near_far.h says how well.
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
            return Exp2(hn::Neg(hn::Mul(b, Log2(x))));
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

// --- bounds ------------------------------------------------------------------------------------------------
//
// Every bound below is a monotone function of bounds, taken on the safe side: distances are not greater than
// they are, by `rounding` and kTight. From there on a bound is made of products, quotients, roots and sums of
// positive numbers, and of differences from numbers without an error: each step adds at most u to the
// relative error, or multiplies what there is by at most 2 (a square) before that. kLoose covers 128 u: the
// longest chain, to the eighth power in a closed form, is 1 + 8 (5.5) + 7 steps long, and its upper bound
// enters the rest, of 20 steps, which the factor at the end covers.
constexpr float kLoose = 1 + 128 * kFloatRounding, kTight = 1 - 128 * kFloatRounding;

/// At least x^-K, for x = 1 / inverse >= 1, and at most 1.
HWY_INLINE V PowerOfInverse(int k, V inverse) {
    const V x2 = hn::Mul(inverse, inverse), x4 = hn::Mul(x2, x2);
    const V power = k == 4 ? x4 : hn::Mul(x4, k == 5 ? inverse : k == 6 ? x2 : x4);
    return hn::Min(hn::Mul(power, Set(kLoose)), Set(1));
}
/// sqrt(x^2 - 1), without a difference of rounded numbers.
HWY_INLINE V Sinh(V x) {
    return hn::Sqrt(hn::Mul(hn::Sub(x, Set(1)), hn::Add(x, Set(1))));
}
/// At least e^(-K m), for x = cosh(m).
HWY_INLINE V Decay(int k, V x) {
    return PowerOfInverse(k, Reciprocal(hn::Add(x, Sinh(x))));
}

struct AxisError {
    V value, linear;
};

/// Relative interpolation error of (x0 + s)^-b, 0 < b <= 2, and of s times it, on [-1, 1]:
/// morph/near_far_interpolation.cpp proves it.
template <bool kAboveOne>
HWY_INLINE AxisError BesideError(int k, V x) {
    const V one = Set(1);
    const V y = Decay(k, x);
    const V g = hn::Div(hn::Add(y, y), TimesPlus(y, y, one));
    V e = g;
    if constexpr (kAboveOne) {
        // (1 + K tanh(m / 2)) / cosh(K m), which falls from K m = 1/2 on (its logarithm's slope is at most K
        // / 2 / (1 + K tanh(m / 2)) - K tanh(K m)), and so does x times it. Before that it is below 1.12, and
        // x below 1.01: 1.3 stands for both.
        e = TimesPlus(hn::Mul(g, Set(static_cast<float>(k))),
                      hn::Sqrt(hn::Div(hn::Sub(x, one), hn::Add(x, one))), g);
        e = hn::IfThenElse(hn::Gt(y, Set(0.6f)), Set(1.3f), e);
    }
    return {e, hn::Mul(x, hn::Add(g, e))};
}

/// Relative interpolation error of (a + |s - z|)^-b, and of s times it, on [-1, 1], with z = sigma + i eta,
/// the end of a line beside the cell. sigma and eta are at most `more` below what they are.
HWY_INLINE AxisError EndError(int k, V sigma, V eta, V more) {
    const V one = Set(1);
    const V eta2 = hn::Mul(eta, eta), minus = hn::Sub(sigma, one), plus = hn::Add(sigma, one);
    const V a = hn::Mul(
        Set(0.5f), hn::Add(hn::Sqrt(TimesPlus(minus, minus, eta2)), hn::Sqrt(TimesPlus(plus, plus, eta2))));
    // Not farther off than it is.
    const V y = Decay(k, hn::Max(hn::Mul(a, Set(kTight)), one));
    const V g = hn::Div(hn::Add(y, y), hn::Mul(hn::Sub(one, y), hn::Add(one, y)));
    // The slope of the linear factor: by its value over eta, or by the derivative on the real axis.
    const V s1 = hn::Max(sigma, one), ys = Decay(k, s1), ys2 = hn::Mul(ys, ys);
    const V below = hn::Mul(hn::Sub(one, ys), hn::Add(one, ys));
    const V derivative = hn::Div(hn::Mul(hn::Mul(Set(static_cast<float>(2 * k)), ys), hn::Add(one, ys2)),
                                 hn::Mul(Sinh(s1), hn::Mul(below, below)));
    const V slope = hn::IfThenElse(hn::Ge(eta, one), hn::Div(g, hn::Max(eta, one)), derivative);
    // What grows with sigma and eta.
    const V reach = hn::Add(plus, more), most = hn::Max(hn::Add(eta, more), reach);
    const V value = TimesPlus(reach, slope, g);
    return {value, TimesPlus(slope, TimesPlus(reach, reach, hn::Mul(most, most)), value)};
}

/// Both axes together, interpolating along the worse one last.
HWY_INLINE AxisError Both(const AxisError& s, const AxisError& t, V lebesgue) {
    const auto swap = hn::Lt(s.value, t.value);
    const V value = TimesPlus(lebesgue, hn::Min(s.value, t.value), hn::Max(s.value, t.value));
    const V linear = hn::IfThenElse(swap, TimesPlus(lebesgue, s.linear, t.linear),
                                    TimesPlus(lebesgue, t.linear, s.linear));
    return {value, linear};
}

/// A vector of lines as seen from a cell's centre.
struct SeenLines {
    HWY_INLINE SeenLines() {
    }  // of the instruction set, which GCC does not give constructors that it writes itself

    V along_x, along_y, before, behind, beside;
    V far;       ///< dist
    V rounding;  ///< of their places
    V nearest;   ///< a + dist, the least in the cell
};

/// What interpolating (a + dist)^-b on a cell is made of, the same for all lines.
struct CellBounds {
    HWY_INLINE CellBounds(const CellFrame& cell, const WeightParameters& weights, int degree, float lebesgue)
        : k(degree), b(weights.b), a(Set(weights.a)), half(Set(cell.half)), constant(Set(lebesgue)) {
        // 1.41422 is above sqrt(2) by more than 70 u of it.
        diagonal = Set(cell.half * 1.41422f);
        unit = Set(1 / cell.half);
        tiny = Set(cell.half * 1e-6f);
        // Bounds of the second and third derivatives of (a + r)^-b along a line, times (r / half side)^2 and
        // ^3 over the function, times the interpolation's constant on both axes.
        const float b1 = b < 1 ? HWY_MAX(b + 1, 2 / std::sqrt(2 - b)) : b + 1;
        const float axes = third_error(k) * (1 + lebesgue);
        jump = Set(jump_error(k) * b);
        second = Set(axes * 3 * b * (b + 1));
        third = Set(axes * b * (b + 2) * b1);
    }

    int k;
    float b;
    V a, half, constant, diagonal;
    V unit;  ///< 1 / half
    V tiny;  ///< in place of 0, which is divided by: a pole taken too near is on the safe side
    V jump, second, third;
};

/// From anywhere but on the line itself: its ends' levels are jumps of the second derivative.
HWY_INLINE AxisError JumpError(const CellBounds& c, const SeenLines& l, V extent) {
    const V one = Set(1), infinite = Set(HUGE_VALF);
    const V clear = hn::Sub(hn::Sub(l.far, c.diagonal), l.rounding);
    const V apart = hn::Max(clear, Set(kPlaceApart)), size = hn::Div(c.half, apart),
            size2 = hn::Mul(size, size);
    const V larger = hn::Max(hn::Mul(l.along_x, l.along_x), hn::Mul(l.along_y, l.along_y));
    const V jumps = hn::Add(hn::IfThenElseZero(hn::Lt(hn::Abs(l.before), extent), one),
                            hn::IfThenElseZero(hn::Lt(hn::Abs(l.behind), extent), one));
    const V jump = hn::Mul(hn::Mul(jumps, hn::Mul(size, hn::Div(c.half, l.nearest))),
                           TimesPlus(larger, hn::Sub(one, c.constant), c.constant));
    const V third = hn::Mul(size2, hn::Mul(size, c.third));
    const V value = TimesPlus(jump, c.jump, third);
    const V linear = TimesPlus(size2, c.second, value);
    const auto is_apart = hn::Gt(clear, Set(kPlaceApart));
    return {hn::IfThenElse(is_apart, value, infinite), hn::IfThenElse(is_apart, linear, infinite)};
}

/// Beside the line, by its pole along either axis.
HWY_INLINE AxisError LineError(const CellBounds& c, const SeenLines& l, V hx, V hy) {
    const V one = Set(1), distance = hn::Sub(hn::Add(c.a, hn::Abs(l.beside)), l.rounding);
    const auto pole = [&](V apart_by, V by) HWY_ATTR {
        return hn::Max(hn::Mul(Set(kTight), hn::Div(apart_by, hn::Max(by, c.tiny))), one);
    };
    const V xs = pole(hn::Sub(distance, hx), hy), xt = pole(hn::Sub(distance, hy), hx);
    return c.b > 1 ? Both(BesideError<true>(c.k, xs), BesideError<true>(c.k, xt), c.constant)
                   : Both(BesideError<false>(c.k, xs), BesideError<false>(c.k, xt), c.constant);
}

/// In closed form: beside the line, on one side of it, from end to end; or beyond an end, seen from
/// everywhere in the cell.
HWY_INLINE AxisError ClosedError(const CellBounds& c, const SeenLines& l, V hx, V hy, V extent) {
    const V zero = Set(0), one = Set(1), infinite = Set(HUGE_VALF);
    const auto is_beside =
        hn::And(hn::And(hn::Lt(l.before, hn::Neg(extent)), hn::Lt(l.behind, hn::Neg(extent))),
                hn::Gt(hn::Abs(l.beside), extent));
    const AxisError by_line = LineError(c, l, hx, hy);
    const auto is_beyond = hn::Gt(hn::Max(l.before, l.behind), extent);
    const V z = hn::IfThenElse(hn::Gt(l.before, l.behind), l.before, hn::Neg(l.behind));
    const V room = hn::Mul(l.rounding, c.unit), more = hn::Add(room, room);
    const auto seen = [&](V at)
                          HWY_ATTR { return hn::Max(hn::Sub(hn::Mul(hn::Abs(at), c.unit), room), zero); };
    const V px = seen(TimesPlus(z, l.along_x, hn::Mul(l.beside, l.along_y)));
    const V py = seen(TimesMinus(z, l.along_y, hn::Mul(l.beside, l.along_x)));
    const V ex = hn::Max(hn::Sub(px, one), zero), ey = hn::Max(hn::Sub(py, one), zero);
    const AxisError by_end = Both(EndError(c.k, px, ey, more), EndError(c.k, py, ex, more), c.constant);
    const auto outside = hn::And(is_beyond, hn::Gt(hn::Max(px, py), Set(1.05f)));
    const auto either = [&](V line, V end) HWY_ATTR {
        return hn::IfThenElse(is_beside, line, hn::IfThenElse(outside, end, infinite));
    };
    return {either(by_line.value, by_end.value), either(by_line.linear, by_end.linear)};
}

/// The interpolation error on both axes.
HWY_INLINE AxisError InterpolationError(const CellBounds& c, const SeenLines& l) {
    if (!(c.b > 0)) return {Set(0), Set(0)};
    const V hx = hn::Mul(c.half, hn::Abs(l.along_x)), hy = hn::Mul(c.half, hn::Abs(l.along_y));
    const V extent = hn::Add(hn::Add(hx, hy), l.rounding);
    const AxisError any = JumpError(c, l, extent);
    if (!(c.b <= 2)) return any;
    const AxisError closed = ClosedError(c, l, hx, hy, extent);
    return {hn::Min(any.value, closed.value), hn::Min(any.linear, closed.linear)};
}

template <Exponent kExponent>
HWY_INLINE void BoundLines(const LineTable& lines, const CellFrame& cell, const WeightParameters& weights,
                           int k, float lebesgue, LineBounds& out) {
    const Floats d;
    const CellBounds c(cell, weights, k, lebesgue);
    const V x = Set(cell.x), y = Set(cell.y), zero = Set(0);
    const V b = Set(weights.b), least_distance = Set(kLeastDistance);
    const auto weight_margin =
        static_cast<float>(2 * kFloatRounding * weight_rounding(weights.b, weights.log));
    const V loose = Set(1 + weight_margin), tight = Set(1 - weight_margin), closed_form = Set(kLoose);
    // What rounding at the nodes does to a weight, in proportion (that of its place: over a + dist), and to a
    // displacement per pixel of its change; the interpolant has Lebesgue_K^2 of it.
    const float amplified = lebesgue * lebesgue * kLoose;
    const V rounded =
        Set(amplified *
            static_cast<float>(kNodeRounding + kFloatRounding * weight_rounding(weights.b, weights.log)));
    const V misplaced = Set(amplified * 11 * kRegionHalf * kFloatRounding * weights.b);
    const V displaced = Set(amplified * 10 * kRegionHalf * kFloatRounding);
    Wide sums[kSums], least_sum;
    for (int i = 0; i < lines.count; i += kLanes) {
        const auto field = [&](int f) HWY_ATTR { return hn::LoadU(d, lines.data + f * lines.stride + i); };
        SeenLines l;
        l.along_x = field(LineTable::kAlongX);
        l.along_y = field(LineTable::kAlongY);
        const V factor = hn::LoadU(d, lines.factor + i);
        const V along = TimesPlus(l.along_x, x, hn::Mul(l.along_y, y));
        l.before = hn::Sub(field(LineTable::kBefore), along);
        l.behind = hn::Add(field(LineTable::kBehind), along);
        l.beside = hn::Add(field(LineTable::kBeside), TimesMinus(l.along_x, y, hn::Mul(l.along_y, x)));
        l.far = Distance(l.before, l.behind, l.beside);

        // Distances change by no more than the way.
        l.rounding = TimesPlus(l.far, Set(kPlaceRelative), Set(kPlaceApart));
        const V clear = hn::Max(hn::Sub(hn::Sub(l.far, c.diagonal), l.rounding), zero);
        l.nearest = hn::Max(hn::Add(c.a, clear), least_distance);
        const V farthest = hn::Add(c.a, hn::Add(hn::Add(l.far, c.diagonal), l.rounding));
        const V most = hn::Mul(hn::Mul(factor, loose), Power<kExponent>(l.nearest, b));
        const V least = hn::Mul(hn::Mul(factor, tight), Power<kExponent>(farthest, b));
        const V weight = hn::Mul(factor, Power<kExponent>(hn::Max(hn::Add(c.a, l.far), least_distance), b));
        hn::StoreU(most, d, out.most + i);
        hn::StoreU(l.nearest, d, out.nearest + i);
        hn::StoreU(least, d, out.least + i);
        least_sum.At(i) = hn::Add(least_sum.At(i), least);
        sums[0].At(i) = hn::Add(sums[0].At(i), weight);
        for (int n = 0; n < kComponents; ++n) {
            const V at = TimesPlus(field(LineTable::kRight + n), x,
                                   TimesPlus(field(LineTable::kDown + n), y, field(LineTable::kAt + n)));
            hn::StoreU(at, d, out.displacement[n] + i);
            sums[n + 1].At(i) = TimesPlus(weight, at, sums[n + 1].At(i));
        }

        const AxisError error = InterpolationError(c, l);
        const V value = hn::Add(error.value, hn::Add(rounded, hn::Div(misplaced, l.nearest)));
        const V change = hn::Mul(TimesPlus(c.half, error.linear, displaced), field(LineTable::kSlope));
        // Lines of factor 0 fill up the last vector.
        const auto real = hn::Gt(factor, zero);
        const V whole = hn::Mul(most, closed_form);
        hn::StoreU(hn::IfThenElse(real, hn::Mul(whole, value), zero), d, out.value + i);
        hn::StoreU(hn::IfThenElse(real, hn::Mul(whole, change), zero), d, out.linear + i);
    }
    for (int n = 0; n < kSums; ++n) out.center[n] = static_cast<double>(sums[n].Sum());
    out.least_sum = static_cast<double>(least_sum.Sum());
}

void BoundLinesOf(const LineTable& lines, const CellFrame& cell, const WeightParameters& weights, int k,
                  float lebesgue, LineBounds& out) {
    WithExponent(weights.b, [&](auto exponent) HWY_ATTR {
        BoundLines<decltype(exponent)::value>(lines, cell, weights, k, lebesgue, out);
    });
}

/// LineSums of a few lines, lane by lane.
struct LaneSums {
    Wide value, error, least, most, reach, slope, near, near_reach, farthest;

    // Written out, so that it is compiled for the instruction set.
    HWY_INLINE LaneSums() {}  // NOLINT
    HWY_INLINE void AddTo(LineSums& sums) const {
        const auto add = [](double& to, const Wide& from) { to += static_cast<double>(from.Sum()); };
        add(sums.value, value);
        add(sums.error, error);
        add(sums.least, least);
        add(sums.most, most);
        add(sums.reach, reach);
        add(sums.slope, slope);
        add(sums.near, near);
        add(sums.near_reach, near_reach);
        sums.farthest = HWY_MAX(sums.farthest, static_cast<double>(farthest.Max()));
    }
};

void BoundDisplacements(const LineTable& lines, const CellFrame& cell, const float* center, float much,
                        float offset, const LineBounds& bounds, float* reach, float* error,
                        SpreadSums& sums) {
    const Floats d;
    const V zero = Set(0), infinite = Set(HUGE_VALF);
    // Displacements err by u (4 |value| + 10 kRegionHalf slope): in proportion, by the reference and by the
    // slope.
    float reference = 0;
    for (int c = 0; c < kComponents; ++c) reference = HWY_MAX(reference, std::fabs(center[c]));
    const V by_reference = Set(8 * kFloatRounding * reference);
    const V by_slope = Set(cell.half + 12 * kFloatRounding * kRegionHalf);
    Wide heavy, light, farthest, all_most, all_reach, slope, near_reach;
    for (int i = 0; i < lines.count; i += kLanes) {
        V square = zero;
        for (int c = 0; c < kComponents; c += 2) {
            const V dx = hn::Sub(hn::LoadU(d, bounds.displacement[c] + i), Set(center[c]));
            const V dy = hn::Sub(hn::LoadU(d, bounds.displacement[c + 1] + i), Set(center[c + 1]));
            square = hn::Max(square, TimesPlus(dx, dx, hn::Mul(dy, dy)));
        }
        const V m = hn::LoadU(d, bounds.most + i);
        const auto real = hn::Gt(hn::LoadU(d, lines.factor + i), zero);
        const V distance = TimesPlus(hn::Sqrt(square), Set(kLoose), by_reference);
        const V change = hn::LoadU(d, lines.data + LineTable::kSlope * lines.stride + i);
        const V r = hn::IfThenElseZero(real, hn::Mul(TimesPlus(by_slope, change, distance), Set(kLoose)));
        hn::StoreU(r, d, reach + i);
        const V value = hn::LoadU(d, bounds.value + i), linear = hn::LoadU(d, bounds.linear + i);
        // An unknown error stays so, whatever the displacement.
        const auto known = hn::Lt(value, infinite);
        hn::StoreU(
            hn::IfThenElse(known, TimesPlus(value, distance, TimesPlus(m, Set(offset), linear)), infinite), d,
            error + i);

        const V near = hn::Div(m, hn::LoadU(d, bounds.nearest + i));
        const auto is_light = hn::Le(m, Set(much));
        const V moment = hn::Mul(m, r), near_moment = hn::Mul(near, r);
        const auto add = [&](Wide& sum, V v) HWY_ATTR { sum.At(i) = hn::Add(sum.At(i), v); };
        const auto most = [&](Wide& sum, V v) HWY_ATTR { sum.At(i) = hn::Max(sum.At(i), v); };
        most(heavy, hn::IfThenZeroElse(is_light, r));
        add(light, hn::IfThenElseZero(is_light, moment));
        most(farthest, r);
        add(all_most, m);
        add(all_reach, moment);
        add(near_reach, near_moment);
        add(slope, hn::Mul(m, change));
    }
    sums.heavy = HWY_MAX(sums.heavy, static_cast<double>(heavy.Max()));
    sums.light += static_cast<double>(light.Sum());
    sums.farthest = HWY_MAX(sums.farthest, static_cast<double>(farthest.Max()));
    sums.most += static_cast<double>(all_most.Sum());
    sums.reach += static_cast<double>(all_reach.Sum());
    sums.slope += static_cast<double>(slope.Sum());
    sums.near_reach += static_cast<double>(near_reach.Sum());
}

/// Marks the least parts, which add up to 1 at most: those are 0 afterwards, and the others above it.
HWY_INLINE void MarkLeast(int count, float* part) {
    const Floats d;
    // All up to a power of two that fit together.
    float most = 1, used = 0;
    for (int cut = 0; cut < 40; ++cut, most *= 0.5f) {
        Wide sum;
        for (int i = 0; i < count; i += kLanes) {
            const V p = hn::LoadU(d, part + i);
            sum.At(i) = hn::Add(sum.At(i), hn::IfThenElseZero(hn::Le(p, Set(most)), p));
        }
        used = sum.Sum();
        if (used <= 1) break;
    }
    if (used > 1) return;
    for (int i = 0; i < count; i += kLanes) {
        const V p = hn::LoadU(d, part + i);
        hn::StoreU(hn::IfThenZeroElse(hn::Le(p, Set(most)), p), d, part + i);
        // And of the next ones what fits.
        if (most < 1 && !hn::AllFalse(d, hn::And(hn::Gt(p, Set(most)), hn::Le(p, Set(2 * most)))))
            for (int j = i; j < i + kLanes; ++j)
                if (part[j] > most && part[j] <= 2 * most && used + part[j] <= 1) {
                    used += part[j];
                    part[j] = 0;
                }
    }
}

/// The chosen lines' places behind `first`; the rest of the vector is written over. Returns how many.
template <class Chosen>
HWY_INLINE int Places(Chosen chosen, int first, int32_t* to) {
    const hn::RebindToSigned<Floats> di;
    // Compressed in a register: storing compressed numbers is slow on some processors.
    hn::StoreU(hn::Compress(hn::Iota(di, first), hn::RebindMask(di, chosen)), di, to);
    return static_cast<int>(hn::CountTrue(Floats(), chosen));
}

Selection SelectLines(const LineTable& lines, const LineBounds& bounds, const float* reach,
                      const float* error, float spread, float unit, float* part, int32_t* near,
                      int32_t* far) {
    const Floats d;
    const V zero = Set(0);
    for (int i = 0; i < lines.count; i += kLanes) {
        const V whole = TimesPlus(Set(spread), hn::LoadU(d, bounds.value + i), hn::LoadU(d, error + i));
        hn::StoreU(hn::Mul(Set(unit), whole), d, part + i);
    }
    MarkLeast(lines.count, part);
    Selection out;
    constexpr int kRun = kSumLanes * kWide;  // so that floats add up few numbers
    for (int first = 0; first < lines.count; first += kRun) {
        LaneSums sums;
        for (int i = first; i < HWY_MIN(first + kRun, lines.count); i += kLanes) {
            const V m = hn::LoadU(d, bounds.most + i);
            const auto real = hn::Gt(hn::LoadU(d, lines.factor + i), zero);
            const auto is_far = hn::And(real, hn::Eq(hn::LoadU(d, part + i), zero));
            out.near += Places(hn::AndNot(is_far, real), i, near + out.near);
            out.far += Places(is_far, i, far + out.far);
            const auto add = [&](Wide& sum, V v)
                                 HWY_ATTR { sum.At(i) = hn::Add(sum.At(i), hn::IfThenElseZero(is_far, v)); };
            const V r = hn::LoadU(d, reach + i), m_near = hn::Div(m, hn::LoadU(d, bounds.nearest + i));
            add(sums.value, hn::LoadU(d, bounds.value + i));
            add(sums.error, hn::LoadU(d, error + i));
            add(sums.least, hn::LoadU(d, bounds.least + i));
            add(sums.most, m);
            add(sums.reach, hn::Mul(m, r));
            add(sums.slope, hn::Mul(m, hn::LoadU(d, lines.data + LineTable::kSlope * lines.stride + i)));
            add(sums.near, m_near);
            add(sums.near_reach, hn::Mul(m_near, r));
            sums.farthest.At(i) = hn::Max(sums.farthest.At(i), hn::IfThenElseZero(is_far, r));
        }
        sums.AddTo(out.sums);
    }
    return out;
}

// --- sums --------------------------------------------------------------------------------------------------

/// Adds what one line says about points.
template <Exponent kExponent>
HWY_INLINE void AddLineAt(const FieldLine& l, V x, V y, V a, V b, V* HWY_RESTRICT sums) {
    const V ux = Set(l.along_x), uy = Set(l.along_y);
    const V along = TimesPlus(ux, x, hn::Mul(uy, y));
    const V before = hn::Sub(Set(l.before), along), behind = hn::Add(Set(l.behind), along);
    const V beside = hn::Add(Set(l.beside), TimesMinus(ux, y, hn::Mul(uy, x)));
    const V far = hn::Max(hn::Add(a, Distance(before, behind, beside)), Set(kLeastDistance));
    const V weight = hn::Mul(Set(l.factor), Power<kExponent>(far, b));
    sums[0] = hn::Add(sums[0], weight);
    for (int c = 0; c < kComponents; ++c)
        sums[c + 1] = TimesPlus(
            weight, TimesPlus(Set(l.right[c]), x, TimesPlus(Set(l.down[c]), y, Set(l.at[c]))), sums[c + 1]);
}

template <Exponent kExponent>
HWY_INLINE void NodeSums(const FieldLine* lines, const int32_t* which, int count, const CellFrame& cell,
                         const WeightParameters& weights, int k, const float* nodes, double* sums) {
    // Floats are added up over few lines only.
    constexpr int kRun = kNodeRun;
    const Floats d;
    const int points = k * k;
    HWY_ALIGN float x[kMaxDegree * kMaxDegree], y[kMaxDegree * kMaxDegree], part[kLanes];
    for (int n = 0; n < (points + 15) / 16 * 16; ++n) {
        const int at = n < points ? n : 0;
        x[n] = cell.x + cell.half * nodes[at % k];
        y[n] = cell.y + cell.half * nodes[at / k];
    }
    const V a = Set(weights.a), b = Set(weights.b);
    for (int first = 0; first < count; first += kRun) {
        const int last = HWY_MIN(count, first + kRun);
        for (int n = 0; n < points; n += kLanes) {
            const V vx = hn::Load(d, x + n), vy = hn::Load(d, y + n);
            V s[kSums];
            for (V& v : s) v = Set(0);
            for (int i = first; i < last; ++i) AddLineAt<kExponent>(lines[which[i]], vx, vy, a, b, s);
            const int lanes = HWY_MIN(kLanes, points - n);
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
        NodeSums<decltype(exponent)::value>(lines, which, count, cell, weights, k, nodes, sums);
    });
}

#if HWY_HAVE_FLOAT64 && HWY_TARGET != HWY_SCALAR
using Doubles = hn::CappedTag<double, 8>;
#else
using Doubles = hn::CappedTag<double, 1>;
#endif

/// kUpper: left and right are 0 below the diagonal.
template <int K, bool kUpper>
HWY_INLINE void TransformDegree(const double* left, const double* right, const double* HWY_RESTRICT from,
                                const double* HWY_RESTRICT more, double* HWY_RESTRICT to) {
    const Doubles d;
    constexpr int kStep = static_cast<int>(hn::MaxLanes(d));
    HWY_ALIGN double between[K * K * 8];
    for (int lane = 0; lane < 8; lane += kStep) {
        for (int m = 0; m < K; ++m)
            for (int i = 0; i < K; ++i) {
                const int first = kUpper ? m : 0;
                const double* at = from + i * 8 + lane;
                auto sum = hn::Mul(hn::Set(d, left[m * K + first]), hn::LoadU(d, at + first * K * 8));
                for (int j = first + 1; j < K; ++j)
                    sum = TimesPlus(hn::Set(d, left[m * K + j]), hn::LoadU(d, at + j * K * 8), sum);
                hn::Store(sum, d, between + (m * K + i) * 8 + lane);
            }
        for (int m = 0; m < K; ++m)
            for (int n = 0; n < K; ++n) {
                const int first = kUpper ? n : 0;
                const double* at = between + m * K * 8 + lane;
                auto sum = hn::Mul(hn::Set(d, right[n * K + first]), hn::Load(d, at + first * 8));
                if (more) sum = hn::Add(sum, hn::LoadU(d, more + (m * K + n) * 8 + lane));
                for (int i = first + 1; i < K; ++i)
                    sum = TimesPlus(hn::Set(d, right[n * K + i]), hn::Load(d, at + i * 8), sum);
                hn::StoreU(sum, d, to + (m * K + n) * 8 + lane);
            }
    }
}

void Transform(const double* left, const double* right, int k, const double* from, const double* more,
               double* to) {
    if (k == 4) return TransformDegree<4, false>(left, right, from, more, to);
    if (k == 5) return TransformDegree<5, false>(left, right, from, more, to);
    if (k == 6) return TransformDegree<6, false>(left, right, from, more, to);
    TransformDegree<8, false>(left, right, from, more, to);
}
void Shift(const double* left, const double* right, int k, const double* from, double* to) {
    if (k == 4) return TransformDegree<4, true>(left, right, from, nullptr, to);
    if (k == 5) return TransformDegree<5, true>(left, right, from, nullptr, to);
    if (k == 6) return TransformDegree<6, true>(left, right, from, nullptr, to);
    TransformDegree<8, true>(left, right, from, nullptr, to);
}

void RoundCoefficients(const double* from, int k, float* to, float* sizes) {
    const Doubles d;
    const hn::Rebind<float, Doubles> df;
    constexpr int kStep = static_cast<int>(hn::MaxLanes(d));
    for (int lane = 0; lane < 8; lane += kStep) {
        auto size = hn::Zero(df);
        for (int i = lane; i < 8 * k * k; i += 8) {
            const auto v = hn::DemoteTo(df, hn::LoadU(d, from + i));
            hn::StoreU(v, df, to + i);
            size = hn::Add(size, hn::Abs(v));
        }
        hn::StoreU(size, df, sizes + lane);
    }
}

// --- pixels ------------------------------------------------------------------------------------------------

/// Near lines on rows of pixels: 16 numbers each, at y = 0 and per pixel down.
class LineRows {
  public:
    enum At { kBefore, kBehind, kBeside, kAt, kAlongX = kAt + kComponents, kAlongY, kFactor, kRight };
    // What a fine row has beside them.
    enum AtFine { kBeforeRest, kBehindRest, kBesideRest, kAlongXRest, kAlongYRest };
    static constexpr int kMost = kNearRun;

    HWY_INLINE void See(const FieldLine* lines, int count) {
        m_lines = lines;
        m_count = count;
        for (int i = 0; i < count; ++i) {
            const FieldLine& l = lines[i];
            float *at = m_start + 16 * i, *down = m_down + 16 * i;
            for (int j = 0; j < 16; ++j) at[j] = down[j] = 0;
            at[kBefore] = l.before;
            at[kBehind] = l.behind;
            at[kBeside] = l.beside;
            at[kAlongX] = l.along_x;
            at[kAlongY] = l.along_y;
            at[kFactor] = l.factor;
            down[kBefore] = -l.along_y;
            down[kBehind] = l.along_y;
            down[kBeside] = l.along_x;
            for (int c = 0; c < kComponents; ++c) {
                at[kAt + c] = l.at[c];
                at[kRight + c] = l.right[c];
                down[kAt + c] = l.down[c];
            }
        }
    }

    template <bool kFine>
    HWY_INLINE void Move(float y) {
        const Floats d;
        for (int i = 0; i < 16 * m_count; i += kLanes)
            hn::Store(TimesPlus(Set(y), hn::Load(d, m_down + i), hn::Load(d, m_start + i)), d, m_row + i);
        if constexpr (kFine)
            for (int i = 0; i < m_count; ++i) Split(i, y);
    }
    const float* Row(int i) const { return m_row + 16 * i; }
    const float* Rest(int i) const { return m_rest + 8 * i; }

  private:
    /// Positions and direction as multiples of 2^-13, and the rest.
    HWY_INLINE void Split(int i, float y) {
        const FieldLine& l = m_lines[i];
        float *row = m_row + 16 * i, *rest = m_rest + 8 * i;
        const auto put = [&](int at, int at_rest, double value) HWY_ATTR {
            constexpr double kGrid = 0x1p13;
            row[at] = static_cast<float>(std::nearbyint(value * kGrid) / kGrid);
            rest[at_rest] = static_cast<float>(value - static_cast<double>(row[at]));
        };
        const auto whole = [](float a, float b)
                               HWY_ATTR { return static_cast<double>(a) + static_cast<double>(b); };
        const double ux = whole(l.along_x, l.along_x_rest), uy = whole(l.along_y, l.along_y_rest);
        const double dy = static_cast<double>(y);
        put(kBefore, kBeforeRest, whole(l.before, l.before_rest) - uy * dy);
        put(kBehind, kBehindRest, whole(l.behind, l.behind_rest) + uy * dy);
        put(kBeside, kBesideRest, whole(l.beside, l.beside_rest) + ux * dy);
        put(kAlongX, kAlongXRest, ux);
        put(kAlongY, kAlongYRest, uy);
    }

    const FieldLine* m_lines = nullptr;
    int m_count = 0;
    HWY_ALIGN float m_start[16 * kMost], m_down[16 * kMost], m_row[16 * kMost], m_rest[8 * kMost];
};

/// Adds what one line says about the pixels at x of a row.
template <Exponent kExponent, bool kFine, int kCount>
HWY_INLINE void AddLine(const float* row, const float* rest, V x, V a, V b, V* HWY_RESTRICT sums) {
    const V along = hn::Mul(Set(row[LineRows::kAlongX]), x);
    V before = hn::Sub(Set(row[LineRows::kBefore]), along);
    V behind = hn::Add(Set(row[LineRows::kBehind]), along);
    V beside = hn::Sub(Set(row[LineRows::kBeside]), hn::Mul(Set(row[LineRows::kAlongY]), x));
    if constexpr (kFine) {
        const V along_rest = hn::Mul(Set(rest[LineRows::kAlongXRest]), x);
        before = hn::Add(before, hn::Sub(Set(rest[LineRows::kBeforeRest]), along_rest));
        behind = hn::Add(behind, hn::Add(Set(rest[LineRows::kBehindRest]), along_rest));
        beside = hn::Add(
            beside, hn::Sub(Set(rest[LineRows::kBesideRest]), hn::Mul(Set(rest[LineRows::kAlongYRest]), x)));
    }
    const V far = hn::Max(hn::Add(a, Distance(before, behind, beside)), Set(kLeastDistance));
    const V weight = hn::Mul(Set(row[LineRows::kFactor]), Power<kExponent>(far, b));
    sums[0] = hn::Add(sums[0], weight);
    for (int c = 0; c < kCount; ++c)
        sums[c + 1] = TimesPlus(
            weight, TimesPlus(Set(row[LineRows::kRight + c]), x, Set(row[LineRows::kAt + c])), sums[c + 1]);
}

/// The far lines' sums on every row of a cell, as polynomials in s.
class PolynomialRows {
  public:
    static constexpr int kMostRows = 64;

    HWY_INLINE PolynomialRows(const FieldCell& cell, float y, int height) : m_k(cell.k) {
        if (m_k == 4) Fill<4>(cell, y, height);
        if (m_k == 5) Fill<5>(cell, y, height);
        if (m_k == 6) Fill<6>(cell, y, height);
        if (m_k == 8) Fill<8>(cell, y, height);
    }
    template <int kCount>
    HWY_INLINE void At(int row, V s, V* HWY_RESTRICT sums) const {
        const float* at = m_rows + (row + 1) * 8 * m_k - 8;
        for (int c = 0; c <= kCount; ++c) sums[c] = Set(at[c]);
        for (int m = m_k - 1; m > 0; --m) {
            at -= 8;
            for (int c = 0; c <= kCount; ++c) sums[c] = TimesPlus(sums[c], s, Set(at[c]));
        }
    }

  private:
    template <int K>
    HWY_INLINE void Fill(const FieldCell& cell, float y, int height) {
        const hn::CappedTag<float, 8 * K % 16 ? 8 : 16> d;
        const float unit = 1 / cell.frame.half;
        for (int m = 0; m < 8 * K; m += static_cast<int>(hn::MaxLanes(d))) {
            hn::Vec<decltype(d)> c[K];
            for (int n = 0; n < K; ++n) c[n] = hn::LoadU(d, cell.coefficients + n * 8 * K + m);
            for (int j = 0; j < height; ++j) {
                const auto t = hn::Set(d, (y + static_cast<float>(j) - cell.frame.y) * unit);
                auto sum = c[K - 1];
                for (int n = K - 2; n >= 0; --n) sum = TimesPlus(sum, t, c[n]);
                hn::StoreU(sum, d, m_rows + j * 8 * K + m);
            }
        }
    }

    int m_k;
    HWY_ALIGN float m_rows[kMostRows * 8 * kMaxDegree];
};

template <Exponent kExponent, bool kFine, int kCount>
void FieldPoints(const FieldCell& cell, const FieldOutput& out) {
    constexpr int kWidth = 64;
    const Floats d;
    const V a = Set(cell.weights.a), b = Set(cell.weights.b), lanes = hn::Iota(d, 0.0f);
    const V unit = Set(1 / cell.frame.half), center = Set(cell.frame.x);
    const PolynomialRows polynomial(cell, out.y, out.height);
    LineRows rows;
    // Lines in parts of so many; sums wait here for the next part.
    HWY_ALIGN float waiting[kSums][kWidth];
    const int parts = HWY_MAX(1, (cell.near_count + LineRows::kMost - 1) / LineRows::kMost);
    for (int j = 0; j < out.height; ++j) {
        const float y = out.y + static_cast<float>(j);
        for (int part = 0; part < parts; ++part) {
            const int first = part * LineRows::kMost;
            const int count = HWY_MIN(LineRows::kMost, cell.near_count - first);
            if (j == 0 || parts > 1) rows.See(cell.near_lines + first, count);
            rows.Move<kFine>(y);
            for (int i = 0; i < out.width; i += kLanes) {
                const V x = hn::Add(lanes, Set(out.x + static_cast<float>(i)));
                V sums[kSums];
                for (V& s : sums) s = Set(0);
                if (part == 0 && cell.k > 0)
                    polynomial.At<kCount>(j, hn::Mul(hn::Sub(x, center), unit), sums);
                for (int n = 0; n < count; ++n)
                    AddLine<kExponent, kFine, kCount>(rows.Row(n), rows.Rest(n), x, a, b, sums);
                if (part > 0)
                    for (int c = 0; c <= kCount; ++c) sums[c] = hn::Add(sums[c], hn::Load(d, waiting[c] + i));
                if (part + 1 < parts) {
                    for (int c = 0; c <= kCount; ++c) hn::Store(sums[c], d, waiting[c] + i);
                    continue;
                }
                const V inverse = Reciprocal(sums[0]);
                for (int c = 0; c < kCount; ++c) {
                    // x + its displacement, or y and its.
                    const V identity = c & 1 ? Set(out.offset[c] + out.slope[c] * y)
                                             : TimesPlus(Set(out.slope[c]), x, Set(out.offset[c]));
                    hn::StoreU(TimesPlus(sums[c + 1], inverse, identity), d, out.to[c] + j * out.stride + i);
                }
            }
        }
    }
}

void FieldPointsOf(const FieldCell& cell, const FieldOutput& out) {
    WithExponent(cell.weights.b, [&](auto exponent) HWY_ATTR {
        constexpr Exponent kExponent = decltype(exponent)::value;
        if (out.components == 2)
            cell.fine ? FieldPoints<kExponent, true, 2>(cell, out)
                      : FieldPoints<kExponent, false, 2>(cell, out);
        else
            cell.fine ? FieldPoints<kExponent, true, 4>(cell, out)
                      : FieldPoints<kExponent, false, 4>(cell, out);
    });
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(BoundLinesOf);
HWY_EXPORT(BoundDisplacements);
HWY_EXPORT(SelectLines);
HWY_EXPORT(NodeSumsOf);
HWY_EXPORT(Transform);
HWY_EXPORT(Shift);
HWY_EXPORT(RoundCoefficients);
HWY_EXPORT(FieldPointsOf);

namespace {

/// Calls body(table, bounds, first) for so many lines at a time that floats add up few numbers.
template <class Body>
void each_part(const LineTable& lines, const LineBounds& bounds, const Body& body) {
    constexpr int kPart = kSumLanes * 16;
    for (int first = 0; first < lines.count; first += kPart) {
        LineBounds b = bounds;
        for (float** array : {&b.most, &b.least, &b.value, &b.linear, &b.nearest}) *array += first;
        for (float*& array : b.displacement) array += first;
        body(LineTable{lines.data + first, lines.stride, lines.factor + first,
                       std::min(kPart, lines.count - first)},
             b, first);
    }
}

}  // namespace

void bound_lines(const LineTable& lines, const CellFrame& cell, const WeightParameters& weights, int k,
                 float lebesgue, LineBounds& bounds) {
    bounds.least_sum = 0;
    std::fill_n(bounds.center, kSums, 0.0);
    each_part(lines, bounds, [&](const LineTable& table, LineBounds part, int) {
        HWY_DYNAMIC_DISPATCH(BoundLinesOf)(table, cell, weights, k, lebesgue, part);
        bounds.least_sum += part.least_sum;
        for (int c = 0; c < kSums; ++c) bounds.center[c] += part.center[c];
    });
}
SpreadSums bound_displacements(const LineTable& lines, const CellFrame& cell, const float* center, float much,
                               float offset, const LineBounds& bounds, float* reach, float* error) {
    SpreadSums sums;
    each_part(lines, bounds, [&](const LineTable& table, const LineBounds& part, int first) {
        HWY_DYNAMIC_DISPATCH(BoundDisplacements)
        (table, cell, center, much, offset, part, reach + first, error + first, sums);
    });
    return sums;
}
Selection select_lines(const LineTable& lines, const LineBounds& bounds, const float* reach,
                       const float* error, float spread, float unit, float* part, std::int32_t* near,
                       std::int32_t* far) {
    return HWY_DYNAMIC_DISPATCH(SelectLines)(lines, bounds, reach, error, spread, unit, part, near, far);
}
void node_sums(const FieldLine* lines, const std::int32_t* which, int count, const CellFrame& cell,
               const WeightParameters& weights, int k, const float* nodes, double* sums) {
    HWY_DYNAMIC_DISPATCH(NodeSumsOf)(lines, which, count, cell, weights, k, nodes, sums);
}
void transform(const double* left, const double* right, int k, const double* from, const double* more,
               double* to) {
    HWY_DYNAMIC_DISPATCH(Transform)(left, right, k, from, more, to);
}
void shift(const double* left, const double* right, int k, const double* from, double* to) {
    HWY_DYNAMIC_DISPATCH(Shift)(left, right, k, from, to);
}
void round_coefficients(const double* from, int k, float* to, float* sizes) {
    HWY_DYNAMIC_DISPATCH(RoundCoefficients)(from, k, to, sizes);
}
void field_points(const FieldCell& cell, const FieldOutput& output) {
    HWY_DYNAMIC_DISPATCH(FieldPointsOf)(cell, output);
}

}  // namespace anamorph::simd
#endif
