// SPDX-License-Identifier: Apache-2.0
// What stands between a projector and a scene, as triangles: where along an edge a shadow begins or ends, and how much of a
// triangle lies in shadows.
//
// With rays r from the centre, a triangle v_1, v_2, v_3 hides what is in its pyramid, (v_i x v_j) . r >= 0 for its three
// sides as it is turned to the centre, and beyond its plane, n . r (1 - kTouching) >= n . v_1: four conditions that are linear in
// r. An edge is in the shadow of a triangle over one stretch, and the part of another triangle that is in it is convex. Two
// triangles that share a side read it with the same numbers, and leave no gap.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace anamorph {

/// The sizes, as seen from the centre, below which parts of shadows are neglected.
struct ShadowScale {
    double per_radian = 1;  ///< texels per radian
    /// The least width, in texels, of strips of light or shadow that count; a narrower triangle is lit or
    /// hidden as its middle is.
    double thin = 0;
    double on_plane = 0;  ///< a ray as near to a plane as this, relative to its length, lies in it
};

/// The part of a triangle that is in shadows.
struct ShadowCover {
    /// The share of the triangle that is hidden.
    enum Share {
        lit,     ///< none of it is hidden
        hidden,  ///< all of it is hidden
        both     ///< some of it is hidden
    };
    Share share = lit;  ///< the share that shadows hide
    /// Weights of a point within the triangle where its share is both, a corner of a shadow if there is one.
    glm::dvec3 corner{1. / 3};
    bool has_corner = false;  ///< is `corner` a corner of a shadow?
    bool mostly_lit = false;  ///< where the share is both: is more than half of the triangle's area lit?
};

/// Triangles that hide what is behind them from a point.
class Occluders {
  public:
    /// The distance from a point, relative to its distance from the centre, within which nothing hides it: a
    /// surface does not hide itself, nor what touches it.
    static constexpr double kTouching = 0x1p-16;

    /// `corners`: three for each triangle. Triangles that are not finite, or seen edge-on, hide nothing.
    Occluders(const std::vector<glm::dvec3>& corners, const glm::dvec3& centre);

    /// Is a point hidden?
    bool hides(const glm::dvec3& point) const;
    /// Finds the triangles that may hide some points, by their positions in occluders(): all that hide one, and the fewer others the
    /// closer together the points are.
    void find_before(std::span<const glm::dvec3> points, std::vector<std::int32_t>& found) const;
    /// Finds triangles of which one at least hides a point of a triangle wherever any does. False where there are more than `most`.
    bool find_before(const std::array<glm::dvec3, 3>& triangle, std::size_t most,
                     std::vector<std::int32_t>& found) const;
    /// Is a point hidden by one of these triangles? Where they are what find_before() finds, by any at all, but for triangles whose
    /// shape is that of rounding.
    bool hides(const glm::dvec3& point, std::span<const std::int32_t> triangles) const;
    /// May something hide a part of a triangle? False if nothing does, nor anything of a triangle whose points are off its own by a
    /// share `hair` of their distance from the centre.
    bool may_hide(const std::array<glm::dvec3, 3>& triangle, double hair = 0) const;
    /// Finds the first place on the way from a to b, from 0 to 1, where a shadow begins or ends; -1 where there is none.
    /// Stretches shorter than `hair` do not count.
    double border(const glm::dvec3& a, const glm::dvec3& b, double hair, const ShadowScale& scale) const;
    /// Finds the part of a triangle that is in shadows.
    ShadowCover cover(const std::array<glm::dvec3, 3>& triangle, const ShadowScale& scale) const;

    /// A triangle that hides a point, of ray r from the centre, if normals[k] . r >= 0 for its three sides and
    /// normals[3] . r > depth.
    struct Occluder {
        std::array<glm::dvec3, 4> normals;
        double depth;
        /// The value of normals[k] . ray, less `depth` for k = 3: a point is hidden where all four are not negative (that of
        /// k = 3, positive).
        double value(std::size_t k, const glm::dvec3& ray) const;
        /// Does it hide the point of a ray?
        bool hides(const glm::dvec3& ray) const;
    };
    /// A box around some of the triangles, relative to the centre.
    struct Node {
        glm::dvec3 low, high;
        /// `begin` and `end` of its occluders; the position of its second half, or 0. Its first half is the next node.
        std::int32_t begin, end, right;
    };
    ///@{
    /// The triangles, and the boxes around them from the largest on, depth first, for callers that trace rays themselves, as
    /// shaders do.
    const std::vector<Occluder>& occluders() const { return m_occluders; }
    const std::vector<Node>& nodes() const { return m_nodes; }
    ///@}

  private:
    /// The half space normal . r + offset >= 0.
    struct HalfSpace {
        glm::dvec3 normal;
        double offset;
    };

    class Region;

    void build(std::vector<std::array<glm::dvec3, 3>>& triangles, std::size_t begin, std::size_t end);
    /// Calls `body` with the positions of the occluders that may be in a region, until `body` returns false.
    template <class Body>
    void for_each_in(const Region& region, const Body& body) const;
    static Region region_before(const std::array<glm::dvec3, 3>& rays, double hair = 0);
    static Region region_before(const glm::dvec3& a, const glm::dvec3& b);

    friend class ShadowParts;

    glm::dvec3 m_centre;
    std::vector<Occluder> m_occluders;
    std::vector<Node> m_nodes;
};

}  // namespace anamorph
