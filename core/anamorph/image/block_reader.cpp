// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/block_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "anamorph/image/pixel.h"

namespace anamorph {
namespace {

constexpr int kMaxRow = simd::kMaxRow;

bool is_polynomial(const Block& block) {
    return block.kind == Block::Kind::polynomial || block.kind == Block::Kind::bicubic;
}

BlockPolynomial polynomial_of(const BlockMap& map, const Block& block) {
    return block.kind == Block::Kind::bicubic ? map.bicubic(block) : quadratic_of(block);
}

simd::Polynomials on_block(const BlockPolynomial& p, const Block& block) {
    return {p.c, p.degree, block.box.width(), block.box.height()};
}

/// From the coefficients of a polynomial block.
Jacobian jacobian_of(const Block& block) {
    const double hx = 0.5 * std::max(1, block.box.width() - 1),
                 hy = 0.5 * std::max(1, block.box.height() - 1);
    return {block.x[1] / hx, block.y[1] / hx, block.x[2] / hy, block.y[2] / hy};
}

/// The least and the greatest of the points of a block in one coordinate.
void range_over(const float* at, std::ptrdiff_t stride, int width, int height, double& low, double& high) {
    // In lanes, so that the compiler need not keep the order of comparisons.
    constexpr int kLanes = 16;
    float least[kLanes], greatest[kLanes];
    std::fill_n(least, kLanes, HUGE_VALF);
    std::fill_n(greatest, kLanes, -HUGE_VALF);
    const auto take = [&](float v, int lane) {
        least[lane] = v < least[lane] ? v : least[lane];
        greatest[lane] = v > greatest[lane] ? v : greatest[lane];
    };
    for (int j = 0; j < height; ++j, at += stride) {
        int i = 0;
        for (; i + kLanes <= width; i += kLanes)
            for (int lane = 0; lane < kLanes; ++lane) take(at[i + lane], lane);
        for (; i < width; ++i) take(at[i], 0);
    }
    low = *std::min_element(least, least + kLanes);
    high = *std::max_element(greatest, greatest + kLanes);
}

}  // namespace

void block_row(const BlockMap& map, const Block& block, const Box& part, int j, float* x, float* y) {
    const int row = j - block.box.y0, begin = part.x0 - block.box.x0, end = part.x1 - block.box.x0;
    if (is_polynomial(block)) {
        const BlockPolynomial p = polynomial_of(map, block);
        simd::block_points(on_block(p, block), row, begin, end, x, y);
    }
    if (block.kind == Block::Kind::computed) map.computed_row(block, row, begin, end, x, y);
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
        // With room for the rounding of the sum.
        spread = spread * (1 + 1e-5) + 1e-3;
        return {middle - spread, middle + spread};
    }
};

/// The texels from the low to the high end of a range past a base, with those that taps and kernel need
/// around them.
struct BlockReader::Span {
    double first, last;

    Span(const Filtering& f, double tap_reach, std::int32_t base, const Range& range) {
        const int support = f.kernel == simd::Kernel::bicubic    ? 2
                            : f.kernel == simd::Kernel::bilinear ? 1
                                                                 : 0;
        first = base + std::floor(range.low - tap_reach) - support;
        last = base + std::floor(range.high + tap_reach) + support + 1;
    }
    bool fits() const { return std::max(std::fabs(first), std::fabs(last)) < (1 << 30); }
};

/// A computed block's offsets in one coordinate, in texels of a level.
struct BlockReader::LevelOffsets {
    std::int32_t base;
    float origin, scale;
    Range range;

    LevelOffsets(const float* at, std::ptrdiff_t stride, int width, int height, std::int32_t from_base,
                 double level_scale)
        : scale(static_cast<float>(level_scale)) {
        const double exact_origin = from_base * level_scale;
        base = static_cast<std::int32_t>(std::floor(exact_origin));
        origin = static_cast<float>(exact_origin - base);
        range_over(at, stride, width, height, range.low, range.high);
        // With room for the rounding of origin + offset * scale.
        const auto at_level = [&](double offset) { return origin + offset * level_scale; };
        const double room = scale == 1 ? 0 : 1e-3 + 1e-6 * (std::fabs(range.low) + std::fabs(range.high));
        range = {at_level(range.low) - room, at_level(range.high) + room};
    }
    void row(const float* at, int count, float* to) const {
        for (int i = 0; i < count; ++i) to[i] = origin + at[i] * scale;
    }
};

