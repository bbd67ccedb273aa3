// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chain/chain_plan.h"

#include "anamorph/plan/formula_plan_impl.h"

namespace anamorph {

template class FormulaPlan<ChainMap>;

}  // namespace anamorph
