// SPDX-License-Identifier: Apache-2.0
// The costs of the ways to plan and to draw a map, by which plans choose among them. A cost that is wrong
// makes pictures slower, never a bound.
#pragma once

namespace anamorph {

/// Costs in exact pixels of the map. The defaults are those of panoramas. speed_vs_error --calibrate measures
/// them; its table is tests/bench/costs.md.
struct PlanCosts {
    double bound = 500;         ///< a bound over a box
    double further_bound = 60;  ///< each further bound at once
    /// The most that bounds may cost beyond what they have saved so far, where only the fastest way is asked
    /// for: a part of the region's pixels.
    double credit = 1.0 / 16;
    double bound_pixels = 512;   ///< a box of fewer pixels is not bounded: that could not pay
    double polynomial = 40;      ///< a Taylor polynomial
    double rounding = 80;        ///< finding for a block alone what rounding costs it
    double double_pixel = 1;     ///< what a polynomial's pixel costs more in double than in float
    double direct_trial = 130;   ///< looking whether direct blocks hold the tolerance
    double direct_pixel = 0.3;   ///< what a polynomial's pixel saves where it could be direct, in float
    double precise_pixel = 0.9;  ///< what a polynomial's pixel saves where it could be direct, in double
    // Beside direct pixels in double, polynomials are of small blocks and save little, so that costs are to be closer there:
    double apart_pixel = 0.62;  ///< precise_pixel where texels lie far apart: memory is waited for meanwhile
    double precise_bound = 1000;  ///< a bound, of charts that need angles
    double block = 30;            ///< what drawing a polynomial's block costs beyond its pixels
};

/// The costs of a map: its own, or the defaults.
template <class Map>
PlanCosts costs_of() {
    if constexpr (requires { Map::kCosts; })
        return Map::kCosts;
    else
        return {};
}

}  // namespace anamorph
