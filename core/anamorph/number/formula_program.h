// SPDX-License-Identifier: Apache-2.0
// A formula as a program: a straight line of operations on the point (x, y), which is read with any number of number.h. There are
// no branches: both sides of a choice are computed.
//
// Unlike formulas that are compiled, a program may jump or have a crease wherever its text says so. Numbers that stand for all points of
// a box notice: where a choice is not the same for all of them, intervals hold both sides, what Rounded says counts their
// distance, and jets, whose derivatives end there, are not bounded. So the box is cut until it is decided, or exact.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <new>
#include <utility>
#include <vector>

#include "anamorph/number/interval.h"
#include "anamorph/number/jet.h"
#include "anamorph/number/jets.h"
#include "anamorph/number/number.h"
#include "anamorph/number/rounded.h"

namespace anamorph {

/// The operation that a step of a program computes from its operands a, b and c.
enum class StepKind : std::uint8_t {
    number,    ///< numbers[a]
    constant,  ///< constants[a]
    sum,
    difference,
    product,
    quotient,
    add_number,      ///< a + numbers[b]
    times_number,    ///< a * numbers[b]
    times_constant,  ///< a * constants[b]
    negation,
    square,
    sqrt,
    sine_and_cosine,  ///< results go to result and result + 1
    angle,            ///< angle of (b, a), a up, from -pi to pi
    exp,
    log,
    asinh,
    floor,
    choice  ///< b where a < 0, else c
};

/// A step of a program. Operands and results are numbers of registers.
struct ProgramStep {
    StepKind kind;
    std::uint8_t result, a = 0, b = 0, c = 0;
};

/// Computes numbers from x and y, which are registers 0 and 1.
struct FormulaProgram {
    /// The number of registers. They are reused; no program has more alive at once.
    static constexpr int kRegisters = 64;

