// SPDX-License-Identifier: Apache-2.0
// The map of a control mesh: Hermite bicubic patches through the positions at its vertices, with Catmull-Rom
// derivatives (Kim 2003, eq. 5.2, 5.3, 5.8), on cells of several levels (5.3.4).
//
// Frames. The mesh lies in one image ("from") and says where in another ("to") its points are; both in
// pixels, x right, y down, pixel centres at + 0.5. What is interpolated is the displacement from the
// identity, which maps the one image onto the other as a whole: the patches reproduce linear functions, so
// this is the same map, and without displacement it is the identity to the bit.
//
// Smoothness. Each vertex of a level has one value and one set of derivatives, read by all cells around
// it: the map is C1. A vertex beside a cell that is not subdivided takes all of them from the coarser
// patch, so that the map is C1 across levels too. A point on an edge between two levels is evaluated in
// the coarser cell.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "anamorph/geometry/size.h"
#include "anamorph/mesh/mesh_data.h"
#include "anamorph/number/jet.h"
#include "anamorph/number/tracked.h"

namespace anamorph {

/// Weights of (value at 0, value at 1, derivative at 0, derivative at 1): S M of eq. 5.2. Exactly (1, 0, 0,
/// 0) at 0 and (0, 1, 0, 0) at 1, so that cells agree on their edges to the bit.
template <class T>
std::array<T, 4> hermite_basis(const T& s) {
    const T s2 = square(s), r = s - 1.0;
    return {s2 * (s * 2.0 - 3.0) + 1.0, s2 * (s * -2.0 + 3.0), s * square(r), s2 * r};
}

/// The sum of eq. 5.3 over the elements of a patch's geometry (Patch::g), which are numbers G of their own.
template <class T, class G>
Point<T> hermite_sum(const Point<G> (&g)[4][4], const T& s, const T& t) {
    const std::array<T, 4> a = hermite_basis(s), b = hermite_basis(t);
    Point<T> sum{T(0.0), T(0.0)};
    for (std::size_t i = 0; i < 4; ++i) {
        Point<T> row{T(0.0), T(0.0)};
        for (std::size_t j = 0; j < 4; ++j) {
            row.x = row.x + b[j] * g[i][j].x;
            row.y = row.y + b[j] * g[i][j].y;
        }
        sum.x = sum.x + a[i] * row.x;
        sum.y = sum.y + a[i] * row.y;
    }
    return sum;
}

/// The map of a point of "from" whose displacement from the identity is `by`. `scale`: Mesh::scale().
template <class T, class G>
Point<T> displaced(const T& x, const T& y, const Point<G>& scale, const Point<T>& by) {
    return {x * scale.x + by.x, y * scale.y + by.y};
}

/// The geometry of eq. 5.3 for both coordinates: g[a][b] with a = value at s = 0, at s = 1, d/ds at 0, at 1,
/// and b so for t; s and t run over 0..1 in the cell.
struct Patch {
    double x0, y0, x1, y1;  ///< edges of the cell, pixels
    Point<double> g[4][4];

    /// The displacement at (s, t).
    template <class T>
    Point<T> operator()(const T& s, const T& t) const {
        return hermite_sum(g, s, t);
    }
};

/// A cell that is not subdivided.
struct MeshCell {
    int level = 0, column = 0, row = 0;  ///< place in the lattice of its level
    int node = -1;                       ///< number of the mesh's node; -1 at level 0
    double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

class Mesh {
  public:
    /// `amount` blends from the identity (0) to the mesh (1) and beyond. Throws Error that names `name` and
    /// the vertex.
    Mesh(const ControlMesh& mesh, const Size& from, const Size& to, double amount,
         const std::string& name = "mesh");

    const Size& from() const { return m_from; }
    const Size& to() const { return m_to; }
    int columns() const { return static_cast<int>(m_x.size()) - 1; }
    int rows() const { return static_cast<int>(m_y.size()) - 1; }
    /// The lines of level 0, from edge to edge of the image.
    const std::vector<double>& x_lines() const { return m_x; }
    const std::vector<double>& y_lines() const { return m_y; }
    /// The lines of level 0 that stand before the first given one, across and down: 1 where that lies inside the image, else 0.
    const Size& lines_before() const { return m_before; }
    /// The place of a vertex of the lattice of a level, whose numbers count the lines before too.
    Point<double> lattice_place(int level, int column, int row) const {
        return {line(m_x, level, column), line(m_y, level, row)};
    }
    /// Pixels of "to" per pixel of "from" of the identity.
    const Point<double>& scale() const { return m_scale; }

    /// The cell that a point is evaluated in; the nearest one for points outside the image.
    MeshCell cell_at(double x, double y) const;
    /// The cell with (x, y) in [x0, x1) x [y0, y1), whatever its neighbours; with `left` (`above`) a point on
    /// its left (top) edge belongs to the neighbour instead.
    MeshCell leaf_at(double x, double y, bool left = false, bool above = false) const;
    Patch patch(const MeshCell& cell) const;
    /// The largest distance, anywhere in the cell and in either coordinate, of the map of a cell's patch from the one that the
    /// given numbers define: the rounding of lines, displacements and derivatives.
    double data_error(const MeshCell& cell, const Patch& patch) const;

