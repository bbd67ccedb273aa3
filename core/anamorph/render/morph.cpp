// SPDX-License-Identifier: Apache-2.0
#include "anamorph/render/morph.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <string>

#include "anamorph/approx/near_far.h"
#include "anamorph/approx/near_far_mesh.h"
#include "anamorph/parameter.h"
#include "anamorph/render/block_reader.h"
#include "anamorph/render/pixel.h"

namespace anamorph {
namespace {

constexpr int kRegion = CellField::kRegion;
static_assert(kRegion % simd::kMaxRow == 0);

/// One shape's map, for the pixels that stand alone and for footprints.
class ShapeMap final : public BlockMap {
  public:
    ShapeMap(const FeatureMap& map, int shape)
        : BlockMap(map.target().width, map.target().height,
                   {Box{0, 0, map.target().width, map.target().height}}),
          m_map(map),
          m_shape(shape) {}

    bool exact(double x, double y, int, Point<double>& at, int& source_piece) const noexcept override {
        at = m_map(x, y, m_shape);
        source_piece = 0;
        return true;
    }
    Jacobian jacobian(double x, double y, int) const noexcept override {
        using J = Jet1<double>;
        const Point<J> p = m_map(J::variable(x, 1, 0), J::variable(y, 0, 1), m_shape);
        return {p.x.c[1], p.y.c[1], p.x.c[2], p.y.c[2]};
    }

  protected:
    void plan(const Box& box, int, Blocks& blocks) const override {
        for (int y = box.y0; y < box.y1; y += Block::kMaxSide)
            for (int x = box.x0; x < box.x1; x += Block::kMaxSide) {
                Block block;
                block.box = intersection({x, y, x + Block::kMaxSide, y + Block::kMaxSide}, box);
                blocks.push_back(block);
            }
    }

  private:
    const FeatureMap& m_map;
    int m_shape;
};

/// One weight a key shape: what was given, else those of t.
std::vector<double> mixture(const std::vector<double>& given, double t, int shapes, const char* name,
                            const char* t_name) {
    if (!given.empty()) {
        std::string text;
        for (const double w : given) text += (text.empty() ? "" : ",") + shortest(w);
        check_mixture(name, text, given, shapes);
        return given;
    }
    if (shapes != 2)
        throw Error(
            t_name, shortest(t),
            std::string("allowed with two pictures only; for more, ") + name + " takes a number for each");
    if (!(std::fabs(t) <= MorphOptions::kMostT))
        throw Error(t_name, shortest(t),
                    "allowed is a number from " + shortest(-MorphOptions::kMostT) + " to " +
                        shortest(MorphOptions::kMostT));
    return {1 - t, t};
}

bool only(const std::vector<double>& weights, std::size_t shape) {
    for (std::size_t k = 0; k < weights.size(); ++k)
        if (weights[k] != (k == shape ? 1 : 0)) return false;
    return true;
}

std::vector<Size> sizes_of(const std::vector<Size>& pictures, int width, int height) {
    const auto check = [](const std::string& name, int w, int h) {
        if (!(w > 0 && h > 0 && w <= kMaxSide && h <= kMaxSide))
            throw Error(name, std::to_string(w) + "x" + std::to_string(h),
                        "must be 1 to " + std::to_string(kMaxSide) + " pixels either way");
    };
    check("size", width, height);
    std::vector<Size> sizes;
    for (const Size& s : pictures) {
        check("picture " + std::to_string(sizes.size() + 1), s.width, s.height);
        sizes.push_back({s.width, s.height});
    }
    return sizes;
}

bool is_colour(MorphOutput output) {
    return output == MorphOutput::color || output == MorphOutput::lines || output == MorphOutput::warp_a ||
           output == MorphOutput::warp_b;
}

Border border_of(const Size& size, Wrap wrap) {
    // The angle of the flat chart plays no part for a plain rectangle of pixels.
    return Border(Chart(Projection::rectilinear, size.width, size.height, 90),
                  wrap == Wrap::automatic ? Wrap::clamp : wrap);
}

}  // namespace

struct Morph::State {
    std::shared_ptr<const Features> features;
    MorphOptions options;
    FeatureMap map;
    std::vector<double> color;                          ///< weights of the pictures
    std::vector<double> shape;                          ///< and of the key shapes
    std::vector<int> drawn;                             ///< the shapes whose maps the output needs
    std::vector<Border> borders;                        ///< one a shape
    std::vector<std::unique_ptr<ShapeMap>> shape_maps;  ///< one a shape
    std::vector<std::unique_ptr<CellField>> fields;     ///< cover `drawn`
    std::int64_t evaluations = 0;

