// SPDX-License-Identifier: Apache-2.0
// What a body hides of small pieces of lines and surfaces; and what of a body may be seen at all.
#pragma once

#include <span>
#include <vector>

#include "anamorph/figure/outline_body.h"

namespace anamorph {

/// All that lies within `around` of the line from center - half to center + half, as View::to_view gives it.
struct Piece {
    glm::dvec3 center{0.0}, half{0.0};
    double around = 0;
};

enum class Cover { none, partly, all };

/// What of a piece a body hides; `partly` also where this is not sure.
Cover cover_of(const SeenBody& body, const Piece& piece, bool perspective);
/// What of a piece of a body's surface is on the far side of it.
Cover far_side_of(const SeenBody& body, const Piece& piece);

/// Does a body hide a point? To rounding: not where the point is on its surface or its limb.
bool hides(const SeenBody& body, const glm::dvec3& point, bool perspective);
/// Is a point of a body's surface on the far side of it?
bool is_on_far_side(const SeenBody& body, const glm::dvec3& point);

/// May the body's surface pass through a piece?
bool may_meet(const SeenBody& body, const Piece& piece);

/// Pieces that together hold all that may be seen of the surface of a solid body, which `from_unit` and its
/// center make of the unit sphere. `others` are the bodies that may hide it; those that do are moved ahead.
std::vector<Piece> seen_pieces(const SeenBody& body, const glm::dmat3& from_unit,
                               std::vector<const SeenBody*> others, bool perspective);

}  // namespace anamorph
