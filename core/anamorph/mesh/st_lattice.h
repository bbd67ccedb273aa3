// SPDX-License-Identifier: Apache-2.0
// The samples of an ST-map that is as large as the picture, as vertices of a lattice: between them the map is that of the mesh that
// they make (mesh_lattice.h).
#pragma once

#include <memory>
#include <vector>

#include "anamorph/geometry/size.h"
#include "anamorph/mesh/mesh_data.h"
#include "anamorph/mesh/mesh_lattice.h"

namespace anamorph {

/// Points of the target, as large as the ST-map, and of the source: pixels, x right, y down, pixel centres at + 0.5.
class StLattice {
  public:
    /// `amount` blends from the identity (0) to the ST-map (1) and beyond.
    StLattice(std::shared_ptr<const StSamples> samples, const Size& target, const Size& source,
              double amount);

    const StSamples& samples() const { return *m_samples; }
    const Size& target() const { return m_target; }
    const Size& source() const { return m_source; }
    /// Source pixels per target pixel of the identity.
    const Point<double>& scale() const { return m_scale; }
    double amount() const { return m_amount; }

    /// The numbers u and v of a pixel.
    const float* sample(int column, int row) const;
    /// The source point of a pixel; NaN where that is a hole. Without rounding where `amount` is 1 and v goes down, since u is a
    /// float and the source's width has 21 bits.
    Point<double> point(int column, int row) const;
    /// What point() says of `count` pixels of a row.
    void points(int column, int row, int count, double* x, double* y) const;
    /// The rounding of point() in double, whichever way it is computed.
    double rounding() const;

    LatticeWeights across(double x) const { return {m_x, x}; }
    LatticeWeights down(double y) const { return {m_y, y}; }
    /// The source point at any point of the target; at a pixel's centre that of the pixel. NaN where a hole counts.
    Point<double> at(double x, double y) const;
    Jacobian jacobian(const LatticeWeights& across, const LatticeWeights& down) const;

  private:
    Point<double> displacement(int column, int row) const;

    std::shared_ptr<const StSamples> m_samples;
    Size m_target, m_source;
    Point<double> m_scale;
    double m_amount;
    std::vector<double> m_x, m_y;  ///< the lines of the lattice: edge, centres of pixels, edge
};

}  // namespace anamorph
