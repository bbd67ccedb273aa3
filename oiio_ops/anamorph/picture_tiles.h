// SPDX-License-Identifier: Apache-2.0
// The tiles in which pictures are hashed and shared out, and the hash of a picture (docs/hash.md).
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "anamorph/geometry/box.h"
#include "anamorph/image/picture_hash.h"

namespace anamorph {

/// The tiles of a picture, from its upper left on, row by row, in which it is hashed and shared out: whatever tiles a file has.
struct TileGrid {
    static constexpr int kSide = 256;
    int width, height;

    explicit TileGrid(const OIIO::ImageSpec& spec) : width(spec.width), height(spec.height) {}
    std::int64_t columns() const { return (width + kSide - 1) / kSide; }
    std::int64_t rows() const { return (height + kSide - 1) / kSide; }
    std::int64_t count() const { return columns() * rows(); }
    /// The pixels of `number` tiles from tile i on, which lie in one row.
    Box box(std::int64_t i, std::int64_t number = 1) const;
    /// How many tiles from i on are read at once: of one row, before `end`, and not so many that memory counts.
    std::int64_t together(std::int64_t i, std::int64_t end) const;
};

/// The text of a picture that is hashed before its tiles: its windows, and the names and types of its channels.
std::string picture_text(const OIIO::ImageSpec& spec);

/// The hash of a tile: of its rows of pixels, one behind the other, which stand `row_bytes` apart from `pixels` on.
PictureHash hash_of_tile(const OIIO::ImageSpec& spec, const std::byte* pixels, std::size_t row_bytes,
                         int width, int height);

/// The hash of pictures one after the other.
class FileHasher {
  public:
    FileHasher();
    void begin(const OIIO::ImageSpec& spec);
    void add(const PictureHash& tile) { m_hasher.add(tile); }
    /// begin(), and all tiles of the picture, whose pixels `read` writes to memory, packed, of boxes that lie in one row of tiles.
    void add_picture(const OIIO::ImageSpec& spec,
                     const std::function<void(const Box& box, std::byte* pixels)>& read);
    PictureHash hash() const { return m_hasher.hash(); }

  private:
    PictureHasher m_hasher;
};

}  // namespace anamorph
