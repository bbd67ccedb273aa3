// SPDX-License-Identifier: Apache-2.0
// Splits the text of a script into tokens, and reads numbers.
#pragma once

#include <optional>
#include <string_view>

#include "anamorph/figure/language/program.h"

namespace anamorph::figure {

struct ScriptToken {
    std::string_view text;  ///< empty at the end of the text
    int line = 1, column = 1;
    bool begins_line = false;
};

/// Splits a text into tokens, which lie between blanks; `*`, wherever it is, starts a comment that lasts to
/// the end of the line.
class ScriptLexer {
  public:
    /// Starts at the beginning of a text; a byte order mark ahead of it is left out.
    explicit ScriptLexer(std::string_view text);
    ScriptToken next();
    /// Leaves the line if a token of it is left. Returns the first that was left, or an empty one.
    ScriptToken skip_line();

  private:
    void skip_blanks();
    void advance();

    std::string_view m_text;
    std::size_t m_at = 0;
    int m_line = 1, m_column = 1;
};

/// The first byte of a token that the language does not allow; classic: letters, digits, + - . only.
std::optional<char> odd_character(std::string_view token, Dialect dialect);

/// Whether a token is meant as a number: signs, digits and points only, and a digit.
bool looks_like_number(std::string_view token);

/// The number that a token [+-]digits[.digits] is. The classic dialect allows signs anywhere: each `-` turns
/// the sign, `+` is passed over.
std::optional<double> read_script_number(std::string_view token, Dialect dialect);

}  // namespace anamorph::figure
