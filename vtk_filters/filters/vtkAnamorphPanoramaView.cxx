// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphPanoramaView.h"

#include <algorithm>
#include <string>

#include "anamorph/error.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/operation/pano.h"
#include "anamorph/projector/projector_rows.h"
#include "execution.h"
#include "image_texture.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkObjectFactoryNewMacro(vtkAnamorphPanoramaView);

namespace {

using Executive = vtkStreamingDemandDrivenPipeline;

constexpr int kMostViewSize = 1 << 16;
const char* const kName = "the panorama";

void check_size(const int* size) {
    for (int k = 0; k < 2; ++k)
        if (size[k] < 1 || size[k] > kMostViewSize)
            throw anamorph::Error("ViewSize", std::to_string(size[k]),
                                  "must be an integer from 1 to " + std::to_string(kMostViewSize));
}

}  // namespace

vtkAnamorphPanoramaView::vtkAnamorphPanoramaView() {
    this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS,
                                 vtkDataSetAttributes::SCALARS);
}
vtkAnamorphPanoramaView::~vtkAnamorphPanoramaView() {
    this->SetLens(nullptr);
}

void vtkAnamorphPanoramaView::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "Projection: " << anamorph::name_of(anamorph::kProjections[this->Projection]) << "\n";
    os << indent << "FieldOfView: " << this->FieldOfView << "\n";
    os << indent << "PanniniDistance: " << this->PanniniDistance << "\n";
    os << indent << "Lens: " << (this->Lens ? this->Lens : "none") << "\n";
    os << indent << "Yaw: " << this->Yaw << "\n";
    os << indent << "Pitch: " << this->Pitch << "\n";
    os << indent << "Roll: " << this->Roll << "\n";
    os << indent << "ViewAngle: " << this->ViewAngle << "\n";
    os << indent << "ViewSize: " << this->ViewSize[0] << " " << this->ViewSize[1] << "\n";
    os << indent << "Tolerance: " << this->Tolerance << "\n";
    os << indent << "MaxError: " << this->MaxError << "\n";
}

int vtkAnamorphPanoramaView::RequestInformation(vtkInformation*, vtkInformationVector** inputs,
                                                vtkInformationVector* outputs) {
    const auto tell = [&] {
        check_size(this->ViewSize);
        vtkInformation* output = outputs->GetInformationObject(0);
        output->Set(Executive::WHOLE_EXTENT(), 0, this->ViewSize[0] - 1, 0, this->ViewSize[1] - 1, 0, 0);
        output->Set(CAN_PRODUCE_SUB_EXTENT(), 1);
        const double spacing[3] = {1, 1, 1}, origin[3] = {0, 0, 0},
                     direction[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        output->Set(vtkDataObject::SPACING(), spacing, 3);
        output->Set(vtkDataObject::ORIGIN(), origin, 3);
        output->Set(vtkDataObject::DIRECTION(), direction, 9);
        vtkInformation* array = this->GetInputArrayFieldInformation(0, inputs);
        const bool known = array && array->Has(vtkDataObject::FIELD_ARRAY_TYPE()) &&
                           array->Has(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS());
        vtkDataObject::SetPointDataActiveScalarInfo(
            output, known ? array->Get(vtkDataObject::FIELD_ARRAY_TYPE()) : -1,
            known ? array->Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS()) : -1);
    };
    return anamorph_vtk::guarded(this, tell, {vtkDataObject::GetData(outputs)});
}

int vtkAnamorphPanoramaView::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                                 vtkInformationVector*) {
    // Any part of a view may show any part of the panorama.
    vtkInformation* input = inputs[0]->GetInformationObject(0);
    if (input && input->Has(Executive::WHOLE_EXTENT()))
        input->Set(Executive::UPDATE_EXTENT(), input->Get(Executive::WHOLE_EXTENT()), 6);
    return 1;
}

int vtkAnamorphPanoramaView::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                         vtkInformationVector* outputs) {
    vtkImageData* output = vtkImageData::GetData(outputs);
    output->Initialize();
    this->MaxError = 0;
    return anamorph_vtk::guarded(this,
                                 [&] {
                                     int asked[6];
                                     outputs->GetInformationObject(0)->Get(Executive::UPDATE_EXTENT(), asked);
                                     this->Draw(inputs, asked, output);
                                 },
                                 {output});
}

/// Draws the pixels of an extent of the view.
void vtkAnamorphPanoramaView::Draw(vtkInformationVector** inputs, const int* extent, vtkImageData* output) {
    if (extent[0] > extent[1] || extent[2] > extent[3]) return;
    check_size(this->ViewSize);
    const anamorph_vtk::ImageTexture panorama(vtkImageData::GetData(inputs[0]),
                                              this->GetInputArrayToProcess(0, inputs), kName);
    anamorph::ParameterValues values(*anamorph::pano_operation().parameters);
    const anamorph::Projection projection = anamorph::kProjections[this->Projection];
    values.set("from", std::string(anamorph::name_of(projection)));
    anamorph::kPanniniDistanceRow.check(this->PanniniDistance, "srcd");
    if (anamorph::numbers_of(projection) > 0) values.set("srcd", this->PanniniDistance);
    values.set("fov", this->ViewAngle);
    values.set("yaw", this->Yaw);
    values.set("pitch", this->Pitch);
    values.set("roll", this->Roll);
    values.set("size", anamorph::Size{this->ViewSize[0], this->ViewSize[1]});
    values.set("tol", this->Tolerance);
    if (this->FieldOfView != 0) values.set("srcfov", this->FieldOfView);
    if (this->Lens && *this->Lens) values.set("srclens", this->Lens);
    const anamorph::ReprojectRequest request =
        anamorph::read_reproject_request(values, {panorama.size().width, panorama.size().height});

    output->SetExtent(extent[0], extent[1], extent[2], extent[3], 0, 0);
    output->SetOrigin(0, 0, 0);
    output->SetSpacing(1, 1, 1);
    const int channels = panorama.view().channels, height = this->ViewSize[1];
    const auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(panorama.type()));
    array->SetName("Colors");
    array->SetNumberOfComponents(channels);
    array->SetNumberOfTuples(output->GetNumberOfPoints());
    output->GetPointData()->SetScalars(array);

    anamorph_vtk::Execution execution(this);
    const anamorph::Picture view = anamorph::reprojected_picture(request.map(), request.options);
    const anamorph::MemorySource base(panorama.view(), anamorph_vtk::alpha_of(channels));
    const anamorph::FaceGrid faces = anamorph::faces_of(request.source.chart.projection());
    const anamorph::Pyramid source(base, std::max(1, faces.columns), std::max(1, faces.rows));
    const anamorph::Box box{extent[0], height - 1 - extent[3], extent[1] + 1, height - extent[2]};
    if (!view.draw(&source, box,
                   anamorph_vtk::turned_over(static_cast<std::byte*>(array->GetVoidPointer(0)),
                                             panorama.view().type, box.width(), box.height(), channels),
                   execution.stage(0.05, 0.95)))
        throw anamorph::Error("the panorama cannot be read");
    this->MaxError = view.reached(execution.stage(0.95, 1)).max_error;
}
