// SPDX-License-Identifier: Apache-2.0
#include "reference.h"

#include <algorithm>
#include <sstream>

namespace anamorph::command {

std::vector<std::string> wrapped(const std::string& text, std::size_t columns) {
    std::istringstream words(text);
    std::vector<std::string> lines{""};
    std::string word;
    while (words >> word) {
        std::string& line = lines.back();
        if (!line.empty() && line.size() + 1 + word.size() > columns)
            lines.push_back(word);
        else
            line += (line.empty() ? "" : " ") + word;
    }
    return lines;
}

namespace {

/// The words of a text in lines of at most kColumns, each after `indent` blanks.
std::string lines_of(const std::string& text, std::size_t indent) {
    std::string all;
    for (const std::string& line : wrapped(text, kColumns - indent))
        all += std::string(indent, ' ') + line + "\n";
    return all;
}

std::string row_of(const Parameter& p) {
    std::string line = p.name + ": " + p.accepted();
    if (!p.unit.empty()) line += " (" + p.unit + ")";
    if (!p.default_value.empty()) line += " [" + p.default_value + "]";
    return lines_of(line, 2) + lines_of(p.documentation, 6);
}

}  // namespace

std::string operations_page() {
    std::string page = "Operations, each of recipes NAME.OPERATION?key=value&key=value:\n\n";
    std::size_t width = 0;
    for (const Operation* operation : operations()) width = std::max(width, operation->name.size());
    for (const Operation* operation : operations())
        page += "  " + operation->name + std::string(width + 2 - operation->name.size(), ' ') +
                operation->title + "\n";
    return page + "\nanamorph help OPERATION lists the keys of one.\n";
}

std::string operation_page(const Operation& operation) {
    std::string page = lines_of(operation.name + ": " + operation.title, 0) + "\n";
    page += lines_of("Recipes are NAME." + operation.name + "?key=value&key=value, or files NAME." +
                         operation.name + " with one key=value a line. For example:",
                     0);
    std::string arguments;
    for (std::size_t i = 1; i < operation.least_sources; ++i) arguments += operation.sources[i] + "=OTHER&";
    page += "\n  NAME." + operation.name + "?" + arguments + operation.example.arguments + "\n\n";
    page += "Keys, what they may be, and [their defaults]:\n\n";
    for (const Parameter& p : *operation.parameters) page += row_of(p);
    return page;
}

}  // namespace anamorph::command
