// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/mesh_scattered.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "anamorph/mesh/cubic_rows.h"
#include "anamorph/mesh/folds.h"
#include "anamorph/mesh/hermite.h"
#include "anamorph/mesh/window_map.h"
#include "anamorph/number/hypot.h"
#include "anamorph/plan/block_writer.h"
#include "anamorph/plan/map_link.h"

namespace anamorph {
namespace {

/// The pixel centres of a block, or another part of the target.
struct Centres {
    Part across, down;

    explicit Centres(const Box& box)
        : across{0.5 * (box.x0 + box.x1), half(box.width())},
          down{0.5 * (box.y0 + box.y1), half(box.height())} {}
    Centres(const Part& x, const Part& y) : across(x), down(y) {}
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

/// Bits [begin, end) of at most 64.
std::uint64_t bits(int begin, int end) {
    static_assert(Block::kMaxSide <= 64);
    return begin < end ? ~std::uint64_t{0} >> (64 - (end - begin)) << begin : 0;
}

/// A triangle that may hold pixels of a block, and where it lies.
struct Near {
    const CubicTriangle* triangle;
    Bounds bounds;
    double margin;  ///< of barycentric coordinates at the block's pixels
    Bicubic cubic;  ///< on the block
};
Near near_to(const Box& box, const CubicTriangle& triangle, const Bicubic& cubic) {
    // Rows are cut where they may leave a triangle, up to a pixel behind the last one.
    const Bounds all{box.x0 + 0.5, box.y0 + 0.5, box.x1 + 0.5, box.y1 - 0.5};
    return {&triangle, triangle.bounds(), 4 * triangle.place_error(all), cubic};
}

/// The triangles of a region's computed blocks, as many as are kept.
struct Pieces : RegionData {
    static constexpr std::size_t kMost = 1024;

    std::vector<Near> near;
    struct Part {
        std::size_t first, count;
    };
    std::vector<Part> of_blocks;

    std::span<const Near> of(const Block& block) const {
        const Part& part = of_blocks[static_cast<std::size_t>(block.record)];
        return {near.data() + part.first, part.count};
    }
};

/// A coordinate of a cubic on the row at `t`, less a base: in powers of the row's parameter.
simd::CubicRow row_of(const double (&c)[4][4], double t, double base) {
    return {{c[0][0] + t * (c[0][1] + t * (c[0][2] + t * c[0][3])) - base,
             c[1][0] + t * (c[1][1] + t * c[1][2]), c[2][0] + t * c[2][1], c[3][0]}};
}

/// The pixels [begin, end) of a row whose centres certainly lie in a triangle, and those that may.
struct Run {
    int begin, end, outer_begin, outer_end;

    /// The row's first centre is (x, y). Barycentric coordinates err by less than `margin`, crossings by less than
    /// their share of it.
    Run(const CubicTriangle& t, double margin, double x, double y, int count) : begin(0), end(count) {
        outer_begin = begin;
        outer_end = end;
        const double dx = x - t.base.x, dy = y - t.base.y;
        // A triangle without an inside holds nothing for certain.
        if (!std::isfinite(margin)) {
            end = begin;
            return;
        }
        const auto cut = [&](double value, double slope) {
            narrow(value - margin, slope, count, begin, end);
            narrow(value + margin, slope, count, outer_begin, outer_end);
        };
        const double u = dx * t.a[0] + dy * t.b[0] + t.c[0], v = dx * t.a[1] + dy * t.b[1] + t.c[1];
        cut(u, t.a[0]);
        cut(v, t.a[1]);
        cut(1 - u - v, -t.a[0] - t.a[1]);
    }

