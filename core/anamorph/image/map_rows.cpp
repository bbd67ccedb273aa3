// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/map_rows.h"

#include <algorithm>
#include <cmath>

#include "anamorph/number/hypot.h"

namespace anamorph {
namespace {

struct Found {
    Point<double> at;
    int piece;
    bool seen;
};

/// The source points of one row of a block, as they are used.
class PointRow {
  public:
    /// Row j of `part` of the block.
    PointRow(const BlockMap& map, const Block& block, const BlockPoints& points, const Box& part, int j)
        : m_map(map), m_block(block), m_first(part.x0), m_y(j + 0.5) {
        if (in_double(block)) {
            m_exact.read(map, block, j - block.box.y0, j - block.box.y0 + 1);
        } else if (block.kind == Block::Kind::computed) {
            const std::ptrdiff_t at = (j - block.box.y0) * points.row_stride + part.x0 - block.box.x0;
            m_px = points.x + at;
            m_py = points.y + at;
        } else
            block_row(map, block, part, j, m_room[0], m_room[1]);
    }

    double x(int i) const { return m_first + i + 0.5; }
    double y() const { return m_y; }
    Found operator()(int i) const {
        if (in_double(m_block)) {
            const int k = m_first - m_block.box.x0 + i;
            const std::int32_t piece = m_exact.piece(0)[k];
            const bool seen =
                m_block.kind == Block::Kind::exact ? piece >= 0 : m_map.seen(x(i), m_y, m_block.piece);
            return {m_exact.at(k, 0), piece, seen};
        }
        return {{m_block.base_x + double{m_px[i]}, m_block.base_y + double{m_py[i]}},
                m_block.source_piece,
                m_map.seen(x(i), m_y, m_block.piece)};
    }

  private:
    const BlockMap& m_map;
    const Block& m_block;
    int m_first;
    double m_y;
    alignas(64) float m_room[2][simd::kRowRoom];
    const float *m_px = m_room[0], *m_py = m_room[1];
    PointsInDouble m_exact;
};

/// Is a point on the outline of a chart that shows one meridian at both of its ends, so that its mirror image is the same place?
bool is_at_both_ends(const Chart& source, const Point<double>& at, const Point<double>& mirrored) {
    constexpr double kSame = 1e-9;
    const Ray<double> a = source.ray(at.x, at.y), b = source.ray(mirrored.x, mirrored.y);
    return hypot(a.x - b.x, a.y - b.y, a.z - b.z) <= kSame * hypot(a.x, a.y, a.z);
}

/// The distance from the truth at (x, y); the source's x is counted around one with azimuths.
double error_of(const Found& used, const BlockMap& map, const Chart& source, double x, double y, int piece) {
    Point<DoubleDouble> truth{}, at{used.at.x, used.at.y};
    int true_piece = 0;
    if (!map.truth(x, y, piece, truth, true_piece)) return 0;
    if (!used.seen) return HUGE_VAL;
    // On the edge between two faces of a cube.
    if (true_piece != used.piece) at = source.point(source.ray(at.x, at.y, used.piece), true_piece);
    DoubleDouble dx = at.x - truth.x;
    if (const double turn = source.turn(); turn < HUGE_VAL)
        dx -= std::round(static_cast<double>(dx / turn)) * DoubleDouble(turn);
    const auto distance = static_cast<double>(hypot(dx, at.y - truth.y));
    if (distance < 1 || source.pieces().size() > 1) return distance;
    // The truth may be the other end of a seam.
    const Point<double> mirrored{source.width() - used.at.x, used.at.y};
    if (!is_at_both_ends(source, used.at, mirrored)) return distance;
    return std::min(distance, static_cast<double>(hypot(mirrored.x - truth.x, mirrored.y - truth.y)));
}

/// Source points as (u, v) of a chart.
class SourceImage {
  public:
    SourceImage(const Chart& chart, Output output)
        : m_output(output),
          m_width(chart.width()),
          m_height(chart.height()),
          m_period(chart.closed() ? chart.period() : HUGE_VAL),
          m_cube(has_faces(chart.projection())),
          m_poles(chart.reaches_poles()) {}

    void put(const Found& used, float* uv) const {
        const Point<double> at = inside(used.at);
        uv[0] = used.seen ? static_cast<float>(at.x / m_width) : -1;
        uv[1] = used.seen ? static_cast<float>(v_of(m_output, at.y / m_height)) : -1;
    }

  private:
    /// Moves a point of a source that goes on past its edges to the same point within: around the seam by
    /// full turns; at poles and cube edges, which exact points do not cross, on the edge, which is nearer to
    /// them.
    Point<double> inside(Point<double> p) const {
        if (m_period < HUGE_VAL && (p.x < 0 || p.x > m_width)) p.x -= std::floor(p.x / m_period) * m_period;
        if (m_cube) p.x = std::clamp(p.x, 0.0, m_width);
        if (m_cube || m_poles) p.y = std::clamp(p.y, 0.0, m_height);
        return p;
    }

    Output m_output;
    double m_width, m_height, m_period;
    bool m_cube, m_poles;
};

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
        return fill_rows(is_stmap(output) ? -1 : static_cast<float>(block.bound), part, row);
    const SourceImage image(source, output);
    float values[2 * simd::kMaxRow + 16] = {};
    for (int j = part.y0; j < part.y1; ++j) {
        const PointRow used(map, block, points, part, j);
        for (int i = 0; i < part.width(); ++i)
            if (is_stmap(output))
                image.put(used(i), values + 2 * i);
            else
                values[i] =
                    static_cast<float>(error_of(used(i), map, source, used.x(i), used.y(), block.piece));
        row(part.x0, j, part.width(), values);
    }
}

}  // namespace anamorph
