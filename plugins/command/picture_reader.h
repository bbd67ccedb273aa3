// SPDX-License-Identifier: Apache-2.0
// Pictures of recipes and of files, tile by tile, and their hashes.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/image/picture_hash.h"

namespace anamorph::command {

/// A picture as it is stored, at its finest level, which is read as far as it is asked for.
class PictureReader {
  public:
    virtual ~PictureReader() = default;
    /// How many pictures there are, one after the other.
    virtual int subimages() = 0;
    virtual const OIIO::ImageSpec& spec(int subimage) = 0;
    /// Reads pixels of `box`, counted from the corner of the data window, which lie in one row of tiles, packed, in the spec's format.
    /// Throws Error.
    virtual void read(int subimage, const Box& box, std::byte* pixels) = 0;
    /// Differs where the picture may; empty where that is not known.
    virtual std::string state() const { return {}; }
};

/// Opens a recipe or a picture file. Throws Error.
std::unique_ptr<PictureReader> open_picture(const std::string& name);

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
    PictureHash hash() const { return m_hasher.hash(); }

  private:
    PictureHasher m_hasher;
};

/// The hash of all of a picture.
PictureHash hash_of(PictureReader& picture);

}  // namespace anamorph::command
