// SPDX-License-Identifier: Apache-2.0
// The maps of meshes and points, written out in long double from what was given: shares no formula with the
// code that it tests.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "anamorph/mesh/mesh.h"
#include "anamorph/mesh/scattered.h"

namespace anamorph::test {

using Real = long double;
using RealPoint = Point<Real>;

/// The map of a mesh of one level: Catmull-Rom slopes of what vertices are moved by, Hermite's cubics both
/// ways.
class MeshOracle {
  public:
    MeshOracle(const ControlMesh& mesh, const Size& from, const Size& to, double amount)
        : m_sx(Real(to.width) / from.width), m_sy(Real(to.height) / from.height) {
        m_x = lines(mesh.x_lines, mesh.columns, from.width, mesh.units);
        m_y = lines(mesh.y_lines, mesh.rows, from.height, mesh.units);
        for (int r = 0; r <= mesh.rows; ++r) {
            m_d.emplace_back();
            for (int c = 0; c <= mesh.columns; ++c) {
                const Point<double>& v = mesh.vertices[static_cast<std::size_t>(r * (mesh.columns + 1) + c)];
                const bool pixels = mesh.units == Units::pixels;
                m_d.back().push_back(
                    {amount * (v.x * Real(pixels ? 1 : to.width) - m_x[std::size_t(c)] * m_sx),
                     amount * (v.y * Real(pixels ? 1 : to.height) - m_y[std::size_t(r)] * m_sy)});
            }
        }
        extend(from);
    }

    RealPoint operator()(Real x, Real y) const { return on(below(m_x, x), below(m_y, y), x, y); }

    std::size_t columns() const { return m_x.size() - 1; }
    std::size_t rows() const { return m_y.size() - 1; }
    const std::vector<Real>& x_lines() const { return m_x; }
    const std::vector<Real>& y_lines() const { return m_y; }
    /// The map on one cell.
    RealPoint on(std::size_t i, std::size_t j, Real x, Real y) const {
        const Real w = m_x[i + 1] - m_x[i], h = m_y[j + 1] - m_y[j], s = (x - m_x[i]) / w,
                   t = (y - m_y[j]) / h;
        const auto hermite = [](Real p0, Real p1, Real m0, Real m1, Real k) {
            return p0 + k * (m0 + k * ((3 * (p1 - p0) - 2 * m0 - m1) + k * (2 * (p0 - p1) + m0 + m1)));
        };
        const auto along = [&](std::size_t row, bool slope, auto part) {
            return hermite(value(i, row, false, slope, part), value(i + 1, row, false, slope, part),
                           value(i, row, true, slope, part) * w, value(i + 1, row, true, slope, part) * w, s);
        };
        const auto coordinate = [&](auto part) {
            return hermite(along(j, false, part), along(j + 1, false, part), along(j, true, part) * h,
                           along(j + 1, true, part) * h, t);
        };
        return {x * m_sx + coordinate(&RealPoint::x), y * m_sy + coordinate(&RealPoint::y)};
    }

  private:
    static std::vector<Real> lines(const std::vector<double>& given, int cells, int size, Units units) {
        std::vector<Real> at;
        for (int i = 0; i <= cells; ++i)
            at.push_back(given.empty() ? Real(size) * i / cells
                                       : given[std::size_t(i)] * Real(units == Units::pixels ? 1 : size));
        return at;
    }
    void extend(const Size& from) {
        const auto beyond = [](const RealPoint& a, const RealPoint& b, Real k) {
            return RealPoint{a.x + (a.x - b.x) * k, a.y + (a.y - b.y) * k};
        };
        const auto columns = [&](bool front, Real at) {
            const std::size_t n = m_x.size(), e = front ? 0 : n - 1, in = front ? 1 : n - 2;
            const Real k = (at - m_x[e]) / (m_x[e] - m_x[in]);
            for (auto& row : m_d) row.insert(front ? row.begin() : row.end(), beyond(row[e], row[in], k));
            m_x.insert(front ? m_x.begin() : m_x.end(), at);
        };
        if (m_x.front() > 0) columns(true, 0);
        if (m_x.back() < from.width) columns(false, from.width);
        const auto rows = [&](bool front, Real at) {
            const std::size_t n = m_y.size(), e = front ? 0 : n - 1, in = front ? 1 : n - 2;
            const Real k = (at - m_y[e]) / (m_y[e] - m_y[in]);
            std::vector<RealPoint> row;
            for (std::size_t c = 0; c < m_x.size(); ++c) row.push_back(beyond(m_d[e][c], m_d[in][c], k));
            m_d.insert(front ? m_d.begin() : m_d.end(), row);
            m_y.insert(front ? m_y.begin() : m_y.end(), at);
        };
        if (m_y.front() > 0) rows(true, 0);
        if (m_y.back() < from.height) rows(false, from.height);
    }
    static std::size_t below(const std::vector<Real>& at, Real x) {
        std::size_t i = 0;
        while (i + 2 < at.size() && at[i + 1] <= x) ++i;
        return i;
    }
    template <class Part>
    Real value(std::size_t i, std::size_t j, bool slope_x, bool slope_y, Part part) const {
        if (slope_x) {
            const std::size_t a = i ? i - 1 : 0, b = std::min(i + 1, m_x.size() - 1);
            return (value(b, j, false, slope_y, part) - value(a, j, false, slope_y, part)) /
                   (m_x[b] - m_x[a]);
        }
        if (!slope_y) return m_d[j][i].*part;
        const std::size_t a = j ? j - 1 : 0, b = std::min(j + 1, m_y.size() - 1);
        return (m_d[b][i].*part - m_d[a][i].*part) / (m_y[b] - m_y[a]);
    }

