// SPDX-License-Identifier: Apache-2.0
// What a filter lends to the core while it executes: VTK's threads, its progress, and the wish to stop.
#pragma once

#include "anamorph/error.h"

class vtkAlgorithm;

namespace anamorph_vtk {

/// Thrown when the user wants to stop. What was being written is then unfinished.
struct Aborted {};

class Execution {
  public:
    explicit Execution(vtkAlgorithm* algorithm) : m_algorithm(algorithm) {}

    /// Loops on VTK's threads that take the filter's progress on from `begin` to `end`; it never falls. They
    /// throw Aborted, and what their body throws. Call them from the filter's own thread. The result must not
    /// outlive this.
    anamorph::ParallelFor stage(double begin, double end);
    /// Reports progress and throws Aborted if the user wants to stop.
    void progress(double amount);

  private:
    vtkAlgorithm* m_algorithm;
    double m_progress = 0;
};

}  // namespace anamorph_vtk
