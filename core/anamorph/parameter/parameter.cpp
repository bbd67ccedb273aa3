// SPDX-License-Identifier: Apache-2.0
#include "anamorph/parameter/parameter.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdio>
#include <new>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "anamorph/number/portable.h"
#include "anamorph/parameter/suggestion.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph {
namespace {

constexpr std::string_view kBlanks = " \t";

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string lower(std::string_view text) {
    std::string out(text);
    for (char& c : out)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return out;
}

std::string joined(const std::vector<std::string>& words) {
    std::string out;
    for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
    return out;
}

/// All of `text` as a finite number; locale-independent.
std::optional<double> to_number(std::string_view text) {
    // from_chars takes no plus sign.
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
    return value;
}

std::optional<int> to_whole(std::string_view text) {
    int value = 0;
    const auto [end, error] = from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return {};
    return value;
}

std::optional<Size> to_extent(std::string_view text) {
    const std::size_t cross = text.find_first_of("xX");
    const std::optional<int> width = to_whole(text.substr(0, cross));
    if (!width) return {};
    if (cross == std::string_view::npos) return Size{*width, -1};
    const std::optional<int> height = to_whole(text.substr(cross + 1));
    if (!height) return {};
    return Size{*width, *height};
}

/// "1,2.5,-3", with or without blanks
std::optional<std::vector<double>> to_numbers(std::string_view text) {
    std::vector<double> values;
    while (true) {
        const std::size_t comma = text.find(',');
        const std::optional<double> value = to_number(trimmed(text.substr(0, comma)));
        if (!value) return {};
        values.push_back(*value);
        if (comma == std::string_view::npos) return values;
        text.remove_prefix(comma + 1);
    }
}

bool is_choice(const Parameter& parameter, const std::string& word) {
    return std::find(parameter.choices.begin(), parameter.choices.end(), word) != parameter.choices.end();
}

/// The numbers that a text says; none where it is a word, or says none. Of an extent its width, and its height if that is given.
std::vector<double> numbers_in(const Parameter& parameter, std::string_view text) {
    switch (parameter.type) {
        case ParameterType::number:
            if (const auto v = to_number(text)) return {*v};
            return {};
        case ParameterType::whole:
        case ParameterType::toggle:
            if (const auto v = to_whole(text)) return {static_cast<double>(*v)};
            return {};
        case ParameterType::extent: {
            const std::optional<Size> v = to_extent(text);
            if (!v) return {};
            if (text.find_first_of("xX") == std::string_view::npos) return {static_cast<double>(v->width)};
            return {static_cast<double>(v->width), static_cast<double>(v->height)};
        }
        case ParameterType::numbers:
            return to_numbers(text).value_or(std::vector<double>{});
        default:
            return {};
    }
}

/// Are these numbers what a parameter takes?
bool are_allowed(const Parameter& parameter, const std::vector<double>& values) {
    const auto in_range = [&](double v) {
        const bool low = parameter.above_minimum ? v > parameter.minimum : v >= parameter.minimum;
        return std::isfinite(v) && low && v <= parameter.maximum;
    };
    const auto is_int = [](double v) { return v == std::trunc(v) && std::fabs(v) <= INT_MAX; };
    const bool all = !values.empty() && std::all_of(values.begin(), values.end(), in_range);
    switch (parameter.type) {
        case ParameterType::number:
            return values.size() == 1 && all;
        case ParameterType::whole:
            return values.size() == 1 && all && is_int(values[0]);
        case ParameterType::toggle:
            return values.size() == 1 && (values[0] == 0 || values[0] == 1);
        case ParameterType::extent:
            return values.size() <= 2 && all && std::all_of(values.begin(), values.end(), is_int);
        case ParameterType::numbers:
            return all;
        default:
            return false;
    }
}

bool is_allowed(const Parameter& parameter, const std::string& text, const std::vector<double>& numbers) {
    switch (parameter.type) {
        case ParameterType::toggle:
            return text == "0" || text == "1";
        case ParameterType::choice:
            return is_choice(parameter, text);
        case ParameterType::extent:
            return is_choice(parameter, text) || are_allowed(parameter, numbers);
        case ParameterType::image:
        case ParameterType::file:
        case ParameterType::text:
            return !text.empty();
        default:
            return are_allowed(parameter, numbers);
    }
}

/// Numbers as a recipe has them.
std::string written(ParameterType type, const std::vector<double>& values) {
    const char* between = type == ParameterType::extent ? "x" : ",";
    std::string text;
    for (const double value : values) text += (text.empty() ? "" : between) + shortest(value);
    return text;
}

const Parameter* find(const ParameterTable& table, std::string_view key) {
    const std::string name = lower(key);
    for (const Parameter& parameter : table)
        if (parameter.name == name) return &parameter;
    return nullptr;
}

bool takes_definitions(const ParameterTable& table) {
    return std::any_of(table.begin(), table.end(), [](const Parameter& p) { return p.definitions; });
}

std::vector<std::string> names(const ParameterTable& table) {
    std::vector<std::string> out;
    for (const Parameter& parameter : table) out.push_back(parameter.name);
    return out;
}

/// Names as far as a line holds them.
std::string joined_in_a_line(const std::vector<std::string>& all) {
    constexpr std::size_t kLine = 240;
    std::vector<std::string> first;
    std::size_t length = 0;
    for (const std::string& name : all)
        if ((length += name.size() + 2) < kLine) first.push_back(name);
    const std::size_t others = all.size() - first.size();
    return joined(first) + (others > 0 ? " and " + std::to_string(others) + " others" : "");
}

[[noreturn]] void throw_unknown(const Assignment& given, const ParameterTable& table) {
    const std::vector<std::string> all = names(table);
    throw Error(printable(given.key), printable(given.value),
                "there is no such parameter" + perhaps(lower(given.key), all) + ": must be one of " +
                    joined_in_a_line(all));
}

[[noreturn]] void throw_refused(const Parameter& parameter, const std::string& text) {
    const std::string near = perhaps(lower(text), parameter.choices);
    throw Error(parameter.name, printable(text),
                (near.empty() ? "" : "there is no such value" + near + ": ") + parameter.rule());
}

/// "key=value" cut at its first equals sign.
std::optional<Assignment> to_assignment(std::string_view text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string_view::npos) return {};
    const std::string_view key = trimmed(text.substr(0, equals));
    if (key.empty()) return {};
    return Assignment{std::string(key), std::string(trimmed(text.substr(equals + 1)))};
}

