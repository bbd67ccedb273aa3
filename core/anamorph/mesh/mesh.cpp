// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "anamorph/error.h"
#include "anamorph/mesh/mesh_file.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

// Knots of level 0 are kept for meshes of at most so many vertices, else computed when needed.
constexpr std::size_t kKeptKnots = std::size_t{1} << 20;

std::string text_of(int column, int row) {
    return "[" + std::to_string(column) + ", " + std::to_string(row) + "]";
}

void check_count(const std::string& name, const char* what, double value, double least, double most) {
    if (!(value >= least && value <= most))
        throw Error(name + ": " + what, brief(value), "must be from " + brief(least) + " to " + brief(most));
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
                    "must be " + std::to_string(lines.size()));
    const double unit = units == Units::pixels ? 1 : size;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        lines[i] = given[i] * unit;
        if (!(std::fabs(lines[i]) <= ControlMesh::kMaxPosition) || (i > 0 && !(lines[i] > lines[i - 1])))
            throw Error(name + ": " + key + "[" + std::to_string(i) + "]", brief(given[i]),
                        "positions must ascend");
        // Cells so thin that their derivatives lose all digits.
        if (i > 0 && !(lines[i] - lines[i - 1] >= 1e-6))
            throw Error(name + ": " + key + "[" + std::to_string(i) + "]", brief(given[i]),
                        "lines are at least 1e-6 pixels apart");
    }
    // Lines a hair inside the edge stand on it.
    constexpr double kAtEdge = 1e-6;
    if (lines.front() > 0 && lines.front() <= kAtEdge) lines.front() = 0;
    if (lines.back() < size && lines.back() >= size - kAtEdge) lines.back() = size;
    if (lines.front() > 0) {
        lines.insert(lines.begin(), 0.0);
        before = 1;
    }
    if (lines.back() < size) lines.push_back(size);
    return lines;
}

using Number = Tracked<double>;

/// Are even or given lines what was asked for, without rounding, and, if need be, with room for all their
/// halves?
bool exact_lines(const std::vector<double>& lines, const std::vector<double>& given, int cells, int size,
                 Units units, int before, bool halves) {
    for (int i = 0; i <= cells; ++i) {
        const double line = lines[static_cast<std::size_t>(i + before)];
        const double unit = units == Units::pixels ? 1 : size;
        const double left = given.empty() ? std::fma(line, cells, -static_cast<double>(size) * i)
                                          : std::fma(given[static_cast<std::size_t>(i)], unit, -line);
        constexpr double kRoom = 1 << (52 - 20 - ControlMesh::kMaxLevels);
        const bool room = line * kRoom == std::floor(line * kRoom) && std::fabs(line) < 0x1p20;
        if (left != 0 || (halves && !room)) return false;
    }
    return true;
}

/// Catmull-Rom, eq. 5.8: the secant through the two neighbours.
Point<Number> secant(const Point<Number>& before, const Point<Number>& after, const Number& distance) {
    const Number k = Number(1) / distance;
    return {(after.x - before.x) * k, (after.y - before.y) * k};
}

Point<double> value_of(const Point<Number>& p) {
    return {p.x.value, p.y.value};
}
double error_of(const Point<Number>& p) {
    return std::max(p.x.error, p.y.error);
}
Point<Number> with_error(const Point<double>& p, double error) {
    return {{p.x, error}, {p.y, error}};
}

