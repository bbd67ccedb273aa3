// SPDX-License-Identifier: Apache-2.0
// An ST-map that is as large as its picture, in windows (window_map.h). The map is the lattice's (st_lattice.h).
//
// The bound of a window. Interpolation I along an axis with lines 1 apart is by weights whose magnitudes sum to 1 + s (1 - s)
// <= 5/4, s being the place in a cell: those of the inner two samples are not negative, those of the outer ones, -s (1 - s)^2 / 2 and
// -s^2 (1 - s) / 2, not positive, and all sum to 1. It reproduces polynomials of degree 2, and x^3 but for s (1 - s) (1 - 2 s)
// (the slopes at 0 and 1 come out as 1 and 4 in place of 0 and 3), which is at most sqrt(3) / 18 < 0.0963. So with p a
// polynomial of total degree 3 and r what samples are off it, |I[p + r] - p| <= (5/4)^2 max |r| + 0.0963 (|p_30| + |p_03|).
#pragma once

#include <memory>
#include <optional>

#include "anamorph/mesh/st_lattice.h"
#include "anamorph/mesh/window_map.h"

namespace anamorph {

class StWindows final : public WindowSource {
  public:
    explicit StWindows(std::shared_ptr<const StLattice> lattice) : m_lattice(std::move(lattice)) {}

    Size target_size() const override { return m_lattice->target(); }
    Size source_size() const override { return m_lattice->source(); }
    bool exact(double x, double y, Point<double>& p) const override;
    double exact_error(const Interval& x, const Interval& y, double off) const override;
    Jacobian jacobian(double x, double y) const override;
    WindowCubic cubic_over(const Box& window, double most) const override;
    std::optional<Point<Interval>> points_of(const Interval& x, const Interval& y) const override;

  private:
    /// The ranges of the displacements from the identity of all samples that count anywhere in a box; none where one is a hole.
    std::optional<Point<Interval>> displacements(const Interval& x, const Interval& y) const;

    std::shared_ptr<const StLattice> m_lattice;
};

}  // namespace anamorph
