// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/mesh_lattice.h"

#include <algorithm>

namespace anamorph {

LatticeWeights::LatticeWeights(std::span<const double> lines, double at) {
    const int last = static_cast<int>(lines.size()) - 1, cell = Mesh::line_below(lines, at);
    const auto line = [&](int i) { return lines[static_cast<std::size_t>(i)]; };
    first = std::clamp(cell - 1, 0, last - 3);
    const double width = line(cell + 1) - line(cell);
    using J = Jet1<double>;
    const auto basis = hermite_basis(J::variable((at - line(cell)) / width, 1, 0));
    const auto add = [&](int i, const J& weight) {
        value[i - first] += weight.c[0];
        slope[i - first] += weight.c[1] / width;
    };
    // The secant at a line, eq. 5.8; at the border that line stands in for the missing one.
    const auto add_secant = [&](int i, const J& weight) {
        const int before = std::max(i - 1, 0), after = std::min(i + 1, last);
        const J share = weight * (width / (line(after) - line(before)));
        add(after, share);
        add(before, -share);
    };
    add(cell, basis[0]);
    add(cell + 1, basis[1]);
    add_secant(cell, basis[2]);
    add_secant(cell + 1, basis[3]);
    while (begin < 3 && value[begin] == 0) ++begin;
    while (end > begin + 1 && value[end - 1] == 0) --end;
}

namespace {

auto vertices_of(const Mesh& mesh) {
    return [&mesh](int column, int row) { return mesh.displacements(row)[column]; };
}

}  // namespace

Point<double> lattice_point(const Mesh& mesh, const LatticeWeights& across, const LatticeWeights& down,
                            double x, double y) {
    const Point<double> d = lattice_displacement(vertices_of(mesh), across, down);
    return {x * mesh.scale().x + d.x, y * mesh.scale().y + d.y};
}

Jacobian lattice_jacobian(const Mesh& mesh, const LatticeWeights& across, const LatticeWeights& down) {
    return lattice_jacobian(vertices_of(mesh), mesh.scale(), across, down);
}

}  // namespace anamorph
