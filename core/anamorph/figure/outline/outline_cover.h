// SPDX-License-Identifier: Apache-2.0
// What a body hides of small pieces of lines and surfaces; and what of a body may be seen at all.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "anamorph/figure/outline/outline_body.h"

namespace anamorph::figure {

/// The rounding of what decides whether a body hides something: an operation or two for each term.
inline constexpr double kHidingRounding = 32 * 0x1p-52;

/// The points within `around` of the line from center - half to center + half, as View::to_view gives it.
struct SurfacePiece {
    glm::dvec3 center{0.0}, half{0.0};
    double around = 0;
};

enum class Covered { none, partly, all };

/// Decides how much of a piece a body hides; `partly` also where this is not sure.
Covered cover_of(const SeenBody& body, const SurfacePiece& piece, bool perspective);
/// Decides how much of a piece of a body's surface is on the body's far side.
Covered far_side_of(const SeenBody& body, const SurfacePiece& piece);

/// Does a body hide a point? To rounding: not where the point is on its surface or its limb.
bool hides(const SeenBody& body, const glm::dvec3& point, bool perspective);
/// Is a point of a body's surface on the far side of it?
bool is_on_far_side(const SeenBody& body, const glm::dvec3& point);

/// May the body's surface pass through a piece?
bool may_meet(const SeenBody& body, const SurfacePiece& piece);

/// A solid body's surface as spherical triangles on the unit sphere, of which `from_unit` and the body's
/// center make it.
class Surface {
  public:
    using Triangle = std::array<glm::dvec3, 3>;
    using Others = std::vector<const SeenBody*>;
    struct Part {
        Triangle corners;
        SurfacePiece piece;  ///< holds the triangle
        Others others;       ///< the bodies that may hide some of it
    };

    Surface(const SeenBody& body, const glm::dmat3& from_unit, bool perspective);

    /// Finds parts that together hold all that may be seen of the surface where `others` may hide it; at most
    /// `most` of them.
    std::vector<Part> seen(Others others, std::size_t most = SIZE_MAX) const;
    /// May something be seen of where a part passes through another body's surface?
    bool may_show_meeting(const SeenBody& other, const Part& part) const;

  private:
    SurfacePiece piece_of(const Triangle& corners) const;
    void add_seen(const Triangle& corners, Others& others, std::size_t from, std::size_t to, int level,
                  std::size_t most, std::vector<Part>& found) const;
    bool shows(const Triangle& corners, const SeenBody& other, Others& others, std::size_t from,
               std::size_t to, int level) const;
    bool leave_doubts(const SurfacePiece& piece, Others& others, std::size_t from, std::size_t to) const;

    const SeenBody& m_body;
    glm::dmat3 m_from_unit;
    bool m_perspective;
    double m_size = 0;
};

}  // namespace anamorph::figure
