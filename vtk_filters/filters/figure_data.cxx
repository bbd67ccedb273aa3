// SPDX-License-Identifier: Apache-2.0
#include "figure_data.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <string>

#include "anamorph/error.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

namespace anamorph_vtk {
namespace {

using anamorph::Error;
using anamorph::figure::Body;
using anamorph::figure::FigureFrame;

constexpr const char *kAxes = "Axes", *kOrientation = "Orientation";

glm::dvec3 flipped(const glm::dvec3& p) {
    return {p.x, p.y, -p.z};
}

/// The same turn where z is negated: about the mirrored axis, the other way.
glm::dquat flipped(const glm::dquat& q) {
    return {q.w, -q.x, -q.y, q.z};
}

template <class Array>
Array* new_array(const char* name, int components, vtkIdType tuples, vtkFieldData* where) {
    vtkNew<Array> array;
    array->SetName(name);
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(tuples);
    where->AddArray(array);
    return array;
}

void set(vtkDoubleArray* array, vtkIdType i, const glm::dvec3& v) {
    array->SetTuple3(i, v.x, v.y, v.z);
}

void write_joints(const FigureFrame& frame, vtkFieldData* field) {
    const auto count = static_cast<vtkIdType>(frame.joints.size());
    auto* bodies = new_array<vtkIdTypeArray>("JointBodies", 2, count, field);
    auto* positions = new_array<vtkDoubleArray>("JointPosition", 3, count, field);
    auto* names = new_array<vtkStringArray>("JointName", 1, count, field);
    for (vtkIdType k = 0; k < count; ++k) {
        const anamorph::figure::Joint& joint = frame.joints[static_cast<std::size_t>(k)];
        bodies->SetTypedComponent(k, 0, joint.first);
        bodies->SetTypedComponent(k, 1, joint.second);
        set(positions, k, flipped(joint.position));
        names->SetValue(k, joint.name);
    }
}

void write_view(const FigureFrame& frame, vtkFieldData* field) {
    set(new_array<vtkDoubleArray>("ViewCenter", 3, 1, field), 0, flipped(frame.place));
    auto* rotation = new_array<vtkDoubleArray>("ViewRotation", 9, 1, field);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            rotation->SetTypedComponent(0, 3 * row + column,
                                        (column == 2 ? -1 : 1) * frame.observer[column][row]);
}

/// An array of the field with so many components, or null.
vtkDataArray* field_array(vtkPolyData* data, const char* name, int components) {
    vtkDataArray* array = data->GetFieldData()->GetArray(name);
    return array && array->GetNumberOfComponents() == components ? array : nullptr;
}

vtkDataArray* point_array(vtkPolyData* data, const char* name, int components) {
    vtkDataArray* array = data->GetPointData()->GetArray(name);
    if (!array)
        throw Error(std::string("the input has no array \"") + name +
                    "\" of its points: it is no figure of vtkAnamorphFigureReader");
    if (array->GetNumberOfComponents() != components)
        throw Error(std::string("the array \"") + name + "\" has " +
                    std::to_string(array->GetNumberOfComponents()) + " components, but must have " +
                    std::to_string(components));
    if (array->GetNumberOfTuples() != data->GetNumberOfPoints())
        throw Error(std::string("the array \"") + name + "\" has " +
                    std::to_string(array->GetNumberOfTuples()) + " tuples, but must have " +
                    std::to_string(data->GetNumberOfPoints()));
    return array;
}

bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

void write_figures(const FigureFrame& frame, bool joints, int precision, vtkPolyData* output) {
    const auto count = static_cast<vtkIdType>(frame.bodies.size());
    vtkNew<vtkPoints> points;
    points->SetDataType(precision == 1 ? VTK_DOUBLE : VTK_FLOAT);
    points->SetNumberOfPoints(count);
    vtkPointData* data = output->GetPointData();
    auto* axes = new_array<vtkDoubleArray>(kAxes, 3, count, data);
    auto* orientation = new_array<vtkDoubleArray>(kOrientation, 4, count, data);
    auto* color = new_array<vtkUnsignedCharArray>("Color", 3, count, data);
    auto* texture = new_array<vtkStringArray>("Texture", 1, count, data);
    auto* offset = new_array<vtkDoubleArray>("TextureOffset", 2, count, data);
    auto* name = new_array<vtkStringArray>("Name", 1, count, data);
    auto* figure = new_array<vtkStringArray>("Figure", 1, count, data);
    vtkNew<vtkCellArray> vertices, lines;
    for (vtkIdType i = 0; i < count; ++i) {
        const Body& body = frame.bodies[static_cast<std::size_t>(i)];
        const glm::dvec3 center = flipped(body.shape.center);
        points->SetPoint(i, center.x, center.y, center.z);
        set(axes, i, body.shape.axes);
        const glm::dquat turn = flipped(glm::quat_cast(body.shape.rotation));
        orientation->SetTuple4(i, turn.w, turn.x, turn.y, turn.z);
        for (int k = 0; k < 3; ++k)
            color->SetTypedComponent(
                i, k, static_cast<unsigned char>(std::lround(glm::clamp(body.color[k], 0.0, 255.0))));
        texture->SetValue(i, body.texture);
        offset->SetTuple2(i, body.texture_offset.x, body.texture_offset.y);
        name->SetValue(i, body.name);
        const auto f = static_cast<std::size_t>(body.figure);
        figure->SetValue(i, f < frame.figures.size() ? frame.figures[f] : std::string());
        vertices->InsertNextCell(1, &i);
    }
    if (joints)
        for (const anamorph::figure::Joint& joint : frame.joints) {
            const vtkIdType ends[2] = {joint.first, joint.second};
            lines->InsertNextCell(2, ends);
        }
    output->SetPoints(points);
    output->SetVerts(vertices);
    output->SetLines(lines);
    data->SetActiveScalars("Color");
    write_joints(frame, output->GetFieldData());
    write_view(frame, output->GetFieldData());
}

FigureData::FigureData(vtkPolyData* data) : m_data(data), m_size(data->GetNumberOfPoints()) {
    if (m_size == 0) return;
    m_axes = point_array(data, kAxes, 3);
    m_orientation = point_array(data, kOrientation, 4);
    m_ghosts = data->GetPointGhostArray();
    if (m_ghosts && m_ghosts->GetNumberOfTuples() != m_size) m_ghosts = nullptr;
}

std::optional<anamorph::figure::Ellipsoid> FigureData::ellipsoid(vtkIdType i) const {
    if (m_ghosts && (m_ghosts->GetValue(i) & vtkDataSetAttributes::HIDDENPOINT) != 0) return std::nullopt;
    anamorph::figure::Ellipsoid shape;
    double center[3], q[4];
    m_data->GetPoint(i, center);
    m_axes->GetTuple(i, &shape.axes.x);
    m_orientation->GetTuple(i, q);
    shape.center = {center[0], center[1], center[2]};
    shape.axes = glm::abs(shape.axes);
    const glm::dquat turn(q[0], q[1], q[2], q[3]);
    const double length = glm::length(turn);
    if (!is_finite(shape.center) || !is_finite(shape.axes) || !(length > 0) || !std::isfinite(length))
        return std::nullopt;
    shape.rotation = glm::mat3_cast(turn / length);
    return shape;
}

void allocate_cell_data(vtkPolyData* input, vtkIdType cells, vtkCellData* data) {
    vtkPointData* points = input->GetPointData();
    for (int i = 0; i < points->GetNumberOfArrays(); ++i) {
        const char* name = points->GetArrayName(i);
        if (name && points->GetAbstractArray(i)->GetNumberOfTuples() != input->GetNumberOfPoints())
            data->CopyFieldOff(name);
    }
    for (const char* name : {kAxes, kOrientation}) data->CopyFieldOff(name);
    data->CopyAllocate(points, cells);
}

std::vector<anamorph::figure::Joint> joints_of(vtkPolyData* data) {
    std::vector<anamorph::figure::Joint> joints;
    vtkDataArray *bodies = field_array(data, "JointBodies", 2),
                 *positions = field_array(data, "JointPosition", 3);
    if (!bodies || !positions || bodies->GetNumberOfTuples() != positions->GetNumberOfTuples()) return joints;
    for (vtkIdType k = 0; k < bodies->GetNumberOfTuples(); ++k) {
        const double first = bodies->GetComponent(k, 0), second = bodies->GetComponent(k, 1);
        const auto count = static_cast<double>(data->GetNumberOfPoints());
        if (!(first >= 0 && first < count && second >= 0 && second < count)) continue;
        anamorph::figure::Joint joint;
        joint.first = static_cast<int>(first);
        joint.second = static_cast<int>(second);
        positions->GetTuple(k, &joint.position.x);
        joints.push_back(joint);
    }
    return joints;
}

anamorph::figure::View script_view(vtkPolyData* data, double height) {
    anamorph::figure::View view;
    view.scale = height / 1000;
    view.center = {500, 500, -500};
    view.rotation[2][2] = -1;
    if (vtkDataArray* center = field_array(data, "ViewCenter", 3); center && center->GetNumberOfTuples() > 0)
        center->GetTuple(0, &view.center.x);
    if (vtkDataArray* rotation = field_array(data, "ViewRotation", 9);
        rotation && rotation->GetNumberOfTuples() > 0)
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                view.rotation[column][row] = rotation->GetComponent(0, 3 * row + column);
    return view;
}

}  // namespace anamorph_vtk
