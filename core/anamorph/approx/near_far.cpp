// SPDX-License-Identifier: Apache-2.0
// Near/far with its proof.
//
// On a square cell, s and t in [-1, 1] across it, a line's weight is w = factor (a + r)^-b, and its
// displacement D is affine. The K x K tensor interpolant at Chebyshev's nodes of w and w D replaces them for
// lines that are far. For 0 < b <= 2 its error has a closed form, from three facts.
//
// (1) Interpolating f = 1 / q, q a polynomial without a root in [-1, 1], at the roots of T_K gives
//     f - p = T_K l f, with l the polynomial of degree < deg q that equals 1 / T_K at the roots of q: the
//     error is relative, |T_K| <= 1. For q = s + x, l = 1 / T_K(x). For q = |s - z|^2, l is the line through
//     1 / T_K at z and its conjugate. The error of s f has z / T_K(z) in its place.
// (2) Beside a line r is linear, and (x + s)^-b with 0 < b <= 1 is a mean of 1 / (s + x'), x' >= x, with
//     positive weights (Stieltjes); for 1 < b <= 2 it is a mean of products of two. Beyond a line's end r^2
//     is |s - z|^2 on each row, z complex, and (a + sqrt(r^2))^-b with 0 < b <= 2 is a Stieltjes function
//     of r^2 (it maps the upper half plane into the lower one): a mean of 1 / (|s - z|^2 + y), y >= 0, whose
//     poles lie farther off still. So the relative error is at most that of the nearest poles, where l and
//     its slope are bounded with |T_K(z)| >= sinh(K m), m = log rho(z), rho the sum of the half axes of the
//     ellipse with foci -1, 1 through z: both fall with rho.
//     The same for s f: beside the line s (1 + e s)^-b = ((1 + e s)^(1 - b) - (1 + e s)^-b) / e, two of these
//     (for b < 1 the first is a mean of 1 - y / (1 + e s + y)); beyond an end the line through z / T_K(z) is
//     s l less the slope of l times |s - z|^2.
// (3) In two dimensions f - I_s I_t f = (f - I_s f) + I_s (f - I_t f), hence E <= E_s + Lebesgue_K E_t, and
//     the same with s and t changed.
// (4) Where the cell does not touch the line, but the level of its ends, or its extension, crosses the cell,
//     w has a jump in its second derivative and is smooth on either side. With Peano's kernel of order 3 the
//     error is at most the jump times the kernel's supremum plus the greatest third derivative times the
//     kernel's integral. The jump is b w / ((a + r) r) times the square of the direction; the derivatives of
//     (a + r)^-b along a line are at most b (b + 1) w / r^2 and b (b + 2) k w / r^3, k = b + 1 or, where that
//     is more, 2 / sqrt(2 - b) (b < 1): r' is the cosine of the angle to the ray, r'' its sine^2 / r, r''' is
//     -3 cosine sine^2 / r^2. Any b.
//
// simd/near_far.cpp evaluates these (BesideError, EndError, BoundLines); tests/core holds them against errors
// of interpolants, and proves the kernel's supremum and integral. Lines that the cell touches are near.
//
// The displacement is S / W. With a sum off by dS and dW the quotient is off by (dS - D dW) / (W + dW). The
// interpolant is linear in f, so dS - D dW is what it makes of the sum of w_i (D_i - D): each line counts
// with |D_i - D| only. D is a mean of the D_i, which bounds |D - D*| for any reference D* (`spread`).
//
// Rounding: simd/near_far.h says what floats cost a line's sums. Near lines are seen from the cell's centre,
// so that numbers are small. A relative error e_i of a near line's weight moves the quotient by e_i w_i |D_i
// - D| / W, which stays small on the line itself: there D is D_i. Where a line's place, as a float, is too
// coarse for its a + r, the cell is fine: places are two floats (simd/near_far.h). Distances below 1e-6 are
// cut off, so where a is less than that, cells that a line touches are exact.
#include "anamorph/approx/near_far.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>

#include "anamorph/approx/near_far_line.h"
#include "anamorph/error.h"
#include "anamorph/parameter.h"
#include "anamorph/simd/near_far.h"

namespace anamorph {
namespace {

using simd::CellFrame;
using simd::FieldLine;
using simd::kComponents;
using simd::kMaxDegree;
using simd::kSums;
using simd::LineTable;

constexpr auto kHalfRegion = static_cast<double>(simd::kRegionHalf);
constexpr int kRegion = static_cast<int>(2 * kHalfRegion);
// Cells are not cut below this.
constexpr int kFloor = 4;
constexpr auto kFloatUlp = static_cast<double>(simd::kFloatRounding);
// A bound is made of sums over lines (off by kSumRounding each, in numerator and denominator) and of fewer
// than 100 more operations on floats, products of four at most of such sums: 8 (24) + 100 < 512 units.
constexpr double kBoundRounding = 512 * kFloatUlp;
// The part of the tolerance that interpolation may use; the rest is for rounding.
constexpr double kInterpolationShare = 0.9;
// Of the smallest cells where that leaves too little for the near lines' rounding.
constexpr double kSmallestShare = 0.45;
// And the part of what is left of it that a cell uses up for lines that are far already from a cell to be
// cut.
constexpr double kParentShare = 0.25;
constexpr std::size_t kCoefficients = kMaxDegree * kMaxDegree * 8;

using Vector = std::array<double, kComponents>;

/// The longer of a vector's two halves: the displacements of the shapes.
double length_of(const Vector& v) {
    return std::sqrt(std::max(v[0] * v[0] + v[1] * v[1], v[2] * v[2] + v[3] * v[3]));
}

/// Interpolation at the K roots of T_K.
struct Chebyshev {
    int k;
    float nodes[kMaxDegree];
    double lebesgue;
    /// From values at the nodes to coefficients of powers.
    double powers[kMaxDegree * kMaxDegree];
    /// From coefficients in s to those in s' where s = (s' -+ 1) / 2: the left and the right half.
    double halves[2][kMaxDegree * kMaxDegree];

