// SPDX-License-Identifier: Apache-2.0
// The light on a body: the formula of RASEL, and the usual two.
//
// Directions are the observer's: x right, y up, z away. With the unit normal n, the unit direction l towards
// the light, that towards the eye v, and the ambient share A, a colour is multiplied by
//     rasel     A + (1 - A) (1 + n.l) / 2                   (Chapman 1986, section 2.9, with l = (0, 1, 0))
//     lambert   A + (1 - A) max(0, n.l)
//     blinn     the same, and specular max(0, n.h)^shininess of white is added, h = (l + v) / |l + v|.
// To what multiplies the colour a random number may be added (perturbation.h); it stays within 0 to 1.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace anamorph::figure {

/// The formulas of the intensity.
enum class Lighting { rasel, lambert, blinn };

/// How bodies are lit.
struct Light {
    Lighting lighting = Lighting::rasel;
    glm::dvec3 toward{0, 1, 0};  ///< the direction to the light, of length 1
    double ambient = 0.3;        ///< 0 to 1
    double specular = 0.3, shininess = 30;
};

/// The default direction to the light: from above, as RASEL has it, or from in front of the figures, over the
/// observer's left shoulder.
inline glm::dvec3 usual_light(Lighting lighting) {
    return lighting == Lighting::rasel ? glm::dvec3(0, 1, 0) : glm::normalize(glm::dvec3(-1, 2, -2));
}

/// A colour from 0 to 1 as it is lit and seen where the surface has the unit normal `n` and the eye is in the unit
/// direction `v`. `perturbation` is added to the intensity.
inline glm::dvec3 lit(const glm::dvec3& color, const Light& light, const glm::dvec3& n, const glm::dvec3& v,
                      double perturbation = 0) {
    const double cosine = glm::dot(n, light.toward);
    const double direct = light.lighting == Lighting::rasel ? 0.5 * (1 + cosine) : std::max(0.0, cosine);
    double intensity = light.ambient + (1 - light.ambient) * direct;
    if (perturbation != 0) intensity = std::clamp(intensity + perturbation, 0.0, 1.0);
    // One variable, which is what is returned: a copy of it would wait for its three numbers at every pixel.
    glm::dvec3 seen = color * intensity;
    if (light.lighting == Lighting::blinn && cosine > 0) {
        const glm::dvec3 half = light.toward + v;
        const double length = glm::length(half);
        const double glance = length > 0 ? std::max(0.0, glm::dot(n, half) / length) : 0;
        if (length > 0) seen += glm::dvec3(light.specular * std::pow(glance, light.shininess));
    }
    return seen;
}

}  // namespace anamorph::figure
