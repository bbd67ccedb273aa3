// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/inverse.h"

#include <array>
#include <atomic>
#include <optional>

#include "anamorph/mesh/hermite.h"
#include "anamorph/mesh/window_map.h"
#include "anamorph/number/hypot.h"
#include "anamorph/parameter/left_out.h"
#include "anamorph/plan/block_writer.h"

namespace anamorph {
namespace {

// Parts of a mesh that turns over nearly everywhere need never end.
constexpr std::size_t kMostParts = std::size_t{1} << 22;
constexpr int kMostCuts = 80;

/// The map on a part of a cell, in powers of parameters in [-1, 1].
Bicubic map_on(const Mesh& mesh, const MeshCell& cell, const Bicubic& powers, const Part& s, const Part& t) {
    Bicubic f = restricted(powers, s, t);
    const double w = cell.x1 - cell.x0, h = cell.y1 - cell.y0;
    add_identity(f, mesh, {cell.x0 + s.middle * w, s.half * w}, {cell.y0 + t.middle * h, t.half * h});
    return f;
}

}  // namespace

/// One cell, and what is known of its parts.
class InversePlan::CellParts {
  public:
    CellParts(const Mesh& mesh, const MeshCell& cell, int number)
        : m_mesh(mesh),
          m_cell(cell),
          m_number(number),
          m_patch(mesh.patch(cell)),
          m_powers(power_form(m_patch)) {
        m_rounding = double_rounding(mesh, cell, m_patch);
        m_exact = exact_rounding(mesh, cell, m_patch);
    }

    double width() const { return m_cell.x1 - m_cell.x0; }
    double height() const { return m_cell.y1 - m_cell.y0; }
    Point<double> source(double s, double t) const {
        return {m_cell.x0 + s * width(), m_cell.y0 + t * height()};
    }

    SeenPart see(const Part& s, const Part& t, const Bounds&) const {
        const Bicubic f = map_on(m_mesh, m_cell, m_powers, s, t);
        const double rx = sum_of_magnitudes(f.x) - std::fabs(f.x[0][0]) + m_rounding,
                     ry = sum_of_magnitudes(f.y) - std::fabs(f.y[0][0]) + m_rounding;
        SeenPart seen{{f.x[0][0] - rx, f.y[0][0] - ry, f.x[0][0] + rx, f.y[0][0] + ry},
                      std::max(rx, ry),
                      std::nullopt,
                      true};
        const Matrix2 a{f.x[1][0], f.x[0][1], f.y[1][0], f.y[0][1]};
        const double size = std::max(largest({a.a11, a.a12}), largest({a.a21, a.a22}));
        const bool regular = std::fabs(a.determinant()) > 1e-9 * size * size;
        const Bend bend = regular ? bend_of(f, a.inverse()) : Bend{};
        if (regular) {
            const Sheet sheet = sheet_of(a.inverse(), s, t, bend.reach);
            if (bend.now + slope_rounding(a.inverse(), s, t) <= Sheet::kContraction &&
                sheet.hair <= Sheet::kMostHair) {
                seen.sheet = sheet;
                return seen;
            }
        }
        seen.cut_s = bend.after_s <= bend.after_t;
        // Near a fold Y says little: cut what is longer in the target.
        if (!regular || !(bend.now < 4)) {
            double along_s = 0, along_t = 0;
            for (int i = 0; i < 4; ++i)
                for (int j = 0; j < 4; ++j) {
                    const double v = largest({f.x[i][j], f.y[i][j]});
                    along_s += i * v;
                    along_t += j * v;
                }
            seen.cut_s = along_s >= along_t;
        }
        return seen;
    }

    /// A part that is left as a fold.
    Sheet fold(const Part& s, const Part& t) const {
        return Sheet::of_fold(m_number, s, t, m_mesh.inside(m_patch, s.middle, t.middle));
    }

  private:
    /// The Lipschitz constant of N: as it is, and about what it is after a cut; and how far N reaches.
    struct Bend {
        double now = 0, after_s = 0, after_t = 0, reach = 0;
    };
    static Bend bend_of(const Bicubic& f, const Matrix2& y) {
        double now[2] = {}, after_s[2] = {}, after_t[2] = {};
        Bend bend;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) {
                if (i + j < 2) continue;
                const Point<double> v = y(f.x[i][j], f.y[i][j]);
                bend.reach += largest(v);
                // Half a parameter's range divides a term by 2 for each of its powers, and that parameter is
                // then counted in halves.
                const double size[2] = {(i + j) * std::fabs(v.x), (i + j) * std::fabs(v.y)};
                for (int k = 0; k < 2; ++k) {
                    now[k] += size[k];
                    after_s[k] += std::ldexp(size[k], k == 0 ? 1 - i : -i);
                    after_t[k] += std::ldexp(size[k], k == 0 ? -j : 1 - j);
                }
            }
        bend.now = std::max(now[0], now[1]);
        bend.after_s = std::max(after_s[0], after_s[1]);
        bend.after_t = std::max(after_t[0], after_t[1]);
        return bend;
    }

    /// The rounding of N's slope. That of all coefficients together is at most m_rounding; on a part of half
    /// sizes h and k they are shifted and scaled, so that a slope has h (1 + h)^2 (1 + k)^3 times 3 of it and
    /// the same the other way round, with h and k of at most 1/2.
    double slope_rounding(const Matrix2& y, const Part& s, const Part& t) const {
        return 8 * (s.half + t.half) * y.norm() * m_rounding;
    }

