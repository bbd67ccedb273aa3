// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/outline.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anamorph/figure/body/rotation.h"
#include "anamorph/figure/outline/outline_arcs.h"
#include "anamorph/figure/outline/outline_body.h"
#include "anamorph/figure/outline/outline_crossing.h"
#include "anamorph/figure/outline/outline_hiding.h"
#include "anamorph/number/hypot.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::figure {
namespace {

/// Depth along the limb: w + reach cos(t - peak).
struct Depth {
    double w, reach, peak;

    explicit Depth(const Ellipse<glm::dvec3>& viewed)
        : w(viewed.center.z),
          reach(hypot(viewed.cosine.z, viewed.sine.z)),
          peak(std::atan2(viewed.sine.z, viewed.cosine.z)) {}
    /// The geometric mean of the nearest and the farthest.
    double mean() const { return std::sqrt((w - reach) * (w + reach)); }
};

/// The image of a limb before the eye. With s the angle on it and t that on the limb, both from the limb's
/// farthest point: 1 / depth, cos(t) / depth and sin(t) / depth are linear in cos(s) and sin(s).
Ellipse<glm::dvec2> screen_of(const Ellipse<glm::dvec3>& viewed, const View& view) {
    const glm::dvec2 center(viewed.center), cosine(viewed.cosine), sine(viewed.sine);
    if (!view.perspective())
        return {view.middle + view.scale * center, view.scale * cosine, view.scale * sine};
    const Depth depth(viewed);
    const double c = std::cos(depth.peak), s = std::sin(depth.peak), zoom = view.scale * view.eye_distance;
    const double area = depth.mean() * depth.mean();
    const glm::dvec2 far = cosine * c + sine * s, side = sine * c - cosine * s;
    const glm::dvec2 p = (far * depth.w - center * depth.reach) * (zoom / area),
                     q = side * (zoom / depth.mean());
    return {view.middle + (center * depth.w - far * depth.reach) * (zoom / area), p * c - q * s,
            p * s + q * c};
}

/// The arc of a limb that is nearer than `near`.
Arc cut_arc(const Ellipse<glm::dvec3>& viewed, double near) {
    const Depth depth(viewed);
    const double half = std::acos(std::clamp((near - depth.w) / depth.reach, -1.0, 1.0));
    const double begin = in_turn(depth.peak + half);
    return {begin, begin + kTurn - 2 * half};
}

/// Does the image of a limb lie outside of a window, for all rounding?
bool is_outside(const SeenBody& body, const View& view, const ScreenWindow& window) {
    const double zoom = view.perspective() ? view.scale * view.eye_distance : view.scale;
    for (int k = 0; k < 2; ++k) {
        const double low = zoom * body.low[k], high = zoom * body.high[k], middle = view.middle[k];
        const double slack = 0x1p-40 * (std::fabs(low) + std::fabs(high) + std::fabs(middle));
        if (middle + low - slack > window.high[k] || middle + high + slack < window.low[k]) return true;
    }
    return false;
}

/// The limb of a body, without arcs.
Outline limb_of(const SeenBody& body, const View& view) {
    Outline outline;
    outline.kind = body.kind;
    if (body.kind == OutlineKind::around_eye) return outline;
    outline.limb = body.limb;
    outline.viewed = body.viewed;
    if (body.kind == OutlineKind::behind) return outline;
    if (body.kind == OutlineKind::whole) outline.screen = screen_of(body.viewed, view);
    return outline;
}

void add_arcs(Outline& outline, const SeenBody& body, std::size_t position, const std::vector<SeenBody>& all,
              const std::vector<int>& near_by, const View& view) {
    std::vector<Arc> hidden;
    for (const int j : near_by)
        if (static_cast<std::size_t>(j) != position)
            add_hidden(body, all[static_cast<std::size_t>(j)], view.perspective(), hidden);
    std::vector<Arc> cut;
    if (body.kind == OutlineKind::cut) cut = {cut_arc(body.viewed, view.near)};
    split(std::move(hidden), cut, kTurn, true, outline.visible, outline.hidden);
}

}  // namespace

double Outline::screen_angle(double angle, const View& view) const {
    if (!view.perspective()) return angle;
    const Depth depth(viewed);
    const double t = angle - depth.peak, turns = kTurn * std::round(t / kTurn);
    return depth.peak + turns + std::atan2(depth.mean() * std::sin(t), depth.w * std::cos(t) + depth.reach);
}

