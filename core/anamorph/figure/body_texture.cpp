// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/body_texture.h"

#include "anamorph/number/jet.h"

namespace anamorph {
namespace {

/// What stands beyond the texture's edges: what the mapping continues with.
Border border_of(const Source& source, BodyMapping mapping) {
    const Size size = source.size(0);
    if (mapping == BodyMapping::latlong)
        return {Chart(Projection::equirectangular, size.width, size.height), Wrap::automatic};
    return {Chart(Projection::rectilinear, size.width, size.height),
            mapping == BodyMapping::mirrored ? Wrap::mirror : Wrap::clamp};
}

}  // namespace

BodyTexture::BodyTexture(const Source& source, BodyMapping mapping, Filter filter)
    : m_source(source),
      m_mapping(mapping),
      m_filter(filter),
      m_border(border_of(source, mapping)),
      m_chooser(source),
      m_sampler(source, m_border),
      m_pixel(static_cast<std::size_t>(source.channels())) {}

glm::dvec3 BodyTexture::color(const SeenSurface& surface, double x, double y, bool far_side,
                              const glm::dvec2& offset, const glm::dvec3& below) {
    using Number = Jet1<double>;
    const std::array<Number, 3> p =
        surface.unit_point_of(Number::variable(x, 1, 0), Number::variable(y, 0, 1), far_side);
    Number u, v;
    texture_point(m_mapping, p[0], p[1], p[2], u, v);
    const Size size = m_source.size(0);
    u = u * double(size.width) + offset.x;
    v = v * double(size.height) + offset.y;
    const bool read = m_sampler.sample(m_filter, m_chooser, {u.c[1], v.c[1], u.c[2], v.c[2]}, 0, u.value(),
                                       v.value(), m_pixel.data());
    if (!read) return below;
    const bool gray = m_pixel.size() < 3;
    const auto at = [&](std::size_t c) { return static_cast<double>(m_pixel[gray ? 0 : c]); };
    const std::size_t alpha = gray ? 1 : 3;
    const double rest = alpha < m_pixel.size() ? 1 - static_cast<double>(m_pixel[alpha]) : 0.0;
    return glm::dvec3(at(0), at(1), at(2)) + rest * below;
}

}  // namespace anamorph
