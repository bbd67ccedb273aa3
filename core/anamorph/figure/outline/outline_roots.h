// SPDX-License-Identifier: Apache-2.0
// The crossings of a quadric by a point that moves along an ellipse: the roots in the angle of
//
//     f(t) = x^2 + y^2 + z^2 - w^2,   each of x, y, z, w of the form k + c cos(t) + s sin(t).
//
// f is only ever evaluated in this factored form: in the coefficients of its expansion, or of the quartic in
// tan(t/2), the digits are lost that tell a tangent from a crossing. The expansion serves for bounds, and tells in closed form how many
// roots there are and about where, as long as none is near a tangent: those are searched for.
#pragma once

#include <cmath>

namespace anamorph::figure {

struct UnitVector {
    double cosine = 1, sine = 0;

    UnitVector turned(const UnitVector& by) const {
        return {cosine * by.cosine - sine * by.sine, sine * by.cosine + cosine * by.sine};
    }
};
/// The direction (cos(t), sin(t)) to rounding, for 0 <= t < 100.
UnitVector direction(double t);

/// The function k + c cos(t) + s sin(t) of an angle.
struct Wave {
    double k = 0, c = 0, s = 0;

    double at(const UnitVector& d) const { return k + c * d.cosine + s * d.sine; }
    double slope(const UnitVector& d) const { return s * d.cosine - c * d.sine; }
    double amplitude() const { return std::sqrt(c * c + s * s); }
};

struct WaveSquares {
    Wave x, y, z, w;
    double noise = 0;  ///< what rounding may add to f near its roots

    double at(const UnitVector& d) const {
        const double a = x.at(d), b = y.at(d), c = z.at(d), e = w.at(d);
        return a * a + b * b + c * c - e * e;
    }
};

/// The sign changes of one or more f on the circle, in [0, 2 pi), ascending; at most as many as the array
/// holds. Changes within the noise may be left out, in pairs.
struct Roots {
    static constexpr int kMost = 16;
    double angle[kMost];
    int count = 0;

    void add(double t) {
        if (count == kMost) return;
        int k = count++;
        for (; k > 0 && angle[k - 1] > t; --k) angle[k] = angle[k - 1];
        angle[k] = t;
    }
};

void add_roots(const WaveSquares& f, Roots& roots);
void add_roots(const Wave& f, Roots& roots);

}  // namespace anamorph::figure
