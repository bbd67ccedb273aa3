// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/block_shading.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace anamorph::machine {

using surface::DrapeShading;
using surface::Light;
using surface::LitPoint;

BlockShading::BlockShading(const BlockMachine& machine, const surface::DrapedSurface& surface,
                           const surface::Camera& camera, const Size& picture, const BlockFrame& frame,
                           const surface::DrapeLighting& lighting)
    : m_lighting(lighting), m_unit(std::ldexp(1.0, -machine.light_bits)), m_centres(frame.centres) {
    const Rounding rounded{machine.coordinates};
    const double side_u = std::min(machine.block, double(picture.width)),
                 side_v = std::min(machine.block, double(picture.height));
    const auto lit = [&](double u, double v) {
        return lit_point(surface, camera, u / picture.width, v / picture.height);
    };
    m_numbers.reserve(m_centres.size() * numbers());
    for (const Point<double>& c : m_centres) {
        const LitPoint centre = lit(c.x, c.y);
        const auto beside = [&](double u, double v) {
            LitPoint at = lit(u, v);
            if (glm::dot(at.normal, centre.normal) < 0) at.normal = -at.normal;
            return numbers_at(at);
        };
        const auto here = numbers_at(centre), left = beside(c.x - side_u, c.y),
                   right = beside(c.x + side_u, c.y), above = beside(c.x, c.y - side_v),
                   below = beside(c.x, c.y + side_v);
        const auto gain = [&](double before, double after, double side) {
            return rounded(rounded(rounded(after) - rounded(before)) / rounded(2 * side));
        };
        for (std::size_t k = 0; k < numbers(); ++k)
            m_numbers.push_back(
                {rounded(here[k]), gain(left[k], right[k], side_u), gain(above[k], below[k], side_v)});
    }
}

std::array<double, BlockShading::kMostNumbers> BlockShading::numbers_at(const LitPoint& point) const {
    if (m_lighting.shading == DrapeShading::gouraud) {
        const Light light = light_at(m_lighting, point);
        return {double(light.share), double(light.highlight)};
    }
    return {point.normal.x, point.normal.y, point.normal.z, point.ray.x, point.ray.y, point.ray.z};
}

double BlockShading::value(std::int32_t block, std::size_t number, const Point<double>& address) const {
    const auto at = static_cast<std::size_t>(block);
    const Linear& l = m_numbers[at * numbers() + number];
    return l.centre + (address.x - m_centres[at].x) * l.by_u + (address.y - m_centres[at].y) * l.by_v;
}

Light BlockShading::at(std::int32_t block, const Point<double>& address) const {
    const auto number = [&](std::size_t k) { return value(block, k, address); };
    const auto direction = [&](std::size_t k) {
        const glm::dvec3 to(number(k), number(k + 1), number(k + 2));
        const double length = glm::length(to);
        return length > 0 ? to / length : to;
    };
    const auto stored = [&](double light) {
        return static_cast<float>(std::max(0.0, std::nearbyint(light / m_unit) * m_unit));
    };
    if (m_lighting.shading == DrapeShading::gouraud) return {stored(number(0)), stored(number(1))};
    const Light light = light_at(m_lighting, {direction(0), direction(3)});
    return {stored(double(light.share)), stored(double(light.highlight))};
}

OperationCounts cost_of(const surface::DrapeLighting& lighting) {
    if (lighting.shading == DrapeShading::none) return {};
    const bool shines = lighting.specular > 0;
    OperationCounts cost{12, 1, 1};
    if (lighting.shading == DrapeShading::phong) {
        // Differences of a normal, and of a direction where highlights depend on it.
        cost.products += 2 * (shines ? 6 : 3);
        return cost;
    }
    const int lights = static_cast<int>(lighting.lights.size());
    cost += {3 * lights, 0, 0};
    if (shines) cost += {6 * lights, lights, 2 * lights};
    cost.products += 2 * (shines ? 2 : 1);
    return cost;
}

}  // namespace anamorph::machine
