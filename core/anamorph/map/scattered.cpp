// SPDX-License-Identifier: Apache-2.0
#include "anamorph/map/scattered.h"

#include <algorithm>
#include <boost/polygon/voronoi.hpp>
#include <cmath>
#include <cstdio>
#include <map>

#include "anamorph/error.h"

namespace anamorph {
namespace {

/// A point of the triangulation: its place, displacement, and the displacement's gradient.
struct Node {
    double x, y;
    Point<double> d;
    Point<double> dx{0, 0}, dy{0, 0};
};

using Corners = std::array<std::size_t, 3>;

std::string text_of(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

double cross(const Point<double>& a, const Point<double>& b) {
    return a.x * b.y - a.y * b.x;
}

/// The points in pixels with their displacements.
std::vector<Node> nodes_of(const ControlPoints& points, const Extent& from, const Extent& to,
                           const Point<double>& scale, double amount, const std::string& name) {
    if (points.pairs.empty()) throw Error(name + ": there are no points");
    if (points.pairs.size() > ControlPoints::kMaxPoints)
        throw Error(name + ": points", std::to_string(points.pairs.size()),
                    "allowed are at most " + std::to_string(ControlPoints::kMaxPoints));
    const bool pixels = points.units == Units::pixels;
    std::vector<Node> nodes;
    nodes.reserve(points.pairs.size() + 4);
    for (std::size_t i = 0; i < points.pairs.size(); ++i) {
        ControlPoints::Pair p = points.pairs[i];
        if (!pixels) p = {p.x * from.width, p.y * from.height, p.u * to.width, p.v * to.height};
        for (const double v : {p.x, p.y, p.u, p.v})
            if (!(std::fabs(v) <= ControlMesh::kMaxPosition))
                throw Error(name + ": points[" + std::to_string(i) + "]", text_of(v),
                            "allowed are numbers that stand for at most 1e8 pixels");
        const Point<double> d{(p.u - p.x * scale.x) * amount, (p.v - p.y * scale.y) * amount};
        if (!(std::fabs(d.x) <= 1e11 && std::fabs(d.y) <= 1e11))
            throw Error("amount", text_of(amount), "it moves a point by more than 1e11 pixels");
        nodes.push_back({p.x, p.y, d});
    }
    return nodes;
}

/// d = origin + dx (x - cx) + dy (y - cy).
struct Affine {
    double cx = 0, cy = 0;
    Point<double> origin{0, 0}, dx{0, 0}, dy{0, 0};

    Point<double> operator()(double x, double y) const { return origin + dx * (x - cx) + dy * (y - cy); }
};

/// The plane through (cx, cy, origin) that fits (x - cx, y - cy, d - origin) best, weights given; flat where
/// the points lie on a line.
template <class Weight>
void fit_slopes(Affine& plane, const std::vector<Node>& nodes, const std::vector<std::size_t>& which,
                const Weight& weight) {
    double xx = 0, xy = 0, yy = 0;
    Point<double> xd{0, 0}, yd{0, 0};
    for (const std::size_t i : which) {
        const Node& n = nodes[i];
        const double x = n.x - plane.cx, y = n.y - plane.cy, w = weight(x, y);
        const Point<double> d = n.d - plane.origin;
        xx += w * x * x;
        xy += w * x * y;
        yy += w * y * y;
        xd = xd + d * (w * x);
        yd = yd + d * (w * y);
    }
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 1e-12 * (xx + yy) * (xx + yy))) return;
    plane.dx = (xd * yy - yd * xy) * (1 / determinant);
    plane.dy = (yd * xx - xd * xy) * (1 / determinant);
}

Affine best_affine(const std::vector<Node>& nodes) {
    Affine fit;
    std::vector<std::size_t> all(nodes.size());
    const double share = 1.0 / static_cast<double>(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        all[i] = i;
        fit.cx += nodes[i].x * share;
        fit.cy += nodes[i].y * share;
        fit.origin = fit.origin + nodes[i].d * share;
    }
    fit_slopes(fit, nodes, all, [](double, double) { return 1.0; });
    return fit;
}

/// Delaunay triangles from the Voronoi diagram of the points rounded to a fine grid: every Voronoi vertex is
/// the centre of a polygon of points on one circle. Topology only: places stay as they are.
std::vector<Corners> triangulate(const std::vector<Node>& nodes, std::size_t given, const Bounds& box,
                                 const std::string& name) {
    namespace bp = boost::polygon;
    // The grid reaches 2^30 each way from the middle.
    const double cx = 0.5 * (box.x0 + box.x1), cy = 0.5 * (box.y0 + box.y1);
    const double grid = 0x1p30 / std::max(0.5 * (box.x1 - box.x0), 0.5 * (box.y1 - box.y0));
    std::vector<bp::point_data<std::int32_t>> places;
    std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> taken;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const auto x = static_cast<std::int32_t>(std::lround((nodes[i].x - cx) * grid)),
                   y = static_cast<std::int32_t>(std::lround((nodes[i].y - cy) * grid));
        const auto [at, is_new] = taken.try_emplace({x, y}, i);
        if (!is_new)
            throw Error(name + ": points[" + std::to_string(std::min(i, given - 1)) + "]",
                        "[" + text_of(nodes[i].x) + ", " + text_of(nodes[i].y) + "]",
                        "points[" + std::to_string(at->second) + "] stands at the same place");
        places.emplace_back(x, y);
    }
    bp::voronoi_diagram<double> diagram;
    bp::construct_voronoi(places.begin(), places.end(), &diagram);
    std::vector<Corners> triangles;
    for (const auto& vertex : diagram.vertices()) {
        std::vector<std::size_t> around;
        const auto* edge = vertex.incident_edge();
        do {
            around.push_back(edge->cell()->source_index());
            edge = edge->rot_next();
        } while (edge != vertex.incident_edge());
        for (std::size_t k = 2; k < around.size(); ++k) {
            const Node &a = nodes[around[0]], &b = nodes[around[k - 1]], &c = nodes[around[k]];
            const double area = cross({b.x - a.x, b.y - a.y}, {c.x - a.x, c.y - a.y});
            // Rounding may leave triangles without an inside.
            if (std::fabs(area) < 1e-12) continue;
            if (area > 0)
                triangles.push_back({around[0], around[k - 1], around[k]});
            else
                triangles.push_back({around[0], around[k], around[k - 1]});
        }
    }
    return triangles;
}

