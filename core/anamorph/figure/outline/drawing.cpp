// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/drawing.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <numbers>
#include <utility>

#include "anamorph/figure/body/skeleton.h"
#include "anamorph/figure/outline/level_of_detail.h"
#include "anamorph/figure/outline/outline.h"
#include "anamorph/figure/outline/simple_outlines.h"

namespace anamorph::figure {
namespace {

/// The rest is left for the rounding of numbers in a file (kTolRow).
constexpr double kShareOfTol = 0.99;
/// Longer arcs are closed.
constexpr double kWholeTurn = 2 * std::numbers::pi - 1e-9;

/// Strokes no longer are points in a file.
constexpr double kLeastExtent = 1e-4;

bool has_extent(const std::vector<glm::dvec2>& points) {
    return std::any_of(points.begin(), points.end(), [&](const glm::dvec2& p) {
        return std::max(std::fabs(p.x - points[0].x), std::fabs(p.y - points[0].y)) > kLeastExtent;
    });
}

/// Cuts the segment from a to b to the box; false where nothing is left (Liang and Barsky).
bool clip(glm::dvec2& a, glm::dvec2& b, const ScreenWindow& box) {
    double from = 0, to = 1;
    const glm::dvec2 d = b - a;
    for (int k = 0; k < 2; ++k)
        for (const double side : {1.0, -1.0}) {
            // side (a + s d - edge) <= 0
            const double edge = side > 0 ? box.high[k] : box.low[k];
            const double slope = side * d[k], room = side * (edge - a[k]);
            if (slope == 0) {
                if (!(room >= 0)) return false;
            } else if (slope > 0) {
                to = std::min(to, room / slope);
            } else {
                from = std::max(from, room / slope);
            }
        }
    if (!(from <= to)) return false;
    const glm::dvec2 start = a;
    if (to < 1) b = start + to * d;
    if (from > 0) a = start + from * d;
    return true;
}

/// What of a polyline is not within `radius` of any of the points.
std::vector<std::vector<glm::dvec2>> parts_away_from(const std::vector<glm::dvec2>& points,
                                                     const std::vector<glm::dvec2>& from, double radius) {
    if (from.empty()) return {points};
    std::vector<std::vector<glm::dvec2>> parts;
    const auto add = [&](const glm::dvec2& a, const glm::dvec2& b) {
        if (parts.empty() || parts.back().back() != a) parts.push_back({a});
        parts.back().push_back(b);
    };
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
        const glm::dvec2 a = points[k], d = points[k + 1] - a;
        // Shares of the segment that are too near, in order.
        std::vector<std::pair<double, double>> near;
        for (const glm::dvec2& p : from) {
            const double square = glm::dot(d, d), middle = glm::dot(p - a, d) / square;
            const glm::dvec2 beside = a + middle * d - p;
            const double half = std::sqrt((radius * radius - glm::dot(beside, beside)) / square);
            if (half > 0) near.emplace_back(middle - half, middle + half);
        }
        std::sort(near.begin(), near.end());
        double at = 0;
        for (const auto& [begin, end] : near) {
            if (begin >= 1) break;
            if (begin > at) add(a + at * d, a + begin * d);
            at = std::max(at, end);
        }
        if (at < 1) add(at > 0 ? a + at * d : a, points[k + 1]);
    }
    return parts;
}

class Page {
  public:
    Page(const FigureFrame& frame, const View& view, const glm::dvec2& size, const DrawingOptions& options)
        : m_frame(frame), m_options(options), m_view(view) {
        const double margin = 2 * (options.line_width + options.halo) + 2;
        m_box = {glm::dvec2(-margin), size + margin};
        m_drawing.frame = frame.number;
        m_drawing.size = size;
        m_drawing.line_width = options.line_width;
        m_drawing.halo = options.halo;
        m_drawing.simple = options.style != OutlineStyle::limbs;
        // Chords take a part of what lines may be off.
        if (holds_tolerance(options.style)) m_options.tol = std::min(options.tol, options.simple_tol / 4);
        m_drawing.max_error = m_options.tol;
        for (const Body& body : frame.bodies) m_shapes.push_back(body.shape);
    }

