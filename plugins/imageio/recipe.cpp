// SPDX-License-Identifier: Apache-2.0
#include "recipe.h"

#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "anamorph/image/reproject_parameters.h"
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
        throw Error(what + " has " + std::to_string(size) + " bytes: allowed are at most " +
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

}  // namespace

bool has_extension(std::string_view name, std::string_view extension) {
    const std::string_view base = base_of(name);
    if (base.size() <= extension.size()) return false;
    const std::string_view end = base.substr(base.size() - extension.size());
    return std::equal(end.begin(), end.end(), extension.begin(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

Recipe load_recipe(const std::string& name, const std::vector<Assignment>& config) {
    const RecipeName parsed = parse_recipe_name(name);
    Recipe recipe{"", ParameterValues(reproject_parameters())};
    std::string text;
    if (read_recipe_file(parsed.base, text)) {
        std::vector<Assignment> lines;
        try {
            lines = parse_recipe(text);
            recipe.values.assign(lines);
        } catch (const Error& e) {
            throw Error("recipe \"" + printable(parsed.base) + "\": " + e.what());
        }
        if (recipe.values.given("src")) {
            const std::string& src = recipe.values.text("src");
            const bool in_memory = has_extension(src, kBufferExtension);
            recipe.source = in_memory ? src : (fs::path(parsed.base).parent_path() / src).string();
        }
    }
    for (const auto* place : {&parsed.assignments, &config}) {
        ParameterValues own(reproject_parameters());
        own.assign(*place);
        if (own.given("src")) recipe.source = own.text("src");
        recipe.values.assign(*place);
    }
    if (recipe.source.empty())
        recipe.source = parsed.base.substr(0, parsed.base.size() - kRecipeExtension.size());
    return recipe;
}

std::string source_identity(const std::string& name, const Recipe& recipe) {
    std::vector<std::string> names = {normal(name)};
    std::string identity, source = recipe.source;
    while (true) {
        identity += state_of(source);
        if (!has_extension(source, kRecipeExtension)) return identity;
        const bool again = std::find(names.begin(), names.end(), normal(source)) != names.end();
        names.push_back(normal(source));
        if (again) {
            std::string cycle;
            for (const std::string& n : names) cycle += (cycle.empty() ? "" : " -> ") + printable(n);
            throw Error("recipes read each other: " + cycle);
        }
        if (static_cast<int>(names.size()) > kMaxDepth)
            throw Error("recipes nest too deep: allowed are " + std::to_string(kMaxDepth));
        source = load_recipe(source).source;
    }
}

}  // namespace anamorph
