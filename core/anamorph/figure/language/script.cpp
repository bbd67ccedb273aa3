// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/language/script.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "anamorph/error.h"
#include "anamorph/figure/language/script_parser.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {
namespace {

using text_file::excerpt;

/// Sets of ellipsoids that joints connect.
class Components {
  public:
    explicit Components(std::size_t size) : m_parent(size) { std::iota(m_parent.begin(), m_parent.end(), 0); }

    int find(int i) {
        auto& parent = m_parent[static_cast<std::size_t>(i)];
        while (m_parent[static_cast<std::size_t>(parent)] != parent)
            parent = m_parent[static_cast<std::size_t>(parent)];
        return parent;
    }
    /// False when they were connected before.
    bool join(int a, int b) {
        a = find(a);
        b = find(b);
        m_parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
        return a != b;
    }

  private:
    std::vector<int> m_parent;
};

class Checker {
  public:
    explicit Checker(Script& script) : m_script(script), m_program(script.program) {}

    void check() {
        Components components(m_program.ellipsoids.size());
        for (const JointDeclaration& joint : m_program.joints)
            if (!joint.attached && !components.join(joint.first, joint.second))
                report(m_program.dialect == Dialect::strict, joint.position,
                       "the joint " + in_quotes(joint.name) + " closes a ring");
        for (const FigureDeclaration& figure : m_program.figures) {
            const auto apart = std::find_if(figure.ellipsoids.begin(), figure.ellipsoids.end(), [&](int e) {
                return components.find(e) != components.find(figure.ellipsoids.front());
            });
            if (apart != figure.ellipsoids.end())
                report(false, figure.position,
                       "no joint connects " + in_quotes(ellipsoid(*apart)) + " with " +
                           in_quotes(ellipsoid(figure.ellipsoids.front())) +
                           ": it will not move with the figure");
        }
        if (m_program.dialect == Dialect::strict) {
            check_calls();
            check_handed_over();
        }
        check_ends();
    }

  private:
    const std::string& ellipsoid(int index) const {
        return m_program.ellipsoids[static_cast<std::size_t>(index)].name;
    }

    void report(bool error, const ScriptPosition& position, const std::string& message) {
        m_script.diagnostics.push_back({error ? Severity::error : Severity::warning,
                                        m_program.files[static_cast<std::size_t>(position.file)],
                                        position.line, position.column, "", "", message,
                                        m_program.included_from(position.file)});
    }

    /// Takes away, again and again, subroutines that call none of those left: a ring remains.
    void check_calls() {
        const std::size_t count = m_program.subroutines.size();
        std::vector<std::size_t> calls(count);
        std::vector<std::vector<std::size_t>> callers(count);
        for (std::size_t i = 0; i < count; ++i)
            for (const Movement& m : m_program.subroutines[i].movements)
                if (m.action == Action::call && m.operands[0].kind == OperandKind::subroutine) {
                    callers[static_cast<std::size_t>(m.operands[0].index)].push_back(i);
                    ++calls[i];
                }
        std::vector<std::size_t> leaves;
        for (std::size_t i = 0; i < count; ++i)
            if (calls[i] == 0) leaves.push_back(i);
        for (std::size_t at = 0; at < leaves.size(); ++at)
            for (const std::size_t caller : callers[leaves[at]])
                if (--calls[caller] == 0) leaves.push_back(caller);
        for (std::size_t i = 1; i < count; ++i)
            if (calls[i] > 0)
                return report(
                    true, m_program.subroutines[i].position,
                    "subroutines call themselves, by way of " + in_quotes(m_program.subroutines[i].name));
    }

    /// Whether calls hand over as many values as there are parameters, and what these stand for.
    void check_handed_over() {
        const ParameterUses uses = parameter_uses(m_program);
        for (const Subroutine& s : m_program.subroutines)
            for (const Movement& m : s.movements) {
                if (m.action != Action::call || m.operands[0].kind != OperandKind::subroutine) continue;
                const auto to = static_cast<std::size_t>(m.operands[0].index);
                const Subroutine& called = m_program.subroutines[to];
                if (const std::string fault = wrong_count(called, m.operands.size() - 1); !fault.empty()) {
                    report(true, m.position, fault);
                    continue;
                }
                for (std::size_t i = 0; i < called.parameters.size(); ++i)
                    for (const char letter : uses[to][i])
                        if (!fits(letter, m.operands[i + 1]))
                            report(true, m.position, wrong_value(called, i, letter, m.operands[i + 1]));
            }
    }

