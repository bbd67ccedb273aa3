// SPDX-License-Identifier: Apache-2.0
// What stands for bodies in drawings of lines (simple_outlines.h).
#pragma once

#include <cstdint>

namespace anamorph::figure {

/// What bodies are drawn as: their outlines; the level of Fetter's that serves; one of these; or Willmert's cylinders.
enum class OutlineStyle : std::uint8_t { limbs, levels, boxes, contours, cylinders };

}  // namespace anamorph::figure
