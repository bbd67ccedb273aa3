// SPDX-License-Identifier: Apache-2.0
// A feature line in the numbers that simd/near_far.h reads.
#pragma once

#include <vector>

#include "anamorph/map/feature_lines.h"
#include "anamorph/simd/near_far.h"

namespace anamorph {

/// Line i of the map as seen from (x, y), for one or two of its shapes: displacements in pixels of the
/// shapes' pictures, less `reference` (x and y of each shape), factors times `unit`.
simd::FieldLine seen_from(const FeatureMap& map, std::size_t i, const std::vector<int>& shapes, double x,
                          double y, const double* reference, double unit);

}  // namespace anamorph
