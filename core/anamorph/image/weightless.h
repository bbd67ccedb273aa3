// SPDX-License-Identifier: Apache-2.0
// Texels that are infinite, or no numbers, in filters.
//
// Filters add up texels by their weights, and 0 times infinity, or times no number, is no number. So a channel that comes out
// infinite or as no number is computed again texel by texel, and those of weight 0 are left out. What is finite keeps its bits.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace anamorph {

/// The distance from the middle of a texel, either way, below which a point counts as there for a channel
/// that comes out infinite or as no number: the texels beside it have no weight. So much a block of 64 source
/// pixels loses of its points, offsets of up to 32 from its base, in float: each of some ten roundings by
/// 2^-24 of 32 at most (term_rounding, plan/block_writer.h). An identity is off by less.
inline constexpr float kSameTexel = 0x1p-15f;

/// The distance from their middle, each way, within which several taps count as one for such a channel. A
/// step of one texel that is off by as much as two points, 2^-14, asks for less energy of noise by a third of
/// that (footprint.h), which two taps d apart have where d^2 / 2 is as much: each is d / 2 < 2^-8 from the
/// middle.
inline constexpr float kSameTap = 0x1p-8f;

/// The least and the greatest of the taps of a filter, between which a clamped one stays. A tap that is infinite, or no number,
/// counts where it has weight.
class TapRange {
  public:
    void add(double tap, double weight) {
        if (weight == 0 && !std::isfinite(tap)) return;
        m_least = std::min(m_least, tap);
        m_most = std::max(m_most, tap);
    }
    /// What is no number stays so. Infinity times a negative weight is cut off as what else overshoots.
    double clamped(double value) const {
        return std::isnan(value) ? value : std::min(std::max(value, m_least), m_most);
    }

  private:
    double m_least = std::numeric_limits<double>::infinity(),
           m_most = -std::numeric_limits<double>::infinity();
};

}  // namespace anamorph
