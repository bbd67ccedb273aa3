// SPDX-License-Identifier: Apache-2.0
#include "vtkSMAnamorphSourceProxy.h"

#include "vtkObjectFactory.h"
#include "vtkSMVectorProperty.h"

vtkStandardNewMacro(vtkSMAnamorphSourceProxy);

vtkSMAnamorphSourceProxy::vtkSMAnamorphSourceProxy() = default;
vtkSMAnamorphSourceProxy::~vtkSMAnamorphSourceProxy() = default;

void vtkSMAnamorphSourceProxy::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
}

void vtkSMAnamorphSourceProxy::SetPropertyModifiedFlag(const char* name, int flag) {
    this->Superclass::SetPropertyModifiedFlag(name, flag);
    if (flag != 0) this->Changed.insert(name);
}

void vtkSMAnamorphSourceProxy::UpdateVTKObjects() {
    std::set<std::string> changed;
    changed.swap(this->Changed);
    for (const std::string& name : changed) {
        auto* list = vtkSMVectorProperty::SafeDownCast(this->GetProperty(name.c_str()));
        if (!list || !list->GetRepeatCommand()) continue;
        const auto row = static_cast<unsigned int>(list->GetNumberOfElementsPerCommand());
        const unsigned int count = list->GetNumberOfElements();
        if (row > 1 && count % row != 0)
            vtkErrorMacro(<< name << " has " << count << " numbers: must be rows of " << row << "; the last "
                          << count % row << " are dropped");
    }
    this->Superclass::UpdateVTKObjects();
}
