// SPDX-License-Identifier: Apache-2.0
// The blocks of a mesh warp. A block lies in one cell of the mesh, where the map is one bicubic patch, so
// that every bound is in closed form from the patch's own coefficients:
//
// - hermite: the patch (Kim 2003, 5.3.5) restricted to the block, in float.
// - automatic: so, or economised to a quadratic (hermite.h) where that holds the tolerance.
// - residual: the plane through three vertices for each of a cell's two triangles, in double, plus the
//   thirteen non-linear products of eq. 5.5 and 5.7 from tables read bilinearly (5.4).
//
// Point by point where that exceeds the tolerance or a cell has few pixels; where most cells have few and all
// are of one level, as in dense ST-maps, by a sum over the vertices around (mesh_lattice.h).
//
// It is no FormulaPlan: a mesh is a formula for each cell, whose edges blocks may not cross, and a patch is a
// polynomial already, so that nothing is left to expand or enclose. Meshes that push are solved for, and
// pairs of points triangulated: no single formula either. What these plans share is BlockWriter, which also
// halves their blocks: in the middle, where FormulaPlan cuts at powers of two, which keep its blocks in line.
#pragma once

#include <memory>

#include "anamorph/mesh/mesh.h"
#include "anamorph/plan/block.h"
#include "anamorph/plan/formula_plan.h"
#include "anamorph/plan/scheme.h"

namespace anamorph {

/// The source points of a warp, in blocks, and where it folds.
class WarpPlan : public BlockMap, public std::enable_shared_from_this<WarpPlan> {
  public:
    using BlockMap::BlockMap;

    /// The number at a pixel's centre that MeshWarpOptions::folds shows.
    virtual float folds(double x, double y) const noexcept = 0;
    /// The number of pixels of a box that are folded (folds is not 0).
    virtual std::int64_t folded_pixels(const Box& box) const;
};

/// Does a scheme let a warp be joined with others? Else it is asked for by itself.
constexpr bool joins(WarpScheme scheme) {
    return scheme == WarpScheme::automatic || scheme == WarpScheme::exact;
}

/// How a warp is planned as a link of a chain.
PlanOptions link_options(WarpScheme scheme, double tol);

class WindowSource;

/// A warp as a link of a chain, by windows of it; null where these are too small to be worth it, unless all pixels are exact.
std::shared_ptr<const MapLink> window_link(std::shared_ptr<const WindowSource> source, WarpScheme scheme,
                                           double tol);

class ResidualTables;

/// The blocks of a control mesh that pulls.
class MeshPlan final : public WarpPlan {
  public:
    /// `tol`: source pixels. Throws Error when it is negative or not a number.
    MeshPlan(Mesh mesh, WarpScheme scheme, double tol);

    const Mesh& mesh() const { return m_mesh; }

    bool exact(double x, double y, int piece, Point<double>& source_point,
               int& source_piece) const noexcept override;
    Jacobian jacobian(double x, double y, int piece) const noexcept override;
    BlockPolynomial bicubic(const Block& block) const noexcept override;
    void computed_row(const Block& block, int row, int begin, int end, float* x,
                      float* y) const noexcept override;
    void computed(std::span<const Block> layers, const PointRows* to) const noexcept override;
    float folds(double x, double y) const noexcept override;
    std::int64_t folded_pixels(const Box& box) const override;
    /// Null where its cells are small and differ, or another scheme than automatic or exact is asked for.
    std::shared_ptr<const MapLink> link() const override;
    std::string why_unlinked() const override;

  protected:
    void plan(const Box& box, int piece, Blocks& blocks) const override;

  private:
    bool folds(const Jacobian& jacobian) const noexcept;
    std::int64_t folded_pixels_of_lattice(const Box& box) const;
    void lattice_rows(const Block& block, const Box& part, const PointRows& to) const noexcept;

    Mesh m_mesh;
    WarpScheme m_scheme;
    double m_tol;
    bool m_lattice = false;  ///< is the mesh read as a lattice (mesh_lattice.h)?
    std::shared_ptr<const ResidualTables> m_tables;
};

}  // namespace anamorph