double Outline::limb_angle(double angle, const View& view) const {
    if (!view.perspective()) return angle;
    const Depth depth(viewed);
    const double s = angle - depth.peak, turns = kTurn * std::round(s / kTurn);
    return depth.peak + turns + std::atan2(depth.mean() * std::sin(s), depth.w * std::cos(s) - depth.reach);
}

Outlines outlines(std::span<const Ellipsoid> bodies, const View& view, const OutlineOptions& options,
                  const ParallelFor& parallel_for) {
    if (options.crossings) kOutlineTolRow.check(options.tol, "tol");
    const std::vector<SeenBody> seen = see_all(bodies, view, options.names, parallel_for);
    std::vector<ScreenBox> boxes;
    boxes.reserve(seen.size());
    for (const SeenBody& body : seen)
        boxes.push_back(body.seen() ? ScreenBox{body.low, body.high, body.limb_farthest}
                                    : ScreenBox{glm::dvec2(1), glm::dvec2(-1), -HUGE_VAL});
    const Overlaps overlaps(seen);
    Outlines result;
    result.bodies.resize(bodies.size());
    constexpr std::size_t batch = 16;
    parallel_for(static_cast<std::int64_t>((bodies.size() + batch - 1) / batch), [&](std::int64_t k) {
        const std::size_t first = static_cast<std::size_t>(k) * batch;
        std::vector<int> near_by;
        for (std::size_t i = first; i < std::min(first + batch, bodies.size()); ++i) {
            result.bodies[i] = limb_of(seen[i], view);
            if (!seen[i].seen() || is_outside(seen[i], view, options.window)) continue;
            if (options.hide) overlaps.find(boxes[i], near_by);
            add_arcs(result.bodies[i], seen[i], i, seen, near_by, view);
        }
    });
    // Limbs tell at once where a tolerance asks for too many chords, crossings late.
    if (options.crossings)
        for (const Outline& outline : result.bodies)
            if (outline.kind == OutlineKind::whole) chord_angles(outline, {0, kTurn}, view, options.tol);
    if (options.crossings) result.crossings = crossing_curves(bodies, seen, view, options, parallel_for);
    return result;
}

Outlines outlines(const FigureFrame& frame, const View& view, OutlineOptions options,
                  const ParallelFor& parallel_for) {
    std::vector<Ellipsoid> shapes;
    options.names.clear();
    shapes.reserve(frame.bodies.size());
    options.names.reserve(frame.bodies.size());
    for (const Body& body : frame.bodies) {
        shapes.push_back(body.shape);
        options.names.push_back(body.name);
    }
    return outlines(shapes, view, options, parallel_for);
}

void hide_lines(std::span<SeenLine> lines, std::span<const Ellipsoid> bodies, const View& view,
                const std::vector<std::vector<int>>& ignored, const ParallelFor& parallel_for) {
    const std::vector<SeenBody> seen = see_all(bodies, view, {}, parallel_for);
    for (std::size_t i = 0; i < lines.size(); ++i)
        for (const glm::dvec3& end : {lines[i].from, lines[i].to})
            check_point("line " + std::to_string(i), end);
    std::vector<std::array<glm::dvec3, 2>> ends;
    std::vector<ScreenBox> boxes;
    for (const SeenLine& line : lines) {
        ends.push_back({view.to_view(line.from), view.to_view(line.to)});
        boxes.push_back(box_of(ends.back(), view.perspective()));
    }
    const Overlaps overlaps(seen);
    parallel_for(static_cast<std::int64_t>(lines.size()), [&](std::int64_t k) {
        const auto i = static_cast<std::size_t>(k);
        SeenLine& line = lines[i];
        const auto& [from, to] = ends[i];
        std::vector<Arc> hidden, cut;
        if (view.perspective()) cut = nearer_part(from.z, to.z, view.near);
        for (const int j : overlaps.with(boxes[i])) {
            const bool skip =
                i < ignored.size() && std::find(ignored[i].begin(), ignored[i].end(), j) != ignored[i].end();
            if (!skip) add_hidden(from, to, seen[static_cast<std::size_t>(j)], view.perspective(), hidden);
        }
        split(std::move(hidden), cut, 1, false, line.visible, line.hidden);
    });
}

}  // namespace anamorph::figure
