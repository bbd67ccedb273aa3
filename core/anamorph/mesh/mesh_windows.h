// SPDX-License-Identifier: Apache-2.0
// A control mesh that pulls, of cells too small to be formulas of a chain (cell_map.h), in windows (window_map.h).
//
// The bound of a window. On a cell the map is a bicubic, and so is what a cubic of the window differs from it by: it is known by its
// values, slopes and twists at the cell's corners, in units of the cell. By the Hermite basis, of which the two of values are not
// negative and sum to 1, and the magnitudes of the two of slopes to s (1 - s) <= 1/4, it is at most max |value| + max |slope along s| / 4 +
// max |slope along t| / 4 + max |twist| / 16. Of a cell that reaches beyond the window, the coefficients of the difference on their common
// part bound it.
#pragma once

#include <memory>

#include "anamorph/mesh/mesh.h"
#include "anamorph/mesh/window_map.h"

namespace anamorph {

class MeshWindows final : public WindowSource {
  public:
    /// Cells of a window of fewer pixels on average cost more than what is gained by it.
    static constexpr int kLeastPixels = 16;

    explicit MeshWindows(std::shared_ptr<const Mesh> mesh) : m_mesh(std::move(mesh)) {}

    Size target_size() const override { return m_mesh->from(); }
    Size source_size() const override { return m_mesh->to(); }
    bool exact(double x, double y, Point<double>& p) const override;
    double exact_error(const Interval& x, const Interval& y, double off) const override;
    Jacobian jacobian(double x, double y) const override;
    WindowCubic cubic_over(const Box& window, double most) const override;
    std::optional<Point<Interval>> points_of(const Interval& x, const Interval& y) const override;

  private:
    /// Calls body(cell, patch, s, t, map) for the cells that meet a box: their part of it in parameters of the cell, and the map on that in
    /// powers of parameters in [-1, 1].
    template <class Body>
    void each_part(const Interval& x, const Interval& y, const Body& body) const;

    std::shared_ptr<const Mesh> m_mesh;
};

}  // namespace anamorph
