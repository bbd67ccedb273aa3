// SPDX-License-Identifier: Apache-2.0
// Files of text that a filter reads whole.
#pragma once

#include <string>

namespace anamorph_vtk {

/// All of a file. Throws Error where it cannot be read, or is larger than the core reads.
std::string text_of_file(const std::string& name);

}  // namespace anamorph_vtk
