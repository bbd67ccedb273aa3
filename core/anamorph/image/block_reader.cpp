// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/block_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "anamorph/image/pixel.h"
#include "anamorph/number/hypot.h"
#include "anamorph/plan/block_writer.h"

namespace anamorph {
namespace {

constexpr int kMaxRow = simd::kMaxRow;

bool is_polynomial(const Block& block) {
    return block.kind == Block::Kind::polynomial || (block.kind == Block::Kind::bicubic && !block.precise);
}

BlockPolynomial polynomial_of(const BlockMap& map, const Block& block) {
    return block.kind == Block::Kind::bicubic ? map.bicubic(block) : quadratic_of(block);
}

simd::Polynomials on_block(const BlockPolynomial& p, const Block& block) {
    return {p.c, p.degree, block.box.width(), block.box.height(), nullptr, nullptr, 0};
}

/// From the coefficients of a polynomial block.
Jacobian jacobian_of(const Block& block) {
    const double hx = half(block.box.width()), hy = half(block.box.height());
    return {block.x[1] / hx, block.y[1] / hx, block.x[2] / hy, block.y[2] / hy};
}

// Pixels share a footprint whose axes are off by at most this part of their lengths, or by half a source
// pixel.
constexpr double kFootprintShare = 1.0 / 4, kFootprintOff = 0.5;

/// May (step_x, step_y) stand in for an axis (x, y) of a footprint? All may where the map does not minify.
inline bool alike(double x, double y, double step_x, double step_y) {
    const double length = x * x + y * y, step = step_x * step_x + step_y * step_y;
    const double off = square(step_x - x) + square(step_y - y);
    // Written so that what is no number is like nothing.
    return off <= std::max(square(kFootprintOff), square(kFootprintShare) * length) ||
           (length <= 1 && step <= 1);
}

/// Is the footprint in the middle of a polynomial block right for all its pixels? The derivative along s is
/// the sum of i c[j][i] s^(i - 1) t^j, and differs from c[0][1] by at most the magnitudes of its other terms.
bool shares_footprint(const BlockPolynomial& p, const Block& block) {
    double along_s[2] = {}, along_t[2] = {};
    for (int k = 0; k < 2; ++k)
        for (int j = 0; j <= p.degree; ++j)
            for (int i = 0; i <= p.degree; ++i) {
                const double c = std::fabs(double{p.c[j][4 * k + i]});
                if (i > 1 || j > 0) along_s[k] += i * c;
                if (j > 1 || i > 0) along_t[k] += j * c;
            }
    const double hx = half(block.box.width()), hy = half(block.box.height());
    const auto steady = [](double x, double y, double off_x, double off_y) {
        const double length = hypot(x, y), off = hypot(off_x, off_y);
        return off <= std::max(kFootprintOff, kFootprintShare * length) || length + off <= 1;
    };
    return steady(p.c[0][1] / hx, p.c[0][5] / hx, along_s[0] / hx, along_s[1] / hx) &&
           steady(p.c[1][0] / hy, p.c[1][4] / hy, along_t[0] / hy, along_t[1] / hy);
}

/// Into how many parts each way a pixel is cut so that one footprint serves each of them: 1, 2, 4 or kRays. What footprints
/// are like, whichever way a face or a lens turns the source, is how long the map makes the pixel's sides and diagonals. Those
/// in its corners are to be like those in its middle to within twice what pixels of a cell are: what changes evenly about the
/// middle cancels in the mean. Over an n-th part of the pixel they change by an n-th part of that. Where the map has no
/// derivative in the middle, at a pole or on an axis, only rays serve; corners without one say nothing.
constexpr int kRays = 8;
int parts_of_pixel(const Jacobian& middle, const std::array<Jacobian, 4>& corners) {
    const auto lengths = [](const Jacobian& j) {
        return std::array{hypot(j.x_i, j.y_i), hypot(j.x_j, j.y_j), hypot(j.x_i + j.x_j, j.y_i + j.y_j),
                          hypot(j.x_i - j.x_j, j.y_i - j.y_j)};
    };
    const std::array<double, 4> here = lengths(middle);
    if (!std::all_of(here.begin(), here.end(), [](double l) { return std::isfinite(l); })) return kRays;
    double parts = 1;
    for (const Jacobian& corner : corners) {
        const std::array<double, 4> there = lengths(corner);
        for (std::size_t k = 0; k < here.size(); ++k) {
            if (std::isnan(there[k])) continue;
            const double least = std::min(here[k], there[k]);
            const double off = std::fabs(there[k] - here[k]);
            parts = std::max(parts, off / (2 * std::max(kFootprintOff, kFootprintShare * least)));
        }
    }
    return parts <= 1 ? 1 : parts <= 2 ? 2 : parts <= 4 ? 4 : kRays;
}

/// The source points of a block's pixels, counted from its corner, and the steps from one to the next, of which there are
/// some both ways.
template <class At>
class Steps {
  public:
    Steps(const At& at, const Block& block) : m_at(at), m_size{0, 0, block.box.width(), block.box.height()} {}

    /// The map's derivative in the middle of a cell: of the two nearest steps within the block, either way,
    /// the shorter one, which does not cross a seam.
    Jacobian jacobian(const Box& cell) const {
        const int i = (cell.x0 + cell.x1) / 2, j = (cell.y0 + cell.y1) / 2;
        const Point<double> across =
            shorter(i, m_size.x1, [&](int k) { return m_at(k + 1, j) - m_at(k, j); });
        const Point<double> down = shorter(j, m_size.y1, [&](int k) { return m_at(i, k + 1) - m_at(i, k); });
        return {across.x, across.y, down.x, down.y};
    }
    /// Is every step of a cell like the axes of a footprint?
    bool alike(const Box& cell, const Jacobian& to) const {
        const Box a = across(cell), b = down(cell);
        bool all = true;
        for (int j = a.y0; j < a.y1 && all; ++j)
            for (int i = a.x0; i < a.x1; ++i) {
                const Point<double> step = m_at(i + 1, j) - m_at(i, j);
                all &= anamorph::alike(to.x_i, to.y_i, step.x, step.y);
            }
        for (int j = b.y0; j < b.y1 && all; ++j)
            for (int i = b.x0; i < b.x1; ++i) {
                const Point<double> step = m_at(i, j + 1) - m_at(i, j);
                all &= anamorph::alike(to.x_j, to.y_j, step.x, step.y);
            }
        return all;
    }

  private:
    /// The shorter of the two steps, of a row of `count` pixels, next to pixel k.
    template <class Step>
    static Point<double> shorter(int k, int count, const Step& step) {
        const int first = std::clamp(k - 1, 0, std::max(0, count - 3)), last = std::min(first + 1, count - 2);
        const Point<double> a = step(first), b = step(last);
        return square(a.x) + square(a.y) < square(b.x) + square(b.y) ? a : b;
    }

