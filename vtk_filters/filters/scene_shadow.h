// SPDX-License-Identifier: Apache-2.0
// What stands between a projector and a point of a scene.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "vtkSmartPointer.h"

class vtkMultiProcessController;
class vtkPolyData;
class vtkStaticCellLocator;

namespace anamorph_vtk {

/// Three corners, and so on.
using TriangleList = std::vector<glm::dvec3>;

/// Appends the triangles of a mesh of triangles.
void append_triangles(vtkPolyData* mesh, TriangleList& to);
/// The triangles of all ranks, in their order. Every rank has to call it.
TriangleList of_all_ranks(const TriangleList& own, vtkMultiProcessController* controller);

/// Tests rays against triangles.
class SceneShadow {
  public:
    /// As near to a point as this, relative to its distance from the projector, nothing hides it: a surface does not hide
    /// itself, nor what touches it.
    static constexpr double kTouching = 0x1p-16;

    SceneShadow(const TriangleList& triangles, const glm::dvec3& projector);
    ~SceneShadow();

    /// May be called from several threads at once.
    bool hides(const glm::dvec3& point) const;

  private:
    glm::dvec3 m_projector;
    vtkSmartPointer<vtkPolyData> m_mesh;
    vtkSmartPointer<vtkStaticCellLocator> m_locator;
};

}  // namespace anamorph_vtk