BlockReader::BlockReader(const BlockMap& map, const Source& source, const Border& border, Filter filter)
    : m_map(map),
      m_source(source),
      m_filter(filter),
      m_reader(source, border),
      m_points(source, border),
      m_chooser(source),
      m_values(static_cast<std::size_t>(kMaxRow) * static_cast<std::size_t>(source.channels()) + 16) {}

bool BlockReader::rows(const Block& block, const Box& part, const Row& row) {
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
            return rows(block, computed_points(block), part, row);
        case Block::Kind::exact:
            break;
    }
    return exact_rows(block, part, row);
}

bool BlockReader::draw(const Block& block, const Box& part, const Canvas& canvas, const Block* next) {
    if (is_polynomial(block) && canvas.packed() && m_source.unassociated_alpha() < 0) {
        const Filtering f = filtering(jacobian_of(block));
        const LevelPolynomial polynomial(polynomial_of(m_map, block), block, f.scale_x, f.scale_y);
        Window window;
        const Got got = polynomial_window(f, block, polynomial, window);
        if (got == Got::failed) return false;
        if (got == Got::window) {
            simd::draw_block(texels_of(f, window, polynomial.base_x, polynomial.base_y),
                             on_block(polynomial.p, block), part.x0 - block.box.x0, part.x1 - block.box.x0,
                             part.y0 - block.box.y0, part.y1 - block.box.y0,
                             canvas.scale_from(one_of(window.type)), canvas.type(),
                             canvas.at(part.x0, part.y0), canvas.row_stride(), upcoming(next, f));
            return true;
        }
    }
    return rows(block, part, [&](int x, int y, int count, const float* values, float one) {
        canvas.store(x, y, count, values, one);
    });
}

// --- blocks by kind
// ------------------------------------------------------------------------------------------

bool BlockReader::polynomial_rows(const Block& block, const Box& part, const Row& row) {
    const Filtering f = filtering(jacobian_of(block));
    const LevelPolynomial polynomial(polynomial_of(m_map, block), block, f.scale_x, f.scale_y);
    Window window;
    const Got got = polynomial_window(f, block, polynomial, window);
    if (got == Got::failed) return false;
    if (got == Got::too_large) return rows_one_by_one(block, {}, part, row);
    const simd::Texels texels = texels_of(f, window, polynomial.base_x, polynomial.base_y);
    alignas(64) float px[simd::kRowRoom], py[simd::kRowRoom];
    for (int j = part.y0; j < part.y1; ++j) {
        simd::block_points(on_block(polynomial.p, block), j - block.box.y0, part.x0 - block.box.x0,
                           part.x1 - block.box.x0, px, py);
        sample(texels, {px, py, part.width()}, window.type, part.x0, j, row);
    }
    return true;
}

bool BlockReader::rows(const Block& block, const BlockPoints& points, const Box& part, const Row& row) {
    const int w = block.box.width(), h = block.box.height();
    // The map's derivative from the outermost points.
    const auto between = [&](const float* at, std::ptrdiff_t to, int steps) {
        return steps > 0 ? (double{at[to]} - double{at[0]}) / steps : 0.0;
    };
    const Jacobian jacobian{between(points.x, w - 1, w - 1), between(points.y, w - 1, w - 1),
                            between(points.x, (h - 1) * points.row_stride, h - 1),
                            between(points.y, (h - 1) * points.row_stride, h - 1)};
    const Filtering f = filtering(jacobian);
    const LevelOffsets lx(points.x, points.row_stride, w, h, block.base_x, f.scale_x),
        ly(points.y, points.row_stride, w, h, block.base_y, f.scale_y);
    Window window;
    switch (window_of(f, block.source_piece, lx.base, lx.range, ly.base, ly.range, block.box, window)) {
        case Got::failed:
            return false;
        case Got::too_large:
            return rows_one_by_one(block, points, part, row);
        case Got::window:
            break;
    }
    const simd::Texels texels = texels_of(f, window, lx.base, ly.base);
    alignas(64) float px[simd::kRowRoom], py[simd::kRowRoom];
    for (int j = part.y0; j < part.y1; ++j) {
        const std::ptrdiff_t at = (j - block.box.y0) * points.row_stride + part.x0 - block.box.x0;
        lx.row(points.x + at, part.width(), px);
        ly.row(points.y + at, part.width(), py);
        sample(texels, {px, py, part.width()}, window.type, part.x0, j, row);
    }
    return true;
}

