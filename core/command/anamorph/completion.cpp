// SPDX-License-Identifier: Apache-2.0
#include "completion.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <span>
#include <sstream>
#include <string_view>

#include "anamorph/operation/operation.h"
#include "pictures_program.h"
#include "plugin_place.h"

namespace anamorph::command {
namespace {

constexpr std::string_view kCompleted[] = {"anamorph", "anamorph-figure", "anamorph-machine"};

/// What a program of ours says of itself, or of one of its subcommands; empty where it is not there.
std::string help_of(const std::string& program, const std::string& subcommand) {
    const std::filesystem::path file = own_folder() / program;
    std::string line = "'";
    for (const char c : file.string()) line += c == '\'' ? "'\\''" : std::string(1, c);
    // A subcommand is one of those that the program's help names.
    line += "' " + subcommand + " --help 2>/dev/null";
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(line.c_str(), "r"), pclose);
    std::string text;
    char part[4096];
    while (pipe)
        if (const std::size_t size = std::fread(part, 1, sizeof part, pipe.get()))
            text.append(part, size);
        else
            break;
    return text;
}

struct Offered {
    std::vector<std::string> options, subcommands;
};

/// The options and subcommands that a help text lists, in the form of CLI11.
Offered offered_by(const std::string& help) {
    Offered offered;
    std::istringstream lines(help);
    bool of_subcommands = false;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("Subcommands:")) of_subcommands = true;
        std::istringstream words(line);
        std::string word;
        if (!line.starts_with("  ") || line.starts_with("    ") || !(words >> word)) continue;
        if (of_subcommands) {
            offered.subcommands.push_back(word);
            continue;
        }
        std::istringstream spellings(word);
        for (std::string one; std::getline(spellings, one, ',');)
            if (one.starts_with("-")) offered.options.push_back(one);
    }
    return offered;
}

/// Where the recipe begins in a word that the cursor stands in: behind the last bracket that is not closed.
std::size_t recipe_begin(std::string_view word) {
    int closed = 0;
    for (std::size_t i = word.size(); i-- > 0;) {
        if (word[i] == ')') ++closed;
        if (word[i] == '(' && closed-- == 0) return i + 1;
    }
    return 0;
}

/// The keys of a recipe, or the values of one of them, each with what stands before it.
std::vector<std::string> in_recipe(const std::string& word) {
    const std::size_t begin = recipe_begin(word), question = word.find('?', begin);
    if (question == std::string::npos) return {};
    const std::size_t dot = word.rfind('.', question);
    const Operation* operation = dot == std::string::npos || dot < begin
                                     ? nullptr
                                     : find_operation(word.substr(dot + 1, question - dot - 1));
    if (!operation) return {};
    const std::size_t at = std::max(question, word.rfind('&') == std::string::npos ? 0 : word.rfind('&')) + 1;
    const std::size_t equals = word.find('=', at);
    std::vector<std::string> found;
    for (const Parameter& parameter : *operation->parameters) {
        if (equals == std::string::npos) {
            found.push_back(word.substr(0, at) + parameter.name + "=");
        } else if (word.compare(at, equals - at, parameter.name) == 0) {
            for (const std::string& choice : parameter.choices)
                found.push_back(word.substr(0, equals + 1) + choice);
        }
    }
    return found;
}

}  // namespace

std::vector<std::string> completions(const std::vector<std::string>& words) {
    if (words.size() < 2) return {};
    const std::string program = std::filesystem::path(words[0]).filename().string(), &last = words.back();
    if (std::ranges::find(kCompleted, program) == std::end(kCompleted)) return {};
    if (program == "anamorph" && words.size() > 2 &&
        std::ranges::find(kPrograms, words[1]) != std::end(kPrograms)) {
        std::vector<std::string> of_program(words.begin() + 1, words.end());
        of_program[0] = "anamorph-" + words[1];
        return completions(of_program);
    }
    Offered offered = offered_by(help_of(program, ""));
    if (program == "anamorph") {
        for (const auto& more :
             {std::span<const std::string_view>(kOfPictures), std::span<const std::string_view>(kPrograms)})
            offered.subcommands.insert(offered.subcommands.end(), more.begin(), more.end());
        offered.subcommands.emplace_back(kBench);
    }
    std::string subcommand;
    for (std::size_t i = 1; i + 1 < words.size() && subcommand.empty(); ++i)
        if (std::ranges::find(offered.subcommands, words[i]) != offered.subcommands.end())
            subcommand = words[i];
    std::vector<std::string> all = in_recipe(last);
    if (last.starts_with("-")) {
        all = subcommand.empty() ? offered.options : offered_by(help_of(program, subcommand)).options;
    } else if (subcommand.empty()) {
        all.insert(all.end(), offered.subcommands.begin(), offered.subcommands.end());
    } else if (program == "anamorph" && subcommand == "new") {
        for (const Operation* operation : operations()) all.push_back(operation->name);
    } else if (program == "anamorph" && subcommand == "help") {
        for (const Operation* operation : operations()) all.push_back(operation->name);
        all.insert(all.end(), std::begin(kOfPictures), std::end(kOfPictures));
    }
    std::erase_if(all, [&](const std::string& word) { return !word.starts_with(last); });
    std::ranges::sort(all);
    return all;
}

}  // namespace anamorph::command
