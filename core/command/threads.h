// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "anamorph/error.h"
#include "anamorph/parallel_for.h"

namespace anamorph::command {

/// A ParallelFor on so many threads. Of exceptions, that of the smallest index is passed on.
ParallelFor threads_for(int threads);

}  // namespace anamorph::command