    Real m_sx, m_sy;
    std::vector<Real> m_x, m_y;
    std::vector<std::vector<RealPoint>> m_d;
};

/// The source points of a mesh that pushes: Newton's method from many places in each cell.
class PushOracle {
  public:
    struct Root {
        RealPoint at;
        bool turned;
        std::size_t cell;
        Real slope;  ///< the Jacobian's determinant: near 0 by a fold
    };

    PushOracle(const MeshOracle& mesh, double orientation) : m_mesh(mesh), m_orientation(orientation) {}

    /// Finds all source points, the one that is drawn first.
    std::vector<Root> roots(Real x, Real y) const {
        std::vector<Root> found;
        for (std::size_t j = 0; j < m_mesh.rows(); ++j)
            for (std::size_t i = 0; i < m_mesh.columns(); ++i)
                for (int k = 0; k < kStarts * kStarts; ++k) try_from(i, j, k, x, y, found);
        std::stable_sort(found.begin(), found.end(), [](const Root& a, const Root& b) {
            if (a.turned != b.turned) return b.turned;
            if (a.cell != b.cell) return a.cell > b.cell;
            return a.at.y != b.at.y ? a.at.y > b.at.y : a.at.x > b.at.x;
        });
        return found;
    }

  private:
    static constexpr int kStarts = 5;

    void try_from(std::size_t i, std::size_t j, int k, Real x, Real y, std::vector<Root>& found) const {
        const Real x0 = m_mesh.x_lines()[i], w = m_mesh.x_lines()[i + 1] - x0, y0 = m_mesh.y_lines()[j],
                   h = m_mesh.y_lines()[j + 1] - y0, step = 1e-7L;
        Real s = (k % kStarts + Real(0.5)) / kStarts, t = (k / kStarts + Real(0.5)) / kStarts, det = 0;
        const auto at = [&](Real a, Real b) { return m_mesh.on(i, j, x0 + a * w, y0 + b * h); };
        for (int n = 0; n < 40; ++n) {
            const RealPoint f = at(s, t), a = at(s + step, t), b = at(s - step, t), c = at(s, t + step),
                            d = at(s, t - step);
            const Real xs = (a.x - b.x) / (2 * step), ys = (a.y - b.y) / (2 * step),
                       xt = (c.x - d.x) / (2 * step), yt = (c.y - d.y) / (2 * step);
            det = xs * yt - xt * ys;
            const Real ds = (yt * (x - f.x) - xt * (y - f.y)) / det,
                       dt = (xs * (y - f.y) - ys * (x - f.x)) / det;
            if (!(std::fabs(ds) < 3 && std::fabs(dt) < 3)) return;
            s += ds;
            t += dt;
            if (std::max(std::fabs(ds), std::fabs(dt)) < 1e-17L) break;
        }
        const Real hair = 1e-12L;
        const RealPoint f = at(s, t);
        if (!(std::hypot(f.x - x, f.y - y) < 1e-11L && s > -hair && s < 1 + hair && t > -hair &&
              t < 1 + hair))
            return;
        const Root root{
            {x0 + s * w, y0 + t * h}, det * m_orientation < 0, j * m_mesh.columns() + i, det / (w * h)};
        for (const Root& other : found)
            if (std::hypot(other.at.x - root.at.x, other.at.y - root.at.y) < 1e-9L) return;
        found.push_back(root);
    }