    std::vector<ProgramStep> steps;
    std::vector<double> numbers;
    std::vector<Constant> constants;
    std::vector<std::uint8_t> outputs;
};

/// An interval that leaves out what has no root or no logarithm, and knows how far constants are off: of the values that a
/// program has for the members of x and y, all that are defined.
struct DefinedInterval : Interval {
    using Interval::Interval;
    DefinedInterval(const Interval& a) : Interval(a) {}  // NOLINT: it is one
    static DefinedInterval near(double value, double error) {
        return Interval(value) + Interval(-error, error);
    }
};
inline DefinedInterval sqrt(const DefinedInterval& a) {
    return sqrt(Interval(a.lo < 0 && a.hi >= 0 ? 0 : a.lo, a.hi));
}
/// sin and cos of an interval; all numbers where it is infinite.
inline void sin_cos(const DefinedInterval& a, DefinedInterval& s, DefinedInterval& c) {
    const bool is_finite = std::isfinite(magnitude(a));
    s = is_finite ? sin(a) : Interval::all();
    c = is_finite ? cos(a) : Interval::all();
}
inline DefinedInterval log(const DefinedInterval& a) {
    return log(Interval(a.lo < 0 && a.hi >= 0 ? 0 : a.lo, a.hi));
}

namespace program_detail {

using simd::FourConditions;
using simd::Jets;
using simd::kJets;

// --- choices ---

template <class T>
T choose(bool condition, const T& a, const T& b) {
    return condition ? a : b;
}
inline Interval choose(Certainty condition, const Interval& a, const Interval& b) {
    return select(condition, a, b);
}
/// Chooses one of two numbers. Where that is open, what is computed may be the one, and the exact value the
/// other.
template <class Real>
Rounded<Real> choose(Certainty condition, const Rounded<Real>& a, const Rounded<Real>& b) {
    Rounded<Real> r = select(condition, a, b);
    if (condition == Certainty::open)
        r.error += (r.range.hi - r.range.lo + a.radius + b.radius) * rounded_detail::kUp;
    return r;
}
template <int N>
Jet<Interval, N> unbounded() {
    Jet<Interval, N> r;
    for (Interval& c : r.c) c = Interval::all();
    return r;
}
template <int N>
Jet<Interval, N> choose(Certainty condition, const Jet<Interval, N>& a, const Jet<Interval, N>& b) {
    if (condition == Certainty::open) return unbounded<N>();
    return condition == Certainty::yes ? a : b;
}
/// Makes jet i of four unbounded.
template <int N>
void set_unbounded(Jets<Interval, N>& jets, int i) {
    // Coefficients above the degree are not stored: those of the others are 0.
    for (int k = jets.terms(); k < jets.kSize; ++k)
        for (int j = 0; j < kJets; ++j) jets.c[k].set(j, Interval(0));
    jets.degree = N;
    for (int k = 0; k < jets.kSize; ++k) jets.c[k].set(i, Interval::all());
}
template <int N>
Jets<double, N> choose(const FourConditions<bool>& condition, const Jets<double, N>& a,
                       const Jets<double, N>& b) {
    return select(condition, a, b);
}
template <int N>
Jets<Interval, N> choose(const FourConditions<Certainty>& condition, const Jets<Interval, N>& a,
                         const Jets<Interval, N>& b) {
    Jets<Interval, N> r = select(condition, a, b);
    for (int i = 0; i < kJets; ++i)
        if (condition.of[i] == Certainty::open) set_unbounded(r, i);
    return r;
}

// --- whole numbers ---

template <RealNumber T>
T floor_of(const T& a) {
    return floor(a);
}
inline Interval floor_of(const Interval& a) {
    return {std::floor(a.lo), std::floor(a.hi)};
}
/// The floor of a number. A whole number that lies within the error may be on either side.
template <class Real>
Rounded<Real> floor_of(const Rounded<Real>& a) {
    Rounded<Real> r(floor_of(a.range), 0, 0);
    if (a.error == 0) return r;
    const double lowest = std::nextafter(a.range.lo - a.error, -HUGE_VAL),
                 highest = std::nextafter(a.range.hi + a.error, HUGE_VAL);
    if (!(std::floor(lowest) == std::floor(highest))) r.error = std::floor(a.error) + 1;
    return r;
}
template <int N>
Jet<double, N> floor_of(const Jet<double, N>& a) {
    return Jet<double, N>(std::floor(a.c[0]));
}
template <int N>
Jet<Interval, N> floor_of(const Jet<Interval, N>& a) {
    const double floor = std::floor(a.c[0].lo);
    return floor == std::floor(a.c[0].hi) ? Jet<Interval, N>(floor) : unbounded<N>();
}
template <class T, int N>
Jets<T, N> floor_of(const Jets<T, N>& a) {
    Jets<T, N> r(0);
    for (int i = 0; i < kJets; ++i) r.c[0].set(i, floor_of(a.c[0][i]));
    if constexpr (std::is_same_v<T, Interval>)
        for (int i = 0; i < kJets; ++i)
            if (!(r.c[0].lo[i] == r.c[0].hi[i])) set_unbounded(r, i);
    return r;
}

// --- sums, products and quotients ---

template <class T, class U>
T sum_of(const T& a, const U& b) {
    return a + b;
}
template <class T, class U>
T product_of(const T& a, const U& b) {
    return a * b;
}
template <class T>
T quotient_of(const T& a, const T& b) {
    return a / b;
}
/// The one value of a number that is known to be computed exactly; NaN if there is no such.
template <class Real>
double only_value(const Rounded<Real>& a) {
    return a.error == 0 && a.radius == 0 && a.range.lo == a.range.hi ? a.range.lo : NAN;
}
/// Is a rounded result of a and b the exact one? What rounding took is computed without an error (Knuth; an fma).
inline bool is_exact_sum(double a, double b, double sum) {
    const double of_b = sum - a, of_a = sum - of_b;
    return (a - of_a) + (b - of_b) == 0;
}
inline bool is_exact_product(double a, double b, double product) {
    if (product == 0) return (a == 0 && std::isfinite(b)) || (b == 0 && std::isfinite(a));
    // What rounding took of smaller ones may underflow.
    return std::fabs(product) > 0x1p-900 && std::fma(a, b, -product) == 0;
}
/// Whole numbers, and what lies on a pixel's own column or row, stay exact, so that choices are decided there.
template <class Real>
Rounded<Real> sum_of(const Rounded<Real>& a, const Rounded<Real>& b) {
    const double x = only_value(a), y = only_value(b), sum = x + y;
    return is_exact_sum(x, y, sum) ? Rounded<Real>(sum) : a + b;
}
template <class Real>
Rounded<Real> sum_of(const Rounded<Real>& a, double b) {
    return sum_of(a, Rounded<Real>(b));
}
/// Zero times what may be infinite is no number.
template <class Real>
Rounded<Real> product_of(const Rounded<Real>& a, const Rounded<Real>& b) {
    const double x = only_value(a), y = only_value(b), product = x * y;
    if (is_exact_product(x, y, product)) return Rounded<Real>(product);
    const bool is_known = std::isfinite(a.computed_size()) && std::isfinite(b.computed_size());
    return is_known ? a * b : Rounded<Real>(Interval::all(), 0, HUGE_VAL);
}
template <class Real>
Rounded<Real> product_of(const Rounded<Real>& a, double b) {
    return product_of(a, Rounded<Real>(b));
}
template <class Real>
Rounded<Real> quotient_of(const Rounded<Real>& a, const Rounded<Real>& b) {
    const double x = only_value(a), y = only_value(b), quotient = x / y;
    return y != 0 && is_exact_product(quotient, y, x) ? Rounded<Real>(quotient) : a / b;
}

// --- angles: they jump by a turn on the half line y = 0, x < 0 ---

inline bool may_jump(const Interval& y, const Interval& x) {
    return !(x.lo > 0 || y.lo > 0 || y.hi < 0);
}
template <class T>
T angle_of(const T& y, const T& x) {
    // There is one zero.
    if constexpr (RealNumber<T>)
        return atan2(T(y + 0), T(x + 0));
    else
        return atan2(y, x);
}
/// Where y is not negative nothing jumps: on the half line the angle is pi, and at the origin 0.
inline DefinedInterval angle_of(const DefinedInterval& y, const DefinedInterval& x) {
    if (!(y.lo == 0 && x.lo <= 0)) return atan2(y, x);
    constexpr double kBelowPi = 3.141592653589793, kAbovePi = 3.1415926535897936;
    const double most = x.lo < 0 ? kAbovePi : kAbovePi / 2;
    if (x.hi >= 0) return Interval(0, most);
    return y.hi == 0 ? Interval(kBelowPi, most) : Interval(atan2(Interval(y.hi), Interval(x.hi)).lo, most);
}
/// Rounded takes angles modulo a turn.
template <class Real>
Rounded<Real> angle_of(const Rounded<Real>& y, const Rounded<Real>& x) {
    constexpr double kTurn = 6.283185307179587;
    const auto near = [](const Rounded<Real>& a) {
        return Interval(a.range.lo - a.error, a.range.hi + a.error);
    };
    Rounded<Real> r = atan2(y, x);
    // Where y is exact, its sign is.
    if (y.error > 0 && may_jump(near(y), near(x))) r.error += kTurn;
    return r;
}
template <int N>
Jet<Interval, N> angle_of(const Jet<Interval, N>& y, const Jet<Interval, N>& x) {
    return may_jump(y.c[0], x.c[0]) ? unbounded<N>() : atan2(y, x);
}
template <int N>
Jets<Interval, N> angle_of(const Jets<Interval, N>& y, const Jets<Interval, N>& x) {
    Jets<Interval, N> r = atan2(y, x);
    for (int i = 0; i < kJets; ++i)
        if (may_jump(y.c[0][i], x.c[0][i])) set_unbounded(r, i);
    return r;
}

}  // namespace program_detail

/// The first N numbers that a program computes at (x, y), read with T.
template <std::size_t N, class T>
std::array<T, N> read_program(const FormulaProgram& program, const T& x, const T& y) {
    using namespace program_detail;
    // Registers are written before they are read, and no step writes over its own operands.
    alignas(alignof(T) > 64 ? alignof(T) : 64) std::byte room[FormulaProgram::kRegisters * sizeof(T)];
    T* const r = reinterpret_cast<T*>(room);
    new (r) T(x);
    new (r + 1) T(y);
    const double* const numbers = program.numbers.data();
    const Constant* const constants = program.constants.data();
    for (const ProgramStep& step : program.steps) {
        const T &a = r[step.a], &b = r[step.b], &c = r[step.c];
        T* const to = r + step.result;
        switch (step.kind) {
            case StepKind::number:
                new (to) T(numbers[step.a]);
                break;
            case StepKind::constant:
                new (to) T(constants[step.a].template as<T>());
                break;
            case StepKind::sum:
                new (to) T(sum_of(a, b));
                break;
            case StepKind::difference:
                new (to) T(sum_of(a, T(-b)));
                break;
            case StepKind::product:
                new (to) T(product_of(a, b));
                break;
            case StepKind::quotient:
                new (to) T(quotient_of(a, b));
                break;
            case StepKind::add_number:
                new (to) T(sum_of(a, numbers[step.b]));
                break;
            case StepKind::times_number:
                new (to) T(product_of(a, numbers[step.b]));
                break;
            case StepKind::times_constant:
                new (to) T(a * constants[step.b].template as<T>());
                break;
            case StepKind::negation:
                new (to) T(-a);
                break;
            case StepKind::square:
                new (to) T(square(a));
                break;
            case StepKind::sqrt:
                new (to) T(sqrt(a));
                break;
            case StepKind::sine_and_cosine:
                new (to) T;
                new (to + 1) T;
                sin_cos(a, to[0], to[1]);
                break;
            case StepKind::angle:
                new (to) T(angle_of(a, b));
                break;
            case StepKind::exp:
                new (to) T(exp(a));
                break;
            case StepKind::log:
                new (to) T(log(a));
                break;
            case StepKind::asinh:
                new (to) T(asinh(a));
                break;
            case StepKind::floor:
                new (to) T(floor_of(a));
                break;
            case StepKind::choice:
                new (to) T(choose(is_negative(a), b, c));
                break;
        }
    }
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
        return std::array<T, N>{r[program.outputs[I]]...};
    }
    (std::make_index_sequence<N>());
}

}  // namespace anamorph
