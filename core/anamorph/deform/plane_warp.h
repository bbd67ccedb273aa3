// SPDX-License-Identifier: Apache-2.0
// A list of deformations as a map of space: the parameters of a point are those of its projection onto a
// plane, and everything above and below moves along with the plane's point.
//
//     W(p) = p + D(u(p), v(p)),   D(u, v) = sum_i V_i F((u, v), c_i, a_i)
//
// W^-1 has two unknowns: the parameters s of W^-1(q) solve s + G D(s) = t, with t those of q and G the
// gradients of u and v; then W^-1(q) = q - D(s). Displacements across the plane (G V_i = 0) invert exactly.
// The map is one to one unless the plane's own part folds: det(I + G D') > 0 everywhere. (A map of the plane
// that is the identity far out and has no such point is one to one.)
#pragma once

#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "anamorph/deform/deformation.h"
#include "anamorph/number/interval.h"

namespace anamorph {

/// A plane and its parameters (u, v), by which a point of space is p = origin + u axis_u + v axis_v + a part
/// perpendicular to both.
class ParameterPlane {
  public:
    /// Constructs the plane z = 0 whose parameters are x and y.
    ParameterPlane() = default;
    /// The plane through `origin` with these axes. Throws Error on axes that are parallel or zero, and on numbers that are not finite.
    ParameterPlane(glm::dvec3 origin, glm::dvec3 axis_u, glm::dvec3 axis_v);

    /// The parameters (u, v) of a point's projection onto the plane; not finite where p is not.
    glm::dvec2 parameters(glm::dvec3 p) const;
    /// The depth w of a point: its distance from the plane, to the side of normal(); not finite where p is not.
    double depth(glm::dvec3 p) const;
    /// The unit normal axis_u x axis_v / |axis_u x axis_v|, which is the gradient of the depth.
    glm::dvec3 normal() const { return m_normal; }
    /// The point of the plane that has the parameters s.
    glm::dvec3 point(glm::dvec2 s) const { return m_origin + s.x * m_axis_u + s.y * m_axis_v; }

    glm::dvec3 origin() const { return m_origin; }
    glm::dvec3 axis_u() const { return m_axis_u; }
    glm::dvec3 axis_v() const { return m_axis_v; }
    /// The gradients of u and of v.
    glm::dvec3 gradient_u() const { return m_gradient_u; }
    glm::dvec3 gradient_v() const { return m_gradient_v; }

    bool operator==(const ParameterPlane&) const = default;

  private:
    glm::dvec3 m_origin{0.0}, m_axis_u{1, 0, 0}, m_axis_v{0, 1, 0};
    glm::dvec3 m_gradient_u{1, 0, 0}, m_gradient_v{0, 1, 0}, m_normal{0, 0, 1};
};

/// Whether a map of the plane folds.
enum class FoldAnswer {
    none,      ///< proved, with outward rounding: det(I + G D') > 0 everywhere
    found,     ///< it is certainly not positive at Fold::parameters
    undecided  ///< it comes too close to 0 somewhere, or there are too many deformations to tell
};
/// The result of a search for folds.
struct Fold {
    FoldAnswer answer = FoldAnswer::none;
    glm::dvec2 parameters{0.0};
};

/// The map W of space, and its inverse.
class PlaneWarp {
  public:
    PlaneWarp() = default;
    /// The map that a list makes over a plane. Throws Error on a deformation that check_deformation refuses, and on one with depth
    /// or side: what is above and below moves along.
    PlaneWarp(const ParameterPlane& plane, const std::vector<Deformation>& list);

    const ParameterPlane& plane() const { return m_plane; }

    /// The image W(p) of a point; Gaussians are cut off where they are below 1e-18.
    glm::dvec3 forward(glm::dvec3 p) const;
    /// The Jacobian matrix W'(p): column c is the derivative by coordinate c.
    glm::dmat3 jacobian(glm::dvec3 p) const;

    /// The result of inverse(): a point that W moves to a given one.
    struct Inverse {
        glm::dvec3 point;
        bool found;  ///< false: `point` is the nearest to a solution that was met, or NaN for a q with NaN
    };
    /// Solves W(p) = q: by damped Newton's method, then by continuation along s + l G D(s) = t for l from 0 to 1. Where the
    /// map folds there is more than one solution; the result is one of them, or not found.
    Inverse inverse(glm::dvec3 q) const;

    /// Searches for a fold in boxes of the plane, at most `most_boxes` of them.
    Fold find_fold(std::size_t most_boxes = 20000) const;

  private:
    struct Bin {
        std::vector<std::size_t> entries;
    };
    struct FoldBox;
    FoldBox fold_box(const Interval& u, const Interval& v, const std::vector<std::size_t>& parents) const;
    int bin_of(double value, int axis) const;
    DisplacementJet displacement(glm::dvec2 s) const;
    glm::dvec2 residual(glm::dvec2 s, glm::dvec2 target, double share, DisplacementJet& jet) const;
    bool solve(glm::dvec2 target, double share, glm::dvec2& s) const;

    ParameterPlane m_plane;
    std::vector<Deformation> m_list;  ///< the deformations that move anything
    bool m_across = true;             ///< all displacements are perpendicular to the parameters (G V = 0)
    // Uniform bins over what the list reaches; a deformation that reaches many stands in m_wide.
    glm::dvec2 m_least{0.0}, m_most{0.0};
    int m_side = 0;
    std::vector<Bin> m_bins;
    std::vector<std::size_t> m_wide;
};

}  // namespace anamorph