    explicit Chebyshev(int degree) : k(degree) {
        double node[kMaxDegree];
        lebesgue = 0;
        for (int i = 0; i < k; ++i) {
            const double angle = (2 * i + 1) * std::numbers::pi / (2 * k);
            // What is evaluated are floats; the interpolant is exact for them.
            nodes[i] = static_cast<float>(std::cos(angle));
            node[i] = nodes[i];
            lebesgue += 1 / std::tan(angle / 2) / k;
        }
        // Nodes are rounded by u / 2 each, and Lagrange's polynomials have slopes below K^2 Lebesgue_K
        // (Markov): the sum of K of them moves by K^3 u / 2 of itself, at most 256 u.
        lebesgue *= 1 + 512 * kFloatUlp;
        // Lagrange's polynomials, multiplied out.
        for (int i = 0; i < k; ++i) {
            double c[kMaxDegree] = {1};
            int degree_so_far = 0;
            for (int j = 0; j < k; ++j) {
                if (j == i) continue;
                const double scale = 1 / (node[i] - node[j]);
                for (int m = ++degree_so_far; m >= 0; --m)
                    c[m] = scale * ((m > 0 ? c[m - 1] : 0) - (m < degree_so_far ? node[j] * c[m] : 0));
            }
            for (int m = 0; m < k; ++m) powers[m * k + i] = c[m];
        }
        for (int half = 0; half < 2; ++half) {
            const double shift = half ? 0.5 : -0.5;
            for (int n = 0; n < k; ++n) {
                // (shift + s' / 2)^n
                double binomial = 1;
                for (int m = 0; m <= n; ++m) {
                    halves[half][m * k + n] = binomial * std::pow(shift, n - m) * std::pow(0.5, m);
                    binomial = binomial * (n - m) / (m + 1);
                }
                for (int m = n + 1; m < k; ++m) halves[half][m * k + n] = 0;
            }
        }
    }
};

/// Coefficients each way that make a tolerance cheapest (measured).
int degree_for(double tol) {
    return tol >= 0.03 ? 4 : tol >= 2e-3 ? 5 : tol >= 2e-4 ? 6 : 8;
}

struct Cell {
    Box box;
    bool exact;
    double bound;  ///< not of exact cells
    CellFrame frame;
    std::int32_t base[kComponents];
    std::size_t coefficients, near;  ///< where they begin in the region's lists
    int near_count;
    bool fine;  ///< how near lines are placed
};

struct Region final : RegionData {
    std::vector<Cell> cells;
    std::vector<float> coefficients;
    std::vector<FieldLine> lines;  ///< that are near, cell by cell, as seen from the cell's centre
    Vector origin;                 ///< source point of the region's centre under the reference displacement
};

/// Lines and what is known of them over the cell at hand; one for each depth of the recursion.
class Candidates {
  public:
    /// All lines of a region.
    void take(const std::vector<FieldLine>& all, const std::vector<float>& slopes) {
        reset(all.size());
        own_table();
        for (std::size_t i = 0; i < all.size(); ++i) {
            const FieldLine& l = all[i];
            m_own_ids[i] = static_cast<std::int32_t>(i);
            m_factor[i] = l.factor;
            const auto put = [&](std::size_t f, float v) { m_own[f * m_stride + i] = v; };
            put(LineTable::kBefore, l.before);
            put(LineTable::kBehind, l.behind);
            put(LineTable::kBeside, l.beside);
            put(LineTable::kAlongX, l.along_x);
            put(LineTable::kAlongY, l.along_y);
            put(LineTable::kSlope, slopes[i]);
            for (std::size_t c = 0; c < kComponents; ++c) {
                put(LineTable::kAt + c, l.at[c]);
                put(LineTable::kRight + c, l.right[c]);
                put(LineTable::kDown + c, l.down[c]);
            }
        }
    }
    /// The near lines of another: in its table, the others with factor 0, or in one of their own where that
    /// is shorter.
    void take_near(const Candidates& from) {
        const auto count = static_cast<std::size_t>(from.near_count);
        if (padded(count) == from.m_stride) {
            reset(from.m_count);
            m_table = from.m_table;
            m_ids = from.m_ids;
            for (std::size_t j = 0; j < count; ++j) {
                const auto i = static_cast<std::size_t>(from.near[j]);
                m_factor[i] = from.m_factor[i];
            }
            return;
        }
        reset(count);
        own_table();
        for (std::size_t f = 0; f < LineTable::kFields; ++f)
            for (std::size_t j = 0; j < count; ++j)
                m_own[f * m_stride + j] =
                    from.m_table[f * from.m_stride + static_cast<std::size_t>(from.near[j])];
        for (std::size_t j = 0; j < count; ++j) {
            const auto i = static_cast<std::size_t>(from.near[j]);
            m_factor[j] = from.m_factor[i];
            m_own_ids[j] = from.m_ids[i];
        }
    }

