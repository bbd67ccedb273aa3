// SPDX-License-Identifier: Apache-2.0
// The means that a filter lends to the core while it executes: VTK's threads, its progress, and the wish to
// stop; what becomes of what the core throws; and what it writes to.
#pragma once

#include <functional>
#include <initializer_list>

#include "anamorph/error.h"
#include "anamorph/parallel_for.h"

class vtkAlgorithm;
class vtkDataObject;
class vtkInformation;
class vtkObject;

namespace anamorph_vtk {

/// Thrown when the user wants to stop. What was being written is then unfinished.
struct Aborted {};

class Execution {
  public:
    explicit Execution(vtkAlgorithm* algorithm) : m_algorithm(algorithm) {}

    /// Makes loops on VTK's threads that take the filter's progress on from `begin` to `end`; it never falls.
    /// They throw Aborted, and what their body throws. Call them from the filter's own thread. The result
    /// must not outlive this.
    anamorph::ParallelFor stage(double begin, double end);
    /// Reports progress and throws Aborted if the user wants to stop.
    void progress(double amount);

  private:
    vtkAlgorithm* m_algorithm;
    double m_progress = 0;
};

/// Runs `body` and returns 1. What it throws empties the outputs; it becomes an error of `object` and 0, but
/// for Aborted, which is none.
int guarded(vtkObject* object, const std::function<void()>& body,
            std::initializer_list<vtkDataObject*> outputs = {});

/// Are the first ports connected, whose names these are? An error of the filter tells the first that is not.
/// For ProcessRequest(), of filters that call all of their ports optional, so that VTK does not complain in
/// its own words.
bool has_inputs(vtkAlgorithm* filter, std::initializer_list<const char*> names);

/// Sees to it, in RequestDataObject(), that an output is of the class of `like`.
void make_output(vtkInformation* output, vtkDataObject* like);

}  // namespace anamorph_vtk
