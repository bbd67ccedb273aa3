// SPDX-License-Identifier: Apache-2.0
// The cells of a mesh and the pixels whose centres they hold.
#pragma once

#include <algorithm>
#include <cmath>

#include "anamorph/geometry/box.h"
#include "anamorph/mesh/hermite.h"
#include "anamorph/mesh/mesh.h"

namespace anamorph {

/// Finds the pixels whose centres lie in [from, to), as far as they lie in [first, last).
inline void pixels_between(double from, double to, int first, int last, int& begin, int& end) {
    const auto number = [&](double at) {
        return static_cast<int>(std::clamp(std::ceil(at - 0.5), double(first), double(last)));
    };
    begin = number(from);
    end = number(to);
}

/// Calls body(cell, part) for the cells that meet a box of pixels, with the pixels whose centres they hold.
template <class Body>
void each_cell_of(const Mesh& mesh, const Box& box, const Body& body) {
    mesh.each_cell(box.x0 + 0.5, box.y0 + 0.5, box.x1 - 0.5, box.y1 - 0.5, [&](const MeshCell& cell) {
        Box part;
        // The outermost cells go on to the edges of the image.
        pixels_between(cell.x0 <= mesh.x_lines().front() ? -1 : cell.x0,
                       cell.x1 >= mesh.x_lines().back() ? HUGE_VAL : cell.x1, box.x0, box.x1, part.x0,
                       part.x1);
        pixels_between(cell.y0 <= mesh.y_lines().front() ? -1 : cell.y0,
                       cell.y1 >= mesh.y_lines().back() ? HUGE_VAL : cell.y1, box.y0, box.y1, part.y0,
                       part.y1);
        if (!part.empty()) body(cell, part);
    });
}

/// A rectangle and a hair more around it: points on an edge may be evaluated in the neighbour.
inline Bounds with_neighbors(const Bounds& b) {
    constexpr double kMore = 1e-9;
    return {b.x0 - kMore, b.y0 - kMore, b.x1 + kMore, b.y1 + kMore};
}
/// The largest distance of Mesh::at from the map of the given numbers in the cells that meet a rectangle, cell by cell.
inline double exact_rounding_by_cells(const Mesh& mesh, const Bounds& b) {
    double bound = 0;
    mesh.each_cell(b.x0, b.y0, b.x1, b.y1, [&](const MeshCell& cell) {
        bound = std::max(bound, exact_rounding(mesh, cell, mesh.patch(cell)));
    });
    return bound;
}

}  // namespace anamorph
