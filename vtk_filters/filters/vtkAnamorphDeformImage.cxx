// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphDeformImage.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/deform/plane_warp.h"
#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"
#include "deformation_numbers.h"
#include "drawn_image.h"
#include "execution.h"
#include "vtkAnamorphDeformationList.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkImageInterpolator.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkObjectFactoryNewMacro(vtkAnamorphDeformImage);

namespace {

using Executive = vtkStreamingDemandDrivenPipeline;

/// An array as vtkImageInterpolator reads it: bits, and integers of 64 bits, which it does not, as double.
vtkSmartPointer<vtkDataArray> readable(vtkDataArray* from) {
    switch (from->GetDataType()) {
        case VTK_BIT:
        case VTK_LONG:
        case VTK_UNSIGNED_LONG:
        case VTK_LONG_LONG:
        case VTK_UNSIGNED_LONG_LONG:
        case VTK_ID_TYPE:
            break;
        default:
            return from;
    }
    auto numbers = vtkSmartPointer<vtkDoubleArray>::New();
    numbers->SetNumberOfComponents(from->GetNumberOfComponents());
    numbers->SetNumberOfTuples(from->GetNumberOfTuples());
    for (vtkIdType i = 0; i < from->GetNumberOfTuples(); ++i)
        for (int c = 0; c < from->GetNumberOfComponents(); ++c)
            numbers->SetComponent(i, c, from->GetComponent(i, c));
    return numbers;
}

/// An array of the input, how it is read between points, and the one that it makes.
struct Resampled {
    vtkNew<vtkImageData> image;  ///< with the array as its scalars
    vtkNew<vtkImageInterpolator> interpolator;
    vtkSmartPointer<vtkDataArray> to;
    double background;
    double least = 0, most = 0;  ///< of whole numbers
    bool whole;

    Resampled(vtkImageData* input, vtkDataArray* from, int interpolation, double empty, vtkIdType points)
        : background(empty) {
        image->CopyStructure(input);
        image->GetPointData()->SetScalars(readable(from));
        interpolator->SetInterpolationMode(interpolation);
        interpolator->SetOutValue(empty);
        // Of the distance of points: what rounding puts beyond the last one.
        interpolator->SetTolerance(1e-9);
        interpolator->Initialize(image);
        // Threads write next to each other, and eight bits share a byte.
        const bool is_bits = from->GetDataType() == VTK_BIT;
        to = vtkSmartPointer<vtkDataArray>::Take(is_bits ? vtkDataArray::CreateDataArray(VTK_UNSIGNED_CHAR)
                                                         : from->NewInstance());
        to->SetName(from->GetName());
        to->SetNumberOfComponents(from->GetNumberOfComponents());
        for (int c = 0; c < from->GetNumberOfComponents(); ++c)
            if (from->GetComponentName(c)) to->SetComponentName(c, from->GetComponentName(c));
        to->SetNumberOfTuples(points);
        whole = from->GetDataType() != VTK_FLOAT && from->GetDataType() != VTK_DOUBLE;
        least = is_bits ? 0 : from->GetDataTypeMin();
        most = is_bits ? 1 : from->GetDataTypeMax();
        if (most > 0x1p53) most = std::nextafter(most, 0);  // the largest double that the type still holds
    }

    /// place: the index in the input, not finite where there is none.
    void write(vtkIdType point, const glm::dvec3& place, std::vector<double>& room) {
        const int components = to->GetNumberOfComponents();
        room.assign(static_cast<std::size_t>(components), background);
        const double at[3] = {place.x, place.y, place.z};
        if (std::isfinite(place.x + place.y + place.z) && interpolator->CheckBoundsIJK(at))
            interpolator->InterpolateIJK(at, room.data());
        for (int c = 0; c < components; ++c) {
            double& value = room[static_cast<std::size_t>(c)];
            if (whole) value = std::isnan(value) ? 0 : std::clamp(std::nearbyint(value), least, most);
            to->SetComponent(point, c, value);
        }
    }
};

}  // namespace

vtkAnamorphDeformImage::vtkAnamorphDeformImage()
    : DeformationList(vtkSmartPointer<vtkAnamorphDeformationList>::New()) {}

vtkAnamorphDeformImage::~vtkAnamorphDeformImage() {
    this->SetFileName(nullptr);
}

void vtkAnamorphDeformImage::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    const auto write = [&](const char* name, const double* v) {
        os << indent << name << ": " << v[0] << " " << v[1] << " " << v[2] << "\n";
    };
    os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
    write("Origin", this->Origin);
    write("Axis1", this->Axis1);
    write("Axis2", this->Axis2);
    os << indent << "Inverse: " << this->Inverse << "\n"
       << indent << "Interpolation: "
       << (this->Interpolation == NEAREST  ? "Nearest"
           : this->Interpolation == LINEAR ? "Linear"
                                           : "Cubic")
       << "\n"
       << indent << "Background: " << this->Background << "\n"
       << indent << "NumberOfFailures: " << this->NumberOfFailures << "\n"
       << indent << "DeformationList:\n";
    this->DeformationList->PrintSelf(os, indent.GetNextIndent());
}

