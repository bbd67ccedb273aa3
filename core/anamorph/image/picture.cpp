// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/picture.h"

#include <algorithm>
#include <atomic>
#include <deque>
#include <span>
#include <string>

#include "anamorph/image/block_reader.h"
#include "anamorph/image/coverage_source.h"
#include "anamorph/image/map_rows.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/strips.h"

namespace anamorph {
namespace {

using Sources = std::vector<const Source*>;

std::string text_of(const Size& size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height);
}

/// A source has the size that the map was made for, and the channels of `first`, if there is one.
void check_source(const std::string& name, const Source* source, const Chart& chart, const Source* first) {
    if (!source) throw Error("a picture in colour needs a source: " + name + " is missing");
    const Size size = source->size(0), wanted{chart.width(), chart.height()};
    if (size.width != wanted.width || size.height != wanted.height)
        throw Error(name + " size", text_of(size), "the map was made for " + text_of(wanted));
    if (first && (source->channels() != first->channels() ||
                  source->unassociated_alpha() != first->unassociated_alpha()))
        throw Error(name + " channels", std::to_string(source->channels()),
                    "must be the same in all, " + std::to_string(first->channels()));
}

/// What draw() was given fits together. Returns one of the sources that are read, or null if none is.
const Source* check(const Picture& picture, const Sources& sources, const ImageView& view) {
    if (picture.source_count && sources.size() != static_cast<std::size_t>(*picture.source_count))
        throw Error("pictures", std::to_string(sources.size()),
                    "must be " + std::to_string(*picture.source_count));
    const Source* first = nullptr;
    for (const Picture::Map& map : picture.maps)
        for (const Picture::Layer& layer : map.layers) {
            if (!picture.shows_color()) continue;
            const auto i = static_cast<std::size_t>(layer.source);
            const std::string name = sources.size() > 1 ? "picture " + std::to_string(i + 1) : "source";
            check_source(name, i < sources.size() ? sources[i] : nullptr, layer.border.chart(), first);
            if (!first) first = sources[i];
        }
    const int channels = picture.channels(first);
    if (view.channels != channels)
        throw Error("channels", std::to_string(view.channels), "must be " + std::to_string(channels));
    return first;
}

void store(const PixelRows& pixels, const Canvas& canvas) {
    const Box& box = pixels.box;
    for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; x += simd::kMaxRow)
            canvas.store(x, y, std::min(simd::kMaxRow, box.x1 - x), pixels.at(x, y));
}

/// Draws one strip: straight to the canvas where the picture has a single layer, else mixed in memory first.
class Painter {
  public:
    Painter(const Picture& picture, const Sources& sources, const Canvas& canvas, int alpha)
        : m_picture(picture), m_sources(sources), m_canvas(canvas), m_alpha(alpha) {}

    bool draw(const Strip& strip) {
        const Picture::Map& map = m_picture.maps.front();
        const bool single = m_picture.maps.size() == 1 && map.layers.size() == 1;
        if (!m_picture.shows_color() && single)
            draw_map(strip, *map.blocks, map.layers.front());
        else if (single && map.layers.front().weight == 1 && !map.layers.front().weights &&
                 !m_picture.overlay)
            draw_color(strip, *map.blocks, map.layers.front());
        else
            mix(strip.box());
        return m_ok;
    }

  private:
    const Source& source_of(const Picture::Layer& layer) const {
        return *m_sources[static_cast<std::size_t>(layer.source)];
    }

    void draw_color(const Strip& strip, const BlockMap& map, const Picture::Layer& layer) {
        BlockReader reader(map, source_of(layer), layer.border, m_picture.filter);
        strip.for_each_block([&](const Block& block, const Box& part) {
            if (!reader.draw(block, part, m_canvas)) m_ok = false;
        });
    }
    void draw_map(const Strip& strip, const BlockMap& map, const Picture::Layer& layer) {
        const auto store = [&](int x, int y, int count, const float* values) {
            m_canvas.store(x, y, count, values);
        };
        const BlockPlanes planes(1);
        strip.for_each_block([&](const Block& block, const Box& part) {
            const BlockPoints points = points_of(map, {&block, 1}, planes) ? planes.points(0) : BlockPoints{};
            map_rows(map, layer.border.chart(), m_picture.output, block, points, part, store);
        });
    }

    /// The points of the blocks that all layers have in one place, if they are computed in float and wanted.
    bool points_of(const BlockMap& map, std::span<const Block> layers, const BlockPlanes& to) const {
        if (layers.front().kind != Block::Kind::computed || layers.front().precise) return false;
        if (!m_picture.shows_color() && m_picture.output == Output::bound) return false;
        map.computed(layers, to.rows());
        return true;
    }

