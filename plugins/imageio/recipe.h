// SPDX-License-Identifier: Apache-2.0
// Recipes as files and names: the source of their values, and the files that they lead to.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/file_names.h"
#include "anamorph/operation/operation.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {

inline constexpr std::string_view kBufferExtension = ".anabuf";

/// Runs `body`; where it throws an Error that does not name the recipe, the recipe is named in front.
template <class Body>
decltype(auto) in_recipe(std::string_view name, const Body& body) {
    try {
        return body();
    } catch (const Error& e) {
        const std::string base = printable(name.substr(0, name.find('?'))), what = e.what();
        if (what.find(base) != std::string::npos) throw;
        throw Error("in \"" + base + "\": " + what);
    }
}

struct Recipe {
    const Operation* operation;
    ParameterValues values;
    /// The sources and side files by key, each with the folder it stands in. Identities tell apart the states
    /// of the file, and of all that it is made of where it is a recipe: names, times of writing (ns), sizes.
    SideFiles files;
    std::vector<std::string> linked_images;  ///< keys of files that are drawn as well, in their order
    std::string identity;  ///< values, and identities of files: where it is the same, pictures are
};

/// Recipes as one reading from outside finds them: no file of theirs is read twice, nor looked at twice.
class RecipeReader {
  public:
    /// Loads the recipe file if there is one, overridden by the name's arguments, overridden by `config`. A
    /// relative file name in a file is relative to that file's folder, else to the working folder; the first
    /// source is by default the recipe's name without its extension; a name may also be that of a file that
    /// an operation draws as it stands. Follows the recipes that the recipe reads from. Throws Error, also on
    /// a cycle, and beyond kMaxDepth and kMaxRecipes.
    Recipe load(const std::string& name, const std::vector<Assignment>& config = {});

  private:
    const Recipe& nested(const Operation& operation, const std::string& name);
    const std::string& identity_of(const SideFile& file);
    void visit(const SideFile& file);

    std::map<std::string, Recipe> m_nested;           ///< recipes that others read from, by name
    std::map<std::string, std::string> m_identities;  ///< identities of files, by name
    std::map<std::string, std::string> m_states;      ///< states of files, by name
    // Members of the walk through what one file is made of:
    std::vector<std::string> m_way;  ///< the recipes that lead to the file
    std::set<std::string> m_seen;
    std::string m_identity;
};
inline constexpr int kMaxDepth = 16;     ///< the most recipes that read from each other, one from the next
inline constexpr int kMaxRecipes = 100;  ///< the most recipes that one reads from, directly or not

}  // namespace anamorph
