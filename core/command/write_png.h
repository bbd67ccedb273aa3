// SPDX-License-Identifier: Apache-2.0
// PNG without filters of rows: libpng's choice of one for each row takes several times as long, and gains nothing on drawings.
#pragma once

#include <cstdint>
#include <vector>

#include "output_file.h"

namespace anamorph::command {

/// Writes a picture of 8 bits a channel: red, green and blue of each pixel, row by row from the top. The file is not closed. Throws Error.
void write_png(OutputFile& file, int width, int height, const std::vector<std::uint8_t>& pixels);

}  // namespace anamorph::command
