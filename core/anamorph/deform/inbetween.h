// SPDX-License-Identifier: Apache-2.0
// Multiple inbetweening (Oka 1987, section 4.2): a weighted sum of any number of surfaces,
//
//     T = sum_i I_i S_i,                                                   (4.3)
//
// point by point. Weights outside [0, 1] extrapolate. Surfaces are arrays of `points` times `components`
// numbers without gaps, of the same points in the same order; any other array of the points will do as well.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/parallel_for.h"

namespace anamorph {

/// How the sum of the weights is treated.
enum class WeightSum {
    checked,    ///< has to be 1, within kWeightSumError
    normalized  ///< is divided out; may be anything that is not small beside the weights
};
/// The largest difference from 1 of a sum that is checked.
inline constexpr double kWeightSumError = 1e-6;
/// The smallest sum of weights that can be normalized, as a share of the sum of their magnitudes.
inline constexpr double kLeastWeightSum = 1e-9;

/// The coefficients I_i of eq. (4.3) from weights. Throws Error naming a weight that is not finite, or the sum where
/// it is not accepted.
std::vector<double> inbetween_weights(std::span<const double> weights, WeightSum sum);

/// Computes out = sum_i weights[i] shapes[i], added in double and rounded once; the sum of the weights is checked or
/// normalized. Shapes of weight 0 are not read. `out` may be one of the shapes. Throws Error on weights that
/// are refused, and when there are not as many as shapes.
template <class T>
void inbetween(std::span<const T* const> shapes, std::span<const double> weights, WeightSum sum,
               std::int64_t points, int components, T* out, const ParallelFor& parallel_for = serial_for);

/// Adds the differences of shapes from a base: out = base + sum_i weights[i] m_i (shapes[i] - base), where m_i is 1 or,
/// with masks, masks[i][point] (unless masks[i] is null), so that a shape is seen in its region only. The base takes
/// the rest of the weight, so that the weights may have any sum. Throws Error also on a mask that is not finite.
template <class T>
void inbetween_from_base(const T* base, std::span<const T* const> shapes, std::span<const double> weights,
                         std::span<const float* const> masks, std::int64_t points, int components, T* out,
                         const ParallelFor& parallel_for = serial_for);

}  // namespace anamorph
