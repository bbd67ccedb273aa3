// SPDX-License-Identifier: Apache-2.0
// VTK's points as the control mesh of an image.
#pragma once

#include "anamorph/mesh/mesh_data.h"

class vtkImageData;
class vtkPointSet;

namespace anamorph_vtk {

/// The mesh whose vertices are points and whose lines their texture coordinates, in pixels of an image (vtkAnamorphImageWarp says how).
/// `extent`: the image's whole one. Throws Error where the texture coordinates are no grid's, or a number is not finite.
anamorph::ControlMesh control_mesh(vtkPointSet* points, vtkImageData* image, const int* extent);

}  // namespace anamorph_vtk
