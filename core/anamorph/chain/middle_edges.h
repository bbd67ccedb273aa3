// SPDX-License-Identifier: Apache-2.0
// The part of a pixel that lies within the edges of the pictures in the middle of a chain.
#pragma once

#include <span>

#include "anamorph/number/jet.h"
#include "anamorph/plan/partial_pixels.h"

namespace anamorph {

/// The part of a pixel on which functions are not negative, each linear: its value in the pixel's middle, and its derivatives per
/// pixel. Exactly, but for rounding.
PartialPixel part_within(int x, int y, std::span<const Jet1<double>> edges);

/// Edges over a box of pixels.
class EdgesOverBox {
  public:
    /// `middle`: each edge in the middle of the box; `over`: the same edges over the box, whose derivatives are bounds.
    EdgesOverBox(const Box& box, std::span<const Jet1<double>> middle, std::span<const Jet1<Interval>> over);

    /// May an edge run through a pixel of the box that does not lie wholly beyond another?
    bool may_cross(int x, int y) const;

  private:
    Point<double> m_middle;
    std::span<const Jet1<double>> m_edges;
    std::span<const Jet1<Interval>> m_over;
};

}  // namespace anamorph
