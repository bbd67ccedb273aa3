// SPDX-License-Identifier: Apache-2.0
// Texts, tokens, messages and declarations; movements are in script_movements.cpp.
#include "anamorph/figure/language/script_parser.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {

using script_table::Keyword;
using text_file::excerpt;

namespace {

constexpr int kMostMessages = 100;  // of errors, and of warnings
constexpr std::size_t kDeepestInclude = 16;
// Shorter words are not taken for the beginning of a statement where something is wrong.
constexpr std::size_t kShortestForm = 3;

/// Whether a text holds nothing but comments, or begins with a word that begins a statement.
bool begins_as_script(std::string_view text) {
    const ScriptToken first = ScriptLexer(text).next();
    return first.text.empty() ||
           (first.text.size() >= kShortestForm && script_table::find_statement(first.text) &&
            text.find('\0') == std::string_view::npos);
}

}  // namespace

ScriptParser::ScriptParser(Script& script, const ScriptOptions& options)
    : m_script(script), m_program(script.program), m_options(options), m_symbols(script.program) {
    m_program.dialect = options.dialect;
}

void ScriptParser::parse(std::string_view text, std::string_view name) {
    if (!m_options.libraries.empty()) add_file(std::string(name), {});
    for (const std::string& library : m_options.libraries) parse_included(library, {});
    parse_file(text, std::string(name), {}, false);
    resolve_pending();
    check_program(m_script);
}

// --- Texts

void ScriptParser::add_file(const std::string& name, const ScriptPosition& included_at) {
    m_program.files.push_back(name);
    m_program.included_at.push_back(included_at);
}

void ScriptParser::parse_file(std::string_view text, const std::string& name,
                              const ScriptPosition& included_at, bool library) {
    add_file(name, included_at);
    const int file = static_cast<int>(m_program.files.size()) - 1;
    m_included_bytes += text.size();
    m_file = file;
    if (m_included_bytes > kMaxScriptText) {
        error({file, 1, 1}, "a script and what it includes must be at most " +
                                std::to_string(kMaxScriptText >> 20) + " MB");
        throw ScriptTooBad{};
    }
    const int subroutine = m_subroutine;
    m_lexer = ScriptLexer(text);
    m_peeked = false;
    m_including.push_back(name);
    while (true) {
        try {
            if (!statement(library)) break;
            end_statement();
        } catch (const Abandoned&) {
            skip_to_statement();
        }
    }
    if (m_subroutine != subroutine) {
        error(position_of(peek()), "the subroutine " +
                                       m_program.subroutines[static_cast<std::size_t>(m_subroutine)].name +
                                       " has no end");
        m_subroutine = subroutine;
        m_parameters.clear();
    }
    m_including.pop_back();
}

void ScriptParser::parse_included(const std::string& name, const ScriptPosition& position) {
    if (m_including.size() >= kDeepestInclude ||
        std::find(m_including.begin(), m_including.end(), name) != m_including.end())
        return error(position, "include " + excerpt(name) + ": it includes itself, or is too deep");
    const std::string what = (position.line > 0 ? "include " : "library ") + excerpt(name);
    const auto text = m_options.include ? m_options.include(name) : std::nullopt;
    if (!text) return error(position, what + ": there is no such file");
    // No message may show a word of other files.
    if (!begins_as_script(*text))
        return error(position,
                     what + ": it is not a script: it does not begin with a declaration or a movement");
    const ScriptLexer lexer = m_lexer;
    const int file = m_file;
    parse_file(*text, name, position, true);
    m_lexer = lexer;
    m_file = file;
    m_peeked = false;
}

// --- Messages

void ScriptParser::report(Severity severity, const ScriptPosition& position, std::string found,
                          std::string expected, std::string message) {
    const bool is_error = severity == Severity::error;
    int& count = is_error ? m_errors : m_warnings;
    if (!is_error && count == kMostMessages) return;
    ++count;
    const auto file = static_cast<std::size_t>(position.file);
    const std::string name = file < m_program.files.size() ? m_program.files[file] : std::string();
    m_script.diagnostics.push_back({severity, name, position.line, position.column, std::move(found),
                                    std::move(expected), std::move(message),
                                    m_program.included_from(position.file)});
    if (!is_error || count < kMostMessages) return;
    m_script.diagnostics.push_back({Severity::error, name, position.line, position.column, "", "",
                                    std::to_string(kMostMessages) + " errors: the rest is not read", ""});
    throw ScriptTooBad{};
}

void ScriptParser::error(const ScriptPosition& position, const std::string& message) {
    report(Severity::error, position, "", "", message);
}