    Sheet sheet_of(const Matrix2& y, const Part& s, const Part& t, double reach) const {
        // Of z: the parameters s and t round, and the map in double errs; the iteration is a contraction.
        const double noise =
            (y.norm() * m_exact + 0x1p-51 * (1 + 1 / std::min(s.half, t.half))) / (1 - Sheet::kContraction);
        const double hair = std::max(Sheet::kHair, 4 * noise);
        const double diameter = 2 * hypot(s.half * width(), t.half * height());
        const double place = std::max(std::fabs(m_cell.x0), std::fabs(m_cell.x1)) +
                             std::max(std::fabs(m_cell.y0), std::fabs(m_cell.y1));
        Sheet sheet = fold(s, t);
        sheet.fold = false;
        sheet.to_parameters = y;
        sheet.reach = reach + slope_rounding(y, s, t) + hair;
        sheet.hair = hair;
        sheet.noise = noise;
        // The stop at a step of `noise`, and the rounding of the position and of lines.
        sheet.error = diameter * 1.5 * noise + 8 * 0x1p-53 * place;
        sheet.edge = diameter * 2 * hair;
        return sheet;
    }

    const Mesh& m_mesh;
    MeshCell m_cell;
    int m_number;
    Patch m_patch;
    Bicubic m_powers;
    double m_rounding, m_exact;  ///< of the forms and of Mesh::inside, target pixels
};

namespace {

// ----------------------------------------------------------------------------------------------------------

/// Homogeneous polynomials of two variables: the coefficient of s^(K-j) t^j stands at j.
template <std::size_t K>
using Form = std::array<double, K + 1>;

template <std::size_t A, std::size_t B>
Form<A + B - 2> times(const std::array<double, A>& a, const std::array<double, B>& b) {
    Form<A + B - 2> product{};
    for (std::size_t i = 0; i < A; ++i)
        for (std::size_t j = 0; j < B; ++j) product[i + j] += a[i] * b[j];
    return product;
}
/// The derivative of a form in the direction of (v[0], v[1]), themselves forms.
template <std::size_t A, std::size_t B>
Form<A + B - 3> derivative_along(const std::array<double, A>& a, const std::array<double, B> (&v)[2]) {
    Form<A - 2> by_s, by_t;
    for (std::size_t i = 0; i + 1 < A; ++i) {
        by_s[i] = static_cast<double>(A - 1 - i) * a[i];
        by_t[i] = static_cast<double>(i + 1) * a[i + 1];
    }
    const auto across = times(by_s, v[0]), down = times(by_t, v[1]);
    Form<A + B - 3> sum;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = across[i] + down[i];
    return sum;
}
template <std::size_t N>
double norm(const std::array<double, N>& a) {
    double sum = 0;
    for (const double v : a) sum += std::fabs(v);
    return sum;
}
template <std::size_t N>
double norm(const std::array<double, N>& x, const std::array<double, N>& y) {
    return std::max(norm(x), norm(y));
}

/// By total degree, what a bicubic's coefficients in source pixels about a point are at most in units of the
/// block, in either coordinate.
using Sizes = std::array<double, 7>;

/// sum of size[d] r^d from degree `first` on, and of d size[d] r^(d-1).
double value_at(const Sizes& sizes, std::size_t first, double r) {
    double sum = 0;
    for (std::size_t d = sizes.size(); d-- > first;) sum = sum * r + sizes[d];
    return sum * std::pow(r, double(first));
}
double slope_at(const Sizes& sizes, double r) {
    double sum = 0;
    for (std::size_t d = sizes.size(); d-- > 1;) sum = sum * r + double(d) * sizes[d];
    return sum;
}

/// The inverse on a block: a polynomial in its parameters and the distance to the truth in source pixels.
struct LocalInverse : Bicubic {
    double error = HUGE_VAL;

    LocalInverse() : Bicubic{} {}
};

/// What a region's bicubic blocks are made of.
struct Bicubics : RegionData {
    std::vector<BlockPolynomial> polynomials;
};

/// Plans one region.
class InverseSubdivider {
  public:
    InverseSubdivider(const InversePlan& plan, double tol, Blocks& blocks)
        : m_plan(plan), m_mesh(plan.mesh()), m_tol(tol), m_blocks(blocks), m_writer(tol, blocks) {}

    void exact(const Box& box) {
        BlockWriter::for_blocks(box, [&](const Box& b) {
            aim(b);
            const bool on_fold = gather();
            write_exact(b, on_fold);
        });
    }

    void region(const Box& box) {
        BlockWriter::for_blocks(box, [&](const Box& b) { place(b); });
    }

    /// The inverse on a box whose points have one source point each, between the centres of its outermost pixels; else the error is
    /// infinite.
    LocalInverse over(const Box& box) {
        aim(box);
        return gather() ? LocalInverse() : invert();
    }
    /// A box that holds all source points of those of a box.
    std::optional<Point<Interval>> points_over(const Interval& x, const Interval& y) {
        if (roots_over(x, y) != Roots::one) return {};
        Point<Interval> all{{HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, -HUGE_VAL}};
        const auto add = [](Interval& to, double line, double cell, double middle, double size,
                            const Part& z) {
            const double at = line + (middle + size * z.middle) * cell, reach = size * z.half * cell;
            to = {std::min(to.lo, at - reach), std::max(to.hi, at + reach)};
        };
        for (const Near& near : m_near) {
            const Sheet& sheet = *near.sheet;
            const MeshCell& cell = m_plan.cells()[static_cast<std::size_t>(sheet.cell)];
            add(all.x, cell.x0, cell.x1 - cell.x0, sheet.s, sheet.hs, near.s);
            add(all.y, cell.y0, cell.y1 - cell.y0, sheet.t, sheet.ht, near.t);
        }
        // What computed ones are off, and what rounds here.
        double error = 0;
        for (const Near& near : m_near) error = std::max(error, 2 * near.sheet->error);
        const Interval off(-error, error);
        return Point<Interval>{all.x + off, all.y + off};
    }

