// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphPanoramaRepresentation.h"

#include <algorithm>
#include <vector>

#include "vtkAnamorphPanoramaProjector.h"
#include "vtkAnamorphProjectionShader.h"
#include "vtkAppendPolyData.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkMatrix4x4.h"
#include "vtkMatrixToLinearTransform.h"
#include "vtkObjectFactory.h"
#include "vtkPVLODActor.h"
#include "vtkPVRenderView.h"
#include "vtkPVRenderViewDataDeliveryManager.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkTexture.h"
#include "vtkTransformPolyDataFilter.h"
#include "vtkTriangleFilter.h"

vtkStandardNewMacro(vtkAnamorphPanoramaRepresentation);

namespace {

/// Of what the view is given beside the surfaces.
constexpr int kOccluders = 1;

/// Every surface of some data.
std::vector<vtkPolyData*> surfaces_of(vtkDataObject* data) {
    std::vector<vtkPolyData*> surfaces;
    const auto add = [&](vtkDataObject* object) {
        if (auto* mesh = vtkPolyData::SafeDownCast(object)) surfaces.push_back(mesh);
    };
    add(data);
    if (auto* blocks = vtkCompositeDataSet::SafeDownCast(data)) {
        const vtkSmartPointer<vtkCompositeDataIterator> each = vtk::TakeSmartPointer(blocks->NewIterator());
        for (each->InitTraversal(); !each->IsDoneWithTraversal(); each->GoToNextItem())
            add(each->GetCurrentDataObject());
    }
    return surfaces;
}

/// The triangles of surfaces, without their arrays.
void collect_triangles(const std::vector<vtkPolyData*>& surfaces, vtkPolyData* to) {
    vtkNew<vtkAppendPolyData> all;
    for (vtkPolyData* surface : surfaces) {
        vtkNew<vtkPolyData> bare;
        bare->SetPoints(surface->GetPoints());
        bare->SetPolys(surface->GetPolys());
        bare->SetStrips(surface->GetStrips());
        all->AddInputData(bare);
    }
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputConnection(all->GetOutputPort());
    if (surfaces.empty())
        to->Initialize();
    else {
        triangles->Update();
        to->ShallowCopy(triangles->GetOutput());
    }
}

}  // namespace

vtkAnamorphPanoramaRepresentation::vtkAnamorphPanoramaRepresentation() {
    this->Shader->AddTo(this->Actor);
    vtkNew<vtkMatrix4x4> matrix;
    this->ToWorld->SetInput(matrix);
    this->Occluders->SetTransform(this->ToWorld);
}

vtkAnamorphPanoramaRepresentation::~vtkAnamorphPanoramaRepresentation() {
    this->Shader->RemoveFrom(this->Actor);
}

void vtkAnamorphPanoramaRepresentation::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "Occlusion: " << this->Occlusion << "\n";
    this->Shader->PrintSelf(os, indent);
}

int vtkAnamorphPanoramaRepresentation::ProcessViewRequest(vtkInformationRequestKey* request,
                                                          vtkInformation* input, vtkInformation* output) {
    if (!this->Superclass::ProcessViewRequest(request, input, output)) return 0;
    if (request == vtkPVView::REQUEST_UPDATE())
        this->SendOccluders(input);
    else if (request == vtkPVView::REQUEST_RENDER())
        this->ReceiveOccluders(input);
    return 1;
}

/// Gives the view the triangles of this rank, for all that draw.
void vtkAnamorphPanoramaRepresentation::SendOccluders(vtkInformation* input) {
    vtkDataObject* shown = this->Occlusion ? this->MultiBlockMaker->GetOutputDataObject(0) : nullptr;
    const std::vector<vtkPolyData*> surfaces = surfaces_of(shown);
    vtkMTimeType time = shown ? shown->GetMTime() : 0;
    for (vtkPolyData* surface : surfaces) time = std::max(time, surface->GetMTime());
    if (time != this->OwnTime) {
        collect_triangles(surfaces, this->OwnTriangles);
        this->OwnTime = time;
    }
    vtkPVView::SetPiece(input, this, this->OwnTriangles, 0, kOccluders);
    auto* view = vtkPVRenderView::SafeDownCast(this->GetView());
    auto* delivery =
        view ? vtkPVRenderViewDataDeliveryManager::SafeDownCast(view->GetDeliveryManager()) : nullptr;
    if (delivery) delivery->SetDeliverToAllProcesses(this, true, false, kOccluders);
}

