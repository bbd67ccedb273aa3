// SPDX-License-Identifier: Apache-2.0
// A Hermite bicubic patch in the forms that make it cheap: in powers, in Chebyshev polynomials on a block of
// its pixels, in Bernstein polynomials. Each bounds the patch in closed form from its own coefficients.
#pragma once

#include <array>
#include <cmath>

#include "anamorph/geometry/bounds_tree.h"
#include "anamorph/mesh/mesh.h"
#include "anamorph/plan/block.h"
#include "anamorph/plan/sheets.h"

namespace anamorph {

/// Sixteen coefficients of both coordinates: c[i][j] for the i-th function of s times the j-th of t. The two
/// coordinates stand side by side, so that loops over them become vectors.
struct Bicubic {
    double x[4][4], y[4][4];
};

/// Leads from Hermite data to powers of s and t: M G M^T (eq. 5.3).
inline Bicubic power_form(const Patch& patch) {
    const auto powers = [](const double* g, double* c) {
        c[0] = g[0];
        c[1] = g[2];
        c[2] = 3 * (g[1] - g[0]) - 2 * g[2] - g[3];
        c[3] = 2 * (g[0] - g[1]) + g[2] + g[3];
    };
    Bicubic form;
    const auto convert = [&](double Point<double>::*coordinate, double(&to)[4][4]) {
        double along_t[4][4];
        for (int i = 0; i < 4; ++i) {
            double g[4];
            for (int j = 0; j < 4; ++j) g[j] = patch.g[i][j].*coordinate;
            powers(g, along_t[i]);
        }
        for (int j = 0; j < 4; ++j) {
            double g[4], c[4];
            for (int i = 0; i < 4; ++i) g[i] = along_t[i][j];
            powers(g, c);
            for (int i = 0; i < 4; ++i) to[i][j] = c[i];
        }
    };
    convert(&Point<double>::x, form.x);
    convert(&Point<double>::y, form.y);
    return form;
}

/// The polynomial in powers on [s.middle -+ s.half] x [t.middle -+ t.half], as powers of parameters in [-1,
/// 1].
inline Bicubic restricted(const Bicubic& f, const Part& s, const Part& t) {
    // Taylor coefficients at the middle, scaled: for one direction, on four rows at once.
    const auto shift = [](const double(&c)[4][4], const Part& p, double(&to)[4][4]) {
        const double m = p.middle, h = p.half, h2 = h * h;
        for (int j = 0; j < 4; ++j) {
            const double c0 = c[0][j], c1 = c[1][j], c2 = c[2][j], c3 = c[3][j], c3m = c3 * m;
            to[j][0] = c0 + m * (c1 + m * (c2 + c3m));
            to[j][1] = (c1 + m * (2 * c2 + 3 * c3m)) * h;
            to[j][2] = (c2 + 3 * c3m) * h2;
            to[j][3] = c3 * (h2 * h);
        }
    };
    Bicubic turned, result;
    shift(f.x, s, turned.x);
    shift(f.y, s, turned.y);
    shift(turned.x, t, result.x);
    shift(turned.y, t, result.y);
    return result;
}

/// Turns a displacement, in powers of parameters in [-1, 1] on a part of the image (pixels), into the map.
inline void add_identity(Bicubic& f, const Mesh& mesh, const Part& x, const Part& y) {
    f.x[0][0] += x.middle * mesh.scale().x;
    f.x[1][0] += x.half * mesh.scale().x;
    f.y[0][0] += y.middle * mesh.scale().y;
    f.y[0][1] += y.half * mesh.scale().y;
}

/// A map in powers of a block's parameters as its polynomial in float.
inline BlockPolynomial float_form(const Bicubic& f, const Block& block) {
    BlockPolynomial p{3, {}};
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
            p.c[j][i] = static_cast<float>(f.x[i][j] - (i + j ? 0 : block.base_x));
            p.c[j][4 + i] = static_cast<float>(f.y[i][j] - (i + j ? 0 : block.base_y));
        }
    return p;
}

/// Sum of the magnitudes of a patch's elements, the larger of both coordinates'.
inline double size_of(const Patch& patch) {
    double x = 0, y = 0;
    for (const auto& row : patch.g)
        for (const Point<double>& g : row) {
            x += std::fabs(g.x);
            y += std::fabs(g.y);
        }
    return std::max(x, y);
}

/// A map's own error and what a computation's rounding to double adds to it, as a distance: `terms` roundings
/// of a patch's elements, 16 of the identity's part.
inline double with_rounding(const Mesh& mesh, const Mesh::Rough& rough, const Bounds& box, double terms) {
    const double place = std::max(std::max(std::fabs(box.x0), std::fabs(box.x1)) * mesh.scale().x,
                                  std::max(std::fabs(box.y0), std::fabs(box.y1)) * mesh.scale().y);
    return 1.4143 * (rough.data_error + 0x1p-53 * (terms * rough.size + 16 * place));
}
inline double rounding_of(const Mesh& mesh, const MeshCell& cell, const Patch& patch, double terms) {
    return with_rounding(mesh, {mesh.data_error(cell, patch), size_of(patch), {}, {}},
                         {patch.x0, patch.y0, patch.x1, patch.y1}, terms);
}

