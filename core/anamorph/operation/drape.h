// SPDX-License-Identifier: Apache-2.0
// The operation drape: a picture laid on a surface in space.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "anamorph/operation/operation.h"

namespace anamorph {

const Operation& drape_operation();

/// Directions of length 1, from three numbers for each light. Throws Error naming `light`.
std::vector<glm::dvec3> drape_lights(const std::vector<double>& numbers);

}  // namespace anamorph