void set_gradients(std::vector<Node>& nodes, std::size_t given, const std::vector<Corners>& triangles) {
    std::vector<std::vector<std::size_t>> neighbours(nodes.size());
    for (const Corners& t : triangles)
        for (std::size_t i = 0; i < 3; ++i)
            for (const std::size_t other : {t[(i + 1) % 3], t[(i + 2) % 3]})
                neighbours[t[i]].push_back(other);
    for (std::size_t i = 0; i < given; ++i) {
        std::sort(neighbours[i].begin(), neighbours[i].end());
        neighbours[i].erase(std::unique(neighbours[i].begin(), neighbours[i].end()), neighbours[i].end());
        Affine plane{nodes[i].x, nodes[i].y, nodes[i].d};
        fit_slopes(plane, nodes, neighbours[i], [](double x, double y) { return 1 / (x * x + y * y); });
        nodes[i].dx = plane.dx;
        nodes[i].dy = plane.dy;
    }
}

/// The three cubics of a triangle.
void add_cubics(const std::vector<Node>& nodes, const Corners& corners, std::vector<CubicTriangle>& cubics) {
    const Node* v[3] = {&nodes[corners[0]], &nodes[corners[1]], &nodes[corners[2]]};
    const Point<double> middle{(v[0]->x + v[1]->x + v[2]->x) / 3, (v[0]->y + v[1]->y + v[2]->y) / 3};
    const auto towards = [](const Node& n, double x, double y) {
        return n.d + n.dx * ((x - n.x) / 3) + n.dy * ((y - n.y) / 3);
    };
    CubicTriangle parts[3];
    Point<double> inner[3];  // 102 of a corner: on the line from it to the middle
    for (std::size_t k = 0; k < 3; ++k) {
        // Edge from i to j and the middle.
        const Node &i = *v[(k + 1) % 3], &j = *v[(k + 2) % 3];
        CubicTriangle& p = parts[k];
        p.corner[0] = {i.x, i.y};
        p.corner[1] = {j.x, j.y};
        p.corner[2] = middle;
        const Point<double> e0 = p.corner[0] - middle, e1 = p.corner[1] - middle;
        const double area = cross(e0, e1);
        p.a[0] = e1.y / area;
        p.b[0] = -e1.x / area;
        p.a[1] = -e0.y / area;
        p.b[1] = e0.x / area;
        p.bezier[0] = i.d;
        p.bezier[1] = j.d;
        p.bezier[3] = towards(i, j.x, j.y);
        p.bezier[4] = towards(j, i.x, i.y);
        p.bezier[5] = towards(i, middle.x, middle.y);
        p.bezier[6] = towards(j, middle.x, middle.y);
        // 111: the derivative across the edge is linear along it, so at its middle the mean of those at its
        // ends: 3/4 (u (300 + 2 210 + 120) + v (210 + 2 120 + 030) + w (201 + 2 111 + 021)), where (u, v, w)
        // is the normal in barycentric coordinates.
        const double nx = j.y - i.y, ny = i.x - j.x;
        const double u = nx * p.a[0] + ny * p.b[0], w1 = nx * p.a[1] + ny * p.b[1], w = -u - w1;
        const Point<double> wanted = (i.dx * nx + i.dy * ny + j.dx * nx + j.dy * ny) * 0.5;
        const Point<double> along = (p.bezier[0] + p.bezier[3] * 2 + p.bezier[4]) * u +
                                    (p.bezier[3] + p.bezier[4] * 2 + p.bezier[1]) * w1;
        p.bezier[9] = ((wanted * (4.0 / 3) - along) * (1 / w) - p.bezier[5] - p.bezier[6]) * 0.5;
    }
    // Across the lines to the middle: each inner point is the mean of its neighbours'.
    for (std::size_t k = 0; k < 3; ++k) {
        const CubicTriangle &after = parts[(k + 2) % 3], &before = parts[(k + 1) % 3];
        inner[k] = (after.bezier[5] + after.bezier[9] + before.bezier[9]) * (1.0 / 3);
    }
    const Point<double> top = (inner[0] + inner[1] + inner[2]) * (1.0 / 3);
    for (std::size_t k = 0; k < 3; ++k) {
        parts[k].bezier[2] = top;
        parts[k].bezier[7] = inner[(k + 1) % 3];
        parts[k].bezier[8] = inner[(k + 2) % 3];
        cubics.push_back(parts[k]);
    }
}

}  // namespace

