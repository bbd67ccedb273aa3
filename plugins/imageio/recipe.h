// SPDX-License-Identifier: Apache-2.0
// Recipes as files and names: where the values come from, and which files they lead to.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "anamorph/operation.h"
#include "anamorph/parameter.h"

namespace anamorph {

/// Is the part before the first `?` a name that ends in `extension` (".pano"), in any case of letters?
bool has_extension(std::string_view name, std::string_view extension);
constexpr std::string_view kBufferExtension = ".anabuf";

/// The operation whose recipes have such a name, or null.
const OperationKind* kind_of(std::string_view name);

struct Recipe {
    const OperationKind* kind;
    ParameterValues values;
    /// The sources and side files by key, each with the folder it stands in. Identities tell states of the
    /// file, and of all that it is made of where it is a recipe, apart: names, times of writing (ns), sizes.
    SideFiles files;
};

/// The recipe file if there is one, overridden by the name's arguments, overridden by `config`. A relative
/// file name in a file is relative to that file's folder, else to the working folder; the first source is by
/// default the recipe's name without its extension. Follows the recipes that the recipe reads from. Throws
/// Error, also on a cycle and beyond kMaxDepth.
Recipe load_recipe(const std::string& name, const std::vector<Assignment>& config = {});
constexpr int kMaxDepth = 16;

}  // namespace anamorph
