// SPDX-License-Identifier: Apache-2.0
// A cubic that stands for a map in a window of its target, off by a bound that is known: what chains of maps read where a map has no
// formula that goes on with any other.
//
// That bound is no polynomial's, yet Rounded (number/rounded.h) passes it on. Of a box it knows the range of values at all pixels'
// centres, and each of its operations says by how much its value there may be moved where its operands are moved by up to their errors;
// what it adds for the other coefficients of jets makes that larger. So the map is no farther off at any centre than it says.
#pragma once

#include <array>
#include <vector>

#include "anamorph/geometry/point.h"
#include "anamorph/number/interval.h"
#include "anamorph/number/rounded.h"

namespace anamorph {

/// Pixels of the target and of the source, x right, y down, pixel centres at + 0.5.
struct WindowCubic {
    /// The powers of s and t of each coefficient.
    static constexpr int kAcross[] = {0, 1, 0, 2, 1, 0, 3, 2, 1, 0}, kDown[] = {0, 0, 1, 0, 1, 2, 0, 1, 2, 3};
    /// The part of the tolerance that a cubic may be off the map that it stands for.
    static constexpr double kShare = 0.5;

    Interval x{1, 0}, y{1, 0};  ///< where it is off by `error` at most; empty where that is nowhere
    Point<double> middle{0, 0};
    double unit = 1;                  ///< windows per pixel, half of one
    double cx[10] = {}, cy[10] = {};  ///< coefficients as in Jet, in units of a window about its middle
    double error = 0;                 ///< in either coordinate

    bool serves() const { return x.lo <= x.hi; }
    bool holds(const Interval& across, const Interval& down) const {
        return across.lo >= x.lo && across.hi <= x.hi && down.lo >= y.lo && down.hi <= y.hi;
    }
    /// The sum of the magnitudes of its coefficients, the larger of both coordinates'.
    double size() const;

    /// The cubic; of Interval and Rounded, what the map may be.
    template <class T>
    Point<T> operator()(const T& at_x, const T& at_y) const {
        return cubic(at_x, at_y);
    }
    Point<Interval> operator()(const Interval& at_x, const Interval& at_y) const {
        const Point<Interval> p = cubic(at_x, at_y);
        const Interval off(-error, error);
        return {p.x + off, p.y + off};
    }
    Point<Rounded<double>> operator()(const Rounded<double>& at_x, const Rounded<double>& at_y) const {
        Point<Rounded<double>> p = cubic(at_x, at_y);
        p.x.error += error;
        p.y.error += error;
        return p;
    }

  private:
    template <class T>
    Point<T> cubic(const T& at_x, const T& at_y) const {
        const T s = (at_x - middle.x) * unit, t = (at_y - middle.y) * unit, s2 = square(s), t2 = square(t);
        const auto sum = [&](const double* c) {
            return s * c[1] + t * c[2] + s2 * c[3] + s * t * c[4] + t2 * c[5] + s2 * (s * c[6] + t * c[7]) +
                   t2 * (s * c[8] + t * c[9]) + c[0];
        };
        return {sum(cx), sum(cy)};
    }
};

/// The least-squares fit of cubics to values at fixed places of a window, -1 to 1 over all of it.
class CubicFit {
  public:
    explicit CubicFit(std::vector<Point<double>> places);

    const std::vector<Point<double>>& places() const { return m_places; }
    /// Sets the coefficients of a cubic near value(n) at each place n.
    template <class Value>
    void fit(const Value& value, WindowCubic& cubic) const {
        std::array<double, 10> sum_x{}, sum_y{};
        for (std::size_t n = 0; n < m_places.size(); ++n) {
            const Point<double> v = value(n);
            for (std::size_t a = 0; a < 10; ++a) {
                sum_x[a] += v.x * m_monomials[n][a];
                sum_y[a] += v.y * m_monomials[n][a];
            }
        }
        for (std::size_t a = 0; a < 10; ++a) {
            cubic.cx[a] = cubic.cy[a] = 0;
            for (std::size_t b = 0; b < 10; ++b) {
                cubic.cx[a] += m_inverse[a][b] * sum_x[b];
                cubic.cy[a] += m_inverse[a][b] * sum_y[b];
            }
        }
    }

  private:
    std::vector<Point<double>> m_places;
    std::vector<std::array<double, 10>> m_monomials;
    std::array<std::array<double, 10>, 10> m_inverse{};
};

}  // namespace anamorph