    Drawing take() {
        const auto layer = [](const Stroke& stroke) {
            return stroke.kind == StrokeKind::fill ? 0 : stroke.kind == StrokeKind::hidden ? 1 : 2;
        };
        std::stable_sort(m_drawing.strokes.begin(), m_drawing.strokes.end(),
                         [&](const Stroke& a, const Stroke& b) {
                             return layer(a) != layer(b) ? layer(a) < layer(b) : a.depth > b.depth;
                         });
        if (m_options.halo > 0) add_halos();
        return std::move(m_drawing);
    }

    void draw_outlines(const ParallelFor& parallel_for) {
        OutlineOptions options;
        options.hide = m_options.hidden != HiddenLines::draw;
        options.crossings = m_options.crossings;
        options.keep_hidden = m_options.hidden == HiddenLines::dash;
        options.tol = kShareOfTol * m_options.tol;
        options.window = {m_box.low, m_box.high};
        const Outlines found = outlines(m_frame, m_view, options, parallel_for);
        const std::vector<Outline>& all = found.bodies;
        if (m_options.style != OutlineStyle::limbs) return draw_simple(all, parallel_for);
        std::vector<Detail> details(all.size(), Detail::body);
        if (m_options.lod > 0) details = levels_of_detail(m_shapes, m_view, {m_options.lod});
        std::vector<int> lines;
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (details[i] == Detail::dot)
                draw_dot(i, all[i]);
            else if (details[i] == Detail::line)
                lines.push_back(static_cast<int>(i));
            else
                draw_outline(i, all[i]);
        }
        draw_lines(lines, all, parallel_for);
        const auto drawn = [&](int i) { return details[static_cast<std::size_t>(i)] > Detail::line; };
        for (const CrossingCurve& curve : found.crossings)
            if (drawn(curve.first) && drawn(curve.second)) draw_crossing(curve);
    }

    /// Shows bodies by cylinders, which hide nothing.
    void draw_cylinders() {
        for (const CylinderLine& line :
             cylinder_lines(m_frame, m_view, kShareOfTol * m_options.tol, m_drawing.left_out)) {
            const auto i = static_cast<std::size_t>(line.body);
            std::vector<glm::dvec2> points;
            for (const glm::dvec2& p : line.points) points.push_back(on_page(p));
            add(StrokeKind::visible, i, points, m_view.to_view(m_shapes[i].center).z);
        }
        for (const Ellipsoid& body : m_shapes) count_error(cylinder_error(body, m_view));
    }

    void draw_sticks() {
        const std::vector<Stick> sticks =
            m_options.sticks == Sticks::axes ? axis_sticks(m_frame) : joint_sticks(m_frame);
        std::vector<SeenLine> lines;
        lines.reserve(sticks.size());
        for (const Stick& stick : sticks) lines.push_back({stick.from, stick.to, {}, {}});
        hide_lines(lines, {}, m_view);  // what is before the observer
        for (std::size_t i = 0; i < lines.size(); ++i)
            for (const Arc& part : lines[i].visible)
                add_line(StrokeKind::stick, static_cast<std::size_t>(sticks[i].body), lines[i], part);
    }

  private:
    /// A gap where a neighbour's line ends at this one would open the joint.
    void add_halos() {
        std::vector<std::vector<glm::dvec2>> ends(m_frame.bodies.size());
        for (const Stroke& stroke : m_drawing.strokes) {
            const auto& points = stroke.points;
            if (stroke.kind != StrokeKind::visible || points.front() == points.back()) continue;
            for (const Joint& joint : m_frame.joints)
                for (const auto& [own, other] :
                     {std::pair(joint.first, joint.second), std::pair(joint.second, joint.first)})
                    if (own == stroke.position)
                        ends[static_cast<std::size_t>(other)].insert(
                            ends[static_cast<std::size_t>(other)].end(), {points.front(), points.back()});
        }
        const double radius = m_options.halo + m_options.line_width;
        for (Stroke& stroke : m_drawing.strokes)
            if (stroke.kind == StrokeKind::visible || stroke.kind == StrokeKind::stick)
                stroke.halo =
                    parts_away_from(stroke.points, ends[static_cast<std::size_t>(stroke.position)], radius);
    }

