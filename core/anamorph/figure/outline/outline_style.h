// SPDX-License-Identifier: Apache-2.0
// What stands for bodies in drawings of lines (simple_outlines.h).
#pragma once

#include <cstdint>
#include <utility>

namespace anamorph::figure {

/// What bodies are drawn as: their outlines; the level of Fetter's that serves; one of these; or Willmert's cylinders.
enum class OutlineStyle : std::uint8_t { limbs, levels, boxes, contours, cylinders };

/// The styles and their words.
inline constexpr std::pair<const char*, OutlineStyle> kOutlineStyles[] = {
    {"limbs", OutlineStyle::limbs},
    {"levels", OutlineStyle::levels},
    {"boxes", OutlineStyle::boxes},
    {"contours", OutlineStyle::contours},
    {"cylinders", OutlineStyle::cylinders}};

/// Do the lines of a style hold DrawingOptions::simple_tol? Boxes and cylinders are off by what they come to.
constexpr bool holds_tolerance(OutlineStyle style) {
    return style == OutlineStyle::levels || style == OutlineStyle::contours;
}

}  // namespace anamorph::figure
