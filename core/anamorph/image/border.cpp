// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/border.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace anamorph {
namespace {

/// The remainder in [0, n), for any a.
std::int64_t modulo(std::int64_t a, std::int64_t n) {
    const std::int64_t r = a % n;
    return r < 0 ? r + n : r;
}

/// Where `a` stands in [first, end) repeated for ever.
int periodic(std::int64_t a, int first, int end) {
    const std::int64_t n = end - first;
    return first + static_cast<int>(modulo(modulo(a, n) - first, n));
}

/// Where `a` stands in [first, end) unfolded for ever, as paper is; the edge texels repeat.
int mirrored(std::int64_t a, int first, int end) {
    const std::int64_t n = end - first;
    const std::int64_t r = modulo(modulo(a, 2 * n) - first, 2 * n);
    return first + static_cast<int>(r < n ? r : 2 * n - 1 - r);
}

/// An edge of a piece of an image of `full` pixels, on a level of `size`.
int scaled(int edge, int full, int size) {
    return static_cast<int>((2 * std::int64_t{edge} * size + full) / (2 * std::int64_t{full}));
}

/// The texel of a level of several faces that the ray through (x, y) of the extended plane of `piece` meets.
Texel across_face_edge(const Chart& chart, double x, double y, int piece, const Size& level,
                       const Border& border) {
    const double kx = static_cast<double>(chart.width()) / level.width;
    const double ky = static_cast<double>(chart.height()) / level.height;
    const Ray<double> ray = chart.ray((x + 0.5) * kx, (y + 0.5) * ky, piece);
    const int other = chart.piece_of(ray);
    const Point<double> p = chart.point(ray, other);
    // Where no face has the ray there is nothing, which is so where the pieces do not see all. To a millionth of a pixel, which is
    // more than rounding moves it.
    const Box& own = chart.pieces()[static_cast<std::size_t>(other)].box;
    const auto has = [](double at, int first, int end) { return at >= first - 1e-6 && at <= end + 1e-6; };
    const bool is_seen = chart.pieces_see_all() || (has(p.x, own.x0, own.x1) && has(p.y, own.y0, own.y1));
    if (!is_seen) return {0, 0, true};
    const Box face = border.interior(other, level);
    const auto inside = [](double at, int first, int end) {
        return static_cast<int>(std::clamp(std::floor(at), double(first), double(end - 1)));
    };
    return {inside(p.x / kx, face.x0, face.x1), inside(p.y / ky, face.y0, face.y1)};
}

/// Texels of a full turn. Where fields of view run between pixel centres the last texel of a row repeats the first one's
/// direction and the outer rows stand on the poles: an overlap of one pixel, which the coarser levels hardly see.
int period_of(const Chart& chart, const Size& level) {
    const bool overlaps =
        chart.spacing() == PixelSpacing::centers && 2 * std::int64_t{level.width} >= chart.width();
    return std::max(1, level.width - (overlaps ? 1 : 0));
}

/// A chart whose azimuth closes: around the seam and, where rows end at the poles, over them. `count` is as
/// far as the image goes.
TexelRun around_sphere(const Chart& chart, std::int64_t x, std::int64_t y, const Size& level) {
    const bool centers = chart.spacing() == PixelSpacing::centers;
    const int overlap_y = centers && 2 * std::int64_t{level.height} >= chart.height() ? 1 : 0;
    const int period = period_of(chart, level);
    bool over_pole = false;
    if (y < 0 || y >= level.height) {
        // Down one meridian and up the opposite one.
        const std::int64_t turn = std::max<std::int64_t>(1, 2 * (std::int64_t{level.height} - overlap_y));
        y = modulo(y, turn);
        over_pole = y >= level.height;
        if (over_pole) y = 2 * std::int64_t{level.height} - 1 - overlap_y - y;
    }
    int end = level.width;
    if (over_pole || x < 0 || x >= level.width) {
        x = modulo(modulo(x, period) + (over_pole ? period / 2 : 0), period);
        end = period;
    }
    return {{static_cast<int>(x), static_cast<int>(y)}, end - static_cast<int>(x)};
}

/// Does a full turn fill rows of this picture that are shorter than it is wide?
bool has_rounded_edge(const Chart& chart) {
    return chart.counted() == Counted::azimuth && chart.fov() == 360 && !chart.closed();
}

/// A level of a picture of the whole sphere whose rows end where the sphere does: symmetric, and convex.
class RoundedEdge {
  public:
    RoundedEdge(const Chart& chart, const Size& level)
        : m_chart(chart),
          m_level(level),
          m_kx(static_cast<double>(chart.width()) / level.width),
          m_ky(static_cast<double>(chart.height()) / level.height) {}

