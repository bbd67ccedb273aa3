// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chart/chart_numbers.h"

namespace anamorph {

ANAMORPH_CHART_NUMBERS()

}  // namespace anamorph
