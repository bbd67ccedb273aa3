// SPDX-License-Identifier: Apache-2.0
// Actions that look for a contact: touch, abut and drag; balance; and what `forbid` forbids.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "anamorph/error.h"
#include "anamorph/figure/body/ellipsoid_distance.h"
#include "anamorph/figure/body/rotation.h"
#include "anamorph/figure/language/actions.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {
namespace {

/// A function of an angle whose zero is looked for, in radians.
struct Probe {
    double value = 0;
    double safe = 0;  ///< no zero is closer than this
};

constexpr double kShortestStep = 1e-3;
constexpr double kTouching = 1e-12;  // less than that is rounding error: it is there

/// The angle where `probe` has its sign change between two.
template <class Function>
double bisect(const Function& probe, double from, double to) {
    const bool sign = probe(from).value > 0;
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (from + to);
        if (middle == from || middle == to) break;
        ((probe(middle).value > 0) == sign ? from : to) = middle;
    }
    return 0.5 * (from + to);
}

/// The angle where `probe` is closest to zero: the best of a round of samples, then golden section about it.
template <class Function>
double closest_to_zero(const Function& probe) {
    constexpr int kSamples = 720;
    constexpr double kStep = 2 * std::numbers::pi / kSamples, kGolden = 0.6180339887498949;
    const auto distance = [&](double angle) { return std::abs(probe(angle).value); };
    double best = 0, least = distance(0.0);
    for (int i = 1; i <= kSamples; ++i) {
        // Outwards from where it is: of equals, the closest is kept.
        const int step = (i + 1) / 2;
        const double angle = (i % 2 ? step : -step) * kStep, there = distance(angle);
        if (!(there < least)) continue;
        best = angle;
        least = there;
    }
    double from = best - kStep, to = best + kStep;
    while (to - from > 1e-9) {
        const double left = to - kGolden * (to - from), right = from + kGolden * (to - from);
        if (distance(left) < distance(right))
            to = right;
        else
            from = left;
    }
    return 0.5 * (from + to);
}

/// The angle closest to 0 in [-pi, pi] where `probe` is zero, found by steps that no zero lies in, both ways
/// in turn. Steps are kShortestStep at least, so two zeros closer than that may be missed.
template <class Function>
std::optional<double> nearest_zero(const Function& probe) {
    struct Walker {
        double sign, angle;
        Probe at;
    };
    const Probe start = probe(0.0);
    if (std::abs(start.value) < kTouching) return 0;
    Walker walkers[2] = {{1, 0, start}, {-1, 0, start}};
    while (true) {
        Walker& w = walkers[walkers[0].angle <= walkers[1].angle ? 0 : 1];
        if (!(w.angle < std::numbers::pi)) return std::nullopt;
        const double next = std::min(w.angle + std::max(w.at.safe, kShortestStep), std::numbers::pi);
        const Probe there = probe(w.sign * next);
        if (there.value == 0) return w.sign * next;
        if ((there.value > 0) != (w.at.value > 0)) return bisect(probe, w.sign * w.angle, w.sign * next);
        w.angle = next;
        w.at = there;
    }
}

template <class Function>
double zero_or_closest(const Function& probe) {
    const std::optional<double> zero = nearest_zero(probe);
    return zero ? *zero : closest_to_zero(probe);
}

double shortest_of(const glm::dvec3& v) {
    return std::min({v.x, v.y, v.z});
}

/// The largest distance that a point of the ellipsoid has from a line.
double farthest_from_line(const Ellipsoid& e, const glm::dvec3& point, const glm::dvec3& unit) {
    const glm::dvec3 from = e.center - point;
    return glm::length(from - glm::dot(from, unit) * unit) + longest(e.axes);
}

Ellipsoid turned(Ellipsoid e, const glm::dvec3& about, const glm::dvec3& unit, double radians) {
    const glm::dmat3 by = glm::mat3_cast(turn_about(unit, radians / kRadiansPerDegree));
    e.center = about + by * (e.center - about);
    e.rotation = by * e.rotation;
    return e;
}

bool contains(const std::vector<int>& list, int item) {
    return std::find(list.begin(), list.end(), item) != list.end();
}

double lowest_of(const Ellipsoid& e) {
    return e.center.y - reach_of(e, {0, 1, 0});
}

}  // namespace

