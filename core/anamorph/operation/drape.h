// SPDX-License-Identifier: Apache-2.0
// The operation drape: a picture laid on a surface in space.
#pragma once

#include "anamorph/operation/operation.h"

namespace anamorph {

const Operation& drape_operation();

}  // namespace anamorph
