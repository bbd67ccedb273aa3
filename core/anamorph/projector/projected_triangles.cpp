// SPDX-License-Identifier: Apache-2.0
#include "anamorph/projector/projected_triangles.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "anamorph/number/hypot.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

/// A corner before its triangle is painted.
struct SceneCorner {
    glm::dvec3 weights{0.0}, point{0.0};
};

bool wants_split(const EdgeFinding& side) {
    return side.verdict == EdgeVerdict::split || side.verdict == EdgeVerdict::cut;
}

/// A triangle to be cut, with what the rule says of its sides from each corner to the next.
struct SceneTriangle {
    std::array<SceneCorner, 3> corners;
    std::array<EdgeFinding, 3> sides;
    int depth = 0;         ///< of how many splits it comes
    bool shadows = false;  ///< may something hide a part of it?
};

/// The cutting of one triangle.
class Cutting {
  public:
    Cutting(const Projector& projector, const ProjectionOptions& options, const EdgeRule& rule,
            std::atomic<std::int64_t>& count, std::vector<PaintedTriangle>& to)
        : m_projector(projector), m_options(options), m_rule(rule), m_count(count), m_to(to) {}

    PaintedCounts cut(const std::array<glm::dvec3, 3>& triangle) {
        SceneTriangle whole;
        for (int i = 0; i < 3; ++i) {
            SceneCorner& corner = whole.corners[static_cast<std::size_t>(i)];
            corner.weights[i] = 1;
            corner.point = triangle[static_cast<std::size_t>(i)];
        }
        if (!is_finite(triangle)) {
            put(piece_of(whole.corners), Painting::no_direction);
            return m_counts;
        }
        const auto& c = whole.corners;
        const bool shadows = m_options.occluders && m_options.occluders->may_hide(triangle);
        push(c, {side(c[0], c[1], shadows), side(c[1], c[2], shadows), side(c[2], c[0], shadows)}, shadows);
        while (!m_open.empty()) {
            const SceneTriangle next = m_open.back();
            m_open.pop_back();
            m_depth = next.depth;
            split_or_paint(next);
        }
        return m_counts;
    }

