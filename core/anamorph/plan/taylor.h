// SPDX-License-Identifier: Apache-2.0
// The Taylor polynomial of a pull map on a block, its remainder, and what is lost by keeping a low degree of
// it.
#pragma once

#include <cmath>

#include "anamorph/geometry/point.h"
#include "anamorph/number/jet.h"
#include "anamorph/number/rounded.h"

namespace anamorph {

namespace plan_detail {

inline double length(double x, double y) {
    return std::sqrt(x * x + y * y);
}

}  // namespace plan_detail

/// The magnitudes of the Taylor coefficients of degree K over a box, one per power of the second variable:
/// |remainder of the polynomial of degree K - 1| <= sum_j c[j] hx^(K-j) hy^j at offsets up to (hx, hy).
template <int K>
struct Remainder {
    double c[K + 1] = {};
    double middle[K + 1] = {};  ///< magnitudes of the coefficients' middles

    template <int N>
    explicit Remainder(const Jet<Interval, N>& jet) {
        static_assert(N >= K);
        for (int j = 0; j <= K; ++j) {
            const Interval& a = jet.at(K - j, j);
            c[j] = magnitude(a);
            middle[j] = std::fabs(0.5 * (a.lo + a.hi));
        }
    }
    /// The larger of two remainders, over two boxes.
    static Remainder larger(Remainder a, const Remainder& b) {
        for (int j = 0; j <= K; ++j) {
            a.c[j] = rounded_detail::larger(a.c[j], b.c[j]);
            a.middle[j] = rounded_detail::larger(a.middle[j], b.middle[j]);
        }
        return a;
    }
    double over(double hx, double hy) const { return sum(c, hx, hy); }
    /// The part of the remainder that may be left over a much smaller box.
    double about(double hx, double hy) const { return sum(middle, hx, hy); }

  private:
    static double sum(const double* c, double hx, double hy) {
        // Horner in hy with falling powers of hx.
        double sum = c[K], power = 1;
        for (int j = K - 1; j >= 0; --j) {
            power *= hx;
            sum = sum * hy + c[j] * power;
        }
        return sum;
    }
};

/// The rounding to double of a map's Taylor polynomials, of degree 4 at most: a bound of its sum over all
/// coefficients, and of the coefficients themselves.
struct TaylorRounding {
    Point<double> error, size;
};

/// The rounding of Taylor polynomials about all points of a box, on neighbourhoods of up to the given size.
template <class Map>
TaylorRounding taylor_rounding(const Map& map, const Interval& x, const Interval& y, double half_width,
                               double half_height, const typename Map::Local& local) {
    using R = Rounded<double>;
    const Point<R> p = map(R(x, half_width, 0), R(y, half_height, 0), local);
    return {{p.x.error, p.y.error}, {p.x.computed_size(), p.y.computed_size()}};
}

/// The polynomial of total degree 3 nearest to a Taylor polynomial of degree 4 on [-1, 1]^2, found by dropping
/// the products of Chebyshev polynomials of degree 4: coefficients degree by degree, those of s^k, s^(k-1) t, ...
/// `error` bounds what was dropped (each product is at most 1).
struct EconomizedCubic {
    double c[10];
    double error;

    explicit EconomizedCubic(const Jet<double, 4>& f) {
        const auto size = [&](int i, int j) { return std::fabs(f.at(i, j)); };
        // s^4 = s^2 - 1/8 + T4 / 8, s^3 t = (3 s + T3) t / 4, s^2 t^2 = (s^2 + t^2) / 2 - 1/4 + T2(s) T2(t) / 4
        for (int k = 0; k < 10; ++k) c[k] = f.c[k];
        c[0] -= 0.125 * (f.at(4, 0) + f.at(0, 4)) + 0.25 * f.at(2, 2);
        c[3] += f.at(4, 0) + 0.5 * f.at(2, 2);
        c[4] += 0.75 * (f.at(3, 1) + f.at(1, 3));
        c[5] += f.at(0, 4) + 0.5 * f.at(2, 2);
        error = 0.125 * (size(4, 0) + size(0, 4)) + 0.25 * (size(3, 1) + size(1, 3) + size(2, 2));
    }
};

/// The polynomial of degree 2 nearest to such a cubic, c[0] + c[1] s + c[2] t + c[3] s^2 + c[4] s t +
/// c[5] t^2, with the products of degree 3 dropped as well.
struct Economized {
    double c[6];
    double error;

    explicit Economized(const EconomizedCubic& f) {
        // s^3 = (3 s + T3) / 4, s^2 t = (1 + T2(s)) t / 2
        for (int k = 0; k < 6; ++k) c[k] = f.c[k];
        c[1] += 0.75 * f.c[6] + 0.5 * f.c[8];
        c[2] += 0.75 * f.c[9] + 0.5 * f.c[7];
        error = f.error + 0.25 * (std::fabs(f.c[6]) + std::fabs(f.c[9])) +
                0.5 * (std::fabs(f.c[7]) + std::fabs(f.c[8]));
    }
};

}  // namespace anamorph
