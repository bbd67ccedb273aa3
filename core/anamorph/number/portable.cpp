// SPDX-License-Identifier: Apache-2.0
#include "anamorph/number/portable.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

namespace anamorph::portable {
namespace {

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}
const char* after_digits(const char* at, const char* last) {
    return std::find_if_not(at, last, is_digit);
}

/// Where a word begins a text, in any case, the end of it; else null.
const char* after_word(const char* at, const char* last, std::string_view word) {
    for (const char c : word)
        if (at == last || (*at++ | 0x20) != c) return nullptr;
    return at;
}

/// The end of "inf", "infinity", "nan" or "nan(letters)"; null where there is none of them.
const char* after_no_number(const char* at, const char* last) {
    if (const char* end = after_word(at, last, "infinity")) return end;
    if (const char* end = after_word(at, last, "inf")) return end;
    const char* const end = after_word(at, last, "nan");
    if (!end || end == last || *end != '(') return end;
    const auto in_brackets = [](char c) {
        return is_digit(c) || c == '_' || ((c | 0x20) >= 'a' && (c | 0x20) <= 'z');
    };
    const char* const closed = std::find_if_not(end + 1, last, in_brackets);
    return closed != last && *closed == ')' ? closed + 1 : end;
}

/// The end of a decimal number; `first` where there is none.
const char* after_decimal(const char* first, const char* last, bool has_exponent) {
    const char* at = after_digits(first, last);
    std::ptrdiff_t digits = at - first;
    if (at != last && *at == '.') {
        const char* const end = after_digits(at + 1, last);
        digits += end - at - 1;
        at = end;
    }
    if (digits == 0) return first;
    if (!has_exponent || at == last || (*at | 0x20) != 'e') return at;
    const char* power = at + 1;
    if (power != last && (*power == '+' || *power == '-')) ++power;
    const char* const end = after_digits(power, last);
    return end == power ? at : end;
}

std::to_chars_result copied(std::string_view text, char* first, char* last) {
    if (static_cast<std::size_t>(last - first) < text.size()) return {last, std::errc::value_too_large};
    return {std::copy(text.begin(), text.end(), first), std::errc()};
}

std::string printed(const char* format, int digits, double value) {
    char text[400];
    const int size = std::snprintf(text, sizeof text, format, digits, value);
    return {text, static_cast<std::size_t>(std::clamp(size, 0, static_cast<int>(sizeof text) - 1))};
}

bool reads_as(const std::string& text, double value) {
    return std::strtod(text.c_str(), nullptr) == value;
}
bool reads_as(const std::string& text, float value) {
    return std::strtof(text.c_str(), nullptr) == value;
}

/// The shorter one of d.ddde+XX and ddd.ddd, with the fewest digits d that read back; of equal lengths the latter.
template <class Number>
std::to_chars_result write_shortest(char* first, char* last, Number value) {
    if (!std::isfinite(value)) {
        const bool negative = std::signbit(value);
        return copied(std::isnan(value) ? (negative ? "-nan" : "nan") : (negative ? "-inf" : "inf"), first,
                      last);
    }
    int digits = 0;
    std::string scientific;
    do scientific = printed("%.*e", digits, value);
    while (!reads_as(scientific, value) && ++digits < std::numeric_limits<Number>::max_digits10);
    const int exponent = std::atoi(scientific.c_str() + scientific.find('e') + 1);
    // A whole number is written to its last digit.
    if (std::abs(exponent) > 30) return copied(scientific, first, last);
    const std::string fixed = printed("%.*f", std::max(0, digits - exponent), value);
    return copied(fixed.size() <= scientific.size() ? fixed : scientific, first, last);
}

}  // namespace

std::from_chars_result read_number(const char* first, const char* last, double& value,
                                   std::chars_format format) {
    const char* const unsigned_first = first + (first != last && *first == '-');
    const char* end = after_no_number(unsigned_first, last);
    const bool is_number = !end;
    if (is_number) end = after_decimal(unsigned_first, last, format != std::chars_format::fixed);
    if (end == unsigned_first) return {first, std::errc::invalid_argument};
    const std::string text(first, end);
    const double read = std::strtod(text.c_str(), nullptr);
    const std::string_view mantissa = std::string_view(text).substr(0, text.find_first_of("eE"));
    const bool underflows = read == 0 && mantissa.find_first_of("123456789") != std::string_view::npos;
    if (is_number && (std::isinf(read) || underflows)) return {end, std::errc::result_out_of_range};
    value = read;
    return {end, std::errc()};
}

std::to_chars_result write_number(char* first, char* last, double value) {
    return write_shortest(first, last, value);
}
std::to_chars_result write_number(char* first, char* last, float value) {
    return write_shortest(first, last, value);
}

std::to_chars_result write_fixed(char* first, char* last, double value, int digits) {
    return copied(printed("%.*f", digits, value), first, last);
}

}  // namespace anamorph::portable
