// SPDX-License-Identifier: Apache-2.0
#include "panorama_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>

#include "anamorph/error.h"
#include "error_texts.h"
#include "png_file.h"
#include "vtkDataArray.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkImageReader2.h"
#include "vtkImageReader2Factory.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

namespace anamorph_vtk {

namespace {

using anamorph::Error;

vtkSmartPointer<vtkImageData> read(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) throw Error("Picture", path, "there is no such file");
    check_png(path);
    const vtkSmartPointer<vtkImageReader2> reader =
        vtk::TakeSmartPointer(vtkImageReader2Factory::CreateImageReader2(path.c_str()));
    if (!reader) throw Error("Picture", path, "must be a picture that VTK's image readers know");
    const ErrorTexts errors(reader);
    reader->SetFileName(path.c_str());
    reader->Update();
    vtkSmartPointer<vtkImageData> image = reader->GetOutput();
    if (errors.any() || reader->GetErrorCode() != vtkErrorCode::NoError ||
        !image->GetPointData()->GetScalars())
        throw Error("Picture", path, "it cannot be read");
    const int* size = image->GetDimensions();
    if (size[0] < 1 || size[1] < 1 || size[2] != 1)
        throw Error("Picture", path, "must have one slice of pixels");
    return image;
}

/// What a number of a picture is as a byte: of 8 and 16 bits its full range, of floats 0 to 1.
double white_of(vtkDataArray* array) {
    switch (array->GetDataType()) {
        case VTK_UNSIGNED_CHAR:
            return 255;
        case VTK_UNSIGNED_SHORT:
            return 65535;
        case VTK_FLOAT:
        case VTK_DOUBLE:
            return 1;
        default:
            return array->GetDataTypeMax();
    }
}

}  // namespace

PanoramaPicture::PanoramaPicture(const std::string& path)
    : m_texels(vtkSmartPointer<vtkUnsignedCharArray>::New()), m_shown(vtkSmartPointer<vtkIntArray>::New()) {
    constexpr std::int64_t kMostTexels = std::int64_t{1} << 23;
    const vtkSmartPointer<vtkImageData> image = read(path);
    vtkDataArray* pixels = image->GetPointData()->GetScalars();
    const int* size = image->GetDimensions();
    m_size = {size[0], size[1]};
    int step = 1;
    while (std::int64_t{size[0] / step} * (size[1] / step) > kMostTexels) ++step;
    const int width = std::max(1, size[0] / step), height = std::max(1, size[1] / step);
    m_shown->SetName("anamorph:picture_size");
    m_shown->InsertNextValue(width);
    m_shown->InsertNextValue(height);
    m_texels->SetName("anamorph:picture");
    m_texels->SetNumberOfComponents(3);
    m_texels->SetNumberOfTuples(vtkIdType{width} * height);
    const int channels = pixels->GetNumberOfComponents();
    const double scale = 255 / white_of(pixels);
    unsigned char* to = m_texels->GetPointer(0);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c, ++to) {
                // The mean of the texels of the file that become one.
                double sum = 0;
                int count = 0;
                for (int j = y * step; j < std::min((y + 1) * step, size[1]); ++j)
                    for (int i = x * step; i < std::min((x + 1) * step, size[0]); ++i, ++count)
                        sum += pixels->GetComponent(vtkIdType{j} * size[0] + i, channels < 3 ? 0 : c);
                const double byte = sum / count * scale + 0.5;
                *to = byte >= 0 ? static_cast<unsigned char>(std::min(byte, 255.0)) : 0;
            }
}

void PanoramaPicture::add_to(vtkFieldData* fields) const {
    fields->AddArray(m_texels);
    fields->AddArray(m_shown);
}

}  // namespace anamorph_vtk
