// SPDX-License-Identifier: Apache-2.0
#include "vtkSMAnamorphDeformationDomain.h"

#include <vector>

#include "vtkObjectFactory.h"
#include "vtkSMAnamorphDeformProxy.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"

vtkStandardNewMacro(vtkSMAnamorphDeformationDomain);

vtkSMAnamorphDeformationDomain::vtkSMAnamorphDeformationDomain() = default;
vtkSMAnamorphDeformationDomain::~vtkSMAnamorphDeformationDomain() = default;

void vtkSMAnamorphDeformationDomain::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
}

int vtkSMAnamorphDeformationDomain::SetDefaultValues(vtkSMProperty* property, bool use_unchecked_values) {
    auto* deform = vtkSMAnamorphDeformProxy::SafeDownCast(property->GetParent());
    if (!deform) return 0;
    const std::vector<double> row = deform->DefaultRow(property);
    if (row.empty()) return 0;
    vtkSMPropertyHelper helper(property);
    helper.SetUseUnchecked(use_unchecked_values);
    deform->SetDefault([&] { helper.Set(row.data(), static_cast<unsigned int>(row.size())); });
    return 1;
}
