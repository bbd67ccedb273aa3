// SPDX-License-Identifier: Apache-2.0
// VTK's lines as the features of two images.
#pragma once

#include <memory>

#include "anamorph/morph/feature_lines.h"

class vtkImageData;
class vtkPolyData;

namespace anamorph_vtk {

/// The lines of two data sets, line by line, in pixels of an image each; none where both are null. Throws Error where one is null, they have not
/// as many lines with as many points, a line goes through points that there are not, or a point is not finite.
std::shared_ptr<anamorph::Features> features_of(vtkPolyData* const lines[2], vtkImageData* const images[2]);

}  // namespace anamorph_vtk
