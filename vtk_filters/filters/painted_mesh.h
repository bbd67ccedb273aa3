// SPDX-License-Identifier: Apache-2.0
// A mesh made of pieces of another one's triangles, with its arrays.
#pragma once

#include <array>
#include <unordered_map>
#include <vector>

#include "anamorph/geometry/size.h"
#include "anamorph/projector/projected_triangles.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"
#include "vtkType.h"

class vtkDoubleArray;
class vtkPolyData;

namespace anamorph_vtk {

/// Collects pieces of triangles. Corners that come from the same corners of the scene, at the same place and
/// with the same texel, become one point. Point arrays are interpolated, but for ids and ghosts, cell arrays
/// copied.
class PaintedMesh {
  public:
    /// Starts a mesh for a scene, which is made of triangles. With `size`, that of the panorama in texels,
    /// points get texture coordinates.
    PaintedMesh(vtkPolyData* scene, const anamorph::Size* size);

    /// Adds a piece of a triangle with these corners.
    void add(const anamorph::PaintedTriangle& piece, vtkIdType cell, const std::array<vtkIdType, 3>& corners);
    /// Hands the whole mesh over to `out`.
    void finish(vtkPolyData* out);

  private:
    vtkIdType point_of(const anamorph::PaintedCorner& corner, vtkIdType cell,
                       const std::array<vtkIdType, 3>& corners);

    /// The origin of a point: up to three corners of the scene (-1: none; of a point within a triangle, its
    /// cell), the place and the texel.
    struct Key {
        std::array<vtkIdType, 3> from;
        std::array<double, 5> at;
        bool operator==(const Key&) const;
    };
    struct Hash {
        std::size_t operator()(const Key& key) const;
    };

    vtkPolyData* m_scene;
    const anamorph::Size* m_size;
    vtkSmartPointer<vtkPolyData> m_mesh;
    vtkSmartPointer<vtkDoubleArray> m_texels;
    std::unordered_map<Key, vtkIdType, Hash> m_points;
    vtkNew<vtkIdList> m_ids;  ///< those of a point's corners
};

}  // namespace anamorph_vtk
