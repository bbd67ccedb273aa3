// SPDX-License-Identifier: Apache-2.0
#include "anamorph/approx/text_plan.h"

#include "anamorph/approx/formula_planner.h"

namespace anamorph {

template class FormulaPlan<TextMap>;

}  // namespace anamorph
