// SPDX-License-Identifier: Apache-2.0
// What may cast shadows in a scene, as triangles.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

class vtkMultiProcessController;
class vtkPolyData;

namespace anamorph_vtk {

/// Three corners, and so on.
using TriangleList = std::vector<glm::dvec3>;

/// Appends the triangles of a mesh of triangles.
void append_triangles(vtkPolyData* mesh, TriangleList& to);
/// The triangles of all ranks, in their order. Every rank has to call it.
TriangleList of_all_ranks(const TriangleList& own, vtkMultiProcessController* controller);

}  // namespace anamorph_vtk
