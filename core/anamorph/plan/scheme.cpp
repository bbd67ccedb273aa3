// SPDX-License-Identifier: Apache-2.0
#include "anamorph/plan/scheme.h"

#include <cmath>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {

void check_tol(double tol) {
    if (!(tol >= 0 && tol < HUGE_VAL))
        throw Error("tol", shortest(tol), "must be 0 (exact) or a finite number of source pixels above it");
}

}  // namespace anamorph