  private:
    static bool is_finite(const std::array<glm::dvec3, 3>& triangle) {
        for (const glm::dvec3& p : triangle)
            if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) return false;
        return true;
    }

    /// What the rule says of a side. One that is short enough is cut where a shadow begins or ends, if there may be some in all
    /// triangles that it is a side of.
    EdgeFinding side(const SceneCorner& a, const SceneCorner& b, bool shadows) const {
        const bool ordered = EdgeRule::in_order(a.point, b.point);
        const glm::dvec3 &first = ordered ? a.point : b.point, &last = ordered ? b.point : a.point;
        const EdgeFinding found = m_rule.judge(first, last);
        const double length = glm::length(b.point - a.point);
        if (!shadows || found.verdict != EdgeVerdict::bounded || !(length > 2 * m_options.smallest))
            return found;
        const ShadowScale scale = shadow_scale();
        const double hair =
            std::max({scale.thin / texels_along(first, last), 2 * m_options.smallest / length, 0x1p-30});
        const double at = m_options.occluders->border(first, last, hair, scale);
        return at > 0 ? EdgeFinding{EdgeVerdict::cut, found.bound, at, true} : found;
    }

    ShadowScale shadow_scale() const {
        return {m_projector.panorama().pixels_per_radian(), least_shadow() / 32, m_rule.on_plane()};
    }
    /// Triangles that are no larger, in texels, are not split for shadows.
    double least_shadow() const { return std::min(m_options.tol, 1.0); }

    /// About how many texels of the panorama's middle an edge takes.
    double texels_along(const glm::dvec3& a, const glm::dvec3& b) const {
        const double distance = glm::length(m_projector.ray(a)) + glm::length(m_projector.ray(b));
        return 2 * glm::length(b - a) / distance * m_projector.panorama().pixels_per_radian();
    }

    void push(const std::array<SceneCorner, 3>& c, const std::array<EdgeFinding, 3>& sides, bool shadows) {
        m_open.push_back({c, sides, m_depth + 1, shadows});
    }

    /// May something hide a part of a triangle, which is part of another one? Of two triangles that share a side one is not to say no
    /// where parts of that side, which are rounded, have borders of shadows in them: what counts as on a plane is far more than
    /// their rounding.
    bool has_shadows(const SceneTriangle& whole, const SceneCorner& a, const SceneCorner& b,
                     const SceneCorner& c) const {
        return whole.shadows &&
               m_options.occluders->may_hide({a.point, b.point, c.point}, 8 * m_rule.on_plane());
    }

    glm::dvec3 rounded(const glm::dvec3& p) const { return m_options.single ? glm::dvec3(glm::vec3(p)) : p; }

    /// The corner that splits a side: the same from both ends.
    SceneCorner between(const SceneCorner& a, const SceneCorner& b, const EdgeFinding& found) const {
        const bool ordered = EdgeRule::in_order(a.point, b.point);
        const SceneCorner &first = ordered ? a : b, &last = ordered ? b : a;
        const double t = found.verdict == EdgeVerdict::cut ? found.at : 0.5;
        return {first.weights * (1 - t) + last.weights * t, rounded(first.point * (1 - t) + last.point * t)};
    }

    void split_or_paint(const SceneTriangle& triangle) {
        const auto& c = triangle.corners;
        std::array<std::optional<SceneCorner>, 3> middle;
        int splits = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const SceneCorner &a = c[i], &b = c[(i + 1) % 3];
            if (!wants_split(triangle.sides[i]) || triangle.depth > kDeepest) continue;
            const SceneCorner new_corner = between(a, b, triangle.sides[i]);
            // Rounded, it may be one of the ends.
            if (new_corner.point == a.point || new_corner.point == b.point) continue;
            middle[i] = new_corner;
            ++splits;
        }
        if (splits == 0)
            settle(triangle);
        else if (!split_at_corner(triangle))
            split(triangle, middle, splits);
    }

    /// Where shadows alone split a triangle, at a corner of one within: cut at its sides first, a needle of shadow would
    /// take many small steps.
    bool split_at_corner(const SceneTriangle& triangle) {
        bool shadow = false;
        for (const EdgeFinding& s : triangle.sides) {
            if (wants_split(s) && !s.shadow) return false;
            shadow = shadow || s.shadow;
        }
        if (!shadow) return false;
        const ShadowCover cover = m_options.occluders->cover(points_of(triangle.corners), shadow_scale());
        return cover.share == ShadowCover::both && cover.has_corner && split_within(triangle, cover.corner);
    }

    /// Into 2, 3 or 4, turned as before.
    void split(const SceneTriangle& from, const std::array<std::optional<SceneCorner>, 3>& middle,
               int splits) {
        count(splits);
        const auto& c = from.corners;
        const auto shadows = [&](const SceneCorner& a, const SceneCorner& b, const SceneCorner& d) {
            return has_shadows(from, a, b, d);
        };
        if (splits == 3) {
            const SceneCorner &p = *middle[0], &q = *middle[1], &r = *middle[2];
            const bool at0 = shadows(c[0], p, r), at1 = shadows(p, c[1], q), at2 = shadows(r, q, c[2]),
                       within = shadows(p, q, r);
            const EdgeFinding pq = side(p, q, at1 && within), qr = side(q, r, at2 && within),
                              rp = side(r, p, at0 && within);
            push({c[0], p, r}, {side(c[0], p, at0), rp, side(r, c[0], at0)}, at0);
            push({p, c[1], q}, {side(p, c[1], at1), side(c[1], q, at1), pq}, at1);
            push({r, q, c[2]}, {qr, side(q, c[2], at2), side(c[2], r, at2)}, at2);
            push({p, q, r}, {pq, qr, rp}, within);
            return;
        }
        // Turned so that the side from corner 0 to corner 1 is split, and of two, that from 2 to 0.
        std::size_t first = 0;
        while (!(middle[first] && (splits == 1 || middle[(first + 2) % 3]))) ++first;
        const SceneCorner &a = c[first], &b = c[(first + 1) % 3], &d = c[(first + 2) % 3],
                          &p = *middle[first];
        const EdgeFinding &bd = from.sides[(first + 1) % 3], &da = from.sides[(first + 2) % 3];
        if (splits == 1) {
            const bool at_a = shadows(a, p, d), at_b = shadows(p, b, d);
            const EdgeFinding pd = side(p, d, at_a && at_b);
            push({a, p, d}, {side(a, p, at_a), pd, da}, at_a);
            push({p, b, d}, {side(p, b, at_b), bd, pd}, at_b);
            return;
        }
        const SceneCorner& r = *middle[(first + 2) % 3];
        const bool to_b = glm::length(r.point - b.point) <= glm::length(p.point - d.point);
        const bool at_a = shadows(a, p, r), at_b = to_b ? shadows(p, b, r) : shadows(p, b, d),
                   at_d = to_b ? shadows(b, d, r) : shadows(p, d, r);
        const EdgeFinding pr = side(p, r, at_a && (to_b ? at_b : at_d)), pb = side(p, b, at_b),
                          dr = side(d, r, at_d);
        push({a, p, r}, {side(a, p, at_a), pr, side(r, a, at_a)}, at_a);
        if (to_b) {
            const EdgeFinding br = side(b, r, at_b && at_d);
            push({p, b, r}, {pb, br, pr}, at_b);
            push({b, d, r}, {bd, dr, br}, at_d);
        } else {
            const EdgeFinding pd = side(p, d, at_b && at_d);
            push({p, b, d}, {pb, bd, pd}, at_b);
            push({p, d, r}, {pd, dr, pr}, at_d);
        }
    }

    /// Into 3 about a point within; false where rounding leaves no room for it.
    bool split_within(const SceneTriangle& from, const glm::dvec3& weights) {
        const auto& c = from.corners;
        if (from.depth > kDeepest) return false;
        SceneCorner m;
        for (std::size_t k = 0; k < 3; ++k) {
            m.weights += c[k].weights * weights[static_cast<int>(k)];
            m.point += c[k].point * weights[static_cast<int>(k)];
        }
        m.point = rounded(m.point);
        const glm::dvec3 normal = glm::cross(c[1].point - c[0].point, c[2].point - c[0].point);
        for (std::size_t k = 0; k < 3; ++k)
            if (!(glm::dot(glm::cross(c[(k + 1) % 3].point - c[k].point, m.point - c[k].point), normal) > 0))
                return false;
        count(2);
        std::array<bool, 3> shadows;
        for (std::size_t k = 0; k < 3; ++k) shadows[k] = has_shadows(from, c[k], c[(k + 1) % 3], m);
        std::array<EdgeFinding, 3> to;
        for (std::size_t k = 0; k < 3; ++k) to[k] = side(c[k], m, shadows[k] && shadows[(k + 2) % 3]);
        for (std::size_t k = 0; k < 3; ++k)
            push({c[k], c[(k + 1) % 3], m}, {from.sides[k], to[(k + 1) % 3], to[k]}, shadows[k]);
        return true;
    }

    void count(int more) {
        if (m_count.fetch_add(more) + more > m_options.most_triangles)
            throw Error("tol", shortest(m_options.tol),
                        "takes more than " + std::to_string(m_options.most_triangles) + " triangles");
    }

    static PaintedTriangle piece_of(const std::array<SceneCorner, 3>& c) {
        PaintedTriangle piece;
        for (std::size_t i = 0; i < 3; ++i) piece.corners[i] = {c[i].weights, c[i].point};
        return piece;
    }

    double longest_side(const std::array<SceneCorner, 3>& c) const {
        double longest = 0;
        for (std::size_t i = 0; i < 3; ++i)
            longest = std::max(longest, glm::length(c[(i + 1) % 3].point - c[i].point));
        return longest;
    }

    static double twice_area(const std::array<SceneCorner, 3>& c) {
        return glm::length(glm::cross(c[1].point - c[0].point, c[2].point - c[0].point));
    }

    /// A triangle with sides that are short enough, or as short as they may be.
    void settle(const SceneTriangle& triangle) {
        const auto& c = triangle.corners;
        PaintedTriangle piece = piece_of(c);
        for (std::size_t i = 0; i < 3; ++i) {
            if (triangle.sides[i].verdict != EdgeVerdict::hopeless) continue;
            // What is lost about such a side is as small as it is.
            glm::dvec3 near(0.45);
            near[static_cast<int>((i + 2) % 3)] = 0.1;
            const double least = m_options.smallest * m_options.smallest;
            if (twice_area(c) > least && split_within(triangle, near)) return;
            return put(piece, Painting::no_direction);
        }
        const EdgeFinding found = m_rule.judge(points_of(c));
        if (found.verdict == EdgeVerdict::split) {
            const glm::dvec3 at = m_rule.axis_in(points_of(c)).value_or(glm::dvec3(1. / 3));
            if (longest_side(c) > m_options.smallest && split_within(triangle, at)) return;
            return put(piece, Painting::no_direction);
        }
        const bool tiny = found.verdict == EdgeVerdict::tiny;
        if (found.verdict == EdgeVerdict::outside) return put(piece, Painting::outside);
        if (!set_texels(piece, tiny)) return put(piece, Painting::no_direction);
        const ShadowCover cover =
            triangle.shadows ? m_options.occluders->cover(points_of(c), shadow_scale()) : ShadowCover{};
        bool lit = cover.share == ShadowCover::lit;
        if (cover.share == ShadowCover::both) {
            double seen = 0;
            for (std::size_t i = 0; i < 3; ++i)
                seen = std::max(seen, texels_along(c[i].point, c[(i + 1) % 3].point));
            if (!tiny && seen > least_shadow() && longest_side(c) > m_options.smallest) {
                if (split_within(triangle, cover.corner)) return;
                // A needle that has been cut as often as may be is what most of it is.
                lit = cover.mostly_lit;
            }
        }
        // What is partly hidden and too small to split counts as hidden.
        if (!lit) return put(piece, Painting::hidden);
        m_counts.max_error = std::max(m_counts.max_error, tiny ? m_options.tol : found.bound);
        clip(piece);
    }

    static std::array<glm::dvec3, 3> points_of(const std::array<SceneCorner, 3>& c) {
        return {c[0].point, c[1].point, c[2].point};
    }

    /// The corners' texels, on the piece of the panorama and on the side of the seam where the triangle's middle is. False
    /// where they have none, or are far from each other about an axis that has no poles.
    bool set_texels(PaintedTriangle& piece, bool tiny) const {
        const Chart& chart = m_projector.panorama();
        std::array<glm::dvec3, 3> rays;
        for (std::size_t i = 0; i < 3; ++i) rays[i] = scaled_ray(m_projector.ray(piece.corners[i].point));
        const glm::dvec3 middle = EdgeRule::middle_of({m_projector.ray(piece.corners[0].point),
                                                       m_projector.ray(piece.corners[1].point),
                                                       m_projector.ray(piece.corners[2].point)});
        const int on = chart.piece_of(Ray<double>{middle.x, middle.y, middle.z});
        const bool azimuth = chart.counted() == Counted::azimuth;
        for (std::size_t i = 0; i < 3; ++i) {
            glm::dvec3 r = rays[i];
            const double least = m_rule.on_plane() * glm::length(r);
            const bool near = azimuth && std::fabs(r.x) <= least;
            if (near && std::fabs(r.z) <= least && hypot(r.x, r.z) <= least)
                r = {middle.x * 0x1p-60, r.y, middle.z * 0x1p-60};
            else if (near && r.z < 0)
                r.x = std::copysign(r.z * 0x1p-100, middle.x);
            piece.corners[i].texel = chart.point(Ray<double>{r.x, r.y, r.z}, on);
            const Point<double>& texel = piece.corners[i].texel;
            if (!(std::isfinite(texel.x) && std::isfinite(texel.y))) return false;
        }
        return !tiny || azimuth || spread(piece) <= 0.5 * m_options.tol;
    }

    static double spread(const PaintedTriangle& piece) {
        double most = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Point<double> d = piece.corners[i].texel - piece.corners[(i + 1) % 3].texel;
            most = std::max(most, hypot(d.x, d.y));
        }
        return most;
    }

    using Polygon = std::vector<PaintedCorner>;

    /// Texels as near to a border as this are on it: as far as corners may be from the plane that they are taken to be in.
    double on_border() const {
        const Chart& chart = m_projector.panorama();
        return 8 * m_rule.on_plane() * std::max(chart.scale_x(), chart.scale_y());
    }

    /// How far a texel is within a border of the panorama: left, right, top, bottom.
    double within(int border, const Point<double>& p) const {
        const Chart& chart = m_projector.panorama();
        const double distances[] = {p.x, chart.width() - p.x, p.y, chart.height() - p.y};
        return distances[border];
    }

    /// Is nothing of a piece beyond a border of the panorama?
    bool is_within(const PaintedTriangle& piece) const {
        const double near = on_border();
        for (int border = 0; border < 4; ++border)
            for (const PaintedCorner& corner : piece.corners)
                if (within(border, corner.texel) < -near) return false;
        return true;
    }

    /// Cuts a piece at the borders of the panorama.
    void clip(const PaintedTriangle& piece) {
        if (is_within(piece)) return put(piece, Painting::painted);
        Polygon inside(piece.corners.begin(), piece.corners.end());
        std::array<Polygon, 4> beyond;
        for (int border = 0; border < 4; ++border)
            inside = cut_at(border, inside, beyond[static_cast<std::size_t>(border)]);
        for (int border = 0; border < 4; ++border) {
            Polygon& outside = beyond[static_cast<std::size_t>(border)];
            if (outside.size() > 2) put_fan(with_corners(border, outside, inside), Painting::outside);
        }
        put_fan(inside, Painting::painted);
    }

    /// The part of a convex polygon that is within a border, and what is beyond.
    Polygon cut_at(int border, const Polygon& polygon, Polygon& beyond) const {
        Polygon kept;
        const double near = on_border();
        const auto any = [&](const auto& is) {
            return std::any_of(polygon.begin(), polygon.end(),
                               [&](const PaintedCorner& c) { return is(within(border, c.texel)); });
        };
        // What lies in the border is within it.
        if (!any([&](double at) { return at < -near; })) return polygon;
        if (!any([&](double at) { return at > near; })) {
            beyond = polygon;
            return {};
        }
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const PaintedCorner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
            const double at_a = within(border, a.texel), at_b = within(border, b.texel);
            if (at_a >= -near) kept.push_back(a);
            if (at_a <= near) beyond.push_back(a);
            if (std::max(at_a, at_b) <= near || std::min(at_a, at_b) >= -near) continue;
            kept.push_back(EdgeRule::in_order(a.point, b.point) ? on_border(a, b, at_a / (at_a - at_b))
                                                                : on_border(b, a, at_b / (at_b - at_a)));
            beyond.push_back(kept.back());
        }
        return kept;
    }

    /// A polygon beyond a border, with the corners on its side there that a corner of the panorama makes in what is inside.
    Polygon with_corners(int border, const Polygon& outside, const Polygon& inside) const {
        const auto is_on = [&](const PaintedCorner& c) {
            return std::fabs(within(border, c.texel)) <= on_border();
        };
        Polygon all;
        for (std::size_t i = 0; i < outside.size(); ++i) {
            const PaintedCorner &a = outside[i], &b = outside[(i + 1) % outside.size()];
            all.push_back(a);
            if (!is_on(a) || !is_on(b)) continue;
            Polygon between;
            for (const PaintedCorner& c : inside)
                if (is_on(c) && c.point != a.point && c.point != b.point) between.push_back(c);
            std::sort(between.begin(), between.end(), [&](const PaintedCorner& p, const PaintedCorner& q) {
                return glm::length(p.point - a.point) < glm::length(q.point - a.point);
            });
            all.insert(all.end(), between.begin(), between.end());
        }
        return all;
    }

    /// The corner at a border; the ends come in order, so that it is the same for both triangles.
    PaintedCorner on_border(const PaintedCorner& a, const PaintedCorner& b, double t) const {
        PaintedCorner c;
        c.weights = a.weights * (1 - t) + b.weights * t;
        c.point = rounded(a.point * (1 - t) + b.point * t);
        c.texel = a.texel * (1 - t) + b.texel * t;
        return c;
    }

    void put_fan(const Polygon& polygon, Painting painting) {
        for (std::size_t i = 2; i < polygon.size(); ++i)
            put({{polygon[0], polygon[i - 1], polygon[i]}}, painting);
    }

    void put(PaintedTriangle piece, Painting painting) {
        piece.painting = painting;
        std::int64_t* const counts[] = {&m_counts.painted, &m_counts.outside, &m_counts.hidden,
                                        &m_counts.no_direction};
        ++*counts[static_cast<std::size_t>(painting)];
        m_to.push_back(piece);
    }

    const Projector& m_projector;
    const ProjectionOptions& m_options;
    const EdgeRule& m_rule;
    std::atomic<std::int64_t>& m_count;
    std::vector<PaintedTriangle>& m_to;
    std::vector<SceneTriangle> m_open;
    /// Halving as often as this takes any side to the rounding of its ends.
    static constexpr int kDeepest = 100;
    int m_depth = -1;
    PaintedCounts m_counts;
};

}  // namespace

PaintedCounts& PaintedCounts::operator+=(const PaintedCounts& other) {
    painted += other.painted;
    outside += other.outside;
    hidden += other.hidden;
    no_direction += other.no_direction;
    max_error = std::max(max_error, other.max_error);
    return *this;
}

ScenePainter::ScenePainter(const Projector& projector, const ProjectionOptions& options)
    : m_projector(projector),
      m_options(options),
      m_rule(m_projector, options.tol, options.smallest, options.single) {
    kProjectionTolRow.check(options.tol, "tol");
    if (!(options.smallest >= 0 && options.smallest < HUGE_VAL))
        throw Error("smallest", shortest(options.smallest), "must be a number of at least 0");
}

PaintedCounts ScenePainter::paint(const std::array<glm::dvec3, 3>& triangle,
                                  std::vector<PaintedTriangle>& to) const {
    return Cutting(m_projector, m_options, m_rule, m_count, to).cut(triangle);
}

}  // namespace anamorph
