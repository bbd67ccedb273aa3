// SPDX-License-Identifier: Apache-2.0
// The files that shape a picture, opened by OpenImageIO: text, and images whose pixels are numbers.
#pragma once

#include "anamorph/operation/side_files.h"

namespace anamorph {

/// Reads files of the file system, and whatever images OpenImageIO reads; these past any cache, on the
/// calling thread alone.
const SideFileReader& side_file_reader();

}  // namespace anamorph