/// The text behind an equals sign without its comment, from a # on that follows a blank; of one in double quotes, what
/// stands between these.
std::string_view without_comment(std::string_view text) {
    const auto ends = [](std::string_view rest) {
        return trimmed(rest).empty() || trimmed(rest).front() == '#';
    };
    const std::string_view value = trimmed(text);
    const std::size_t quote = value.starts_with('"') ? value.find('"', 1) : std::string_view::npos;
    if (quote != std::string_view::npos && ends(value.substr(quote + 1))) return value.substr(1, quote - 1);
    for (std::size_t i = 1; i < text.size(); ++i)
        if (text[i] == '#' && kBlanks.find(text[i - 1]) != std::string_view::npos)
            return trimmed(text.substr(0, i));
    return value;
}

/// The length of a "(NAME?...)" that is the whole of the value at the start of `text`; 0 where there is none.
std::size_t bracketed_name(std::string_view text) {
    if (!text.starts_with('(')) return 0;
    int depth = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        depth += text[i] == '(' ? 1 : text[i] == ')' ? -1 : 0;
        if (depth > 0) continue;
        const bool whole = i + 1 == text.size() || text[i + 1] == '&';
        return whole && text.substr(0, i).find('?') != std::string_view::npos ? i + 1 : 0;
    }
    return 0;
}

bool is_control(char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && c != '\t') || byte == 0x7f;
}

/// Bytes of the UTF-8 character in front of `text`; 0 where there is none.
std::size_t character(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char lead = byte(0);
    const std::size_t size = lead < 0x80                    ? 1
                             : lead >= 0xc2 && lead <= 0xdf ? 2
                             : lead >= 0xe0 && lead <= 0xef ? 3
                             : lead >= 0xf0 && lead <= 0xf4 ? 4
                                                            : 0;
    if (text.size() < size) return 0;
    for (std::size_t i = 1; i < size; ++i)
        if ((byte(i) & 0xc0) != 0x80) return 0;
    // Longer than need be, halves of pairs, and beyond the last one.
    if ((lead == 0xe0 && byte(1) < 0xa0) || (lead == 0xed && byte(1) > 0x9f) ||
        (lead == 0xf0 && byte(1) < 0x90) || (lead == 0xf4 && byte(1) > 0x8f))
        return 0;
    return size;
}

/// UTF-8 on one line, which every host can show.
void make_printable(std::string& text) {
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t size = character(std::string_view(text).substr(at));
        if (size == 0 || is_control(text[at]) || text[at] == '\t') text[at] = '?';
        at += std::max<std::size_t>(size, 1);
    }
}

template <class Number>
std::string fewest_digits(Number value) {
    char text[64];
    const auto [end, error] = to_chars(text, text + sizeof text, value);
    return error == std::errc() ? std::string(text, end) : std::string();
}

}  // namespace

std::string shortest(double value) {
    return fewest_digits(value);
}
std::string shortest(float value) {
    return fewest_digits(value);
}
std::string brief(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", value);
    return text;
}

