// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/outline_hiding.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <numeric>

#include "anamorph/figure/body/rotation.h"
#include "anamorph/figure/outline/outline_arcs.h"
#include "anamorph/figure/outline/outline_cover.h"

namespace anamorph::figure {
namespace {

/// row . (a point of the limb - origin), as the point moves along the limb.
Wave wave_of(const glm::dvec3& row, const Ellipse<glm::dvec3>& limb, const glm::dvec3& from_origin) {
    return {glm::dot(row, from_origin), glm::dot(row, limb.cosine), glm::dot(row, limb.sine)};
}

/// Where a point stands against one body.
struct Standing {
    double surface;  ///< |u|^2 - 1 in the body's unit sphere: negative inside
    double cone;     ///< negative where the view line through the point meets the limb's area
    double beyond;   ///< positive on the far side of the limb's plane
};

/// The point of a limb as a body `other` has it.
struct Path {
    WaveSquares surface, cone;
    Wave beyond;
    double beyond_noise = 0;

    Path(const SeenBody& body, const SeenBody& other, bool perspective) {
        const double reach = body.reach + glm::length(other.center);
        if (other.solid) {
            const glm::dvec3 d = body.viewed.center - other.center;
            surface.x = wave_of(other.unit[0], body.viewed, d);
            surface.y = wave_of(other.unit[1], body.viewed, d);
            surface.z = wave_of(other.unit[2], body.viewed, d);
            surface.w.k = 1;
            surface.noise = kHidingRounding * other.unit_size * reach;
        }
        if (other.covers) {
            const glm::dvec3 d = body.viewed.center - other.viewed.center;
            cone.x = wave_of(other.x_row, body.viewed, d);
            cone.y = wave_of(other.y_row, body.viewed, d);
            beyond = wave_of(other.beyond, body.viewed, d);
            if (perspective) cone.w = beyond;
            cone.w.k += 1;
            cone.noise = kHidingRounding * other.cone_size * reach;
            beyond_noise = kHidingRounding * other.beyond_size * reach;
        }
    }
};

enum class Hidden { no, yes, unsure };

/// Hidden: inside the body, or behind it. Around the eye: outside it. Unsure where rounding may decide, which does not count as hidden.
Hidden hidden_at(const Path& path, const SeenBody& other, double t) {
    const UnitVector d = direction(t);
    const auto sign = [](double value, double noise) { return value > noise ? 1 : value < -noise ? -1 : 0; };
    const int surface = other.solid ? sign(path.surface.at(d), path.surface.noise) : 1;
    if (other.kind == OutlineKind::around_eye)
        return surface > 0 ? Hidden::yes : surface < 0 ? Hidden::no : Hidden::unsure;
    if (surface < 0) return Hidden::yes;
    const Hidden outside = surface > 0 ? Hidden::no : Hidden::unsure;
    if (!other.covers) return outside;
    const int beyond = sign(path.beyond.at(d), path.beyond_noise);
    if (beyond < 0) return outside;
    const int cone = sign(path.cone.at(d), path.cone.noise);
    if (cone > 0) return outside;
    return beyond > 0 && cone < 0 ? Hidden::yes : Hidden::unsure;
}

/// Is an arc hidden on which nothing changes? One point tells that is sure. Bodies that touch from inside leave single points of it
/// open, two at most: three are asked.
bool is_hidden(const Path& path, const SeenBody& other, const Arc& arc) {
    for (const double part : {0.5, 0.31, 0.77})
        if (const Hidden hidden = hidden_at(path, other, arc.begin + part * arc.length());
            hidden != Hidden::unsure)
            return hidden == Hidden::yes;
    return false;
}

/// No point of the path comes within the circle about the limb of `other` on its own scale: on the line from the circle's middle to the
/// path's, all of it lies farther.
bool passes_by(const WaveSquares& cone) {
    const double square = cone.x.k * cone.x.k + cone.y.k * cone.y.k, distance = std::sqrt(square);
    const Wave along{square, cone.x.k * cone.x.c + cone.y.k * cone.y.c,
                     cone.x.k * cone.x.s + cone.y.k * cone.y.s};
    const double circle = std::fabs(cone.w.k) + cone.w.amplitude() + cone.noise;
    return square - along.amplitude() > circle * distance + 0x1p-40 * square;
}

}  // namespace

void add_hidden(const SeenBody& body, const SeenBody& other, bool perspective, std::vector<Arc>& hidden) {
    const bool around_eye = other.kind == OutlineKind::around_eye;
    if (around_eye ? !other.solid : !other.covers && !other.solid) return;
    const Path path(body, other, perspective);
    Roots roots;
    bool all_beyond = false;
    if (!around_eye && other.covers) {
        if (passes_by(path.cone)) return;
        const double swing = path.beyond.amplitude();
        all_beyond = path.beyond.k - swing > path.beyond_noise;
        // Before the limb's plane, only what is inside is hidden.
        const bool all_before = path.beyond.k + swing < -path.beyond_noise;
        if (all_before && !other.solid) return;
        if (!all_before) add_roots(path.cone, roots);
        // A path may come from before a body to behind it where it only touches the rim.
        add_roots(path.beyond, roots);
    }
    // Beyond the limb's plane, what is inside is also behind.
    if (other.solid && !all_beyond) add_roots(path.surface, roots);
    if (roots.count == 0) {
        if (is_hidden(path, other, Arc{0, kTurn})) hidden.push_back({0, kTurn});
        return;
    }
    // Between two roots nothing changes: the middle decides.
    for (int k = 0; k < roots.count; ++k) {
        const bool last = k + 1 == roots.count;
        const Arc arc{roots.angle[k], last ? roots.angle[0] + kTurn : roots.angle[k + 1]};
        if (!(arc.end > arc.begin) || !is_hidden(path, other, arc)) continue;
        hidden.push_back(arc);
        // Cut at the turn by the root itself: a turn more and less would round it, and leave an arc of no
        // length.
        if (last) {
            hidden.back().end = kTurn;
            hidden.push_back({0, roots.angle[0]});
        }
    }
}

namespace {

/// The roots of |a + s b|^2 = 1 + 2 s h + s^2 g, of a point on a line, in s.
void add_line_roots(double constant, double half_linear, double square, std::vector<double>& roots) {
    const double discriminant = half_linear * half_linear - constant * square;
    if (!(discriminant >= 0)) return;
    const double q = -(half_linear + std::copysign(std::sqrt(discriminant), half_linear));
    if (square != 0) roots.push_back(q / square);
    if (q != 0) roots.push_back(constant / q);
}

}  // namespace

void add_hidden(const glm::dvec3& from, const glm::dvec3& to, const SeenBody& other, bool perspective,
                std::vector<Arc>& hidden) {
    const glm::dvec3 step = to - from;
    const bool around_eye = other.kind == OutlineKind::around_eye;
    std::vector<double> cuts;
    glm::dvec3 u{0.0}, v{0.0};
    if (other.solid) {
        // Transposed: rows stand in the columns.
        u = (from - other.center) * other.unit;
        v = step * other.unit;
        add_line_roots(glm::dot(u, u) - 1, glm::dot(u, v), glm::dot(v, v), cuts);
    }
    const glm::dvec3 d = from - other.viewed.center;
    const auto along = [&](const glm::dvec3& row) {
        return glm::dvec2(glm::dot(row, d), glm::dot(row, step));
    };
    glm::dvec2 x{0.0}, y{0.0}, beyond{0.0}, w{1, 0};
    if (other.covers && !around_eye) {
        x = along(other.x_row);
        y = along(other.y_row);
        beyond = along(other.beyond);
        if (perspective) w += beyond;
        add_line_roots(x.x * x.x + y.x * y.x - w.x * w.x, x.x * x.y + y.x * y.y - w.x * w.y,
                       x.y * x.y + y.y * y.y - w.y * w.y, cuts);
        if (beyond.y != 0) cuts.push_back(-beyond.x / beyond.y);
    }
    std::erase_if(cuts, [](double s) { return !(s > 0 && s < 1); });
    cuts.push_back(0);
    cuts.push_back(1);
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k)
        if (cuts[k + 1] > cuts[k] && hides(other, from + step * (0.5 * (cuts[k] + cuts[k + 1])), perspective))
            hidden.push_back({cuts[k], cuts[k + 1]});
}

