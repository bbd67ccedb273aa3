// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/scattered.h"

#include <algorithm>
#include <boost/polygon/voronoi.hpp>
#include <cmath>
#include <deque>
#include <map>
#include <set>
#include <utility>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

// What is made of the points once is made in DoubleDouble, with a bound of its rounding.
using Number = Tracked<DoubleDouble>;
using Vector = Point<Number>;

Vector operator+(const Vector& a, const Vector& b) {
    return {a.x + b.x, a.y + b.y};
}
Vector operator-(const Vector& a, const Vector& b) {
    return {a.x - b.x, a.y - b.y};
}
Vector operator*(const Vector& a, const Number& k) {
    return {a.x * k, a.y * k};
}
Number cross(const Vector& a, const Vector& b) {
    return a.x * b.y - a.y * b.x;
}
Number dot(const Vector& a, const Vector& b) {
    return a.x * b.x + a.y * b.y;
}
double rounded(const Number& a) {
    return static_cast<double>(a.value);
}

/// A point of the triangulation: its place, displacement, and the displacement's gradient.
struct Node {
    Vector at, d;
    Vector dx{}, dy{};

    double x() const { return rounded(at.x); }
    double y() const { return rounded(at.y); }
};

using Corners = std::array<std::size_t, 3>;

/// The points in pixels with their displacements.
std::vector<Node> nodes_of(const ControlPoints& points, const Size& from, const Size& to, double amount,
                           const std::string& name) {
    if (points.pairs.empty()) throw Error(name + ": there are no points");
    if (points.pairs.size() > ControlPoints::kMaxPoints)
        throw Error(name + ": points", std::to_string(points.pairs.size()),
                    "must be at most " + std::to_string(ControlPoints::kMaxPoints));
    const bool pixels = points.units == Units::pixels;
    std::vector<Node> nodes;
    nodes.reserve(points.pairs.size() + 4);
    const auto in_pixels = [&](double v, int size) { return pixels ? Number(v) : Number(v) * Number(size); };
    const auto moved = [&](const Number& to_place, const Number& at, int to_size, int from_size) {
        return (to_place - at * Number(to_size) / Number(from_size)) * Number(amount);
    };
    for (std::size_t i = 0; i < points.pairs.size(); ++i) {
        const ControlPoints::Pair& p = points.pairs[i];
        const Vector at{in_pixels(p.x, from.width), in_pixels(p.y, from.height)},
            there{in_pixels(p.u, to.width), in_pixels(p.v, to.height)};
        for (const Number& v : {at.x, at.y, there.x, there.y})
            if (!(v.size() <= ControlMesh::kMaxPosition))
                throw Error(name + ": points[" + std::to_string(i) + "]", brief(rounded(v)),
                            "must stand for at most 1e8 pixels");
        const Vector d{moved(there.x, at.x, to.width, from.width),
                       moved(there.y, at.y, to.height, from.height)};
        if (!(d.x.size() <= 1e11 && d.y.size() <= 1e11))
            throw Error("amount", brief(amount), "it moves a point by more than 1e11 pixels");
        nodes.push_back({at, d});
    }
    return nodes;
}

/// d = origin + dx (x - middle.x) + dy (y - middle.y).
struct Affine {
    Vector middle{}, origin{}, dx{}, dy{};

    Vector operator()(const Vector& p) const {
        return origin + dx * (p.x - middle.x) + dy * (p.y - middle.y);
    }
};

/// The plane through (middle, origin) that fits (place - middle, d - origin) best, weights given; flat where
/// the points lie on a line.
template <class Weight>
void fit_slopes(Affine& plane, const std::vector<Node>& nodes, const std::vector<std::size_t>& which,
                const Weight& weight) {
    // Along the longest difference and across it: near a line, moments of x and y would cancel.
    Vector along{};
    std::size_t farthest = nodes.size();
    for (const std::size_t i : which) {
        const Vector p = nodes[i].at - plane.middle;
        if (!(dot(p, p).value > dot(along, along).value)) continue;
        along = p;
        farthest = i;
    }
    Number aa, ab, bb;
    Vector ad{}, bd{};
    for (const std::size_t i : which) {
        const Vector p = nodes[i].at - plane.middle, d = nodes[i].d - plane.origin;
        const Number w = weight(p), a = dot(along, p), b = i == farthest ? Number(0) : cross(along, p);
        aa += w * a * a;
        ab += w * a * b;
        bb += w * b * b;
        ad = ad + d * (w * a);
        bd = bd + d * (w * b);
    }
    const Number determinant = aa * bb - ab * ab;
    const auto trace = (aa + bb).value;
    if (!(determinant.value > 1e-12 * trace * trace)) return;
    const Vector by_a = (ad * bb - bd * ab) * (Number(1) / determinant),
                 by_b = (bd * aa - ad * ab) * (Number(1) / determinant);
    plane.dx = by_a * along.x - by_b * along.y;
    plane.dy = by_a * along.y + by_b * along.x;
}

