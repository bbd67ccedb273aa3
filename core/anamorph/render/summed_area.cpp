// SPDX-License-Identifier: Apache-2.0
#include "anamorph/render/summed_area.h"

#include <algorithm>
#include <cmath>

#include "anamorph/render/border.h"
#include "anamorph/render/pixel.h"
#include "anamorph/render/window.h"

namespace anamorph {
namespace {

constexpr int kRows = 16;  ///< read at once

/// The point of [0, most] that stands at x where the image is reflected again and again.
double reflected(double x, double most, bool& odd) {
    const double turns = std::floor(x / most);
    odd = std::fmod(turns, 2) != 0;
    const double rest = x - turns * most;
    return std::clamp(odd ? most - rest : rest, 0.0, most);
}

}  // namespace

SummedArea::SummedArea(const Size& size, int channels, SummedEdges edges)
    : m_size(size),
      m_channels(static_cast<std::size_t>(channels)),
      m_edges(edges),
      m_sums(static_cast<std::size_t>(size.width + 1) * static_cast<std::size_t>(size.height + 1) *
             m_channels) {}

std::unique_ptr<const SummedArea> SummedArea::of(const Source& source, SummedEdges edges) {
    for (int level = 0; level < source.levels(); ++level) {
        const Size size = source.size(level);
        if (std::int64_t{size.width} * size.height > kMostTexels) continue;
        std::unique_ptr<SummedArea> area(new SummedArea(size, source.channels(), edges));
        area->m_scale_x = static_cast<double>(size.width) / source.size(0).width;
        area->m_scale_y = static_cast<double>(size.height) / source.size(0).height;
        return area->add(source, level) ? std::move(area) : nullptr;
    }
    return nullptr;
}

bool SummedArea::add(const Source& source, int level) {
    const Border border(Chart(Projection::rectilinear, m_size.width, m_size.height), Wrap::clamp);
    WindowReader reader(source, border);
    const std::size_t row = static_cast<std::size_t>(m_size.width + 1) * m_channels;
    for (int y0 = 0; y0 < m_size.height; y0 += kRows) {
        const int y1 = std::min(y0 + kRows, m_size.height);
        Window window;
        if (!reader.get(level, 0, {0, y0, m_size.width, y1}, window)) return false;
        const auto bytes = static_cast<std::ptrdiff_t>(size_of(window.type));
        for (int y = y0; y < y1; ++y) {
            const std::byte* texel = window.texels + (y - y0) * window.row_stride;
            double* below = &m_sums[static_cast<std::size_t>(y + 1) * row];
            const double* above = below - row;
            std::vector<double> along(m_channels, 0.0);
            for (std::size_t i = m_channels; i < row; ++i, texel += bytes) {
                double& sum = along[i % m_channels];
                const auto value = static_cast<double>(load_channel(texel, window.type));
                // A texel that is no number would spoil all sums after it.
                sum += std::isfinite(value) ? value : 0;
                below[i] = above[i] + sum;
            }
        }
    }
    return true;
}

/// Over [0, x] x [0, y] inside the image.
double SummedArea::sum(double x, double y, std::size_t channel) const {
    const int i = std::clamp(static_cast<int>(x), 0, m_size.width - 1),
              j = std::clamp(static_cast<int>(y), 0, m_size.height - 1);
    const double s = x - i, t = y - j;
    const std::size_t row = static_cast<std::size_t>(m_size.width + 1) * m_channels;
    const double* at =
        &m_sums[static_cast<std::size_t>(j) * row + static_cast<std::size_t>(i) * m_channels + channel];
    return (1 - t) * ((1 - s) * at[0] + s * at[m_channels]) +
           t * ((1 - s) * at[row] + s * at[row + m_channels]);
}

/// Over [0, x] x [y0, y1], with x beyond the edges and y inside.
double SummedArea::sum_left_of(double x, double y0, double y1, std::size_t channel) const {
    const double width = m_size.width;
    const auto inside = [&](double at) { return sum(at, y1, channel) - sum(at, y0, channel); };
    const double turns = std::floor(x / width), rest = std::clamp(x - turns * width, 0.0, width),
                 all = inside(width);
    const bool back = m_edges == SummedEdges::reflected && std::fmod(turns, 2) != 0;
    return turns * all + (back ? all - inside(width - rest) : inside(rest));
}

/// The same over [x0, x1] x [y0, y1]; y beyond the edges by no more than the image.
double SummedArea::sum(double x0, double x1, double y0, double y1, std::size_t channel) const {
    const double height = m_size.height, turn = m_edges == SummedEdges::turn ? 0.5 * m_size.width : 0;
    const auto part = [&](double from, double to, double by) {
        return from < to ? sum_left_of(x1 + by, from, to, channel) - sum_left_of(x0 + by, from, to, channel)
                         : 0;
    };
    return part(std::max(y0, 0.0), std::min(y1, height), 0) + part(0, std::min(-y0, height), turn) +
           part(std::max(2 * height - y1, 0.0), height, turn);
}

void SummedArea::mean(double x, double y, double half_width, double half_height, float* pixel) const {
    const double width = m_size.width, height = m_size.height;
    // So far away that no digits are left, and what is no number, is the corner.
    if (!(std::fabs(x) < 1e12 && std::fabs(y) < 1e12)) x = y = 0;
    bool over = false, odd = false;
    y = reflected(y * m_scale_y, height, over);
    x = x * m_scale_x + (over && m_edges == SummedEdges::turn ? 0.5 * width : 0);
    x = m_edges == SummedEdges::turn ? x - width * std::floor(x / width) : reflected(x, width, odd);
    const auto half = [](double size, double most) {
        return size < most ? std::max(size, std::min(0.5, most)) : most;
    };
    const double a = half(half_width * m_scale_x, 0.5 * width),
                 b = half(half_height * m_scale_y, 0.5 * height);
    for (std::size_t c = 0; c < m_channels; ++c)
        pixel[c] = static_cast<float>(sum(x - a, x + a, y - b, y + b, c) / (4 * a * b));
}

}  // namespace anamorph
