// SPDX-License-Identifier: Apache-2.0
// The unit of rounding in near/far, and the margin for what bounds themselves are off by.
#pragma once

#include "anamorph/morph/near_far_kernels.h"

namespace anamorph::near_far {

/// The unit roundoff u of float.
inline constexpr auto kRoundingUnit = static_cast<double>(simd::kFloatRounding);
/// The relative error of a bound itself. It is made of sums over lines (off by kSumRounding = 24 u each, in
/// numerator and denominator), products of four of them at most, 8 (24) u = 192 u, and of fewer than 100 more
/// operations on floats. And the nodes, off by u / 2 each, are the roots not of T_K
/// (near_far_interpolation.cpp (1)) but of T_K + p, p of degree K - 1, at the nodes at most K^2 u / 2 (T_K's
/// slope), so that |p| <= K^2 Lebesgue_K u / 2 < 74 u. At a pole |p| / |T_K| is at most 74 u on the real
/// axis, and 2 (74 u) / (rho - rho^(1 - 2 K)) < 118 u elsewhere, for rho > 1.37 and K >= 4
/// (morph/near_far_lanes.cpp takes no end nearer than 1.05). In all 192 + 100 + 74 + 118 = 484 units.
inline constexpr double kBoundRounding = 512 * kRoundingUnit;

}  // namespace anamorph::near_far
