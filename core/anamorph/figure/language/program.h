// SPDX-License-Identifier: Apache-2.0
// A NUDES script as parsed: what it declares, and the movements of its subroutines in the order written.
//
// Names are positions in the tables of the program, and ellipsoid 0 is `world`, figure 0 `every`, figure 1
// `world`, subroutine 0 the script outside subroutines. Lengths in the units of the window, angles in
// degrees.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

namespace anamorph::figure {

/// The two ways to read scripts and to perform them.
enum class Dialect {
    classic,  ///< as the programs of 2003 ran scripts, but for `abut` and `touch`, which end in exact contact
    strict    ///< as the language is documented; see script.h and performance.h for what differs
};

/// How an action is distributed over its frames.
enum class Distribution { repeat, linear, quadratic, cubic, accelerate, decelerate, call };

/// The actions of the language.
enum class Action {
    abduct,
    abut,
    add,
    allow,
    angles,
    attach,
    axes,
    balance,
    bendby,
    bendto,
    call,
    centre,
    colour,
    detach,
    divide,
    drag,
    flex,
    forbid,
    grofig,
    groell,
    grojnt,
    ground,
    growto,
    invert,
    linkx,
    moveby,
    moveto,
    movjnt,
    multiply,
    negate,
    observe,
    place,
    print,
    rotate,
    set,
    spinby,
    spinto,
    subtract,
    texture,
    touch
};

/// The kind of an operand, which says in which table its name is.
enum class OperandKind { number, variable, ellipsoid, joint, figure, axis, subroutine, image, parameter };

/// An operand of an action: a number, or a name by its position.
struct Operand {
    OperandKind kind = OperandKind::number;
    double number = 0;  ///< the value of an operand that is a number
    int index = 0;  ///< for other operands, the position in the table of its kind; axes are 0, 1, 2, and a
                    ///< parameter is counted in its subroutine

    bool operator==(const Operand&) const = default;
};

/// A place in a script: a position in Program::files, and the line and column from 1.
struct ScriptPosition {
    int file = 0, line = 0, column = 0;
};

/// One action over the frames start < f <= stop of its subroutine.
struct Movement {
    Distribution distribution = Distribution::repeat;
    Operand start, stop;  ///< numbers or variables
    Action action = Action::call;
    std::vector<Operand>
        operands;  ///< of a call the subroutine, and then what it hands over, in the order of the parameters
    ScriptPosition position;
};

/// The declaration `ellipsoid NAME x y z`.
struct EllipsoidDeclaration {
    std::string name;
    glm::dvec3 axes{1.0};  ///< half the lengths
    ScriptPosition position;
};

/// The declaration `joint NAME`, with its `limit` if there is one.
struct JointDeclaration {
    std::string name;
    bool attached = false;  ///< the joint is made by `attach`, and is not there before
    int first = 0, second = 0;
    glm::dvec3 first_offset{0.0}, second_offset{0.0};  ///< offsets from the centre of each body, at rest
    std::optional<std::array<double, 6>> limit;        ///< x, y, z: smallest and largest angle
    ScriptPosition position;
};

/// The declaration `figure NAME n ellipsoids`.
struct FigureDeclaration {
    std::string name;
    std::vector<int> ellipsoids;  ///< in the order listed; empty when `detach` makes it
    ScriptPosition position;
};

/// The declaration `subroutine NAME ... endsub NAME`, in the strict dialect `subroutine NAME n parameters ...`.
struct Subroutine {
    std::string name;
    std::vector<std::string> parameters;
    std::vector<Movement> movements;
    ScriptPosition position;
};

/// The contents of a script and its libraries.
struct Program {
    Dialect dialect = Dialect::classic;
    std::vector<std::string> files;
    std::vector<ScriptPosition> included_at;  ///< what includes each file; line 0 where nothing does
    std::vector<EllipsoidDeclaration> ellipsoids;
    std::vector<JointDeclaration> joints;
    std::vector<FigureDeclaration> figures;
    std::vector<Subroutine> subroutines;
    std::vector<std::string> variables, images;
    bool trace = false;  ///< each action is told as it is performed
    int speed = 1;       ///< > 0 multiplies frame numbers; < 0: only each |speed|th is shown
    std::optional<std::array<int, 2>> view;  ///< frames view[0] < f <= view[1] are shown

    /// A place as text: "walk.n:12:5".
    std::string where(const ScriptPosition& position) const;
    /// The place where a file was included: " (included at walk.n:3:1)", one for each file between; empty for
    /// the script itself.
    std::string included_from(int file) const;
};

/// The name of an action in the language.
const char* name_of(Action action);
/// The name of a distribution in the language.
const char* name_of(Distribution distribution);

}  // namespace anamorph::figure
