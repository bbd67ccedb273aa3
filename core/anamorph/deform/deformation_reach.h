// SPDX-License-Identifier: Apache-2.0
// Which deformations of a list move a box of (u, v): a tree of their boxes of influence.
//
// Wendland's kernel is 0 beyond r = 1. A Gaussian reaches as far as R extents a, R^2 = 64 + 2 log(1 / m) with m the least
// of both extents and 1. Farther than that e^(-r^2) <= e^-64 m^2, and, as r^2 e^(-r^2) falls from r = 1 on, F and its
// Taylor coefficients up to the second degree are at most
//     (2 R^2 + 1) e^-64 m^2 / m^2 = (2 R^2 + 1) e^-64                                                              (F)
// since those are at most (2 r^2 + 1) / m^2 times e^(-r^2).
//
// With depth or side, F is never larger, but its derivatives also have those of depth and normal, of which nothing is known here:
// such a Gaussian reaches everything, while Wendland's kernel still is 0 beyond r = 1 of u and v alone, with a frame
// beyond the box of its ellipsoid.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "anamorph/deform/deformation.h"
#include "anamorph/number/interval.h"

namespace anamorph {

class DeformationReach {
  public:
    explicit DeformationReach(const std::vector<Deformation>& list);

    /// Calls body(i) for the deformations i that reach a box, and perhaps others near by, in an order that
    /// depends on nothing but the list. The others add at most far() to each coordinate and each of its
    /// Taylor coefficients up to the second degree.
    template <class Body>
    void each_near(const Interval& u, const Interval& v, const Body& body) const {
        if (!m_nodes.empty()) visit(0, u, v, body);
    }
    const glm::dvec3& far() const { return m_far; }

    /// The rectangle from (u0, v0) to (u1, v1).
    struct Reached {
        double u0, v0, u1, v1;
    };
    /// The rectangle that deformation i reaches.
    const Reached& reached(std::size_t i) const { return m_boxes[i]; }

  private:
    struct Node {
        Reached box;
        std::uint32_t begin, end;  ///< of m_order
        std::uint32_t second =
            0;  ///< the second of two parts, the first of which follows; 0 where there are none
    };

    static Reached reached_by(const Deformation& d);
    std::uint32_t build(std::uint32_t begin, std::uint32_t end);

    template <class Body>
    void visit(std::uint32_t index, const Interval& u, const Interval& v, const Body& body) const {
        const Node& node = m_nodes[index];
        const Reached& b = node.box;
        // So that what is no number is reached by all.
        if (u.lo > b.u1 || u.hi < b.u0 || v.lo > b.v1 || v.hi < b.v0) return;
        if (node.second == 0) {
            for (std::uint32_t k = node.begin; k < node.end; ++k) body(m_order[k]);
            return;
        }
        visit(index + 1, u, v, body);
        visit(node.second, u, v, body);
    }

    std::vector<Reached> m_boxes;
    std::vector<std::uint32_t> m_order;
    std::vector<Node> m_nodes;
    glm::dvec3 m_far{0.0};
};

}  // namespace anamorph
