// SPDX-License-Identifier: Apache-2.0
#include "anamorph/projector/projected_triangles.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "anamorph/parameter.h"

namespace anamorph {
namespace {

/// A corner before its triangle is painted.
struct SceneCorner {
    glm::dvec3 weights{0.0}, point{0.0};
    bool hidden = false;
};

bool wants_split(const EdgeFinding& side) {
    return side.verdict == EdgeVerdict::split || side.verdict == EdgeVerdict::cut;
}

/// What the rule says of a side, and whether it is split, be it for a shadow.
struct SceneSide {
    EdgeFinding finding;
    bool split = false;
};

/// A triangle to be cut, with its sides from each corner to the next.
struct SceneTriangle {
    std::array<SceneCorner, 3> corners;
    std::array<SceneSide, 3> sides;
    /// What holds for all of it: of its longest side, or that of a triangle that it is part of. It is then split for its
    /// neighbours and for shadows alone.
    std::optional<EdgeFinding> known = {};
};

/// The place of a triangle's longest side.
std::size_t longest_of(const std::array<SceneCorner, 3>& c) {
    std::size_t longest = 0;
    const auto length = [&](std::size_t i) { return glm::length(c[(i + 1) % 3].point - c[i].point); };
    for (std::size_t i = 1; i < 3; ++i)
        if (length(i) > length(longest)) longest = i;
    return longest;
}

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
            paint(whole);
            return m_counts;
        }
        for (SceneCorner& corner : whole.corners) corner.hidden = is_hidden(corner.point);
        const auto& c = whole.corners;
        push(c, {side(c[0], c[1]), side(c[1], c[2]), side(c[2], c[0])}, {});
        while (!m_open.empty()) {
            const SceneTriangle next = m_open.back();
            m_open.pop_back();
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

    bool is_hidden(const glm::dvec3& point) const { return m_options.hidden && m_options.hidden(point); }

    /// What the rule says of a side. One that is hidden at one end only is split down to a texel.
    SceneSide side(const SceneCorner& a, const SceneCorner& b) const {
        const EdgeFinding found = EdgeRule::in_order(a.point, b.point) ? m_rule.judge(a.point, b.point)
                                                                       : m_rule.judge(b.point, a.point);
        return {found, wants_split(found) || (found.verdict == EdgeVerdict::bounded && shadow_ends(a, b))};
    }

    /// Does a shadow end on a side, somewhere in more than a texel?
    bool shadow_ends(const SceneCorner& a, const SceneCorner& b) const {
        return a.hidden != b.hidden && texels_along(a.point, b.point) > 1 &&
               glm::length(b.point - a.point) > m_options.smallest;
    }

    /// A side within a triangle. Where all is known of that, only a shadow splits it, and not in a sliver: halves of its
    /// sides could take turns without end.
    SceneSide inner_side(const SceneTriangle& in, const SceneCorner& a, const SceneCorner& b) const {
        if (!in.known) return side(a, b);
        const auto& c = in.corners;
        const std::size_t i = longest_of(c);
        const glm::dvec3 along = c[(i + 1) % 3].point - c[i].point, foot = c[(i + 2) % 3].point - c[i].point;
        const double height = glm::length(glm::cross(along, foot)) / glm::length(along);
        const bool sliver = !(height * m_projector.panorama().pixels_per_radian() >
                              0.5 * glm::length(m_projector.ray(a.point)));
        return {*in.known, in.known->verdict == EdgeVerdict::bounded && !sliver && shadow_ends(a, b)};
    }

    /// About how many texels of the panorama's middle an edge takes.
    double texels_along(const glm::dvec3& a, const glm::dvec3& b) const {
        const double distance = glm::length(m_projector.ray(a)) + glm::length(m_projector.ray(b));
        return 2 * glm::length(b - a) / distance * m_projector.panorama().pixels_per_radian();
    }

    void push(const std::array<SceneCorner, 3>& c, const std::array<SceneSide, 3>& sides,
              const std::optional<EdgeFinding>& known) {
        SceneTriangle next{c, sides, known};
        const EdgeFinding& longest = sides[longest_of(c)].finding;
        bool cut = false;
        for (const SceneSide& s : sides) cut = cut || s.finding.verdict == EdgeVerdict::cut;
        if (!known && !cut && !wants_split(longest) && longest.verdict != EdgeVerdict::hopeless)
            next.known = longest;
        m_open.push_back(next);
    }

    double rounded(double x) const { return m_options.single ? double{static_cast<float>(x)} : x; }

    /// The corner that splits a side: the same from both ends.
    SceneCorner between(const SceneCorner& a, const SceneCorner& b, const EdgeFinding& found) const {
        const bool ordered = EdgeRule::in_order(a.point, b.point);
        const SceneCorner &first = ordered ? a : b, &last = ordered ? b : a;
        const double t = found.verdict == EdgeVerdict::cut ? found.at : 0.5;
        SceneCorner corner;
        for (int i = 0; i < 3; ++i) {
            corner.point[i] = rounded(first.point[i] * (1 - t) + last.point[i] * t);
            corner.weights[i] = first.weights[i] * (1 - t) + last.weights[i] * t;
        }
        corner.hidden = is_hidden(corner.point);
        return corner;
    }

    void split_or_paint(const SceneTriangle& triangle) {
        const auto& c = triangle.corners;
        std::array<std::optional<SceneCorner>, 3> middle;
        int splits = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const SceneCorner &a = c[i], &b = c[(i + 1) % 3];
            if (!triangle.sides[i].split) continue;
            const SceneCorner new_corner = between(a, b, triangle.sides[i].finding);
            // Rounded, it may be one of the ends.
            if (new_corner.point == a.point || new_corner.point == b.point) continue;
            middle[i] = new_corner;
            ++splits;
        }
        if (splits == 0)
            paint(triangle);
        else
            split(triangle, middle, splits);
    }

