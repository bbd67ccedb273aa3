// SPDX-License-Identifier: Apache-2.0
// Finds what one body hides of a limb, or of a line; and which bodies may hide what.
#pragma once

#include <span>
#include <vector>

#include "anamorph/figure/outline/outline_body.h"

namespace anamorph::figure {

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

/// The box around points as View::to_view gives them; in perspective, everything if one is not before the
/// eye.
ScreenBox box_of(std::span<const glm::dvec3> points, bool perspective);

/// Does the box of the body's limb overlap this box, and not all of the body lie beyond it?
bool may_hide(const SeenBody& body, const ScreenBox& box);

/// Finds the bodies that may hide what is in a box.
class Overlaps {
  public:
    /// Prepares the search; `bodies` must outlive this.
    explicit Overlaps(const std::vector<SeenBody>& bodies);
    /// The bodies that may hide what is in a box, in an order that means nothing.
    std::vector<int> with(const ScreenBox& box) const {
        std::vector<int> found;
        find(box, found);
        return found;
    }
    /// The same in place of what `found` holds.
    void find(const ScreenBox& box, std::vector<int>& found) const;

  private:
    const std::vector<SeenBody>& m_bodies;
    std::vector<int> m_by_left;   ///< the bodies, ordered by the left ends of their limbs
    std::vector<double> m_right;  ///< the rightmost end of a limb up to each
};

}  // namespace anamorph::figure