    /// Bounds over all cells of level 0 that meet a rectangle, from their vertices alone: of data_error(), and of the sum of
    /// the elements of each. They are cheaper than cell by cell, and wider.
    struct Rough {
        double data_error, size;
        Point<double> low, high;  ///< bounds of the displacements of their vertices and those around
    };
    Rough rough(double x0, double y0, double x1, double y1) const;
    bool has_levels() const { return !m_nodes.empty(); }
    /// The displacements of the vertices on a line of level 0, columns() + 1 of them.
    const Point<double>* displacements(int row) const { return m_values.data() + index(0, row); }
    /// The cell between two lines that a position falls into: [line, next line), the outermost at the ends.
    static int line_below(std::span<const double> lines, double at);

    /// Calls body(cell) for the cells that meet [x0, x1] x [y0, y1], in rows of level 0.
    template <class Body>
    void each_cell(double x0, double y0, double x1, double y1, const Body& body) const {
        const int c0 = line_below(m_x, x0), c1 = line_below(m_x, x1);
        const int r0 = line_below(m_y, y0), r1 = line_below(m_y, y1);
        for (int r = r0; r <= r1; ++r)
            for (int c = c0; c <= c1; ++c)
                each_part(base_cell(c, r), [&](const MeshCell& cell) {
                    if (cell.x0 <= x1 && cell.x1 >= x0 && cell.y0 <= y1 && cell.y1 >= y0) body(cell);
                });
    }

    /// The map on one cell; also a little outside it.
    template <class T>
    Point<T> at(const Patch& patch, const T& x, const T& y) const {
        return displaced(
            x, y, m_scale,
            patch((x - patch.x0) / T(patch.x1 - patch.x0), (y - patch.y0) / T(patch.y1 - patch.y0)));
    }
    /// The map on one cell by the cell's own parameters, 0 to 1, without loss of precision where a cell is thin.
    template <class T>
    Point<T> inside(const Patch& patch, const T& s, const T& t) const {
        return displaced<T>(s * (patch.x1 - patch.x0) + patch.x0, t * (patch.y1 - patch.y0) + patch.y0,
                            m_scale, patch(s, t));
    }
    /// The map at a point.
    Point<double> at(double x, double y) const { return at(patch(cell_at(x, y)), x, y); }

    /// The orientation of the map: +1, or -1 where most of the mesh (of the area that its cells take in
    /// "from") is flipped.
    double orientation() const { return m_orientation; }

  private:
    /// The data of a vertex: displacement and derivatives per pixel; and the largest error of each against what the given
    /// numbers define, in either coordinate.
    struct Knot {
        Point<double> f, fx, fy, fxy;
        double f_error = 0, fx_error = 0, fy_error = 0, fxy_error = 0;
    };
    using Uncertain = Point<Tracked<double>>;
    /// A cell of level 1 or more.
    struct Node {
        int level, column, row;
        int child = -1;      ///< the first of four nodes, if it is cut
        int corner[4] = {};  ///< knots: top left, top right, bottom left, bottom right
    };
    class Refiner;

    /// A line of the lattice of a level.
    static double line(const std::vector<double>& lines, int level, int number);
    MeshCell base_cell(int column, int row) const;
    MeshCell cell_of(int node) const;
    int child_of(const MeshCell& cell) const;
    std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * m_x.size() + static_cast<std::size_t>(column);
    }
    Uncertain value(int column, int row) const;
    void set_value(int column, int row, const Uncertain& value);
    template <class Value>
    void set_derivatives(Knot& knot, int level, int column, int row, const Value& value) const;
    Knot compute_knot(int column, int row) const;
    Knot knot(int column, int row) const;
    /// A line's position with its rounding, whatever its level.
    Tracked<double> place(double line) const { return {line, m_line_rounding * std::fabs(line)}; }
    Knot knot_at(const MeshCell& cell, int corner) const;
    /// The largest errors of the elements of a patch's geometry, in either coordinate, against what the given numbers define.
    using ElementErrors = std::array<std::array<double, 4>, 4>;
    ElementErrors element_errors(const MeshCell& cell) const;
    template <class Entry>
    Uncertain displacement(const Point<double>& to, Units units, double x, double y, double amount,
                           const Entry& entry) const;
    void extend(int before_x, int before_y, int across, int down);
    double turned_area() const;

    template <class Body>
    void each_part(const MeshCell& cell, const Body& body) const {
        const int child = child_of(cell);
        if (child < 0) return body(cell);
        for (int k = 0; k < 4; ++k) each_part(cell_of(child + k), body);
    }

    Size m_from, m_to, m_before;
    Point<double> m_scale;
    std::vector<double> m_x, m_y;
    double m_line_rounding = 4 * 0x1p-53;  ///< relative rounding of a line; 0 where all are exact
    std::vector<Point<double>> m_values;   ///< displacements at the vertices of level 0
    std::vector<float> m_value_errors;     ///< errors of these, in either coordinate
    std::vector<Knot> m_base_knots;        ///< knots of level 0, unless there are very many
    std::vector<int> m_base_child;         ///< nodes of the cells of level 0, where there are more levels
    std::vector<Node> m_nodes;
    std::vector<Knot> m_knots;  ///< knots of the nodes
    double m_orientation = 1;
};

}  // namespace anamorph