    /// Into 2, 3 or 4, turned as before.
    void split(const SceneTriangle& from, const std::array<std::optional<SceneCorner>, 3>& middle,
               int splits) {
        count(splits);
        const auto& c = from.corners;
        const auto inner = [&](const SceneCorner& a, const SceneCorner& b) { return inner_side(from, a, b); };
        if (splits == 3) {
            const SceneCorner &p = *middle[0], &q = *middle[1], &r = *middle[2];
            const SceneSide pq = inner(p, q), qr = inner(q, r), rp = inner(r, p);
            push({c[0], p, r}, {side(c[0], p), rp, side(r, c[0])}, from.known);
            push({p, c[1], q}, {side(p, c[1]), side(c[1], q), pq}, from.known);
            push({r, q, c[2]}, {qr, side(q, c[2]), side(c[2], r)}, from.known);
            push({p, q, r}, {pq, qr, rp}, from.known);
            return;
        }
        // Turned so that the side from corner 0 to corner 1 is split, and of two, that from 2 to 0.
        std::size_t first = 0;
        while (!(middle[first] && (splits == 1 || middle[(first + 2) % 3]))) ++first;
        const SceneCorner &a = c[first], &b = c[(first + 1) % 3], &d = c[(first + 2) % 3],
                          &p = *middle[first];
        const SceneSide &bd = from.sides[(first + 1) % 3], &da = from.sides[(first + 2) % 3];
        const SceneSide ap = side(a, p), pb = side(p, b);
        if (splits == 1) {
            const SceneSide pd = inner(p, d);
            push({a, p, d}, {ap, pd, da}, from.known);
            push({p, b, d}, {pb, bd, pd}, from.known);
            return;
        }
        const SceneCorner& r = *middle[(first + 2) % 3];
        const SceneSide ra = side(r, a), dr = side(d, r), pr = inner(p, r);
        push({a, p, r}, {ap, pr, ra}, from.known);
        if (glm::length(r.point - b.point) <= glm::length(p.point - d.point)) {
            const SceneSide br = inner(b, r);
            push({p, b, r}, {pb, br, pr}, from.known);
            push({b, d, r}, {bd, dr, br}, from.known);
        } else {
            const SceneSide pd = inner(p, d);
            push({p, b, d}, {pb, bd, pd}, from.known);
            push({p, d, r}, {pd, dr, pr}, from.known);
        }
    }

    void count(int more) {
        if (m_count.fetch_add(more) + more > m_options.most_triangles)
            throw Error("tol", shortest(m_options.tol),
                        "takes more than " + std::to_string(m_options.most_triangles) + " triangles");
    }

    /// A triangle of which nothing is known has sides that are as short as they may be.
    void paint(const SceneTriangle& triangle) {
        const auto& c = triangle.corners;
        PaintedTriangle piece;
        for (std::size_t i = 0; i < 3; ++i) piece.corners[i] = {c[i].weights, c[i].point};
        bool settled = triangle.known.has_value();
        for (const SceneSide& s : triangle.sides)
            settled = settled && s.finding.verdict != EdgeVerdict::hopeless;
        if (!settled) return put(piece, Painting::no_direction);
        const bool tiny = triangle.known->verdict == EdgeVerdict::tiny;
        if (triangle.known->verdict == EdgeVerdict::outside) return put(piece, Painting::outside);
        if (!set_texels(piece, tiny)) return put(piece, Painting::no_direction);
        for (const SceneCorner& corner : c)
            if (corner.hidden) return put(piece, Painting::hidden);
        m_counts.max_error = std::max(m_counts.max_error, tiny ? m_options.tol : triangle.known->bound);
        clip(piece);
    }

    /// The corners' texels, on the piece of the panorama and on the side of the seam where the triangle's middle is. False
    /// where they have none, or are far from each other about an axis that has no poles.
    bool set_texels(PaintedTriangle& piece, bool tiny) const {
        const Chart& chart = m_projector.panorama();
        std::array<glm::dvec3, 3> rays;
        for (std::size_t i = 0; i < 3; ++i) rays[i] = scaled_ray(m_projector.ray(piece.corners[i].point));
        const glm::dvec3 middle =
            scaled_ray(m_projector.ray(piece.corners[0].point) + m_projector.ray(piece.corners[1].point) +
                       m_projector.ray(piece.corners[2].point));
        const int on = chart.piece_of(Ray<double>{middle.x, middle.y, middle.z});
        const bool azimuth = chart.counted() == Counted::azimuth;
        for (std::size_t i = 0; i < 3; ++i) {
            glm::dvec3 r = rays[i];
            const double least = m_rule.on_plane() * glm::length(r);
            if (azimuth && std::hypot(r.x, r.z) <= least)
                r = {middle.x * 0x1p-60, r.y, middle.z * 0x1p-60};
            else if (azimuth && std::fabs(r.x) <= least && r.z < 0)
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
            most = std::max(most, std::hypot(d.x, d.y));
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

    /// Cuts a piece at the borders of the panorama.
    void clip(const PaintedTriangle& piece) {
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
        for (int i = 0; i < 3; ++i) {
            c.weights[i] = a.weights[i] * (1 - t) + b.weights[i] * t;
            c.point[i] = rounded(a.point[i] * (1 - t) + b.point[i] * t);
        }
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
