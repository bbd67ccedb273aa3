// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/lighting.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace anamorph::surface {

LitPoint lit_point(const DrapedSurface& surface, const Camera& camera, double u, double v) {
    const SurfaceFrame frame = surface.frame(u, v);
    const glm::dvec3 across = glm::cross(camera.turned(frame.by_u), camera.turned(frame.by_v));
    const glm::dvec3 ray = camera.ray_to(camera.in_frame(frame.position));
    const double length = glm::length(across);
    const double inverse = length > 0 ? (glm::dot(across, ray) > 0 ? -1 : 1) / length : 0;
    return {camera.in_space(across * inverse), camera.in_space(ray)};
}

Light light_at(const DrapeLighting& l, const LitPoint& point) noexcept {
    double diffuse = 0, specular = 0;
    for (const glm::dvec3& to_light : l.lights) {
        const double facing = glm::dot(point.normal, to_light);
        if (!(facing > 0)) continue;
        diffuse += facing;
        const glm::dvec3 middle = to_light - point.ray;
        const double length = glm::length(middle);
        if (l.specular > 0 && length > 0)
            specular += std::pow(std::max(0.0, glm::dot(point.normal, middle) / length), l.shininess);
    }
    return {static_cast<float>(l.ambient + l.diffuse * diffuse), static_cast<float>(l.specular * specular)};
}

void add_light(const Light& light, float* pixel, int channels, int alpha, bool multiplied) noexcept {
    const float highlight = alpha >= 0 && multiplied ? light.highlight * pixel[alpha] : light.highlight;
    for (int c = 0; c < channels; ++c)
        if (c != alpha) pixel[c] = pixel[c] * light.share + highlight;
}

}  // namespace anamorph::surface