Affine best_affine(const std::vector<Node>& nodes) {
    Affine fit;
    std::vector<std::size_t> all(nodes.size());
    const Number count(static_cast<DoubleDouble>(nodes.size()));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        all[i] = i;
        fit.middle = fit.middle + nodes[i].at;
        fit.origin = fit.origin + nodes[i].d;
    }
    fit.middle = {fit.middle.x / count, fit.middle.y / count};
    fit.origin = {fit.origin.x / count, fit.origin.y / count};
    fit_slopes(fit, nodes, all, [](const Vector&) { return Number(1); });
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
        const auto x = static_cast<std::int32_t>(std::lround((nodes[i].x() - cx) * grid)),
                   y = static_cast<std::int32_t>(std::lround((nodes[i].y() - cy) * grid));
        const auto [at, is_new] = taken.try_emplace({x, y}, i);
        if (!is_new)
            throw Error(name + ": points[" + std::to_string(std::min(i, given - 1)) + "]",
                        "[" + brief(nodes[i].x()) + ", " + brief(nodes[i].y()) + "]",
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
            const Number area = cross(b.at - a.at, c.at - a.at);
            // Rounding may leave triangles without an inside.
            if (area.size() < 1e-12 || !(area.size() > area.error)) continue;
            if (area.value > 0)
                triangles.push_back({around[0], around[k - 1], around[k]});
            else
                triangles.push_back({around[0], around[k], around[k - 1]});
        }
    }
    return triangles;
}

/// Makes segments between nodes edges of a triangulation.
class EdgeForcer {
  public:
    EdgeForcer(const std::vector<Node>& nodes, std::vector<Corners>& triangles)
        : m_nodes(nodes), m_triangles(triangles), m_around(nodes.size()) {
        for (std::size_t t = 0; t < triangles.size(); ++t) note(t);
    }

    /// `what` begins what an error says.
    void force(std::size_t a, std::size_t b, const std::string& what) {
        std::deque<Edge> crossing = crossed_by(a, b, what);
        // Each flip of a convex pair takes one away, or turns it; more rounds than this say that there is no end.
        std::size_t left = 64 * (crossing.size() + 4) * (crossing.size() + 4);
        while (!crossing.empty()) {
            if (left-- == 0) throw Error(what + " cannot be an edge: points about it are nearly on a line");
            const Edge edge = crossing.front();
            crossing.pop_front();
            const std::size_t k = opposite(edge.first, edge.second), l = opposite(edge.second, edge.first);
            if (!(side(k, l, edge.first) * side(k, l, edge.second) < 0)) {
                crossing.push_back(edge);
                continue;
            }
            flip(edge.first, edge.second, k, l);
            if (k != a && k != b && l != a && l != b && side(a, b, k) * side(a, b, l) < 0)
                crossing.emplace_back(k, l);
        }
        m_forced.insert(std::minmax(a, b));
    }

  private:
    using Edge = std::pair<std::size_t, std::size_t>;
    static constexpr std::size_t kNone = ~std::size_t{0};