    const MeshOracle& m_mesh;
    double m_orientation;
};

/// The map of points in pixels: which of them make triangles is the map's, all else is computed here.
class PointsOracle {
  public:
    PointsOracle(const ControlPoints& points, const Scattered& map, const Size& from, const Size& to)
        : m_sx(Real(to.width) / from.width), m_sy(Real(to.height) / from.height) {
        std::map<std::pair<double, double>, int> known;
        for (const ControlPoints::Pair& p : points.pairs) {
            known[{p.x, p.y}] = int(m_nodes.size());
            m_nodes.push_back({p.x, p.y, {p.u - p.x * m_sx, p.v - p.y * m_sy}});
        }
        const std::size_t given = m_nodes.size();
        const auto number = [&](const Point<double>& at) {
            const auto [found, is_new] = known.try_emplace({at.x, at.y}, int(m_nodes.size()));
            if (is_new) m_nodes.push_back({at.x, at.y, {}});
            return found->second;
        };
        const std::vector<CubicTriangle>& cubics = map.triangles();
        for (std::size_t i = 0; i < cubics.size(); i += 3)
            m_triangles.push_back(
                {number(cubics[i + 1].corner[1]), number(cubics[i].corner[0]), number(cubics[i].corner[1])});
        far_points(given);
        gradients(given);
    }

    RealPoint operator()(Real x, Real y) const {
        const Triangle* best = nullptr;
        std::array<Real, 3> at{};
        Real most = -HUGE_VALL;
        for (const Triangle& t : m_triangles) {
            const std::array<Real, 3> b = barycentric(t, x, y);
            const Real inside = std::min({b[0], b[1], b[2]});
            if (inside > most) {
                most = inside;
                best = &t;
                at = b;
            }
        }
        const RealPoint d{evaluate(*best, at, &RealPoint::x), evaluate(*best, at, &RealPoint::y)};
        return {x * m_sx + d.x, y * m_sy + d.y};
    }

  private:
    struct Node {
        Real x, y;
        RealPoint d, gx{0, 0}, gy{0, 0};
    };
    using Triangle = std::array<int, 3>;

    const Node& node(int i) const { return m_nodes[std::size_t(i)]; }

    std::array<Real, 3> barycentric(const Triangle& t, Real x, Real y) const {
        const Node &a = node(t[0]), &b = node(t[1]), &c = node(t[2]);
        const auto twice = [](Real px, Real py, Real qx, Real qy) { return px * qy - py * qx; };
        const Real all = twice(b.x - a.x, b.y - a.y, c.x - a.x, c.y - a.y);
        const Real u = twice(b.x - x, b.y - y, c.x - x, c.y - y) / all,
                   v = twice(c.x - x, c.y - y, a.x - x, a.y - y) / all;
        return {u, v, 1 - u - v};
    }

    /// The plane through (x, y, d) closest to some nodes, by two steps of Gram and Schmidt.
    void fit(Real x, Real y, const RealPoint& d, const std::vector<int>& which, bool weighted, RealPoint& gx,
             RealPoint& gy) const {
        std::vector<std::array<Real, 4>> rows;
        Real xx = 0, yy = 0, xy = 0;
        for (const int i : which) {
            const Node& n = node(i);
            Real px = n.x - x, py = n.y - y;
            const Real k = weighted ? 1 / std::hypot(px, py) : 1;
            rows.push_back({px * k, py * k, (n.d.x - d.x) * k, (n.d.y - d.y) * k});
            xx += rows.back()[0] * rows.back()[0];
            yy += rows.back()[1] * rows.back()[1];
        }
        const bool swap = yy > xx;
        const std::size_t p = swap ? 1 : 0, q = 1 - p;
        const Real pp = swap ? yy : xx;
        for (const auto& r : rows) xy += r[p] * r[q];
        const Real share = pp > 0 ? xy / pp : 0;
        Real rest = 0;
        for (const auto& r : rows) rest += (r[q] - share * r[p]) * (r[q] - share * r[p]);
        if (!(rest * pp > 1e-12L * (xx + yy) * (xx + yy))) return;
        for (std::size_t c = 2; c < 4; ++c) {
            Real across = 0, along = 0;
            for (const auto& r : rows) across += (r[q] - share * r[p]) * r[c];
            across /= rest;
            for (const auto& r : rows) along += r[p] * (r[c] - across * r[q]);
            along /= pp;
            (c == 2 ? (swap ? gy : gx).x : (swap ? gy : gx).y) = along;
            (c == 2 ? (swap ? gx : gy).x : (swap ? gx : gy).y) = across;
        }
    }

