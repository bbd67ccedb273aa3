// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/reproject.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <limits>
#include <optional>
#include <vector>

#include "anamorph/image/footprint.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/window.h"
#include "anamorph/simd/block_sampler.h"

namespace anamorph {

struct Reprojection::State {
    State(const Panorama& map, const ReprojectOptions& reproject, const PlanOptions& plan_options)
        : options(reproject), plan(map, plan_options), border(map.source(), reproject.wrap) {}
    ReprojectOptions options;
    Plan plan;
    Border border;
};

namespace {

constexpr int kMaxRow = simd::kMaxRow;

/// The value of this type that stands for 1.
float one_of(PixelType type) {
    return type == PixelType::uint8 ? 255.0f : type == PixelType::uint16 ? 65535.0f : 1.0f;
}

/// The level and taps that all pixels of a block share.
struct Filtering {
    int level = 0;
    double scale_x = 1, scale_y = 1;  ///< level texels per source pixel
    simd::Kernel kernel = simd::Kernel::bilinear;
    int tap_count = 1;
    std::array<simd::Tap, simd::kMaxTaps> taps{};
    double reach_x = 0, reach_y = 0;  ///< of the taps, level texels
};

/// A box of pixels of the picture being drawn.
class Canvas {
  public:
    Canvas(const ImageView& view, const Box& box) : m_view(view), m_box(box) {}

    const Box& box() const { return m_box; }
    int channels() const { return m_view.channels; }
    PixelType type() const { return m_view.type; }
    bool packed() const { return m_view.packed(); }
    std::ptrdiff_t row_stride() const { return m_view.row_stride; }
    std::byte* at(int x, int y) const { return m_view.at(x - m_box.x0, y - m_box.y0); }
    /// The factor from values of which `one` stands for 1.
    float scale_from(float one) const { return one_of(m_view.type) / one; }

    /// Writes a row of pixels from x on; `one` is the value that stands for 1.
    void store(int x, int y, int count, const float* values, float one = 1) const {
        std::byte* to = at(x, y);
        const int channels = m_view.channels;
        const float scale = scale_from(one);
        if (m_view.packed()) return simd::store_row(values, count * channels, scale, m_view.type, to);
        for (int i = 0; i < count; ++i)
            simd::store_row(values + std::ptrdiff_t{i} * channels, channels, scale, m_view.type,
                            to + i * m_view.pixel_stride);
    }

  private:
    ImageView m_view;
    Box m_box;
};

/// Draws blocks into a canvas; one per thread.
class Painter {
  public:
    Painter(const Plan& plan, const ReprojectOptions& options, const Border& border, const Source* source,
            const Canvas& canvas)
        : m_map(plan.map()), m_options(options), m_canvas(canvas), m_source(source) {
        m_values.resize(static_cast<std::size_t>(kMaxRow) * static_cast<std::size_t>(canvas.channels()) + 16);
        if (!source) return;
        m_reader.emplace(*source, border);
        m_points.emplace(*source, border);
        m_chooser.emplace(*source);
    }

    /// False when the source could not be read. `next` is the block to be drawn after this one, if any.
    bool draw(const Block& block, const Block* next) {
        const Box box = intersection(block.box, m_canvas.box());
        if (box.empty()) return true;
        if (m_options.output != Output::color) return draw_map(block, box), true;
        if (block.kind == Block::Kind::outside) return fill(box, 0), true;
        return block.kind == Block::Kind::polynomial ? draw_polynomial(block, box, next)
                                                     : draw_exact(block, box);
    }

  private:
    // --- colour ------------------------------------------------------------------------------------------

