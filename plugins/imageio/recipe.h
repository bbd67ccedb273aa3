// SPDX-License-Identifier: Apache-2.0
// Recipes as files and names: where the values come from, and which sources they lead to.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "anamorph/parameter.h"

namespace anamorph {

/// Is the part before the first `?` a name that ends in `extension` (".pano"), in any case of letters?
bool has_extension(std::string_view name, std::string_view extension);
constexpr std::string_view kRecipeExtension = ".pano";
constexpr std::string_view kBufferExtension = ".anabuf";

struct Recipe {
    std::string source;
    ParameterValues values;
};

/// The recipe file if there is one, overridden by the name's arguments, overridden by `config`. A relative
/// `src` of a file is relative to that file's folder, else to the working folder; `src` is by default the
/// file's name without its extension. Reads nothing but the recipe file. Throws Error.
Recipe load_recipe(const std::string& name, const std::vector<Assignment>& config = {});

/// Follows the recipes that a recipe reads from. Throws Error on a cycle and beyond kMaxDepth. The result
/// tells states of the last source, and of all recipes on the way, apart: names, times of writing (ns),
/// sizes.
std::string source_identity(const std::string& name, const Recipe& recipe);
constexpr int kMaxDepth = 16;

}  // namespace anamorph
