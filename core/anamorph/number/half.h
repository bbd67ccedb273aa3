// SPDX-License-Identifier: Apache-2.0
// IEEE binary16 in and out of float, in plain integer arithmetic: independent of the processor's rounding of
// denormals. Conversion to half rounds to nearest, ties to even; NaN keeps its sign and its leading bits.
#pragma once

#include <cstdint>

#include "anamorph/number/portable.h"

namespace anamorph {

inline float float_from_half(std::uint16_t half) noexcept {
    const std::uint32_t sign = static_cast<std::uint32_t>(half & 0x8000u) << 16;
    const std::uint32_t magnitude = half & 0x7fffu;
    // Denormals count units of 2^-24.
    const std::uint32_t bits = magnitude < 0x0400u
                                   ? bit_cast<std::uint32_t>(static_cast<float>(magnitude) * 0x1p-24f)
                               : magnitude < 0x7c00u ? (magnitude << 13) + ((127u - 15u) << 23)
                                                     : (magnitude << 13) | 0x7f800000u;
    return bit_cast<float>(sign | bits);
}

inline std::uint16_t half_from_float(float value) noexcept {
    const std::uint32_t bits = bit_cast<std::uint32_t>(value);
    const std::uint32_t sign = (bits >> 16) & 0x8000u;
    std::uint32_t magnitude = bits & 0x7fffffffu;
    if (magnitude > 0x7f800000u)  // NaN, made quiet
        magnitude = 0x7e00u | ((magnitude >> 13) & 0x3ffu);
    else if (magnitude >= 0x47800000u)  // 2^16 and above
        magnitude = 0x7c00u;
    else if (magnitude < 0x38800000u)  // below 2^-14: the sum with 1/2 has the half's last place, 2^-24
        magnitude = bit_cast<std::uint32_t>(bit_cast<float>(magnitude) + 0.5f) - 0x3f000000u;
    else  // change the exponent's bias and round away 13 bits; a carry runs into the exponent
        magnitude = (magnitude - ((127u - 15u) << 23) + 0xfffu + ((magnitude >> 13) & 1u)) >> 13;
    return static_cast<std::uint16_t>(sign | magnitude);
}

}  // namespace anamorph
