// SPDX-License-Identifier: Apache-2.0
// Operands, and the actions that move figures as they are and that calculate.
#include "anamorph/figure/language/actions.h"

#include <algorithm>
#include <cmath>

#include "anamorph/error.h"
#include "anamorph/figure/body/rotation.h"
#include "anamorph/figure/language/script_symbols.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {

using text_file::excerpt;

namespace {

std::size_t table_size(const Program& program, OperandKind kind) {
    switch (kind) {
        case OperandKind::ellipsoid:
            return program.ellipsoids.size();
        case OperandKind::joint:
            return program.joints.size();
        case OperandKind::figure:
            return program.figures.size();
        case OperandKind::subroutine:
            return program.subroutines.size();
        case OperandKind::axis:
            return 3;
        default:
            return program.images.size();
    }
}

[[noreturn]] void fail_at(const Program& program, const ScriptPosition& position, const std::string& what) {
    throw Error(program.where(position) + ": " + what);
}

/// Ellipsoid 0 and figures 0 and 1 are all the world, whichever way a variable came to hold it.
bool is_same_kind(const FigureState::Value& value, OperandKind kind) {
    if (value.kind == kind) return true;
    return value.kind == OperandKind::ellipsoid && kind == OperandKind::figure && value.number == 0;
}

}  // namespace

double FigureAction::number(const Program& program, const FigureState& state, const Operand& operand,
                            const ScriptPosition& position) {
    if (operand.kind == OperandKind::number) return operand.number;
    if (operand.kind != OperandKind::variable) return operand.index;
    const auto& value = state.variables[static_cast<std::size_t>(operand.index)];
    if (program.dialect == Dialect::strict) {
        const std::string name = excerpt(program.variables[static_cast<std::size_t>(operand.index)]);
        if (!value.set) fail_at(program, position, "the variable " + name + " is used before it is set");
        if (value.kind != OperandKind::number)
            fail_at(
                program, position,
                "the variable " + name + " holds " + description_of(value.kind) + ", but must hold a number");
    }
    return value.number;
}

int FigureAction::index(const Program& program, const FigureState& state, const Operand& operand,
                        OperandKind kind, const ScriptPosition& position) {
    if (operand.kind != OperandKind::variable) return operand.index;
    const auto& value = state.variables[static_cast<std::size_t>(operand.index)];
    const std::string name = excerpt(program.variables[static_cast<std::size_t>(operand.index)]);
    if (program.dialect == Dialect::strict && !value.set)
        fail_at(program, position, "the variable " + name + " is used before it is set");
    if (program.dialect == Dialect::strict && !is_same_kind(value, kind))
        fail_at(program, position,
                "the variable " + name + " holds " + description_of(value.kind) + ", but must hold " +
                    description_of(kind));
    if (!(value.number >= 0 && value.number < static_cast<double>(table_size(program, kind))))
        fail_at(program, position,
                "the variable " + name + " holds " + shortest(value.number) + ", which is not " +
                    description_of(kind));
    return static_cast<int>(value.number);
}

double FigureAction::number(std::size_t i) const {
    return number(m_program, m_state, m_movement.operands[i], m_movement.position);
}

glm::dvec3 FigureAction::vector(std::size_t i) const {
    return {number(i), number(i + 1), number(i + 2)};
}

int FigureAction::index(std::size_t i, OperandKind kind) const {
    return index(m_program, m_state, m_movement.operands[i], kind, m_movement.position);
}

int FigureAction::joint(std::size_t i) const {
    const int j = index(i, OperandKind::joint);
    if (!m_state.topology->joints[static_cast<std::size_t>(j)].joined)
        fail("there is no joint " + joint_name(j) + " at this moment");
    return j;
}

FigurePart FigureAction::figure(std::size_t i) const {
    const int f = index(i, OperandKind::figure);
    if (f >= 2 && m_state.topology->figure_first[static_cast<std::size_t>(f)] < 0)
        fail("there is no figure " + excerpt(m_program.figures[static_cast<std::size_t>(f)].name) +
             " at this moment");
    return part_of_figure(m_state, f);
}

