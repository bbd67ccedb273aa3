// SPDX-License-Identifier: Apache-2.0
// The terms that a bicubic block of total degree 3 has beyond its quadratic.
#pragma once

#include <algorithm>

#include "anamorph/plan/block.h"

namespace anamorph {

/// The coefficients of s^3, s^2 t, s t^2 and t^3.
struct CubicTerms {
    float x[4], y[4];

    CubicTerms() = default;
    /// Takes them from all ten coefficients, degree by degree.
    CubicTerms(const double* all_x, const double* all_y) {
        std::copy_n(all_x + 6, 4, x);
        std::copy_n(all_y + 6, 4, y);
    }
};

/// The polynomial of a block, whose first terms are the block's quadratic.
inline BlockPolynomial with_cubic_terms(const Block& block, const CubicTerms& terms) {
    BlockPolynomial p = quadratic_of(block);
    p.degree = 3;
    for (int j = 0; j < 4; ++j) {
        p.c[j][3 - j] = terms.x[j];
        p.c[j][7 - j] = terms.y[j];
    }
    return p;
}

}  // namespace anamorph