void ScriptParser::fault(const ScriptPosition& position, const std::string& message) {
    report(strict() ? Severity::error : Severity::warning, position, "", "", message);
}

std::string ScriptParser::usage() const {
    if (!m_entry || m_entry->usage.empty()) return {};
    return std::string(" (").append(m_entry->word).append(" ").append(m_entry->usage).append(")");
}

void ScriptParser::unexpected(const ScriptToken& token, const std::string& expected) {
    const std::string found = token.text.empty() ? "the end of the text" : std::string(token.text);
    // Where a statement is cut short by the next, it is the one that is wrong.
    const bool cut_short = m_entry && (token.text.empty() || begins_statement(token));
    const std::string what =
        "found " + (token.text.empty() ? found : in_quotes(found)) + ", expected " + expected;
    report(Severity::error, cut_short ? m_entry_position : position_of(token), found, expected,
           (cut_short ? std::string(m_entry->word) + " is not complete: " + what : what) + usage());
    throw Abandoned{};
}

void ScriptParser::check_size(std::size_t size, const ScriptPosition& position) {
    if (size <= kMaxScriptItems) return;
    error(position, "a script must have at most " + std::to_string(kMaxScriptItems) + " entries of any kind");
    throw ScriptTooBad{};
}

// --- Tokens

const ScriptToken& ScriptParser::peek() {
    if (m_peeked) return m_token;
    m_token = m_lexer.next();
    m_peeked = true;
    if (const auto odd = odd_character(m_token.text, m_options.dialect)) {
        // Other programs of the family allow any characters in names, and pictures may lie in folders.
        const auto code = static_cast<unsigned char>(*odd);
        const bool control = code < 0x20 || code == 0x7f;
        const bool harmless = *odd == '/' || *odd == '_' || (!strict() && !control);
        if (!harmless)
            error(position_of(m_token), "the character " +
                                            (control ? std::to_string(code) : in_quotes({&*odd, 1})) +
                                            " is not allowed in a name");
        else if (*odd != '/')
            report(Severity::warning, position_of(m_token), std::string(m_token.text), "",
                   "the original does not read the character " + in_quotes({&*odd, 1}));
    }
    return m_token;
}

ScriptToken ScriptParser::take() {
    const ScriptToken token = peek();
    m_peeked = token.text.empty();  // the end of the text stays
    return token;
}

ScriptPosition ScriptParser::position_of(const ScriptToken& token) const {
    return {m_file, token.line, token.column};
}

bool ScriptParser::begins_statement(const ScriptToken& token) const {
    if (m_symbols.known(token.text) || m_parameters.contains(token.text)) return false;
    if (script_table::is_keyword(token.text)) return true;
    return token.begins_line && token.text.size() >= kShortestForm &&
           script_table::find_statement(token.text);
}

void ScriptParser::skip_to_statement() {
    while (!peek().text.empty()) {
        const auto* entry = script_table::find_statement(peek().text);
        if (entry && begins_statement(peek()) && (strict() || peek().begins_line)) return;
        take();
    }
}

ScriptToken ScriptParser::take_operand(const char* expected) {
    if (peek().text.empty() || begins_statement(peek())) unexpected(peek(), expected);
    return take();
}

std::string ScriptParser::take_name(OperandKind kind) {
    const std::string expected = std::string("a name for ") + description_of(kind);
    if (peek().text.empty() || script_table::is_keyword(peek().text)) unexpected(peek(), expected);
    if (looks_like_number(peek().text)) unexpected(take(), expected);
    const ScriptToken token = take();
    if (const auto other = m_symbols.other_kind(kind, token.text))
        fault(position_of(token),
              in_quotes(token.text) + " is the name of " + description_of(*other) + " as well");
    return std::string(token.text);
}

double ScriptParser::take_number(const char* expected) {
    const ScriptToken token = take_operand(expected);
    const auto number = read_script_number(token.text, m_options.dialect);
    if (!number) unexpected(token, expected);
    return *number;
}

int ScriptParser::take_integer(const char* expected, int smallest, int largest) {
    const ScriptToken token = take_operand(expected);
    const auto number = read_script_number(token.text, m_options.dialect);
    if (!number || *number != std::floor(*number) || *number < smallest || *number > largest)
        unexpected(token, expected);
    return static_cast<int>(*number);
}

int ScriptParser::take_mention(OperandKind kind) {
    const ScriptToken token = peek();
    const int index = m_symbols.make(kind, take_name(kind), position_of(token));
    check_size(m_program.ellipsoids.size(), position_of(token));
    return index;
}

// --- Statements

