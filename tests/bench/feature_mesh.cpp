// SPDX-License-Identifier: Apache-2.0
#include "feature_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "anamorph/mesh/mesh.h"

namespace anamorph {
namespace {

using RowColumn = std::pair<int, int>;

/// Does a line meet a rectangle? By cutting it at the rectangle's sides (Liang and Barsky).
bool meets(const FeatureMap::TargetLine& line, double x0, double y0, double x1, double y1) {
    double from = 0, to = line.length;
    const auto cut = [&](double at, double step, double low, double high) {
        if (step == 0) return at >= low && at <= high;
        const double a = (low - at) / step, b = (high - at) / step;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
        return from <= to;
    };
    return cut(line.p.x, line.along.x, x0, x1) && cut(line.p.y, line.along.y, y0, y1);
}

}  // namespace

struct FeatureMesh::State {
    const FeatureMap& map;
    int cells;
    std::vector<ControlMesh> controls;  ///< one a shape of the map
    std::vector<Mesh> meshes;           ///< one a layer
    std::int64_t evaluations = 0;

    State(const FeatureMap& feature_map, int cell_count, int levels, const std::vector<int>& wanted)
        : map(feature_map), cells(cell_count) {
        controls.resize(static_cast<std::size_t>(map.shapes()));
        for (ControlMesh& control : controls) control.columns = control.rows = cells;
        for (int row = 0; row <= cells; ++row)
            for (int column = 0; column <= cells; ++column)
                evaluate(0, row, column,
                         [](ControlMesh& c, int, int, const Point<double>& at) { c.vertices.push_back(at); });
        std::set<RowColumn> parents;
        for (int level = 1; level <= levels; ++level) parents = refine(level, parents);
        const Size target = map.target();
        for (const int k : wanted)
            meshes.emplace_back(controls[static_cast<std::size_t>(k)], Size{target.width, target.height},
                                Size{map.picture(k).width, map.picture(k).height}, 1.0);
    }

    double line_at(int size, int level, int number) const {
        return static_cast<double>(size) * number / (cells << level);
    }

    template <class Put>
    void evaluate(int level, int row, int column, const Put& put) {
        std::vector<Point<double>> points(controls.size());
        map.all(line_at(map.target().width, level, column), line_at(map.target().height, level, row),
                points.data());
        ++evaluations;
        for (std::size_t k = 0; k < controls.size(); ++k) put(controls[k], column, row, points[k]);
    }

    /// Cuts the cells of the level above that a line meets, and evaluates their new vertices; those beside a
    /// cell that is not cut take the coarser patch's value. Returns the cells cut.
    std::set<RowColumn> refine(int level, const std::set<RowColumn>& parents) {
        const auto is_cell = [&](int row, int column) {
            return level == 1 || parents.count({row / 2, column / 2}) != 0;
        };
        const int count = cells << (level - 1);
        std::set<RowColumn> cut;
        for (std::size_t i = 0; i < map.size(); ++i) mark(map.line(i), level - 1, count, is_cell, cut);
        for (ControlMesh& control : controls) {
            control.levels.emplace_back();
            for (const auto& [row, column] : cut) control.levels.back().cells.push_back({column, row});
        }
        const auto is_cut = [&](int row, int column) {
            return row < 0 || column < 0 || row >= count || column >= count || cut.count({row, column});
        };
        std::set<RowColumn> vertices;
        for (const auto& [row, column] : cut)
            for (const RowColumn& v :
                 {RowColumn{2 * row, 2 * column + 1}, RowColumn{2 * row + 1, 2 * column},
                  RowColumn{2 * row + 1, 2 * column + 1}, RowColumn{2 * row + 1, 2 * column + 2},
                  RowColumn{2 * row + 2, 2 * column + 1}})
                if (is_cut((v.first - 1) >> 1, (v.second - 1) >> 1) &&
                    is_cut((v.first - 1) >> 1, v.second >> 1) && is_cut(v.first >> 1, (v.second - 1) >> 1) &&
                    is_cut(v.first >> 1, v.second >> 1))
                    vertices.insert(v);
        for (const auto& [row, column] : vertices)
            evaluate(level, row, column, [](ControlMesh& c, int i, int j, const Point<double>& at) {
                c.levels.back().vertices.push_back({i, j, at});
            });
        return cut;
    }

    template <class IsCell>
    void mark(const FeatureMap::TargetLine& line, int level, int count, const IsCell& is_cell,
              std::set<RowColumn>& cut) const {
        const auto range = [&](double a, double b, int size, int& first, int& last) {
            const double unit = static_cast<double>(size) / count;
            first = static_cast<int>(std::clamp(std::floor(std::min(a, b) / unit), 0.0, count - 1.0));
            last = static_cast<int>(std::clamp(std::floor(std::max(a, b) / unit), 0.0, count - 1.0));
        };
        const Point<double> q{line.p.x + line.along.x * line.length, line.p.y + line.along.y * line.length};
        const Size size = map.target();
        int c0, c1, r0, r1;
        range(line.p.x, q.x, size.width, c0, c1);
        range(line.p.y, q.y, size.height, r0, r1);
        for (int row = r0; row <= r1; ++row)
            for (int column = c0; column <= c1; ++column)
                if (is_cell(row, column) &&
                    meets(line, line_at(size.width, level, column), line_at(size.height, level, row),
                          line_at(size.width, level, column + 1), line_at(size.height, level, row + 1)))
                    cut.insert({row, column});
    }