    // --- several layers ----------------------------------------------------------------------------------

    void mix(const Box& box) {
        if (box.empty()) return;
        // Written before it is read: every pixel belongs to a block of the first layer.
        const int channels = m_canvas.channels();
        const auto size = static_cast<std::size_t>(box.width() * box.height() * channels);
        const std::unique_ptr<float[]> values(new float[size + 16]);
        const PixelRows pixels{box, channels, values.get()};
        m_greatest.clear();
        if (m_picture.chooses) m_greatest.resize(static_cast<std::size_t>(box.width() * box.height()));
        bool first = true;
        for (const Picture::Map& map : m_picture.maps) {
            if (m_picture.shows_color())
                add_color(map, pixels, first);
            else
                add_map(map, pixels, first);
            first = false;
        }
        if (m_picture.shows_color()) finish_color(pixels);
        store(pixels, m_canvas);
    }

    /// body(block, layer, points, part) for every block of every layer that meets a box; only computed ones
    /// have points.
    template <class Body>
    void each_block(const BlockMap& map, const Box& box, const Body& body) const {
        const auto layers = static_cast<std::size_t>(map.layers());
        const BlockPlanes planes(layers);
        for (const std::int64_t region : map.regions_in(box)) {
            const SharedBlocks blocks = map.blocks(region);
            for (std::size_t i = 0; i < blocks.size(); i += layers) {
                const Box part = intersection(blocks[i].box, box);
                if (part.empty()) continue;
                const bool known = points_of(map, {&blocks[i], layers}, planes);
                for (std::size_t k = 0; k < layers; ++k)
                    body(blocks[i + k], k, known ? planes.points(k) : BlockPoints{}, part);
            }
        }
    }

    /// Adds what the layers of a map show, or puts it there if it is the first.
    void add_color(const Picture::Map& map, const PixelRows& pixels, bool first) {
        std::deque<BlockReader> readers;
        for (const Picture::Layer& layer : map.layers)
            readers.emplace_back(*map.blocks, source_of(layer), layer.border, m_picture.filter);
        std::vector<float> weights;
        each_block(
            *map.blocks, pixels.box,
            [&](const Block& block, std::size_t k, const BlockPoints& points, const Box& part) {
                const Picture::Layer& layer = map.layers[k];
                const bool starts = first && k == 0;
                if (!starts && !m_picture.chooses && block.kind == Block::Kind::outside) return;
                if (layer.weights) {
                    weights.resize(static_cast<std::size_t>(part.width() * part.height()));
                    if (!layer.weights(part, weights.data()) && !starts) return;
                }
                const auto row = [&](int x, int y, int count, const float* values, float one) {
                    const auto weight = static_cast<float>(layer.weight / double{one});
                    const std::ptrdiff_t at = std::ptrdiff_t{y - part.y0} * part.width() + x - part.x0;
                    const float* each = layer.weights ? weights.data() + at : nullptr;
                    if (m_picture.chooses)
                        return choose_row(pixels, x, y, count, values, one, layer.weight, each, starts);
                    add_row(pixels.at(x, y), count, values, weight, each, starts);
                };
                const bool done =
                    points.x ? readers[k].rows(block, points, part, row) : readers[k].rows(block, part, row);
                if (!done) m_ok = false;
            });
    }

    /// Puts a row of pixels there where its weight, `weight` times what `each` says of one, is the greatest so far. Bits stay
    /// what they are where 1 stands for 1.
    void choose_row(const PixelRows& to, int x, int y, int count, const float* values, float one,
                    double weight, const float* each, bool first) {
        const int channels = to.channels;
        const Box& box = to.box;
        float* pixel = to.at(x, y);
        double* greatest = m_greatest.data() + std::ptrdiff_t{y - box.y0} * box.width() + x - box.x0;
        for (int i = 0; i < count; ++i, pixel += channels, values += channels, ++greatest) {
            const double own = each ? weight * double{each[i]} : weight;
            if (!first && !(own > *greatest)) continue;
            *greatest = own;
            std::copy_n(values, channels, pixel);
            for (int c = 0; one != 1 && c < channels; ++c) pixel[c] /= one;
        }
    }

