// SPDX-License-Identifier: Apache-2.0
// The tiles in which pictures are hashed and shared out, and the hash of a picture (docs/hash.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/image/picture_hash.h"
#include "anamorph/image/view.h"

namespace anamorph {

/// What a picture is besides its pixels, as far as it is hashed.
struct HashedPicture {
    struct Channel {
        std::string name, type;  ///< type in OpenImageIO's words: uint8, uint16, half, float ...
        HashedNumbers numbers;
    };
    Box data, display;  ///< windows
    std::vector<Channel> channels;

    /// A picture whose windows are one, with channels of one type.
    HashedPicture(int width, int height, PixelType type, const std::vector<std::string>& names);
    HashedPicture(const Box& data_window, const Box& display_window, std::vector<Channel> all)
        : data(data_window), display(display_window), channels(std::move(all)) {}

    std::size_t pixel_bytes() const;
    /// The text that is hashed before the tiles.
    std::string text() const;
    /// The hash of a tile: of its rows of pixels, one behind the other, which stand `row_bytes` apart from `pixels` on.
    PictureHash hash_of_tile(const std::byte* pixels, std::size_t row_bytes, int width, int height) const;
};

/// The tiles of a picture, from its upper left on, row by row, in which it is hashed and shared out: whatever tiles a file has.
struct TileGrid {
    static constexpr int kSide = 256;
    int width, height;

    explicit TileGrid(const Size& size) : width(size.width), height(size.height) {}
    std::int64_t columns() const { return (width + kSide - 1) / kSide; }
    std::int64_t rows() const { return (height + kSide - 1) / kSide; }
    std::int64_t count() const { return columns() * rows(); }
    /// The pixels of `number` tiles from tile i on, which lie in one row.
    Box box(std::int64_t i, std::int64_t number = 1) const;
    /// How many tiles from i on are read at once: of one row, before `end`, and not so many that memory counts.
    std::int64_t together(std::int64_t i, std::int64_t end) const;
};

/// The hash of pictures one after the other.
class FileHasher {
  public:
    FileHasher();
    void begin(const HashedPicture& picture) { m_hasher.add(picture.text()); }
    void add(const PictureHash& tile) { m_hasher.add(tile); }
    /// begin(), and all tiles of the picture, whose pixels `read` writes to memory, packed, of boxes that lie in one row of tiles.
    void add_picture(const HashedPicture& picture,
                     const std::function<void(const Box& box, std::byte* pixels)>& read);
    PictureHash hash() const { return m_hasher.hash(); }

  private:
    PictureHasher m_hasher;
};

}  // namespace anamorph
