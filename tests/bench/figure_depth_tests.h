// SPDX-License-Identifier: Apache-2.0
// What one would write first to hide the lines of figures: points of every limb, each against all ellipsoids.
#pragma once

#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <vector>

#include "anamorph/figure/outline/outline.h"

namespace anamorph::bench {

/// Of how many of `samples` points of each limb does an ellipsoid lie before? Orthographic, along z of the view.
inline std::int64_t hidden_samples(const std::vector<figure::Ellipsoid>& bodies, const figure::View& view,
                                   int samples) {
    figure::OutlineOptions options;
    options.hide = false;
    const figure::Outlines limbs = figure::outlines(bodies, view, options);
    const glm::dvec3 ray = glm::transpose(view.rotation)[2];
    std::int64_t hidden = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i)
        for (int k = 0; k < samples; ++k) {
            const glm::dvec3 p = limbs.bodies[i].limb(2 * std::numbers::pi * k / samples);
            for (std::size_t j = 0; j < bodies.size(); ++j) {
                if (j == i) continue;
                const glm::dmat3 own = glm::transpose(bodies[j].rotation);
                const glm::dvec3 u = own * (p - bodies[j].center) / bodies[j].axes,
                                 v = own * ray / bodies[j].axes;
                const double a = glm::dot(v, v), b = glm::dot(u, v), c = glm::dot(u, u) - 1;
                if (b * b > a * c && -b - std::sqrt(b * b - a * c) < 0) {
                    ++hidden;
                    break;
                }
            }
        }
    return hidden;
}

}  // namespace anamorph::bench
