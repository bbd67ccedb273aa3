// SPDX-License-Identifier: Apache-2.0
#include "anamorph/map/mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

#include "anamorph/error.h"

namespace anamorph {
namespace {

// Knots of level 0 are kept for meshes of at most so many vertices, else computed when needed.
constexpr std::size_t kKeptKnots = std::size_t{1} << 20;

std::string text_of(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

std::string text_of(int column, int row) {
    return "[" + std::to_string(column) + ", " + std::to_string(row) + "]";
}

void check_count(const std::string& name, const char* what, double value, double least, double most) {
    if (!(value >= least && value <= most))
        throw Error(name + ": " + what, text_of(value),
                    "allowed is " + text_of(least) + " to " + text_of(most));
}

/// The lines in pixels, from edge to edge of an image of `size` pixels; `before` counts those added in front.
std::vector<double> lines_of(const std::vector<double>& given, int cells, int size, Units units,
                             const std::string& name, const char* key, int& before) {
    before = 0;
    std::vector<double> lines(static_cast<std::size_t>(cells) + 1);
    if (given.empty()) {
        for (int i = 0; i <= cells; ++i)
            lines[static_cast<std::size_t>(i)] = static_cast<double>(size) * i / cells;
        return lines;
    }
    if (given.size() != lines.size())
        throw Error(name + ": " + key, std::to_string(given.size()) + " lines",
                    "needed are " + std::to_string(lines.size()));
    const double unit = units == Units::pixels ? 1 : size;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        lines[i] = given[i] * unit;
        if (!(std::fabs(lines[i]) <= ControlMesh::kMaxPosition) || (i > 0 && !(lines[i] > lines[i - 1])))
            throw Error(name + ": " + key + "[" + std::to_string(i) + "]", text_of(given[i]),
                        "allowed are ascending positions");
        // Cells so thin that their derivatives lose all digits.
        if (i > 0 && !(lines[i] - lines[i - 1] >= 1e-6))
            throw Error(name + ": " + key + "[" + std::to_string(i) + "]", text_of(given[i]),
                        "lines are at least 1e-6 pixels apart");
    }
    // Lines a hair inside the edge stand on it.
    constexpr double kHair = 1e-6;
    if (lines.front() > 0 && lines.front() <= kHair) lines.front() = 0;
    if (lines.back() < size && lines.back() >= size - kHair) lines.back() = size;
    if (lines.front() > 0) {
        lines.insert(lines.begin(), 0.0);
        before = 1;
    }
    if (lines.back() < size) lines.push_back(size);
    return lines;
}

/// Catmull-Rom, eq. 5.8: the secant through the two neighbours.
Point<double> secant(const Point<double>& before, const Point<double>& after, double distance) {
    return (after - before) * (1 / distance);
}

}  // namespace

// ----------------------------------------------------------------------------------------------------------

/// Builds the levels above 0.
class Mesh::Refiner {
  public:
    Refiner(Mesh& mesh, const ControlMesh& given, double amount, const std::string& name, int before_x,
            int before_y)
        : m_mesh(mesh),
          m_given(given),
          m_amount(amount),
          m_name(name),
          m_before_x(before_x),
          m_before_y(before_y) {}

    void build() {
        choose_cells();
        m_mesh.m_base_child.assign(
            static_cast<std::size_t>(m_mesh.columns()) * static_cast<std::size_t>(m_mesh.rows()), -1);
        for (std::size_t k = 1; k <= m_cut.size(); ++k) build_level(static_cast<int>(k));
    }

  private:
    using Place = std::pair<int, int>;  ///< row, column: ordered as a picture is read

