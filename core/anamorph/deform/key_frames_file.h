// SPDX-License-Identifier: Apache-2.0
// Key frames of named numbers as text. The core opens no files: a host hands over what it has read, and a name for
// messages.
//
//     {"interpolation": "linear",                        optional: step, linear, catmull_rom or
//                                                        monotone_cubic, the default
//      "keys": {"turn": [[0, 0.1], [24, 0.9]],           each a frame, and then its numbers
//               "camera": [[0, 0, 0, 2], [12, 1, 0, 2]]}}
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "anamorph/deform/key_frames.h"

namespace anamorph {

/// The numbers of one name over time.
struct NamedKeyFrames {
    std::string name;
    KeyFrames frames;
};

/// The most key frames that a list of one name may have.
inline constexpr std::size_t kMostKeyFrames = 1u << 20;

/// The key frames of a text, in alphabetical order of their names. Throws Error: one line that names the file
/// and the entry.
std::vector<NamedKeyFrames> parse_key_frames_json(std::string_view text, std::string_view name);

}  // namespace anamorph
