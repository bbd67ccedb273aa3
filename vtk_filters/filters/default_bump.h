// SPDX-License-Identifier: Apache-2.0
// The bump that a surface gets before anybody has said where: one that is seen.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "anamorph/deform/deformation.h"
#include "anamorph/deform/plane_warp.h"
#include "deformed_mesh.h"
#include "vtkSmartPointer.h"

class vtkMultiProcessController;
class vtkPointSet;

namespace anamorph_vtk {

struct DefaultBump {
    anamorph::Deformation bump;
    int subdivisions = 0;  ///< of the surface, which has too few points without
    int points = 0;        ///< how many points the mesh has within its extents, counted up to kEnough
    /// With fewer points than this a bump is a corner that is pulled out, and not round.
    static constexpr int kEnough = 5;
};

/// Finds a bump that the first look at undeformed meshes shows: a tenth of their diagonal high, a sixth of their lengths wide, out of the
/// surface, on the side of an eye that looks from where x, y and z are large. All ranks of the controller (may be null) call this together.
///
/// Where one part of the surface alone is over the middle of the plane it stands there, straight on the plane. Otherwise, as on closed
/// surfaces, it stands where the line from the eye to the middle first meets the surface, with its depth and frame, along the normal. In
/// texture coordinates (plane: null) it is there, too, and has neither. Where the mesh has fewer than kEnough points in it,
/// subdivisions would give it more, which meshes of polygons alone can have. Of others it is put onto the nearest point, and grows to reach
/// the next, but to twice the width at most.
/// None where there are no finite points.
std::optional<DefaultBump> find_default_bump(const std::vector<std::unique_ptr<DeformedMesh>>& meshes,
                                             const std::vector<vtkSmartPointer<vtkPointSet>>& undeformed,
                                             const anamorph::ParameterPlane* plane,
                                             vtkMultiProcessController* controller);

}  // namespace anamorph_vtk
