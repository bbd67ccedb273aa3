// SPDX-License-Identifier: Apache-2.0
// Functions of the C library, which plans are made with: rounded as the GNU C library of the desktop program rounds them. That is correct
// in all but one of a thousand values, and so are these, rounded from numbers of two doubles; musl's own are not in one of ten. The linker
// puts them in place of musl's (--wrap). The angle, which exact pixels take several times each, is a sum of two doubles that is quickly
// found, and a DoubleDouble where that leaves open which double is the nearest (Ziv 1991).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "anamorph/number/double_double.h"

using anamorph::DoubleDouble;

namespace {

/// upper + lower, of which lower is what rounding left of upper.
struct Pair {
    double upper, lower;
};
/// a + b where |a| >= |b| or a = 0 (Dekker 1971).
Pair sum_of_ordered(double a, double b) {
    const double sum = a + b;
    return {sum, b - (sum - a)};
}
/// a + b, whichever is larger (Knuth 1969).
Pair sum_of(double a, double b) {
    const double sum = a + b, of_b = sum - a;
    return {sum, (a - (sum - of_b)) + (b - of_b)};
}
/// a b (Dekker 1971), of numbers that Veltkamp's split of 27 bits does not make infinite.
Pair product_of(double a, double b) {
    const auto split = [](double v) {
        const double scaled = v * 0x8000001p0, upper = scaled - (scaled - v);
        return Pair{upper, v - upper};
    };
    const Pair p = split(a), q = split(b);
    const double product = a * b;
    return {product,
            ((p.upper * q.upper - product) + p.upper * q.lower + p.lower * q.upper) + p.lower * q.lower};
}
Pair pair_of(const DoubleDouble& v) {
    return {v.upper(), v.lower()};
}

constexpr int kAngles = 64;
/// The angles whose tangents are k/64.
const std::array<Pair, kAngles + 1>& angles() {
    static const std::array<Pair, kAngles + 1> all = [] {
        std::array<Pair, kAngles + 1> made;
        for (int k = 0; k <= kAngles; ++k)
            made[static_cast<std::size_t>(k)] = pair_of(atan2(DoubleDouble(k), kAngles));
        return made;
    }();
    return all;
}

/// The angle of less / more, of 0 < less <= more, as a pair that is off by less than 2^-63 of it: with c = k/64 near the quotient,
/// the angle of c and that of (less - c more) / (more + c less), of which |d| <= 1/128 + 2^-52. Of the series d - d^3/3 + ... all but
/// the first term is of double, below 2^-15.5 d and off by 4 roundings of it, 2^-66 d; what is left out is below d^11/11, 2^-73 d. The
/// quotient itself and the sums are off by some 2^-100.
Pair angle_of(double less, double more) {
    const int k = static_cast<int>(less / more * kAngles + 0.5);
    const double c = static_cast<double>(k) / kAngles;
    const Pair of_more = product_of(c, more), of_less = product_of(c, less);
    const Pair over = sum_of(less, -of_more.upper), under = sum_of_ordered(more, of_less.upper);
    const Pair numerator = sum_of(over.upper, over.lower - of_more.lower);
    const Pair denominator = sum_of_ordered(under.upper, under.lower + of_less.lower);
    const double d = numerator.upper / denominator.upper;
    const Pair back = product_of(d, denominator.upper);
    const double rest =
        ((numerator.upper - back.upper) - back.lower + numerator.lower - d * denominator.lower) /
        denominator.upper;
    const double square = d * d;
    const double tail =
        d * square * (-1.0 / 3 + square * (1.0 / 5 + square * (-1.0 / 7 + square * (1.0 / 9))));
    const Pair& angle = angles()[static_cast<std::size_t>(k)];
    const Pair sum = sum_of(angle.upper, d);
    return sum_of_ordered(sum.upper, sum.lower + (angle.lower + (rest + tail)));
}

struct SineAndCosine {
    DoubleDouble sine, cosine;

    explicit SineAndCosine(double x) { sin_cos(DoubleDouble(x), sine, cosine); }
};

}  // namespace

extern "C" {

double __real_sin(double x);
double __real_cos(double x);
double __real_tan(double x);
double __real_atan2(double y, double x);

/// Beyond what DoubleDouble takes as an angle, and of what is no angle, musl's have to do.
double __wrap_sin(double x) {
    if (!(std::fabs(x) <= DoubleDouble::kLargestAngle)) return __real_sin(x);
    return static_cast<double>(SineAndCosine(x).sine);
}
double __wrap_cos(double x) {
    if (!(std::fabs(x) <= DoubleDouble::kLargestAngle)) return __real_cos(x);
    return static_cast<double>(SineAndCosine(x).cosine);
}
double __wrap_tan(double x) {
    if (!(std::fabs(x) <= DoubleDouble::kLargestAngle)) return __real_tan(x);
    return static_cast<double>(tan(DoubleDouble(x)));
}
double __wrap_asin(double x) {
    return static_cast<double>(asin(DoubleDouble(x)));
}
double __wrap_acos(double x) {
    return static_cast<double>(acos(DoubleDouble(x)));
}
double __wrap_atan(double x) {
    return static_cast<double>(atan2(DoubleDouble(x), 1));
}
double __wrap_atan2(double y, double x) {
    const double across = std::fabs(x), down = std::fabs(y);
    const double less = std::min(across, down), more = std::max(across, down);
    // Neither number is extreme, nor is their ratio.
    if (!std::isunordered(x, y) && more < 0x1p500 && less > 0x1p-400 && less > more * 0x1p-100) {
        constexpr Pair turn{DoubleDouble::pi().upper(), DoubleDouble::pi().lower()};
        constexpr Pair right{turn.upper / 2, turn.lower / 2};
        Pair angle = angle_of(less, more);
        const auto less_than = [&](const Pair& whole) {
            const Pair sum = sum_of_ordered(whole.upper, -angle.upper);
            angle = sum_of_ordered(sum.upper, sum.lower + (whole.lower - angle.lower));
        };
        if (down > across) less_than(right);
        if (x < 0) less_than(turn);
        const double most = angle.upper * 0x1p-62;  // off by twice what angle_of() is
        const double rounded = angle.upper + (angle.lower - most);
        if (rounded == angle.upper + (angle.lower + most)) return std::copysign(rounded, y);
    }
    if (x == 0 || y == 0 || !std::isfinite(x) || !std::isfinite(y)) return __real_atan2(y, x);
    return static_cast<double>(atan2(DoubleDouble(y), DoubleDouble(x)));
}

}  // extern "C"
