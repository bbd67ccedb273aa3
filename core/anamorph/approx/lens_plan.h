// SPDX-License-Identifier: Apache-2.0
// The blocks of a lens's distortion.
#pragma once

#include "anamorph/approx/formula_plan.h"
#include "anamorph/map/lens_map.h"

namespace anamorph {

extern template class FormulaPlan<LensMap>;

using LensPlan = FormulaPlan<LensMap>;

}  // namespace anamorph
