// SPDX-License-Identifier: Apache-2.0
// The curves in which bodies pass through each other.
#pragma once

#include <span>
#include <vector>

#include "anamorph/figure/outline/outline_body.h"
#include "anamorph/parallel_for.h"

namespace anamorph::figure {

/// The loops of all pairs of `bodies` (as `seen` in `view`) that `options` ask for, in the order of the
/// pairs.
std::vector<CrossingCurve> crossing_curves(std::span<const Ellipsoid> bodies,
                                           const std::vector<SeenBody>& seen, const View& view,
                                           const OutlineOptions& options, const ParallelFor& parallel_for);

}  // namespace anamorph::figure
