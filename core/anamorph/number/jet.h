// SPDX-License-Identifier: Apache-2.0
// Truncated Taylor series in two variables: the number a formula is read with to get its derivatives.
//
// Jet<T, N> holds the coefficients c_ij of s^i t^j for i + j <= N, that is f_(s^i t^j) / (i! j!). Read with
// T = double at a point it is the Taylor polynomial there; read with T = Interval over a box, the
// coefficients of degree N enclose Lagrange's remainder of the polynomial of degree N - 1.
//
// Every function is a recurrence over the homogeneous parts f_k = sum_(i+j=k) c_ij s^i t^j. Euler's operator
// E = s d/ds + t d/dt multiplies f_k by k, so the classic one-variable recurrences hold part by part.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <type_traits>
#include <utility>

#include "anamorph/number/double_double.h"
#include "anamorph/number/interval.h"
#include "anamorph/number/number.h"

namespace anamorph {

// Recurrences are unrolled whole, except where instruments would be put into every copy.
#if defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__)
#define ANAMORPH_UNROLLED __attribute__((always_inline))
#else
#define ANAMORPH_UNROLLED
#endif

/// The base class of jets of T. It is empty: their degree as polynomials is found from their coefficients
/// (jet_detail::degree_of).
template <class T>
struct ToldDegree {};
/// The number of steps of a recurrence: a constant where it is unrolled. Long ones of intervals are not, as they would be
/// no faster.
template <class T, int N>
inline constexpr std::integral_constant<int, N> kJetSteps{};
template <int N>
requires(N > 2) inline constexpr int kJetSteps<Interval, N> = N;

#include "anamorph/number/jet_series.h"

template <class T>
using Jet1 = Jet<T, 1>;
template <class T>
using Jet2 = Jet<T, 2>;

template <class T, int N>
inline Jet<T, N> sinh(const Jet<T, N>& a) {
    using std::cosh;
    using std::sinh;
    Jet<T, N> s(sinh(a.c[0])), c(cosh(a.c[0]));
    jet_detail::oscillate<1>(s, c, a);
    return s;
}

/// The constant part of a jet; that of a plain number is the number itself.
template <class T, int N>
inline const T& constant_part(const Jet<T, N>& a) {
    return a.c[0];
}
inline double constant_part(double a) {
    return a;
}
inline DoubleDouble constant_part(const DoubleDouble& a) {
    return a;
}
inline const Interval& constant_part(const Interval& a) {
    return a;
}

/// The least member of an interval; that of a plain number is the number itself.
inline double lower_end(double a) {
    return a;
}
inline DoubleDouble lower_end(const DoubleDouble& a) {
    return a;
}
inline double lower_end(const Interval& a) {
    return a.lo;
}

// Conditions are those of the constant part, and so is the choice between two jets.
template <class T, int N>
auto is_zero(const Jet<T, N>& a) {
    return is_zero(a.c[0]);
}
template <class T, int N>
auto is_negative(const Jet<T, N>& a) {
    return is_negative(a.c[0]);
}
template <class T, int N>
Jet<T, N> hull(const Jet<T, N>& a, const Jet<T, N>& b) {
    Jet<T, N> r;
    for (int i = 0; i < Jet<T, N>::kSize; ++i) r.c[i] = hull(a.c[i], b.c[i]);
    return r;
}
template <class T, int N>
Jet<T, N> min(const Jet<T, N>& a, const Jet<T, N>& b) {
    return select(is_negative(T(b.c[0] - a.c[0])), b, a);
}
template <class T, int N>
Jet<T, N> max(const Jet<T, N>& a, const Jet<T, N>& b) {
    return select(is_negative(T(a.c[0] - b.c[0])), b, a);
}
template <class T, int N>
Jet<T, N> without_hair(Jet<T, N> a) {
    a.c[0] = without_hair(a.c[0]);
    return a;
}
template <class T, int N>
double enlarger(const Jet<T, N>& a, const Jet<T, N>& b) {
    return enlarger(a.c[0], b.c[0]);
}

/// Rewrites a polynomial of `Degree` about 0 as one about `shift`, in units of `scale`, by repeated synthetic division;
/// coefficient(j) refers to the coefficient of degree j.
template <int Degree, class Coefficient>
ANAMORPH_UNROLLED inline void taylor_shift(double shift, double scale, const Coefficient& coefficient) {
    double power = 1;
    jet_detail::unroll(kJetSteps<double, Degree + 1>, [&](auto j) ANAMORPH_UNROLLED {
        jet_detail::unroll(kJetSteps<double, Degree - j>, [&](auto k) ANAMORPH_UNROLLED {
            coefficient(Degree - 1 - k) += coefficient(Degree - k) * shift;
        });
        coefficient(j) *= power;
        power *= scale;
    });
}

/// The jet of f(shift_s + scale_s s, shift_t + scale_t t), which turns a polynomial over a box into one over a part of it.
/// A scale of 1 stands for the whole side, with no shift.
template <int N>
Jet<double, N> on_part(Jet<double, N> f, double shift_s, double scale_s, double shift_t, double scale_t) {
    using J = Jet<double, N>;
    if (scale_s != 1)
        jet_detail::unroll(kJetSteps<double, N + 1>, [&](auto j) ANAMORPH_UNROLLED {
            taylor_shift<N - j>(shift_s, scale_s, [&](int i) -> double& { return f.c[J::part(i + j) + j]; });
        });
    if (scale_t != 1)
        jet_detail::unroll(kJetSteps<double, N + 1>, [&](auto i) ANAMORPH_UNROLLED {
            taylor_shift<N - i>(shift_t, scale_t, [&](int j) -> double& { return f.c[J::part(i + j) + j]; });
        });
    return f;
}

#undef ANAMORPH_UNROLLED

}  // namespace anamorph
