// SPDX-License-Identifier: Apache-2.0
// Movements, and the names in them that are declared later.
#include <algorithm>
#include <utility>

#include "anamorph/figure/language/script_parser.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {

void ScriptParser::movement(Distribution distribution) {
    Movement m;
    m.distribution = distribution;
    std::vector<Pending> waiting;
    bool usable = true;
    const auto take = [&](char letter, std::size_t position) {
        Pending pending;
        bool waits = false;
        const Operand operand = take_value(letter, pending, waits, usable);
        pending.operand = position;
        if (waits) waiting.push_back(pending);
        return operand;
    };
    const ScriptToken first = peek();
    m.start = take('n', 0);
    m.stop = take('n', 1);
    const script_table::Entry* entry = script_table::find_action("call");
    m.position = position_of(peek());
    if (distribution == Distribution::call) {
        m.position = position_of(first);
    } else {
        const ScriptToken token = peek();
        entry = script_table::find_action(token.text);
        if (!entry)
            unexpected(token, "an action" + suggestion(nearest_of(token.text, script_table::words(true))));
        this->take();
        warn_of_short_form(token, *entry, true);
        m_entry = entry;
        m_entry_position = m.position;
        if (entry->keyword == script_table::Keyword::ignored) {
            report(Severity::warning, m.position, std::string(token.text), "",
                   in_quotes(token.text) + " is passed over");
            return skip_to_statement();
        }
    }
    m.action = entry->action;
    for (const char letter : entry->operands) m.operands.push_back(take(letter, 2 + m.operands.size()));
    if (m.action == Action::call && strict() && looks_like_number(peek().text)) {
        const int count =
            take_integer("the number of values handed over, an integer of at least 0", 0, kMostCount);
        for (int i = 0; i < count; ++i) {
            m.operands.push_back(take('*', 2 + m.operands.size()));
            check_size(m.operands.size(), m.position);
        }
    }
    if (!usable) return;
    check_frames(m);
    auto& movements = m_program.subroutines[static_cast<std::size_t>(m_subroutine)].movements;
    for (Pending& pending : waiting) {
        pending.subroutine = m_subroutine;
        pending.movement = movements.size();
        m_pending.push_back(pending);
    }
    movements.push_back(std::move(m));
    check_size(movements.size(), movements.back().position);
}

void ScriptParser::check_frames(const Movement& m) {
    if (runs_backwards(m)) fault(m.position, "the frames run backwards: it never happens");
}

Operand ScriptParser::take_value(char letter, Pending& pending, bool& waits, bool& usable) {
    const char* expected = description_of(letter);
    const ScriptToken token = take_operand(expected);
    const ScriptPosition position = position_of(token);
    const auto refuse = [&] {
        usable = false;
        report(Severity::error, position, std::string(token.text), expected,
               "found " + in_quotes(token.text) + ", expected " + expected +
                   suggestion(m_symbols.nearest(letter, token.text)) + usage());
        return Operand{};
    };
    if (looks_like_number(token.text)) {
        const auto number = read_script_number(token.text, m_options.dialect);
        if (!number || (letter != 'n' && letter != '*')) return refuse();
        return {OperandKind::number, *number, 0};
    }
    if (const auto parameter = parameter_of(token.text)) {
        return {OperandKind::parameter, 0, *parameter};
    }
    if (const auto found = m_symbols.resolve(letter, token.text)) {
        if (letter == 'v' && found->kind != OperandKind::variable) return refuse();
        return *found;
    }
    // Joints, figures and pictures may be new here.
    const auto made = [&](OperandKind kind) {
        if (const auto other = m_symbols.other_kind(kind, token.text))
            fault(position, in_quotes(token.text) + " is the name of " + description_of(*other) + " as well");
        return Operand{kind, 0, m_symbols.make(kind, token.text, position)};
    };
    if (letter == 'J') return made(OperandKind::joint);
    if (letter == 'F') return made(OperandKind::figure);
    if (letter == 'i')
        return {OperandKind::image, 0, m_symbols.make(OperandKind::image, token.text, position)};
    if (letter != 's' && letter != '*' && strict()) return refuse();
    pending.letter = letter;
    pending.name = token.text;
    pending.usage = usage();
    pending.position = position;
    waits = true;
    return {};
}

std::optional<int> ScriptParser::parameter_of(std::string_view name) const {
    const auto found = m_parameters.find(name);
    return found == m_parameters.end() ? std::nullopt : std::optional(found->second);
}

std::optional<Operand> ScriptParser::made_for_parameter(const Pending& pending, const ParameterUses& uses) {
    const Movement& m =
        m_program.subroutines[static_cast<std::size_t>(pending.subroutine)].movements[pending.movement];
    if (pending.operand < 3 || m.action != Action::call || m.operands[0].kind != OperandKind::subroutine)
        return std::nullopt;
    const std::vector<std::string>& parameters = uses[static_cast<std::size_t>(m.operands[0].index)];
    if (pending.operand - 3 >= parameters.size()) return std::nullopt;
    const std::string& letters = parameters[pending.operand - 3];
    for (const auto& [letter, kind] : {std::pair('i', OperandKind::image), std::pair('J', OperandKind::joint),
                                       std::pair('F', OperandKind::figure)})
        if (letters.find(letter) != std::string::npos)
            return Operand{kind, 0, m_symbols.make(kind, pending.name, pending.position)};
    return std::nullopt;
}

void ScriptParser::check_parameter_names() {
    for (const auto& [name, position] : m_parameter_names)
        if (const auto other = m_symbols.other_kind(OperandKind::parameter, name))
            error(position, in_quotes(name) + " is the name of " + description_of(*other) + " as well");
}

void ScriptParser::resolve_pending() {
    const auto operand_of = [&](const Pending& p) -> Operand& {
        Movement& m = m_program.subroutines[static_cast<std::size_t>(p.subroutine)].movements[p.movement];
        return p.operand == 0 ? m.start : p.operand == 1 ? m.stop : m.operands[p.operand - 2];
    };
    // What values of calls are may hang on the subroutines.
    for (const Pending& p : m_pending)
        if (p.letter == 's') operand_of(p) = m_symbols.resolve('s', p.name).value_or(Operand{});
    const ParameterUses uses = parameter_uses(m_program);
    for (const Pending& p : m_pending) {
        auto found = m_symbols.resolve(p.letter, p.name);
        if (!found) found = made_for_parameter(p, uses);
        const bool wrong = found && p.letter == 'v' && found->kind != OperandKind::variable;
        const bool undefined =
            found && found->kind == OperandKind::subroutine && !m_defined_subroutines.contains(found->index);
        if (!found || wrong || undefined) {
            report(Severity::error, p.position, p.name, description_of(p.letter),
                   "found " + in_quotes(p.name) + ", expected " + description_of(p.letter) +
                       suggestion(m_symbols.nearest(p.letter, p.name)) + p.usage);
            continue;
        }
        operand_of(p) = *found;
    }
    check_parameter_names();
    // Ellipsoids are made where they are first named: each needs its shape somewhere.
    for (std::size_t i = 1; i < m_program.ellipsoids.size(); ++i)
        if (!m_shaped.contains(static_cast<int>(i)))
            error(m_program.ellipsoids[i].position,
                  "the ellipsoid " + in_quotes(m_program.ellipsoids[i].name) + " is declared nowhere");
}

}  // namespace anamorph::figure
