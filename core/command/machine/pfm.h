// SPDX-License-Identifier: Apache-2.0
// Portable float maps (PF): pictures of three floats a pixel.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace anamorph::command {

/// Rows from the top, three floats a pixel.
struct FloatPicture {
    static constexpr int kMostSide = 16384;

    int width = 0, height = 0;
    std::vector<float> values;
};

/// Throws Error "name: what is wrong".
FloatPicture parse_pfm(std::string_view bytes, const std::string& name);
/// In little-endian order.
std::string pfm_of(const FloatPicture& picture);

}  // namespace anamorph::command
