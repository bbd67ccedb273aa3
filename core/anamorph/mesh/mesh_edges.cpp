// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/mesh_edges.h"

#include <set>

namespace anamorph {

Point<double> on_mesh_edge(const Mesh& mesh, const Patch& patch, int edge, double along) {
    const double s[] = {along, 1, 1 - along, 0}, t[] = {0, along, 1, 1 - along};
    return mesh.inside(patch, s[edge], t[edge]);
}

std::vector<MeshEdge> mesh_edges(const Mesh& mesh, bool mapped) {
    std::vector<MeshEdge> edges;
    std::set<std::array<double, 4>> drawn;
    mesh.each_cell(0, 0, mesh.from().width, mesh.from().height, [&](const MeshCell& cell) {
        const Patch patch = mesh.patch(cell);
        const std::array<double, 4> ends[] = {{cell.x0, cell.y0, cell.x1, cell.y0},
                                              {cell.x1, cell.y0, cell.x1, cell.y1},
                                              {cell.x0, cell.y1, cell.x1, cell.y1},
                                              {cell.x0, cell.y0, cell.x0, cell.y1}};
        for (int edge = 0; edge < 4; ++edge) {
            const std::array<double, 4>& e = ends[edge];
            if (!drawn.insert(e).second) continue;
            MeshEdge made{cell.level, {}};
            if (!mapped) made.line = {{e[0], e[1]}, {e[2], e[3]}};
            for (int i = 0; mapped && i <= kMeshEdgeSteps; ++i)
                made.line.push_back(on_mesh_edge(mesh, patch, edge, double(i) / kMeshEdgeSteps));
            edges.push_back(std::move(made));
        }
    });
    return edges;
}

}  // namespace anamorph