    bool draw_polynomial(const Block& block, const Box& box, const Block* next) {
        const Filtering f = filtering(jacobian_of(block));
        const LevelPolynomial x(block.x, block.base_x, f.scale_x), y(block.y, block.base_y, f.scale_y);
        Window window;
        switch (get_window(f, block.source_piece, x.base, x.reach, y.base, y.reach, block.box, window)) {
            case Got::failed:
                return false;
            case Got::too_large:
                return draw_points(block, box);
            case Got::window:
                break;
        }
        const simd::Texels texels = texels_of(f, window, x.base, y.base);
        const simd::Polynomials polynomials{x.c, y.c, block.box.width(), block.box.height()};
        const int begin = box.x0 - block.box.x0, end = box.x1 - block.box.x0;
        if (m_canvas.packed() && m_source->unassociated_alpha() < 0) {
            simd::draw_block(texels, polynomials, begin, end, box.y0 - block.box.y0, box.y1 - block.box.y0,
                             m_canvas.scale_from(one_of(window.type)), m_canvas.type(),
                             m_canvas.at(box.x0, box.y0), m_canvas.row_stride(), upcoming(next, f));
            return true;
        }
        alignas(64) float px[simd::kRowRoom], py[simd::kRowRoom];
        for (int j = box.y0; j < box.y1; ++j) {
            simd::block_points(polynomials, j - block.box.y0, begin, end, px, py);
            sample(texels, {px, py, box.width()}, window.type, box.x0, j);
        }
        return true;
    }

    bool draw_exact(const Block& block, const Box& box) {
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
        if (!together) return draw_points(block, box);
        const Filtering f = filtering(jacobian_at(0.5 * (block.box.x0 + block.box.x1),
                                                  0.5 * (block.box.y0 + block.box.y1), block.piece));
        const auto base_x = static_cast<std::int32_t>(std::floor(x0 * f.scale_x));
        const auto base_y = static_cast<std::int32_t>(std::floor(y0 * f.scale_y));
        Window window;
        switch (get_window(f, m_exact[0].piece, base_x, {0, x1 * f.scale_x - base_x}, base_y,
                           {0, y1 * f.scale_y - base_y}, block.box, window)) {
            case Got::failed:
                return false;
            case Got::too_large:
                return draw_points(block, box);
            case Got::window:
                break;
        }
        const simd::Texels texels = texels_of(f, window, base_x, base_y);
        alignas(64) float fx[simd::kRowRoom], fy[simd::kRowRoom];
        alignas(64) std::int32_t ix[simd::kRowRoom], iy[simd::kRowRoom];
        for (int j = box.y0; j < box.y1; ++j) {
            const Exact* row = m_exact.data() + (j - block.box.y0) * w + box.x0 - block.box.x0;
            for (int i = 0; i < box.width(); ++i) {
                // Whole texels apart: a fraction loses nothing in float.
                const double x = row[i].at.x * f.scale_x, y = row[i].at.y * f.scale_y;
                ix[i] = static_cast<std::int32_t>(std::floor(x)) - base_x;
                iy[i] = static_cast<std::int32_t>(std::floor(y)) - base_y;
                fx[i] = static_cast<float>(x - std::floor(x));
                fy[i] = static_cast<float>(y - std::floor(y));
            }
            sample(texels, {fx, fy, box.width(), ix, iy}, window.type, box.x0, j);
        }
        return true;
    }

    /// Pixel by pixel, each with a window of its own: where a block's texels lie far apart.
    bool draw_points(const Block& block, const Box& box) {
        const int channels = m_canvas.channels();
        const bool polynomial = block.kind == Block::Kind::polynomial;
        alignas(64) float px[simd::kRowRoom] = {}, py[simd::kRowRoom] = {};
        bool ok = true;
        for (int j = box.y0; j < box.y1; ++j) {
            if (polynomial) points_of(block, box, j, px, py);
            for (int i = box.x0; i < box.x1; ++i) {
                float* pixel = m_values.data() + (i - box.x0) * channels;
                Point<double> p{block.base_x + double(px[i - box.x0]), block.base_y + double(py[i - box.x0])};
                int piece = block.source_piece;
                if (!polynomial && !m_map.exact(i + 0.5, j + 0.5, block.piece, p, piece))
                    std::fill_n(pixel, channels, 0.0f);
                else
                    ok = sample_point(i, j, block.piece, p, piece, pixel) && ok;
            }
            finish_row(box.x0, j, box.width());
        }
        return ok;
    }

    /// The offsets from a polynomial block's base for row j of a box in it.
    static void points_of(const Block& block, const Box& box, int j, float* px, float* py) {
        simd::block_points({block.x, block.y, block.box.width(), block.box.height()}, j - block.box.y0,
                           box.x0 - block.box.x0, box.x1 - block.box.x0, px, py);
    }

