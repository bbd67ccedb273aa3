// SPDX-License-Identifier: Apache-2.0
// All formulas, and one more: what somebody who adds a surface includes.
// clang-format off
#include_next <anamorph/surface/shape/all.h>

#include "anamorph/surface/shape/toy.h"
// clang-format on
