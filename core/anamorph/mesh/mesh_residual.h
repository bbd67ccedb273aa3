// SPDX-License-Identifier: Apache-2.0
// Kim 2003, 5.3.2 and 5.4: a Hermite patch as a plane for each of the cell's two triangles plus a residual,
// which is the sum of thirteen products of Hermite basis functions, read from tables.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "anamorph/mesh/hermite.h"

namespace anamorph {

/// The decomposition of one patch. Triangle 0 has the corners (0, 0), (1, 0), (0, 1) of (s, t), triangle 1
/// those across; the plane through its corners' values is origin + s * right + t * down.
struct ResidualPatch {
    static constexpr int kProducts = 14;  ///< thirteen for each triangle, twelve of them shared

    struct Triangle {
        Point<double> origin, right, down;
        /// The elements of G_N1 (eq. 5.5) or G_N2 (5.7) that belong to the tabulated products.
        float x[16] = {}, y[16] = {};
        double sum = 0;        ///< sum of their magnitudes
        double curvature = 0;  ///< sum of their magnitudes times (|f_ss| + |f_tt|) of their products
    };
    Triangle triangles[2];

    explicit ResidualPatch(const Patch& patch);

    /// The rounding of tables, elements and sums to float; `block`: the map on the block, for the plane.
    double float_rounding(const Bicubic& block) const;
};

/// The fourteen products a_i(s) a_j(t) of basis functions (eq. 5.3), in the order of ResidualPatch.
std::array<double, ResidualPatch::kProducts> residual_products(double s, double t);

/// The products residual_products() on a grid of kCells x kCells cells.
class ResidualTables {
  public:
    static constexpr int kCells = 256;

    /// The tables, which are made once.
    static std::shared_ptr<const ResidualTables> shared();

    /// The error of reading the tables bilinearly: for a product f at most (|f_ss| + |f_tt|) / 8 of a cell's
    /// side squared, times its element.
    double bound(const ResidualPatch& patch) const;

    /// The point that (s, t) = (0, 0) is counted from: its coordinates, and pixels a step to the right.
    struct Origin {
        double x, y, step;
    };
    /// Finds pixels [begin, end) of a row at parameter t, with s = first + i * step: the map less what
    /// `origin` says.
    void row(const ResidualPatch& patch, const Origin& origin, double first, double step, double t, int begin,
             int end, float* x, float* y) const;

  private:
    ResidualTables();
    const float* node(int s, int t) const {
        return m_products.data() +
               (static_cast<std::size_t>(t) * (kCells + 1) + static_cast<std::size_t>(s)) * 16;
    }

    std::vector<float> m_products;  ///< 16 floats a node, the last two 0
};

}  // namespace anamorph