glm::dvec3 FigureAction::direction(int ellipsoid, int axis) const {
    return glm::mat3_cast(body(ellipsoid).turn)[axis];
}

void FigureAction::store(std::size_t i, double value) const {
    const auto variable = static_cast<std::size_t>(m_movement.operands[i].index);
    if (!std::isfinite(value)) fail("the variable " + excerpt(m_program.variables[variable]) + " overflows");
    m_state.variables[variable] = {value, OperandKind::number, true};
}

void FigureAction::store(std::size_t i, const glm::dvec3& values) const {
    for (int k = 0; k < 3; ++k) store(i + static_cast<std::size_t>(k), values[k]);
}

void FigureAction::fail(const std::string& what) const {
    fail_at(m_program, m_movement.position,
            std::string(name_of(m_movement.action)) + " in frame " + std::to_string(m_frame) + ": " + what);
}

void FigureAction::say(const std::string& line) const {
    if (m_message) m_message(line);
}

std::string FigureAction::ellipsoid_name(int i) const {
    return excerpt(m_program.ellipsoids[static_cast<std::size_t>(i)].name);
}

std::string FigureAction::joint_name(int j) const {
    return excerpt(m_program.joints[static_cast<std::size_t>(j)].name);
}

// --- Figures

void FigureAction::check(const glm::dvec3& v, const std::string& what) const {
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
        fail(what + " is out of all bounds");
}

void FigureAction::check(const FigurePart& part) const {
    for (const int i : part.bodies) {
        const auto& b = body(i);
        const double sum = b.center.x + b.center.y + b.center.z + b.axes.x + b.axes.y + b.axes.z + b.turn.w +
                           b.turn.x + b.turn.y + b.turn.z;
        if (!std::isfinite(sum)) fail("the ellipsoid " + ellipsoid_name(i) + " is out of all bounds");
    }
    for (const int j : part.joints) check(joint_position(j), "the joint " + joint_name(j));
}

void FigureAction::move(const FigurePart& part, const glm::dvec3& by) const {
    translate(m_state, part, by);
    check(part);
}

void FigureAction::spin(const FigurePart& part, const glm::dquat& by, const glm::dvec3& about) const {
    turn(m_state, part, by, about);
    check(part);
}

glm::dvec3 FigureAction::towards(const glm::dvec3& now, const glm::dvec3& target,
                                 const std::string& what) const {
    const glm::dvec3 there = now + m_shares.prop * (target - now);
    check(there, what);
    return there;
}

void FigureAction::moveby() const {
    const FigurePart part = figure(0);
    move(part, m_shares.frac * (glm::mat3_cast(body(ellipsoid(1)).turn) * vector(2)));
}

void FigureAction::moveto() const {
    const FigurePart part = figure(0);
    move(part, m_shares.prop * (vector(2) - body(ellipsoid(1)).center));
}

void FigureAction::ground() const {
    const FigurePart part = figure(0);
    if (part.bodies.empty()) return;
    // The original takes its share of the whole out of what remains, and so does not arrive.
    const double share = strict() ? m_shares.prop : m_shares.frac;
    move(part, {0, -share * lowest(m_state, part.bodies), 0});
}

void FigureAction::spinby() const {
    const FigurePart part = figure(0);
    const glm::dvec3 axis_direction = direction(ellipsoid(2), axis(4));
    spin(part, turn_about(axis_direction, number(3) * m_shares.frac), body(ellipsoid(1)).center);
}

namespace {

/// A share of the shortest turn that takes `from` to `to`.
glm::dquat part_of_turn(const glm::dquat& from, const glm::dquat& to, double share) {
    glm::dquat whole = to * glm::conjugate(from);
    if (whole.w < 0) whole = -whole;
    const glm::dvec3 v(whole.x, whole.y, whole.z);
    const double sine = glm::length(v);
    if (sine == 0) return {1, 0, 0, 0};
    return turn_about(v / sine, 2 * std::atan2(sine, whole.w) / kRadiansPerDegree * share);
}

}  // namespace

