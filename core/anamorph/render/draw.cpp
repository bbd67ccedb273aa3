// SPDX-License-Identifier: Apache-2.0
#include "anamorph/render/draw.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/render/block_reader.h"
#include "anamorph/render/strips.h"

namespace anamorph {
namespace {

/// Draws the map itself: what Output names but for colour. One per thread.
class MapPainter {
  public:
    MapPainter(const BlockMap& map, const Chart& source, Output output, const Canvas& canvas)
        : m_map(map), m_source(source), m_output(output), m_canvas(canvas) {
        m_values.resize(static_cast<std::size_t>(simd::kMaxRow * canvas.channels() + 16));
    }

    void draw(const Block& block, const Box& part) {
        if (block.kind == Block::Kind::outside || m_output == Output::bound) {
            m_canvas.fill(part, m_output == Output::stmap ? -1 : static_cast<float>(block.bound));
            return;
        }
        alignas(64) float px[simd::kRowRoom], py[simd::kRowRoom];
        for (int j = part.y0; j < part.y1; ++j) {
            block_row(m_map, block, part, j, px, py);
            for (int i = 0; i < part.width(); ++i) {
                const double x = part.x0 + i + 0.5, y = j + 0.5;
                Found used{{}, block.source_piece, false};
                used.seen = m_map.exact(block, x, y, used.at, used.piece);
                if (block.kind != Block::Kind::exact)
                    used = {{block.base_x + double{px[i]}, block.base_y + double{py[i]}},
                            block.source_piece,
                            used.seen};
                if (m_output == Output::stmap)
                    put_point(i, used);
                else
                    m_values.data()[i] = static_cast<float>(error(x, y, block, used));
            }
            m_canvas.store(part.x0, j, part.width(), m_values.data());
        }
    }

  private:
    struct Found {
        Point<double> at;
        int piece;
        bool seen;
    };

    void put_point(int i, const Found& used) {
        const Point<double> at = in_image(used.at);
        m_values.data()[2 * i] = used.seen ? static_cast<float>(at.x / m_source.width()) : -1;
        m_values.data()[2 * i + 1] = used.seen ? static_cast<float>(at.y / m_source.height()) : -1;
    }

    /// The distance from the truth; x is counted around a source with azimuths.
    double error(double x, double y, const Block& block, const Found& used) const {
        Point<long double> truth{}, at{used.at.x, used.at.y};
        int piece = 0;
        if (!m_map.truth(x, y, block.piece, truth, piece)) return 0;
        if (!used.seen) return HUGE_VAL;
        // On the edge between two faces of a cube.
        if (piece != used.piece) at = m_source.point(m_source.ray(at.x, at.y, used.piece), piece);
        long double dx = at.x - truth.x;
        if (const double turn = m_source.turn(); turn < HUGE_VAL) dx -= std::round(dx / turn) * turn;
        return static_cast<double>(std::hypot(dx, at.y - truth.y));
    }

    /// The same point of a source that goes on past its edges: around the seam by full turns; at poles and
    /// cube edges, which exact points do not cross, on the edge, which is nearer to them.
    Point<double> in_image(Point<double> p) const {
        const double w = m_source.width(), h = m_source.height(), period = m_source.period();
        const bool cube = has_faces(m_source.projection());
        if (m_source.closed() && (p.x < 0 || p.x > w)) p.x -= std::floor(p.x / period) * period;
        if (cube) p.x = std::clamp(p.x, 0.0, w);
        if (cube || m_source.reaches_poles()) p.y = std::clamp(p.y, 0.0, h);
        return p;
    }

    const BlockMap& m_map;
    const Chart& m_source;
    Output m_output;
    const Canvas& m_canvas;
    std::vector<float> m_values;
};

void check(const Chart& chart, Output output, const Source* source, const ImageView& picture) {
    if (output == Output::color && !source) throw Error("a picture in colour needs a source");
    if (output == Output::color) {
        const Size size = source->size(0);
        if (size.width != chart.width() || size.height != chart.height())
            throw Error("source size", std::to_string(size.width) + "x" + std::to_string(size.height),
                        "the map was made for " + std::to_string(chart.width()) + "x" +
                            std::to_string(chart.height()));
    }
    const int channels = channels_of(output, source);
    if (picture.channels != channels)
        throw Error("channels", std::to_string(picture.channels), "needed are " + std::to_string(channels));
}

}  // namespace

int channels_of(Output output, const Source* source) {
    return output == Output::color ? source->channels() : output == Output::stmap ? 2 : 1;
}

bool draw_blocks(const BlockMap& map, const Border& border, Filter filter, Output output,
                 const Source* source, const Box& box, const ImageView& picture,
                 const ParallelFor& parallel_for) {
    check(border.chart(), output, source, picture);
    const Canvas canvas(picture, box);
    if (!map.covers(box)) canvas.fill(box, output == Output::stmap ? -1.0f : 0.0f);
    std::atomic<bool> ok{true};
    for_each_strip(map, box, parallel_for, [&](const Strip& strip) {
        if (output != Output::color) {
            MapPainter painter(map, border.chart(), output, canvas);
            strip.for_each_block(
                [&](const Block& block, const Box& part, const Block*) { painter.draw(block, part); });
        } else {
            BlockReader reader(map, *source, border, filter);
            strip.for_each_block([&](const Block& block, const Box& part, const Block* next) {
                if (!reader.draw(block, part, canvas, next)) ok = false;
            });
        }
        simd::finish_stores();
    });
    return ok;
}

}  // namespace anamorph
