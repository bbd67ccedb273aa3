// SPDX-License-Identifier: Apache-2.0
// The order in which the bases of a formula come (number/near.h), as a checksum that differs wherever two
// orders do.
#pragma once

#include <bit>
#include <cstdint>

namespace anamorph {

/// The operations of a formula that yield a base, or read one.
enum class BaseOperation : std::uint8_t {
    input,
    output,
    negation,
    sum,
    difference,
    product,
    quotient,
    root,
    sine_and_cosine,
    angle,
    area_sine,
    scaled_sine,
    sinc_and_cosine,
    power_series,
    is_negative,
    is_zero,
    is_small_angle,
    both,
    choice
};

/// A checksum of the operations so far, in the order in which they were done: each is numbered, and its entry in the sum is
/// the kind of operation and the numbers of its operands.
class ReadingOrder {
  public:
    /// The number of an operation's first result; 0 for a constant.
    using Number = std::uint32_t;

    constexpr Number next(BaseOperation operation, Number a = 0, Number b = 0, Number c = 0) {
        // Different entries are different words as long as there are fewer than 2^18 of them.
        const std::uint64_t entry = static_cast<std::uint64_t>(operation) | std::uint64_t{a} << 8 |
                                    std::uint64_t{b} << 26 | std::uint64_t{c} << 44;
        m_sum = joined(m_sum, entry);
        return ++m_count;
    }
    constexpr std::uint64_t sum() const { return m_sum; }

    /// Joins two sums in one. With either of them fixed it is one to one in the other, so that a single difference is never
    /// lost; of several differences one in 2^64 is.
    static constexpr std::uint64_t joined(std::uint64_t first, std::uint64_t second) {
        return (std::rotl(first, 27) ^ second) * 0x9e3779b97f4a7c15u;
    }

  private:
    std::uint64_t m_sum = 0;
    Number m_count = 0;
};

}  // namespace anamorph
