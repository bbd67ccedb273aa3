// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/language/script_lexer.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anamorph/number/portable.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {
namespace {

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}
bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v';
}

}  // namespace

ScriptLexer::ScriptLexer(std::string_view text) : m_text(text_file::without_byte_order_mark(text)) {}

void ScriptLexer::advance() {
    if (m_text[m_at++] == '\n') {
        ++m_line;
        m_column = 1;
    } else {
        ++m_column;
    }
}

void ScriptLexer::skip_blanks() {
    while (m_at < m_text.size()) {
        if (m_text[m_at] == '*')
            while (m_at < m_text.size() && m_text[m_at] != '\n') advance();
        else if (is_blank(m_text[m_at]))
            advance();
        else
            return;
    }
}

ScriptToken ScriptLexer::next() {
    const int line_before = m_at == 0 ? 0 : m_line;
    skip_blanks();
    ScriptToken token{{}, m_line, m_column, m_line != line_before};
    const std::size_t from = m_at;
    while (m_at < m_text.size() && m_text[m_at] != '*' && !is_blank(m_text[m_at])) advance();
    token.text = m_text.substr(from, m_at - from);
    return token;
}

ScriptToken ScriptLexer::skip_line() {
    const ScriptLexer before = *this;
    const ScriptToken token = next();
    if (token.begins_line || token.text.empty()) {
        *this = before;
        return {};
    }
    while (m_at < m_text.size() && m_text[m_at] != '\n') advance();
    return token;
}

std::optional<char> odd_character(std::string_view token, Dialect dialect) {
    const std::string_view others = dialect == Dialect::strict ? "+-._" : "+-.";
    for (const char c : token)
        if (!is_digit(c) && !is_letter(c) && others.find(c) == std::string_view::npos) return c;
    return std::nullopt;
}

bool looks_like_number(std::string_view token) {
    return std::any_of(token.begin(), token.end(), is_digit) &&
           std::all_of(token.begin(), token.end(),
                       [](char c) { return is_digit(c) || c == '+' || c == '-' || c == '.'; });
}

std::optional<double> read_script_number(std::string_view token, Dialect dialect) {
    if (!looks_like_number(token)) return std::nullopt;
    bool negative = false;
    std::string digits;
    if (dialect == Dialect::classic) {
        for (const char c : token) {
            if (c == '-') negative = !negative;
            if (c != '-' && c != '+') digits += c;
        }
    } else {
        negative = token.front() == '-';
        digits = token.substr(token.front() == '-' || token.front() == '+' ? 1 : 0);
    }
    if (digits.find_first_of("+-") != std::string::npos) return std::nullopt;
    double value = 0;
    const auto [end, error] =
        from_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value))
        return std::nullopt;
    return negative ? -value : value;
}

}  // namespace anamorph::figure