    /// Which subroutines the script may come to: all, where a variable says which.
    std::vector<bool> called() const {
        std::vector<bool> found(m_program.subroutines.size());
        std::vector<std::size_t> waiting{0};
        found[0] = true;
        while (!waiting.empty()) {
            const std::size_t s = waiting.back();
            waiting.pop_back();
            for (const Movement& m : m_program.subroutines[s].movements) {
                if (m.action != Action::call) continue;
                if (m.operands[0].kind != OperandKind::subroutine)
                    return std::vector<bool>(found.size(), true);
                const auto to = static_cast<std::size_t>(m.operands[0].index);
                if (!found[to]) waiting.push_back(to);
                found[to] = true;
            }
        }
        return found;
    }

    /// Joints that `attach` makes, whose ends are known only when the script is performed.
    std::vector<bool> attached_joints() const {
        std::vector<bool> attached(m_program.joints.size());
        for (std::size_t j = 0; j < attached.size(); ++j) attached[j] = m_program.joints[j].attached;
        for (const Subroutine& s : m_program.subroutines)
            for (const Movement& m : s.movements) {
                if (m.action != Action::attach) continue;
                if (m.operands[1].kind != OperandKind::joint) return std::vector<bool>(attached.size(), true);
                attached[static_cast<std::size_t>(m.operands[1].index)] = true;
            }
        return attached;
    }

    /// The positions of an action's operands of which the first must be an ellipsoid at the second, a joint.
    static std::optional<std::array<std::size_t, 2>> end_and_joint(Action action) {
        switch (action) {
            case Action::flex:
            case Action::rotate:
            case Action::abduct:
            case Action::grojnt:
            case Action::detach:
                return {{0, 1}};
            case Action::movjnt:
                return {{1, 0}};
            case Action::drag:
                return {{1, 2}};
            default:
                return std::nullopt;
        }
    }

    /// Joints that are not at the ellipsoid they are named with: an error where the script comes there.
    void check_ends() {
        const std::vector<bool> reached = called(), attached = attached_joints();
        for (std::size_t s = 0; s < m_program.subroutines.size(); ++s)
            for (const Movement& m : m_program.subroutines[s].movements) {
                const auto places = end_and_joint(m.action);
                if (!places) continue;
                const Operand &end = m.operands[(*places)[0]], &at = m.operands[(*places)[1]];
                if (end.kind != OperandKind::ellipsoid || at.kind != OperandKind::joint ||
                    attached[static_cast<std::size_t>(at.index)])
                    continue;
                const JointDeclaration& joint = m_program.joints[static_cast<std::size_t>(at.index)];
                if (end.index != joint.first && end.index != joint.second)
                    report(reached[s] && !runs_backwards(m), m.position,
                           std::string(name_of(m.action)) + ": the ellipsoid " +
                               in_quotes(ellipsoid(end.index)) + " is not at the joint " +
                               in_quotes(joint.name) + ", which connects " +
                               in_quotes(ellipsoid(joint.first)) + " and " +
                               in_quotes(ellipsoid(joint.second)));
            }
    }

    Script& m_script;
    Program& m_program;
};

/// Adds letters to those that a parameter stands for; false where it has them all.
bool add_letters(std::string& to, std::string_view letters) {
    const std::size_t before = to.size();
    for (const char letter : letters)
        if (to.find(letter) == std::string::npos) to += letter;
    return to.size() != before;
}

}  // namespace

