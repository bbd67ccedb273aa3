// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/image/bump_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anamorph/figure/image/body_texture.h"
#include "anamorph/number/jet.h"

namespace anamorph::figure {
namespace {

using Number = Jet1<double>;

/// The gradients of u and of v by a point of space: both are the same all along a ray from the centre.
std::array<glm::dvec3, 2> gradients_of(BodyMapping mapping, const glm::dvec3& p) {
    Number u, v, of_z_u, of_z_v;
    texture_point(mapping, Number::variable(p.x, 1, 0), Number::variable(p.y, 0, 1), Number(p.z), u, v);
    texture_point(mapping, Number(p.x), Number(p.y), Number::variable(p.z, 1, 0), of_z_u, of_z_v);
    return {glm::dvec3(u.c[1], u.c[2], of_z_u.c[1]), glm::dvec3(v.c[1], v.c[2], of_z_v.c[1])};
}

}  // namespace

BumpMap::BumpMap(const Source& source, BodyMapping mapping)
    : m_source(source),
      m_mapping(mapping),
      m_border(texture_border(source, mapping)),
      m_chooser(source),
      m_sampler(source, m_border),
      m_pixel(static_cast<std::size_t>(source.channels())) {}

bool BumpMap::height(const Jacobian& jacobian, double u, double v, double& height) {
    if (!m_sampler.sample(m_chooser(jacobian), jacobian, 0, u, v, m_pixel.data())) return false;
    const std::size_t colors = m_pixel.size() < 3 ? 1 : 3;
    height = 0;
    for (std::size_t c = 0; c < colors; ++c) height += static_cast<double>(m_pixel[c]) / double(colors);
    return true;
}

glm::dvec3 BumpMap::gradient(const SeenSurface& surface, double x, double y, bool far_side) {
    const std::array<Number, 3> p =
        surface.unit_point_of(Number::variable(x, 1, 0), Number::variable(y, 0, 1), far_side);
    Number u, v;
    texture_point(m_mapping, p[0], p[1], p[2], u, v);
    const Size size = m_source.size(0);
    u = u * double(size.width);
    v = v * double(size.height);
    const Jacobian jacobian{u.c[1], v.c[1], u.c[2], v.c[2]};
    // Half of what the pixel covers, at least a texel and at most a quarter of the picture.
    const auto reach = [](double across, double down, int texels) {
        return std::clamp(0.5 * (std::fabs(across) + std::fabs(down)), 1.0, std::max(1.0, texels / 4.0));
    };
    const double by_u = reach(u.c[1], u.c[2], size.width), by_v = reach(v.c[1], v.c[2], size.height);
    double left, right, above, below;
    if (!(height(jacobian, u.value() - by_u, v.value(), left) &&
          height(jacobian, u.value() + by_u, v.value(), right) &&
          height(jacobian, u.value(), v.value() - by_v, above) &&
          height(jacobian, u.value(), v.value() + by_v, below)))
        return glm::dvec3(0.0);
    const std::array<glm::dvec3, 2> along =
        gradients_of(m_mapping, {p[0].value(), p[1].value(), p[2].value()});
    const glm::dvec3 slope = (right - left) / (2 * by_u) * size.width * along[0] +
                             (below - above) / (2 * by_v) * size.height * along[1];
    return std::isfinite(slope.x + slope.y + slope.z) ? slope : glm::dvec3(0.0);
}

}  // namespace anamorph::figure