  private:
    /// Keeps the i of [begin, end) with value + slope i >= 0.
    static void narrow(double value, double slope, int count, int& begin, int& end) {
        if (slope == 0) {
            if (value < 0) end = begin;
            return;
        }
        // Rounded up and down by what conversion cuts off.
        const double at = std::clamp(-value / slope, -1.0, double(count));
        if (slope > 0)
            begin = std::max(begin, count - static_cast<int>(count - at));
        else
            end = std::min(end, static_cast<int>(at + 1));
    }
};

Bounds bounds_of(const Centres& at) {
    return {at.across.middle - at.across.half, at.down.middle - at.down.half,
            at.across.middle + at.across.half, at.down.middle + at.down.half};
}
/// The rounding of the identity's part: the scale, a product and a sum.
double identity_rounding(const Scattered& map, const Bounds& box) {
    return 4 * 0x1p-53 *
           std::max(std::max(std::fabs(box.x0), std::fabs(box.x1)) * map.scale().x,
                    std::max(std::fabs(box.y0), std::fabs(box.y1)) * map.scale().y);
}

/// How far Scattered::at is from the map of the given points, on a triangle's share of a box. There
/// barycentric coordinates are at most 1; a weight takes 5 roundings, their sum with the Bezier points
/// 11. Where coordinates err, the cubic moves by its derivatives; a point that they put into the
/// neighbour's cubic moves by the square of that.
double exact_rounding(const Scattered& map, const CubicTriangle& t, const Bounds& box) {
    const CubicTriangle::Reach reach = t.reach(box);
    const auto inside = [](double most) { return std::min(most, 1.0); };
    const CubicTriangle::Terms terms = t.terms({inside(reach.u), inside(reach.v), inside(reach.w)});
    const double either = 1.01 * (terms.error + 2 * terms.slope * t.place_error(box)) +
                          24 * 0x1p-53 * terms.value + identity_rounding(map, box);
    return 1.4143 * either;
}

/// How far a cubic, as a polynomial on all of a box, is from the map of the given points. The box may
/// reach beyond its triangle. A Taylor coefficient of a weight takes less than 40 roundings, sums with
/// the Bezier points 11; those of what is made of it (restrictions, differences, Chebyshev's form; rows
/// by Horner's rule, in parameters off by two) less than 200.
double form_rounding(const Scattered& map, const CubicTriangle& t, const Centres& at) {
    const Bounds box = bounds_of(at);
    const CubicTriangle::Terms terms = t.terms(t.reach(box));
    const double either = 1.01 * (terms.error + 2 * terms.slope * t.place_error(box)) +
                          256 * 0x1p-53 * terms.value + 64 * identity_rounding(map, box);
    return 1.4143 * either;
}

/// Plans one region.
class TriangleSubdivider {
  public:
    TriangleSubdivider(const Scattered& map, double tol, Blocks& blocks, Pieces& records)
        : m_map(map), m_blocks(blocks), m_records(records), m_writer(tol, blocks) {}

    void exact(const Box& box) {
        BlockWriter::for_blocks(box, [&](const Box& b) {
            const Bounds all = bounds_of(Centres(b));
            double bound = 0;
            m_map.tree().each(all, [&](std::int32_t i) {
                const CubicTriangle& triangle = m_map.triangles()[static_cast<std::size_t>(i)];
                if (triangle.meets(all)) raise(bound, exact_rounding(m_map, triangle, all));
            });
            m_writer.exact(b, bound);
        });
    }
    void region(const Box& box) {
        BlockWriter::for_blocks(box, [&](const Box& b) { place(b); });
    }
    /// The sign of the Jacobian's determinant at all pixels of a box, 0 where it is not certain.
    int sign(const Box& box) {
        if (!gather(Centres(box))) return 0;
        int all = 0;
        for (const Met& met : m_met) {
            // A derivative sums up to 10 terms, each up to three times a coefficient. The restriction, in
            // parameters of a part of the box, is as exact as the cubic on all of it.
            const int one = sign_of_determinant(restricted(met.f, met.s, met.t), 48 * met.rounding);
            if (one == 0 || (all != 0 && one != all)) return 0;
            all = one;
        }
        return all;
    }

  private:
    /// A cubic that a block meets: on the block, where on it, and how double rounds it.
    struct Met {
        const CubicTriangle* triangle;
        Bicubic f;
        Part s, t;
        double rounding;
    };

    void place(const Box& box) {
        if (BlockWriter::below_floor(box)) return exact(box);
        if (gather(Centres(box)) && (smooth(box) || pieces(box))) return;
        m_writer.halve(box, box.width() >= box.height(), [&](const Box& b) { place(b); });
    }

