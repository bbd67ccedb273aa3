// SPDX-License-Identifier: Apache-2.0
// Cuts a region into cells until each is proven to hold the tolerance: its bound is the sum of what
// near_far_interpolation.cpp and near_far_rounding.cpp prove, and the test is !(bound <= tol). The smallest
// cells fall back on double (near_far_exact.cpp).
#include "anamorph/morph/near_far_subdivider.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anamorph/morph/near_far_line.h"

namespace anamorph::near_far {

namespace {

// What floats hold of a line. A distance (before or behind, and beside) has a square below 2^127; that of a
// point behind q is that of one before p, or less. A factor keeps its 24 bits. Whatever else is too large for
// a float (the square of a displacement, a power near a line) makes a bound infinite or NaN, which holds no
// tolerance; NearFarSubdivider::look says what becomes of sums that are too large or too small.
constexpr float kMostDistance = 1e12f, kMostSlope = 1e9f;
constexpr float kLeastFactor = 1e-25f, kMostFactor = 1e25f;
// The least power of a distance, which has a relative error only if it is a normal float, from 2^-126
// (1.2e-38) on. `farthest` is beyond all pixels of the region; that distances are rounded changes a power by
// less than b (16 u + 1e-3 / 64) of it, less than a thousandth.
constexpr double kLeastPower = 1e-36;
// Cells whose sum of weights interpolation changes by more are cut: there nothing is far. Any part of 1
// would be proven, by the division by what is left of the sum.
constexpr double kMostWeightError = 0.05;
// Cells are not cut below this.
constexpr int kFloor = 8;
// The parts of the tolerance that interpolation may use, one after the other; the rest is for rounding.
constexpr double kInterpolationShares[] = {0.9, 0.55};
// The parts that interpolation may use in the smallest cells, before they fall back on double.
constexpr double kSmallestShares[] = {0.2, 0};
// Where rounding takes more of it on a large cell even without near lines, smaller ones seldom hold it.
constexpr double kMostRoundingShare = 0.2;
// The part of the tolerance that is left which a cell uses up for lines that are far already from a cell to
// be cut.
constexpr double kParentShare = 0.25;

/// How many near lines a cell of this size may have before it is cut (measured).
int most_near(int size) {
    return size >= 64 ? 6 : size >= 32 ? 16 : 64;
}

}  // namespace

void NearFarSubdivider::plan(int x0, int y0, Region& region) {
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

bool NearFarSubdivider::gather() {
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
    if (!(std::pow(farthest, -b) > kLeastPower)) return false;
    const double log = std::max(std::log(farthest), -std::log(std::max<double>(a, simd::kLeastDistance)));
    m_constant = kRoundingUnit * simd::weight_rounding(b, log);
    m_by_nearest = kRoundingUnit * b;
    m_weights.log = static_cast<float>(log * (1 + kBoundRounding));
    m_lines.resize(m_map.size());
    for (std::size_t i = 0; i < m_map.size(); ++i)
        if (!see(i, m_x, m_y, m_lines[i]) || !(m_slopes[i] < kMostSlope)) return false;
    return bound_doubles();
}

bool NearFarSubdivider::see(std::size_t i, double x, double y, FieldLine& to) const {
    to = seen_from(m_map, i, m_options.shapes, x, y, m_reference.data(), m_unit);
    return to.factor > kLeastFactor && to.factor < kMostFactor && std::fabs(to.before) < kMostDistance &&
           std::fabs(to.beside) < kMostDistance;
}

void NearFarSubdivider::settle(int x0, int y0, int size, std::size_t depth, FarSums sums,
                               bool has_polynomial) {
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
        if (base_rounding(known, 0) > kMostRoundingShare * m_options.tol) return exact(x0, y0, size);
        for (const double share : kInterpolationShares)
            if (fits(share)) return;
    }
    if (size <= kFloor) {
        const bool held =
            known.finite && std::any_of(std::begin(kSmallestShares), std::end(kSmallestShares), fits);
        if (!held) exact(x0, y0, size);
        return;
    }
    divide(x0, y0, size, depth, bounds, known, sums, kParentShare * budget(kInterpolationShares[0]),
           has_polynomial);
}

void NearFarSubdivider::divide(int x0, int y0, int size, std::size_t depth, const simd::LineBounds& bounds,
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

bool NearFarSubdivider::emit(const Box& box, Candidates& lines, const simd::LineBounds& bounds,
                             const Known& known, const FarSums& sums, bool has_polynomial) {
    const int near = lines.near_count;
    const double off = sums.value / known.least;
    if (!(off < kMostWeightError)) return false;
    const double half = static_cast<double>(known.frame.half);
    const NearRounding rounding = near_rounding(lines, bounds, known, sums);
    const double before = quotient_error(sums, known) + base_rounding(known, near);
    // The sum of weights is off by interpolation, and by near lines' weights, at once.
    const auto with_near = [&](double error, bool fine_places) {
        const NearError by_near = near_error(rounding, fine_places, half);
        return (error + by_near.moved) / (1 - off - by_near.weight) * (1 + kBoundRounding);
    };
    if (!(with_near(before, true) <= m_options.tol)) return false;

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
    const bool fine = !(with_near(whole, false) <= m_options.tol);
    const double bound = with_near(whole, fine);
    if (!(bound <= m_options.tol)) return false;

    Cell cell{box, false, bound, known.frame, {}, m_region->coefficients.size(), m_region->lines.size(),
              0,   fine};
    const std::vector<int>& shapes = m_options.shapes;
    for (std::size_t n = 0; n < shapes.size(); ++n) {
        const Point<double> s = m_map.scale(shapes[n]);
        const double x =
            m_region->origin[2 * n] + s.x * static_cast<double>(known.frame.x) + known.center[2 * n];
        const double y =
            m_region->origin[2 * n + 1] + s.y * static_cast<double>(known.frame.y) + known.center[2 * n + 1];
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

void NearFarSubdivider::exact(int x0, int y0, int size) {
    for (int y = y0; y < y0 + size; y += Block::kMaxSide)
        for (int x = x0; x < x0 + size; x += Block::kMaxSide) {
            const int side = std::min(size, Block::kMaxSide);
            const Box box = intersection({x, y, x + side, y + side}, m_picture);
            if (!box.empty()) m_region->cells.push_back({box, true, 0, {}, {}, 0, 0, 0, false});
        }
}

}  // namespace anamorph::near_far