    /// The cells to cut, level by level: those that are given, and as many more as keep neighbours within one
    /// level.
    void choose_cells() {
        m_cut.resize(m_given.levels.size());
        std::size_t count = 0;
        for (std::size_t k = 0; k < m_cut.size(); ++k) {
            const int columns = m_given.columns << k, rows = m_given.rows << k;
            for (const ControlMesh::Cell& c : m_given.levels[k].cells) {
                if (c.column < 0 || c.column >= columns || c.row < 0 || c.row >= rows)
                    throw Error(m_name + ": levels[" + std::to_string(k) + "].cells",
                                text_of(c.column, c.row),
                                "the level above has " + std::to_string(columns) + " x " +
                                    std::to_string(rows) + " cells");
                m_cut[k].insert({c.row + (m_before_y << k), c.column + (m_before_x << k)});
            }
        }
        for (std::size_t k = m_cut.size(); k-- > 0;) {
            count += m_cut[k].size();
            if (count > ControlMesh::kMaxVertices / 16)
                throw Error(m_name + ": levels", std::to_string(count) + " cells to cut",
                            "allowed are " + std::to_string(ControlMesh::kMaxVertices / 16));
            if (k == 0) break;
            for (const auto& [row, column] : m_cut[k])
                for (const Place& p : {Place{row, column}, Place{row - 1, column}, Place{row + 1, column},
                                       Place{row, column - 1}, Place{row, column + 1}})
                    if (inside(p, static_cast<int>(k))) m_cut[k - 1].insert({p.first >> 1, p.second >> 1});
        }
    }

    bool inside(const Place& p, int level) const {
        return p.first >= 0 && p.second >= 0 && p.first < m_mesh.rows() << level &&
               p.second < m_mesh.columns() << level;
    }

    /// Is every cell of level - 1 around a vertex of `level` cut?
    bool is_real(const Place& v, int level) const {
        const std::set<Place>& cut = m_cut[static_cast<std::size_t>(level - 1)];
        for (const int row : {(v.first - 1) >> 1, v.first >> 1})
            for (const int column : {(v.second - 1) >> 1, v.second >> 1})
                if (inside({row, column}, level - 1) && !cut.count({row, column})) return false;
        return true;
    }

    /// The cell of level - 1 at a place.
    MeshCell coarse_cell(const Place& p, int level) const {
        return level == 1 ? m_mesh.base_cell(p.second, p.first) : m_mesh.cell_of(m_node_at.at(p));
    }
    Knot coarse_knot(const MeshCell& cell, int corner) const {
        if (cell.level == 0) return m_mesh.knot(cell.column + (corner & 1), cell.row + (corner >> 1));
        return m_mesh.m_knots[static_cast<std::size_t>(
            m_mesh.m_nodes[static_cast<std::size_t>(cell.node)].corner[corner])];
    }

    /// The coarser model at vertex (i, j) of the 3 x 3 in a cell.
    Knot model(const MeshCell& cell, int i, int j) const {
        if (i != 1 && j != 1) return coarse_knot(cell, i / 2 + j / 2 * 2);
        using J = Jet2<double>;
        const Point<J> f = m_mesh.patch(cell)(J::variable(0.5 * i, 1, 0), J::variable(0.5 * j, 0, 1));
        const double kx = 1 / (cell.x1 - cell.x0), ky = 1 / (cell.y1 - cell.y0);
        return {{f.x.c[0], f.y.c[0]},
                {f.x.at(1, 0) * kx, f.y.at(1, 0) * kx},
                {f.x.at(0, 1) * ky, f.y.at(0, 1) * ky},
                {f.x.at(1, 1) * kx * ky, f.y.at(1, 1) * kx * ky}};
    }

    /// Values given for a level, as displacements.
    std::map<Place, Point<double>> given_values(int level) const {
        std::map<Place, Point<double>> values;
        const ControlMesh::Level& given = m_given.levels[static_cast<std::size_t>(level - 1)];
        for (std::size_t n = 0; n < given.vertices.size(); ++n) {
            const ControlMesh::Vertex& v = given.vertices[n];
            const std::string entry =
                m_name + ": levels[" + std::to_string(level - 1) + "].vertices[" + std::to_string(n) + "]";
            if (v.column < 0 || v.column > m_given.columns << level || v.row < 0 ||
                v.row > m_given.rows << level)
                throw Error(entry, text_of(v.column, v.row),
                            "allowed are columns 0 to " + std::to_string(m_given.columns << level) +
                                " and rows 0 to " + std::to_string(m_given.rows << level));
            const Place place{v.row + (m_before_y << level), v.column + (m_before_x << level)};
            values[place] = m_mesh.displacement(
                v.at, m_given.units, m_mesh.line(m_mesh.m_x, level, place.second),
                m_mesh.line(m_mesh.m_y, level, place.first), m_amount, [&] { return entry; });
        }
        return values;
    }

