// SPDX-License-Identifier: Apache-2.0
// All surfaces, and one more: what somebody who adds one writes into the list.
// clang-format off
#include_next <anamorph/surface/shape/list.h>

ANAMORPH_SURFACE(toy_saddle, ToySaddle)
// clang-format on
