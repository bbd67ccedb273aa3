// SPDX-License-Identifier: Apache-2.0
// Features from text. The core opens no files: a host hands over what it has read, and a name for messages.
// All functions throw Error: one line that names the file and the entry.
//
// JSON (keys in any order, others are refused; coordinates in pixels):
//
//     {
//       "sizes": [[600, 400], [800, 600]],    optional: the pictures that the coordinates are meant for; a
//                                             picture of another size is taken to be scaled
//       "pin_border": 1,                      optional: holds the border, with this weight (or true, false)
//       "features": [                         each with one entry for every key shape (A, B, C ...)
//         {"line": [[10, 20, 90, 25], [12, 30, 95, 20]], "name": "brow", "weight": 2},
//         {"polyline": [[[10, 20], [30, 40], [60, 40]], [[12, 24], [35, 42], [66, 47]]]},
//         {"curve": [[[0, 0], [10, 0], [20, 10], [20, 20]], [...]]}     Bezier, 3 n + 1 control points
//       ]
//     }
//
// CSV: one pair a line, ax0,ay0,ax1,ay1,bx0,by0,bx1,by1 in pixels of A and of B, and optionally its weight;
// empty lines and lines that start with # are passed over, and so is a first line that names the columns
// (ax0,ay0,...).
//
// SVG as Inkscape writes it: every layer (a group with inkscape:groupmode="layer") is a key shape, the lowest
// layer first; layers without any lines (pictures, notes) are passed over. The name of the picture that a layer links to
// (Features::picture) may say another order. Read are line, polyline, polygon (closed), circle, ellipse (curves from
// their right end on downwards) and path elements (M L H V C S Q T Z, absolute and relative; quadratic curves are raised to
// cubics; arcs are refused) at any depth in groups, with their transform attributes. Drawings of two layers
// belong together when their inkscape:label is the same, or their id: ids are unique in a file, so the
// id of the other layers' drawing may have a tail after a "-" or "_" ("brow" and "brow-5", which Inkscape
// makes of a copy, or "brow_b"; a tail on both, "brow-a" and "brow-b", when it is the layers' labels). They
// need the same number of parts and segments; where one is straight and the other curved, both count as
// curves. An attribute data-weight of the first layer's drawing is its weight. Coordinates: where a layer
// holds an image element, pixels of a picture that fills that element; else user units are pixels.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "anamorph/morph/feature_lines.h"

namespace anamorph {

/// The largest number of lines in a file; more are refused.
inline constexpr std::size_t kMaxFeatures = std::size_t{1} << 17;

/// Reads features in the JSON format described above.
Features parse_features_json(std::string_view text, std::string_view name);
/// Reads features in the CSV format described above.
Features parse_features_csv(std::string_view text, std::string_view name);
/// Reads features from SVG as described above.
Features parse_features_svg(std::string_view text, std::string_view name);
/// Reads features in the format that the ending of the name says: CSV for .csv, SVG for .svg, else JSON.
Features parse_features_file(std::string_view text, std::string_view name);

/// Writes features as JSON, as parse_features_json() reads them: the same numbers, to the bit.
std::string features_json(const Features& features);
/// Writes features as CSV, to the bit. Throws Error where they have other than two shapes, or more than lines and weights.
std::string features_csv(const Features& features);
/// Writes features as SVG, to the bit: each layer lies over the picture that it belongs to (Features::picture), in its pixels. Throws
/// Error where the format lacks what they have.
std::string features_svg(const Features& features);
/// Writes features in the format that the ending of the name says.
std::string features_text(const Features& features, std::string_view name);

/// Checks how many lines there are. Throws Error naming the entry of the file that is one line too many.
void check_feature_count(const Features& features, std::string_view file, const std::string& entry);

}  // namespace anamorph