    /// The side of the line from a to b that c is on; 0 where rounding does not tell.
    int side(std::size_t a, std::size_t b, std::size_t c) const {
        const Number area = cross(m_nodes[b].at - m_nodes[a].at, m_nodes[c].at - m_nodes[a].at);
        return !(area.size() > area.error) ? 0 : area.value > 0 ? 1 : -1;
    }
    void note(std::size_t t) {
        const Corners& c = m_triangles[t];
        for (std::size_t k = 0; k < 3; ++k) {
            m_left[{c[k], c[(k + 1) % 3]}] = t;
            m_around[c[k]].push_back(t);
        }
    }
    void forget(std::size_t t) {
        const Corners& c = m_triangles[t];
        for (std::size_t k = 0; k < 3; ++k) {
            m_left.erase({c[k], c[(k + 1) % 3]});
            std::erase(m_around[c[k]], t);
        }
    }
    /// The third corner of the triangle to the left of an edge.
    std::size_t opposite(std::size_t from, std::size_t to) const {
        const auto found = m_left.find({from, to});
        if (found == m_left.end()) return kNone;
        for (const std::size_t corner : m_triangles[found->second])
            if (corner != from && corner != to) return corner;
        return kNone;
    }
    bool has(std::size_t a, std::size_t b) const { return m_left.count({a, b}) || m_left.count({b, a}); }

    /// The edges that the segment from a to b crosses, in their order; from its right to its left.
    std::deque<Edge> crossed_by(std::size_t a, std::size_t b, const std::string& what) const {
        if (has(a, b)) return {};
        const auto expect_off = [&](std::size_t c) {
            if (c != b && side(a, b, c) == 0)
                throw Error(what + " must not go through a point: points[" + std::to_string(c) +
                            "] lies on it");
        };
        std::deque<Edge> edges;
        for (const std::size_t t : m_around[a]) {
            const Corners& c = m_triangles[t];
            const std::size_t k = c[0] == a ? 0 : c[1] == a ? 1 : 2;
            const std::size_t p = c[(k + 1) % 3], q = c[(k + 2) % 3];
            // Counterclockwise from p on the right to q on the left: the segment lies between them.
            if (side(a, b, p) > 0 || side(a, b, q) < 0) continue;
            expect_off(p);
            expect_off(q);
            edges.emplace_back(p, q);
            break;
        }
        while (!edges.empty()) {
            const auto [p, q] = edges.back();
            if (m_forced.count(std::minmax(p, q)))
                throw Error(what + " must not cross the side from point " + std::to_string(p) + " to " +
                            std::to_string(q));
            const std::size_t next = opposite(q, p);
            if (next == b) return edges;
            if (next == kNone) break;
            expect_off(next);
            if (edges.size() > m_triangles.size()) break;
            if (side(a, b, next) < 0)
                edges.emplace_back(next, q);
            else
                edges.emplace_back(p, next);
        }
        throw Error(what + " cannot be an edge: points about it are nearly on a line");
    }
    /// Puts the edge from k to l in place of that from i to j; k is on its left.
    void flip(std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
        const std::size_t s = m_left.at({i, j}), t = m_left.at({j, i});
        forget(s);
        forget(t);
        m_triangles[s] = {i, l, k};
        m_triangles[t] = {l, j, k};
        note(s);
        note(t);
    }

    const std::vector<Node>& m_nodes;
    std::vector<Corners>& m_triangles;
    std::map<Edge, std::size_t> m_left;
    std::vector<std::vector<std::size_t>> m_around;
    std::set<std::pair<std::size_t, std::size_t>> m_forced;
};

/// Makes all sides of the polygons edges.
void force_sides(const ControlPoints& points, const std::vector<Node>& nodes, std::vector<Corners>& triangles,
                 const std::string& name) {
    if (points.polygons.empty()) return;
    EdgeForcer forcer(nodes, triangles);
    std::size_t corners = 0;
    for (std::size_t n = 0; n < points.polygons.size(); ++n) {
        const std::vector<int>& polygon = points.polygons[n];
        const std::string what = name + ": polygons[" + std::to_string(n) + "]";
        if (polygon.size() < 3)
            throw Error(what, std::to_string(polygon.size()) + " corners", "must have at least 3");
        corners += polygon.size();
        if (corners > ControlPoints::kMaxCorners)
            throw Error(name + ": polygons", std::to_string(corners) + " corners",
                        "must have at most " + std::to_string(ControlPoints::kMaxCorners));
        for (const int corner : polygon)
            if (corner < 0 || static_cast<std::size_t>(corner) >= points.pairs.size())
                throw Error(
                    what, std::to_string(corner),
                    "must be numbers of points, from 0 to " + std::to_string(points.pairs.size() - 1));
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const int a = polygon[k], b = polygon[(k + 1) % polygon.size()];
            if (a == b) throw Error(what, std::to_string(a), "must not have one corner twice in a row");
            forcer.force(static_cast<std::size_t>(a), static_cast<std::size_t>(b),
                         what + ": the side from point " + std::to_string(a) + " to " + std::to_string(b));
        }
    }
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
        Affine plane{nodes[i].at, nodes[i].d};
        fit_slopes(plane, nodes, neighbours[i], [](const Vector& p) { return Number(1) / dot(p, p); });
        nodes[i].dx = plane.dx;
        nodes[i].dy = plane.dy;
    }
}

