// SPDX-License-Identifier: Apache-2.0
// Counts the pixels of a box that have a property which is known of whole boxes.
#pragma once

#include <cstdint>

#include "anamorph/geometry/box.h"
#include "anamorph/number/interval.h"

namespace anamorph {

/// Counts the pixels of a box that have a property. `certainty(box)`: do all of its pixels have it, none, or
/// is it not known? Where it is not, halves are looked at, down to boxes that are small, as is_small(box)
/// says; count(box) looks at their pixels one by one.
template <class OfBox, class IsSmall, class Count>
std::int64_t count_pixels(const Box& box, const OfBox& certainty, const IsSmall& is_small,
                          const Count& count) {
    const Certainty all = certainty(box);
    if (all == Certainty::no) return 0;
    if (all == Certainty::yes) return std::int64_t{box.width()} * box.height();
    if (is_small(box)) return count(box);
    Box first = box, second = box;
    if (box.width() > box.height())
        first.x1 = second.x0 = (box.x0 + box.x1) / 2;
    else
        first.y1 = second.y0 = (box.y0 + box.y1) / 2;
    return count_pixels(first, certainty, is_small, count) + count_pixels(second, certainty, is_small, count);
}

}  // namespace anamorph
