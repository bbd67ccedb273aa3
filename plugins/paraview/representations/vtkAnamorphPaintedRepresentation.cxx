// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphPaintedRepresentation.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkMapper.h"
#include "vtkObjectFactory.h"
#include "vtkPVLODActor.h"
#include "vtkPVView.h"
#include "vtkPointData.h"
#include "vtkTexture.h"
#include "vtkUnsignedCharArray.h"

vtkStandardNewMacro(vtkAnamorphPaintedRepresentation);

namespace {

struct Picture {
    vtkUnsignedCharArray* texels = nullptr;
    std::array<int, 2> size = {};
};

/// The picture of one data object; none where it has none that is whole.
Picture picture_in(vtkDataObject* data) {
    vtkFieldData* fields = data ? data->GetFieldData() : nullptr;
    if (!fields) return {};
    auto* texels = vtkUnsignedCharArray::SafeDownCast(fields->GetAbstractArray("anamorph:picture"));
    auto* size = vtkIntArray::SafeDownCast(fields->GetAbstractArray("anamorph:picture_size"));
    if (!texels || !size || size->GetNumberOfValues() < 2 || texels->GetNumberOfComponents() != 3) return {};
    const std::array<int, 2> at{size->GetValue(0), size->GetValue(1)};
    // Of several ranks the arrays may have been put behind each other.
    if (at[0] < 1 || at[1] < 1 || texels->GetNumberOfTuples() < vtkIdType{at[0]} * at[1]) return {};
    return {texels, at};
}

/// The first picture of what is shown.
Picture picture_of(vtkDataObject* shown) {
    Picture found = picture_in(shown);
    auto* blocks = vtkCompositeDataSet::SafeDownCast(shown);
    if (found.texels || !blocks) return found;
    const auto each = vtk::TakeSmartPointer(blocks->NewIterator());
    for (each->InitTraversal(); !each->IsDoneWithTraversal() && !found.texels; each->GoToNextItem())
        found = picture_in(each->GetCurrentDataObject());
    return found;
}

/// Lines of a panorama, rows up: dark every 10 degrees of one that is whole, wide every 30, on colors.
vtkSmartPointer<vtkUnsignedCharArray> lines(int width, int height) {
    constexpr int kStep = 64, kWide = 3;
    auto texels = vtkSmartPointer<vtkUnsignedCharArray>::New();
    texels->SetNumberOfComponents(3);
    texels->SetNumberOfTuples(vtkIdType{width} * height);
    unsigned char* to = texels->GetPointer(0);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x, to += 3) {
            const auto on_line = [](int at) {
                const int from = (at + kStep / 2) % (3 * kStep) - kStep / 2;
                const int near = (at + kStep / 2) % kStep - kStep / 2;
                return std::abs(from) < 2 * kWide || std::abs(near) < kWide;
            };
            const bool dark = on_line(x) || on_line(y);
            const int red = 90 + 165 * x / width, green = 90 + 165 * y / height, blue = 255 - 165 * x / width;
            const int part = dark ? 3 : 1;
            to[0] = static_cast<unsigned char>(red / part);
            to[1] = static_cast<unsigned char>(green / part);
            to[2] = static_cast<unsigned char>(blue / part);
        }
    return texels;
}

}  // namespace

vtkAnamorphPaintedRepresentation::vtkAnamorphPaintedRepresentation() {
    this->Own->SetInputData(this->Image);
    this->Own->InterpolateOn();
    this->Own->RepeatOn();
    this->Own->MipmapOn();
}

vtkAnamorphPaintedRepresentation::~vtkAnamorphPaintedRepresentation() = default;

void vtkAnamorphPaintedRepresentation::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "Texels: " << this->Texels << "\n" << indent << "Given: " << this->Given << "\n";
}

void vtkAnamorphPaintedRepresentation::SetTexture(vtkTexture* texture) {
    this->Given = texture != nullptr;
    this->Superclass::SetTexture(this->Given ? texture : this->Own.Get());
}

int vtkAnamorphPaintedRepresentation::ProcessViewRequest(vtkInformationRequestKey* request,
                                                         vtkInformation* input, vtkInformation* output) {
    if (!this->Superclass::ProcessViewRequest(request, input, output)) return 0;
    if (request == vtkPVView::REQUEST_RENDER()) this->TakePicture(vtkPVView::GetDeliveredPiece(input, this));
    return 1;
}

/// Colors of arrays would be looked up by the texture coordinates of the picture.
void vtkAnamorphPaintedRepresentation::UpdateColoringParameters() {
    this->Superclass::UpdateColoringParameters();
    for (vtkMapper* mapper : {this->Mapper, this->LODMapper}) mapper->ScalarVisibilityOff();
}

void vtkAnamorphPaintedRepresentation::TakePicture(vtkDataObject* shown) {
    const Picture picture = picture_of(shown);
    if (picture.texels ? picture.texels != this->Texels : !this->Texels || this->Texels->GetName()) {
        constexpr int kLines[2] = {2304, 1152};
        const int width = picture.texels ? picture.size[0] : kLines[0];
        const int height = picture.texels ? picture.size[1] : kLines[1];
        this->Texels = picture.texels;
        if (!this->Texels) this->Texels = lines(width, height);
        this->Image->Initialize();
        this->Image->SetDimensions(width, height, 1);
        this->Image->GetPointData()->SetScalars(this->Texels);
        this->Image->Modified();
    }
    if (!this->Given) this->Superclass::SetTexture(this->Own);
}
