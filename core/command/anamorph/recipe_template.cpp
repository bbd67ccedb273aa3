// SPDX-License-Identifier: Apache-2.0
#include "recipe_template.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "anamorph/error.h"
#include "output_file.h"
#include "reference.h"

namespace anamorph::command {
namespace {

namespace fs = std::filesystem;

/// A value as a recipe file has it.
std::string value_text(const std::string& value) {
    const bool like_comment = value.find(" #") != std::string::npos || value.starts_with('#');
    return like_comment ? '"' + value + '"' : value;
}

/// The keys that sources are the values of: where none are drawn, that of the file that is.
std::vector<std::string> source_keys(const Operation& operation) {
    if (operation.sources.empty() && !operation.main_file.empty()) return {operation.main_file};
    return operation.sources;
}

/// Keys and values that are set in the template.
std::map<std::string, std::string> set_values(const Operation& operation,
                                              const std::vector<std::string>& sources, bool example) {
    std::map<std::string, std::string> set;
    const std::vector<std::string> keys = source_keys(operation);
    if (sources.size() > keys.size())
        throw Error("SOURCE", printable(sources[keys.size()]),
                    operation.name + " has " + std::to_string(keys.size()) +
                        (keys.size() == 1 ? " source" : " sources") + " at most");
    for (std::size_t i = 0; i < sources.size(); ++i) set[keys[i]] = sources[i];
    if (example)
        for (const Assignment& a : parse_recipe_name("?" + operation.example.arguments).assignments)
            set.insert({a.key, a.value});
    return set;
}

std::string comment(const std::string& text) {
    std::string commented;
    constexpr std::size_t kMark = 2;  // "# "
    for (const std::string& line : wrapped(text, kColumns - kMark)) commented += "# " + line + "\n";
    return commented;
}

bool is_there(const fs::path& name) {
    return fs::exists(fs::symlink_status(name));
}
/// Is a file there with just this text, as an earlier recipe left it?
bool holds(const fs::path& name, const std::string& text) {
    std::ifstream file(name, std::ios::binary);
    return file && std::string(std::istreambuf_iterator<char>(file), {}) == text;
}
/// What must not be there yet.
void check_new(const fs::path& name, const std::string& whose) {
    if (is_there(name))
        throw Error(printable(name.string()) + whose +
                    " is there already, and nothing was written: give another -o");
}
void write(const fs::path& name, const std::string& text) {
    OutputFile file(name.string());
    file.write(text);
    file.close();
}

}  // namespace

std::string recipe_template(const Operation& operation, const std::vector<std::string>& sources,
                            bool example) {
    const std::map<std::string, std::string> set = set_values(operation, sources, example);
    std::string text = comment(operation.title + ".") +
                       comment("Each key of a ." + operation.name +
                               " is below, with what it may be and its default. Lines that begin with # say "
                               "nothing: a key counts once its # is taken away.");
    for (const Parameter& p : *operation.parameters) {
        text += "\n" + comment(p.documentation);
        text += comment(p.accepted() + (p.unit.empty() ? "" : " (" + p.unit + ")"));
        const auto given = set.find(p.name);
        text += given != set.end() ? p.name + "=" + value_text(given->second)
                                   : "#" + p.name + "=" + value_text(p.default_value);
        text += "\n";
    }
    // Names that the example defines.
    for (const auto& [key, value] : set)
        if (!ParameterValues(*operation.parameters).knows(key))
            text += "\n" + key + "=" + value_text(value) + "\n";
    return text;
}

void write_recipe_template(const Operation& operation, std::vector<std::string> sources,
                           const std::string& output) {
    const fs::path folder = fs::path(output).parent_path();
    if (find_operation(fs::path(output).extension().string().erase(0, 1)) != &operation)
        throw Error("--output", printable(output), "must end in ." + operation.name);
    if (!sources.empty() && sources.size() < operation.least_sources) {
        std::string keys;
        for (std::size_t i = 0; i < operation.least_sources; ++i)
            keys += (i == 0 ? "" : i + 1 < operation.least_sources ? ", " : " and ") + operation.sources[i];
        throw Error("SOURCE", printable(sources.back()),
                    operation.name + " needs " + std::to_string(operation.least_sources) +
                        " images, one after the other, for " + keys);
    }
    // Names in a recipe file are relative to its folder.
    for (std::string& source : sources)
        if (!folder.empty() && fs::path(source).is_relative())
            source = fs::absolute(source).lexically_normal().lexically_proximate(
                fs::absolute(folder).lexically_normal());
    const std::map<std::string, std::string> set = set_values(operation, sources, true);
    const std::string text = recipe_template(operation, sources, true);
    check_new(output, "");
    std::map<fs::path, std::string> beside;
    for (const auto& [name, content] : operation.example.files)
        if (std::ranges::any_of(set, [&name = name](const auto& value) { return value.second == name; }) &&
            !holds(folder / name, content))
            beside[folder / name] = content;
    for (const auto& [name, content] : beside) check_new(name, ", which the recipe would read,");
    for (const auto& [name, content] : beside) write(name, content);
    write(output, text);
}

std::vector<std::string> missing_files(const std::vector<std::string>& sources) {
    std::vector<std::string> missing;
    for (const std::string& source : sources) {
        const bool is_file_name = source.find_first_of("?{#%()") == std::string::npos;
        if (is_file_name && !is_there(source)) missing.push_back(source);
    }
    return missing;
}

}  // namespace anamorph::command
