// SPDX-License-Identifier: Apache-2.0
// The state in which a performance is: where everything is, and what is joined to what.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "anamorph/figure/body/frame.h"
#include "anamorph/figure/language/program.h"

namespace anamorph::figure {

/// The connections that joints make at the moment. Shared between states until an action attaches or
/// detaches.
struct Topology {
    struct Ends {
        int first = 0, second = 0;
        bool joined = false;  ///< the joint exists
    };
    std::vector<Ends> joints;
    std::vector<int> joint_order;             ///< the joints that exist, in the order made
    std::vector<std::vector<int>> joints_of;  ///< the joints of each ellipsoid
    std::vector<int> figure_first;            ///< the ellipsoid that a figure is found by; -1: no such figure
    std::size_t visited = 0;                  ///< number of ellipsoids and joints visited in making this

    /// Fills joints_of, and the pieces that figure_of() looks up, from the other members.
    void connect(std::size_t ellipsoids);
    /// Adds a joint that did not exist.
    void attach(int joint, int first, int second);
    /// The figure of an ellipsoid; -1: none.
    int figure_of(int ellipsoid) const;
    int other_end(int joint, int ellipsoid) const;
    bool is_end(int joint, int ellipsoid) const;

  private:
    /// Ellipsoids that hang together are a tree, by its size joined to others; its root knows the figure.
    struct Piece {
        int parent = -1, size = 1, figure = -1;
    };
    int root_of(int ellipsoid) const;
    void join(int first, int second);

    std::vector<Piece> m_pieces;
};

struct FigureState {
    struct Body {
        glm::dvec3 axes{1.0}, center{0.0};
        glm::dquat turn{1, 0, 0, 0};
        glm::dvec3 color{255, 128, 64};
        glm::dvec2 offset{0.0};
        int image = -1;
    };
    struct Value {
        double number = -1;  ///< the number, or the position in the table of its kind
        OperandKind kind = OperandKind::number;
        bool set = false;
    };
    /// Two ellipsoids that must not meet, or may again; world stands for every one.
    struct Overlap {
        int first = 0, second = 0;
        bool forbidden = false;
    };

    std::vector<Body> bodies;        ///< in the order of Program::ellipsoids; 0 is world, which never moves
    std::vector<glm::dvec3> joints;  ///< positions in space, in the order of Program::joints
    std::vector<Value> variables;
    std::vector<Overlap> overlaps;       ///< the last that names a pair holds
    std::shared_ptr<Topology> topology;  ///< changed by own_topology alone
    glm::dvec3 place{500.0}, observe{0.0};

    std::size_t bytes() const;
};

/// The state's topology, to be changed: a copy where other states share it.
Topology& own_topology(FigureState& state);

/// Ellipsoids and joints that move together.
struct FigurePart {
    std::vector<int> bodies, joints;
};

/// The part that is reached from an ellipsoid without crossing a joint (-1: none), in the order found.
FigurePart part_from(const FigureState& state, int ellipsoid, int joint);
/// The part that is a figure; `every` and `world` are all but ellipsoid 0.
FigurePart part_of_figure(const FigureState& state, int figure);

void translate(FigureState& state, const FigurePart& part, const glm::dvec3& by);
void turn(FigureState& state, const FigurePart& part, const glm::dquat& by, glm::dvec3 about);

/// The distance that an ellipsoid reaches up and down from its centre: sqrt(sum_k (a_k R_yk)^2).
double half_height(const FigureState::Body& body);
/// The lowest y of any point of these bodies.
double lowest(const FigureState& state, const std::vector<int>& bodies);

Ellipsoid shape_of(const FigureState::Body& body);

/// Frame 0: from the first ellipsoid of each tree of joints, which is at the origin, c' = c + d - d'.
FigureState figures_at_rest(const Program& program);
FigureFrame frame_of(const FigureState& state, const Program& program, int number);

}  // namespace anamorph::figure
