// SPDX-License-Identifier: Apache-2.0
// A panorama in a file, as it goes with what is painted: texels in the field arrays of a mesh.
#pragma once

#include <string>

#include "anamorph/geometry/size.h"
#include "vtkSmartPointer.h"

class vtkFieldData;
class vtkIntArray;
class vtkUnsignedCharArray;

namespace anamorph_vtk {

/// The texels of a picture in a file.
class PanoramaPicture {
  public:
    /// Reads a file. Throws Error: it is not there, or no picture of one slice that VTK reads.
    explicit PanoramaPicture(const std::string& path);

    /// The file's size in texels.
    anamorph::Size size() const { return m_size; }
    /// Adds the arrays "anamorph:picture" and "anamorph:picture_size".
    void add_to(vtkFieldData* fields) const;

  private:
    anamorph::Size m_size;
    vtkSmartPointer<vtkUnsignedCharArray> m_texels;
    vtkSmartPointer<vtkIntArray> m_shown;
};

}  // namespace anamorph_vtk
