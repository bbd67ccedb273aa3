// SPDX-License-Identifier: Apache-2.0
// All projections, and one more: what somebody who adds one writes into the list.
// clang-format off
#include_next <anamorph/chart/projection/list.h>

#include "anamorph/chart/projection/toy.h"
// clang-format on