    State(std::shared_ptr<const Features> given, const std::vector<Size>& pictures, int width, int height,
          const MorphOptions& morph)
        : features(std::move(given)),
          options(morph),
          map(*features, sizes_of(pictures, width, height), {width, height},
              mixture(morph.shape_weights, morph.t, features->shapes(), "shape_weights", "t"),
              {morph.weight_a, morph.weight_b, morph.weight_p}) {
        shape = mixture(morph.shape_weights, morph.t, features->shapes(), "shape_weights", "t");
        color = colors();
        for (int k = 0; k < map.shapes(); ++k) {
            if (color[static_cast<std::size_t>(k)] != 0) drawn.push_back(k);
            borders.push_back(border_of(pictures[static_cast<std::size_t>(k)], options.wrap));
            shape_maps.push_back(std::make_unique<ShapeMap>(map, k));
        }
        make_fields();
    }

    Box whole() const { return {0, 0, map.target().width, map.target().height}; }
    bool reads(int k) const { return color[static_cast<std::size_t>(k)] != 0; }

    /// The picture that comes through untouched, or -1.
    int untouched() const {
        for (int k = 0; k < map.shapes(); ++k) {
            const auto i = static_cast<std::size_t>(k);
            if (only(shape, i) && only(color, i) && map.picture(k).width == map.target().width &&
                map.picture(k).height == map.target().height)
                return k;
        }
        return -1;
    }

  private:
    /// The weights of the pictures in what is drawn.
    std::vector<double> colors() const {
        std::vector<double> one(static_cast<std::size_t>(map.shapes()), 0.0);
        const MorphOutput o = options.output;
        if (o == MorphOutput::warp_a || o == MorphOutput::stmap_a) one[0] = 1;
        if (o == MorphOutput::warp_b || o == MorphOutput::stmap_b) one[1] = 1;
        if (one[0] + one[1] > 0) return one;
        if (options.color_weights.empty() && !options.t_color) return shape;
        return mixture(options.color_weights, options.t_color.value_or(options.t), map.shapes(),
                       "color_weights", "t_color");
    }

    void make_fields() {
        if (options.scheme == MorphScheme::mesh) {
            auto mesh = std::make_unique<FeatureMesh>(map, options.mesh_cells, options.mesh_levels, drawn);
            evaluations = mesh->evaluations();
            fields.push_back(std::move(mesh));
            return;
        }
        const double tol = options.scheme == MorphScheme::exact && options.tol >= 0 ? 0 : options.tol;
        // Two at a time share one plan.
        for (std::size_t i = 0; i < drawn.size(); i += 2) {
            NearFarOptions near_far;
            near_far.tol = tol;
            near_far.shapes.assign(
                drawn.begin() + static_cast<std::ptrdiff_t>(i),
                drawn.begin() + static_cast<std::ptrdiff_t>(std::min(i + 2, drawn.size())));
            fields.push_back(std::make_unique<NearFar>(map, near_far));
        }
    }
};

namespace {

/// Draws one region at a time; one per thread.
class RegionPainter {
  public:
    RegionPainter(const FeatureMap& map, const Canvas& canvas)
        : m_map(map), m_canvas(canvas), m_channels(canvas.channels()) {
        // Written before it is read: every pixel of a region belongs to a block.
        m_values.reset(
            new float[static_cast<std::size_t>(kRegion) * kRegion * static_cast<std::size_t>(m_channels) +
                      16]);
    }

    void begin(const Box& region) {
        m_region = region;
        m_part = intersection(region, m_canvas.box());
    }
    const Box& part() const { return m_part; }
    float* pixel(int x, int y) {
        return m_values.get() + (std::ptrdiff_t{y - m_region.y0} * kRegion + x - m_region.x0) * m_channels;
    }

