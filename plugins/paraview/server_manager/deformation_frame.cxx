// SPDX-License-Identifier: Apache-2.0
#include "deformation_frame.h"

#include <algorithm>
#include <cmath>

#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkPVDataInformation.h"
#include "vtkSMAnamorphDeformProxy.h"
#include "vtkSMOutputPort.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"
#include "vtkSMVectorProperty.h"

namespace anamorph_paraview {

unsigned int columns_of(vtkSMProperty* deformations) {
    auto* vector = vtkSMVectorProperty::SafeDownCast(deformations);
    return vector ? static_cast<unsigned int>(vector->GetNumberOfElementsPerCommand()) : 0;
}

Point Frame::point(double u, double v, double t) const {
    Point p;
    for (unsigned int c = 0; c < 3; ++c) p[c] = origin[c] + u * axes[0][c] + v * axes[1][c] + t * axes[2][c];
    return p;
}

Point Frame::parameters(const Point& p) const {
    double columns[9], inverse[9];
    for (unsigned int row = 0; row < 3; ++row)
        for (unsigned int column = 0; column < 3; ++column) columns[3 * row + column] = axes[column][row];
    vtkMatrix3x3::Invert(columns, inverse);
    const double from_origin[3] = {p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]};
    Point parameters;
    vtkMatrix3x3::MultiplyPoint(inverse, from_origin, parameters.data());
    return parameters;
}

bool Frame::is_over(double u, double v, const Point& p) const {
    const double height = parameters(p)[2];
    const Point q = point(u, v, height);
    constexpr double kRounding = 1e-12;  // of the largest number that is added
    double largest = std::fabs(height), apart = 0;
    for (unsigned int c = 0; c < 3; ++c) {
        for (const double part : {p[c], origin[c], u * axes[0][c], v * axes[1][c]})
            largest = std::max(largest, std::fabs(part));
        apart = std::max(apart, std::fabs(p[c] - q[c]));
    }
    return apart <= kRounding * largest;
}

bool input_bounds(vtkSMProxy* deform, double bounds[6]) {
    vtkSMOutputPort* port = vtkSMPropertyHelper(deform, "Input", true).GetAsOutputPort();
    vtkPVDataInformation* information = port ? port->GetDataInformation() : nullptr;
    if (information == nullptr) return false;
    information->GetBounds(bounds);
    return vtkMath::AreBoundsInitialized(bounds);
}

namespace {

int toggle(vtkSMProxy* deform, const char* name) {
    return vtkSMPropertyHelper(deform, name, true).GetAsInt();
}

/// The axes given, and their unit normal.
std::optional<Frame> frame_along(const double* origin, const double* axis1, const double* axis2) {
    Frame frame;
    std::copy_n(origin, 3, frame.origin.begin());
    std::copy_n(axis1, 3, frame.axes[0].begin());
    std::copy_n(axis2, 3, frame.axes[1].begin());
    vtkMath::Cross(axis1, axis2, frame.axes[2].data());
    if (!(vtkMath::Normalize(frame.axes[2].data()) > 0)) return std::nullopt;
    return frame;
}

/// The plane of the last update, or else of the two directions that are longest.
std::optional<Frame> automatic_frame(vtkSMProxy* deform) {
    auto* proxy = vtkSMAnamorphDeformProxy::SafeDownCast(deform);
    if (const double* used = proxy ? proxy->GetUsedPlane() : nullptr)
        return frame_along(used, used + 3, used + 6);
    double bounds[6];
    if (!input_bounds(deform, bounds)) return std::nullopt;
    const auto length = [&](unsigned int c) { return bounds[2 * c + 1] - bounds[2 * c]; };
    unsigned int across = 2;
    for (const unsigned int c : {1u, 0u})
        if (length(c) < length(across)) across = c;
    double origin[3] = {}, axes[2][3] = {};
    origin[across] = bounds[2 * across] / 2 + bounds[2 * across + 1] / 2;
    unsigned int next = 0;
    for (unsigned int c = 0; c < 3; ++c)
        if (c != across) axes[next++][c] = 1;
    return frame_along(origin, axes[0], axes[1]);
}

}  // namespace

std::optional<Frame> frame_of(vtkSMProxy* deform) {
    if (toggle(deform, "ParameterMode") != 0) {
        auto* proxy = vtkSMAnamorphDeformProxy::SafeDownCast(deform);
        const double* used = proxy ? proxy->GetUsedPlane() : nullptr;
        return used ? frame_along(used, used + 3, used + 6) : std::nullopt;
    }
    if (toggle(deform, "AutomaticPlane") != 0) return automatic_frame(deform);
    double origin[3], axes[2][3];
    vtkSMPropertyHelper(deform, "Origin").Get(origin, 3);
    vtkSMPropertyHelper(deform, "Axis1").Get(axes[0], 3);
    vtkSMPropertyHelper(deform, "Axis2").Get(axes[1], 3);
    return frame_along(origin, axes[0], axes[1]);
}

}  // namespace anamorph_paraview