void FigureAction::touch() const {
    const int first = ellipsoid(0), second = ellipsoid(1), bent = ellipsoid(2), at = joint(4);
    const glm::dvec3 unit = direction(ellipsoid(3), axis(5)), pivot = joint_position(at);
    const std::vector<int> part = part_from(m_state, bent, at).bodies;
    const bool moves_first = contains(part, first), moves_second = contains(part, second);
    if (moves_first == moves_second)
        return say("frame " + std::to_string(m_frame) + ", touch: the joint " + joint_name(at) +
                   " does not move " + ellipsoid_name(first) + " against " + ellipsoid_name(second));
    const Ellipsoid moved = shape_of(body(moves_first ? first : second));
    const Ellipsoid still = shape_of(body(moves_first ? second : first));
    const double speed = std::max(farthest_from_line(moved, pivot, unit), 1e-300);
    const double inner = shortest_of(moved.axes) + shortest_of(still.axes);
    const double angle = zero_or_closest([&](double radians) {
        const EllipsoidContact c = contact_of(turned(moved, pivot, unit, radians), still);
        // Apart: the gap has to be crossed. Overlapping: their Minkowski sum has to be left.
        const double way = c.ratio > 1 ? c.gap : (1 - c.ratio) * inner;
        return Probe{c.ratio - 1, std::max(way, 0.0) / speed};
    });
    bend(bent, at, turn_about(unit, angle / kRadiansPerDegree));
}

void FigureAction::abut() const {
    const int first = ellipsoid(0), second = ellipsoid(1);
    const glm::dvec3 unit = direction(ellipsoid(2), axis(3));
    const FigurePart part = part_from(m_state, first, -1);
    if (contains(part.bodies, second))
        return say("frame " + std::to_string(m_frame) + ", abut: " + ellipsoid_name(first) + " and " +
                   ellipsoid_name(second) + " are parts of one figure");
    const Ellipsoid moved = shape_of(body(first)), still = shape_of(body(second));
    const auto contact = [&](double way) {
        Ellipsoid there = moved;
        there.center += way * unit;
        return contact_of(there, still);
    };
    // Along the line the ratio is convex, and falls where the normal points ahead.
    const double nearest = glm::dot(still.center - moved.center, unit);
    const double reach = longest(moved.axes) + longest(still.axes);
    double low = nearest - reach, high = nearest + reach;
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        if (middle <= low || middle >= high) break;
        (glm::dot(contact(middle).normal, unit) > 0 ? low : high) = middle;
    }
    double way = 0.5 * (low + high);
    if (contact(way).ratio < 1) {
        const auto apart = [&](double t) { return Probe{contact(t).ratio - 1, 0}; };
        const double before = bisect(apart, way, nearest - reach - 1e-9 * std::abs(nearest));
        const double after = bisect(apart, way, nearest + reach + 1e-9 * std::abs(nearest));
        way = std::abs(before) < std::abs(after) ? before : after;
    }
    move(part, m_shares.prop * way * unit);
}

void FigureAction::drag() const {
    const int dragged = ellipsoid(0), bent = ellipsoid(1), at = joint(2), chosen = axis(4);
    if (!m_state.topology->is_end(at, bent))
        fail("the ellipsoid " + ellipsoid_name(bent) + " is not at the joint " + joint_name(at));
    const int other = m_state.topology->other_end(at, bent);
    const FigurePart far = part_from(m_state, other, at), whole = part_from(m_state, other, -1);
    if (!contains(part_from(m_state, bent, at).bodies, dragged))
        return say("frame " + std::to_string(m_frame) + ", drag: the joint " + joint_name(at) +
                   " does not move " + ellipsoid_name(dragged));
    const auto ground_far_side = [&] { move(whole, {0, -lowest(m_state, far.bodies), 0}); };
    ground_far_side();
    // The original takes the axis of the other ellipsoid, whatever is asked for.
    if (strict())
        drag_exactly(dragged, bent, at, direction(ellipsoid(3), chosen));
    else
        drag_coarsely(dragged, bent, at, direction(other, chosen));
    ground_far_side();
}