    /// Adds a row of a picture's pixels, `weight` times; the first one replaces what was there. Colour is
    /// mixed as it is seen: by its alpha where that is not multiplied in.
    void blend(int x, int y, int count, const float* values, float weight, int alpha, bool first) {
        float* to = pixel(x, y);
        if (alpha >= 0) {
            for (int i = 0; i < count; ++i, to += m_channels, values += m_channels)
                for (int c = 0; c < m_channels; ++c) {
                    const float v = weight * (c == alpha ? values[c] : values[c] * values[alpha]);
                    to[c] = first ? v : to[c] + v;
                }
            return;
        }
        const int n = count * m_channels;
        if (first)
            for (int i = 0; i < n; ++i) to[i] = weight * values[i];
        else
            for (int i = 0; i < n; ++i) to[i] += weight * values[i];
    }

    void unassociate(int alpha) {
        if (alpha < 0) return;
        for (int y = m_part.y0; y < m_part.y1; ++y)
            for (int x = m_part.x0; x < m_part.x1; ++x) unassociate_alpha(pixel(x, y), m_channels, alpha);
    }

    /// The features of every shape, one pixel and a half wide, each shape in a colour of its own.
    void draw_lines(const Features& features) {
        static constexpr float kColors[][3] = {{1, 0.3f, 0.1f}, {0.1f, 0.55f, 1}, {0.2f, 0.9f, 0.3f}};
        constexpr double kHalfWidth = 0.75;
        const Size target = m_map.target();
        for (std::size_t i = 0; i < features.size(); ++i)
            for (int k = 0; k < features.shapes(); ++k) {
                const Features::Frame frame = features.frame(k);
                const double sx = target.width / (frame.width > 0 ? frame.width : m_map.picture(k).width);
                const double sy = target.height / (frame.height > 0 ? frame.height : m_map.picture(k).height);
                const Line& l = features.line(i, k);
                draw_line({{l.p.x * sx, l.p.y * sy}, {l.q.x * sx, l.q.y * sy}}, kColors[k % 3], kHalfWidth);
            }
    }

    void store() {
        for (int y = m_part.y0; y < m_part.y1; ++y)
            for (int x = m_part.x0; x < m_part.x1; x += simd::kMaxRow)
                m_canvas.store(x, y, std::min(simd::kMaxRow, m_part.x1 - x), pixel(x, y));
    }

  private:
    void draw_line(const Line& line, const float* color, double half_width) {
        const double reach = half_width + 1;
        const auto low = [&](double a, double b) { return std::floor(std::min(a, b) - reach); };
        const auto high = [&](double a, double b) { return std::ceil(std::max(a, b) + reach); };
        const int x0 = static_cast<int>(std::max<double>(low(line.p.x, line.q.x), m_part.x0));
        const int y0 = static_cast<int>(std::max<double>(low(line.p.y, line.q.y), m_part.y0));
        const int x1 = static_cast<int>(std::min<double>(high(line.p.x, line.q.x), m_part.x1));
        const int y1 = static_cast<int>(std::min<double>(high(line.p.y, line.q.y), m_part.y1));
        const Point<double> e{line.q.x - line.p.x, line.q.y - line.p.y};
        const double length = std::hypot(e.x, e.y);
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) {
                const double dx = x + 0.5 - line.p.x, dy = y + 0.5 - line.p.y;
                const double along = (dx * e.x + dy * e.y) / length;
                const double beside = (dy * e.x - dx * e.y) / length;
                const double distance = feature_detail::distance_to_line(-along, along - length, beside);
                const auto cover = static_cast<float>(std::clamp(half_width + 0.5 - distance, 0.0, 1.0));
                if (cover == 0) continue;
                float* p = pixel(x, y);
                for (int c = 0; c < m_channels; ++c) p[c] += cover * ((c < 3 ? color[c] : 1) - p[c]);
            }
    }

    const FeatureMap& m_map;
    const Canvas& m_canvas;
    int m_channels;
    Box m_region, m_part;
    std::unique_ptr<float[]> m_values;
};

std::vector<Box> regions_of(const Box& box, const Box& whole) {
    std::vector<Box> regions;
    const Box part = intersection(box, whole);
    if (part.empty()) return regions;
    for (int y = part.y0 / kRegion * kRegion; y < part.y1; y += kRegion)
        for (int x = part.x0 / kRegion * kRegion; x < part.x1; x += kRegion)
            regions.push_back(intersection({x, y, x + kRegion, y + kRegion}, whole));
    return regions;
}

}  // namespace