    /// Finds the cubics that a block meets, the one at its middle first. False where there are too many.
    bool gather(const Centres& at) {
        m_met.clear();
        const Part &across = at.across, &down = at.down;
        const auto take = [&](const CubicTriangle& triangle) {
            const Bounds b = triangle.bounds();
            m_met.push_back({&triangle, on(m_map, triangle, at), common(across, b.x0, b.x1),
                             common(down, b.y0, b.y1), form_rounding(m_map, triangle, at)});
        };
        const CubicTriangle& middle = m_map.triangle_at(across.middle, down.middle);
        take(middle);
        const Bounds all = bounds_of(at);
        m_map.tree().each(all, [&](std::int32_t i) {
            const CubicTriangle& other = m_map.triangles()[static_cast<std::size_t>(i)];
            if (m_met.size() <= kMost && &other != &middle && other.meets(all)) take(other);
        });
        return m_met.size() <= kMost;
    }

    /// One polynomial, from which the other cubics differ little.
    bool smooth(const Box& box) {
        const Bicubic& f = m_met[0].f;
        double step = 0, rounding = 0;
        for (const Met& other : m_met) {
            const Bicubic there = restricted(difference(other.f, f), other.s, other.t);
            raise(step, hypot(sum_of_magnitudes(there.x), sum_of_magnitudes(there.y)));
            raise(rounding, other.rounding);
        }
        const EconomizedBicubic x(f.x), y(f.y);
        // The polynomial's own rounding, and that of what it stands for elsewhere.
        rounding += m_met[0].rounding;
        return m_writer.polynomial(box, x.c, y.c, hypot(x.dropped, y.dropped) + step + rounding) ||
               m_writer.bicubic(box, f.x, f.y, x.c, y.c, step + rounding);
    }

    /// Each pixel by the cubic it lies in, in double: the offset from the base is rounded to float, and twice
    /// more where it is read.
    bool pieces(const Box& box) {
        const Point<double> middle = m_map.at(0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1));
        double error = 0;
        for (const Met& met : m_met) {
            Bicubic f = met.f;
            f.x[0][0] -= std::floor(middle.x);
            f.y[0][0] -= std::floor(middle.y);
            const Bicubic there = restricted(f, met.s, met.t);
            raise(error, hypot(sum_of_magnitudes(there.x), sum_of_magnitudes(there.y)) * (3.03 * 0x1p-24) +
                             met.rounding);
        }
        if (!m_writer.computed(box, middle, error)) return false;
        if (m_records.near.size() + m_met.size() > Pieces::kMost) return true;
        m_blocks.back().data = &m_records;
        m_blocks.back().record = static_cast<int>(m_records.of_blocks.size());
        m_records.of_blocks.push_back({m_records.near.size(), m_met.size()});
        for (const Met& met : m_met) m_records.near.push_back(near_to(box, *met.triangle, met.f));
        return true;
    }

    /// Makes `most` the greater of both, or NaN where one of them is.
    static void raise(double& most, double value) {
        if (!std::isnan(most) && !(value <= most)) most = value;
    }

    static Bicubic difference(const Bicubic& a, const Bicubic& b) {
        Bicubic d;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) {
                d.x[i][j] = a.x[i][j] - b.x[i][j];
                d.y[i][j] = a.y[i][j] - b.y[i][j];
            }
        return d;
    }

    /// The part of [-1, 1] that [low, high] takes of a row of pixels; a hair more.
    static Part common(const Part& all, double low, double high) {
        const double from = std::clamp((low - all.middle) / all.half, -1.0, 1.0),
                     to = std::clamp((high - all.middle) / all.half, -1.0, 1.0);
        return {0.5 * (from + to), 0.5 * (to - from) + 1e-9};
    }

    static constexpr std::size_t kMost = 64;

