// SPDX-License-Identifier: Apache-2.0
// Pictures of recipes and of files, tile by tile.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/image/picture_hash.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/picture_tiles.h"

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

/// Opens a recipe, of which `given` overrides keys, or a picture file. Throws Error.
std::unique_ptr<PictureReader> open_picture(const std::string& name,
                                            const std::vector<Assignment>& given = {});

/// The hash of all of a picture.
PictureHash hash_of(PictureReader& picture);

}  // namespace anamorph::command