    /// The whole limb, which the page may cut.
    void fill_outline(std::size_t i, const Outline& outline) {
        if (outline.kind != OutlineKind::whole) return;
        Stroke stroke = stroke_of(StrokeKind::fill, i);
        for (const double angle :
             chord_angles(outline, {0, 2 * std::numbers::pi}, m_view, kShareOfTol * m_options.tol))
            stroke.points.push_back(on_page(outline.on_screen(angle, m_view)));
        stroke.points.back() = stroke.points.front();
        if (m_options.viewport)
            stroke.points = clip_polygon(stroke.points, *m_options.viewport, kShareOfTol * m_options.tol);
        stroke.depth = outline.viewed.center.z;
        if (has_extent(stroke.points)) m_drawing.strokes.push_back(std::move(stroke));
    }

    /// What is infinite is left out or drawn whole.
    void count_error(double error) {
        if (error < HUGE_VAL) m_drawing.max_error = std::max(m_drawing.max_error, error + m_options.tol);
    }

    /// Draws bodies by the level of their figure, or by one for all.
    void draw_simple(const std::vector<Outline>& all, const ParallelFor& parallel_for) {
        const double most = m_options.simple_tol - m_options.tol;
        std::vector<FigureLevel> levels(
            std::max<std::size_t>(m_frame.figures.size(), 1),
            m_options.style == OutlineStyle::boxes ? FigureLevel::boxes : FigureLevel::contours);
        if (m_options.style == OutlineStyle::levels) levels = figure_levels(m_frame, m_view, most);
        std::vector<bool> has_dot(levels.size());
        for (std::size_t i = 0; i < all.size(); ++i) {
            const auto figure =
                std::min(static_cast<std::size_t>(m_frame.bodies[i].figure), levels.size() - 1);
            const Ellipsoid& body = m_shapes[i];
            const int contours = contours_for(body, m_view, most);
            const FigureLevel level = levels[figure];
            // A body that is a point is there nevertheless.
            if (level != FigureLevel::dot && dot_error(body, m_view) <= kLeastExtent) {
                draw_dot(i, all[i]);
                continue;
            }
            if (level == FigureLevel::dot) {
                // Of the first body that is seen.
                if (has_dot[figure] || all[i].visible.empty()) continue;
                has_dot[figure] = true;
                const FigureDot dot = figure_dot(m_frame, m_view, figure);
                add_dot(i, on_page(dot.at), m_view.to_view(body.center).z);
                count_error(dot.error);
            } else if (level == FigureLevel::sticks) {
                draw_shape(i, {axis_line(body)}, {static_cast<int>(i)}, parallel_for);
                count_error(stick_error(body, m_view));
            } else if (level == FigureLevel::boxes && box_error(body, m_view) < HUGE_VAL) {
                draw_shape(i, box_lines(body, m_view), {static_cast<int>(i)}, parallel_for);
                count_error(box_error(body, m_view));
            } else if (level == FigureLevel::contours && contours > 0) {
                const double tol = kShareOfTol * m_options.tol;
                draw_shape(i, contour_lines(body, m_view, contours, tol), {}, parallel_for);
                count_error(contour_error(body, m_view, contours));
            } else {
                draw_outline(i, all[i]);
            }
        }
    }

