// SPDX-License-Identifier: Apache-2.0
#include "vtkSMAnamorphHeightDomain.h"

#include <algorithm>
#include <cmath>

#include "vtkDataSetAttributes.h"
#include "vtkObjectFactory.h"
#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkPVDataSetAttributesInformation.h"
#include "vtkSMDoubleVectorProperty.h"
#include "vtkSMInputProperty.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMUncheckedPropertyHelper.h"

vtkStandardNewMacro(vtkSMAnamorphHeightDomain);

namespace {

constexpr double kShare = 0.1;  ///< of the plane's length

/// The distance from the least to the greatest height of an array, of a component, or at most of the luminance (-1), which is a mean of
/// the first three.
double range_of(vtkPVArrayInformation* heights, int component) {
    if (heights->GetDataType() != VTK_FLOAT && heights->GetDataType() != VTK_DOUBLE) return 1;
    const auto length = [&](int c) {
        const double* range = heights->GetComponentRange(c);
        return range[1] - range[0];
    };
    if (component >= heights->GetNumberOfComponents()) return 1;
    if (component >= 0 || heights->GetNumberOfComponents() < 3) return length(component < 0 ? 0 : component);
    return std::max({length(0), length(1), length(2)});
}

}  // namespace

vtkSMAnamorphHeightDomain::vtkSMAnamorphHeightDomain() = default;
vtkSMAnamorphHeightDomain::~vtkSMAnamorphHeightDomain() = default;

void vtkSMAnamorphHeightDomain::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
}

void vtkSMAnamorphHeightDomain::Update(vtkSMProperty*) {
    this->DomainModified();
}

/// The array that is the height: the one that is chosen, or the picture's scalars; null where there is none.
vtkPVArrayInformation* vtkSMAnamorphHeightDomain::Heights() {
    auto* input = vtkSMInputProperty::SafeDownCast(this->GetRequiredProperty("Input"));
    auto* source = input && input->GetNumberOfUncheckedProxies() > 0
                       ? vtkSMSourceProxy::SafeDownCast(input->GetUncheckedProxy(0))
                       : nullptr;
    vtkPVDataInformation* data =
        source ? source->GetDataInformation(input->GetUncheckedOutputPortForConnection(0)) : nullptr;
    if (!data) return nullptr;
    vtkPVDataSetAttributesInformation* points = data->GetPointDataInformation();
    if (vtkSMProperty* array = this->GetRequiredProperty("Array")) {
        vtkSMUncheckedPropertyHelper helper(array);
        const char* name = helper.GetInputArrayNameToProcess();
        if (name && *name) return points->GetArrayInformation(name);
    }
    return points->GetAttributeInformation(vtkDataSetAttributes::SCALARS);
}

int vtkSMAnamorphHeightDomain::SetDefaultValues(vtkSMProperty* property, bool use_unchecked_values) {
    auto* factor = vtkSMDoubleVectorProperty::SafeDownCast(property);
    vtkPVArrayInformation* heights = this->Heights();
    if (!factor || !heights) return this->Superclass::SetDefaultValues(property, use_unchecked_values);
    vtkSMProperty* component = this->GetRequiredProperty("Component");
    double range = range_of(heights, component ? vtkSMUncheckedPropertyHelper(component).GetAsInt() : -1);
    if (!(range > 0 && std::isfinite(kShare / range))) range = 1;
    if (use_unchecked_values)
        factor->SetUncheckedElement(0, kShare / range);
    else
        factor->SetElement(0, kShare / range);
    return 1;
}
