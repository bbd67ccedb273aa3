// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <string_view>

namespace anamorph::figure {

/// The properties of a chemical element that are drawn.
struct ChemicalElement {
    double covalent_radius;  ///< Angstrom; Cordero et al., Dalton Trans. 2008
    glm::dvec3 color;        ///< 0 to 255
};

/// The element with a symbol; null where there is none. D is deuterium.
const ChemicalElement* find_element(std::string_view symbol);

}  // namespace anamorph::figure