void ScriptParser::end_statement() {
    m_entry = nullptr;
    if (strict() || m_peeked) return;
    const ScriptToken token = m_lexer.skip_line();
    if (token.text.empty()) return;
    report(Severity::warning, position_of(token), std::string(token.text), "",
           "found " + in_quotes(token.text) + " after the end of a statement: " +
               (script_table::find_statement(token.text) && begins_statement(token)
                    ? "a statement begins on a new line, and the rest of this one is passed over"
                    : "the rest of the line is passed over"));
}

void ScriptParser::unknown_statement(const ScriptToken& token) {
    if (script_table::is_keyword(token.text))
        unexpected(token,
                   "a declaration or a movement: before an action stand how it is spread and two frames, "
                   "as in linear 0 9 " +
                       std::string(token.text));
    unexpected(token, "a declaration or a movement" +
                          suggestion(nearest_of(token.text, script_table::words(false))));
}

void ScriptParser::warn_of_short_form(const ScriptToken& token, const script_table::Entry& entry,
                                      bool action) {
    const auto* rival = script_table::rival_of(entry, token.text, action);
    if (!rival || !m_short_forms.emplace(token.text).second) return;
    report(Severity::warning, position_of(token), std::string(token.text), "",
           in_quotes(token.text) + " is taken for " + in_quotes(entry.word) + ", and not for " +
               in_quotes(rival->word));
}

bool ScriptParser::statement(bool library) {
    m_entry = nullptr;
    const ScriptToken token = take();
    if (token.text.empty()) {
        if (!library)
            report(Severity::error, position_of(token), "the end of the text", "stop",
                   "found the end of the text, expected stop");
        return false;
    }
    const auto* entry = script_table::find_statement(token.text);
    if (!entry) unknown_statement(token);
    warn_of_short_form(token, *entry, false);
    m_entry = entry;
    m_entry_position = position_of(token);
    return rest_of_statement(*entry, token, library);
}

bool ScriptParser::rest_of_statement(const script_table::Entry& entry, const ScriptToken& word,
                                     bool library) {
    switch (entry.keyword) {
        case Keyword::figure:
            figure();
            break;
        case Keyword::ellipsoid:
            ellipsoid();
            break;
        case Keyword::joint:
            joint();
            break;
        case Keyword::limit:
            limit();
            break;
        case Keyword::variables:
            variables();
            break;
        case Keyword::subroutine:
            begin_subroutine();
            break;
        case Keyword::endsub:
            end_subroutine();
            break;
        case Keyword::speed:
            speed();
            break;
        case Keyword::view:
            view();
            break;
        case Keyword::debug:
            m_program.trace = take_number("a number") <= 0;
            break;
        case Keyword::include:
            parse_included(std::string(take_operand("a file name").text), position_of(word));
            break;
        case Keyword::stop:
            if (library) fault(position_of(word), "a library has no stop");
            return false;
        case Keyword::distribution:
            movement(entry.distribution);
            break;
        case Keyword::ignored:
            report(Severity::warning, position_of(word), std::string(word.text), "",
                   in_quotes(word.text) + " is passed over");
            skip_to_statement();
            break;
        default:
            m_entry = nullptr;
            unexpected(word, "a declaration or a movement: it is a word of the first versions");
    }
    return true;
}

void ScriptParser::figure() {
    const ScriptToken token = peek();
    const std::string name = take_name(OperandKind::figure);
    const int index = m_symbols.make(OperandKind::figure, name, position_of(token));
    FigureDeclaration declared = m_program.figures[static_cast<std::size_t>(index)];
    if (index < 2 || !declared.ellipsoids.empty())
        error(position_of(token), "the figure " + in_quotes(name) + " is declared twice");
    declared.ellipsoids.clear();
    const int count = take_integer("the number of ellipsoids, an integer of at least 1", 1, kMostCount);
    for (int i = 0; i < count; ++i) {
        const int ellipsoid = take_mention(OperandKind::ellipsoid);
        if (ellipsoid == 0) error(position_of(token), "world is no ellipsoid of a figure");
        declared.ellipsoids.push_back(ellipsoid);
    }
    declared.position = position_of(token);
    m_program.figures[static_cast<std::size_t>(index)] = declared;
}

void ScriptParser::ellipsoid() {
    const ScriptToken token = peek();
    const int index = take_mention(OperandKind::ellipsoid);
    if (index == 0 || !m_shaped.insert(index).second)
        error(position_of(token), "the ellipsoid " + in_quotes(token.text) + " is declared twice");
    glm::dvec3 axes(0.0);
    for (int i = 0; i < 3; ++i) axes[i] = take_number("a number, half the length of an axis");
    if (axes.x < 0 || axes.y < 0 || axes.z < 0) fault(position_of(token), "an axis is negative");
    m_program.ellipsoids[static_cast<std::size_t>(index)].axes = axes;
}

