// SPDX-License-Identifier: Apache-2.0
// The parser behind parse_script().
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/figure/language/script.h"
#include "anamorph/figure/language/script_lexer.h"
#include "anamorph/figure/language/script_symbols.h"
#include "anamorph/figure/language/script_table.h"

namespace anamorph::figure {

/// The largest number of a frame; numbers beyond it, either way, count as this.
inline constexpr int kLargestFrame = 1000000000;
/// The largest number that a statement counts its names by.
inline constexpr int kMostCount = 1 << 20;

/// The letters of script_table::Entry::operands that the parameters of each subroutine stand for, in their order.
using ParameterUses = std::vector<std::vector<std::string>>;

/// What parameters stand for, where they are handed on too; calls by variables are not known.
ParameterUses parameter_uses(const Program& program);

class ScriptParser {
  public:
    ScriptParser(Script& script, const ScriptOptions& options);
    /// Reads libraries and the script, and resolves what was named early.
    void parse(std::string_view text, std::string_view name);

  private:
    /// Thrown to end a statement whose fault has been reported.
    struct Abandoned {};

    struct Pending {
        int subroutine = 0;
        std::size_t movement = 0, operand = 0;
        char letter = 'n';
        std::string name, usage;
        ScriptPosition position;
    };

    // Texts
    void parse_file(std::string_view text, const std::string& name, const ScriptPosition& included_at,
                    bool library);
    void parse_included(const std::string& name, const ScriptPosition& position);
    void add_file(const std::string& name, const ScriptPosition& included_at);

    // Statements; each throws Abandoned where it cannot go on
    bool statement(bool library);  ///< false at the end of the text
    /// Reads the rest of a statement, after its word; false after stop.
    bool rest_of_statement(const script_table::Entry& entry, const ScriptToken& word, bool library);
    void end_statement();
    void unknown_statement(const ScriptToken& token);
    void warn_of_short_form(const ScriptToken& token, const script_table::Entry& entry, bool action);
    void skip_to_statement();
    void figure();
    void ellipsoid();
    void joint();
    void limit();
    void variables();
    void begin_subroutine();
    void parameters();
    void end_subroutine();
    void speed();
    void view();
    void movement(Distribution distribution);

    // Tokens
    const ScriptToken& peek();
    ScriptToken take();
    ScriptToken take_operand(const char* expected);
    bool begins_statement(const ScriptToken& token) const;
    ScriptPosition position_of(const ScriptToken& token) const;
    std::string take_name(OperandKind kind);
    double take_number(const char* expected);
    int take_integer(const char* expected, int smallest, int largest);
    int take_mention(OperandKind kind);  ///< an ellipsoid: made when it is new
    Operand take_value(char letter, Pending& pending, bool& waits, bool& usable);
    /// The parameter of the subroutine being read that has this name.
    std::optional<int> parameter_of(std::string_view name) const;
    /// What a call hands over that is known by what the parameter stands for alone: a picture, or what an action makes.
    std::optional<Operand> made_for_parameter(const Pending& pending, const ParameterUses& uses);
    void check_parameter_names();
    void check_frames(const Movement& movement);
    void resolve_pending();

    // Messages
    bool strict() const { return m_options.dialect == Dialect::strict; }
    void report(Severity severity, const ScriptPosition& position, std::string found, std::string expected,
                std::string message);
    void error(const ScriptPosition& position, const std::string& message);
    /// Reports a warning, in the strict dialect an error.
    void fault(const ScriptPosition& position, const std::string& message);
    [[noreturn]] void unexpected(const ScriptToken& token, const std::string& expected);
    /// Says how the statement that is being read goes on after its word.
    std::string usage() const;
    void check_size(std::size_t size, const ScriptPosition& position);

    Script& m_script;
    Program& m_program;
    const ScriptOptions& m_options;
    ScriptSymbols m_symbols;
    ScriptLexer m_lexer{{}};
    ScriptToken m_token;
    bool m_peeked = false;
    int m_file = 0;
    const script_table::Entry* m_entry = nullptr;  ///< entry of the statement or action being read
    ScriptPosition m_entry_position;
    std::set<std::string, std::less<>> m_short_forms;      ///< short forms that have been warned of
    int m_subroutine = 0;                                  ///< the subroutine that is being read
    std::set<int> m_defined_subroutines{0}, m_shaped{0};   ///< declared in full, not only named
    std::map<std::string, int, std::less<>> m_parameters;  ///< of the subroutine that is being read
    /// The names of parameters that nothing else had so far.
    std::vector<std::pair<std::string, ScriptPosition>> m_parameter_names;
    std::vector<std::string> m_including;
    std::size_t m_included_bytes = 0;
    std::vector<Pending> m_pending;
    int m_errors = 0, m_warnings = 0;
};

/// The parser throws this where it gives up: too many errors, or a text too large.
struct ScriptTooBad {};

/// Do numbers say that a movement never happens?
inline bool runs_backwards(const Movement& m) {
    return m.start.kind == OperandKind::number && m.stop.kind == OperandKind::number &&
           m.stop.number < m.start.number;
}

/// What is wrong with the number of values that a call hands over; empty where nothing is.
std::string wrong_count(const Subroutine& called, std::size_t values);
/// What to say of an operand that does not fit the letter which a parameter stands for.
std::string wrong_value(const Subroutine& called, std::size_t parameter, char letter, const Operand& operand);

/// Checks what only the whole program shows: rings of joints, figures in pieces, subroutines that call
/// themselves.
void check_program(Script& script);

}  // namespace anamorph::figure
