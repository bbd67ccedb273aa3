// SPDX-License-Identifier: Apache-2.0
// Meshes that push, drawn by pulling: the inverse of a mesh's map, certified part by part (plan/sheets.h) and by blocks.
//
// Sheets. N's coefficients, those of a bicubic, bound it and its Lipschitz constant; the map in double errs by exact_rounding of
// hermite.h. Parts smaller than kFoldSize are folds.
//
// Blocks. Around the preimage of a block's middle, in parameters z of the block, the map is z + Q(z) + C(z) + F(z) +
// higher terms, of degrees 2, 3, 4 and more. Its inverse is z - Q(z) + T(z) + U(z) + remainder, where by degrees
// T = DQ Q - C and U = DC Q - DQ T - Q(Q(z)) - F; norms of the coefficients prove existence and uniqueness (Banach's
// fixed point theorem on a ball somewhat larger than the block) and bound the remainder. The polynomial is economised to
// a quadratic, or but for its fourth powers drawn as it is. Neighbouring cells that the ball reaches enter with their
// difference from the cell in the middle, so that blocks may run over edges.
#pragma once

#include "anamorph/mesh/mesh_plan.h"
#include "anamorph/plan/sheets.h"

namespace anamorph {

class InversePlan final : public WarpPlan {
  public:
    /// The mesh's map leads from the source to the target. `tol`: source pixels. Throws Error when tol is
    /// negative or not a number, or the mesh turns over nearly everywhere.
    InversePlan(Mesh mesh, WarpScheme scheme, double tol, const std::string& name);

    const Mesh& mesh() const { return m_mesh; }

    /// Finds the source point of a target point. Of several source points it takes those where the mesh is not turned over, of
    /// these the one in the cell of level 0 with the largest number, row by row, of these the lowest, of these the rightmost.
    bool exact(double x, double y, int piece, Point<double>& source_point,
               int& source_piece) const noexcept override;
    BlockPolynomial bicubic(const Block& block) const noexcept override;
    Jacobian jacobian(double x, double y, int piece) const noexcept override;
    /// The number of source points of a target point less one; at least 1 where they cannot be told apart.
    float folds(double x, double y) const noexcept override;
    std::int64_t folded_pixels(const Box& box) const override;
    /// Null where the mesh is rough, where another scheme than automatic or exact is asked for, and where no shared_ptr holds it.
    std::shared_ptr<const MapLink> link() const override;
    std::string why_unlinked() const override;

    static constexpr double kFoldSize = 1.0 / 4;
    /// The largest number of visits for a pixel near a fold.
    static constexpr int most_visits() { return 1024; }

    /// The target point of parameters z of a sheet.
    Point<double> on_sheet(const Sheet& sheet, const Point<double>& z) const noexcept;
    const std::vector<Sheet>& sheets() const { return m_sheets; }
    const std::vector<MeshCell>& cells() const { return m_cells; }
    const BoundsTree& tree() const { return m_tree; }

    Preimages preimages(double x, double y) const noexcept;
    /// Finds the source point of (x, y) on a sheet that is no fold. False where there is none.
    bool find(const Sheet& sheet, double x, double y, Preimage& found) const noexcept;
    /// Finds the source point of (x, y) on a sheet that is no fold, with the `patch` of its cell. False where there is none.
    bool find(const Sheet& sheet, const Patch& patch, double x, double y, Preimage& found) const noexcept;

  protected:
    void plan(const Box& box, int piece, Blocks& blocks) const override;

  private:
    friend class PreimageSearch<InversePlan>;
    class CellParts;
    CellParts cell(int number) const;
    bool before(const Preimage& a, const Preimage& b) const noexcept;

    Mesh m_mesh;
    WarpScheme m_scheme;
    double m_tol;
    std::vector<MeshCell> m_cells;
    std::vector<Sheet> m_sheets;
    BoundsTree m_tree;
};

}  // namespace anamorph