    bool sample_point(int i, int j, int target_piece, const Point<double>& p, int piece, float* pixel) {
        if (m_options.filter != Filter::antialias)
            return m_points->sample(m_options.filter, 0, piece, p.x, p.y, pixel);
        const Jacobian jacobian = jacobian_at(i + 0.5, j + 0.5, target_piece);
        return m_points->sample((*m_chooser)(jacobian), jacobian, piece, p.x, p.y, pixel);
    }

    void sample(const simd::Texels& texels, const simd::Offsets& offsets, PixelType type, int x, int y) {
        simd::sample_row(texels, offsets, m_values.data());
        finish_row(x, y, offsets.count, one_of(type));
    }

    /// A row of filtered values to the picture.
    void finish_row(int x, int y, int count, float one = 1) {
        const int alpha = m_source->unassociated_alpha(), channels = m_canvas.channels();
        for (int i = 0; alpha >= 0 && i < count; ++i)
            unassociate_alpha(m_values.data() + i * channels, channels, alpha);
        m_canvas.store(x, y, count, m_values.data(), one);
    }

    // --- windows -----------------------------------------------------------------------------------------

    struct Reach {
        double low = 0, high = 0;
    };
    enum class Got { window, too_large, failed };

    /// A block's polynomial for one coordinate in texels of a level: base + c, and the range of c.
    struct LevelPolynomial {
        float c[6];
        std::int32_t base;
        Reach reach;

        LevelPolynomial(const float* from, std::int32_t from_base, double scale) {
            const double origin = (from_base + static_cast<double>(from[0])) * scale;
            base = scale == 1 ? from_base : static_cast<std::int32_t>(std::floor(origin));
            c[0] = scale == 1 ? from[0] : static_cast<float>(origin - base);
            double spread = 0;
            for (int i = 1; i < 6; ++i) {
                c[i] = static_cast<float>(from[i] * scale);
                spread += std::fabs(c[i]);
            }
            // With room for the rounding of the sum.
            spread = spread * (1 + 1e-5) + 1e-3;
            reach = {c[0] - spread, c[0] + spread};
        }
    };

    /// The texels from `low` to `high` past a base, with those that taps and kernel need around them.
    struct Span {
        double first, last;

        Span(const Filtering& f, double tap_reach, std::int32_t base, const Reach& reach) {
            const int support = f.kernel == simd::Kernel::bicubic    ? 2
                                : f.kernel == simd::Kernel::bilinear ? 1
                                                                     : 0;
            first = base + std::floor(reach.low - tap_reach) - support;
            last = base + std::floor(reach.high + tap_reach) + support + 1;
        }
        bool fits() const { return std::max(std::fabs(first), std::fabs(last)) < (1 << 30); }
    };

    Got get_window(const Filtering& f, int piece, std::int32_t base_x, const Reach& reach_x,
                   std::int32_t base_y, const Reach& reach_y, const Box& block, Window& window) {
        const Span x(f, f.reach_x, base_x, reach_x), y(f, f.reach_y, base_y, reach_y);
        // More texels than this per pixel are better fetched one pixel at a time.
        constexpr double kMost = 32;
        const double texels = (x.last - x.first) * (y.last - y.first);
        const double pixels = double(block.width()) * block.height();
        if (!(texels <= kMost * pixels + 4096) || !x.fits() || !y.fits()) return Got::too_large;
        const Box box{static_cast<int>(x.first), static_cast<int>(y.first), static_cast<int>(x.last),
                      static_cast<int>(y.last)};
        if (!m_reader->get(f.level, piece, box, window)) return Got::failed;
        // Offsets inside a window are counted in 32 bits.
        const double span = double(window.row_stride) * (box.height() + 1);
        return std::fabs(span) < std::numeric_limits<std::int32_t>::max() ? Got::window : Got::too_large;
    }

    /// Where the next block's texels stand in memory, if they do; filtered like this one's.
    simd::Upcoming upcoming(const Block* next, const Filtering& f) const {
        const ConstImageView* view = m_source->view(f.level);
        if (!next || !view || next->kind != Block::Kind::polynomial) return {};
        const LevelPolynomial px(next->x, next->base_x, f.scale_x), py(next->y, next->base_y, f.scale_y);
        const Span x(f, f.reach_x, px.base, px.reach), y(f, f.reach_y, py.base, py.reach);
        if (!(x.first >= 0 && y.first >= 0 && x.last <= view->width && y.last <= view->height)) return {};
        return {view->at(static_cast<std::ptrdiff_t>(x.first), static_cast<std::ptrdiff_t>(y.first)),
                view->row_stride, static_cast<int>(y.last - y.first),
                static_cast<int>((x.last - x.first) * view->pixel_stride)};
    }

