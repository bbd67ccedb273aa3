// SPDX-License-Identifier: Apache-2.0
// The lines that a cell still has to place, as a table, with arrays for what is known of each over the cell.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "anamorph/morph/near_far_kernels.h"

namespace anamorph::near_far {

using simd::FieldLine;
using simd::kComponents;
using simd::LineTable;

/// The room for a polynomial: K x K coefficients of 8 numbers.
inline constexpr std::size_t kCoefficients = simd::kMaxDegree * simd::kMaxDegree * 8;

/// Lines and what is known of them over the cell at hand; one for each depth of the recursion.
class Candidates {
  public:
    /// Takes all lines of a region.
    void take(const std::vector<FieldLine>& all, const std::vector<float>& slopes);
    /// Takes the near lines of other candidates: in their table, with factor 0 for the rest, or in one of its
    /// own where that is shorter.
    void take_near(const Candidates& from);

    LineTable table() const {
        return {m_table, static_cast<std::ptrdiff_t>(m_stride), m_factor.data(), static_cast<int>(m_count)};
    }
    float slope(std::size_t i) const { return m_table[LineTable::kSlope * m_stride + i]; }
    /// A line's number in the region's list of all.
    std::int32_t id(std::int32_t i) const { return m_ids[i]; }

    simd::LineBounds bounds() {
        return {array(0), array(1), array(2), array(3), array(4), {array(5), array(6), array(7), array(8)},
                {},       0};
    }
    float* reach() { return array(9); }
    float* error() { return array(10); }

    /// Marks lines far, those of least error first, as long as their errors fit the budget.
    simd::LineSums select(const simd::LineBounds& bounds, float spread, float unit);
    std::vector<std::int32_t> near, far;  ///< positions of lines in the table
    int near_count = 0, far_count = 0;

    /// The polynomial that the cell has from the cells above it; lane 5 to 7 of each coefficient are 0.
    alignas(64) double polynomial[kCoefficients];

  private:
    static constexpr std::size_t kBounds = 12;
    static std::size_t padded(std::size_t count) { return (count + 15) / 16 * 16; }

    void reset(std::size_t count);
    void own_table();
    float* array(std::size_t k) { return m_bounds.data() + k * m_stride; }

    std::size_t m_count = 0, m_stride = 0;
    const float* m_table = nullptr;
    const std::int32_t* m_ids = nullptr;
    std::vector<float> m_own, m_factor, m_bounds;
    std::vector<std::int32_t> m_own_ids;
};

}  // namespace anamorph::near_far