BlockPoints BlockReader::computed_points(const Block& block) {
    constexpr std::size_t kPlane = std::size_t{simd::kRowRoom} * Block::kMaxSide;
    m_computed.resize(2 * kPlane);
    const BlockPoints points{m_computed.data(), m_computed.data() + kPlane, simd::kRowRoom};
    for (int j = 0; j < block.box.height(); ++j)
        m_map.computed_row(block, j, 0, block.box.width(), m_computed.data() + j * points.row_stride,
                           m_computed.data() + kPlane + j * points.row_stride);
    return points;
}

bool BlockReader::exact_rows(const Block& block, const Box& part, const Row& row) {
    // Positions of the whole block decide how it is read, whatever part of it is asked for.
    const int w = block.box.width();
    m_exact.resize(static_cast<std::size_t>(w) * static_cast<std::size_t>(block.box.height()));
    double x0 = HUGE_VAL, y0 = HUGE_VAL, x1 = -HUGE_VAL, y1 = -HUGE_VAL;
    bool together = true;
    for (int j = block.box.y0; j < block.box.y1; ++j)
        for (int i = block.box.x0; i < block.box.x1; ++i) {
            Exact& e = m_exact.data()[(j - block.box.y0) * w + i - block.box.x0];
            e.seen = m_map.exact(i + 0.5, j + 0.5, block.piece, e.at, e.piece);
            together = together && e.seen && e.piece == m_exact[0].piece;
            x0 = std::min(x0, e.at.x);
            x1 = std::max(x1, e.at.x);
            y0 = std::min(y0, e.at.y);
            y1 = std::max(y1, e.at.y);
        }
    if (!together) return rows_one_by_one(block, {}, part, row);
    const Filtering f = filtering(m_map.jacobian(0.5 * (block.box.x0 + block.box.x1),
                                                 0.5 * (block.box.y0 + block.box.y1), block.piece));
    const auto base_x = static_cast<std::int32_t>(std::floor(x0 * f.scale_x));
    const auto base_y = static_cast<std::int32_t>(std::floor(y0 * f.scale_y));
    Window window;
    switch (window_of(f, m_exact[0].piece, base_x, {0, x1 * f.scale_x - base_x}, base_y,
                      {0, y1 * f.scale_y - base_y}, block.box, window)) {
        case Got::failed:
            return false;
        case Got::too_large:
            return rows_one_by_one(block, {}, part, row);
        case Got::window:
            break;
    }
    const simd::Texels texels = texels_of(f, window, base_x, base_y);
    alignas(64) float fx[simd::kRowRoom], fy[simd::kRowRoom];
    alignas(64) std::int32_t ix[simd::kRowRoom], iy[simd::kRowRoom];
    for (int j = part.y0; j < part.y1; ++j) {
        const Exact* e = m_exact.data() + (j - block.box.y0) * w + part.x0 - block.box.x0;
        for (int i = 0; i < part.width(); ++i) {
            // Whole texels apart: a fraction loses nothing in float.
            const double x = e[i].at.x * f.scale_x, y = e[i].at.y * f.scale_y;
            ix[i] = static_cast<std::int32_t>(std::floor(x)) - base_x;
            iy[i] = static_cast<std::int32_t>(std::floor(y)) - base_y;
            fx[i] = static_cast<float>(x - std::floor(x));
            fy[i] = static_cast<float>(y - std::floor(y));
        }
        sample(texels, {fx, fy, part.width(), ix, iy}, window.type, part.x0, j, row);
    }
    return true;
}

/// Each pixel with a window of its own: where a block's texels lie far apart.
bool BlockReader::rows_one_by_one(const Block& block, const BlockPoints& points, const Box& part,
                                  const Row& row) {
    const int channels = m_source.channels();
    alignas(64) float px[simd::kRowRoom] = {}, py[simd::kRowRoom] = {};
    bool ok = true;
    for (int j = part.y0; j < part.y1; ++j) {
        if (points.x) {
            const std::ptrdiff_t at = (j - block.box.y0) * points.row_stride + part.x0 - block.box.x0;
            std::copy_n(points.x + at, part.width(), px);
            std::copy_n(points.y + at, part.width(), py);
        } else
            block_row(m_map, block, part, j, px, py);
        for (int i = part.x0; i < part.x1; ++i) {
            float* pixel = m_values.data() + (i - part.x0) * channels;
            Point<double> p{block.base_x + double(px[i - part.x0]), block.base_y + double(py[i - part.x0])};
            int piece = block.source_piece;
            if (block.kind == Block::Kind::exact && !m_map.exact(i + 0.5, j + 0.5, block.piece, p, piece))
                std::fill_n(pixel, channels, 0.0f);
            else
                ok = sample_point(i, j, block.piece, p, piece, pixel) && ok;
        }
        finish(part.x0, j, part.width(), 1, row);
    }
    return ok;
}

