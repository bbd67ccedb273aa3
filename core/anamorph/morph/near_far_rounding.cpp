// SPDX-License-Identifier: Apache-2.0
// Proves what floats add to a cell's error, by counting roundings: each is off by u = 2^-24 (kRoundingUnit),
// in proportion.
//
// Rounding: morph/near_far_kernels.h says what floats cost a line's sums. Near lines are seen from the cell's centre,
// so that numbers are small. A relative error e_i of a near line's weight moves the quotient by e_i w_i |D_i
// - D| / W, which stays small on the line itself: there D is D_i. Where a line's place, as a float, is too
// coarse for its a + r, the cell is fine: places are two floats (morph/near_far_kernels.h). Distances below 1e-6 are
// cut off, so where a is less than that, cells that a line touches are exact.
//
// Lines are doubles to begin with, off from those that were given by what line_off (near_far_exact.h) says;
// so is the view of one from a region's or a cell's centre. Whatever is off, it is a line again: all else is
// proven for the map of the lines as double has them. Of that map, at a pixel, D is a mean of what the given
// lines say, each off by `displacement`, with weights off by e_i in proportion, which moves it by the sum of
// e_i l_i |D_i - D|: NearFarSubdivider::bound_doubles.
#include "anamorph/morph/near_far_subdivider.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "anamorph/morph/near_far_exact.h"

