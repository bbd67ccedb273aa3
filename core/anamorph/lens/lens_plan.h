// SPDX-License-Identifier: Apache-2.0
// The blocks of a lens's distortion.
#pragma once

#include "anamorph/lens/lens_map.h"
#include "anamorph/plan/formula_plan.h"

namespace anamorph {

extern template class FormulaPlan<LensMap>;

using LensPlan = FormulaPlan<LensMap>;

}  // namespace anamorph