    /// Adds a row of pixels, `weight` times, and so often again as `each` says of one, if it is given. Colour is mixed as
    /// it is seen: by its alpha where that is not multiplied in.
    void add_row(float* to, int count, const float* values, float weight, const float* each,
                 bool first) const {
        const int channels = m_canvas.channels();
        if (m_alpha >= 0 || each) {
            for (int i = 0; i < count; ++i, to += channels, values += channels) {
                const float w = each ? weight * each[i] : weight;
                for (int c = 0; c < channels; ++c) {
                    const bool seen = m_alpha >= 0 && c != m_alpha;
                    // What is infinite does not count where it has no weight.
                    const float v = w == 0 ? 0 : w * (seen ? values[c] * values[m_alpha] : values[c]);
                    to[c] = first ? v : to[c] + v;
                }
            }
            return;
        }
        const int n = count * channels;
        if (first)
            for (int i = 0; i < n; ++i) to[i] = weight * values[i];
        else
            for (int i = 0; i < n; ++i) to[i] += weight * values[i];
    }

    void finish_color(const PixelRows& pixels) const {
        const Box& box = pixels.box;
        for (int y = box.y0; m_alpha >= 0 && !m_picture.chooses && y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x)
                unassociate_alpha(pixels.at(x, y), pixels.channels, m_alpha);
        if (m_picture.overlay) m_picture.overlay(pixels);
    }

    /// Keeps the largest of what the layers of a map say.
    void add_map(const Picture::Map& map, const PixelRows& pixels, bool first) const {
        each_block(*map.blocks, pixels.box,
                   [&](const Block& block, std::size_t k, const BlockPoints& points, const Box& part) {
                       const auto row = [&](int x, int y, int count, const float* values) {
                           float* to = pixels.at(x, y);
                           for (int i = 0; i < count * pixels.channels; ++i)
                               to[i] = first && k == 0 ? values[i] : std::max(to[i], values[i]);
                       };
                       map_rows(*map.blocks, map.layers[k].border.chart(), m_picture.output, block, points,
                                part, row);
                   });
    }

    const Picture& m_picture;
    const Sources& m_sources;
    const Canvas& m_canvas;
    int m_alpha;
    std::vector<double> m_greatest;  ///< the greatest weights so far, where layers are chosen
    bool m_ok = true;
};

/// What Picture::value says.
void draw_values(const Picture& picture, const Box& box, const Canvas& canvas) {
    float values[simd::kMaxRow + 16] = {};
    for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; x += simd::kMaxRow) {
            const int count = std::min(simd::kMaxRow, box.x1 - x);
            for (int i = 0; i < count; ++i) values[i] = picture.value(x + i + 0.5, y + 0.5);
            canvas.store(x, y, count, values);
        }
}

/// The pixels of a source as they stand.
bool draw_same(const Picture& picture, const Source& source, const Box& box, const Canvas& canvas) {
    const int row = box.width() * source.channels();
    const std::ptrdiff_t stride = std::ptrdiff_t{row} * size_of(source.type());
    std::vector<std::byte> texels(static_cast<std::size_t>(stride * box.height()));
    std::vector<float> values(static_cast<std::size_t>(row * box.height()) + 16);
    const PixelRows pixels{box, source.channels(), values.data()};
    const bool ok = source.read(0, box, texels.data(), stride);
    for (int y = box.y0; y < box.y1; ++y)
        load_channels(texels.data() + (y - box.y0) * stride, source.type(), row, pixels.at(box.x0, y));
    if (picture.overlay) picture.overlay(pixels);
    store(pixels, canvas);
    return ok;
}

}  // namespace

bool Picture::reads(int source) const {
    if (!shows_color()) return false;
    for (const Map& map : maps)
        for (const Layer& layer : map.layers)
            if (layer.source == source) return true;
    return false;
}

int Picture::channels(const Source* first) const {
    if (!shows_color()) return !value && is_stmap(output) ? 2 : 1;
    if (!first) throw Error("a picture in colour needs a source");
    return first->channels() + (adds_alpha ? 1 : 0);
}

Reached Picture::reached(const ParallelFor& parallel_for) const {
    Reached all;
    double exact = 0, layers = 0;
    for (const Map& map : maps) {
        const Reached one = map.blocks->reached(parallel_for);
        all.max_error = std::max(all.max_error, one.max_error);
        exact += one.exact_fraction * map.blocks->layers();
        layers += map.blocks->layers();
    }
    all.exact_fraction = exact / layers;
    return all;
}

