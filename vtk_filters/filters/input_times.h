// SPDX-License-Identifier: Apache-2.0
// The times of a filter with several inputs. By itself the pipeline passes those of the first one alone, and takes an output that
// depends on none of them for up to date.
#pragma once

#include <span>

class vtkDataObject;
class vtkInformation;
class vtkInformationVector;

namespace anamorph_vtk {

/// Tells, in RequestInformation(), the time steps of all inputs (those of each port) and the range that holds theirs.
void tell_times(std::span<vtkInformationVector* const> inputs, vtkInformation* output);

/// Says, in RequestData(), that an output is of the time of the first input that has one.
void hand_over_time(std::span<vtkInformationVector* const> inputs, vtkDataObject* output);

}  // namespace anamorph_vtk