void FigureAction::spinto() const {
    const FigurePart part = figure(0);
    const auto& moved = body(ellipsoid(1));
    const glm::dquat target = body(ellipsoid(2)).turn * turn_of_angles(vector(3));
    spin(part, part_of_turn(moved.turn, target, m_shares.prop), moved.center);
}

void FigureAction::bend(int ellipsoid, int joint, const glm::dquat& by) const {
    spin(part_from(m_state, ellipsoid, joint), by, joint_position(joint));
    if (strict()) enforce_limit(ellipsoid, joint);
}

void FigureAction::bendby() const {
    const glm::dvec3 axis_direction = direction(ellipsoid(2), axis(4));
    bend(ellipsoid(0), joint(1), turn_about(axis_direction, number(3) * m_shares.frac));
}

void FigureAction::bendto() const {
    const int bent = ellipsoid(0);
    const glm::dquat target = body(ellipsoid(2)).turn * turn_of_angles(vector(3));
    bend(bent, joint(1), part_of_turn(body(bent).turn, target, m_shares.prop));
}

bool FigureAction::is_left(int i) const {
    const int f = m_state.topology->figure_of(i);
    const int first = f < 0 ? 1 : m_state.topology->figure_first[static_cast<std::size_t>(f)];
    return (i - first) % 2 == 0;
}

void FigureAction::bend_own(Action action) const {
    const int bent = ellipsoid(0), at = joint(1);
    if (!m_state.topology->is_end(at, bent))
        fail("the ellipsoid " + ellipsoid_name(bent) + " is not at the joint " + joint_name(at));
    const int other = m_state.topology->other_end(at, bent);
    const double angle = number(2) * m_shares.frac;
    if (action == Action::flex) {
        const bool knee = joint_name(at).find("kne") != std::string::npos;
        bend(bent, at, turn_about(direction(other, 0), knee ? angle : -angle));
    } else if (action == Action::rotate) {
        bend(bent, at, turn_about(direction(bent, 1), is_left(bent) ? angle : -angle));
    } else {
        bend(bent, at, turn_about(direction(other, 2), is_left(bent) ? -angle : angle));
    }
}

void FigureAction::enforce_limit(int ellipsoid, int joint) const {
    const auto& limit = m_program.joints[static_cast<std::size_t>(joint)].limit;
    if (!limit) return;
    const auto& ends = m_state.topology->joints[static_cast<std::size_t>(joint)];
    const glm::dquat first = body(ends.first).turn, second = body(ends.second).turn;
    // The turn of the second ellipsoid as the first one sees it, as Rx Ry Rz.
    const glm::dvec3 angles = xyz_of_rotation(glm::mat3_cast(glm::conjugate(first) * second));
    glm::dvec3 kept;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto i = static_cast<int>(k);
        kept[i] = std::clamp(angles[i], (*limit)[2 * k], (*limit)[2 * k + 1]);
    }
    if (kept == angles) return;
    say("frame " + std::to_string(m_frame) + ", the joint " + joint_name(joint) + " is at its limit");
    const FigurePart part = part_from(m_state, ellipsoid, joint);
    const bool moves_second =
        std::find(part.bodies.begin(), part.bodies.end(), ends.second) != part.bodies.end();
    const glm::dquat wanted = turn_xyz(kept);
    const glm::dquat back = moves_second ? first * wanted * glm::conjugate(second)
                                         : second * glm::conjugate(wanted) * glm::conjugate(first);
    spin(part, back, joint_position(joint));
}

// --- Variables

