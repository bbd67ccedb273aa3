// SPDX-License-Identifier: Apache-2.0
// Strokes of a drawing as pixels: round ends and joins, each pixel covered as far as its 16 x 16 samples are.
#pragma once

#include <span>
#include <vector>

#include "anamorph/figure/outline/drawing.h"
#include "anamorph/geometry/box.h"

namespace anamorph::figure {

/// A pixel with red, green and blue multiplied by alpha.
struct LinePixel {
    float r = 0, g = 0, b = 0, a = 0;
};

/// A drawing, ready to be looked at. Thread safe.
class StrokePixels {
  public:
    explicit StrokePixels(Drawing drawing);

    /// The pixels of a small box, row by row. They do not depend on the box.
    std::vector<LinePixel> pixels(const Box& box) const;

  private:
    Drawing m_drawing;
    std::vector<Box> m_boxes;  ///< boxes around the strokes
};

}  // namespace anamorph::figure
