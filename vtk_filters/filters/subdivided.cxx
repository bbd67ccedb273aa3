// SPDX-License-Identifier: Apache-2.0
#include "subdivided.h"

#include <cmath>
#include <limits>
#include <string>

#include "anamorph/error.h"
#include "cell_corners.h"
#include "error_texts.h"
#include "vtkFieldData.h"
#include "vtkLinearSubdivisionFilter.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkTriangleFilter.h"

namespace anamorph_vtk {

bool has_polygons_alone(vtkPointSet* mesh) {
    auto* surface = vtkPolyData::SafeDownCast(mesh);
    return surface && surface->GetNumberOfVerts() == 0 && surface->GetNumberOfLines() == 0;
}

vtkSmartPointer<vtkPointSet> subdivided(vtkPointSet* mesh, int times) {
    const auto refuse = [&](const std::string& why) {
        throw anamorph::Error("Subdivisions", std::to_string(times), why);
    };
    if (!has_polygons_alone(mesh)) refuse("the surface must be of polygons alone, or Subdivisions 0");
    check_corners(mesh);
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputData(mesh);
    triangles->Update();
    vtkPolyData* const cut = triangles->GetOutput();
    const double count = static_cast<double>(cut->GetNumberOfPolys()) * std::pow(4.0, times);
    if (count > std::numeric_limits<std::int32_t>::max() / 2.0)
        refuse("the surface would have more than 2^30 triangles");
    vtkNew<vtkPolyData> made;
    if (cut->GetNumberOfPolys() == 0) {
        made->ShallowCopy(cut);
        return made;
    }
    vtkNew<vtkLinearSubdivisionFilter> filter;
    const ErrorTexts errors(filter);
    filter->SetInputData(cut);
    filter->SetNumberOfSubdivisions(times);
    filter->Update();
    made->ShallowCopy(filter->GetOutput());
    if (errors.any() || static_cast<double>(made->GetNumberOfPolys()) != count)
        refuse(
            "no edge of the surface must be of more than two triangles (Clean to Grid and Extract Surface "
            "mend some)" +
            errors.text());
    // What the whole has stays.
    vtkNew<vtkFieldData> fields;
    if (vtkFieldData* of_all = mesh->GetFieldData()) fields->PassData(of_all);
    made->SetFieldData(fields);
    return made;
}

}  // namespace anamorph_vtk