void FigureAction::drag_exactly(int dragged, int bent, int at, const glm::dvec3& unit) const {
    const Ellipsoid shape = shape_of(body(dragged));
    const glm::dvec3 pivot = joint_position(at);
    const double speed = std::max(farthest_from_line(shape, pivot, unit), 1e-300);
    const double angle = zero_or_closest([&](double radians) {
        const double low = lowest_of(turned(shape, pivot, unit, radians));
        return Probe{low, std::abs(low) / speed};
    });
    bend(bent, at, turn_about(unit, angle / kRadiansPerDegree));
}

void FigureAction::drag_coarsely(int dragged, int bent, int at, const glm::dvec3& unit) const {
    const Ellipsoid shape = shape_of(body(dragged));
    const glm::dvec3 pivot = joint_position(at);
    const auto height = [&](double degrees) {
        return std::abs(lowest_of(turned(shape, pivot, unit, degrees * kRadiansPerDegree)));
    };
    double angle = 0;
    for (const double step : {1.0, 0.1, 0.01}) {
        double best = angle;
        for (int i = -10; i <= 10; ++i)
            if (height(angle + i * step) < height(best)) best = angle + i * step;
        angle = best;
    }
    bend(bent, at, turn_about(unit, angle));
}

void FigureAction::balance() const {
    const int bent = ellipsoid(0), at = joint(1);
    const glm::dvec3 unit = direction(ellipsoid(2), axis(3)), up(0, 1, 0);
    double mass = 0;
    glm::dvec3 moment(0.0);
    for (const int i : part_from(m_state, bent, at).bodies) {
        const double m = body(i).axes.x * body(i).axes.y * body(i).axes.z;
        mass += m;
        moment += m * (body(i).center - joint_position(at));
    }
    if (!(mass > 0)) return;
    // The angle about the axis from the centre of mass to the upward direction.
    const glm::dvec3 d = moment / mass;
    const double cosine = glm::dot(d, up) - glm::dot(d, unit) * glm::dot(up, unit);
    const double sine = glm::dot(unit, glm::cross(d, up));
    bend(bent, at, turn_about(unit, std::atan2(sine, cosine) / kRadiansPerDegree));
}

void check_overlaps(const Program& program, const FigureState& state, int frame) {
    if (state.overlaps.empty()) return;
    const auto meet = [&](int i, int j) {
        const Ellipsoid a = shape_of(state.bodies[static_cast<std::size_t>(i)]);
        const Ellipsoid b = shape_of(state.bodies[static_cast<std::size_t>(j)]);
        return glm::distance(a.center, b.center) < longest(a.axes) + longest(b.axes) &&
               contact_of(a, b).ratio < 1;
    };
    const auto names = [](int rule, int body) { return rule == 0 || rule == body; };
    const auto forbidden = [&](int i, int j) {
        for (auto rule = state.overlaps.rbegin(); rule != state.overlaps.rend(); ++rule)
            if ((names(rule->first, i) && names(rule->second, j)) ||
                (names(rule->first, j) && names(rule->second, i)))
                return rule->forbidden;
        return false;
    };
    const auto check = [&](int i, int j) {
        if (i == j || !forbidden(i, j) || !meet(i, j)) return;
        throw Error("frame " + std::to_string(frame) + ": the ellipsoids " +
                    text_file::excerpt(program.ellipsoids[static_cast<std::size_t>(i)].name) + " and " +
                    text_file::excerpt(program.ellipsoids[static_cast<std::size_t>(j)].name) +
                    " meet, which is forbidden");
    };
    // Neighbours overlap at their joint: world, which stands for all, does not mean them.
    const auto neighbours = [&](int i, int j) {
        const auto& joints = state.topology->joints_of[static_cast<std::size_t>(i)];
        return std::any_of(joints.begin(), joints.end(),
                           [&](int joint) { return state.topology->is_end(joint, j); });
    };
    const int count = static_cast<int>(state.bodies.size());
    for (const auto& rule : state.overlaps) {
        if (!rule.forbidden) continue;
        for (int i = rule.first ? rule.first : 1; i < (rule.first ? rule.first + 1 : count); ++i)
            for (int j = rule.second ? rule.second : 1; j < (rule.second ? rule.second + 1 : count); ++j)
                if ((rule.first && rule.second) || !neighbours(i, j)) check(i, j);
    }
}

}  // namespace anamorph::figure