    LineTable table() const {
        return {m_table, static_cast<std::ptrdiff_t>(m_stride), m_factor.data(), static_cast<int>(m_count)};
    }
    float slope(std::size_t i) const { return m_table[LineTable::kSlope * m_stride + i]; }
    /// A line's number in the region's list of all.
    std::int32_t id(std::int32_t i) const { return m_ids[i]; }

    simd::LineBounds bounds() {
        return {array(0), array(1), array(2), array(3), array(4), {array(5), array(6), array(7), array(8)},
                {},       0};
    }
    float* reach() { return array(9); }
    float* error() { return array(10); }

    /// Marks lines far, those of least error first, as long as their errors fit the budget.
    simd::LineSums select(const simd::LineBounds& bounds, float spread, float unit) {
        const simd::Selection s = simd::select_lines(table(), bounds, reach(), error(), spread, unit,
                                                     array(11), near.data(), far.data());
        near_count = s.near;
        far_count = s.far;
        return s.sums;
    }
    std::vector<std::int32_t> near, far;  ///< places in the table
    int near_count = 0, far_count = 0;

    /// The polynomial that the cell has from the cells above it; lane 5 to 7 of each coefficient are 0.
    alignas(64) double polynomial[kCoefficients];

  private:
    static constexpr std::size_t kBounds = 12;
    static std::size_t padded(std::size_t count) { return (count + 15) / 16 * 16; }

    void reset(std::size_t count) {
        m_count = count;
        m_stride = padded(count);
        if (m_bounds.size() < kBounds * m_stride) m_bounds.resize(kBounds * m_stride);
        if (near.size() < m_stride + 16) {
            near.resize(m_stride + 16);
            far.resize(m_stride + 16);
        }
        m_factor.assign(m_stride, 0.0f);
    }
    void own_table() {
        if (m_own.size() < LineTable::kFields * m_stride) m_own.resize(LineTable::kFields * m_stride);
        m_own_ids.resize(m_count);
        // Lines of factor 0 fill up the last vector, far from everything.
        for (std::size_t f = 0; f < LineTable::kFields; ++f)
            for (std::size_t i = m_count; i < m_stride; ++i)
                m_own[f * m_stride + i] = f == LineTable::kBefore   ? 1e6f
                                          : f == LineTable::kAlongX ? 1.0f
                                                                    : 0.0f;
        m_table = m_own.data();
        m_ids = m_own_ids.data();
    }
    float* array(std::size_t k) { return m_bounds.data() + k * m_stride; }

    std::size_t m_count = 0, m_stride = 0;
    const float* m_table = nullptr;
    const std::int32_t* m_ids = nullptr;
    std::vector<float> m_own, m_factor, m_bounds;
    std::vector<std::int32_t> m_own_ids;
};

/// Adds sums over other lines, all with reaches from the same reference.
void add(simd::LineSums& to, const simd::LineSums& more) {
    to.value += more.value;
    to.error += more.error;
    to.least += more.least;
    to.most += more.most;
    to.reach += more.reach;
    to.slope += more.slope;
    to.near += more.near;
    to.near_reach += more.near_reach;
    to.farthest = std::max(to.farthest, more.farthest);
}

/// Sums over the lines that are far already, their reaches from `center`.
struct FarSums : simd::LineSums {
    Vector center{};

    void move(const Vector& to) {
        Vector d;
        for (std::size_t c = 0; c < kComponents; ++c) d[c] = to[c] - center[c];
        const double shift = length_of(d);
        error += shift * value;
        reach += shift * most;
        near_reach += shift * near;
        farthest += shift;
        center = to;
    }
};

/// Plans one region.
class Planner {
  public:
    Planner(const FeatureMap& map, const NearFarOptions& options, const Chebyshev& chebyshev,
            const std::vector<float>& slopes)
        : m_map(map),
          m_options(options),
          m_chebyshev(chebyshev),
          m_slopes(slopes),
          m_picture{0, 0, map.target().width, map.target().height},
          m_weights{static_cast<float>(map.weights().a), static_cast<float>(map.weights().b)} {}

    void plan(int x0, int y0, Region& region) {
        m_region = &region;
        region.cells.reserve(64);
        region.lines.reserve(128);
        region.coefficients.reserve(64 * 8 * static_cast<std::size_t>(m_chebyshev.k * m_chebyshev.k));
        m_x = x0 + kHalfRegion;
        m_y = y0 + kHalfRegion;
        if (!gather()) return exact(x0, y0, kRegion);
        level(0).take(m_lines, m_slopes);
        settle(x0, y0, kRegion, 0, FarSums{}, false);
    }

  private:
    Candidates& level(std::size_t depth) {
        if (m_levels.size() <= depth) m_levels.resize(depth + 1);
        if (!m_levels[depth]) m_levels[depth] = std::make_unique<Candidates>();
        return *m_levels[depth];
    }

