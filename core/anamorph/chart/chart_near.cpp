// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chart/chart_near.h"

#include "anamorph/chart/chart_formulas.h"

namespace anamorph {

ANAMORPH_CHART_POINTS(, NearBound<float>)
ANAMORPH_CHART_POINTS(, NearBound<double>)

}  // namespace anamorph
