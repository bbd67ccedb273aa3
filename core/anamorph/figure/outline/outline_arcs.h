// SPDX-License-Identifier: Apache-2.0
// Sets of parameters on a circle (or a line) as sorted, disjoint arcs.
#pragma once

#include <vector>

#include "anamorph/figure/outline/outline.h"

namespace anamorph::figure {

/// Sorts and joins arcs with 0 <= begin <= period and end <= begin + period. On a closed range an arc that
/// ends at `period` is joined to one that begins at 0.
std::vector<Arc> union_of(std::vector<Arc> arcs, double period, bool closed = true);

/// The part of [0, period] that arcs, as union_of takes them, leave out.
std::vector<Arc> complement_of(std::vector<Arc> arcs, double period, bool closed = true);

/// Sorts a range into visible and hidden parts, without those that are `cut`; both as union_of takes them. An
/// end of an arc that does not run over `period` is the end of a part to the bit.
void split(std::vector<Arc> hidden_parts, const std::vector<Arc>& cut, double period, bool closed,
           std::vector<Arc>& visible, std::vector<Arc>& hidden);

/// The part of a line that is nearer than `near`, from the depths of its ends: 0 to 1, one arc or none.
std::vector<Arc> nearer_part(double from, double to, double near);

}  // namespace anamorph::figure
