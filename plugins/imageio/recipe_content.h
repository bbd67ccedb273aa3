// SPDX-License-Identifier: Apache-2.0
// The picture of a recipe.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "anamorph/parameter/parameter.h"
#include "content.h"

namespace anamorph {

/// Opens a recipe: reads it, the files that it names besides its sources, and the sources' headers; pixels
/// are read when they are asked for, through OpenImageIO's shared cache. What is solved for a recipe is kept
/// for the process. Throws Error.
std::shared_ptr<const Content> open_recipe(const std::string& name, const std::vector<Assignment>& config);

}  // namespace anamorph