/// A number of a cubic as it is kept: in double, and its error goes to the largest.
double kept(const Number& a, double& largest_error) {
    const Tracked<double> r = a.in_double();
    largest_error = std::max(largest_error, r.error);
    return r.value;
}

/// A triangle of the triangulation, with what its three cubics share. Everything is made of differences of
/// its corners.
struct Element {
    const Node* v[3];
    Number area;  ///< twice it

    Vector difference(std::size_t to, std::size_t from) const { return v[to]->at - v[from]->at; }
    /// The vector from corner k to the middle.
    Vector to_middle(std::size_t k) const {
        return (difference((k + 1) % 3, k) + difference((k + 2) % 3, k)) * (Number(1) / Number(3));
    }
    /// A third of the way from a corner.
    Vector towards(std::size_t k, const Vector& way) const {
        const Node& n = *v[k];
        return n.d + (n.dx * way.x + n.dy * way.y) * (Number(1) / Number(3));
    }
};

/// Corners and barycentric coordinates of the cubic between corners i and j and the middle.
CubicTriangle frame_of(const Element& e, std::size_t i, std::size_t j, const Vector& a, const Vector& b,
                       const Size& image) {
    CubicTriangle p{};
    const Vector to_middle = e.to_middle(i), middle = e.v[i]->at + to_middle;
    p.corner[0] = {e.v[i]->x(), e.v[i]->y()};
    p.corner[1] = {e.v[j]->x(), e.v[j]->y()};
    p.corner[2] = {rounded(middle.x), rounded(middle.y)};
    p.base = {std::floor(std::clamp(p.corner[2].x, 0.0, double(image.width))),
              std::floor(std::clamp(p.corner[2].y, 0.0, double(image.height)))};
    // The coordinates at the base are counted from the nearest corner of the triangle, where the
    // coordinates are (1, 0), (0, 1), or at the one across, (-1, -1).
    const std::size_t k = 3 - i - j;
    const Vector base{Number(p.base.x), Number(p.base.y)};
    const auto distance = [&](std::size_t n) {
        const Vector way = base - e.v[n]->at;
        return dot(way, way).value;
    };
    std::size_t nearest = i;
    for (const std::size_t n : {j, k})
        if (distance(n) < distance(nearest)) nearest = n;
    const Vector way = base - e.v[nearest]->at;
    const Number there[2] = {Number(nearest == i   ? 1
                                    : nearest == k ? -1
                                                   : 0),
                             Number(nearest == j   ? 1
                                    : nearest == k ? -1
                                                   : 0)};
    const Vector slope[2] = {{a.x, b.x}, {a.y, b.y}};
    for (std::size_t n = 0; n < 2; ++n) {
        p.a[n] = kept(slope[n].x, p.slope_error);
        p.b[n] = kept(slope[n].y, p.slope_error);
        p.c[n] = kept(there[n] + dot(slope[n], way), p.c_error);
    }
    return p;
}

