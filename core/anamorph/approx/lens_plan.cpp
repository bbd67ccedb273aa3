// SPDX-License-Identifier: Apache-2.0
#include "anamorph/approx/lens_plan.h"

#include "anamorph/approx/chart_jets.h"
#include "anamorph/approx/formula_planner.h"

namespace anamorph {

template class FormulaPlan<LensMap>;

}  // namespace anamorph
