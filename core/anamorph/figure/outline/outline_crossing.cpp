// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/outline_crossing.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "anamorph/figure/outline/outline_arcs.h"
#include "anamorph/figure/outline/outline_cover.h"
#include "anamorph/figure/outline/outline_hiding.h"
#include "anamorph/figure/outline/outline_loops.h"

namespace anamorph::figure {
namespace {

/// R diag(a), which takes the unit sphere of a solid body to directions in view.
glm::dmat3 from_unit(const Ellipsoid& body, const View& view) {
    glm::dmat3 m = view.rotation * body.rotation;
    for (int k = 0; k < 3; ++k) m[k] *= std::fabs(body.axes[k]);
    return m;
}

double norm(const glm::dmat3& m) {
    return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

/// The box of all of a body on the screen, down to its farthest point.
ScreenBox surface_box(const SeenBody& body) {
    return {body.low, body.high, 2 * body.center.z - body.nearest};
}

/// The unit sphere of `on` with the surface of `other` in it.
SphereCurve curve_on(const SeenBody& on, const glm::dmat3& from_unit_on, const SeenBody& other) {
    const glm::dmat3 unit = glm::transpose(other.unit);
    SphereCurve curve{unit * from_unit_on, unit * (on.center - other.center), 0};
    const double reach = glm::length(on.center) + glm::length(other.center) + norm(from_unit_on);
    curve.noise = 32 * 0x1p-52 * other.unit_size * reach;
    return curve;
}

/// Which bodies may be seen, and which pairs of them where they meet. What hides a surface is found twice,
/// body by body, and not kept: kept for all bodies it would grow with their square.
class SeenSurfaces {
  public:
    SeenSurfaces(std::span<const Ellipsoid> bodies, const std::vector<SeenBody>& seen, const View& view,
                 const Overlaps& overlaps, const ParallelFor& parallel_for)
        : m_bodies(seen),
          m_overlaps(overlaps),
          m_perspective(view.perspective()),
          m_parallel_for(parallel_for),
          m_seen(seen.size()) {
        for (const Ellipsoid& body : bodies) m_from_unit.push_back(from_unit(body, view));
        for_all(
            [&](std::size_t i) { m_seen[i] = !seen[i].solid || !surface(i).seen(others_of(i), 1).empty(); });
    }

    bool any(int body) const { return m_seen[static_cast<std::size_t>(body)] != 0; }

    /// Lists for each body those after it with which it meets in a curve of which something may be seen.
    std::vector<std::vector<int>> meetings() const {
        std::vector<std::vector<int>> showing(m_bodies.size()), both(m_bodies.size());
        for_all([&](std::size_t i) {
            if (m_seen[i] && m_bodies[i].solid) showing[i] = shown_on(i);
        });
        for (std::size_t i = 0; i < showing.size(); ++i)
            for (const int j : showing[i]) {
                const std::vector<int>& back = showing[static_cast<std::size_t>(j)];
                if (static_cast<std::size_t>(j) > i &&
                    std::binary_search(back.begin(), back.end(), static_cast<int>(i)))
                    both[i].push_back(j);
            }
        return both;
    }

  private:
    void for_all(const std::function<void(std::size_t)>& work) const {
        m_parallel_for(static_cast<std::int64_t>(m_bodies.size()),
                       [&](std::int64_t n) { work(static_cast<std::size_t>(n)); });
    }

    Surface surface(std::size_t i) const { return {m_bodies[i], m_from_unit[i], m_perspective}; }

    /// The bodies that may hide some of a body: those first that begin nearest to the observer.
    Surface::Others others_of(std::size_t i) const {
        Surface::Others others;
        for (const int j : m_overlaps.with(surface_box(m_bodies[i])))
            if (j != static_cast<int>(i)) others.push_back(&m_bodies[static_cast<std::size_t>(j)]);
        std::sort(others.begin(), others.end(),
                  [](const SeenBody* a, const SeenBody* b) { return a->nearest < b->nearest; });
        return others;
    }

    /// The bodies that on the surface of this one may be seen to meet it, in order.
    std::vector<int> shown_on(std::size_t body) const {
        const Surface own = surface(body);
        std::vector<char> shows(m_bodies.size());
        for (const Surface::Part& part : own.seen(others_of(body)))
            for (const SeenBody* other : part.others) {
                const auto j = static_cast<std::size_t>(other - m_bodies.data());
                if (!shows[j] && other->solid && m_seen[j]) shows[j] = own.may_show_meeting(*other, part);
            }
        std::vector<int> found;
        for (std::size_t j = 0; j < shows.size(); ++j)
            if (shows[j]) found.push_back(static_cast<int>(j));
        return found;
    }

    const std::vector<SeenBody>& m_bodies;
    const Overlaps& m_overlaps;
    bool m_perspective;
    const ParallelFor& m_parallel_for;
    std::vector<glm::dmat3> m_from_unit;
    std::vector<char> m_seen;  ///< written by many threads, so no bits
};

/// One curve in which two bodies meet, and what is seen of it.
class Pair {
  public:
    Pair(std::span<const Ellipsoid> bodies, const std::vector<SeenBody>& seen, const View& view, double tol,
         int i, int j)
        : m_seen(seen), m_view(view), m_tol(tol), m_first(i), m_second(j) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        const glm::dmat3 from_a = from_unit(bodies[a], view), from_b = from_unit(bodies[b], view);
        const SphereCurve on_a = curve_on(seen[a], from_a, seen[b]),
                          on_b = curve_on(seen[b], from_b, seen[a]);
        // On the larger body the other's surface is the flatter one.
        const bool first = norm(on_a.matrix) <= norm(on_b.matrix);
        m_curve = first ? on_a : on_b;
        m_from_unit = first ? from_a : from_b;
        m_center = first ? seen[a].center : seen[b].center;
        m_size = norm(m_from_unit);
    }

    /// The loops on the sphere, as loops_of gives them.
    std::vector<std::vector<glm::dvec3>> loops() const {
        return loops_of(m_curve, [this](const glm::dvec3& u, double radius) { return allowed(u, radius); });
    }

    CrossingCurve curve(const std::vector<glm::dvec3>& loop) const {
        CrossingCurve curve;
        curve.first = m_first;
        curve.second = m_second;
        for (const glm::dvec3& u : loop) curve.points.push_back(in_view(u));
        return curve;
    }

    /// Finds what is seen of a curve whose points are in view.
    void hide(CrossingCurve& curve, const std::vector<glm::dvec3>& loop, const std::vector<int>& near_by,
              bool by_bodies) {
        const std::size_t count = loop.size();
        std::vector<Arc> cut;
        if (m_view.perspective())
            for (std::size_t k = 0; k < count; ++k)
                for (const Arc& part :
                     nearer_part(curve.points[k].z, curve.points[(k + 1) % count].z, m_view.near))
                    cut.push_back({static_cast<double>(k) + part.begin, static_cast<double>(k) + part.end});
        m_hidden.clear();
        if (by_bodies) {
            m_loop = &loop;
            m_points = &curve.points;
            const ScreenBox box = box_of(curve.points, m_view.perspective());
            m_doubts = {{&seen(m_first), true}, {&seen(m_second), true}};
            for (const int body : near_by)
                if (body != m_first && body != m_second && may_hide(seen(body), box))
                    m_doubts.push_back({&seen(body), false});
            mark(0, count, 0, m_doubts.size());
        }
        const auto period = static_cast<double>(count);
        split(std::move(m_hidden), cut, period, true, curve.visible, curve.hidden);
    }

  private:
    /// A body that may hide something, or have it on its own far side.
    struct Doubt {
        const SeenBody* body = nullptr;
        bool own = false;
    };

    glm::dvec3 in_view(const glm::dvec3& u) const { return m_center + m_from_unit * u; }

    /// How far chords may be off within `radius` of u, on the sphere.
    double allowed(const glm::dvec3& u, double radius) const {
        double zoom = m_view.scale;
        if (m_view.perspective()) {
            const glm::dvec3 p = in_view(u);
            const double depth = std::max(p.z - m_size * radius, m_view.near);
            zoom *=
                m_view.eye_distance / depth * (1 + (glm::length(glm::dvec2(p)) + m_size * radius) / depth);
        }
        return m_tol / (zoom * m_size);
    }

    const SeenBody& seen(int body) const { return m_seen[static_cast<std::size_t>(body)]; }
    const glm::dvec3& unit_point(std::size_t k) const { return (*m_loop)[k % m_loop->size()]; }
    const glm::dvec3& point(std::size_t k) const { return (*m_points)[k % m_points->size()]; }

    bool is_hidden(const glm::dvec3& p, std::size_t from, std::size_t to) const {
        return std::any_of(m_doubts.begin() + static_cast<std::ptrdiff_t>(from),
                           m_doubts.begin() + static_cast<std::ptrdiff_t>(to), [&](const Doubt& d) {
                               return d.own ? is_on_far_side(*d.body, p)
                                            : hides(*d.body, p, m_view.perspective());
                           });
    }

    /// Appends those doubts of a range that a piece does not settle; true where one hides all of it.
    bool doubts_left(const SurfacePiece& piece, std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k) {
            const Doubt doubt = m_doubts[k];
            const Covered cover = doubt.own ? far_side_of(*doubt.body, piece)
                                            : cover_of(*doubt.body, piece, m_view.perspective());
            if (cover == Covered::all) {
                // What hides one part often hides the next.
                std::swap(m_doubts[from], m_doubts[k]);
                return true;
            }
            if (cover == Covered::partly) m_doubts.push_back(doubt);
        }
        return false;
    }

