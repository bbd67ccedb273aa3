// SPDX-License-Identifier: Apache-2.0
// Proves the Lebesgue constant for nodes that are floats, by Markov's inequality.
#include "anamorph/morph/near_far_chebyshev.h"

#include <cmath>
#include <numbers>

#include "anamorph/morph/near_far_rounding.h"

namespace anamorph::near_far {

// By how much the Lebesgue constant grows when nodes, numbers in (-1, 1), are rounded by u / 2 each. A
// polynomial of degree K - 1 and size M on [-1, 1] that is at most 1 at the rounded nodes is at most 1 +
// K^2 M u / 2 at the roots of T_K (Markov), hence M <= Lebesgue_K (1 + K^2 M u / 2): with K = 8 and
// Lebesgue_8 < 2.3, M <= Lebesgue_K (1 + 74 u). The rest of 512 u is room for the constant's own sum, in
// double.
constexpr double kNodesMove = 512 * kRoundingUnit;

Chebyshev::Chebyshev(int degree) : k(degree) {
    double node[kMaxDegree];
    lebesgue = 0;
    for (int i = 0; i < k; ++i) {
        const double angle = (2 * i + 1) * std::numbers::pi / (2 * k);
        // What is evaluated are floats; the interpolant is exact for them.
        nodes[i] = static_cast<float>(std::cos(angle));
        node[i] = nodes[i];
        lebesgue += 1 / std::tan(angle / 2) / k;
    }
    lebesgue *= 1 + kNodesMove;
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

int degree_for(double tol) {
    return tol >= 0.03 ? 4 : tol >= 2e-3 ? 5 : tol >= 2e-4 ? 6 : 8;
}

}  // namespace anamorph::near_far