    const Scattered& m_map;
    Blocks& m_blocks;
    Pieces& m_records;
    BlockWriter m_writer;
    std::vector<Met> m_met;
};

/// The map as one for chains: on each triangle its cubic, for boxes in one triangle; elsewhere pixels are exact.
class TriangleMap {
  public:
    explicit TriangleMap(std::shared_ptr<const ScatteredPlan> plan) : m_plan(std::move(plan)) {}

    /// Are squares of 16 pixels about half of some places all over the picture each in one triangle?
    bool has_large_triangles() const {
        constexpr int kTried = 16;
        const Size size = target_size();
        int large = 0;
        for (int j = 0; j < kTried; ++j)
            for (int i = 0; i < kTried; ++i) {
                const double x = (i + 0.5) * size.width / kTried, y = (j + 0.5) * size.height / kTried;
                large += reach_in(map().triangle_at(x, y), x, y) >= 8;
            }
        return 2 * large >= kTried * kTried;
    }

    // The members that make this a FormulaMap (plan/formula_map.h).

    using Local = WindowCubic;
    Size target_size() const { return map().from(); }
    Size source_size() const { return map().to(); }
    std::vector<Box> target_pieces() const { return {{0, 0, map().from().width, map().from().height}}; }
    SourceEdges source_edges() const { return {}; }
    int source_piece(const Local&) const { return 0; }
    int period() const { return 0; }
    /// The cubic of the triangle that holds a point, for the largest square about it that lies in that.
    Local local_around(double x, double y, int) const {
        const CubicTriangle& triangle = map().triangle_at(x, y);
        const double reach = reach_in(triangle, x, y);
        const Centres at(Part{x, reach > 0 ? reach : 1}, Part{y, reach > 0 ? reach : 1});
        const Bicubic f = on(map(), triangle, at);
        WindowCubic cubic;
        cubic.middle = {x, y};
        cubic.unit = 1 / at.across.half;
        for (int k = 0; k < 10; ++k) {
            cubic.cx[k] = f.x[WindowCubic::kAcross[k]][WindowCubic::kDown[k]];
            cubic.cy[k] = f.y[WindowCubic::kAcross[k]][WindowCubic::kDown[k]];
        }
        // What double rounds of the cubic where it is read: less than 64 units of its size.
        cubic.error = (form_rounding(map(), triangle, at) + 0x1p-47 * cubic.size()) * rounded_detail::kUp;
        if (!(reach > 0)) return cubic;
        cubic.x = {x - reach, x + reach};
        cubic.y = {y - reach, y + reach};
        return cubic;
    }
    Cover cover(const Interval& x, const Interval& y, int, const Local& local, bool) const {
        return cover_by(local, x, y);
    }
    template <class T>
    Point<T> operator()(const T& x, const T& y, const Local& local) const {
        return local(x, y);
    }
    Jacobian jacobian(double x, double y, int piece) const { return m_plan->jacobian(x, y, piece); }
    /// MapLink::points_of(): of all cubics that the box meets.
    std::optional<Point<Interval>> points_of(const Interval& x, const Interval& y) const {
        const Bounds all{x.lo, y.lo, x.hi, y.hi};
        std::optional<Point<Interval>> points;
        const auto hull = [](const Interval& a, const Interval& b) {
            return Interval(std::min(a.lo, b.lo), std::max(a.hi, b.hi));
        };
        map().tree().each(all, [&](std::int32_t i) {
            const CubicTriangle& t = map().triangles()[static_cast<std::size_t>(i)];
            if (!t.meets(all)) return;
            const Point<Interval> here = map().at(t, x, y);
            const double error = exact_rounding(map(), t, all);
            const Interval off(-error, error);
            const Point<Interval> with_error{here.x + off, here.y + off};
            points = points ? Point<Interval>{hull(points->x, with_error.x), hull(points->y, with_error.y)}
                            : with_error;
        });
        if (!points || !(magnitude(points->x) < kFarthest && magnitude(points->y) < kFarthest)) return {};
        return points;
    }
    template <RealNumber Real>
    bool exact(const Real& x, const Real& y, int piece, Point<Real>& p, int& source_piece) const {
        Point<double> at;
        if (!m_plan->exact(static_cast<double>(x), static_cast<double>(y), piece, at, source_piece))
            return false;
        p = {Real(at.x), Real(at.y)};
        return true;
    }
    /// The points are doubles whatever Real is.
    template <class Real>
    double exact_error(const Interval& x, const Interval& y, int, double off = 0) const {
        return exact_error(x, y, off);
    }

