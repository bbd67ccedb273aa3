// SPDX-License-Identifier: Apache-2.0
// The blocks of an ST-map that is as large as the picture and taken pixel for pixel: the source point of a
// pixel is its sample, and nothing is interpolated; a hole has none. Between the samples the map is that of the mesh that they
// make (mesh_lattice.h), which gives derivatives and folds.
#pragma once

#include <memory>
#include <mutex>

#include "anamorph/mesh/mesh_plan.h"
#include "anamorph/mesh/st_lattice.h"

namespace anamorph {

class StMapPlan final : public WarpPlan {
  public:
    /// Does a mesh say the source point of each pixel of a target?
    static bool serves(const ControlMesh& mesh, const Size& target);

    /// Plans a mesh that serves. `tol`: source pixels; 0 or scheme exact: every pixel in double. Throws Error
    /// when tol is negative or not a number, and where Mesh does.
    StMapPlan(const ControlMesh& mesh, const Size& target, const Size& source, double amount,
              WarpScheme scheme, double tol, const std::string& name);

    bool exact(double x, double y, int piece, Point<double>& source_point,
               int& source_piece) const noexcept override;
    void exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept override;
    Jacobian jacobian(double x, double y, int piece) const noexcept override;
    void computed_row(const Block& block, int row, int begin, int end, float* x,
                      float* y) const noexcept override;
    float folds(double x, double y) const noexcept override;
    std::int64_t folded_pixels(const Box& box) const override;
    /// Null where another scheme than automatic or exact is asked for, and where its samples are so rough that most pixels of a
    /// chain would be exact.
    std::shared_ptr<const MapLink> link() const override;
    std::string why_unlinked() const override;

  protected:
    void plan(const Box& box, int piece, Blocks& blocks) const override;

  private:
    Jacobian jacobian_by_neighbors(int column, int row) const;
    double orientation() const;

    std::shared_ptr<const StLattice> m_lattice;
    WarpScheme m_scheme;
    double m_given_tol, m_tol;  ///< m_tol: 0 where every pixel is exact
    mutable std::once_flag m_turned;
    mutable double m_orientation = 1;
};

}  // namespace anamorph
