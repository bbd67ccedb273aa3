// SPDX-License-Identifier: Apache-2.0
#include "write_png.h"

#ifdef ANAMORPH_HAVE_CAIRO
#include <png.h>

#include <memory>
#include <string>

#include "anamorph/error.h"

namespace anamorph::command {

void write_png(OutputFile& file, int width, int height, const std::vector<std::uint8_t>& pixels) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width);
    image.height = static_cast<png_uint_32>(height);
    image.format = PNG_FORMAT_RGB;
    image.flags = PNG_IMAGE_FLAG_FAST;  // no filters
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    const auto packed = std::make_unique_for_overwrite<char[]>(size);
    if (!png_image_write_to_memory(&image, packed.get(), &size, 0, pixels.data(), 0, nullptr))
        throw Error(std::string("libpng: ") + image.message);
    file.write({packed.get(), size});
}

}  // namespace anamorph::command
#endif
