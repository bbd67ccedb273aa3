// SPDX-License-Identifier: Apache-2.0
// Pixels that a picture fills in part: what a chain of maps leads through may end inside of them. How much of a pixel is filled is told by
// the derivatives in its middle, as if edges were straight in it: it is no area that is proven.
#pragma once

#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/geometry/point.h"

namespace anamorph {

/// A pixel of which a part is drawn, and the rest is empty.
struct PartialPixel {
    int x = 0, y = 0;
    double share = 1;              ///< the part's share of the pixel's area
    Point<double> middle{0, 0};    ///< the part's centre of mass, pixels of the target
    double width = 1, height = 1;  ///< sides of the rectangle around the part, pixels of the target
};

/// A map (plan/block.h) whose exact blocks may hold partial pixels, those among them whose middle has no source point; no other
/// blocks do.
class PartialPixels {
  public:
    virtual ~PartialPixels() = default;
    /// Finds the partial pixels of a part of a block's box. What is found of a pixel depends on the block, not on the part.
    virtual void find(const Box& block, int piece, const Box& part,
                      std::vector<PartialPixel>& pixels) const = 0;
};

}  // namespace anamorph
