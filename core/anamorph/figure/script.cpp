// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/script.h"

#include <algorithm>
#include <numeric>

#include "anamorph/error.h"
#include "anamorph/figure/script_parser.h"
#include "anamorph/text_file.h"

namespace anamorph {
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
                       "the joint " + quoted(joint.name) + " closes a ring");
        for (const FigureDeclaration& figure : m_program.figures) {
            const auto apart = std::find_if(figure.ellipsoids.begin(), figure.ellipsoids.end(), [&](int e) {
                return components.find(e) != components.find(figure.ellipsoids.front());
            });
            if (apart != figure.ellipsoids.end())
                report(false, figure.position,
                       "no joint connects " + quoted(ellipsoid(*apart)) + " with " +
                           quoted(ellipsoid(figure.ellipsoids.front())) +
                           ": it will not move with the figure");
        }
        if (m_program.dialect == Dialect::strict) check_calls();
    }

  private:
    const std::string& ellipsoid(int index) const {
        return m_program.ellipsoids[static_cast<std::size_t>(index)].name;
    }

    void report(bool error, const ScriptPosition& position, const std::string& message) {
        m_script.diagnostics.push_back({error ? Severity::error : Severity::warning,
                                        m_program.files[static_cast<std::size_t>(position.file)],
                                        position.line, position.column, "", "", message});
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
                    "subroutines call themselves, by way of " + quoted(m_program.subroutines[i].name));
    }

    Script& m_script;
    Program& m_program;
};

}  // namespace

void check_program(Script& script) {
    Checker(script).check();
}

std::string Program::where(const ScriptPosition& position) const {
    const auto file = static_cast<std::size_t>(position.file);
    return (file < files.size() ? excerpt(files[file]) : "script") + ":" + std::to_string(position.line) +
           ":" + std::to_string(position.column);
}

std::string Diagnostic::text() const {
    return excerpt(file) + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " +
           (severity == Severity::error ? "error: " : "warning: ") + message;
}

bool Script::ok() const {
    return std::none_of(diagnostics.begin(), diagnostics.end(),
                        [](const Diagnostic& d) { return d.severity == Severity::error; });
}

Script parse_script(std::string_view text, std::string_view name, const ScriptOptions& options) {
    Script script;
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

}  // namespace anamorph
