// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline_loops.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <unordered_map>

namespace anamorph {
namespace {

using Triangle = std::array<int, 3>;

// Near-coincident bodies meet everywhere: what is then left of the curve is cut short.
constexpr std::size_t kMostCells = 40000;
constexpr int kMostLevels = 40, kMostHalvings = 16;

std::uint64_t edge_key(int a, int b) {
    const auto low = static_cast<std::uint64_t>(std::min(a, b)),
               high = static_cast<std::uint64_t>(std::max(a, b));
    return high << 32 | low;
}

using Tolerance = std::function<bool(const glm::dvec3&, double, double)>;

/// A bound of the curve's curvature within `radius` of u. In the sphere it is |t.H t| / |grad f| along the
/// curve's tangent t, with f = |B u + b|^2 - 1 and H = 2 B^T B - (u.grad f); the sphere's own is 1.
struct Bend {
    bool known = false;  ///< the curve's direction changes by less than 30 degrees
    double curvature = 0;

    Bend(const SphereCurve& curve, const glm::dvec3& u, double radius) {
        double square_norm = 0;
        for (int k = 0; k < 3; ++k) square_norm += glm::dot(curve.matrix[k], curve.matrix[k]);
        const glm::dvec3 gradient = 2.0 * ((curve.matrix * u + curve.offset) * curve.matrix);
        const double across = glm::dot(gradient, u);
        const glm::dvec3 in_sphere = gradient - u * across;
        const double along = glm::length(in_sphere);
        // How much the gradient, the tangent's direction and H change over the radius.
        const double change = (2 * square_norm * (1 + radius) + std::fabs(across) + along * radius) * radius;
        known = change <= 0.5 * along;
        if (!known) return;
        const glm::dvec3 bent = curve.matrix * (glm::cross(u, in_sphere) / along);
        const double in_cell = std::fabs(2 * glm::dot(bent, bent) - across) +
                               2 * (change / along) * (2 * square_norm + std::fabs(across)) + change;
        curvature = std::hypot(in_cell / (along - change), 1.0);
    }
};

/// Adds points between p and q, on the curve and not q, until its chords hold. Between them the curve is at
/// most twice as long as the chord, as its direction changes by less than 60 degrees; a curve with curvature
/// k is at most k l^2 / 8 from a chord of length l, 1.2 times that where its direction changes so much.
void add_between(const SphereCurve& curve, const glm::dvec3& p, const glm::dvec3& q, const Tolerance& holds,
                 int depth, std::vector<glm::dvec3>& points) {
    const double length = glm::distance(p, q);
    const glm::dvec3 middle = glm::normalize(p + q);
    const Bend bend(curve, middle, 1.5 * length);
    const double deviation = bend.known ? 1.2 * bend.curvature * length * length / 8 : length;
    if (depth == 0 || !(length > 0) || holds(middle, length, deviation)) return;
    // Across the chord, in the sphere, to the curve.
    const glm::dvec3 across = glm::cross(middle, (q - p) / length);
    glm::dvec3 u = middle;
    double moved = 0;
    for (int k = 0; k < 12; ++k) {
        const glm::dvec3 v = curve.matrix * u + curve.offset;
        const double step = -(glm::dot(v, v) - 1) / (2 * glm::dot(v, curve.matrix * across));
        if (!(std::fabs(moved + step) < length)) return;
        moved += step;
        u = glm::normalize(middle + across * moved);
        if (std::fabs(step) < 0x1p-50) break;
    }
    add_between(curve, p, u, holds, depth - 1, points);
    points.push_back(u);
    add_between(curve, u, q, holds, depth - 1, points);
}

/// Cells on the sphere, all of one size, that the curve may pass through: refined together, so that
/// neighbours always share whole edges.
class Cells {
  public:
    explicit Cells(const SphereCurve& curve) : m_curve(curve) {
        double square = 0;
        for (int k = 0; k < 3; ++k) square += glm::dot(curve.matrix[k], curve.matrix[k]);
        m_square_norm = square;
        // An icosahedron, turned so that no corner lies on an axis or in a plane of symmetry.
        const double phi = 0.5 * (1 + std::sqrt(5.0));
        const glm::dvec3 x = glm::normalize(glm::dvec3(0.613, 0.257, 0.747)),
                         y = glm::normalize(glm::cross(x, glm::dvec3(0.113, 0.883, -0.456))),
                         z = glm::cross(x, y);
        const glm::dmat3 turn(x, y, z);
        for (const double one : {-1.0, 1.0})
            for (const double far : {-phi, phi})
                for (const glm::dvec3& p :
                     {glm::dvec3(0, one, far), glm::dvec3(one, far, 0), glm::dvec3(far, 0, one)})
                    add_corner(turn * p);
        // Its faces: the corners that are an edge (2 of its units) apart from each other.
        const double edge = 2 / std::sqrt(phi * phi + 1) * 1.01;
        const int count = static_cast<int>(m_corners.size());
        const auto joined = [&](int a, int b) { return glm::distance(corner(a), corner(b)) < edge; };
        for (int a = 0; a < count; ++a)
            for (int b = a + 1; b < count; ++b)
                for (int c = b + 1; c < count; ++c)
                    if (joined(a, b) && joined(b, c) && joined(a, c)) m_cells.push_back({a, b, c});
    }