    void build_level(int level) {
        const std::map<Place, Point<double>> given = given_values(level);
        const std::set<Place>& cut = m_cut[static_cast<std::size_t>(level - 1)];
        std::map<Place, int> knots;
        // Values first: the derivatives of a vertex need its neighbours'.
        for (const Place& p : cut) {
            const MeshCell cell = coarse_cell(p, level);
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i) {
                    const Place v{2 * p.first + j, 2 * p.second + i};
                    const auto [at, is_new] = knots.try_emplace(v, static_cast<int>(m_mesh.m_knots.size()));
                    if (!is_new) continue;
                    Knot knot = model(cell, i, j);
                    const auto own = given.find(v);
                    if (own != given.end() && is_real(v, level)) knot.f = own->second;
                    m_mesh.m_knots.push_back(knot);
                }
        }
        for (const auto& [v, knot] : knots)
            if (is_real(v, level))
                m_mesh.set_derivatives(m_mesh.m_knots[static_cast<std::size_t>(knot)], level, v.second,
                                       v.first, [&](int column, int row) -> const Point<double>& {
                                           const int k = knots.at({row, column});
                                           return m_mesh.m_knots[static_cast<std::size_t>(k)].f;
                                       });

        // Then the cells.
        std::map<Place, int> nodes;
        for (const Place& p : cut) {
            const int first = static_cast<int>(m_mesh.m_nodes.size());
            if (level == 1)
                m_mesh.m_base_child[static_cast<std::size_t>(p.first) *
                                        static_cast<std::size_t>(m_mesh.columns()) +
                                    static_cast<std::size_t>(p.second)] = first;
            else
                m_mesh.m_nodes[static_cast<std::size_t>(m_node_at.at(p))].child = first;
            for (int k = 0; k < 4; ++k) {
                const int row = 2 * p.first + (k >> 1), column = 2 * p.second + (k & 1);
                Node node{level, column, row};
                for (int c = 0; c < 4; ++c) node.corner[c] = knots.at({row + (c >> 1), column + (c & 1)});
                nodes[{row, column}] = static_cast<int>(m_mesh.m_nodes.size());
                m_mesh.m_nodes.push_back(node);
            }
        }
        m_node_at = std::move(nodes);
    }

    Mesh& m_mesh;
    const ControlMesh& m_given;
    double m_amount;
    const std::string& m_name;
    int m_before_x, m_before_y;
    std::vector<std::set<Place>> m_cut;
    std::map<Place, int> m_node_at;  ///< of the level built last
};

// ----------------------------------------------------------------------------------------------------------

Mesh::Mesh(const ControlMesh& mesh, const Extent& from, const Extent& to, double amount,
           const std::string& name)
    : m_from(from), m_to(to) {
    check_count(name, "columns", mesh.columns, 1, ControlMesh::kMaxCells);
    check_count(name, "rows", mesh.rows, 1, ControlMesh::kMaxCells);
    const int across = mesh.columns + 1, down = mesh.rows + 1;
    if (mesh.vertices.size() != static_cast<std::size_t>(across) * static_cast<std::size_t>(down))
        throw Error(name + ": vertices", std::to_string(mesh.vertices.size()) + " positions",
                    "needed are " + std::to_string(across) + " x " + std::to_string(down));
    check_count(name, "vertices", static_cast<double>(mesh.vertices.size()), 4, ControlMesh::kMaxVertices);
    check_count(name, "levels", static_cast<double>(mesh.levels.size()), 0, ControlMesh::kMaxLevels);
    if (!std::isfinite(amount)) throw Error("amount", text_of(amount), "allowed are finite numbers");
    m_scale = {static_cast<double>(to.width) / from.width, static_cast<double>(to.height) / from.height};

    int before_x = 0, before_y = 0;
    m_x = lines_of(mesh.x_lines, mesh.columns, from.width, mesh.units, name, "x", before_x);
    m_y = lines_of(mesh.y_lines, mesh.rows, from.height, mesh.units, name, "y", before_y);

    // Displacements at the given vertices, then at the lines added around them.
    m_values.resize(m_x.size() * m_y.size());
    auto given = mesh.vertices.begin();
    for (int r = before_y; r < before_y + down; ++r)
        for (int c = before_x; c < before_x + across; ++c)
            value(c, r) = displacement(
                *given++, mesh.units, m_x[static_cast<std::size_t>(c)], m_y[static_cast<std::size_t>(r)],
                amount, [&] { return name + ": vertex " + text_of(c - before_x, r - before_y); });
    extend(before_x, before_y, across, down);
    if (m_values.size() <= kKeptKnots) {
        m_base_knots.reserve(m_values.size());
        for (int r = 0; r <= rows(); ++r)
            for (int c = 0; c <= columns(); ++c) m_base_knots.push_back(compute_knot(c, r));
    }
    if (!mesh.levels.empty()) Refiner(*this, mesh, amount, name, before_x, before_y).build();
    m_orientation = outline_area() < 0 ? -1 : 1;
}

