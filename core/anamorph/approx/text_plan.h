// SPDX-License-Identifier: Apache-2.0
// The blocks of a formula that is text.
#pragma once

#include "anamorph/approx/formula_plan.h"
#include "anamorph/map/text_map.h"

namespace anamorph {

extern template class FormulaPlan<TextMap>;

using TextPlan = FormulaPlan<TextMap>;

}  // namespace anamorph
