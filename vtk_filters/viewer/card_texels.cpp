// SPDX-License-Identifier: Apache-2.0
#include "card_texels.h"

#include <algorithm>
#include <cmath>

namespace anamorph_viewer {

using anamorph::Size;

void refuse_card(const std::string& what) {
    throw anamorph::Error("a graphics card does not draw " + what + ": draw must be picture");
}

CardTexels card_texels(const anamorph::SourceStack& stack, int stacked) {
    constexpr int kMostSide = 8192;
    constexpr std::int64_t kMostTexels = std::int64_t{1} << 25;
    if (stack.space()) refuse_card("in another color space");
    const anamorph::Source& source = stack.top();
    int level = 0;
    const auto fits = [&](const Size& s) {
        return std::max(s.width, s.height) <= kMostSide && std::int64_t{s.width} * s.height <= kMostTexels;
    };
    while (!fits(source.size(level)) && level + 1 < source.levels()) ++level;
    CardTexels texels{source.size(level), source.channels(), {}};
    const Size& size = texels.size;
    if (!fits(size) || size.height % stacked != 0) refuse_card("images as large as this");
    const std::size_t values_of_row =
                          static_cast<std::size_t>(size.width) * static_cast<std::size_t>(texels.channels),
                      count = values_of_row * static_cast<std::size_t>(size.height);
    const OIIO::TypeDesc type = anamorph::oiio_type(source.type());
    std::vector<std::byte> stored(count * type.size());
    if (!source.read(level, {0, 0, size.width, size.height}, stored.data(),
                     static_cast<std::ptrdiff_t>(values_of_row * type.size())))
        throw anamorph::Error(stack.error());
    texels.values.resize(count);
    OIIO::convert_pixel_values(type, stored.data(), OIIO::TypeDesc::FLOAT, texels.values.data(),
                               static_cast<int>(count));
    return texels;
}

vtkSmartPointer<vtkImageData> card_image(const CardTexels& texels, int scalars) {
    const auto image = vtkSmartPointer<vtkImageData>::New();
    const auto width = static_cast<std::size_t>(texels.size.width),
               channels = static_cast<std::size_t>(texels.channels);
    image->SetDimensions(texels.size.width, texels.size.height, 1);
    image->AllocateScalars(scalars, 3);
    void* const to = image->GetScalarPointer();
    std::size_t next = 0;
    for (auto y = static_cast<std::size_t>(texels.size.height); y-- > 0;)
        for (std::size_t x = 0; x < width; ++x) {
            const float* const from = &texels.values[(y * width + x) * channels];
            for (std::size_t c = 0; c < 3; ++c, ++next) {
                const float value = from[channels < 3 ? 0 : c];
                if (scalars == VTK_FLOAT)
                    static_cast<float*>(to)[next] = value;
                else
                    static_cast<unsigned char*>(to)[next] =
                        static_cast<unsigned char>(std::lround(255 * value));
            }
        }
    return image;
}

}  // namespace anamorph_viewer
