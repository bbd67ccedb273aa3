// SPDX-License-Identifier: Apache-2.0
// The names of a script, and what an operand means.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "anamorph/figure/language/program.h"

namespace anamorph::figure {

/// The words that messages use for the letters of script_table::Entry::operands.
const char* description_of(char letter);
const char* description_of(OperandKind kind);

/// Whether an operand may stand where a letter of script_table::Entry::operands is; what a variable holds is not known yet.
bool fits(char letter, const Operand& operand);

/// A text as messages show it: in quotes, on one line, not endless.
std::string in_quotes(std::string_view text);

/// The candidate that `word` is most likely a misspelling of; empty where none is near.
std::string nearest_of(std::string_view word, const std::vector<std::string_view>& candidates);

/// The ending `, did you mean "NAME"?` of a message, or nothing for an empty name.
std::string suggestion(const std::string& name);

class ScriptSymbols {
  public:
    /// Declares the names that every script knows.
    explicit ScriptSymbols(Program& program);

    std::optional<int> find(OperandKind kind, std::string_view name) const;
    /// The entry of the program's table, made if it is not there.
    int make(OperandKind kind, std::string_view name, const ScriptPosition& position);
    /// Another kind that has this name.
    std::optional<OperandKind> other_kind(OperandKind kind, std::string_view name) const;
    bool known(std::string_view name) const;

    /// The operand that a name means where `letter` is asked for: a variable first. Numbers are not looked
    /// up.
    std::optional<Operand> resolve(char letter, std::string_view name) const;
    /// The known name of what `letter` asks for that is nearest to `name`; empty where none is near.
    std::string nearest(char letter, std::string_view name) const;

  private:
    static constexpr int kKinds = 8;
    Program& m_program;
    std::unordered_map<std::string, std::array<int, kKinds>> m_indices;
};

}  // namespace anamorph::figure
