// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphFigureRepresentation.h"

#include "points_of_data.h"
#include "vtkAnamorphEllipsoidMapper.h"
#include "vtkAnamorphFigureAlgorithm.h"
#include "vtkCamera.h"
#include "vtkMatrix4x4.h"
#include "vtkPVLODActor.h"
#include "vtkPVRenderView.h"
#include "vtkRenderer.h"

vtkAnamorphFigureRepresentation::vtkAnamorphFigureRepresentation() {
    this->GeometryFilter->Delete();
    this->GeometryFilter = PointsOfData::New();
    this->SuppressLOD = true;
    this->SetupDefaults();
    this->Actor->SetPickable(0);
}

vtkAnamorphFigureRepresentation::~vtkAnamorphFigureRepresentation() = default;

/// The figures as the view is going to show them; nothing is made anew while that stays.
void vtkAnamorphFigureRepresentation::Draw(vtkDataObject* figures) {
    auto* view = vtkPVRenderView::SafeDownCast(this->GetView());
    if (!view || !figures) return;
    vtkCamera* camera = view->GetActiveCamera();
    const int* size = view->GetRenderer()->GetSize();
    if (size[0] < 1 || size[1] < 1) return;
    vtkAnamorphFigureAlgorithm* filter = this->GetFilter();
    filter->SetInputDataObject(figures);
    filter->SetViewMode(vtkAnamorphFigureAlgorithm::CAMERA);
    filter->SetViewSize(size[0], size[1]);
    filter->SetCameraPosition(camera->GetPosition());
    filter->SetCameraFocalPoint(camera->GetFocalPoint());
    filter->SetCameraViewUp(camera->GetViewUp());
    filter->SetCameraParallelProjection(camera->GetParallelProjection() != 0);
    filter->SetCameraParallelScale(camera->GetParallelScale());
    filter->SetCameraViewAngle(camera->GetViewAngle());
    filter->Update();
    this->Mapper->SetInputDataObject(filter->GetOutputDataObject(0));
}

int vtkAnamorphFigureRepresentation::ProcessViewRequest(vtkInformationRequestKey* request,
                                                        vtkInformation* input, vtkInformation* output) {
    if (!this->Superclass::ProcessViewRequest(request, input, output)) return 0;
    if (request == vtkPVView::REQUEST_UPDATE()) {
        this->Bodies->SetInputDataObject(this->MultiBlockMaker->GetOutputDataObject(0));
        vtkNew<vtkMatrix4x4> matrix;
        this->Actor->GetMatrix(matrix);
        vtkPVRenderView::SetGeometryBounds(input, this, this->Bodies->GetBounds(), matrix);
    } else if (request == vtkPVView::REQUEST_RENDER()) {
        this->Draw(vtkPVView::GetDeliveredPiece(input, this));
    }
    return 1;
}

void vtkAnamorphFigureRepresentation::UpdateColoringParameters() {
    this->Superclass::UpdateColoringParameters();
    // What the points have, their cells have.
    if (this->Mapper->GetScalarMode() == VTK_SCALAR_MODE_USE_POINT_FIELD_DATA)
        this->Mapper->SetScalarMode(VTK_SCALAR_MODE_USE_CELL_FIELD_DATA);
}

void vtkAnamorphFigureRepresentation::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "Filter:\n";
    this->GetFilter()->PrintSelf(os, indent.GetNextIndent());
}
