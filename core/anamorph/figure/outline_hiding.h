// SPDX-License-Identifier: Apache-2.0
// What one body hides of a limb, or of a line; and which bodies may hide what.
#pragma once

#include <vector>

#include "anamorph/figure/outline_body.h"

namespace anamorph {

/// Adds the arcs of the limb of `body` that `other` hides.
void add_hidden(const SeenBody& body, const SeenBody& other, bool perspective, std::vector<Arc>& hidden);

/// Adds the parts of the straight line from `from` to `to` (View::to_view) that `other` hides, 0 to 1.
void add_hidden(const glm::dvec3& from, const glm::dvec3& to, const SeenBody& other, bool perspective,
                std::vector<Arc>& hidden);

/// A rectangle on the screen, and the greatest depth of what is in it.
struct ScreenBox {
    glm::dvec2 low{0.0}, high{0.0};
    double farthest = 0;
};

/// For each box, the bodies whose limbs' boxes overlap it and that do not lie wholly beyond it.
std::vector<std::vector<int>> overlapping(const std::vector<ScreenBox>& boxes,
                                          const std::vector<SeenBody>& bodies);

}  // namespace anamorph