bool BlockReader::sample_point(int i, int j, int target_piece, const Point<double>& p, int piece,
                               float* pixel) {
    if (m_filter != Filter::antialias) return m_points.sample(m_filter, 0, piece, p.x, p.y, pixel);
    const Jacobian jacobian = m_map.jacobian(i + 0.5, j + 0.5, target_piece);
    return m_points.sample(m_chooser(jacobian), jacobian, piece, p.x, p.y, pixel);
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
    // More texels than this per pixel are better fetched one pixel at a time.
    constexpr double kMost = 32;
    const double texels = (x.last - x.first) * (y.last - y.first);
    const double pixels = double(block.width()) * block.height();
    if (!(texels <= kMost * pixels + 4096) || !x.fits() || !y.fits()) return Got::too_large;
    const Box box{static_cast<int>(x.first), static_cast<int>(y.first), static_cast<int>(x.last),
                  static_cast<int>(y.last)};
    if (!m_reader.get(f.level, piece, box, window)) return Got::failed;
    // Offsets inside a window are counted in 32 bits.
    const double span = double(window.row_stride) * (box.height() + 1);
    return std::fabs(span) < std::numeric_limits<std::int32_t>::max() ? Got::window : Got::too_large;
}

/// Where the next block's texels stand in memory, if they do; filtered like this one's.
simd::Upcoming BlockReader::upcoming(const Block* next, const Filtering& f) const {
    const ConstImageView* view = m_source.view(f.level);
    if (!next || !view || !is_polynomial(*next)) return {};
    const LevelPolynomial p(quadratic_of(*next), *next, f.scale_x, f.scale_y);
    const Span x(f, f.reach_x, p.base_x, p.x), y(f, f.reach_y, p.base_y, p.y);
    if (!(x.first >= 0 && y.first >= 0 && x.last <= view->width && y.last <= view->height)) return {};
    return {view->at(static_cast<std::ptrdiff_t>(x.first), static_cast<std::ptrdiff_t>(y.first)),
            view->row_stride, static_cast<int>(y.last - y.first),
            static_cast<int>((x.last - x.first) * view->pixel_stride)};
}

simd::Texels BlockReader::texels_of(const Filtering& f, const Window& window, std::int32_t base_x,
                                    std::int32_t base_y) {
    const std::ptrdiff_t pixel = std::ptrdiff_t{window.channels} * size_of(window.type);
    return {window.texels + (base_y - window.box.y0) * window.row_stride + (base_x - window.box.x0) * pixel,
            window.row_stride,
            window.type,
            window.channels,
            f.kernel,
            f.taps.data(),
            f.tap_count};
}

BlockReader::Filtering BlockReader::filtering(const Jacobian& jacobian) const {
    Filtering f;
    if (m_filter == Filter::nearest) f.kernel = simd::Kernel::nearest;
    if (m_filter == Filter::bicubic) f.kernel = simd::Kernel::bicubic;
    if (m_filter != Filter::antialias) return f;
    const Footprint footprint = m_chooser(jacobian);
    f.level = footprint.level;
    f.scale_x = m_chooser.scale(f.level)[0];
    f.scale_y = m_chooser.scale(f.level)[1];
    f.tap_count = 0;
    for (int b = 0; b < footprint.taps_b; ++b)
        for (int a = 0; a < footprint.taps_a; ++a) {
            const Point<double> o = tap_offset(footprint, jacobian, {f.scale_x, f.scale_y}, a, b);
            f.taps[static_cast<std::size_t>(f.tap_count++)] = {static_cast<float>(o.x),
                                                               static_cast<float>(o.y)};
            f.reach_x = std::max(f.reach_x, std::fabs(o.x));
            f.reach_y = std::max(f.reach_y, std::fabs(o.y));
        }
    return f;
}

}  // namespace anamorph