// This factor covers the rounding of bounds that are sums themselves.
constexpr double kSlack = 1 + 0x1p-40;

}  // namespace

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
                            "must be at most " + std::to_string(ControlMesh::kMaxVertices / 16));
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
    /// The coarser model at vertex (i, j) of the 3 x 3 in a cell.
    Knot model(const MeshCell& cell, int i, int j) const {
        if (i != 1 && j != 1) return m_mesh.knot_at(cell, i / 2 + j / 2 * 2);
        using J = Jet2<Number>;
        const J s = J::variable(0.5 * i, 1, 0), t = J::variable(0.5 * j, 0, 1);
        const Point<J> f = m_mesh.patch(cell)(s, t);
        const ElementErrors errors = m_mesh.element_errors(cell);
        const std::array<J, 4> a = hermite_basis(s), b = hermite_basis(t);
        // A derivative, p times along s and q times along t, with what the elements' errors make of it.
        const auto derivative = [&](int p, int q) {
            double carried = 0;
            for (std::size_t m = 0; m < 4; ++m)
                for (std::size_t n = 0; n < 4; ++n)
                    carried += a[m].at(p, 0).size() * b[n].at(0, q).size() * errors[m][n];
            const auto of = [&](const J& c) {
                return Number(c.at(p, q).value, (c.at(p, q).error + carried) * kSlack);
            };
            return Uncertain{of(f.x), of(f.y)};
        };
        const Number kx = Number(1) / (m_mesh.place(cell.x1) - m_mesh.place(cell.x0)),
                     ky = Number(1) / (m_mesh.place(cell.y1) - m_mesh.place(cell.y0));
        const auto times = [](const Uncertain& p, const Number& by) { return Uncertain{p.x * by, p.y * by}; };
        const Uncertain value = derivative(0, 0), fx = times(derivative(1, 0), kx),
                        fy = times(derivative(0, 1), ky), fxy = times(times(derivative(1, 1), kx), ky);
        return {value_of(value), value_of(fx), value_of(fy), value_of(fxy),
                error_of(value), error_of(fx), error_of(fy), error_of(fxy)};
    }

    /// Values given for a level, as displacements.
    std::map<Place, Uncertain> given_values(int level) const {
        std::map<Place, Uncertain> values;
        const ControlMesh::Level& given = m_given.levels[static_cast<std::size_t>(level - 1)];
        for (std::size_t n = 0; n < given.vertices.size(); ++n) {
            const ControlMesh::Vertex& v = given.vertices[n];
            const std::string entry =
                m_name + ": levels[" + std::to_string(level - 1) + "].vertices[" + std::to_string(n) + "]";
            if (v.column < 0 || v.column > m_given.columns << level || v.row < 0 ||
                v.row > m_given.rows << level)
                throw Error(entry, text_of(v.column, v.row),
                            "must be in columns 0 to " + std::to_string(m_given.columns << level) +
                                " and rows 0 to " + std::to_string(m_given.rows << level));
            const Place place{v.row + (m_before_y << level), v.column + (m_before_x << level)};
            values[place] = m_mesh.displacement(
                v.at, m_given.units, m_mesh.line(m_mesh.m_x, level, place.second),
                m_mesh.line(m_mesh.m_y, level, place.first), m_amount, [&] { return entry; });
        }
        return values;
    }

    void build_level(int level) {
        const std::map<Place, Uncertain> given = given_values(level);
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
                    if (own != given.end() && is_real(v, level)) {
                        knot.f = value_of(own->second);
                        knot.f_error = error_of(own->second);
                    }
                    m_mesh.m_knots.push_back(knot);
                }
        }
        for (const auto& [v, knot] : knots)
            if (is_real(v, level))
                m_mesh.set_derivatives(m_mesh.m_knots[static_cast<std::size_t>(knot)], level, v.second,
                                       v.first, [&](int column, int row) {
                                           const auto k = static_cast<std::size_t>(knots.at({row, column}));
                                           return with_error(m_mesh.m_knots[k].f, m_mesh.m_knots[k].f_error);
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

Mesh::Mesh(const ControlMesh& mesh, const Size& from, const Size& to, double amount, const std::string& name)
    : m_from(from), m_to(to) {
    const bool is_stmap = mesh.width > 0 && mesh.levels.empty();
    const int most_cells = is_stmap ? kMostStMapSide : ControlMesh::kMaxCells;
    check_count(name, "columns", mesh.columns, 1, most_cells);
    check_count(name, "rows", mesh.rows, 1, most_cells);
    const int across = mesh.columns + 1, down = mesh.rows + 1;
    if (mesh.vertex_count() != static_cast<std::size_t>(across) * static_cast<std::size_t>(down))
        throw Error(name + ": vertices", std::to_string(mesh.vertex_count()) + " positions",
                    "must be " + std::to_string(across) + " x " + std::to_string(down));
    check_count(name, "vertices", static_cast<double>(mesh.vertex_count()), 4,
                is_stmap ? kMostStMapVertices : ControlMesh::kMaxVertices);
    check_count(name, "levels", static_cast<double>(mesh.levels.size()), 0, ControlMesh::kMaxLevels);
    if (!std::isfinite(amount)) throw Error("amount", brief(amount), "must be a finite number");
    m_scale = {static_cast<double>(to.width) / from.width, static_cast<double>(to.height) / from.height};

    int before_x = 0, before_y = 0;
    m_x = lines_of(mesh.x_lines, mesh.columns, from.width, mesh.units, name, "x", before_x);
    m_y = lines_of(mesh.y_lines, mesh.rows, from.height, mesh.units, name, "y", before_y);
    m_before = {before_x, before_y};
    const bool halves = !mesh.levels.empty();
    if (exact_lines(m_x, mesh.x_lines, mesh.columns, from.width, mesh.units, before_x, halves) &&
        exact_lines(m_y, mesh.y_lines, mesh.rows, from.height, mesh.units, before_y, halves))
        m_line_rounding = 0;

    // Displacements at the given vertices, then at the lines added around them.
    m_values.resize(m_x.size() * m_y.size());
    m_value_errors.resize(m_values.size());
    std::size_t given = 0;
    for (int r = before_y; r < before_y + down; ++r)
        for (int c = before_x; c < before_x + across; ++c)
            set_value(c, r,
                      displacement(mesh.vertex(given++), mesh.units, m_x[static_cast<std::size_t>(c)],
                                   m_y[static_cast<std::size_t>(r)], amount,
                                   [&] { return name + ": vertex " + text_of(c - before_x, r - before_y); }));
    extend(before_x, before_y, across, down);
    if (m_values.size() <= kKeptKnots) {
        m_base_knots.reserve(m_values.size());
        for (int r = 0; r <= rows(); ++r)
            for (int c = 0; c <= columns(); ++c) m_base_knots.push_back(compute_knot(c, r));
    }
    if (!mesh.levels.empty()) Refiner(*this, mesh, amount, name, before_x, before_y).build();
    m_orientation = turned_area() > 0 ? -1 : 1;
}

/// The displacement of a vertex at (x, y); `entry()` names it.
template <class Entry>
Mesh::Uncertain Mesh::displacement(const Point<double>& to, Units units, double x, double y, double amount,
                                   const Entry& entry) const {
    const bool pixels = units == Units::pixels;
    const Uncertain at{pixels ? Number(to.x) : Number(to.x) * Number(m_to.width),
                       pixels ? Number(to.y) : Number(to.y) * Number(m_to.height)};
    if (!(at.x.size() <= ControlMesh::kMaxPosition && at.y.size() <= ControlMesh::kMaxPosition))
        throw Error(entry(), "[" + brief(to.x) + ", " + brief(to.y) + "]",
                    "must stand for at most 1e8 pixels");
    const auto moved = [&](const Number& there, double line, int to_size, int from_size) {
        return (there - place(line) * (Number(to_size) / Number(from_size))) * Number(amount);
    };
    const Uncertain d{moved(at.x, x, m_to.width, m_from.width), moved(at.y, y, m_to.height, m_from.height)};
    if (!(d.x.size() <= 1e3 * ControlMesh::kMaxPosition && d.y.size() <= 1e3 * ControlMesh::kMaxPosition))
        throw Error("amount", brief(amount), "it moves a vertex by more than 1e11 pixels");
    return d;
}

Mesh::Uncertain Mesh::value(int column, int row) const {
    const std::size_t i = index(column, row);
    return with_error(m_values[i], double{m_value_errors[i]});
}

void Mesh::set_value(int column, int row, const Uncertain& value) {
    const std::size_t i = index(column, row);
    m_values[i] = value_of(value);
    // Upwards, also where float has no number so small.
    m_value_errors[i] = static_cast<float>(error_of(value) * (1 + 0x1p-22) + 1e-37);
}

/// Linear extrapolation to the lines that were added around the given ones.
void Mesh::extend(int before_x, int before_y, int across, int down) {
    const auto beyond = [&](const Uncertain& edge, const Uncertain& inner, double at_edge, double at_inner,
                            double at) {
        const Number k = (place(at) - place(at_edge)) / (place(at_inner) - place(at_edge));
        return Uncertain{edge.x + (inner.x - edge.x) * k, edge.y + (inner.y - edge.y) * k};
    };
    const auto columns_from = [&](int edge, int inner, int to) {
        for (int r = before_y; r < before_y + down; ++r)
            set_value(to, r,
                      beyond(value(edge, r), value(inner, r), line(m_x, 0, edge), line(m_x, 0, inner),
                             line(m_x, 0, to)));
    };
    const auto rows_from = [&](int edge, int inner, int to) {
        for (int c = 0; c <= columns(); ++c)
            set_value(c, to,
                      beyond(value(c, edge), value(c, inner), line(m_y, 0, edge), line(m_y, 0, inner),
                             line(m_y, 0, to)));
    };
    const int right = before_x + across, bottom = before_y + down;
    if (before_x) columns_from(1, 2, 0);
    if (right <= columns()) columns_from(right - 1, right - 2, right);
    if (before_y) rows_from(1, 2, 0);
    if (bottom <= rows()) rows_from(bottom - 1, bottom - 2, bottom);
}

/// The area in "from" of the cells of level 0 that are flipped, less that of those that are not.
double Mesh::turned_area() const {
    const auto position = [&](int c, int r) {
        return m_values[index(c, r)] +
               Point<double>{line(m_x, 0, c) * m_scale.x, line(m_y, 0, r) * m_scale.y};
    };
    double area = 0;
    for (int r = 0; r < rows(); ++r)
        for (int c = 0; c < columns(); ++c) {
            // Twice the area of a quadrilateral is the product of its diagonals.
            const Point<double> p = position(c + 1, r + 1) - position(c, r),
                                q = position(c, r + 1) - position(c + 1, r);
            const double turn = p.x * q.y - p.y * q.x;
            const MeshCell cell = base_cell(c, r);
            area -= (turn > 0) * ((cell.x1 - cell.x0) * (cell.y1 - cell.y0));
            area += (turn < 0) * ((cell.x1 - cell.x0) * (cell.y1 - cell.y0));
        }
    return area;
}

int Mesh::line_below(std::span<const double> lines, double at) {
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
    // A point on an edge belongs to the coarsest of the cells around.
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
    const Number dx = place(line(m_x, level, right)) - place(line(m_x, level, left));
    const Number dy = place(line(m_y, level, down)) - place(line(m_y, level, up));
    const Uncertain fx = secant(value_at(left, row), value_at(right, row), dx);
    const Uncertain fy = secant(value_at(column, up), value_at(column, down), dy);
    const Uncertain fxy = secant(secant(value_at(left, up), value_at(right, up), dx),
                                 secant(value_at(left, down), value_at(right, down), dx), dy);
    knot.fx = value_of(fx);
    knot.fy = value_of(fy);
    knot.fxy = value_of(fxy);
    knot.fx_error = error_of(fx);
    knot.fy_error = error_of(fy);
    knot.fxy_error = error_of(fxy);
}

Mesh::Knot Mesh::compute_knot(int column, int row) const {
    const std::size_t i = index(column, row);
    Knot knot{m_values[i], {}, {}, {}, double{m_value_errors[i]}};
    set_derivatives(knot, 0, column, row, [&](int c, int r) { return value(c, r); });
    return knot;
}

Mesh::Knot Mesh::knot(int column, int row) const {
    return m_base_knots.empty() ? compute_knot(column, row) : m_base_knots[index(column, row)];
}

Mesh::Knot Mesh::knot_at(const MeshCell& cell, int corner) const {
    if (cell.node < 0) return knot(cell.column + (corner & 1), cell.row + (corner >> 1));
    return m_knots[static_cast<std::size_t>(m_nodes[static_cast<std::size_t>(cell.node)].corner[corner])];
}

Patch Mesh::patch(const MeshCell& cell) const {
    Patch p{cell.x0, cell.y0, cell.x1, cell.y1, {}};
    const double w = cell.x1 - cell.x0, h = cell.y1 - cell.y0;
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const std::size_t i = corner & 1, j = corner >> 1;
        const Knot k = knot_at(cell, static_cast<int>(corner));
        p.g[i][j] = k.f;
        p.g[i + 2][j] = k.fx * w;
        p.g[i][j + 2] = k.fy * h;
        p.g[i + 2][j + 2] = k.fxy * (w * h);
    }
    return p;
}

Mesh::ElementErrors Mesh::element_errors(const MeshCell& cell) const {
    const Number w = place(cell.x1) - place(cell.x0), h = place(cell.y1) - place(cell.y0);
    const auto error_times = [](const Point<double>& slope, double error, const Number& by) {
        return (Number(largest(slope), error) * by).error;
    };
    ElementErrors errors{};
    for (std::size_t corner = 0; corner < 4; ++corner) {
        const std::size_t i = corner & 1, j = corner >> 1;
        const Knot k = knot_at(cell, static_cast<int>(corner));
        errors[i][j] = k.f_error;
        errors[i + 2][j] = error_times(k.fx, k.fx_error, w);
        errors[i][j + 2] = error_times(k.fy, k.fy_error, h);
        errors[i + 2][j + 2] = error_times(k.fxy, k.fxy_error, w * h);
    }
    return errors;
}

// Two causes. The elements' own errors: on [0, 1] the basis functions of values sum to 1 and those of slopes
// reach 4/27. And the lines': (x - x0) / (x1 - x0) errs by at most 3 e / (w - 2 e) where a line errs by e,
// which moves a value by that times its derivative; as basis functions of values sum to 1, values count in it
// by their difference from one of them, 3/2 each, and slopes by 1 (the twists by less).
double Mesh::data_error(const MeshCell& cell, const Patch& patch) const {
    const ElementErrors errors = element_errors(cell);
    double most_value = 0, others = 0, steep = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
            const bool value = i < 2 && j < 2;
            const Point<double> g = value ? patch.g[i][j] - patch.g[0][0] : patch.g[i][j];
            steep += (value ? 1.5 : 1) * largest(g);
            if (value)
                most_value = std::max(most_value, errors[i][j]);
            else
                others += errors[i][j] * (4.0 / 27);
        }
    const auto shift = [&](double from, double to) {
        const double e = std::max(place(from).error, place(to).error), room = to - from - 2 * e;
        return room > 0 ? 3 * e / room : HUGE_VAL;
    };
    return (most_value + others + steep * (shift(patch.x0, patch.x1) + shift(patch.y0, patch.y1))) * kSlack;
}