double CubicTriangle::inside(double x, double y) const {
    const double dx = x - corner[2].x, dy = y - corner[2].y;
    const double u = dx * a[0] + dy * b[0], v = dx * a[1] + dy * b[1];
    return std::min({u, v, 1 - u - v});
}

Bounds CubicTriangle::bounds() const {
    Bounds all{corner[0].x, corner[0].y, corner[0].x, corner[0].y};
    for (const Point<double>& c : corner) all.add({c.x, c.y, c.x, c.y});
    return all;
}

bool CubicTriangle::meets(const Bounds& box) const {
    if (!bounds().meets(box)) return false;
    // All of the rectangle on the far side of an edge: a barycentric coordinate is negative on it.
    const double x = 0.5 * (box.x0 + box.x1) - corner[2].x, y = 0.5 * (box.y0 + box.y1) - corner[2].y;
    const double hx = 0.5 * (box.x1 - box.x0), hy = 0.5 * (box.y1 - box.y0);
    const auto beyond = [&](double p, double q, double constant) {
        return constant + p * x + q * y + std::fabs(p) * hx + std::fabs(q) * hy < -1e-9;
    };
    return !beyond(a[0], b[0], 0) && !beyond(a[1], b[1], 0) && !beyond(-a[0] - a[1], -b[0] - b[1], 1);
}

Scattered::Scattered(const ControlPoints& points, const Extent& from, const Extent& to, double amount,
                     const std::string& name)
    : m_from(from), m_to(to) {
    if (!std::isfinite(amount)) throw Error("amount", text_of(amount), "allowed are finite numbers");
    m_scale = {static_cast<double>(to.width) / from.width, static_cast<double>(to.height) / from.height};
    std::vector<Node> nodes = nodes_of(points, from, to, m_scale, amount, name);
    const std::size_t given = nodes.size();

    // Four further points, far outside, on the best affine map.
    const Affine affine = best_affine(nodes);
    Bounds box{0, 0, double(from.width), double(from.height)};
    for (const Node& n : nodes) box.add({n.x, n.y, n.x, n.y});
    const double w = box.x1 - box.x0, h = box.y1 - box.y0;
    box = {box.x0 - w, box.y0 - h, box.x1 + w, box.y1 + h};
    for (const double x : {box.x0, box.x1})
        for (const double y : {box.y0, box.y1}) nodes.push_back({x, y, affine(x, y), affine.dx, affine.dy});
    m_orientation =
        (m_scale.x + affine.dx.x) * (m_scale.y + affine.dy.y) - affine.dx.y * affine.dy.x < 0 ? -1 : 1;

    const std::vector<Corners> triangles = triangulate(nodes, given, box, name);
    set_gradients(nodes, given, triangles);
    m_triangles.reserve(3 * triangles.size());
    for (const Corners& t : triangles) add_cubics(nodes, t, m_triangles);
    std::vector<Bounds> bounds;
    bounds.reserve(m_triangles.size());
    for (const CubicTriangle& t : m_triangles) bounds.push_back(t.bounds());
    m_tree = BoundsTree(std::move(bounds));
}

const CubicTriangle& Scattered::triangle_at(double x, double y) const {
    // On an edge both agree; rounding may leave a point outside all triangles by a hair.
    std::int32_t best = 0;
    double most = -HUGE_VAL;
    m_tree.each({x, y, x, y}, [&](std::int32_t i) {
        const double inside = m_triangles[static_cast<std::size_t>(i)].inside(x, y);
        if (inside > most || (inside == most && i < best)) {
            most = inside;
            best = i;
        }
    });
    return m_triangles[static_cast<std::size_t>(best)];
}

}  // namespace anamorph