    /// Has every point of a box certainly one source point, or certainly none?
    enum class Roots { none, one, unknown };
    Roots roots_over(const Interval& x, const Interval& y) {
        // A point is taken to be a little box, which is to hold more than rounding.
        constexpr double kLeast = 0x1p-20;
        m_x = 0.5 * (x.lo + x.hi);
        m_y = 0.5 * (y.lo + y.hi);
        m_hx = std::max(0.5 * (x.hi - x.lo), kLeast);
        m_hy = std::max(0.5 * (y.hi - y.lo), kLeast);
        m_narrowings = 16;
        const bool on_fold = gather();
        if (m_near.empty() && !on_fold) return Roots::none;
        return !on_fold && invert().error < HUGE_VAL ? Roots::one : Roots::unknown;
    }

  private:
    void aim(const Box& box) {
        m_x = 0.5 * (box.x0 + box.x1);
        m_y = 0.5 * (box.y0 + box.y1);
        m_hx = half(box.width());
        m_hy = half(box.height());
    }

    /// About what an inverse misses on a block, and which cut helps most; nothing is proven of it.
    struct Miss {
        double error = 0;
        bool vertical_cut = true;

        /// A remainder of degree 5: two cuts, one either way, leave 1/32.
        Miss on_half() const { return {error * 0.177, !vertical_cut}; }
    };

    void place(const Box& box) { place(box, Miss{}); }
    void place(const Box& box, const Miss& expected) {
        // Not worth the attempt.
        if (expected.error > m_tol && !BlockWriter::below_floor(box)) return halve(box, expected);
        aim(box);
        const bool on_fold = gather();
        if (m_near.empty() && !on_fold) return m_writer.outside(box);
        if (BlockWriter::below_floor(box)) return write_exact(box, on_fold);
        Miss miss{0, box.width() >= box.height()};
        if (!on_fold) {
            const LocalInverse inverse = invert();
            if (inverse.error < HUGE_VAL) {
                const EconomizedBicubic x(inverse.x), y(inverse.y);
                if (m_writer.polynomial(box, x.c, y.c, hypot(x.dropped, y.dropped) + inverse.error) ||
                    bicubic(box, inverse, x.c, y.c))
                    return;
                miss = {inverse.error, x.dropped_s + y.dropped_s >= x.dropped_t + y.dropped_t};
            }
        }
        halve(box, miss);
    }
    void halve(const Box& box, const Miss& miss) {
        m_writer.halve(box, miss.vertical_cut, [&](const Box& b) { place(b, miss.on_half()); });
    }

    /// True when the polynomial as it is keeps the tolerance; `near_x` and `near_y` is the quadratic near it.
    bool bicubic(const Box& box, const LocalInverse& inverse, const double* near_x, const double* near_y) {
        if (!m_writer.bicubic(box, inverse.x, inverse.y, near_x, near_y, inverse.error)) return false;
        if (!m_bicubics) m_blocks.data = m_bicubics = std::make_shared<Bicubics>();
        Block& block = m_blocks.back();
        block.data = m_bicubics.get();
        block.record = static_cast<int>(m_bicubics->polynomials.size());
        m_bicubics->polynomials.push_back(float_form(inverse, block));
        return true;
    }

    /// The bound of exact pixels: that of the sheets near; on folds, of each pixel.
    void write_exact(const Box& box, bool on_fold) {
        double bound = 0;
        for (const Near& near : m_near) bound = std::max(bound, near.sheet->error);
        for (int y = box.y0; on_fold && y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x)
                bound = std::max(bound, m_plan.preimages(x + 0.5, y + 0.5).error);
        m_writer.exact(box, bound);
    }

    /// A sheet, and the box in its parameters where source points of the block's pixels may be.
    struct Near {
        const Sheet* sheet;
        Part s, t;
    };

    /// Finds the sheets that may hold source points of the block's pixels; is a fold among them?
    bool gather() {
        m_near.clear();
        bool fold = false;
        m_plan.tree().each({m_x - m_hx, m_y - m_hy, m_x + m_hx, m_y + m_hy}, [&](std::int32_t i) {
            const Sheet& sheet = m_plan.sheets()[static_cast<std::size_t>(i)];
            if (sheet.fold)
                fold = true;
            else if (const std::optional<Near> near = narrowed(sheet))
                m_near.push_back(*near);
        });
        return fold;
    }

    std::optional<Near> narrowed(const Sheet& sheet) const {
        const auto on_sheet = [&](const Point<double>& z) { return m_plan.on_sheet(sheet, z); };
        const auto near = sheet.narrowed(m_x, m_y, m_hx, m_hy, on_sheet, m_narrowings);
        return near ? std::optional(Near{&sheet, near->first, near->second}) : std::nullopt;
    }

    /// A cell, and what is made of it.
    struct KnownCell {
        int level = -1, column = 0, row = 0;
        Patch patch{};
        Bicubic powers{};     ///< of the patch
        double rounding = 0;  ///< double_rounding()

