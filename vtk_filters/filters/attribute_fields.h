// SPDX-License-Identifier: Apache-2.0
// What the core says of a picture, as fields of the output.
#pragma once

#include "anamorph/operation/operation.h"

class vtkDataObject;

namespace anamorph_vtk {

/// Adds a field array of one value.
void add_field(const anamorph::Attribute& attribute, vtkDataObject* output);

}  // namespace anamorph_vtk
