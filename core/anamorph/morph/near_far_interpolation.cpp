// SPDX-License-Identifier: Apache-2.0
// Proves what the far lines' polynomials are off by: bounds of interpolation at Chebyshev's nodes in closed
// form, line by line, and of the quotient of the sums.
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
// morph/near_far_lanes.cpp evaluates these (BesideError, EndError, BoundLines); tests/core holds them against errors
// of interpolants, and proves the kernel's supremum and integral. Lines that the cell touches are near.
//
// The displacement is S / W. With a sum off by dS and dW the quotient is off by (dS - D dW) / (W + dW). The
// interpolant is linear in f, so dS - D dW is what it makes of the sum of w_i (D_i - D): each line counts
// with |D_i - D| only. D is a mean of the D_i, which bounds |D - D*| for any reference D* (`spread`).
#include "anamorph/morph/near_far_subdivider.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace anamorph::near_far {

// The greatest sum of weights, and of weighted displacements. Floats make less than twice as much of it:
// below 2^126 neither a sum overflows nor its reciprocal comes out below 2^-126. A polynomial whose sum of
// sizes overflows has no finite bound (far_rounding).
constexpr double kMostSum = 0x1p125;
// What comes out below 2^-126 (a factor times a power, a weight times a displacement or an error) is off by
// that much. A line has less than ten such numbers; what is made of them multiplies them by a displacement's
// distance and by Lebesgue_K^2 < 6 or sqrt(2) b half < 1449, less than 2^14 in all.
constexpr double kUnderflow = 0x1p-112;
// Underflow may move a pixel by this at most, in pixels: every bound is at least 4 u (base_rounding), and
// kBoundRounding leaves 28 u of that, more than 2^-42.
constexpr double kUnderflowMoves = 0x1p-44;

bool NearFarSubdivider::floats_hold(const Known& known, double most, double reach) const {
    const double lost = static_cast<double>(m_lines.size()) * (1 + known.farthest) * kUnderflow;
    // Displacements are at most `offset` and their reach long. NaN is not held.
    return (1 + known.offset) * most + reach < kMostSum && lost <= kUnderflowMoves * known.least;
}

Known NearFarSubdivider::look(int x0, int y0, int size, Candidates& lines, simd::LineBounds& bounds,
                              FarSums& sums, bool has_polynomial) const {
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
    const simd::SpreadSums over = simd::bound_displacements(
        lines.table(), known.frame, center, static_cast<float>(0.25 * known.least),
        static_cast<float>(known.offset * node_sum_rounding()), bounds, lines.reach(), lines.error());

    // D is a mean of the D_i: no farther off than the farthest, and lines of little weight count by that.
    // And D - center is the mean of (w_i - w_i at the centre) (D_i - center) and of w_i at the centre
    // times the change of D_i, since the sum of w_i (D_i - center) is 0 there but for the polynomial's
    // errors and the rounding of what `center` was made of: weights, sums and the quotient.
    const double half = static_cast<double>(known.frame.half), b = m_map.weights().b;
    known.farthest = std::max(sums.farthest, over.farthest);
    known.finite = floats_hold(known, sums.most + over.most, sums.reach + over.reach);
    const double rounding = center_rounding(sums.reach + over.reach, sums.near_reach + over.near_reach,
                                            sums.most + over.most, sums.slope + over.slope, known.offset);
    const double change =
        (half * (std::numbers::sqrt2 * b * (sums.near_reach + over.near_reach) + sums.slope + over.slope) +
         sums.error + rounding) /
        known.least;
    const double mean = std::min((sums.reach + over.light) / known.least + over.heavy, known.farthest);
    known.mean = mean * (1 + kBoundRounding);
    known.spread = std::min(mean, change) * (1 + kBoundRounding);
    return known;
}

double NearFarSubdivider::quotient_error(const FarSums& sums, const Known& known) const {
    const double places = m_map.weights().b * m_place * (sums.near_reach + known.spread * sums.near);
    return (sums.error + known.spread * sums.value + known.offset * node_sum_rounding() * sums.most +
            places) /
           known.least;
}

double NearFarSubdivider::node_sum_rounding() const {
    return m_chebyshev.lebesgue * m_chebyshev.lebesgue * simd::kNodeRounding;
}

simd::LineSums NearFarSubdivider::select(Candidates& lines, const simd::LineBounds& bounds,
                                         const Known& known, double budget) {
    const double unit = budget > 0 ? 1 / (known.least * budget) : HUGE_VAL;
    return lines.select(bounds, static_cast<float>(known.spread), static_cast<float>(std::min(unit, 1e30)));
}

void NearFarSubdivider::interpolate(const Candidates& lines, const CellFrame& frame, bool has_polynomial,
                                    double* to) {
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

}  // namespace anamorph::near_far