  private:
    const Scattered& map() const { return m_plan->map(); }

    /// How far a square about a point may reach each way so that it lies certainly in a triangle; not above 0 where it may not.
    static double reach_in(const CubicTriangle& t, double x, double y) {
        constexpr double kMost = 4096;
        const double dx = x - t.base.x, dy = y - t.base.y;
        const double u = dx * t.a[0] + dy * t.b[0] + t.c[0], v = dx * t.a[1] + dy * t.b[1] + t.c[1];
        const double margin = 1e-9 + 2 * t.place_error({x - kMost, y - kMost, x + kMost, y + kMost});
        const auto reach = [&](double coordinate, double a, double b) {
            return (coordinate - margin) / (std::fabs(a) + std::fabs(b));
        };
        return std::min({kMost, reach(u, t.a[0], t.b[0]), reach(v, t.a[1], t.b[1]),
                         reach(1 - u - v, t.a[0] + t.a[1], t.b[0] + t.b[1])});
    }

    /// Where points are off by `off`, the map moves them by that times its slope at most: the cubics' by barycentric coordinates, times
    /// what these change by.
    double exact_error(const Interval& x, const Interval& y, double off) const {
        const Bounds all{x.lo, y.lo, x.hi, y.hi};
        double rounding = 0, slope = 0;
        map().tree().each(all, [&](std::int32_t i) {
            const CubicTriangle& t = map().triangles()[static_cast<std::size_t>(i)];
            if (!t.meets(all)) return;
            const double here = exact_rounding(map(), t, all);
            if (!(here <= rounding)) rounding = here;
            if (off == 0) return;
            const CubicTriangle::Reach reach = t.reach(all);
            const auto inside = [](double reached) { return std::min(reached, 1.0); };
            const CubicTriangle::Terms terms = t.terms({inside(reach.u), inside(reach.v), inside(reach.w)});
            const double turn = hypot(t.a[0], t.b[0]) + hypot(t.a[1], t.b[1]);
            const double steep = 1.01 * 1.4143 * terms.slope * turn;
            if (!(steep <= slope)) slope = steep;
        });
        const double identity = std::max(map().scale().x, map().scale().y);
        return off == 0 ? rounding : (rounding + (slope + identity) * off) * rounded_detail::kUp;
    }

    std::shared_ptr<const ScatteredPlan> m_plan;
};

/// The triangles of a computed block: those that were kept, or found again.
class Triangles {
  public:
    Triangles(const Scattered& map, const Block& block) {
        if (block.data) {
            m_all = static_cast<const Pieces&>(*block.data).of(block);
            return;
        }
        const Box& box = block.box;
        const Bounds centres{box.x0 + 0.5, box.y0 + 0.5, box.x1 - 0.5, box.y1 - 0.5};
        map.tree().each(centres, [&](std::int32_t n) {
            const CubicTriangle& triangle = map.triangles()[static_cast<std::size_t>(n)];
            if (triangle.meets(centres))
                m_found.push_back(near_to(box, triangle, on(map, triangle, Centres(box))));
        });
        m_all = m_found;
    }
    Triangles(const Triangles&) = delete;
    Triangles& operator=(const Triangles&) = delete;

    std::span<const Near> all() const { return m_all; }

