// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphOutlineRepresentation.h"

#include "points_of_data.h"
#include "vtkAnamorphEllipsoidMapper.h"
#include "vtkAnamorphFigureOutline.h"
#include "vtkCamera.h"
#include "vtkMatrix4x4.h"
#include "vtkObjectFactory.h"
#include "vtkPVLODActor.h"
#include "vtkPVRenderView.h"
#include "vtkRenderer.h"

vtkStandardNewMacro(vtkAnamorphOutlineRepresentation);

vtkAnamorphOutlineRepresentation::vtkAnamorphOutlineRepresentation() {
    this->GeometryFilter->Delete();
    this->GeometryFilter = PointsOfData::New();
    this->SuppressLOD = true;
    this->SetupDefaults();
    this->Actor->SetPickable(0);
    this->Outline->SetViewMode(vtkAnamorphFigureOutline::CAMERA);
}

vtkAnamorphOutlineRepresentation::~vtkAnamorphOutlineRepresentation() = default;

void vtkAnamorphOutlineRepresentation::SetHidden(int hidden) {
    this->Outline->SetHidden(hidden);
}

void vtkAnamorphOutlineRepresentation::SetCrossings(bool crossings) {
    this->Outline->SetCrossings(crossings);
}

void vtkAnamorphOutlineRepresentation::SetConnected(bool connected) {
    this->Outline->SetConnected(connected);
}

void vtkAnamorphOutlineRepresentation::SetTolerance(double tolerance) {
    this->Outline->SetTolerance(tolerance);
}

/// Of the figures as the view is going to show them; nothing is made anew while that stays.
void vtkAnamorphOutlineRepresentation::MakeOutlines(vtkDataObject* figures) {
    auto* view = vtkPVRenderView::SafeDownCast(this->GetView());
    if (!view || !figures) return;
    vtkCamera* camera = view->GetActiveCamera();
    const int* size = view->GetRenderer()->GetSize();
    if (size[0] < 1 || size[1] < 1) return;
    vtkAnamorphFigureOutline* outline = this->Outline;
    outline->SetInputDataObject(figures);
    outline->SetViewSize(size[0], size[1]);
    outline->SetCameraPosition(camera->GetPosition());
    outline->SetCameraFocalPoint(camera->GetFocalPoint());
    outline->SetCameraViewUp(camera->GetViewUp());
    outline->SetCameraParallelProjection(camera->GetParallelProjection() != 0);
    outline->SetCameraParallelScale(camera->GetParallelScale());
    outline->SetCameraViewAngle(camera->GetViewAngle());
    outline->Update();
    this->Mapper->SetInputDataObject(outline->GetOutputDataObject(0));
}

int vtkAnamorphOutlineRepresentation::ProcessViewRequest(vtkInformationRequestKey* request,
                                                         vtkInformation* input, vtkInformation* output) {
    if (!this->Superclass::ProcessViewRequest(request, input, output)) return 0;
    if (request == vtkPVView::REQUEST_UPDATE()) {
        this->Bodies->SetInputDataObject(this->MultiBlockMaker->GetOutputDataObject(0));
        vtkNew<vtkMatrix4x4> matrix;
        this->Actor->GetMatrix(matrix);
        vtkPVRenderView::SetGeometryBounds(input, this, this->Bodies->GetBounds(), matrix);
    } else if (request == vtkPVView::REQUEST_RENDER()) {
        this->MakeOutlines(vtkPVView::GetDeliveredPiece(input, this));
    }
    return 1;
}

void vtkAnamorphOutlineRepresentation::UpdateColoringParameters() {
    this->Superclass::UpdateColoringParameters();
    // What the points have, their lines have as cells.
    if (this->Mapper->GetScalarMode() == VTK_SCALAR_MODE_USE_POINT_FIELD_DATA)
        this->Mapper->SetScalarMode(VTK_SCALAR_MODE_USE_CELL_FIELD_DATA);
}

void vtkAnamorphOutlineRepresentation::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "Outline:\n";
    this->Outline->PrintSelf(os, indent.GetNextIndent());
}
