// SPDX-License-Identifier: Apache-2.0
// Meshes that a broken file or script made, whose cells have corners that are no points.
#pragma once

class vtkPointSet;

namespace anamorph_vtk {

/// Throws Error where a cell of a vtkPolyData or vtkUnstructuredGrid has a corner that is none of its points. `name` is the mesh's in the message.
void check_corners(vtkPointSet* mesh, const char* name = "the mesh");

}  // namespace anamorph_vtk