    /// The first and the end of the texels of a row that stand for themselves: their centres lie on the
    /// sphere, or, of levels that were made by averaging what lies outside too, all of them does. None: 0, 0.
    std::pair<int, int> row(int y) const {
        int in = m_level.width / 2, out = m_level.width;
        if (!stands(in, y)) return {0, 0};
        while (out - in > 1) {
            const int middle = in + (out - in) / 2;
            (stands(middle, y) ? in : out) = middle;
        }
        return {m_level.width - out, out};
    }

    /// A rectangle that stands for itself: half of the height.
    Box middle() const {
        const int y0 = m_level.height / 4, y1 = m_level.height - y0;
        const auto [a, b] = row(y0);
        const auto [c, d] = row(y1 - 1);
        const Box box{std::max(a, c), y0, std::min(b, d), y1};
        if (!box.empty()) return box;
        const int x = m_level.width / 2, y = m_level.height / 2;
        return {x, y, x + 1, y + 1};
    }

    TexelRun resolve(std::int64_t x, std::int64_t y) const {
        if (y >= 0 && y < m_level.height) {
            const auto [first, end] = row(static_cast<int>(y));
            if (x >= first && x < end)
                return {{static_cast<int>(x), static_cast<int>(y)}, end - static_cast<int>(x)};
        }
        return {across(static_cast<double>(x), static_cast<double>(y))};
    }

  private:
    bool on_sphere(double x, double y) const { return m_chart.inside(x * m_kx, y * m_ky) >= 0; }
    bool stands(int x, int y) const {
        if (m_level == Size{m_chart.width(), m_chart.height()}) return on_sphere(x + 0.5, y + 0.5);
        return on_sphere(x, y) && on_sphere(x + 1, y) && on_sphere(x, y + 1) && on_sphere(x + 1, y + 1);
    }

    /// The formulas go on beyond the edge, around the sphere. Nothing where they end, or where the sphere
    /// goes on and the picture does not.
    Texel across(double x, double y) const {
        const Point<double> p = m_chart.point(m_chart.ray((x + 0.5) * m_kx, (y + 0.5) * m_ky), 0);
        const double row_of = std::floor(p.y / m_ky);
        if (!(std::isfinite(p.x) && row_of >= 0 && row_of < m_level.height)) return {0, 0, true};
        // The nearest row with texels, toward the middle.
        int to = static_cast<int>(row_of);
        auto [first, end] = row(to);
        for (const int step = 2 * to < m_level.height ? 1 : -1; first == end;
             std::tie(first, end) = row(to)) {
            if (to == m_level.height / 2) return {0, 0, true};
            to += step;
        }
        return {static_cast<int>(std::clamp(std::floor(p.x / m_kx), double(first), end - 1.0)), to};
    }

    const Chart& m_chart;
    Size m_level;
    double m_kx, m_ky;
};

}  // namespace

Border::Border(const Chart& chart, Wrap wrap) : m_chart(chart), m_wrap(wrap) {}

