// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/simple_outlines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <numbers>
#include <optional>

#include "anamorph/number/hypot.h"

namespace anamorph::figure {
namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;
// What the header derives.
const double kBoxScale = 2 / (1 + std::sqrt(3.0)), kBoxShare = (std::sqrt(3.0) - 1) / (std::sqrt(3.0) + 1);
const double kCylinderScale = 2 / (1 + std::sqrt(2.0)),
             kCylinderShare = (std::sqrt(2.0) - 1) / (std::sqrt(2.0) + 1);

double contour_scale(int contours) {
    return 2 / (1 + std::cos(std::numbers::pi / (2 * contours)));
}
double contour_share(int contours) {
    const double tangent = std::tan(std::numbers::pi / (4 * contours));
    return tangent * tangent;
}

/// A body's half-axes as vectors, as the observer has them, the longest first.
glm::dmat3 axes_of(const Ellipsoid& body, const glm::dmat3& turn) {
    std::array<int, 3> order{0, 1, 2};
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return body.axes[a] > body.axes[b]; });
    const glm::dmat3 all = turn * body.rotation;
    glm::dmat3 axes;
    for (int k = 0; k < 3; ++k) {
        const int axis = order[static_cast<std::size_t>(k)];
        axes[k] = body.axes[axis] * all[axis];
    }
    return axes;
}

/// How far apart, in pixels, points about a body may be seen that differ by a point of the unit ball times the orthogonal `offsets`.
double seen_distance(const Ellipsoid& body, const glm::dmat3& offsets, const View& view) {
    if (!view.perspective()) {
        // The larger singular value of what is seen of the offsets.
        double a = 0, b = 0, c = 0;
        for (int k = 0; k < 3; ++k) {
            a += offsets[k].x * offsets[k].x;
            b += offsets[k].x * offsets[k].y;
            c += offsets[k].y * offsets[k].y;
        }
        return view.scale * std::sqrt(0.5 * (a + c + hypot(a - c, 2 * b)));
    }
    // x / z of two points that are d apart, with z at least z0 and |x| / z at most t, differs by at most d (1 + t) / z0. Boxes reach
    // sqrt(3) kBoxScale = 1.27 of the longest half-axis, contours at most 2 (one alone, of which k = 2).
    const double longest = std::max({body.axes.x, body.axes.y, body.axes.z}), reach = 2 * longest;
    const glm::dvec3 center = view.to_view(body.center);
    const double nearest = center.z - reach;
    if (!(nearest > view.near)) return HUGE_VAL;
    const double tangent = (glm::length(glm::dvec2(center)) + reach) / nearest;
    const double apart =
        std::max({glm::length(offsets[0]), glm::length(offsets[1]), glm::length(offsets[2])});
    return view.scale * view.eye_distance * apart * (1 + tangent) / nearest;
}

double share_error(const Ellipsoid& body, const View& view, double share) {
    return seen_distance(body, share * axes_of(body, view.rotation), view);
}

}  // namespace

double dot_error(const Ellipsoid& body, const View& view) {
    return share_error(body, view, 1);
}
double stick_error(const Ellipsoid& body, const View& view) {
    glm::dmat3 offsets = axes_of(body, view.rotation);
    offsets[0] = glm::dvec3(0.0);
    return seen_distance(body, offsets, view);
}
double box_error(const Ellipsoid& body, const View& view) {
    return share_error(body, view, kBoxShare);
}
double contour_error(const Ellipsoid& body, const View& view, int contours) {
    return share_error(body, view, contour_share(contours));
}
double cylinder_error(const Ellipsoid& body, const View& view) {
    return share_error(body, view, kCylinderShare);
}

int contours_for(const Ellipsoid& body, const View& view, double most) {
    for (int contours = 1; contours <= kMostContours; ++contours)
        if (contour_error(body, view, contours) <= most) return contours;
    return 0;
}