        bool is(const MeshCell& cell) const {
            return level == cell.level && column == cell.column && row == cell.row;
        }
    };

    /// The map about the middle of a block, in its units: z + Q(z) + C(z) + F(z) + higher terms, where M leads from
    /// the block's parameters to source pixels.
    struct Middle {
        KnownCell cell;
        Point<double> at;    ///< source pixels
        Bicubic powers;      ///< of the cell's map about it
        Matrix2 to_source;   ///< M
        Point<double> span;  ///< of the ball of radius 1, source pixels
        Form<2> q[2];
        Form<3> c[2];
        Form<4> f[2];
    };

    /// The source point of the block's middle. False where there is none, or several.
    bool find_middle(Preimage& at) const {
        if (m_near.size() == 1) {
            const Sheet& only = *m_near.front().sheet;
            const KnownCell& cell = known(m_plan.cells()[static_cast<std::size_t>(only.cell)]);
            return m_plan.find(only, cell.patch, m_x, m_y, at);
        }
        const Preimages found = m_plan.preimages(m_x, m_y);
        at = found.best;
        return found.count == 1;
    }

    /// See inverse.h. The error is infinite where nothing is proven.
    LocalInverse invert() {
        LocalInverse result;
        Preimage at{};
        if (!find_middle(at)) return result;
        Middle middle{
            known(m_plan.cells()[static_cast<std::size_t>(at.cell)]), at.at, {}, {}, {}, {}, {}, {}};
        middle.powers = about(middle.cell, middle.at);
        const Bicubic& f = middle.powers;
        const Matrix2 j{f.x[1][0], f.x[0][1], f.y[1][0], f.y[0][1]};
        if (j.determinant() == 0) return result;
        const Matrix2 ji = j.inverse();
        middle.to_source = {ji.a11 * m_hx, ji.a12 * m_hy, ji.a21 * m_hx, ji.a22 * m_hy};
        middle.span = middle.to_source.span(1, 1);
        set_terms(middle);

        // T = DQ Q - C and U = DC Q - DQ T - Q(Q(z)) - F.
        const Form<2>(&q)[2] = middle.q;
        Form<3> third[2];
        Form<4> fourth[2];
        for (int k = 0; k < 2; ++k) {
            const Form<3> along = derivative_along(q[k], q);
            for (std::size_t i = 0; i < 4; ++i) third[k][i] = along[i] - middle.c[k][i];
        }
        const Form<4> xx = times(q[0], q[0]), xy = times(q[0], q[1]), yy = times(q[1], q[1]);
        for (int k = 0; k < 2; ++k) {
            const Form<4> c_along = derivative_along(middle.c[k], q), q_along = derivative_along(q[k], third);
            for (std::size_t i = 0; i < 5; ++i)
                fourth[k][i] = c_along[i] - q_along[i] -
                               (q[k][0] * xx[i] + q[k][1] * xy[i] + q[k][2] * yy[i]) - middle.f[k][i];
        }
        const Point<double>&m = middle.at, &span = middle.span;
        // And of what follows, to a quadratic: 24 roundings of point and spans.
        result.error = hypot(span.x, span.y) *
                           inverse_error(middle, norm(third[0], third[1]), norm(fourth[0], fourth[1])) +
                       24 * 0x1p-53 * (std::fabs(m.x) + std::fabs(m.y) + 4 * (span.x + span.y));
        set_inverse(middle, third, fourth, result);
        if (!on_mesh(result)) result.error = HUGE_VAL;
        return result;
    }

    /// Are its points certainly on the mesh, in cells that have sheets? Those that meet the source have.
    bool on_mesh(const LocalInverse& inverse) const {
        const auto holds = [&](const std::vector<double>& lines, int size, const double(&c)[4][4]) {
            const double reach = sum_of_magnitudes(c) - std::fabs(c[0][0]) + inverse.error;
            return c[0][0] - reach >= std::max(lines.front(), 0.0) &&
                   c[0][0] + reach <= std::min(lines.back(), double(size));
        };
        return holds(m_mesh.x_lines(), m_mesh.from().width, inverse.x) &&
               holds(m_mesh.y_lines(), m_mesh.from().height, inverse.y);
    }

    /// Q, C and F: the patch's own, of what M makes of z.
    void set_terms(Middle& middle) const {
        const Matrix2& m = middle.to_source;
        const Form<1> a{m.a11, m.a12}, b{m.a21, m.a22};
        const Form<2> aa = times(a, a), ab = times(a, b), bb = times(b, b);
        const Form<3> aaa = times(aa, a), aab = times(aa, b), abb = times(a, bb), bbb = times(bb, b);
        const Form<4> aaab = times(aaa, b), aabb = times(aab, b), abbb = times(a, bbb);
        for (int k = 0; k < 2; ++k) {
            const auto& g = k ? middle.powers.y : middle.powers.x;
            const double unit = 1 / (k ? m_hy : m_hx);
            for (std::size_t i = 0; i < 3; ++i)
                middle.q[k][i] = (g[2][0] * aa[i] + g[1][1] * ab[i] + g[0][2] * bb[i]) * unit;
            for (std::size_t i = 0; i < 4; ++i)
                middle.c[k][i] =
                    (g[3][0] * aaa[i] + g[2][1] * aab[i] + g[1][2] * abb[i] + g[0][3] * bbb[i]) * unit;
            for (std::size_t i = 0; i < 5; ++i)
                middle.f[k][i] = (g[3][1] * aaab[i] + g[2][2] * aabb[i] + g[1][3] * abbb[i]) * unit;
        }
    }