/// The rectangle of a level that a piece fills.
Box Border::face(int piece, const Size& level) const noexcept {
    if (m_chart.pieces().size() == 1 || faces_of(m_chart.projection()).joined)
        return {0, 0, level.width, level.height};
    const Box& box = m_chart.pieces()[static_cast<std::size_t>(piece)].box;
    const int w = m_chart.width(), h = m_chart.height();
    Box r{scaled(box.x0, w, level.width), scaled(box.y0, h, level.height), scaled(box.x1, w, level.width),
          scaled(box.y1, h, level.height)};
    // A level too small for its faces: each keeps a texel, perhaps another's.
    r.x0 = std::min(r.x0, level.width - 1);
    r.y0 = std::min(r.y0, level.height - 1);
    r.x1 = std::max(r.x1, r.x0 + 1);
    r.y1 = std::max(r.y1, r.y0 + 1);
    return r;
}

Box Border::interior(int piece, const SourceLevel& level) const noexcept {
    if (m_wrap == Wrap::automatic && has_rounded_edge(m_chart))
        return RoundedEdge(m_chart, level.size).middle();
    if (!has_edges()) return face(piece, level.size);
    // What is faded toward black belongs to a black border only.
    return goes_black() ? level.extent : level.whole;
}

/// Is the picture one rectangle that does not go on by itself?
bool Border::has_edges() const noexcept {
    return m_chart.pieces().size() == 1 && !m_chart.closed() && !has_rounded_edge(m_chart);
}

bool Border::is_black(const Box& box, const SourceLevel& level) const noexcept {
    return goes_black() && has_edges() && intersection(box, level.extent).empty();
}

int Border::turn(const Size& level) const noexcept {
    const bool closes = m_wrap == Wrap::automatic && m_chart.pieces().size() == 1 && m_chart.closed();
    return closes ? period_of(m_chart, level) : 0;
}

TexelRun Border::resolve_run(std::int64_t x, std::int64_t y, int piece, const SourceLevel& level,
                             int limit) const noexcept {
    const Size& size = level.size;
    if (m_wrap == Wrap::automatic && has_rounded_edge(m_chart)) {
        const TexelRun found = RoundedEdge(m_chart, size).resolve(x, y);
        return {found.first, std::min(found.count, limit)};
    }
    const Box own = interior(piece, level);
    if (own.y0 <= y && y < own.y1 && x < own.x1) {
        if (x >= own.x0)
            return {{static_cast<int>(x), static_cast<int>(y)},
                    std::min(own.x1 - static_cast<int>(x), limit)};
        if (x > std::int64_t{own.x0} - limit) limit = own.x0 - static_cast<int>(x);
    }
    const Box box = face(piece, size);
    const bool in_column = box.x0 <= x && x < box.x1, in_row = box.y0 <= y && y < box.y1;
    const auto run = [&](TexelRun r) { return TexelRun{r.first, std::min(r.count, limit)}; };
    switch (m_wrap) {
        case Wrap::black:
            break;
        case Wrap::clamp:
            return run({{static_cast<int>(std::clamp<std::int64_t>(x, box.x0, box.x1 - 1)),
                         static_cast<int>(std::clamp<std::int64_t>(y, box.y0, box.y1 - 1))},
                        in_column ? box.x1 - static_cast<int>(x) : 1});
        case Wrap::periodic: {
            const int from = periodic(x, box.x0, box.x1);
            return run({{from, periodic(y, box.y0, box.y1)}, box.x1 - from});
        }
        case Wrap::mirror:
            return {{mirrored(x, box.x0, box.x1), mirrored(y, box.y0, box.y1)}};
        case Wrap::automatic:
            if (m_chart.pieces().size() > 1)
                return {across_face_edge(m_chart, static_cast<double>(x), static_cast<double>(y), piece, size,
                                         *this)};
            if (m_chart.closed() && (in_row || m_chart.reaches_poles()))
                return run(around_sphere(m_chart, x, y, size));
            break;
    }
    return {{0, 0, true}, limit};
}

}  // namespace anamorph
