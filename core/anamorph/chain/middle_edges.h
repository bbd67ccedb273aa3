// SPDX-License-Identifier: Apache-2.0
// The part of a pixel that lies within the edges of the pictures in the middle of a chain.
#pragma once

#include <span>
#include <vector>

#include "anamorph/number/jet.h"
#include "anamorph/plan/formula_map.h"
#include "anamorph/plan/partial_pixels.h"

namespace anamorph {

/// The part of a pixel on which functions are not negative, each linear: its value in the pixel's middle, and its derivatives per
/// pixel. Exactly, but for rounding.
PartialPixel part_within(int x, int y, std::span<const Jet1<double>> edges);

/// Edges over a box of pixels.
class EdgesOverBox {
  public:
    /// What of a pixel lies beyond an edge by no more than this does not count, a 512th of its area: pictures that end together do so but
    /// for rounding, and for what bounds over boxes are too wide.
    static constexpr double kNegligible = 0x1p-9;

    /// `middle`: each edge in the middle of the box; `over`: the same edges over the box, whose derivatives are bounds.
    EdgesOverBox(const Box& box, std::vector<Jet1<double>> middle, std::vector<Jet1<Interval>> over);

    /// Does a part of the box lie within all edges, or all of it beyond one? Cover::cut where a corner lies beyond one by more than
    /// is negligible, Cover::mixed where it is not known.
    Cover cover(const Box& part) const;

  private:
    Point<double> m_middle;
    std::vector<Jet1<double>> m_edges;
    std::vector<Jet1<Interval>> m_over;
};

}  // namespace anamorph
