// SPDX-License-Identifier: Apache-2.0
#include "attribute_fields.h"

#include <string>
#include <variant>

#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkStringArray.h"

namespace anamorph_vtk {

void add_field(const anamorph::Attribute& attribute, vtkDataObject* output) {
    const auto add = [&](const auto& array, const auto& value) {
        array->SetName(attribute.name.c_str());
        array->InsertNextValue(value);
        output->GetFieldData()->AddArray(array);
    };
    if (const auto* text = std::get_if<std::string>(&attribute.value))
        add(vtkNew<vtkStringArray>(), *text);
    else if (const auto* number = std::get_if<double>(&attribute.value))
        add(vtkNew<vtkDoubleArray>(), *number);
    else
        add(vtkNew<vtkIntArray>(), std::get<int>(attribute.value));
}

}  // namespace anamorph_vtk