/// The three cubics of a triangle.
void add_cubics(const std::vector<Node>& nodes, const Corners& corners, const Size& image,
                std::vector<CubicTriangle>& cubics) {
    Element e{{&nodes[corners[0]], &nodes[corners[1]], &nodes[corners[2]]}, {}};
    e.area = cross(e.difference(1, 0), e.difference(2, 0));
    CubicTriangle parts[3];
    Vector bezier[3][10];
    for (std::size_t k = 0; k < 3; ++k) {
        // Edge from i to j and the middle.
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        const Vector edge = e.difference(j, i), j_sum = edge + e.difference(j, k),
                     i_sum = e.difference(i, j) + e.difference(i, k);
        const Number one_over = Number(1) / e.area;
        const Vector a{j_sum.y * one_over, -i_sum.y * one_over}, b{-j_sum.x * one_over, i_sum.x * one_over};
        parts[k] = frame_of(e, i, j, a, b, image);
        Vector* p = bezier[k];
        p[0] = e.v[i]->d;
        p[1] = e.v[j]->d;
        p[3] = e.towards(i, edge);
        p[4] = e.towards(j, e.difference(i, j));
        p[5] = e.towards(i, e.to_middle(i));
        p[6] = e.towards(j, e.to_middle(j));
        // 111: the derivative across the edge is linear along it, so at its middle the mean of those at its
        // ends: 3/4 (u (300 + 2 210 + 120) + v (210 + 2 120 + 030) + w (201 + 2 111 + 021)), where (u, v, w)
        // is the normal in barycentric coordinates.
        const Vector normal{edge.y, -edge.x};
        const Number u = dot(normal, {a.x, b.x}), w = Number(-3) * dot(edge, edge) * one_over, v = -u - w;
        const Node &ni = *e.v[i], &nj = *e.v[j];
        const Vector wanted = ((ni.dx + nj.dx) * normal.x + (ni.dy + nj.dy) * normal.y) * Number(0.5);
        const Vector along = (p[0] + p[3] * Number(2) + p[4]) * u + (p[3] + p[4] * Number(2) + p[1]) * v;
        p[9] = ((wanted * (Number(4) / Number(3)) - along) * (Number(1) / w) - p[5] - p[6]) * Number(0.5);
    }
    // Across the lines to the middle: each inner point (102 of a corner) is the mean of its neighbours'.
    const Number third = Number(1) / Number(3);
    Vector inner[3];
    for (std::size_t k = 0; k < 3; ++k)
        inner[k] = (bezier[(k + 2) % 3][5] + bezier[(k + 2) % 3][9] + bezier[(k + 1) % 3][9]) * third;
    for (std::size_t k = 0; k < 3; ++k) {
        bezier[k][2] = (inner[0] + inner[1] + inner[2]) * third;
        bezier[k][7] = inner[(k + 1) % 3];
        bezier[k][8] = inner[(k + 2) % 3];
        for (std::size_t n = 0; n < 10; ++n)
            parts[k].bezier[n] = {kept(bezier[k][n].x, parts[k].bezier_error[n]),
                                  kept(bezier[k][n].y, parts[k].bezier_error[n])};
        cubics.push_back(parts[k]);
    }
}

}  // namespace

double CubicTriangle::place_error(const Bounds& box) const {
    const double dx = std::max(std::fabs(box.x0 - base.x), std::fabs(box.x1 - base.x)),
                 dy = std::max(std::fabs(box.y0 - base.y), std::fabs(box.y1 - base.y));
    // Three terms each: two products and two sums.
    double sum = 0;
    for (std::size_t n = 0; n < 2; ++n)
        sum += c_error + slope_error * (dx + dy) +
               4 * 0x1p-53 * (std::fabs(c[n]) + std::fabs(a[n]) * dx + std::fabs(b[n]) * dy);
    return sum;
}

CubicTriangle::Reach CubicTriangle::reach(const Bounds& box) const {
    const double x = 0.5 * (box.x0 + box.x1) - base.x, y = 0.5 * (box.y0 + box.y1) - base.y;
    const double hx = 0.5 * (box.x1 - box.x0), hy = 0.5 * (box.y1 - box.y0);
    const auto most = [&](double constant, double p, double q) {
        return std::fabs(constant + p * x + q * y) + std::fabs(p) * hx + std::fabs(q) * hy;
    };
    const double error = place_error(box);
    return {most(c[0], a[0], b[0]) + error, most(c[1], a[1], b[1]) + error,
            most(1 - c[0] - c[1], -a[0] - a[1], -b[0] - b[1]) + 2 * error};
}

