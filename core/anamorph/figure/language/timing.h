// SPDX-License-Identifier: Apache-2.0
// How an action is spread over its frames.
#pragma once

#include "anamorph/figure/language/program.h"

namespace anamorph::figure {

struct Shares {
    double frac = 1;  ///< share of the whole; they sum to 1
    double prop = 1;  ///< share of what remains; the last is 1
};

/// The shares of frame `a` of `n`, 1 <= a <= n. `repeat` gives 1 and 1.
Shares shares_of(Distribution distribution, double a, double n);

}  // namespace anamorph::figure