    bool coincides() const {
        return std::all_of(m_values.begin(), m_values.end(),
                           [&](double v) { return std::fabs(v) <= m_curve.noise; });
    }

    /// Halves all cells; those that the curve cannot pass through are dropped.
    void refine() {
        std::vector<Triangle> finer;
        m_middles.clear();
        for (const auto& [a, b, c] : m_cells) {
            const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            for (const Triangle& t : {Triangle{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}})
                if (may_meet(t)) finer.push_back(t);
        }
        m_cells = std::move(finer);
    }

    /// Does the curve cross each cell in one direction, or is the cell so small that it does not matter?
    bool clear(const Tolerance& holds) const {
        return std::all_of(m_cells.begin(), m_cells.end(), [&](const Triangle& t) {
            const Cell cell(*this, t);
            return Bend(m_curve, cell.middle, cell.radius).known ||
                   holds(cell.middle, cell.radius, cell.radius);
        });
    }

    std::size_t count() const { return m_cells.size(); }

    std::vector<std::vector<glm::dvec3>> loops() const {
        // Every cell with both signs has one chord, between two of its edges.
        std::unordered_map<std::uint64_t, std::array<std::uint64_t, 2>> next;
        std::vector<std::uint64_t> order;
        const auto link = [&](std::uint64_t from, std::uint64_t to) {
            const auto [it, fresh] = next.try_emplace(from, std::array{to, to});
            if (fresh)
                order.push_back(from);
            else
                it->second[1] = to;
        };
        for (const Triangle& t : m_cells) {
            std::uint64_t cut[2];
            int cuts = 0;
            for (int k = 0; k < 3; ++k) {
                const int a = t[static_cast<std::size_t>(k)], b = t[static_cast<std::size_t>((k + 1) % 3)];
                if (inside(a) != inside(b)) cut[cuts++] = edge_key(a, b);
            }
            if (cuts == 2) {
                link(cut[0], cut[1]);
                link(cut[1], cut[0]);
            }
        }
        std::vector<std::vector<glm::dvec3>> all;
        for (const std::uint64_t start : order) {
            if (!next.count(start)) continue;
            std::vector<glm::dvec3> loop;
            std::uint64_t at = start;
            for (auto it = next.find(at); it != next.end(); it = next.find(at)) {
                loop.push_back(crossing(at));
                const auto [one, other] = it->second;
                next.erase(it);
                at = next.count(one) ? one : other;
            }
            if (loop.size() > 2) all.push_back(std::move(loop));
        }
        return all;
    }

  private:
    struct Cell {
        glm::dvec3 middle;
        double radius;

        Cell(const Cells& cells, const Triangle& t)
            : middle(glm::normalize(cells.corner(t[0]) + cells.corner(t[1]) + cells.corner(t[2]))),
              radius(0) {
            for (const int k : t) radius = std::max(radius, glm::distance(middle, cells.corner(k)));
        }
    };

