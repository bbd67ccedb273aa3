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

#include <cmath>
#include <type_traits>
#include <utility>

#include "anamorph/number/interval.h"
#include "anamorph/number/number.h"

namespace anamorph {

template <class T, int N>
struct Jet {
    static constexpr int kDegree = N;
    static constexpr int kSize = (N + 1) * (N + 2) / 2;

    /// Degree by degree; within degree k the coefficient of s^(k-j) t^j stands at k (k + 1) / 2 + j.
    T c[kSize] = {};

    Jet() = default;
    Jet(const T& constant) { c[0] = constant; }  // NOLINT: a number is a jet
    template <class U>
    requires(std::is_arithmetic_v<U> && !std::is_same_v<U, T>) Jet(U constant)  // NOLINT: a number is a jet
    {
        c[0] = T(constant);
    }

    /// value + ds * s + dt * t
    static Jet variable(const T& value, const T& ds, const T& dt) {
        Jet r(value);
        r.c[1] = ds;
        r.c[2] = dt;
        return r;
    }

    static constexpr int part(int degree) { return degree * (degree + 1) / 2; }
    const T& at(int i, int j) const { return c[part(i + j) + j]; }
    const T& value() const { return c[0]; }
};

template <class T>
using Jet1 = Jet<T, 1>;
template <class T>
using Jet2 = Jet<T, 2>;

// Recurrences are unrolled whole, except where instruments would be put into every copy.
#if defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__)
#define ANAMORPH_UNROLLED __attribute__((always_inline))
#else
#define ANAMORPH_UNROLLED
#endif

namespace jet_detail {

/// body(0), ..., body(Count - 1), each with its index as a constant: unrolled.
template <int Count, class Body>
ANAMORPH_UNROLLED inline void unroll(const Body& body) {
    [&]<int... I>(std::integer_sequence<int, I...>) ANAMORPH_UNROLLED {
        (body(std::integral_constant<int, I>{}), ...);
    }
    (std::make_integer_sequence<int, Count>{});
}

/// A sum of products.
template <class T>
struct ProductSum {
    T sum = T(0);

    ANAMORPH_UNROLLED void add(const T& a, const T& b) { sum += a * b; }
    ANAMORPH_UNROLLED void add(const ProductSum& part, int weight) {
        sum += weight == 1 ? part.sum : part.sum * T(weight);
    }
    const T& value() const { return sum; }
};
/// Of intervals, in about as many steps as of numbers. With middles p, q and largest magnitudes P, Q of two
/// factors, their product is within PQ - |p||q| of pq; so is a sum of them, with weights w, of the sum of w p q.
/// Read here are s = 2 p and t = 2 q, sums of ends, which do not underflow.
///
/// Rounding, in units u = 2^-53 of G = sum |w| P Q, for N <= 6, when a coefficient has at most 16 products: s t w
/// is off by 4 u of itself, and adding up by 16 u more, so that sum w s t and sum |w| |s| |t|, of 4 G at most, are
/// off by 20 u of 4 G, and G by 18 u; the difference of sizes and the two ends by 4 u. 20 + 20 + 18 + 4 < 64 units;
/// 128 are taken. What underflows is off by 2^-1022 at most, 16 products with weights up to 12 in three sums by
/// less than 2^-1012: no more than the rest of the units where G is at least 2^-950. Where it is less, the sum is
/// only known to be next to nothing.
template <>
struct ProductSum<Interval> {
    double middle = 0, middle_size = 0;  ///< sum w s t and sum |w s t|
    double size = 0;                     ///< G

