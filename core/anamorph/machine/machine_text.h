// SPDX-License-Identifier: Apache-2.0
// Machines as users name them: by a preset, or by an object of JSON that says what differs from it,
// {"size": 64, "texel": "V8U8"}.
#pragma once

#include <string_view>

#include "anamorph/machine/bump_unit.h"
#include "anamorph/machine/shaded_warp.h"

namespace anamorph {

/// Of the hardware of Kim 2003, chapter 4.
inline constexpr const char* kBumpPreset = "embm-2003";

/// `text`: kBumpPreset, or JSON with any of size, texel, scaled, weight_bits, edge, arithmetic, address_bits and
/// texture_side. Throws Error naming `machine` and the key.
BumpUnit bump_unit_from_text(std::string_view text);

/// Of the hardware of Kim 2003, chapter 5.
inline constexpr const char* kShaderPreset = "ps20";

/// The same, with kShaderPreset, arithmetic, texel, table_size, weight_bits, address_bits and texture_side.
ShaderUnit shader_unit_from_text(std::string_view text);

}  // namespace anamorph
