// SPDX-License-Identifier: Apache-2.0
// Machines as users name them: by a preset, embm-2003; with what differs from it, embm-2003:size=64,texel=V8U8; or that alone
// as an object of JSON, {"size": 64, "texel": "V8U8"}.
#pragma once

#include <string_view>

#include "anamorph/machine/block_machine.h"
#include "anamorph/machine/bump_unit.h"
#include "anamorph/machine/morph_unit.h"
#include "anamorph/machine/shaded_warp.h"

namespace anamorph::machine {

/// The name of the preset for the hardware of Kim 2003, chapter 4.
inline constexpr const char* kBumpPreset = "embm-2003";

/// Parses a machine of kBumpPreset, with any of the keys card, projecting, planes, x_max, y_max, size, texel, scaled, weight_bits,
/// edge, arithmetic, address_bits and texture_side. Throws Error naming `machine` and the key, also where the card cannot do it.
BumpUnit bump_unit_from_text(std::string_view text);

/// The name of the preset for the hardware of Kim 2003, chapter 5.
inline constexpr const char* kShaderPreset = "ps20";

/// The name of the preset that has registers and textures as the printed program does (ShaderLayout::printed).
inline constexpr const char* kPrintedPreset = "kim-2003";

/// Parses a machine of kShaderPreset or kPrintedPreset, with any of the keys arithmetic, texel, table_size, weight_bits,
/// address_bits and texture_side, and of the latter alpha. Throws Error naming `machine` and the key.
ShaderUnit shader_unit_from_text(std::string_view text);

/// Parses a machine of kPrintedPreset for morphs, with any of its keys but alpha, and cells, levels and buffer. Throws Error naming
/// `machine` and the key.
MorphUnit morph_unit_from_text(std::string_view text);

/// The name of the preset for the machine of Oka 1987, section 3.
inline constexpr const char* kBlockPreset = "oka-1987";

/// Parses a machine of kBlockPreset, with any of the names of the rows of block_machine.h as keys, and coordinates, coefficients,
/// addresses and hidden. Throws Error naming `machine` and the key.
BlockMachine block_machine_from_text(std::string_view text);

}  // namespace anamorph::machine
