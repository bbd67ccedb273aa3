// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphEllipsoidRepresentation.h"

#include <algorithm>
#include <cstring>

#include "points_of_data.h"
#include "vtkAnamorphEllipsoidMapper.h"
#include "vtkCompositeDataDisplayAttributes.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPVLODActor.h"
#include "vtkPVRenderView.h"
#include "vtkTexture.h"

vtkStandardNewMacro(vtkAnamorphEllipsoidRepresentation);

namespace {

/// What ParaView's menus of arrays call none.
const char* array_name(const char* name) {
    return name && std::strcmp(name, "None") != 0 ? name : "";
}

}  // namespace

vtkAnamorphEllipsoidRepresentation::vtkAnamorphEllipsoidRepresentation() {
    this->GeometryFilter->Delete();
    this->GeometryFilter = PointsOfData::New();
    this->Mapper->Delete();
    this->LODMapper->Delete();
    this->Mapper = vtkAnamorphEllipsoidMapper::New();
    this->LODMapper = vtkAnamorphEllipsoidMapper::New();
    this->SuppressLOD = true;
    this->SetupDefaults();
}

vtkAnamorphEllipsoidRepresentation::~vtkAnamorphEllipsoidRepresentation() = default;

vtkAnamorphEllipsoidMapper* vtkAnamorphEllipsoidRepresentation::Ellipsoids() {
    return vtkAnamorphEllipsoidMapper::SafeDownCast(this->Mapper);
}

void vtkAnamorphEllipsoidRepresentation::SetShape(int shape) {
    this->Ellipsoids()->SetShape(shape);
}

void vtkAnamorphEllipsoidRepresentation::SetAxesArray(const char* name) {
    this->Ellipsoids()->SetAxesArray(array_name(name));
}

void vtkAnamorphEllipsoidRepresentation::SetOrientationArray(const char* name) {
    this->Ellipsoids()->SetOrientationArray(array_name(name));
}

void vtkAnamorphEllipsoidRepresentation::SetTensorArray(const char* name) {
    this->Ellipsoids()->SetTensorArray(array_name(name));
}

void vtkAnamorphEllipsoidRepresentation::SetScaleFactor(double factor) {
    this->Ellipsoids()->SetScaleFactor(factor);
}

void vtkAnamorphEllipsoidRepresentation::SetProbability(double probability) {
    this->Ellipsoids()->SetProbability(probability);
}

void vtkAnamorphEllipsoidRepresentation::SetStyle(int style) {
    this->Ellipsoids()->SetStyle(style);
}

void vtkAnamorphEllipsoidRepresentation::SetInteractiveBodies(int count) {
    this->Ellipsoids()->SetInteractiveBodies(count);
}

void vtkAnamorphEllipsoidRepresentation::SetTextureArray(const char* name) {
    this->Ellipsoids()->SetTextureArray(array_name(name));
}

void vtkAnamorphEllipsoidRepresentation::SetTextureMapping(int mapping) {
    this->Ellipsoids()->SetTextureMapping(mapping);
}

void vtkAnamorphEllipsoidRepresentation::AddTexture(vtkTexture* texture) {
    if (!texture) return;
    this->Textures.emplace_back(texture);
    this->GiveTextures();
}

void vtkAnamorphEllipsoidRepresentation::RemoveAllTextures() {
    this->Textures.clear();
    this->GiveTextures();
}

void vtkAnamorphEllipsoidRepresentation::SetNumberOfTextureNames(int count) {
    this->TextureNames.resize(static_cast<std::size_t>(std::max(count, 0)));
    this->GiveTextures();
}

void vtkAnamorphEllipsoidRepresentation::SetTextureName(int i, const char* name) {
    const auto at = static_cast<std::size_t>(std::max(i, 0));
    if (at >= this->TextureNames.size()) this->TextureNames.resize(at + 1);
    this->TextureNames[at] = name ? name : "";
    this->GiveTextures();
}

/// The textures and the names, which are set one after the other.
void vtkAnamorphEllipsoidRepresentation::GiveTextures() {
    this->Ellipsoids()->RemoveAllTextures();
    for (std::size_t i = 0; i < this->Textures.size(); ++i)
        this->Ellipsoids()->AddTexture(this->Textures[i],
                                       i < this->TextureNames.size() ? this->TextureNames[i].c_str() : "");
}

/// Gives the mapper data, and what is said of its blocks where that or the data is new.
void vtkAnamorphEllipsoidRepresentation::ShowBlocksOf(vtkDataObject* data, bool blocks_changed) {
    this->Mapper->SetInputDataObject(data);
    if (!data || (!blocks_changed && data == this->Shown && data->GetMTime() == this->ShownTime)) return;
    this->Shown = data;
    this->ShownTime = data->GetMTime();
    vtkNew<vtkCompositeDataDisplayAttributes> blocks;
    this->PopulateBlockAttributes(blocks, data);
    this->Ellipsoids()->SetCompositeDataDisplayAttributes(blocks);
}

int vtkAnamorphEllipsoidRepresentation::ProcessViewRequest(vtkInformationRequestKey* request,
                                                           vtkInformation* input, vtkInformation* output) {
    const bool blocks_changed = this->BlockAttrChanged;  // it is set back when they are rendered
    if (!this->Superclass::ProcessViewRequest(request, input, output)) return 0;
    if (request == vtkPVView::REQUEST_UPDATE()) {
        // The view fits what the points stand for, not the points.
        this->ShowBlocksOf(this->MultiBlockMaker->GetOutputDataObject(0), blocks_changed);
        vtkNew<vtkMatrix4x4> matrix;
        this->Actor->GetMatrix(matrix);
        vtkPVRenderView::SetGeometryBounds(input, this, this->Mapper->GetBounds(), matrix);
    } else if (request == vtkPVView::REQUEST_RENDER()) {
        this->ShowBlocksOf(vtkPVView::GetDeliveredPiece(input, this), blocks_changed);
    }
    return 1;
}

void vtkAnamorphEllipsoidRepresentation::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "Mapper:\n";
    this->Mapper->PrintSelf(os, indent.GetNextIndent());
}
