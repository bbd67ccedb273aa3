// SPDX-License-Identifier: Apache-2.0
// What the readers of text files share: messages of one line, numbers, rows of CSV files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/error.h"

namespace anamorph::text_file {

/// Is it a character that a name may begin with? A name is letters of ASCII, digits and underscores, a digit
/// not first.
bool starts_name(char c);
bool continues_name(char c);
bool is_name(std::string_view text);

/// A part of a text from outside as messages show it: no line breaks, not endless.
std::string excerpt(std::string_view text);

/// Throws Error "file: entry: what", or "file: what" where `entry` is empty.
[[noreturn]] void fail(std::string_view file, const std::string& entry, const std::string& what);

/// The most bytes of a file; longer ones are refused, and hosts need not read more.
inline constexpr std::size_t kMostBytes = std::size_t{64} << 20;
void check_size(std::string_view text, std::string_view file);

/// Runs `body`; its errors get the file and the entry in front.
template <class Body>
void in_entry(std::string_view file, const std::string& entry, const Body& body) {
    try {
        body();
    } catch (const Error& error) {
        fail(file, entry, error.what());
    }
}

/// A decimal number at the front of `text`, which is shortened by it; false where there is none.
bool take_number(std::string_view& text, double& value);

/// The number that a field is. Throws Error where it is none.
double number(std::string_view field);

/// The text without blanks at its ends.
std::string_view trimmed(std::string_view text);

/// The fields between the commas of a row, trimmed.
std::vector<std::string_view> fields_of(std::string_view row);

/// Does a file's name end like this, in small letters or capitals?
bool ends_with(std::string_view name, std::string_view lower_case_ending);

/// A text without the mark that some editors put in front of UTF-8.
inline std::string_view without_byte_order_mark(std::string_view text) {
    constexpr std::string_view kMark = "\xef\xbb\xbf";
    return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

/// Calls body(row, label) for every row, trimmed; `label` is "row N". Left out are a byte order mark, empty
/// rows, and those that begin with #.
template <class Body>
void each_row(std::string_view text, const Body& body) {
    text = without_byte_order_mark(text);
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = text.find('\n');
        const std::string_view row = trimmed(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        if (!row.empty() && row.front() != '#') body(row, "row " + std::to_string(number));
    }
}

}  // namespace anamorph::text_file