    /// How far z - Q + T + U is from the inverse, in units of the block; `third` and `fourth`: the sizes of T and U.
    double inverse_error(const Middle& middle, double third, double fourth) const {
        const Sizes full = sizes_of(middle.powers, middle.span);
        Sizes sizes = full;
        sizes[0] = sizes[1] = 0;
        sizes[2] = norm(middle.q[0], middle.q[1]);
        sizes[3] = norm(middle.c[0], middle.c[1]);
        sizes[4] = norm(middle.f[0], middle.f[1]);
        // The residual of z + d, with d = e - Q and e = T + U: DQ U + Q(d) - Q(-Q) + DC e + C(z + d) - C(z) - DC d +
        // F(z + d) - F(z) + higher(z + d). As a bilinear form Q(d) - Q(-Q) is that of e and d - Q.
        const double e = third + fourth, d = sizes[2] + e, d2 = d * d;
        const double residual =
            2 * sizes[2] * fourth + sizes[2] * e * (d + sizes[2]) + sizes[3] * (3 * e + 3 * d2 + d2 * d) +
            sizes[4] * (4 * d + 6 * d2 + 4 * d2 * d + d2 * d2) + value_at(sizes, 5, 1 + d);

        // The middle's own error, and rounding.
        const auto start_in = [&](double r) { return middle_error(middle, r, full); };
        // A ball that holds block, approximation and every source point that a sheet may have.
        double radius = 1 + d;
        for (int i = 0; i < 3; ++i)
            radius = std::max(radius, 1 + 1.05 * (value_at(sizes, 2, radius) + start_in(radius)));
        radius = std::max(radius, reach_of_sheets(middle.at, middle.to_source.inverse()));
        if (!(radius < 8)) return HUGE_VAL;
        const double start = start_in(radius);
        const std::optional<Step> step = step_to_neighbours(middle, radius, 1 + d);
        if (!step) return HUGE_VAL;
        const double outside = value_at(step->sizes, 0, radius);
        // One root in the ball: the map less the identity takes it into itself and contracts.
        double wide = radius;
        if (outside > 0) wide = std::max(wide, 1 + 1.05 * (value_at(sizes, 2, radius) + outside + start));
        if (wide > radius) return HUGE_VAL;
        const double contraction = slope_at(sizes, radius) + slope_at(step->sizes, radius);
        if (!(contraction <= 0.75) || !(1 + value_at(sizes, 2, radius) + outside + start <= radius))
            return HUGE_VAL;
        return (residual + step->most + start) / (1 - contraction);
    }

    /// z - Q + T + U, through M to source pixels. Fourth powers are economised: s^4 is within 1/8 of s^2 - 1/8.
    static void set_inverse(const Middle& middle, const Form<3> (&third)[2], const Form<4> (&fourth)[2],
                            LocalInverse& result) {
        const Matrix2& m = middle.to_source;
        double dropped[2];
        for (int k = 0; k < 2; ++k) {
            auto& to = k ? result.y : result.x;
            const Form<1> row = k ? Form<1>{m.a21, m.a22} : Form<1>{m.a11, m.a12};
            const auto through = [&](const auto& form, std::size_t i) {
                return row[0] * form[0][i] + row[1] * form[1][i];
            };
            const double s4 = through(fourth, 0), t4 = through(fourth, 4);
            dropped[k] = (std::fabs(s4) + std::fabs(t4)) / 8;
            to[0][0] = (k ? middle.at.y : middle.at.x) - (s4 + t4) / 8;
            to[1][0] = row[0];
            to[0][1] = row[1];
            for (std::size_t i = 0; i < 3; ++i) to[2 - i][i] = -through(middle.q, i);
            for (std::size_t i = 0; i < 4; ++i) to[3 - i][i] = through(third, i);
            for (std::size_t i = 1; i < 4; ++i) to[4 - i][i] = through(fourth, i);
            to[2][0] += s4;
            to[0][2] += t4;
        }
        result.error += hypot(dropped[0], dropped[1]);
    }

    /// A cell's map in powers of source pixels from a point.
    Bicubic about(const KnownCell& cell, const Point<double>& m) const {
        const Patch& patch = cell.patch;
        const double w = 1 / (patch.x1 - patch.x0), h = 1 / (patch.y1 - patch.y0);
        Bicubic f = restricted(cell.powers, {(m.x - patch.x0) * w, w}, {(m.y - patch.y0) * h, h});
        add_identity(f, m_mesh, {m.x, 1}, {m.y, 1});
        return f;
    }

    Sizes sizes_of(const Bicubic& f, const Point<double>& span) const {
        Sizes sizes{};
        const double px[4] = {1, span.x, span.x * span.x, span.x * span.x * span.x};
        const double py[4] = {1, span.y, span.y * span.y, span.y * span.y * span.y};
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = 0; j < 4; ++j)
                sizes[i + j] +=
                    std::max(std::fabs(f.x[i][j]) / m_hx, std::fabs(f.y[i][j]) / m_hy) * px[i] * py[j];
        return sizes;
    }

    /// How a cell's map rounds about a point, in units of the block: `radius` spans from it, powers of
    /// parameters beyond [0, 1] grow by their cubes, and so does their rounding.
    double rounding_about(const KnownCell& cell, const Point<double>& m, const Point<double>& span,
                          double radius) const {
        const auto growth = [](double from, double to, double at, double reach) {
            const double r = (std::max(std::fabs(at - from), std::fabs(to - at)) + reach) / (to - from);
            return std::max(1.0, r * r * r);
        };
        const Patch& patch = cell.patch;
        return cell.rounding * growth(patch.x0, patch.x1, m.x, radius * span.x) *
               growth(patch.y0, patch.y1, m.y, radius * span.y) / std::min(m_hx, m_hy);
    }

