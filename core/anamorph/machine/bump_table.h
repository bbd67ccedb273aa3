// SPDX-License-Identifier: Apache-2.0
// Residuals as the texels of a bump map (Kim 2003, 4.4.3), for pictures of panoramas (bump_unit.h) and for panoramas on scenes.
#pragma once

#include <array>
#include <vector>

#include "anamorph/machine/number_format.h"

namespace anamorph::machine {

/// Two numbers for each texel, row by row: perturbations across and down, in texture coordinates.
using BumpTexels = std::vector<std::array<double, 2>>;

/// The texels of a bump map.
struct BumpTable {
    BumpTexels texels;                  ///< numbers of their format
    std::array<double, 2> scale{1, 1};  ///< what they are multiplied with to be perturbations
    int saturated = 0;                  ///< how many were beyond their format's range
};

/// Makes texels of a format. `scaled`: residuals of a fixed format are divided by the largest, so that they use all of its range.
BumpTable bump_table(const BumpTexels& residuals, const NumberFormat& texel, bool scaled);

/// The largest distances, across and down, of what is read bilinearly from a table of so many columns, with weights rounded to
/// multiples of 2^-weight_bits, from what is read of the residuals with exact weights, in texture coordinates.
std::array<double, 2> reading_error(const BumpTexels& residuals, const BumpTable& table, int columns,
                                    int weight_bits);

}  // namespace anamorph::machine
