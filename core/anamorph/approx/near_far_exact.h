// SPDX-License-Identifier: Apache-2.0
// What rounding does to pixels of a morph that are evaluated in double.
#pragma once

#include <vector>

#include "anamorph/map/feature_lines.h"

namespace anamorph {

/// The most by which FeatureMap, in double, is off from the lines' exact formula at the pixels of a box, for
/// any of `shapes`, in pixels of their pictures. Not infinite: where a = 0 and lines cross on a pixel, the
/// bound is as large as what they say differs.
double exact_bound(const FeatureMap& map, const std::vector<int>& shapes, const Box& box);

}  // namespace anamorph
