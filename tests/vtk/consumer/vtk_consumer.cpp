// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphDeform.h>
#include <vtkNew.h>
#include <vtkPlaneSource.h>
#include <vtkPolyData.h>

int main() {
    vtkNew<vtkPlaneSource> plane;
    vtkNew<vtkAnamorphDeform> deform;
    deform->SetInputConnection(plane->GetOutputPort());
    deform->Update();
    return deform->GetPolyDataOutput()->GetNumberOfPoints() == 4 ? 0 : 1;
}