    /// Where steps to the right, or down, begin; those of a single column or row go to a neighbour in the block.
    Box across(const Box& cell) const {
        if (cell.width() > 1) return {cell.x0, cell.y0, cell.x1 - 1, cell.y1};
        const int x = std::min(cell.x0, m_size.x1 - 2);
        return {x, cell.y0, x + 1, cell.y1};
    }
    Box down(const Box& cell) const {
        if (cell.height() > 1) return {cell.x0, cell.y0, cell.x1, cell.y1 - 1};
        const int y = std::min(cell.y0, m_size.y1 - 2);
        return {cell.x0, y, cell.x1, y + 1};
    }

    const At& m_at;
    Box m_size;
};

/// The ends of one coordinate of a block's points, over a cell counted from its corner.
template <class Real>
simd::Ends ends_over(const Real* values, std::ptrdiff_t stride, const Box& cell) {
    return simd::ends_of(
        simd::ValueRows<Real>{values + cell.y0 * stride + cell.x0, stride, cell.width(), cell.height()});
}

/// Are all steps of a block's points, `ahead` entries from one to the next, so near to the axis (x, y) of a footprint that
/// each is like it? At once for all of them; false where that is not certain.
template <class Real>
bool all_alike(const PixelPoints<Real>& points, std::ptrdiff_t ahead, int width, int height, double x,
               double y) {
    double worst = 0, longest = 0;
    for (const auto& [at, axis] : {std::pair(points.x, x), std::pair(points.y, y)}) {
        const auto [low, high] = simd::ends_of({at, points.row_stride, width, height, ahead});
        worst += square(std::max(std::fabs(low - axis), std::fabs(high - axis)));
        longest += square(std::max(std::fabs(low), std::fabs(high)));
    }
    const double length = square(x) + square(y);
    return worst <= std::max(square(kFootprintOff), square(kFootprintShare) * length) ||
           (length <= 1 && longest <= 1);
}

/// What is at pixel (i, j).
template <class Real>
auto at_points(const PixelPoints<Real>& points) {
    return [points](int i, int j) {
        const std::ptrdiff_t k = j * points.row_stride + i;
        return Point<double>{points.x[k], points.y[k]};
    };
}

// Where there are more texels than this for a pixel, they lie far apart for the hot loops.
constexpr double kApart = 3;

// More texels than this for a pixel are not taken together, wherever they are: the bits of a picture do not depend on that.
constexpr double kMostTexels = 128;

// Nor are more than this where they cross an edge of the source: all but the cells at the edge can be read in place.
constexpr double kMostPutTogether = 8;

// Cells of up to so many pixels whose texels lie too far apart are read pixel by pixel, larger ones are halved.
constexpr int kSmallCell = 16;

// Cells of so many pixels each way have one step in a row, which is like itself.
constexpr int kFewSteps = 2;

bool has_few_steps(const Box& cell) {
    return std::max(cell.width(), cell.height()) <= kFewSteps;
}

/// body(half) for the halves of a cell, cut across its longer side. False when any body was.
template <class Body>
bool for_halves(const Box& cell, const Body& body) {
    Box first = cell, second = cell;
    if (cell.width() >= cell.height())
        first.x1 = second.x0 = (cell.x0 + cell.x1) / 2;
    else
        first.y1 = second.y0 = (cell.y0 + cell.y1) / 2;
    const bool done = body(first);
    return body(second) && done;
}

/// body(cell, jacobian) for the largest cells of a block, counted from its corner, that share a footprint:
/// those in whose middle the map's derivative is like all their steps, and those of up to `least` pixels each way. False when
/// any body was.
template <class Derivative, class Alike, class Body>
bool for_each_cell(const Box& cell, int least, const Derivative& derivative, const Alike& alike,
                   const Body& body) {
    const Jacobian jacobian = derivative(cell);
    if (std::max(cell.width(), cell.height()) <= least || alike(cell, jacobian)) return body(cell, jacobian);
    return for_halves(cell,
                      [&](const Box& half) { return for_each_cell(half, least, derivative, alike, body); });
}

bool is_near(double at) {
    return std::fabs(at) < kFarthest;
}

double texels_in(const Box& box) {
    return double(box.width()) * box.height();
}

Box whole(const Block& block) {
    return {0, 0, block.box.width(), block.box.height()};
}

/// Has a block steps one way only?
bool is_line(const Block& block) {
    return block.box.width() == 1 || block.box.height() == 1;
}

/// The part of a block's cell that lies in a box of the picture.
Box part_of(const Box& cell, const Block& block, const Box& part) {
    const int x = block.box.x0, y = block.box.y0;
    return intersection({cell.x0 + x, cell.y0 + y, cell.x1 + x, cell.y1 + y}, part);
}

}  // namespace

void PointsInDouble::read(const BlockMap& map, const Block& block, int begin, int end) {
    make_room(block.box.width(), end - begin);
    map.exact_rows(block, begin, end, {m_x.data(), m_y.data(), m_piece.data(), m_stride});
}

void PointsInDouble::make_room(int width, int rows) {
    m_stride = width + 16;
    const auto room = static_cast<std::size_t>(m_stride) * static_cast<std::size_t>(rows);
    if (m_x.size() >= room) return;
    m_x.resize(room);
    m_y.resize(room);
    m_piece.resize(room);
}

void PointsInDouble::take(const Block& block, const BlockPoints& from) {
    const int width = block.box.width(), height = block.box.height();
    make_room(width, height);
    for (int j = 0; j < height; ++j) {
        const std::ptrdiff_t to = j * m_stride, at = j * from.row_stride;
        for (int i = 0; i < width; ++i) {
            m_x[static_cast<std::size_t>(to + i)] = block.base_x + double{from.x[at + i]};
            m_y[static_cast<std::size_t>(to + i)] = block.base_y + double{from.y[at + i]};
        }
        std::fill_n(m_piece.data() + to, width, block.source_piece);
    }
}

void block_row(const BlockMap& map, const Block& block, const Box& part, int j, float* x, float* y) {
    if (in_double(block)) return;
    const int row = j - block.box.y0, begin = part.x0 - block.box.x0, end = part.x1 - block.box.x0;
    if (is_polynomial(block)) {
        const BlockPolynomial p = polynomial_of(map, block);
        simd::block_points(on_block(p, block), row, begin, end, x, y);
    }
    if (block.kind == Block::Kind::computed) map.computed_row(block, row, begin, end, x, y);
}

BlockPlanes::BlockPlanes(std::size_t layers) {
    constexpr std::ptrdiff_t kPlane = std::ptrdiff_t{simd::kRowRoom} * Block::kMaxSide;
    // Points are written before they are read.
    m_values.reset(new float[2 * layers * std::size_t{kPlane} + 16]);
    for (std::size_t k = 0; k < layers; ++k) {
        float* x = m_values.get() + 2 * static_cast<std::ptrdiff_t>(k) * kPlane;
        m_rows.push_back({x, x + kPlane, simd::kRowRoom});
    }
}

/// A block's polynomial in texels of a level: less a base of its own, with the ranges of x and y.
struct BlockReader::LevelPolynomial {
    BlockPolynomial p;
    std::int32_t base_x, base_y;
    Range x, y;

