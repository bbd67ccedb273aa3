// SPDX-License-Identifier: Apache-2.0
// Polylines along limbs, with a bound: x(t) on an arc of half-width h about m, and the point of its chord
// that has the same component across the direction x(m) - center, differ by (cos(t - m) - cos h) (x(m) -
// center).
#include <algorithm>
#include <cmath>

#include "anamorph/figure/outline/outline.h"
#include "anamorph/number/hypot.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::figure {
namespace {

constexpr double kMostChords = 1 << 20;

[[noreturn]] void too_many(double tol) {
    throw Error("tol", shortest(tol), "must be a tolerance that a million chords can hold");
}

/// 1 - cos(h), without cancellation.
double sagitta(double h) {
    const double s = std::sin(0.5 * h);
    return 2 * s * s;
}

/// Orthographic: the sagitta is at most (1 - cos h) times the longest half-axis.
std::vector<double> even_angles(const Outline& outline, const Arc& arc, const View& view, double tol) {
    const glm::dvec2 cosine(outline.viewed.cosine), sine(outline.viewed.sine);
    const double major = view.scale * principal_axes(Ellipse<glm::dvec2>{{0, 0}, cosine, sine}).major;
    // At least three chords a turn keep an ellipse from falling to a line.
    const double widest = std::acos(-0.5);
    const double step =
        major > 2 * tol ? std::min(widest, 4 * std::asin(std::sqrt(0.5 * tol / major))) : widest;
    const double count = std::ceil(arc.length() / step * (1 - 0x1p-50));
    if (!(count <= kMostChords)) too_many(tol);
    std::vector<double> angles;
    angles.reserve(static_cast<std::size_t>(count) + 1);
    for (int k = 0; k < count; ++k) angles.push_back(arc.begin + arc.length() * (k / count));
    angles.push_back(arc.end);
    return angles;
}

/// Perspective: how far the image of the chord from a to b is from that of the arc, at most. A point y of the
/// chord and the limb's point y + k r, 0 <= k <= 1, with r the sagitta as a vector, have images
/// zoom k (r.xy - y.xy / y.z r.z) / (y.z + k r.z) apart, and y.xy / y.z is nowhere larger than at an end.
double deviation(const Ellipse<glm::dvec3>& limb, double a, double b, double zoom) {
    const double m = 0.5 * (a + b), h = 0.5 * (b - a);
    const glm::dvec3 r = (limb(m) - limb.center) * sagitta(h), from = limb(a), to = limb(b);
    const double reach = hypot(limb.cosine.z, limb.sine.z);
    // The farthest nearer point of arc and chord: the ends', less the chord's sagitta.
    const double nearest = std::max(std::min(from.z, to.z) - std::fabs(r.z), limb.center.z - reach);
    if (!(nearest > 0)) return HUGE_VAL;
    const double slope = std::max(glm::length(glm::dvec2(from)) / from.z, glm::length(glm::dvec2(to)) / to.z);
    return zoom * (glm::length(glm::dvec2(r)) + slope * std::fabs(r.z)) / nearest;
}

void bisect(const Ellipse<glm::dvec3>& limb, double a, double b, double zoom, double tol,
            std::vector<double>& angles) {
    const double m = 0.5 * (a + b);
    if ((b - a <= 2.1 && deviation(limb, a, b, zoom) <= tol) || !(m > a && m < b)) {
        angles.push_back(b);
        if (static_cast<double>(angles.size()) > kMostChords) too_many(tol);
        return;
    }
    bisect(limb, a, m, zoom, tol, angles);
    bisect(limb, m, b, zoom, tol, angles);
}

}  // namespace

std::vector<double> chord_angles(const Outline& outline, const Arc& arc, const View& view, double tol) {
    kOutlineTolRow.check(tol, "tol");
    if (!view.perspective()) return even_angles(outline, arc, view, tol);
    std::vector<double> angles{arc.begin};
    bisect(outline.viewed, arc.begin, arc.end, view.scale * view.eye_distance, tol, angles);
    return angles;
}

std::vector<glm::dvec2> chords(const Outline& outline, const Arc& arc, const View& view, double tol) {
    std::vector<glm::dvec2> points;
    for (const double angle : chord_angles(outline, arc, view, tol))
        points.push_back(outline.on_screen(angle, view));
    return points;
}

}  // namespace anamorph::figure
