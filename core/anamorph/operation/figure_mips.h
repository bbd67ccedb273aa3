// SPDX-License-Identifier: Apache-2.0
// A texture's pyramid as one picture, as Williams 1983 keeps it (Chapman 1986, section 3.5 and Fig. 24): level 0
// in three quarters, red at the upper right, green at the lower left, blue at the lower right; in the fourth
// quarter level 1 alike, and so on to the level that has a side of one texel.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/operation/operation.h"

namespace anamorph {

/// A texture that is there or not.
struct MipTexture {
    std::string name;
    std::optional<Size> size;
    std::shared_ptr<const Source> maps = {};  ///< where it is no picture of the host's
};

/// Makes a picture of one channel for each texture, twice as large either way; of one that is missing 2 x 2
/// black pixels. Those that are the host's are the first sources that are drawn.
std::unique_ptr<const Pictures> mip_pictures(std::vector<MipTexture> textures, const Attributes& says);

}  // namespace anamorph
