// SPDX-License-Identifier: Apache-2.0
// The triangles of a scene that may cast shadows.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "vtkSmartPointer.h"
#include "vtkType.h"

class vtkMultiProcessController;
class vtkPolyData;

namespace anamorph_vtk {

/// A list of triangles: three corners each.
using TriangleList = std::vector<glm::dvec3>;

/// The polygons of a mesh as triangles, with what belongs to its points and cells. Throws Error of cells whose corners are no points.
vtkSmartPointer<vtkPolyData> triangulated(vtkPolyData* mesh);
/// Calls body(its three points) for every triangle of a mesh, as triangulated() makes it, that is not hidden
/// (blanked).
void for_shown(vtkPolyData* triangles, const std::function<void(const vtkIdType*)>& body);
/// Appends the triangles whose points are finite.
void append_triangles(vtkPolyData* triangles, TriangleList& to);
/// The triangles of all ranks, in their order. Every rank has to call it.
TriangleList of_all_ranks(const TriangleList& own, vtkMultiProcessController* controller);

}  // namespace anamorph_vtk
