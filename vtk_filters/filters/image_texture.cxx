// SPDX-License-Identifier: Apache-2.0
#include "image_texture.h"

#include <algorithm>

#include "anamorph/error.h"
#include "anamorph/image/source.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"

namespace anamorph_vtk {

using anamorph::Error;
using anamorph::PixelType;

anamorph::Point<double> pixel_place(vtkImageData* image, const int* extent, const double* point) {
    double index[3];
    image->TransformPhysicalPointToContinuousIndex(point, index);
    return {index[0] - extent[0] + 0.5, extent[3] - index[1] + 0.5};
}

PixelType pixel_type(vtkDataArray* array, const std::string& name) {
    switch (array->GetDataType()) {
        case VTK_UNSIGNED_CHAR:
            return PixelType::uint8;
        case VTK_UNSIGNED_SHORT:
            return PixelType::uint16;
        case VTK_FLOAT:
            return PixelType::float32;
        default:
            throw Error(name + "'s numbers are of type " + array->GetDataTypeAsString() +
                        ", but must be of type unsigned char, unsigned short or float");
    }
}

ImageTexture::ImageTexture(vtkImageData* image, vtkDataArray* array, const std::string& name)
    : m_array(array) {
    int size[3];
    image->GetDimensions(size);
    if (image->GetNumberOfPoints() < 1) throw Error(name + " has no pixels");
    if (size[2] != 1) throw Error(name + " has " + std::to_string(size[2]) + " slices, but must have 1");
    if (std::max(size[0], size[1]) > anamorph::kMaxSide)
        throw Error(name + " is " + std::to_string(std::max(size[0], size[1])) +
                    " pixels wide or high, but must be at most " + std::to_string(anamorph::kMaxSide));
    if (!array || array->GetNumberOfTuples() != image->GetNumberOfPoints())
        throw Error(name + " has no point array to draw");
    const int components = array->GetNumberOfComponents();
    if (components < 1 || components > 4)
        throw Error(name + " has " + std::to_string(components) + " components, but must have 1 to 4");
    const PixelType type = pixel_type(array, name);
    if (!array->HasStandardMemoryLayout()) {
        m_array.TakeReference(vtkDataArray::CreateDataArray(array->GetDataType()));
        m_array->DeepCopy(array);
    }
    m_view = turned_over(static_cast<const std::byte*>(m_array->GetVoidPointer(0)), type, size[0], size[1],
                         components);
}

ImageTexture::~ImageTexture() = default;

int ImageTexture::type() const {
    return m_array->GetDataType();
}

}  // namespace anamorph_vtk