std::string printable(std::string_view text) {
    std::size_t most = 100;
    const bool cut = text.size() > most;
    // Not within a character.
    for (int i = 0; cut && i < 3 && most > 0 && (static_cast<unsigned char>(text[most]) & 0xc0) == 0x80; ++i)
        --most;
    std::string out(text.substr(0, most));
    make_printable(out);
    return cut ? out + "..." : out;
}

std::string message_of(const std::exception& error, const std::string& what) {
    const bool memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr ||
                        dynamic_cast<const std::length_error*>(&error) != nullptr;
    std::string message = memory ? "not enough memory for " + what : std::string(error.what());
    make_printable(message);
    return message;
}

std::string Parameter::accepted() const {
    const std::string from_to = " from " + shortest(minimum) + " to " + shortest(maximum);
    switch (type) {
        case ParameterType::number: {
            const std::string least = (above_minimum ? " above " : " of at least ") + shortest(minimum);
            if (!std::isfinite(minimum)) return "a finite number";
            if (!std::isfinite(maximum)) return "a number" + least;
            return "a number" + (above_minimum ? least + ", at most " + shortest(maximum) : from_to);
        }
        case ParameterType::whole:
            return "an integer" + from_to;
        case ParameterType::toggle:
            return "0 or 1";
        case ParameterType::choice:
            return joined(choices);
        case ParameterType::extent:
            return "N or NxM, integers" + from_to + (choices.empty() ? "" : "; or " + joined(choices));
        case ParameterType::numbers:
            if (std::isfinite(minimum) && std::isfinite(maximum))
                return "numbers" + from_to + ", separated by commas";
            return std::isfinite(minimum)
                       ? "numbers of at least " + shortest(minimum) + ", separated by commas"
                       : "finite numbers, separated by commas";
        case ParameterType::image:
            return "the name of an image";
        case ParameterType::file:
            return "the name of a file";
        case ParameterType::text:
            return "text";
    }
    return {};
}

std::string Parameter::rule() const {
    switch (type) {
        case ParameterType::choice:
            return "must be one of " + accepted();
        case ParameterType::image:
        case ParameterType::file:
        case ParameterType::text:
            return "must not be empty";
        default:
            return "must be " + accepted();
    }
}

void ParameterValues::define(const Assignment& name) {
    const auto found = std::find_if(m_definitions.begin(), m_definitions.end(),
                                    [&](const Assignment& known) { return known.key == name.key; });
    if (found == m_definitions.end())
        m_definitions.push_back(name);
    else
        found->value = name.value;
}

/// Is it a name that is no parameter's, where such names are defined?
bool ParameterValues::defines(std::string_view name) const {
    return !find(*m_table, name) && takes_definitions(*m_table) && text_file::is_name(name);
}

void ParameterValues::refuse_definitions() const {
    if (!m_definitions.empty()) throw_unknown(m_definitions.front(), *m_table);
}

void ParameterValues::assign(const std::vector<Assignment>& place) {
    std::set<std::string> seen;
    for (const Assignment& a : place) {
        const Parameter* parameter = find(*m_table, a.key);
        if (!parameter && !defines(a.key)) throw_unknown(a, *m_table);
        const std::string& name = parameter ? parameter->name : a.key;
        if (!seen.insert(name).second)
            throw Error(name, printable(a.value), "given twice in one place: must be given once");
        set(name, a.value);
    }
}

const Parameter& ParameterValues::row_of(std::string_view name) const {
    const Parameter* parameter = find(*m_table, name);
    if (!parameter) throw Error("there is no parameter " + std::string(name));
    return *parameter;
}

void ParameterValues::set(std::string_view name, const std::string& text) {
    if (defines(name)) return define({std::string(name), text});
    const Parameter& parameter = row_of(name);
    std::vector<double> numbers = numbers_in(parameter, text);
    if (!is_allowed(parameter, text, numbers)) throw_refused(parameter, text);
    m_given[parameter.name] = {text, std::move(numbers)};
}

void ParameterValues::set(std::string_view name, const std::vector<double>& values) {
    const bool is_defined = defines(name);
    const ParameterType type = is_defined ? ParameterType::numbers : row_of(name).type;
    std::string text = written(type, values);
    if (is_defined) return define({std::string(name), text});
    const Parameter& parameter = row_of(name);
    if (!are_allowed(parameter, values)) throw Error(parameter.name, printable(text), parameter.rule());
    m_given[parameter.name] = {std::move(text), values};
}

void ParameterValues::set(std::string_view name, const Size& value) {
    set(name, std::vector<double>{static_cast<double>(value.width), static_cast<double>(value.height)});
}

bool ParameterValues::knows(std::string_view name) const {
    return find(*m_table, name) != nullptr;
}