    LevelPolynomial(const BlockPolynomial& of_source, const Block& block, double scale_x, double scale_y)
        : p(of_source), base_x(block.base_x), base_y(block.base_y) {
        x = take(0, base_x, scale_x);
        y = take(4, base_y, scale_y);
    }

  private:
    /// One coordinate: coefficients and base to the level, and the range.
    Range take(int first, std::int32_t& base, double scale) {
        double spread = 0;
        for (int j = 0; j <= p.degree; ++j)
            for (int i = first; i <= first + p.degree; ++i) {
                if (j == 0 && i == first) continue;
                if (scale != 1) p.c[j][i] = static_cast<float>(p.c[j][i] * scale);
                spread += std::fabs(p.c[j][i]);
            }
        float& middle = p.c[0][first];
        if (scale != 1) {
            const double origin = (base + static_cast<double>(middle)) * scale;
            base = static_cast<std::int32_t>(std::floor(origin));
            middle = static_cast<float>(origin - base);
        }
        // s and t are at most 1 in float too, so that no term is larger than its coefficient; and rounding
        // moves the sum by at most that much.
        spread += (spread + std::fabs(middle)) * term_rounding(2 * p.degree);
        return {middle - spread, middle + spread};
    }
};

/// The texels from the low to the high end of a range past a base, with those that taps and kernel need
/// around them.
struct BlockReader::Span {
    double first, last;

    Span(const Filtering& f, double tap_reach, std::int32_t base, const Range& range) {
        const int support = support_of(f.kernel);
        first = base + std::floor(range.low - tap_reach) - support;
        last = base + std::floor(range.high + tap_reach) + support + 1;
    }
    bool fits() const { return std::fabs(first) < (1 << 30) && std::fabs(last) < (1 << 30); }
    double farthest_from(std::int32_t base) const {
        return std::max(std::fabs(first - base), std::fabs(last - base));
    }
};

/// One coordinate of points in double, in texels of a level: `base` is the texel that the least one falls
/// into, the range counts from there.
struct BlockReader::LevelPoints {
    double scale;
    std::int32_t base;
    Range range;

