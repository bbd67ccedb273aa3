// SPDX-License-Identifier: Apache-2.0
// A figure's picture as bytes.
#pragma once

#include <cstdint>
#include <vector>

#include "anamorph/figure/image/figure_picture.h"

namespace anamorph::command {

/// Draws all of a picture in `look`, red, green and blue of each pixel from the upper left: 255 times what it has, which stays within
/// 0 to 255, rounded. Where it is transparent it is over black.
std::vector<std::uint8_t> picture_bytes(const figure::FigurePicture& picture, const figure::FigureLook& look,
                                        const Size& size, const std::vector<const Source*>& textures,
                                        const ParallelFor& parallel_for);

}  // namespace anamorph::command
