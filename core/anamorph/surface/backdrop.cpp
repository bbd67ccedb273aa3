// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/backdrop.h"

#include <algorithm>

#include "anamorph/image/border.h"
#include "anamorph/image/pixel.h"

namespace anamorph::surface {

void lay_over(const float* over, const float* under, int channels, int alpha, float share, float* to) {
    const float rest = 1 - std::clamp(alpha >= 0 ? over[alpha] : share, 0.0f, 1.0f);
    // What is hidden is not read: it need not be a number.
    for (int c = 0; c < channels; ++c) to[c] = rest == 0 ? over[c] : over[c] + rest * under[c];
}

Backdrop::Backdrop(const std::vector<float>& color, const Source* picture, int alpha, const Box& covered,
                   Filter filter, int channels, const AlphaChannel& front)
    : m_picture(picture),
      m_alpha(alpha),
      m_channels(channels),
      m_front(front),
      m_filter(filter),
      m_covered(covered),
      m_color(static_cast<std::size_t>(channels)) {
    std::copy_n(color.begin(), std::min(color.size(), m_color.size()), m_color.begin());
    const auto opaque = static_cast<std::size_t>(front.channel);
    if (front.exists() && !color.empty() && color.size() <= opaque) m_color[opaque] = 1;
    if (front.straight()) associate_alpha(m_color.data(), channels, front.channel);
    if (!picture) return;
    const Size size = picture->size(0);
    m_step = {static_cast<double>(size.width) / covered.width(), 0, 0,
              static_cast<double>(size.height) / covered.height()};
    m_texel.resize(static_cast<std::size_t>(picture->channels()) + 16);
    m_over = m_color;
    m_chooser.emplace(*picture);
    m_border.emplace(Chart(Projection::rectilinear, size.width, size.height), Wrap::clamp);
    m_sampler.emplace(*picture, *m_border);
}

/// The picture at a pixel's centre, in its own channels.
bool Backdrop::sample(int x, int y) {
    const double u = (x - m_covered.x0 + 0.5) * m_step.x_i, v = (y - m_covered.y0 + 0.5) * m_step.y_j;
    return m_sampler->sample(m_filter, *m_chooser, m_step, 0, u, v, m_texel.data());
}

bool Backdrop::at(int x, int y, float* pixel) {
    std::copy(m_color.begin(), m_color.end(), pixel);
    if (!m_picture) return true;
    const bool ok = sample(x, y);
    int from = 0;
    for (int c = 0; c < m_channels; ++c) {
        if (c == m_front.channel) continue;
        if (from == m_alpha) ++from;
        m_over[static_cast<std::size_t>(c)] = m_texel[static_cast<std::size_t>(from++)];
    }
    const float alpha = m_alpha >= 0 ? m_texel[static_cast<std::size_t>(m_alpha)] : 1;
    if (m_front.exists()) m_over[static_cast<std::size_t>(m_front.channel)] = alpha;
    lay_over(m_over.data(), m_color.data(), m_channels, m_front.channel, alpha, pixel);
    return ok;
}

}  // namespace anamorph::surface
