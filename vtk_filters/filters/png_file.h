// SPDX-License-Identifier: Apache-2.0
// The check that a PNG file is whole: VTK 9.1's reader crashes on one that is cut off or damaged.
#pragma once

#include <string>

namespace anamorph_vtk {

/// Throws Error unless the chunks of a PNG file are all there and have the checksums that they say; passes
/// files of other formats. Reads the file once and unpacks nothing: a picture that was written with too
/// little in it passes.
void check_png(const std::string& path);

}  // namespace anamorph_vtk