    ANAMORPH_UNROLLED void add(const Interval& a, const Interval& b) {
        const double product = (a.lo + a.hi) * (b.lo + b.hi);
        middle += product;
        middle_size += std::fabs(product);
        size += larger(-a.lo, a.hi) * larger(-b.lo, b.hi);
    }
    ANAMORPH_UNROLLED void add(const ProductSum& part, int weight) {
        middle += part.middle * weight;
        middle_size += part.middle_size * std::abs(weight);
        size += part.size * std::abs(weight);
    }
    /// Unbounded where a factor is, or nearly so.
    ANAMORPH_UNROLLED Interval value() const {
        if (!(middle_size + size < 0x1p1000)) return Interval::all();
        const double radius = size < 0x1p-950 ? 0x1p-940 : (size - 0.25 * middle_size) + size * 0x1p-46;
        return {0.25 * middle - radius, 0.25 * middle + radius};
    }

  private:
    ANAMORPH_UNROLLED static double larger(double a, double b) { return a > b ? a : b; }
};

/// The degree of a jet as a polynomial: parts above are zero. Constants, lines and their squares are mostly zeros,
/// and gain by its being seen. N for vectors.
template <class T, int N>
int degree_of(const Jet<T, N>& jet) {
    int degree = N;
    if constexpr (requires(bool known, const T& a) { known = is_zero(a); })
        for (int last = Jet<T, N>::kSize - 1; last > 0 && is_zero(jet.c[last]); --last)
            if (last == Jet<T, N>::part(degree)) --degree;
    return degree;
}

/// How many coefficients are worth an operation of their own: of intervals, those of the degree.
template <class T, int N>
int terms(const Jet<T, N>& jet) {
    return std::is_same_v<T, Interval> ? Jet<T, N>::part(degree_of(jet) + 1) : Jet<T, N>::kSize;
}

/// A jet as a factor of products.
template <class T, int N>
struct Factor {
    const Jet<T, N>& jet;
    int degree;

    explicit Factor(const Jet<T, N>& known) : jet(known), degree(degree_of(known)) {}
    /// A jet of which more parts are to come.
    static Factor growing(const Jet<T, N>& jet) { return Factor(jet, N); }

  private:
    Factor(const Jet<T, N>& unknown, int any) : jet(unknown), degree(any) {}
};

/// Coefficient m of the part of degree K of sum_(First <= a <= Last) weight(a) f_a g_(K-a).
template <int K, int First, int Last, class T, int N, class Weight>
ANAMORPH_UNROLLED inline T convolve(const Factor<T, N>& f, const Factor<T, N>& g, int m,
                                    const Weight& weight) {
    using J = Jet<T, N>;
    if (First > Last || K > f.degree + g.degree) return T(0);
    ProductSum<T> sum;
    unroll<Last - First + 1>([&](auto offset) ANAMORPH_UNROLLED {
        constexpr int a = First + offset, b = K - a;
        if (a > f.degree || b > g.degree) return;
        ProductSum<T> part;
        unroll<a + 1>([&](auto i) ANAMORPH_UNROLLED {
            const int j = m - i;
            if (j >= 0 && j <= b) part.add(f.jet.c[J::part(a) + i], g.jet.c[J::part(b) + j]);
        });
        sum.add(part, weight(a));
    });
    static_assert(!std::is_same_v<T, Interval> || N <= 6);
    return sum.value();
}

/// body(k, m) for the coefficients m of the parts of degree k = 1 ... N, part by part.
template <int N, class Body>
ANAMORPH_UNROLLED inline void each_coefficient(const Body& body) {
    unroll<N>([&](auto below) ANAMORPH_UNROLLED {
        constexpr int k = below + 1;
        unroll<k + 1>([&](auto m) ANAMORPH_UNROLLED { body(std::integral_constant<int, k>{}, m); });
    });
}

/// Solves q E g = w for the parts of g above the constant: k q_0 g_k = w_k - sum_(0<j<k) j g_j q_(k-j).
template <class T, int N>
inline void integrate_quotient(Jet<T, N>& g, const Jet<T, N>& w, const Jet<T, N>& q) {
    const T inverse = T(1) / q.c[0];
    T part_of[N + 1];
    for (int k = 1; k <= N; ++k) part_of[k] = inverse / T(k);
    const auto left = Factor<T, N>::growing(g);
    const Factor<T, N> right(q);
    each_coefficient<N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        const T known = convolve<k, 1, k - 1>(left, right, m, [](int j) { return j; });
        const int at = Jet<T, N>::part(k) + m;
        g.c[at] = (w.c[at] - known) * part_of[k];
    });
}

