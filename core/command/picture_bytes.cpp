// SPDX-License-Identifier: Apache-2.0
#include "picture_bytes.h"

#include <algorithm>
#include <cmath>

namespace anamorph::command {

std::vector<std::uint8_t> picture_bytes(const figure::FigurePicture& picture, const figure::FigureLook& look,
                                        const Size& size, const std::vector<const Source*>& textures,
                                        const ParallelFor& parallel_for) {
    const int channels = figure::channels_of(look.style);
    std::vector<float> pixels(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height) *
                              static_cast<std::size_t>(channels));
    picture.draw({0, 0, size.width, size.height},
                 packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, size.width,
                             size.height, channels),
                 parallel_for, textures);
    std::vector<std::uint8_t> bytes;
    for (std::size_t i = 0; i < pixels.size(); i += static_cast<std::size_t>(channels))
        for (std::size_t c = 0; c < 3; ++c)
            bytes.push_back(
                static_cast<std::uint8_t>(std::lround(std::clamp(pixels[i + c], 0.0f, 1.0f) * 255)));
    return bytes;
}

}  // namespace anamorph::command