/// The terms of the distance of Mesh::at from the map of the given numbers on a cell, in pixels of "to". With
/// u = 2^-53: the parameters round 3 u, which moves a value by 3 u of at most 3/2 of each element, both ways;
/// a basis function of parameters in [0, 1] is at most 1 and rounds 10 u at most (s^2 (2 s - 3) + 1: a
/// subtraction of at most 3, two products, a sum); products and sums of the rows and of the whole 4 u each.
/// So less than 9 + 20 + 8 + 2 u, once each, of the elements' magnitudes; and of the identity's part the
/// scale, the product and the sum.
inline constexpr double kExactTerms = 40;
inline double exact_rounding(const Mesh& mesh, const MeshCell& cell, const Patch& patch) {
    return rounding_of(mesh, cell, patch, kExactTerms);
}
/// The largest distance of Mesh::at from the map of the given numbers in all cells of a box, where there is
/// one level.
inline double exact_rounding(const Mesh& mesh, const Bounds& box) {
    return with_rounding(mesh, mesh.rough(box.x0, box.y0, box.x1, box.y1), box, kExactTerms);
}

/// The largest distance of the forms of this file from the map of the given numbers on a cell. Powers: a
/// coefficient along one parameter rounds 5 u of at most 3, 3, 2, 1 (or 2, 2, 1, 1) times the elements; the
/// columns of M in eq. 5.2 sum to at most 6, so that all coefficients together are at most 36 times the
/// elements' magnitudes, and both passes round 10 u of that. A restriction to a part of [0, 1] evaluates
/// Taylor coefficients, whose magnitudes sum to no more than the coefficients' own: 8 u a pass; its middle
/// and half, 3 u and 2 u, move a value by at most 3 of all coefficients, both ways: 30 u. Chebyshev's form
/// and what is left of it: 10 u. In all 66 u of 36 times the elements, of which the identity's part needs the
/// restriction's and Chebyshev's share.
inline double double_rounding(const Mesh& mesh, const MeshCell& cell, const Patch& patch) {
    return rounding_of(mesh, cell, patch, 66 * 36);
}

/// The polynomial c[0] + c[1] s + c[2] t + c[3] s^2 + c[4] s t + c[5] t^2 that is left of a bicubic on [-1,
/// 1]^2 when its products of Chebyshev polynomials above degree 2 are dropped. Each product is at most 1, so
/// that the sum of what was dropped bounds the difference; it is kept apart by whose cutting makes it
/// smaller.
struct EconomizedBicubic {
    double c[6];
    double dropped, dropped_s, dropped_t;

    explicit EconomizedBicubic(const double (&p)[4][4]) {
        // s^2 = (1 + T2) / 2, s^3 = (3 T1 + T3) / 4
        const auto chebyshev = [](double& c0, double& c1, double& c2, double& c3) {
            c2 *= 0.5;
            c0 += c2;
            c3 *= 0.25;
            c1 += 3 * c3;
        };
        double k[4][4];
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) k[i][j] = p[i][j];
        for (int i = 0; i < 4; ++i) chebyshev(k[i][0], k[i][1], k[i][2], k[i][3]);
        for (int j = 0; j < 4; ++j) chebyshev(k[0][j], k[1][j], k[2][j], k[3][j]);
        c[0] = k[0][0] - k[2][0] - k[0][2];
        c[1] = k[1][0];
        c[2] = k[0][1];
        c[3] = 2 * k[2][0];
        c[4] = k[1][1];
        c[5] = 2 * k[0][2];
        const auto size = [&](int i, int j) { return std::fabs(k[i][j]); };
        const double along_s = size(3, 0) + size(2, 1) + size(3, 1) + size(3, 2);
        const double along_t = size(0, 3) + size(1, 2) + size(1, 3) + size(2, 3);
        const double both = size(2, 2) + size(3, 3);
        dropped = along_s + along_t + both;
        dropped_s = along_s + 0.5 * both;
        dropped_t = along_t + 0.5 * both;
    }
};

/// The sum of the magnitudes of a bicubic's coefficients in products of Chebyshev polynomials: a bound of it on [-1, 1]^2.
inline double chebyshev_size(const double (&p)[4][4]) {
    const EconomizedBicubic e(p);
    return std::fabs(e.c[0] + 0.5 * (e.c[3] + e.c[5])) + std::fabs(e.c[1]) + std::fabs(e.c[2]) +
           0.5 * (std::fabs(e.c[3]) + std::fabs(e.c[5])) + std::fabs(e.c[4]) + e.dropped;
}

/// The sum of the magnitudes of the coefficients of a coordinate: a bound of the coordinate on [-1, 1]^2.
inline double sum_of_magnitudes(const double (&c)[4][4]) {
    double sum = 0;
    for (const auto& row : c)
        for (const double v : row) sum += std::fabs(v);
    return sum;
}

}  // namespace anamorph
