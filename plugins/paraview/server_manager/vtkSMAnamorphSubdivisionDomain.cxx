// SPDX-License-Identifier: Apache-2.0
#include "vtkSMAnamorphSubdivisionDomain.h"

#include "vtkObjectFactory.h"
#include "vtkSMAnamorphDeformProxy.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"

vtkStandardNewMacro(vtkSMAnamorphSubdivisionDomain);

vtkSMAnamorphSubdivisionDomain::vtkSMAnamorphSubdivisionDomain() = default;
vtkSMAnamorphSubdivisionDomain::~vtkSMAnamorphSubdivisionDomain() = default;

void vtkSMAnamorphSubdivisionDomain::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
}

int vtkSMAnamorphSubdivisionDomain::SetDefaultValues(vtkSMProperty* property, bool use_unchecked_values) {
    auto* deform = vtkSMAnamorphDeformProxy::SafeDownCast(property->GetParent());
    if (!deform) return 0;
    const int subdivisions = deform->DefaultSubdivisions();
    if (subdivisions == 0) return 0;
    vtkSMPropertyHelper helper(property);
    helper.SetUseUnchecked(use_unchecked_values);
    helper.Set(subdivisions);
    return 1;
}