    LevelPoints(double least, double greatest, double level_scale)
        : scale(level_scale),
          base(static_cast<std::int32_t>(std::floor(least * scale))),
          range{0, greatest * scale - base} {}
};

BlockReader::BlockReader(const BlockMap& map, const Source& source, const Border& border, Filter filter)
    : m_map(map),
      m_source(source),
      m_border(border),
      m_filter(filter),
      m_reader(source, border),
      m_points(source, border),
      m_apart(source, border),
      m_chooser(source),
      m_values(static_cast<std::size_t>(kMaxRow) * static_cast<std::size_t>(source.channels()) + 16),
      m_partial(filter == Filter::nearest ? nullptr : dynamic_cast<const PartialPixels*>(&map)) {}

bool BlockReader::rows(const Block& block, const Box& part, const Row& row) {
    if (in_double(block)) {
        read_in_double(block);
        if (m_filter == Filter::summed_area) return rows_one_by_one(block, {}, part, row);
        return rows_in_double(block, part, row);
    }
    if (m_filter == Filter::summed_area && block.kind != Block::Kind::outside)
        return rows_one_by_one(block, points_of(block), part, row);
    switch (block.kind) {
        case Block::Kind::outside:
            std::fill(m_values.begin(), m_values.end(), 0.0f);
            for (int j = part.y0; j < part.y1; ++j)
                for (int x = part.x0; x < part.x1; x += kMaxRow)
                    row(x, j, std::min(kMaxRow, part.x1 - x), m_values.data(), 1);
            return true;
        case Block::Kind::polynomial:
        case Block::Kind::bicubic:
            return polynomial_rows(block, part, row);
        case Block::Kind::computed:
            return rows(block, points_of(block), part, row);
        case Block::Kind::exact:
            break;
    }
    return false;
}

bool BlockReader::draw(const Block& block, const Box& part, const Canvas& canvas) {
    const Row store = [&](int x, int y, int count, const float* values, float one) {
        canvas.store(x, y, count, values, one);
    };
    return draw_whole(block, part, store, canvas) &&
           (!m_partial || block.kind != Block::Kind::exact || draw_partial(block, part, store));
}

/// The partial pixels of an exact block: by a footprint about the middle of what is drawn, as large as that.
bool BlockReader::draw_partial(const Block& block, const Box& part, const Row& row) {
    m_partial_pixels.clear();
    m_partial->find(block.box, block.piece, part, m_partial_pixels);
    for (const PartialPixel& pixel : m_partial_pixels) {
        Point<double> p;
        int piece;
        if (!m_map.exact(pixel.middle.x, pixel.middle.y, block.piece, p, piece)) continue;
        Jacobian own = m_map.jacobian(pixel.middle.x, pixel.middle.y, block.piece);
        for (double* d : {&own.x_i, &own.y_i}) *d *= pixel.width;
        for (double* d : {&own.x_j, &own.y_j}) *d *= pixel.height;
        if (!m_points.sample(m_filter, m_chooser, own, piece, p.x, p.y, m_values.data())) return false;
        for (int c = 0; c < m_source.channels(); ++c) {
            float& value = m_values[static_cast<std::size_t>(c)];
            value = static_cast<float>(value * pixel.share);
        }
        finish(pixel.x, pixel.y, 1, 1, row);
    }
    return true;
}

bool BlockReader::draw_whole(const Block& block, const Box& part, const Row& store, const Canvas& canvas) {
    const bool straight = m_source.unassociated_alpha() < 0;
    if (m_filter == Filter::summed_area) return rows(block, part, store);
    if (in_double(block)) {
        read_in_double(block);
        const Got got = straight ? draw_in_double(block, part, canvas) : Got::too_large;
        return got == Got::too_large ? rows_in_double(block, part, store) : got == Got::window;
    }
    if (block.kind == Block::Kind::computed) {
        const BlockPoints points = points_of(block);
        Got got = straight ? draw_points(block, points, part, canvas) : Got::too_large;
        if (got == Got::too_large && straight && !averages(m_filter)) {
            m_exact.take(block, points);
            got = draw_in_double(block, part, canvas);
        }
        return got == Got::too_large ? rows(block, points, part, store) : got == Got::window;
    }
    const Got got = straight && is_polynomial(block) ? draw_polynomial(block, part, canvas) : Got::too_large;
    return got == Got::too_large ? rows(block, part, store) : got == Got::window;
}

/// Draws a polynomial block where all its pixels share a filter and a window.
BlockReader::Got BlockReader::draw_polynomial(const Block& block, const Box& part, const Canvas& canvas) {
    const Filtering f = filtering(jacobian_of(block));
    const BlockPolynomial of_source = polynomial_of(m_map, block);
    if (!shares_filter(of_source, block)) return Got::too_large;
    const LevelPolynomial polynomial(of_source, block, f.scale_x, f.scale_y);
    Window window;
    const Got got = polynomial_window(f, block, polynomial, window);
    if (got == Got::window)
        draw_window(f, block, on_block(polynomial.p, block), {polynomial.base_x, polynomial.base_y}, window,
                    part, canvas);
    return got;
}

/// The filter that serves all pixels of a block with these points. False where none does for certain.
template <class Real>
bool BlockReader::filtering_of(const Block& block, const PixelPoints<Real>& points, Filtering& f) const {
    f = filtering({});
    if (!averages(m_filter)) return true;
    const int width = block.box.width(), height = block.box.height();
    if (width < 2 || height < 2) return false;
    const auto at = at_points(points);
    const Jacobian j = Steps(at, block).jacobian(whole(block));
    if (!all_alike(points, 1, width - 1, height, j.x_i, j.y_i) ||
        !all_alike(points, points.row_stride, width, height - 1, j.x_j, j.y_j))
        return false;
    f = filtering(j);
    return true;
}

/// Draws a block whose points are at hand, read on the source itself, where its pixels share a filter and a
/// window.
BlockReader::Got BlockReader::draw_points(const Block& block, const BlockPoints& points, const Box& part,
                                          const Canvas& canvas) {
    Filtering f;
    if (!filtering_of(block, points, f) || f.level > 0) return Got::too_large;
    Range x, y;
    if (!ranges_of(block, points, whole(block), x, y)) return Got::too_large;
    Window window;
    const Got got = window_of(f, block.source_piece, block.base_x, x, block.base_y, y, block.box, window);
    if (got == Got::window)
        draw_window(
            f, block,
            {nullptr, 0, block.box.width(), block.box.height(), points.x, points.y, points.row_stride},
            {block.base_x, block.base_y}, window, part, canvas);
    return got;
}

/// Draws a block whose points are in double, where its pixels share a filter and a window.
BlockReader::Got BlockReader::draw_in_double(const Block& block, const Box& part, const Canvas& canvas) {
    const PixelPoints<double> points = m_exact.points();
    Filtering f;
    Range range_x, range_y;
    if (!lie_together(whole(block)) || !ranges_in_double(whole(block), range_x, range_y) ||
        !filtering_of(block, points, f))
        return Got::too_large;
    const LevelPoints x(range_x.low, range_x.high, f.scale_x), y(range_y.low, range_y.high, f.scale_y);
    Window window;
    const bool apart = lie_apart([&](int i, int j) { return m_exact.at(i, j); }, block);
    const Got got =
        apart ? Got::too_large
              : window_of(f, m_exact.piece(0)[0], x.base, x.range, y.base, y.range, block.box, window);
    if (got == Got::too_large) return draw_scattered(f, block, range_y, part, canvas);
    if (got != Got::window) return got;
    draw_window(f, block, split(block, part, x.scale, y.scale, {x.base, y.base}).points(block),
                {x.base, y.base}, window, part, canvas);
    return got;
}

/// Where the texels of a block's points in double lie far apart, or across an edge, in an image that stands in memory: all
/// its rows that the block reads are one window, and rows that close on themselves are followed around. Pixels whose own
/// texels lie across an edge are drawn by themselves. For filters that read one point, at level 0; other ways to read give
/// the same bits, but for uint8 (image/packed_blocks.h).
BlockReader::Got BlockReader::draw_scattered(const Filtering& f, const Block& block, const Range& y,
                                             const Box& part, const Canvas& canvas) {
    if (averages(m_filter) || m_source.type() == PixelType::uint8) return Got::too_large;
    const int piece = m_exact.piece(0)[0], reach = support_of(f.kernel);
    const Size size = m_source.size(0);
    Box box = m_border.interior(piece, m_source.level(0));
    box.y0 = std::max(box.y0, static_cast<int>(std::floor(y.low)) - reach);
    box.y1 = std::min(box.y1, static_cast<int>(std::floor(y.high)) + reach + 1);
    // Behind an image's last row nothing may be read.
    if (box.y1 == size.height) --box.y1;
    Window window;
    if (box.width() <= 2 * reach || box.height() <= 2 * reach ||
        !m_reader.get_in_place(0, piece, box, window) ||
        !(std::fabs(static_cast<double>(window.row_stride)) * (box.height() + 1.0) <
          std::numeric_limits<std::int32_t>::max()))
        return Got::too_large;
    const SplitBlock at = split(block, part, 1, 1, {0, 0});
    const simd::Readable readable{box, reach, size.width, m_border.turn(size)};
    m_over_edge.clear();
    for (int j = part.y0; j < part.y1; ++j) {
        const std::ptrdiff_t first = (j - block.box.y0) * at.stride;
        std::int32_t outside[simd::kRowRoom];
        if (!simd::place_in(readable, block.box.width(), at.whole_x + first, at.whole_y + first, outside))
            continue;
        for (int i = part.x0; i < part.x1; ++i)
            if (outside[i - block.box.x0] != 0) m_over_edge.push_back({i, j});
    }
    draw_window(f, block, at.points(block), {box.x0, box.y0}, window, part, canvas);
    return draw_pixels(block, m_over_edge, canvas) ? Got::window : Got::failed;
}

/// Pixels of a block whose points were read in double, each from texels of its own.
bool BlockReader::draw_pixels(const Block& block, const std::vector<Point<int>>& pixels,
                              const Canvas& canvas) {
    const simd::Kernel kernel = filtering({}).kernel;
    ApartReader::Row& row = m_apart_rows[0];
    for (std::size_t first = 0; first < pixels.size(); first += kMaxRow) {
        row.count = static_cast<int>(std::min<std::size_t>(kMaxRow, pixels.size() - first));
        for (int k = 0; k < row.count; ++k) {
            const Point<int>& p = pixels[first + static_cast<std::size_t>(k)];
            take_apart(block, {}, p.x - block.box.x0, p.y - block.box.y0, k, row);
        }
        if (!m_apart.locate(row, kernel)) return false;
        const PixelType type = m_apart.sample(row, kernel, m_values.data());
        for (int k = 0; k < row.count; ++k) {
            const Point<int>& p = pixels[first + static_cast<std::size_t>(k)];
            canvas.store(p.x, p.y, 1, m_values.data() + std::ptrdiff_t{k} * m_source.channels(),
                         one_of(type));
        }
    }
    return true;
}

/// The texels that the points of a part of a block fall into, less `base`, and the rests.
BlockReader::SplitBlock BlockReader::split(const Block& block, const Box& part, double scale_x,
                                           double scale_y, const Point<std::int32_t>& base) {
    const PixelPoints<double> points = m_exact.points();
    const int width = block.box.width(), height = block.box.height();
    const std::ptrdiff_t stride = simd::kRowRoom, room = stride * height;
    m_texels.resize(2 * static_cast<std::size_t>(room));
    m_rests.resize(2 * static_cast<std::size_t>(room));
    const SplitBlock at{m_texels.data(), m_texels.data() + room, m_rests.data(), m_rests.data() + room,
                        stride};
    for (int j = part.y0 - block.box.y0; j < part.y1 - block.box.y0; ++j) {
        const std::ptrdiff_t from = j * points.row_stride, to = j * stride;
        simd::split_points(points.x + from, width, scale_x, base.x, at.whole_x + to, at.x + to);
        simd::split_points(points.y + from, width, scale_y, base.y, at.whole_y + to, at.y + to);
    }
    return at;
}

void BlockReader::draw_window(const Filtering& f, const Block& block, const simd::Polynomials& polynomials,
                              const Point<std::int32_t>& base, const Window& window, const Box& part,
                              const Canvas& canvas) {
    const simd::Texels texels = texels_of(f, window, base.x, base.y, texels_in(block.box));
    const auto draw_to = [&](std::byte* to, std::ptrdiff_t row_stride) {
        simd::draw_block(texels, polynomials, part.x0 - block.box.x0, part.x1 - block.box.x0,
                         part.y0 - block.box.y0, part.y1 - block.box.y0,
                         canvas.scale_from(one_of(window.type)), canvas.type(), to, row_stride);
    };
    if (canvas.packed()) return draw_to(canvas.at(part.x0, part.y0), canvas.row_stride());
    // Pixels with gaps have the same bits: they are drawn packed, and spread.
    const std::ptrdiff_t pixel = std::ptrdiff_t{canvas.channels()} * size_of(canvas.type());
    std::vector<std::byte> packed(static_cast<std::size_t>(pixel * part.width() * part.height()));
    draw_to(packed.data(), pixel * part.width());
    const std::byte* from = packed.data();
    for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; ++x, from += pixel) std::copy_n(from, pixel, canvas.at(x, y));
}