    /// Adds what is hidden between two points of the loop, as far as the doubts of a range say.
    void mark(std::size_t first, std::size_t last, std::size_t from, std::size_t to) {
        if (last - first == 1) return mark_chord(first, from, to);
        SurfacePiece piece;
        double deviation = 0;
        for (std::size_t k = first; k <= last; ++k)
            piece.center += point(k) / static_cast<double>(last - first + 1);
        for (std::size_t k = first; k <= last; ++k)
            piece.around = std::max(piece.around, glm::distance(piece.center, point(k)));
        for (std::size_t k = first; k < last; ++k) deviation = std::max(deviation, deviation_of(k));
        piece.around += deviation;
        const std::size_t next = m_doubts.size();
        if (doubts_left(piece, from, to)) {
            m_hidden.push_back({static_cast<double>(first), static_cast<double>(last)});
        } else if (const std::size_t end = m_doubts.size(); end > next) {
            const std::size_t middle = first + (last - first) / 2;
            mark(first, middle, next, end);
            mark(middle, last, next, end);
        }
        m_doubts.resize(next);
    }

    /// How far the curve is off the chord after a point, at most.
    double deviation_of(std::size_t k) const {
        const double length = glm::distance(unit_point(k), unit_point(k + 1));
        return m_size * std::min(allowed(unit_point(k), length), length);
    }