    /// The lines as seen from the region's centre. False where floats cannot hold them.
    bool gather() {
        const std::vector<int>& shapes = m_options.shapes;
        for (std::size_t n = 0; n < shapes.size(); ++n) {
            const Point<double> at = m_map(m_x, m_y, shapes[n]), scale = m_map.scale(shapes[n]);
            m_region->origin[2 * n] = at.x;
            m_region->origin[2 * n + 1] = at.y;
            m_reference[2 * n] = at.x - m_x * scale.x;
            m_reference[2 * n + 1] = at.y - m_y * scale.y;
        }
        // Weights in units of what a line at this distance has, so that floats hold them.
        double unit = HUGE_VAL, farthest = 1;
        for (std::size_t i = 0; i < m_map.size(); ++i) {
            const FeatureMap::TargetLine& line = m_map.line(i);
            const double distance = kHalfRegion + m_map.distance(line, m_map.frame(line, m_x, m_y));
            unit = std::min(unit, distance);
            farthest = std::max(farthest, distance + kHalfRegion);
        }
        const double a = m_map.weights().a, b = m_map.weights().b;
        m_unit = std::pow(unit, b);
        // Where a power is less than floats hold, they have no bound in proportion. What else comes out too
        // small, a product with a factor, is off by less than 2^-126, a million lines by 1e-32: nothing
        // beside a sum above 1e-20.
        if (!(std::pow(farthest, -b) > 1e-36)) return false;
        const double log = std::max(std::log(farthest), -std::log(std::max<double>(a, simd::kLeastDistance)));
        m_constant = kFloatUlp * simd::weight_rounding(b, log);
        m_by_nearest = kFloatUlp * b;
        m_weights.log = static_cast<float>(log * (1 + kBoundRounding));
        m_lines.resize(m_map.size());
        for (std::size_t i = 0; i < m_map.size(); ++i)
            if (!see(i, m_x, m_y, m_lines[i]) || !(m_slopes[i] < 1e9f)) return false;
        return true;
    }

    /// A line as seen from a point, its displacement from the reference. False where floats cannot hold it.
    bool see(std::size_t i, double x, double y, FieldLine& to) const {
        to = seen_from(m_map, i, m_options.shapes, x, y, m_reference.data(), m_unit);
        return to.factor > 1e-25f && to.factor < 1e25f && std::fabs(to.before) < 1e12f;
    }

    // --- a cell ------------------------------------------------------------------------------------------

    /// What is known of a cell beside its lines' own bounds.
    struct Known {
        CellFrame frame;
        Vector center;    ///< displacement at the centre
        double least;     ///< sum of weights, at least
        double mean;      ///< the mean of |D_i - center|, at most
        double spread;    ///< |D - center|, at most
        double offset;    ///< length of `center`
        double farthest;  ///< the greatest of them
        bool finite;
    };

    /// `sums`: over the lines that are in the polynomial of `level(depth)` already, if it has one.
    void settle(int x0, int y0, int size, std::size_t depth, FarSums sums, bool has_polynomial) {
        const Box box = intersection({x0, y0, x0 + size, y0 + size}, m_picture);
        if (box.empty()) return;
        Candidates& lines = level(depth);
        simd::LineBounds bounds = lines.bounds();
        const Known known = look(x0, y0, size, lines, bounds, sums, has_polynomial);
        const auto budget = [&](double share) { return share * m_options.tol - quotient_error(sums, known); };
        const auto fits = [&](double share) {
            FarSums all = sums;
            add(all, select(lines, bounds, known, budget(share)));
            return (lines.near_count <= most_near(size) || size <= kFloor) &&
                   emit(box, lines, bounds, known, all, has_polynomial);
        };
        if (known.finite && size <= Block::kMaxSide) {
            if (fits(kInterpolationShare)) return;
            if (lines.near_count <= most_near(size) && base_rounding(known, lines.near_count) > m_options.tol)
                return exact(x0, y0, size);
        }
        if (size <= kFloor) {
            if (!known.finite || !fits(kSmallestShare)) exact(x0, y0, size);
            return;
        }
        divide(x0, y0, size, depth, bounds, known, sums, kParentShare * budget(kInterpolationShare),
               has_polynomial);
    }