/// Of a vertex at (x, y); `entry()` names it.
template <class Entry>
Point<double> Mesh::displacement(const Point<double>& to, Units units, double x, double y, double amount,
                                 const Entry& entry) const {
    const bool pixels = units == Units::pixels;
    const Point<double> at{pixels ? to.x : to.x * m_to.width, pixels ? to.y : to.y * m_to.height};
    if (!(std::fabs(at.x) <= ControlMesh::kMaxPosition && std::fabs(at.y) <= ControlMesh::kMaxPosition))
        throw Error(entry(), "[" + text_of(to.x) + ", " + text_of(to.y) + "]",
                    "allowed are numbers that stand for at most 1e8 pixels");
    const Point<double> d = (at - Point<double>{x * m_scale.x, y * m_scale.y}) * amount;
    if (!(std::fabs(d.x) <= 1e3 * ControlMesh::kMaxPosition &&
          std::fabs(d.y) <= 1e3 * ControlMesh::kMaxPosition))
        throw Error("amount", text_of(amount), "it moves a vertex by more than 1e11 pixels");
    return d;
}

/// Linear extrapolation to the lines that were added around the given ones.
void Mesh::extend(int before_x, int before_y, int across, int down) {
    const auto beyond = [](const Point<double>& edge, const Point<double>& inner, double at_edge,
                           double at_inner, double at) {
        return edge + (inner - edge) * ((at - at_edge) / (at_inner - at_edge));
    };
    const auto columns_from = [&](int edge, int inner, int to) {
        for (int r = before_y; r < before_y + down; ++r)
            value(to, r) = beyond(value(edge, r), value(inner, r), line(m_x, 0, edge), line(m_x, 0, inner),
                                  line(m_x, 0, to));
    };
    const auto rows_from = [&](int edge, int inner, int to) {
        for (int c = 0; c <= columns(); ++c)
            value(c, to) = beyond(value(c, edge), value(c, inner), line(m_y, 0, edge), line(m_y, 0, inner),
                                  line(m_y, 0, to));
    };
    const int right = before_x + across, bottom = before_y + down;
    if (before_x) columns_from(1, 2, 0);
    if (right <= columns()) columns_from(right - 1, right - 2, right);
    if (before_y) rows_from(1, 2, 0);
    if (bottom <= rows()) rows_from(bottom - 1, bottom - 2, bottom);
}

/// Twice the area that the outline of the mesh surrounds in "to": positive where it runs as in "from".
double Mesh::outline_area() const {
    double area = 0;
    const auto position = [&](int c, int r) {
        return value(c, r) + Point<double>{line(m_x, 0, c) * m_scale.x, line(m_y, 0, r) * m_scale.y};
    };
    Point<double> last = position(0, 0);
    const auto go = [&](int c, int r) {
        const Point<double> next = position(c, r);
        area += last.x * next.y - last.y * next.x;
        last = next;
    };
    for (int c = 1; c <= columns(); ++c) go(c, 0);
    for (int r = 1; r <= rows(); ++r) go(columns(), r);
    for (int c = columns() - 1; c >= 0; --c) go(c, rows());
    for (int r = rows() - 1; r >= 0; --r) go(0, r);
    return area;
}

int Mesh::line_below(const std::vector<double>& lines, double at) {
    const auto next = std::upper_bound(lines.begin() + 1, lines.end() - 1, at);
    return static_cast<int>(next - lines.begin()) - 1;
}

double Mesh::line(const std::vector<double>& lines, int level, int number) {
    const std::size_t below = static_cast<std::size_t>(number >> level);
    const int part = number & ((1 << level) - 1);
    if (part == 0) return lines[below];
    return lines[below] + (lines[below + 1] - lines[below]) * std::ldexp(part, -level);
}

MeshCell Mesh::base_cell(int column, int row) const {
    const auto c = static_cast<std::size_t>(column), r = static_cast<std::size_t>(row);
    return {0, column, row, -1, m_x[c], m_y[r], m_x[c + 1], m_y[r + 1]};
}