ParameterUses parameter_uses(const Program& program) {
    using Place = std::pair<std::size_t, std::size_t>;  // of a parameter: its subroutine, its position there
    ParameterUses uses;
    for (const Subroutine& s : program.subroutines) uses.emplace_back(s.parameters.size());
    std::map<Place, std::vector<Place>> handed_on;  // to a parameter, by those
    std::vector<Place> changed;
    for (std::size_t s = 0; s < uses.size(); ++s)
        for (const Movement& m : program.subroutines[s].movements) {
            const auto note = [&](const Operand& operand, std::string_view letter) {
                if (operand.kind != OperandKind::parameter) return;
                const Place place{s, static_cast<std::size_t>(operand.index)};
                if (add_letters(uses[place.first][place.second], letter)) changed.push_back(place);
            };
            note(m.start, "n");
            note(m.stop, "n");
            const std::string_view letters = script_table::operands_of(m.action);
            for (std::size_t i = 0; i < letters.size(); ++i) note(m.operands[i], letters.substr(i, 1));
            if (m.action != Action::call || m.operands[0].kind != OperandKind::subroutine) continue;
            const auto to = static_cast<std::size_t>(m.operands[0].index);
            for (std::size_t i = 1; i < m.operands.size() && i <= uses[to].size(); ++i)
                if (m.operands[i].kind == OperandKind::parameter)
                    handed_on[{to, i - 1}].emplace_back(s, static_cast<std::size_t>(m.operands[i].index));
        }
    // What a parameter is handed on to, it stands for itself.
    while (!changed.empty()) {
        const Place at = changed.back();
        changed.pop_back();
        const auto from = handed_on.find(at);
        if (from == handed_on.end()) continue;
        for (const Place& place : from->second)
            if (add_letters(uses[place.first][place.second], uses[at.first][at.second]))
                changed.push_back(place);
    }
    return uses;
}

std::string wrong_count(const Subroutine& called, std::size_t values) {
    const std::size_t wanted = called.parameters.size();
    if (values == wanted) return {};
    return "call hands over " + std::to_string(values) + " values, but the parameters of " +
           in_quotes(called.name) + " are " + std::to_string(wanted) +
           (values == 0 ? ": after the name stand how many values follow, and these" : "");
}

std::string wrong_value(const Subroutine& called, std::size_t parameter, char letter,
                        const Operand& operand) {
    return "call hands over " + std::string(description_of(operand.kind)) + ", but the parameter " +
           in_quotes(called.parameters[parameter]) + " of " + in_quotes(called.name) + " stands for " +
           description_of(letter);
}

void check_program(Script& script) {
    Checker(script).check();
}

std::string Program::where(const ScriptPosition& position) const {
    const auto file = static_cast<std::size_t>(position.file);
    return (file < files.size() ? excerpt(files[file]) : "script") + ":" + std::to_string(position.line) +
           ":" + std::to_string(position.column);
}

std::string Program::included_from(int file) const {
    std::string text;
    for (auto f = static_cast<std::size_t>(file); f < included_at.size() && included_at[f].line > 0;
         f = static_cast<std::size_t>(included_at[f].file))
        text += (text.empty() ? " (included at " : ", at ") + where(included_at[f]);
    return text.empty() ? text : text + ")";
}

std::string Diagnostic::text() const {
    return excerpt(file) + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " +
           (severity == Severity::error ? "error: " : "warning: ") + message + included_from;
}

bool Script::ok() const {
    return std::none_of(diagnostics.begin(), diagnostics.end(),
                        [](const Diagnostic& d) { return d.severity == Severity::error; });
}

Script parse_script(std::string_view text, std::string_view name, const ScriptOptions& options) {
    Script script;
    if (text_file::ends_with(name, ".lbn")) {
        // The editor LED writes such scores, and the program lintel makes scripts of them.
        script.diagnostics.push_back(
            {Severity::error, std::string(name), 1, 1, "", "",
             "is a score in Labanotation (.lbn), not a script: must be made one (.n) by lintel", ""});
        return script;
    }
    ScriptParser parser(script, options);
    try {
        parser.parse(text, name);
    } catch (const ScriptTooBad&) {
        // The diagnostics say why.
    }
    return script;
}

Program parse_program(std::string_view text, std::string_view name, const ScriptOptions& options) {
    Script script = parse_script(text, name, options);
    for (const Diagnostic& d : script.diagnostics)
        if (d.severity == Severity::error) throw Error(d.text());
    return std::move(script.program);
}

}  // namespace anamorph::figure
