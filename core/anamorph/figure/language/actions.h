// SPDX-License-Identifier: Apache-2.0
// What each action does to a state in one frame.
#pragma once

#include <functional>
#include <string>

#include "anamorph/figure/language/figure_state.h"
#include "anamorph/figure/language/program.h"
#include "anamorph/figure/language/timing.h"

namespace anamorph::figure {

/// One action in one frame. All functions throw Error, naming the line of the script.
class FigureAction {
  public:
    FigureAction(const Program& program, FigureState& state, const Movement& movement, Shares shares,
                 int frame, const std::function<void(const std::string&)>& message)
        : m_program(program),
          m_state(state),
          m_movement(movement),
          m_shares(shares),
          m_frame(frame),
          m_message(message) {}

    /// Performs the action, which is any but `call`.
    void perform();

    /// The value of a number or a variable.
    static double number(const Program& program, const FigureState& state, const Operand& operand,
                         const ScriptPosition& position);
    /// The position in the table of its kind that a name or a variable means.
    static int index(const Program& program, const FigureState& state, const Operand& operand,
                     OperandKind kind, const ScriptPosition& position);

  private:
    // Operands, by position
    double number(std::size_t i) const;
    glm::dvec3 vector(std::size_t i) const;
    int index(std::size_t i, OperandKind kind) const;
    int ellipsoid(std::size_t i) const { return index(i, OperandKind::ellipsoid); }
    int joint(std::size_t i) const;
    int axis(std::size_t i) const { return index(i, OperandKind::axis); }
    FigurePart figure(std::size_t i) const;
    FigureState::Body& body(int i) const { return m_state.bodies[static_cast<std::size_t>(i)]; }
    glm::dvec3& joint_position(int j) const { return m_state.joints[static_cast<std::size_t>(j)]; }
    /// The direction of an axis of an ellipsoid.
    glm::dvec3 direction(int ellipsoid, int axis) const;
    void store(std::size_t i, double value) const;
    void store(std::size_t i, const glm::dvec3& values) const;
    bool strict() const { return m_program.dialect == Dialect::strict; }
    [[noreturn]] void fail(const std::string& what) const;
    void say(const std::string& line) const;
    /// Moves a part; spin() turns one. Both check that what was moved is still somewhere.
    void move(const FigurePart& part, const glm::dvec3& by) const;
    void spin(const FigurePart& part, const glm::dquat& by, const glm::dvec3& about) const;
    void check(const FigurePart& part) const;
    void check(const glm::dvec3& numbers, const std::string& what) const;
    /// The place that the way from `now` to a target leads to in this frame.
    glm::dvec3 towards(const glm::dvec3& now, const glm::dvec3& target, const std::string& what) const;
    std::string ellipsoid_name(int i) const;
    std::string joint_name(int j) const;

    // Moving figures (actions.cpp)
    void moveby() const;
    void moveto() const;
    void ground() const;
    void spinby() const;
    void spinto() const;
    void bendby() const;
    void bendto() const;
    void bend_own(Action action) const;
    /// Turns the part on the ellipsoid's side of a joint about it, and minds the joint's limit.
    void bend(int ellipsoid, int joint, const glm::dquat& by) const;
    void enforce_limit(int ellipsoid, int joint) const;
    bool is_left(int ellipsoid) const;

    // Sizes and joints (actions_grow.cpp)
    void grofig() const;
    void groell() const;
    void grojnt() const;
    void growto() const;
    void movjnt() const;
    void attach() const;
    void detach() const;
    void scale(const FigurePart& part, const glm::dvec3& about, const glm::dvec3& factors) const;
    /// Each factor to the power of a share; its sign stays.
    glm::dvec3 powers(const glm::dvec3& factors, double share) const;

    // Found by searching (actions_search.cpp)
    void touch() const;
    void abut() const;
    void drag() const;
    void drag_coarsely(int dragged, int ellipsoid, int joint, const glm::dvec3& axis) const;
    void drag_exactly(int dragged, int ellipsoid, int joint, const glm::dvec3& axis) const;
    void balance() const;

    /// Colours, textures, the view, and which ellipsoids may overlap; other actions use variables.
    void change_scene() const;
    void rule_overlap(bool forbidden) const;

    // Variables (actions.cpp)
    void use_variables() const;
    void set() const;
    void calculate() const;

    const Program& m_program;
    FigureState& m_state;
    const Movement& m_movement;
    Shares m_shares;
    int m_frame;
    const std::function<void(const std::string&)>& m_message;
};

/// Throws Error when ellipsoids meet that `forbid` keeps apart.
void check_overlaps(const Program& program, const FigureState& state, int frame);

}  // namespace anamorph::figure
