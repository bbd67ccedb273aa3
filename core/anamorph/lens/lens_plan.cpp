// SPDX-License-Identifier: Apache-2.0
#include "anamorph/lens/lens_plan.h"

#include "anamorph/chart/chart_jets.h"
#include "anamorph/plan/formula_plan_impl.h"

namespace anamorph {

template class FormulaPlan<LensMap>;

}  // namespace anamorph