namespace anamorph::near_far {
namespace {

// What the sum of all weights less one may lack, in proportion to that one: the sum, in double, of n near
// lines is off by n 2^-53 of itself, below a millionth for any n up to 2^32 (that of the far lines, in
// floats, in proportion to itself: kBoundRounding).
constexpr double kCancelled = 1e-6;

// Where near lines' weights may be off by more in proportion, the cell is fine or cut. Up to there
// 1 / (1 - e) covers all orders: with the distance off by d of itself, e = b d, a weight is off by a factor
// of at most (1 + d)^b <= exp(e) <= 1 / (1 - e), and of at least (1 + d)^-b >= 1 - e.
constexpr double kMostNearError = 0.25;

// In double, a line nearer than this to a region counts by its place in pixels, one farther off by it in
// proportion to its distance.
constexpr double kNearRegion = kHalfRegion;
// How far near lines may be out of place in double. With a + dist at least kPlaceApart, b times that over a +
// dist is at most 16 / 100, of which 1 / (1 - e) makes less than the twice as much that line_off allows for;
// where a + dist is less, near_error counts it among the rest. kPlaceApart has room for 90 times as much.
constexpr double kMostPlace = 1e-5;
// The farthest that far lines may be out of place in double, in proportion: kPlaceRelative has room for
// 10 units.
constexpr double kMostFarPlace = 8 * kRoundingUnit;

}  // namespace

bool NearFarSubdivider::bound_doubles() {
    const double radius = std::numbers::sqrt2 * kHalfRegion;
    const double farthest = std::fabs(m_x) + std::fabs(m_y) + 2 * radius;
    double displacement = 0, weight = 0, reach = 0;
    m_place = 0;
    for (std::size_t i = 0; i < m_lines.size(); ++i) {
        const FeatureMap::TargetLine& line = m_map.line(i);
        const FeatureMap::Frame<double> at = m_map.frame(line, m_x, m_y);
        const double rho = std::sqrt(at.along * at.along + at.beside * at.beside) + radius;
        const LineOff off = line_off(m_map, i, rho, farthest);
        const double nearest = m_map.distance(line, at) - radius;
        // Twice, as line_off says of itself.
        double error = 2 * m_map.rounding(i).weight;
        if (nearest < kNearRegion)
            m_place = std::max(m_place, off.distance);
        else if (off.distance <= kMostFarPlace * nearest)
            error += m_map.weights().b * off.distance / nearest;
        else
            return false;
        displacement = std::max(displacement, off.displacement);
        weight = std::max(weight, error);
        Vector from_reference;
        for (std::size_t c = 0; c < kComponents; ++c)
            from_reference[c] = static_cast<double>(m_lines[i].at[c]);
        reach = std::max(reach, length_of(from_reference) + static_cast<double>(m_slopes[i]) * radius);
    }
    // No two of the D_i are farther apart than twice their reach. Where a region's centre comes from and
    // the reference are made of numbers of that size, in fewer than 8 operations.
    const double origin = length_of(m_region->origin) + scale() * farthest;
    m_in_double = scale() * displacement + 2 * weight * reach + 8 * 0x1p-53 * origin;
    return m_place <= kMostPlace;
}

double NearFarSubdivider::center_rounding(double reach, double near_reach, double most, double slope,
                                          double offset) const {
    const double sums = (2 * simd::kSumRounding + 4 * kRoundingUnit) * (reach + offset * most);
    return m_chebyshev.lebesgue * m_chebyshev.lebesgue *
           (m_constant * reach + m_by_nearest * 11 * kHalfRegion * near_reach + sums +
            10 * kRoundingUnit * kHalfRegion * slope);
}

double NearFarSubdivider::scale() const {
    double most = 0;
    for (const int k : m_options.shapes) most = std::max({most, m_map.scale(k).x, m_map.scale(k).y});
    return most;
}

double NearFarSubdivider::base_rounding(const Known& known, int near) const {
    // The near lines' sums and the quotient: in numerator and denominator a product and a sum for each
    // line, 3 more for the polynomial and the quotient.
    const double value = known.mean + known.offset;
    const double sums = (2 * static_cast<double>(simd::near_additions(near)) + 6) * value;
    // offset + slope x, x up to half the cell, and the quotient added to it, on each axis: the offset is
    // below 1 + |center| and rounded 3 times, slope x 4 times, the displacement once.
    const double placed =
        3 * (1 + known.offset) + 4 * scale() * static_cast<double>(known.frame.half) + value;
    return kRoundingUnit * (sums + std::numbers::sqrt2 * placed) + m_in_double;
}

double NearFarSubdivider::far_rounding(const Known& known, const float* size) const {
    // A coefficient is rounded once; Horner's rule, K - 1 steps of a product and a sum, in t and then in s,
    // rounds a term 4 (K - 1) times at most. s and t are exact: multiples of 1 / (2 half), a power of two.
    // Of 4 K - 3 roundings up to 4 K + 4, 7 are room for those of `size`, K^2 additions, and of second
    // order: (4 K)^2 u and 4 K K^2 u of a rounding, and for the coefficients' own, in double.
    const double moved = static_cast<double>(std::max(size[1] + size[2], size[3] + size[4]));
    return kRoundingUnit * (4 * m_chebyshev.k + 4) *
           (moved + (known.spread + known.offset) * static_cast<double>(size[0])) / known.least;
}

NearRounding NearFarSubdivider::near_rounding(Candidates& lines, const simd::LineBounds& bounds,
                                              const Known& known, const FarSums& far) const {
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
        // l (1 - l) is at most a quarter.
        const double moved = std::min(part * (reach + known.spread), std::min(part, 0.25) * between);
        // The weight is most (nearest / d)^b at distance d, and with it 1 - l at most others / weight. An
        // error that falls with d is worst at the nearest distance, or with b >= 1 where that is as good
        // as `moved`. `most` allows for twice the weight's rounding, which 1 - l has to take back, and for
        // its own. Where no others and no `between` are left, `moved` is 0, and the ratio not 0 / 0.
        const double others = std::max(all - most, 0.0) * (1 + 4 * m_constant) + kCancelled * most;
        const double ratio = std::max(most * moved / (others * between + 1e-300), 1.0);
        const double by = b == 2 ? std::sqrt(ratio) : b <= 1 ? ratio : std::pow(ratio, 1 / b);
        out.moved += moved;
        out.moved_by_place += moved / (nearest * by);
        out.nearest = std::min(out.nearest, nearest);
    }
    out.displacements = kRoundingUnit * (4 * (known.mean + known.offset) + 10 * half * slope);
    return out;
}

NearError NearFarSubdivider::near_error(const NearRounding& near, bool fine, double half) const {
    const double place =
        m_by_nearest * (fine ? simd::kFineRounding : 11 * half) + m_map.weights().b * m_place;
    // Where distances are cut off, weights have no bound.
    constexpr auto kLeast = static_cast<double>(simd::kLeastDistance);
    if (near.nearest <= kLeast && m_map.weights().a < kLeast) return {HUGE_VAL, 0};
    const double worst = m_constant + place / near.nearest;
    if (!(worst < kMostNearError)) return {HUGE_VAL, 0};
    return {(m_constant * near.moved + place * near.moved_by_place) / (1 - worst) + near.displacements,
            worst};
}

}  // namespace anamorph::near_far
