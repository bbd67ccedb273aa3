// SPDX-License-Identifier: Apache-2.0
// What the tests of the figure classes share.
#pragma once

#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "support.h"

/// Two bodies, joined, that move for four frames.
inline const std::string kTwoBodies =
    "figure f 2 a b\n"
    "ellipsoid a 10 40 20\n"
    "ellipsoid b 5 20 8\n"
    "joint j a 0 40 0 b 0 -20 0\n"
    "repeat 0 1 colour a 10 20 30\n"
    "repeat 0 1 texture b wood 3 4\n"
    "repeat 0 1 moveto f a 100 200 300\n"
    "repeat 0 1 bendby b j world 90 x\n"
    "linear 0 4 moveby f world 40 0 -8\n"
    "stop\n";

/// An ellipsoid in VTK's space. The turn need not be of unit length.
struct Ball {
    glm::dvec3 center, axes;
    glm::dquat turn;

    glm::dvec3 turned(const glm::dvec3& v) const { return glm::normalize(turn) * v; }
    glm::dvec3 turned_back(const glm::dvec3& v) const { return glm::inverse(glm::normalize(turn)) * v; }
};

/// Figures as vtkAnamorphFigureReader writes them, with the arrays that the filters read.
inline vtkSmartPointer<vtkPolyData> figures(const std::vector<Ball>& balls) {
    vtkNew<vtkPoints> points;
    points->SetDataType(VTK_DOUBLE);
    vtkNew<vtkDoubleArray> axes, turns;
    axes->SetName("Axes");
    axes->SetNumberOfComponents(3);
    turns->SetName("Orientation");
    turns->SetNumberOfComponents(4);
    for (const Ball& ball : balls) {
        points->InsertNextPoint(ball.center.x, ball.center.y, ball.center.z);
        axes->InsertNextTuple3(ball.axes.x, ball.axes.y, ball.axes.z);
        turns->InsertNextTuple4(ball.turn.w, ball.turn.x, ball.turn.y, ball.turn.z);
    }
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->GetPointData()->AddArray(axes);
    data->GetPointData()->AddArray(turns);
    return data;
}

/// The output that a filter makes of figures.
template <class Filter>
vtkSmartPointer<vtkPolyData> drawn(vtkPolyData* input, const std::function<void(Filter*)>& set = {}) {
    vtkNew<Filter> filter;
    filter->SetInputData(input);
    if (set) set(filter);
    filter->Update();
    return vtkPolyData::SafeDownCast(filter->GetOutputDataObject(0));
}

inline std::vector<double> cell_numbers(vtkPolyData* data, const char* name) {
    return numbers(data->GetCellData()->GetArray(name));
}
