// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphProjectionBake.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/projector/projection_bake.h"
#include "execution.h"
#include "scene_shadow.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTriangleFilter.h"

vtkObjectFactoryNewMacro(vtkAnamorphProjectionBake);

struct vtkAnamorphProjectionBake::Projectors {
    std::vector<anamorph::ProjectorPose> all;
};

namespace {

vtkSmartPointer<vtkPolyData> triangles_of(vtkPolyData* mesh) {
    vtkNew<vtkPolyData> copy;
    copy->ShallowCopy(mesh);
    vtkNew<vtkTriangleFilter> filter;
    filter->SetInputData(copy);
    filter->PassVertsOff();
    filter->PassLinesOff();
    filter->Update();
    return filter->GetOutput();
}

/// The pixels of an image, rows from the top.
std::vector<float> pixels_of(vtkImageData* image, vtkDataArray* scalars) {
    int size[3];
    image->GetDimensions(size);
    const int channels = scalars->GetNumberOfComponents();
    std::vector<float> pixels;
    pixels.reserve(static_cast<std::size_t>(scalars->GetNumberOfTuples() * channels));
    for (int j = size[1] - 1; j >= 0; --j)
        for (int i = 0; i < size[0]; ++i)
            for (int c = 0; c < channels; ++c)
                pixels.push_back(static_cast<float>(scalars->GetComponent(vtkIdType{j} * size[0] + i, c)));
    return pixels;
}

void add_field_value(vtkDataObject* object, const char* name, std::int64_t value) {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->InsertNextValue(static_cast<double>(value));
    object->GetFieldData()->AddArray(array);
}

}  // namespace

/// One execution of the filter.
struct vtkAnamorphProjectionBake::Run {
    vtkAnamorphProjectionBake& filter;
    anamorph_vtk::Execution execution{&filter};
    anamorph::BakeOptions options = {};
    bool bytes = true;
    std::vector<std::vector<float>> pixels = {};
    std::vector<anamorph::Occluders> occluders = {};
    std::vector<anamorph::ThrownPicture> pictures = {};
    std::vector<anamorph::BakedTriangle> mesh = {};

    void take_mesh(vtkPolyData* triangles);
    void take_pictures(vtkInformationVector* images);
    void cast_shadows(vtkPolyData* triangles, vtkPolyData* others);
    void hand_over(const anamorph::BakedTexture& texture, vtkImageData* output) const;
};

void vtkAnamorphProjectionBake::Run::take_mesh(vtkPolyData* triangles) {
    vtkDataArray* coordinates = triangles->GetPointData()->GetTCoords();
    if (triangles->GetNumberOfPolys() > 0 && (!coordinates || coordinates->GetNumberOfComponents() < 2))
        throw anamorph::Error("mesh", "no texture coordinates",
                              "must have them at its points, 2 numbers each");
    for (vtkIdType i = 0; i < triangles->GetNumberOfPolys(); ++i) {
        vtkIdType count = 0;
        const vtkIdType* ids = nullptr;
        triangles->GetPolys()->GetCellAtId(i, count, ids);
        anamorph::BakedTriangle t;
        for (std::size_t k = 0; k < 3; ++k) {
            triangles->GetPoint(ids[k], &t.points[k].x);
            t.coordinates[k] = {coordinates->GetComponent(ids[k], 0), coordinates->GetComponent(ids[k], 1)};
        }
        mesh.push_back(t);
    }
}

void vtkAnamorphProjectionBake::Run::take_pictures(vtkInformationVector* images) {
    const auto count = static_cast<std::size_t>(images->GetNumberOfInformationObjects());
    const auto& poses = filter.Poses->all;
    if (count != poses.size())
        throw anamorph::Error("projectors", std::to_string(poses.size()),
                              "must be as many as there are panoramas, " + std::to_string(count));
    for (std::size_t i = 0; i < count; ++i) {
        auto* image = vtkImageData::GetData(images, static_cast<int>(i));
        vtkDataArray* scalars = image ? image->GetPointData()->GetScalars() : nullptr;
        if (!scalars || scalars->GetNumberOfTuples() == 0)
            throw anamorph::Error("panorama", std::to_string(i), "must be an image with scalars");
        const int channels = scalars->GetNumberOfComponents();
        if (i > 0 && channels != options.channels)
            throw anamorph::Error("panorama", std::to_string(i),
                                  "must have as many components as the others");
        options.channels = channels;
        bytes = bytes && scalars->GetDataType() == VTK_UNSIGNED_CHAR;
        int size[3];
        image->GetDimensions(size);
        const anamorph::Chart chart(anamorph::kProjections[filter.Projection], size[0], size[1],
                                    filter.FieldOfView, anamorph::PixelSpacing::edges, "panorama ");
        pixels.push_back(pixels_of(image, scalars));
        pictures.push_back({anamorph::Projector(chart, poses[i]), nullptr});
    }
    for (std::size_t i = 0; i < count; ++i) pictures[i].pixels = pixels[i].data();
}

