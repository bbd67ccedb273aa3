// SPDX-License-Identifier: Apache-2.0
// The blocks of a view of concentric mosaics, for one of its panoramas.
#pragma once

#include "anamorph/panorama/concentric.h"
#include "anamorph/plan/formula_plan.h"

namespace anamorph {

extern template class FormulaPlan<ConcentricMap>;

using ConcentricPlan = FormulaPlan<ConcentricMap>;

}  // namespace anamorph
