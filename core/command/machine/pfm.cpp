// SPDX-License-Identifier: Apache-2.0
#include "pfm.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "anamorph/parameter/text_file.h"

namespace anamorph::command {
namespace {

using text_file::fail;

/// The next word of the header, and one blank behind it.
std::string_view take_word(std::string_view& bytes) {
    const std::size_t end = bytes.find_first_of(" \t\r\n");
    const std::string_view word = bytes.substr(0, end);
    bytes.remove_prefix(end == std::string_view::npos ? bytes.size() : end + 1);
    return word;
}

int take_side(std::string_view& bytes, const std::string& name) {
    const std::string_view word = take_word(bytes);
    std::string_view rest = word;
    double side = 0;
    const bool good = text_file::take_number(rest, side) && rest.empty() && side >= 1 &&
                      side <= FloatPicture::kMostSide && side == static_cast<int>(side);
    if (!good)
        fail(name, "",
             "width and height must be integers from 1 to " + std::to_string(FloatPicture::kMostSide) +
                 ", not \"" + text_file::excerpt(word) + "\"");
    return static_cast<int>(side);
}

std::uint32_t in_other_order(std::uint32_t v) {
    return v >> 24 | (v >> 8 & 0xff00u) | (v << 8 & 0xff0000u) | v << 24;
}

}  // namespace

FloatPicture parse_pfm(std::string_view bytes, const std::string& name) {
    if (take_word(bytes) != "PF")
        fail(name, "", "is no portable float map of three channels: must begin with PF");
    FloatPicture picture;
    picture.width = take_side(bytes, name);
    picture.height = take_side(bytes, name);
    double scale = 0;
    std::string_view word = take_word(bytes);
    if (!text_file::take_number(word, scale) || !word.empty() || scale == 0 || !std::isfinite(scale))
        fail(name, "",
             "has no scale behind its size: must have a finite number, negative for little-endian floats, "
             "positive for "
             "others");
    const std::size_t row = std::size_t{3} * static_cast<std::size_t>(picture.width);
    const std::size_t count = row * static_cast<std::size_t>(picture.height);
    if (bytes.size() != count * sizeof(float))
        fail(name, "",
             "has " + std::to_string(bytes.size()) + " bytes of pixels: must have " +
                 std::to_string(count * sizeof(float)));
    picture.values.resize(count);
    const bool other = (scale < 0) != (std::endian::native == std::endian::little);
    // Rows stand from the bottom.
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t from = (static_cast<std::size_t>(picture.height) - 1 - i / row) * row + i % row;
        std::uint32_t bits = 0;
        std::memcpy(&bits, bytes.data() + from * sizeof bits, sizeof bits);
        picture.values[i] = std::bit_cast<float>(other ? in_other_order(bits) : bits);
    }
    return picture;
}

std::string pfm_of(const FloatPicture& picture) {
    std::string text =
        "PF\n" + std::to_string(picture.width) + " " + std::to_string(picture.height) + "\n-1\n";
    const std::size_t row = std::size_t{3} * static_cast<std::size_t>(picture.width);
    for (int y = picture.height - 1; y >= 0; --y)
        for (std::size_t i = 0; i < row; ++i) {
            const auto bits =
                std::bit_cast<std::uint32_t>(picture.values[static_cast<std::size_t>(y) * row + i]);
            for (int byte = 0; byte < 4; ++byte) text += static_cast<char>(bits >> (8 * byte) & 0xffu);
        }
    return text;
}

}  // namespace anamorph::command
