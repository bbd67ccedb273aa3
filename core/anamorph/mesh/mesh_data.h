// SPDX-License-Identifier: Apache-2.0
// What the author of a warp gives: positions at the vertices of a mesh, or pairs of points. Hosts read it
// from files (mesh_file.h); mesh.h and scattered.h make maps of it.
//
// Frames. Positions are in pixels (x right, y down, the centre of pixel (i, j) at (i + 0.5, j + 0.5)) or in
// fractions of the width and height of the image that they lie in (0 to 1, edge to edge).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "anamorph/chart/chart.h"

namespace anamorph {

/// The units of positions: pixels, or fractions of the width and height of their image.
enum class Units { pixels, fractions };

/// The direction of a mesh. pull: the mesh lies in the target image, and its vertices say where in the source they come
/// from. push: the mesh lies in the source image, and its vertices, which one drags, say where in the target they go.
enum class Direction { pull, push };

/// The pixels of an ST-map: u and v of each pixel, in fractions, row by row from the top left; both are NaN in
/// a hole, a pixel that comes from nowhere.
struct StSamples {
    std::vector<float> uv;
    double most = 0;         ///< the largest magnitude in uv, and of v counted from the top
    std::int64_t holes = 0;  ///< pixels that are holes
    bool v_up = false;       ///< does v go up, from 0 at the lower edge?

    /// The position that pixel i says, v down.
    Point<double> position(std::size_t i) const {
        const double v = uv[2 * i + 1];
        return {uv[2 * i], v_up ? 1 - v : v};
    }
};

/// A rectangular mesh of columns x rows cells, any of which may be subdivided into four, to any depth.
struct ControlMesh {
    static constexpr int kMaxCells = 8192;        ///< columns and rows, each
    static constexpr int kMaxVertices = 1 << 24;  ///< vertices of all levels together
    static constexpr int kMaxLevels = 16;
    static constexpr double kMaxPosition = 1e8;  ///< pixels

    Units units = Units::pixels;
    Direction direction = Direction::pull;
    /// The size of the ST-map that the mesh was made of; 0 where there is none.
    int width = 0, height = 0;
    /// The display window of that ST-map, in its pixels, where its data window is another.
    std::optional<Box> display = {};
    int columns = 1, rows = 1;
    /// The (columns + 1) (rows + 1) vertices of level 0, row by row from the top left.
    std::vector<Point<double>> vertices;
    /// The vertices of an ST-map that is taken pixel for pixel; `vertices` is then empty.
    std::shared_ptr<const StSamples> samples;
    /// The number of vertices of level 0, given in `vertices` or in `samples`.
    std::size_t vertex_count() const { return samples ? samples->uv.size() / 2 : vertices.size(); }
    /// Vertex i of level 0, from the top left.
    Point<double> vertex(std::size_t i) const { return samples ? samples->position(i) : vertices[i]; }
    /// The positions of the lines of the mesh: columns + 1 and rows + 1 ascending positions. When empty, the
    /// lines are spread evenly from edge to edge of the image. Between the outermost lines and the edges the
    /// map goes on linearly.
    std::vector<double> x_lines, y_lines;

    /// A cell by its place in the lattice.
    struct Cell {
        int column, row;
    };
    /// A vertex of the lattice of a level: its numbers there, and its position in the other image.
    struct Vertex {
        int column, row;
        Point<double> at;
    };
    /// Level k = 1, 2 ... (levels[k - 1]): cells of level k - 1 that are subdivided into four, and the
    /// vertices known at level k, whose lattice has 2^k columns by 2^k rows of cells in each cell of level
    /// 0. Vertices that are not given, and those on a cell that is not subdivided (T-vertices, whatever is
    /// given for them), take their value from the coarser model.
    struct Level {
        std::vector<Cell> cells;
        std::vector<Vertex> vertices;
    };
    std::vector<Level> levels;
};

/// Pairs of points: (x, y) in the target comes from (u, v) in the source; by themselves, or as the corners of polygons.
struct ControlPoints {
    static constexpr int kMaxPoints = 1 << 17;

    /// (x, y) in the target comes from (u, v) in the source.
    struct Pair {
        double x, y, u, v;
    };
    Units units = Units::pixels;
    std::vector<Pair> pairs;
    /// Polygons whose corners are pairs, by their numbers, of any shape: along each of their sides the map is one cubic, by what it is
    /// and how it changes at the ends (Hermite), whatever lies beside it. They do not cross one another.
    std::vector<std::vector<int>> polygons = {};
    static constexpr std::size_t kMaxCorners = std::size_t{1} << 19;
    /// Pixels of the target on either side, across and down, that do not count for how the map goes on beyond the points.
    Size overscan = {};
};

/// A warp as its author gives it. `name` is what messages call it (a file's name).
struct WarpMap {
    std::string name = "mesh";
    std::variant<ControlMesh, ControlPoints> shape;
};

}  // namespace anamorph
