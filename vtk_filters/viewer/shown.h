// SPDX-License-Identifier: Apache-2.0
// Values as a screen shows them.
#pragma once

#include <string_view>

namespace anamorph_viewer {

/// A value as the screen shows it: `gain` times as bright, in sRGB's curve, 0 to 255. Values of sources that are not HDR are
/// in that curve already, and stay as they are where the gain is 1.
unsigned char shown(float value, bool hdr, double gain);

/// The same where the gain is 1, from a table whose values of HDR are read to 11 bits.
unsigned char shown_quickly(float value, bool hdr);

/// What shown() does, as lines of a fragment shader that come last. They read a uniform vec2 of the name kShownGain: the gain, 0 where
/// values stay as they are, and whether they are HDR.
std::string_view shown_glsl();
inline constexpr const char* kShownGain = "anamorphGain";

}  // namespace anamorph_viewer
