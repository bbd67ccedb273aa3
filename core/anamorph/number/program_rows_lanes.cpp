// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/number/program_rows_lanes.cpp"
#include "anamorph/number/program_rows.h"

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

/// N points as a number that read_program reads. Its functions are not for inlining: the program's reader is compiled for no
/// instruction set.
template <int N>
struct Row {
    alignas(64) double v[N];

    Row() = default;
    HWY_NOINLINE Row(double k) {  // NOLINT: a number is many
        set([k](int) { return L(k); });
    }
    HWY_NOINLINE explicit Row(const double* from) {
        set([from](int i) { return L::load(from + i); });
    }
    template <class Value>
    HWY_INLINE void set(const Value& value) {
        for (int i = 0; i < N; i += kLanes) value(i).store(v + i);
    }
    template <class Value>
    static HWY_INLINE Row of(const Value& value) {
        Row row;
        row.set(value);
        return row;
    }
    HWY_INLINE L at(int i) const { return L::load(v + i); }

    friend HWY_NOINLINE Row operator+(const Row& a, const Row& b) {
        return of([&](int i) { return a.at(i) + b.at(i); });
    }
    friend HWY_NOINLINE Row operator+(const Row& a, double b) {
        return of([&](int i) { return a.at(i) + L(b); });
    }
    friend HWY_NOINLINE Row operator*(const Row& a, const Row& b) {
        return of([&](int i) { return a.at(i) * b.at(i); });
    }
    friend HWY_NOINLINE Row operator*(const Row& a, double b) {
        return of([&](int i) { return a.at(i) * L(b); });
    }
    friend HWY_NOINLINE Row operator/(const Row& a, const Row& b) {
        return of([&](int i) { return a.at(i) / b.at(i); });
    }
    friend HWY_NOINLINE Row operator-(const Row& a) {
        return of([&](int i) { return -a.at(i); });
    }
    friend HWY_NOINLINE Row square(const Row& a) {
        return of([&](int i) { return square(a.at(i)); });
    }
    friend HWY_NOINLINE Row sqrt(const Row& a) {
        return of([&](int i) { return sqrt(a.at(i)); });
    }
    friend HWY_NOINLINE Row floor_of(const Row& a) {
        return of([&](int i) { return L(hn::Floor(a.at(i).v)); });
    }
    friend HWY_NOINLINE Row exp(const Row& a) {
        return of([&](int i) {
            return OrElse(IsAtMost(a.at(i), kMostExponent), exp(a.at(i)), a.at(i), a.at(i),
                          [](double x, double) { return std::exp(x); });
        });
    }
    friend HWY_NOINLINE Row log(const Row& a) {
        return of([&](int i) {
            return OrElse(IsOrdinary(a.at(i)), log(a.at(i)), a.at(i), a.at(i),
                          [](double x, double) { return std::log(x); });
        });
    }
    friend HWY_NOINLINE Row asinh(const Row& a) {
        return of([&](int i) {
            return OrElse(IsOrdinary(a.at(i)), asinh(a.at(i)), a.at(i), a.at(i),
                          [](double x, double) { return std::asinh(x); });
        });
    }
    /// There is one zero.
    friend HWY_NOINLINE Row atan2(const Row& up, const Row& right) {
        return of([&](int i) {
            const L y = up.at(i) + L(0), x = right.at(i) + L(0);
            return OrElse(both(IsOrdinary(y), IsOrdinary(x)), atan2(y, x), y, x,
                          [](double of_y, double of_x) { return std::atan2(of_y, of_x); });
        });
    }
    friend HWY_NOINLINE void sin_cos(const Row& a, Row& sine, Row& cosine) {
        for (int i = 0; i < N; i += kLanes) {
            const L angle = a.at(i);
            const Mask near = IsAtMost(angle, kMostAngle);
            L s, c;
            sin_cos(angle, s, c);
            OrElse(near, s, angle, angle, [](double x, double) { return std::sin(x); }).store(sine.v + i);
            OrElse(near, c, angle, angle, [](double x, double) { return std::cos(x); }).store(cosine.v + i);
        }
    }
    /// The condition is the number itself, which choose() asks.
    struct Negative {
        const Row& of;
    };
    friend Negative is_negative(const Row& a) { return {a}; }
    friend HWY_NOINLINE Row choose(const Negative& where, const Row& a, const Row& b) {
        return of([&](int i) { return select(is_negative(where.of.at(i)), a.at(i), b.at(i)); });
    }
};

/// The points from `first` on.
template <int N>
void ReadRow(const FormulaProgram& program, const ProgramRow& at, int first, ProgramRow& to) {
    const auto store = [&](const auto& found) {
        double* const parts[] = {to.x, to.y, to.z};
        for (std::size_t k = 0; k < found.size(); ++k)
            for (int i = 0; i < N; i += kLanes) found[k].at(i).store(parts[k] + first + i);
    };
    const Row<N> x(at.x + first), y(at.y + first);
    switch (program.outputs.size()) {
        case 1:
            return store(read_program<1>(program, x, y));
        case 2:
            return store(read_program<2>(program, x, y));
        default:
            return store(read_program<3>(program, x, y));
    }
}

void ReadProgramRow(const FormulaProgram& program, const ProgramRow& at, int count, ProgramRow& to) {
    // What is left of a row takes short ones.
    constexpr int kShort = HWY_MAX(8, kLanes);
    if (count > kProgramRow / 2) return ReadRow<kProgramRow>(program, at, 0, to);
    for (int first = 0; first < count; first += kShort) ReadRow<kShort>(program, at, first, to);
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
