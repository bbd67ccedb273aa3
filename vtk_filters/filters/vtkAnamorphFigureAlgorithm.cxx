// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphFigureAlgorithm.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "anamorph/error.h"
#include "anamorph/figure/body/figure_rows.h"
#include "anamorph/figure/body/rotation.h"
#include "anamorph/figure/outline/outline_view.h"
#include "anamorph/parameter/parameter.h"
#include "execution.h"
#include "figure_data.h"
#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkPolyData.h"

namespace {

using anamorph::Error;

/// Nothing is drawn that is nearer to the eye than this, as a share of the distance to the focal point.
constexpr double kNear = 1e-3;

glm::dvec3 point(const char* name, const double* v) {
    for (int k = 0; k < 3; ++k)
        if (!std::isfinite(v[k])) throw Error(name, anamorph::shortest(v[k]), "must be a finite number");
    return {v[0], v[1], v[2]};
}

}  // namespace

vtkAnamorphFigureAlgorithm::vtkAnamorphFigureAlgorithm() = default;
vtkAnamorphFigureAlgorithm::~vtkAnamorphFigureAlgorithm() = default;

anamorph::figure::View vtkAnamorphFigureAlgorithm::ViewOf(vtkPolyData* figures) const {
    for (const int size : this->ViewSize) anamorph::figure::kViewSizeRow.check(size, "ViewSize");
    const double height = this->ViewSize[1];
    if (this->ViewMode == SCRIPT) return anamorph_vtk::script_view(figures, height);
    const glm::dvec3 eye = point("CameraPosition", this->CameraPosition),
                     focus = point("CameraFocalPoint", this->CameraFocalPoint),
                     up = point("CameraViewUp", this->CameraViewUp);
    const double distance = glm::length(focus - eye);
    const glm::dvec3 away = (focus - eye) / distance, across = glm::cross(away, up);
    const glm::dvec3 right = across / glm::length(across);
    if (!std::isfinite(right.x + right.y + right.z))
        throw Error("the camera's position and focal point, and its view up, span no plane");
    anamorph::figure::View view;
    view.center = focus;
    // Rows: what becomes x, y and z.
    view.rotation = glm::transpose(glm::dmat3(right, glm::cross(right, away), away));
    if (this->CameraParallelProjection) {
        anamorph::figure::kParallelScaleRow.check(this->CameraParallelScale, "CameraParallelScale");
        view.scale = height / (2 * this->CameraParallelScale);
    } else {
        anamorph::figure::kViewAngleRow.check(this->CameraViewAngle, "CameraViewAngle");
        view.eye_distance = distance;
        view.near = kNear * distance;
        view.scale =
            height /
            (2 * std::tan(0.5 * this->CameraViewAngle * anamorph::figure::kRadiansPerDegree) * distance);
    }
    return view;
}

int vtkAnamorphFigureAlgorithm::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                            vtkInformationVector* outputs) {
    vtkPolyData* input = vtkPolyData::GetData(inputs[0]);
    vtkDataObject* output = vtkDataObject::GetData(outputs);
    const auto draw = [&] {
        anamorph_vtk::Execution execution(this);
        this->Draw(input, output, execution);
    };
    return anamorph_vtk::guarded(this, draw, {output});
}

void vtkAnamorphFigureAlgorithm::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    const auto print = [&](const char* name, const double* v) {
        os << indent << name << ": " << v[0] << " " << v[1] << " " << v[2] << "\n";
    };
    os << indent << "ViewMode: " << (this->ViewMode == SCRIPT ? "script" : "camera") << "\n"
       << indent << "ViewSize: " << this->ViewSize[0] << " " << this->ViewSize[1] << "\n";
    print("CameraPosition", this->CameraPosition);
    print("CameraFocalPoint", this->CameraFocalPoint);
    print("CameraViewUp", this->CameraViewUp);
    os << indent << "CameraParallelProjection: " << this->CameraParallelProjection << "\n"
       << indent << "CameraParallelScale: " << this->CameraParallelScale << "\n"
       << indent << "CameraViewAngle: " << this->CameraViewAngle << "\n";
}
