// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/image/solid_texture.h"

#include <algorithm>
#include <cmath>

#include "anamorph/number/formula_program.h"

namespace anamorph::figure {
namespace {

SolidText shades_of(const std::string& share, const std::string& let) {
    return {"own_red*" + share, "own_green*" + share, "own_blue*" + share, let};
}

SpaceFormula half_of(const SolidLook& look, const Body& body, int frame, bool behind) {
    SolidSetting setting;
    for (int k = 0; k < 3; ++k) {
        setting.axes[static_cast<std::size_t>(k)] = body.shape.axes[k];
        setting.own[static_cast<std::size_t>(k)] = body.color[k] / 255;
    }
    setting.scale = look.scale;
    setting.frame = frame;
    setting.behind = behind;
    return parse_solid(look.text, setting);
}

}  // namespace

const std::vector<SolidPreset>& solid_presets() {
    // Years of a trunk along y that leans and is not quite round: light in spring, darker to autumn, which ends within an eighth.
    static const std::string rings =
        "X=x/scale;Y=y/scale;Z=z/scale;"
        "a=X+0.1*Y+0.08*sin(4*Y+1)+0.3;b=Z+0.06*sin(5*Y)+0.2;"
        "d=8*sqrt(a*a+b*b+1e-6)+0.15*sin(9*a)*sin(7*b);"
        "f=d-floor(d);w=smoothstep(0.1,0.85,f)*(1-smoothstep(0.875,1,f))";
    // Veins where a sum of planes that waves bend is nearest to a whole number of turns (Perlin 1985 bends by noise, this by sines).
    static const std::string veins =
        "X=x/scale;Y=y/scale;Z=z/scale;"
        "n=sin(2.3*X+3.1*Y+1.7*Z)+0.5*sin(5.9*Y-4.7*Z+1.3*X+1)+0.25*sin(11.1*Z+9.3*X+2)+0.125*sin(21.7*X-19."
        "3*Y);"
        "w=(0.5+0.5*cos(2*pi*(X+1.5*Y+0.35*n)))^6";
    static const std::string cubes = "c=floor(2*x/scale)+floor(2*y/scale)+floor(2*z/scale);w=mod(c,2)";
    static const std::vector<SolidPreset> presets = {
        {"wood", "rings about the y axis, eight to a scale", shades_of("(1-0.55*w)", rings)},
        {"marble", "veins, one to a scale", shades_of("(1-0.75*w)", veins)},
        {"checker", "cubes of half a scale", shades_of("(1-0.6*w)", cubes)}};
    return presets;
}

SolidTexture::SolidTexture(const SolidLook& look, const Body& body, int frame)
    : m_halves{half_of(look, body, frame, false), half_of(look, body, frame, true)},
      m_own(body.color / 255.0),
      m_samples(look.samples) {}

glm::dvec3 SolidTexture::color_at(const glm::dvec3& unit) const {
    const SpaceFormula& half = m_halves[unit.z < 0 ? 0 : 1];
    const double below = 1 + std::fabs(unit.z), s = unit.x / below, t = unit.y / below;
    if (!half.is_everywhere && !(read_program<1>(half.domain, s, t)[0] > 0)) return m_own;
    const std::array<double, 3> color = read_program<3>(half.point, s, t);
    // Written so that what is no number is the body's own.
    if (!std::isfinite(color[0] + color[1] + color[2])) return m_own;
    return {std::clamp(color[0], 0.0, 1.0), std::clamp(color[1], 0.0, 1.0), std::clamp(color[2], 0.0, 1.0)};
}

glm::dvec3 SolidTexture::color(const SeenSurface& surface, double x, double y, bool far_side,
                               double side) const {
    glm::dvec3 sum(0.0);
    const double step = side / m_samples, first = 0.5 * (step - side);
    for (int j = 0; j < m_samples; ++j)
        for (int i = 0; i < m_samples; ++i)
            sum += color_at(surface.unit_point(x + first + i * step, y + first + j * step, far_side));
    return sum / double(m_samples * m_samples);
}

}  // namespace anamorph::figure