    static simd::Texels texels_of(const Filtering& f, const Window& window, std::int32_t base_x,
                                  std::int32_t base_y) {
        const std::ptrdiff_t pixel = std::ptrdiff_t{window.channels} * size_of(window.type);
        return {
            window.texels + (base_y - window.box.y0) * window.row_stride + (base_x - window.box.x0) * pixel,
            window.row_stride,
            window.type,
            window.channels,
            f.kernel,
            f.taps.data(),
            f.tap_count};
    }

    // --- filters -----------------------------------------------------------------------------------------

    Jacobian jacobian_of(const Block& block) const {
        const double hx = 0.5 * std::max(1, block.box.width() - 1),
                     hy = 0.5 * std::max(1, block.box.height() - 1);
        return {block.x[1] / hx, block.y[1] / hx, block.x[2] / hy, block.y[2] / hy};
    }

    Jacobian jacobian_at(double x, double y, int piece) const {
        using J = Jet1<double>;
        const Point<J> p = m_map(J::variable(x, 1, 0), J::variable(y, 0, 1), m_map.local_around(x, y, piece));
        return {p.x.c[1], p.y.c[1], p.x.c[2], p.y.c[2]};
    }

    Filtering filtering(const Jacobian& jacobian) const {
        Filtering f;
        if (m_options.filter == Filter::nearest) f.kernel = simd::Kernel::nearest;
        if (m_options.filter == Filter::bicubic) f.kernel = simd::Kernel::bicubic;
        if (m_options.filter != Filter::antialias) return f;
        const Footprint footprint = (*m_chooser)(jacobian);
        f.level = footprint.level;
        f.scale_x = m_chooser->scale(f.level)[0];
        f.scale_y = m_chooser->scale(f.level)[1];
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

    // --- the map itself ----------------------------------------------------------------------------------

    void fill(const Box& box, float value) {
        std::fill(m_values.begin(), m_values.end(), value);
        for (int j = box.y0; j < box.y1; ++j)
            for (int x = box.x0; x < box.x1; x += kMaxRow)
                m_canvas.store(x, j, std::min(kMaxRow, box.x1 - x), m_values.data());
    }

    void draw_map(const Block& block, const Box& box) {
        if (block.kind == Block::Kind::outside || m_options.output == Output::bound) {
            fill(box, m_options.output == Output::stmap ? -1 : static_cast<float>(block.bound));
            return;
        }
        alignas(64) float px[simd::kRowRoom], py[simd::kRowRoom];
        const bool polynomial = block.kind == Block::Kind::polynomial;
        for (int j = box.y0; j < box.y1; ++j) {
            if (polynomial) points_of(block, box, j, px, py);
            for (int i = 0; i < box.width(); ++i) {
                Point<double> exact{}, used{};
                int piece = 0;
                const bool seen = m_map.exact(box.x0 + i + 0.5, j + 0.5, block.piece, exact, piece);
                used = polynomial ? Point<double>{block.base_x + double(px[i]), block.base_y + double(py[i])}
                                  : exact;
                put_map(i, seen, exact, used);
            }
            m_canvas.store(box.x0, j, box.width(), m_values.data());
        }
    }

    void put_map(int i, bool seen, const Point<double>& exact, const Point<double>& used) {
        const Chart& source = m_map.source();
        if (m_options.output == Output::stmap) {
            m_values.data()[2 * i] = seen ? static_cast<float>(used.x / source.width()) : -1;
            m_values.data()[2 * i + 1] = seen ? static_cast<float>(used.y / source.height()) : -1;
            return;
        }
        double dx = seen ? used.x - exact.x : 0;
        if (source.closed()) dx -= std::round(dx / source.period()) * source.period();
        m_values.data()[i] = static_cast<float>(std::hypot(dx, seen ? used.y - exact.y : 0));
    }

    struct Exact {
        Point<double> at;
        int piece;
        bool seen;
    };

    const Panorama& m_map;
    const ReprojectOptions& m_options;
    const Canvas& m_canvas;
    const Source* m_source;
    std::optional<WindowReader> m_reader;
    std::optional<PointSampler> m_points;
    std::optional<FootprintChooser> m_chooser;
    std::vector<float> m_values;
    std::vector<Exact> m_exact;
};

PlanOptions plan_options(const ReprojectOptions& options) {
    PlanOptions plan;
    plan.scheme = options.scheme;
    plan.tol = options.tol;
    plan.cull = options.wrap == Wrap::automatic || options.wrap == Wrap::black;
    plan.across_seam = options.wrap == Wrap::automatic;
    return plan;
}

}  // namespace

Reprojection::Reprojection(const Panorama& map, const ReprojectOptions& options)
    : m_state(std::make_unique<State>(map, options, plan_options(options))) {}
Reprojection::~Reprojection() = default;
Reprojection::Reprojection(Reprojection&&) noexcept = default;
Reprojection& Reprojection::operator=(Reprojection&&) noexcept = default;

const Panorama& Reprojection::map() const {
    return m_state->plan.map();
}
const ReprojectOptions& Reprojection::options() const {
    return m_state->options;
}
int Reprojection::channels(const Source& source) const {
    const Output output = m_state->options.output;
    return output == Output::color ? source.channels() : output == Output::stmap ? 2 : 1;
}
Reached Reprojection::reached(const ParallelFor& parallel_for) const {
    return m_state->plan.reached(parallel_for);
}

bool Reprojection::draw(const Source* source, const Box& box, const ImageView& picture,
                        const ParallelFor& parallel_for) const {
    const State& state = *m_state;
    const Chart &from = state.plan.map().source(), &to = state.plan.map().target();
    const bool color = state.options.output == Output::color;
    if (color && !source) throw Error("a picture in colour needs a source");
    const int channels = color ? source->channels() : state.options.output == Output::stmap ? 2 : 1;
    if (color && (source->size(0).width != from.width() || source->size(0).height != from.height()))
        throw Error(
            "source size",
            std::to_string(source->size(0).width) + "x" + std::to_string(source->size(0).height),
            "the map was made for " + std::to_string(from.width()) + "x" + std::to_string(from.height()));
    if (picture.channels != channels)
        throw Error("channels", std::to_string(picture.channels), "needed are " + std::to_string(channels));

    // Background first where no piece of the target stands.
    const Canvas canvas(picture, box);
    const bool gaps = to.projection() == Projection::cubecross;
    const Box whole{0, 0, to.width(), to.height()};
    if (gaps || !(intersection(box, whole) == box)) {
        const std::vector<float> background(static_cast<std::size_t>(kMaxRow * channels + 16),
                                            state.options.output == Output::stmap ? -1.0f : 0.0f);
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; x += kMaxRow)
                canvas.store(x, y, std::min(kMaxRow, box.x1 - x), background.data());
    }

