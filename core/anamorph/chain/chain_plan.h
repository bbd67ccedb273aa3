// SPDX-License-Identifier: Apache-2.0
// The blocks of a chain of maps.
#pragma once

#include "anamorph/chain/chain_map.h"
#include "anamorph/plan/formula_plan.h"

namespace anamorph {

extern template class FormulaPlan<ChainMap>;

using ChainPlan = FormulaPlan<ChainMap>;

}  // namespace anamorph
