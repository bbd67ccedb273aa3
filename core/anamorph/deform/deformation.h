// SPDX-License-Identifier: Apache-2.0
// Free-form deformation by a list of editable bumps (Oka 1987, section 4.1).
//
//     P_i = P_(i-1) + V_i F(p, c_i, a_i)                                   (4.1)
//
// moves the point P of a surface that belongs to the point p = (u, v) of the texture plane. c and a are in
// the units of u and v, V in those of P. The list is plain data: what evaluates it (deformed_surface.h) adds
// in fixed point, so the surface depends neither on the order of the list nor on how it came about.
//
// p, c and a may have a third coordinate, the depth w of the undeformed point, in the units of P: with
//     r^2 = ((u - c_u) / a_u)^2 + ((v - c_v) / a_v)^2 + ((w - c_w) / a_w)^2
// a bump reaches as far in depth as along the plane, and moves one of two parts of a surface that lie over each
// other. Without a_w the third term is missing: a bump reaches to any depth.
//
// A bump with depth may have a frame of its own, the turn R of a quaternion q = (q_w, q_x, q_y, q_z) of any length but 0: with
//     x = R^T (p - c),   r^2 = (x_u / a_u)^2 + (x_v / a_v)^2 + (x_w / a_w)^2
// its extents are along R's columns, the directions in (u, v, w) that R turns u, v and w into. frame_at() finds the turn that lays w
// along the normal at a point of a surface.
//
// A bump may move one side alone. With the unit normal n of the undeformed surface, V F S moves the point, where
//     S = H(2 n . V / |V|) of the front, H(-2 n . V / |V|) of the back,
//     H(t) = 0 up to t = 0, t^2 (3 - 2 t) up to t = 1, then 1:
// normals within 60 degrees of V (or of -V) move in full, those that are 90 degrees off or more do not, and S is once
// continuously differentiable, and twice but on curves. A point without a normal (n = 0) belongs to neither side.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/deform/deform_rows.h"
#include "anamorph/number/jet.h"
#include "anamorph/number/number.h"

namespace anamorph {

/// F as a function of the distance r from the centre, in extents.
enum class DeformationKernel {
    gaussian,    ///< exp(-r^2)                                            (4.2)
    wendland_c2  ///< (1 - r)^4 (4 r + 1) up to r = 1, then 0: twice continuously differentiable (Wendland
                 ///< 1995, phi_(3,1))
};

/// What a bump moves: all of a surface, or where its normal looks along V, or against V.
enum class DeformationSide { both, front, back };

/// One bump: V F(p, c, a) of eq. (4.1).
struct Deformation {
    glm::dvec3 vector{0.0};                  ///< V
    glm::dvec2 center{0.0};                  ///< c
    glm::dvec2 extent{kExtentRow.standard};  ///< a: r is 1 on the ellipse with these half axes
    DeformationKernel kernel = DeformationKernel::gaussian;
    bool enabled = true;
    double center_w = 0;  ///< c_w
    double extent_w = 0;  ///< a_w; 0: none
    DeformationSide side = DeformationSide::both;
    glm::dvec4 orientation{1, 0, 0, 0};  ///< q; of bumps with depth alone

