// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/viewport.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>
#include <utility>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::figure {
namespace {

/// Parts of a side that the circle leaves are no shorter, in its radii.
constexpr double kLeastPiece = 1e-9;
constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kFarthestMiddle = 10, kLeastHalfAxis = 1e-4, kMostHalfAxis = 10;  // shares of the page

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

/// The point where the viewport is the unit circle.
glm::dvec2 on_unit(const glm::dvec2& p, const Viewport& viewport) {
    return (p - viewport.middle) / viewport.half_axes;
}

/// The part of a segment, 0 to 1, in the unit circle.
std::optional<std::pair<double, double>> part_in_circle(const glm::dvec2& a, const glm::dvec2& b) {
    // |a + s d|^2 = 1 is square s^2 + 2 half s + rest = 0; half^2 - square rest = square - cross(a, d)^2.
    const glm::dvec2 d = b - a;
    const double square = glm::dot(d, d), half = glm::dot(a, d), rest = glm::dot(a, a) - 1;
    if (!(square > 0)) return rest <= 0 ? std::optional(std::pair(0.0, 1.0)) : std::nullopt;
    const double apart = cross(a, d), room = square - apart * apart;
    if (!(room >= 0)) return std::nullopt;
    const double q = -(half + std::copysign(std::sqrt(room), half));
    const double first = q / square, second = q != 0 ? rest / q : first;
    const bool ends_in = glm::dot(b, b) <= 1;
    const double from = rest <= 0 ? 0 : std::max(std::min(first, second), 0.0),
                 to = ends_in ? 1 : std::min(std::max(first, second), 1.0);
    if (!(from < to)) return std::nullopt;
    return std::pair(from, to);
}

/// Whether a point lies in a convex polygon that turns by `sense`.
bool in_polygon(const glm::dvec2& p, const std::vector<glm::dvec2>& polygon, double sense) {
    for (std::size_t k = 0; k + 1 < polygon.size(); ++k)
        if (sense * cross(polygon[k + 1] - polygon[k], p - polygon[k]) < 0) return false;
    return true;
}

double area_of(const std::vector<glm::dvec2>& polygon) {
    double twice = 0;
    for (std::size_t k = 0; k + 1 < polygon.size(); ++k)
        twice += cross(polygon[k] - polygon[0], polygon[k + 1] - polygon[0]);
    return twice / 2;
}

/// Joins what is left of a polygon's sides by arcs of the unit circle.
class Rounded {
  public:
    Rounded(const std::vector<glm::dvec2>& polygon, double chord)
        : m_polygon(polygon), m_sense(std::copysign(1.0, area_of(polygon))), m_chord(chord) {}

    /// The points of the unit circle after `from` and before `to`, the way that the polygon turns.
    void add_arc(glm::dvec2 from, glm::dvec2 to, std::vector<glm::dvec2>& out) const {
        const double angle = m_sense * std::atan2(cross(from, to), glm::dot(from, to));
        // Two points that are one but for rounding have no arc between them: pieces as short are left out.
        if (angle > -kLeastPiece && angle < kLeastPiece) return;
        add_chords(std::atan2(from.y, from.x), m_sense * (angle < 0 ? angle + kTurn : angle), out);
    }

    std::vector<glm::dvec2> whole_circle() const {
        if (!in_polygon({0, 0}, m_polygon, m_sense)) return {};
        std::vector<glm::dvec2> out{{1, 0}};
        add_chords(0, m_sense * kTurn, out);
        out.push_back(out.front());
        return out;
    }

  private:
    void add_chords(double begin, double angle, std::vector<glm::dvec2>& out) const {
        const double count = std::ceil(std::fabs(angle) / m_chord);
        for (double k = 1; k < count; ++k) {
            const double at = begin + angle * (k / count);
            out.emplace_back(std::cos(at), std::sin(at));
        }
    }

    const std::vector<glm::dvec2>& m_polygon;
    double m_sense, m_chord;
};

}  // namespace

bool Viewport::holds(const glm::dvec2& point) const {
    const glm::dvec2 p = on_unit(point, *this);
    return glm::dot(p, p) <= 1;
}

Viewport viewport_of(std::string_view name, const std::string& text, std::span<const double> numbers) {
    const auto within = [](double x, double least, double most) { return x >= least && x <= most; };
    const bool right = numbers.size() == 4 && within(numbers[0], -kFarthestMiddle, kFarthestMiddle) &&
                       within(numbers[1], -kFarthestMiddle, kFarthestMiddle) &&
                       within(numbers[2], kLeastHalfAxis, kMostHalfAxis) &&
                       within(numbers[3], kLeastHalfAxis, kMostHalfAxis);
    if (!right)
        throw Error(std::string(name), printable(text),
                    "must be x,y,a,b: the middle, from " + shortest(-kFarthestMiddle) + " to " +
                        shortest(kFarthestMiddle) + ", and the half-axes, from " + shortest(kLeastHalfAxis) +
                        " to " + shortest(kMostHalfAxis) + ", of an ellipse in shares of width and height");
    return {{numbers[0], numbers[1]}, {numbers[2], numbers[3]}};
}

Viewport in_pixels(const Viewport& shares, const glm::dvec2& size, const glm::dvec2& corner) {
    return {shares.middle * size + corner, shares.half_axes * size};
}

bool clip(glm::dvec2& a, glm::dvec2& b, const Viewport& viewport) {
    const auto part = part_in_circle(on_unit(a, viewport), on_unit(b, viewport));
    if (!part) return false;
    const glm::dvec2 start = a, d = b - a;
    if (part->second < 1) b = start + part->second * d;
    if (part->first > 0) a = start + part->first * d;
    return true;
}

std::vector<glm::dvec2> clip_polygon(const std::vector<glm::dvec2>& polygon, const Viewport& viewport,
                                     double tol) {
    std::vector<glm::dvec2> unit, out;
    for (const glm::dvec2& p : polygon) unit.push_back(on_unit(p, viewport));
    // A chord over an angle t of a circle of radius r is within r (1 - cos(t / 2)) <= r t^2 / 8 of it; an ellipse's within
    // that of its longer half-axis.
    const double longest = std::max(viewport.half_axes.x, viewport.half_axes.y);
    const Rounded rounded(unit, std::min(std::sqrt(8 * tol / longest), 1.0));
    const auto at = [](const glm::dvec2& a, const glm::dvec2& b, double s) {
        return s == 0 ? a : s == 1 ? b : a + s * (b - a);
    };
    for (std::size_t k = 0; k + 1 < unit.size(); ++k) {
        const auto part = part_in_circle(unit[k], unit[k + 1]);
        if (!part) continue;
        const glm::dvec2 from = at(unit[k], unit[k + 1], part->first),
                         to = at(unit[k], unit[k + 1], part->second);
        if ((part->first > 0 || part->second < 1) && glm::distance(from, to) < kLeastPiece) continue;
        if (!out.empty() && part->first > 0) rounded.add_arc(out.back(), from, out);
        if (out.empty() || out.back() != from) out.push_back(from);
        out.push_back(to);
    }
    if (out.empty())
        out = rounded.whole_circle();
    else if (out.back() != out.front()) {
        rounded.add_arc(out.back(), out.front(), out);
        out.push_back(out.front());
    }
    for (glm::dvec2& p : out) p = viewport.middle + viewport.half_axes * p;
    return out;
}

}  // namespace anamorph::figure