    /// The points of pixels `box` of a block, less the block's base.
    void fill(const Block& block, const Box& box, const PointRows& to) const {
        const Mesh& mesh = meshes[static_cast<std::size_t>(block.piece)];
        mesh.each_cell(box.x0, box.y0, box.x1, box.y1,
                       [&](const MeshCell& cell) { fill(mesh, cell, block, box, to); });
    }

    /// Those that lie in one cell.
    static void fill(const Mesh& mesh, const MeshCell& cell, const Block& block, const Box& box,
                     const PointRows& to) {
        const Patch patch = mesh.patch(cell);
        const auto first = [](double edge) { return static_cast<int>(std::ceil(edge - 0.5)); };
        const double kx = 1 / (patch.x1 - patch.x0), ky = 1 / (patch.y1 - patch.y0);
        const int i0 = std::max(first(cell.x0), box.x0), i1 = std::min(first(cell.x1), box.x1);
        for (int j = std::max(first(cell.y0), box.y0); j < std::min(first(cell.y1), box.y1); ++j) {
            // The patch on this row, as a cubic in s (eq. 5.2 in powers).
            const std::array<double, 4> b = hermite_basis((j + 0.5 - patch.y0) * ky);
            Point<double> row[4];
            for (int a = 0; a < 4; ++a)
                for (std::size_t n = 0; n < 4; ++n)
                    row[a] = {n ? row[a].x + b[n] * patch.g[a][n].x : b[n] * patch.g[a][n].x,
                              n ? row[a].y + b[n] * patch.g[a][n].y : b[n] * patch.g[a][n].y};
            const auto cubic = [&](double f0, double f1, double d0, double d1, double* c) {
                c[0] = f0;
                c[1] = d0;
                c[2] = 3 * (f1 - f0) - 2 * d0 - d1;
                c[3] = 2 * (f0 - f1) + d0 + d1;
            };
            double cx[4], cy[4];
            cubic(row[0].x, row[1].x, row[2].x, row[3].x, cx);
            cubic(row[0].y, row[1].y, row[2].y, row[3].y, cy);
            float* const to_x = to.x + (j - box.y0) * to.stride - box.x0;
            float* const to_y = to.y + (j - box.y0) * to.stride - box.x0;
            const double y = (j + 0.5) * mesh.scale().y - block.base_y;
            for (int i = i0; i < i1; ++i) {
                const double s = (i + 0.5 - patch.x0) * kx;
                to_x[i] = static_cast<float>((i + 0.5) * mesh.scale().x - block.base_x + cx[0] +
                                             s * (cx[1] + s * (cx[2] + s * cx[3])));
                to_y[i] = static_cast<float>(y + cy[0] + s * (cy[1] + s * (cy[2] + s * cy[3])));
            }
        }
    }
};

FeatureMesh::FeatureMesh(const FeatureMap& map, int cells, int levels, const std::vector<int>& shapes)
    : FeatureBlocks(map, shapes, {}), m_state(std::make_unique<State>(map, cells, levels, shapes)) {}
FeatureMesh::~FeatureMesh() = default;

std::int64_t FeatureMesh::evaluations() const {
    return m_state->evaluations;
}

void FeatureMesh::plan(const Box& region, int, Blocks& blocks) const {
    Block block;
    block.kind = Block::Kind::computed;
    block.bound = std::numeric_limits<double>::infinity();
    each_square(region, [&](const Box& box) {
        block.box = box;
        for (block.piece = 0; block.piece < layers(); ++block.piece) {
            const Mesh& mesh = m_state->meshes[static_cast<std::size_t>(block.piece)];
            const Point<double> middle = mesh.at(0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1));
            const auto base = [](double at) {
                return static_cast<std::int32_t>(std::floor(std::clamp(at, -1e9, 1e9)));
            };
            block.base_x = base(middle.x);
            block.base_y = base(middle.y);
            blocks.push_back(block);
        }
    });
}

void FeatureMesh::computed_row(const Block& block, int row, int begin, int end, float* x,
                               float* y) const noexcept {
    const Box& b = block.box;
    m_state->fill(block, {b.x0 + begin, b.y0 + row, b.x0 + end, b.y0 + row + 1}, {x, y, end - begin});
}

void FeatureMesh::computed(std::span<const Block> layers, const PointRows* to) const noexcept {
    for (const Block& block : layers) m_state->fill(block, block.box, *to++);
}

}  // namespace anamorph
