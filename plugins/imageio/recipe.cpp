// SPDX-License-Identifier: Apache-2.0
#include "recipe.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "anamorph/file_names.h"
#include "anamorph/operation/face_files.h"
#include "anamorph/side_files.h"
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

/// A path without "." and empty parts, which mean nothing, unless there is no other; ".." is kept, since a link may stand
/// before it.
std::string without_detours(std::string_view path) {
    std::string out = path.starts_with('/') ? "/" : "";
    const bool is_empty = path.empty();
    while (!path.empty()) {
        const std::size_t slash = path.find('/');
        const std::string_view part = path.substr(0, slash);
        path.remove_prefix(slash == std::string_view::npos ? path.size() : slash + 1);
        if (part.empty() || part == ".") continue;
        if (!out.empty() && out.back() != '/') out += '/';
        out += part;
    }
    return out.empty() && !is_empty ? "." : out;
}

std::string state_of(const std::string& name) {
    const bool in_memory = has_extension(name, kBufferExtension);
    return normal(name) + "\n" +
           (in_memory ? std::to_string(buffer_generation(name)) : file_state(std::string(base_of(name)))) +
           "\n";
}

/// Where the source's name is none of a file, but stands for six: finds them.
void find_faces(Recipe& recipe, const std::string& key) {
    SideFile& source = recipe.files[key];
    const auto exists = [](const std::string& name) { return side_file_reader().exists(name); };
    if (!has_face(source.name) || operation_of(source.name) || exists(source.name)) return;
    auto faces = std::make_shared<FaceFiles>(find_face_files(key, source.name, recipe.values, exists));
    std::transform(faces->names.begin(), faces->names.end(), faces->identities.begin(), state_of);
    source.faces = std::move(faces);
}

/// The values of a recipe, and the files that they name; nothing is known of those yet.
Recipe read_recipe(const Operation& operation, const std::string& name,
                   const std::vector<Assignment>& config) {
    RecipeName parsed = parse_recipe_name(name);
    parsed.base = without_detours(parsed.base);
    Recipe recipe{&operation, ParameterValues(*operation.parameters), {}, {}, {}};
    // Takes the values of one place; files there are relative to `folder`.
    const auto take = [&](const std::vector<Assignment>& place, const fs::path& folder) {
        ParameterValues own(*operation.parameters);
        own.assign(place);
        for (const auto& [key, file, image] : operation.named_files(own)) {
            const bool in_memory = has_extension(file, kBufferExtension);
            const std::string path = (folder / std::string(base_of(file))).string();
            recipe.files[key] = {in_memory ? file : without_detours(path) + file.substr(base_of(file).size()),
                                 "", image};
        }
        recipe.values.assign(place);
    };
    // A name may be that of the file that is drawn.
    const bool as_it_stands = ends_as_main_file(operation, parsed.base);
    std::string text;
    if (!as_it_stands && read_recipe_file(parsed.base, text)) {
        try {
            take(parse_recipe(text), fs::path(parsed.base).parent_path());
        } catch (const Error& e) {
            throw Error("recipe \"" + printable(parsed.base) + "\": " + e.what());
        }
    }
    take(parsed.assignments, {});
    take(config, {});
    if (as_it_stands) {
        if (recipe.values.given(operation.main_file))
            throw Error(operation.main_file, printable(recipe.values.text(operation.main_file)),
                        "must not be given with the name of a file that is drawn itself");
        recipe.files[operation.main_file].name = parsed.base;
    }
    const std::string first = operation.sources.empty() ? operation.main_file : operation.sources[0];
    if (!first.empty() && !recipe.files.count(first)) {
        const std::string source = parsed.base.substr(0, parsed.base.size() - operation.name.size() - 1);
        recipe.files[first] = {source, "", !operation.sources.empty()};
        // A name without keys and without a picture's ending was meant to be a file's.
        if (name == parsed.base && !fs::path(source).has_extension() && !side_file_reader().exists(source))
            throw Error("there is no recipe \"" + printable(name) + "\", and the source \"" +
                        printable(source) + "\" does not exist");
    }
    if (!operation.gathering_file(recipe.files).empty()) recipe.files.at(first).image = false;
    for (const auto& [key, file] : recipe.files) check_file_name(key, file.name);
    if (operation.reads_faces) find_faces(recipe, first);
    if (operation.linked)
        for (const LinkedFile& file :
             operation.linked(recipe.values, recipe.files, KeyedFileReader(recipe.files))) {
            check_file_name(file.key, file.name);
            recipe.files[file.key] = {file.name, "", file.image};
            if (file.image) recipe.linked_images.push_back(file.key);
        }
    return recipe;
}

}  // namespace

Recipe RecipeReader::load(const std::string& name, const std::vector<Assignment>& config) {
    const Operation* operation = operation_of(name);
    if (!operation) throw Error("\"" + printable(name) + "\" is not a recipe's name");
    Recipe recipe = config.empty() && m_nested.count(normal(name)) ? m_nested.at(normal(name))
                                                                   : read_recipe(*operation, name, config);
    recipe.identity = operation->name + "\n" + recipe.values.key();
    for (auto& [key, file] : recipe.files) {
        m_way = {normal(name)};
        file.identity = identity_of(file);
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
const std::string& RecipeReader::identity_of(const SideFile& file) {
    const std::string known = (file.image ? "image " : "file ") + normal(file.name);
    const auto found = m_identities.find(known);
    if (found != m_identities.end()) return found->second;
    m_seen.clear();
    m_identity.clear();
    visit(file);
    return m_identities.emplace(known, m_identity).first->second;
}

/// Walks the files that a file is made of, each once.
void RecipeReader::visit(const SideFile& file) {
    const std::string name = normal(file.name);
    const Operation* operation = file.image ? operation_of(file.name) : nullptr;
    const bool again = std::find(m_way.begin(), m_way.end(), name) != m_way.end();
    m_way.push_back(name);
    if (operation && again) {
        std::string cycle;
        for (const std::string& n : m_way) cycle += (cycle.empty() ? "" : " -> ") + printable(n);
        throw Error("recipes read each other: " + cycle);
    }
    if (operation && static_cast<int>(m_way.size()) > kMaxDepth)
        throw Error("recipes nest too deep: must be at most " + std::to_string(kMaxDepth));
    if (m_seen.insert((operation ? "recipe " : "") + name).second) {
        const auto [state, is_new] = m_states.try_emplace(name);
        if (is_new) state->second = state_of(file.name);
        m_identity += state->second;
        if (file.faces)
            for (const std::string& identity : file.faces->identities) m_identity += identity;
        if (operation)
            for (const auto& [key, used] : nested(*operation, file.name).files) visit(used);
    }
    m_way.pop_back();
}

}  // namespace anamorph