/// x E y - y E x, whose part of degree k is sum_a (k - 2 a) x_a y_(k-a).
template <class T, int N>
inline Jet<T, N> wronskian(const Jet<T, N>& x, const Jet<T, N>& y) {
    Jet<T, N> r;
    const Factor<T, N> left(x), right(y);
    each_coefficient<N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        constexpr int degree = k;
        r.c[Jet<T, N>::part(k) + m] = convolve<k, 0, k>(left, right, m, [](int a) { return degree - 2 * a; });
    });
    return r;
}

/// E f: the part of degree k times k.
template <class T, int N>
inline Jet<T, N> euler(const Jet<T, N>& f) {
    Jet<T, N> r;
    each_coefficient<N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        const int at = Jet<T, N>::part(k) + m;
        r.c[at] = f.c[at] * T(k);
    });
    return r;
}

/// E u = v E a and E v = Sign * u E a: sine and cosine (Sign -1), or their hyperbolic twins (Sign 1).
template <int Sign, class T, int N>
inline void oscillate(Jet<T, N>& u, Jet<T, N>& v, const Jet<T, N>& a) {
    const Factor<T, N> angle(a);
    const auto sine = Factor<T, N>::growing(u), cosine = Factor<T, N>::growing(v);
    each_coefficient<N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        const int at = Jet<T, N>::part(k) + m;
        u.c[at] = convolve<k, 1, k>(angle, cosine, m, [](int j) { return j; }) / T(k);
        v.c[at] = convolve<k, 1, k>(angle, sine, m, [](int j) { return Sign * j; }) / T(k);
    });
}

}  // namespace jet_detail

template <class T, int N>
inline Jet<T, N> operator-(const Jet<T, N>& a) {
    Jet<T, N> r;
    for (int i = 0; i < Jet<T, N>::kSize; ++i) r.c[i] = -a.c[i];
    return r;
}
template <class T, int N>
inline Jet<T, N> operator+(const Jet<T, N>& a, const Jet<T, N>& b) {
    Jet<T, N> r;
    const int size = std::max(jet_detail::terms(a), jet_detail::terms(b));
    for (int i = 0; i < size; ++i) r.c[i] = a.c[i] + b.c[i];
    return r;
}
template <class T, int N>
inline Jet<T, N> operator-(const Jet<T, N>& a, const Jet<T, N>& b) {
    Jet<T, N> r;
    const int size = std::max(jet_detail::terms(a), jet_detail::terms(b));
    for (int i = 0; i < size; ++i) r.c[i] = a.c[i] - b.c[i];
    return r;
}
template <class T, int N>
inline Jet<T, N> operator*(const Jet<T, N>& a, const Jet<T, N>& b) {
    Jet<T, N> r(a.c[0] * b.c[0]);
    const jet_detail::Factor<T, N> left(a), right(b);
    jet_detail::each_coefficient<N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        r.c[Jet<T, N>::part(k) + m] = jet_detail::convolve<k, 0, k>(left, right, m, [](int) { return 1; });
    });
    return r;
}
template <class T, int N>
inline Jet<T, N> operator*(const Jet<T, N>& a, double b) {
    if (b == 1) return a;
    Jet<T, N> r;
    const int size = jet_detail::terms(a);
    for (int i = 0; i < size; ++i) r.c[i] = a.c[i] * b;
    return r;
}
template <class T, int N>
requires(!std::is_arithmetic_v<T>) inline Jet<T, N> operator*(const Jet<T, N>& a, const T& b) {
    Jet<T, N> r;
    for (int i = 0; i < Jet<T, N>::kSize; ++i) r.c[i] = a.c[i] * b;
    return r;
}
template <class T, int N>
inline Jet<T, N> operator*(double a, const Jet<T, N>& b) {
    return b * a;
}
template <class T, int N>
inline Jet<T, N> operator+(const Jet<T, N>& a, double b) {
    Jet<T, N> r = a;
    r.c[0] = r.c[0] + T(b);
    return r;
}
template <class T, int N>
inline Jet<T, N> operator+(double a, const Jet<T, N>& b) {
    return b + a;
}
template <class T, int N>
inline Jet<T, N> operator-(const Jet<T, N>& a, double b) {
    return a + (-b);
}
template <class T, int N>
inline Jet<T, N> operator-(double a, const Jet<T, N>& b) {
    return -b + a;
}

