// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/morph_unit.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace anamorph::machine {
namespace {

using Place = std::pair<int, int>;  ///< column and row

/// Does a line meet a rectangle, edges included?
bool meets(const FeatureMap::TargetLine& line, double x0, double y0, double x1, double y1) {
    double from = 0, to = line.length;
    const auto cut = [&](double at, double rate, double low, double high) {
        if (rate == 0) return at >= low && at <= high;
        const double a = (low - at) / rate, b = (high - at) / rate;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
        return from <= to;
    };
    return cut(line.p.x, line.along.x, x0, x1) && cut(line.p.y, line.along.y, y0, y1);
}

/// The levels of a mesh about features.
class Refinement {
  public:
    Refinement(const FeatureMap& map, const MorphUnit& unit) : m_map(map), m_cells(unit.cells) {
        std::set<Place> parents;
        for (int row = 0; row < m_cells; ++row)
            for (int column = 0; column < m_cells; ++column) parents.insert({column, row});
        for (int level = 1; level <= unit.levels; ++level) {
            std::set<Place> cut, children;
            for (const Place& cell : parents)
                if (is_near(cell, level - 1)) cut.insert(cell);
            for (const auto& [column, row] : cut)
                for (const int i : {0, 1})
                    for (const int j : {0, 1}) children.insert({2 * column + i, 2 * row + j});
            if (cut.empty()) break;
            m_cut.push_back(std::move(cut));
            parents = std::move(children);
        }
    }

    /// Of each level from 1 on, the cells of the level before that are cut.
    const std::vector<std::set<Place>>& cut() const { return m_cut; }
    /// The vertices that a level adds, but for those on a cell that is not cut, which have the coarser mesh's values.
    std::vector<Place> added(std::size_t level) const {
        const std::set<Place>& cut = m_cut[level - 1];
        std::set<Place> vertices;
        for (const auto& [column, row] : cut)
            for (const int i : {0, 1, 2})
                for (const int j : {0, 1, 2})
                    if ((i == 1 || j == 1) && is_free({2 * column + i, 2 * row + j}, level))
                        vertices.insert({2 * column + i, 2 * row + j});
        return {vertices.begin(), vertices.end()};
    }
    /// The point of a vertex of a level's lattice.
    Point<double> point(const Place& vertex, int level) const {
        const double cells = std::ldexp(m_cells, level);
        return {vertex.first * m_map.target().width / cells, vertex.second * m_map.target().height / cells};
    }

  private:
    bool is_near(const Place& cell, int level) const {
        const Point<double> a = point(cell, level), b = point({cell.first + 1, cell.second + 1}, level);
        for (std::size_t i = 0; i < m_map.size(); ++i)
            if (meets(m_map.line(i), a.x, a.y, b.x, b.y)) return true;
        return false;
    }
    /// Are all cells of the level before that have the vertex on them cut?
    bool is_free(const Place& vertex, std::size_t level) const {
        const int most = m_cells << (level - 1);
        const auto [x, y] = vertex;
        for (const int column : {(x - 1) >> 1, x >> 1})
            for (const int row : {(y - 1) >> 1, y >> 1}) {
                const bool inside = column >= 0 && row >= 0 && column < most && row < most;
                if (inside && m_cut[level - 1].count({column, row}) == 0) return false;
            }
        return true;
    }

    const FeatureMap& m_map;
    int m_cells;
    std::vector<std::set<Place>> m_cut;
};

NearFarOptions exactly(int shape) {
    NearFarOptions options;
    options.tol = 0;
    options.shapes = {shape};
    return options;
}

ShaderUnit with_alpha(ShaderUnit unit, double alpha) {
    unit.alpha = alpha;
    return unit;
}

}  // namespace

MorphMeshes morph_meshes(const FeatureMap& map, const MorphUnit& unit) {
    const auto shapes = static_cast<std::size_t>(map.shapes());
    MorphMeshes made;
    made.meshes.resize(shapes);
    for (ControlMesh& mesh : made.meshes) mesh.columns = mesh.rows = unit.cells;
    const Refinement refinement(map, unit);
    std::vector<Point<double>> at(shapes);
    const auto evaluate = [&](const Point<double>& p) {
        map.all(p.x, p.y, at.data());
        ++made.evaluations;
    };
    for (int row = 0; row <= unit.cells; ++row)
        for (int column = 0; column <= unit.cells; ++column) {
            evaluate(refinement.point({column, row}, 0));
            for (std::size_t k = 0; k < shapes; ++k) made.meshes[k].vertices.push_back(at[k]);
        }
    for (std::size_t level = 1; level <= refinement.cut().size(); ++level) {
        ControlMesh::Level shared;
        for (const auto& [column, row] : refinement.cut()[level - 1]) shared.cells.push_back({column, row});
        for (ControlMesh& mesh : made.meshes) mesh.levels.push_back(shared);
        for (const Place& vertex : refinement.added(level)) {
            evaluate(refinement.point(vertex, static_cast<int>(level)));
            for (std::size_t k = 0; k < shapes; ++k)
                made.meshes[k].levels.back().vertices.push_back({vertex.first, vertex.second, at[k]});
        }
    }
    return made;
}

MorphWarp::MorphWarp(const std::shared_ptr<const FeatureMap>& map, int shape, const ControlMesh& mesh,
                     const MorphUnit& unit, double alpha)
    : MorphWarp(std::shared_ptr<const Exact>(new Exact{map, NearFar(*map, exactly(shape))}), shape, mesh,
                unit, alpha) {}

MorphWarp::MorphWarp(std::shared_ptr<const Exact> exact, int shape, const ControlMesh& mesh,
                     const MorphUnit& unit, double alpha)
    : MachineMap({exact, &exact->blocks}, {{0, 0, exact->blocks.width(), exact->blocks.height()}},
                 exact->map->picture(shape), HUGE_VAL, unit.shader.address_bits),
      m_exact(exact),
      m_warp(Mesh(mesh, exact->map->target(), exact->map->picture(shape), 1, "the morph's mesh"),
             with_alpha(unit.shader, alpha)) {}

UnitCoordinates MorphWarp::coordinates(int x, int y, int) const {
    return m_warp.texture_coordinates(x, y);
}

double MorphWarp::rounding(const Box& box, int) const {
    return most_bound(m_exact->blocks, box);
}

double blended(const NumberFormat& buffer, double color, double alpha, double below) {
    const double of = nearest(buffer, alpha);
    return nearest(buffer, nearest(buffer, color) * of + below * (1 - of));
}

}  // namespace anamorph::machine
