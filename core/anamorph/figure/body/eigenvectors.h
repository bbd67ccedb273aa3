// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/mat3x3.hpp>

namespace anamorph::figure {

/// The eigenvectors of a symmetric matrix as columns, the largest eigenvalue's first (Jacobi's method). They
/// are orthonormal; the determinant may be -1.
glm::dmat3 eigenvectors(glm::dmat3 a);

}  // namespace anamorph::figure
