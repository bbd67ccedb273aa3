// SPDX-License-Identifier: Apache-2.0
#include "vtkSMAnamorphSliceDomain.h"

#include "vtkObjectFactory.h"
#include "vtkPVDataInformation.h"
#include "vtkSMInputProperty.h"
#include "vtkSMSourceProxy.h"

vtkStandardNewMacro(vtkSMAnamorphSliceDomain);

vtkSMAnamorphSliceDomain::vtkSMAnamorphSliceDomain() = default;
vtkSMAnamorphSliceDomain::~vtkSMAnamorphSliceDomain() = default;

void vtkSMAnamorphSliceDomain::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
}

int vtkSMAnamorphSliceDomain::IsInDomain(vtkSMProperty* property) {
    auto* inputs = vtkSMInputProperty::SafeDownCast(property);
    if (!inputs) return NOT_IN_DOMAIN;
    for (unsigned int i = 0; i < inputs->GetNumberOfUncheckedProxies(); ++i) {
        auto* source = vtkSMSourceProxy::SafeDownCast(inputs->GetUncheckedProxy(i));
        vtkPVDataInformation* data =
            source ? source->GetDataInformation(inputs->GetUncheckedOutputPortForConnection(i)) : nullptr;
        const int* extent = data ? data->GetExtent() : nullptr;
        if (extent && extent[4] < extent[5]) return NOT_IN_DOMAIN;
    }
    return IN_DOMAIN;
}
