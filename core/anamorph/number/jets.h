// SPDX-License-Identifier: Apache-2.0
// Jets of four boxes at once, as a number that formulas are read with: what plans are made from.
//
// What costs most of such a formula are its products, quotients, roots and angles, so these are compiled for every
// instruction set, and formulas once. The same bits on all of them; no box of four depends on its neighbours.
//
// Jets of doubles compute what number/jet.h does, with functions of number/lanes.h in place of libm's, whose errors are
// no larger than Rounded<double> allows for.
#pragma once

#include <algorithm>

#include "anamorph/number/jet.h"

namespace anamorph::simd {

inline constexpr int kJets = 4;

// Of single numbers.
using anamorph::both;
using anamorph::enlarger;
using anamorph::is_negative;
using anamorph::is_zero;
using anamorph::select;
using anamorph::without_hair;

/// Four numbers.
template <class T>
struct Four;
template <>
struct Four<double> {
    alignas(32) double v[kJets];

    double operator[](int i) const { return v[i]; }
    void set(int i, double value) { v[i] = value; }
};
template <>
struct Four<Interval> {
    alignas(32) double lo[kJets], hi[kJets];

    Interval operator[](int i) const { return {lo[i], hi[i]}; }
    void set(int i, const Interval& value) {
        lo[i] = value.lo;
        hi[i] = value.hi;
    }
};

/// A condition for each of four numbers.
template <class Condition>
struct FourConditions {
    Condition of[kJets];
};
template <class A, class B>
auto both(const FourConditions<A>& a, const FourConditions<B>& b) {
    FourConditions<decltype(both(a.of[0], b.of[0]))> r;
    for (int i = 0; i < kJets; ++i) r.of[i] = both(a.of[i], b.of[i]);
    return r;
}

/// Four Jet<T, N>. All are polynomials of at most `degree`; coefficients above are not stored.
template <class T, int N>
struct Jets {
    static constexpr int kDegree = N, kSize = Jet<T, N>::kSize;

    int degree = 0;
    Four<T> c[kSize];

    Jets() = default;
    Jets(double constant) {  // NOLINT: a number is four
        for (int i = 0; i < kJets; ++i) c[0].set(i, T(constant));
    }
    /// The variable value + ds * s + dt * t.
    static Jets variable(const T (&value)[kJets], const double (&ds)[kJets], const double (&dt)[kJets]) {
        Jets r;
        r.degree = 1;
        for (int i = 0; i < kJets; ++i) {
            r.c[0].set(i, value[i]);
            r.c[1].set(i, T(ds[i]));
            r.c[2].set(i, T(dt[i]));
        }
        return r;
    }

