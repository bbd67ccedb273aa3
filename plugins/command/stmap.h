// SPDX-License-Identifier: Apache-2.0
// ST-maps of recipes: where in the source each pixel comes from, and, the other way, where in the picture each pixel of the source goes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "anamorph/parameter/parameter.h"
#include "picture_reader.h"

namespace anamorph::command {

/// How an ST-map is written.
struct StMapKind {
    bool up = false;       ///< does v go up? So it does also where the recipe says flip_v=1
    bool inverse = false;  ///< is it the map from the source to the picture?
};

/// Opens the ST-map of a recipe, of which `given` overrides keys, as a picture of two channels, R and G. That of the inverse is as large as the
/// source's display window; its points are found by Newton's iteration in double and met to 1e-9 of the picture's size, of a map that folds one of
/// them, and nothing of it is proven. (-1, -1) where there is none. Throws Error.
std::unique_ptr<PictureReader> open_stmap(const std::string& recipe, const std::vector<Assignment>& given,
                                          const StMapKind& kind);

}  // namespace anamorph::command
