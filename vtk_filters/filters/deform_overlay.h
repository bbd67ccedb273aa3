// SPDX-License-Identifier: Apache-2.0
// The + and the oval of each deformation, drawn on the deformed surface (Oka 1987, Fig. 4.1).
#pragma once

#include <array>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "anamorph/deform/deformed_surface.h"
#include "anamorph/deform/formula_displacement.h"
#include "anamorph/deform/plane_warp.h"
#include "deformed_mesh.h"
#include "ranks.h"
#include "vtkSmartPointer.h"

class vtkPointSet;
class vtkPolyData;

namespace anamorph_vtk {

/// An undeformed mesh and the parameters of its points. Triangles with parameters that are not finite are
/// left out.
struct OverlayMesh {
    vtkPointSet* mesh;
    const std::vector<glm::dvec2>* parameters;
    const anamorph::PointDepths* depths;  ///< of its points; empty where no bump needs them
};

/// Draws all of `list`, each as that of `entries` that it is, those that are not enabled too, on the surface that the list and the formula make.
/// Where parts of a surface lie over each other, a bump with depth or side is drawn on the part that it moves most.
/// Lines end where the meshes do, unless there is a plane to go on.
void draw_overlay(const std::vector<anamorph::Deformation>& list, const std::vector<std::size_t>& entries,
                  const anamorph::DeformOptions& options,
                  const std::optional<anamorph::FormulaDisplacement>& formula,
                  const std::vector<OverlayMesh>& meshes, const anamorph::ParameterPlane* plane,
                  vtkPolyData* overlay);

// The functions below return kNowhere where they find nothing; else it is the less the better what they found is, so that ranks can tell
// whose is the best (take_best).

/// Finds how far from a plane deformed meshes are at the centre of a bump, of several points where it moves them most, and at its
/// centre plus its extent near by in depth: at the points of the meshes that are nearest. What is not found is left as it is.
double find_heights(const anamorph::Deformation& bump,
                    const std::vector<std::unique_ptr<DeformedMesh>>& meshes,
                    const std::vector<vtkSmartPointer<vtkPointSet>>& deformed,
                    const anamorph::ParameterPlane& plane, double (&heights)[2]);

/// Finds the plane that meshes touch at parameters, moved as their nearest point is: the point that it has at (u, v) = (0, 0), and its derivatives by u and v.
/// Fitted to the points that are nearest in (u, v), so that on flat meshes it is exact but for rounding. What is not found is left as it is.
double find_frame(glm::dvec2 at, const std::vector<std::unique_ptr<DeformedMesh>>& meshes,
                  const std::vector<vtkSmartPointer<vtkPointSet>>& undeformed,
                  const std::vector<vtkSmartPointer<vtkPointSet>>& deformed, double (&frame)[9]);

/// What of an undeformed surface is at a point of the deformed one.
struct PickedPlace {
    glm::dvec2 parameters{0.0};
    glm::dvec3 point{0.0};     ///< undeformed
    double square = kNowhere;  ///< of the distance between the two points
    bool found = false;
};

/// Where a line meets a surface: the point, and how far along, 0 at its beginning and 1 at its end.
struct MetPoint {
    glm::dvec3 point;
    double along;
};

/// Finds what is at the point of the deformed meshes that is nearest to one in space; between points of a triangle in their shares.
PickedPlace find_place(const glm::dvec3& at, const std::vector<std::unique_ptr<DeformedMesh>>& meshes,
                       const std::vector<vtkSmartPointer<vtkPointSet>>& undeformed,
                       const std::vector<vtkSmartPointer<vtkPointSet>>& deformed);

/// Calls take(point, how far along, the corners) where a line meets the triangles of a mesh's surface cells, whose points are those of `points`.
void for_each_meeting(
    const glm::dvec3& from, const glm::dvec3& to, vtkPointSet* mesh, vtkPointSet* points,
    const std::function<void(const MetPoint&, const std::array<vtkIdType, 3>& corners)>& take);

/// Finds the point where a line first meets the deformed meshes; none if it misses them.
std::optional<MetPoint> find_on_line(const glm::dvec3& from, const glm::dvec3& to,
                                     const std::vector<vtkSmartPointer<vtkPointSet>>& undeformed,
                                     const std::vector<vtkSmartPointer<vtkPointSet>>& deformed);

/// The turn of a bump whose depth is along a normal of length 1 in space.
glm::dvec4 turn_to(const glm::dvec3& normal, const anamorph::ParameterPlane& plane);

/// Finds the part of undeformed meshes that is over the centre of a bump, of several the one nearest to it in depth: the depth there, an
/// extent in depth, the turn that lays the depth along the normal (a mean of those of the cells at the corners of that part), and V along it,
/// or against it where V is. What is not found is left as it is.
double find_anchor(const anamorph::Deformation& bump,
                   const std::vector<std::unique_ptr<DeformedMesh>>& meshes,
                   const std::vector<vtkSmartPointer<vtkPointSet>>& undeformed,
                   const anamorph::ParameterPlane& plane, double (&anchor)[9]);

}  // namespace anamorph_vtk
