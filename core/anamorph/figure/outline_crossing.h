// SPDX-License-Identifier: Apache-2.0
// The curves in which bodies pass through each other.
#pragma once

#include <span>
#include <vector>

#include "anamorph/figure/outline_body.h"

namespace anamorph {

/// The loops of all pairs of `bodies` (as `seen` in `view`), in the order of the pairs; what is seen of them
/// too where `hide` is set.
std::vector<CrossingCurve> crossing_curves(std::span<const Ellipsoid> bodies,
                                           const std::vector<SeenBody>& seen, const View& view, double tol,
                                           bool hide, const ParallelFor& parallel_for);

}  // namespace anamorph
