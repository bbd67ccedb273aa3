// SPDX-License-Identifier: Apache-2.0
#include "anamorph/render/point_sampler.h"

#include <algorithm>
#include <cmath>

#include "anamorph/render/pixel.h"
#include "anamorph/render/summed_areas.h"
#include "anamorph/render/weightless.h"

namespace anamorph {
namespace {

/// The texels one axis of a filter reads: `first`, `first` + 1, ... with their weights.
struct Taps {
    int first = 0, count = 1;
    std::array<double, 4> weight{1, 0, 0, 0};
};

/// A point nearer than `same` to the middle of a texel is there.
Taps taps_at(Filter filter, double at, float same) {
    // Far beyond every edge all points are alike; int64 holds them, int must too.
    at = std::clamp(at, -0x1p30, 0x1p30);
    if (filter == Filter::nearest) return {static_cast<int>(std::floor(at)), 1, {1}};
    const double floor = std::floor(at - 0.5), past = at - 0.5 - floor;
    const double t = past < same ? 0 : past > 1 - same ? 1 : past;
    const int below = static_cast<int>(floor);
    if (filter == Filter::bicubic) return {below - 1, 4, catmull_rom_weights(t)};
    const auto [first, second] = bilinear_weights(t);
    return {below, 2, {first, second}};
}

/// Of a channel of the texels from the corner of a window on.
double sum_of(const Window& window, const Taps& across, const Taps& down, int channel) {
    const std::ptrdiff_t size = size_of(window.type);
    double sum = 0;
    for (int j = 0; j < down.count; ++j)
        for (int i = 0; i < across.count; ++i) {
            const double weight =
                across.weight[static_cast<std::size_t>(i)] * down.weight[static_cast<std::size_t>(j)];
            if (weight == 0) continue;
            const std::byte* texel =
                window.texels + j * window.row_stride + (i * window.channels + channel) * size;
            sum += weight * static_cast<double>(load_channel(texel, window.type));
        }
    return sum;
}

}  // namespace

PointSampler::PointSampler(const Source& source, const Border& border)
    : m_source(source),
      m_wrap(border.wrap()),
      m_reader(source, border),
      m_tap(static_cast<std::size_t>(source.channels())),
      m_sum(static_cast<std::size_t>(source.channels())) {}

bool PointSampler::sample(Filter filter, int level, int piece, double x, double y, float* pixel) noexcept {
    const int channels = m_source.channels();
    std::fill_n(pixel, channels, 0.0f);
    if (std::isnan(x) || std::isnan(y)) return true;
    const Taps across = taps_at(filter, x, 0), down = taps_at(filter, y, 0);
    const Box box{across.first, down.first, across.first + across.count, down.first + down.count};
    Window window;
    if (!m_reader.get(level, piece, box, window)) return false;
    if (filter == Filter::nearest) {
        load_channels(window.texels, window.type, channels, pixel);
        return true;
    }

    for (int c = 0; c < channels; ++c) {
        double value = sum_of(window, across, down, c);
        if (!std::isfinite(value))
            value = sum_of(window, taps_at(filter, x, kSameTexel), taps_at(filter, y, kSameTexel), c);
        pixel[c] = static_cast<float>(value);
    }
    return true;
}

bool PointSampler::sample(const Footprint& footprint, const Jacobian& jacobian, int piece, double x, double y,
                          float* pixel) noexcept {
    const Size full = m_source.size(0), size = m_source.size(footprint.level);
    const double sx = static_cast<double>(size.width) / full.width,
                 sy = static_cast<double>(size.height) / full.height;
    std::fill(m_sum.begin(), m_sum.end(), 0.0);
    const TapOffsets offset(footprint, jacobian, {sx, sy});
    for (int j = 0; j < footprint.taps_b; ++j)
        for (int i = 0; i < footprint.taps_a; ++i) {
            const Point<double> tap = offset(i, j);
            if (!sample(Filter::bilinear, footprint.level, piece, x * sx + tap.x, y * sy + tap.y,
                        m_tap.data()))
                return false;
            for (std::size_t c = 0; c < m_sum.size(); ++c) m_sum[c] += static_cast<double>(m_tap[c]);
        }
    const double taps = footprint.taps_a * footprint.taps_b;
    for (std::size_t c = 0; c < m_sum.size(); ++c) pixel[c] = static_cast<float>(m_sum[c] / taps);
    // Taps that lie together are one, where that makes a difference.
    const Point<double> corner = offset(0, 0);
    const bool together =
        taps > 1 && std::fabs(corner.x) + std::fabs(corner.y) < static_cast<double>(kSameTap);
    if (!together || std::all_of(m_sum.begin(), m_sum.end(), [](double sum) { return std::isfinite(sum); }))
        return true;
    if (!sample(Filter::bilinear, footprint.level, piece, x * sx, y * sy, m_tap.data())) return false;
    for (std::size_t c = 0; c < m_sum.size(); ++c)
        if (!std::isfinite(m_sum[c])) pixel[c] = m_tap[c];
    return true;
}

bool PointSampler::sample(Filter filter, const FootprintChooser& chooser, const Jacobian& jacobian, int piece,
                          double x, double y, float* pixel) noexcept {
    if (!averages(filter)) return sample(filter, 0, piece, x, y, pixel);
    if (filter == Filter::antialias) return sample(chooser(jacobian), jacobian, piece, x, y, pixel);
    const Jacobian rectangle = covering_rectangle(jacobian);
    if (filter == Filter::pyramid) return sample(chooser(rectangle), rectangle, piece, x, y, pixel);
    return mean(rectangle, x, y, pixel);
}

bool PointSampler::mean(const Jacobian& rectangle, double x, double y, float* pixel) noexcept {
    if (!m_sums) m_sums = m_source.summed_areas();
    if (!m_sums) return false;
    m_sums->mean(x, y, rectangle.x_i, rectangle.y_j, m_wrap, pixel);
    return true;
}

}  // namespace anamorph
