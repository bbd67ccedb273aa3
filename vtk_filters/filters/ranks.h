// SPDX-License-Identifier: Apache-2.0
// What the ranks of a controller find out together; all of them call these functions.
#pragma once

#include <cstddef>
#include <limits>

class vtkMultiProcessController;

namespace anamorph_vtk {

/// What is `apart` of a rank that has found nothing.
inline constexpr double kNowhere = std::numeric_limits<double>::infinity();

/// Has a controller (which may be null) several ranks?
bool distributed(vtkMultiProcessController* controller);

/// Gives all ranks the numbers of the one that is least apart; those of the first where none has any.
void take_best(double* numbers, std::size_t count, double apart, vtkMultiProcessController* controller);

}  // namespace anamorph_vtk
