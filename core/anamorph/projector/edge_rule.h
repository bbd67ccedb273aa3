// SPDX-License-Identifier: Apache-2.0
// Decides whether an edge of a scene that receives a panorama (projector.h) is short enough, by the edge alone: neighbours
// that share an edge split it in the same places, whatever process or thread they are in, and no crack opens between them.
// It also proves a bound of the error in a triangle with such sides.
//
// Texture coordinates are interpolated linearly in space (what a rasterizer does with perspective correction). Let F be the
// map from space to the panorama, q = sum l_i q_i a point of a flat triangle. Taylor's formula about q gives
//     sum l_i F(q_i) - F(q) = sum l_i A_i[q_i - q, q_i - q] / 2,                                                          (1)
// where A_i is a mean of F'' on the way from q to q_i. Let H be any form within which F'' differs by a form D at most,
// wherever the triangle is. As sum l_i H[q_i - q, q_i - q] = sum_(i<j) l_i l_j H[q_i - q_j, q_i - q_j], the length of (1) is
//     | sum_(i<j) l_i l_j H[q_i - q_j, q_i - q_j] | / 2 + sum l_i D_i[q_i - q, q_i - q] / 2.                              (2)
// The formula is read as a jet of intervals (number/jet.h) over a box about the triangle, along its shorter sides e and f,
// with q = q_0 + s e + t f: that gives F''[e, e], F''[e, f], F''[f, f] as intervals, H by their middles and D by half their
// widths. The first sum of (2) is largest at the middle of a side or where its derivatives are 0. In the second one, the mean
// of (s_i - s)^2 is l_1 (1 - l_1) <= 1/4, that of (t_i - t)^2 too, and that of their product is no more by Cauchy and Schwarz:
// it is (D_ee + 2 D_ef + D_ff) / 8 at most.
//
// An edge is judged as the triangle that it is when two corners fall together, by a share of the tolerance. Triangles with
// such sides mostly hold it, as they have little more in their middle; those that do not are split within.
//
// Of panoramas that close on themselves, most edges and triangles are judged by F'' over a cell of directions that has others in it, too (derivative_cells.h), which takes
// a fifth of the time; those that this leaves open, by their own boxes.
//
// Where F'' has no such bound (at poles and axes), edges are split until what they may be off as directions, 4 rho at most
// in a fan of triangles about a pole within a tangent of rho, is less than the tolerance at the panorama's middle.
//
// Seams, borders of faces and creases are plane in space. Edges are split on them, and every triangle is then on one side.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "anamorph/projector/derivative_cells.h"
#include "anamorph/projector/projector.h"

namespace anamorph {

/// The verdicts on an edge or a triangle.
enum class EdgeVerdict {
    bounded,   ///< its error is proven to be at most the bound
    outside,   ///< no point of it is on the panorama
    tiny,      ///< as seen from the centre it is smaller than the tolerance, with a pole or an axis in it
    hopeless,  ///< an edge that is as short as one may be, and next to the centre; or it is not finite
    split,     ///< it has to be split, an edge in the middle
    cut        ///< it has to be split at EdgeFinding::at
};

/// A verdict on an edge or a triangle, with its numbers.
struct EdgeFinding {
    EdgeVerdict verdict = EdgeVerdict::hopeless;
    double bound = 0;     ///< the proven bound of the error in texels, where bounded
    double at = 0.5;      ///< the place of a cut, from 0 at the end that was given first to 1
    bool shadow = false;  ///< is it cut at the border of a shadow?
};

/// The rule by which edges are split, and triangles bounded.
class EdgeRule {
  public:
    /// `tol`: the tolerance in texels. Edges no longer than `smallest` (units of the scene) are not split. `single`: are points
    /// rounded to float?
    EdgeRule(const Projector& projector, double tol, double smallest, bool single = false);

    /// Judges the edge from a to b. For the same bits from both sides, callers pass the ends in the order of in_order().
    EdgeFinding judge(const glm::dvec3& a, const glm::dvec3& b) const;

    /// Judges a triangle whose sides have been judged; it is never cut or hopeless.
    EdgeFinding judge(const std::array<glm::dvec3, 3>& corners) const;

    /// The weights of the point where the axis that azimuths are counted about passes through the inside of a triangle;
    /// nothing where it does not.
    std::optional<glm::dvec3> axis_in(const std::array<glm::dvec3, 3>& corners) const;

    /// The mean of a triangle's rays, scaled (scaled_ray); a triangle is read on the piece of the panorama that this ray is on.
    static glm::dvec3 middle_of(const std::array<glm::dvec3, 3>& rays);
    /// Does a come before b in the order in which the ends of an edge are judged?
    static bool in_order(const glm::dvec3& a, const glm::dvec3& b);
    /// The distance from a plane, relative to a ray's length, within which the ray is taken to lie in the plane.
    double on_plane() const { return m_on_plane; }

  private:
    /// The place on the way from a to b, from 0 to 1, where a seam, a border of faces or a crease is crossed; -1 where none is.
    double crossing(const glm::dvec3& a, const glm::dvec3& b) const;
    /// The faces that a ray is on: several on their borders.
    std::vector<std::size_t> faces_at(const glm::dvec3& ray) const;
    /// The branches on which an edge may be read: one for each face that its middle is on.
    std::vector<Branch> branches_of_faces(const glm::dvec3& middle) const;
    /// The branch about the middle of rays, or half way between their azimuths where those are counted.
    Branch branch_between(const std::array<glm::dvec3, 3>& rays, const glm::dvec3& middle) const;
    /// Is the texel of an edge's middle farther from what interpolation gives than an edge may be off? It is then split, as it would
    /// be by its bound, which is no less. False where that is not clear.
    bool is_off_in_middle(const glm::dvec3& a, const glm::dvec3& b) const;
    /// Judges an edge by what is known of its surroundings; hopeless where that does not suffice.
    EdgeFinding judge_by_cells(const glm::dvec3& a, const glm::dvec3& b) const;
    EdgeFinding judge_rays(std::array<glm::dvec3, 3> rays, std::span<const Branch> branches, double share,
                           double wider) const;

    /// The share of the tolerance that edges may take.
    static constexpr double kShare = 0.9;
    /// The share that an edge may take if it is judged by cells: what is nearer to the tolerance is judged by its own box, which tells
    /// better whether triangles along it will hold the tolerance.
    static constexpr double kSureShare = 0.7;
    /// The share by which boxes about edges are enlarged, so that triangles along them do not fail narrowly.
    static constexpr double kWider = 0.02;

    const Projector& m_projector;
    double m_tol, m_smallest, m_on_plane;
    /// The derivatives of a panorama that closes on itself; null of others.
    std::unique_ptr<const DerivativeCells> m_cells;
};

}  // namespace anamorph