    /// Draws the lines of a shape that stands for body i: what is turned away is hidden, and so is what bodies but `ignored` hide.
    void draw_shape(std::size_t i, const std::vector<ShapeLine>& shape, const std::vector<int>& ignored,
                    const ParallelFor& parallel_for) {
        std::vector<SeenLine> lines;
        for (const ShapeLine& line : shape) lines.push_back({line.from, line.to, {}, {}});
        const bool hide = m_options.hidden != HiddenLines::draw;
        hide_lines(lines, hide ? std::span<const Ellipsoid>(m_shapes) : std::span<const Ellipsoid>(), m_view,
                   std::vector<std::vector<int>>(lines.size(), ignored), parallel_for);
        for (std::size_t k = 0; k < lines.size(); ++k) {
            const bool seen = !hide || !shape[k].turned_away;
            for (const Arc& part : lines[k].visible)
                if (seen || m_options.hidden == HiddenLines::dash)
                    add_line(seen ? StrokeKind::visible : StrokeKind::hidden, i, lines[k], part);
            if (m_options.hidden == HiddenLines::dash)
                for (const Arc& part : lines[k].hidden) add_line(StrokeKind::hidden, i, lines[k], part);
        }
    }

    void draw_outline(std::size_t i, const Outline& outline) {
        if (m_options.fill) fill_outline(i, outline);
        for (const Arc& arc : outline.visible) add_arc(StrokeKind::visible, i, outline, arc);
        if (m_options.hidden == HiddenLines::dash)
            for (const Arc& arc : outline.hidden) add_arc(StrokeKind::hidden, i, outline, arc);
    }

    void draw_crossing(const CrossingCurve& curve) {
        const auto i = static_cast<std::size_t>(curve.first);
        for (const Arc& arc : curve.visible) add_part(StrokeKind::visible, i, curve, arc);
        if (m_options.hidden == HiddenLines::dash)
            for (const Arc& arc : curve.hidden) add_part(StrokeKind::hidden, i, curve, arc);
    }

    void draw_dot(std::size_t i, const Outline& outline) {
        if (!outline.visible.empty()) add_dot(i, on_page(outline.screen.center), outline.viewed.center.z);
    }

    void add_dot(std::size_t i, const glm::dvec2& at, double depth) {
        if (at.x < m_box.low.x || at.y < m_box.low.y || at.x > m_box.high.x || at.y > m_box.high.y) return;
        if (m_options.viewport && !m_options.viewport->holds(at)) return;
        Stroke stroke = stroke_of(StrokeKind::dot, i);
        stroke.points.assign(1, at);
        stroke.depth = depth;
        m_drawing.strokes.push_back(std::move(stroke));
    }

    /// Bodies that are drawn as the longest axis of their limb.
    void draw_lines(const std::vector<int>& bodies, const std::vector<Outline>& all,
                    const ParallelFor& parallel_for) {
        std::vector<SeenLine> lines;
        std::vector<std::vector<int>> own;
        for (const int i : bodies) {
            const Outline& o = all[static_cast<std::size_t>(i)];
            const double t =
                principal_axes(
                    Ellipse<glm::dvec2>{{0, 0}, glm::dvec2(o.viewed.cosine), glm::dvec2(o.viewed.sine)})
                    .shift;
            lines.push_back({o.limb(t), o.limb(t + std::numbers::pi), {}, {}});
            own.push_back({i});
        }
        const bool hide = m_options.hidden != HiddenLines::draw;
        hide_lines(lines, hide ? std::span<const Ellipsoid>(m_shapes) : std::span<const Ellipsoid>(), m_view,
                   own, parallel_for);
        for (std::size_t k = 0; k < lines.size(); ++k) {
            const auto i = static_cast<std::size_t>(bodies[k]);
            for (const Arc& part : lines[k].visible) add_line(StrokeKind::visible, i, lines[k], part);
            if (m_options.hidden == HiddenLines::dash)
                for (const Arc& part : lines[k].hidden) add_line(StrokeKind::hidden, i, lines[k], part);
        }
    }