/// q with q g = f: g_0 q_k = f_k - sum_(j<k) q_j g_(k-j)
template <class T, int N>
inline Jet<T, N> operator/(const Jet<T, N>& f, const Jet<T, N>& g) {
    const T inverse = T(1) / g.c[0];
    Jet<T, N> q(f.c[0] * inverse);
    const auto left = jet_detail::Factor<T, N>::growing(q);
    const jet_detail::Factor<T, N> right(g);
    jet_detail::each_coefficient<N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        const T known = jet_detail::convolve<k, 0, k - 1>(left, right, m, [](int) { return 1; });
        const int at = Jet<T, N>::part(k) + m;
        q.c[at] = (f.c[at] - known) * inverse;
    });
    return q;
}

/// a a, with a constant part that is never negative.
template <class T, int N>
inline Jet<T, N> square(const Jet<T, N>& a) {
    Jet<T, N> r(square(a.c[0]));
    const jet_detail::Factor<T, N> both(a);
    jet_detail::each_coefficient<N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        constexpr int degree = k;
        // Each pair of different parts counts twice.
        r.c[Jet<T, N>::part(k) + m] =
            jet_detail::convolve<k, 0, k / 2>(both, both, m, [](int j) { return 2 * j == degree ? 1 : 2; });
    });
    return r;
}

/// r with r r = f: 2 r_0 r_k = f_k - sum_(0<j<k) r_j r_(k-j)
template <class T, int N>
inline Jet<T, N> sqrt(const Jet<T, N>& f) {
    using std::sqrt;
    Jet<T, N> r(sqrt(f.c[0]));
    const T inverse = T(0.5) / r.c[0];
    const auto root = jet_detail::Factor<T, N>::growing(r);
    jet_detail::each_coefficient<N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        const T known = jet_detail::convolve<k, 1, k - 1>(root, root, m, [](int) { return 1; });
        const int at = Jet<T, N>::part(k) + m;
        r.c[at] = (f.c[at] - known) * inverse;
    });
    return r;
}

template <class T, int N>
inline void sin_cos(const Jet<T, N>& a, Jet<T, N>& s, Jet<T, N>& c) {
    using std::cos;
    using std::sin;
    s = Jet<T, N>(sin(a.c[0]));
    c = Jet<T, N>(cos(a.c[0]));
    jet_detail::oscillate<-1>(s, c, a);
}

/// E g = g E a, so k g_k = sum_(0<j<=k) j a_j g_(k-j)
template <class T, int N>
inline Jet<T, N> exp(const Jet<T, N>& a) {
    using std::exp;
    Jet<T, N> g(exp(a.c[0]));
    const jet_detail::Factor<T, N> exponent(a);
    const auto power = jet_detail::Factor<T, N>::growing(g);
    jet_detail::each_coefficient<N>([&](auto k, auto m) ANAMORPH_UNROLLED {
        const int at = Jet<T, N>::part(k) + m;
        g.c[at] = jet_detail::convolve<k, 1, k>(exponent, power, m, [](int j) { return j; }) / T(k);
    });
    return g;
}

