// SPDX-License-Identifier: Apache-2.0
// Compiled as C++17, which is why it stands alone: VTK 9.1's vtkSMPTools.h is no C++20.
#include <cstdint>
#include <functional>

#include "vtkSMPTools.h"

namespace anamorph {

void smp_for(std::int64_t count, const std::function<void(std::int64_t)>& body) {
    const auto stretch = [&body](vtkIdType begin, vtkIdType end) {
        for (vtkIdType i = begin; i < end; ++i) body(i);
    };
    vtkSMPTools::For(0, static_cast<vtkIdType>(count), stretch);
}

}  // namespace anamorph
