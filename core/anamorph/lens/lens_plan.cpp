// SPDX-License-Identifier: Apache-2.0
#include "anamorph/lens/lens_plan.h"

#include "anamorph/panorama/chart_jets.h"
#include "anamorph/plan/formula_planner.h"

namespace anamorph {

template class FormulaPlan<LensMap>;

}  // namespace anamorph
