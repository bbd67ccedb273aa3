// SPDX-License-Identifier: Apache-2.0
// Lines drawn over a picture: the features of a morph, the mesh of a warp.
#pragma once

#include <array>
#include <vector>

#include "anamorph/chart/chart.h"
#include "anamorph/image/picture.h"

namespace anamorph {

/// The colour of the i-th kind of lines: of a shape, or of a level. There are three, over and over.
const std::array<float, 3>& overlay_color(int i);

/// Draws a chain of lines from point to point of the picture, one pixel and a half wide; channels above the third become 1 there. Points that
/// follow each other may be the same.
void draw_line_over(const std::vector<Point<double>>& line, const std::array<float, 3>& color,
                    const PixelRows& pixels);

}  // namespace anamorph
