// SPDX-License-Identifier: Apache-2.0
// The formulas of charts and lenses read near the middle of a block (number/near.h): compiled once, in chart_near.cpp.
#pragma once

#include "anamorph/chart/chart_numbers.h"
#include "anamorph/number/near_bound.h"

namespace anamorph {

ANAMORPH_CHART_POINTS(extern, NearBound<float>)
ANAMORPH_CHART_POINTS(extern, NearBound<double>)

}  // namespace anamorph