ScreenBox box_of(std::span<const glm::dvec3> points, bool perspective) {
    const glm::dvec2 all(HUGE_VAL);
    ScreenBox box{all, -all, -HUGE_VAL};
    for (const glm::dvec3& p : points) {
        box.farthest = std::max(box.farthest, p.z);
        const bool before = !perspective || p.z > 0;
        const glm::dvec2 at = perspective ? glm::dvec2(p) / p.z : glm::dvec2(p);
        box.low = before ? glm::min(box.low, at) : -all;
        box.high = before ? glm::max(box.high, at) : all;
        if (!before) box.farthest = HUGE_VAL;
    }
    return box;
}

bool may_hide(const SeenBody& body, const ScreenBox& box) {
    return box.low.x <= body.high.x && body.low.x <= box.high.x && box.low.y <= body.high.y &&
           body.low.y <= box.high.y && body.nearest <= box.farthest;
}

Overlaps::Overlaps(const std::vector<SeenBody>& bodies) : m_bodies(bodies), m_by_left(bodies.size()) {
    std::iota(m_by_left.begin(), m_by_left.end(), 0);
    std::stable_sort(m_by_left.begin(), m_by_left.end(), [&](int a, int b) {
        return bodies[static_cast<std::size_t>(a)].low.x < bodies[static_cast<std::size_t>(b)].low.x;
    });
    m_right.reserve(bodies.size());
    double right = -HUGE_VAL;
    for (const int i : m_by_left) {
        right = std::max(right, bodies[static_cast<std::size_t>(i)].high.x);
        m_right.push_back(right);
    }
}

void Overlaps::find(const ScreenBox& box, std::vector<int>& found) const {
    found.clear();
    // From the first that nothing before it reaches the box, to the last that begins left of its right end.
    const auto from = std::lower_bound(m_right.begin(), m_right.end(), box.low.x) - m_right.begin();
    for (auto k = static_cast<std::size_t>(from); k < m_by_left.size(); ++k) {
        const SeenBody& body = m_bodies[static_cast<std::size_t>(m_by_left[k])];
        if (body.low.x > box.high.x) break;
        if (may_hide(body, box)) found.push_back(m_by_left[k]);
    }
}

}  // namespace anamorph::figure
