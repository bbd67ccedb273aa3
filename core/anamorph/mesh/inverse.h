// SPDX-License-Identifier: Apache-2.0
// Meshes that push, drawn by pulling: the inverse of a mesh's map, certified.
//
// Sheets. Every patch is cut until it is certainly one to one: in parameters z in [-1, 1]^2 of a part, with Y
// the inverse of the derivative at its middle, Y (f(z) - f(0)) = z + N(z), and the coefficients of the
// bicubic bound N and its Lipschitz constant rho (<= kContraction). Then
//   - a point p has at most one preimage in the part: the fixed point of z -> w - N(z), w = Y (p - f(0)), to
//     which this iteration (the chord form of Newton's, with Krawczyk's bound) converges;
//   - it has none where |w| > 1 + max |N|.
// Where no such part can be had (the derivative is singular: a fold), cutting ends at parts smaller than
// kFoldSize target pixels. Pixels on such parts are computed one by one, and the parts cut on for each of
// them as far as it takes to tell its source points apart: down to kUndecided source pixels, or kMostVisits
// parts. What then is left (a pixel within rounding of a fold's edge, or a mesh squeezed to a line) counts as
// a source point and as a fold, with a bound that spans all that it may be.
//
// Rounding. The map in double errs by e (exact_rounding of hermite.h), so that the iteration ends within |Y|
// e / (1 - rho) of the exact source point, in z; parts overlap by more than that, and points found on the
// edges of two parts are compared.
//
// Blocks. Around the preimage of a block's middle, in parameters z of the block, the map is z + Q(z) + C(z) + F(z) +
// higher terms, of degrees 2, 3, 4 and more. Its inverse is z - Q(z) + T(z) + U(z) + remainder, where by degrees
// T = DQ Q - C and U = DC Q - DQ T - Q(Q(z)) - F; norms of the coefficients prove existence and uniqueness (Banach's
// fixed point theorem on a ball somewhat larger than the block) and bound the remainder. The polynomial is economised to
// a quadratic, or but for its fourth powers drawn as it is. Neighbouring cells that the ball reaches enter with their
// difference from the cell in the middle, so that blocks may run over edges.
#pragma once

#include "anamorph/mesh/mesh_plan.h"
#include "anamorph/mesh/mesh_tree.h"

namespace anamorph {

class InversePlan final : public WarpPlan {
  public:
    /// The mesh's map leads from the source to the target. `tol`: source pixels. Throws Error when tol is
    /// negative or not a number, or the mesh turns over nearly everywhere.
    InversePlan(Mesh mesh, WarpScheme scheme, double tol, const std::string& name);

    const Mesh& mesh() const { return m_mesh; }

    /// Of several source points: those where the mesh is not turned over first, of these the one in the cell
    /// of level 0 with the largest number, row by row, of these the lowest, of these the rightmost.
    bool exact(double x, double y, int piece, Point<double>& source_point,
               int& source_piece) const noexcept override;
    BlockPolynomial bicubic(const Block& block) const noexcept override;
    Jacobian jacobian(double x, double y, int piece) const noexcept override;
    /// The number of source points less one; at least 1 where they cannot be told apart.
    float folds(double x, double y) const noexcept override;
    std::int64_t folded_pixels(const Box& box) const override;

    static constexpr double kContraction = 1.0 / 4;
    static constexpr double kFoldSize = 1.0 / 4;
    static constexpr double kUndecided = 0x1p-20;
    static constexpr int kMostVisits = 1024;

    /// A part of a cell that is one to one, or a fold.
    struct Sheet {
        int cell;  ///< in cells()
        bool fold;
        double s, t, hs, ht;        ///< the middle and half the size, parameters of the cell
        Point<double> at;           ///< f(0), target pixels
        double y11, y12, y21, y22;  ///< Y, per target pixel
        double reach;               ///< of N
        double hair;                ///< how far z runs beyond 1, so that no point on an edge is lost
        double noise;               ///< what rounding makes of z
        double error;               ///< of a source point found here, source pixels
        double edge;                ///< as far apart, source points on two parts' edges may be the same
    };
    /// The target point of parameters z of a sheet.
    Point<double> on_sheet(const Sheet& sheet, const Point<double>& z) const noexcept;
    const std::vector<Sheet>& sheets() const { return m_sheets; }
    const std::vector<MeshCell>& cells() const { return m_cells; }
    const BoundsTree& tree() const { return m_tree; }

    /// One source point of a target point.
    struct Preimage {
        Point<double> at;
        int cell;      ///< in cells()
        bool turned;   ///< is the mesh turned over there?
        double error;  ///< of the point
        double edge;   ///< above 0: on the edge of its part, as far as others may be the same point
    };
    struct Preimages {
        Preimage best;
        int count = 0;
        bool on_fold = false;  ///< some could not be told apart
        double error = 0;      ///< of the distance from the best to the exact one
    };
    Preimages preimages(double x, double y) const noexcept;
    /// Finds the source point of (x, y) on a sheet that is no fold. False where there is none. `patch`: of its cell.
    bool find(const Sheet& sheet, const Patch& patch, double x, double y, Preimage& found) const noexcept;

  protected:
    void plan(const Box& box, int piece, Blocks& blocks) const override;

  private:
    class Search;
    bool reaches(const Sheet& sheet, double x, double y) const noexcept;
    bool before(const Preimage& a, const Preimage& b) const noexcept;

    Mesh m_mesh;
    WarpScheme m_scheme;
    double m_tol;
    std::vector<MeshCell> m_cells;
    std::vector<Sheet> m_sheets;
    BoundsTree m_tree;
};

}  // namespace anamorph
