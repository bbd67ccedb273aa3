// SPDX-License-Identifier: Apache-2.0
// Interpolation at Chebyshev's nodes, in floats: the nodes, a bound of what interpolation makes of an error
// at them, and the matrices that lead to coefficients.
#pragma once

#include "anamorph/morph/near_far_kernels.h"

namespace anamorph::near_far {

using simd::kMaxDegree;

/// Interpolation at the K roots of T_K.
struct Chebyshev {
    int k;
    float nodes[kMaxDegree];
    double lebesgue;
    /// The matrix from values at the nodes to coefficients of powers.
    double powers[kMaxDegree * kMaxDegree];
    /// The matrices from coefficients in s to those in s' where s = (s' -+ 1) / 2: for the left and the right
    /// half.
    double halves[2][kMaxDegree * kMaxDegree];

    explicit Chebyshev(int degree);
};

/// The number of coefficients each way that makes a tolerance cheapest (measured).
int degree_for(double tol);

}  // namespace anamorph::near_far
