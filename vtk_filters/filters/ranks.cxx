// SPDX-License-Identifier: Apache-2.0
#include "ranks.h"

#include <algorithm>
#include <vector>

#include "vtkMultiProcessController.h"

namespace anamorph_vtk {

bool distributed(vtkMultiProcessController* controller) {
    return controller && controller->GetNumberOfProcesses() > 1;
}

void take_best(double* numbers, std::size_t count, double apart, vtkMultiProcessController* controller) {
    if (!distributed(controller)) return;
    std::vector<double> own(numbers, numbers + count);
    own.push_back(apart);
    const auto ranks = static_cast<std::size_t>(controller->GetNumberOfProcesses());
    std::vector<double> all(ranks * own.size());
    controller->AllGather(own.data(), all.data(), static_cast<vtkIdType>(own.size()));
    const double* best = all.data();
    for (std::size_t r = 1; r < ranks; ++r)
        if (const double* const other = &all[r * own.size()]; other[count] < best[count]) best = other;
    std::copy_n(best, count, numbers);
}

}  // namespace anamorph_vtk