// --- blocks by kind
// ------------------------------------------------------------------------------------------

/// Do all pixels of a polynomial block share the filter that serves its middle?
bool BlockReader::shares_filter(const BlockPolynomial& polynomial, const Block& block) const {
    return !averages(m_filter) || shares_footprint(polynomial, block);
}

bool BlockReader::polynomial_rows(const Block& block, const Box& part, const Row& row) {
    const BlockPolynomial of_source = polynomial_of(m_map, block);
    if (!shares_filter(of_source, block)) return rows(block, points_of(block), part, row);
    const Filtering f = filtering(jacobian_of(block));
    const LevelPolynomial polynomial(of_source, block, f.scale_x, f.scale_y);
    Window window;
    const Got got = polynomial_window(f, block, polynomial, window);
    if (got == Got::failed) return false;
    if (got == Got::too_large) return rows(block, points_of(block), part, row);
    const simd::Texels texels =
        texels_of(f, window, polynomial.base_x, polynomial.base_y, texels_in(block.box));
    alignas(64) float px[simd::kRowRoom], py[simd::kRowRoom];
    for (int j = part.y0; j < part.y1; ++j) {
        simd::block_points(on_block(polynomial.p, block), j - block.box.y0, part.x0 - block.box.x0,
                           part.x1 - block.box.x0, px, py);
        sample(texels, {px, py, part.width()}, window.type, part.x0, j, row);
    }
    return true;
}

bool BlockReader::rows(const Block& block, const BlockPoints& points, const Box& part, const Row& row) {
    if (m_filter == Filter::summed_area) return rows_one_by_one(block, points, part, row);
    const auto at = at_points(points);
    if (lie_apart(at, block)) return rows_apart(block, points, part, row);
    if (m_filter == Filter::antialias && !m_map.is_smooth_in_pixels() && !is_line(block))
        return own_rows(block, points, part, row);
    const auto body = [&](const Box& cell, const Filtering& f) {
        return points_cell(f, block, points, cell, part, row);
    };
    return for_each_footprint(block, at, part, row, body);
}

/// body(cell, filtering) for the cells of a block that share a footprint; `at` gives the source points of its
/// pixels, counted from its corner. Pixels of `part` that no footprint serves are drawn.
template <class At, class Body>
bool BlockReader::for_each_footprint(const Block& block, const At& at, const Box& part, const Row& row,
                                     const Body& body) {
    if (!averages(m_filter)) return body(whole(block), filtering({}));
    if (is_line(block)) return pixels_of_cell(block, whole(block), part, row, body);
    const Steps<At> steps(at, block);
    const auto derivative = [&](const Box& cell) { return steps.jacobian(cell); };
    const auto alike = [&](const Box& cell, const Jacobian& jacobian) { return steps.alike(cell, jacobian); };
    // The derivatives of a cell with few steps are found where that takes little time.
    const bool by_pixels = m_map.is_smooth_in_pixels();
    return for_each_cell(
        whole(block), by_pixels ? kFewSteps : 1, derivative, alike, [&](const Box& cell, const Jacobian& j) {
            return by_pixels && has_few_steps(cell) ? pixels_of_cell(block, cell, part, row, body)
                                                    : body(cell, filtering(j));
        });
}

/// The pixels of a block by one filter where that serves all, else at once where all have taps of their own, else by its largest cells
/// whose pixels do or share a filter.
bool BlockReader::own_rows(const Block& block, const BlockPoints& points, const Box& part, const Row& row) {
    const auto body = [&](const Box& cell, const Filtering& f) {
        return points_cell(f, block, points, cell, part, row);
    };
    Filtering shared;
    if (filtering_of(block, points, shared)) return body(whole(block), shared);
    find_own(block, points);
    const auto at = at_points(points);
    const Steps steps(at, block);
    const auto draw_cell = [&](const auto& self, const Box& cell) -> bool {
        if (part_of(cell, block, part).empty()) return true;
        const simd::OwnKind kind =
            m_own_reach.kind == simd::OwnKind::others ? kind_of_cell(cell) : m_own_reach.kind;
        if (kind != simd::OwnKind::others) return body(cell, own_filtering(kind));
        const Jacobian j = steps.jacobian(cell);
        if (texels_in(cell) <= 1 || steps.alike(cell, j)) return body(cell, filtering(j));
        return for_halves(cell, [&](const Box& half) { return self(self, half); });
    };
    return draw_cell(draw_cell, whole(block));
}

/// Finds the taps that the pixels of a block have for themselves.
void BlockReader::find_own(const Block& block, const BlockPoints& points) {
    constexpr std::ptrdiff_t kStride = simd::kRowRoom, kPlane = kStride * Block::kMaxSide;
    m_own_taps.resize(std::size_t{4 * kPlane});
    m_own_counts.resize(std::size_t{kPlane});
    float* const taps = m_own_taps.data();
    m_own = {taps, taps + kPlane, taps + 2 * kPlane, taps + 3 * kPlane, m_own_counts.data(), kStride};
    const float widest =
        m_chooser.levels() > 1 ? simd::kWidestOnFinest : std::numeric_limits<float>::infinity();
    m_own_reach = simd::own_taps(points.x, points.y, points.row_stride, block.box.width(), block.box.height(),
                                 widest, m_own);
}

