// SPDX-License-Identifier: Apache-2.0
// What maps can be asked for: how they are approximated, and their tolerance.
#pragma once

namespace anamorph {

/// How a reprojection is approximated.
///
/// exact: every pixel by the formula. blocks: polynomials of degree 2 to 4 on blocks. residual: Kim's decomposition
/// (3.1), one linear map and a bilinear table of residuals (4.3, 4.4). direct: every pixel by the formula, in float
/// where that holds the tolerance, else in double, near the middle of its block (number/near.h). automatic: the fastest
/// that holds.
enum class Scheme { automatic, exact, blocks, residual, direct };

/// How a mesh warp is approximated.
///
/// exact: every pixel in double. hermite: the bicubic patch in full at every pixel (5.3.5), in float.
/// residual: a linear map for each of a cell's two triangles plus thirteen tabulated products (5.4 to 5.7).
/// automatic: quadratics in place of the patch where they hold the tolerance, the fastest. Maps that are no bicubic
/// patches (pairs of points, and push meshes) have exact and automatic only, and take automatic for the other two.
enum class WarpScheme { automatic, exact, hermite, residual };

/// Checks a tolerance. Throws Error unless `tol`, in source pixels, is 0 (exact) or a finite number above it.
void check_tol(double tol);

}  // namespace anamorph