void ScriptParser::joint() {
    const ScriptToken token = peek();
    const std::string name = take_name(OperandKind::joint);
    const auto index = static_cast<std::size_t>(m_symbols.make(OperandKind::joint, name, position_of(token)));
    if (!m_program.joints[index].attached)
        error(position_of(token), "the joint " + in_quotes(name) + " is declared twice");
    check_size(index, position_of(token));
    JointDeclaration declared = m_program.joints[index];
    declared.attached = false;
    for (int side = 0; side < 2; ++side) {
        (side ? declared.second : declared.first) = take_mention(OperandKind::ellipsoid);
        glm::dvec3& offset = side ? declared.second_offset : declared.first_offset;
        for (int i = 0; i < 3; ++i) offset[i] = take_number("a number, a coordinate of the joint");
    }
    if (declared.first == 0 || declared.second == 0)
        error(position_of(token), "a joint does not connect world");
    else
        m_program.joints[index] = declared;
}

void ScriptParser::limit() {
    const ScriptToken token = take_operand("a joint");
    const auto index = m_symbols.find(OperandKind::joint, token.text);
    if (!index) unexpected(token, "a joint");
    std::array<double, 6> limit{};
    for (double& v : limit) v = take_number("a number, an angle");
    for (std::size_t i = 0; i < 6; i += 2)
        if (limit[i] > limit[i + 1])
            return error(position_of(token), "a smallest angle is above the largest");
    m_program.joints[static_cast<std::size_t>(*index)].limit = limit;
}

void ScriptParser::variables() {
    const int count = take_integer("the number of variables, an integer of at least 1", 1, kMostCount);
    for (int i = 0; i < count; ++i) {
        const ScriptToken token = peek();
        const std::string name = take_name(OperandKind::variable);
        // All are global: what looks like one of a subroutine's own is not.
        if (strict() && m_symbols.find(OperandKind::variable, name))
            error(position_of(token), "the variable " + in_quotes(name) + " is declared twice");
        m_symbols.make(OperandKind::variable, name, position_of(token));
        check_size(m_program.variables.size(), position_of(token));
    }
}

void ScriptParser::begin_subroutine() {
    const ScriptToken token = peek();
    const std::string name = take_name(OperandKind::subroutine);
    if (m_subroutine != 0) error(position_of(token), "a subroutine begins inside of another");
    const int index = m_symbols.make(OperandKind::subroutine, name, position_of(token));
    if (!m_defined_subroutines.insert(index).second) {
        error(position_of(token), "the subroutine " + in_quotes(name) + " is declared twice");
        return;
    }
    m_subroutine = index;
    m_parameters.clear();
    if (strict() && looks_like_number(peek().text)) parameters();
}

void ScriptParser::parameters() {
    const int count = take_integer("the number of parameters, an integer of at least 0", 0, kMostCount);
    for (int i = 0; i < count; ++i) {
        const ScriptToken token = peek();
        const std::string name = take_name(OperandKind::parameter);
        if (!m_symbols.other_kind(OperandKind::parameter, name))
            m_parameter_names.emplace_back(name, position_of(token));
        if (!m_parameters.emplace(name, i).second)
            error(position_of(token), "the parameter " + in_quotes(name) + " is declared twice");
        auto& declared = m_program.subroutines[static_cast<std::size_t>(m_subroutine)].parameters;
        declared.push_back(name);
        check_size(declared.size(), position_of(token));
    }
}

void ScriptParser::end_subroutine() {
    const ScriptToken token = take_operand("a subroutine");
    const std::string& current = m_program.subroutines[static_cast<std::size_t>(m_subroutine)].name;
    if (m_subroutine == 0)
        error(position_of(token), "a subroutine ends that has not begun");
    else if (current != token.text)
        report(Severity::error, position_of(token), std::string(token.text), current,
               "found the end of " + in_quotes(token.text) + ", expected the end of " + in_quotes(current));
    m_subroutine = 0;
    m_parameters.clear();
}

void ScriptParser::speed() {
    const ScriptToken token = peek();
    const int k = take_integer("an integer other than 0", -kMostCount, kMostCount);
    if (k == 0) unexpected(token, "an integer other than 0");
    m_program.speed = k;
}

void ScriptParser::view() {
    std::array<int, 2> frames{};
    // Drivers write the largest number they know for "to the end".
    constexpr int kAny = std::numeric_limits<int>::max();
    for (int& f : frames) f = std::clamp(take_integer("a frame", -kAny, kAny), -kLargestFrame, kLargestFrame);
    m_program.view = frames;
}

}  // namespace anamorph::figure
