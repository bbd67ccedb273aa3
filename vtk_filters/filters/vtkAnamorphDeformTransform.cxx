// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphDeformTransform.h"

#include <algorithm>
#include <atomic>
#include <optional>

#include "anamorph/deform/plane_warp.h"
#include "anamorph/error.h"
#include "deformation_numbers.h"
#include "vtkAnamorphDeformationList.h"
#include "vtkObjectFactory.h"

vtkObjectFactoryNewMacro(vtkAnamorphDeformTransform);

struct vtkAnamorphDeformTransform::Map {
    anamorph::PlaneWarp warp;
    std::optional<anamorph::Fold> fold;  ///< once it was looked for
    std::atomic<vtkIdType> failures = 0;

    glm::dvec3 inverse(glm::dvec3 q) {
        const anamorph::PlaneWarp::Inverse result = warp.inverse(q);
        if (!result.found) ++failures;
        return result.point;
    }
};

namespace {

template <class T>
glm::dvec3 vector(const T* v) {
    return {v[0], v[1], v[2]};
}

template <class T>
void put(glm::dvec3 v, T* out) {
    for (int c = 0; c < 3; ++c) out[c] = static_cast<T>(v[c]);
}

template <class T>
void put(const glm::dmat3& jacobian, T (*derivative)[3]) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) derivative[i][j] = static_cast<T>(jacobian[j][i]);
}

}  // namespace

vtkAnamorphDeformTransform::vtkAnamorphDeformTransform()
    : DeformationList(vtkSmartPointer<vtkAnamorphDeformationList>::New()), Warp(std::make_unique<Map>()) {}

vtkAnamorphDeformTransform::~vtkAnamorphDeformTransform() = default;

void vtkAnamorphDeformTransform::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    const auto write = [&](const char* name, const double* v) {
        os << indent << name << ": " << v[0] << " " << v[1] << " " << v[2] << "\n";
    };
    write("Origin", this->Origin);
    write("Axis1", this->Axis1);
    write("Axis2", this->Axis2);
    os << indent << "FoldParameters: " << this->FoldParameters[0] << " " << this->FoldParameters[1] << "\n"
       << indent << "NumberOfFailures: " << this->GetNumberOfFailures() << "\n"
       << indent << "DeformationList:\n";
    this->DeformationList->PrintSelf(os, indent.GetNextIndent());
}

void vtkAnamorphDeformTransform::SetDeformationList(vtkAnamorphDeformationList* list) {
    if (!list || list == this->DeformationList) return;
    this->DeformationList = list;
    this->Modified();
}

vtkAnamorphDeformationList* vtkAnamorphDeformTransform::GetDeformationList() {
    return this->DeformationList;
}

vtkMTimeType vtkAnamorphDeformTransform::GetMTime() {
    return std::max(this->Superclass::GetMTime(), this->DeformationList->GetMTime());
}

vtkAbstractTransform* vtkAnamorphDeformTransform::MakeTransform() {
    return vtkAnamorphDeformTransform::New();
}

void vtkAnamorphDeformTransform::InternalDeepCopy(vtkAbstractTransform* transform) {
    auto* other = static_cast<vtkAnamorphDeformTransform*>(transform);
    this->SetOrigin(other->Origin);
    this->SetAxis1(other->Axis1);
    this->SetAxis2(other->Axis2);
    if (this->DeformationList != other->DeformationList)
        this->DeformationList->DeepCopy(other->DeformationList);
    this->SetInverseTolerance(other->InverseTolerance);
    this->SetInverseIterations(other->InverseIterations);
    if (this->InverseFlag != other->InverseFlag) {
        this->InverseFlag = other->InverseFlag;
        this->Modified();
    }
}

void vtkAnamorphDeformTransform::InternalUpdate() {
    auto map = std::make_unique<Map>();
    try {
        const anamorph::ParameterPlane plane(vector(this->Origin), vector(this->Axis1), vector(this->Axis2));
        const anamorph::MirrorSteps steps{plane.axis_u(), plane.gradient_u(), plane.axis_v(),
                                          plane.gradient_v()};
        map->warp = {plane, anamorph_vtk::checked_deformations(this->DeformationList->GetAll(), steps).list};
    } catch (const std::exception& error) {
        vtkErrorMacro(<< error.what() << "; nothing is moved");
    }
    this->Warp = std::move(map);
    if (this->InverseFlag == 0) return;
    this->Warp->fold = this->Warp->warp.find_fold();
    if (this->Warp->fold->answer == anamorph::FoldAnswer::found)
        vtkWarningMacro(<< "the deformations fold the plane at u=" << this->Warp->fold->parameters.x
                        << ", v=" << this->Warp->fold->parameters.y << ": there is no single inverse");
}

int vtkAnamorphDeformTransform::GetFold() {
    this->Update();
    std::optional<anamorph::Fold>& fold = this->Warp->fold;
    if (!fold) fold = this->Warp->warp.find_fold();
    this->FoldParameters[0] = fold->parameters.x;
    this->FoldParameters[1] = fold->parameters.y;
    switch (fold->answer) {
        case anamorph::FoldAnswer::none:
            return NO_FOLD;
        case anamorph::FoldAnswer::found:
            return FOLD;
        default:
            return UNDECIDED;
    }
}

vtkIdType vtkAnamorphDeformTransform::GetNumberOfFailures() {
    return this->Warp->failures;
}

void vtkAnamorphDeformTransform::ForwardTransformPoint(const double in[3], double out[3]) {
    put(this->Warp->warp.forward(vector(in)), out);
}
void vtkAnamorphDeformTransform::ForwardTransformPoint(const float in[3], float out[3]) {
    put(this->Warp->warp.forward(vector(in)), out);
}
void vtkAnamorphDeformTransform::ForwardTransformDerivative(const double in[3], double out[3],
                                                            double derivative[3][3]) {
    const glm::dvec3 p = vector(in);
    put(this->Warp->warp.forward(p), out);
    put(this->Warp->warp.jacobian(p), derivative);
}
void vtkAnamorphDeformTransform::ForwardTransformDerivative(const float in[3], float out[3],
                                                            float derivative[3][3]) {
    const glm::dvec3 p = vector(in);
    put(this->Warp->warp.forward(p), out);
    put(this->Warp->warp.jacobian(p), derivative);
}
void vtkAnamorphDeformTransform::InverseTransformPoint(const double in[3], double out[3]) {
    put(this->Warp->inverse(vector(in)), out);
}
void vtkAnamorphDeformTransform::InverseTransformPoint(const float in[3], float out[3]) {
    put(this->Warp->inverse(vector(in)), out);
}
// As vtkWarpTransform has it: the derivative is that of the forward transform, at the result.
void vtkAnamorphDeformTransform::InverseTransformDerivative(const double in[3], double out[3],
                                                            double derivative[3][3]) {
    const glm::dvec3 p = this->Warp->inverse(vector(in));
    put(p, out);
    put(this->Warp->warp.jacobian(p), derivative);
}
void vtkAnamorphDeformTransform::InverseTransformDerivative(const float in[3], float out[3],
                                                            float derivative[3][3]) {
    const glm::dvec3 p = this->Warp->inverse(vector(in));
    put(p, out);
    put(this->Warp->warp.jacobian(p), derivative);
}