    const glm::dvec3& corner(int i) const { return m_corners[static_cast<std::size_t>(i)]; }
    bool inside(int i) const { return m_values[static_cast<std::size_t>(i)] < -m_curve.noise; }

    int add_corner(const glm::dvec3& p) {
        m_corners.push_back(glm::normalize(p));
        m_values.push_back(m_curve.at(m_corners.back()));
        return static_cast<int>(m_corners.size()) - 1;
    }
    int middle(int a, int b) {
        const auto [it, fresh] = m_middles.try_emplace(edge_key(a, b), 0);
        if (fresh) it->second = add_corner(corner(a) + corner(b));
        return it->second;
    }

    /// Of f = |B u + b|^2 - 1: its gradient in the sphere, the part across it, and |B|^2.
    struct Slope {
        double along, across;
    };
    Slope slope(const glm::dvec3& u) const {
        const glm::dvec3 gradient = 2.0 * ((m_curve.matrix * u + m_curve.offset) * m_curve.matrix);
        const double across = glm::dot(gradient, u);
        return {glm::length(gradient - u * across), std::fabs(across)};
    }

    /// f(u) = f(m) + grad.(u - m) + |B (u - m)|^2, and u - m has -|u - m|^2 / 2 along m.
    bool may_meet(const Triangle& t) const {
        const Cell cell(*this, t);
        const auto [along, across] = slope(cell.middle);
        const double r = cell.radius * (1 + 0x1p-40);
        return std::fabs(m_curve.at(cell.middle)) <=
               along * r + (0.5 * across + m_square_norm) * r * r + 2 * m_curve.noise;
    }

    /// The root on the great circle from corner a to corner b, whose signs differ.
    glm::dvec3 crossing(std::uint64_t edge) const {
        int a = static_cast<int>(edge & 0xffffffffu), b = static_cast<int>(edge >> 32);
        if (inside(b)) std::swap(a, b);
        const glm::dvec3 p = corner(a), step = corner(b) - p;
        const double enough = 0x1p-50 / glm::length(step);
        double low = 0, high = 1, s = 0.5;
        for (int k = 0; k < 160 && high - low > enough; ++k) {
            const glm::dvec3 q = p + step * s, u = glm::normalize(q), v = m_curve.matrix * u + m_curve.offset;
            const double f = glm::dot(v, v) - 1;
            if (std::fabs(f) <= m_curve.noise * 0x1p-5) break;
            (f < -m_curve.noise ? low : high) = s;
            const glm::dvec3 turn = (step - u * glm::dot(u, step)) / glm::length(q);
            const double next = s - f / (2 * glm::dot(v, m_curve.matrix * turn));
            if (std::fabs(next - s) < enough) break;
            // Far from the root Newton's method creeps: every third step halves.
            s = k % 3 < 2 && next > low && next < high ? next : 0.5 * (low + high);
        }
        return glm::normalize(p + step * s);
    }

    const SphereCurve& m_curve;
    double m_square_norm = 0;
    std::vector<glm::dvec3> m_corners;
    std::vector<double> m_values;
    std::vector<Triangle> m_cells;
    std::unordered_map<std::uint64_t, int> m_middles;
};

}  // namespace

std::vector<std::vector<glm::dvec3>> loops_of(const SphereCurve& curve, const Tolerance& holds) {
    Cells cells(curve);
    if (cells.coincides()) return {};
    cells.refine();
    for (int level = 1; level < kMostLevels && cells.count() > 0 && cells.count() < kMostCells; ++level) {
        if (cells.clear(holds)) break;
        cells.refine();
    }
    std::vector<std::vector<glm::dvec3>> loops;
    for (const std::vector<glm::dvec3>& coarse : cells.loops()) {
        std::vector<glm::dvec3>& loop = loops.emplace_back();
        for (std::size_t k = 0; k < coarse.size(); ++k) {
            loop.push_back(coarse[k]);
            add_between(curve, coarse[k], coarse[(k + 1) % coarse.size()], holds, kMostHalvings, loop);
        }
    }
    return loops;
}

}  // namespace anamorph