    /// How far f(m) is from the block's middle, with the rounding of everything here, in units of the block.
    /// M's rounding leaves J M - 1 below 8 u |J| |M|, and `sizes` says |J| |M| at degree 1; Q, C and F are sums
    /// of at most 24 products of 6 factors, less than 32 u of what they sum; T, of products of two of them, and U, of
    /// products of up to three: less than 128 u of its square and its cube.
    double middle_error(const Middle& middle, double radius, const Sizes& sizes) const {
        const Bicubic& f = middle.powers;
        const double off = std::max(std::fabs(f.x[0][0] - m_x) / m_hx, std::fabs(f.y[0][0] - m_y) / m_hy);
        const double sum = value_at(sizes, 1, radius);
        return off + rounding_about(middle.cell, middle.at, middle.span, radius) +
               128 * 0x1p-53 * sum * (1 + sum * (1 + sum));
    }

    /// How far from the block's middle, in its units, the sheets' source points can be.
    double reach_of_sheets(const Point<double>& m, const Matrix2& to_block) const {
        double reach = 0;
        for (const Near& near : m_near) {
            const Sheet& sheet = *near.sheet;
            const MeshCell& cell = m_plan.cells()[static_cast<std::size_t>(sheet.cell)];
            const double w = cell.x1 - cell.x0, h = cell.y1 - cell.y0;
            const Part x{cell.x0 + (sheet.s + near.s.middle * sheet.hs) * w, near.s.half * sheet.hs * w};
            const Part v{cell.y0 + (sheet.t + near.t.middle * sheet.ht) * h, near.t.half * sheet.ht * h};
            const Point<double> at = to_block(x.middle - m.x, v.middle - m.y),
                                far = to_block.span(x.half, v.half);
            reach = std::max({reach, std::fabs(at.x) + far.x, std::fabs(at.y) + far.y});
        }
        return reach;
    }

    /// What is known of a cell; the last few are kept, more than a ball may meet.
    const KnownCell& known(const MeshCell& cell) const {
        for (const KnownCell& one : m_known)
            if (one.is(cell)) return one;
        KnownCell& next = m_known[m_next_known++ % m_known.size()];
        next = {cell.level, cell.column, cell.row, m_mesh.patch(cell), {}, 0};
        next.powers = power_form(next.patch);
        next.rounding = double_rounding(m_mesh, cell, next.patch);
        return next;
    }

    /// By how much the maps of the cells that a ball meets differ from the one in the middle, in units of the
    /// block: everywhere in the ball, and where a cell meets a smaller one. Beyond the mesh the map is taken to
    /// differ from that by as much as at the nearest point of the mesh, which lies in the ball's box too: so it
    /// goes on without a step, as steep at most. Its source points are the mesh's where they lie on it
    /// (on_mesh).
    struct Step {
        Sizes sizes{};
        double most = 0;
    };
    /// None where the ball meets many cells.
    std::optional<Step> step_to_neighbours(const Middle& middle, double radius, double smaller) const {
        const Point<double>&m = middle.at, &span = middle.span;
        const Patch& own = middle.cell.patch;
        const double rx = span.x * radius, ry = span.y * radius;
        const std::vector<double>&x_lines = m_mesh.x_lines(), &y_lines = m_mesh.y_lines();
        Step step;
        if (m.x - rx >= own.x0 && m.x + rx <= own.x1 && m.y - ry >= own.y0 && m.y + ry <= own.y1) return step;
        constexpr int kMost = 9;
        int count = 0;
        const double left = std::max(m.x - rx, x_lines.front()), right = std::min(m.x + rx, x_lines.back()),
                     top = std::max(m.y - ry, y_lines.front()), bottom = std::min(m.y + ry, y_lines.back());
        m_mesh.each_cell(left, top, right, bottom, [&](const MeshCell& other) {
            if (++count > kMost) return;
            const KnownCell& there = known(other);
            const double rounding = rounding_about(there, m, span, radius);
            if (middle.cell.is(other)) {
                // No difference but rounding.
                step.sizes[0] = std::max(step.sizes[0], rounding);
                step.most = std::max(step.most, rounding);
                return;
            }
            Bicubic g = about(there, m);
            for (int i = 0; i < 4; ++i)
                for (int k = 0; k < 4; ++k) {
                    g.x[i][k] -= middle.powers.x[i][k];
                    g.y[i][k] -= middle.powers.y[i][k];
                }
            Sizes sizes = sizes_of(g, span);
            sizes[0] += rounding;
            for (std::size_t i = 0; i < sizes.size(); ++i) step.sizes[i] = std::max(step.sizes[i], sizes[i]);
            const Part x = common(m.x, span.x * smaller, other.x0, other.x1),
                       y = common(m.y, span.y * smaller, other.y0, other.y1);
            if (x.half < 0 || y.half < 0) return;
            const Bicubic common_part = restricted(g, x, y);
            step.most = std::max({step.most, sum_of_magnitudes(common_part.x) / m_hx + rounding,
                                  sum_of_magnitudes(common_part.y) / m_hy + rounding});
        });
        if (count > kMost) return std::nullopt;
        return step;
    }

