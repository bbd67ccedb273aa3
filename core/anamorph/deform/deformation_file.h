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
//          "side": "both"}]}          optional: both (the default), front or back
//
// center and extent may have a third number, the depth w: a bump whose extent has none, or 0, reaches to any depth.
//
// CSV: one deformation a line, center_u,center_v,extent_u,extent_v,x,y,z and then, if wanted, kernel and
// enabled (1 or 0), and then center_w,extent_w and side. Empty lines and lines that start with # are passed over, and so is a first line that
// names the columns (it starts with center_u).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/deform/deformation.h"

namespace anamorph {

/// The largest number of deformations in a file; longer lists are refused.
inline constexpr std::size_t kMaxDeformations = std::size_t{1} << 20;

/// Reads a list in the JSON format described above.
std::vector<Deformation> parse_deformations_json(std::string_view text, std::string_view name);
/// Reads a list in the CSV format described above.
std::vector<Deformation> parse_deformations_csv(std::string_view text, std::string_view name);
/// Reads a list in the format that the ending of the name says: CSV for .csv, else JSON.
std::vector<Deformation> parse_deformations_file(std::string_view text, std::string_view name);

/// A list as a JSON file, which reads back as the same list, to the bit.
std::string deformations_json(const std::vector<Deformation>& list);
/// The text of a CSV file that reads back as the same list, to the bit.
std::string deformations_csv(const std::vector<Deformation>& list);

/// The name of a side in files: "both", "front" or "back".
const char* name_of(DeformationSide side);
/// The side of that name. Throws Error on other names.
DeformationSide side_named(std::string_view name);

/// The name of a kernel in files: "gaussian" or "wendland_c2".
const char* name_of(DeformationKernel kernel);
/// The kernel of that name. Throws Error on other names.
DeformationKernel kernel_named(std::string_view name);

}  // namespace anamorph
