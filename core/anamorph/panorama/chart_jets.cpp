// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/chart_jets.h"

namespace anamorph {

ANAMORPH_CHART_POINTS(, simd::TaylorJets)
ANAMORPH_CHART_POINTS(, simd::BoundJets)

}  // namespace anamorph
