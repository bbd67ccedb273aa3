// SPDX-License-Identifier: Apache-2.0
// The Taylor polynomial of a pull map on a block, its remainder, and what is lost by keeping a low degree of
// it.
#pragma once

#include <cmath>

#include "anamorph/geometry/point.h"
#include "anamorph/number/jet.h"
#include "anamorph/number/rounded.h"

namespace anamorph {

/// Magnitudes of the Taylor coefficients of degree K over a box, one per power of the second variable:
/// |remainder of the polynomial of degree K - 1| <= sum_j c[j] hx^(K-j) hy^j at offsets up to (hx, hy).
template <int K>
struct Remainder {
    double c[K + 1] = {};

    template <int N>
    explicit Remainder(const Jet<Interval, N>& jet) {
        static_assert(N >= K);
        for (int j = 0; j <= K; ++j) c[j] = magnitude(jet.at(K - j, j));
    }
    double over(double hx, double hy) const {
        // Horner in hy with falling powers of hx.
        double sum = c[K], power = 1;
        for (int j = K - 1; j >= 0; --j) {
            power *= hx;
            sum = sum * hy + c[j] * power;
        }
        return sum;
    }
};

/// What rounding to double does to a map's Taylor polynomials, of degree 4 at most: a bound of its sum over
/// all coefficients, and of the coefficients themselves.
struct TaylorRounding {
    Point<double> error, size;
};

/// About all points of a box, on neighbourhoods of up to the given size.
template <class Map>
TaylorRounding taylor_rounding(const Map& map, const Interval& x, const Interval& y, double half_width,
                               double half_height, const typename Map::Local& local) {
    using R = Rounded<double>;
    const Point<R> p = map(R(x, half_width, 0), R(y, half_height, 0), local);
    return {{p.x.error, p.y.error}, {p.x.computed_size(), p.y.computed_size()}};
}

/// The polynomial c[0] + c[1] s + c[2] t + c[3] s^2 + c[4] s t + c[5] t^2 nearest to a Taylor polynomial of
/// degree 4 on [-1, 1]^2, found by dropping the products of Chebyshev polynomials above degree 2; `error`
/// bounds what was dropped (each product is at most 1).
struct Economized {
    double c[6];
    double error;

    explicit Economized(const Jet<double, 4>& f) {
        const auto size = [&](int i, int j) { return std::fabs(f.at(i, j)); };
        // s^3 = (3 T1 + T3) / 4, s^2 t = (1 + T2) t / 2, s^4 = (3 + 4 T2 + T4) / 8, s^2 t^2 = (1 + T2)(1 +
        // T2) / 4
        const double ss = 0.5 * (f.at(2, 0) + f.at(4, 0)) + 0.25 * f.at(2, 2);  // of T2(s)
        const double tt = 0.5 * (f.at(0, 2) + f.at(0, 4)) + 0.25 * f.at(2, 2);  // of T2(t)
        c[0] = f.at(0, 0) - 0.125 * (f.at(4, 0) + f.at(0, 4)) - 0.25 * f.at(2, 2);
        c[1] = f.at(1, 0) + 0.75 * f.at(3, 0) + 0.5 * f.at(1, 2);
        c[2] = f.at(0, 1) + 0.75 * f.at(0, 3) + 0.5 * f.at(2, 1);
        c[3] = 2 * ss;
        c[4] = f.at(1, 1) + 0.75 * (f.at(3, 1) + f.at(1, 3));
        c[5] = 2 * tt;
        error = 0.5 * (size(2, 1) + size(1, 2)) + 0.25 * (size(3, 0) + size(0, 3)) +
                0.25 * (size(3, 1) + size(1, 3) + size(2, 2)) + 0.125 * (size(4, 0) + size(0, 4));
    }
};

}  // namespace anamorph
