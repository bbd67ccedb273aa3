// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphImageMorph.h"

#include <map>
#include <memory>
#include <string>

#include "anamorph/error.h"
#include "anamorph/morph/features_file.h"
#include "anamorph/morph/morph.h"
#include "anamorph/operation/solved.h"
#include "anamorph/parameter/parameter.h"
#include "drawn_image.h"
#include "execution.h"
#include "feature_cells.h"
#include "image_texture.h"
#include "input_times.h"
#include "property_names.h"
#include "text_of_file.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkObjectFactoryNewMacro(vtkAnamorphImageMorph);

namespace {

using anamorph::Error;

constexpr int kImages = 2, kPorts = 4;

/// What the core calls our properties.
const std::map<std::string, std::string>& property_names() {
    static const std::map<std::string, std::string> names = {{"pin_border", "PinBorder"},
                                                             {"tol", "Tolerance"},
                                                             {"weight_a", "WeightA"},
                                                             {"weight_b", "WeightB"},
                                                             {"weight_p", "WeightP"}};
    return names;
}

/// The array of the second image that belongs to one of the first.
vtkDataArray* array_like(vtkDataArray* first, vtkImageData* image) {
    const char* name = first ? first->GetName() : nullptr;
    vtkDataArray* same = name ? image->GetPointData()->GetArray(name) : nullptr;
    return same ? same : image->GetPointData()->GetScalars();
}

std::shared_ptr<anamorph::Features> features_in_file(const std::string& name) {
    auto features = std::make_shared<anamorph::Features>(
        anamorph::parse_features_file(anamorph_vtk::text_of_file(name), name));
    if (features->shapes() != kImages)
        throw Error("FileName", name,
                    "the file has features of " + std::to_string(features->shapes()) +
                        " images: must have those of 2");
    return features;
}

}  // namespace

vtkAnamorphImageMorph::vtkAnamorphImageMorph() {
    this->SetNumberOfInputPorts(kPorts);
    this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS,
                                 vtkDataSetAttributes::SCALARS);
}

vtkAnamorphImageMorph::~vtkAnamorphImageMorph() {
    this->SetFileName(nullptr);
}

void vtkAnamorphImageMorph::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n"
       << indent << "Shape: " << this->Shape << "\n"
       << indent << "Color: " << this->Color << "\n"
       << indent << "ColorFollowsShape: " << this->ColorFollowsShape << "\n"
       << indent << "WeightA: " << this->WeightA << "\n"
       << indent << "WeightB: " << this->WeightB << "\n"
       << indent << "WeightP: " << this->WeightP << "\n"
       << indent << "PinBorder: " << this->PinBorder << "\n"
       << indent << "Interpolation: " << this->Interpolation << "\n"
       << indent << "Tolerance: " << this->Tolerance << "\n"
       << indent << "MaxError: " << this->MaxError << "\n";
}

void vtkAnamorphImageMorph::SetOtherConnection(vtkAlgorithmOutput* output) {
    this->SetInputConnection(1, output);
}

void vtkAnamorphImageMorph::SetLinesConnection(vtkAlgorithmOutput* output) {
    this->SetInputConnection(2, output);
}

void vtkAnamorphImageMorph::SetOtherLinesConnection(vtkAlgorithmOutput* output) {
    this->SetInputConnection(3, output);
}

int vtkAnamorphImageMorph::FillInputPortInformation(int port, vtkInformation* info) {
    info->Set(INPUT_REQUIRED_DATA_TYPE(), port < kImages ? "vtkImageData" : "vtkPolyData");
    info->Set(INPUT_IS_OPTIONAL(), 1);  // has_inputs() tells of the images in our own words
    return 1;
}

vtkTypeBool vtkAnamorphImageMorph::ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                                                  vtkInformationVector* outputs) {
    if (!anamorph_vtk::has_inputs(this, {"the first image", "the second image"})) return 0;
    return this->Superclass::ProcessRequest(request, inputs, outputs);
}

int vtkAnamorphImageMorph::RequestInformation(vtkInformation*, vtkInformationVector** inputs,
                                              vtkInformationVector* outputs) {
    anamorph_vtk::tell_times({inputs, kPorts}, outputs->GetInformationObject(0));
    return 1;
}

int vtkAnamorphImageMorph::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                               vtkInformationVector*) {
    anamorph_vtk::ask_for_all({inputs, kPorts});
    return 1;
}

int vtkAnamorphImageMorph::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                       vtkInformationVector* outputs) {
    vtkImageData* output = vtkImageData::GetData(outputs);
    output->Initialize();
    this->MaxError = 0;
    const auto draw = [&] {
        try {
            this->Draw(
                inputs,
                outputs->GetInformationObject(0)->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT()),
                output);
            anamorph_vtk::hand_over_time({inputs, kPorts}, output);
        } catch (const Error& error) {
            throw anamorph_vtk::of_known_property(error, property_names());
        }
    };
    return anamorph_vtk::guarded(this, draw, {output});
}

/// Draws the pixels of an extent.
void vtkAnamorphImageMorph::Draw(vtkInformationVector** inputs, const int* extent, vtkImageData* output) {
    if (extent[0] > extent[1] || extent[2] > extent[3] || extent[4] > extent[5]) return;
    vtkImageData* const images[kImages] = {vtkImageData::GetData(inputs[0]),
                                           vtkImageData::GetData(inputs[1])};
    vtkDataArray* const given = this->GetInputArrayToProcess(0, inputs);
    const anamorph_vtk::ImageTexture a(images[0], given, "the first image"),
        b(images[1], array_like(given, images[1]), "the second image");
    const int channels = a.view().channels;
    if (b.view().channels != channels || b.type() != a.type())
        throw Error("the second image has " + std::to_string(b.view().channels) + " components of " +
                    vtkImageScalarTypeNameMacro(b.type()) + ", but must be as the first, which has " +
                    std::to_string(channels) + " of " + vtkImageScalarTypeNameMacro(a.type()));

    vtkPolyData* const lines[kImages] = {vtkPolyData::GetData(inputs[2]), vtkPolyData::GetData(inputs[3])};
    const bool file = this->FileName && *this->FileName;
    if (file && (lines[0] || lines[1]))
        throw Error("FileName", this->FileName, "must not be given together with lines");
    const std::shared_ptr<anamorph::Features> features =
        file ? features_in_file(this->FileName) : anamorph_vtk::features_of(lines, images);
    if (this->PinBorder != 0) features->pin_border(this->PinBorder);
    // Nothing moves where the border alone is held.
    if (features->size() == 0 && features->border_weight() == 0) features->pin_border(1);

    const auto check_part = [](const char* name, double part) {
        if (!(part >= 0 && part <= 1))
            throw Error(name, anamorph::shortest(part), "must be a number from 0 to 1");
    };
    check_part("Shape", this->Shape);
    if (!this->ColorFollowsShape) check_part("Color", this->Color);
    anamorph::MorphOptions options;
    options.tol = this->Tolerance;
    options.filter = anamorph_vtk::filter_of(this->Interpolation);
    options.t = this->Shape;
    if (!this->ColorFollowsShape) options.t_color = this->Color;
    options.weight_a = this->WeightA;
    options.weight_b = this->WeightB;
    options.weight_p = this->WeightP;
    const std::unique_ptr<const anamorph::SolvedPicture> picture =
        anamorph::solved(anamorph::morphed_picture(features, {a.size(), b.size()}, a.size(), options));

    const anamorph_vtk::ImageTexture* const textures[] = {&a, &b};
    this->MaxError = anamorph_vtk::draw_image(this, *picture, textures, images[0], given, extent, output);
}