const std::string& ParameterValues::text(std::string_view name) const {
    const auto given = m_given.find(name);
    return given != m_given.end() ? given->second.text : row_of(name).default_value;
}

std::vector<double> ParameterValues::numbers_of(std::string_view name) const {
    const auto given = m_given.find(name);
    if (given != m_given.end() && !given->second.numbers.empty()) return given->second.numbers;
    const Parameter& parameter = row_of(name);
    std::vector<double> numbers = numbers_in(parameter, text(name));
    if (numbers.empty()) throw Error(parameter.name, text(name), parameter.rule());
    return numbers;
}

double ParameterValues::number(std::string_view name) const {
    return numbers_of(name)[0];
}

int ParameterValues::whole(std::string_view name) const {
    return static_cast<int>(numbers_of(name)[0]);
}

std::vector<double> ParameterValues::numbers(std::string_view name) const {
    return numbers_of(name);
}

Size ParameterValues::extent(std::string_view name) const {
    const std::vector<double> sides = numbers_of(name);
    return {static_cast<int>(sides[0]), sides.size() > 1 ? static_cast<int>(sides[1]) : -1};
}

std::size_t ParameterValues::choice(std::string_view name) const {
    const std::vector<std::string>& choices = row_of(name).choices;
    return static_cast<std::size_t>(std::find(choices.begin(), choices.end(), text(name)) - choices.begin());
}

int ParameterValues::enumerator(std::string_view name) const {
    return row_of(name).enumerators.at(choice(name));
}

std::string ParameterValues::key(const std::vector<std::string>& without) const {
    std::string key;
    for (const Parameter& parameter : *m_table) {
        if (std::find(without.begin(), without.end(), parameter.name) != without.end()) continue;
        // No value holds a line break, and none that is given is empty.
        key += parameter.name + "=" + text(parameter.name) + "\n";
    }
    for (const Assignment& name : m_definitions) key += name.key + "=" + name.value + "\n";
    return key;
}

std::vector<Assignment> parse_recipe(std::string_view text) {
    if (text.size() > kMaxRecipeBytes)
        throw Error("recipe of " + std::to_string(text.size()) + " bytes: must have at most " +
                    std::to_string(kMaxRecipeBytes));
    text = text_file::without_byte_order_mark(text);
    std::vector<Assignment> out;
    for (int number = 1; !text.empty(); ++number) {
        const std::size_t end = text.find('\n');
        std::string_view line = text.substr(0, end);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        if (line.ends_with('\r')) line.remove_suffix(1);
        const std::string where = "recipe line " + std::to_string(number);
        if (std::any_of(line.begin(), line.end(), is_control))
            throw Error(where + " holds a control character: must be text, one key=value a line");
        line = trimmed(line);
        if (line.empty() || line.front() == '#') continue;
        std::optional<Assignment> assignment = to_assignment(line);
        if (assignment) assignment->value = without_comment(line.substr(line.find('=') + 1));
        if (!assignment)
            throw Error(where + " is \"" + printable(line) +
                        "\": must be key=value, or a comment that begins with #");
        out.push_back(*assignment);
    }
    return out;
}

RecipeName parse_recipe_name(std::string_view name) {
    const std::size_t question = name.find('?');
    RecipeName out{std::string(name.substr(0, question)), {}};
    if (question == std::string_view::npos) return out;
    std::string_view rest = name.substr(question + 1);
    while (!rest.empty()) {
        std::size_t end = rest.find('&');
        std::optional<Assignment> assignment = to_assignment(rest.substr(0, end));
        if (!assignment || std::any_of(assignment->value.begin(), assignment->value.end(), is_control))
            throw Error("argument \"" + printable(rest.substr(0, end)) + "\": must be key=value");
        // A nested recipe name keeps its own arguments.
        const std::size_t value = rest.find('=') + 1, bracketed = bracketed_name(rest.substr(value));
        if (bracketed > 0) {
            end = value + bracketed;
            assignment->value = rest.substr(value + 1, bracketed - 2);
        } else if (assignment->value.find('?') != std::string::npos) {
            end = std::string_view::npos;
            assignment = to_assignment(rest);
        }
        out.assignments.push_back(*assignment);
        rest.remove_prefix(std::min(rest.size(), end == std::string_view::npos ? rest.size() : end + 1));
    }
    return out;
}

std::string reference_page(const std::string& title, const ParameterTable& table) {
    std::string page =
        "# " + title + "\n\n| key | default | unit | values | meaning |\n|---|---|---|---|---|\n";
    for (const Parameter& p : table) {
        page += "| `" + p.name + "` | " + (p.default_value.empty() ? "" : "`" + p.default_value + "`") +
                " | " + p.unit + " | " + p.accepted() + " | " + p.documentation + " |\n";
    }
    return page;
}

}  // namespace anamorph
