// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/simd/program_rows.cpp"
#include "anamorph/simd/program_rows.h"

#include <cmath>

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "anamorph/number/lanes.h"

using D = hn::CappedTag<double, kProgramRow>;
using L = Lanes<D>;
using Mask = LaneMask<D>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));

/// Where lanes.h states what functions err by: elsewhere libm is asked, lane by lane, so that a lane does not depend on others.
constexpr double kMostAngle = 1e4, kMostExponent = 700, kLeastSize = 0x1p-500, kMostSize = 0x1p500;

HWY_INLINE Mask IsAtMost(const L& a, double most) {
    return {hn::Le(hn::Abs(a.v), hn::Set(D(), most))};
}
/// Neither tiny nor huge; 0 is neither.
HWY_INLINE Mask IsOrdinary(const L& a) {
    const auto size = hn::Abs(a.v);
    const auto between =
        hn::And(hn::Le(hn::Set(D(), kLeastSize), size), hn::Le(size, hn::Set(D(), kMostSize)));
    return {hn::Or(between, hn::Eq(size, hn::Zero(D())))};
}

/// `value` where the mask says so, else what `function` gives for the lane's operands.
template <class Function>
HWY_INLINE L OrElse(const Mask& where, const L& value, const L& a, const L& b, const Function& function) {
    if (HWY_LIKELY(hn::AllTrue(D(), where.m))) return value;
    HWY_ALIGN double of_a[kLanes], of_b[kLanes], is_there[kLanes], result[kLanes];
    a.store(of_a);
    b.store(of_b);
    value.store(result);
    select(where, L(1), L(0)).store(is_there);
    for (int i = 0; i < kLanes; ++i)
        if (is_there[i] == 0) result[i] = function(of_a[i], of_b[i]);
    return L::load(result);
}

/// One step for all points: registers are rows.
class Reader {
  public:
    Reader(const FormulaProgram& program, int count)
        : m_program(program), m_vectors((count + kLanes - 1) / kLanes) {}

    void read(const ProgramRow& at, ProgramRow& to) {
        each(0, [&](int i) { return L::load(at.x + i); });
        each(1, [&](int i) { return L::load(at.y + i); });
        for (const ProgramStep& step : m_program.steps) read(step);
        const auto& [x, y] = m_program.outputs;
        for (int k = 0; k < m_vectors; ++k) {
            of(x, k * kLanes).store(to.x + k * kLanes);
            of(y, k * kLanes).store(to.y + k * kLanes);
        }
    }

  private:
    HWY_INLINE L of(int r, int i) const { return L::load(m_registers[r] + i); }
    template <class Value>
    HWY_INLINE void each(int r, const Value& value) {
        for (int k = 0; k < m_vectors; ++k) value(k * kLanes).store(m_registers[r] + k * kLanes);
    }
    double number(int i) const { return m_program.numbers[static_cast<std::size_t>(i)]; }
    double constant(int i) const {
        return m_program.constants[static_cast<std::size_t>(i)].template as<double>();
    }

    void read(const ProgramStep& step) {
        const int to = step.result;
        const auto a = [&](int i) { return of(step.a, i); };
        const auto b = [&](int i) { return of(step.b, i); };
        switch (step.kind) {
            case StepKind::number:
                return each(to, [k = L(number(step.a))](int) { return k; });
            case StepKind::constant:
                return each(to, [k = L(constant(step.a))](int) { return k; });
            case StepKind::sum:
                return each(to, [&](int i) { return a(i) + b(i); });
            case StepKind::difference:
                return each(to, [&](int i) { return a(i) - b(i); });
            case StepKind::product:
                return each(to, [&](int i) { return a(i) * b(i); });
            case StepKind::quotient:
                return each(to, [&](int i) { return a(i) / b(i); });
            case StepKind::add_number:
                return each(to, [&, k = L(number(step.b))](int i) { return a(i) + k; });
            case StepKind::times_number:
                return each(to, [&, k = L(number(step.b))](int i) { return a(i) * k; });
            case StepKind::times_constant:
                return each(to, [&, k = L(constant(step.b))](int i) { return a(i) * k; });
            case StepKind::negation:
                return each(to, [&](int i) { return -a(i); });
            case StepKind::square:
                return each(to, [&](int i) { return square(a(i)); });
            case StepKind::sqrt:
                return each(to, [&](int i) { return sqrt(a(i)); });
            case StepKind::sine_and_cosine:
                return sine_and_cosine(step);
            case StepKind::angle:
                return each(to, [&](int i) { return angle(a(i), b(i)); });
            case StepKind::exp:
                return each(to, [&](int i) {
                    return OrElse(IsAtMost(a(i), kMostExponent), exp(a(i)), a(i), a(i),
                                  [](double x, double) { return std::exp(x); });
                });
            case StepKind::log:
                return each(to, [&](int i) {
                    return OrElse(IsOrdinary(a(i)), log(a(i)), a(i), a(i),
                                  [](double x, double) { return std::log(x); });
                });
            case StepKind::asinh:
                return each(to, [&](int i) {
                    return OrElse(IsOrdinary(a(i)), asinh(a(i)), a(i), a(i),
                                  [](double x, double) { return std::asinh(x); });
                });
            case StepKind::floor:
                return each(to, [&](int i) { return L(hn::Floor(a(i).v)); });
            case StepKind::choice:
                return each(to, [&](int i) { return select(is_negative(a(i)), b(i), of(step.c, i)); });
        }
    }

    void sine_and_cosine(const ProgramStep& step) {
        for (int k = 0; k < m_vectors; ++k) {
            const int i = k * kLanes;
            const L a = of(step.a, i);
            L sine, cosine;
            sin_cos(a, sine, cosine);
            const Mask near = IsAtMost(a, kMostAngle);
            OrElse(near, sine, a, a, [](double x, double) {
                return std::sin(x);
            }).store(m_registers[step.result] + i);
            OrElse(near, cosine, a, a, [](double x, double) {
                return std::cos(x);
            }).store(m_registers[step.result + 1] + i);
        }
    }

    /// There is one zero.
    static HWY_INLINE L angle(const L& y_given, const L& x_given) {
        const L y = y_given + L(0), x = x_given + L(0);
        return OrElse(both(IsOrdinary(y), IsOrdinary(x)), atan2(y, x), y, x,
                      [](double up, double right) { return std::atan2(up, right); });
    }

    const FormulaProgram& m_program;
    int m_vectors;
    HWY_ALIGN double m_registers[FormulaProgram::kRegisters][kProgramRow];
};

void ReadProgramRow(const FormulaProgram& program, const ProgramRow& at, int count, ProgramRow& to) {
    Reader reader(program, count);
    reader.read(at, to);
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(ReadProgramRow);

void read_program_row(const FormulaProgram& program, const ProgramRow& at, int count, ProgramRow& to) {
    HWY_DYNAMIC_DISPATCH(ReadProgramRow)(program, at, count, to);
}

}  // namespace anamorph::simd
#endif
