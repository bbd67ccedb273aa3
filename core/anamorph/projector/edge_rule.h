// SPDX-License-Identifier: Apache-2.0
// Whether an edge of a scene that receives a panorama (projector.h) is short enough, by the edge alone: neighbours that
// share an edge split it in the same places, whatever process or thread they are in, and no crack opens between them.
//
// Texture coordinates are interpolated linearly in space (what a rasterizer does with perspective correction). Let F be the
// map from space to the panorama, q = sum l_i q_i a point of a flat triangle whose longest side is h, and K a bound of
// |F''[d, d]| for all unit vectors d wherever the triangle is. Taylor's formula about q gives
//     |sum l_i F(q_i) - F(q)| <= K/2 sum l_i |q_i - q|^2 = K/2 sum_(i<j) l_i l_j |q_i - q_j|^2 <= K h^2 / 6,           (1)
// as sum_(i<j) l_i l_j <= 1/3. All of the triangle is no farther than h from both ends of its longest side, and so no
// farther than R = sqrt(3)/2 h from its middle: K is bounded over that ball, and then (1) holds for every triangle that has
// this edge as its longest one.
//
// F depends on the direction alone. With unit vectors e_1, e_2 across the way to the middle of the ball, which is D away,
// a point at z along that way and (X, Y) across it has the direction of (p, 1), p = (X, Y) / z, and F(q) = G(p). G is read
// as a jet of intervals (number/jet.h) over |p| <= rho = R / sqrt(D^2 - R^2). Along d = (d_p, d_z), with z >= D - R,
//     p' = (d_p - p d_z) / z,  |p'| <= sqrt(1 + rho^2) / (D - R),
//     p'' = -2 p' d_z / z,     |p''| <= (1 + 2 rho) / (D - R)^2,   as |d_p d_z| <= 1/2,
//     |F''[d, d]| <= |G''| |p'|^2 + |G'| |p''|.                                                                        (2)
//
// Where G has no such bound (at poles and axes), edges are split until what they may be off as directions, 4 rho at most
// in a fan of triangles about a pole, is less than the tolerance at the panorama's middle.
//
// Seams, borders of faces and creases are plane in space. Edges are split on them, and every triangle is then on one side.
#pragma once

#include <vector>

#include "anamorph/projector/projector.h"

namespace anamorph {

/// What is known of every triangle whose longest side is an edge.
enum class EdgeVerdict {
    bounded,  ///< it is off by the bound at most
    outside,  ///< no point of it is on the panorama
    tiny,  ///< as seen from the centre it is smaller than the tolerance, and there is a pole or an axis in it
    hopeless,  ///< it is as short as an edge may be, and next to the centre; or it is not finite
    split,     ///< it has to be split in the middle
    cut        ///< it has to be split at `at`
};

/// An edge's verdict.
struct EdgeFinding {
    EdgeVerdict verdict = EdgeVerdict::hopeless;
    double bound = 0;  ///< in texels, where bounded; proven
    double at = 0.5;   ///< from the end that was given first
};

/// The rule.
class EdgeRule {
  public:
    /// `tol`: in texels. Edges are not split that are no longer than `smallest`. `single`: are points rounded to float?
    EdgeRule(const Projector& projector, double tol, double smallest, bool single = false)
        : m_projector(projector), m_tol(tol), m_smallest(smallest), m_on_plane(single ? 0x1p-20 : 0x1p-40) {}

    /// Of the edge from a to b. Both orders find the same, bit by bit, if they come as in_order() says.
    EdgeFinding judge(const glm::dvec3& a, const glm::dvec3& b) const;

    /// Whether a is first of the two.
    static bool in_order(const glm::dvec3& a, const glm::dvec3& b);
    /// How far from a plane, relative to its distance, a ray is taken to lie in it.
    double on_plane() const { return m_on_plane; }

  private:
    /// The place on the way from a to b where a seam, a border of faces or a crease is crossed; -1 where none is.
    double crossing(const glm::dvec3& a, const glm::dvec3& b) const;
    /// The faces that a ray is on: several on their borders.
    std::vector<std::size_t> faces_at(const glm::dvec3& ray) const;
    EdgeFinding judge_ball(const glm::dvec3& centre, double radius, double edge) const;

    const Projector& m_projector;
    double m_tol, m_smallest, m_on_plane;
};

}  // namespace anamorph
