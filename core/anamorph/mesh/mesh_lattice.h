// SPDX-License-Identifier: Apache-2.0
// The map of a mesh of one level as a sum over the vertices around: by the Hermite basis and the secants of
// eq. 5.8, the displacement at (x, y) is the sum of a_i(x) b_j(y) f_ij over four lines either way. Where
// cells are as small as pixels this takes no patches and no derivatives at vertices; at a vertex it is that
// vertex's own displacement.
//
// Rounding, u = 2^-53. The parameter rounds 3 u and the basis 10 u, as for patches (exact_rounding of
// hermite.h); the share of a cell in the span of a secant 4 u; so a weight less than 20 u. Along an axis the
// magnitudes of the weights sum to at most 1 + 4 * 4/27 < 1.6 (slopes count at most 4/27, and a cell is no
// wider than the span of a secant), and sums of four round 4 u. With d the largest displacement both axes
// make less than 2 * 1.6 * (4 * 20 + 8) u d < 300 u d: less than the 40 u of 36 d in exact_rounding, which
// therefore bounds this too.
#pragma once

#include <span>

#include "anamorph/mesh/mesh.h"

namespace anamorph {

/// Four lines about a position, first ... first + 3, and the weights of the values there in a function's
/// value and in its derivative per pixel. Those of [begin, end) alone count in the value.
struct LatticeWeights {
    int first = 0, begin = 0, end = 4;
    double value[4] = {}, slope[4] = {};

    /// Does one value alone count? Its weight is 1 then.
    bool on_line() const { return end - begin == 1; }
    /// The first line whose value counts.
    int line() const { return first + begin; }

    LatticeWeights() = default;
    /// Finds the weights at a position. `lines` ascend; at least 4.
    LatticeWeights(std::span<const double> lines, double at);
};

/// Is a mesh a lattice: of one level, with four lines either way?
inline bool is_lattice(const Mesh& mesh) {
    return !mesh.has_levels() && mesh.columns() >= 3 && mesh.rows() >= 3;
}

/// The map at (x, y), whose weights are given.
Point<double> lattice_point(const Mesh& mesh, const LatticeWeights& across, const LatticeWeights& down,
                            double x, double y);
/// The derivatives of the map, whose weights are given.
Jacobian lattice_jacobian(const Mesh& mesh, const LatticeWeights& across, const LatticeWeights& down);

namespace lattice_detail {

/// The sum of weight i times at(i) for i in [begin, end).
template <class At>
Point<double> sum(const double* weights, int begin, int end, const At& at) {
    Point<double> s{0, 0};
    for (int i = begin; i < end; ++i) {
        const Point<double> p = at(i);
        s.x += weights[i] * p.x;
        s.y += weights[i] * p.y;
    }
    return s;
}

}  // namespace lattice_detail

/// The displacement of a lattice whose vertices are displaced by at(column, row).
template <class At>
Point<double> lattice_displacement(const At& at, const LatticeWeights& across, const LatticeWeights& down) {
    using lattice_detail::sum;
    return sum(down.value, down.begin, down.end, [&](int j) {
        return sum(across.value, across.begin, across.end,
                   [&](int i) { return at(across.first + i, down.first + j); });
    });
}
/// The derivatives of the map of a lattice whose vertices are displaced by at(column, row), `scale` being
/// those of the identity.
template <class At>
Jacobian lattice_jacobian(const At& at, const Point<double>& scale, const LatticeWeights& across,
                          const LatticeWeights& down) {
    using lattice_detail::sum;
    const auto along = [&](const double* weights, int begin, int end) {
        return [&at, &across, &down, weights, begin, end](int j) {
            return sum(weights, begin, end, [&](int i) { return at(across.first + i, down.first + j); });
        };
    };
    const Point<double> by_x = sum(down.value, down.begin, down.end, along(across.slope, 0, 4)),
                        by_y = sum(down.slope, 0, 4, along(across.value, across.begin, across.end));
    return {scale.x + by_x.x, by_x.y, by_y.x, scale.y + by_y.y};
}

}  // namespace anamorph
