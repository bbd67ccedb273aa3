// SPDX-License-Identifier: Apache-2.0
#include "recipe.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "anamorph/file_names.h"
#include "buffer_store.h"

namespace anamorph {
namespace {

namespace fs = std::filesystem;

std::string_view base_of(std::string_view name) {
    return name.substr(0, name.find('?'));
}

/// The text of a recipe file; none where there is no such file.
bool read_recipe_file(const std::string& path, std::string& text) {
    std::error_code failure;
    const fs::file_status status = fs::status(path, failure);
    if (!fs::exists(status)) return false;
    const std::string what = "recipe \"" + printable(path) + "\"";
    if (!fs::is_regular_file(status)) throw Error(what + " is not a file");
    const std::uintmax_t size = fs::file_size(path, failure);
    if (failure || size > kMaxRecipeBytes)
        throw Error(what + " has " + std::to_string(size) + " bytes: must have at most " +
                    std::to_string(kMaxRecipeBytes));
    std::ifstream file(path, std::ios::binary);
    text.resize(static_cast<std::size_t>(size));
    if (!file || (size > 0 && !file.read(text.data(), static_cast<std::streamsize>(size))))
        throw Error(what + " cannot be read");
    return true;
}

/// "a/./b.pano?x=1" and "a/b.pano?x=1" are one.
std::string normal(const std::string& name) {
    const std::string_view base = base_of(name);
    return fs::path(base).lexically_normal().string() + name.substr(base.size());
}

/// A path without "." and empty parts, which mean nothing; ".." is kept, since a link may stand before it.
std::string without_detours(std::string_view path) {
    std::string out = path.starts_with('/') ? "/" : "";
    while (!path.empty()) {
        const std::size_t slash = path.find('/');
        const std::string_view part = path.substr(0, slash);
        path.remove_prefix(slash == std::string_view::npos ? path.size() : slash + 1);
        if (part.empty() || part == ".") continue;
        if (!out.empty() && out.back() != '/') out += '/';
        out += part;
    }
    return out;
}

std::string state_of(const std::string& name) {
    struct stat s {};
    std::string state = normal(name) + "\n";
    if (has_extension(name, kBufferExtension)) return state + std::to_string(buffer_generation(name)) + "\n";
    if (::stat(std::string(base_of(name)).c_str(), &s) != 0) return state;
    for (const auto number : {std::int64_t(s.st_ino), std::int64_t(s.st_size), std::int64_t(s.st_mtim.tv_sec),
                              std::int64_t(s.st_mtim.tv_nsec)})
        state += std::to_string(number) + " ";
    return state + "\n";
}

/// The values of a recipe, and the files that they name; nothing is known of those yet.
Recipe read_recipe(const Operation& operation, const std::string& name,
                   const std::vector<Assignment>& config) {
    RecipeName parsed = parse_recipe_name(name);
    parsed.base = without_detours(parsed.base);
    Recipe recipe{&operation, ParameterValues(*operation.parameters), {}, {}};
    // Takes the values of one place; files there are relative to `folder`.
    const auto take = [&](const std::vector<Assignment>& place, const fs::path& folder) {
        ParameterValues own(*operation.parameters);
        own.assign(place);
        for (const Parameter& p : *operation.parameters) {
            if ((p.type != ParameterType::image && p.type != ParameterType::file) || !own.given(p.name))
                continue;
            const std::string& file = own.text(p.name);
            const bool in_memory = has_extension(file, kBufferExtension);
            const std::string path = (folder / std::string(base_of(file))).string();
            recipe.files[p.name].name =
                in_memory ? file : without_detours(path) + file.substr(base_of(file).size());
        }
        recipe.values.assign(place);
    };
    std::string text;
    if (read_recipe_file(parsed.base, text)) {
        try {
            take(parse_recipe(text), fs::path(parsed.base).parent_path());
        } catch (const Error& e) {
            throw Error("recipe \"" + printable(parsed.base) + "\": " + e.what());
        }
    }
    take(parsed.assignments, {});
    take(config, {});
    const bool draws_one = !operation.sources.empty();
    if (draws_one && !recipe.files.count(operation.sources[0]))
        recipe.files[operation.sources[0]].name =
            parsed.base.substr(0, parsed.base.size() - operation.name.size() - 1);
    for (const auto& [key, file] : recipe.files) check_file_name(key, file.name);
    return recipe;
}

}  // namespace

bool has_extension(std::string_view name, std::string_view extension) {
    const std::string_view base = base_of(name);
    if (base.size() <= extension.size()) return false;
    const std::string_view end = base.substr(base.size() - extension.size());
    return std::equal(end.begin(), end.end(), extension.begin(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

const Operation* operation_of(std::string_view name) {
    for (const Operation* operation : operations())
        if (has_extension(name, "." + operation->name)) return operation;
    return nullptr;
}

Recipe RecipeReader::load(const std::string& name, const std::vector<Assignment>& config) {
    const Operation* operation = operation_of(name);
    if (!operation) throw Error("\"" + printable(name) + "\" is not a recipe's name");
    Recipe recipe = config.empty() && m_nested.count(normal(name)) ? m_nested.at(normal(name))
                                                                   : read_recipe(*operation, name, config);
    recipe.identity = operation->name + "\n" + recipe.values.key();
    for (auto& [key, file] : recipe.files) {
        m_way = {normal(name)};
        file.identity = identity_of(file.name);
        recipe.identity += key + "=" + file.name + "\n" + file.identity;
    }
    return recipe;
}

const Recipe& RecipeReader::nested(const Operation& operation, const std::string& name) {
    const auto found = m_nested.find(normal(name));
    if (found != m_nested.end()) return found->second;
    if (m_nested.size() >= kMaxRecipes)
        throw Error("recipe \"" + printable(m_way.front()) + "\" reads from more than " +
                    std::to_string(kMaxRecipes) + " others: must be at most so many");
    return in_recipe(name, [&]() -> const Recipe& {
        return m_nested.emplace(normal(name), read_recipe(operation, name, {})).first->second;
    });
}

/// The states of a file and of all that it is made of.
const std::string& RecipeReader::identity_of(const std::string& file) {
    const auto found = m_identities.find(normal(file));
    if (found != m_identities.end()) return found->second;
    m_seen.clear();
    m_identity.clear();
    visit(file);
    return m_identities.emplace(normal(file), m_identity).first->second;
}

/// Walks the files that a file is made of, each once.
void RecipeReader::visit(const std::string& file) {
    const std::string name = normal(file);
    const Operation* operation = operation_of(file);
    const bool again = std::find(m_way.begin(), m_way.end(), name) != m_way.end();
    m_way.push_back(name);
    if (operation && again) {
        std::string cycle;
        for (const std::string& n : m_way) cycle += (cycle.empty() ? "" : " -> ") + printable(n);
        throw Error("recipes read each other: " + cycle);
    }
    if (operation && static_cast<int>(m_way.size()) > kMaxDepth)
        throw Error("recipes nest too deep: must be at most " + std::to_string(kMaxDepth));
    if (m_seen.insert(name).second) {
        const auto [state, is_new] = m_states.try_emplace(name);
        if (is_new) state->second = state_of(file);
        m_identity += state->second;
        if (operation)
            for (const auto& [key, used] : nested(*operation, file).files) visit(used.name);
    }
    m_way.pop_back();
}

}  // namespace anamorph
