// SPDX-License-Identifier: Apache-2.0
// All projections, and one more: what somebody who adds one writes into the list.
// clang-format off
#include_next <anamorph/chart/projection/list.h>

#ifdef ANAMORPH_PROJECTION
ANAMORPH_PROJECTION(toy, Toy)
#else
#include "anamorph/chart/projection/toy.h"
#endif
// clang-format on