    /// Is q another turn than none?
    bool has_frame() const { return orientation.y != 0 || orientation.z != 0 || orientation.w != 0; }
    bool has_depth() const { return extent_w != 0; }
    bool has_side() const { return side != DeformationSide::both; }
    /// Does the bump need no more of a point than (u, v)?
    bool is_plain() const { return !has_depth() && !has_side(); }
    bool operator==(const Deformation&) const = default;
};

/// Does any bump of a list that moves anything need more of a point than (u, v)?
bool needs_depth(const std::vector<Deformation>& list);
/// Is any bump of a list that moves anything of one side?
bool needs_normals(const std::vector<Deformation>& list);

/// The greatest ratio of two half axes of a bump with a frame.
inline constexpr double kMostExtentRatio = 0x1p20;

/// Checks a bump. Throws Error that names the field, unless all numbers are finite and extents in the range of kExtentRow;
/// extent_w may be 0. Bumps with a frame need an extent_w, a q whose largest number has a magnitude from 1e-100 to 1e100, and
/// extents that are no more than kMostExtentRatio apart.
void check_deformation(const Deformation& deformation);

/// exp(-a) for a >= 0. Numbers that have a faster way overload it.
template <class T>
T exp_of_minus(const T& a) {
    return exp(-a);
}

#include "anamorph/deform/deformation_formula.h"

/// q divided by the power of 2 that makes its largest number one from 1 to 2.
glm::dvec4 unit_scaled(glm::dvec4 q);

/// V / |V| of the front, -V / |V| of the back, (0, 0, 0) of V = 0: what a normal is multiplied by (facing).
template <class T>
Triple<T> side_direction(const Deformation& d) {
    const double largest =
        std::max(std::fabs(d.vector.x), std::max(std::fabs(d.vector.y), std::fabs(d.vector.z)));
    if (!(largest > 0)) return {T(0.0), T(0.0), T(0.0)};
    // In units of a power of 2, so that no product leaves the range of double.
    const auto scaled = [exponent = std::ilogb(largest), back = d.side == DeformationSide::back](double x) {
        return T(std::ldexp(back ? -x : x, -exponent));
    };
    const Triple<T> v{scaled(d.vector.x), scaled(d.vector.y), scaled(d.vector.z)};
    const T length = sqrt(dot_product(v, v));
    return {v.x / length, v.y / length, v.z / length};
}

/// R of a bump: R[j][k] is how much of (u, v, w)[j] its k-th own direction has. Its columns are of length 1 and at right angles but for
/// rounding, by which each number errs by at most 9 units of 2^-53: sums of four products, above and below, by 4 of the sum of their
/// magnitudes, and the quotient by one.
template <class T>
std::array<std::array<T, 3>, 3> turn_of(const Deformation& d) {
    // In units of the largest number, which is a power of 2 off at most.
    const glm::dvec4 q = unit_scaled(d.orientation);
    const T w(q.x), x(q.y), y(q.z), z(q.w);
    const T xx = square(x), yy = square(y), zz = square(z), ww = square(w), length = ww + xx + yy + zz;
    const auto off = [&](const T& a, const T& b) { return T(T(2.0) * (a + b) / length); };
    return {{{T((ww + xx - yy - zz) / length), off(x * y, -(w * z)), off(x * z, w * y)},
             {off(x * y, w * z), T((ww - xx + yy - zz) / length), off(y * z, -(w * x))},
             {off(x * z, -(w * y)), off(y * z, w * x), T((ww - xx - yy + zz) / length)}}};
}

/// x of a bump with a frame, in extents.
template <class T>
std::array<T, 3> in_own_frame(const Deformation& d, const T& u, const T& v, const T& w) {
    const std::array<std::array<T, 3>, 3> turn = turn_of<T>(d);
    const T from[3] = {u - T(d.center.x), v - T(d.center.y), w - T(d.center_w)};
    const double extent[3] = {d.extent.x, d.extent.y, d.extent_w};
    const auto along = [&](std::size_t k) {
        return T((turn[0][k] * from[0] + turn[1][k] * from[1] + turn[2][k] * from[2]) *
                 (T(1.0) / T(extent[k])));
    };
    return {along(0), along(1), along(2)};
}

/// How far from its centre a bump with a frame reaches along u, v and w, where it reaches r = 1; rounded up.
glm::dvec3 framed_reach(const Deformation& d);

/// The turn q, of length 1, that lays w along a normal, which need not be of length 1, by the shortest way. Throws Error where the
/// normal has no direction.
glm::dvec4 frame_at(glm::dvec3 normal);

/// F at x = (u - c_u) / a_u and y = (v - c_v) / a_v; it is 1 at the centre.
template <class T>
T kernel_value(DeformationKernel kernel, const T& x, const T& y) {
    const T squared = square(x) + square(y);
    return kernel == DeformationKernel::gaussian ? gaussian_of(squared) : wendland_of(squared);
}

/// F(p, c, a) at p = (u, v), exactly (with no cutoff).
template <class T>
T influence(const Deformation& d, const T& u, const T& v) {
    return kernel_value(d.kernel, (u - T(d.center.x)) * T(1 / d.extent.x),
                        (v - T(d.center.y)) * T(1 / d.extent.y));
}

/// F(p, c, a) S at p = (u, v, w), exactly. facing: the product of the unit normal and side_direction(d).
template <class T>
T influence(const Deformation& d, const T& u, const T& v, const T& w, const T& facing) {
    T squared(0.0);
    if (d.has_frame()) {
        for (const T& x : in_own_frame(d, u, v, w)) squared = squared + square(x);
    } else {
        const T x = (u - T(d.center.x)) * T(1 / d.extent.x), y = (v - T(d.center.y)) * T(1 / d.extent.y);
        squared = square(x) + square(y);
        if (d.has_depth()) squared = squared + square(T((w - T(d.center_w)) * T(1 / d.extent_w)));
    }
    const T f = d.kernel == DeformationKernel::gaussian ? gaussian_of(squared) : wendland_of(squared);
    return d.has_side() ? T(f * side_share(facing)) : f;
}

/// The displacement sum_i V_i F(p, c_i, a_i) of the enabled deformations at p and its derivatives by u and v. The
/// functions that give it read bumps as they are at any depth and on both sides; callers refuse others.
struct DisplacementJet {
    glm::dvec3 value{0.0}, by_u{0.0}, by_v{0.0};
};
/// Finds the displacement and its derivatives at p in double, with no cutoff; deformations that are not enabled add nothing.
DisplacementJet displacement_at(const std::vector<Deformation>& list, glm::dvec2 p);
/// The displacement at p of a surface whose point there has the depth w and the unit normal n.
glm::dvec3 displacement_at(const std::vector<Deformation>& list, glm::dvec2 p, double w, glm::dvec3 n);
/// Adds the displacement at p of one deformation, enabled or not, and its derivatives to `sum`.
void add_displacement(const Deformation& deformation, glm::dvec2 p, DisplacementJet& sum);

/// The unit normal of a displaced surface at a point where the undeformed surface has the derivatives base_u and
/// base_v: the direction of (base_u + D_u) x (base_v + D_v); 0 where these are parallel.
glm::dvec3 normal_of(const DisplacementJet& displacement, glm::dvec3 base_u, glm::dvec3 base_v);

/// The change of the surface by an edit of a list: `before` is taken away, `after` is added. Neither is there
/// if the edit moves nothing.
struct DeformationChange {
    std::optional<Deformation> before, after;

