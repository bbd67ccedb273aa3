// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/layered_picture.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include "anamorph/image/pixel.h"

namespace anamorph {
namespace {

/// The source that a layer is a picture of. Throws Error where it is missing.
const Source& source_of(const PictureLayer& layer, const std::vector<const Source*>& sources) {
    const auto i = static_cast<std::size_t>(layer.picture.maps.front().layers.front().source);
    const Source* const source = i < sources.size() ? sources[i] : nullptr;
    if (!source) throw Error("a layer needs a source: picture " + std::to_string(i + 1) + " is missing");
    return *source;
}

/// What is known of the pixels of some rows while layers are added.
class Mixture {
  public:
    Mixture(const LayeredPicture& picture, bool is_multiplied, const Box& box, int channels)
        : m_picture(picture),
          m_is_multiplied(is_multiplied),
          m_box(box),
          m_channels(channels),
          m_width(static_cast<std::size_t>(box.width())),
          m_colors(pixels() * static_cast<std::size_t>(channels), 0.0f),
          m_weight(pixels(), 0.0f),
          m_uncovered(pixels(), 1.0f),
          m_through(picture.layering == Layering::over ? pixels() : 0, 1.0f) {}

    std::size_t pixels() const { return m_width * static_cast<std::size_t>(m_box.height()); }
    /// Is what lies below never seen?
    bool is_closed() const {
        return !m_through.empty() &&
               std::all_of(m_through.begin(), m_through.end(), [](float t) { return t == 0; });
    }

    /// Adds a row of a layer.
    void add(std::int64_t row, const float* layer, const float* weights) {
        for (std::size_t i = 0; i < m_width; ++i) {
            const std::size_t at = static_cast<std::size_t>(row) * m_width + i;
            add_pixel(at, layer + at * static_cast<std::size_t>(m_channels), weights ? weights[at] : 1.0f);
        }
    }
    void store(std::int64_t row, const ImageView& view) {
        std::vector<float> pixel(static_cast<std::size_t>(m_channels));
        for (std::size_t i = 0; i < m_width; ++i) {
            finish(static_cast<std::size_t>(row) * m_width + i, pixel.data());
            std::byte* to = view.at(static_cast<std::ptrdiff_t>(i), static_cast<std::ptrdiff_t>(row));
            if (m_picture.shows_alpha) {
                store_channel(pixel[alpha_channel()], to, view.type);
                continue;
            }
            for (int c = 0; c < view.channels; ++c)
                store_channel(pixel[static_cast<std::size_t>(c)], to + c * size_of(view.type), view.type);
        }
    }

  private:
    std::size_t alpha_channel() const { return static_cast<std::size_t>(m_picture.alpha); }

    void add_pixel(std::size_t at, const float* layer, float weight) {
        const float alpha = std::min(layer[alpha_channel()], 1.0f);
        if (!(alpha > 0)) return;
        m_uncovered[at] *= 1 - alpha;
        if (!m_through.empty()) {
            const float through = m_through[at];
            m_through[at] *= 1 - weight * alpha;
            weight *= through;
        }
        // What is infinite does not count where it has no weight.
        if (weight == 0) return;
        m_weight[at] += weight * alpha;
        if (!m_is_multiplied) weight *= alpha;
        float* colors = &m_colors[at * static_cast<std::size_t>(m_channels)];
        for (int c = 0; c < m_channels; ++c) colors[c] += weight * layer[c];
    }
    void finish(std::size_t at, float* pixel) const {
        const float covered = 1 - m_uncovered[at];
        const float scale = m_weight[at] > 0 ? (m_is_multiplied ? covered : 1) / m_weight[at] : 0;
        const float* colors = &m_colors[at * static_cast<std::size_t>(m_channels)];
        for (int c = 0; c < m_channels; ++c) pixel[c] = scale == 0 ? 0 : colors[c] * scale;
        pixel[alpha_channel()] = covered;
    }

    const LayeredPicture& m_picture;
    bool m_is_multiplied;
    Box m_box;
    int m_channels;
    std::size_t m_width;
    std::vector<float> m_colors, m_weight, m_uncovered, m_through;
};

}  // namespace

bool LayeredPicture::draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
                          const ParallelFor& parallel_for) const {
    const Source& first = source_of(layers.front(), sources);
    for (const PictureLayer& layer : layers)
        if (source_of(layer, sources).unassociated_alpha() != first.unassociated_alpha())
            throw Error("the layers' pictures must all have colors that are multiplied by alpha, or none");
    // Some rows at a time, for which there is memory.
    constexpr int kPixels = 1 << 18;
    const int most = std::max(1, kPixels / std::max(1, box.width()));
    bool ok = true;
    for (int y = box.y0; y < box.y1; y += most) {
        const Box rows{box.x0, y, box.x1, std::min(y + most, box.y1)};
        Mixture mixture(*this, first.unassociated_alpha() < 0, rows, first.channels());
        const auto size = mixture.pixels() * static_cast<std::size_t>(first.channels());
        std::vector<float> colors(size), weights;
        const ImageView of_layer =
            packed_view(reinterpret_cast<std::byte*>(colors.data()), PixelType::float32, rows.width(),
                        rows.height(), first.channels());
        for (auto layer = layers.rbegin(); layer != layers.rend() && !mixture.is_closed(); ++layer) {
            ok = layer->picture.draw(sources, rows, of_layer, parallel_for) && ok;
            weights.resize(layer->weights ? mixture.pixels() : 0);
            if (layer->weights) layer->weights(rows, weights.data(), parallel_for);
            parallel_for(rows.height(), [&](std::int64_t row) {
                mixture.add(row, colors.data(), weights.empty() ? nullptr : weights.data());
            });
        }
        ImageView to = view;
        to.data = view.at(0, rows.y0 - box.y0);
        parallel_for(rows.height(), [&](std::int64_t row) { mixture.store(row, to); });
    }
    return ok;
}

}  // namespace anamorph
