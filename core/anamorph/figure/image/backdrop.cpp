// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/image/backdrop.h"

#include <algorithm>

#include "anamorph/figure/image/body_texture.h"

namespace anamorph::figure {

glm::dvec4 band_color(const std::vector<BackgroundBand>& bands, int y, int height) {
    glm::dvec3 sum(0.0);
    double from = y;
    for (std::size_t i = 0; i < bands.size() && from < y + 1; ++i) {
        const double end = i + 1 == bands.size() ? y + 1 : std::clamp(bands[i].end * height, from, y + 1.0);
        sum += (end - from) * bands[i].color / 255.0;
        from = end;
    }
    return {sum, 1};
}

FigureBackdrop::FigureBackdrop(const Source& source, const Size& size)
    : m_jacobian{static_cast<double>(source.size(0).width) / size.width, 0, 0,
                 static_cast<double>(source.size(0).height) / size.height},
      m_border(Chart(Projection::rectilinear, source.size(0).width, source.size(0).height), Wrap::clamp),
      m_footprint(FootprintChooser(source)(m_jacobian)),
      m_sampler(source, m_border),
      m_pixel(static_cast<std::size_t>(source.channels())) {}

glm::dvec4 FigureBackdrop::color(int x, int y, const glm::dvec4& below) {
    if (!m_sampler.sample(m_footprint, m_jacobian, 0, (x + 0.5) * m_jacobian.x_i, (y + 0.5) * m_jacobian.y_j,
                          m_pixel.data()))
        return below;
    const glm::dvec4 own = color_of_texel(m_pixel);
    return laid_over(own, own.a, below);
}

}  // namespace anamorph::figure
