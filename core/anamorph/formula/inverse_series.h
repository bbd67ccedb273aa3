// SPDX-License-Identifier: Apache-2.0
// The Taylor series of a function's inverse, in the plane: f(u_0 + u) = f(u_0) + J u + N(u) with N of degree 2 and more is solved for u
// by u = J^-1 (v - N(u)), where each step makes one degree more of it right.
#pragma once

#include <algorithm>
#include <cmath>

#include "anamorph/geometry/matrix2.h"
#include "anamorph/geometry/point.h"
#include "anamorph/number/jet.h"
#include "anamorph/number/jets.h"

namespace anamorph {

/// A linear map of the plane with coefficients T.
template <class T>
struct Linear {
    T a11, a12, a21, a22;
};
inline Linear<double> inverse_of(const Linear<double>& a) {
    const Matrix2 inverse = Matrix2{a.a11, a.a12, a.a21, a.a22}.inverse();
    return {inverse.a11, inverse.a12, inverse.a21, inverse.a22};
}
/// The inverses (Y J)^-1 Y of all members J, with Y that of the middle one: the first factor is near I, and
/// Cramer's rule hardly widens it.
inline Linear<Interval> inverse_of(const Linear<Interval>& a) {
    const auto middle = [](const Interval& x) { return 0.5 * (x.lo + x.hi); };
    const Linear<double> y =
        inverse_of(Linear<double>{middle(a.a11), middle(a.a12), middle(a.a21), middle(a.a22)});
    const Interval m11 = a.a11 * y.a11 + a.a21 * y.a12, m12 = a.a12 * y.a11 + a.a22 * y.a12,
                   m21 = a.a11 * y.a21 + a.a21 * y.a22, m22 = a.a12 * y.a21 + a.a22 * y.a22;
    const Interval per = Interval(1) / (m11 * m22 - m12 * m21);
    return {(m22 * y.a11 - m12 * y.a21) * per, (m22 * y.a12 - m12 * y.a22) * per,
            (m11 * y.a21 - m21 * y.a11) * per, (m11 * y.a22 - m21 * y.a12) * per};
}

namespace inverse_detail {

/// Gives access to one jet, or to several at once.
template <class J>
struct Lanes;
template <class T, int N>
struct Lanes<Jet<T, N>> {
    using J = Jet<T, N>;
    using Scalar = T;
    static constexpr int kCount = 1, kDegree = N;
    static T get(const J& a, int k, int) { return a.c[k]; }
    static void set(J& a, int, const T& constant) { a.c[0] = constant; }
    static void set_slope(J& a, int k) { a.c[k] = T(1); }
    /// Coefficients above the degree that is right do no harm.
    static void cut(J&, int) {}
};
template <class T, int N>
struct Lanes<simd::Jets<T, N>> {
    using J = simd::Jets<T, N>;
    using Scalar = T;
    static constexpr int kCount = simd::kJets, kDegree = N;
    static T get(const J& a, int k, int lane) { return k < a.terms() ? a.c[k][lane] : T(0); }
    static void set(J& a, int lane, const T& constant) { a.c[0].set(lane, constant); }
    static void set_slope(J& a, int k) {
        a.degree = 1;
        for (int lane = 0; lane < kCount; ++lane) {
            a.c[1].set(lane, T(k == 1));
            a.c[2].set(lane, T(k == 2));
        }
    }
    static void cut(J& a, int degree) { a.degree = std::min(a.degree, degree); }
};

/// The constants get(lane).
template <class J, class Get>
J constants(const Get& get) {
    J jet(0);
    for (int lane = 0; lane < Lanes<J>::kCount; ++lane) Lanes<J>::set(jet, lane, get(lane));
    return jet;
}

/// The variable s about get(lane), or t.
template <class J, class Get>
J variable(const Get& get, bool is_first) {
    J jet = constants<J>(get);
    Lanes<J>::set_slope(jet, is_first ? 1 : 2);
    return jet;
}

/// The part N(u) of f's series, up to a degree, by Horner's rule; u has no constant part.
template <class J>
J beyond_linear(const J& f, const Point<J>& u, int degree) {
    const auto coefficient = [&](int i, int j) {
        return constants<J>([&](int lane) { return Lanes<J>::get(f, (i + j) * (i + j + 1) / 2 + j, lane); });
    };
    J sum(0);
    for (int j = degree; j >= 0; --j) {
        J row(0);
        for (int i = degree - j; i >= 0; --i) {
            row = row * u.x;
            if (i + j >= 2) row = row + coefficient(i, j);
        }
        sum = sum * u.y + row;
    }
    return sum;
}

}  // namespace inverse_detail

/// The jets of the inverse: `f` is the function's series at the source points `at(lane)`, by powers of source pixels, and v the
/// target point.
template <class J, class At>
Point<J> inverse_series(const Point<J>& f, const Point<J>& v, const At& at) {
    using L = inverse_detail::Lanes<J>;
    using T = typename L::Scalar;
    Linear<T> inverse[L::kCount];
    for (int lane = 0; lane < L::kCount; ++lane)
        inverse[lane] = inverse_of(Linear<T>{L::get(f.x, 1, lane), L::get(f.x, 2, lane), L::get(f.y, 1, lane),
                                             L::get(f.y, 2, lane)});
    const auto entry = [&](T Linear<T>::*which) {
        return inverse_detail::constants<J>([&](int lane) { return inverse[lane].*which; });
    };
    const J a11 = entry(&Linear<T>::a11), a12 = entry(&Linear<T>::a12), a21 = entry(&Linear<T>::a21),
            a22 = entry(&Linear<T>::a22);
    const auto solved = [&](const J& x, const J& y, int degree) {
        Point<J> u{a11 * x + a12 * y, a21 * x + a22 * y};
        L::cut(u.x, degree);
        L::cut(u.y, degree);
        return u;
    };
    Point<J> rest = v;
    for (int lane = 0; lane < L::kCount; ++lane) {
        L::set(rest.x, lane, T(0));
        L::set(rest.y, lane, T(0));
    }
    Point<J> u = solved(rest.x, rest.y, 1);
    for (int degree = 2; degree <= L::kDegree; ++degree)
        u = solved(rest.x - inverse_detail::beyond_linear(f.x, u, degree),
                   rest.y - inverse_detail::beyond_linear(f.y, u, degree), degree);
    for (int lane = 0; lane < L::kCount; ++lane) {
        L::set(u.x, lane, at(lane).x);
        L::set(u.y, lane, at(lane).y);
    }
    return u;
}

}  // namespace anamorph
