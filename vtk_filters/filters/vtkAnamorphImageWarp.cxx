// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphImageWarp.h"

#include <memory>

#include "anamorph/error.h"
#include "anamorph/mesh/mesh_warp.h"
#include "anamorph/operation/solved.h"
#include "control_points.h"
#include "drawn_image.h"
#include "execution.h"
#include "image_texture.h"
#include "input_times.h"
#include "property_names.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointSet.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkObjectFactoryNewMacro(vtkAnamorphImageWarp);

namespace {

constexpr int kPorts = 2;

}  // namespace

vtkAnamorphImageWarp::vtkAnamorphImageWarp() {
    this->SetNumberOfInputPorts(kPorts);
    this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS,
                                 vtkDataSetAttributes::SCALARS);
}
vtkAnamorphImageWarp::~vtkAnamorphImageWarp() = default;

void vtkAnamorphImageWarp::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "Direction: " << (this->Direction == PUSH ? "push" : "pull") << "\n"
       << indent << "Amount: " << this->Amount << "\n"
       << indent << "Interpolation: " << this->Interpolation << "\n"
       << indent << "Tolerance: " << this->Tolerance << "\n"
       << indent << "MaxError: " << this->MaxError << "\n";
}

void vtkAnamorphImageWarp::SetMeshConnection(vtkAlgorithmOutput* output) {
    this->SetInputConnection(1, output);
}

int vtkAnamorphImageWarp::FillInputPortInformation(int port, vtkInformation* info) {
    info->Set(INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkImageData" : "vtkPointSet");
    info->Set(INPUT_IS_OPTIONAL(), 1);  // has_inputs() tells of both in our own words
    return 1;
}

vtkTypeBool vtkAnamorphImageWarp::ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                                                 vtkInformationVector* outputs) {
    if (!anamorph_vtk::has_inputs(this, {"the image", "the mesh"})) return 0;
    return this->Superclass::ProcessRequest(request, inputs, outputs);
}

int vtkAnamorphImageWarp::RequestInformation(vtkInformation*, vtkInformationVector** inputs,
                                             vtkInformationVector* outputs) {
    anamorph_vtk::tell_times({inputs, kPorts}, outputs->GetInformationObject(0));
    return 1;
}

int vtkAnamorphImageWarp::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                              vtkInformationVector*) {
    anamorph_vtk::ask_for_all({inputs, kPorts});
    return 1;
}

int vtkAnamorphImageWarp::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                      vtkInformationVector* outputs) {
    vtkImageData* output = vtkImageData::GetData(outputs);
    output->Initialize();
    this->MaxError = 0;
    const auto draw = [&] {
        try {
            this->Draw(
                vtkImageData::GetData(inputs[0]), this->GetInputArrayToProcess(0, inputs),
                vtkPointSet::GetData(inputs[1]),
                outputs->GetInformationObject(0)->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT()),
                output);
            anamorph_vtk::hand_over_time({inputs, kPorts}, output);
        } catch (const anamorph::Error& error) {
            throw anamorph_vtk::of_known_property(error, {{"amount", "Amount"}, {"tol", "Tolerance"}});
        }
    };
    return anamorph_vtk::guarded(this, draw, {output});
}

/// Draws the pixels of an extent.
void vtkAnamorphImageWarp::Draw(vtkImageData* input, vtkDataArray* given, vtkPointSet* mesh,
                                const int* extent, vtkImageData* output) {
    if (extent[0] > extent[1] || extent[2] > extent[3] || extent[4] > extent[5]) return;
    const anamorph_vtk::ImageTexture image(input, given, "the image");
    const int* whole = input->GetExtent();
    anamorph::MeshWarpOptions options;
    options.tol = this->Tolerance;
    options.amount = this->Amount;
    options.filter = anamorph_vtk::filter_of(this->Interpolation);
    anamorph::ControlMesh control = anamorph_vtk::control_mesh(mesh, input, whole);
    control.direction = this->Direction == PUSH ? anamorph::Direction::push : anamorph::Direction::pull;
    const std::unique_ptr<const anamorph::SolvedPicture> picture = anamorph::solved(
        anamorph::warped_picture({"the mesh", control}, image.size(), image.size(), options));

    const anamorph_vtk::ImageTexture* const textures[] = {&image};
    this->MaxError = anamorph_vtk::draw_image(this, *picture, textures, input, given, extent, output);
}
