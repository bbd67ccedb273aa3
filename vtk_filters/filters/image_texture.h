// SPDX-License-Identifier: Apache-2.0
// VTK's images as the core reads and writes them: pixels of one slice whose rows go down.
#pragma once

#include <string>

#include "anamorph/geometry/point.h"
#include "anamorph/geometry/size.h"
#include "anamorph/image/view.h"
#include "vtkSmartPointer.h"

class vtkDataArray;
class vtkImageData;

namespace anamorph_vtk {

/// The channel of alpha of so many components, or -1.
inline int alpha_of(int components) {
    return components % 2 == 0 ? components - 1 : -1;
}

/// Where a point of space is in an image of this whole extent: in pixels from the upper left, whose centres are at halves.
anamorph::Point<double> pixel_place(vtkImageData* image, const int* extent, const double* point);

/// The type of the numbers of a picture, which messages call `name`. Throws Error.
anamorph::PixelType pixel_type(vtkDataArray* array, const std::string& name);

/// A view of packed pixels whose rows go up as rows that go down.
template <class Byte>
anamorph::BasicView<Byte> turned_over(Byte* data, anamorph::PixelType type, int width, int height,
                                      int channels) {
    auto view = anamorph::packed_view(data, type, width, height, channels);
    view.data += (height - 1) * view.row_stride;
    view.row_stride = -view.row_stride;
    return view;
}

/// An image's pixels as the core reads them.
class ImageTexture {
  public:
    /// Takes an image's array of points. Messages call the image `name`. Throws Error: more than a slice, no
    /// pixels, no such array, other than 1 to 4 components of unsigned char, unsigned short or float.
    ImageTexture(vtkImageData* image, vtkDataArray* array, const std::string& name);
    ~ImageTexture();

    const anamorph::ConstImageView& view() const { return m_view; }
    anamorph::Size size() const { return {m_view.width, m_view.height}; }
    /// The type as VTK numbers it.
    int type() const;

  private:
    vtkSmartPointer<vtkDataArray> m_array;
    anamorph::ConstImageView m_view;
};

}  // namespace anamorph_vtk