void check_mixture(const std::string& name, const std::string& text, const std::vector<double>& weights,
                   int shapes) {
    constexpr double kMost = MorphOptions::kMostT;
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    const bool in_range =
        std::all_of(weights.begin(), weights.end(), [](double w) { return std::fabs(w) <= kMost; });
    if (weights.size() != static_cast<std::size_t>(shapes) || !in_range || !(std::fabs(sum - 1) <= 1e-6))
        throw Error(name, printable(text),
                    "allowed are " + std::to_string(shapes) + " numbers from " + shortest(-kMost) + " to " +
                        shortest(kMost) + ", one for each picture, with sum 1");
}

Morph::Morph(std::shared_ptr<const Features> features, const std::vector<Size>& pictures, int width,
             int height, const MorphOptions& options) {
    if (!features) throw Error("a morph needs features");
    m_state = std::make_unique<State>(std::move(features), pictures, width, height, options);
}
Morph::~Morph() = default;
Morph::Morph(Morph&&) noexcept = default;
Morph& Morph::operator=(Morph&&) noexcept = default;

int Morph::width() const {
    return m_state->map.target().width;
}
int Morph::height() const {
    return m_state->map.target().height;
}
const MorphOptions& Morph::options() const {
    return m_state->options;
}
std::int64_t Morph::mesh_evaluations() const {
    return m_state->evaluations;
}

std::vector<bool> Morph::reads() const {
    std::vector<bool> all;
    for (int k = 0; k < m_state->map.shapes(); ++k)
        all.push_back(is_colour(m_state->options.output) && m_state->reads(k));
    return all;
}

int Morph::channels(const Source* first) const {
    const MorphOutput output = m_state->options.output;
    if (is_colour(output)) {
        if (!first) throw Error("a picture in colour needs a source");
        return first->channels();
    }
    return output == MorphOutput::stmap_a || output == MorphOutput::stmap_b ? 2 : 1;
}

Reached Morph::reached(const ParallelFor& parallel_for) const {
    const State& state = *m_state;
    const std::vector<Box> regions = regions_of(state.whole(), state.whole());
    Reached reached;
    std::int64_t exact = 0;
    std::mutex mutex;
    parallel_for(static_cast<std::int64_t>(regions.size()), [&](std::int64_t i) {
        for (const auto& field : state.fields) {
            const CellField::Tally tally = field->tally(regions[static_cast<std::size_t>(i)]);
            const std::lock_guard lock(mutex);
            reached.max_error = std::max(reached.max_error, tally.bound);
            exact += tally.exact_pixels;
        }
    });
    const double pixels = double(width()) * height() * static_cast<double>(state.fields.size());
    reached.exact_fraction = pixels > 0 ? static_cast<double>(exact) / pixels : 0;
    return reached;
}

namespace {

/// What Morph::draw was given fits together.
void check(const std::vector<const Source*>& sources, const FeatureMap& map, const std::vector<bool>& reads) {
    if (sources.size() != reads.size())
        throw Error("pictures", std::to_string(sources.size()), "needed are " + std::to_string(reads.size()));
    const Source* first = nullptr;
    for (std::size_t k = 0; k < reads.size(); ++k) {
        if (!reads[k]) continue;
        if (!sources[k]) throw Error("picture " + std::to_string(k + 1) + " is missing");
        const Size size = sources[k]->size(0);
        const Size wanted = map.picture(static_cast<int>(k));
        if (size.width != wanted.width || size.height != wanted.height)
            throw Error("picture " + std::to_string(k + 1) + " size",
                        std::to_string(size.width) + "x" + std::to_string(size.height),
                        "the morph was made for " + std::to_string(wanted.width) + "x" +
                            std::to_string(wanted.height));
        if (!first) first = sources[k];
        if (sources[k]->channels() != first->channels() ||
            sources[k]->unassociated_alpha() != first->unassociated_alpha())
            throw Error("picture " + std::to_string(k + 1) + " channels",
                        std::to_string(sources[k]->channels()),
                        "all pictures need the same channels, " + std::to_string(first->channels()));
    }
}

}  // namespace