    Known look(int x0, int y0, int size, Candidates& lines, simd::LineBounds& bounds, FarSums& sums,
               bool has_polynomial) const {
        Known known;
        known.frame = {static_cast<float>(x0 + 0.5 * size - m_x), static_cast<float>(y0 + 0.5 * size - m_y),
                       static_cast<float>(0.5 * size)};
        simd::bound_lines(lines.table(), known.frame, m_weights, m_chebyshev.k,
                          static_cast<float>(m_chebyshev.lebesgue), bounds);
        // Any displacement serves as a reference; the one at the centre is best.
        float center[kComponents];
        const auto at_center = [&](std::size_t c) {
            return bounds.center[c] + (has_polynomial ? lines.polynomial[c] : 0);
        };
        for (std::size_t c = 0; c < kComponents; ++c) {
            center[c] = static_cast<float>(at_center(c + 1) / at_center(0));
            known.center[c] = static_cast<double>(center[c]);
        }
        sums.move(known.center);
        known.offset = length_of(known.center);
        known.least = (bounds.least_sum + sums.least) * (1 - 2 * simd::kSumRounding);
        known.finite = known.least > 1e-20 && known.least < HUGE_VAL && known.offset < HUGE_VAL;
        const simd::SpreadSums over = simd::bound_displacements(
            lines.table(), known.frame, center, static_cast<float>(0.25 * known.least),
            static_cast<float>(known.offset * node_sum_rounding()), bounds, lines.reach(), lines.error());

        // D is a mean of the D_i: no farther off than the farthest, and lines of little weight count by that.
        // And D - center is the mean of (w_i - w_i at the centre) (D_i - center) and of w_i at the centre
        // times the change of D_i, since the sum of w_i (D_i - center) is 0 there but for the polynomial's
        // errors and the rounding of what `center` was made of: weights, sums and the quotient.
        const double half = static_cast<double>(known.frame.half), b = m_map.weights().b;
        known.farthest = std::max(sums.farthest, over.farthest);
        const double rounding = center_rounding(sums.reach + over.reach, sums.near_reach + over.near_reach,
                                                sums.most + over.most, sums.slope + over.slope, known.offset);
        const double change = (half * (std::numbers::sqrt2 * b * (sums.near_reach + over.near_reach) +
                                       sums.slope + over.slope) +
                               sums.error + rounding) /
                              known.least;
        const double mean = std::min((sums.reach + over.light) / known.least + over.heavy, known.farthest);
        known.mean = mean * (1 + kBoundRounding);
        known.spread = std::min(mean, change) * (1 + kBoundRounding);
        return known;
    }

    /// Of the quotient, by interpolation and by rounding at the nodes.
    double quotient_error(const FarSums& sums, const Known& known) const {
        return (sums.error + known.spread * sums.value + known.offset * node_sum_rounding() * sums.most) /
               known.least;
    }
    /// What adding up in floats at the nodes does to an interpolant.
    double node_sum_rounding() const {
        return m_chebyshev.lebesgue * m_chebyshev.lebesgue * simd::kNodeRounding;
    }

    static simd::LineSums select(Candidates& lines, const simd::LineBounds& bounds, const Known& known,
                                 double budget) {
        const double unit = budget > 0 ? 1 / (known.least * budget) : HUGE_VAL;
        return lines.select(bounds, static_cast<float>(known.spread),
                            static_cast<float>(std::min(unit, 1e30)));
    }

    /// How many near lines a cell of this size may have before it is cut (measured).
    static int most_near(int size) { return size >= 64 ? 3 : size >= 32 ? 10 : 16; }

    void divide(int x0, int y0, int size, std::size_t depth, const simd::LineBounds& bounds,
                const Known& known, FarSums sums, double budget, bool has_polynomial) {
        // Lines that are far from the whole cell go into its polynomial.
        Candidates& lines = level(depth);
        Candidates& rest = level(depth + 1);
        alignas(64) double polynomial[kCoefficients];
        const double* whole = lines.polynomial;
        add(sums, select(lines, bounds, known, known.finite ? budget : 0));
        if (lines.far_count > 0) {
            interpolate(lines, known.frame, has_polynomial, polynomial);
            whole = polynomial;
            has_polynomial = true;
        }
        rest.take_near(lines);

        const int half = size / 2;
        for (int child = 0; child < 4; ++child) {
            const int right = child & 1, below = child >> 1;
            if (has_polynomial)
                simd::shift(m_chebyshev.halves[below], m_chebyshev.halves[right], m_chebyshev.k, whole,
                            rest.polynomial);
            settle(x0 + right * half, y0 + below * half, half, depth + 1, sums, has_polynomial);
        }
    }

    /// The polynomial of a cell: what it has from above and the interpolant of the far lines' sums.
    void interpolate(const Candidates& lines, const CellFrame& frame, bool has_polynomial, double* to) {
        const int k = m_chebyshev.k;
        const auto size = static_cast<std::size_t>(k * k * 8);
        if (lines.far_count == 0) {
            std::copy_n(lines.polynomial, size, to);
            return;
        }
        m_far.clear();
        for (int j = 0; j < lines.far_count; ++j)
            m_far.push_back(lines.id(lines.far[static_cast<std::size_t>(j)]));
        alignas(64) double sums[kCoefficients];
        std::fill_n(sums, size, 0.0);
        simd::node_sums(m_lines.data(), m_far.data(), lines.far_count, frame, m_weights, k, m_chebyshev.nodes,
                        sums);
        simd::transform(m_chebyshev.powers, m_chebyshev.powers, k, sums,
                        has_polynomial ? lines.polynomial : nullptr, to);
    }

    // --- rounding ----------------------------------------------------------------------------------------

    /// Of the displacement at the centre times the sum of weights, from sums over all lines: m r, m r / d, m,
    /// m times the displacement's change per pixel. Of what a polynomial adds up, interpolation makes
    /// Lebesgue_K^2 as much.
    double center_rounding(double reach, double near_reach, double most, double slope, double offset) const {
        const double sums = (2 * simd::kSumRounding + 4 * kFloatUlp) * (reach + offset * most);
        return m_chebyshev.lebesgue * m_chebyshev.lebesgue *
               (m_constant * reach + m_by_nearest * 11 * kHalfRegion * near_reach + sums +
                10 * kFloatUlp * kHalfRegion * slope);
    }

