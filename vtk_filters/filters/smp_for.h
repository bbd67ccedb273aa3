// SPDX-License-Identifier: Apache-2.0
// The core's loops on VTK's threads.
#pragma once

#include <cstdint>
#include <functional>

#include "anamorph/parallel_for.h"

namespace anamorph {

/// The core's ParallelFor on vtkSMPTools.
void smp_for(std::int64_t count, const std::function<void(std::int64_t)>& body);

}  // namespace anamorph
