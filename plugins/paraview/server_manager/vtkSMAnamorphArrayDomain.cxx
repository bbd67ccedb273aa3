// SPDX-License-Identifier: Apache-2.0
#include "vtkSMAnamorphArrayDomain.h"

#include <algorithm>
#include <vector>

#include "vtkDataSetAttributes.h"
#include "vtkObjectFactory.h"
#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkPVDataSetAttributesInformation.h"
#include "vtkPVXMLElement.h"
#include "vtkSMInputProperty.h"
#include "vtkSMSourceProxy.h"

vtkStandardNewMacro(vtkSMAnamorphArrayDomain);

vtkSMAnamorphArrayDomain::vtkSMAnamorphArrayDomain() = default;
vtkSMAnamorphArrayDomain::~vtkSMAnamorphArrayDomain() = default;

void vtkSMAnamorphArrayDomain::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "ArrayName: " << (this->ArrayName.empty() ? "(texture coordinates)" : this->ArrayName)
       << "\n";
}

int vtkSMAnamorphArrayDomain::ReadXMLAttributes(vtkSMProperty* property, vtkPVXMLElement* element) {
    if (!this->Superclass::ReadXMLAttributes(property, element)) return 0;
    const char* name = element->GetAttribute("array_name");
    int texture = 0;
    element->GetScalarAttribute("active_tcoords", &texture);
    if (!name && !texture) {
        vtkErrorMacro("array_name is not given: must be the name of an array");
        return 0;
    }
    this->ArrayName = name ? name : "";
    return 1;
}

int vtkSMAnamorphArrayDomain::IsInDomain(vtkSMProperty* property) {
    if (!this->Superclass::IsInDomain(property)) return NOT_IN_DOMAIN;
    auto* inputs = vtkSMInputProperty::SafeDownCast(property);
    if (!inputs) return NOT_IN_DOMAIN;
    const std::vector<int> components = this->GetAcceptableNumbersOfComponents();
    for (unsigned int i = 0; i < inputs->GetNumberOfUncheckedProxies(); ++i) {
        auto* source = vtkSMSourceProxy::SafeDownCast(inputs->GetUncheckedProxy(i));
        if (!source) return NOT_IN_DOMAIN;
        vtkPVDataInformation* data =
            source->GetDataInformation(inputs->GetUncheckedOutputPortForConnection(i));
        vtkPVArrayInformation* array = nullptr;
        if (data && this->ArrayName.empty())
            array = data->GetPointDataInformation()->GetAttributeInformation(vtkDataSetAttributes::TCOORDS);
        else if (data)
            array = data->GetArrayInformation(this->ArrayName.c_str(), this->GetAttributeType());
        const auto fits = [&](int count) { return count == 0 || count == array->GetNumberOfComponents(); };
        if (!array || !(components.empty() || std::any_of(components.begin(), components.end(), fits)))
            return NOT_IN_DOMAIN;
    }
    return IN_DOMAIN;
}