bool Morph::draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& picture,
                 const ParallelFor& parallel_for) const {
    const State& state = *m_state;
    const MorphOutput output = state.options.output;
    const std::vector<bool> needed = reads();
    if (is_colour(output)) check(sources, state.map, needed);
    const Source* any = nullptr;
    for (std::size_t k = 0; k < needed.size(); ++k)
        if (needed[k] && !any) any = sources[k];
    if (picture.channels != channels(any))
        throw Error("channels", std::to_string(picture.channels),
                    "needed are " + std::to_string(channels(any)));
    const int alpha = any ? any->unassociated_alpha() : -1;

    const Canvas canvas(picture, box);
    if (!(intersection(box, state.whole()) == box)) canvas.fill(box, 0);
    const std::vector<Box> regions = regions_of(box, state.whole());
    const int untouched = is_colour(output) ? state.untouched() : -1;

    std::atomic<bool> ok{true};
    const auto draw_colour = [&](RegionPainter& painter, const Box& region,
                                 std::vector<std::unique_ptr<BlockReader>>& readers) {
        const int first_shape = state.drawn.front();
        if (untouched >= 0) {
            // Pixels as they stand in the source, whatever filter.
            const Source& source = *sources[static_cast<std::size_t>(untouched)];
            const Box& part = painter.part();
            const auto row = static_cast<std::size_t>(part.width() * source.channels());
            std::vector<std::byte> texels(row * static_cast<std::size_t>(part.height()) *
                                          static_cast<std::size_t>(size_of(source.type())));
            const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(row) * size_of(source.type());
            if (!source.read(0, part, texels.data(), stride)) ok = false;
            for (int y = part.y0; y < part.y1; ++y)
                load_channels(texels.data() + (y - part.y0) * stride, source.type(),
                              static_cast<std::int64_t>(row), painter.pixel(part.x0, y));
        } else {
            for (const auto& field : state.fields)
                field->each_block(
                    region, painter.part(), [&](int k, const Block& block, const CellPoints& points) {
                        const auto i = static_cast<std::size_t>(k);
                        if (!readers[i])
                            readers[i] = std::make_unique<BlockReader>(
                                *state.shape_maps[i], *sources[i], state.borders[i], state.options.filter);
                        const auto row = [&](int x, int y, int count, const float* values, float one) {
                            painter.blend(x, y, count, values, static_cast<float>(state.color[i] / one),
                                          alpha, k == first_shape);
                        };
                        const Box part = intersection(block.box, painter.part());
                        const bool done =
                            points.x
                                ? readers[i]->rows(block, {points.x, points.y, points.row_stride}, part, row)
                                : readers[i]->rows(block, part, row);
                        if (!done) ok = false;
                    });
            painter.unassociate(alpha);
        }
        if (output == MorphOutput::lines) painter.draw_lines(*state.features);
    };

    const auto draw_map = [&](RegionPainter& painter, const Box& region) {
        for (const auto& field : state.fields)
            field->each_block(
                region, painter.part(), [&](int k, const Block& block, const CellPoints& points) {
                    const Box part = intersection(block.box, painter.part());
                    const bool first = k == state.drawn.front();
                    const Size size = state.map.picture(k);
                    for (int y = part.y0; y < part.y1; ++y)
                        for (int x = part.x0; x < part.x1; ++x) {
                            float* to = painter.pixel(x, y);
                            const std::ptrdiff_t at =
                                (y - block.box.y0) * points.row_stride + x - block.box.x0;
                            const auto keep = [&](double value) {
                                to[0] = first ? static_cast<float>(value)
                                              : std::max(to[0], static_cast<float>(value));
                            };
                            if (output == MorphOutput::bound) {
                                keep(block.bound);
                                continue;
                            }
                            const Point<double> used =
                                !points.x ? state.map(x + 0.5, y + 0.5, k)
                                          : Point<double>{block.base_x + double{points.x[at]},
                                                          block.base_y + double{points.y[at]}};
                            if (output == MorphOutput::error) {
                                const Point<long double> truth = state.map(x + 0.5L, y + 0.5L, k);
                                keep(static_cast<double>(std::hypot(used.x - truth.x, used.y - truth.y)));
                                continue;
                            }
                            to[0] = static_cast<float>(used.x / size.width);
                            to[1] = static_cast<float>(used.y / size.height);
                        }
                });
    };

    parallel_for(static_cast<std::int64_t>(regions.size()), [&](std::int64_t i) {
        const Box& region = regions[static_cast<std::size_t>(i)];
        RegionPainter painter(state.map, canvas);
        painter.begin(region);
        if (is_colour(output)) {
            std::vector<std::unique_ptr<BlockReader>> readers(needed.size());
            draw_colour(painter, region, readers);
        } else
            draw_map(painter, region);
        painter.store();
        simd::finish_stores();
    });
    return ok;
}

}  // namespace anamorph