template <class T, int N>
inline Jet<T, N> sinh(const Jet<T, N>& a) {
    using std::cosh;
    using std::sinh;
    Jet<T, N> s(sinh(a.c[0])), c(cosh(a.c[0]));
    jet_detail::oscillate<1>(s, c, a);
    return s;
}

/// a E g = E a
template <class T, int N>
inline Jet<T, N> log(const Jet<T, N>& a) {
    using std::log;
    Jet<T, N> g(log(a.c[0]));
    jet_detail::integrate_quotient(g, jet_detail::euler(a), a);
    return g;
}

/// Over cosh of a's constant part.
template <class T, int N>
inline T scaled_sinh(const Jet<T, N>& a, Jet<T, N>& s) {
    T sine;
    const T one = scaled_sinh(a.c[0], sine);
    Jet<T, N> c(T(1));
    s = Jet<T, N>(sine);
    jet_detail::oscillate<1>(s, c, a);
    return one;
}

/// E g sqrt(1 + a^2) = E a
template <class T, int N>
inline Jet<T, N> asinh(const Jet<T, N>& a) {
    using std::asinh;
    Jet<T, N> g(asinh(a.c[0]));
    jet_detail::integrate_quotient(g, jet_detail::euler(a), sqrt(square(a) + 1.0));
    return g;
}

/// (x^2 + y^2) E g = x E y - y E x
template <class T, int N>
inline Jet<T, N> atan2(const Jet<T, N>& y, const Jet<T, N>& x) {
    using std::atan2;
    Jet<T, N> g(atan2(y.c[0], x.c[0]));
    jet_detail::integrate_quotient(g, jet_detail::wronskian(x, y), square(x) + square(y));
    return g;
}

/// The constant part of a jet; a plain number is its own.
template <class T, int N>
inline const T& constant_part(const Jet<T, N>& a) {
    return a.c[0];
}
inline double constant_part(double a) {
    return a;
}
inline long double constant_part(long double a) {
    return a;
}
inline const Interval& constant_part(const Interval& a) {
    return a;
}

/// The least member.
inline double lower_end(double a) {
    return a;
}
inline long double lower_end(long double a) {
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

/// The polynomial of `Degree` about 0 as one about `shift`, in units of `scale`, by repeated division;
/// coefficient(j) refers to that of degree j.
template <int Degree, class Coefficient>
ANAMORPH_UNROLLED inline void taylor_shift(double shift, double scale, const Coefficient& coefficient) {
    double power = 1;
    jet_detail::unroll<Degree + 1>([&](auto j) ANAMORPH_UNROLLED {
        jet_detail::unroll<Degree - j>([&](auto k) ANAMORPH_UNROLLED {
            coefficient(Degree - 1 - k) += coefficient(Degree - k) * shift;
        });
        coefficient(j) *= power;
        power *= scale;
    });
}

/// f(shift_s + scale_s s, shift_t + scale_t t): from the offsets in a box to those in a part of it. A scale
/// of 1 stands for the whole side, with no shift.
template <int N>
Jet<double, N> on_part(Jet<double, N> f, double shift_s, double scale_s, double shift_t, double scale_t) {
    using J = Jet<double, N>;
    if (scale_s != 1)
        jet_detail::unroll<N + 1>([&](auto j) ANAMORPH_UNROLLED {
            taylor_shift<N - j>(shift_s, scale_s, [&](int i) -> double& { return f.c[J::part(i + j) + j]; });
        });
    if (scale_t != 1)
        jet_detail::unroll<N + 1>([&](auto i) ANAMORPH_UNROLLED {
            taylor_shift<N - i>(shift_t, scale_t, [&](int j) -> double& { return f.c[J::part(i + j) + j]; });
        });
    return f;
}

#undef ANAMORPH_UNROLLED

}  // namespace anamorph
