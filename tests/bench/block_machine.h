// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench.h"

namespace anamorph::bench {

/// Measures the machine of 1987 beside plain drapes, on a screen of side x side; none where that is more than
/// settings.size, but for the smallest.
void measure_blocks(const Settings& settings, Report& report, int side);

}  // namespace anamorph::bench
