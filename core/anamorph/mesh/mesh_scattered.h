// SPDX-License-Identifier: Apache-2.0
// The blocks of a warp through pairs of points: the cubic at a block's middle, or a quadratic near it, where
// the other cubics that the block meets differ little from it, bounded on what they share; else every pixel
// by the cubic it lies in.
#pragma once

#include "anamorph/mesh/mesh_plan.h"
#include "anamorph/mesh/scattered.h"

namespace anamorph {

class ScatteredPlan final : public WarpPlan {
  public:
    /// `tol`: source pixels. Throws Error when it is negative or not a number.
    ScatteredPlan(Scattered map, WarpScheme scheme, double tol);

    const Scattered& map() const { return m_map; }

    bool exact(double x, double y, int piece, Point<double>& source_point,
               int& source_piece) const noexcept override;
    BlockPolynomial bicubic(const Block& block) const noexcept override;
    void computed_row(const Block& block, int row, int begin, int end, float* x,
                      float* y) const noexcept override;
    void computed(std::span<const Block> layers, const PointRows* to) const noexcept override;
    Jacobian jacobian(double x, double y, int piece) const noexcept override;
    float folds(double x, double y) const noexcept override;
    std::int64_t folded_pixels(const Box& box) const override;
    /// Null where triangles are small, where another scheme than automatic or exact is asked for, and where no shared_ptr holds it.
    std::shared_ptr<const MapLink> link() const override;
    std::string why_unlinked() const override;

  protected:
    void plan(const Box& box, int piece, Blocks& blocks) const override;

  private:
    Scattered m_map;
    WarpScheme m_scheme;
    double m_tol;
};

}  // namespace anamorph
