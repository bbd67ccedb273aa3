// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/shaded_morph.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <string>

#include "anamorph/image/canvas.h"
#include "anamorph/image/strips.h"
#include "anamorph/operation/shaded_picture.h"
#include "anamorph/operation/solved.h"

namespace anamorph {
namespace {

/// A picture of a morph as it is drawn: the first covers what stands in the frame buffer, the second is blended over it.
struct ShadedLayer {
    std::shared_ptr<const machine::MorphWarp> warp;
    Border border;
    int source;
    double alpha;   ///< of the blend
    double weight;  ///< of the picture
};

struct ShadedLayers {
    std::vector<ShadedLayer> layers;
    std::int64_t evaluations;
};

ShadedLayers shaded_layers(const std::shared_ptr<const Features>& features, const MorphRequest& request,
                           const MorphOptions& options) {
    const Size target{request.width, request.height};
    check_morph_sizes(request.pictures, target);
    check_tol(options.tol);
    const int shapes = features->shapes();
    const std::vector<double> colors = color_mixture(options, shapes);
    for (const Size& picture : request.pictures)
        machine::check_texture_side(picture, request.machine->shader.texture_side);
    const auto map = std::make_shared<const FeatureMap>(
        *features, request.pictures, target, shape_mixture(options, shapes),
        LineWeights{options.weight_a, options.weight_b, options.weight_p});
    const machine::MorphMeshes meshes = machine::morph_meshes(*map, *request.machine);
    ShadedLayers drawn{{}, meshes.evaluations};
    double below = 0;
    for (int k = 0; k < shapes; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const double weight = colors[i];
        if (weight == 0) continue;
        // Each is blended over those before by its part of the sum so far.
        below += weight;
        const double alpha = drawn.layers.empty() ? 1 : weight / below;
        if (!(weight >= 0 && alpha <= 1))
            throw Error("machine: kim-2003 blends by an alpha from 0 to 1: the weight of picture " +
                        morph_pictures()[i] + " is " + shortest(weight));
        drawn.layers.push_back(
            {std::make_shared<machine::MorphWarp>(map, k, meshes.meshes[i], *request.machine, alpha),
             morph_border(request.pictures[i], options.wrap), k, alpha, weight});
    }
    return drawn;
}

Attribute says_evaluations(const ShadedLayers& drawn) {
    return {"anamorph:evaluations", static_cast<double>(drawn.evaluations)};
}

/// Source points and errors.
Picture shaded_points(const ShadedLayers& drawn, const MorphOptions& options) {
    Picture picture;
    for (const ShadedLayer& layer : drawn.layers)
        picture.maps.push_back({layer.warp, {{layer.border, layer.source, layer.weight}}});
    picture.filter = options.filter;
    picture.output = options.output;
    picture.reached_by_drawing = true;
    return picture;
}

/// The colors that stand in the frame buffer when all pictures were drawn.
class ShadedMorph final : public SolvedPicture {
  public:
    ShadedMorph(ShadedLayers drawn, Filter filter, const machine::NumberFormat& buffer)
        : m_drawn(std::move(drawn)), m_filter(filter), m_buffer(buffer) {}

    Attributes reached(const ParallelFor& parallel_for) const override {
        double error = 0, saturated = 0;
        for (const ShadedLayer& layer : m_drawn.layers) {
            error = std::max(error, layer.warp->reached(parallel_for).max_error);
            saturated += static_cast<double>(layer.warp->saturated_pixels(parallel_for));
        }
        return {{"anamorph:max_error", error},
                {"anamorph:exact_fraction", 0.0},
                {"anamorph:saturated_pixels", saturated},
                says_evaluations(m_drawn)};
    }
    bool reached_by_drawing() const override { return true; }
    Attributes known() const override { return {says_evaluations(m_drawn)}; }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        for (const ShadedLayer& layer : m_drawn.layers)
            if (sources.size() <= static_cast<std::size_t>(layer.source) || !source_of(sources, layer))
                throw Error("a picture in colour needs a source");
        const machine::MorphWarp& first = *m_drawn.layers.front().warp;
        const Canvas canvas(view, box);
        const Box whole{0, 0, first.width(), first.height()};
        if (!first.covers(box)) canvas.fill(box, 0);
        std::atomic<bool> ok{true};
        for_each_square(intersection(box, whole), parallel_for, [&](const Box& square) {
            if (!draw_square(sources, square, canvas)) ok = false;
            simd::finish_stores();
        });
        return ok;
    }

  private:
    static const Source* source_of(const std::vector<const Source*>& sources, const ShadedLayer& layer) {
        return sources[static_cast<std::size_t>(layer.source)];
    }

    bool draw_square(const std::vector<const Source*>& sources, const Box& square,
                     const Canvas& canvas) const {
        const auto channels =
            static_cast<std::size_t>(source_of(sources, m_drawn.layers.front())->channels());
        bool ok = true;
        std::vector<double> buffer(static_cast<std::size_t>(square.width()) *
                                   static_cast<std::size_t>(square.height()) * channels);
        for (const ShadedLayer& layer : m_drawn.layers) {
            PointSampler sampler(*source_of(sources, layer), layer.border);
            const machine::ShadedWarp::ReadPicture read = register_reader(sampler, m_filter, channels, ok);
            double* to = buffer.data();
            for (int y = square.y0; y < square.y1; ++y)
                for (int x = square.x0; x < square.x1; ++x) {
                    const std::array<double, 4> color = layer.warp->color(x, y, read);
                    for (std::size_t c = 0; c < channels; ++c, ++to)
                        *to = machine::blended(m_buffer, color[c], color[3], *to);
                }
        }
        float row[simd::kMaxRow * 4 + 16] = {};
        const double* from = buffer.data();
        for (int y = square.y0; y < square.y1; ++y)
            for (int x = square.x0; x < square.x1; x += simd::kMaxRow) {
                const int count = std::min(simd::kMaxRow, square.x1 - x);
                const std::size_t values = static_cast<std::size_t>(count) * channels;
                std::transform(from, from + values, row,
                               [](double value) { return static_cast<float>(value); });
                from += values;
                canvas.store(x, y, count, row);
            }
        return ok;
    }

    ShadedLayers m_drawn;
    Filter m_filter;
    machine::NumberFormat m_buffer;
};

}  // namespace

void check_shaded_sources(const std::vector<SourceImage>& sources) {
    for (std::size_t i = 0; i < sources.size(); ++i)
        if (sources[i].channels > 3 || sources[i].alpha >= 0)
            throw Error(
                "picture " + morph_pictures()[i] + " has " + std::to_string(sources[i].channels) +
                " channels" + (sources[i].alpha >= 0 ? " with alpha" : "") +
                ": must have at most 3 without alpha with scheme=hardware, which writes an alpha of its own");
}

std::unique_ptr<const SolvedPicture> shaded_morph(const std::shared_ptr<const Features>& features,
                                                  const MorphRequest& request, const MorphOptions& options) {
    ShadedLayers drawn = shaded_layers(features, request, options);
    if (options.output != Output::color)
        return solved(shaded_points(drawn, options), {says_evaluations(drawn)});
    return std::make_unique<ShadedMorph>(std::move(drawn), options.filter, request.machine->buffer);
}

}  // namespace anamorph
