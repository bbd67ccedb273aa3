// SPDX-License-Identifier: Apache-2.0
// Views that figures fill.
#pragma once

#include <glm/vec2.hpp>

#include "anamorph/figure/body/frame.h"
#include "anamorph/figure/outline/outline_view.h"

namespace anamorph::figure {

/// A rectangle on the screen around figures, relative to the view's middle, as it is with the view's scale 1.
struct SeenExtent {
    glm::dvec2 least{HUGE_VAL}, most{-HUGE_VAL};

    bool empty() const { return !(least.x <= most.x && least.y <= most.y); }
};

/// Widens `extent` by the outlines of a frame's bodies, exactly. In perspective a body that reaches behind
/// View::near is left out, as no picture shows all of it.
void add_seen_extent(const FigureFrame& frame, const View& view, SeenExtent& extent);

/// Moves and scales a view so that `extent` fills a picture of `size` pixels but for a margin of a twentieth
/// on every side, the origin of the screen being the picture's lower left corner. Without figures, or where
/// they have no extent, the scale stays.
void fit_view(View& view, const SeenExtent& extent, const glm::dvec2& size);

}  // namespace anamorph::figure