void vtkAnamorphDeformImage::SetDeformationList(vtkAnamorphDeformationList* list) {
    if (!list || list == this->DeformationList) return;
    this->DeformationList = list;
    this->Modified();
}
vtkAnamorphDeformationList* vtkAnamorphDeformImage::GetDeformationList() {
    return this->DeformationList;
}
void vtkAnamorphDeformImage::SetNumberOfDeformations(int number) {
    this->DeformationList->SetNumberOfDeformations(number);
}
int vtkAnamorphDeformImage::GetNumberOfDeformations() {
    return this->DeformationList->GetNumberOfDeformations();
}
int vtkAnamorphDeformImage::AddDeformation(double center_u, double center_v, double extent_u, double extent_v,
                                           double x, double y, double z, double kernel, double enabled) {
    return this->DeformationList->AddDeformation(center_u, center_v, extent_u, extent_v, x, y, z, kernel,
                                                 enabled);
}
void vtkAnamorphDeformImage::SetDeformation(int position, double center_u, double center_v, double extent_u,
                                            double extent_v, double x, double y, double z, double kernel,
                                            double enabled) {
    this->DeformationList->SetDeformation(position, center_u, center_v, extent_u, extent_v, x, y, z, kernel,
                                          enabled);
}

vtkMTimeType vtkAnamorphDeformImage::GetMTime() {
    return std::max(this->Superclass::GetMTime(), this->DeformationList->GetMTime());
}

vtkTypeBool vtkAnamorphDeformImage::ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                                                   vtkInformationVector* outputs) {
    if (!anamorph_vtk::has_inputs(this, {"the image"})) return 0;
    return this->Superclass::ProcessRequest(request, inputs, outputs);
}

int vtkAnamorphDeformImage::FillInputPortInformation(int, vtkInformation* info) {
    info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
    info->Set(INPUT_IS_OPTIONAL(), 1);  // has_inputs() tells of the image in our own words
    return 1;
}

int vtkAnamorphDeformImage::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                                vtkInformationVector*) {
    // Any part may come from anywhere.
    anamorph_vtk::ask_for_all({inputs, 1});
    return 1;
}

int vtkAnamorphDeformImage::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                        vtkInformationVector* outputs) {
    vtkImageData* output = vtkImageData::GetData(outputs);
    output->Initialize();
    this->NumberOfFailures = 0;
    return anamorph_vtk::guarded(this,
                                 [&] {
                                     int asked[6];
                                     outputs->GetInformationObject(0)->Get(Executive::UPDATE_EXTENT(), asked);
                                     this->Execute(vtkImageData::GetData(inputs[0]), asked, output);
                                 },
                                 {output});
}

void vtkAnamorphDeformImage::Execute(vtkImageData* input, const int* extent, vtkImageData* output) {
    if (input->GetNumberOfPoints() == 0) return;
    output->CopyStructure(input);
    output->GetFieldData()->PassData(input->GetFieldData());
    output->SetExtent(const_cast<int*>(extent));
    const auto vector = [](const double* v) { return glm::dvec3(v[0], v[1], v[2]); };
    const anamorph::ParameterPlane plane(vector(this->Origin), vector(this->Axis1), vector(this->Axis2));
    std::vector<anamorph_vtk::Numbers> list = this->DeformationList->GetAll();
    if (this->FileName && *this->FileName) {
        const auto more = anamorph_vtk::read_deformations(this->FileName);
        list.insert(list.end(), more.begin(), more.end());
    }
    const anamorph::MirrorSteps steps{plane.axis_u(), plane.gradient_u(), plane.axis_v(), plane.gradient_v()};
    const anamorph::PlaneWarp warp(plane, anamorph_vtk::checked_deformations(list, steps).list);
    if (!this->Inverse)
        if (const anamorph::Fold fold = warp.find_fold(); fold.answer == anamorph::FoldAnswer::found)
            vtkWarningMacro(<< "the deformations fold the plane at u="
                            << anamorph::shortest(fold.parameters.x)
                            << ", v=" << anamorph::shortest(fold.parameters.y)
                            << ": several points go to one, of which one is shown");

    const vtkIdType points = output->GetNumberOfPoints();
    std::vector<std::unique_ptr<Resampled>> arrays;
    vtkPointData* const from = input->GetPointData();
    for (int i = 0; i < from->GetNumberOfArrays(); ++i) {
        vtkDataArray* array = from->GetArray(i);
        if (!array ||
            (array->GetName() && std::string(array->GetName()) == vtkDataSetAttributes::GhostArrayName()))
            continue;
        arrays.push_back(
            std::make_unique<Resampled>(input, array, this->Interpolation, this->Background, points));
        const int at = output->GetPointData()->AddArray(arrays.back()->to);
        if (const int role = from->IsArrayAnAttribute(i); role >= 0)
            output->GetPointData()->SetActiveAttribute(at, role);
    }
    const vtkIdType columns = extent[1] - extent[0] + 1, rows = extent[3] - extent[2] + 1;
    std::atomic<vtkIdType> failures = 0;
    anamorph_vtk::Execution execution(this);
    execution.stage(0, 1)(columns > 0 ? points / columns : 0, [&](std::int64_t row) {
        std::vector<double> room;
        for (vtkIdType i = 0; i < columns; ++i) {
            const double index[3] = {static_cast<double>(extent[0] + i),
                                     static_cast<double>(extent[2] + row % rows),
                                     static_cast<double>(extent[4] + row / rows)};
            glm::dvec3 p, place;
            input->TransformContinuousIndexToPhysicalPoint(index, &p.x);
            if (this->Inverse) {
                p = warp.forward(p);
            } else {
                const anamorph::PlaneWarp::Inverse result = warp.inverse(p);
                p = result.found ? result.point : glm::dvec3(std::nan(""));
                if (!result.found) ++failures;
            }
            input->TransformPhysicalPointToContinuousIndex(&p.x, &place.x);
            for (const auto& array : arrays) array->write(row * columns + i, place, room);
        }
    });
    this->NumberOfFailures = failures;
    vtkNew<vtkDoubleArray> count;
    count->SetName("anamorph:failures");
    count->InsertNextValue(static_cast<double>(this->NumberOfFailures));
    output->GetFieldData()->AddArray(count);
}