MeshCell Mesh::cell_of(int node) const {
    const Node& n = m_nodes[static_cast<std::size_t>(node)];
    return {n.level,
            n.column,
            n.row,
            node,
            line(m_x, n.level, n.column),
            line(m_y, n.level, n.row),
            line(m_x, n.level, n.column + 1),
            line(m_y, n.level, n.row + 1)};
}

int Mesh::child_of(const MeshCell& cell) const {
    if (m_base_child.empty()) return -1;
    if (cell.level > 0) return m_nodes[static_cast<std::size_t>(cell.node)].child;
    return m_base_child[static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(columns()) +
                        static_cast<std::size_t>(cell.column)];
}

MeshCell Mesh::leaf_at(double x, double y, bool left, bool above) const {
    int column = line_below(m_x, x), row = line_below(m_y, y);
    if (left && column > 0 && x == m_x[static_cast<std::size_t>(column)]) --column;
    if (above && row > 0 && y == m_y[static_cast<std::size_t>(row)]) --row;
    MeshCell cell = base_cell(column, row);
    for (int child = child_of(cell); child >= 0; child = child_of(cell)) {
        const MeshCell last = cell_of(child + 3);
        const bool right_half = left ? x > last.x0 : x >= last.x0,
                   lower_half = above ? y > last.y0 : y >= last.y0;
        cell = cell_of(child + (right_half ? 1 : 0) + (lower_half ? 2 : 0));
    }
    return cell;
}

MeshCell Mesh::cell_at(double x, double y) const {
    MeshCell cell = leaf_at(x, y, false, false);
    if (cell.level == 0 || (x != cell.x0 && y != cell.y0)) return cell;
    // On an edge: the coarsest of the cells around.
    for (const auto& [left, above] : {std::pair{true, false}, {false, true}, {true, true}}) {
        const MeshCell other = leaf_at(x, y, left, above);
        if (other.level < cell.level) cell = other;
    }
    return cell;
}

/// Catmull-Rom, eq. 5.8, on the lattice of a level. At the border the vertex itself stands in for the
/// neighbour that is missing: with that one extrapolated linearly the secant is the slope to the other one.
template <class Value>
void Mesh::set_derivatives(Knot& knot, int level, int column, int row, const Value& value_at) const {
    const int left = std::max(column - 1, 0), right = std::min(column + 1, columns() << level);
    const int up = std::max(row - 1, 0), down = std::min(row + 1, rows() << level);
    const double dx = line(m_x, level, right) - line(m_x, level, left);
    const double dy = line(m_y, level, down) - line(m_y, level, up);
    knot.fx = secant(value_at(left, row), value_at(right, row), dx);
    knot.fy = secant(value_at(column, up), value_at(column, down), dy);
    knot.fxy = secant(secant(value_at(left, up), value_at(right, up), dx),
                      secant(value_at(left, down), value_at(right, down), dx), dy);
}

Mesh::Knot Mesh::compute_knot(int column, int row) const {
    Knot knot{value(column, row), {}, {}, {}};
    set_derivatives(knot, 0, column, row, [&](int c, int r) -> const Point<double>& { return value(c, r); });
    return knot;
}

Mesh::Knot Mesh::knot(int column, int row) const {
    return m_base_knots.empty()
               ? compute_knot(column, row)
               : m_base_knots[static_cast<std::size_t>(row) * m_x.size() + static_cast<std::size_t>(column)];
}

Patch Mesh::patch(const MeshCell& cell) const {
    Patch p{cell.x0, cell.y0, cell.x1, cell.y1, {}};
    const double w = cell.x1 - cell.x0, h = cell.y1 - cell.y0;
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const std::size_t i = corner & 1, j = corner >> 1;
        const Knot k = cell.node < 0 ? knot(cell.column + static_cast<int>(i), cell.row + static_cast<int>(j))
                                     : m_knots[static_cast<std::size_t>(
                                           m_nodes[static_cast<std::size_t>(cell.node)].corner[corner])];
        p.g[i][j] = k.f;
        p.g[i + 2][j] = k.fx * w;
        p.g[i][j + 2] = k.fy * h;
        p.g[i + 2][j + 2] = k.fxy * (w * h);
    }
    return p;
}

}  // namespace anamorph
