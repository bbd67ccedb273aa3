// SPDX-License-Identifier: Apache-2.0
// Lists of deformations as text. The core opens no files: a host hands over what it has read, and a name for
// messages. Readers throw Error: one line that names the file and the entry.
//
// JSON (other keys are refused):
//
//     {"deformations": [
//         {"vector": [x, y, z], "center": [u, v], "extent": [a_u, a_v],
//          "kernel": "gaussian",      optional: gaussian (the default) or wendland_c2
//          "enabled": true,           optional: true (the default) or false
//          "side": "both",            optional: both (the default), front or back
//          "orientation": [1, 0, 0, 0],  optional: the turn of the bump's own frame, of bumps with depth
//          "mirror": "u",             optional: none (the default), u or v: the bump has an image beyond the line
//          "mirror_at": 0.5,          optional: of u, or v, = mirror_at (0)
//          "name": "left brow"}]}     optional
//
// center and extent may have a third number, the depth w: a bump whose extent has none, or 0, reaches to any depth.
//
// CSV: one deformation a line, center_u,center_v,extent_u,extent_v,x,y,z and then, if wanted, kernel and
// enabled (1 or 0), and then center_w,extent_w and side, then
// orientation_w,orientation_x,orientation_y,orientation_z, then mirror,mirror_at, and then name. Empty lines and lines that start with # are passed over, and so is a first line that
// names the columns (it starts with center_u).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/deform/deformation.h"
#include "anamorph/deform/deformation_entry.h"

namespace anamorph {

/// The largest number of deformations in a file; longer lists are refused.
inline constexpr std::size_t kMaxDeformations = std::size_t{1} << 20;

/// Reads a list in the JSON format described above, as it stands there.
std::vector<DeformationEntry> parse_entries_json(std::string_view text, std::string_view name);
/// Reads a list in the CSV format described above, as it stands there.
std::vector<DeformationEntry> parse_entries_csv(std::string_view text, std::string_view name);
/// Reads a list in the format that the ending of the name says: CSV for .csv, else JSON.
std::vector<DeformationEntry> parse_entries_file(std::string_view text, std::string_view name);

/// A list as a JSON file, which reads back as the same list, to the bit.
std::string entries_json(const std::vector<DeformationEntry>& list);
/// The text of a CSV file that reads back as the same list, to the bit.
std::string entries_csv(const std::vector<DeformationEntry>& list);

/// Reads a list in the JSON format described above: what a surface is deformed by, images included (with_images).
std::vector<Deformation> parse_deformations_json(std::string_view text, std::string_view name);
/// The same of the CSV format.
std::vector<Deformation> parse_deformations_csv(std::string_view text, std::string_view name);
/// The same of the format that the ending of the name says: CSV for .csv, else JSON.
std::vector<Deformation> parse_deformations_file(std::string_view text, std::string_view name);

/// A list without names and images as a JSON file.
std::string deformations_json(const std::vector<Deformation>& list);
/// The same as a CSV file.
std::string deformations_csv(const std::vector<Deformation>& list);

/// The name of a side in files: "both", "front" or "back".
const char* name_of(DeformationSide side);
/// The side of that name. Throws Error on other names.
DeformationSide side_named(std::string_view name);

/// The name of a mirror in files: "none", "u" or "v".
const char* name_of(DeformationMirror mirror);
/// The mirror of that name. Throws Error on other names.
DeformationMirror mirror_named(std::string_view name);

/// The name of a kernel in files: "gaussian" or "wendland_c2".
const char* name_of(DeformationKernel kernel);
/// The kernel of that name. Throws Error on other names.
DeformationKernel kernel_named(std::string_view name);

}  // namespace anamorph