    DeformationChange undo() const { return {after, before}; }
};

/// A list of deformations and its edits. Each edit returns its change of the surface, whose undo() takes it back there; the list
/// itself is put back by another edit. Throws Error on a deformation that check_deformation refuses and on a position that is not in
/// the list.
class DeformationList {
  public:
    DeformationList() = default;
    /// A list of these entries, in their order.
    explicit DeformationList(std::vector<Deformation> entries);

    const std::vector<Deformation>& entries() const { return m_entries; }

    /// Appends a deformation.
    DeformationChange add(const Deformation& deformation);
    /// Inserts a deformation before the one at `position`, or at the end of the list.
    DeformationChange insert(std::size_t position, const Deformation& deformation);
    /// Replaces the deformation at `position`.
    DeformationChange change(std::size_t position, const Deformation& deformation);
    /// Removes the deformation at `position`.
    DeformationChange remove(std::size_t position);
    /// Enables or disables the deformation at `position`.
    DeformationChange enable(std::size_t position, bool enabled);
    /// Moves the entry at `from` to `to`. The surface does not change.
    void move(std::size_t from, std::size_t to);

  private:
    void check_position(std::size_t position, std::size_t end) const;

    std::vector<Deformation> m_entries;
};

/// The changes that lead from the surface of one list to the surface of another; entries of both lists are left out.
std::vector<DeformationChange> difference(const std::vector<Deformation>& from,
                                          const std::vector<Deformation>& to);

}  // namespace anamorph