void vtkAnamorphPanoramaRepresentation::ReceiveOccluders(vtkInformation* input) {
    auto* all = this->Occlusion
                    ? vtkPolyData::SafeDownCast(vtkPVView::GetDeliveredPiece(input, this, kOccluders))
                    : nullptr;
    if (!all) return this->Projector->SetOccluderConnection(nullptr);
    vtkNew<vtkMatrix4x4> matrix;
    this->Actor->GetMatrix(matrix);
    vtkMatrix4x4* known = this->ToWorld->GetInput();
    if (!std::equal(matrix->GetData(), matrix->GetData() + 16, known->GetData())) known->DeepCopy(matrix);
    this->Occluders->SetInputData(all);
    this->Projector->SetOccluderConnection(this->Occluders->GetOutputPort());
}

void vtkAnamorphPanoramaRepresentation::SetPanorama(vtkTexture* panorama) {
    this->Projector->SetPanorama(panorama);
    if (panorama) {
        panorama->InterpolateOn();
        panorama->RepeatOn();
        panorama->MipmapOn();
        // Some drivers filter anisotropically without the gradients that we give, and show seams.
        panorama->SetMaximumAnisotropicFiltering(1);
        this->Shader->AddProjector(this->Projector);
    } else
        this->Shader->RemoveAllProjectors();
}

void vtkAnamorphPanoramaRepresentation::SetPanoramaProjection(int projection) {
    this->Projector->SetProjection(projection);
}

void vtkAnamorphPanoramaRepresentation::SetPanoramaFieldOfView(double degrees) {
    this->Projector->SetFieldOfView(degrees);
}

void vtkAnamorphPanoramaRepresentation::SetPanoramaVerticalFieldOfView(double degrees) {
    this->Projector->SetVerticalFieldOfView(degrees);
}
void vtkAnamorphPanoramaRepresentation::SetPanoramaProjectionAlpha(double alpha) {
    this->Projector->SetProjectionAlpha(alpha);
}
void vtkAnamorphPanoramaRepresentation::SetPanoramaPanniniDistance(double d) {
    this->Projector->SetPanniniDistance(d);
}

void vtkAnamorphPanoramaRepresentation::SetPanoramaLens(const char* lens) {
    this->Projector->SetLens(lens);
}

void vtkAnamorphPanoramaRepresentation::SetProjectorPosition(double x, double y, double z) {
    this->Projector->SetPosition(x, y, z);
}

void vtkAnamorphPanoramaRepresentation::SetProjectorDirection(double x, double y, double z) {
    this->Projector->SetDirection(x, y, z);
}

void vtkAnamorphPanoramaRepresentation::SetProjectorViewUp(double x, double y, double z) {
    this->Projector->SetViewUp(x, y, z);
}

void vtkAnamorphPanoramaRepresentation::SetShadows(int mode) {
    this->Projector->SetShadows(mode);
}

void vtkAnamorphPanoramaRepresentation::SetShadowSize(int texels) {
    this->Projector->SetShadowSize(texels);
}

void vtkAnamorphPanoramaRepresentation::SetCircles(int count) {
    this->Projector->SetCircles(count);
}

void vtkAnamorphPanoramaRepresentation::SetCircleRadius(double radius) {
    this->Projector->SetCircleRadius(radius);
}

void vtkAnamorphPanoramaRepresentation::SetFollowCamera(bool follow) {
    this->Projector->SetFollowCamera(follow);
}

void vtkAnamorphPanoramaRepresentation::SetViewpoint(double x, double y, double z) {
    this->Projector->SetViewpoint(x, y, z);
}

void vtkAnamorphPanoramaRepresentation::SetOcclusion(bool occlusion) {
    if (occlusion == this->Occlusion) return;
    this->Occlusion = occlusion;
    // The view has to be given the triangles.
    this->MarkModified();
}

void vtkAnamorphPanoramaRepresentation::SetProjectionMode(int mode) {
    this->Shader->SetMode(mode);
}

void vtkAnamorphPanoramaRepresentation::SetHideUnpainted(bool hide) {
    this->Shader->SetHideUnpainted(hide);
}
