// SPDX-License-Identifier: Apache-2.0
#include "anamorph/approx/mesh_scattered.h"

#include "anamorph/approx/block_writer.h"
#include "anamorph/approx/hermite.h"

namespace anamorph {
namespace {

/// The pixel centres of a block.
struct Centres {
    Part across, down;

    explicit Centres(const Box& box)
        : across{0.5 * (box.x0 + box.x1), half(box.width())},
          down{0.5 * (box.y0 + box.y1), half(box.height())} {}
};

/// A cubic's map in powers of a block's parameters.
Bicubic on(const Scattered& map, const CubicTriangle& triangle, const Centres& at) {
    using J = Jet<double, 3>;
    const Point<J> p = map.at(triangle, J::variable(at.across.middle, at.across.half, 0),
                              J::variable(at.down.middle, 0, at.down.half));
    Bicubic f{};
    for (int i = 0; i < 4; ++i)
        for (int j = 0; i + j < 4; ++j) {
            f.x[i][j] = p.x.at(i, j);
            f.y[i][j] = p.y.at(i, j);
        }
    return f;
}

/// Plans one region.
class Planner {
  public:
    Planner(const Scattered& map, double tol, Blocks& blocks) : m_map(map), m_writer(tol, blocks) {}

    void exact(const Box& box) {
        BlockWriter::for_blocks(box, [&](const Box& b) { m_writer.exact(b); });
    }
    void region(const Box& box) {
        BlockWriter::for_blocks(box, [&](const Box& b) { place(b); });
    }

  private:
    void place(const Box& box) {
        if (BlockWriter::below_floor(box)) return m_writer.exact(box);
        const Centres at(box);
        const auto& [across, down] = at;
        const CubicTriangle& middle = m_map.triangle_at(across.middle, down.middle);
        const Bicubic f = on(m_map, middle, at);
        const EconomizedBicubic x(f.x), y(f.y);
        double step = 0, rounding = rounding_of(middle, across, down);
        int count = 0;
        const Bounds place_{across.middle - across.half, down.middle - down.half, across.middle + across.half,
                            down.middle + down.half};
        m_map.tree().each(place_, [&](std::int32_t i) {
            const CubicTriangle& other = m_map.triangles()[static_cast<std::size_t>(i)];
            if (&other == &middle || count > kMost || !other.meets(place_)) return;
            ++count;
            Bicubic g = on(m_map, other, at);
            for (int r = 0; r < 4; ++r)
                for (int c = 0; c < 4; ++c) {
                    g.x[r][c] -= f.x[r][c];
                    g.y[r][c] -= f.y[r][c];
                }
            const Bounds b = other.bounds();
            const Bicubic there = restricted(g, common(across, b.x0, b.x1), common(down, b.y0, b.y1));
            step = std::max(step, std::hypot(sum_of_magnitudes(there.x), sum_of_magnitudes(there.y)));
            rounding = std::max(rounding, rounding_of(other, across, down));
        });
        // Beyond this many the block is better halved.
        if (count <= kMost &&
            (m_writer.polynomial(box, x.c, y.c, std::hypot(x.dropped, y.dropped) + step + rounding) ||
             m_writer.bicubic(box, f.x, f.y, x.c, y.c, step + rounding)))
            return;
        m_writer.halve(box, box.width() >= box.height(), [&](const Box& b) { place(b); });
    }

    /// In double, of the cubic and its Taylor coefficients: barycentric coordinates grow with the distance
    /// from the triangle, and weights with their cubes.
    double rounding_of(const CubicTriangle& t, const Part& across, const Part& down) const {
        const double dx = std::fabs(across.middle - t.corner[2].x) + across.half,
                     dy = std::fabs(down.middle - t.corner[2].y) + down.half;
        const double reach =
            1 + (std::fabs(t.a[0]) + std::fabs(t.a[1])) * dx + (std::fabs(t.b[0]) + std::fabs(t.b[1])) * dy;
        double size = 0;
        for (const Point<double>& p : t.bezier) size = std::max({size, std::fabs(p.x), std::fabs(p.y)});
        const double place =
            std::fabs(across.middle) * m_map.scale().x + std::fabs(down.middle) * m_map.scale().y;
        return 0x1p-53 * 256 * (size * 8 * reach * reach * reach + place);
    }

    /// The part of [-1, 1] that [low, high] takes of a row of pixels; a hair more.
    static Part common(const Part& all, double low, double high) {
        const double from = std::clamp((low - all.middle) / all.half, -1.0, 1.0),
                     to = std::clamp((high - all.middle) / all.half, -1.0, 1.0);
        return {0.5 * (from + to), 0.5 * (to - from) + 1e-9};
    }

    static constexpr int kMost = 12;

    const Scattered& m_map;
    BlockWriter m_writer;
};

}  // namespace

ScatteredPlan::ScatteredPlan(Scattered map, WarpScheme scheme, double tol)
    : WarpPlan(map.from().width, map.from().height, {Box{0, 0, map.from().width, map.from().height}}),
      m_map(std::move(map)),
      m_scheme(scheme),
      m_tol(tol) {
    check_tol(tol);
}

void ScatteredPlan::plan(const Box& box, int, Blocks& blocks) const {
    Planner planner(m_map, m_tol, blocks);
    if (m_tol == 0 || m_scheme == WarpScheme::exact)
        planner.exact(box);
    else
        planner.region(box);
}

bool ScatteredPlan::exact(double x, double y, int, Point<double>& source_point,
                          int& source_piece) const noexcept {
    source_point = m_map.at(x, y);
    source_piece = 0;
    return std::fabs(source_point.x) < kFarthest && std::fabs(source_point.y) < kFarthest;
}

BlockPolynomial ScatteredPlan::bicubic(const Block& block) const noexcept {
    const Centres at(block.box);
    return float_form(on(m_map, m_map.triangle_at(at.across.middle, at.down.middle), at), block);
}

Jacobian ScatteredPlan::jacobian(double x, double y, int) const noexcept {
    using J = Jet1<double>;
    const Point<J> p = m_map.at(m_map.triangle_at(x, y), J::variable(x, 1, 0), J::variable(y, 0, 1));
    return {p.x.c[1], p.y.c[1], p.x.c[2], p.y.c[2]};
}

float ScatteredPlan::folds(double x, double y) const noexcept {
    const Jacobian j = jacobian(x, y, 0);
    return (j.x_i * j.y_j - j.x_j * j.y_i) * m_map.orientation() < 0 ? 1.0f : 0.0f;
}

}  // namespace anamorph
