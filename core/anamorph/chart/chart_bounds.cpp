// SPDX-License-Identifier: Apache-2.0
// Charts and lenses read with the numbers of which bounds and polynomials are made.
#include "anamorph/chart/chart_formulas.h"
#include "anamorph/chart/chart_jets.h"

namespace anamorph {

ANAMORPH_CHART_BOUNDS()
ANAMORPH_CHART_POINTS(, simd::TaylorJets)
ANAMORPH_CHART_POINTS(, simd::BoundJets)

}  // namespace anamorph