    double scale() const {
        double most = 0;
        for (const int k : m_options.shapes) most = std::max({most, m_map.scale(k).x, m_map.scale(k).y});
        return most;
    }

    /// Of adding up, dividing and placing: what no cutting of cells reduces.
    double base_rounding(const Known& known, int near) const {
        // The near lines' sums and the quotient: in numerator and denominator a product and a sum for each
        // line, 3 more for the polynomial and the quotient.
        const double value = known.mean + known.offset;
        const double sums = (2 * static_cast<double>(simd::near_additions(near)) + 6) * value;
        // offset + slope x, x up to half the cell, and the quotient added to it, on each axis: the offset is
        // below 1 + |center| and rounded 3 times, slope x 4 times, the displacement once.
        const double placed =
            3 * (1 + known.offset) + 4 * scale() * static_cast<double>(known.frame.half) + value;
        return kFloatUlp * (sums + std::numbers::sqrt2 * placed);
    }

    /// Of a polynomial's coefficients and of Horner's rule: `size`, the sums of the coefficients' sizes.
    double far_rounding(const Known& known, const float* size) const {
        const double moved = static_cast<double>(std::max(size[1] + size[2], size[3] + size[4]));
        return kFloatUlp * (4 * m_chebyshev.k + 4) *
               (moved + (known.spread + known.offset) * static_cast<double>(size[0])) / known.least;
    }

    /// What the near lines' rounding is made of: sums of how far a unit of a weight's relative error moves D,
    /// and one of its error by the place, per pixel; the least a + dist; and their displacements'.
    struct NearRounding {
        double moved = 0, moved_by_place = 0, nearest = HUGE_VAL, displacements = 0;
    };
    /// A weight off by a factor 1 + e moves D by e l |D_i - D|, l the weight's part of all, which is l (1 -
    /// l) times the distance of D_i from the mean of the others.
    NearRounding near_rounding(Candidates& lines, const simd::LineBounds& bounds, const Known& known,
                               const FarSums& far) const {
        const double b = m_map.weights().b, half = static_cast<double>(known.frame.half);
        NearRounding out;
        double slope = 0;
        // For the mean of the others: lines of little weight count by that, the two farthest of the rest.
        const double much = 0.25 * known.least;
        double all = far.most, light = far.reach, farthest = 0, second = 0;
        std::size_t farthest_line = lines.near.size();
        for (std::size_t j = 0; j < static_cast<std::size_t>(lines.near_count); ++j) {
            const auto i = static_cast<std::size_t>(lines.near[j]);
            const double most = static_cast<double>(bounds.most[i]),
                         reach = static_cast<double>(lines.reach()[i]);
            all += most;
            if (most <= much)
                light += most * reach;
            else if (reach >= farthest) {
                second = farthest;
                farthest = reach;
                farthest_line = i;
            } else
                second = std::max(second, reach);
        }
        for (std::size_t j = 0; j < static_cast<std::size_t>(lines.near_count); ++j) {
            const auto i = static_cast<std::size_t>(lines.near[j]);
            slope = std::max(slope, static_cast<double>(lines.slope(i)));
            const double reach = static_cast<double>(lines.reach()[i]);
            const double most = static_cast<double>(bounds.most[i]);
            const double nearest = static_cast<double>(bounds.nearest[i]);
            const double rest = known.least - static_cast<double>(bounds.least[i]);
            const double mean =
                (light - (most <= much ? most * reach : 0)) / rest + (i == farthest_line ? second : farthest);
            const double part = std::min(1.0, most / known.least);
            const double between = reach + (rest > 0 ? std::min(mean, known.farthest) : known.farthest);
            const double moved = std::min(part * (reach + known.spread), std::min(part, 0.25) * between);
            // The weight is most (nearest / d)^b at distance d, and with it 1 - l at most others / weight. An
            // error that falls with d is worst at the nearest distance, or with b >= 1 where that is as good
            // as `moved`. The millionth keeps the difference from being nothing but rounding: `all` is off by
            // less than that of the sum.
            const double others = std::max(all - most, 0.0) + 1e-6 * most;
            const double ratio = std::max(most * moved / (others * between + 1e-300), 1.0);
            const double by = b == 2 ? std::sqrt(ratio) : b <= 1 ? ratio : std::pow(ratio, 1 / b);
            out.moved += moved;
            out.moved_by_place += moved / (nearest * by);
            out.nearest = std::min(out.nearest, nearest);
        }
        out.displacements = kFloatUlp * (4 * (known.mean + known.offset) + 10 * half * slope);
        return out;
    }
    double near_rounding(const NearRounding& near, bool fine, double half) const {
        const double place = m_by_nearest * (fine ? simd::kFineRounding : 11 * half);
        // Where distances are cut off, weights have no bound.
        constexpr auto kLeast = static_cast<double>(simd::kLeastDistance);
        if (near.nearest <= kLeast && m_map.weights().a < kLeast) return HUGE_VAL;
        const double worst = m_constant + place / near.nearest;
        if (!(worst < 0.25)) return HUGE_VAL;
        return (m_constant * near.moved + place * near.moved_by_place) / (1 - worst) + near.displacements;
    }

    // --- results -----------------------------------------------------------------------------------------

