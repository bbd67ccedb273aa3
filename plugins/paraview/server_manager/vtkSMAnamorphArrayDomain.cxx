// SPDX-License-Identifier: Apache-2.0
#include "vtkSMAnamorphArrayDomain.h"

#include <algorithm>
#include <sstream>
#include <string>
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
    std::istringstream counts(element->GetAttributeOrEmpty("number_of_components"));
    for (std::string count; std::getline(counts, count, ',');)
        this->ComponentCounts.push_back(std::stoi(count));
    return 1;
}

int vtkSMAnamorphArrayDomain::IsInDomain(vtkSMProperty* property) {
    auto* inputs = vtkSMInputProperty::SafeDownCast(property);
    if (!inputs) return NOT_IN_DOMAIN;
    for (unsigned int i = 0; i < inputs->GetNumberOfUncheckedProxies(); ++i) {
        auto* source = vtkSMSourceProxy::SafeDownCast(inputs->GetUncheckedProxy(i));
        if (!source) return NOT_IN_DOMAIN;
        vtkPVDataInformation* data =
            source->GetDataInformation(inputs->GetUncheckedOutputPortForConnection(i));
        if (!data) return NOT_IN_DOMAIN;
        vtkPVDataSetAttributesInformation* points = data->GetPointDataInformation();
        vtkPVArrayInformation* array = this->ArrayName.empty()
                                           ? points->GetAttributeInformation(vtkDataSetAttributes::TCOORDS)
                                           : points->GetArrayInformation(this->ArrayName.c_str());
        const std::vector<int>& counts = this->ComponentCounts;
        if (!array || std::find(counts.begin(), counts.end(), array->GetNumberOfComponents()) == counts.end())
            return NOT_IN_DOMAIN;
    }
    return IN_DOMAIN;
}
