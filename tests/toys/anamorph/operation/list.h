// SPDX-License-Identifier: Apache-2.0
// All operations, and one more: what somebody who adds one writes into the list.
#include_next <anamorph/operation/list.h>
ANAMORPH_OPERATION(toy)