    void mark_chord(std::size_t k, std::size_t from, std::size_t to) {
        const double deviation = deviation_of(k);
        mark_part({k, deviation * kLeast}, {0, point(k)}, {1, point(k + 1)}, deviation, from, to);
    }

    struct Chord {
        std::size_t index = 0;
        double least = 0;  ///< shorter parts are seen or hidden as their ends are
    };
    struct End {
        double s = 0;
        glm::dvec3 point{0.0};
    };

    End on_curve(std::size_t chord, double s) const {
        return {s, in_view(point_between(m_curve, unit_point(chord), unit_point(chord + 1), s))};
    }

    void mark_part(const Chord& chord, const End& a, const End& b, double deviation, std::size_t from,
                   std::size_t to) {
        const SurfacePiece piece{0.5 * (a.point + b.point), 0.5 * (b.point - a.point), deviation};
        const std::size_t next = m_doubts.size();
        const bool all = doubts_left(piece, from, to);
        const std::size_t end = m_doubts.size();
        const double middle = 0.5 * (a.s + b.s);
        if (all) {
            add(chord, a.s, b.s);
        } else if (end > next && (glm::length(piece.half) <= chord.least || b.s - a.s <= kShortest)) {
            mark_short(chord, a, b, next, end);
        } else if (end > next) {
            const End m = on_curve(chord.index, middle);
            // A curve is four times closer to chords half as long; that their lengths differ takes some of
            // it.
            mark_part(chord, a, m, deviation * 0.35, next, end);
            mark_part(chord, m, b, deviation * 0.35, next, end);
        }
        m_doubts.resize(next);
    }

