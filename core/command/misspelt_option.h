// SPDX-License-Identifier: Apache-2.0
// What a command line that CLI11 does not take is told: of an option that there is not, the one that may have been meant.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/suggestion.h"

namespace anamorph::command {

inline const CLI::App* subcommand_of(const CLI::App& app, const std::string& name) {
    for (const CLI::App* command : app.get_subcommands({}))
        if (command->get_name() == name) return command;
    return nullptr;
}

/// What is wrong with a command line, in one line.
inline std::string what_is_wrong(const CLI::ParseError& error, const CLI::App& app, int argc,
                                 const char* const* argv) {
    const CLI::App* command = &app;
    std::vector<std::string> options;
    const auto add_options = [&options](const CLI::App& of) {
        for (const CLI::Option* option : of.get_options()) {
            for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
            for (const std::string& name : option->get_snames()) options.push_back("-" + name);
        }
    };
    add_options(app);
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (word == "--") break;
        if (const CLI::App* found = command == &app ? subcommand_of(app, word) : nullptr) {
            command = found;
            add_options(*command);
            continue;
        }
        const std::string option = word.substr(0, word.find('='));
        // Others are names, numbers below 0, or letters that stand together.
        if (!option.starts_with("--") || std::ranges::find(options, option) != options.end()) continue;
        std::string meant = perhaps(option, options);
        const auto longer = std::ranges::find_if(
            options, [&option](const std::string& other) { return other.starts_with(option); });
        if (meant.empty() && longer != options.end()) meant = ", perhaps " + *longer + " is meant";
        if (!meant.empty()) return printable(option) + ": there is no such option" + meant;
    }
    return error.what();
}

}  // namespace anamorph::command
