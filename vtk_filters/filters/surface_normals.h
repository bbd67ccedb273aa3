// SPDX-License-Identifier: Apache-2.0
// Unit normals of a deformed mesh at its points.
//
// With normals of the undeformed mesh and parameters of a plane they are exact: space moves with the Jacobian
// J = I + D_u grad(u)^T + D_v grad(v)^T, and a normal n becomes cof(J) n, the cross product of two tangents
// a, b with a x b = n after J.
//
// Otherwise they are sums over the corners of the cells at a point, weighted by the corner's angle (Thuermer
// and Wuethrich 1998): the edges e of a corner are the surface's tangents there, and become
// e + D_u du + D_v dv, with the exact derivatives of the displacement and the edge's change of parameters.
// This is exact on a plane. Sums are in fixed point, so the order of the cells does not matter; where cells
// of other pieces are missing (no ghost cells), their corners are.
//
// A point of no surface cell has the normal of the parameter plane, or none (0, 0, 0).
#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "anamorph/deform/deformed_surface.h"
#include "anamorph/deform/plane_warp.h"
#include "vtkType.h"

class vtkDataArray;
class vtkPointSet;

namespace anamorph_vtk {

struct NormalsOf {
    vtkPointSet* mesh;                          ///< undeformed
    const std::vector<glm::dvec2>* parameters;  ///< of all its points; cells leave out those not finite
    const anamorph::ParameterPlane* plane;      ///< null: texture coordinates
    vtkDataArray* normals;                      ///< of the undeformed mesh, or null
    const std::vector<anamorph::Deformation>* list;
    anamorph::DeformOptions options;
};

bool is_finite(glm::dvec2 parameters);

/// Those that are not finite replaced by those of another point: the core takes no others.
std::vector<glm::dvec2> with_finite_parameters(std::vector<glm::dvec2> parameters);

/// Writes the normals of `points` to out, three numbers a point of the mesh. May build the mesh's cells.
template <class T>
void write_normals(const NormalsOf& of, const std::vector<vtkIdType>& points, T* out,
                   const anamorph::ParallelFor& parallel_for);

/// Calls body(cell_points) for the linear surface cells of a mesh, others cut into triangles; corners in
/// order. On one thread.
void for_each_surface_cell(vtkPointSet* mesh,
                           const std::function<void(vtkIdType count, const vtkIdType* points)>& body);

}  // namespace anamorph_vtk