ShapeLine axis_line(const Ellipsoid& body) {
    const glm::dvec3 half = axes_of(body, glm::dmat3(1.0))[0];
    return {body.center - half, body.center + half};
}

std::vector<ShapeLine> box_lines(const Ellipsoid& body, const View& view) {
    const glm::dmat3 half = kBoxScale * axes_of(body, glm::dmat3(1.0));
    const glm::dvec3 center = view.to_view(body.center);
    // Is the face at the end of an axis turned to the observer?
    const auto faces_observer = [&](int axis, double side) {
        const glm::dvec3 outwards = side * (view.rotation * half[axis]);
        return glm::dot(outwards, view.perspective() ? center + outwards : glm::dvec3(0, 0, 1)) < 0;
    };
    std::vector<ShapeLine> lines;
    for (int along = 0; along < 3; ++along) {
        const int p = (along + 1) % 3, q = (along + 2) % 3;
        for (const double s : {-1.0, 1.0})
            for (const double t : {-1.0, 1.0}) {
                const glm::dvec3 middle = body.center + s * half[p] + t * half[q];
                lines.push_back({middle - half[along], middle + half[along],
                                 !faces_observer(p, s) && !faces_observer(q, t)});
            }
    }
    return lines;
}

std::vector<ShapeLine> contour_lines(const Ellipsoid& body, const View& view, int contours, double tol) {
    const glm::dmat3 axes = contour_scale(contours) * axes_of(body, glm::dmat3(1.0));
    const double size = dot_error(body, view);
    // Chords of half an angle d lie within k cos(d) >= 1, outside of the body, and are off by size (1 - cos(d)).
    const double half = std::min(std::acos(1 / contour_scale(contours)),
                                 std::acos(std::max(-1.0, 1 - tol / std::max(size, tol))));
    const int chords = static_cast<int>(std::clamp(std::ceil(std::numbers::pi / half), 8.0, 720.0));
    std::vector<ShapeLine> lines;
    for (int j = 0; j < contours; ++j) {
        const double latitude = std::numbers::pi * ((j + 0.5) / contours - 0.5);
        const auto point = [&](int i) {
            const double angle = kFullTurn * i / chords;
            return body.center + std::sin(latitude) * axes[0] +
                   std::cos(latitude) * (std::cos(angle) * axes[1] + std::sin(angle) * axes[2]);
        };
        for (int i = 0; i < chords; ++i) lines.push_back({point(i), point(i + 1 == chords ? 0 : i + 1)});
    }
    return lines;
}

FigureDot figure_dot(const FigureFrame& frame, const View& view, std::size_t figure) {
    struct Disc {
        glm::dvec2 center;
        double radius;
    };
    std::vector<Disc> discs;
    glm::dvec2 low(HUGE_VAL), high(-HUGE_VAL);
    for (const Body& body : frame.bodies) {
        if (static_cast<std::size_t>(body.figure) != figure) continue;
        const double radius = dot_error(body.shape, view);
        if (!(radius < HUGE_VAL)) return {{}, HUGE_VAL};
        discs.push_back({view.project(body.shape.center), radius});
        low = glm::min(low, discs.back().center - radius);
        high = glm::max(high, discs.back().center + radius);
    }
    if (discs.empty()) return {};
    FigureDot dot{0.5 * (low + high), 0};
    for (const Disc& disc : discs)
        dot.error = std::max(dot.error, glm::length(disc.center - dot.at) + disc.radius);
    return dot;
}

