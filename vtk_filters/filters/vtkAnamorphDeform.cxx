// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphDeform.h"

#include "vtkDataObject.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkAnamorphDeform);
vtkAnamorphDeform::vtkAnamorphDeform() = default;
vtkAnamorphDeform::~vtkAnamorphDeform() = default;
int vtkAnamorphDeform::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                   vtkInformationVector* outputs) {
    vtkDataObject::GetData(outputs)->ShallowCopy(vtkDataObject::GetData(inputs[0]));
    return 1;
}
void vtkAnamorphDeform::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
}
