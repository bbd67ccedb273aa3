// SPDX-License-Identifier: Apache-2.0
// OpenImageIO's pictures as they are hashed and shared out (docs/hash.md).
#pragma once

#include <OpenImageIO/imageio.h>

#include "anamorph/image/picture_tiles.h"

namespace anamorph {

/// What of a picture is hashed besides its pixels.
HashedPicture hashed_picture(const OIIO::ImageSpec& spec);

/// The tiles of a picture.
inline TileGrid tiles_of(const OIIO::ImageSpec& spec) {
    return TileGrid({spec.width, spec.height});
}

}  // namespace anamorph
