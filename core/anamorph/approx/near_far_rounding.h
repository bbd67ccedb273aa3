// SPDX-License-Identifier: Apache-2.0
// The unit of rounding in near/far, and the margin for what bounds themselves are off by.
#pragma once

#include "anamorph/simd/near_far.h"

namespace anamorph::near_far {

constexpr auto kFloatUlp = static_cast<double>(simd::kFloatRounding);
// A bound is made of sums over lines (off by kSumRounding each, in numerator and denominator) and of fewer
// than 100 more operations on floats, products of four at most of such sums: 8 (24) + 100 < 512 units.
constexpr double kBoundRounding = 512 * kFloatUlp;

}  // namespace anamorph::near_far
