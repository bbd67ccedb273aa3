// SPDX-License-Identifier: Apache-2.0
// Kim 2003, section 3.1 and 4.3: a map as a linear part plus a table of residuals that is read bilinearly.
#pragma once

#include "anamorph/map/panorama.h"

namespace anamorph {

/// The coefficients of eq. 4.3, theta = theta_0 + a x' and v = 0.5 + b y', for |x'| <= x_max on the
/// projection plane of a unit cylinder of height `height` (theta and v in 0..1): those for which the
/// residuals (4.4) are least in the maximum norm. Section 4.3: the residual of theta has extremes of equal
/// size and opposite sign at x_max and in between; the residual of v is as large at x' = 0 as at x' = x_max.
struct LinearCoefficients {
    double a, b;
};
LinearCoefficients minimax_coefficients(double x_max, double height);

/// The linear part of a pull map on one piece of the target: source point = origin + right * (x - cx) +
/// down * (y - cy) in pixels, with (cx, cy) the centre of the piece.
struct LinearPart {
    double cx, cy;
    Point<double> origin, right, down;

    Point<double> operator()(double x, double y) const {
        return {origin.x + right.x * (x - cx) + down.x * (y - cy),
                origin.y + right.y * (x - cx) + down.y * (y - cy)};
    }
};

/// The minimax coefficients where the paper derives them (a level view of a cylinder); elsewhere the map's
/// derivative at the piece's centre, and the centre of the source where there is none.
LinearPart linear_part(const Panorama& map, int piece);

}  // namespace anamorph
