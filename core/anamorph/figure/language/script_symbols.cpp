// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/language/script_symbols.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {
namespace {

std::size_t column(OperandKind kind) {
    return static_cast<std::size_t>(kind);
}

/// The kinds that are looked up for a letter, after variables.
std::string_view kinds_for(char letter) {
    switch (letter) {
        case 'j':
        case 'J':
            return "j";
        case 'f':
        case 'F':
            return "f";
        case '*':
            return "ejfsa";
        case 'e':
            return "e";
        case 's':
            return "s";
        case 'a':
            return "a";
        case 'i':
            return "i";
        default:
            return "";
    }
}

OperandKind kind_of(char letter) {
    switch (letter) {
        case 'e':
            return OperandKind::ellipsoid;
        case 'j':
            return OperandKind::joint;
        case 'f':
            return OperandKind::figure;
        case 's':
            return OperandKind::subroutine;
        case 'a':
            return OperandKind::axis;
        default:
            return OperandKind::image;
    }
}

}  // namespace

const char* description_of(char letter) {
    switch (letter) {
        case 'n':
            return "a number or a variable";
        case 'v':
            return "a variable";
        case 'e':
            return "an ellipsoid";
        case 'j':
        case 'J':
            return "a joint";
        case 'f':
        case 'F':
            return "a figure";
        case 'a':
            return "an axis, x, y or z";
        case 's':
            return "a subroutine";
        case 'i':
            return "a picture";
        default:
            return "a number or a name";
    }
}

const char* description_of(OperandKind kind) {
    switch (kind) {
        case OperandKind::number:
            return "a number";
        case OperandKind::variable:
            return "a variable";
        case OperandKind::ellipsoid:
            return "an ellipsoid";
        case OperandKind::joint:
            return "a joint";
        case OperandKind::figure:
            return "a figure";
        case OperandKind::axis:
            return "an axis";
        case OperandKind::subroutine:
            return "a subroutine";
        case OperandKind::image:
            return "a picture";
        case OperandKind::parameter:
            return "a parameter";
    }
    return "";
}

bool fits(char letter, const Operand& operand) {
    const OperandKind kind = operand.kind;
    if (letter == '*' || kind == OperandKind::parameter) return true;
    if (letter == 'n') return kind == OperandKind::number || kind == OperandKind::variable;
    if (letter == 'v') return kind == OperandKind::variable;
    if (letter == 'J') letter = 'j';
    if (letter == 'F') letter = 'f';
    // World is an ellipsoid and a figure.
    const bool world = letter == 'f' && kind == OperandKind::ellipsoid && operand.index == 0;
    return kind == OperandKind::variable || world || (kind == kind_of(letter) && !kinds_for(letter).empty());
}

std::string in_quotes(std::string_view text) {
    std::string out(1, '"');
    out += text_file::excerpt(text);
    out += '"';
    return out;
}

namespace {

/// How many letters are to be exchanged, put in, taken out, or swapped with the next to turn a into b.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
    std::iota(last.begin(), last.end(), 0);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool same = a[i - 1] == b[j - 1];
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0 : 1)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        before = std::exchange(last, row);
    }
    return last[b.size()];
}

}  // namespace

std::string nearest_of(std::string_view word, const std::vector<std::string_view>& candidates) {
    // Names are short; in longer ones, and among very many, it is not worth the time.
    constexpr std::size_t kLongest = 32, kMostCandidates = 10000;
    if (word.size() > kLongest || candidates.size() > kMostCandidates) return {};
    std::size_t least = std::max<std::size_t>(word.size() / 3, 1) + 1;
    std::string_view nearest;
    for (const std::string_view candidate : candidates) {
        const std::size_t longer = std::max(candidate.size(), word.size()),
                          shorter = std::min(candidate.size(), word.size());
        if (shorter < 2 || longer - shorter > least) continue;
        const std::size_t distance = edit_distance(word, candidate);
        const bool tie = distance == least && !nearest.empty() && candidate < nearest;
        if (distance < least || tie) {
            least = distance;
            nearest = candidate;
        }
    }
    return std::string(nearest);
}

std::string suggestion(const std::string& name) {
    return name.empty() ? std::string() : ", did you mean " + in_quotes(name) + "?";
}

ScriptSymbols::ScriptSymbols(Program& program) : m_program(program) {
    make(OperandKind::subroutine, "nudes", {});
    make(OperandKind::figure, "every", {});
    make(OperandKind::figure, "world", {});
    make(OperandKind::ellipsoid, "world", {});
    make(OperandKind::variable, "variab", {});
    constexpr const char* axes[] = {"x", "y", "z"};
    for (int i = 0; i < 3; ++i) {
        auto& row = m_indices.try_emplace(axes[i]).first->second;
        row.fill(-1);
        row[column(OperandKind::axis)] = i;
    }
}

std::optional<int> ScriptSymbols::find(OperandKind kind, std::string_view name) const {
    const auto found = m_indices.find(std::string(name));
    if (found == m_indices.end() || found->second[column(kind)] < 0) return std::nullopt;
    return found->second[column(kind)];
}

int ScriptSymbols::make(OperandKind kind, std::string_view name, const ScriptPosition& position) {
    const auto [entry, inserted] = m_indices.try_emplace(std::string(name));
    if (inserted) entry->second.fill(-1);
    int& index = entry->second[column(kind)];
    if (index >= 0) return index;
    const auto append = [&](auto& table, auto item) {
        index = static_cast<int>(table.size());
        table.push_back(std::move(item));
    };
    const std::string text(name);
    switch (kind) {
        case OperandKind::ellipsoid:
            append(m_program.ellipsoids, EllipsoidDeclaration{text, glm::dvec3(1.0), position});
            break;
        case OperandKind::joint: {
            JointDeclaration joint;
            joint.name = text;
            joint.attached = true;
            joint.position = position;
            append(m_program.joints, joint);
            break;
        }
        case OperandKind::figure:
            append(m_program.figures, FigureDeclaration{text, {}, position});
            break;
        case OperandKind::subroutine:
            append(m_program.subroutines, Subroutine{text, {}, {}, position});
            break;
        case OperandKind::variable:
            append(m_program.variables, text);
            break;
        default:
            append(m_program.images, text);
    }
    return index;
}

std::optional<OperandKind> ScriptSymbols::other_kind(OperandKind kind, std::string_view name) const {
    for (const char letter : std::string_view("ejfsa"))
        if (kind_of(letter) != kind && find(kind_of(letter), name)) return kind_of(letter);
    if (kind != OperandKind::variable && find(OperandKind::variable, name)) return OperandKind::variable;
    return std::nullopt;
}

bool ScriptSymbols::known(std::string_view name) const {
    return m_indices.contains(std::string(name));
}

std::optional<Operand> ScriptSymbols::resolve(char letter, std::string_view name) const {
    if (const auto variable = find(OperandKind::variable, name))
        return Operand{OperandKind::variable, 0, *variable};
    for (const char kind : kinds_for(letter))
        if (const auto index = find(kind_of(kind), name)) return Operand{kind_of(kind), 0, *index};
    return std::nullopt;
}

std::string ScriptSymbols::nearest(char letter, std::string_view name) const {
    std::vector<std::string_view> candidates;
    for (const auto& [known, row] : m_indices) {
        bool fits = letter != 'J' && letter != 'F' && row[column(OperandKind::variable)] >= 0;
        for (const char kind : kinds_for(letter)) fits = fits || row[column(kind_of(kind))] >= 0;
        if (fits) candidates.push_back(known);
    }
    return nearest_of(name, candidates);
}

}  // namespace anamorph::figure
