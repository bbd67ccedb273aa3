// SPDX-License-Identifier: Apache-2.0
#include "points_of_data.h"

#include "vtkCellArray.h"
#include "vtkDataSet.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(PointsOfData);

int PointsOfData::FillInputPortInformation(int, vtkInformation* information) {
    information->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
    return 1;
}

int PointsOfData::RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) {
    vtkDataSet* input = vtkDataSet::GetData(inputs[0]);
    vtkPolyData* output = vtkPolyData::GetData(outputs);
    const vtkIdType count = input->GetNumberOfPoints();
    if (count == 0) return 1;
    if (auto* points = vtkPointSet::SafeDownCast(input)) {
        output->SetPoints(points->GetPoints());
    } else {
        vtkNew<vtkPoints> own;
        own->SetDataType(VTK_DOUBLE);
        own->SetNumberOfPoints(count);
        for (vtkIdType i = 0; i < count; ++i) own->SetPoint(i, input->GetPoint(i));
        output->SetPoints(own);
    }
    vtkNew<vtkIdTypeArray> offsets, ids;
    offsets->SetNumberOfValues(count + 1);
    ids->SetNumberOfValues(count);
    for (vtkIdType i = 0; i < count; ++i) {
        offsets->SetValue(i, i);
        ids->SetValue(i, i);
    }
    offsets->SetValue(count, count);
    vtkNew<vtkCellArray> vertices;
    vertices->SetData(offsets, ids);
    output->SetVerts(vertices);
    output->GetPointData()->ShallowCopy(input->GetPointData());
    return 1;
}
