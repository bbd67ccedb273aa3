// SPDX-License-Identifier: Apache-2.0
// Ellipsoids of anisotropic displacement (ORTEP): how large they are that hold an atom with a probability.
#pragma once

namespace anamorph::figure {

/// displacement_scale(0.5).
inline constexpr double kHalfProbability = 1.5381722544550522;

/// The factor s by which the ellipsoid x^T U^-1 x = s^2 holds a point of the three-dimensional Gaussian of covariance U with the
/// given probability, between 0 and 1 but neither. 1.538... for 1/2, to a few units in the last place for any other.
double displacement_scale(double probability);

}  // namespace anamorph::figure
