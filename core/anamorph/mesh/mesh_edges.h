// SPDX-License-Identifier: Apache-2.0
// The edges of a mesh's cells as lines.
#pragma once

#include <vector>

#include "anamorph/mesh/mesh.h"

namespace anamorph {

/// The edge of a cell, from corner to corner.
struct MeshEdge {
    int level;
    std::vector<Point<double>> line;
};

/// The edges of all cells, each once: where the mesh lies, or mapped, each a line of kMeshEdgeSteps steps along the map.
std::vector<MeshEdge> mesh_edges(const Mesh& mesh, bool mapped);
inline constexpr int kMeshEdgeSteps = 8;

/// The map of the points along a cell's edge: 0 the upper, 1 the right, 2 the lower, 3 the left one; clockwise.
Point<double> on_mesh_edge(const Mesh& mesh, const Patch& patch, int edge, double along);

}  // namespace anamorph