    void far_points(std::size_t given) {
        Real x = 0, y = 0;
        RealPoint d{0, 0}, gx{0, 0}, gy{0, 0};
        std::vector<int> all;
        for (std::size_t i = 0; i < given; ++i) {
            x += m_nodes[i].x / given;
            y += m_nodes[i].y / given;
            d = {d.x + m_nodes[i].d.x / given, d.y + m_nodes[i].d.y / given};
            all.push_back(int(i));
        }
        fit(x, y, d, all, false, gx, gy);
        for (std::size_t i = given; i < m_nodes.size(); ++i) {
            Node& n = m_nodes[i];
            n.d = {d.x + gx.x * (n.x - x) + gy.x * (n.y - y), d.y + gx.y * (n.x - x) + gy.y * (n.y - y)};
            n.gx = gx;
            n.gy = gy;
        }
    }
    void gradients(std::size_t given) {
        for (std::size_t i = 0; i < given; ++i) {
            std::vector<int> around;
            for (const Triangle& t : m_triangles)
                for (const int a : t)
                    for (const int b : t)
                        if (a == int(i) && b != a) around.push_back(b);
            std::sort(around.begin(), around.end());
            around.erase(std::unique(around.begin(), around.end()), around.end());
            Node& n = m_nodes[i];
            fit(n.x, n.y, n.d, around, true, n.gx, n.gy);
        }
    }

    /// Clough and Tocher's element by de Casteljau's construction on the part opposite the least coordinate.
    template <class Part>
    Real evaluate(const Triangle& t, const std::array<Real, 3>& at, Part part) const {
        const Node* n[3] = {&node(t[0]), &node(t[1]), &node(t[2])};
        const Real mx = (n[0]->x + n[1]->x + n[2]->x) / 3, my = (n[0]->y + n[1]->y + n[2]->y) / 3;
        const auto slope = [&](int i, Real dx, Real dy) { return n[i]->gx.*part * dx + n[i]->gy.*part * dy; };
        Real to_middle[3], beside[3], inner[3];
        for (int i = 0; i < 3; ++i) to_middle[i] = n[i]->d.*part + slope(i, mx - n[i]->x, my - n[i]->y) / 3;
        Real edge[3][2];  // of the side opposite k: next to its first and second end
        for (int k = 0; k < 3; ++k) {
            const int i = (k + 1) % 3, j = (k + 2) % 3;
            const Real ex = n[j]->x - n[i]->x, ey = n[j]->y - n[i]->y;
            edge[k][0] = n[i]->d.*part + slope(i, ex, ey) / 3;
            edge[k][1] = n[j]->d.*part - slope(j, ex, ey) / 3;
            // From the side's middle to the centre, as a part along the side and one across it: across, the
            // derivative there is the mean of the ends'.
            const Real hx = mx - (n[i]->x + n[j]->x) / 2, hy = my - (n[i]->y + n[j]->y) / 2;
            const Real along = (hx * ex + hy * ey) / (ex * ex + ey * ey), ax = hx - along * ex,
                       ay = hy - along * ey;
            const Real across = (slope(i, ax, ay) + slope(j, ax, ay)) / 2;
            // Along the side, in the middle of its cubic.
            const Real run = Real(3) / 4 * (n[j]->d.*part + edge[k][1] - edge[k][0] - n[i]->d.*part);
            // The derivative towards the centre: 3 (second row - first row) in quadratic weights 1/4, 1/2,
            // 1/4, where the first row's points are means of neighbours on the side.
            const Real first = ((n[i]->d.*part + edge[k][0]) / 2 + (edge[k][0] + edge[k][1]) +
                                (edge[k][1] + n[j]->d.*part) / 2) /
                               4;
            beside[k] = ((across + along * run) / 3 + first) * 2 - (to_middle[i] + to_middle[j]) / 2;
        }
        for (int k = 0; k < 3; ++k) inner[k] = (to_middle[k] + beside[(k + 1) % 3] + beside[(k + 2) % 3]) / 3;
        const Real centre = (inner[0] + inner[1] + inner[2]) / 3;
        const int k = int(std::min_element(at.begin(), at.end()) - at.begin()), i = (k + 1) % 3,
                  j = (k + 2) % 3;
        // In the part of corners i, j and the centre.
        const Real w = 3 * at[std::size_t(k)], u = at[std::size_t(i)] - at[std::size_t(k)],
                   v = at[std::size_t(j)] - at[std::size_t(k)];
        const auto step = [&](Real a, Real b, Real c) { return u * a + v * b + w * c; };
        const Real uu =
            step(step(n[i]->d.*part, edge[k][0], to_middle[i]), step(edge[k][0], edge[k][1], beside[k]),
                 step(to_middle[i], beside[k], inner[i]));
        const Real vv =
            step(step(edge[k][0], edge[k][1], beside[k]), step(edge[k][1], n[j]->d.*part, to_middle[j]),
                 step(beside[k], to_middle[j], inner[j]));
        const Real ww = step(step(to_middle[i], beside[k], inner[i]), step(beside[k], to_middle[j], inner[j]),
                             step(inner[i], inner[j], centre));
        return step(uu, vv, ww);
    }

    Real m_sx, m_sy;
    std::vector<Node> m_nodes;
    std::vector<Triangle> m_triangles;
};

}  // namespace anamorph::test