    /// Keeps the cell if its bound holds the tolerance.
    bool emit(const Box& box, Candidates& lines, const simd::LineBounds& bounds, const Known& known,
              const FarSums& sums, bool has_polynomial) {
        const int near = lines.near_count;
        const double off = sums.value / known.least;
        if (!(off < 0.05)) return false;
        const double half = static_cast<double>(known.frame.half);
        const NearRounding rounding = near_rounding(lines, bounds, known, sums);
        const double before = quotient_error(sums, known) + base_rounding(known, near);
        if (!(before + near_rounding(rounding, true, half) <= m_options.tol)) return false;

        const bool any = has_polynomial || lines.far_count > 0;
        float coefficients[kCoefficients];
        double whole = before;
        if (any) {
            alignas(64) double polynomial[kCoefficients];
            interpolate(lines, known.frame, has_polynomial, polynomial);
            float sizes[8];
            simd::round_coefficients(polynomial, m_chebyshev.k, coefficients, sizes);
            whole += far_rounding(known, sizes);
        }
        const auto bound_of = [&](bool fine) {
            return (whole + near_rounding(rounding, fine, half)) / (1 - off) * (1 + kBoundRounding);
        };
        const bool fine = !(bound_of(false) <= m_options.tol);
        const double bound = bound_of(fine);
        if (!(bound <= m_options.tol)) return false;

        Cell cell{box, false, bound, known.frame, {}, m_region->coefficients.size(), m_region->lines.size(),
                  0,   fine};
        const std::vector<int>& shapes = m_options.shapes;
        for (std::size_t n = 0; n < shapes.size(); ++n) {
            const Point<double> s = m_map.scale(shapes[n]);
            const double x =
                m_region->origin[2 * n] + s.x * static_cast<double>(known.frame.x) + known.center[2 * n];
            const double y = m_region->origin[2 * n + 1] + s.y * static_cast<double>(known.frame.y) +
                             known.center[2 * n + 1];
            if (!(std::fabs(x) < 1 << 30 && std::fabs(y) < 1 << 30)) return false;
            cell.base[2 * n] = static_cast<std::int32_t>(std::floor(x));
            cell.base[2 * n + 1] = static_cast<std::int32_t>(std::floor(y));
        }
        if (any)
            m_region->coefficients.insert(m_region->coefficients.end(), coefficients,
                                          coefficients + m_chebyshev.k * m_chebyshev.k * 8);
        else
            cell.coefficients = std::numeric_limits<std::size_t>::max();
        for (int j = 0; j < near; ++j) {
            FieldLine seen;
            see(static_cast<std::size_t>(lines.id(lines.near[static_cast<std::size_t>(j)])),
                m_x + static_cast<double>(known.frame.x), m_y + static_cast<double>(known.frame.y), seen);
            m_region->lines.push_back(seen);
        }
        cell.near_count = near;
        m_region->cells.push_back(cell);
        return true;
    }

    /// Exact blocks on a square.
    void exact(int x0, int y0, int size) {
        for (int y = y0; y < y0 + size; y += Block::kMaxSide)
            for (int x = x0; x < x0 + size; x += Block::kMaxSide) {
                const int side = std::min(size, Block::kMaxSide);
                const Box box = intersection({x, y, x + side, y + side}, m_picture);
                if (!box.empty()) m_region->cells.push_back({box, true, 0, {}, {}, 0, 0, 0, false});
            }
    }

    const FeatureMap& m_map;
    const NearFarOptions& m_options;
    const Chebyshev& m_chebyshev;
    const std::vector<float>& m_slopes;
    const Box m_picture;
    Region* m_region = nullptr;
    simd::WeightParameters m_weights;
    double m_x = 0, m_y = 0;  ///< the region's centre
    double m_unit = 1;        ///< of weights
    /// Relative errors of weights: by rounding, and by that of the place, per pixel and a + dist.
    double m_constant = 0, m_by_nearest = 0;
    Vector m_reference{};  ///< displacements are relative to this
    std::vector<FieldLine> m_lines;
    std::vector<std::int32_t> m_far;
    std::vector<std::unique_ptr<Candidates>> m_levels;
};

}  // namespace

struct NearFar::State {
    NearFarOptions options;
    Chebyshev chebyshev;
    std::vector<float> slopes;  ///< line by line: the most that its displacement changes over a pixel
    /// Planners keep their memory from region to region.
    std::mutex mutex;
    std::vector<std::unique_ptr<Planner>> idle;

    State(const FeatureMap& map, const NearFarOptions& near_far)
        : options(near_far), chebyshev(degree_for(near_far.tol)) {
        if (options.tol == 0) return;
        constexpr double kNowhere[kComponents] = {};
        for (std::size_t i = 0; i < map.size(); ++i) {
            const FieldLine l = seen_from(map, i, options.shapes, 0, 0, kNowhere, 1);
            double slope = 0;
            for (int c = 0; c < kComponents; c += 2) {
                const auto length = [](float x, float y) {
                    return std::sqrt(static_cast<double>(x) * static_cast<double>(x) +
                                     static_cast<double>(y) * static_cast<double>(y));
                };
                slope =
                    std::max(slope, length(l.right[c], l.right[c + 1]) + length(l.down[c], l.down[c + 1]));
            }
            slopes.push_back(static_cast<float>(slope * (1 + 1e-5) + 1e-12));
        }
    }

