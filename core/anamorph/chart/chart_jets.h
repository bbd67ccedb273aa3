// SPDX-License-Identifier: Apache-2.0
// The formulas of charts and lenses read with four jets at once: compiled once, in chart_bounds.cpp.
#pragma once

#include "anamorph/chart/chart_numbers.h"
#include "anamorph/chart/lens_jets.h"

namespace anamorph {

ANAMORPH_CHART_POINTS(extern, simd::TaylorJets)
ANAMORPH_CHART_POINTS(extern, simd::BoundJets)

}  // namespace anamorph