std::vector<FigureLevel> figure_levels(const FigureFrame& frame, const View& view, double most) {
    std::vector<FigureLevel> levels;
    const auto figures = std::max<std::size_t>(frame.figures.size(), 1);
    for (std::size_t f = 0; f < figures; ++f) {
        double sticks = 0, boxes = 0;
        bool fine = true;
        for (const Body& body : frame.bodies) {
            if (static_cast<std::size_t>(body.figure) != f) continue;
            sticks = std::max(sticks, stick_error(body.shape, view));
            boxes = std::max(boxes, box_error(body.shape, view));
            fine = fine && contours_for(body.shape, view, most) > 0;
        }
        levels.push_back(figure_dot(frame, view, f).error <= most ? FigureLevel::dot
                         : sticks <= most                         ? FigureLevel::sticks
                         : boxes <= most                          ? FigureLevel::boxes
                         : fine                                   ? FigureLevel::contours
                                                                  : FigureLevel::limbs);
    }
    return levels;
}

// --- Willmert's cylinders ----------------------------------------------------------------------------------

namespace {

double cross_of(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

/// A shadow line, from its end at one end ellipse to that at the other.
struct ShadowLine {
    glm::dvec2 at[2];
};

/// A cylinder on the screen.
struct SeenCylinder {
    std::array<glm::dvec3, 2> ends{};                 ///< centres of the end ellipses, in space
    std::array<glm::dvec2, 2> middles{};              ///< these on the screen
    std::array<std::vector<glm::dvec2>, 2> ellipses;  ///< closed
    std::array<std::vector<glm::dvec2>, 2> caps;      ///< of each ellipse what of it is outline
    std::vector<ShadowLine> lines;                    ///< two, or none
};

/// Points of a convex hull, and which ellipse each is of (Andrew's monotone chain); counterclockwise.
std::vector<std::pair<glm::dvec2, int>> hull_of(std::vector<std::pair<glm::dvec2, int>> points) {
    std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
        return a.first.x != b.first.x ? a.first.x < b.first.x : a.first.y < b.first.y;
    });
    std::vector<std::pair<glm::dvec2, int>> hull;
    const auto add = [&](const auto& point, std::size_t least) {
        while (hull.size() >= least + 2 && cross_of(hull.back().first - hull[hull.size() - 2].first,
                                                    point.first - hull.back().first) <= 0)
            hull.pop_back();
        hull.push_back(point);
    };
    for (const auto& point : points) add(point, 0);
    const std::size_t upper = hull.size() - 1;
    for (auto point = points.rbegin() + 1; point != points.rend(); ++point) add(*point, upper);
    hull.pop_back();
    return hull;
}

std::optional<SeenCylinder> seen_cylinder(const Ellipsoid& body, const View& view, double tol) {
    const double size = dot_error(body, view);
    if (!(size < HUGE_VAL)) return std::nullopt;
    const double half = std::acos(std::max(-1.0, 1 - tol / std::max(size, tol)));
    const int chords = static_cast<int>(std::clamp(std::ceil(std::numbers::pi / half), 16.0, 720.0));
    const glm::dmat3 axes = kCylinderScale * axes_of(body, glm::dmat3(1.0));
    SeenCylinder seen;
    std::vector<std::pair<glm::dvec2, int>> points;
    for (int end = 0; end < 2; ++end) {
        const auto e = static_cast<std::size_t>(end);
        seen.ends[e] = body.center + (end == 0 ? -1.0 : 1.0) * axes[0];
        seen.middles[e] = view.project(seen.ends[e]);
        for (int i = 0; i < chords; ++i) {
            const double angle = kFullTurn * i / chords;
            const glm::dvec2 at =
                view.project(seen.ends[e] + std::cos(angle) * axes[1] + std::sin(angle) * axes[2]);
            seen.ellipses[e].push_back(at);
            points.emplace_back(at, end);
        }
        seen.ellipses[e].push_back(seen.ellipses[e].front());
    }
    const auto hull = hull_of(std::move(points));
    // Shadow lines lead from the points of one ellipse to those of the other.
    std::vector<std::size_t> changes;
    for (std::size_t i = 0; i < hull.size(); ++i)
        if (hull[i].second != hull[(i + 1) % hull.size()].second) changes.push_back(i);
    if (changes.size() != 2) return seen;
    for (const std::size_t i : changes) {
        const auto &a = hull[i], &b = hull[(i + 1) % hull.size()];
        ShadowLine line;
        line.at[a.second] = a.first;
        line.at[b.second] = b.first;
        seen.lines.push_back(line);
    }
    for (std::size_t k = 0; k < 2; ++k) {
        const std::size_t begin = changes[k] + 1,
                          count = (changes[1 - k] + hull.size() - changes[k]) % hull.size();
        const auto end = static_cast<std::size_t>(hull[begin % hull.size()].second);
        for (std::size_t i = 0; i < count; ++i)
            seen.caps[end].push_back(hull[(begin + i) % hull.size()].first);
    }
    return seen;
}