  private:
    std::vector<Near> m_found;
    std::span<const Near> m_all;
};

/// Pixels [begin, end) of a row of a computed block.
void write_row(const Scattered& map, const Block& block, std::span<const Near> triangles, int row, int begin,
               int end, float* x, float* y) {
    // Whatever part of it is asked for, the whole row decides who holds a pixel.
    const int width = block.box.width();
    const double first = block.box.x0 + 0.5, down = block.box.y0 + row + 0.5;
    const Centres at(block.box);
    const double t = (down - at.down.middle) / at.down.half;
    // Pixels, bit by bit, that a triangle may hold, that several may, and that one certainly does.
    std::uint64_t claimed = 0, contested = 0, held = 0;
    simd::CubicRun runs[Block::kMaxSide];
    int count = 0;
    for (const Near& near : triangles) {
        if (!near.bounds.meets({first, down, first + width - 1, down})) continue;
        const Run run(*near.triangle, near.margin, first, down, width);
        const std::uint64_t claim = bits(run.outer_begin, run.outer_end);
        contested |= claimed & claim;
        claimed |= claim;
        held |= bits(run.begin, run.end);
        const int from = std::max(run.begin, begin), to = std::min(run.end, end);
        if (from >= to) continue;
        // From left to right: no pixel is certainly in two triangles.
        int k = count++;
        for (; k > 0 && runs[k - 1].begin > from - begin; --k) runs[k] = runs[k - 1];
        runs[k] = {row_of(near.cubic.x, t, block.base_x), row_of(near.cubic.y, t, block.base_y), from - begin,
                   to - begin};
    }
    simd::write_cubics({runs, static_cast<std::size_t>(count)}, begin - 0.5 * (width - 1), 1 / at.across.half,
                       x, y);
    // On edges, by the rule for single points.
    for (std::uint64_t open = bits(begin, end) & ~(held & ~contested); open; open &= open - 1) {
        const int i = std::countr_zero(open);
        const Point<double> p = map.at(first + i, down);
        x[i - begin] = static_cast<float>(p.x - block.base_x);
        y[i - begin] = static_cast<float>(p.y - block.base_y);
    }
}

}  // namespace

ScatteredPlan::ScatteredPlan(Scattered map, WarpScheme scheme, double tol)
    : WarpPlan(map.from().width, map.from().height, {Box{0, 0, map.from().width, map.from().height}}),
      m_map(std::move(map)),
      m_scheme(scheme),
      m_tol(tol) {
    check_tol(tol);
}

void ScatteredPlan::plan(const Box& box, int, Blocks& blocks) const {
    const auto records = std::make_shared<Pieces>();
    TriangleSubdivider subdivider(m_map, m_tol, blocks, *records);
    if (m_tol == 0 || m_scheme == WarpScheme::exact)
        subdivider.exact(box);
    else
        subdivider.region(box);
    if (!records->near.empty()) blocks.data = records;
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

void ScatteredPlan::computed(std::span<const Block> layers, const PointRows* to) const noexcept {
    const Block& block = layers.front();
    const Box& b = block.box;
    const Triangles triangles(m_map, block);
    for (int j = 0; j < b.height(); ++j)
        write_row(m_map, block, triangles.all(), j, 0, b.width(), to->x + j * to->stride,
                  to->y + j * to->stride);
}

void ScatteredPlan::computed_row(const Block& block, int row, int begin, int end, float* x,
                                 float* y) const noexcept {
    write_row(m_map, block, Triangles(m_map, block).all(), row, begin, end, x, y);
}

std::shared_ptr<const MapLink> ScatteredPlan::link() const {
    const auto plan = std::static_pointer_cast<const ScatteredPlan>(weak_from_this().lock());
    if (!plan || !joins(m_scheme)) return nullptr;
    const TriangleMap map(plan);
    if (m_scheme != WarpScheme::exact && !map.has_large_triangles()) return nullptr;
    return std::make_shared<const LinkOf<TriangleMap>>(map, link_options(m_scheme, m_tol));
}

std::string ScatteredPlan::why_unlinked() const {
    return joins(m_scheme) ? "has pairs of points that stand close" : BlockMap::why_unlinked();
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

std::int64_t ScatteredPlan::folded_pixels(const Box& box) const {
    Blocks unused;
    Pieces no_pieces;
    TriangleSubdivider subdivider(m_map, m_tol, unused, no_pieces);
    const int orientation = m_map.orientation() < 0 ? -1 : 1;
    return count_folded(
        box, [&](const Box& b) { return subdivider.sign(b) * orientation; },
        [&](const Box& b) { return WarpPlan::folded_pixels(b); });
}

}  // namespace anamorph