    void mark_short(const Chord& chord, const End& a, const End& b, std::size_t from, std::size_t to) {
        const bool first = is_hidden(a.point, from, to), second = is_hidden(b.point, from, to);
        if (first == second) {
            if (first) add(chord, a.s, b.s);
            return;
        }
        double low = a.s, high = b.s;
        for (int k = 0; k < kHalvings; ++k) {
            const double s = 0.5 * (low + high);
            (is_hidden(on_curve(chord.index, s).point, from, to) == first ? low : high) = s;
        }
        if (first)
            add(chord, a.s, low);
        else
            add(chord, high, b.s);
    }

    void add(const Chord& chord, double begin, double end) {
        const auto base = static_cast<double>(chord.index);
        if (!m_hidden.empty() && m_hidden.back().end == base + begin)
            m_hidden.back().end = base + end;
        else
            m_hidden.push_back({base + begin, base + end});
    }

    /// The share of what chords may be off.
    static constexpr double kLeast = 1.0 / 16;
    static constexpr int kHalvings = 30;
    /// The shortest part of a chord, where its curve is not found beside it.
    static constexpr double kShortest = 0x1p-14;

    const std::vector<SeenBody>& m_seen;
    const View& m_view;
    double m_tol;
    int m_first, m_second;
    SphereCurve m_curve;
    glm::dmat3 m_from_unit{1.0};
    glm::dvec3 m_center{0.0};
    double m_size = 0;

    // While a curve is hidden
    const std::vector<glm::dvec3>* m_loop = nullptr;
    const std::vector<glm::dvec3>* m_points = nullptr;
    std::vector<Doubt> m_doubts;
    std::vector<Arc> m_hidden;
};

}  // namespace

std::vector<CrossingCurve> crossing_curves(std::span<const Ellipsoid> bodies,
                                           const std::vector<SeenBody>& seen, const View& view,
                                           const OutlineOptions& options, const ParallelFor& parallel_for) {
    const Overlaps overlaps(seen);
    std::optional<SeenSurfaces> surfaces;
    if (options.hide) surfaces.emplace(bodies, seen, view, overlaps, parallel_for);
    const bool cull = surfaces && !options.keep_hidden;
    const std::vector<std::vector<int>> meetings =
        cull ? surfaces->meetings() : std::vector<std::vector<int>>(bodies.size());
    const glm::dmat3 to_scene = glm::transpose(view.rotation);
    const glm::dvec3 eye(0, 0, view.perspective() ? view.eye_distance : 0);

    std::vector<std::vector<CrossingCurve>> found(bodies.size());
    parallel_for(static_cast<std::int64_t>(bodies.size()), [&](std::int64_t n) {
        const auto i = static_cast<std::size_t>(n);
        const auto first = static_cast<int>(i);
        if (!seen[i].solid || (cull && meetings[i].empty())) return;
        std::vector<int> hiding = overlaps.with(surface_box(seen[i])), others = cull ? meetings[i] : hiding;
        // What is hidden is hidden by something that is seen, or may be.
        if (surfaces) std::erase_if(hiding, [&](int j) { return !surfaces->any(j); });
        std::sort(others.begin(), others.end());
        for (const int j : others) {
            if (j <= first || !seen[static_cast<std::size_t>(j)].solid) continue;
            Pair pair(bodies, seen, view, options.tol, first, j);
            for (const std::vector<glm::dvec3>& loop : pair.loops()) {
                CrossingCurve curve = pair.curve(loop);
                pair.hide(curve, loop, hiding, options.hide);
                if (!options.keep_hidden && curve.visible.empty()) continue;
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

}  // namespace anamorph::figure
