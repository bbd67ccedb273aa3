// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/outline_cover.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "anamorph/figure/outline/outline_hiding.h"

namespace anamorph::figure {
namespace {

struct Range {
    double low = 0, high = 0;

    Range wider(double by) const { return {low - by, high + by}; }
};

/// The range of |a + t b| for |t| <= 1.
template <class Vector>
Range lengths(const Vector& a, const Vector& b) {
    const double middle = glm::dot(a, a), slope = 2 * std::fabs(glm::dot(a, b));
    if (b == Vector(0.0)) return {std::sqrt(middle), std::sqrt(middle)};
    return {std::sqrt(std::max(0.0, middle - slope)), std::sqrt(middle + slope + glm::dot(b, b))};
}

/// Where a piece is against the limb's area and plane, as SeenBody has them.
struct Shadow {
    Range across, area, beyond;

    Shadow(const SeenBody& body, const SurfacePiece& piece, bool perspective) {
        const glm::dvec3 d = piece.center - body.viewed.center;
        const auto both = [&](const glm::dvec3& row) {
            return glm::dvec2(glm::dot(row, d), glm::dot(row, piece.half));
        };
        const glm::dvec2 x = both(body.x_row), y = both(body.y_row), z = both(body.beyond);
        across = lengths(glm::dvec2(x.x, y.x), glm::dvec2(x.y, y.y)).wider(body.cone_size * piece.around);
        beyond = Range{z.x - std::fabs(z.y), z.x + std::fabs(z.y)}.wider(body.beyond_size * piece.around);
        area = perspective ? Range{1 + beyond.low, 1 + beyond.high} : Range{1, 1};
    }
};

double size_of(const SeenBody& body, const glm::dvec3& point) {
    return glm::length(point) + glm::length(body.center);
}

}  // namespace

Covered cover_of(const SeenBody& body, const SurfacePiece& piece, bool perspective) {
    Range surface{HUGE_VAL, HUGE_VAL};
    const double size = size_of(body, piece.center) + glm::length(piece.half);
    const double noise = kHidingRounding * body.unit_size * size;
    if (body.solid)
        surface = lengths((piece.center - body.center) * body.unit, piece.half * body.unit)
                      .wider(body.unit_size * piece.around + noise);
    if (body.kind == OutlineKind::around_eye)
        return surface.low > 1 ? Covered::all : surface.high < 1 ? Covered::none : Covered::partly;
    if (surface.high < 1) return Covered::all;
    bool beside = true;
    if (body.covers) {
        const Shadow shadow(body, piece, perspective);
        const double rim = kHidingRounding * body.cone_size * size,
                     plane = kHidingRounding * body.beyond_size * size;
        if (shadow.beyond.low > plane && shadow.across.high < shadow.area.low - rim) return Covered::all;
        beside = shadow.beyond.high < -plane || shadow.across.low > shadow.area.high + rim;
    }
    return beside && surface.low > 1 ? Covered::none : Covered::partly;
}

Covered far_side_of(const SeenBody& body, const SurfacePiece& piece) {
    if (!body.covers) return Covered::none;
    const Range beyond = Shadow(body, piece, false).beyond;
    return beyond.low > 0 ? Covered::all : beyond.high <= 0 ? Covered::none : Covered::partly;
}

bool hides(const SeenBody& body, const glm::dvec3& point, bool perspective) {
    const double size = size_of(body, point), surface_noise = kHidingRounding * body.unit_size * size,
                 cone_noise = kHidingRounding * body.cone_size * size,
                 beyond_noise = kHidingRounding * body.beyond_size * size;
    const glm::dvec3 u = (point - body.center) * body.unit;
    const double surface = glm::dot(u, u) - 1;
    if (body.kind == OutlineKind::around_eye) return body.solid && surface > surface_noise;
    if (body.solid && surface < -surface_noise) return true;
    if (!body.covers) return false;
    const glm::dvec3 d = point - body.viewed.center;
    const double x = glm::dot(body.x_row, d), y = glm::dot(body.y_row, d), beyond = glm::dot(body.beyond, d);
    const double w = perspective ? 1 + beyond : 1;
    return beyond > beyond_noise && x * x + y * y - w * w < -cone_noise;
}

bool is_on_far_side(const SeenBody& body, const glm::dvec3& point) {
    return body.covers && glm::dot(body.beyond, point - body.viewed.center) > 0;
}

bool may_meet(const SeenBody& body, const SurfacePiece& piece) {
    const Range surface = lengths((piece.center - body.center) * body.unit, piece.half * body.unit)
                              .wider(body.unit_size * piece.around);
    return surface.low <= 1 && surface.high >= 1;
}

namespace {

std::array<Surface::Triangle, 4> quarters(const Surface::Triangle& corners) {
    const auto& [a, b, c] = corners;
    const glm::dvec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
    return {{{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}}};
}

}  // namespace

Surface::Surface(const SeenBody& body, const glm::dmat3& from_unit, bool perspective)
    : m_body(body), m_from_unit(from_unit), m_perspective(perspective) {
    for (int k = 0; k < 3; ++k) m_size += glm::dot(from_unit[k], from_unit[k]);
    m_size = std::sqrt(m_size);
}

/// A flat triangle's points are no farther from a point than its corners; the sphere's are little above it.
SurfacePiece Surface::piece_of(const Triangle& corners) const {
    const glm::dvec3 middle = glm::normalize(corners[0] + corners[1] + corners[2]);
    SurfacePiece piece;
    piece.center = m_body.center + m_from_unit * middle;
    double radius = 0;
    for (const glm::dvec3& corner : corners) {
        radius = std::max(radius, glm::distance(corner, middle));
        piece.around = std::max(piece.around, glm::length(m_from_unit * (corner - middle)));
    }
    piece.around = (piece.around + 0.5 * m_size * radius * radius) * (1 + 0x1p-30);
    return piece;
}

namespace {

/// A piece's box on the screen; in perspective, everything if some of it is not before the eye.
ScreenBox box_of_piece(const SurfacePiece& piece, bool perspective) {
    const glm::dvec3 reach = (glm::abs(piece.half) + piece.around) * (1 + 0x1p-30),
                     low = piece.center - reach, high = piece.center + reach;
    if (!perspective) return {glm::dvec2(low), glm::dvec2(high), high.z};
    if (!(low.z > 0)) return {glm::dvec2(-HUGE_VAL), glm::dvec2(HUGE_VAL), HUGE_VAL};
    const glm::dvec2 least(low), most(high);
    return {glm::min(least / low.z, least / high.z), glm::max(most / low.z, most / high.z), high.z};
}

}  // namespace

/// Appends those of a range of others that may hide a part of a piece; false where one hides all of it.
bool Surface::leave_doubts(const SurfacePiece& piece, Others& others, std::size_t from,
                           std::size_t to) const {
    const ScreenBox box = box_of_piece(piece, m_perspective);
    for (std::size_t k = from; k < to; ++k) {
        if (!may_hide(*others[k], box)) continue;
        const Covered cover = cover_of(*others[k], piece, m_perspective);
        if (cover == Covered::all) {
            // What hides one piece often hides its neighbour.
            std::swap(others[from], others[k]);
            return false;
        }
        if (cover == Covered::partly) others.push_back(others[k]);
    }
    return true;
}

void Surface::add_seen(const Triangle& corners, Others& others, std::size_t from, std::size_t to, int level,
                       std::size_t most, std::vector<Part>& found) const {
    constexpr int kLevels = 2;
    if (found.size() >= most) return;
    const SurfacePiece piece = piece_of(corners);
    if (far_side_of(m_body, piece) == Covered::all) return;
    const std::size_t next = others.size();
    if (leave_doubts(piece, others, from, to)) {
        const std::size_t end = others.size();
        if (end == next || level == kLevels)
            found.push_back(
                {corners, piece, {others.begin() + static_cast<std::ptrdiff_t>(next), others.end()}});
        else
            for (const Triangle& part : quarters(corners))
                add_seen(part, others, next, end, level + 1, most, found);
    }
    others.resize(next);
}

std::vector<Surface::Part> Surface::seen(Others others, std::size_t most) const {
    std::vector<Part> found;
    const std::size_t count = others.size();
    // An octahedron.
    for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0})
            for (const double z : {-1.0, 1.0})
                add_seen({glm::dvec3(x, 0, 0), glm::dvec3(0, y, 0), glm::dvec3(0, 0, z)}, others, 0, count, 0,
                         most, found);
    return found;
}

bool Surface::shows(const Triangle& corners, const SeenBody& other, Others& others, std::size_t from,
                    std::size_t to, int level) const {
    constexpr int kLevels = 1;
    const SurfacePiece piece = piece_of(corners);
    if (!may_meet(other, piece) || far_side_of(m_body, piece) == Covered::all ||
        far_side_of(other, piece) == Covered::all)
        return false;
    const std::size_t next = others.size();
    bool found = false;
    if (leave_doubts(piece, others, from, to)) {
        const std::size_t end = others.size();
        found = level == kLevels;
        if (!found)
            for (const Triangle& part : quarters(corners))
                if ((found = shows(part, other, others, next, end, level + 1))) break;
    }
    others.resize(next);
    return found;
}

bool Surface::may_show_meeting(const SeenBody& other, const Part& part) const {
    Others others = part.others;
    std::erase(others, &other);
    return shows(part.corners, other, others, 0, others.size(), 0);
}

}  // namespace anamorph::figure
