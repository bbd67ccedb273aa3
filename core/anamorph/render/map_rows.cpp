// SPDX-License-Identifier: Apache-2.0
#include "anamorph/render/map_rows.h"

#include <algorithm>
#include <cmath>

namespace anamorph {
namespace {

struct Found {
    Point<double> at;
    int piece;
    bool seen;
};

/// The source points of row j of `part` of a block, as they are used.
void find_row(const BlockMap& map, const Block& block, const BlockPoints& points, const Box& part, int j,
              Found* found) {
    alignas(64) float room[2][simd::kRowRoom];
    const float *px = room[0], *py = room[1];
    if (block.kind == Block::Kind::computed) {
        const std::ptrdiff_t at = (j - block.box.y0) * points.row_stride + part.x0 - block.box.x0;
        px = points.x + at;
        py = points.y + at;
    } else
        block_row(map, block, part, j, room[0], room[1]);
    for (int i = 0; i < part.width(); ++i) {
        const double x = part.x0 + i + 0.5, y = j + 0.5;
        Found& to = found[i] = {{}, block.source_piece, false};
        if (block.kind == Block::Kind::exact)
            to.seen = map.exact(block, x, y, to.at, to.piece);
        else
            to = {{block.base_x + double{px[i]}, block.base_y + double{py[i]}},
                  block.source_piece,
                  map.seen(x, y, block.piece)};
    }
}

/// The distance from the truth at (x, y); the source's x is counted around one with azimuths.
double error_of(const Found& used, const BlockMap& map, const Chart& source, double x, double y, int piece) {
    Point<long double> truth{}, at{used.at.x, used.at.y};
    int true_piece = 0;
    if (!map.truth(x, y, piece, truth, true_piece)) return 0;
    if (!used.seen) return HUGE_VAL;
    // On the edge between two faces of a cube.
    if (true_piece != used.piece) at = source.point(source.ray(at.x, at.y, used.piece), true_piece);
    long double dx = at.x - truth.x;
    if (const double turn = source.turn(); turn < HUGE_VAL) dx -= std::round(dx / turn) * turn;
    return static_cast<double>(std::hypot(dx, at.y - truth.y));
}

/// The same point of a source that goes on past its edges: around the seam by full turns; at poles and cube
/// edges, which exact points do not cross, on the edge, which is nearer to them.
Point<double> in_image(Point<double> p, const Chart& source) {
    const double w = source.width(), h = source.height(), period = source.period();
    const bool cube = has_faces(source.projection());
    if (source.closed() && (p.x < 0 || p.x > w)) p.x -= std::floor(p.x / period) * period;
    if (cube) p.x = std::clamp(p.x, 0.0, w);
    if (cube || source.reaches_poles()) p.y = std::clamp(p.y, 0.0, h);
    return p;
}

void put_point(const Found& used, const Chart& source, float* uv) {
    const Point<double> at = in_image(used.at, source);
    uv[0] = used.seen ? static_cast<float>(at.x / source.width()) : -1;
    uv[1] = used.seen ? static_cast<float>(at.y / source.height()) : -1;
}

/// Every value the same.
void fill_rows(float value, const Box& part, const MapRow& row) {
    float values[2 * simd::kMaxRow + 16];
    std::fill(std::begin(values), std::end(values), value);
    for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; x += simd::kMaxRow)
            row(x, y, std::min(simd::kMaxRow, part.x1 - x), values);
}

}  // namespace

void map_rows(const BlockMap& map, const Chart& source, Output output, const Block& block,
              const BlockPoints& points, const Box& part, const MapRow& row) {
    if (block.kind == Block::Kind::outside || output == Output::bound)
        return fill_rows(output == Output::stmap ? -1 : static_cast<float>(block.bound), part, row);
    Found found[simd::kMaxRow];
    float values[2 * simd::kMaxRow + 16] = {};
    for (int j = part.y0; j < part.y1; ++j) {
        find_row(map, block, points, part, j, found);
        for (int i = 0; i < part.width(); ++i)
            if (output == Output::stmap)
                put_point(found[i], source, values + 2 * i);
            else
                values[i] = static_cast<float>(
                    error_of(found[i], map, source, part.x0 + i + 0.5, j + 0.5, block.piece));
        row(part.x0, j, part.width(), values);
    }
}

}  // namespace anamorph