/// What serves all pixels of a cell.
simd::OwnKind BlockReader::kind_of_cell(const Box& cell) const {
    std::int32_t most = 0;
    for (int j = cell.y0; j < cell.y1; ++j) {
        const std::int32_t* const taps = m_own.taps + j * m_own.stride;
        for (int i = cell.x0; i < cell.x1; ++i) most = std::max(most, taps[i]);
    }
    return simd::own_kind(most);
}

BlockReader::Filtering BlockReader::own_filtering(simd::OwnKind kind) const {
    Filtering f = filtering({});
    f.own = kind != simd::OwnKind::one;
    if (f.own) f.reach_x = f.reach_y = 0.5;
    // What rounding moves taps by is far below the half of a texel that windows have to spare.
    if (kind == simd::OwnKind::some) {
        f.reach_x = std::max(f.reach_x, double{m_own_reach.x});
        f.reach_y = std::max(f.reach_y, double{m_own_reach.y});
    }
    return f;
}

/// The pixels of a cell, each by the map's derivative there.
template <class Body>
bool BlockReader::pixels_of_cell(const Block& block, const Box& cell, const Box& part, const Row& row,
                                 const Body& body) {
    const Box own = part_of(cell, block, part);
    bool ok = true;
    for (int y = own.y0; y < own.y1; ++y)
        for (int x = own.x0; x < own.x1; ++x) {
            Jacobian middle;
            const int parts = parts_at(x, y, block.piece, middle);
            if (parts == 1) {
                const int i = x - block.box.x0, j = y - block.box.y0;
                ok = body({i, j, i + 1, j + 1}, filtering(middle)) && ok;
            } else {
                ok = sample_parts(x, y, block.piece, parts, m_values.data()) && ok;
                finish(x, y, 1, 1, row);
            }
        }
    return ok;
}

/// Finds the ranges of the points of a cell. False where they are too far away.
bool BlockReader::ranges_of(const Block& block, const BlockPoints& points, const Box& cell, Range& x,
                            Range& y) {
    x = ends_over(points.x, points.row_stride, cell);
    y = ends_over(points.y, points.row_stride, cell);
    return is_near(block.base_x + x.low) && is_near(block.base_x + x.high) && is_near(block.base_y + y.low) &&
           is_near(block.base_y + y.high);
}

bool BlockReader::points_cell(const Filtering& f, const Block& block, const BlockPoints& points,
                              const Box& cell, const Box& part, const Row& row) {
    const Box own = part_of(cell, block, part);
    if (own.empty()) return true;
    Range x, y;
    const auto taps_of = [&](int j) {
        return f.own ? m_own.at((j - block.box.y0) * m_own.stride + own.x0 - block.box.x0) : simd::OwnTaps{};
    };
    const auto in_parts = [&] {
        if (texels_in(cell) <= kSmallCell) return rows_one_by_one(block, points, own, row);
        return for_halves(cell,
                          [&](const Box& half) { return points_cell(f, block, points, half, part, row); });
    };
    if (!ranges_of(block, points, cell, x, y)) return in_parts();
    // On the source itself the block's offsets serve as they are, unless a cell lies apart from its base.
    if (f.level > 0 || !(cell == whole(block))) {
        double px[simd::kRowRoom], py[simd::kRowRoom];
        const auto at = [&](int j) {
            const std::ptrdiff_t k = (j - block.box.y0) * points.row_stride + own.x0 - block.box.x0;
            for (int i = 0; i < own.width(); ++i) {
                px[i] = block.base_x + double{points.x[k + i]};
                py[i] = block.base_y + double{points.y[k + i]};
            }
            return Point<const double*>{px, py};
        };
        const LevelPoints lx(block.base_x + x.low, block.base_x + x.high, f.scale_x),
            ly(block.base_y + y.low, block.base_y + y.high, f.scale_y);
        const Got got = split_rows(f, block.source_piece, at, taps_of, lx, ly, cell, own, row);
        return got == Got::too_large ? in_parts() : got == Got::window;
    }
    Window window;
    const Got got = window_of(f, block.source_piece, block.base_x, x, block.base_y, y, cell, window);
    if (got == Got::too_large) return in_parts();
    if (got == Got::failed) return false;
    const simd::Texels texels = texels_of(f, window, block.base_x, block.base_y, texels_in(cell));
    for (int j = own.y0; j < own.y1; ++j) {
        const std::ptrdiff_t at = (j - block.box.y0) * points.row_stride + own.x0 - block.box.x0;
        sample(texels, {points.x + at, points.y + at, own.width(), nullptr, nullptr, taps_of(j)}, window.type,
               own.x0, j, row);
    }
    return true;
}

/// The pixels of `own`, a part of a cell whose points lie in the given ranges; `points` gives the source
/// points of a row of them, `taps` what they have for themselves.
template <class RowPoints, class RowTaps>
BlockReader::Got BlockReader::split_rows(const Filtering& f, int piece, const RowPoints& points,
                                         const RowTaps& taps, const LevelPoints& x, const LevelPoints& y,
                                         const Box& cell, const Box& own, const Row& row) {
    Window window;
    const Got got = window_of(f, piece, x.base, x.range, y.base, y.range, cell, window);
    if (got != Got::window) return got;
    const simd::Texels texels = texels_of(f, window, x.base, y.base, texels_in(cell));
    alignas(64) float fx[simd::kRowRoom] = {}, fy[simd::kRowRoom] = {};
    alignas(64) std::int32_t ix[simd::kRowRoom] = {}, iy[simd::kRowRoom] = {};
    for (int j = own.y0; j < own.y1; ++j) {
        const Point<const double*> at = points(j);
        simd::split_points(at.x, own.width(), x.scale, x.base, ix, fx);
        simd::split_points(at.y, own.width(), y.scale, y.base, iy, fy);
        sample(texels, {fx, fy, own.width(), ix, iy, taps(j)}, window.type, own.x0, j, row);
    }
    return Got::window;
}

/// The source points of all pixels of a block; of a computed one, of a map of a single layer.
BlockPoints BlockReader::points_of(const Block& block) {
    if (!m_planes) m_planes.emplace(1);
    const PointRows& to = m_planes->rows()[0];
    if (block.kind == Block::Kind::computed)
        m_map.computed({&block, 1}, &to);
    else
        for (int j = 0; j < block.box.height(); ++j)
            block_row(m_map, block, block.box, block.box.y0 + j, to.x + j * to.stride, to.y + j * to.stride);
    return m_planes->points(0);
}

/// Reads a block whose points are in double. Positions of the whole block decide how it is drawn, whatever part of it
/// is asked for.
void BlockReader::read_in_double(const Block& block) {
    m_exact.read(m_map, block, 0, block.box.height());
}

/// Do all pixels of a cell have source points, on one piece?
bool BlockReader::lie_together(const Box& cell) const {
    const std::int32_t first = m_exact.piece(cell.y0)[cell.x0];
    for (int j = cell.y0; j < cell.y1; ++j) {
        const std::int32_t* const piece = m_exact.piece(j);
        if (!std::all_of(piece + cell.x0, piece + cell.x1, [&](std::int32_t p) { return p == first; }))
            return false;
    }
    return first >= 0;
}

