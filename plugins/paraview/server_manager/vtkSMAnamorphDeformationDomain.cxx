// SPDX-License-Identifier: Apache-2.0
#include "vtkSMAnamorphDeformationDomain.h"

#include <cmath>
#include <vector>

#include "deformation_frame.h"
#include "vtkMath.h"
#include "vtkObjectFactory.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"

vtkStandardNewMacro(vtkSMAnamorphDeformationDomain);

vtkSMAnamorphDeformationDomain::vtkSMAnamorphDeformationDomain() = default;
vtkSMAnamorphDeformationDomain::~vtkSMAnamorphDeformationDomain() = default;

void vtkSMAnamorphDeformationDomain::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
}

int vtkSMAnamorphDeformationDomain::SetDefaultValues(vtkSMProperty* property, bool use_unchecked_values) {
    using namespace anamorph_paraview;
    vtkSMProxy* deform = property->GetParent();
    const char* file = vtkSMPropertyHelper(deform, "FileName", true).GetAsString();
    if ((file && *file) || vtkSMPropertyHelper(deform, "Table", true).GetNumberOfElements() > 0) return 0;
    double bounds[6];
    const bool on_plane = vtkSMPropertyHelper(deform, "ParameterMode", true).GetAsInt() == 0;
    const std::optional<Frame> known = on_plane ? frame_of(deform) : Frame();
    if (!input_bounds(deform, bounds) || !known) return 0;
    const Frame& frame = *known;
    const Point corners[2] = {frame.parameters({bounds[0], bounds[2], bounds[4]}),
                              frame.parameters({bounds[1], bounds[3], bounds[5]})};

    std::vector<double> row(columns_of(property), 0.0);
    for (unsigned int i = 0; i < 2; ++i) {
        row[kCenter + i] = corners[0][i] / 2 + corners[1][i] / 2;
        const double extent = std::fabs(corners[1][i] - corners[0][i]) / 6;
        row[kExtent + i] = extent > 0 ? extent : 1;
    }
    const double diagonal = std::sqrt((bounds[1] - bounds[0]) * (bounds[1] - bounds[0]) +
                                      (bounds[3] - bounds[2]) * (bounds[3] - bounds[2]) +
                                      (bounds[5] - bounds[4]) * (bounds[5] - bounds[4]));
    for (unsigned int i = 0; i < 3; ++i)
        row[kVector + i] = (diagonal > 0 ? diagonal / 10 : 1) * frame.axes[2][i];
    row.back() = 1;  // enabled
    vtkSMPropertyHelper helper(property);
    helper.SetUseUnchecked(use_unchecked_values);
    helper.Set(row.data(), static_cast<unsigned int>(row.size()));
    return 1;
}