void FigureAction::set() const {
    const Operand& from = m_movement.operands[1];
    auto& to = m_state.variables[static_cast<std::size_t>(m_movement.operands[0].index)];
    if (from.kind == OperandKind::number)
        to = {from.number, OperandKind::number, true};
    else if (from.kind != OperandKind::variable)
        to = {static_cast<double>(from.index), from.kind, true};
    else
        to = m_state.variables[static_cast<std::size_t>(from.index)];
    if (strict() && !to.set) number(1);  // says that it was not set
}

void FigureAction::calculate() const {
    switch (m_movement.action) {
        case Action::invert: {
            const double v = number(0);
            return store(0, v == 0 ? 0 : 1 / v);
        }
        case Action::negate:
            return store(0, -number(0));
        case Action::add:
            return store(0, number(1) + number(2));
        case Action::subtract:
            return store(0, number(1) - number(2));
        case Action::multiply:
            return store(0, number(1) * number(2));
        default:
            if (number(2) == 0) fail("a division by zero");
            return store(0, number(1) / number(2));
    }
}

void FigureAction::perform() {
    switch (m_movement.action) {
        case Action::moveby:
            return moveby();
        case Action::moveto:
            return moveto();
        case Action::ground:
            return ground();
        case Action::spinby:
            return spinby();
        case Action::spinto:
            return spinto();
        case Action::bendby:
            return bendby();
        case Action::bendto:
            return bendto();
        case Action::flex:
        case Action::rotate:
        case Action::abduct:
            return bend_own(m_movement.action);
        case Action::grofig:
            return grofig();
        case Action::groell:
            return groell();
        case Action::grojnt:
            return grojnt();
        case Action::growto:
            return growto();
        case Action::movjnt:
            return movjnt();
        case Action::attach:
            return attach();
        case Action::detach:
            return detach();
        case Action::touch:
            return touch();
        case Action::abut:
            return abut();
        case Action::drag:
            return drag();
        case Action::balance:
            return balance();
        default:
            return change_scene();
    }
}

void FigureAction::change_scene() const {
    switch (m_movement.action) {
        case Action::colour: {
            auto& painted = body(ellipsoid(0));
            painted.color = towards(painted.color, vector(1), "the colour");
            painted.image = -1;
            return;
        }
        case Action::texture: {
            auto& painted = body(ellipsoid(0));
            painted.image = index(1, OperandKind::image);
            painted.offset = {number(2), number(3)};
            return;
        }
        case Action::observe:
            m_state.observe = towards(m_state.observe, vector(0), "the view");
            return;
        case Action::place:
            m_state.place = towards(m_state.place, vector(0), "the place");
            return;
        case Action::allow:
        case Action::forbid:
            return rule_overlap(m_movement.action == Action::forbid);
        default:
            return use_variables();
    }
}

void FigureAction::rule_overlap(bool forbidden) const {
    const int first = ellipsoid(0), second = ellipsoid(1);
    auto& rules = m_state.overlaps;
    const auto covered = [&](const FigureState::Overlap& rule) {
        return (first == 0 && second == 0) || (rule.first == first && rule.second == second);
    };
    rules.erase(std::remove_if(rules.begin(), rules.end(), covered), rules.end());
    if (forbidden || !rules.empty()) rules.push_back({first, second, forbidden});
}

void FigureAction::use_variables() const {
    switch (m_movement.action) {
        case Action::set:
            return set();
        case Action::angles:
            return store(2,
                         angles_of_turn(glm::conjugate(body(ellipsoid(1)).turn) * body(ellipsoid(0)).turn));
        case Action::centre:
            return store(1, body(ellipsoid(0)).center);
        case Action::axes:
            return store(1, body(ellipsoid(0)).axes);
        case Action::linkx:
            return store(1, joint_position(joint(0)));
        case Action::print: {
            const auto variable = static_cast<std::size_t>(m_movement.operands[0].index);
            return say("frame " + std::to_string(m_frame) + ", " + excerpt(m_program.variables[variable]) +
                       " " + shortest(m_state.variables[variable].number));
        }
        default:
            return calculate();
    }
}

}  // namespace anamorph::figure
