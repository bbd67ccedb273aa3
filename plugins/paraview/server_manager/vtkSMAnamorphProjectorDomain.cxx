// SPDX-License-Identifier: Apache-2.0
#include "vtkSMAnamorphProjectorDomain.h"

#include <cmath>

#include "deformation_frame.h"
#include "vtkObjectFactory.h"
#include "vtkPVXMLElement.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"

vtkStandardNewMacro(vtkSMAnamorphProjectorDomain);

vtkSMAnamorphProjectorDomain::vtkSMAnamorphProjectorDomain() = default;
vtkSMAnamorphProjectorDomain::~vtkSMAnamorphProjectorDomain() = default;

void vtkSMAnamorphProjectorDomain::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "Of: " << this->Of << "\n";
}

int vtkSMAnamorphProjectorDomain::ReadXMLAttributes(vtkSMProperty* property, vtkPVXMLElement* element) {
    if (const char* of = element->GetAttribute("of")) this->Of = of;
    return this->Superclass::ReadXMLAttributes(property, element);
}

int vtkSMAnamorphProjectorDomain::SetDefaultValues(vtkSMProperty* property, bool use_unchecked_values) {
    double bounds[6];
    if (!anamorph_paraview::input_bounds(property->GetParent(), bounds)) return 0;
    double center[3], diagonal = 0;
    int across = 0;
    for (int i = 0; i < 3; ++i) {
        const double length = bounds[2 * i + 1] - bounds[2 * i];
        center[i] = bounds[2 * i] / 2 + bounds[2 * i + 1] / 2;
        diagonal = std::hypot(diagonal, length);
        if (length <= bounds[2 * across + 1] - bounds[2 * across]) across = i;
    }
    constexpr double kFlat = 1e-4;  // of the diagonal
    const bool flat = bounds[2 * across + 1] - bounds[2 * across] <= kFlat * diagonal;
    vtkSMPropertyHelper helper(property);
    helper.SetUseUnchecked(use_unchecked_values);
    if (this->Of == "Position") {
        if (flat) center[across] += diagonal > 0 ? diagonal / 2 : 1;
        helper.Set(center, 3);
        return 1;
    }
    if (!flat) return 0;
    double vector[3] = {0, 0, 0};
    if (this->Of == "Direction")
        vector[across] = -1;
    else
        vector[across == 1 ? 2 : 1] = 1;
    helper.Set(vector, 3);
    return 1;
}