bool BlockReader::rows_in_double(const Block& block, const Box& part, const Row& row) {
    const auto at = [&](int i, int j) { return m_exact.at(i, j); };
    if (lie_apart(at, block)) return rows_apart(block, {}, part, row);
    const auto body = [&](const Box& cell, const Filtering& f) {
        return exact_cell(f, block, cell, part, row);
    };
    if (!averages(m_filter)) return body(whole(block), filtering({}));
    // Steps go from source point to source point.
    Range x, y;
    if (!lie_together(whole(block)) || !ranges_in_double(whole(block), x, y))
        return rows_one_by_one(block, {}, part, row);
    return for_each_footprint(block, at, part, row, body);
}

/// Finds the ranges of the points of a cell that were read in double. False where they are too far away.
bool BlockReader::ranges_in_double(const Box& cell, Range& x, Range& y) const {
    const PixelPoints<double> points = m_exact.points();
    x = ends_over(points.x, points.row_stride, cell);
    y = ends_over(points.y, points.row_stride, cell);
    return is_near(x.low) && is_near(x.high) && is_near(y.low) && is_near(y.high);
}

bool BlockReader::exact_cell(const Filtering& f, const Block& block, const Box& cell, const Box& part,
                             const Row& row) {
    const Box own = part_of(cell, block, part);
    if (own.empty()) return true;
    const auto in_parts = [&] {
        if (texels_in(cell) <= kSmallCell) return rows_one_by_one(block, {}, own, row);
        return for_halves(cell, [&](const Box& half) { return exact_cell(f, block, half, part, row); });
    };
    Range x, y;
    if (!lie_together(cell) || !ranges_in_double(cell, x, y)) return in_parts();
    const auto at = [&](int j) {
        const PixelPoints<double> points = m_exact.points();
        const std::ptrdiff_t k = (j - block.box.y0) * points.row_stride + own.x0 - block.box.x0;
        return Point<const double*>{points.x + k, points.y + k};
    };
    const auto none = [](int) { return simd::OwnTaps{}; };
    const Got got =
        split_rows(f, m_exact.piece(cell.y0)[cell.x0], at, none, LevelPoints(x.low, x.high, f.scale_x),
                   LevelPoints(y.low, y.high, f.scale_y), cell, own, row);
    return got == Got::too_large ? in_parts() : got == Got::window;
}

/// Each pixel with a window of its own: where a block's texels lie far apart.
bool BlockReader::rows_one_by_one(const Block& block, const BlockPoints& points, const Box& part,
                                  const Row& row) {
    const int channels = m_source.channels();
    alignas(64) float px[simd::kRowRoom] = {}, py[simd::kRowRoom] = {};
    bool ok = true;
    for (int j = part.y0; j < part.y1; ++j) {
        const int k = j - block.box.y0, first = part.x0 - block.box.x0;
        if (points.x) {
            const std::ptrdiff_t at = k * points.row_stride + first;
            std::copy_n(points.x + at, part.width(), px);
            std::copy_n(points.y + at, part.width(), py);
        } else
            block_row(m_map, block, part, j, px, py);
        for (int i = 0; i < part.width(); ++i) {
            float* pixel = m_values.data() + i * channels;
            Point<double> p{block.base_x + double{px[i]}, block.base_y + double{py[i]}};
            int piece = block.source_piece;
            if (in_double(block)) {
                p = m_exact.at(first + i, k);
                piece = m_exact.piece(k)[first + i];
            }
            if (piece < 0)
                std::fill_n(pixel, channels, 0.0f);
            else
                ok = sample_point(part.x0 + i, j, block.piece, p, piece, pixel) && ok;
        }
        finish(part.x0, j, part.width(), 1, row);
    }
    return ok;
}

/// Does the map minify so much that no cell of the block has its texels together? Judged by the steps in its middle.
template <class At>
bool BlockReader::lie_apart(const At& at, const Block& block) const {
    if (averages(m_filter) || is_line(block)) return false;
    const Steps<At> steps(at, block);
    const Jacobian j = steps.jacobian(whole(block));
    return (std::fabs(j.x_i) + std::fabs(j.x_j)) * (std::fabs(j.y_i) + std::fabs(j.y_j)) > kMostTexels;
}

/// Each pixel with texels of its own, of filters that read one point. The next row's are on their way meanwhile.
bool BlockReader::rows_apart(const Block& block, const BlockPoints& points, const Box& part, const Row& row) {
    const simd::Kernel kernel = filtering({}).kernel;
    for (int j = part.y0; j <= part.y1; ++j) {
        ApartReader::Row& next = m_apart_rows[j & 1];
        ApartReader::Row& now = m_apart_rows[(j - 1) & 1];
        if (j < part.y1) {
            next.count = part.width();
            for (int i = 0; i < next.count; ++i)
                take_apart(block, points, part.x0 - block.box.x0 + i, j - block.box.y0, i, next);
            if (!m_apart.locate(next, kernel)) return false;
        }
        if (j == part.y0) continue;
        const PixelType type = m_apart.sample(now, kernel, m_values.data());
        finish(part.x0, j - 1, part.width(), one_of(type), row);
    }
    return true;
}

/// Pixel (i, j) of a block, counted from its corner, to place k of a row. Beyond every edge all points are alike: those too
/// far away come nearer.
void BlockReader::take_apart(const Block& block, const BlockPoints& points, int i, int j, int k,
                             ApartReader::Row& to) const {
    const std::ptrdiff_t at = j * points.row_stride + i;
    const Point<double> p =
        points.x ? Point<double>{block.base_x + double{points.x[at]}, block.base_y + double{points.y[at]}}
                 : m_exact.at(i, j);
    const bool is_none = std::isnan(p.x) || std::isnan(p.y);
    to.x[k] = is_none ? 0 : std::clamp(p.x, -kFarthest, kFarthest);
    to.y[k] = is_none ? 0 : std::clamp(p.y, -kFarthest, kFarthest);
    to.piece[k] = is_none ? -1 : points.x ? block.source_piece : m_exact.piece(j)[i];
}

bool BlockReader::sample_point(int i, int j, int target_piece, const Point<double>& p, int piece,
                               float* pixel) {
    if (!averages(m_filter)) return m_points.sample(m_filter, 0, piece, p.x, p.y, pixel);
    Jacobian middle;
    const int parts = parts_at(i, j, target_piece, middle);
    if (parts == 1) return m_points.sample(m_filter, m_chooser, middle, piece, p.x, p.y, pixel);
    return sample_parts(i, j, target_piece, parts, pixel);
}

/// Into how many parts each way pixel (i, j) is cut, and the derivative in its middle.
int BlockReader::parts_at(int i, int j, int target_piece, Jacobian& middle) {
    middle = m_map.jacobian(i + 0.5, j + 0.5, target_piece);
    if (!m_map.is_smooth_in_pixels()) return 1;
    const auto corner = [&](int x, int y) { return derivative_at(x, y, target_piece); };
    return parts_of_pixel(middle, {corner(i, j), corner(i + 1, j), corner(i, j + 1), corner(i + 1, j + 1)});
}

