// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline_crossing.h"

#include <algorithm>
#include <cmath>

#include "anamorph/figure/outline_arcs.h"
#include "anamorph/figure/outline_hiding.h"
#include "anamorph/figure/outline_loops.h"

namespace anamorph {
namespace {

/// From the unit sphere of a solid body to directions in view, R diag(a).
glm::dmat3 from_unit(const Ellipsoid& body, const View& view) {
    glm::dmat3 m = view.rotation * body.rotation;
    for (int k = 0; k < 3; ++k) m[k] *= std::fabs(body.axes[k]);
    return m;
}

double norm(const glm::dmat3& m) {
    return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

/// The unit sphere of `on` with the surface of `other` in it.
SphereCurve curve_on(const SeenBody& on, const glm::dmat3& from_unit_on, const SeenBody& other) {
    const glm::dmat3 unit = glm::transpose(other.unit);
    SphereCurve curve{unit * from_unit_on, unit * (on.center - other.center), 0};
    const double reach = glm::length(on.center) + glm::length(other.center) + norm(from_unit_on);
    curve.noise = 32 * 0x1p-52 * other.unit_size * reach;
    return curve;
}

/// Adds what of the chord is on the far side of a body that it lies on.
void add_far_side(const glm::dvec3& from, const glm::dvec3& to, const SeenBody& body,
                  std::vector<Arc>& hidden) {
    if (!body.covers) return;
    const double a = glm::dot(body.beyond, from - body.viewed.center),
                 b = glm::dot(body.beyond, to - body.viewed.center);
    if (a <= 0 && b <= 0) return;
    if (a > 0 && b > 0) {
        hidden.push_back({0, 1});
        return;
    }
    const double s = a / (a - b);
    hidden.push_back(a > 0 ? Arc{0, s} : Arc{s, 1});
}

class Pair {
  public:
    Pair(std::span<const Ellipsoid> bodies, const std::vector<SeenBody>& seen, const View& view, int i, int j)
        : m_seen(seen), m_view(view), m_first(i), m_second(j) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        const glm::dmat3 from_a = from_unit(bodies[a], view), from_b = from_unit(bodies[b], view);
        const SphereCurve on_a = curve_on(seen[a], from_a, seen[b]),
                          on_b = curve_on(seen[b], from_b, seen[a]);
        // Where the other body is the larger one, cells need not be small.
        const bool first = norm(on_a.matrix) <= norm(on_b.matrix);
        m_curve = first ? on_a : on_b;
        m_from_unit = first ? from_a : from_b;
        m_center = first ? seen[a].center : seen[b].center;
    }

    std::vector<CrossingCurve> curves(double tol) const {
        const double size = norm(m_from_unit);
        const auto holds = [&](const glm::dvec3& u, double radius, double deviation) {
            double zoom = m_view.scale;
            if (m_view.perspective()) {
                const glm::dvec3 p = m_center + m_from_unit * u;
                const double depth = std::max(p.z - size * radius, m_view.near);
                zoom *=
                    m_view.eye_distance / depth * (1 + (glm::length(glm::dvec2(p)) + size * radius) / depth);
            }
            return zoom * size * deviation <= tol;
        };
        std::vector<CrossingCurve> all;
        for (const std::vector<glm::dvec3>& loop : loops_of(m_curve, holds)) {
            CrossingCurve curve;
            curve.first = m_first;
            curve.second = m_second;
            for (const glm::dvec3& u : loop) curve.points.push_back(m_center + m_from_unit * u);
            all.push_back(std::move(curve));
        }
        return all;
    }

    /// Finds what is seen of a curve whose points are in view.
    void hide(CrossingCurve& curve, const std::vector<int>& near_by, bool by_bodies) const {
        const std::size_t count = curve.points.size();
        const std::vector<int> others = by_bodies ? before(curve, near_by) : std::vector<int>();
        std::vector<Arc> hidden, cut;
        const auto append = [](std::vector<Arc>& to, const std::vector<Arc>& parts, std::size_t chord) {
            const auto base = static_cast<double>(chord);
            for (const Arc& part : parts) to.push_back({base + part.begin, base + part.end});
        };
        for (std::size_t k = 0; k < count; ++k) {
            const glm::dvec3 &from = curve.points[k], &to = curve.points[(k + 1) % count];
            if (m_view.perspective()) append(cut, nearer_part(from.z, to.z, m_view.near), k);
            if (!by_bodies) continue;
            std::vector<Arc> parts;
            for (const int body : {m_first, m_second}) add_far_side(from, to, seen(body), parts);
            for (const int body : others) add_hidden(from, to, seen(body), m_view.perspective(), parts);
            append(hidden, parts, k);
        }
        const auto period = static_cast<double>(count);
        split(std::move(hidden), cut, period, true, curve.visible, curve.hidden);
    }

  private:
    /// Those other bodies that may lie before the curve.
    std::vector<int> before(const CrossingCurve& curve, const std::vector<int>& near_by) const {
        const ScreenBox box = box_of(curve.points, m_view.perspective());
        std::vector<int> others;
        for (const int body : near_by)
            if (body != m_first && body != m_second && may_hide(seen(body), box)) others.push_back(body);
        return others;
    }

    const SeenBody& seen(int body) const { return m_seen[static_cast<std::size_t>(body)]; }

    const std::vector<SeenBody>& m_seen;
    const View& m_view;
    int m_first, m_second;
    SphereCurve m_curve;
    glm::dmat3 m_from_unit{1.0};
    glm::dvec3 m_center{0.0};
};

}  // namespace

std::vector<CrossingCurve> crossing_curves(std::span<const Ellipsoid> bodies,
                                           const std::vector<SeenBody>& seen, const View& view, double tol,
                                           bool hide, const ParallelFor& parallel_for) {
    std::vector<ScreenBox> boxes;
    for (const SeenBody& body : seen)
        boxes.push_back({body.low, body.high, 2 * body.center.z - body.nearest});
    const std::vector<std::vector<int>> near_by = overlapping(boxes, seen);
    const glm::dmat3 to_scene = glm::transpose(view.rotation);
    const glm::dvec3 eye(0, 0, view.perspective() ? view.eye_distance : 0);

    std::vector<std::vector<CrossingCurve>> found(bodies.size());
    parallel_for(static_cast<std::int64_t>(bodies.size()), [&](std::int64_t n) {
        const auto i = static_cast<std::size_t>(n);
        std::vector<int> others = near_by[i];
        std::sort(others.begin(), others.end());
        for (const int j : others) {
            const SeenBody& other = seen[static_cast<std::size_t>(j)];
            if (j <= static_cast<int>(i) || !seen[i].solid || !other.solid) continue;
            const Pair pair(bodies, seen, view, static_cast<int>(i), j);
            for (CrossingCurve& curve : pair.curves(tol)) {
                pair.hide(curve, others, hide);
                for (glm::dvec3& p : curve.points) p = view.center + to_scene * (p - eye);
                found[i].push_back(std::move(curve));
            }
        }
    });
    std::vector<CrossingCurve> all;
    for (std::vector<CrossingCurve>& curves : found)
        std::move(curves.begin(), curves.end(), std::back_inserter(all));
    return all;
}

}  // namespace anamorph