Picture Picture::of_coverage() const {
    Picture coverage = *this;
    coverage.output = Output::color;
    coverage.adds_alpha = false;
    coverage.overlay = {};
    coverage.data = {};
    coverage.same_as = {};
    for (Map& map : coverage.maps)
        for (Layer& layer : map.layers)
            // A seam is an edge where that is asked for.
            if (layer.border.wrap() != Wrap::black)
                layer.border = Border(layer.border.chart(), Wrap::automatic);
    return coverage;
}

Picture Picture::of_data() const {
    Picture of_data = *this;
    of_data.filter = data.filter;
    of_data.data = {};
    of_data.chooses = true;
    of_data.adds_alpha = false;
    of_data.overlay = {};
    return of_data;
}

bool Picture::draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
                   const ParallelFor& parallel_for) const {
    const bool shows_alpha = adds_alpha && shows_color();
    if (!shows_alpha && (value || output != Output::coverage))
        return draw_channels(sources, box, view, parallel_for);
    std::deque<CoverageSource> covers;
    std::vector<const Source*> covered;
    for (const Source* source : sources) covered.push_back(source ? &covers.emplace_back(*source) : nullptr);
    const Picture coverage = of_coverage();
    if (!shows_alpha) return coverage.draw_pixels(covered, box, view, parallel_for);
    check(*this, sources, view);
    Picture colors = *this;
    colors.adds_alpha = false;
    const int last = view.channels - 1;
    const bool ok = colors.draw_channels(sources, box, channels_of(view, 0, last), parallel_for);
    return coverage.draw_pixels(covered, box, channels_of(view, last, 1), parallel_for) && ok;
}

bool Picture::draw_channels(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
                            const ParallelFor& parallel_for) const {
    if (!draw_pixels(sources, box, view, parallel_for)) return false;
    const bool is_mixed = maps.size() > 1 || maps.front().layers.size() > 1;
    if (data.channels.empty() || !shows_color() || (data.filter == filter && !is_mixed && !overlay))
        return true;
    const Picture own = of_data();
    const std::ptrdiff_t channel = size_of(view.type), pixel = view.channels * channel;
    std::vector<std::byte> drawn(static_cast<std::size_t>(pixel * box.width() * box.height()));
    const ImageView from = packed_view(drawn.data(), view.type, box.width(), box.height(), view.channels);
    if (!own.draw_pixels(sources, box, from, parallel_for)) return false;
    for (int y = 0; y < box.height(); ++y)
        for (int x = 0; x < box.width(); ++x)
            for (const int c : data.channels)
                std::copy_n(from.at(x, y) + c * channel, channel, view.at(x, y) + c * channel);
    return true;
}

bool Picture::draw_pixels(const std::vector<const Source*>& sources, const Box& of_picture,
                          const ImageView& view, const ParallelFor& parallel_for) const {
    const Source* first = check(*this, sources, view);
    const Box box = moved(of_picture, -overscan.width, -overscan.height);
    const Canvas canvas(view, box);
    const BlockMap& map = *maps.front().blocks;
    if (!map.covers(box)) canvas.fill(box, !value && is_stmap(output) ? -1.0f : 0.0f);
    const Box inside = intersection(box, widened({0, 0, width(), height()}, overscan));
    std::atomic<bool> ok{true};
    if (value) {
        for_each_square(inside, parallel_for, [&](const Box& square) {
            draw_values(*this, square, canvas);
            simd::finish_stores();
        });
    } else if (shows_color() && same_as) {
        const Source& source = *sources[static_cast<std::size_t>(*same_as)];
        for_each_square(inside, parallel_for, [&](const Box& square) {
            if (!draw_same(*this, source, square, canvas)) ok = false;
            simd::finish_stores();
        });
    } else {
        const int alpha = first ? first->unassociated_alpha() : -1;
        for_each_strip(map, box, parallel_for, [&](const Strip& strip) {
            if (!Painter(*this, sources, canvas, alpha).draw(strip)) ok = false;
            simd::finish_stores();
        });
    }
    return ok;
}

Picture picture_through(std::shared_ptr<const BlockMap> blocks, const Border& border, Filter filter,
                        Output output) {
    Picture picture;
    picture.maps = {{std::move(blocks), {{border}}}};
    picture.filter = filter;
    picture.output = output;
    return picture;
}

void check_picture_size(const std::string& name, const Size& size) {
    if (!(size.width > 0 && size.height > 0 && size.width <= kMaxSide && size.height <= kMaxSide))
        throw Error(name, std::to_string(size.width) + "x" + std::to_string(size.height),
                    "must be 1 to " + std::to_string(kMaxSide) + " pixels either way");
}

}  // namespace anamorph
