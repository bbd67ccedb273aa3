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
#include "anamorph/image/pyramid.h"
#include "anamorph/image/strips.h"
#include "anamorph/image/summed_areas.h"
#include "anamorph/image/window.h"

namespace anamorph::machine {

/// Reads texels of the input image memory and interpolates between them; one for each thread.
class BlockPixels::Reader {
  public:
    /// `sums`: those of the source, where texels are means; else null.
    Reader(const BlockPixels& pixels, const Source& source, const SummedAreas* sums)
        : m_pixels(pixels),
          m_sums(sums),
          m_window_reader(source, pixels.m_border),
          m_weight_unit(std::ldexp(1.0, pixels.m_weight_bits)),
          m_channels(source.channels()),
          m_texel(static_cast<std::size_t>(m_channels)),
          m_sum(static_cast<std::size_t>(m_channels)) {}

    /// Writes what stands at an address, of a block whose pixels gain `steps` of texels, to `pixel`: colour multiplied by alpha. False
    /// where the source could not be read.
    bool read(const Point<double>& at, const Jacobian& steps, float* pixel) {
        const bool nearest = m_pixels.m_filter == Filter::nearest;
        const double shift = nearest ? 0 : 0.5;
        const int i = static_cast<int>(std::floor(at.x - shift)),
                  j = static_cast<int>(std::floor(at.y - shift));
        if (!enter(i, j, nearest ? 1 : 2, steps)) return false;
        // Multiples of the weights' unit.
        const double right = nearest ? 0 : weight(at.x - shift - i),
                     below = nearest ? 0 : weight(at.y - shift - j);
        std::fill(m_sum.begin(), m_sum.end(), 0.0);
        for (const int dy : {0, 1})
            for (const int dx : {0, 1}) {
                const double share = (dx ? right : 1 - right) * (dy ? below : 1 - below);
                // What has no weight is not looked at: it may be no number.
                if (share == 0) continue;
                if (!store(i + dx, j + dy)) return false;
                for (std::size_t c = 0; c < m_sum.size(); ++c) m_sum[c] += share * double(m_texel[c]);
            }
        for (std::size_t c = 0; c < m_sum.size(); ++c) pixel[c] = static_cast<float>(m_sum[c]);
        return true;
    }

  private:
    double weight(double part) const { return std::nearbyint(part * m_weight_unit) / m_weight_unit; }

    /// Makes texels from (i, j) on ready, so many each way.
    bool enter(int i, int j, int side, const Jacobian& steps) {
        m_width = std::fabs(steps.x_i) + std::fabs(steps.x_j);
        m_height = std::fabs(steps.y_i) + std::fabs(steps.y_j);
        const Box texels{i, j, i + side, j + side};
        if (m_sums || intersection(texels, m_window.box) == texels) return true;
        // A window with room for the pixels that come next.
        constexpr int kRoom = 16;
        return m_window_reader.get(0, 0, {i - kRoom, j - kRoom, i + kRoom, j + kRoom}, m_window);
    }
    /// The texel (i, j) as the memory holds it.
    bool store(int i, int j) {
        if (m_sums) {
            if (!m_sums->mean(i + 0.5, j + 0.5, m_width, m_height, m_pixels.m_border.wrap(), m_texel.data()))
                return false;
        } else {
            load_channels(m_window.texels + (j - m_window.box.y0) * m_window.row_stride +
                              std::ptrdiff_t{i - m_window.box.x0} * m_channels * size_of(m_window.type),
                          m_window.type, m_channels, m_texel.data());
        }
        if (m_pixels.m_texel_bits == 0) return true;
        const double most = std::ldexp(1.0, m_pixels.m_texel_bits) - 1;
        for (float& value : m_texel)
            value =
                std::isnan(value)
                    ? 0
                    : static_cast<float>(std::nearbyint(std::clamp(double(value), 0.0, 1.0) * most) / most);
        return true;
    }

    const BlockPixels& m_pixels;
    const SummedAreas* m_sums;
    WindowReader m_window_reader;
    Window m_window;
    double m_weight_unit;
    int m_channels;
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
    // A source that keeps no sums is lent a place for them.
    std::optional<Pyramid> lent;
    const SummedAreas* sums = nullptr;
    if (m_filter == Filter::antialias) {
        if (!(sums = source->summed_areas(0))) sums = lent.emplace(*source).summed_areas(0);
        if (!sums) return false;
    }
    const Box whole{0, 0, m_map->width(), m_map->height()};
    if (!(intersection(box, whole) == box)) canvas.fill(box, 0);
    std::atomic<bool> ok{true};
    for_each_square(intersection(box, whole), parallel_for, [&](const Box& square) {
        Reader reader(*this, *source, sums);
        const auto frame = m_map->frame_of(square);
        const int channels = source->channels();
        std::vector<float> row(static_cast<std::size_t>(square.width() * channels + 16));
        for (int y = square.y0; y < square.y1; ++y) {
            std::fill(row.begin(), row.end(), 0.0f);
            for (int x = square.x0; x < square.x1; ++x) {
                float* const pixel = row.data() + std::ptrdiff_t{x - square.x0} * channels;
                const std::size_t at = frame->index(x, y);
                const std::int32_t block = frame->block[at];
                if (block == BlockFrame::kNone) continue;
                const Point<double>& address = frame->addresses[at];
                if (!reader.read(address, m_map->blocks_of_machine().steps()[static_cast<std::size_t>(block)],
                                 pixel))
                    ok = false;
                if (m_shading) add_light(m_shading->at(block, address), pixel, channels, m_alpha, true);
                if (source->unassociated_alpha() >= 0)
                    unassociate_alpha(pixel, channels, source->unassociated_alpha());
            }
            for (int x = square.x0; x < square.x1; x += simd::kMaxRow)
                canvas.store(x, y, std::min(simd::kMaxRow, square.x1 - x),
                             row.data() + std::ptrdiff_t{x - square.x0} * channels);
        }
        simd::finish_stores();
    });
    return ok;
}

}  // namespace anamorph::machine
