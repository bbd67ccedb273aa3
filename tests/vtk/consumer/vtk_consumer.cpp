// SPDX-License-Identifier: Apache-2.0
#include <vtkAnamorphDeform.h>
#include <vtkNew.h>
#include <vtkPlaneSource.h>
#include <vtkPolyData.h>

int main() {
    vtkNew<vtkPlaneSource> plane;
    vtkNew<vtkAnamorphDeform> deform;
    deform->SetInputConnection(plane->GetOutputPort());
    deform->AddDeformation(-0.5, -0.5, 0.1, 0.1, 0, 0, 2);  // on a corner
    deform->Update();
    return deform->GetPolyDataOutput()->GetPoint(0)[2] == 2 ? 0 : 1;
}
