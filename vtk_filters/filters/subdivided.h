// SPDX-License-Identifier: Apache-2.0
// Surfaces with more points, for what moves points.
#pragma once

#include "vtkSmartPointer.h"

class vtkPointSet;

namespace anamorph_vtk {

/// More would be cells without number.
inline constexpr int kMostSubdivisions = 10;

/// Can a mesh be subdivided: is it of polygons and strips alone?
bool has_polygons_alone(vtkPointSet* mesh);

/// A surface whose polygons are cut into triangles, and each of these into four so many times, at the middles of its edges: a surface of
/// the same shape, whose points have the arrays of the corners in equal shares. Throws anamorph::Error, which names Subdivisions, where
/// the mesh has anything but polygons, an edge of more than two triangles, or would have 2^31 points or more.
vtkSmartPointer<vtkPointSet> subdivided(vtkPointSet* mesh, int times);

}  // namespace anamorph_vtk
