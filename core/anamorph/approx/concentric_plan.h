// SPDX-License-Identifier: Apache-2.0
// The blocks of a view of concentric mosaics, for one of its panoramas.
#pragma once

#include "anamorph/approx/formula_plan.h"
#include "anamorph/map/concentric.h"

namespace anamorph {

extern template class FormulaPlan<ConcentricMap>;

using ConcentricPlan = FormulaPlan<ConcentricMap>;

}  // namespace anamorph
