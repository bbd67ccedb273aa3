// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/point_sampler.h"

#include <algorithm>
#include <cmath>

#include "anamorph/image/pixel.h"
#include "anamorph/image/weightless.h"

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
    if (is_cubic(filter)) return {below - 1, 4, cubic_weights(t, double{cubic_slope(is_sharp(filter))})};
    const auto [first, second] = bilinear_weights(t);
    return {below, 2, {first, second}};
}

/// The texels that a filter reads around a point.
Box box_at(Filter filter, double x, double y) {
    const Taps across = taps_at(filter, x, 0), down = taps_at(filter, y, 0);
    return {across.first, down.first, across.first + across.count, down.first + down.count};
}

/// The texels that all taps of a footprint read; empty where these are no numbers. Those in its corners reach farthest.
template <class TapAt>
Box box_of_taps(const Footprint& footprint, const TapAt& tap_at) {
    const int a = footprint.taps_a - 1, b = footprint.taps_b - 1;
    Point<double> low = tap_at(0, 0), high = low;
    for (const Point<double>& corner : {tap_at(a, 0), tap_at(0, b), tap_at(a, b)}) {
        low = {std::min(low.x, corner.x), std::min(low.y, corner.y)};
        high = {std::max(high.x, corner.x), std::max(high.y, corner.y)};
    }
    if (!(low.x <= high.x && low.y <= high.y)) return {};
    const Box first = box_at(Filter::bilinear, low.x, low.y), last = box_at(Filter::bilinear, high.x, high.y);
    return {first.x0, first.y0, last.x1, last.y1};
}

/// Are the texels of all taps quicker fetched together than by tap?
bool are_close(const Box& all, const Footprint& footprint) {
    constexpr double kMostForTap = 64;
    return (double(all.x1) - all.x0) * (double(all.y1) - all.y0) <=
           kMostForTap * footprint.taps_a * footprint.taps_b;
}

/// The sums of texels within a window, channel by channel; `texels` has room for four. They are clamped to the range of the
/// texels where that is asked for.
void weigh(const Window& window, const Taps& across, const Taps& down, bool clamps,
           std::vector<float>& texels, std::vector<double>& sums) {
    const std::size_t channels = sums.size();
    const std::ptrdiff_t size = size_of(window.type);
    const std::byte* const first = window.texels + (down.first - window.box.y0) * window.row_stride +
                                   std::ptrdiff_t{across.first - window.box.x0} * window.channels * size;
    std::fill(sums.begin(), sums.end(), 0.0);
    for (std::size_t j = 0; j < static_cast<std::size_t>(down.count); ++j) {
        load_channels(first + static_cast<std::ptrdiff_t>(j) * window.row_stride, window.type,
                      across.count * window.channels, texels.data());
        for (std::size_t i = 0; i < static_cast<std::size_t>(across.count); ++i) {
            const double weight = across.weight[i] * down.weight[j];
            if (weight == 0) continue;
            for (std::size_t c = 0; c < channels; ++c)
                sums[c] += weight * static_cast<double>(texels[i * channels + c]);
        }
    }
    if (!clamps) return;
    for (std::size_t c = 0; c < channels; ++c) {
        TapRange range;
        for (std::size_t j = 0; j < static_cast<std::size_t>(down.count); ++j)
            for (std::size_t i = 0; i < static_cast<std::size_t>(across.count); ++i)
                range.add(static_cast<double>(
                              load_channel(first + static_cast<std::ptrdiff_t>(j) * window.row_stride +
                                               static_cast<std::ptrdiff_t>(i * channels + c) * size,
                                           window.type)),
                          across.weight[i] * down.weight[j]);
        sums[c] = range.clamped(sums[c]);
    }
}

}  // namespace

PointSampler::PointSampler(const Source& source, const Border& border)
    : m_source(source),
      m_border(border),
      m_sums(source),
      m_reader(source, border),
      m_tap(static_cast<std::size_t>(source.channels())),
      m_sum(m_tap.size()),
      m_values(m_tap.size()),
      m_mended(m_tap.size()),
      m_texels(4 * m_tap.size()) {}

bool PointSampler::sample(Filter filter, int level, int piece, double x, double y, float* pixel) noexcept {
    Window window;
    if (!std::isnan(x) && !std::isnan(y) && !m_reader.get(level, piece, box_at(filter, x, y), window))
        return false;
    sample(filter, window, x, y, pixel);
    return true;
}

/// Samples the source from a window that has the texels.
void PointSampler::sample(Filter filter, const Window& window, double x, double y, float* pixel) noexcept {
    const int channels = m_source.channels();
    std::fill_n(pixel, channels, 0.0f);
    if (std::isnan(x) || std::isnan(y)) return;
    const Taps across = taps_at(filter, x, 0), down = taps_at(filter, y, 0);
    if (filter == Filter::nearest) {
        load_channels(window.texels, window.type, channels, pixel);
        return;
    }
    const bool clamps = is_clamped(filter);
    weigh(window, across, down, clamps, m_texels, m_values);
    const auto is_finite = [](double value) { return std::isfinite(value); };
    if (!std::all_of(m_values.begin(), m_values.end(), is_finite)) {
        weigh(window, taps_at(filter, x, kSameTexel), taps_at(filter, y, kSameTexel), clamps, m_texels,
              m_mended);
        for (std::size_t c = 0; c < m_values.size(); ++c)
            if (!is_finite(m_values[c])) m_values[c] = m_mended[c];
    }
    std::transform(m_values.begin(), m_values.end(), pixel,
                   [](double value) { return static_cast<float>(value); });
}

bool PointSampler::sample(const Footprint& footprint, const Jacobian& jacobian, int piece, double x, double y,
                          float* pixel) noexcept {
    const Size full = m_source.size(0), size = m_source.size(footprint.level);
    const double sx = static_cast<double>(size.width) / full.width,
                 sy = static_cast<double>(size.height) / full.height;
    std::fill(m_sum.begin(), m_sum.end(), 0.0);
    const TapOffsets offset(footprint, jacobian, {sx, sy});
    const auto tap_at = [&](int i, int j) {
        const Point<double> tap = offset(i, j);
        return Point<double>{x * sx + tap.x, y * sy + tap.y};
    };
    // A footprint may be thousands of texels beside what there is.
    const SourceLevel level = m_source.level(footprint.level);
    const Box all = box_of_taps(footprint, tap_at);
    if (all.empty() || m_border.is_black(all, level)) {
        std::fill_n(pixel, m_sum.size(), 0.0f);
        return true;
    }
    // Taps that lie close to each other are read from one window.
    Window window;
    const bool at_once = are_close(all, footprint);
    if (at_once && !m_reader.get(footprint.level, piece, all, window)) return false;
    for (int j = 0; j < footprint.taps_b; ++j)
        for (int i = 0; i < footprint.taps_a; ++i) {
            const Point<double> at = tap_at(i, j);
            if (at_once)
                sample(Filter::bilinear, window, at.x, at.y, m_tap.data());
            else if (std::isnan(at.x) || std::isnan(at.y) ||
                     m_border.is_black(box_at(Filter::bilinear, at.x, at.y), level))
                continue;
            else if (!sample(Filter::bilinear, footprint.level, piece, at.x, at.y, m_tap.data()))
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
    return m_sums.mean(x, y, rectangle.x_i, rectangle.y_j, m_border.wrap(), pixel);
}

}  // namespace anamorph