CubicTriangle::Terms CubicTriangle::terms(const Reach& reach) const {
    const auto& [u, v, w] = reach;
    const double weight[10] = {u * u * u,     v * v * v,     w * w * w,     3 * u * u * v, 3 * u * v * v,
                               3 * u * u * w, 3 * v * v * w, 3 * u * w * w, 3 * v * w * w, 6 * u * v * w};
    Terms terms{0, 0, 0};
    double x = 0, y = 0;
    for (std::size_t i = 0; i < 10; ++i) {
        x += weight[i] * std::fabs(bezier[i].x);
        y += weight[i] * std::fabs(bezier[i].y);
        terms.error += weight[i] * bezier_error[i];
    }
    terms.value = std::max(x, y);
    // A derivative is three times the quadratic of differences of Bezier points.
    const double quadratic[6] = {u * u, v * v, w * w, 2 * u * v, 2 * u * w, 2 * v * w};
    constexpr std::size_t kFirst[6] = {0, 4, 7, 3, 5, 9}, kSecond[6] = {3, 1, 8, 4, 9, 6},
                          kThird[6] = {5, 6, 2, 9, 7, 8};
    const auto slope = [&](const std::size_t(&of)[6], double Point<double>::*part) {
        double sum = 0;
        for (std::size_t i = 0; i < 6; ++i)
            sum += 3 * quadratic[i] * std::fabs(bezier[of[i]].*part - bezier[kThird[i]].*part);
        return sum;
    };
    for (const auto part : {&Point<double>::x, &Point<double>::y})
        terms.slope = std::max({terms.slope, slope(kFirst, part), slope(kSecond, part)});
    return terms;
}

double CubicTriangle::inside(double x, double y) const {
    const double dx = x - base.x, dy = y - base.y;
    const double u = dx * a[0] + dy * b[0] + c[0], v = dx * a[1] + dy * b[1] + c[1];
    return std::min({u, v, 1 - u - v});
}

Bounds CubicTriangle::bounds() const {
    Bounds all{corner[0].x, corner[0].y, corner[0].x, corner[0].y};
    for (const Point<double>& p : corner) all.add({p.x, p.y, p.x, p.y});
    return all;
}

bool CubicTriangle::meets(const Bounds& box) const {
    if (!bounds().meets(box)) return false;
    // Where the whole rectangle is on the far side of an edge, a barycentric coordinate is negative on it.
    const double x = 0.5 * (box.x0 + box.x1) - base.x, y = 0.5 * (box.y0 + box.y1) - base.y;
    const double hx = 0.5 * (box.x1 - box.x0), hy = 0.5 * (box.y1 - box.y0);
    const double margin = 1e-9 + 2 * place_error(box);
    const auto beyond = [&](double p, double q, double constant) {
        return constant + p * x + q * y + std::fabs(p) * hx + std::fabs(q) * hy < -margin;
    };
    return !beyond(a[0], b[0], c[0]) && !beyond(a[1], b[1], c[1]) &&
           !beyond(-a[0] - a[1], -b[0] - b[1], 1 - c[0] - c[1]);
}

Scattered::Scattered(const ControlPoints& points, const Size& from, const Size& to, double amount,
                     const std::string& name)
    : m_from(from), m_to(to) {
    if (!std::isfinite(amount)) throw Error("amount", brief(amount), "must be a finite number");
    m_scale = {static_cast<double>(to.width) / from.width, static_cast<double>(to.height) / from.height};
    std::vector<Node> nodes = nodes_of(points, from, to, amount, name);
    const std::size_t given = nodes.size();

    // Four further points, far outside, on the best affine map.
    const Affine affine = best_affine(nodes);
    const Size& beyond = points.overscan;
    const Bounds picture{0, 0, double(from.width), double(from.height)};
    Bounds box{double(beyond.width), double(beyond.height), double(from.width - beyond.width),
               double(from.height - beyond.height)};
    for (const Node& n : nodes) box.add({n.x(), n.y(), n.x(), n.y()});
    const double w = box.x1 - box.x0, h = box.y1 - box.y0;
    box = {box.x0 - w, box.y0 - h, box.x1 + w, box.y1 + h};
    box.add(picture);
    for (const double x : {box.x0, box.x1})
        for (const double y : {box.y0, box.y1}) {
            const Vector at{Number(x), Number(y)};
            nodes.push_back({at, affine(at), affine.dx, affine.dy});
        }
    const double x_x = m_scale.x + rounded(affine.dx.x), y_y = m_scale.y + rounded(affine.dy.y);
    m_orientation = x_x * y_y - rounded(affine.dx.y) * rounded(affine.dy.x) < 0 ? -1 : 1;

    std::vector<Corners> triangles = triangulate(nodes, given, box, name);
    force_sides(points, nodes, triangles, name);
    set_gradients(nodes, given, triangles);
    m_triangles.reserve(3 * triangles.size());
    for (const Corners& t : triangles) add_cubics(nodes, t, from, m_triangles);
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
