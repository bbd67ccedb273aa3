// SPDX-License-Identifier: Apache-2.0
#include "shown.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace anamorph_viewer {
namespace {

double linear_of(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}
double encoded_of(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

/// The bits of a float that the table leaves out.
constexpr int kDropped = 12;

std::vector<unsigned char> make_table() {
    std::vector<unsigned char> table(std::bit_cast<std::uint32_t>(1.0f) >> kDropped);
    for (std::uint32_t i = 0; i < table.size(); ++i)
        table[i] = shown(std::bit_cast<float>((i << kDropped) | (1u << (kDropped - 1))), true, 1);
    return table;
}

}  // namespace

unsigned char shown(float value, bool hdr, double gain) {
    double v = double{value};
    if (hdr || gain != 1) v = encoded_of((hdr ? v : linear_of(v)) * gain);
    // Written so that what is no number is black.
    return static_cast<unsigned char>(std::lround(255 * std::min(v > 0 ? v : 0, 1.0)));
}

unsigned char shown_quickly(float value, bool hdr) {
    if (!(value > 0)) return 0;
    if (value >= 1) return 255;
    if (!hdr) return static_cast<unsigned char>(255 * value + 0.5f);
    static const std::vector<unsigned char> table = make_table();
    return table[std::bit_cast<std::uint32_t>(value) >> kDropped];
}

std::string_view shown_glsl() {
    return R"(
  vec3 anamorphLinear = gl_FragData[0].rgb;
  if (anamorphGain.x > 0.0) {
    if (anamorphGain.y == 0.0)
      anamorphLinear = mix(pow((anamorphLinear + 0.055) / 1.055, vec3(2.4)), anamorphLinear / 12.92,
                           vec3(lessThanEqual(anamorphLinear, vec3(0.04045))));
    anamorphLinear = max(anamorphLinear * anamorphGain.x, vec3(0.0));
    gl_FragData[0].rgb = mix(1.055 * pow(anamorphLinear, vec3(1.0 / 2.4)) - 0.055, 12.92 * anamorphLinear,
                             vec3(lessThanEqual(anamorphLinear, vec3(0.0031308))));
  }
)";
}

}  // namespace anamorph_viewer
