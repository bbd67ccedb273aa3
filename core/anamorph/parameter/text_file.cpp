// SPDX-License-Identifier: Apache-2.0
#include "anamorph/parameter/text_file.h"

#include <algorithm>
#include <cctype>

#include "anamorph/number/portable.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::text_file {

bool starts_name(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool continues_name(char c) {
    return starts_name(c) || (c >= '0' && c <= '9');
}
bool is_name(std::string_view text) {
    return !text.empty() && starts_name(text.front()) &&
           std::all_of(text.begin(), text.end(), continues_name);
}

std::string excerpt(std::string_view text) {
    return printable(text);
}

void fail(std::string_view file, const std::string& entry, const std::string& what) {
    throw Error(excerpt(file) + ": " + (entry.empty() ? "" : entry + ": ") + what);
}

void check_size(std::string_view text, std::string_view file) {
    if (text.size() > kMostBytes)
        fail(file, "", "must be at most " + std::to_string(kMostBytes >> 20) + " MB");
}

bool take_number(std::string_view& text, double& value) {
    const char* from = text.data();
    const char* end = from + text.size();
    if (from != end && *from == '+') ++from;
    const auto [to, error] = from_chars(from, end, value);
    if (error != std::errc()) return false;
    text.remove_prefix(static_cast<std::size_t>(to - text.data()));
    return true;
}

double number(std::string_view field) {
    double value;
    std::string_view rest = field;
    if (!take_number(rest, value) || !rest.empty())
        throw Error("must be a number, not \"" + excerpt(field) + "\"");
    return value;
}

std::string_view trimmed(std::string_view text) {
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!text.empty() && blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && blank(text.back())) text.remove_suffix(1);
    return text;
}

std::vector<std::string_view> fields_of(std::string_view row) {
    std::vector<std::string_view> fields;
    for (;;) {
        const std::size_t comma = row.find(',');
        fields.push_back(trimmed(row.substr(0, comma)));
        if (comma == std::string_view::npos) return fields;
        row.remove_prefix(comma + 1);
    }
}

bool ends_with(std::string_view name, std::string_view lower_case_ending) {
    if (name.size() < lower_case_ending.size()) return false;
    const std::string_view tail = name.substr(name.size() - lower_case_ending.size());
    return std::equal(tail.begin(), tail.end(), lower_case_ending.begin(),
                      [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

}  // namespace anamorph::text_file
