// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chain/middle_edges.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace anamorph {
namespace {

using Polygon = std::vector<Point<double>>;

/// The part of a convex polygon on which a linear function is not negative (Sutherland and Hodgman 1974).
Polygon clipped(const Polygon& polygon, const Jet1<double>& edge) {
    const auto height = [&](const Point<double>& p) { return edge.c[0] + edge.c[1] * p.x + edge.c[2] * p.y; };
    Polygon part;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point<double>&a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double at_a = height(a), at_b = height(b);
        if (at_a >= 0) part.push_back(a);
        if ((at_a >= 0) != (at_b >= 0)) part.push_back(a + (b - a) * (at_a / (at_a - at_b)));
    }
    return part;
}

}  // namespace

PartialPixel part_within(int x, int y, std::span<const Jet1<double>> edges) {
    Polygon part{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
    bool is_whole = true;
    for (const Jet1<double>& edge : edges) {
        const double reach = 0.5 * (std::fabs(edge.c[1]) + std::fabs(edge.c[2]));
        if (edge.c[0] >= reach) continue;
        is_whole = false;
        part = clipped(part, edge);
    }
    const Point<double> middle{x + 0.5, y + 0.5};
    if (is_whole) return {x, y, 1, middle};
    // The area of a polygon and its centre of mass, by triangles from its first corner.
    double area = 0;
    Point<double> sum{0, 0}, low{0.5, 0.5}, high{-0.5, -0.5};
    for (std::size_t i = 0; i < part.size(); ++i) {
        low = {std::min(low.x, part[i].x), std::min(low.y, part[i].y)};
        high = {std::max(high.x, part[i].x), std::max(high.y, part[i].y)};
        if (i < 2) continue;
        const Point<double> a = part[i - 1] - part[0], b = part[i] - part[0];
        const double triangle = 0.5 * (a.x * b.y - a.y * b.x);
        area += triangle;
        sum = sum + (a + b) * (triangle / 3);
    }
    if (!(area > 0)) return {x, y, 0, middle, 0, 0};
    const Point<double> mass = part[0] + sum * (1 / area);
    return {x, y, std::min(area, 1.0), middle + mass, high.x - low.x, high.y - low.y};
}

EdgesOverBox::EdgesOverBox(const Box& box, std::vector<Jet1<double>> middle, std::vector<Jet1<Interval>> over)
    : m_middle{0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1)},
      m_edges(std::move(middle)),
      m_over(std::move(over)) {}

Cover EdgesOverBox::cover(const Box& part) const {
    const Interval dx(part.x0 - m_middle.x, part.x1 - m_middle.x),
        dy(part.y0 - m_middle.y, part.y1 - m_middle.y);
    Cover cover = Cover::inside;
    for (std::size_t i = 0; i < m_edges.size(); ++i) {
        const Jet1<double>& edge = m_edges[i];
        // By the mean value theorem, from the middle of the box.
        const auto at = [&](const Interval& x, const Interval& y) {
            return Interval(edge.c[0]) + m_over[i].c[1] * x + m_over[i].c[2] * y;
        };
        const Interval all = at(dx, dy);
        if (all.hi < 0) return Cover::outside;
        if (all.lo >= 0 || cover == Cover::cut) continue;
        const Interval farthest =
            at(Interval(edge.c[1] > 0 ? dx.lo : dx.hi), Interval(edge.c[2] > 0 ? dy.lo : dy.hi));
        cover = farthest.hi < -kNegligible ? Cover::cut : Cover::mixed;
    }
    return cover;
}

}  // namespace anamorph
