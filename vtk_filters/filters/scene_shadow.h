// SPDX-License-Identifier: Apache-2.0
// What may cast shadows in a scene, as triangles.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "vtkSmartPointer.h"
#include "vtkType.h"

class vtkMultiProcessController;
class vtkPolyData;

namespace anamorph_vtk {

/// Three corners, and so on.
using TriangleList = std::vector<glm::dvec3>;

/// The polygons of a mesh as triangles, with what belongs to its points and cells.
vtkSmartPointer<vtkPolyData> triangulated(vtkPolyData* mesh);
/// Calls body(its three points) for every triangle of such a mesh that is not hidden (blanked).
void for_shown(vtkPolyData* triangles, const std::function<void(const vtkIdType*)>& body);
/// Appends those whose points are finite.
void append_triangles(vtkPolyData* triangles, TriangleList& to);
/// The triangles of all ranks, in their order. Every rank has to call it.
TriangleList of_all_ranks(const TriangleList& own, vtkMultiProcessController* controller);

}  // namespace anamorph_vtk
