// SPDX-License-Identifier: Apache-2.0
// A feature line in the numbers that morph/near_far_kernels.h reads.
#pragma once

#include <vector>

#include "anamorph/morph/feature_lines.h"
#include "anamorph/morph/near_far_kernels.h"

namespace anamorph {

/// Line i of the map as seen from (x, y), for one or two of its shapes: displacements in pixels of the
/// shapes' pictures, less `reference` (x and y of each shape), factors times `unit`.
simd::FieldLine seen_from(const FeatureMap& map, std::size_t i, const std::vector<int>& shapes, double x,
                          double y, const double* reference, double unit);

}  // namespace anamorph