    // Strips of regions, so that two threads share one region's blocks.
    constexpr int kStrip = 64;
    struct Unit {
        std::int64_t region;
        int y0, y1;
    };
    std::vector<Unit> units;
    for (const std::int64_t r : state.plan.regions_in(box)) {
        const Box region = state.plan.region_box(r), part = intersection(region, box);
        for (int y = region.y0; y < region.y1; y += kStrip)
            if (y < part.y1 && y + kStrip > part.y0) units.push_back({r, y, y + kStrip});
    }
    std::atomic<bool> ok{true};
    parallel_for(static_cast<std::int64_t>(units.size()), [&](std::int64_t i) {
        const Unit& unit = units[static_cast<std::size_t>(i)];
        Painter painter(state.plan, state.options, state.border, source, canvas);
        const auto blocks = state.plan.blocks(unit.region);
        for (std::size_t k = 0; k < blocks->size(); ++k) {
            Block block = (*blocks)[k];
            // A block without texels may be cut at will; others are no taller than a strip.
            if (block.kind == Block::Kind::outside) {
                block.box.y0 = std::max(block.box.y0, unit.y0);
                block.box.y1 = std::min(block.box.y1, unit.y1);
            } else if (block.box.y0 < unit.y0 || block.box.y0 >= unit.y1)
                continue;
            if (!painter.draw(block, k + 1 < blocks->size() ? &(*blocks)[k + 1] : nullptr)) ok = false;
        }
        simd::finish_stores();
    });
    return ok;
}

}  // namespace anamorph
