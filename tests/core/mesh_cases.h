// SPDX-License-Identifier: Apache-2.0
// Meshes for tests: random ones, and those that are hard.
#pragma once

#include <random>
#include <string>
#include <utility>
#include <vector>

#include "anamorph/mesh/mesh.h"

namespace anamorph::test {

/// A source of random numbers, the same on every machine.
class Random {
  public:
    explicit Random(unsigned seed) : m_random(seed) {}
    double between(double low, double high) {
        return low + (high - low) * (static_cast<double>(m_random()) / 4294967296.0);
    }
    int whole(int low, int high) {
        return low + static_cast<int>(m_random() % static_cast<unsigned>(high - low + 1));
    }

  private:
    std::mt19937 m_random;
};

/// A mesh of evenly spaced vertices that stay where they are.
inline ControlMesh identity_mesh(const Size& size, int columns, int rows) {
    ControlMesh mesh;
    mesh.columns = columns;
    mesh.rows = rows;
    for (int r = 0; r <= rows; ++r)
        for (int c = 0; c <= columns; ++c)
            mesh.vertices.push_back({double(size.width) * c / columns, double(size.height) * r / rows});
    return mesh;
}

/// A mesh of vertices moved by up to `amplitude` cells; lines at random places if `uneven`; `levels` finer
/// levels, each with some cells cut and some of their vertices moved.
inline ControlMesh random_mesh(Random& random, const Size& from, const Size& to, int columns, int rows,
                               double amplitude, bool uneven, int levels) {
    ControlMesh mesh = identity_mesh(to, columns, rows);
    const double dx = amplitude * to.width / columns, dy = amplitude * to.height / rows;
    const auto move = [&](Point<double>& p, double by) {
        p.x += random.between(-dx, dx) * by;
        p.y += random.between(-dy, dy) * by;
    };
    for (Point<double>& p : mesh.vertices) move(p, 1);
    if (uneven) {
        const auto lines = [&](int cells, int size) {
            std::vector<double> at{random.between(-3, 0.1 * size)};
            for (int i = 0; i < cells; ++i) at.push_back(at.back() + random.between(0.3, 1.1) * size / cells);
            return at;
        };
        mesh.x_lines = lines(columns, from.width);
        mesh.y_lines = lines(rows, from.height);
    }
    for (int k = 1; k <= levels; ++k) {
        ControlMesh::Level level;
        const int n = std::max(1, columns * rows / 3);
        std::vector<ControlMesh::Cell> parents;
        if (k == 1) {
            for (int i = 0; i < n; ++i)
                parents.push_back({random.whole(0, columns - 1), random.whole(0, rows - 1)});
        } else {
            for (const ControlMesh::Cell& c : mesh.levels.back().cells)
                parents.push_back({2 * c.column + random.whole(0, 1), 2 * c.row + random.whole(0, 1)});
        }
        for (const ControlMesh::Cell& c : parents) {
            level.cells.push_back(c);
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i) {
                    const int column = 2 * c.column + i, row = 2 * c.row + j;
                    Point<double> at{double(to.width) * column / (columns << k),
                                     double(to.height) * row / (rows << k)};
                    move(at, 0.3 / k);
                    if (random.whole(0, 2)) level.vertices.push_back({column, row, at});
                }
        }
        mesh.levels.push_back(level);
    }
    return mesh;
}

/// Meshes that break those who sample, each with its name.
inline std::vector<std::pair<std::string, ControlMesh>> hard_meshes(const Size& from, const Size& to) {
    std::vector<std::pair<std::string, ControlMesh>> meshes;
    const auto add = [&](const char* name, int columns, int rows, const auto& move) {
        ControlMesh mesh = identity_mesh(to, columns, rows);
        for (int r = 0; r <= rows; ++r)
            for (int c = 0; c <= columns; ++c)
                move(c, r, mesh.vertices[static_cast<std::size_t>(r * (columns + 1) + c)]);
        meshes.emplace_back(name, mesh);
    };
    add("two by two vertices", 1, 1,
        [&](int c, int r, Point<double>& p) { p.x += 30 * r, p.y -= 50 * c * r; });
    add("two by two cells", 2, 2, [&](int c, int r, Point<double>& p) {
        if (c == 1 && r == 1) p = {p.x + 60, p.y - 70};
    });
    // Midpoints of cells are where an odd map agrees with its chord.
    add("odd symmetric", 4, 4, [&](int c, int r, Point<double>& p) {
        p.x += (c % 2 ? 25 : -25);
        p.y += (r % 2 ? -25 : 25);
    });
    add("folded", 4, 3, [&](int c, int, Point<double>& p) {
        if (c == 1 || c == 2) p.x = to.width - p.x * 0.7;
    });
    add("all in one point", 3, 3, [&](int, int, Point<double>& p) { p = {to.width / 2.0, to.height / 3.0}; });
    add("far away", 3, 3, [&](int c, int r, Point<double>& p) { p = {1e8 - 3 * c, -1e8 + r * 7}; });
    add("one vertex far away", 5, 5, [&](int c, int r, Point<double>& p) {
        if (c == 2 && r == 3) p = {-1e8, 1e8};
    });
    add("a needle", 7, 6, [&](int c, int r, Point<double>& p) {
        if (c == 3 && r == 3) p.x += 5000;
    });
    // A mesh that covers a small part of the target, so that most of it is extrapolated.
    add("in a corner", 2, 2, [&](int c, int r, Point<double>& p) {
        p = {10.0 + 9 * c * c, 20.0 + 5 * r + c};
    });
    meshes.back().second.x_lines = {0.1 * from.width, 0.15 * from.width, 0.2 * from.width};
    meshes.back().second.y_lines = {0.1 * from.height, 0.15 * from.height, 0.2 * from.height};
    return meshes;
}

}  // namespace anamorph::test
