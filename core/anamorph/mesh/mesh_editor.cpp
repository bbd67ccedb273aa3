// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/mesh_editor.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "anamorph/error.h"
#include "anamorph/mesh/cells.h"
#include "anamorph/number/hypot.h"
#include "anamorph/plan/block_writer.h"

namespace anamorph {
namespace {

template <class Body>
void each_cell_of_all(const Mesh& mesh, const Body& body) {
    mesh.each_cell(0, 0, mesh.from().width, mesh.from().height, body);
}

ControlMesh checked(ControlMesh mesh, const std::string& name) {
    if (mesh.samples)
        throw Error(name + " is an ST-map taken pixel for pixel: must be a mesh, as every step-th pixel is");
    return mesh;
}

/// The vertices of all levels.
std::size_t vertex_count(const ControlMesh& mesh) {
    std::size_t count = mesh.vertices.size();
    for (const auto& level : mesh.levels) count += level.vertices.size();
    return count;
}

/// Is every cell around a vertex of `level` at least as fine?
bool is_free(const Mesh& map, int level, int column, int row) {
    const Point<double> at = map.lattice_place(level, column, row);
    for (const bool left : {false, true})
        for (const bool above : {false, true})
            if (map.leaf_at(at.x, at.y, left, above).level < level) return false;
    return true;
}

/// Does the outline of a cell, as edges() draws it, go around a position? By how often a line from there to the right crosses it.
bool shows_at(const Mesh& map, const MeshCell& cell, const Point<double>& at) {
    const Patch patch = map.patch(cell);
    bool inside = false;
    Point<double> last = map.inside(patch, 0.0, 0.0);
    for (int edge = 0; edge < 4; ++edge)
        for (int i = 1; i <= kMeshEdgeSteps; ++i) {
            const Point<double> next = on_mesh_edge(map, patch, edge, double(i) / kMeshEdgeSteps);
            if ((last.y > at.y) != (next.y > at.y) &&
                at.x < last.x + (next.x - last.x) * ((at.y - last.y) / (next.y - last.y)))
                inside = !inside;
            last = next;
        }
    return inside;
}

}  // namespace

MeshEditor::MeshEditor(ControlMesh mesh, const Size& from, const Size& to, const std::string& name)
    : m_from(from),
      m_to(to),
      m_name(name),
      m_state{checked(std::move(mesh), name), {}},
      m_map(m_state.mesh, from, to, 1, name) {
    find_points();
}

/// Takes a mesh in place of the one before, whole or, where it is refused, not at all.
void MeshEditor::take(ControlMesh mesh) {
    Mesh map(mesh, m_from, m_to, 1, m_name);
    m_state.mesh = std::move(mesh);
    m_map = std::move(map);
    find_points();
}

void MeshEditor::find_points() {
    std::map<Place, bool> places;
    const Size before = m_map.lines_before();
    const ControlMesh& mesh = m_state.mesh;
    each_cell_of_all(m_map, [&](const MeshCell& cell) {
        for (int corner = 0; corner < 4; ++corner) {
            Place at{cell.level, cell.column + (corner & 1), cell.row + (corner >> 1)};
            for (; at.level > 0 && at.column % 2 == 0 && at.row % 2 == 0; --at.level)
                at.column /= 2, at.row /= 2;
            const bool is_fixed = !is_free(m_map, at.level, at.column, at.row);
            at.column -= before.width << at.level;
            at.row -= before.height << at.level;
            if (at.column < 0 || at.row < 0 || at.column > mesh.columns << at.level ||
                at.row > mesh.rows << at.level)
                continue;
            places.emplace(at, is_fixed);
        }
    });
    m_points.clear();
    for (const auto& [place, is_fixed] : places) {
        const Point<double> at =
            m_map.lattice_place(place.level, place.column + (before.width << place.level),
                                place.row + (before.height << place.level));
        m_points.push_back({place, m_map.at(at.x, at.y), is_fixed});
    }
    std::erase_if(m_state.selected, [&](const Place& place) {
        const auto found = places.find(place);
        return found == places.end() || found->second;
    });
}

std::vector<std::vector<Point<double>>> MeshEditor::edges() const {
    std::vector<std::vector<Point<double>>> edges;
    for (MeshEdge& edge : mesh_edges(m_map, true)) edges.push_back(std::move(edge.line));
    return edges;
}

std::optional<MeshEditor::Place> MeshEditor::point_near(const Point<double>& at, double within) const {
    std::optional<Place> nearest;
    for (const ControlPoint& point : m_points) {
        const double far = hypot(point.at.x - at.x, point.at.y - at.y);
        if (point.is_fixed || !(far <= within)) continue;
        within = far;
        nearest = point.place;
    }
    return nearest;
}

void MeshEditor::select(const Place& place, Selecting how) {
    const auto is_it = [&](const ControlPoint& point) { return point.place == place && !point.is_fixed; };
    if (std::none_of(m_points.begin(), m_points.end(), is_it)) return;
    select_places({place}, how, m_state.selected);
}

void MeshEditor::select_in(const Bounds& box, Selecting how) {
    std::vector<Place> inside;
    for (const ControlPoint& point : m_points) {
        const Point<double>& at = point.at;
        if (!point.is_fixed && at.x >= box.x0 && at.x <= box.x1 && at.y >= box.y0 && at.y <= box.y1)
            inside.push_back(point.place);
    }
    select_places(inside, how, m_state.selected);
}

/// A point of a level may stand in the lists of finer levels as well, of which the finest counts that the map takes it from.
MeshEditor::Handle MeshEditor::handle_of(ControlMesh& mesh, const Place& place) const {
    const auto found_in = [&](int level) -> std::optional<std::size_t> {
        const std::vector<ControlMesh::Vertex>& all =
            mesh.levels[static_cast<std::size_t>(level - 1)].vertices;
        const int column = place.column << (level - place.level), row = place.row << (level - place.level);
        const Size before = m_map.lines_before();
        if (!is_free(m_map, level, column + (before.width << level), row + (before.height << level)))
            return {};
        // Of several the last counts.
        for (std::size_t i = all.size(); i-- > 0;)
            if (all[i].column == column && all[i].row == row) return i;
        return {};
    };
    const auto at = [&](int level, std::size_t i) {
        return mesh.levels[static_cast<std::size_t>(level - 1)].vertices[i].at;
    };
    for (int level = static_cast<int>(mesh.levels.size()); level > 0 && level >= place.level; --level)
        if (const auto i = found_in(level)) return {level, *i, at(level, *i)};
    if (place.level == 0) {
        const auto i = static_cast<std::size_t>(place.row) * (static_cast<std::size_t>(mesh.columns) + 1) +
                       static_cast<std::size_t>(place.column);
        return {0, i, mesh.vertices[i]};
    }
    const auto point =
        std::lower_bound(m_points.begin(), m_points.end(), place,
                         [](const ControlPoint& p, const Place& than) { return p.place < than; });
    const bool parts = mesh.units == Units::fractions;
    const Point<double> here{point->at.x / (parts ? m_to.width : 1), point->at.y / (parts ? m_to.height : 1)};
    std::vector<ControlMesh::Vertex>& all = mesh.levels[static_cast<std::size_t>(place.level - 1)].vertices;
    all.push_back({place.column, place.row, here});
    return {place.level, all.size() - 1, here};
}

void MeshEditor::start_drag() {
    State before = m_state;
    ControlMesh mesh = m_state.mesh;
    std::vector<Handle> handles;
    for (const Place& place : m_state.selected) handles.push_back(handle_of(mesh, place));
    m_state.mesh = std::move(mesh);
    m_handles = std::move(handles);
    m_before = std::move(before);
}

void MeshEditor::drag(const Point<double>& by) {
    if (m_state.selected.empty()) return;
    const bool starts = !m_before;
    if (starts) start_drag();
    ControlMesh mesh = m_state.mesh;
    const bool parts = mesh.units == Units::fractions;
    const Point<double> step{by.x / (parts ? m_to.width : 1), by.y / (parts ? m_to.height : 1)};
    for (const Handle& handle : m_handles)
        (handle.level == 0
             ? mesh.vertices[handle.index]
             : mesh.levels[static_cast<std::size_t>(handle.level - 1)].vertices[handle.index].at) =
            handle.from + step;
    try {
        take(std::move(mesh));
    } catch (...) {
        if (starts) {
            m_state = std::move(*m_before);
            m_before.reset();
        }
        throw;
    }
}

void MeshEditor::end_drag(bool keep) {
    if (!m_before) return;
    State before = std::move(*m_before);
    m_before.reset();
    if (keep) return keep_step(std::move(before));
    take(std::move(before.mesh));
}

bool MeshEditor::cut_at(const Point<double>& at) {
    end_drag();
    std::optional<MeshCell> cell;
    each_cell_of_all(m_map, [&](const MeshCell& c) {
        if ((!cell || c.level >= cell->level) && shows_at(m_map, c, at)) cell = c;
    });
    if (!cell) return false;
    const Size before = m_map.lines_before();
    const int column = cell->column - (before.width << cell->level),
              row = cell->row - (before.height << cell->level);
    const ControlMesh& now = m_state.mesh;
    if (column < 0 || row < 0 || column >= now.columns << cell->level || row >= now.rows << cell->level)
        return false;
    ControlMesh mesh = now;
    const auto level = static_cast<std::size_t>(cell->level);
    if (level == mesh.levels.size()) mesh.levels.emplace_back();
    mesh.levels[level].cells.push_back({column, row});
    State was = m_state;
    take(std::move(mesh));
    keep_step(std::move(was));
    return true;
}

void MeshEditor::keep_step(State before) {
    m_steps.keep(std::move(before));
    const auto vertices = [this] {
        return std::accumulate(
            m_steps.kept().begin(), m_steps.kept().end(), std::size_t{0},
            [](std::size_t sum, const State& state) { return sum + vertex_count(state.mesh); });
    };
    while (steps() > 1 && vertices() > ControlMesh::kMaxVertices) m_steps.forget_first();
}

bool MeshEditor::restore(std::optional<State> state) {
    if (!state) return false;
    m_state.selected = std::move(state->selected);
    take(std::move(state->mesh));
    return true;
}

namespace {

/// The blocks that a box meets, where they are not cut at the edges of cells.
Box with_blocks(const Box& box) {
    static_assert(BlockMap::kRegion % BlockWriter::kWidth == 0 &&
                  BlockMap::kRegion % BlockWriter::kHeight == 0);
    const auto down = [](int at, int side) { return std::max(at, 0) / side * side; };
    const auto up = [&](int at, int side) { return down(at + side - 1, side); };
    return {down(box.x0, BlockWriter::kWidth), down(box.y0, BlockWriter::kHeight),
            up(box.x1, BlockWriter::kWidth), up(box.y1, BlockWriter::kHeight)};
}

}  // namespace

std::vector<Box> changed_pixels(const Mesh& before, const Mesh& after) {
    const Box whole{0, 0, after.from().width, after.from().height};
    std::vector<Box> boxes;
    double cells = 0;
    each_cell_of(after, whole, [&](const MeshCell& cell, const Box& part) {
        ++cells;
        const MeshCell was = before.leaf_at(0.5 * (cell.x0 + cell.x1), 0.5 * (cell.y0 + cell.y1));
        const Patch a = before.patch(was), b = after.patch(cell);
        if (std::memcmp(&a, &b, sizeof a) == 0) return;
        // Pixels on an edge may be read in the neighbour; and blocks of exact pixels lie across cells.
        const Box box = intersection(with_blocks(widened(part, {1, 1})), whole);
        if (!boxes.empty() && boxes.back().y0 == box.y0 && boxes.back().y1 == box.y1 &&
            boxes.back().x1 >= box.x0 && boxes.back().x0 <= box.x0)
            boxes.back().x1 = std::max(boxes.back().x1, box.x1);
        else
            boxes.push_back(box);
    });
    // Cells of a few pixels are not drawn cell by cell.
    const bool small = double(whole.width()) * whole.height() < BlockWriter::kFloorPixels * cells;
    if (!boxes.empty() && (small || before.has_levels() != after.has_levels())) return {whole};
    return boxes;
}

}  // namespace anamorph
