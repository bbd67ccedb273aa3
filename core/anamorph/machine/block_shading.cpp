// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/block_shading.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace anamorph::machine {

using surface::DrapeShading;
using surface::Light;
using surface::LitPoint;

BlockShading::BlockShading(const BlockMachine& machine, std::shared_ptr<const surface::DrapedSurface> surface,
                           const surface::Camera& camera, const Size& picture, const MachineBlocks& blocks,
                           const surface::DrapeLighting& lighting)
    : m_coordinates(machine.coordinates),
      m_surface(std::move(surface)),
      m_camera(camera),
      m_picture(picture),
      m_centres(&blocks.centres()),
      m_lighting(lighting),
      m_side(machine.block),
      m_unit(std::ldexp(1.0, -machine.light_bits)),
      m_numbers(m_centres->size() * numbers()),
      m_lit(std::make_unique<OnceEach>(m_centres->size())) {}

/// Finds the light of blocks.
void BlockShading::light_blocks(std::size_t first, std::size_t end) const {
    const Rounding rounded{m_coordinates};
    const double side_u = std::min(m_side, double(m_picture.width)),
                 side_v = std::min(m_side, double(m_picture.height));
    const auto lit = [&](double u, double v) {
        return lit_point(*m_surface, m_camera, u / m_picture.width, v / m_picture.height);
    };
    for (std::size_t i = first; i < end; ++i) {
        const Point<double>& c = (*m_centres)[i];
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
            m_numbers[i * numbers() + k] = {rounded(here[k]), gain(left[k], right[k], side_u),
                                            gain(above[k], below[k], side_v)};
    }
}

std::array<double, BlockShading::kMostNumbers> BlockShading::numbers_at(const LitPoint& point) const {
    if (m_lighting.shading == DrapeShading::gouraud) {
        const Light light = light_at(m_lighting, point);
        return {double(light.share), double(light.highlight)};
    }
    return {point.normal.x, point.normal.y, point.normal.z, point.ray.x, point.ray.y, point.ray.z};
}

double BlockShading::value(std::size_t block, std::size_t number, const Point<double>& address) const {
    const Linear& l = m_numbers[block * numbers() + number];
    const Point<double>& centre = (*m_centres)[block];
    return l.centre + (address.x - centre.x) * l.by_u + (address.y - centre.y) * l.by_v;
}

Light BlockShading::at(std::int32_t block, const Point<double>& address) const {
    const auto at = static_cast<std::size_t>(block);
    m_lit->ask(at, [&](std::size_t first, std::size_t end) { light_blocks(first, end); });
    const auto number = [&](std::size_t k) { return value(at, k, address); };
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
