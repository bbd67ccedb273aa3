// SPDX-License-Identifier: Apache-2.0
// All formulas, and one more: what somebody who adds a surface includes.
// clang-format off
#include_next <anamorph/map/surface/all.h>

#include "anamorph/map/surface/toy.h"
// clang-format on
