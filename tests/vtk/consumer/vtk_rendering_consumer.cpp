// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphEllipsoidMapper.h>
#include <vtkDoubleArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

int main() {
    vtkNew<vtkPoints> points;
    points->InsertNextPoint(1, 2, 3);
    vtkNew<vtkDoubleArray> axes;
    axes->SetName("Half");
    axes->SetNumberOfComponents(3);
    axes->InsertNextTuple3(4, 5, 6);
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->GetPointData()->AddArray(axes);
    vtkNew<vtkAnamorphEllipsoidMapper> mapper;  // needs no display until it draws
    mapper->SetInputData(data);
    mapper->SetAxesArray("Half");
    mapper->SetOrientationArray("");
    return mapper->GetBounds()[5] == 9 ? 0 : 1;
}