// Bounds errors and sizes with d and e, the largest displacement of a vertex around and its error: a slope
// spans the cell, so that it is at most 2 d in units of it, and a twist 4 d; together with the four values
// 36 d, and 36 e. A slope's own rounding is that of both its spans, at most 12 lines' rounding over the
// cell's, and 8 u; twists twice that.
Mesh::Rough Mesh::rough(double x0, double y0, double x1, double y1) const {
    const int c0 = std::max(line_below(m_x, x0) - 1, 0), c1 = std::min(line_below(m_x, x1) + 2, columns());
    const int r0 = std::max(line_below(m_y, y0) - 1, 0), r1 = std::min(line_below(m_y, y1) + 2, rows());
    Point<double> low = m_values[index(c0, r0)], high = low;
    float e = 0;
    for (int r = r0; r <= r1; ++r)
        for (std::size_t i = index(c0, r); i <= index(c1, r); ++i) {
            const Point<double>& f = m_values[i];
            low = {std::min(low.x, f.x), std::min(low.y, f.y)};
            high = {std::max(high.x, f.x), std::max(high.y, f.y)};
            e = std::max(e, m_value_errors[i]);
        }
    const double d = std::max(largest(low), largest(high));
    double shift = 0;
    const auto look = [&](const std::vector<double>& lines, int first, int last) {
        for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
            const double of_line = std::max(place(lines[i]).error, place(lines[i + 1]).error);
            const double room = lines[i + 1] - lines[i] - 2 * of_line;
            shift = std::max(shift, room > 0 ? of_line / room : HUGE_VAL);
        }
    };
    look(m_x, c0, c1);
    look(m_y, r0, r1);
    const double size = 36 * d, slopes = 24 * shift + 16 * 0x1p-53, parameters = 2 * 1.5 * 3 * shift;
    return {(36 * double{e} + size * (slopes + parameters)) * kSlack, size, low, high};
}

}  // namespace anamorph
