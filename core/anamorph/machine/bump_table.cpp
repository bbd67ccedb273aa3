// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/bump_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace anamorph::machine {

BumpTable bump_table(const BumpTexels& residuals, const NumberFormat& texel, bool scaled) {
    BumpTable table;
    for (std::size_t c = 0; c < 2; ++c) {
        double most = 0;
        for (const auto& residual : residuals) most = std::max(most, std::fabs(residual[c]));
        if (scaled && texel.kind == NumberFormat::Kind::fixed && most > 0)
            table.scale[c] = most / largest(texel);
    }
    table.texels.reserve(residuals.size());
    for (const auto& residual : residuals) {
        bool beyond = false;
        std::array<double, 2> rounded{};
        for (std::size_t c = 0; c < 2; ++c) rounded[c] = nearest(texel, residual[c] / table.scale[c], beyond);
        table.texels.push_back(rounded);
        table.saturated += beyond;
    }
    return table;
}

/// An average of texels is off by no more than the farthest of them. A weight is off by half of its unit: along a row that moves what is
/// read by that of two neighbours' difference, and between two rows by that of a difference which is an average of those of
/// neighbours above each other.
std::array<double, 2> reading_error(const BumpTexels& residuals, const BumpTable& table, int columns,
                                    int weight_bits) {
    std::array<double, 2> error{};
    const auto width = static_cast<std::size_t>(columns);
    for (std::size_t c = 0; c < 2; ++c) {
        double texel = 0, across = 0, down = 0;
        const auto at = [&](std::size_t i) { return table.texels[i][c] * table.scale[c]; };
        // A NaN is larger than all.
        const auto raise = [](double& most, double value) {
            if (!(value <= most)) most = value;
        };
        for (std::size_t i = 0; i < residuals.size(); ++i) {
            raise(texel, std::fabs(at(i) - residuals[i][c]));
            if (i % width > 0) raise(across, std::fabs(at(i) - at(i - 1)));
            if (i >= width) raise(down, std::fabs(at(i) - at(i - width)));
        }
        error[c] = texel + std::ldexp(across + down, -weight_bits - 1);
    }
    return error;
}

}  // namespace anamorph::machine
