// SPDX-License-Identifier: Apache-2.0
// Pictures as files of OpenImageIO's formats.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace anamorph::command {

/// The file that a picture becomes.
struct PictureFile {
    std::string name;
    /// How it is packed, in its format's words, such as "zip" or "zip:4". Without, PNG files are "rle", which takes a fraction of the time
    /// of zlib's own choice and packs photographs smaller; others are as OpenImageIO has them.
    std::optional<std::string> compression;
    /// Is a format refused that has no numbers of the type float, which the picture has?
    bool in_float = false;
};

/// Writes a picture whose rows of tiles `rows` makes, one after the other, under another name until it is whole. Where OpenImageIO
/// may use several threads, a row is packed and written while the next is made. Throws Error.
void write_picture(const OIIO::ImageSpec& picture, const PictureFile& file,
                   const std::function<void(std::int64_t row, std::vector<std::byte>& pixels)>& rows);

}  // namespace anamorph::command
