// SPDX-License-Identifier: Apache-2.0
// Unit normals of a deformed mesh at its points.
//
// With normals of the undeformed mesh and parameters of a plane they are exact: space moves with the Jacobian
// J = I + D_u grad(u)^T + D_v grad(v)^T + D_w grad(w)^T, and a normal n becomes cof(J) n, the cross product of two
// tangents a, b with a x b = n after J. Without bumps of one side, that is.
//
// Otherwise they are sums over the corners of the cells at a point, weighted by the corner's angle (Thuermer
// and Wuethrich 1998): the edges e of a corner are the surface's tangents there, and become
// e + D_u du + D_v dv, with the exact derivatives of the displacement and the edge's change of parameters, and so on
// by depth and normal where bumps have these.
// This is exact on a plane. Sums are in fixed point, so the order of the cells does not matter; where cells
// of other pieces are missing (no ghost cells), their corners are.
//
// A point of no surface cell has the normal of the parameter plane, or none (0, 0, 0).
#pragma once

#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "anamorph/deform/deformed_surface.h"
#include "anamorph/deform/plane_warp.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

class vtkDataArray;
class vtkPointSet;
class vtkUnsignedCharArray;

namespace anamorph_vtk {

bool is_finite(glm::dvec2 parameters);

/// The given parameters, with those that are not finite replaced by those of another point: the core takes no
/// others.
std::vector<glm::dvec2> with_finite_parameters(std::vector<glm::dvec2> parameters);

/// Reads an array of three numbers a tuple, of any type, from any thread.
class Triples {
  public:
    explicit Triples(vtkDataArray* array);
    glm::dvec3 operator[](std::int64_t i) const {
        if (m_floats) return {m_floats[3 * i], m_floats[3 * i + 1], m_floats[3 * i + 2]};
        return m_doubles ? glm::dvec3(m_doubles[3 * i], m_doubles[3 * i + 1], m_doubles[3 * i + 2]) : read(i);
    }

  private:
    glm::dvec3 read(std::int64_t i) const;

    vtkSmartPointer<vtkDataArray> m_array;
    const float* m_floats = nullptr;  ///< the numbers of an array of floats without gaps
    const double* m_doubles = nullptr;
};

/// The normals of a mesh, for any deformation of it.
class SurfaceNormals {
  public:
    /// mesh: undeformed. parameters: those of all its points, to be kept as long as this; cells leave out
    /// those not finite. plane: null for texture coordinates. normals: of the undeformed mesh, or null. depths: of
    /// all points, to be kept as long as this, or null where slopes have no derivatives by them.
    SurfaceNormals(vtkPointSet* mesh, const std::vector<glm::dvec2>& parameters,
                   const anamorph::ParameterPlane* plane, vtkDataArray* normals,
                   const anamorph::PointDepths* depths = nullptr);

    /// Writes the normals of some points to out, three numbers a point of the mesh. From any thread.
    template <class T>
    void write(const anamorph::SurfaceSlopes& slopes, T* out) const;

  private:
    /// Links points to their cells: those of point i are m_cells[m_first[i]] to m_cells[m_first[i + 1]].
    void link_cells();
    using Normals = double[3][anamorph::SurfaceSlopes::kMost];
    void turn(const anamorph::SurfaceSlopes& slopes, Normals& to) const;
    void add_corners(const anamorph::SurfaceSlopes& slopes, Normals& to) const;

    vtkSmartPointer<vtkPointSet> m_mesh;  ///< the mesh without its arrays
    vtkSmartPointer<vtkUnsignedCharArray> m_ghosts;
    Triples m_points, m_normals;
    const std::vector<glm::dvec2>& m_parameters;
    const anamorph::PointDepths* m_depths;
    bool m_on_plane, m_exact;
    anamorph::ParameterPlane m_plane;
    std::vector<std::int64_t> m_first;
    std::vector<std::uint32_t> m_cells;
};

/// Calls body(cell_points) for the linear surface cells of a mesh, others cut into triangles; corners in
/// order. On one thread.
void for_each_surface_cell(vtkPointSet* mesh,
                           const std::function<void(vtkIdType count, const vtkIdType* points)>& body);

}  // namespace anamorph_vtk