/// The shadow line to the left, or right, of a cylinder for one who looks along it from an end; where it has none, nothing.
int line_at(const SeenCylinder& cylinder, int end, bool left) {
    const glm::dvec2 from = cylinder.middles[static_cast<std::size_t>(end)],
                     along = cylinder.middles[static_cast<std::size_t>(1 - end)] - from;
    for (int k = 0; k < static_cast<int>(cylinder.lines.size()); ++k)
        if ((cross_of(along, cylinder.lines[static_cast<std::size_t>(k)].at[end] - from) > 0) == left)
            return k;
    return -1;
}

/// The share of a segment from `p` by `d` at which it meets the line from `q` by `e`.
double meeting(const glm::dvec2& p, const glm::dvec2& d, const glm::dvec2& q, const glm::dvec2& e) {
    return cross_of(q - p, e) / cross_of(d, e);
}

/// Connects the end `p` of a line to that of another, `q`, which comes along `along`: by a circular arc about `center` from p, and a
/// straight line.
std::vector<glm::dvec2> arc_between(const glm::dvec2& center, const glm::dvec2& p, const glm::dvec2& q,
                                    const glm::dvec2& along, double tol) {
    const glm::dvec2 from = p - center, at = q - center;
    const double radius = glm::length(from);
    // |at + t along| = radius, ahead.
    const double a = glm::dot(along, along), b = glm::dot(at, along), c = glm::dot(at, at) - radius * radius;
    const double root = std::sqrt(std::max(0.0, b * b - a * c)), t = a > 0 ? (root - b) / a : 0;
    const glm::dvec2 to = at + std::max(0.0, t) * along;
    const double turn = std::atan2(cross_of(from, to), glm::dot(from, to));
    const double half = std::acos(std::max(-1.0, 1 - tol / std::max(radius, tol)));
    const int steps = static_cast<int>(std::clamp(std::ceil(std::fabs(turn) / (2 * half)), 1.0, 720.0));
    std::vector<glm::dvec2> points;
    for (int i = 0; i <= steps; ++i) {
        const double angle = turn * i / steps;
        points.push_back(center + glm::dvec2(from.x * std::cos(angle) - from.y * std::sin(angle),
                                             from.x * std::sin(angle) + from.y * std::cos(angle)));
    }
    points.push_back(q);
    return points;
}