    void add_arc(StrokeKind kind, std::size_t i, const Outline& outline, const Arc& arc) {
        std::vector<glm::dvec2> points;
        double depth = 0;
        for (const double angle : chord_angles(outline, arc, m_view, kShareOfTol * m_options.tol)) {
            points.push_back(on_page(outline.on_screen(angle, m_view)));
            depth += outline.viewed(angle).z;
        }
        depth /= static_cast<double>(points.size());
        if (arc.length() > kWholeTurn) {
            // A body that is a point is there nevertheless.
            if (kind == StrokeKind::visible && !has_extent(points)) return add_dot(i, points[0], depth);
            points.back() = points.front();
        }
        add(kind, i, points, depth);
    }

    /// A part of a closed polyline; it may go over its end.
    void add_part(StrokeKind kind, std::size_t i, const CrossingCurve& curve, const Arc& arc) {
        std::vector<glm::dvec2> points;
        double depth = 0;
        const auto add_point = [&](double t) {
            const auto k = static_cast<std::size_t>(t), count = curve.points.size();
            const glm::dvec3 p = m_view.to_view(
                glm::mix(curve.points[k % count], curve.points[(k + 1) % count], t - std::floor(t)));
            points.push_back(on_page(m_view.to_screen(p)));
            depth += p.z;
        };
        add_point(arc.begin);
        for (int t = static_cast<int>(std::floor(arc.begin)) + 1; t < arc.end; ++t) add_point(t);
        add_point(arc.end);
        if (arc.length() >= static_cast<double>(curve.points.size())) points.back() = points.front();
        add(kind, i, points, depth / static_cast<double>(points.size()));
    }

    void add_line(StrokeKind kind, std::size_t i, const SeenLine& line, const Arc& part) {
        const glm::dvec3 from = m_view.to_view(line.from + part.begin * (line.to - line.from)),
                         to = m_view.to_view(line.from + part.end * (line.to - line.from));
        add(kind, i, {on_page(m_view.to_screen(from)), on_page(m_view.to_screen(to))}, 0.5 * (from.z + to.z));
    }

    /// Adds what of a polyline is on the page, but nothing of no extent: round caps would make it a dot.
    void add(StrokeKind kind, std::size_t i, const std::vector<glm::dvec2>& points, double depth) {
        Stroke stroke = stroke_of(kind, i);
        stroke.depth = depth;
        for (std::size_t k = 0; k + 1 < points.size(); ++k) {
            glm::dvec2 a = points[k], b = points[k + 1];
            if (!clip(a, b, m_box) || (m_options.viewport && !clip(a, b, *m_options.viewport))) continue;
            if (stroke.points.empty() || stroke.points.back() != a) {
                if (has_extent(stroke.points)) m_drawing.strokes.push_back(stroke);
                stroke.points = {a};
            }
            stroke.points.push_back(b);
        }
        if (has_extent(stroke.points)) m_drawing.strokes.push_back(std::move(stroke));
    }

    Stroke stroke_of(StrokeKind kind, std::size_t i) const {
        Stroke stroke;
        stroke.kind = kind;
        stroke.body = m_frame.bodies[i].name;
        stroke.position = static_cast<int>(i);
        if (m_options.colors || kind == StrokeKind::fill)
            stroke.color = glm::clamp(m_frame.bodies[i].color, 0.0, 255.0);
        return stroke;
    }

    glm::dvec2 on_page(const glm::dvec2& screen) const { return {screen.x, m_drawing.size.y - screen.y}; }

    const FigureFrame& m_frame;
    DrawingOptions m_options;
    const View& m_view;
    ScreenWindow m_box;
    std::vector<Ellipsoid> m_shapes;
    Drawing m_drawing;
};

}  // namespace

Drawing draw(const FigureFrame& frame, const View& view, const glm::dvec2& size,
             const DrawingOptions& options, const ParallelFor& parallel_for) {
    Page page(frame, view, size, options);
    if (options.sticks == Sticks::none && options.style == OutlineStyle::cylinders)
        page.draw_cylinders();
    else if (options.sticks == Sticks::none)
        page.draw_outlines(parallel_for);
    else
        page.draw_sticks();
    return page.take();
}

}  // namespace anamorph::figure
