// SPDX-License-Identifier: Apache-2.0
#include "anamorph/approx/concentric_plan.h"

#include "anamorph/approx/chart_jets.h"
#include "anamorph/approx/formula_planner.h"

namespace anamorph {

template class FormulaPlan<ConcentricMap>;

}  // namespace anamorph