/// Cylinders, and what joints do to them.
class JoinedCylinders {
  public:
    JoinedCylinders(const FigureFrame& frame, const View& view, double tol, std::vector<int>& left_out)
        : m_frame(frame), m_view(view), m_tol(tol) {
        for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
            m_cylinders.push_back(seen_cylinder(frame.bodies[i].shape, view, tol));
            if (!m_cylinders.back()) left_out.push_back(static_cast<int>(i));
        }
        m_joined.resize(frame.bodies.size());
    }

    std::vector<CylinderLine> take() {
        for (const Joint& joint : m_frame.joints) join(joint);
        for (std::size_t i = 0; i < m_cylinders.size(); ++i) {
            if (!m_cylinders[i]) continue;
            const SeenCylinder& cylinder = *m_cylinders[i];
            for (const ShadowLine& line : cylinder.lines) add(i, {line.at[0], line.at[1]});
            for (std::size_t end = 0; end < 2; ++end)
                if (cylinder.lines.empty())
                    add(i, cylinder.ellipses[end]);
                else if (!m_joined[i][end])
                    add(i, cylinder.caps[end]);
        }
        return std::move(m_lines);
    }

  private:
    void add(std::size_t body, std::vector<glm::dvec2> points) {
        m_lines.push_back({static_cast<int>(body), std::move(points)});
    }

    void join(const Joint& joint) {
        const std::size_t bodies[2] = {static_cast<std::size_t>(joint.first),
                                       static_cast<std::size_t>(joint.second)};
        int ends[2];
        for (int k = 0; k < 2; ++k) {
            if (!m_cylinders[bodies[k]] || m_cylinders[bodies[k]]->lines.size() != 2) return;
            const SeenCylinder& c = *m_cylinders[bodies[k]];
            // Where along the axis the joint is, from -1 to 1: one that is nearer to the middle than to an end connects nothing.
            const glm::dvec3 axis = 0.5 * (c.ends[1] - c.ends[0]), middle = 0.5 * (c.ends[0] + c.ends[1]);
            const double along = glm::dot(joint.position - middle, axis) / glm::dot(axis, axis);
            if (!(std::fabs(along) >= 0.5)) return;
            ends[k] = along < 0 ? 0 : 1;
        }
        if (bodies[0] == bodies[1]) return;
        const glm::dvec2 center = m_view.project(joint.position);
        for (const bool left : {false, true}) {
            const int lines[2] = {line_at(*m_cylinders[bodies[0]], ends[0], left),
                                  line_at(*m_cylinders[bodies[1]], ends[1], !left)};
            if (lines[0] < 0 || lines[1] < 0) continue;
            connect(bodies, ends, lines, center);
        }
        for (int k = 0; k < 2; ++k) m_joined[bodies[k]][static_cast<std::size_t>(ends[k])] = true;
    }

    void connect(const std::size_t (&bodies)[2], const int (&ends)[2], const int (&lines)[2],
                 const glm::dvec2& center) {
        glm::dvec2 *at[2], far[2];
        for (int k = 0; k < 2; ++k) {
            ShadowLine& line = m_cylinders[bodies[k]]->lines[static_cast<std::size_t>(lines[k])];
            at[k] = &line.at[ends[k]];
            far[k] = line.at[1 - ends[k]];
        }
        const glm::dvec2 p = *at[0], q = *at[1], d = far[0] - p, e = far[1] - q;
        const double s = meeting(p, d, q, e), t = meeting(q, e, p, d);
        if (s >= 0 && s <= 1 && t >= 0 && t <= 1) {
            // Clip and crease: to the middle of the base of the triangle of the crossing and the ends that are cut off.
            const glm::dvec2 crossing = p + s * d;
            *at[0] = *at[1] = crossing;
            add(bodies[0], {crossing, 0.5 * (p + q)});
            return;
        }
        // From the end that is farther from the joint, so that the other line, extrapolated, meets the circle.
        const bool first = glm::distance(p, center) >= glm::distance(q, center);
        add(bodies[first ? 0 : 1],
            first ? arc_between(center, p, q, -e, m_tol) : arc_between(center, q, p, -d, m_tol));
    }

    const FigureFrame& m_frame;
    const View& m_view;
    double m_tol;
    std::vector<std::optional<SeenCylinder>> m_cylinders;
    std::vector<std::array<bool, 2>> m_joined;
    std::vector<CylinderLine> m_lines;
};

}  // namespace

std::vector<CylinderLine> cylinder_lines(const FigureFrame& frame, const View& view, double tol,
                                         std::vector<int>& left_out) {
    return JoinedCylinders(frame, view, tol, left_out).take();
}

}  // namespace anamorph::figure