    std::unique_ptr<Planner> take_planner(const FeatureMap& map) {
        const std::lock_guard lock(mutex);
        if (idle.empty()) return std::make_unique<Planner>(map, options, chebyshev, slopes);
        std::unique_ptr<Planner> planner = std::move(idle.back());
        idle.pop_back();
        return planner;
    }
    void give_back(std::unique_ptr<Planner> planner) {
        const std::lock_guard lock(mutex);
        idle.push_back(std::move(planner));
    }
};

NearFar::NearFar(const FeatureMap& map, const NearFarOptions& options) : FeatureBlocks(map, options.shapes) {
    if (!(options.tol >= 0 && options.tol < HUGE_VAL))
        throw Error("tol", shortest(options.tol),
                    "must be 0 (exact) or a finite number of source pixels above it");
    m_state = std::make_unique<State>(map, options);
}
NearFar::~NearFar() = default;

void NearFar::plan(const Box& box, int, Blocks& blocks) const {
    if (m_state->options.tol == 0) {
        each_square(box, [&](const Box& square) { add_exact(square, blocks); });
        return;
    }
    const auto region = std::make_shared<Region>();
    std::unique_ptr<Planner> planner = m_state->take_planner(map());
    planner->plan(box.x0, box.y0, *region);
    m_state->give_back(std::move(planner));

    blocks.reserve(region->cells.size() * static_cast<std::size_t>(layers()));
    for (std::size_t i = 0; i < region->cells.size(); ++i) {
        const Cell& cell = region->cells[i];
        if (cell.exact)
            add_exact(cell.box, blocks);
        else
            for (int k = 0; k < layers(); ++k) {
                Block block;
                block.box = cell.box;
                block.kind = Block::Kind::computed;
                block.piece = k;
                block.base_x = cell.base[2 * k];
                block.base_y = cell.base[2 * k + 1];
                block.bound = cell.bound;
                block.data = region.get();
                block.record = static_cast<int>(i);
                blocks.push_back(block);
            }
    }
    blocks.data = region;
}

namespace {

/// Pixels `part` of a cell, for all layers: x and y of the first from to[0] and to[1] on, and so on.
void cell_points(const FeatureMap& map, const std::vector<int>& shapes, int degree, const Region& region,
                 const Cell& cell, const Box& part, float* const* to, std::ptrdiff_t stride) {
    // In the frame of the cell's centre.
    simd::FieldCell field{{0, 0, cell.frame.half},
                          0,
                          nullptr,
                          region.lines.data() + cell.near,
                          cell.near_count,
                          {static_cast<float>(map.weights().a), static_cast<float>(map.weights().b)},
                          cell.fine};
    if (cell.coefficients != std::numeric_limits<std::size_t>::max()) {
        field.k = degree;
        field.coefficients = region.coefficients.data() + cell.coefficients;
    }
    // Regions stand on multiples of their size.
    const auto from_center = [](int pixel, float center) {
        return static_cast<float>(pixel % kRegion + 0.5 - kHalfRegion - static_cast<double>(center));
    };
    simd::FieldOutput out{};
    out.x = from_center(part.x0, cell.frame.x);
    out.y = from_center(part.y0, cell.frame.y);
    out.width = part.width();
    out.height = part.height();
    out.components = 2 * static_cast<int>(shapes.size());
    out.stride = stride;
    for (std::size_t n = 0; n < shapes.size(); ++n) {
        const Point<double> scale = map.scale(shapes[n]);
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const std::size_t c = 2 * n + axis;
            const double slope = axis ? scale.y : scale.x;
            const double center = static_cast<double>(axis ? cell.frame.y : cell.frame.x);
            out.slope[c] = static_cast<float>(slope);
            out.offset[c] = static_cast<float>(region.origin[c] + slope * center - cell.base[c]);
            out.to[c] = to[c];
        }
    }
    simd::field_points(field, out);
}

}  // namespace

void NearFar::computed(std::span<const Block> layers, const PointRows* to) const noexcept {
    const auto& region = static_cast<const Region&>(*layers.front().data);
    float* planes[kComponents] = {};
    for (std::size_t k = 0; k < layers.size(); ++k) {
        planes[2 * k] = to[k].x;
        planes[2 * k + 1] = to[k].y;
    }
    cell_points(map(), shapes(), m_state->chebyshev.k, region,
                region.cells[static_cast<std::size_t>(layers.front().record)], layers.front().box, planes,
                to->stride);
}

void NearFar::computed_row(const Block& block, int row, int begin, int end, float* x,
                           float* y) const noexcept {
    const auto& region = static_cast<const Region&>(*block.data);
    const Box& box = block.box;
    constexpr int kRoom = Block::kMaxSide + 16;
    float others[2][kRoom];
    // What the other layer has there comes with it and is not wanted.
    float* planes[kComponents] = {others[0], others[1], others[0], others[1]};
    planes[2 * layer_of(block)] = x;
    planes[2 * layer_of(block) + 1] = y;
    cell_points(map(), shapes(), m_state->chebyshev.k, region,
                region.cells[static_cast<std::size_t>(block.record)],
                {box.x0 + begin, box.y0 + row, box.x0 + end, box.y0 + row + 1}, planes, kRoom);
}

}  // namespace anamorph