    /// [middle - radius, middle + radius] and [low, high], less the middle; a hair more.
    static Part common(double middle, double radius, double low, double high) {
        const double from = std::max(low - middle, -radius), to = std::min(high - middle, radius);
        return {0.5 * (from + to), 0.5 * (to - from) + Sheet::kHair};
    }

    const InversePlan& m_plan;
    const Mesh& m_mesh;
    double m_tol;
    Blocks& m_blocks;
    std::shared_ptr<Bicubics> m_bicubics;  ///< of m_blocks, if there are any
    BlockWriter m_writer;
    double m_x = 0, m_y = 0, m_hx = 0, m_hy = 0;  ///< the block's middle and half its size, target pixels
    int m_narrowings = 3;                         ///< steps that sheets are narrowed by, each to a quarter
    std::vector<Near> m_near;
    mutable std::array<KnownCell, 16> m_known;
    mutable std::size_t m_next_known = 0;
};

/// A mesh that pushes in windows (window_map.h): its inverse by blocks, in larger ones.
class InverseWindows final : public WindowSource {
  public:
    explicit InverseWindows(std::shared_ptr<const InversePlan> plan) : m_plan(std::move(plan)) {}

    Size target_size() const override { return m_plan->mesh().to(); }
    Size source_size() const override { return m_plan->mesh().from(); }
    bool exact(double x, double y, Point<double>& p) const override {
        int piece = 0;
        return m_plan->exact(x, y, 0, p, piece);
    }
    Jacobian jacobian(double x, double y) const override { return m_plan->jacobian(x, y, 0); }
    bool misses(const Interval& x, const Interval& y) const override {
        bool any = false;
        m_plan->tree().each({x.lo, y.lo, x.hi, y.hi}, [&](std::int32_t) { any = true; });
        return !any;
    }

    WindowCubic cubic_over(const Box& window, double most) const override {
        WindowCubic cubic = cubic_about(window);
        Blocks none;
        const LocalInverse inverse = InverseSubdivider(*m_plan, most, none).over(window);
        // In parameters between the centres of the outermost pixels, no product of powers is more than 1.
        const auto dropped = [](const double(&c)[4][4]) {
            return std::fabs(c[3][1]) + std::fabs(c[2][2]) + std::fabs(c[1][3]);
        };
        cubic.unit = 1 / half(window.width());
        for (int k = 0; k < 10; ++k) {
            cubic.cx[k] = inverse.x[WindowCubic::kAcross[k]][WindowCubic::kDown[k]];
            cubic.cy[k] = inverse.y[WindowCubic::kAcross[k]][WindowCubic::kDown[k]];
        }
        const double error = (inverse.error + hypot(dropped(inverse.x), dropped(inverse.y)) +
                              1.4143 * 0x1p-47 * cubic.size()) *
                             rounded_detail::kUp;
        if (!(error <= most)) return cubic;
        cubic.error = error;
        cubic.x = {window.x0 + 0.5, window.x1 - 0.5};
        cubic.y = {window.y0 + 0.5, window.y1 - 0.5};
        return cubic;
    }

    /// Where every point of the box has one source point: what exact() errs by, and by how much the inverse moves what is off. On a sheet
    /// z + N(z) = w, so that z changes by |Y| / (1 - kContraction) of it at most; from sheet to sheet the inverse goes on.
    double exact_error(const Interval& x, const Interval& y, double off) const override {
        const bool is_point = x.lo == x.hi && y.lo == y.hi && off == 0;
        double error = 0, slope = 0;
        bool on_fold = false, any = false;
        m_plan->tree().each({x.lo, y.lo, x.hi, y.hi}, [&](std::int32_t i) {
            const Sheet& sheet = m_plan->sheets()[static_cast<std::size_t>(i)];
            any = true;
            on_fold |= sheet.fold;
            if (sheet.fold) return;
            error = std::max(error, sheet.error);
            const MeshCell& cell = m_plan->cells()[static_cast<std::size_t>(sheet.cell)];
            slope = std::max(slope, hypot(sheet.hs * (cell.x1 - cell.x0), sheet.ht * (cell.y1 - cell.y0)) *
                                        sheet.to_parameters.norm() / (1 - Sheet::kContraction));
        });
        if (!any) return 0;
        if (is_point) return on_fold ? m_plan->preimages(x.lo, y.lo).error : error;
        Blocks none;
        switch (InverseSubdivider(*m_plan, HUGE_VAL, none).roots_over(x, y)) {
            case InverseSubdivider::Roots::none:
                return 0;
            case InverseSubdivider::Roots::one:
                return (error + slope * off) * rounded_detail::kUp;
            default:
                return HUGE_VAL;
        }
    }

    std::optional<Point<Interval>> points_of(const Interval& x, const Interval& y) const override {
        Blocks none;
        return InverseSubdivider(*m_plan, HUGE_VAL, none).points_over(x, y);
    }

  private:
    std::shared_ptr<const InversePlan> m_plan;
};

}  // namespace

InversePlan::InversePlan(Mesh mesh, WarpScheme scheme, double tol, const std::string& name)
    : WarpPlan(mesh.to().width, mesh.to().height, {Box{0, 0, mesh.to().width, mesh.to().height}}),
      m_mesh(std::move(mesh)),
      m_scheme(scheme),
      m_tol(tol) {
    check_tol(tol);
    m_mesh.each_cell(0, 0, m_mesh.from().width, m_mesh.from().height,
                     [&](const MeshCell& cell) { m_cells.push_back(cell); });
    SheetCutter cutter({0, 0, double(m_mesh.to().width), double(m_mesh.to().height)},
                       {kFoldSize, kMostCuts, kMostParts});
    for (std::size_t i = 0; i < m_cells.size(); ++i)
        if (!cutter.cut(cell(static_cast<int>(i))))
            throw Error(name + ": the mesh turns over at too many places to be inverted");
    m_sheets = std::move(cutter.sheets);
    m_tree = BoundsTree(std::move(cutter.bounds));
}

