// SPDX-License-Identifier: Apache-2.0
// Kim 2003, section 4.3: the linear part of a panorama's map whose residuals are least.
#pragma once

#include "anamorph/panorama/panorama.h"
#include "anamorph/plan/residual.h"

namespace anamorph {

/// The coefficients of eq. 4.3, theta = theta_0 + a x' and v = 0.5 + b y', for |x'| <= x_max on the
/// projection plane of a unit cylinder of height `height` (theta and v in 0..1): those for which the
/// residuals (4.4) are least in the maximum norm. Section 4.3: the residual of theta has extremes of equal
/// size and opposite sign at x_max and in between; the residual of v is as large at x' = 0 as at x' = x_max.
struct LinearCoefficients {
    double a, b;
};
LinearCoefficients minimax_coefficients(double x_max, double height);

/// The minimax coefficients where the paper derives them: a level view of a cylinder.
LinearPart linear_part(const Panorama& map, int piece);

}  // namespace anamorph