    /// The number of coefficients that are stored.
    int terms() const { return Jet<T, N>::part(degree + 1); }
    /// Jet i of the four.
    Jet<T, N> at(int i) const {
        Jet<T, N> jet;
        for (int k = 0; k < terms(); ++k) jet.c[k] = c[k][i];
        return jet;
    }
    void set(int i, const Jet<T, N>& jet) {
        degree = N;
        for (int k = 0; k < kSize; ++k) c[k].set(i, jet.c[k]);
    }
};

/// The Taylor polynomials of blocks, and the enclosures of those of boxes.
using TaylorJets = Jets<double, 4>;
using BoundJets = Jets<Interval, 5>;

// NOLINTBEGIN(bugprone-macro-parentheses): a type takes none.
#define ANAMORPH_JETS(J)                               \
    void multiply(const J& a, const J& b, J& product); \
    void square_of(const J& a, J& product);            \
    void divide(const J& a, const J& b, J& quotient);  \
    void root_of(const J& a, J& root);                 \
    void sine_cosine(const J& a, J& s, J& c);          \
    void angle_of(const J& y, const J& x, J& angle);   \
    void power_of_e(const J& a, J& power);             \
    void logarithm_of(const J& a, J& logarithm);       \
    void area_sine(const J& a, J& area);               \
    void hyperbolic_sine(const J& a, J& sine, J& one);
// NOLINTEND(bugprone-macro-parentheses)
ANAMORPH_JETS(TaylorJets)
ANAMORPH_JETS(BoundJets)
#undef ANAMORPH_JETS
void scale(const BoundJets& a, double k, BoundJets& product);
/// sum_k c_k f^k of four jets f less their constant parts.
void compose_with(const Four<double>* c, const TaylorJets& f, TaylorJets& sum);
void compose_with(const Four<Interval>* c, const BoundJets& f, BoundJets& sum);

template <class T, int N>
Jets<T, N> operator*(const Jets<T, N>& a, const Jets<T, N>& b) {
    Jets<T, N> r;
    multiply(a, b, r);
    return r;
}
template <class T, int N>
Jets<T, N> operator/(const Jets<T, N>& a, const Jets<T, N>& b) {
    Jets<T, N> r;
    divide(a, b, r);
    return r;
}
template <class T, int N>
Jets<T, N> square(const Jets<T, N>& a) {
    Jets<T, N> r;
    square_of(a, r);
    return r;
}
template <class T, int N>
Jets<T, N> sqrt(const Jets<T, N>& a) {
    Jets<T, N> r;
    root_of(a, r);
    return r;
}
template <class T, int N>
void sin_cos(const Jets<T, N>& a, Jets<T, N>& s, Jets<T, N>& c) {
    sine_cosine(a, s, c);
}
template <class T, int N>
Jets<T, N> atan2(const Jets<T, N>& y, const Jets<T, N>& x) {
    Jets<T, N> r;
    angle_of(y, x, r);
    return r;
}
template <class T, int N>
Jets<T, N> exp(const Jets<T, N>& a) {
    Jets<T, N> r;
    power_of_e(a, r);
    return r;
}
template <class T, int N>
Jets<T, N> log(const Jets<T, N>& a) {
    Jets<T, N> r;
    logarithm_of(a, r);
    return r;
}
template <class T, int N>
Jets<T, N> asinh(const Jets<T, N>& a) {
    Jets<T, N> r;
    area_sine(a, r);
    return r;
}
template <class T, int N>
Jets<T, N> scaled_sinh(const Jets<T, N>& a, Jets<T, N>& s) {
    Jets<T, N> one;
    hyperbolic_sine(a, s, one);
    return one;
}

namespace jets_detail {

inline Four<double> negated(const Four<double>& a) {
    Four<double> r;
    for (int i = 0; i < kJets; ++i) r.v[i] = -a.v[i];
    return r;
}
inline Four<Interval> negated(const Four<Interval>& a) {
    Four<Interval> r;
    for (int i = 0; i < kJets; ++i) r.lo[i] = -a.hi[i];
    for (int i = 0; i < kJets; ++i) r.hi[i] = -a.lo[i];
    return r;
}
inline Four<double> sum(const Four<double>& a, const Four<double>& b) {
    Four<double> r;
    for (int i = 0; i < kJets; ++i) r.v[i] = a.v[i] + b.v[i];
    return r;
}
/// The sum of four intervals, rounded as that of Interval is.
inline Four<Interval> sum(const Four<Interval>& a, const Four<Interval>& b) {
    using interval_detail::kUlp;
    Four<Interval> r;
    for (int i = 0; i < kJets; ++i) {
        const double lo = a.lo[i] + b.lo[i];
        r.lo[i] = lo - std::fabs(lo) * kUlp;
    }
    for (int i = 0; i < kJets; ++i) {
        const double hi = a.hi[i] + b.hi[i];
        r.hi[i] = hi + std::fabs(hi) * kUlp;
    }
    return r;
}
}  // namespace jets_detail

template <class T, int N>
[[gnu::noinline]] Jets<T, N> operator-(const Jets<T, N>& a) {
    Jets<T, N> r;
    r.degree = a.degree;
    for (int k = 0; k < a.terms(); ++k) r.c[k] = jets_detail::negated(a.c[k]);
    return r;
}
template <class T, int N>
[[gnu::noinline]] Jets<T, N> operator+(const Jets<T, N>& a, const Jets<T, N>& b) {
    Jets<T, N> r;
    r.degree = std::max(a.degree, b.degree);
    const int in_both = std::min(a.terms(), b.terms());
    for (int k = 0; k < in_both; ++k) r.c[k] = jets_detail::sum(a.c[k], b.c[k]);
    const Jets<T, N>& longer = a.degree > b.degree ? a : b;
    for (int k = in_both; k < r.terms(); ++k) r.c[k] = longer.c[k];
    return r;
}
template <class T, int N>
[[gnu::noinline]] Jets<T, N> operator-(const Jets<T, N>& a, const Jets<T, N>& b) {
    return a + -b;
}
template <class T, int N>
[[gnu::noinline]] Jets<T, N> operator*(const Jets<T, N>& a, double k) {
    if (k == 1) return a;
    Jets<T, N> r;
    if constexpr (std::is_same_v<T, double>) {
        // Lines, mostly.
        r.degree = a.degree;
        for (int i = 0; i < a.terms(); ++i)
            for (int j = 0; j < kJets; ++j) r.c[i].v[j] = a.c[i].v[j] * k;
    } else
        scale(a, k, r);
    return r;
}
template <class T, int N>
Jets<T, N> operator*(double k, const Jets<T, N>& a) {
    return a * k;
}
template <class T, int N>
[[gnu::noinline]] Jets<T, N> operator+(const Jets<T, N>& a, double k) {
    Jets<T, N> r = a;
    for (int i = 0; i < kJets; ++i) r.c[0].set(i, a.c[0][i] + T(k));
    return r;
}
template <class T, int N>
Jets<T, N> operator+(double k, const Jets<T, N>& a) {
    return a + k;
}
template <class T, int N>
Jets<T, N> operator-(const Jets<T, N>& a, double k) {
    return a + -k;
}
template <class T, int N>
Jets<T, N> operator-(double k, const Jets<T, N>& a) {
    return -a + k;
}

// Conditions are those of the constant parts.
template <class T, int N>
FourConditions<bool> is_zero(const Jets<T, N>& a) {
    FourConditions<bool> r;
    for (int i = 0; i < kJets; ++i) r.of[i] = is_zero(a.c[0][i]);
    return r;
}
template <class T, int N>
auto is_negative(const Jets<T, N>& a) {
    FourConditions<decltype(is_negative(a.c[0][0]))> r;
    for (int i = 0; i < kJets; ++i) r.of[i] = is_negative(a.c[0][i]);
    return r;
}
/// Selects jet by jet. The result has the larger degree, whichever is chosen: no box depends on its
/// neighbours.
template <class Condition, class T, int N>
[[gnu::noinline]] Jets<T, N> select(const FourConditions<Condition>& where, const Jets<T, N>& a,
                                    const Jets<T, N>& b) {
    Jets<T, N> r;
    r.degree = std::max(a.degree, b.degree);
    for (int k = 0; k < r.terms(); ++k)
        for (int i = 0; i < kJets; ++i) {
            const T of_a = k < a.terms() ? a.c[k][i] : T(0), of_b = k < b.terms() ? b.c[k][i] : T(0);
            r.c[k].set(i, select(where.of[i], of_a, of_b));
        }
    return r;
}
template <class T, int N>
Jets<T, N> min(const Jets<T, N>& a, const Jets<T, N>& b) {
    return select(is_negative(b - a), b, a);
}
template <class T, int N>
Jets<T, N> max(const Jets<T, N>& a, const Jets<T, N>& b) {
    return select(is_negative(a - b), b, a);
}
template <class T, int N>
Jets<T, N> without_hair(const Jets<T, N>& a) {
    Jets<T, N> r = a;
    for (int i = 0; i < kJets; ++i) r.c[0].set(i, without_hair(a.c[0][i]));
    return r;
}
/// A factor for each of four jets.
struct FourFactors {
    double of[kJets];
};
template <class T, int N>
FourFactors enlarger(const Jets<T, N>& a, const Jets<T, N>& b) {
    FourFactors r;
    for (int i = 0; i < kJets; ++i) r.of[i] = enlarger(a.c[0][i], b.c[0][i]);
    return r;
}
template <class T, int N>
[[gnu::noinline]] Jets<T, N> operator*(const Jets<T, N>& a, const FourFactors& k) {
    if (std::all_of(k.of, k.of + kJets, [](double one) { return one == 1; })) return a;
    Jets<T, N> r;
    r.degree = a.degree;
    for (int j = 0; j < a.terms(); ++j)
        for (int i = 0; i < kJets; ++i) r.c[j].set(i, k.of[i] == 1 ? a.c[j][i] : a.c[j][i] * k.of[i]);
    return r;
}

}  // namespace anamorph::simd
