// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/block_pixels.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/image/canvas.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/point_sampler.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/image/strips.h"
#include "anamorph/image/summed_areas.h"

namespace anamorph::machine {

/// Reads texels of the input image memory and interpolates between them; one for each thread.
class BlockPixels::Reader {
  public:
    /// `sums`: those of the source, where texels are means; else null.
    Reader(const BlockPixels& pixels, const Source& source, const SummedAreas* sums)
        : m_pixels(pixels),
          m_sums(sums),
          m_sampler(source, pixels.m_border),
          m_channels(static_cast<std::size_t>(source.channels())),
          m_texel(m_channels),
          m_sum(m_channels) {}

    /// Writes what stands at an address, of a block whose pixels gain `steps` of texels, to `pixel`: colour multiplied by alpha. False
    /// where the source could not be read.
    bool read(const Point<double>& at, const Jacobian& steps, float* pixel) {
        m_width = std::fabs(steps.x_i) + std::fabs(steps.x_j);
        m_height = std::fabs(steps.y_i) + std::fabs(steps.y_j);
        if (m_pixels.m_filter == Filter::nearest) {
            if (!store(std::floor(at.x), std::floor(at.y))) return false;
            std::copy(m_texel.begin(), m_texel.end(), pixel);
            return true;
        }
        const double i = std::floor(at.x - 0.5), j = std::floor(at.y - 0.5);
        const double right = weight(at.x - 0.5 - i), below = weight(at.y - 0.5 - j);
        std::fill(m_sum.begin(), m_sum.end(), 0.0);
        for (const int dy : {0, 1})
            for (const int dx : {0, 1}) {
                const double share = (dx ? right : 1 - right) * (dy ? below : 1 - below);
                // What has no weight is not looked at: it may be no number.
                if (share == 0) continue;
                if (!store(i + dx, j + dy)) return false;
                for (std::size_t c = 0; c < m_channels; ++c) m_sum[c] += share * double(m_texel[c]);
            }
        for (std::size_t c = 0; c < m_channels; ++c) pixel[c] = static_cast<float>(m_sum[c]);
        return true;
    }

  private:
    double weight(double part) const {
        const double unit = std::ldexp(1.0, m_pixels.m_weight_bits);
        return std::nearbyint(part * unit) / unit;
    }

    /// The texel (i, j) as the memory holds it.
    bool store(double i, double j) {
        if (m_sums)
            m_sums->mean(i + 0.5, j + 0.5, m_width, m_height, m_pixels.m_border.wrap(), m_texel.data());
        else if (!m_sampler.sample(Filter::nearest, 0, 0, i + 0.5, j + 0.5, m_texel.data()))
            return false;
        if (m_pixels.m_texel_bits > 0) {
            const double most = std::ldexp(1.0, m_pixels.m_texel_bits) - 1;
            for (float& value : m_texel)
                value = static_cast<float>(
                    std::isnan(value) ? 0
                                      : std::nearbyint(std::clamp(double(value), 0.0, 1.0) * most) / most);
        }
        return true;
    }

    const BlockPixels& m_pixels;
    const SummedAreas* m_sums;
    PointSampler m_sampler;
    std::size_t m_channels;
    double m_width = 1, m_height = 1;
    std::vector<float> m_texel;
    std::vector<double> m_sum;
};

BlockPixels::BlockPixels(std::shared_ptr<const BlockMachineMap> map, const BlockMachine& machine,
                         const Border& border, Filter filter)
    : m_map(std::move(map)),
      m_border(border),
      m_filter(filter),
      m_weight_bits(machine.weight_bits),
      m_texel_bits(machine.texel_bits) {}

bool BlockPixels::draw(const Source* source, const Box& box, const ImageView& view,
                       const ParallelFor& parallel_for) const {
    if (!source) throw Error("a picture in colour needs a source");
    const Canvas canvas(view, box);
    canvas.fill(box, 0);
    // A source that keeps no sums is lent a place for them.
    std::optional<Pyramid> lent;
    const SummedAreas* sums = nullptr;
    if (m_filter == Filter::antialias) {
        if (!(sums = source->summed_areas())) sums = lent.emplace(*source).summed_areas();
        if (!sums) return false;
    }
    const BlockFrame& frame = m_map->frame();
    const Box whole{0, 0, m_map->width(), m_map->height()};
    std::atomic<bool> ok{true};
    for_each_square(intersection(box, whole), parallel_for, [&](const Box& square) {
        Reader reader(*this, *source, sums);
        std::vector<float> pixel(static_cast<std::size_t>(source->channels()) + 16);
        for (int y = square.y0; y < square.y1; ++y)
            for (int x = square.x0; x < square.x1; ++x) {
                const std::size_t at = frame.index(x, y);
                if (frame.block[at] == BlockFrame::kNone) continue;
                if (!reader.read(frame.addresses[at], frame.steps[static_cast<std::size_t>(frame.block[at])],
                                 pixel.data()))
                    ok = false;
                if (source->unassociated_alpha() >= 0)
                    unassociate_alpha(pixel.data(), source->channels(), source->unassociated_alpha());
                canvas.store(x, y, 1, pixel.data());
            }
        simd::finish_stores();
    });
    return ok;
}

}  // namespace anamorph::machine