void InversePlan::plan(const Box& box, int, Blocks& blocks) const {
    InverseSubdivider subdivider(*this, m_tol, blocks);
    if (m_tol == 0 || m_scheme == WarpScheme::exact)
        subdivider.exact(box);
    else
        subdivider.region(box);
}

BlockPolynomial InversePlan::bicubic(const Block& block) const noexcept {
    return static_cast<const Bicubics&>(*block.data).polynomials[static_cast<std::size_t>(block.record)];
}

std::shared_ptr<const MapLink> InversePlan::link() const {
    const auto plan = std::static_pointer_cast<const InversePlan>(weak_from_this().lock());
    return !kIsSmall && plan && joins(m_scheme)
               ? window_link(std::make_shared<const InverseWindows>(plan), m_scheme, m_tol)
               : nullptr;
}

std::string InversePlan::why_unlinked() const {
    return joins(m_scheme) ? "has a mesh that pushes and bends too much" : BlockMap::why_unlinked();
}

Point<double> InversePlan::on_sheet(const Sheet& sheet, const Point<double>& z) const noexcept {
    return m_mesh.inside(m_mesh.patch(m_cells[static_cast<std::size_t>(sheet.cell)]),
                         sheet.s + sheet.hs * z.x, sheet.t + sheet.ht * z.y);
}

InversePlan::CellParts InversePlan::cell(int number) const {
    return {m_mesh, m_cells[static_cast<std::size_t>(number)], number};
}

bool InversePlan::find(const Sheet& sheet, double x, double y, Preimage& found) const noexcept {
    return find(sheet, m_mesh.patch(m_cells[static_cast<std::size_t>(sheet.cell)]), x, y, found);
}

bool InversePlan::find(const Sheet& sheet, const Patch& patch, double x, double y,
                       Preimage& found) const noexcept {
    Point<double> z{};
    const auto f = [&](const Point<double>& at) {
        return m_mesh.inside(patch, sheet.s + sheet.hs * at.x, sheet.t + sheet.ht * at.y);
    };
    if (!sheet.find(x, y, f, z)) return false;
    const bool at_edge = largest(z) >= 1 - 2 * sheet.hair;
    const double width = patch.x1 - patch.x0, height = patch.y1 - patch.y0;
    found = {{patch.x0 + (sheet.s + sheet.hs * z.x) * width, patch.y0 + (sheet.t + sheet.ht * z.y) * height},
             sheet.cell,
             sheet.to_parameters.determinant() * m_mesh.orientation() < 0,
             sheet.error,
             at_edge ? sheet.edge : 0,
             sheet.to_source(width, height)};
    return true;
}

bool InversePlan::before(const Preimage& a, const Preimage& b) const noexcept {
    if (a.turned != b.turned) return b.turned;
    const auto number = [&](const Preimage& p) {
        const MeshCell& c = m_cells[static_cast<std::size_t>(p.cell)];
        return std::int64_t{c.row >> c.level} * m_mesh.columns() + (c.column >> c.level);
    };
    const std::int64_t na = number(a), nb = number(b);
    if (na != nb) return na > nb;
    return a.at.y != b.at.y ? a.at.y > b.at.y : a.at.x > b.at.x;
}

Preimages InversePlan::preimages(double x, double y) const noexcept {
    PreimageSearch search(*this, x, y);
    m_tree.each({x, y, x, y}, [&](std::int32_t i) { search.look(m_sheets[static_cast<std::size_t>(i)]); });
    return search.result();
}

bool InversePlan::exact(double x, double y, int, Point<double>& source_point,
                        int& source_piece) const noexcept {
    const Preimages all = preimages(x, y);
    if (all.count == 0) return false;
    source_point = all.best.at;
    source_piece = 0;
    return true;
}

Jacobian InversePlan::jacobian(double x, double y, int) const noexcept {
    const Preimages all = preimages(x, y);
    if (all.count == 0) return {};
    using J = Jet1<double>;
    const MeshCell& cell = m_cells[static_cast<std::size_t>(all.best.cell)];
    const Point<J> f =
        m_mesh.at(m_mesh.patch(cell), J::variable(all.best.at.x, 1, 0), J::variable(all.best.at.y, 0, 1));
    const Matrix2 inverse = Matrix2{f.x.c[1], f.x.c[2], f.y.c[1], f.y.c[2]}.inverse();
    return {inverse.a11, inverse.a21, inverse.a12, inverse.a22};
}

float InversePlan::folds(double x, double y) const noexcept {
    const Preimages all = preimages(x, y);
    return static_cast<float>(std::max(all.count - 1, all.on_fold ? 1 : 0));
}

std::int64_t InversePlan::folded_pixels(const Box& box) const {
    // Polynomial blocks are proven to be one to one.
    std::int64_t count = 0;
    for (const std::int64_t region : regions_in(box))
        for (const Block& block : blocks(region)) {
            const Box part = intersection(block.box, box);
            if (block.kind == Block::Kind::exact && !part.empty()) count += WarpPlan::folded_pixels(part);
        }
    return count;
}

}  // namespace anamorph
