// SPDX-License-Identifier: Apache-2.0
// The small random number that is added to the light of a pixel, against contours on displays with few
// intensities (Chapman 1986, section 2.9, after Herbison-Evans 1980). The essay names neither its size nor its
// distribution: uniform it is ours.
//
// It is a hash of the seed, the frame and the pixel, no member of a sequence: any part of a picture, on any
// thread, has the same.
#pragma once

#include <cstdint>

namespace anamorph::figure {

/// The finalizer of SplitMix64 (Steele, Lea and Flood 2014): a bijection of 64 bits in which every bit of z moves all of the
/// result.
inline std::uint64_t mixed_bits(std::uint64_t z) {
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

/// A number that is as random as the hash, uniform in [-1, 1), of a pixel of a frame; x and y may be negative.
inline double random_of_pixel(int seed, int frame, int x, int y) {
    constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15u;  // 2^64 divided by the golden ratio, odd
    std::uint64_t bits = 0;
    for (const int part : {seed, frame, x, y})
        bits = mixed_bits(bits + kStep + static_cast<std::uint32_t>(part));
    // The upper 53 bits, all of which double holds.
    return static_cast<double>(bits >> 11) * 0x1p-52 - 1;
}

}  // namespace anamorph::figure
