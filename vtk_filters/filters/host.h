// SPDX-License-Identifier: Apache-2.0
// What the filters ask of VTK in the same way: threads, and whether to stop.
#pragma once

#include <cstdint>
#include <functional>

namespace anamorph {

/// The core's ParallelFor on vtkSMPTools.
void smp_for(std::int64_t count, const std::function<void(std::int64_t)>& body);

/// vtkAlgorithm::CheckAbort, or what there is of it in older versions.
template <class Algorithm>
bool is_aborted(Algorithm* algorithm) {
    if constexpr (requires { algorithm->CheckAbort(); })
        return algorithm->CheckAbort();
    else
        return algorithm->GetAbortExecute() != 0;
}

}  // namespace anamorph
