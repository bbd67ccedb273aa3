// SPDX-License-Identifier: Apache-2.0
// All projections, and one more: what somebody who adds one writes into the list.
// clang-format off
#include_next <anamorph/map/projection/list.h>

#include "anamorph/map/projection/toy.h"
// clang-format on