void vtkAnamorphProjectionBake::Run::cast_shadows(vtkPolyData* triangles, vtkPolyData* others) {
    anamorph_vtk::TriangleList list;
    anamorph_vtk::append_triangles(triangles, list);
    if (others) anamorph_vtk::append_triangles(triangles_of(others), list);
    for (const anamorph::ThrownPicture& picture : pictures)
        occluders.emplace_back(list, picture.projector.pose().position);
    for (std::size_t i = 0; i < pictures.size(); ++i) pictures[i].occluders = &occluders[i];
}

void vtkAnamorphProjectionBake::Run::hand_over(const anamorph::BakedTexture& texture,
                                               vtkImageData* output) const {
    const int channels = options.channels + 1, width = options.size.width, height = options.size.height;
    output->SetExtent(0, width - 1, 0, height - 1, 0, 0);
    output->AllocateScalars(bytes ? VTK_UNSIGNED_CHAR : VTK_FLOAT, channels);
    vtkDataArray* scalars = output->GetPointData()->GetScalars();
    scalars->SetName("Texture");
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i)
            for (int c = 0; c < channels; ++c) {
                const float value =
                    texture.pixels[(static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                                    static_cast<std::size_t>(i)) *
                                       static_cast<std::size_t>(channels) +
                                   static_cast<std::size_t>(c)];
                const double coverage = bytes && c == channels - 1 ? 255 : 1;
                const double out = value * coverage;
                scalars->SetComponent(vtkIdType{height - 1 - j} * width + i, c,
                                      bytes ? std::floor(out + 0.5) : out);
            }
    add_field_value(output, "anamorph:painted", texture.painted);
    add_field_value(output, "anamorph:unseen", texture.unseen);
}

vtkAnamorphProjectionBake::vtkAnamorphProjectionBake() : Poses(std::make_unique<Projectors>()) {
    this->SetNumberOfInputPorts(3);
}

vtkAnamorphProjectionBake::~vtkAnamorphProjectionBake() = default;

void vtkAnamorphProjectionBake::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "NumberOfProjectors: " << this->Poses->all.size() << "\n"
       << indent << "Projection: " << anamorph::name_of(anamorph::kProjections[this->Projection]) << "\n"
       << indent << "FieldOfView: " << this->FieldOfView << "\n"
       << indent << "Width: " << this->Width << "\n"
       << indent << "Height: " << this->Height << "\n"
       << indent << "Fade: " << this->Fade << "\n"
       << indent << "Margin: " << this->Margin << "\n"
       << indent << "Occlusion: " << this->Occlusion << "\n";
}

void vtkAnamorphProjectionBake::AddProjector(double x, double y, double z, double dx, double dy, double dz,
                                             double ux, double uy, double uz) {
    this->Poses->all.push_back({{x, y, z}, {dx, dy, dz}, {ux, uy, uz}});
    this->Modified();
}

void vtkAnamorphProjectionBake::RemoveAllProjectors() {
    if (this->Poses->all.empty()) return;
    this->Poses->all.clear();
    this->Modified();
}

int vtkAnamorphProjectionBake::GetNumberOfProjectors() {
    return static_cast<int>(this->Poses->all.size());
}

int vtkAnamorphProjectionBake::FillInputPortInformation(int port, vtkInformation* info) {
    info->Set(INPUT_REQUIRED_DATA_TYPE(), port == 1 ? "vtkImageData" : "vtkPolyData");
    if (port == 1) info->Set(INPUT_IS_REPEATABLE(), 1);
    if (port == 2) info->Set(INPUT_IS_OPTIONAL(), 1);
    return 1;
}

int vtkAnamorphProjectionBake::RequestInformation(vtkInformation*, vtkInformationVector**,
                                                  vtkInformationVector* outputs) {
    vtkInformation* info = outputs->GetInformationObject(0);
    const int extent[6] = {0, std::max(this->Width, 1) - 1, 0, std::max(this->Height, 1) - 1, 0, 0};
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
    return 1;
}

int vtkAnamorphProjectionBake::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                                   vtkInformationVector*) {
    using Pipeline = vtkStreamingDemandDrivenPipeline;
    // All of every panorama, whatever is asked for.
    for (int i = 0; i < inputs[1]->GetNumberOfInformationObjects(); ++i) {
        vtkInformation* info = inputs[1]->GetInformationObject(i);
        if (info->Has(Pipeline::WHOLE_EXTENT()))
            info->Set(Pipeline::UPDATE_EXTENT(), info->Get(Pipeline::WHOLE_EXTENT()), 6);
    }
    return 1;
}

int vtkAnamorphProjectionBake::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                           vtkInformationVector* outputs) {
    vtkImageData* output = vtkImageData::GetData(outputs);
    const auto execute = [&] {
        Run run{*this};
        run.options.size = {this->Width, this->Height};
        run.options.fade = this->Fade;
        run.options.margin = this->Margin;
        run.take_pictures(inputs[1]);
        const vtkSmartPointer<vtkPolyData> triangles = triangles_of(vtkPolyData::GetData(inputs[0]));
        run.take_mesh(triangles);
        if (this->Occlusion) run.cast_shadows(triangles, vtkPolyData::GetData(inputs[2]));
        run.hand_over(anamorph::bake(run.mesh, run.pictures, run.options, run.execution.stage(0, 1)), output);
    };
    return anamorph_vtk::guarded(this, execute, {output});
}
