// SPDX-License-Identifier: Apache-2.0
// Bounds of the second derivatives of a panorama's map F from rays to texels, kept by cells of directions: what many edges and
// triangles of a scene have in common is read with intervals once.
//
// Cells are squares of (u, v) = (x / z, y / z) on the faces of a cube, where z > 0 stands for the part of a ray that is largest
// at the middle, of either sign, and x and y for the two others. As F is the same along a ray, F(x, y, z) = G(u, v), and by the
// chain rule its derivatives along e and f, in space, are
//     F''[e, f] = G''[w_e, w_f] - a_e G'[w_f] - a_f G'[w_e],   w_e = (e_x - u e_z, e_y - v e_z) / z,   a_e = e_z / z,     (1)
// w_f and a_f alike, since w_e itself changes by -a_e w_f - a_f w_e along f. Here u, v and z range over the edge or triangle.
//
// G' and G'' are read at the cell's middle, third derivatives over all of it, as jets of intervals (number/jet.h): Taylor's formula gives G' and G'' over the range of
// an edge, with what they may be off, which is little more than they change along it.
//
// Squares have widths that are powers of 2, from 4 to 8 times the reach of what is asked for from its middle, and cells go on by a
// quarter beyond, so that an edge or a triangle lies in the cell of its middle. Many lie in the same.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "anamorph/chart/chart.h"

namespace anamorph {

/// F''[e, e], F''[e, f] and F''[f, f] of one coordinate of F over a triangle: middles, and how far off they may be anywhere.
struct SecondForms {
    double ee = 0;      ///< the middle of F''[e, e]
    double ef = 0;      ///< the middle of F''[e, f]
    double ff = 0;      ///< the middle of F''[f, f]
    double off_ee = 0;  ///< how far F''[e, e] may be off its middle
    double off_ef = 0;  ///< how far F''[e, f] may be off its middle
    double off_ff = 0;  ///< how far F''[f, f] may be off its middle
};

/// Second derivatives of a panorama of one piece, by cells that are read when they are first asked for. Several threads may ask
/// at once; what they are told does not depend on it.
class DerivativeCells {
  public:
    /// `chart` has one piece, and has to live as long.
    explicit DerivativeCells(const Chart& chart);

    /// Finds the forms of x and y along e and f, or along e alone, wherever a ray is in the hull of `rays`, `middle` being between
    /// them. Nothing where cells are too narrow for that, are not wholly on the panorama, or where derivatives are not bounded.
    std::optional<Point<SecondForms>> over(std::span<const glm::dvec3> rays, const glm::dvec3& middle,
                                           const glm::dvec3& e, const glm::dvec3* f = nullptr) const;

  private:
    struct Cell;
    class Kept;
    /// A cell's square: that of a face from column * width and row * width on.
    struct Place {
        std::int64_t chart = 0;  ///< the number of its DerivativeCells
        double width = 0, column = 0, row = 0;
        int face = 0;

        bool operator==(const Place&) const = default;
        std::size_t hash() const;
    };

    const Cell& cell(const Place& place) const;
    Cell read(const Place& place) const;
    /// The branch on which a cell about a ray is read.
    Branch branch_for(const glm::dvec3& middle) const;

    const Chart& m_chart;
    std::int64_t m_number;
};

}  // namespace anamorph
