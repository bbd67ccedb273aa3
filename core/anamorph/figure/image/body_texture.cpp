// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/image/body_texture.h"

#include <algorithm>
#include <cmath>

#include "anamorph/number/hypot.h"
#include "anamorph/number/jet.h"

namespace anamorph::figure {
Border texture_border(const Source& source, BodyMapping mapping) {
    const Size size = source.size(0);
    // Any texture goes from pole to pole, as a panorama of such a height and twice its width does.
    if (mapping == BodyMapping::latlong)
        return {Chart(Projection::equirectangular, 2 * size.height, size.height), Wrap::automatic};
    return {Chart(Projection::rectilinear, size.width, size.height),
            mapping == BodyMapping::mirrored ? Wrap::mirror : Wrap::clamp};
}

glm::dvec4 color_of_texel(const std::vector<float>& texel) {
    const bool gray = texel.size() < 3;
    const auto at = [&](std::size_t c) { return static_cast<double>(texel[gray ? 0 : c]); };
    const std::size_t alpha = gray ? 1 : 3;
    return {at(0), at(1), at(2), alpha < texel.size() ? at(alpha) : 1.0};
}

BodyTexture::BodyTexture(const Source& source, BodyMapping mapping, Filter filter, TextureAverage average)
    : m_source(source),
      m_average(average),
      m_mapping(mapping),
      m_filter(filter),
      m_border(texture_border(source, mapping)),
      m_chooser(source),
      m_sampler(source, m_border),
      m_pixel(static_cast<std::size_t>(source.channels())),
      m_coarser(m_pixel.size()) {
    if (average == TextureAverage::summed_area && averages(filter) && source.summed_areas(0))
        m_sums.emplace(source);
}

glm::dvec3 BodyTexture::color(const TexturedSurface& body, double x, double y, bool far_side,
                              const glm::dvec3& below) {
    using Number = Jet1<double>;
    const std::array<Number, 3> p =
        body.surface.unit_point_of(Number::variable(x, 1, 0), Number::variable(y, 0, 1), far_side);
    Number u, v;
    texture_point(m_mapping, p[0], p[1], p[2], u, v);
    const Size size = m_source.size(0);
    u = u * double(size.width) + body.offset.x;
    v = v * double(size.height) + body.offset.y;
    bool read;
    if (!averages(m_filter))
        read = m_sampler.sample(m_filter, 0, 0, u.value(), v.value(), m_pixel.data());
    else if (m_average == TextureAverage::mrasel)
        read = read_as_mrasel(p[1].value(), body.longest, u.value(), v.value());
    else
        read = read_average({u.c[1], v.c[1], u.c[2], v.c[2]}, u.value(), v.value());
    if (!read) return below;
    const glm::dvec4 own = color_of_texel(m_pixel);
    return laid_over(glm::dvec3(own), own.a, below);
}

bool BodyTexture::read_average(const Jacobian& jacobian, double u, double v) {
    if (m_average == TextureAverage::trilinear) return read_trilinear(jacobian, u, v);
    if (!m_sums) return m_sampler.sample(m_chooser(jacobian), jacobian, 0, u, v, m_pixel.data());
    const Jacobian rectangle = covering_rectangle(jacobian);
    if (m_mapping == BodyMapping::latlong)
        return m_sums->mean_over_poles(u, v, rectangle.x_i, rectangle.y_j, m_pixel.data());
    return m_sums->mean(u, v, rectangle.x_i, rectangle.y_j, m_border.wrap(), m_pixel.data());
}

bool BodyTexture::read_trilinear(const Jacobian& jacobian, double u, double v) {
    const double longer = std::max(hypot(jacobian.x_i, jacobian.y_i), hypot(jacobian.x_j, jacobian.y_j));
    // Between the last level whose texels are shorter than that, and the next.
    const auto texel = [&](int level) {
        const std::array<double, 2>& scale = m_chooser.scale(level);
        return 1 / std::min(scale[0], scale[1]);
    };
    int level = 0;
    while (level + 1 < m_chooser.levels() && texel(level + 1) <= longer) ++level;
    if (!read_level(Filter::bilinear, level, u, v, m_pixel.data())) return false;
    if (level + 1 == m_chooser.levels() || !(longer > texel(level))) return true;
    if (!read_level(Filter::bilinear, level + 1, u, v, m_coarser.data())) return false;
    const double share = std::log(longer / texel(level)) / std::log(texel(level + 1) / texel(level));
    // A level of weight 0 does not count.
    if (share <= 0) return true;
    if (share >= 1) m_pixel = m_coarser;
    for (std::size_t c = 0; share < 1 && c < m_pixel.size(); ++c)
        m_pixel[c] = static_cast<float>((1 - share) * static_cast<double>(m_pixel[c]) +
                                        share * static_cast<double>(m_coarser[c]));
    return true;
}

/// Chapman 1986, section 3.6: of the levels larger than min(cos, sin) max(a1, a2, a3), the smallest.
bool BodyTexture::read_as_mrasel(double sine, double longest, double u, double v) {
    const double cosine = std::sqrt(std::max(0.0, 1 - sine * sine));
    const double wanted = std::min(cosine, std::fabs(sine)) * longest;
    int level = 0;
    while (level + 1 < m_chooser.levels() && m_source.size(level + 1).width > wanted) ++level;
    return read_level(Filter::nearest, level, u, v, m_pixel.data());
}

/// (u, v) in texels of level 0.
bool BodyTexture::read_level(Filter filter, int level, double u, double v, float* pixel) {
    const std::array<double, 2>& scale = m_chooser.scale(level);
    return m_sampler.sample(filter, level, 0, u * scale[0], v * scale[1], pixel);
}

}  // namespace anamorph::figure