/// In the corner of a pixel, which neighbours share.
const Jacobian& BlockReader::derivative_at(int x, int y, int target_piece) {
    Corner& corner = m_corners[static_cast<std::size_t>((x & 7) + 8 * (y & 7))];
    if (corner.x != x || corner.y != y || corner.piece != target_piece)
        corner = {x, y, target_piece, m_map.jacobian(x, y, target_piece)};
    return corner.derivative;
}

/// The mean over n x n parts of a pixel, each by a footprint of its own; over kRays x kRays of them by the source itself. Parts
/// without a source point do not count: where a picture ends pixels are whole, as all of them are whose middle has one.
bool BlockReader::sample_parts(int i, int j, int target_piece, int n, float* pixel) {
    const auto channels = static_cast<std::size_t>(m_source.channels());
    m_part.resize(channels);
    m_parts.assign(channels, 0.0);
    int count = 0;
    for (int b = 0; b < n; ++b)
        for (int a = 0; a < n; ++a) {
            const double x = i + (a + 0.5) / n, y = j + (b + 0.5) / n;
            Point<double> p;
            int piece;
            if (!m_map.exact(x, y, target_piece, p, piece)) continue;
            ++count;
            Jacobian own;
            if (n < kRays) {
                own = m_map.jacobian(x, y, target_piece);
                for (double* d : {&own.x_i, &own.y_i, &own.x_j, &own.y_j}) *d /= n;
            }
            if (!m_points.sample(m_filter, m_chooser, own, piece, p.x, p.y, m_part.data())) return false;
            for (std::size_t c = 0; c < channels; ++c) m_parts[c] += static_cast<double>(m_part[c]);
        }
    for (std::size_t c = 0; c < channels; ++c) pixel[c] = static_cast<float>(m_parts[c] / std::max(count, 1));
    return true;
}

void BlockReader::sample(const simd::Texels& texels, const simd::Offsets& offsets, PixelType type, int x,
                         int y, const Row& row) {
    simd::sample_row(texels, offsets, m_values.data());
    finish(x, y, offsets.count, one_of(type), row);
}

/// A row of filtered values to the taker.
void BlockReader::finish(int x, int y, int count, float one, const Row& row) {
    const int alpha = m_source.unassociated_alpha(), channels = m_source.channels();
    for (int i = 0; alpha >= 0 && i < count; ++i)
        unassociate_alpha(m_values.data() + i * channels, channels, alpha);
    row(x, y, count, m_values.data(), one);
}

// --- windows and filters
// -------------------------------------------------------------------------------------

BlockReader::Got BlockReader::polynomial_window(const Filtering& f, const Block& block,
                                                const LevelPolynomial& p, Window& window) {
    return window_of(f, block.source_piece, p.base_x, p.x, p.base_y, p.y, block.box, window);
}

BlockReader::Got BlockReader::window_of(const Filtering& f, int piece, std::int32_t base_x,
                                        const Range& range_x, std::int32_t base_y, const Range& range_y,
                                        const Box& block, Window& window) {
    const Span x(f, f.reach_x, base_x, range_x), y(f, f.reach_y, base_y, range_y);
    if (!x.fits() || !y.fits()) return Got::too_large;
    // Offsets are floats, which move half a texel without losing it, and count elements in 32 bits.
    constexpr double kMostOffset = 1 << 20;
    const double most_x = x.farthest_from(base_x), most_y = y.farthest_from(base_y);
    if (!(most_x <= kMostOffset && most_y <= kMostOffset)) return Got::too_large;
    const Box box{static_cast<int>(x.first), static_cast<int>(y.first), static_cast<int>(x.last),
                  static_cast<int>(y.last)};
    if (texels_in(box) > kMostTexels * texels_in(block) + 4096) return Got::too_large;
    // To put a window together takes longer than to read a few of its texels.
    if (texels_in(block) > kSmallCell && texels_in(box) > kMostPutTogether * texels_in(block) &&
        m_reader.crosses_edge(f.level, piece, box))
        return Got::too_large;
    const auto fits = [&] {
        const double pixel = double(window.channels) * size_of(window.type);
        const double span = std::fabs(double(window.row_stride)) * most_y + pixel * most_x;
        return span < std::numeric_limits<std::int32_t>::max();
    };
    if (!m_reader.get(f.level, piece, box, window)) return Got::failed;
    // Rows that stand far apart in memory are no reason to read otherwise than from a file.
    if (!fits() && !m_reader.get_copy(f.level, piece, box, window)) return Got::failed;
    return fits() ? Got::window : Got::too_large;
}

simd::Texels BlockReader::texels_of(const Filtering& f, const Window& window, std::int32_t base_x,
                                    std::int32_t base_y, double pixels) {
    const std::ptrdiff_t pixel = std::ptrdiff_t{window.channels} * size_of(window.type);
    return {window.texels + (base_y - window.box.y0) * window.row_stride + (base_x - window.box.x0) * pixel,
            window.row_stride,
            window.type,
            window.channels,
            f.kernel,
            f.taps.data(),
            f.tap_count,
            texels_in(window.box) > kApart * pixels};
}

BlockReader::Filtering BlockReader::filtering(const Jacobian& steps) const {
    Filtering f;
    const Jacobian jacobian = m_filter == Filter::pyramid ? covering_rectangle(steps) : steps;
    if (m_filter == Filter::nearest) f.kernel = simd::Kernel::nearest;
    if (m_filter == Filter::bicubic) f.kernel = simd::Kernel::bicubic;
    if (m_filter == Filter::bicubic_clamped) f.kernel = simd::Kernel::bicubic_clamped;
    if (m_filter == Filter::sharp_bicubic) f.kernel = simd::Kernel::sharp_bicubic;
    if (m_filter == Filter::sharp_bicubic_clamped) f.kernel = simd::Kernel::sharp_bicubic_clamped;
    if (!averages(m_filter)) return f;
    const Footprint footprint = m_chooser(jacobian);
    f.level = footprint.level;
    f.scale_x = m_chooser.scale(f.level)[0];
    f.scale_y = m_chooser.scale(f.level)[1];
    f.tap_count = 0;
    const TapOffsets offset(footprint, jacobian, {f.scale_x, f.scale_y});
    for (int b = 0; b < footprint.taps_b; ++b)
        for (int a = 0; a < footprint.taps_a; ++a) {
            Point<double> o = offset(a, b);
            // Next to a point that is none a footprint has no direction; its taps stay in the middle.
            if (std::isnan(o.x) || std::isnan(o.y)) o = {};
            f.taps[static_cast<std::size_t>(f.tap_count++)] = {static_cast<float>(o.x),
                                                               static_cast<float>(o.y)};
            f.reach_x = std::max(f.reach_x, std::fabs(o.x));
            f.reach_y = std::max(f.reach_y, std::fabs(o.y));
        }
    return f;
}

}  // namespace anamorph
